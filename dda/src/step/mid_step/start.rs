//! Impulses from step to step: what the last one found is where the next one starts.

use super::closing::Closing;
use super::touches::Touch;
use crate::contact::dynamics::bodies::Point;
use crate::contact::dynamics::kept::KeptImpulse;
use crate::contact::report::ContactState;
use crate::{Blocks, Vec3};

/// Distance from the friction bound within which a point slides, × the bound.
pub(super) const AT_THE_BOUND: f64 = 1e-9;

/// State of a point with an impulse in its frame.
fn state_of(friction: f64, impulse: &Vec3) -> ContactState {
    let bound = friction * impulse.x;
    if impulse.x <= 0.0 {
        ContactState::Open
    } else if impulse.y.hypot(impulse.z) < bound * (1.0 - AT_THE_BOUND) {
        ContactState::Stick
    } else {
        ContactState::Slide
    }
}

impl Blocks {
    /// Impulses of the last step for this one; N s. Each goes to the nearest point of its parts: corners of faces that lie on each
    /// other change their names by round-off, and their sum should not.
    pub(super) fn impulses_before(&self, closing: &Closing, dt: f64) -> Vec<Vec3> {
        let Closing {
            touches,
            points,
            rolling,
            ..
        } = closing;
        let mut impulses = vec![Vec3::zeros(); points.len()];
        // two at most, one across the normal and one along it
        let mut resisting = vec![[None; 2]; touches.len()];
        for (row, rolling) in (touches.len()..).zip(rolling) {
            resisting[rolling.contact as usize][rolling.axis as usize] = Some(row);
        }
        let mut first = 0;
        for group in touches.chunk_by(|a, b| a.parts == b.parts) {
            let parts = group[0].parts;
            let kept = &self.state.impulses;
            let from = kept.partition_point(|kept| kept.parts < parts);
            for kept in kept[from..].iter().take_while(|kept| kept.parts == parts) {
                let away = |touch: &Touch| (touch.position - kept.position).norm_squared();
                let nearest =
                    (group.iter().enumerate()).min_by(|a, b| away(a.1).total_cmp(&away(b.1)));
                if let Some((k, _)) = nearest {
                    let at = first + k;
                    impulses[at] += points[at].frame.tr_mul(&kept.impulse) * (dt / kept.dt);
                    for row in resisting[at].into_iter().flatten() {
                        let frame = &points[row].frame;
                        let column = frame.column_iter().map(|c| c.norm_squared());
                        let square = column.fold(0.0, f64::max);
                        impulses[row] += frame.tr_mul(&kept.torque) * (dt / (kept.dt * square));
                    }
                }
            }
            first += group.len();
        }
        self.recall_bonds(closing, &mut impulses, dt);
        self.recall_joints(closing, &mut impulses, dt);
        impulses
    }

    /// Keeps the impulses of this step for the next one, and those between blocks asleep.
    pub(super) fn keep_impulses(
        &mut self,
        touches: &[Touch],
        points: &[Point],
        impulses: &[Vec3],
        torques: &[(u32, Vec3)],
        dt: f64,
    ) {
        let rows = touches.iter().zip(points).zip(impulses);
        let mut found: Vec<KeptImpulse> = rows
            .map(|((touch, point), impulse)| KeptImpulse {
                parts: touch.parts,
                blocks: touch.blocks.into(),
                position: touch.position,
                normal: touch.normal,
                gap: touch.gap,
                impulse: point.frame * impulse,
                torque: Vec3::zeros(),
                dt,
                state: state_of(touch.friction, impulse),
                has_slipped: touch.has_slipped,
            })
            .collect();
        for (contact, torque) in torques {
            found[*contact as usize].torque += *torque;
        }
        self.note_slip(touches, &mut found);
        let mut kept = std::mem::take(&mut self.state.impulses);
        kept.retain(|kept| !self.is_solved(kept.blocks));
        kept.append(&mut found);
        self.state.impulses = kept;
        self.state.impulses.sort_by_key(|kept| kept.parts);
    }
}
