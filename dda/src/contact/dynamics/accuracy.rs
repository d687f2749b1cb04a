//! How far impulses are from the laws of contact.

use super::cone::{projected, shifted};
use super::delassus::Delassus;
use super::{ContactProblem, Law};
use crate::Vec3;

/// Mass by which impulses become velocities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scaling {
    /// `ρ_a = 3/tr W_aa`, the mass that the contact feels.
    ContactMass,
    /// 1 kg, as in collections of contact problems.
    Unit,
}

impl Scaling {
    fn of<D: Delassus>(self, operator: &D, a: usize) -> f64 {
        match self {
            Self::ContactMass => contact_mass(operator, a),
            Self::Unit => 1.0,
        }
    }
}

/// `ρ_a = 3/tr W_aa`; kg. 1 for a contact that impulses do not move.
pub(super) fn contact_mass<D: Delassus>(operator: &D, a: usize) -> f64 {
    let trace = operator.diagonal(a).trace();
    if 0.0 < trace { 3.0 / trace } else { 1.0 }
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
    let [mut off, mut free, mut pressed, mut moving] = [0.0_f64; 4];
    for (a, impulse) in impulses.iter().enumerate() {
        let mass = scaling.of(&problem.operator, a);
        let scaled = impulse / mass;
        let velocity = problem.velocity(velocities, a);
        let image = match problem.law(a, |contact| impulses[contact].x) {
            Law::Contact(friction) => projected(friction, &(scaled - shifted(friction, &velocity))),
            Law::Rolling(bound) => (scaled - velocity).cap_magnitude(bound / mass),
            Law::Fixed => scaled - velocity,
        };
        off += (scaled - image).norm_squared();
        free += problem.free_velocity[a].norm_squared();
        pressed += scaled.norm_squared();
        moving += velocity.norm_squared();
    }
    let size = free.max(pressed).max(moving);
    if 0.0 < size { (off / size).sqrt() } else { 0.0 }
}

/// Spurious over available energy, the measure `g` of Koziara & Bićanić (2011); –.
///
/// ```text
/// g = Σ C·W_aa⁻¹C / Σ b·W_aa⁻¹b,   C = Û + (S − P_K(S)),   S = R/ρ − Û
/// ```
/// Of the contacts, without rolling resistance and fixed rows.
pub fn energy_error<D: Delassus>(
    problem: &ContactProblem<D>,
    (impulses, velocities): (&[Vec3], &D::Velocities),
) -> f64 {
    let [mut spurious, mut available] = [0.0_f64; 2];
    for (a, impulse) in impulses.iter().enumerate().take(problem.len()) {
        let Some(inverse) = problem.operator.diagonal(a).try_inverse() else {
            continue;
        };
        let friction = problem.friction[a];
        let moved = shifted(friction, &problem.velocity(velocities, a));
        let s = impulse / contact_mass(&problem.operator, a) - moved;
        let left = moved + s - projected(friction, &s);
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
