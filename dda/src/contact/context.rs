//! Surroundings of the contacts: bodies, joints and settings.

use crate::contact::detection::common_plane::ContactDetection;
use crate::contact::tally::Tally;
use crate::geometry::parts::Part;
use crate::material::{Joint, RollingLaw};
use crate::motion::kinematics::Kinematics;
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
    /// `ξ` of the shear dashpot; –.
    pub shear_damping_ratio: f64,
    pub rolling_law: RollingLaw,
    /// Farthest point of each block from its centroid; m.
    pub radius: &'a [f64],
    /// Lever of the worst contact of each block; m.
    pub lever: &'a [f64],
    pub contact_detection: ContactDetection,
    pub step_bound: StepBound,
    /// m/s².
    pub gravity: Vec3,
    /// Is Hertz's law used for spheres?
    pub is_hertz: bool,
    /// Of each part; m.
    pub size: &'a [f64],
    pub deepest_allowed: &'a [f64],
}

impl<'a> ContactContext<'a> {
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
        let over_allowed = overlap / least_of(parts, self.deepest_allowed);
        tally.note_overlap(parts, over_allowed, overlap / least_of(parts, self.size));
    }
}

/// The lesser of both parts' values.
pub(crate) fn least_of(parts: (u32, u32), of: &[f64]) -> f64 {
    of[parts.0 as usize].min(of[parts.1 as usize])
}
