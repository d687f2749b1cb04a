//! Speed of blocks: random hulls and cubes that have fallen into a bin.
//!
//! `cargo bench -p riprap-dda` settles 125 and 1000 of each, then times steps on one and on all threads.
//! `cargo bench -p riprap-dda -- N` does it for about N bodies.
#![expect(clippy::print_stdout, reason = "a benchmark reports")]

use std::time::Instant;

use riprap_dda::{
    BlockDefinition, Blocks, Isometry, Material, Motion, Polyhedron, Random, Settings, Shape, Vec3,
};

/// Simulated time before the measurement; s.
const SETTLING: f64 = 1.5;
/// Steps of a measurement; the median of five is reported.
const STEPS: u32 = 40;
/// Distance of the bodies at the start; m.
const PITCH: f64 = 1.45;

type Failure = Box<dyn std::error::Error>;

fn body(is_hull: bool, random: &mut Random) -> Result<Polyhedron, Failure> {
    if !is_hull {
        return Ok(Polyhedron::cuboid(Vec3::repeat(-0.5), Vec3::repeat(0.5))?);
    }
    // 14 points on a sphere of 0.6 m
    let points: Vec<Vec3> = (0..14)
        .map(|_| {
            let mut v = vector(random);
            while v.norm() > 1.0 || v.norm() < 0.1 {
                v = vector(random);
            }
            v.normalize() * 0.6
        })
        .collect();
    Ok(Polyhedron::convex_hull(&points)?)
}

/// In the cube of side 2 about the origin; m.
fn vector(random: &mut Random) -> Vec3 {
    Vec3::new(random.uniform(), random.uniform(), random.uniform()) * 2.0 - Vec3::repeat(1.0)
}

fn pile(side: usize, is_hull: bool) -> Result<Blocks, Failure> {
    let rock = Material {
        density: 2600.0,
        friction_angle: 0.5_f64.atan(),
        residual_friction_angle: None,
        cohesion: 0.0,
        residual_cohesion: 0.0,
        tensile_strength: 0.0,
        restitution: 0.3,
        // 1e8 N/m carries ten layers that come down; more layers need more.
        contact_stiffness: 1e8 * f64::max(side as f64 / 10.0, 1.0),
        joint_stiffness: None,
        shear_stiffness_ratio: 0.8,
        rolling_friction: 0.0,
        elastic: None,
    };
    let mut random = Random::new(1);
    let width = PITCH * side as f64;
    let far = width + 2.0;
    let mut definitions = Vec::new();
    let mut push = |shape: Polyhedron, motion| {
        definitions.push(BlockDefinition {
            shape: Shape::Polyhedra(vec![shape]),
            material: 0,
            motion,
            velocity: Vec3::zeros(),
            angular_velocity: Vec3::zeros(),
            deformability: None,
        });
    };
    for (from, to) in [
        ([-2.0, -2.0, -2.0], [far, far, 0.0]),
        ([-2.0, -2.0, 0.0], [0.0, far, far]),
        ([width, -2.0, 0.0], [far, far, far]),
        ([-2.0, -2.0, 0.0], [far, 0.0, far]),
        ([-2.0, width, 0.0], [far, far, far]),
    ] {
        push(Polyhedron::cuboid(from.into(), to.into())?, Motion::Fixed);
    }
    for k in 0..side * side * side {
        let place = Vec3::new(
            (k % side) as f64,
            (k / side % side) as f64,
            (k / side / side) as f64,
        );
        let center = place.add_scalar(0.5) * PITCH + Vec3::new(0.0, 0.0, 0.2);
        let turn = Isometry::new(center, vector(&mut random) * 0.3);
        push(body(is_hull, &mut random)?.transformed(&turn), Motion::Free);
    }
    Ok(Blocks::new(definitions, vec![rock], Settings::default())?)
}

fn steps(blocks: &mut Blocks, n: u32) -> Result<(), Failure> {
    for _ in 0..n {
        let dt = blocks.critical_time_step().dt;
        blocks.advance(0.0, dt, 1)?;
    }
    Ok(())
}

fn main() -> Result<(), Failure> {
    let wanted = std::env::args()
        .skip(1)
        .find_map(|argument| argument.parse::<f64>().ok());
    let sides = wanted.map_or(vec![5, 10], |n| vec![n.cbrt().round() as usize]);
    for side in sides {
        for is_hull in [false, true] {
            let mut blocks = pile(side, is_hull)?;
            let (mut time, mut n_settling) = (0.0, 0_u32);
            while time < SETTLING {
                let dt = blocks.critical_time_step().dt;
                blocks.advance(time, dt, 1)?;
                time += dt;
                n_settling += 1;
            }
            let mut baseline = None;
            for threads in [1, rayon::current_num_threads()] {
                let pool = rayon::ThreadPoolBuilder::new()
                    .num_threads(threads)
                    .build()?;
                let mut rounds = Vec::new();
                let before = (blocks.contact_updates(), blocks.axis_searches());
                for _ in 0..5 {
                    let start = Instant::now();
                    pool.install(|| steps(&mut blocks, STEPS).map_err(|e| e.to_string()))?;
                    rounds.push(start.elapsed().as_secs_f64() / f64::from(STEPS));
                }
                rounds.sort_by(f64::total_cmp);
                let step = rounds[2];
                let updates = (blocks.contact_updates() - before.0) as f64;
                let pairs = updates / f64::from(5 * STEPS);
                let searched = (blocks.axis_searches() - before.1) as f64 / updates;
                let ratio = *baseline.get_or_insert(step) / step;
                println!(
                    "{} {}, {threads} threads: {:.3} ms a step, {:.1} steps/s, {pairs:.0} touching pairs, {:.2} us per pair and step, \
                     {:.3e} contact updates/s, {:.1} % planes kept, x {ratio:.2}; {:.1} steps per ms of settling",
                    side * side * side,
                    if is_hull { "hulls" } else { "cubes" },
                    1e3 * step,
                    1.0 / step,
                    1e6 * step / pairs,
                    pairs / step,
                    100.0 * (1.0 - searched),
                    f64::from(n_settling) / (1e3 * SETTLING),
                );
            }
        }
    }
    Ok(())
}
