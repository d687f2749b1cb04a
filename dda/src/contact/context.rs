//! Surroundings of the contacts: bodies, joints and settings.

use crate::contact::detection::common_plane::ContactDetection;
use crate::contact::tally::Tally;
use crate::geometry::parts::Part;
use crate::material::{Joint, RollingLaw};
use crate::motion::kinematics::{Kinematics, LeverArm};
use crate::motion::update::Update;
use crate::{Motion, StepBound, Vec3};

/// Context of the contact law beyond the pair itself.
pub(crate) struct ContactContext<'a> {
    pub parts: &'a [Part],
    pub kinematics: &'a [Kinematics],
    pub update: &'a [Update],
    pub motion: &'a [Motion],
    pub joints: &'a [Joint],
    pub material_of_part: &'a [u32],
    pub n_materials: usize,
    pub rolling_law: RollingLaw,
    /// Farthest point of each block from its centroid; m.
    pub radius: &'a [f64],
    /// Way of the farthest point of each rigid block since the start, or more; m.
    pub travel: &'a [f64],
    /// Worst point of contact of each block.
    pub lever_arm: &'a [LeverArm],
    pub contact_detection: ContactDetection,
    pub step_bound: StepBound,
    /// m/s².
    pub gravity: Vec3,
    /// Is Hertz's law used for spheres?
    pub is_hertz: bool,
    /// Overlaps that a step allows.
    pub overlap_limits: OverlapLimits<'a>,
}

/// Sum of the travels of two blocks; m.
pub(crate) fn travel_of(travel: &[f64], blocks: (u32, u32)) -> f64 {
    travel[blocks.0 as usize] + travel[blocks.1 as usize]
}

impl<'a> ContactContext<'a> {
    /// Sum of the travels of two blocks; m.
    pub fn travel_of(&self, blocks: (u32, u32)) -> f64 {
        travel_of(self.travel, blocks)
    }

    /// Do both lie still, one of them asleep? Their contact is then as it was.
    pub fn are_still(&self, blocks: (u32, u32)) -> bool {
        let updates = [blocks.0, blocks.1].map(|block| self.update[block as usize]);
        let is_still = |block: u32, update: Update| match update {
            Update::Asleep => true,
            Update::Fixed => matches!(self.motion[block as usize], Motion::Fixed),
            Update::Rigid | Update::Constrained => false,
        };
        updates.contains(&Update::Asleep)
            && is_still(blocks.0, updates[0])
            && is_still(blocks.1, updates[1])
    }

    pub fn joint_of(&self, parts: (u32, u32)) -> &'a Joint {
        let material = |part: u32| self.material_of_part[part as usize] as usize;
        &self.joints[material(parts.0) * self.n_materials + material(parts.1)]
    }

    /// Records the deepest overlap (m) of two parts.
    pub fn note_overlap(&self, parts: (u32, u32), overlap: f64, tally: &mut Tally) {
        let over_allowed = overlap / self.overlap_limits.of(parts);
        let over_size = overlap / self.overlap_limits.size_of(parts);
        tally.note_overlap(parts, over_allowed, over_size);
    }
}

/// Overlap allowed, × mean thickness of two parts. At 1 their mid-planes have passed each other, and contact would push them out
/// on the wrong side.
const THICKNESS_SHARE: f64 = 0.5;

/// Overlaps that a step allows between parts: a share of the size of the smaller, and so little of their thickness that none comes
/// out on the other side.
#[derive(Clone, Copy)]
pub(crate) struct OverlapLimits<'a> {
    /// Share of the size; –.
    pub share_of_size: f64,
    /// Of each part; m.
    pub size: &'a [f64],
    /// Of each part, infinite for a surface; m.
    pub thickness: &'a [f64],
}

impl OverlapLimits<'_> {
    /// Overlap allowed between two parts; m. A part on a surface counts by its own thickness.
    pub fn of(&self, parts: (u32, u32)) -> f64 {
        let (i, j) = (parts.0 as usize, parts.1 as usize);
        let (a, b) = (self.thickness[i], self.thickness[j]);
        let thickness = if a.is_finite() && b.is_finite() {
            0.5 * (a + b)
        } else {
            a.min(b)
        };
        f64::min(
            self.share_of_size * self.size_of(parts),
            THICKNESS_SHARE * thickness,
        )
    }

    /// Size of the smaller of two parts; m.
    pub fn size_of(&self, parts: (u32, u32)) -> f64 {
        self.size[parts.0 as usize].min(self.size[parts.1 as usize])
    }
}
