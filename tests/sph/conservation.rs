//! Conserved quantities.

use riprap_sph::{Fluid, Start, Vec3};

use crate::support::{PeriodicBox, evaluate, noise3, published, step};

fn jittered(viscosity: f64) -> (PeriodicBox, Fluid) {
    let setup = PeriodicBox {
        scheme: published(viscosity),
        ..PeriodicBox::default()
    };
    let dp = setup.spacing();
    let fluid = setup.fluid(|x| noise3(x) * (0.1 * dp), |x| noise3(&(x * 2.0)));
    (setup, fluid)
}

fn wide(a: &[f32; 3]) -> Vec3 {
    Vec3::from(a.map(f64::from))
}

/// Misprint of Eq. 14: with a minus between the pressures, action would not equal reaction.
#[test]
fn misprint_of_eq_14_pressure_conserves_momentum() {
    let (_, fluid) = jittered(0.0);
    let sum: Vec3 = fluid.particles().acceleration.iter().sum();
    let size: f64 = fluid
        .particles()
        .acceleration
        .iter()
        .map(|a| a.norm())
        .sum();
    // 1728 particles, f64: round-off of the sum
    assert!(sum.norm() < 1e-12 * size, "{} of {size}", sum.norm());
}

/// Misprint of Eq. 18: printed v_a − v_b, a negative viscosity that would feed the motion.
#[test]
fn misprint_of_eq_18_viscosity_takes_energy() {
    let (_, fluid) = jittered(5.0);
    let p = fluid.particles();
    let power: f64 = p
        .velocity
        .iter()
        .zip(&p.viscous_acceleration)
        .map(|(v, a)| v.dot(&wide(a)))
        .sum();
    assert!(power < 0.0, "{power}");
    let sum: Vec3 = p.viscous_acceleration.iter().map(wide).sum();
    let size: f64 = p.viscous_acceleration.iter().map(|a| wide(a).norm()).sum();
    // kept in f32, for the ledger only
    assert!(sum.norm() < 1e-7 * size);
}

/// Misprint of Eq. 12: the sum runs over the neighbors' masses; on a lattice it gives ρ₀.
#[test]
fn misprint_of_eq_12_lattice_water_has_its_reference_density() {
    for support_over_spacing in [2.4, 3.0, 4.0] {
        let fluid = PeriodicBox {
            support_over_spacing,
            ..PeriodicBox::default()
        }
        .fluid(|_| Vec3::zeros(), |_| Vec3::zeros());
        for density in &fluid.particles().density {
            // the normalized sum is exact up to the round-off of a hundred terms
            assert!((density - 1000.0).abs() < 1e-9, "{density}");
        }
    }
}

#[test]
fn momentum_of_a_closed_box_stays() {
    let (_, mut fluid) = jittered(2.0);
    let before = fluid.momentum();
    let mass = fluid.particle_mass() * fluid.particles().len() as f64;
    for _ in 0..200 {
        let dt = fluid.step_limits().smallest();
        step(&mut fluid, dt);
    }
    // relative to mass times the initial speed scale of 1 m/s
    let change = (fluid.momentum() - before).norm() / mass;
    assert!(change < 1e-13, "{change}");
}

#[test]
fn water_at_rest_without_gravity_does_nothing() {
    let mut fluid = PeriodicBox::default().fluid(|_| Vec3::zeros(), |_| Vec3::zeros());
    for _ in 0..500 {
        step(&mut fluid, 1e-3);
    }
    // forces on a lattice cancel to round-off: 1e-10 of the sound speed leaves five decades
    assert!(fluid.max_speed() < 1e-10 * 20.0, "{}", fluid.max_speed());
}

#[test]
fn inviscid_motion_runs_backwards() {
    let (setup, mut fluid) = jittered(0.0);
    let by_id = |fluid: &Fluid| {
        let p = fluid.particles();
        let mut x: Vec<_> =
            p.id.iter()
                .copied()
                .zip(p.position.iter().copied())
                .collect();
        x.sort_by_key(|(id, _)| *id);
        x
    };
    let before = by_id(&fluid);
    let dt = 1e-3;
    for _ in 0..100 {
        step(&mut fluid, dt);
    }
    // half a box away from the start: the motion is a motion
    assert!(1e-2 < (by_id(&fluid)[7].1 - before[7].1).norm());
    for _ in 0..100 {
        step(&mut fluid, -dt);
    }
    for ((id, a), (_, b)) in before.iter().zip(by_id(&fluid)) {
        // a particle at the edge may return on its other side
        let d = (a - b).map(|d| d - d.round());
        assert!(
            d.norm() < 1e-6 * setup.spacing(),
            "particle {id}: {}",
            d.norm()
        );
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let run = |threads: usize| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap()
            .install(|| {
                let (_, mut fluid) = jittered(3.0);
                for _ in 0..20 {
                    let dt = fluid.step_limits().smallest();
                    step(&mut fluid, dt);
                }
                let mut bits = vec![
                    fluid.energies().kinetic.to_bits(),
                    fluid.viscous_loss().to_bits(),
                ];
                fluid.visit_state(|x| bits.push(x.to_bits()));
                bits
            })
    };
    let one = run(1);
    assert_eq!(one, run(2));
    assert_eq!(one, run(4));
}

#[test]
fn work_of_viscosity_is_the_kinetic_energy_it_takes() {
    // shear at rest density: pressure does next to nothing, so the ledger must close by viscosity
    let setup = PeriodicBox {
        scheme: published(5.0),
        ..PeriodicBox::default()
    };
    let k = 2.0 * std::f64::consts::PI;
    let mut fluid = setup.fluid(
        |_| Vec3::zeros(),
        |x| Vec3::new(1e-3 * (k * x.z).sin(), 0.0, 0.0),
    );
    let before = fluid.energies();
    for _ in 0..40 {
        step(&mut fluid, 1e-3);
    }
    let after = fluid.energies();
    let lost = before.kinetic - after.kinetic;
    let unexplained = (lost - after.viscous).abs() / lost;
    // kicks book their works exactly; what is left is the work of pressure
    assert!(unexplained < 1e-3, "{unexplained}");
}

#[test]
fn a_particle_outside_the_domain_is_removed_and_booked() {
    let mut settings = PeriodicBox::default()
        .fluid(|_| Vec3::zeros(), |_| Vec3::zeros())
        .settings()
        .clone();
    settings.periodic = [false; 3];
    let inside = Vec3::new(0.5, 0.5, 0.5);
    let outside = Vec3::new(0.5, 0.5, 2.0);
    let velocity = Vec3::new(0.0, 0.0, 3.0);
    let start = Start {
        positions: vec![outside, inside],
        velocities: vec![velocity, Vec3::zeros()],
        pressures: Vec::new(),
    };
    let mut fluid = Fluid::new(start, settings).unwrap();
    assert_eq!(fluid.refresh(), 1);
    evaluate(&mut fluid);
    assert_eq!(fluid.particles().id, [1.into()]);
    assert_eq!(fluid.removed().momentum, velocity * fluid.particle_mass());
}
