//! The step of contact dynamics: as given, shorter where blocks move too far in it.

use super::super::step_bound::CriticalStep;
use crate::motion::deformation::{Affine12, Deformable};
use crate::motion::kinematics::Kinematics;
use crate::motion::rigid::is_isotropic;
use crate::{Blocks, ContactDynamics};

/// Way of a block in a step, × its size: normals and arms of contacts are those of the middle of the step.
const LARGEST_WAY: f64 = 0.2;
/// Rotation of a block in a step that is no sphere; rad.
const LARGEST_TURN: f64 = 0.1;

impl Blocks {
    /// The step as given, or the longest in which no free block moves by more than a fifth of its smallest part or turns by more than
    /// 0.1 rad, and that supports and bolts, which remain springs, allow:
    ///
    /// ```text
    /// |v| dt ≤ 0.2 L,   |ω| dt ≤ 0.1,   dt ≤ C_b 2/√Λ_K                                            [s]
    /// ```
    /// Blocks that deform strain and turn by less than 0.1, and stay within the bound of the stiffness by their stress, which is explicit.
    pub(crate) fn step_of_contact_dynamics(&self, dynamics: &ContactDynamics) -> CriticalStep {
        let attached = self.attached_stiffness();
        let path = self.fastest_path();
        let mut step = CriticalStep {
            dt: dynamics.time_step,
            block: None,
            contact: None,
            is_by_speed: false,
        };
        for b in (0..self.n_blocks()).filter(|&b| self.is_driven(b)) {
            let parts = self.parts_of(b);
            let size = self.constants.size[parts].iter().copied();
            let size = size.fold(f64::INFINITY, f64::min);
            let body = &self.state.kinematics[b];
            let mut dt = LARGEST_WAY * size / (body.velocity.norm() + path);
            if !is_isotropic(&self.constants.inertia[b]) {
                dt = dt.min(LARGEST_TURN / body.spin.norm());
            }
            if let Some(k) = self.constants.deformable_of[b] {
                let affine = &self.state.deformables[k as usize];
                dt = dt.min(self.step_of_strain(body, affine));
            }
            if let Some(rate) = attached.get(b).filter(|rate| 0.0 < **rate) {
                let factor = self.constants.settings.time_step_factor;
                dt = dt.min(factor * 2.0 / rate.sqrt());
            }
            if dt < step.dt {
                (step.dt, step.block) = (dt, Some(b));
            }
        }
        step
    }

    /// Step in which a block turns and strains by less than 0.1, and which the stiffness by its stress allows; s.
    fn step_of_strain(&self, body: &Kinematics, deformable: &Deformable) -> f64 {
        let strain_rate = body.strain_rate.map_or(0.0, |rate| rate.norm());
        let stress_rate = deformable.affine().map_or(0.0, Affine12::stress_rate);
        let stable = 2.0 * self.constants.settings.time_step_factor / stress_rate.sqrt();
        stable.min(LARGEST_TURN / (body.spin.norm() + strain_rate))
    }

    /// Notes by how much a part may come closer to others within `dt` (s), which the search for pairs must cover.
    pub(super) fn note_reach(&mut self, dt: f64) {
        let mut reach = std::mem::take(&mut self.scratch.reach);
        reach.clear();
        reach.extend(
            (self.constants.block_of_part.iter()).map(|&block| self.approach(block as usize, dt)),
        );
        self.scratch.reach = reach;
    }
}
