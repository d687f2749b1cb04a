//! Valleys as rough as surveys are: every one starts, and its slide comes down.

use super::*;
use riprap::world::World;
use riprap_dda::Random;

/// A slope with noise, and the slide that leaves it.
struct Valley {
    text: String,
    name: String,
}

/// Smooth noise of octaves that halve in length and height, of a height (m) over a length (m).
fn fractal(random: &mut Random, height: f64, length: f64) -> impl Fn(f64, f64) -> f64 + use<> {
    let waves: Vec<[f64; 4]> = (0..5)
        .flat_map(|octave| {
            let scale = 2.0_f64.powi(octave);
            (0..4)
                .map(|_| {
                    let turn = std::f64::consts::TAU * random.uniform();
                    let k = std::f64::consts::TAU * scale / length;
                    let phase = std::f64::consts::TAU * random.uniform();
                    [k * turn.cos(), k * turn.sin(), phase, height / scale / 2.0]
                })
                .collect::<Vec<_>>()
        })
        .collect();
    move |x, y| {
        let of = |[a, b, phase, height]: &[f64; 4]| height * (a * x + b * y + phase).sin();
        waves.iter().map(of).sum()
    }
}

/// Valley number k: cells of 2 to 30 m, white or fractal noise of 0.1 to 3 m, three joint sets, map offsets, a steep scar. The
/// failure plane has the dip of the slope and lies a few cells below it; heights scale with the cells.
///
/// With a lake the valley is closed, three cells deep, and the slide runs into it.
fn rough_valley(folder: &Path, k: u64, has_lake: bool) -> Valley {
    let mut random = Random::new(1000 + k);
    let cell = [2.0, 5.0, 10.0, 20.0, 30.0][k as usize % 5];
    let noise = f64::min([0.1, 0.3, 1.0, 3.0][(k / 5) as usize % 4], 0.15 * cell);
    let offset = [412_000.0, 6_904_000.0];
    let raster = Raster {
        corner: [offset[0] - 30.0 * cell, offset[1] - 20.0 * cell],
        cell,
        n: [61, 41],
    };
    let dip = 30.0 + 10.0 * random.uniform();
    let steepness = f64::to_radians(dip).tan();
    let is_white = k.is_multiple_of(2);
    let waves = fractal(&mut random, noise, 20.0 * cell);
    let white: Vec<f64> = (0..61 * 41)
        .map(|_| noise * (random.uniform() + random.uniform() + random.uniform() - 1.5) * 2.0)
        .collect();
    let height = |x: f64, y: f64| {
        let (x, y) = (x - offset[0], y - offset[1]);
        let (i, j) = ((x / cell + 30.0).round(), (y / cell + 20.0).round());
        let rough = if is_white {
            white[(j * 61.0 + i) as usize]
        } else {
            waves(x, y)
        };
        let slope = -steepness * (x + 5.0 * cell);
        let ground = if has_lake {
            // level ground between it and three banks
            let banks = f64::max(x - 15.0 * cell, y.abs() - 10.0 * cell);
            slope.max(0.0).max(banks)
        } else {
            // level ground, on which it runs out
            slope.max(-0.02 * x)
        };
        ground + rough
    };
    let name = format!("valley{k}.asc");
    raster.write(&folder.join(&name), height);
    let l = cell;
    let (left, right, half) = (-26.0 * l, -12.0 * l, 4.5 * l);
    let z = steepness * (-right - 5.0 * l) - 1.0 * l;
    let joint = 3.0 * l;
    let water = if has_lake {
        let (level, spacing) = (3.0 * l, 0.5 * l);
        let bed = 1.5 * l;
        format!(
            "fluid: (resolution: Spacing({spacing:?}), regions: [(name: \"lake\", shape: Below(level: {level:?}, seed: (0, 0, {bed:?})))]),"
        )
    } else {
        String::new()
    };
    let text = format!(
        r#"(title: "a rough valley", domain: (min: ({a:?}, {b:?}, {c:?}), max: ({d:?}, {e:?}, {f:?})),
            materials: [(name: "rock", density: 2650, friction_angle_deg: 20, restitution: 0.5)],
            terrain: (sources: [(file: "{name}")], origin: ({east:?}, {north:?}, 0)),
            slides: [(name: "slide", material: "rock",
                outline: Corners([({left:?}, -{half:?}), ({right:?}, -{half:?}), ({right:?}, {half:?}), ({left:?}, {half:?})]),
                failure_surface: Plane(point: ({right:?}, 0, {z:?}), dip_deg: {dip:?}, dip_direction_deg: 90),
                joint_sets: [(dip_deg: {dip:?}, dip_direction_deg: 90, spacing: {joint:?}, origin: ({right:?}, 0, {z:?})),
                             (dip_deg: 70, dip_direction_deg: 270, spacing: {joint:?}, scatter_deg: 2),
                             (dip_deg: 88, dip_direction_deg: 5, spacing: {joint:?})], seed: {k})],
            blocks: [(name: "ground", material: "rock", motion: Fixed, shape: Terrain)],
            numerics: (expected_speed: {speed:?}), {water}
            time: (duration: 20))"#,
        a = -29.0 * l,
        b = -19.0 * l,
        c = -20.0 * l,
        d = 29.0 * l,
        e = 19.0 * l,
        f = 40.0 * l,
        east = offset[0],
        north = offset[1],
        speed = (2.0 * 9.81 * 10.0 * l).sqrt(),
    );
    Valley { text, name }
}

/// A valley as a scene, and its world after a time (s) to which it runs without a stop, with the energy (J) by which its blocks fell.
fn run_valley(folder: &Path, valley: &Valley, duration: f64) -> (Scene, World, f64) {
    let Valley { text, name } = valley;
    let scene = resolved_in(folder, text).unwrap_or_else(|problems| panic!("{name}: {problems:?}"));
    let mut world = run::build(&scene).unwrap();
    let start = world.blocks.energies().potential;
    while world.time() < duration {
        let step = world.next_step(duration).unwrap();
        if let Err(error) = world.step(step) {
            panic!("{name} at {:.3} s: {error}\n{text}", world.time());
        }
    }
    let fell = start - world.blocks.energies().potential;
    assert!(fell > 0.0, "{name}");
    (scene, world, fell)
}

/// Runs some valleys for a time (s).
fn come_down(valleys: impl Iterator<Item = u64>, duration: f64) {
    let folder = tempfile::tempdir().unwrap();
    for k in valleys {
        let valley = rough_valley(folder.path(), k, false);
        let (scene, world, fell) = run_valley(folder.path(), &valley, duration);
        let name = valley.name;
        let deepest = world.blocks.max_overlap_over_size();
        println!(
            "{name}: {} blocks, {} triangles, deepest overlap {:.1} % of the size, fell {fell:.2e} J",
            scene.rock_masses[0].n_blocks,
            scene.terrain.as_ref().unwrap().surface.triangles().len(),
            100.0 * deepest
        );
        assert!(deepest < 0.1, "{name}: {deepest}");
    }
}

/// Slides of some valleys run into a lake for a time (s): to the end, with the energy of the slide closed and all of the water there.
fn run_into_a_lake(valleys: impl Iterator<Item = u64>, duration: f64) {
    let folder = tempfile::tempdir().unwrap();
    for k in valleys {
        let valley = rough_valley(folder.path(), k, true);
        let (scene, world, fell) = run_valley(folder.path(), &valley, duration);
        let name = valley.name;
        let fluid = &world.water.as_ref().unwrap().fluid;
        let (left, gone) = (fluid.particles().len(), fluid.removed().count);
        let gone = gone as f64 / (left as f64 + gone as f64);
        let unexplained = world.energy().residual / fell;
        let deepest = world.blocks.max_overlap_over_size();
        println!(
            "{name}: {} blocks, {left} particles, {:.2} % gone, energy unexplained {:.2} % of {fell:.2e} J, deepest overlap {:.1} %",
            scene.rock_masses[0].n_blocks,
            100.0 * gone,
            100.0 * unexplained,
            100.0 * deepest
        );
        assert!(unexplained.abs() < 0.02, "{name}: {unexplained}");
        assert!(gone < 0.005, "{name}: {gone}");
    }
}

/// Four of the sixty: the finest and the coarsest cells, white and fractal noise.
#[test]
fn slides_of_rough_valleys_start() {
    come_down([0, 9, 14, 18].into_iter(), 0.3);
}

/// All of them for five seconds.
#[test]
#[ignore = "18 min of one core"]
fn sixty_rough_valleys_come_down() {
    come_down(0..60, 5.0);
}

/// Ten valleys with a lake, for twenty seconds.
///
/// Missed by valley 24 at the whole step: 3.8 % of the slide's energy, all in the first two seconds, in which the lake sinks into
/// its rough bed of 30 m cells and gives off seventeen times that energy, of which 0.2 % are unexplained; 1.0 % at half the step.
#[test]
#[ignore = "25 min of one core"]
fn slides_of_ten_rough_valleys_run_into_lakes() {
    run_into_a_lake((0..10).map(|k| 6 * k), 20.0);
}
