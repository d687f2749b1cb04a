//! How far impulses are from the laws of contact.

use super::delassus::Delassus;
use super::{ContactProblem, ROWS_AT_A_TIME};
use crate::{Vec3, chunks};

/// Mass by which impulses become velocities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scaling {
    /// `ρ_a = 3/tr W_aa`, the mass that the contact feels; `1/W_nn` of a rod.
    ContactMass,
    /// 1 kg, as in collections of contact problems.
    Unit,
}

impl Scaling {
    #[inline]
    fn of<D: Delassus>(self, problem: &ContactProblem<D>, a: usize) -> f64 {
        match self {
            Self::ContactMass => problem.mass(a),
            Self::Unit => 1.0,
        }
    }
}

/// `Û`: the velocity of a row, shifted along the normal; m/s.
#[inline]
fn shifted<D: Delassus>(problem: &ContactProblem<D>, a: usize, velocity: &Vec3) -> Vec3 {
    let along = velocity + Vec3::x() * problem.shift(a, velocity);
    problem.acting(a, &along)
}

/// Residual of the laws; –.
///
/// ```text
/// E = ‖R/ρ − P_K(R/ρ − Û)‖ / max(‖b‖, ‖R/ρ‖, ‖U‖)
/// ```
/// 0 for a problem that is at rest without impulses.
pub fn residual<D: Delassus>(
    problem: &ContactProblem<D>,
    (impulses, velocities): (&[Vec3], &D::Velocities),
    scaling: Scaling,
) -> f64 {
    let of_rows = |first: usize, rows: &[Vec3]| {
        let mut sums = [0.0_f64; 4];
        for (a, impulse) in (first..).zip(rows) {
            let mass = scaling.of(problem, a);
            let scaled = impulse / mass;
            let velocity = problem.velocity(velocities, a);
            let free = scaled - shifted(problem, a, &velocity);
            let image = problem.projected(a, &free, mass, |contact| impulses[contact].x);
            for (sum, of) in sums.iter_mut().zip([
                &(scaled - image),
                &problem.free_velocity[a],
                &scaled,
                &velocity,
            ]) {
                *sum += of.norm_squared();
            }
        }
        sums
    };
    let [off, free, pressed, moving] =
        chunks::reduce(impulses, ROWS_AT_A_TIME, &of_rows, &|a, b| {
            [0, 1, 2, 3].map(|k| a[k] + b[k])
        });
    let size = free.max(pressed).max(moving);
    if 0.0 < size { (off / size).sqrt() } else { 0.0 }
}

/// Spurious over available energy, the measure `g` of Koziara & Bićanić (2011); –.
///
/// ```text
/// g = Σ C·W_aa⁻¹C / Σ b·W_aa⁻¹b,   C = Û + (S − P_K(S)),   S = R/ρ − Û
/// ```
pub fn energy_error<D: Delassus>(
    problem: &ContactProblem<D>,
    (impulses, velocities): (&[Vec3], &D::Velocities),
) -> f64 {
    let [mut spurious, mut available] = [0.0_f64; 2];
    for (a, impulse) in impulses.iter().enumerate() {
        let Some(inverse) = problem.inverse(a) else {
            continue;
        };
        let mass = problem.mass(a);
        let moved = shifted(problem, a, &problem.velocity(velocities, a));
        let s = impulse / mass - moved;
        let left = moved + s - problem.projected(a, &s, mass, |contact| impulses[contact].x);
        let free = &problem.free_velocity[a];
        spurious += left.dot(&(inverse * left));
        available += free.dot(&(inverse * free));
    }
    if 0.0 < available {
        spurious / available
    } else {
        0.0
    }
}
