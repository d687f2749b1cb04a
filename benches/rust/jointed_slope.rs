//! Speed of a jointed slope: a mass of about 5000 blocks, cut by three sets of joints, that begins to slide.
//!
//! `cargo bench -p riprap-dda --bench jointed_slope`; `-- N` for about N blocks.
#![expect(clippy::print_stdout, reason = "a benchmark reports")]

use std::time::Instant;

use riprap_dda::{
    BlockDefinition, Blocks, Isometry, JointSet, Material, Motion, Polyhedron, Settings, Shape,
    Vec3, cut_by_joints,
};

/// Steps before the measurement, and of a measurement; the median of five is reported.
const WARM_UP: u32 = 200;
const STEPS: u32 = 20;
/// Spacing of the joints; m.
const SPACING: f64 = 2.0;

type Failure = Box<dyn std::error::Error>;

fn slope(n_blocks: f64) -> Result<Blocks, Failure> {
    let rock = Material {
        density: 2600.0,
        friction_angle: 25.0_f64.to_radians(),
        residual_friction_angle: None,
        cohesion: 0.0,
        residual_cohesion: 0.0,
        tensile_strength: 0.0,
        restitution: 0.2,
        contact_stiffness: 1e10,
        joint_stiffness: None,
        shear_stiffness_ratio: 0.8,
        shear_damping_ratio: 0.2,
        rolling_friction: 0.0,
        twisting_friction: 0.0,
        elastic: None,
    };
    // Aligned with the slope: one set lies in it, two stand on it.
    let side = SPACING * (n_blocks / 0.5).cbrt();
    let mass = Polyhedron::cuboid(Vec3::zeros(), Vec3::new(side, side, 0.5 * side))?;
    let set = |dip: f64, dip_direction: f64| JointSet {
        dip: dip.to_radians(),
        dip_direction: dip_direction.to_radians(),
        spacing: SPACING,
        origin: Vec3::repeat(0.3),
        persistence: 1.0,
        scatter: 0.02,
        spacing_scatter: 0.1,
    };
    let sets = [set(0.0, 0.0), set(80.0, 90.0), set(85.0, 10.0)];
    let cut = cut_by_joints(vec![mass], &sets, 1, 100_000)?.blocks;
    let turn = Isometry::rotation(Vec3::y() * 35.0_f64.to_radians());
    let bed = Polyhedron::cuboid(
        Vec3::new(-5.0, -5.0, -3.0),
        Vec3::new(3.0 * side, side + 5.0, 0.0),
    )?;
    let block = |shape: Polyhedron, motion| BlockDefinition {
        shape: Shape::Polyhedra(vec![shape.transformed(&turn)]),
        material: 0,
        motion,
        velocity: Vec3::zeros(),
        angular_velocity: Vec3::zeros(),
        deformability: None,
    };
    let definitions = std::iter::once(block(bed, Motion::Fixed))
        // Slivers would set the step: see the merging of them.
        .chain(
            cut.into_iter()
                .filter(|part| riprap_dda::volume(part) > 0.05 * SPACING.powi(3))
                .map(|part| block(part, Motion::Free)),
        )
        .collect();
    Ok(Blocks::new(definitions, vec![rock], Settings::default())?)
}

fn main() -> Result<(), Failure> {
    let wanted = std::env::args()
        .skip(1)
        .find_map(|argument| argument.parse::<f64>().ok());
    let mut blocks = slope(wanted.unwrap_or(5000.0))?;
    let mut steps = |n: u32| -> Result<f64, String> {
        let start = Instant::now();
        for _ in 0..n {
            let dt = blocks.critical_time_step().dt;
            blocks
                .advance(0.0, dt, 1)
                .map_err(|error| error.to_string())?;
        }
        Ok(start.elapsed().as_secs_f64() / f64::from(n))
    };
    steps(WARM_UP)?;
    let mut baseline = None;
    let mut medians = Vec::new();
    for threads in [1, rayon::current_num_threads()] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()?;
        let mut rounds = (0..5)
            .map(|_| pool.install(|| steps(STEPS)))
            .collect::<Result<Vec<f64>, String>>()?;
        rounds.sort_by(f64::total_cmp);
        let ratio = *baseline.get_or_insert(rounds[2]) / rounds[2];
        medians.push((threads, rounds[2], ratio));
    }
    let updates = blocks.contact_updates() as f64;
    let pairs = updates / f64::from(WARM_UP + 10 * STEPS);
    let kept = 1.0 - blocks.axis_searches() as f64 / updates;
    for (threads, step, ratio) in medians {
        println!(
            "{} blocks, {threads} threads: {:.3} ms a step, {:.1} steps/s, {pairs:.0} touching pairs, {:.2} us per pair and step, \
             {:.3e} contact updates/s, {:.1} % planes kept, x {ratio:.2}",
            blocks.n_free(),
            1e3 * step,
            1.0 / step,
            1e6 * step / pairs,
            pairs / step,
            100.0 * kept,
        );
    }
    Ok(())
}
