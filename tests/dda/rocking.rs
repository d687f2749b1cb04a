//! A slender block rocks from edge to edge (D20).
//!
//! ```text
//! r = (1 − 3/2 sin² α)²                                   energy kept in a hit on an edge alone            [–]
//! r = ((κ² − ρ)/(κ² + ρ))²,  κ² = 1/3 + 4/3 cot² α        in a hit whose impulse is at ρ of the half width [–]
//! ```
//! Source of the first: Housner (1963). A base that lies on a bed of springs and dashpots meets all of it as it passes
//! through level: the impulse begins inside of the edge, ρ is 0.8 for the bed of a patch, and the block keeps more.

use riprap_dda::{
    Blocks, ContactDynamics, Integrator, Isometry, Material, Motion, Polyhedron, Settings, Shape,
    Vec3,
};

use crate::setup::{assert_close, block, cuboid, down, floor, rock};

/// m.
const HEIGHT: f64 = 1.0;
/// Height of the hollow under a block on two edges; m.
const HOLLOW: f64 = 0.001;
/// Rotation at which the block is let go, over its slenderness angle; –.
const START: f64 = 0.5;
const N_IMPACTS: usize = 5;

#[derive(Clone, Copy, Debug)]
enum Base {
    Flat,
    TwoEdges,
}

/// Energy kept in a hit on an edge alone; –.
fn housner(alpha: f64) -> f64 {
    (1.0 - 1.5 * alpha.sin().powi(2)).powi(2)
}

/// Energy kept in a hit of a flat base on a bed, weight and sliding left aside; –.
///
/// ```text
/// δ = z − θ x,   f = w max(0, δ + c δ′) where δ ≥ 0,   c = 2 √(K_e m_e)/Σw            1/6 of K at each edge
/// z″ = −Σ f,     κ² θ″ = Σ f x                         θ = z = 0, θ′ = z′ = 1 at first
/// ```
/// in half widths, masses and stiffnesses of the block. From then on it turns about the new edge, about which no later
/// hit there changes its angular momentum.
fn kept_on_a_bed(alpha: f64) -> f64 {
    const N_STRIPS: u32 = 400;
    const STEP: f64 = 1e-3;
    let height = 1.0 / alpha.tan();
    let inertia = (1.0 + height * height) / 3.0;
    let about_base = inertia + height * height;
    let strip = |k: u32| (2.0 * f64::from(k) + 1.0) / f64::from(N_STRIPS) - 1.0;
    let mut springs = vec![(-1.0, 1.0 / 6.0), (1.0, 1.0 / 6.0)];
    springs.extend((0..N_STRIPS).map(|k| (strip(k), 2.0 / 3.0 / f64::from(N_STRIPS))));
    let (mut depth, mut sinking, mut turn, mut spin) = (0.0, 1.0, 0.0, 1.0);
    loop {
        let pressed = springs.iter().filter(|(x, _)| 0.0 <= depth - turn * x);
        let total: f64 = pressed.clone().map(|(_, w)| w).sum();
        if total == 0.0 {
            let after = (about_base * spin - sinking) / (about_base + 1.0);
            return after * after;
        }
        let middle = pressed.clone().map(|(x, w)| x * w).sum::<f64>() / total;
        let mobility = 1.0 + middle * middle / inertia;
        let dashpot = 2.0 * (total / mobility).sqrt() / total;
        let (mut force, mut moment) = (0.0, 0.0);
        for (x, w) in pressed {
            let f = w * (depth - turn * x + dashpot * (sinking - spin * x)).max(0.0);
            force += f;
            moment += f * x;
        }
        sinking -= force * STEP;
        spin += moment / about_base * STEP;
        depth += sinking * STEP;
        turn += spin * STEP;
    }
}

fn outline(alpha: f64, base: Base) -> Vec<[f64; 2]> {
    let width = alpha.tan() * HEIGHT;
    let mut outline = vec![[-width, 0.0]];
    if let Base::TwoEdges = base {
        outline.push([-0.5 * width, HOLLOW]);
    }
    outline.extend([[0.0, 0.0], [0.0, HEIGHT], [-width, HEIGHT]]);
    outline
}

/// On a floor, turned by `turn` about its right edge, and turning back at `spin` (rad/s).
fn rocker(outline: &[[f64; 2]], (turn, spin): (f64, f64), settings: Settings) -> Blocks {
    let parts = Polyhedron::extrusion(outline, 1, -0.3, 0.3).unwrap();
    let tilt = Isometry::rotation(Vec3::y() * turn);
    let mut stone = block(cuboid([0.0; 3], [1.0; 3]), Motion::Free);
    stone.shape = Shape::Polyhedra(parts).transformed(&tilt);
    let material = Material {
        friction_angle: 1.4,
        contact_stiffness: 1e10,
        ..rock()
    };
    let at_rest = Blocks::new(vec![floor(), stone.clone()], vec![material], settings);
    stone.angular_velocity = Vec3::y() * -spin;
    stone.velocity = stone.angular_velocity.cross(&at_rest.unwrap().centroid(1));
    Blocks::new(vec![floor(), stone], vec![material], settings).unwrap()
}

/// Energy kept in a hit without weight, by steps that are a share of the critical one; –.
fn kept_without_weight(alpha: f64, base: Base, share: f64) -> f64 {
    const SPIN: f64 = 0.5;
    let settings = Settings {
        gravity: Vec3::zeros(),
        ..Settings::default()
    };
    let mut blocks = rocker(&outline(alpha, base), (0.0, SPIN), settings);
    let (mass, width) = (blocks.mass(1), alpha.tan() * HEIGHT);
    let new_edge = Vec3::new(-width, 0.0, 0.0) - blocks.centroid(1);
    // The bed is left after some 8 √(m/K).
    let end = 100.0 * (mass / 1e10).sqrt();
    let mut time = 0.0;
    while time < end {
        let dt = share * blocks.critical_time_step().dt;
        blocks.advance(time, dt, 1).unwrap();
        time += dt;
    }
    let arm = blocks.orientation(1) * -new_edge;
    let momentum = blocks.spin_momentum(1).y + mass * arm.cross(&blocks.velocity(1)).y;
    let about_edge = mass * (width * width + HEIGHT * HEIGHT) / 3.0;
    (momentum / (about_edge * SPIN)).powi(2)
}

/// Largest rotations of the swings, the first before any impact; rad.
fn peaks(alpha: f64, base: Base, integrator: Integrator) -> Vec<f64> {
    let settings = Settings {
        gravity: down(),
        integrator,
        ..Settings::default()
    };
    let mut blocks = rocker(&outline(alpha, base), (START * alpha, 0.0), settings);
    let mut peaks = Vec::new();
    let (mut time, mut side, mut highest) = (0.0, 1.0, START * alpha);
    while peaks.len() <= N_IMPACTS {
        let dt = blocks.critical_time_step().dt.min(1e-4);
        blocks.advance(time, dt, 1).unwrap();
        time += dt;
        let turn = blocks.orientation(1).scaled_axis().y + START * alpha;
        if turn * side < 0.0 {
            peaks.push(highest);
            (side, highest) = (-side, 0.0);
        }
        highest = highest.max(turn.abs());
    }
    peaks
}

/// Energy of a block at rest that is turned, above that upright, over `m g R`; –.
fn energy(alpha: f64, turn: f64) -> f64 {
    (alpha - turn).cos() - alpha.cos()
}

/// Energy kept from swing to swing within a tolerance, and all peaks within 10 %.
fn check_swings(name: &str, alpha: f64, found: &[f64], (kept, tolerance): (f64, f64)) {
    for pair in found.windows(2) {
        let ratio = energy(alpha, pair[1]) / energy(alpha, pair[0]);
        assert_close(
            &format!("{name}, alpha {alpha}: kept"),
            ratio,
            kept,
            tolerance,
        );
    }
    let start = energy(alpha, START * alpha);
    for (n, peak) in (0..).zip(found) {
        let expected = alpha - (alpha.cos() + start * kept.powi(n)).acos();
        assert_close(
            &format!("{name}, alpha {alpha}: peak {n}"),
            *peak,
            expected,
            0.1,
        );
    }
}

/// The limit of a bed, for angles so small that it turns at one rate throughout: `κ² (1 − √r)/(1 + √r)`.
#[test]
fn impulse_of_a_bed_lies_inside_of_the_edge() {
    let alpha = 0.01_f64;
    let slenderness = 1.0 / 3.0 + 4.0 / 3.0 / alpha.tan().powi(2);
    let root = kept_on_a_bed(alpha).sqrt();
    // 0.7953 by a program of its own, of that rate.
    assert_close(
        "place of the impulse",
        slenderness * (1.0 - root) / (1.0 + root),
        0.7953,
        2e-3,
    );
}

/// Springs over the whole base answer as their differential equation does, on two edges as Housner has it.
#[test]
fn hit_without_weight() {
    for alpha in [0.1, 0.2, 0.3] {
        let flat = kept_without_weight(alpha, Base::Flat, 0.1);
        // Measured 2e-3 at most.
        assert_close("flat base, bed", flat, kept_on_a_bed(alpha), 4e-3);
        // 0.2, 0.7 and 1.6 % more by the step: the whole base meets the floor within one.
        let coarse = kept_without_weight(alpha, Base::Flat, 1.0);
        assert_close(
            "the same, critical step",
            coarse,
            kept_on_a_bed(alpha),
            2e-2,
        );
        let edges = kept_without_weight(alpha, Base::TwoEdges, 1.0);
        assert_close("two edges, Housner", edges, housner(alpha), 2e-3);
    }
}

#[test]
fn springs_on_two_edges() {
    for alpha in [0.1, 0.2, 0.3] {
        let found = peaks(alpha, Base::TwoEdges, Integrator::CentralDifference);
        // Measured 4e-4 at most; the peaks 2e-3.
        check_swings("springs, two edges", alpha, &found, (housner(alpha), 1e-2));
    }
}

#[test]
fn springs_on_a_flat_base() {
    for alpha in [0.1, 0.2] {
        let found = peaks(alpha, Base::Flat, Integrator::CentralDifference);
        let bed = kept_on_a_bed(alpha);
        // Measured 0.5 % and 1.6 % more, the peaks 3 % and 7 %: the critical step, and weight in a hit that takes a while.
        check_swings("springs, flat base", alpha, &found, (bed, 2e-2));
    }
}

/// In contact dynamics the old edge opens freely, whatever lies between the two.
#[test]
fn contact_dynamics_is_housners() {
    let integrator = Integrator::ContactDynamics(ContactDynamics {
        time_step: 1e-4,
        tolerance: 1e-8,
        n_iterations: 2000,
        ..ContactDynamics::default()
    });
    for alpha in [0.1, 0.2, 0.3] {
        for base in [Base::Flat, Base::TwoEdges] {
            let found = peaks(alpha, base, integrator);
            // Measured 0.1 to 0.4 % less, the peaks 1.4 %, both of first order: the hit is that of the step before, in
            // which the edge is still above the floor.
            let name = format!("contact dynamics, {base:?}");
            check_swings(&name, alpha, &found, (housner(alpha), 1e-2));
        }
    }
}
