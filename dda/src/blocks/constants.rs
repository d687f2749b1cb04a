//! Constants of the blocks: set when the system is built, the same in every step.

use crate::contact::context::OverlapLimits;
use crate::geometry::parts::Part;
use crate::material::Joint;
use crate::motion::kinematics::LeverArm;
use crate::{Hold, Motion, Settings, Vec3};
use nalgebra::UnitQuaternion;

/// Constants of a system of blocks. Columns are one per block unless noted.
#[derive(Clone, Debug, Default)]
pub(crate) struct Constants {
    /// Free, fixed or on a prescribed path.
    pub motion: Vec<Motion>,
    /// Position among the deformable blocks, if it is one.
    pub deformable_of: Vec<Option<u32>>,
    /// Directions in which a free block is held; empty if no block is.
    pub holds: Vec<Option<Hold>>,
    /// Mass; kg.
    pub mass: Vec<f64>,
    /// Volume; m³.
    pub volume: Vec<f64>,
    /// Principal moments of inertia; kg m².
    pub inertia: Vec<Vec3>,
    /// Initial placement from principal axes.
    pub principal: Vec<UnitQuaternion<f64>>,
    /// Centroid at t = 0, before the displacement of a prescribed path; m.
    pub initial_centroid: Vec<Vec3>,
    /// Distance of the farthest point from the centroid; m.
    pub radius: Vec<f64>,
    /// Worst point of contact.
    pub lever_arm: Vec<LeverArm>,
    /// Twice the longest way in a step: the least margin of the fat boxes of its parts, of spheres that along an axis; m.
    pub least_margin: Vec<f64>,
    /// First part of each block, then the number of parts; n_blocks + 1.
    pub part_start: Vec<u32>,
    /// Block of each part.
    pub block_of_part: Vec<u32>,
    /// Material of each part.
    pub material_of_part: Vec<u32>,
    /// Geometry about the initial centroid, in the initial axes; one per part.
    pub reference: Vec<Part>,
    /// Margin of the fat box at rest, zero if the part cannot move; one per part; m.
    pub margin: Vec<f64>,
    /// Cube root of the volume; one per part; m.
    pub size: Vec<f64>,
    /// Smallest thickness, infinite for a surface; one per part; m.
    pub thickness: Vec<f64>,
    /// True if a joint resists rolling.
    pub has_rolling: bool,
    /// Contact constants of every pair of materials before any weakening, row by row.
    pub initial_joints: Vec<Joint>,
    /// Number of materials.
    pub n_materials: usize,
    /// Parameters of the solver.
    pub settings: Settings,
}

impl Constants {
    /// Overlaps that a step allows.
    pub fn overlap_limits(&self) -> OverlapLimits<'_> {
        OverlapLimits {
            share_of_size: self.settings.overlap_limit,
            size: &self.size,
            thickness: &self.thickness,
        }
    }
}
