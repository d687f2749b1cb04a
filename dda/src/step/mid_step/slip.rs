//! Static and residual friction: a contact has the residual one once it has slipped.
//!
//! Points of two polyhedra in one direction slip as one, when all of them are at their bound,
//!
//! ```text
//! Σ |R_t| = μ Σ R_n                                                                                    [N s]
//! ```
//! for the impulses among them are not unique: one may be at its bound while others hold. They have the residual friction for as long as
//! the parts stay near each other. A sphere has it while it slips, and the static one when it holds again. The laws are those of the
//! penalty contact.

use super::start::AT_THE_BOUND;
use super::touches::Touch;
use crate::Blocks;
use crate::contact::detection::terrain::{ONE_FOOT, SAME_FOOT};
use crate::contact::dynamics::kept::KeptImpulse;
use crate::contact::report::ContactState;

impl Blocks {
    /// Whether any joint has a residual friction of its own.
    fn has_residual_friction(&self) -> bool {
        let mut joints = self.state.joints.iter();
        joints.any(|joint| joint.residual_friction != joint.friction)
    }

    fn is_of_sphere(&self, touch: &Touch) -> bool {
        let is_sphere = |part: u32| self.derived.parts[part as usize].is_sphere();
        is_sphere(touch.parts.0) || is_sphere(touch.parts.1)
    }

    /// Residual friction of points that have slipped.
    pub(super) fn recall_slip(&self, touches: &mut [Touch]) {
        if !self.has_residual_friction() {
            return;
        }
        for touch in touches {
            let joint = self.joint_between(touch.parts);
            if joint.residual_friction != joint.friction && self.had_slipped(touch) {
                touch.has_slipped = true;
                touch.friction = match self.is_of_sphere(touch) {
                    true => joint.spheres.dynamic_friction,
                    false => joint.residual_friction,
                };
            }
        }
    }

    /// Whether the point of these parts that had most nearly the same direction in the last step had slipped by then.
    fn had_slipped(&self, touch: &Touch) -> bool {
        let kept = &self.state.impulses;
        let from = kept.partition_point(|kept| kept.parts < touch.parts);
        let own = kept[from..].iter().take_while(|k| k.parts == touch.parts);
        let along = |kept: &KeptImpulse| kept.normal.dot(&touch.normal);
        let last = own.max_by(|a, b| along(a).total_cmp(&along(b)));
        last.is_some_and(|last| last.has_slipped && SAME_FOOT < along(last))
    }

    /// Notes what slipped in this step; `kept` are the impulses of the touches, in their order.
    pub(super) fn note_slip(&self, touches: &[Touch], kept: &mut [KeptImpulse]) {
        if !self.has_residual_friction() {
            return;
        }
        let mut first = 0;
        for of_parts in touches.chunk_by(|a, b| a.parts == b.parts) {
            let rows = first..first + of_parts.len();
            first = rows.end;
            let joint = self.joint_between(of_parts[0].parts);
            if joint.residual_friction == joint.friction {
                continue;
            }
            let is_of_sphere = self.is_of_sphere(&of_parts[0]);
            let slips: Vec<bool> = (of_parts.iter().zip(rows.clone()))
                .map(|(touch, own)| match is_of_sphere {
                    true => kept[own].state == ContactState::Slide,
                    false => touch.has_slipped || slides(of_parts, &kept[rows.clone()], touch),
                })
                .collect();
            for (kept, slips) in kept[rows].iter_mut().zip(slips) {
                kept.has_slipped = slips;
            }
        }
    }
}

/// Whether all points in the direction of one are at their bound.
fn slides(touches: &[Touch], kept: &[KeptImpulse], one: &Touch) -> bool {
    let [mut pressed, mut bound, mut sheared] = [0.0; 3];
    for (touch, kept) in touches.iter().zip(kept) {
        if touch.normal.dot(&one.normal) > ONE_FOOT {
            let along = kept.impulse.dot(&touch.normal);
            pressed += along;
            bound += touch.friction * along;
            sheared += (kept.impulse - touch.normal * along).norm();
        }
    }
    0.0 < pressed && bound * (1.0 - AT_THE_BOUND) <= sheared
}
