//! Implicit viscous steps, far longer than explicit ones may be.

use std::f64::consts::TAU;

use riprap_sph::scheme::{DensityDiffusion, Viscosity};
use riprap_sph::{
    Dimensions, Fluid, FluidError, Precision, Regularization, Rheology, Scheme, Settings, Stepping,
    Vec3, ViscousStep,
};

use super::mud::{DENSITY, Flow, Layer, alone, bingham, flux, slope, zero_of_line};
use super::support::{PeriodicBox, noise3, step};

/// A law without a yield stress.
fn newtonian(dynamic_viscosity: f64) -> Viscosity {
    Viscosity::Rheological {
        rheology: Rheology::Newtonian { dynamic_viscosity },
    }
}

/// A yield stress of 60 Pa, 2 Pa s beyond it, and at most `largest` (Pa s) below it.
fn mud(largest: f64) -> Viscosity {
    Viscosity::Rheological {
        rheology: bingham(Regularization::Bilinear(largest)),
    }
}

fn boxed(viscosity: Viscosity, viscous_step: ViscousStep, precision: Precision) -> PeriodicBox {
    PeriodicBox {
        support_over_spacing: 4.0,
        scheme: Scheme {
            viscosity,
            viscous_step,
            precision,
            diffusion: DensityDiffusion::None,
            ..Scheme::artificial()
        },
        ..PeriodicBox::default()
    }
}

/// Largest explicit step of viscosity at the same state; s.
fn explicit_limit(settings: &Settings, dynamic_viscosity: f64) -> f64 {
    let h = settings.smoothing_length;
    settings.time_step_factor * 0.25 * h * h * settings.reference_density / dynamic_viscosity
}

#[test]
fn a_shear_wave_decays_as_by_backward_euler_however_long_the_step() {
    // too slow to shear the lattice: 1e-6 of a spacing
    let wave = |x: &Vec3| Vec3::new(1e-5 * (TAU * x.z).sin(), 0.0, 0.0);
    let rest = |_: &Vec3| Vec3::zeros();
    let eta = 1e5;
    let explicit =
        boxed(newtonian(eta), ViscousStep::Explicit, Precision::Double).fluid(rest, wave);
    // the rate of the discrete operator, within a few per cent of ν k²
    let rate = {
        let p = explicit.particles();
        let power: f64 = (p.velocity.iter().zip(&p.acceleration))
            .map(|(v, a)| v.dot(a))
            .sum();
        let square: f64 = p.velocity.iter().map(Vec3::norm_squared).sum();
        -power / square
    };
    let exact = eta / 1000.0 * TAU * TAU;
    let setup = boxed(newtonian(eta), ViscousStep::Implicit, Precision::Double);
    let mut fluid = setup.fluid(rest, wave);
    let dt = fluid.step_limits().smallest();
    let ratio = dt / explicit_limit(fluid.settings(), eta);
    step(&mut fluid, dt);
    let largest = |fluid: &Fluid| {
        fluid
            .particles()
            .velocity
            .iter()
            .map(|v| v.x)
            .fold(0.0, f64::max)
    };
    let mut worst = 0.0_f64;
    for _ in 0..5 {
        let before = largest(&fluid);
        step(&mut fluid, dt);
        let factor = largest(&fluid) / before;
        worst = worst.max((factor * (1.0 + rate * dt) - 1.0).abs());
    }
    println!(
        "shear wave: rate {:.4} of ν k², {ratio:.0} explicit steps in one, λ dt = {:.2}, factor off by {worst:.1e}, {} products",
        rate / exact,
        rate * dt,
        fluid.n_products()
    );
}

#[test]
fn momentum_and_energy() {
    for precision in [Precision::Double, Precision::Single] {
        let setup = boxed(mud(1e5), ViscousStep::Implicit, precision);
        let mut fluid = setup.fluid(
            |x| noise3(x) * 0.01,
            |x| noise3(x) * 0.5 + Vec3::new((TAU * x.z).sin(), 0.3, 0.0),
        );
        fluid.open_ledger();
        let p0 = fluid.momentum();
        let e0 = fluid.energies();
        for _ in 0..20 {
            let dt = fluid.step_limits().smallest();
            step(&mut fluid, dt);
            print!("{} ", fluid.n_products());
        }
        let e = fluid.energies();
        let lost = e0.kinetic + e0.internal - e.kinetic - e.internal;
        println!(
            "{precision:?}: momentum {:.2e} of {:.2e}; lost {lost:.8e} booked {:.8e} kin {:.3e}->{:.3e}",
            (fluid.momentum() - p0).norm(),
            p0.norm(),
            e.viscous + e.diffusive,
            e0.kinetic,
            e.kinetic
        );
    }
}

#[test]
fn couette() {
    for viscous_step in [ViscousStep::Explicit, ViscousStep::Implicit] {
        let layer = Layer {
            rows: 20,
            depth: 0.02,
            lid: Some(Vec3::new(0.4, 0.0, 0.0)),
            viscosity: newtonian(50.0),
            viscous_step,
            precision: Precision::Double,
            ..Layer::default()
        };
        let flow = alone(|| {
            let mut f = layer.flow(|_| 0.0);
            let n = f.run(0.02);
            println!("{n} steps {} products", f.fluid.n_products());
            f
        });
        println!(
            "{:?}",
            flow.profile(layer.spacing())
                .iter()
                .map(|p| p.1 / (20.0 * p.0))
                .collect::<Vec<_>>()
        );
        let layer = Layer {
            rows: 20,
            depth: 0.02,
            lid: Some(Vec3::zeros()),
            gravity: [10.0, 0.0],
            viscosity: newtonian(50.0),
            viscous_step,
            precision: Precision::Double,
            ..Layer::default()
        };
        let flow = alone(|| {
            let mut f = layer.flow(|_| 0.0);
            let n = f.run(0.02);
            println!("{n} steps {} products", f.fluid.n_products());
            f
        });
        println!(
            "{:?}",
            flow.profile(layer.spacing())
                .iter()
                .map(|p| p.1 / (DENSITY * 10.0 / 100.0 * p.0 * (0.02 - p.0)))
                .collect::<Vec<_>>()
        );
    }
}

#[test]
fn film() {
    let gravity = slope(5.0);
    let pull = DENSITY * gravity[0];
    for (largest, vs) in [
        (200.0, ViscousStep::Explicit),
        (200.0, ViscousStep::Implicit),
        (2000.0, ViscousStep::Implicit),
    ] {
        let layer = Layer {
            gravity,
            viscosity: mud(largest),
            viscous_step: vs,
            ..Layer::default()
        };
        let (depth, dp) = (layer.depth, layer.spacing());
        let yield_height = depth - 60.0 / pull;
        let plug = pull * yield_height * yield_height / (2.0 * 2.0);
        let exact = |z: f64| {
            let below = (1.0 - z / yield_height).max(0.0);
            plug * (1.0 - below * below)
        };
        let expected = plug * (depth - yield_height / 3.0);
        let t0 = std::time::Instant::now();
        let (flow, steps, products) = alone(|| {
            let mut flow = layer.flow(exact);
            let (mut n, mut np) = (0u64, 0u64);
            while flow.time < 0.4 {
                flow.step();
                n += 1;
                np += u64::from(flow.fluid.n_products());
            }
            (flow, n, np)
        });
        let el = t0.elapsed();
        let profile = flow.profile(dp);
        let rates = flow.rows(dp, |a| flow.fluid.particles().shear_rate[a]);
        let sheared: Vec<_> = rates
            .into_iter()
            .filter(|(z, _)| (0.2..0.7).contains(&(z / yield_height)))
            .collect();
        let ratios = [
            profile.last().unwrap().1 / plug,
            flux(&profile, dp) / expected,
            zero_of_line(&sheared) / yield_height,
        ];
        println!(
            "{largest} {vs:?}: {steps} steps, {:.2} products a step, {ratios:.4?} {el:?}",
            products as f64 / steps as f64
        );
    }
}

#[test]
fn creep() {
    let gravity = slope(5.0);
    let largest = 2000.0;
    let layer = Layer {
        rows: 16,
        depth: 0.04,
        gravity,
        viscosity: mud(largest),
        viscous_step: ViscousStep::Implicit,
        ..Layer::default()
    };
    let flow = alone(|| {
        let mut flow = layer.flow(|_| 0.0);
        let n = flow.run(0.05);
        println!("{n} steps {}", flow.fluid.n_products());
        flow
    });
    let speed = flow.profile(layer.spacing()).last().unwrap().1;
    let creep = DENSITY * gravity[0] * layer.depth.powi(2) / (2.0 * largest);
    println!("creep: {:.4} of", speed / creep);
}
