//! Single blocks, walls and wavemakers: where they are, how they move and deform.

use serde::{Deserialize, Serialize};

use super::{Axis, ShapeFile, Triple, one};

/// One block, wall or wavemaker.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BlockFile {
    /// Unique name.
    pub name: String,
    /// Name of its material.
    pub material: String,
    /// Geometry before `placement`.
    pub shape: ShapeFile,
    /// Turn and shift of the shape.
    #[serde(default)]
    pub placement: PlacementFile,
    /// How it moves.
    #[serde(default)]
    pub motion: MotionFile,
    /// Initial velocity of the centroid, free blocks only; m/s.
    #[serde(default)]
    pub velocity: Triple,
    /// Initial angular velocity, free blocks only; rad/s.
    #[serde(default)]
    pub angular_velocity: Triple,
    /// Makes a free block deformable; its material must have elastic moduli. Rigid when left out.
    #[serde(default)]
    pub deformable: Option<DeformableFile>,
    /// What a free, rigid block may not do.
    #[serde(default)]
    pub hold: Option<HoldFile>,
    /// No water gets into the joints between a free block and what it rests on or leans against, where these are
    /// too narrow for particles: no uplift. Otherwise the pressure there is that of seepage between what water the
    /// joint is open to.
    #[serde(default)]
    pub sealed: bool,
}

/// A turn about an axis through a point, then a shift.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlacementFile {
    /// The turn.
    #[serde(default)]
    pub rotate: Option<RotationFile>,
    /// The shift, after the turn; m.
    #[serde(default)]
    pub translate: Triple,
}

/// A turn, right-handed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RotationFile {
    /// Direction of the axis; any length but zero.
    pub axis: Triple,
    /// Angle; degrees.
    pub angle_deg: f64,
    /// Point on the axis; m.
    #[serde(default)]
    pub about: Triple,
}

/// How a block moves.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum MotionFile {
    /// By the forces on it.
    #[default]
    Free,
    /// Not at all.
    Fixed,
    /// Back and forth along a line:
    /// `amplitude · ramp(t) · sin(2π t/period + phase)`, ramp rising smoothly from 0 to 1.
    Sinusoid {
        /// Direction; any length but zero.
        direction: Triple,
        /// Half the stroke; m.
        amplitude: f64,
        /// Period; s.
        period: f64,
        /// Phase; degrees.
        #[serde(default)]
        phase_deg: f64,
        /// Time of the smooth start; s.
        #[serde(default)]
        ramp: f64,
    },
    /// Along a record: CSV with columns time (s), displacement x, y, z (m) and, where it turns, the rotation vector
    /// rx, ry, rz about the centroid (degrees); `#` comments.
    Table {
        /// Path, relative to the scene file.
        file: String,
    },
    /// Base shaking by a record of acceleration, integrated twice from rest: CSV with columns time
    /// (s, in equal steps from 0) and acceleration (m/s²); `#` comments.
    Shaking {
        /// Direction; any length but zero.
        direction: Triple,
        /// Path, relative to the scene file.
        file: String,
    },
}

/// How a block deforms: one strain for the whole block.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DeformableFile {
    /// Kinematics and stress law.
    #[serde(default)]
    pub model: DeformableModelFile,
    /// Stress at t = 0: xx, yy, zz, yz, zx, xy, tension positive; Pa.
    #[serde(default)]
    pub initial_stress: (f64, f64, f64, f64, f64, f64),
    /// Factor on the inertia of the strain modes, at least 1: a larger step for a slower swing.
    #[serde(default = "one")]
    pub strain_mass_factor: f64,
}

/// Kinematics and stress law of a deformable block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum DeformableModelFile {
    /// Exact affine motion, stress of Saint Venant and Kirchhoff.
    #[default]
    Affine,
    /// Exact affine motion, stress linear in the stretch.
    Corotational,
    /// The unknowns of classical DDA, corrected; for comparison with the literature.
    Classical,
}

/// Directions in which a block does not move, and how it may turn. Holding forces do no work.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HoldFile {
    /// Directions in which the centroid does not move.
    #[serde(default)]
    pub directions: Vec<Axis>,
    /// How the block may turn.
    #[serde(default)]
    pub turning: TurningFile,
}

/// How a held block may turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum TurningFile {
    /// As forces make it.
    #[default]
    Free,
    /// About this axis only.
    About(Axis),
    /// Not at all.
    Held,
}
