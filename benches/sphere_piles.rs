//! Speed of balls: a box of them that has come to rest.
//!
//! `cargo bench -p riprap-dda --bench sphere_piles` settles 10,000 balls of 1 m, then times steps on one
//! and on all threads; `-- N` does it for about N.
#![expect(clippy::print_stdout, reason = "a benchmark reports")]

use std::time::Instant;

use riprap_dda::{
    BlockDefinition, Blocks, Material, Motion, Polyhedron, Random, Settings, Shape, Vec3,
};

/// Simulated time before the measurement; s.
const SETTLING: f64 = 4.0;
/// Steps of a measurement; the median of five is reported.
const STEPS: u32 = 200;
/// Distance of the centres at the start; m.
const PITCH: f64 = 1.1;

type Failure = Box<dyn std::error::Error>;

/// In the cube of side 2 about the origin; m.
fn vector(random: &mut Random) -> Vec3 {
    Vec3::new(random.uniform(), random.uniform(), random.uniform()) * 2.0 - Vec3::repeat(1.0)
}

fn pile(side: usize) -> Result<Blocks, Failure> {
    let rock = Material {
        density: 2600.0,
        friction_angle: 0.5_f64.atan(),
        residual_friction_angle: None,
        cohesion: 0.0,
        residual_cohesion: 0.0,
        tensile_strength: 0.0,
        restitution: 0.3,
        // 1.4e7 N/m carries 22 layers that come down; more layers need more.
        contact_stiffness: 1.4e7 * f64::max(side as f64 / 22.0, 1.0),
        joint_stiffness: None,
        shear_stiffness_ratio: 2.0 / 7.0,
        rolling_friction: 0.0,
        elastic: None,
    };
    let mut random = Random::new(1);
    let width = PITCH * side as f64;
    let far = width + 2.0;
    let mut definitions = Vec::new();
    let mut push = |shape, motion| {
        definitions.push(BlockDefinition {
            shape,
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
        let wall = Polyhedron::cuboid(from.into(), to.into())?;
        push(Shape::Polyhedra(vec![wall]), Motion::Fixed);
    }
    for k in 0..side * side * side {
        let place = Vec3::new(
            (k % side) as f64,
            (k / side % side) as f64,
            (k / side / side) as f64,
        );
        let center = place.add_scalar(0.5) * PITCH + vector(&mut random) * 0.04;
        push(
            Shape::Sphere {
                center,
                radius: 0.5,
            },
            Motion::Free,
        );
    }
    Ok(Blocks::new(definitions, vec![rock], Settings::default())?)
}

fn main() -> Result<(), Failure> {
    let wanted = std::env::args()
        .skip(1)
        .find_map(|argument| argument.parse::<f64>().ok());
    let side = wanted.unwrap_or(1e4).cbrt().round() as usize;
    let mut blocks = pile(side)?;
    let mut time = 0.0;
    while time < SETTLING {
        let dt = blocks.critical_time_step().dt;
        blocks.advance(time, dt, 1)?;
        time += dt;
    }
    let mut baseline = None;
    for threads in [1, rayon::current_num_threads()] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()?;
        let mut rounds = Vec::new();
        let before = blocks.contact_updates();
        let mut dt = 0.0;
        for _ in 0..5 {
            let start = Instant::now();
            pool.install(|| {
                for _ in 0..STEPS {
                    dt = blocks.critical_time_step().dt;
                    blocks.advance(0.0, dt, 1).map_err(|e| e.to_string())?;
                }
                Ok::<(), String>(())
            })?;
            rounds.push(start.elapsed().as_secs_f64() / f64::from(STEPS));
        }
        rounds.sort_by(f64::total_cmp);
        let step = rounds[2];
        let contacts = (blocks.contact_updates() - before) as f64 / f64::from(5 * STEPS);
        let ratio = *baseline.get_or_insert(step) / step;
        println!(
            "{} balls, {threads} threads: {:.3} ms a step of {dt:.2e} s, {:.1} steps/s, {contacts:.0} contacts, {:.0} ns per contact and \
             step, {:.3e} contact updates/s, x {ratio:.2}",
            side * side * side,
            1e3 * step,
            1.0 / step,
            1e9 * step / contacts,
            contacts / step,
        );
    }
    Ok(())
}
