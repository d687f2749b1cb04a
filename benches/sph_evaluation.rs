//! Speed of the fluid's sums: a dam break column on its lattice, scene D of the trade study.
//!
//! `cargo bench -p riprap-sph --bench sph_evaluation -- [SPACING ...]`

use std::time::Instant;

use riprap_sph::scheme::{DensityDiffusion, Viscosity};
use riprap_sph::{
    Dimensions, Fluid, Precision, Regularization, Rheology, Scheme, Settings, Start, Vec3,
};

fn main() {
    let spacings: Vec<f64> = std::env::args()
        .skip(1)
        .filter_map(|a| a.parse().ok())
        .collect();
    let spacings = if spacings.is_empty() {
        vec![0.0116]
    } else {
        spacings
    };
    for dp in spacings {
        let water = Viscosity::Artificial { alpha: 0.1 };
        let morris = Viscosity::Morris {
            kinematic_viscosity: 1e-3,
        };
        let mud = Viscosity::Rheological {
            rheology: Rheology::Bingham {
                dynamic_viscosity: 1.0,
                yield_stress: 50.0,
                regularization: Regularization::Bilinear(100.0),
            },
        };
        for (ratio, precision, viscosity) in [
            (1.3, Precision::Single, water),
            (1.3, Precision::Double, water),
            (3.0_f64.sqrt(), Precision::Single, water),
            (1.3, Precision::Single, morris),
            (1.3, Precision::Single, mud),
        ] {
            for threads in [1, 2] {
                let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(threads).build() else {
                    return;
                };
                pool.install(|| measure(dp, ratio, (precision, viscosity), threads));
            }
        }
    }
}

fn column(dp: f64, ratio: f64, precision: Precision, viscosity: Viscosity) -> Option<Fluid> {
    let n = [0.4, 0.67, 0.3].map(|l: f64| (l / dp).round() as usize);
    let sound_speed = 20.0 * (9.81_f64 * 0.3).sqrt();
    let settings = Settings {
        particle_spacing: [dp; 3],
        smoothing_length: ratio * dp,
        reference_density: 1000.0,
        sound_speed,
        scheme: Scheme {
            diffusion: DensityDiffusion::Fourtakas(0.1),
            viscosity,
            precision,
            ..Scheme::standard()
        },
        dimensions: Dimensions::Three,
        gravity: Vec3::new(0.0, 0.0, -9.81),
        time_step_factor: 0.2,
        domain: (Vec3::zeros(), Vec3::new(1.6, 0.67, 0.6)),
        periodic: [false; 3],
    };
    let mut start = Start::default();
    for i in 1..=n[0] {
        for j in 1..n[1] {
            for k in 1..=n[2] {
                let x = Vec3::new(i as f64, j as f64, k as f64) * dp;
                start.pressures.push(9810.0 * (0.3 - x.z).max(0.0));
                start.positions.push(x);
                start.velocities.push(Vec3::zeros());
            }
        }
    }
    Fluid::new(start, settings).ok()
}

fn measure(dp: f64, ratio: f64, (precision, viscosity): (Precision, Viscosity), threads: usize) {
    let Some(mut fluid) = column(dp, ratio, precision, viscosity) else {
        return;
    };
    fluid.refresh();
    let n = fluid.particles().len() as f64;
    let mut best = [f64::INFINITY; 3];
    for _ in 0..5 {
        let start = Instant::now();
        fluid.update_rates();
        let rates = start.elapsed().as_secs_f64();
        fluid.advance_density(0.0);
        let start = Instant::now();
        if fluid.update_pressure().is_err() {
            return;
        }
        if fluid.varies_viscosity() {
            fluid.update_strain();
            fluid.update_viscosity();
        }
        fluid.update_accelerations();
        let forces = start.elapsed().as_secs_f64();
        for (best, time) in best.iter_mut().zip([rates, forces, rates + forces]) {
            *best = best.min(time);
        }
    }
    #[expect(clippy::print_stdout, reason = "a benchmark prints")]
    {
        println!(
            "dp {dp}: {n} particles, h {ratio:.3} dp, {precision:?}, varying viscosity {}, {threads} threads, {:.0} neighbours: \
             rates {:.0} ns, forces {:.0} ns, both {:.3e} evaluations/s, {:.3e} pairs/s",
            viscosity.varies(),
            fluid.n_pairs() as f64 / n,
            1e9 * best[0] / n,
            1e9 * best[1] / n,
            n / best[2],
            2.0 * fluid.n_pairs() as f64 / best[2],
        );
    }
}
