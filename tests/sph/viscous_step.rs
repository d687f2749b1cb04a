//! Implicit viscous steps, far longer than explicit ones may be.

use std::f64::consts::{PI, TAU};

use riprap_sph::scheme::{DensityDiffusion, Viscosity};
use riprap_sph::{
    Dimensions, Fluid, FluidError, Precision, Regularization, Rheology, Scheme, Settings, Start,
    Stepping, Vec3, ViscousStep,
};

use super::mud::{DENSITY, Flow, Layer, bingham, flux, slope, zero_of_line};
use super::support::{PeriodicBox, evaluate, noise3, step};

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

fn scheme(viscosity: Viscosity, viscous_step: ViscousStep, precision: Precision) -> Scheme {
    Scheme {
        viscosity,
        viscous_step,
        precision,
        diffusion: DensityDiffusion::None,
        ..Scheme::artificial()
    }
}

fn boxed(viscosity: Viscosity, viscous_step: ViscousStep, precision: Precision) -> PeriodicBox {
    PeriodicBox {
        support_over_spacing: 4.0,
        scheme: scheme(viscosity, viscous_step, precision),
        ..PeriodicBox::default()
    }
}

/// Explicit steps of viscosity (Pa s) in the present one of a fluid.
fn explicit_steps(fluid: &Fluid, dynamic_viscosity: f64) -> f64 {
    let settings = fluid.settings();
    let explicit = settings.viscous_limit(dynamic_viscosity / settings.reference_density);
    fluid.step_limits().smallest() / explicit
}

fn on_threads<T: Send>(n: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build();
    pool.unwrap().install(work)
}

/// Steps to a time; returns their number and the mean number of products.
fn run(flow: &mut Flow, until: f64) -> (u32, f64) {
    let (mut steps, mut products) = (0, 0);
    while flow.time < until {
        flow.step();
        steps += 1;
        products += flow.fluid.n_products();
    }
    (steps, f64::from(products) / f64::from(steps))
}

#[test]
fn a_shear_wave_decays_as_by_backward_euler_however_long_the_step() {
    // it moves by 1e-6 of a spacing in a step, which changes the sums by the square of that
    let wave = |x: &Vec3| Vec3::new(1e-4 * (TAU * x.z).sin(), 0.0, 0.0);
    let rest = |_: &Vec3| Vec3::zeros();
    let eta = 2e4;
    let of =
        |viscous_step| boxed(newtonian(eta), viscous_step, Precision::Double).fluid(rest, wave);
    // the rate of the discrete operator: 0.919 of ν k² with twelve spacings in a wave
    let rate = {
        let explicit = of(ViscousStep::Explicit);
        let p = explicit.particles();
        let power: f64 = (p.velocity.iter().zip(&p.acceleration))
            .map(|(v, a)| v.dot(a))
            .sum();
        let square: f64 = p.velocity.iter().map(Vec3::norm_squared).sum();
        -power / square
    };
    let mut fluid = of(ViscousStep::Implicit);
    let dt = fluid.step_limits().smallest();
    let ratio = explicit_steps(&fluid, eta);
    // the first kick knows nothing of the step
    step(&mut fluid, dt);
    // of the wave alone: the solution ends within 1e-5 of the rest
    let amplitude = |fluid: &Fluid| {
        let p = fluid.particles();
        let each = p.position.iter().zip(&p.velocity);
        each.map(|(x, v)| v.x * (TAU * x.z).sin()).sum::<f64>()
    };
    let mut worst = 0.0_f64;
    for _ in 0..4 {
        let before = amplitude(&fluid);
        step(&mut fluid, dt);
        let factor = amplitude(&fluid) / before;
        worst = worst.max((factor * (1.0 + rate * dt) - 1.0).abs());
    }
    println!(
        "shear wave: rate {:.4} of ν k², {ratio:.0} explicit steps in one, λ dt = {:.2}, factor off by {worst:.1e}",
        rate / (eta / 1000.0 * TAU * TAU),
        rate * dt
    );
    assert!(20.0 < ratio && 2.0 < rate * dt, "{ratio}");
    assert!(worst < 1e-6, "{worst}");
}

#[test]
fn momentum_is_that_of_pair_forces() {
    // a stirred Bingham fluid, its residual far above round-off
    for (precision, bound) in [(Precision::Double, 1e-13), (Precision::Single, 1e-6)] {
        let setup = boxed(mud(1e5), ViscousStep::Implicit, precision);
        let stirred = |x: &Vec3| noise3(x) * 0.5 + Vec3::new((TAU * x.z).sin(), 0.3, 0.0);
        let mut fluid = setup.fluid(|x| noise3(x) * 0.01, stirred);
        let before = fluid.momentum();
        let mut products = 0;
        for _ in 0..20 {
            let dt = fluid.step_limits().smallest();
            step(&mut fluid, dt);
            products += fluid.n_products();
        }
        let off = (fluid.momentum() - before).norm() / before.norm();
        println!("{precision:?}: momentum off by {off:.1e} after {products} products");
        assert!(20 < products);
        // measured 1e-17 and 2e-7: seven digits of a pair force, the same as of explicit ones
        assert!(off < bound, "{precision:?}: {off}");
    }
}

#[test]
fn the_account_of_energy_closes() {
    // a sheared layer between plates slows down; nothing pulls
    let layer = Layer {
        rows: 16,
        lid: Some(Vec3::zeros()),
        viscosity: mud(5000.0),
        viscous_step: ViscousStep::Implicit,
        ..Layer::default()
    };
    let (lost, booked, share) = on_threads(1, || {
        let mut flow = layer.flow(|z| 2.0 * (1.0 - (20.0 * z - 1.0).powi(2)));
        flow.fluid.open_ledger();
        let before = flow.fluid.energies();
        run(&mut flow, 0.05);
        let after = flow.fluid.energies();
        let lost = before.kinetic + before.internal - after.kinetic - after.internal;
        (
            lost,
            after.viscous + after.diffusive,
            after.kinetic / before.kinetic,
        )
    });
    println!("kinetic to {share:.3}, lost {lost:.6e} J, booked {booked:.6e}");
    assert!(share < 0.9, "{share}");
    // as of explicit steps, 1e-6: the digits of the viscous accelerations, and of sound
    assert!((booked / lost - 1.0).abs() < 1e-4, "{booked} {lost}");
}

#[test]
fn steady_flows_between_plates_are_those_of_explicit_steps() {
    let width = 0.02;
    let eta = 50.0;
    let couette = |z: f64| 0.4 * z / width;
    let poiseuille = |z: f64| DENSITY * 10.0 / (2.0 * eta) * z * (width - z);
    for (name, lid, pull) in [("Couette", 0.4, 0.0), ("Poiseuille", 0.0, 10.0)] {
        let exact = |z: f64| match 0.0 < pull {
            true => poiseuille(z),
            false => couette(z),
        };
        let layer = |viscous_step| Layer {
            rows: 20,
            depth: width,
            lid: Some(Vec3::new(lid, 0.0, 0.0)),
            gravity: [pull, 0.0],
            viscosity: newtonian(eta),
            viscous_step,
            precision: Precision::Double,
            ..Layer::default()
        };
        let profile = |viscous_step| {
            // ρ L²/(π² η) = 1.2 ms
            let layer = layer(viscous_step);
            on_threads(1, || {
                let mut flow = layer.flow(|_| 0.0);
                let (steps, _) = run(&mut flow, 0.02);
                (flow.profile(layer.spacing()), steps)
            })
        };
        let (explicit, many) = profile(ViscousStep::Explicit);
        let (implicit, few) = profile(ViscousStep::Implicit);
        let largest = implicit.iter().fold(0.0_f64, |most, (_, u)| most.max(*u));
        let worst = |of: &dyn Fn(usize) -> f64| {
            (0..implicit.len()).fold(0.0_f64, |most, k| most.max(of(k).abs())) / largest
        };
        let off = worst(&|k| implicit[k].1 - exact(implicit[k].0));
        let apart = worst(&|k| implicit[k].1 - explicit[k].1);
        println!(
            "{name}: {few} steps for {many}, off by {off:.4} of the largest speed, {apart:.1e} from explicit ones"
        );
        assert!(6 * few < many, "{few} {many}");
        assert!(off < 0.03, "{name}: {off}");
        // ten times the residual of a step
        assert!(apart < 1e-4, "{name}: {apart}");
    }
}

#[test]
fn a_channel_starts_as_in_its_series() {
    let (width, eta, pull) = (0.1, 100.0, 10.0);
    let layer = Layer {
        depth: width,
        lid: Some(Vec3::zeros()),
        gravity: [pull, 0.0],
        viscosity: newtonian(eta),
        viscous_step: ViscousStep::Implicit,
        ..Layer::default()
    };
    let nu = eta / DENSITY;
    // a tenth of L²/ν, when the middle has 0.615 of its final speed
    let (flow, ratio, steps) = on_threads(1, || {
        let mut flow = layer.flow(|_| 0.0);
        let ratio = explicit_steps(&flow.fluid, eta);
        let (steps, _) = run(&mut flow, 0.1 * width * width / nu);
        (flow, ratio, steps)
    });
    let time = flow.time * nu / (width * width);
    let exact = |z: f64| {
        let y = z / width;
        let odd = (1..60).step_by(2).map(f64::from);
        let decaying: f64 = odd
            .map(|n| {
                let wave = n * PI;
                4.0 / wave.powi(3) * (wave * y).sin() * (-wave * wave * time).exp()
            })
            .sum();
        pull * width * width / nu * (0.5 * y * (1.0 - y) - decaying)
    };
    let profile = flow.profile(layer.spacing());
    let largest = exact(0.5 * width);
    let squares: f64 = (profile.iter().map(|(z, u)| (u - exact(*z)).powi(2))).sum();
    let off = (squares / profile.len() as f64).sqrt() / largest;
    println!("channel: {steps} steps, each {ratio:.1} explicit ones, off by {off:.4}");
    assert!(4.0 < ratio);
    assert!(off < 0.02, "{off}");
}

/// G11: 98 times fewer steps than explicit ones with the same largest viscosity, a thousand times that beyond the yield stress. With 5
/// products a step an implicit one takes 3.2 times the processor's time of an explicit one, the flow 31 times less.
#[test]
fn a_bingham_film_slides_on_long_steps() {
    let gravity = slope(5.0);
    let pull = DENSITY * gravity[0];
    let largest = 2000.0;
    let layer = Layer {
        gravity,
        viscosity: mud(largest),
        viscous_step: ViscousStep::Implicit,
        ..Layer::default()
    };
    let (depth, dp) = (layer.depth, layer.spacing());
    // 0.053216 m and 0.907998 m/s
    let yield_height = depth - 60.0 / pull;
    let plug = pull * yield_height * yield_height / (2.0 * 2.0);
    let exact = |z: f64| {
        let below = (1.0 - z / yield_height).max(0.0);
        plug * (1.0 - below * below)
    };
    let expected = plug * (depth - yield_height / 3.0);
    let (flow, ratio, steps, products) = on_threads(1, || {
        let mut flow = layer.flow(exact);
        let ratio = explicit_steps(&flow.fluid, largest);
        let (steps, products) = run(&mut flow, 0.4);
        (flow, ratio, steps, products)
    });
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
        "film: {steps} steps, each {ratio:.0} explicit ones, {products:.2} products a step; \
         plug speed, flux, yield height over exact {ratios:.4?}"
    );
    assert!(50.0 < ratio, "{ratio}");
    assert!(0.0 < products && products < 30.0, "{products}");
    // measured 1.014, 1.005 and 0.991, of explicit steps with a tenth of the largest viscosity 1.017, 1.005 and 0.990
    assert!(ratios.iter().all(|r| (r - 1.0).abs() < 0.03), "{ratios:?}");
}

#[test]
fn a_film_below_yield_only_creeps_on_long_steps() {
    // thinner than τ/(ρ g sin θ) = 46.8 mm
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
    let (speed, ratio) = on_threads(1, || {
        let mut flow = layer.flow(|_| 0.0);
        let ratio = explicit_steps(&flow.fluid, largest);
        run(&mut flow, 0.05);
        (flow.profile(layer.spacing()).last().unwrap().1, ratio)
    });
    let creep = DENSITY * gravity[0] * layer.depth.powi(2) / (2.0 * largest);
    println!(
        "creep: {:.4} of ρ g sin θ H²/(2 η_max), steps of {ratio:.0} explicit ones",
        speed / creep
    );
    assert!(50.0 < ratio, "{ratio}");
    assert!((1.0 / 1.2..1.2).contains(&(speed / creep)), "{speed}");
}

#[test]
fn threads_do_not_change_a_bit() {
    let layer = Layer {
        rows: 24,
        columns: 80,
        gravity: slope(5.0),
        lid: Some(Vec3::new(0.2, 0.0, 0.0)),
        viscosity: mud(2000.0),
        viscous_step: ViscousStep::Implicit,
        ..Layer::default()
    };
    let states = [1, 2].map(|n| {
        on_threads(n, || {
            let mut flow = layer.flow(|z| 20.0 * z + (300.0 * z).sin() * 0.1);
            let mut state = Vec::new();
            for _ in 0..20 {
                flow.step();
                state.push(u64::from(flow.fluid.n_products()));
            }
            flow.fluid.visit_state(|x| state.push(x.to_bits()));
            state
        })
    });
    assert!(1920 < states[0].len() && 0 < states[0][0]);
    assert!(states[0] == states[1]);
}

/// A flow with planes of symmetry above and below is half of one that is twice as high and repeats itself.
#[test]
fn half_of_a_flow_between_planes_of_symmetry_is_that_of_the_whole() {
    let n = 16;
    let dp = 1.0 / f64::from(n);
    let mirrored = |x: &Vec3| {
        Vec3::new(
            (TAU * x.z).cos() * (1.0 + 0.3 * (TAU * x.x).sin()),
            0.0,
            0.2 * (TAU * x.z).sin(),
        )
    };
    let fluid = |height: f64| {
        let rows = (height / dp).round() as i32;
        let place = |i: i32, k: i32| Vec3::new(f64::from(i) + 0.5, 0.0, f64::from(k) + 0.5) * dp;
        let positions: Vec<Vec3> = (0..rows)
            .flat_map(|k| (0..n).map(move |i| (i, k)))
            .map(|(i, k)| place(i, k) + Vec3::new(0.0, 0.5, 0.0))
            .collect();
        let is_half = height < 1.0;
        let start = Start {
            velocities: positions.iter().map(mirrored).collect(),
            positions,
            pressures: Vec::new(),
        };
        let settings = Settings {
            particle_spacing: [dp, 1.0, dp],
            smoothing_length: 2.0 * dp,
            reference_density: 1000.0,
            sound_speed: 20.0,
            scheme: scheme(mud(1e5), ViscousStep::Implicit, Precision::Double),
            dimensions: Dimensions::Two { width: 1.0 },
            gravity: Vec3::zeros(),
            time_step_factor: 0.5,
            domain: (Vec3::zeros(), Vec3::new(1.0, 1.0, height)),
            periodic: [true, false, !is_half],
            symmetry: [[false; 2], [false; 2], [is_half; 2]],
        };
        let mut fluid = Fluid::new(start, settings).unwrap();
        evaluate(&mut fluid);
        fluid
    };
    let (mut half, mut whole) = (fluid(0.5), fluid(1.0));
    let dt = whole.step_limits().smallest();
    let mut impulse = Vec3::zeros();
    let before = half.momentum();
    for _ in 0..5 {
        impulse += half.plane_force() * (0.5 * dt);
        step(&mut half, dt);
        step(&mut whole, dt);
        impulse += half.plane_force() * (0.5 * dt);
    }
    let sorted = |fluid: &Fluid| {
        let p = fluid.particles();
        let mut all: Vec<_> = (0..p.len()).map(|a| (p.id[a], p.velocity[a])).collect();
        all.sort_unstable_by_key(|&(id, _)| id);
        all
    };
    let pairs = sorted(&half).into_iter().zip(sorted(&whole));
    let worst = pairs.fold(0.0_f64, |most, ((_, a), (_, b))| most.max((a - b).norm()));
    let changed = half.momentum() + half.reflected() * -1.0 - before;
    println!(
        "half against whole: {worst:.1e} m/s, {} products; momentum {changed:.3e} by planes {impulse:.3e}",
        half.n_products()
    );
    // both stop within 1e-5 of the root mean square, 0.5 m/s, and not at the same product
    assert!(worst < 2e-5, "{worst}");
    // the planes give no momentum along themselves, and all of that across
    assert!((changed.z - impulse.z).abs() < 1e-9 * before.norm().max(1.0));
}

#[test]
fn schemes_without_implicit_steps_say_so() {
    let settings = |scheme: Scheme| {
        let setup = PeriodicBox {
            scheme: Scheme {
                viscous_step: ViscousStep::Explicit,
                ..scheme
            },
            support_over_spacing: 4.0,
            ..PeriodicBox::default()
        };
        let fluid = setup.fluid(|_| Vec3::zeros(), |_| Vec3::zeros());
        let mut settings = fluid.settings().clone();
        settings.scheme = scheme;
        settings
    };
    let implicit = scheme(newtonian(1.0), ViscousStep::Implicit, Precision::Double);
    assert!(settings(implicit).check_viscous_step().is_ok());
    for (refused, word) in [
        (
            Scheme {
                viscosity: Viscosity::Laminar {
                    kinematic_viscosity: 1.0,
                },
                ..implicit
            },
            "Morris",
        ),
        (
            Scheme {
                stepping: Stepping::PredictorCorrector,
                ..implicit
            },
            "KickDriftKick",
        ),
    ] {
        let error = Fluid::new(Start::default(), settings(refused))
            .err()
            .unwrap();
        assert!(matches!(error, FluidError::ExplicitViscosity { .. }));
        assert!(error.to_string().contains(word), "{error}");
    }
}
