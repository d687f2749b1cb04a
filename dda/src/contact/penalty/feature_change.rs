//! Energy continuity when the features of a contact change.
//!
//! A patch under each of the faces, a pair of edges, and a corner beside a face have potentials of their
//! own (see `patch`). Where one ends and another begins, the stiffness of the new one is scaled so that it
//! holds what the old one left,
//!
//! ```text
//! s (U + W) = U_before − W_before,     s ≤ 1                                                    [J]
//! ```
//! W the works of the springs in the two halves of the step. Without it a step between the two came from
//! nothing: a pile of fifty hulls missed 2.4 % of the energy that it lost, most of it where two edges took
//! over from a face. Of a larger energy than the new springs take (s = 1) the rest is lost and is booked
//! with the dashpots, 1 % of what that pile loses. A contact that has become softer stiffens with what its
//! own dashpots and friction take from then on, and starts again when the bodies part. A contact that begins
//! deep, without one before, still comes from nothing.

use super::normal::Pressing;
use super::work::{Acting, Losses, Normals};
use crate::contact::detection::manifold::ManifoldPoint;

/// No contact becomes softer than this share; –.
const SOFTEST: f64 = 1e-3;

/// Share of the stiffness of the points of new features, so that they hold the energy that the old ones left (J); –.
pub(super) fn share_of_new(left: f64, asked: f64) -> f64 {
    if asked > 0.0 {
        (left / asked).clamp(SOFTEST, 1.0)
    } else {
        1.0
    }
}

/// Energy that springs store and release in the second half of the step (s); J.
pub(super) fn energy_asked(
    springs: &Pressing,
    points: &[ManifoldPoint],
    normal: &crate::Vec3,
    dt: f64,
) -> f64 {
    let (a, b) = springs.bodies;
    let of = |point: &ManifoldPoint| {
        let x = &point.position;
        let opening = (b.velocity_at(x) - a.velocity_at(x)).dot(normal);
        0.5 * springs.stiffness * point.weight * point.overlap * (point.overlap + dt * opening)
    };
    points.iter().map(of).sum()
}

/// Energy (J) that springs which held some have left after the first half of a step (s), in which they did work; J.
pub(super) fn energy_left<N: Normals>(held: f64, former: &Acting<N>, dt: f64) -> f64 {
    held - former.work_of_normal_springs(dt)
}

/// Gives a softer contact that holds some energy (J) what it lost in this step; returns its new share of the stiffness.
pub(super) fn stiffen(share: f64, held: &mut f64, losses: &mut Losses) -> f64 {
    let lost = losses.damping + losses.friction;
    if share >= 1.0 || lost <= 0.0 || *held <= 0.0 {
        return share;
    }
    let whole = *held / share;
    let stiffer = (share + lost / whole).min(1.0);
    let taken = (stiffer - share) * whole;
    *held += taken;
    losses.damping -= taken;
    stiffer
}
