//! Fluid in parts that know only their own particles and a rim of their neighbors', as several processes would have it.

use riprap_sph::exact_sum::Reduce;
use riprap_sph::fluid::energy::ParticleSums;
use riprap_sph::{Fluid, ParticleId, Start, Vec3};

use crate::support::{PeriodicBox, evaluate, noise3, step};

const N: [usize; 3] = [64, 8, 8];
const SPACING: f64 = 1.0 / N[0] as f64;
const SUPPORT: f64 = 2.0 * SPACING;

/// Width of the rim. A particle feels the density of those within a support, which comes from those within another; and a step
/// evaluates twice, so that the rim must move rightly as well; one more spacing for what moves meanwhile.
const RIM: f64 = 4.0 * SUPPORT + SPACING;

/// Particles by id.
#[derive(Clone, PartialEq, Debug)]
struct State {
    positions: Vec<Vec3>,
    velocities: Vec<Vec3>,
}

/// A fluid of the particles `ids` of `state`, whose own numbers start at 0 again.
fn fluid_of(state: &State, ids: &[usize], whole: &Fluid) -> Fluid {
    let start = Start {
        positions: ids.iter().map(|&id| state.positions[id]).collect(),
        velocities: ids.iter().map(|&id| state.velocities[id]).collect(),
        pressures: Vec::new(),
    };
    let mut fluid = Fluid::new(start, whole.settings().clone()).unwrap();
    evaluate(&mut fluid);
    fluid
}

/// A step by `n_parts` slices of equal width, which tell each other the particles of their rims before it, and the sums after it.
fn step_in_parts(state: &State, n_parts: usize, dt: f64, whole: &Fluid) -> (State, ParticleSums) {
    let mut next = state.clone();
    let mut total = ParticleSums::default();
    let width = 1.0 / n_parts as f64;
    // the last part reports first
    for part in (0..n_parts).rev() {
        let place = |id: usize| state.positions[id].x.rem_euclid(1.0);
        let is_own = |id: usize| ((place(id) / width) as usize).min(n_parts - 1) == part;
        let center = (part as f64 + 0.5) * width;
        let distance = |id: usize| {
            let d = (place(id) - center).abs();
            d.min(1.0 - d)
        };
        let ids: Vec<usize> = (0..state.positions.len())
            .filter(|&id| n_parts == 1 || distance(id) <= 0.5 * width + RIM)
            .collect();
        assert!(n_parts == 1 || ids.len() < state.positions.len());
        let mut fluid = fluid_of(state, &ids, whole);
        step(&mut fluid, dt);
        let global = |id: ParticleId| ids[u32::from(id) as usize];
        total.merge(&fluid.particle_sums_of(|id| is_own(global(id))));
        let particles = fluid.particles();
        for (a, &id) in particles.id.iter().enumerate() {
            if is_own(global(id)) {
                next.positions[global(id)] = particles.position[a];
                next.velocities[global(id)] = particles.velocity[a];
            }
        }
    }
    (next, total)
}

/// Motion and sums have the same bits for any number of parts, while particles cross from part to part.
#[test]
fn bits_do_not_depend_on_the_number_of_parts() {
    let water = PeriodicBox {
        n: N,
        support_over_spacing: 2.0,
        ..PeriodicBox::default()
    };
    // a stream along the slices' normal, stirred
    let whole = water.fluid(
        |x| noise3(x) * (0.1 * SPACING),
        |x| Vec3::new(2.0, 0.0, 0.0) + noise3(&(x * 1.7)),
    );
    let sorted = whole.particles();
    let mut order: Vec<usize> = (0..sorted.len()).collect();
    order.sort_unstable_by_key(|&a| sorted.id[a]);
    let start = State {
        positions: order.iter().map(|&a| sorted.position[a]).collect(),
        velocities: order.iter().map(|&a| sorted.velocity[a]).collect(),
    };
    // a third of a spacing in all
    let (dt, n_steps) = (1e-4, 25);
    let run = |n_parts: usize| {
        let mut state = start.clone();
        let mut sums = ParticleSums::default();
        for _ in 0..n_steps {
            (state, sums) = step_in_parts(&state, n_parts, dt, &whole);
        }
        (state, sums)
    };
    let (one, of_one) = run(1);
    assert_ne!(one, start);
    let n_crossed = (one.positions.iter().zip(&start.positions))
        .filter(|(now, then)| (now.x.rem_euclid(1.0) < 0.5) != (then.x.rem_euclid(1.0) < 0.5))
        .count();
    assert!(n_crossed > 0, "no particle went from part to part");
    for n_parts in [2, 3] {
        let (several, of_several) = run(n_parts);
        assert!(several == one, "{n_parts} parts move otherwise than one");
        assert_eq!(of_several.count, of_one.count);
        let numbers = |sums: &ParticleSums| {
            let ParticleSums {
                mass,
                momentum: [x, y, z],
                twice_kinetic,
                work_of_gravity,
                internal,
                ..
            } = sums;
            [mass, x, y, z, twice_kinetic, work_of_gravity, internal].map(|s| s.value().to_bits())
        };
        assert_eq!(numbers(&of_several), numbers(&of_one), "{n_parts} parts");
    }
    // sums in the order of parts would not do
    let naive = |n_parts: usize| -> f64 {
        let part = |k: usize| -> f64 {
            let of_part = one.velocities.iter().skip(k).step_by(n_parts);
            of_part.map(|v| v.norm_squared()).sum()
        };
        (0..n_parts).map(part).sum()
    };
    assert_ne!(naive(1).to_bits(), naive(3).to_bits());
}
