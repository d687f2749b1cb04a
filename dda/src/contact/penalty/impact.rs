//! Bodies that meet or part within a step.
//!
//! A force found at the end of a step stands for half a step on either side, but bodies that have just met were
//! apart for a part of the first half, and bodies that have just parted touched only for a part of the second.
//! Their springs would give or take too much by up to `(ω dt)²/4` of the energy of the hit, less or more as the
//! phase falls: a cube that bounces without loss gained 0.6 % each time where it met in short steps and parted in
//! long ones. So the half kick at the end of such a step is cut to the time of touch,
//!
//! ```text
//! τ/dt = U/W,   U = ½ K Σ w δ²,   W = ½ dt K Σ w δ |ġ|                                               [–]
//! ```
//! which is `δ/(|ġ| dt)` of a single point: the bodies give and get what the springs hold. Source: none; the
//! dashpot's share in a meeting, `normal::dashpot_share`, has the same reason.

use super::work::{Acting, Losses, Normals};
use crate::Vec3;

/// A force on the block j at a point, and its opposite on i; world; N, m.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PointForce {
    pub point: Vec3,
    pub force: Vec3,
}

/// Share of the step (s) in which bodies were apart whose springs hold some energy (J) and have exchanged some with them;
/// `None` if there is no more of the second: bodies that overlap at the start have not met, and where a body slides off an
/// edge springs are left over.
fn apart(held: f64, exchanged: f64) -> Option<f64> {
    (held < exchanged).then(|| 1.0 - held / exchanged)
}

/// Cuts the half kick of bodies that were apart a step (s) ago. Their springs hold `held` (J).
pub(super) fn begin_contact<N: Normals>(
    now: &Acting<N>,
    dt: f64,
    held: f64,
    losses: &mut Losses,
    half_kick_corrections: &mut Vec<PointForce>,
) {
    let Some(apart) = apart(held, -now.work_of_normal_springs(dt)) else {
        return;
    };
    for (point, n) in now.points() {
        let x = point.at.position;
        let rate = now.rate(&x);
        let half = 0.5 * dt * apart;
        losses.friction += half * (point.shear_force - point.shear_viscous).dot(&rate);
        // The dashpot of a meeting has had its share already.
        losses.damping += half * point.shear_viscous.dot(&rate);
        let spring = n * (point.normal_force - point.normal_viscous);
        half_kick_corrections.push(PointForce {
            point: x,
            force: (spring + point.shear_force) * -apart,
        });
    }
}

/// Cuts the half kick of bodies that touched a step (s) ago, and books what their springs still held of `held` (J).
pub(super) fn end_contact<N: Normals>(
    former: &Acting<N>,
    dt: f64,
    held: f64,
    losses: &mut Losses,
    half_kick_corrections: &mut Vec<PointForce>,
) {
    let given = former.work_of_normal_springs(dt);
    losses.damping += held - given;
    let Some(apart) = apart(held, given) else {
        return;
    };
    let (a, b) = former.bodies;
    for (point, n) in former.points() {
        let x = point.at.position;
        let rate = former.rate(&x);
        let half = 0.5 * dt * apart;
        losses.friction += half * (point.shear_force - point.shear_viscous).dot(&rate);
        let normal = n * point.normal_force;
        losses.damping += half * (normal + point.shear_viscous).dot(&rate);
        half_kick_corrections.push(PointForce {
            point: x + (a.velocity_at(&x) + b.velocity_at(&x)) * (0.5 * dt),
            force: (normal + point.shear_force) * -apart,
        });
    }
}
