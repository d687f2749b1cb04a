//! Terrain from rasters and surveys, and rock cut out of it: against closed forms.

use crate::support;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use riprap::ground::Ground;
use riprap::observe::Observer as _;
use riprap::observe::gauges::Gauges;
use riprap::run;
use riprap::scene::error::Problem;
use riprap::scene::impulse_wave::SlideImpact;
use riprap::scene::parse;
use riprap::scene::resolve::Scene;
use riprap::scene::terrain::Terrain;
use riprap::scene::terrain::basin::room_below;
use riprap::table::Start;
use riprap_dda::{Shape, Vec3};

const G: f64 = 9.81;

/// A raster of a closed form: its south-western point, the distance of its points, and their numbers.
struct Raster {
    corner: [f64; 2],
    cell: f64,
    n: [usize; 2],
}

impl Raster {
    /// Writes it with its lower-left cell named by its center.
    fn write(&self, path: &Path, height: impl Fn(f64, f64) -> f64) {
        self.write_named(path, ("xllcenter", "yllcenter"), self.corner, height);
    }

    fn write_named(
        &self,
        path: &Path,
        (x, y): (&str, &str),
        named: [f64; 2],
        height: impl Fn(f64, f64) -> f64,
    ) {
        let mut text = format!(
            "ncols {}\nnrows {}\n{x} {:?}\n{y} {:?}\ncellsize {:?}\nNODATA_value -9999\n",
            self.n[0], self.n[1], named[0], named[1], self.cell
        );
        for j in (0..self.n[1]).rev() {
            for i in 0..self.n[0] {
                let at = |axis: usize, k: usize| self.corner[axis] + k as f64 * self.cell;
                let z = height(at(0, i), at(1, j));
                let z = if z.is_nan() { -9999.0 } else { z };
                write!(text, "{z:?} ").unwrap();
            }
            text.push('\n');
        }
        std::fs::write(path, text).unwrap();
    }
}

/// 400 m by 300 m, about the origin along y.
fn valley() -> Raster {
    Raster {
        corner: [0.0, -150.0],
        cell: 10.0,
        n: [41, 31],
    }
}

/// A slope of 40 degrees up along −x, with hummocks.
fn hummocky(x: f64, y: f64) -> f64 {
    300.0 - 40.0_f64.to_radians().tan() * x + 4.0 * (x / 23.0).sin() * (y / 31.0).cos()
}

fn scene(folder: &Path, terrain: &str, slides: &str, further: &str) -> Result<Scene, Vec<Problem>> {
    let text = format!(
        r#"(title: "a slope", domain: (min: (0, -150, -100), max: (400, 150, 400)),
            materials: [(name: "rock", density: 2500, friction_angle_deg: 20, contact_stiffness: 1e9)],
            terrain: {terrain}, slides: [{slides}],
            blocks: [(name: "ground", material: "rock", motion: Fixed, shape: Terrain)],
            time: (duration: 1), {further})"#
    );
    Scene::resolve(parse::read(&text).unwrap(), folder)
}

fn terrain_of(folder: &Path, terrain: &str) -> Result<Terrain, Problem> {
    match scene(folder, terrain, "", "") {
        Ok(scene) => Ok(scene.terrain.unwrap()),
        Err(problems) => Err(problems.into_iter().next().unwrap()),
    }
}

/// Heights of the ground as blocks meet it.
fn ground(terrain: &Terrain) -> Ground {
    let surface = &terrain.surface;
    let corners = |t: &[u32; 3]| t.map(|v| surface.vertices()[v as usize]);
    Ground::over(surface.triangles().iter().map(corners).collect())
}

fn volume(scene: &Scene, name: &str) -> f64 {
    let blocks = scene.block_names.iter().zip(&scene.blocks);
    blocks
        .filter(|(block, _)| block.starts_with(name))
        .map(|(_, block)| block.shape.volume())
        .sum()
}

const L_SHAPE: &str =
    "Corners([(55, -83), (195, -83), (195, 12.5), (141, 12.5), (141, 71), (55, 71)])";
/// Of that; m².
const L_AREA: f64 = 140.0 * 154.0 - 54.0 * 58.5;
const JOINTS: &str = "joint_sets: [(dip_deg: 40, dip_direction_deg: 90, spacing: 17),
    (dip_deg: 75, dip_direction_deg: 270, spacing: 18, scatter_deg: 3, spacing_scatter: 0.2),
    (dip_deg: 88, dip_direction_deg: 10, spacing: 19, spacing_scatter: 0.2)], seed: 2";

/// Rows run from the north; a cell may be named by its center or its corner.
#[test]
fn centres_and_corners_of_cells_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let raster = valley();
    raster.write(&folder.path().join("center.asc"), hummocky);
    let corner = raster.corner.map(|x| x - 0.5 * raster.cell);
    let named = ("xllcorner", "yllcorner");
    raster.write_named(&folder.path().join("corner.asc"), named, corner, hummocky);
    let of = |file: &str| {
        let terrain = format!("(sources: [(file: \"{file}\")])");
        terrain_of(folder.path(), &terrain).unwrap().grid
    };
    let grid = of("center.asc");
    assert_eq!(grid, of("corner.asc"));
    let [x, y] = grid.place([7, 11]);
    assert_eq!([x, y], [70.0, -40.0]);
    assert_eq!(grid.height([x, y]), Some(hummocky(x, y)));
}

/// A map 1e6 m off and a kilometer high gives the scene the same terrain: heights in a file of 1e6 m have 1e-10 m of round-off.
#[test]
fn a_far_map_is_shifted_to_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let near = valley();
    near.write(&folder.path().join("near.asc"), hummocky);
    let far = Raster {
        corner: [1e6, 5e6 - 150.0],
        ..valley()
    };
    far.write(&folder.path().join("far.asc"), |x, y| {
        hummocky(x - 1e6, y - 5e6) + 1000.0
    });
    let near = terrain_of(folder.path(), "(sources: [(file: \"near.asc\")])").unwrap();
    let far = "(sources: [(file: \"far.asc\")], origin: (1e6, 5e6, 1000))";
    let far = terrain_of(folder.path(), far).unwrap();
    assert_eq!(
        (near.grid.corner, near.grid.n),
        (far.grid.corner, far.grid.n)
    );
    let heights = near.grid.heights.iter().zip(&far.grid.heights);
    let worst = heights.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    println!("heights differ by {worst:.1e} m");
    assert!(worst < 1e-9);
    assert_eq!(near.surface.triangles(), far.surface.triangles());
}

/// Land that has 0 for water over a bathymetry in feet: each counts where it has heights, and a strip between is filled.
#[test]
fn land_and_bathymetry_are_merged() {
    let folder = tempfile::tempdir().unwrap();
    let slope = |x: f64| 100.0 - 0.5 * x;
    valley().write(&folder.path().join("land.asc"), |x, _| slope(x).max(0.0));
    let feet = |x: f64, _: f64| {
        if x < 225.0 {
            f64::NAN
        } else {
            (slope(x) - 3.0) / 0.3048
        }
    };
    valley().write(&folder.path().join("sea.asc"), feet);
    let sources = "sources: [(file: \"land.asc\", heights: (0.1, 9000)), (file: \"sea.asc\", height_scale: 0.3048, height_shift: 3)]";
    let refused = terrain_of(folder.path(), &format!("({sources})")).unwrap_err();
    println!("{}", refused.message);
    assert_eq!(refused.path, "terrain.sources");
    assert!(
        refused
            .message
            .contains("no source has a height at (200.00, -150.00) m")
    );
    let terrain = terrain_of(folder.path(), &format!("({sources}, gaps: Filled(30))")).unwrap();
    // heights of the land at 200 m, of both beside it, are 0.0 or below
    assert_eq!(terrain.n_filled, 3 * 31);
    for point in terrain.grid.points() {
        let [x, _] = terrain.grid.place(point);
        let z = terrain.grid.heights[terrain.grid.index(point)];
        // a membrane between two rims of a plane is the plane
        assert!((z - slope(x)).abs() < 1e-6, "{x} {z}");
    }
    let narrow = terrain_of(folder.path(), &format!("({sources}, gaps: Filled(10))")).unwrap_err();
    assert_eq!(narrow.path, "terrain.gaps");
}

/// A coarser point has the mean over its square, which of a plane is its own height, and of a fine ripple nothing.
#[test]
fn coarse_points_are_means_and_fine_points_are_interpolated() {
    let folder = tempfile::tempdir().unwrap();
    let fine = Raster {
        corner: [0.0, -150.0],
        cell: 2.5,
        n: [161, 121],
    };
    // waves of two points, which a sample would take for heights
    let ripple = |x: f64| {
        if (x / 2.5).round() as i64 % 2 == 0 {
            3.0
        } else {
            -3.0
        }
    };
    fine.write(&folder.path().join("fine.asc"), |x, y| {
        0.3 * x + 0.1 * y + ripple(x)
    });
    let of = |more: &str| {
        let terrain =
            format!("(sources: [(file: \"fine.asc\")], clip: ((50, -100), (350, 100)), {more})");
        terrain_of(folder.path(), &terrain).unwrap().grid
    };
    let coarse = of("spacing: 20");
    assert_eq!((coarse.corner, coarse.n), ([60.0, -90.0], [15, 10]));
    for point in coarse.points() {
        let [x, y] = coarse.place(point);
        let z = coarse.heights[coarse.index(point)];
        assert!((z - 0.3 * x - 0.1 * y).abs() < 1e-9, "{x} {y} {z}");
    }
    let finer = of("spacing: 1.25");
    assert_eq!(finer.height([51.25, 0.0]), Some(0.3 * 51.25));
}

/// Flat ground is two triangles for any number of points; rough ground is within the tolerance at each of them.
#[test]
fn flat_ground_is_cheap_and_rough_ground_is_met() {
    let folder = tempfile::tempdir().unwrap();
    valley().write(&folder.path().join("flat.asc"), |x, y| {
        50.0 - 0.25 * x + 0.125 * y
    });
    let flat = terrain_of(folder.path(), "(sources: [(file: \"flat.asc\")])").unwrap();
    assert_eq!(flat.surface.triangles().len(), 2);
    valley().write(&folder.path().join("rough.asc"), hummocky);
    let mut before = 0;
    for tolerance in [2.0, 0.5, 0.1, 1e-9] {
        let terrain = format!("(sources: [(file: \"rough.asc\")], tolerance: {tolerance})");
        let terrain = terrain_of(folder.path(), &terrain).unwrap();
        let found = ground(&terrain);
        let off = |point| {
            let [x, y] = terrain.grid.place(point);
            (found.height_under_the_sky([x, y]).unwrap() - hummocky(x, y)).abs()
        };
        let worst = terrain.grid.points().map(off).fold(0.0, f64::max);
        let n = terrain.surface.triangles().len();
        println!("{n} triangles within {tolerance} m: {worst:.2e} m off");
        assert!(worst <= tolerance * (1.0 + 1e-9) + 1e-9 && before < n);
        before = n;
    }
    // but for the western rim, which is straight: its 29 points between two corners are not needed
    assert_eq!(before, 2 * 40 * 30 - 29);
}

/// The rock between two parallel planes has the outline's area times their distance along z: 1e-9, a thousand cuts' round-off.
#[test]
fn a_slab_has_the_volume_of_its_outline() {
    let folder = tempfile::tempdir().unwrap();
    let slope = |x: f64, y: f64| 300.0 - 0.8 * x + 0.1 * y;
    valley().write(&folder.path().join("plane.asc"), slope);
    let point = slope(100.0, 0.0) - 30.0;
    let dip = 0.8_f64.hypot(0.1).atan().to_degrees();
    let direction = 0.8_f64.atan2(-0.1).to_degrees();
    let slide = format!(
        "(name: \"slab\", material: \"rock\", outline: {L_SHAPE}, {JOINTS},
          failure_surface: Plane(point: (100, 0, {point}), dip_deg: {dip}, dip_direction_deg: {direction}))"
    );
    let scene = scene(
        folder.path(),
        "(sources: [(file: \"plane.asc\")])",
        &slide,
        "",
    )
    .unwrap();
    let exact = 30.0 * L_AREA;
    let error = (volume(&scene, "slab.") / exact - 1.0).abs();
    println!("{}\nvolume off by {error:.1e}", scene.rock_masses[0]);
    assert!(error < 1e-9);
    // under the rock the failure plane, beside it the slope
    let terrain = scene.terrain.as_ref().unwrap();
    let left = ground(terrain);
    for (place, depth) in [
        ([60.0, -80.0], 30.0),
        ([190.0, 10.0], 30.0),
        ([150.0, 20.0], 0.0),
        ([54.0, 0.0], 0.0),
    ] {
        let z = left.height_under_the_sky(place).unwrap();
        assert!(
            (z + depth - slope(place[0], place[1])).abs() < 1e-9,
            "{place:?} {z}"
        );
    }
}

/// On rough ground, with a failure surface that is a raster and comes out of it, blocks fill what was taken out of the ground: 1e-9.
#[test]
fn rock_between_two_rough_surfaces_keeps_its_volume() {
    let folder = tempfile::tempdir().unwrap();
    valley().write(&folder.path().join("rough.asc"), hummocky);
    // a bowl under the slope that daylights within the outline
    let bowl =
        |x: f64, y: f64| hummocky(x, y) - 45.0 + 0.012 * ((x - 120.0).powi(2) + (y + 20.0).powi(2));
    valley().write(&folder.path().join("bowl.asc"), bowl);
    let outline = "Corners([(31, -128), (222, -131), (231, 87), (40, 91)])";
    let slide = |more: &str| {
        format!(
            "(name: \"bowl\", material: \"rock\", outline: {outline}, failure_surface: Raster(file: \"bowl.asc\"), {JOINTS} {more})"
        )
    };
    let of = |more: &str| {
        let terrain = "(sources: [(file: \"rough.asc\")], tolerance: 0.5)";
        scene(folder.path(), terrain, &slide(more), "").unwrap()
    };
    let plain = of("");
    let rock = plain.terrain.as_ref().unwrap().rock[0].volume;
    // a paraboloid of depth d and radius √(d/a): π d²/(2a); triangles of 10 m take 10²/12 · 4a off its depth
    let exact = std::f64::consts::PI * 45.0 / 0.012 * (0.5 * 45.0 - 100.0 / 12.0 * 4.0 * 0.012);
    println!("{}", plain.rock_masses[0]);
    println!(
        "rock {rock:.1} m3 of {exact:.1}, blocks off by {:.1e}",
        volume(&plain, "bowl.") / rock - 1.0
    );
    assert!((volume(&plain, "bowl.") / rock - 1.0).abs() < 1e-9);
    // the tolerance of 0.5 m leaves out points where that makes less
    assert!((rock / exact - 1.0).abs() < 0.005);
    let merged = of(", merge_slivers: (volume_share: 0.1, aspect: 6)");
    println!("{}", merged.rock_masses[0]);
    assert!((volume(&merged, "bowl.") / rock - 1.0).abs() < 1e-9);
    assert!(merged.blocks.len() < plain.blocks.len());
    // blocks of several parts become convex as far as they may, each for no more than that
    let unions = |scene: &Scene| scene.rock_masses[0].n_unions;
    let mut left = unions(&plain);
    for share in [1e-3, 1e-2, 1e-1] {
        let convex = of(&format!(", convex_within: {share}"));
        println!("{}", convex.rock_masses[0]);
        let gained = volume(&convex, "bowl.") / rock - 1.0;
        assert!((-1e-9..share).contains(&gained), "{gained:e}");
        let report = &convex.rock_masses[0];
        assert_eq!(report.n_unions + report.n_filled, unions(&plain));
        assert!(unions(&convex) < left, "{share}: {}", unions(&convex));
        left = unions(&convex);
    }
    // written out and read again it is the same scene, to the bit
    let text = merged.to_text().unwrap();
    let again = Scene::resolve(parse::read(&text).unwrap(), folder.path()).unwrap();
    let shapes =
        |scene: &Scene| -> Vec<Shape> { scene.blocks.iter().map(|b| b.shape.clone()).collect() };
    assert_eq!(shapes(&merged), shapes(&again));
}

/// A jointed slab on its failure plane: it stands where friction holds it, and slides as one body where it does not,
/// `s = ½ g (sin α − tan φ cos α) t²`.
#[test]
fn a_slab_slides_down_its_scar() {
    let folder = tempfile::tempdir().unwrap();
    let alpha = 40.0_f64.to_radians();
    let slope = |x: f64, _: f64| 300.0 - alpha.tan() * x;
    valley().write(&folder.path().join("plane.asc"), slope);
    let slide = |joints: &str| {
        format!(
            "(name: \"slab\", material: \"rock\", outline: Corners([(60, -40), (160, -40), (160, 40), (60, 40)]), {joints}
              failure_surface: Plane(point: (100, 0, {}), dip_deg: 40, dip_direction_deg: 90))",
            slope(100.0, 0.0) - 25.0
        )
    };
    // open downhill: the ground ends where the slab does
    let terrain = "(sources: [(file: \"plane.asc\")], excavations: [(outline: Corners([(160, -60), (390, -60), (390, 60), (160, 60)]),
                    failure_surface: Plane(point: (100, 0, 191.09), dip_deg: 40, dip_direction_deg: 90))])";
    let merged = format!("{JOINTS}, merge_slivers: (volume_share: 0.2, aspect: 6),");
    for (friction, joints) in [(20.0_f64, merged.as_str()), (20.0, ""), (45.0, &merged)] {
        let further = "numerics: (block_time_step_factor: 0.5)";
        let mut scene = scene(folder.path(), terrain, &slide(joints), further).unwrap();
        for material in &mut scene.materials {
            material.friction_angle = friction.to_radians();
            // a slab of one block sinks in by 1 mm under its weight, one of three layers on joints of 1e9 N/m by 20 cm, on those of
            // 1e10 N/m by 2 cm
            material.contact_stiffness = match friction {
                _ if joints.is_empty() => 1e12,
                20.0 => 1e9,
                _ => 1e10,
            };
        }
        let free: Vec<usize> = (0..scene.blocks.len())
            .filter(|&b| scene.block_names[b].starts_with("slab"))
            .collect();
        let mut world = run::build(&scene).unwrap();
        let center = |world: &riprap::world::World| {
            let mass: f64 = free.iter().map(|&b| world.blocks.mass(b)).sum();
            let moment: Vec3 = free
                .iter()
                .map(|&b| world.blocks.centroid(b) * world.blocks.mass(b))
                .sum();
            moment / mass
        };
        let start = center(&world);
        let end = if friction == 20.0 { 1.5 } else { 0.8 };
        while world.time() < end {
            let step = world.next_step(end).unwrap();
            world.step(step).unwrap();
        }
        let way = (center(&world) - start).norm();
        let expected = 0.5
            * G
            * (alpha.sin() - friction.to_radians().tan() * alpha.cos()).max(0.0)
            * end
            * end;
        println!(
            "{} blocks, {friction} degrees: {way:.4} m of {expected:.4} m",
            free.len()
        );
        // what stands sinks in, as far again as it would at rest
        let sag = if expected == 0.0 { 0.05 } else { 0.0 };
        assert!((way - expected).abs() < 0.02 * expected + sag);
    }
}

/// Water poured into a bowl has the volume between the ground and the level, 0.5 % at 20 rows: the lattice follows slopes in steps.
#[test]
fn water_has_the_volume_of_the_basin() {
    let folder = tempfile::tempdir().unwrap();
    // a paraboloid, 100 m deep at a radius of 120 m
    let bowl = |x: f64, y: f64| 100.0 * ((x - 200.0).powi(2) + y * y) / 120.0_f64.powi(2) - 100.0;
    let raster = Raster {
        cell: 5.0,
        n: [81, 61],
        ..valley()
    };
    raster.write(&folder.path().join("bowl.asc"), bowl);
    let water = "fluid: (resolution: Spacing(5), regions: [(name: \"lake\", shape: Below(level: 0, seed: (200, 0, -50)))])";
    let scene = scene(
        folder.path(),
        "(sources: [(file: \"bowl.asc\")], tolerance: 1e-6)",
        "",
        water,
    )
    .unwrap();
    let plan = [[0.0, -150.0], [400.0, 150.0]];
    let terrain = scene.terrain.as_ref().unwrap();
    let room = room_below(terrain, 0.0, [200.0, 0.0], plan).unwrap();
    let integral = room.volume;
    // of a paraboloid half of its cylinder; triangles of 5 m lie above it by 5²/12 (z_xx + z_yy) in the mean
    let above = 25.0 / 12.0 * 4.0 * 100.0 / 120.0_f64.powi(2);
    let exact = std::f64::consts::PI * 120.0_f64.powi(2) * (0.5 * 100.0 - above);
    let lattice = &scene.fluid.as_ref().unwrap().lattice;
    let poured = lattice.positions.len() as f64 * lattice.spacing.iter().product::<f64>();
    println!(
        "integral {integral:.0} m3 of {exact:.0}; {} particles have {poured:.0} m3, {:+.3} %",
        lattice.positions.len(),
        100.0 * (poured / integral - 1.0)
    );
    // measured 3e-5: the shore cuts triangles anywhere
    assert!((integral / exact - 1.0).abs() < 1e-4);
    assert!((poured / integral - 1.0).abs() < 0.005);
    // the apex is a point of the raster
    assert!((room.depth - 100.0).abs() < 1e-9);
    assert_eq!(room_below(terrain, 0.0, [10.0, 0.0], plan), None);
}

/// A joint that loses its friction in two seconds: the block stands until `tan φ s(t) = tan α`, and then goes with
/// `v̇ = g (sin α − s(t) tan φ cos α)`.
#[test]
fn a_block_goes_when_its_friction_has_fallen() {
    let folder = tempfile::tempdir().unwrap();
    let alpha = 30.0_f64.to_radians();
    valley().write(&folder.path().join("plane.asc"), |x, _| {
        300.0 - alpha.tan() * x
    });
    let at = 300.0 - alpha.tan() * 100.0;
    let text = format!(
        r#"(title: "a block", domain: (min: (0, -150, -100), max: (400, 150, 400)),
            materials: [(name: "rock", density: 2500, friction_angle_deg: 40, contact_stiffness: 1e9)],
            joints: [(between: ("rock", "rock"), friction_ramp: [(0.5, 1), (2.5, 0)])],
            terrain: (sources: [(file: "plane.asc")]),
            blocks: [(name: "ground", material: "rock", motion: Fixed, shape: Terrain),
                     (name: "block", material: "rock", shape: Box(min: (-3, -3, 0), max: (3, 3, 2)),
                      placement: (rotate: (axis: (0, 1, 0), angle_deg: 30), translate: (100, 0, {at})))],
            time: (duration: 2))"#
    );
    let scene = Scene::resolve(parse::read(&text).unwrap(), folder.path()).unwrap();
    let mut world = run::build(&scene).unwrap();
    let share = |t: f64| 1.0 - 0.5 * (t - 0.5);
    let place = world.blocks.centroid(1);
    let limit = alpha.tan() / 40.0_f64.to_radians().tan();
    let start = 0.5 + 2.0 * (1.0 - limit);
    let end = 2.0;
    while world.time() < end {
        let step = world.next_step(end).unwrap();
        world.step(step).unwrap();
        if world.time() < 0.95 * start {
            // its weight sinks it in by 2 mm, and strains its shear springs as much
            assert!((world.blocks.centroid(1) - place).norm() < 0.01);
        }
    }
    // integral of g (sin α − s tan φ cos α) from the start on, s linear: its mean is that of the ends
    let mean = 0.5 * (share(start) + share(end));
    let expected =
        G * (alpha.sin() - mean * 40.0_f64.to_radians().tan() * alpha.cos()) * (end - start);
    let found = world.blocks.velocity(1).norm();
    println!("goes at {start:.3} s; at {end} s {found:.4} m/s of {expected:.4} m/s");
    assert!((found / expected - 1.0).abs() < 0.01);
}

/// Input errors are reported with their location and a remedy.
#[test]
fn wrong_terrain_and_outlines_are_refused_in_words() {
    let folder = tempfile::tempdir().unwrap();
    valley().write(&folder.path().join("rough.asc"), hummocky);
    valley().write(&folder.path().join("holes.asc"), |x, y| {
        if x == 200.0 && y == 0.0 {
            f64::NAN
        } else {
            hummocky(x, y)
        }
    });
    let short = std::fs::read_to_string(folder.path().join("rough.asc")).unwrap();
    let short: Vec<&str> = short.lines().collect();
    std::fs::write(
        folder.path().join("short.asc"),
        short[..short.len() - 1].join("\n"),
    )
    .unwrap();
    let plane = "failure_surface: Plane(point: (100, 0, 100), dip_deg: 40, dip_direction_deg: 90)";
    let slide = |outline: &str, beneath: &str| {
        format!("(name: \"s\", material: \"rock\", outline: Corners([{outline}]), {beneath})")
    };
    let good = "(sources: [(file: \"rough.asc\")])";
    let square = "(60, -40), (160, -40), (160, 40), (60, 40)";
    for (terrain, slides, path, words) in [
        (
            "(sources: [(file: \"holes.asc\")])",
            String::new(),
            "terrain.sources",
            "no source has a height at (200.00, 0.00) m",
        ),
        (
            "(sources: [(file: \"short.asc\")])",
            String::new(),
            "terrain.sources[0].file",
            "has 1230 heights; 41 columns and 31 rows need 1271",
        ),
        (
            "(sources: [(file: \"rough.asc\")], clip: ((0, 0), (500, 100)))",
            String::new(),
            "terrain.sources",
            "no source has a height at (410.00, 0.00)",
        ),
        (
            "(sources: [(file: \"rough.asc\")], spacing: 1e-3)",
            String::new(),
            "terrain.spacing",
            "raise the spacing above 0.001 m",
        ),
        (
            good,
            slide("(60, -40), (460, -40), (160, 40)", plane),
            "slides[0].outline",
            "its corner at (460.00, -40.00) m is not within the terrain",
        ),
        (
            good,
            slide("(60, -40), (160, 40), (160, -40), (60, 20)", plane),
            "slides[0].outline",
            "crosses another side",
        ),
        (
            good,
            slide(
                square,
                "failure_surface: Plane(point: (100, 0, 300), dip_deg: 40, dip_direction_deg: 90)",
            ),
            "slides[0].failure_surface",
            "nowhere below the terrain",
        ),
        (
            good,
            format!(
                "{}, {}",
                slide(square, plane),
                slide(square, plane).replace("\"s\"", "\"t\"")
            ),
            "slides[1].outline",
            "overlaps another outline",
        ),
    ] {
        let problems = scene(folder.path(), terrain, &slides, "").unwrap_err();
        println!("{}: {}", problems[0].path, problems[0].message);
        assert_eq!(problems[0].path, path);
        assert!(
            problems[0].message.contains(words),
            "{}",
            problems[0].message
        );
    }
}

/// Water that gets out of the raster or over all land is refused, with the place on the map.
#[test]
fn basins_that_do_not_hold_are_refused_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let floor = Raster {
        corner: [500_000.0, 6_000_000.0],
        cell: 10.0,
        n: [41, 31],
    };
    // a valley that goes on to the south
    floor.write(&folder.path().join("valley.asc"), |x, y| {
        0.5 * (x - 500_200.0).abs() + 0.5 * (y - 6_000_150.0).max(0.0)
    });
    for (level, words) in [
        (40.0, "leaks out of the domain at ("),
        (40.0, "on the map (0, 0, 0) is (500000, 6000000, 0) m"),
        (500.0, "above the domain"),
        (250.0, "leaks out of the domain at ("),
    ] {
        let text = format!(
            r#"(title: "no basin", domain: (min: (0, 0, -20), max: (400, 300, 300)),
                materials: [(name: "rock", density: 2600, friction_angle_deg: 30)],
                terrain: (sources: [(file: "valley.asc")], origin: (500000, 6000000, 0)),
                blocks: [(name: "ground", material: "rock", motion: Fixed, shape: Terrain)],
                fluid: (resolution: Spacing(5), regions: [(name: "lake", shape: Below(level: {level}, seed: (200, 100, 30)))]),
                time: (duration: 1))"#
        );
        let problems = Scene::resolve(parse::read(&text).unwrap(), folder.path()).unwrap_err();
        println!("{}: {}", problems[0].path, problems[0].message);
        assert!(
            problems[0].message.contains(words),
            "{}",
            problems[0].message
        );
    }
}

/// The scripts make the terrain that is here, and the section's ground and rock, to the letter.
#[test]
fn the_scripts_make_the_terrain_of_the_cases() {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../cases");
    let made = |script: &str, what: &[&str]| {
        let mut command = std::process::Command::new("python3");
        let output = command.arg(cases.join(script)).args(what).output();
        output.map(|output| String::from_utf8(output.stdout).unwrap())
    };
    let text = |file: &str| std::fs::read_to_string(cases.join(file)).unwrap();
    let Ok(fjord) = made("fjord.py", &["grid"]) else {
        println!("skipped: there is no python3");
        return;
    };
    assert_eq!(fjord, text("fjord.asc"));
    assert_eq!(made("reservoir.py", &[]).unwrap(), text("reservoir.asc"));
    let section = made("fjord.py", &["section"]).unwrap();
    let scene = text("slide_section.ron");
    assert!(section.lines().count() > 10);
    for line in section.lines().filter(|line| !line.trim().is_empty()) {
        assert!(scene.contains(line.trim()), "{line}");
    }
}

/// The scene of the README is one.
#[test]
fn the_slope_of_the_readme_is_read() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let readme = std::fs::read_to_string(root.join("README.md")).unwrap();
    let (_, from) = readme.split_once("```ron\n").unwrap();
    let (text, _) = from.split_once("```").unwrap();
    let scene = Scene::resolve(parse::read(text).unwrap(), &root.join("cases")).unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    assert!(scene.rock_masses[0].n_blocks > 50);
    let slide = SlideImpact::of(&scene.terrain.as_ref().unwrap().rock[0], &scene).unwrap();
    // 40 to 50 m of rock over half of the outline's 280 m, 300 m above the water, on 34 degrees with a friction of 20
    assert!((20.0..40.0).contains(&slide.thickness) && (slide.width - 230.0).abs() < 1e-6);
    assert!((slide.slope.to_degrees() - 34.0).abs() < 0.1);
    let expected =
        2.0 * G * 300.0 * (1.0 - 20.0_f64.to_radians().tan() / 34.0_f64.to_radians().tan());
    assert!((slide.speed / expected.sqrt() - 1.0).abs() < 0.05);
}

/// A slope turned by a quarter about z, with its outline, its joints and its failure plane, is cut into the same blocks, which slide
/// as far. Triangles may lie across the other diagonal: volumes are the same to its tolerance.
#[test]
fn a_turned_slope_fails_alike() {
    let folder = tempfile::tempdir().unwrap();
    // 390 m by 390 m about its middle
    let square = Raster {
        corner: [-200.0, -200.0],
        cell: 10.0,
        n: [41, 41],
    };
    let slope = |x: f64, y: f64| -0.8 * x + 3.0 * (x / 37.0).sin() * (y / 29.0).cos();
    square.write(&folder.path().join("east.asc"), slope);
    // what was at (x, y) is at (-y, x)
    square.write(&folder.path().join("north.asc"), |x, y| slope(y, -x));
    let made = |file: &str, turn: f64, corners: &str, point: &str| {
        let slide = format!(
            "(name: \"slide\", material: \"rock\", outline: Corners([{corners}]),
              failure_surface: Plane(point: {point}, dip_deg: 36, dip_direction_deg: {}),
              joint_sets: [(dip_deg: 36, dip_direction_deg: {}, spacing: 15, origin: {point}),
                           (dip_deg: 60, dip_direction_deg: {}, spacing: 22, origin: (0, 0, 0)),
                           (dip_deg: 90, dip_direction_deg: {}, spacing: 19, origin: (0, 0, 0))],
              minimum_volume: 200)",
            90.0 - turn,
            90.0 - turn,
            270.0 - turn,
            360.0 - turn
        );
        let text = format!(
            r#"(title: "a slope", domain: (min: (-190, -190, -250), max: (190, 190, 250)),
                materials: [(name: "rock", density: 2600, friction_angle_deg: 10, contact_stiffness: 1e9)],
                terrain: (sources: [(file: "{file}")], tolerance: 0.001),
                slides: [{slide}],
                blocks: [(name: "ground", material: "rock", motion: Fixed, shape: Terrain)],
                time: (duration: 2))"#
        );
        Scene::resolve(parse::read(&text).unwrap(), folder.path()).unwrap()
    };
    let east = made(
        "east.asc",
        0.0,
        "(-90, -55), (20, -55), (20, 55), (-90, 55)",
        "(20, 0, -26)",
    );
    let north = made(
        "north.asc",
        90.0,
        "(55, -90), (55, 20), (-55, 20), (-55, -90)",
        "(0, 20, -26)",
    );
    let volume = |scene: &Scene| scene.terrain.as_ref().unwrap().rock[0].volume;
    let off = volume(&north) / volume(&east) - 1.0;
    println!(
        "{} and {} blocks, volume off by {off:.1e}",
        east.rock_masses[0].n_blocks, north.rock_masses[0].n_blocks
    );
    assert!(off.abs() < 1e-4);
    assert_eq!(east.rock_masses[0].n_blocks, north.rock_masses[0].n_blocks);
    let ways = [east, north].map(|scene| {
        let mut world = run::build(&scene).unwrap();
        let free: Vec<usize> = (0..scene.blocks.len())
            .filter(|&b| world.blocks.is_free(b))
            .collect();
        let center = |world: &riprap::world::World| {
            let mass: f64 = free.iter().map(|&b| world.blocks.mass(b)).sum();
            let moments = free
                .iter()
                .map(|&b| world.blocks.centroid(b) * world.blocks.mass(b));
            moments.sum::<Vec3>() / mass
        };
        let start = center(&world);
        while world.time() < 0.3 {
            let step = world.next_step(0.3).unwrap();
            world.step(step).unwrap();
        }
        center(&world) - start
    });
    let turned = Vec3::new(-ways[0].y, ways[0].x, ways[0].z);
    println!("{:.4?} and {:.4?}", ways[0], ways[1]);
    // of a way of some meters: triangles of rough ground differ by 1 mm
    assert!((ways[1] - turned).norm() < 0.01 * ways[0].norm());
}

/// Feet for meters and degrees for both are asked about.
#[test]
fn implausible_terrain_is_questioned() {
    let folder = tempfile::tempdir().unwrap();
    let asked = |raster: Raster, height: &dyn Fn(f64, f64) -> f64, origin: &str| -> Vec<String> {
        raster.write(&folder.path().join("odd.asc"), height);
        let terrain = format!("(sources: [(file: \"odd.asc\")], origin: {origin})");
        let terrain = terrain_of(folder.path(), &terrain).unwrap();
        terrain.warnings.iter().map(|q| q.message.clone()).collect()
    };
    let none = asked(valley(), &hummocky, "(0, 0, 0)");
    assert!(none.is_empty(), "{none:?}");
    let feet = asked(valley(), &|x, y| hummocky(x, y) / 0.3048, "(0, 0, 0)");
    assert!(
        feet[0].contains("steeper than 70 degrees: are heights in feet"),
        "{feet:?}"
    );
    let plan = Raster {
        cell: 10.0 / 0.3048,
        ..valley()
    };
    let plan = asked(plan, &|x, _| -0.5 * x, "(0, 0, 0)");
    assert!(plan[0].contains("10 m in feet"), "{plan:?}");
    let degrees = Raster {
        corner: [7.0, 62.0],
        cell: 0.001,
        n: [41, 31],
    };
    let degrees = asked(degrees, &|x, _| 1000.0 * (x - 7.0), "(0, 0, 0)");
    assert!(degrees[0].contains("degrees of longitude"), "{degrees:?}");
    let undeclared = asked(
        valley(),
        &|x, y| if x == 0.0 { -32768.0 } else { hummocky(x, y) },
        "(0, 0, 0)",
    );
    assert!(undeclared[0].contains("NODATA_value"), "{undeclared:?}");
}

/// A tank of 1 m by 0.1 m on a flat raster of a map, 50 m above its zero.
fn tank(folder: &Path, region: &str, further: &str) -> PathBuf {
    let floor = Raster {
        corner: [499_999.5, 5_999_999.5],
        cell: 0.1,
        n: [21, 12],
    };
    floor.write(&folder.join("floor.asc"), |_, _| 50.0);
    let text = format!(
        r#"(title: "a tank on a map", domain: (min: (0, 0, -0.2), max: (1, 0.1, 0.7), periodic: [Y]),
            materials: [(name: "wall", density: 2500, friction_angle_deg: 30)],
            terrain: (sources: [(file: "floor.asc")], origin: (500000, 6000000, 50)),
            blocks: [(name: "floor", material: "wall", motion: Fixed, shape: Terrain),
                     (name: "west", material: "wall", motion: Fixed, shape: Box(min: (-0.2, -0.1, -0.2), max: (0, 0.2, 0.7))),
                     (name: "east", material: "wall", motion: Fixed, shape: Box(min: (1, -0.1, -0.2), max: (1.2, 0.2, 0.7)))],
            fluid: (resolution: Spacing(0.02), regions: [{region}]),
            {further})"#
    );
    let path = folder.join("tank.ron");
    std::fs::write(&path, text).unwrap();
    path
}

/// Highest water and first arrival of a standing wave `η = a cos kx sin ωt` over its first three quarters: `a |cos kx|`, and
/// `asin(threshold/(a cos kx))/ω`; grids in coordinates of the map.
#[test]
fn maps_show_how_high_and_when() {
    let folder = tempfile::tempdir().unwrap();
    let region = "(name: \"water\", shape: Box(min: (0, 0, 0), max: (1, 0.1, 0.4)),
                   flow: StandingWave(height: 0.04, length: 2, depth: 0.4, crest: 0))";
    let further =
        "time: (duration: 0.95), maps: (interval: 0.02, spacing: 0.05, arrival_threshold: 0.005)";
    let case = tank(folder.path(), region, further);
    let run_folder = folder.path().join("run");
    support::run(&case, &run_folder, &[]);
    let read = |name: &str| {
        let text = std::fs::read(run_folder.join(format!("{name}.asc"))).unwrap();
        riprap::scene::raster::grid_from(&text).unwrap()
    };
    let (highest, arrival) = (read("maximum_elevation"), read("first_arrival"));
    assert_eq!(highest.n, [20, 2]);
    let corner = [500_000.025, 6_000_000.025];
    assert!((0..2).all(|axis| (highest.corner[axis] - corner[axis]).abs() < 1e-6));
    let (a, k) = (0.02, std::f64::consts::PI);
    let omega = (G * k * (k * 0.4).tanh()).sqrt();
    let mut worst: f64 = 0.0;
    for i in 0..20 {
        let x = 0.025 + 0.05 * f64::from(i);
        let rise = highest.heights[i as usize] - 50.4;
        worst = worst.max((rise - a * (k * x).cos().abs()).abs());
    }
    println!("highest water off by {:.2} a at most", worst / a);
    // a is one spacing: the surface is known to some tenths of it
    assert!(worst < 0.3 * a);
    let expected = (0.005 / (a * (k * 0.025).cos())).asin() / omega;
    println!(
        "arrives at {} s, by theory {expected:.3} s",
        arrival.heights[0]
    );
    assert!((0.0..0.041).contains(&(arrival.heights[0] - expected)));
    let maps = riprap::vtk::read(&run_folder.join("maps.vtp")).unwrap();
    assert_eq!((maps.points.len(), maps.polygons.offsets.len()), (40, 19));
    assert_eq!(maps.point_data.len(), 3);
}

/// The volume that crosses a line is the final volume beyond it, to the particle. The line extends past the ends of the period:
/// until the next neighbor search particles may be past them.
#[test]
fn what_has_overtopped_is_beyond_the_line() {
    let folder = tempfile::tempdir().unwrap();
    let region = "(name: \"column\", shape: Box(min: (0, 0, 0), max: (0.3, 0.1, 0.4)))";
    let further = "time: (duration: 0.4), output: (gauge_interval: 0.01),
                   gauges: [Overtopping(name: \"line\", from: (0.5, -0.05), to: (0.5, 0.15)),
                            Overtopping(name: \"back\", from: (0.5, 0.15), to: (0.5, -0.05))]";
    let case = tank(folder.path(), region, further);
    let (scene, _) = riprap::scene::load(&case, &[]).unwrap();
    let mut world = run::build(&scene).unwrap();
    let mut gauges = Gauges::new(folder.path(), &scene, &world, Start::New).unwrap();
    while world.time() < 0.4 {
        if gauges.is_due(&world) {
            gauges.observe(&world).unwrap();
        }
        let step = world.next_step(0.4).unwrap();
        world.step(step).unwrap();
    }
    gauges.observe(&world).unwrap();
    let rows = support::table(&folder.path().join("gauges.csv"));
    let last = rows.last().unwrap();
    let fluid = &world.water.as_ref().unwrap().fluid;
    let beyond = fluid
        .particles()
        .position
        .iter()
        .filter(|x| 0.5 < x.x)
        .count() as f64;
    println!(
        "{:.6} m3 have passed, {beyond} particles are beyond",
        last[1]
    );
    assert!(beyond > 100.0 && (last[1] / (beyond * fluid.particle_volume()) - 1.0).abs() < 1e-9);
    assert_eq!(last[1], -last[3]);
    // the discharge is what the volume grew by
    let summed: f64 = rows.windows(2).map(|r| r[1][2] * (r[1][0] - r[0][0])).sum();
    assert!((summed / last[1] - 1.0).abs() < 1e-9);
}
