//! Speed of one evaluation of the fluid: sort, neighbours, densities, accelerations.
//!
//! `cargo bench -p riprap-sph` prints particle-evaluations and pair interactions per second by phase
//! and the ratio of all threads to one, measured in the same run.
#![expect(clippy::print_stdout, reason = "a benchmark reports")]

use std::time::{Duration, Instant};

use riprap_sph::{Fluid, FluidError, NegativePressure, Settings, Vec3};

/// Evaluations per measurement; the median of five measurements is reported.
const EVALUATIONS: u32 = 5;

fn cube(n: usize) -> Result<Fluid, FluidError> {
    let dp = 1.0 / n as f64;
    // an irrational jitter: no lattice ties, the same in every run
    let jitter = |i: usize| ((i as f64 * 0.618_033_988_75).fract() - 0.5) * 0.2 * dp;
    let positions: Vec<Vec3> = (0..n * n * n)
        .map(|a| {
            let place = Vec3::new((a % n) as f64, (a / n % n) as f64, (a / n / n) as f64);
            place.add_scalar(0.5) * dp + Vec3::new(jitter(a), jitter(a + 7), jitter(a + 13))
        })
        .collect();
    let settings = Settings {
        particle_spacing: [dp; 3],
        smoothing_length: 1.5 * dp,
        reference_density: 1000.0,
        sound_speed: 30.0,
        dynamic_viscosity: 1.0,
        negative_pressure: NegativePressure::Clamped,
        gravity: Vec3::new(0.0, 0.0, -9.81),
        time_step_factor: 0.5,
        domain: (Vec3::zeros(), Vec3::repeat(1.0)),
        periodic: [false; 3],
    };
    Fluid::new(
        positions.clone(),
        vec![Vec3::zeros(); positions.len()],
        settings,
    )
}

/// Median time of each phase: sort, neighbours, densities, accelerations.
fn measure(fluid: &mut Fluid) -> Result<[Duration; 4], FluidError> {
    let mut rounds = [const { Vec::new() }; 4];
    for _ in 0..5 {
        let mut spent = [Duration::ZERO; 4];
        for _ in 0..EVALUATIONS {
            let mut last = Instant::now();
            let mut lap = |phase: &mut Duration| {
                *phase += last.elapsed();
                last = Instant::now();
            };
            fluid.sort();
            lap(&mut spent[0]);
            fluid.find_neighbors();
            lap(&mut spent[1]);
            fluid.update_density()?;
            lap(&mut spent[2]);
            fluid.update_accelerations();
            lap(&mut spent[3]);
        }
        for (round, spent) in rounds.iter_mut().zip(spent) {
            round.push(spent / EVALUATIONS);
        }
    }
    Ok(rounds.map(|mut round| {
        round.sort();
        round[round.len() / 2]
    }))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for n in [32, 50] {
        let mut baseline = None;
        for threads in [1, rayon::current_num_threads()] {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()?;
            let (phases, pairs) = pool.install(|| -> Result<_, FluidError> {
                let mut fluid = cube(n)?;
                let phases = measure(&mut fluid)?;
                Ok((phases, fluid.n_pairs()))
            })?;
            let total: Duration = phases.iter().sum();
            let particles = (n * n * n) as f64;
            let per_second = particles / total.as_secs_f64();
            let ratio = per_second / *baseline.get_or_insert(per_second);
            let nanoseconds = phases.map(|phase| phase.as_nanos() as f64 / particles);
            println!(
                "{particles:6} particles, {:.0} neighbours, {threads} threads: {per_second:.3e} particle-evaluations/s, \
                 {:.3e} pairs/s, x {ratio:.2}; ns per particle: sort {:.0}, neighbours {:.0}, density {:.0}, accelerations {:.0}",
                pairs as f64 / particles,
                pairs as f64 / total.as_secs_f64(),
                nanoseconds[0],
                nanoseconds[1],
                nanoseconds[2],
                nanoseconds[3],
            );
        }
    }
    Ok(())
}
