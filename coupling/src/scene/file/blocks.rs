//! Single blocks, walls and wavemakers: where they are, how they move and deform.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Axis, ShapeFile, Triple, WavesFile, one};

/// One block, wall or wavemaker.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BlockFile {
    /// Unique name.
    pub name: String,
    /// Name of its material.
    pub material: String,
    /// Geometry before `placement`.
    pub shape: ShapeFile,
    /// Rotation and translation of the shape.
    #[serde(default)]
    pub placement: PlacementFile,
    /// Type of motion.
    #[serde(default)]
    pub motion: MotionFile,
    /// Initial velocity of the centroid, free blocks only; m/s.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m/s"))]
    pub velocity: Triple,
    /// Initial angular velocity, free blocks only; rad/s.
    #[serde(default)]
    #[schemars(extend("x-unit" = "rad/s"))]
    pub angular_velocity: Triple,
    /// Makes a free block deformable; its material must have elastic moduli. Rigid when left out.
    #[serde(default)]
    pub deformable: Option<DeformableFile>,
    /// Constraints on a free, rigid block.
    #[serde(default)]
    pub hold: Option<HoldFile>,
    /// Keeps water out of the joints between a free block and its support where these are too narrow for particles:
    /// no uplift until the two part. Otherwise the pressure there is that of seepage between the bodies of water to which the joint is
    /// open.
    #[serde(default)]
    pub sealed: bool,
    /// Name of the blocks that it belongs to, for tables, messages and VTK files: the rock mass, the slide or the grains that it was
    /// made of; none when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub group: Option<String>,
    /// Faces on joints, of a block that is a `Polyhedron` or `Polyhedra`; as cut by the joint sets of a rock mass or a slide.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub joint_faces: Vec<JointFacesFile>,
}

/// Faces of a block on the joints of one set.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JointFacesFile {
    /// Name of the joint set.
    pub set: String,
    /// Numbers of the faces from 0, part after part.
    pub faces: Vec<u32>,
}

/// A rotation about an axis through a point, then a translation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlacementFile {
    /// The rotation.
    #[serde(default)]
    pub rotate: Option<RotationFile>,
    /// The translation, after the rotation; m.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m"))]
    pub translate: Triple,
}

/// A right-handed rotation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RotationFile {
    /// Direction of the axis; any nonzero length.
    #[schemars(extend("x-unit" = "-"))]
    pub axis: Triple,
    /// Angle; degrees.
    #[schemars(extend("x-unit" = "degrees"))]
    pub angle_deg: f64,
    /// Point on the axis; m.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m"))]
    pub about: Triple,
}

/// Motion of a block.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum MotionFile {
    /// By the forces on it.
    #[default]
    Free,
    /// None.
    Fixed,
    /// Oscillation along a line: `amplitude · ramp(t) · sin(2π t/period + phase)`, with a ramp rising smoothly from 0
    /// to 1.
    Sinusoid {
        /// Direction; any nonzero length.
        #[schemars(extend("x-unit" = "-"))]
        direction: Triple,
        /// Half the stroke; m.
        #[schemars(extend("x-unit" = "m", "minimum" = 0))]
        amplitude: f64,
        /// Period; s.
        #[schemars(extend("x-unit" = "s", "exclusiveMinimum" = 0))]
        period: f64,
        /// Phase; degrees.
        #[serde(default)]
        #[schemars(extend("x-unit" = "degrees"))]
        phase_deg: f64,
        /// Duration of the smooth start; s.
        #[serde(default)]
        #[schemars(extend("x-unit" = "s", "minimum" = 0))]
        ramp: f64,
    },
    /// Motion of a piston that makes waves in the still water before it.
    Waves {
        /// Horizontal direction into the water; any nonzero length.
        #[schemars(extend("x-unit" = "-"))]
        direction: Triple,
        /// Waves.
        waves: WavesFile,
        /// Depth of the still water; m. As it is before the piston when left out.
        #[serde(default)]
        #[schemars(extend("x-unit" = "m", "exclusiveMinimum" = 0))]
        depth: Option<f64>,
        /// Duration of the smooth start, of waves with a period; s. A period when left out.
        #[serde(default)]
        #[schemars(extend("x-unit" = "s", "minimum" = 0))]
        ramp: Option<f64>,
        /// Whether the piston takes out the waves that come back to it, by the surface before it.
        #[serde(default)]
        absorb: bool,
    },
    /// A record: CSV with columns time (s), displacement x, y, z (m) and, for a rotating block, the rotation vector
    /// rx, ry, rz about the centroid (degrees), or in the units of its header, `x [mm]` or `x_mm`; `#` comments.
    Table {
        /// Path, relative to the scene file.
        file: String,
    },
    /// Along a path in a plane, as on a bed: the block turns as the path does, which has arcs at its bends.
    Path {
        /// Points of the path, at least two; m.
        #[schemars(extend("x-unit" = "m"))]
        points: Vec<Triple>,
        /// Radius of the arcs; as large as half of the shorter piece beside a bend allows when left out or too large; m.
        #[serde(default)]
        #[schemars(extend("x-unit" = "m", "exclusiveMinimum" = 0))]
        bend_radius: Option<f64>,
        /// Length of the base of the block, both of whose ends stay on the path; the block follows the direction at one point
        /// when 0; m.
        #[serde(default)]
        #[schemars(extend("x-unit" = "m", "minimum" = 0))]
        base: f64,
        /// Path of a record, relative to the scene file: CSV with columns time (s) and way (m), or in the units of its header,
        /// `way [mm]`; `#` comments. The way is that of the point, or of the middle between the ends of the base, along the path
        /// from its first point; the block is drawn where it is at the first time.
        file: String,
    },
    /// Base excitation by a record of acceleration, integrated twice from rest: CSV with columns time (s, in equal
    /// steps from 0) and acceleration (m/s²), or in the units of its header, `a [g]`; `#` comments.
    Shaking {
        /// Direction; any nonzero length.
        #[schemars(extend("x-unit" = "-"))]
        direction: Triple,
        /// Path, relative to the scene file.
        file: String,
    },
}

/// Deformation of a block: one uniform strain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeformableFile {
    /// Kinematics and stress law.
    #[serde(default)]
    pub model: DeformableModelFile,
    /// Stress at t = 0: xx, yy, zz, yz, zx, xy, tension positive; Pa.
    #[serde(default)]
    #[schemars(extend("x-unit" = "Pa"))]
    pub initial_stress: (f64, f64, f64, f64, f64, f64),
    /// Factor on the inertia of the strain modes, at least 1: a larger step for slower oscillations. Not with contact dynamics, whose
    /// step strain does not limit.
    #[serde(default = "one")]
    #[schemars(extend("x-unit" = "-"))]
    pub strain_mass_factor: f64,
}

/// Kinematics and stress law of a deformable block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum DeformableModelFile {
    /// Exact affine motion, stress of Saint Venant and Kirchhoff.
    #[default]
    Affine,
    /// Exact affine motion, stress linear in the stretch.
    Corotational,
    /// The unknowns of classical DDA, corrected; for comparison with the literature.
    Classical,
}

/// Directions in which a block does not move, and constraints on its rotation. Constraint forces do no work.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HoldFile {
    /// Directions in which the centroid does not move.
    #[serde(default)]
    pub directions: Vec<Axis>,
    /// Rotation of the block.
    #[serde(default)]
    pub turning: TurningFile,
}

/// Rotation of a held block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum TurningFile {
    /// Unconstrained.
    #[default]
    Free,
    /// About this axis only.
    About(Axis),
    /// None.
    Held,
}
