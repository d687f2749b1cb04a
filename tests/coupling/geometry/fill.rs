//! Basins and boxes of water.

use proptest::prelude::*;
use riprap::scene::error::{Problem, Severity};
use riprap::scene::file::{
    Axis, DimensionsFile, DomainFile, FluidFile, GrainExchangeFile, LatticeFile, OutOfDomainFile,
    RegionFile, RegionShapeFile, ResolutionFile, Triple,
};
use riprap::scene::fill::{Lattice, lattice, narrow_gaps, overlaps};
use riprap_dda::{Isometry, Motion, Polyhedron, Shape, Vec3};
use riprap_sph::Dimensions;

type Solids = Vec<(String, Shape)>;

fn domain(min: Triple, max: Triple, periodic: &[Axis]) -> DomainFile {
    DomainFile {
        min,
        max,
        periodic: periodic.to_vec(),
        symmetry: Vec::new(),
        leaving: OutOfDomainFile::Remove,
        dimensions: DimensionsFile::Three,
    }
}

fn fluid(regions: &[(&str, RegionShapeFile)], resolution: ResolutionFile) -> FluidFile {
    FluidFile {
        density: 1000.0,
        dynamic_viscosity: Some(1.0),
        lattice: LatticeFile::Cubic,
        rheology: None,
        resolution,
        grains: GrainExchangeFile::default(),
        regions: regions
            .iter()
            .map(|(name, shape)| RegionFile {
                name: (*name).into(),
                shape: shape.clone(),
                velocity: (0.0, 0.0, 0.0),
                flow: None,
                rheology: None,
            })
            .collect(),
    }
}

fn cuboid(name: &str, min: [f64; 3], max: [f64; 3]) -> (String, Shape) {
    let solid = Polyhedron::cuboid(min.into(), max.into()).unwrap();
    (name.into(), Shape::Polyhedra(vec![solid]))
}

/// Walls 0.1 m thick around 2 m × 1 m, 1 m high, and a floor.
fn tank() -> Solids {
    vec![
        cuboid("floor", [-0.1, -0.1, -0.1], [2.1, 1.1, 0.0]),
        cuboid("west", [-0.1, -0.1, 0.0], [0.0, 1.1, 1.0]),
        cuboid("east", [2.0, -0.1, 0.0], [2.1, 1.1, 1.0]),
        cuboid("south", [0.0, -0.1, 0.0], [2.0, 0.0, 1.0]),
        cuboid("north", [0.0, 1.0, 0.0], [2.0, 1.1, 1.0]),
    ]
}

fn tank_domain() -> DomainFile {
    domain((-0.2, -0.2, -0.2), (2.2, 1.2, 1.2), &[])
}

fn below(level: f64, seed: Triple) -> RegionShapeFile {
    RegionShapeFile::Below { level, seed }
}

fn volume(lattice: &Lattice) -> f64 {
    lattice.positions.len() as f64 * lattice.particle_volume()
}

fn nearest(lattice: &Lattice, solids: &Solids) -> f64 {
    lattice
        .positions
        .iter()
        .flat_map(|x| solids.iter().map(|(_, s)| s.signed_distance(x).distance))
        .fold(f64::INFINITY, f64::min)
}

fn message(found: Result<Lattice, Vec<Problem>>) -> String {
    let problems = found.unwrap_err();
    assert!(problems.iter().all(|p| p.severity == Severity::Error));
    format!("{}: {}", problems[0].path, problems[0].message)
}

#[test]
fn a_tank_of_whole_spacings_fills_exactly() {
    let lake = [("lake", below(0.8, (1.0, 0.5, 0.4)))];
    for (spacing, expected) in [(0.1, 20 * 10 * 8), (0.05, 40 * 20 * 16)] {
        let water = fluid(&lake, ResolutionFile::Spacing(spacing));
        let found = lattice(&water, &tank_domain(), &tank(), 0).unwrap();
        assert_eq!(found.positions.len(), expected);
        assert_eq!(found.region, vec![0; expected]);
        assert!((volume(&found) - 1.6).abs() < 1e-12);
        assert!((found.depth - 0.8).abs() < 1e-12);
        assert_eq!(found.still_water_level, 0.8);
        assert!(nearest(&found, &tank()) >= 0.499 * spacing);
    }
}

/// 0.37 m take four rows of 0.0925 m.
#[test]
fn a_box_is_filled_by_whole_rows_that_are_stretched() {
    let corners = RegionShapeFile::Box {
        min: (0.0, 0.0, 0.0),
        max: (1.0, 0.5, 0.37),
    };
    let water = fluid(&[("dam", corners)], ResolutionFile::Spacing(0.1));
    let found = lattice(&water, &tank_domain(), &tank(), 0).unwrap();
    assert_eq!(found.positions.len(), 10 * 5 * 4);
    assert!((volume(&found) / (1.0 * 0.5 * 0.37) - 1.0).abs() < 1e-12);
    let heights = found.positions.iter().map(|x| x.z);
    let (low, high) = heights.fold((f64::INFINITY, 0.0_f64), |(a, b), z| (a.min(z), b.max(z)));
    assert!((low - 0.5 * 0.0925).abs() < 1e-12 && (high + low - 0.37).abs() < 1e-12);
}

/// A beach of slope 1:2 from the toe at x = 1 m, water 0.4 m deep, 1 m wide.
#[test]
fn a_sloped_basin_fills_to_its_wedge() {
    let mut solids = tank();
    let beach = Polyhedron::extrusion(&[[1.0, 0.0], [2.0, 0.0], [2.0, 0.5]], 1, 0.0, 1.0).unwrap();
    solids.push(("beach".into(), Shape::Polyhedra(beach)));
    // 1 m of flat floor and a wedge of 0.8 m × 0.4 m / 2
    let exact = 1.0 * 0.4 + 0.8 * 0.4 / 2.0;
    let wetted_slope = 0.8_f64.hypot(0.4);
    for spacing in [0.05, 0.025, 0.0125] {
        let lake = [("lake", below(0.4, (0.5, 0.5, 0.2)))];
        let water = fluid(&lake, ResolutionFile::Spacing(spacing));
        let found = lattice(&water, &tank_domain(), &solids, 0).unwrap();
        assert!(nearest(&found, &solids) >= 0.499 * spacing);
        // a node half a spacing from the slope stands for a layer between half and one and a half
        // spacings from it: the layer error is below half a spacing over the slope, beside it the
        // flat sides fit
        let missing = exact - found.positions.len() as f64 * spacing.powi(3);
        let layer = 0.5 * spacing * wetted_slope;
        assert!(missing.abs() <= layer, "{spacing}: {missing} of {layer}");
    }
}

#[test]
fn a_periodic_slab_closes_on_itself() {
    // 0.33 m take 3 spacings of 0.11 m
    let slab = domain((-0.2, 0.2, -0.2), (2.2, 0.53, 1.2), &[Axis::Y]);
    let lake = [("lake", below(0.8, (1.0, 0.4, 0.4)))];
    let water = fluid(&lake, ResolutionFile::Spacing(0.1));
    let found = lattice(&water, &slab, &tank(), 0).unwrap();
    assert_eq!(found.positions.len(), 20 * 3 * 8);
    assert!((found.spacing[1] - 0.11).abs() < 1e-15);
    assert!(
        (found.particle_spacing(Dimensions::Three) - (0.1 * 0.11 * 0.1_f64).cbrt()).abs() < 1e-15
    );
    // the last row and the first, a period on, are one spacing apart
    let (first, last) = found
        .positions
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
            (a.min(x.y), b.max(x.y))
        });
    assert!((first + 0.33 - last - 0.11).abs() < 1e-12);
}

#[test]
fn a_leak_names_its_place() {
    let mut solids = tank();
    solids.retain(|(name, _)| name != "north");
    let lake = [("lake", below(0.8, (1.0, 0.5, 0.4)))];
    let water = fluid(&lake, ResolutionFile::Spacing(0.1));
    let text = message(lattice(&water, &tank_domain(), &solids, 0));
    let start = "fluid.regions[0].shape: fluid region `lake` leaks out of the domain at (";
    assert!(text.starts_with(start), "{text}");
    assert!(text.contains("blocks must close the basin"), "{text}");
    // the last node before the domain's north face
    assert!(text.contains(", 1.150, "), "{text}");
}

/// Plates of 0.2 and of 0.0005 spacings, anywhere between two rows and on them, also where a
/// periodic direction has stretched the lattice.
#[test]
fn a_thin_plate_parts_two_basins() {
    let lake = [("lake", below(0.8, (0.5, 0.3, 0.4)))];
    let water = fluid(&lake, ResolutionFile::Spacing(0.1));
    for thickness in [0.02, 5e-5] {
        for shift in 0..21 {
            let x = 1.0 + 0.005 * f64::from(shift);
            let mut solids = tank();
            solids.push(cuboid("plate", [x, 0.0, 0.0], [x + thickness, 1.0, 1.0]));
            let found = lattice(&water, &tank_domain(), &solids, 0).unwrap();
            let farthest = found.positions.iter().fold(0.0, |far: f64, p| far.max(p.x));
            assert!(farthest < x, "plate at {x}, water to {farthest}");
        }
    }
    // one row of 0.14 m across: half a spacing of clearance leaves 0.04 m unseen
    for shift in 0..15 {
        let y = 0.5 + 0.01 * f64::from(shift);
        let slab = domain((-0.2, 0.2, -0.2), (2.2, 0.76, 1.2), &[Axis::X]);
        let mut solids = tank();
        solids.push(cuboid("plate", [-1.0, y, -1.0], [3.0, y + 0.01, 1.3]));
        solids.push(cuboid("near", [-1.0, 0.1, -1.0], [3.0, 0.2, 1.3]));
        let found = lattice(&water, &slab, &solids, 0).unwrap();
        assert!(found.positions.iter().all(|p| p.y < y), "plate at {y}");
    }
}

#[test]
fn a_wanted_count_is_met() {
    let mut solids = tank();
    let beach = Polyhedron::extrusion(&[[1.0, 0.0], [2.0, 0.0], [2.0, 0.5]], 1, 0.0, 1.0).unwrap();
    solids.push(("beach".into(), Shape::Polyhedra(beach)));
    // measured 0.8 %, 0.8 %, 0.8 %, 1.1 %: whole rows along three walls allow no better
    for (count, tolerance) in [(500, 0.02), (3000, 0.02), (20_000, 0.01), (100_000, 0.015)] {
        let lake = [("lake", below(0.43, (0.5, 0.5, 0.2)))];
        let water = fluid(&lake, ResolutionFile::Count(count));
        let found = lattice(&water, &tank_domain(), &solids, 0).unwrap();
        let share = found.positions.len() as f64 / f64::from(count) - 1.0;
        println!("{count} wanted, {} found", found.positions.len());
        assert!(share.abs() <= tolerance, "{count}: off by {share}");
    }
}

#[test]
fn what_cannot_be_filled_says_why() {
    let water = |shape| fluid(&[("lake", shape)], ResolutionFile::Spacing(0.1));
    let box_of = |min, max| RegionShapeFile::Box { min, max };
    let cases = [
        (
            below(0.8, (1.0, 0.5, 0.9)),
            "fluid.regions[0].shape.seed: fluid region `lake` has its seed [1.0, 0.5, 0.9] m above the level or out of the domain",
        ),
        (
            below(0.8, (1.0, 0.5, -0.05)),
            "fluid.regions[0].shape.seed: fluid region `lake` has its seed [1.0, 0.5, -0.05] m inside block `floor`; move it into the water",
        ),
        (
            below(1.3, (1.0, 0.5, 0.5)),
            "fluid.regions[0].shape.level: fluid region `lake` has its level, 1.3 m, above the domain",
        ),
        (
            // the deepest node stands at x = -0.05, which is 0.05 m from both sides of the wall;
            // in the floor too, but the box begins above it
            box_of((-0.1, 0.0, 0.0), (1.0, 0.5, 0.3)),
            "fluid.regions[0].shape: fluid region `lake` overlaps block `west` by 0.050 m",
        ),
    ];
    for (shape, expected) in cases {
        let text = message(lattice(&water(shape), &tank_domain(), &tank(), 0));
        assert!(text.starts_with(expected), "{text}");
    }
    let huge = fluid(
        &[("lake", below(0.8, (1.0, 0.5, 0.4)))],
        ResolutionFile::Spacing(1e-4),
    );
    let text = message(lattice(&huge, &tank_domain(), &tank(), 0));
    assert!(
        text.contains("needs 3.4e12 lattice nodes, more than 5.0e7"),
        "{text}"
    );
}

#[test]
fn regions_may_adjoin_but_not_overlap() {
    let dam = |from: f64| RegionShapeFile::Box {
        min: (from, 0.0, 0.0),
        max: (from + 0.5, 1.0, 0.8),
    };
    let pair = |from| {
        let regions = [("left", dam(0.0)), ("right", dam(from))];
        let water = fluid(&regions, ResolutionFile::Spacing(0.1));
        lattice(&water, &tank_domain(), &tank(), 0)
    };
    let found = pair(0.5).unwrap();
    assert_eq!(found.positions.len(), 2 * 5 * 10 * 8);
    assert_eq!(found.region.iter().sum::<u32>(), 5 * 10 * 8);
    let text = message(pair(0.45));
    let start = "fluid.regions[1].shape: fluid region `right` overlaps fluid region `left` at (";
    assert!(text.starts_with(start), "{text}");
}

#[test]
fn blocks_that_overlap_are_reported_by_depth() {
    let pair = |shift: f64| {
        let mut solids = tank();
        solids.push(cuboid("stone", [0.5, 0.5, -shift], [0.7, 0.7, 0.2 - shift]));
        let mut motions = vec![Motion::Fixed; 5];
        motions.push(Motion::Free);
        overlaps(&solids, &motions)
    };
    // 1 % of 0.2 m is 0.002 m
    assert_eq!(pair(0.0), []);
    assert_eq!(pair(1e-8), []);
    assert_eq!(pair(1e-4)[0].severity, Severity::Warning);
    let found = pair(0.003);
    assert_eq!(found.len(), 1);
    assert_eq!(
        found[0].message,
        "block `stone` overlaps block `floor` by 3.000e-3 m, 1.50 % of the smaller size, near (0.600, 0.600, -0.002) m; \
         allowed are 1 %: move them apart"
    );
    assert_eq!(found[0].path, "blocks[5].placement");
}

/// No corner of one is inside the other; only their edges and faces pass through each other.
#[test]
fn crossing_bars_overlap() {
    let solids = vec![
        cuboid("along", [-1.0, -0.1, -0.1], [1.0, 0.1, 0.1]),
        cuboid("across", [-0.1, -1.0, 0.05], [0.1, 1.0, 0.25]),
    ];
    let found = overlaps(&solids, &[Motion::Free, Motion::Free]);
    assert_eq!(found.len(), 1);
    assert!(found[0].message.contains("by 5.000e-2 m"), "{found:?}");
    assert_eq!(overlaps(&solids, &[Motion::Fixed, Motion::Fixed]), []);
}

/// A million nodes among a hundred blocks, a fifth of them spheres.
#[test]
fn a_million_nodes_among_a_hundred_blocks() {
    let mut solids = tank();
    for k in 0..100 {
        let (i, j) = (f64::from(k % 20), f64::from(k / 20));
        let corner = [0.05 + 0.09 * i, 0.1 + 0.17 * j, 0.1 + 0.1 * j];
        let far = corner.map(|x| x + 0.06);
        solids.push(if k % 5 == 0 {
            let center = (Vec3::from(corner) + Vec3::from(far)) / 2.0;
            (
                format!("ball {k}"),
                Shape::Sphere {
                    center,
                    radius: 0.03,
                },
            )
        } else {
            cuboid(&format!("stone {k}"), corner, far)
        });
    }
    let lake = [("lake", below(0.9, (0.02, 0.02, 0.8)))];
    let water = fluid(&lake, ResolutionFile::Spacing(0.0125));
    let found = lattice(&water, &tank_domain(), &solids, 0).unwrap();
    println!("{} particles of 1.9e6 nodes", found.positions.len());
    let stones: f64 = solids[5..].iter().map(|(_, s)| s.volume()).sum();
    let own = found.positions.len() as f64 * 0.0125_f64.powi(3);
    let missing = (1.8 - stones - own) / 1.8;
    // measured 0.006: half a layer on the stones' surfaces
    assert!((0.0..0.02).contains(&missing), "{missing}");
    // particles share it; lines a quarter of a cell apart measure the balls
    assert!(
        (volume(&found) / (1.8 - stones) - 1.0).abs() < 1e-3,
        "{}",
        volume(&found)
    );
}

#[test]
fn a_flat_box_without_end_is_found_empty_at_once() {
    let shape = RegionShapeFile::Box {
        min: (0.0, 0.0, 0.0),
        max: (0.01, 1.0, 1e300),
    };
    let water = fluid(&[("sheet", shape)], ResolutionFile::Spacing(0.1));
    assert!(message(lattice(&water, &tank_domain(), &tank(), 0)).contains("no particle fits"));
}

fn triple() -> impl Strategy<Value = Triple> {
    (-2.0..2.0, -2.0..2.0, -2.0..2.0)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever the boxes: water or a reason, and never a particle in a block.
    #[test]
    fn any_boxes_give_water_or_a_reason(
        (a, b, c, d) in (triple(), triple(), triple(), triple()),
        seed in triple(),
        level in -2.0..2.0,
        spacing in 0.08..1.0,
        is_periodic: bool,
        is_box: bool,
    ) {
        let axes: &[Axis] = if is_periodic { &[Axis::Y] } else { &[] };
        let room = domain((-2.0, -2.0, -2.0), (2.0, 2.0, 2.0), axes);
        let shape = if is_box {
            RegionShapeFile::Box { min: a, max: b }
        } else {
            below(level, seed)
        };
        let mut solids = vec![cuboid("floor", [-2.5, -2.5, -2.5], [2.5, 2.5, -1.5])];
        if let Ok(stone) = Polyhedron::cuboid(Vec3::new(c.0, c.1, c.2), Vec3::new(d.0, d.1, d.2)) {
            solids.push(("stone".into(), Shape::Polyhedra(vec![stone])));
        }
        let water = fluid(&[("lake", shape)], ResolutionFile::Spacing(spacing));
        match lattice(&water, &room, &solids, 0) {
            Ok(found) => {
                prop_assert_eq!(found.positions.len(), found.region.len());
                prop_assert!(nearest(&found, &solids) >= -0.0501 * spacing);
            }
            Err(problems) => prop_assert!(!problems.is_empty()),
        }
    }

    /// Numbers that validation would have refused still make no panic.
    #[test]
    fn wild_numbers_make_no_panic(level: f64, spacing: f64, x: f64, y: f64, z: f64, count in 1_u32..200) {
        for resolution in [ResolutionFile::Spacing(spacing), ResolutionFile::Count(count)] {
            let regions = [
                ("lake", below(level, (x, y, z))),
                ("dam", RegionShapeFile::Box { min: (0.0, 0.0, 0.0), max: (x, y, z) }),
            ];
            let _ = lattice(&fluid(&regions, resolution), &tank_domain(), &tank(), 0);
        }
    }
}

#[test]
fn what_is_to_be_packed_has_the_volume_of_the_basin() {
    // a cube of 0.4 m turned askew, all under water: 64 l of 1600 l, and no face along the lattice
    let turn = Isometry::new(Vec3::new(1.0, 0.5, 0.4), Vec3::new(0.4, -0.3, 0.2));
    let block = Polyhedron::cuboid(Vec3::repeat(-0.2), Vec3::repeat(0.2)).unwrap();
    let mut solids = tank();
    solids.push((
        "block".into(),
        Shape::Polyhedra(vec![block.transformed(&turn)]),
    ));
    let shape = below(0.8, (0.1, 0.1, 0.1));
    let water = fluid(&[("lake", shape)], ResolutionFile::Spacing(0.05));
    let exact = 2.0 * 1.0 * 0.8 - 0.064;
    let plain = lattice(&water, &tank_domain(), &solids, 0).unwrap();
    let packed = lattice(&water, &tank_domain(), &solids, 4).unwrap();
    // half a spacing off 6 x 0.16 m2 are 24 l, 1.6 %; lattice points outside a convex body scatter by about the
    // root of those within a spacing of it, 20 of 12,000
    let own = |found: &Lattice| found.positions.len() as f64 * 0.05_f64.powi(3);
    assert!(own(&plain) / exact - 1.0 < -0.01, "{}", own(&plain));
    assert!(
        (own(&packed) / exact - 1.0).abs() < 2e-3,
        "{}",
        own(&packed)
    );
    // particles share the rest; lines a quarter of a cell apart measure the block within 1e-4
    assert!(
        (volume(&packed) / exact - 1.0).abs() < 1e-4,
        "{}",
        volume(&packed)
    );
    // the mould: four whole layers of the tank, which ends above it
    assert!(plain.mould.is_empty());
    assert!(packed.mould.iter().all(|x| 0.8 < x.z && x.z < 1.0));
    assert_eq!(packed.mould.len(), 4 * 40 * 20);
}

/// Distance and number of the nearest neighbors of a close packing: 12 in space, at `2^(1/6)` spacings of the cubic lattice
/// of the same volume, and 6 in a plane, at `(4/3)^(1/4)`.
#[test]
fn a_staggered_lattice_is_the_densest() {
    let planes = [DimensionsFile::Three, DimensionsFile::Two];
    for (dimensions, (neighbors, distance)) in planes.into_iter().zip([
        (12, 2.0_f64.powf(1.0 / 6.0)),
        (6, (4.0_f64 / 3.0).powf(0.25)),
    ]) {
        let spacing = 0.05;
        let mut water = fluid(
            &[("lake", below(0.8, (1.0, 0.5, 0.4)))],
            ResolutionFile::Spacing(spacing),
        );
        water.lattice = LatticeFile::Staggered;
        let mut domain = tank_domain();
        domain.dimensions = dimensions;
        let packed = lattice(&water, &domain, &tank(), 4).unwrap();
        let distance = distance * spacing;
        // those that have all of their neighbors in the tank
        let inner = packed.positions.iter().filter(|x| {
            (0.2..1.8).contains(&x.x)
                && (0.2..0.6).contains(&x.z)
                && (dimensions == DimensionsFile::Two || (0.2..0.8).contains(&x.y))
        });
        let mut n = 0;
        for x in inner {
            n += 1;
            let apart = packed.positions.iter().map(|y| (y - x).norm());
            let near: Vec<f64> = apart.filter(|d| 0.0 < *d && *d < 1.2 * distance).collect();
            assert_eq!(near.len(), neighbors, "at {x:?}");
            // the digits of places
            assert!(near.iter().all(|d| (d / distance - 1.0).abs() < 1e-9));
        }
        assert!(200 < n, "{n}");
        // as of a cubic one; in the plane layers of 0.0465 m make 0.4 % of 0.8 m
        let width = if dimensions == DimensionsFile::Two {
            1.4
        } else {
            1.0
        };
        let off = volume(&packed) / (2.0 * width * 0.8) - 1.0;
        assert!(off.abs() < 0.02, "{off}");
    }
}

#[test]
fn a_gap_of_less_than_two_spacings_is_warned_of() {
    let warned = |gap: f64, spacing: f64| {
        let mut solids = tank();
        solids.push(cuboid("one", [0.8, 0.2, 0.0], [1.0, 0.8, 0.5]));
        solids.push(cuboid("two", [1.0 + gap, 0.2, 0.0], [1.5, 0.8, 0.5]));
        let lake = [("lake", below(0.8, (0.1, 0.1, 0.1)))];
        let water = fluid(&lake, ResolutionFile::Spacing(spacing));
        let found = lattice(&water, &tank_domain(), &solids, 0).unwrap();
        narrow_gaps(&solids, &found, DimensionsFile::Three).map(|problem| problem.message)
    };
    let text = warned(0.09, 0.05).unwrap();
    let start = "the gap of 0.090 m between blocks `one` and `two` below the water level is narrower than two \
                 spacings of 0.050 m";
    assert!(text.starts_with(start), "{text}");
    assert!(text.ends_with("refine to 0.045 m"), "{text}");
    // two spacings, and blocks that touch
    assert_eq!(warned(0.1, 0.05), None);
    assert_eq!(warned(0.0, 0.05), None);
}
