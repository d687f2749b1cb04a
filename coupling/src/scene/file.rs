//! The scene as it is written: the RON schema, nothing checked beyond types.
//!
//! Units are SI; angles are in degrees, and a field that is not SI says so in its name. A field of
//! type `Option` has no fixed default: `None` means "riprap chooses", and the choice is written
//! into the run folder's `case.ron`, so that a scene read from there leaves nothing open.
//! `cases/README.md` documents every field; a test holds that table against these types.

use serde::{Deserialize, Serialize};

/// A vector or point as written, `(x, y, z)`.
pub type Triple = (f64, f64, f64);

/// A whole scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// One line that names the experiment.
    pub title: String,
    /// What is modelled, after whom, and what is known of the right answer.
    #[serde(default)]
    pub description: String,
    /// Acceleration of gravity; m/s².
    #[serde(default = "standard_gravity")]
    pub gravity: Triple,
    /// The box outside of which nothing is modelled.
    pub domain: DomainFile,
    /// Rock and wall materials, referred to by name.
    #[serde(default)]
    pub materials: Vec<MaterialFile>,
    /// What holds between two materials in place of what follows from the two.
    #[serde(default)]
    pub joints: Vec<JointFile>,
    /// Rock blocks, walls and wavemakers.
    #[serde(default)]
    pub blocks: Vec<BlockFile>,
    /// Bodies to be cut into blocks by joint sets; the blocks join the list of blocks.
    #[serde(default)]
    pub rock_masses: Vec<RockMassFile>,
    /// Balls in bulk; they join the list of blocks.
    #[serde(default)]
    pub grains: Vec<GrainsFile>,
    /// Loads, supports and rock bolts on blocks.
    #[serde(default)]
    pub attachments: Vec<AttachmentFile>,
    /// Water; without it no fluid structure is made.
    #[serde(default)]
    pub fluid: Option<FluidFile>,
    /// Layers that take the motion out of waves before they meet the end of the domain.
    #[serde(default)]
    pub absorbers: Vec<AbsorberFile>,
    /// Where water comes in.
    #[serde(default)]
    pub inflows: Vec<InflowFile>,
    /// Where water goes out.
    #[serde(default)]
    pub outflows: Vec<OutflowFile>,
    /// How fluid and blocks push each other.
    #[serde(default)]
    pub interface: InterfaceFile,
    /// Schemes and their numbers.
    #[serde(default)]
    pub numerics: NumericsFile,
    /// How long.
    pub time: TimeFile,
    /// What is recorded, as in a laboratory.
    #[serde(default)]
    pub gauges: Vec<GaugeFile>,
    /// Ways of falling blocks: run-out, bounce height, speed and energy; not followed when left out.
    #[serde(default)]
    pub trajectories: Option<TrajectoriesFile>,
    /// What is written, and how often.
    #[serde(default)]
    pub output: OutputFile,
    /// The eye of `riprap render`; fitted to the scene when left out.
    #[serde(default)]
    pub camera: Option<CameraFile>,
}

/// The modelled box.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DomainFile {
    /// Lower corner; m.
    pub min: Triple,
    /// Upper corner; m.
    pub max: Triple,
    /// Directions in which the fluid repeats itself with the period of the box. A slab a few
    /// spacings thick and periodic across makes a 2-D flume at a 2-D price.
    #[serde(default)]
    pub periodic: Vec<Axis>,
    /// Sides that are planes of symmetry: half of a symmetric flow stands for the whole. Water and blocks beyond
    /// are the mirror image of what is before; free blocks may not touch such a side.
    #[serde(default)]
    pub symmetry: Vec<SideFile>,
    /// What becomes of a particle or block that leaves.
    #[serde(default)]
    pub leaving: Leaving,
    /// Whether the flow is in space or in a vertical plane along x; then nothing depends on y, and masses and
    /// forces are those of a slice as wide as the domain.
    #[serde(default)]
    pub dimensions: DimensionsFile,
}

/// A coordinate direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Axis {
    /// Along x.
    X,
    /// Along y.
    Y,
    /// Along z, up.
    Z,
}

impl SceneFile {
    /// Files that the scene names, relative to its folder.
    pub fn referenced_files(&self) -> Vec<&str> {
        let mut files = Vec::new();
        let shapes = self.blocks.iter().map(|block| &block.shape);
        let boundaries = self.rock_masses.iter().map(|mass| &mass.boundary);
        for shape in shapes.chain(boundaries) {
            if let ShapeFile::Mesh { file, .. }
            | ShapeFile::Surface { file, .. }
            | ShapeFile::Raster { file, .. } = shape
            {
                files.push(file.as_str());
            }
        }
        for block in &self.blocks {
            if let MotionFile::Table { file } | MotionFile::Shaking { file, .. } = &block.motion {
                files.push(file.as_str());
            }
        }
        files
    }
}

impl Axis {
    /// 0, 1, 2 for x, y, z.
    pub fn index(self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
            Self::Z => 2,
        }
    }
}

/// What becomes of a particle or block that leaves the domain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Leaving {
    /// It is removed and counted; its mass, momentum and energy are booked as removed.
    #[default]
    Removed,
    /// The run stops with an error that names it.
    Error,
}

/// A rock or wall material. Where two meet, the lesser friction, cohesion, tension and
/// restitution hold, and the stiffnesses act in series; `joints` can say otherwise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialFile {
    /// Name that blocks refer to.
    pub name: String,
    /// Density; kg/m³.
    pub density: f64,
    /// Friction angle of its joints; degrees.
    pub friction_angle_deg: f64,
    /// Friction angle of a joint once it has slipped or broken; the same when left out; degrees.
    #[serde(default)]
    pub residual_friction_angle_deg: Option<f64>,
    /// Cohesion of a joint until it breaks; Pa.
    #[serde(default)]
    pub cohesion: f64,
    /// Cohesion of a joint that has broken, at most `cohesion`; Pa.
    #[serde(default)]
    pub residual_cohesion: f64,
    /// Tensile strength of a joint until it breaks; Pa.
    #[serde(default)]
    pub tensile_strength: f64,
    /// Normal restitution, 0 to 1.
    #[serde(default)]
    pub restitution: f64,
    /// Contact penalty stiffness of a block of this material; N/m.
    #[serde(default)]
    pub contact_stiffness: Option<f64>,
    /// Normal stiffness of its joints per area; where both materials have one it holds instead of
    /// `contact_stiffness`; Pa/m.
    #[serde(default)]
    pub joint_stiffness: Option<f64>,
    /// Shear over normal penalty stiffness.
    #[serde(default = "default_shear_stiffness_ratio")]
    pub shear_stiffness_ratio: f64,
    /// Resistance of balls to rolling: torque over normal force and effective radius. Where two materials
    /// meet, their mean.
    #[serde(default)]
    pub rolling_friction: f64,
    /// Elastic moduli, which deformable blocks and Hertz's law need; rigid blocks ignore them.
    #[serde(default)]
    pub elastic: Option<ElasticFile>,
}

/// Isotropic linear elasticity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ElasticFile {
    /// Young's modulus; Pa.
    pub young_modulus: f64,
    /// Poisson's ratio, above -1 and below 0.5.
    pub poisson_ratio: f64,
    /// Viscosity of the strain rate; Pa s.
    #[serde(default)]
    pub viscosity: f64,
}

/// What holds between two materials, or within one named twice; what is left out follows from the two.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointFile {
    /// Names of the two materials, in either order.
    pub between: (String, String),
    /// Friction angle; degrees.
    #[serde(default)]
    pub friction_angle_deg: Option<f64>,
    /// Friction angle once the joint has slipped or broken; that of this joint when left out, if it has one;
    /// degrees.
    #[serde(default)]
    pub residual_friction_angle_deg: Option<f64>,
    /// Cohesion until the joint breaks; Pa.
    #[serde(default)]
    pub cohesion: Option<f64>,
    /// Cohesion once the joint has broken, at most the cohesion; Pa.
    #[serde(default)]
    pub residual_cohesion: Option<f64>,
    /// Tensile strength until the joint breaks; Pa.
    #[serde(default)]
    pub tensile_strength: Option<f64>,
    /// Normal restitution, 0 to 1.
    #[serde(default)]
    pub restitution: Option<f64>,
    /// Resistance of balls to rolling: torque over normal force and effective radius.
    #[serde(default)]
    pub rolling_friction: Option<f64>,
}

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
}

/// A body cut into free blocks, named `name.0001` and on, by joint sets, one after the other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RockMassFile {
    /// Unique name.
    pub name: String,
    /// Name of its material.
    pub material: String,
    /// The body before it is cut: any shape but a ball.
    pub boundary: ShapeFile,
    /// The joints.
    pub joint_sets: Vec<JointSetFile>,
    /// Of the random numbers of scatter and persistence.
    #[serde(default)]
    pub seed: u64,
    /// Joins slivers with the neighbour with which they share the largest area; kept when left out.
    #[serde(default)]
    pub merge_slivers: Option<SliversFile>,
    /// Smaller blocks are left out, after slivers are merged, and counted; m³.
    #[serde(default)]
    pub minimum_volume: f64,
    /// More blocks are refused.
    #[serde(default = "default_maximum_blocks")]
    pub maximum_blocks: u32,
    /// Makes the blocks deformable.
    #[serde(default)]
    pub deformable: Option<DeformableFile>,
}

/// Which blocks of a rock mass are slivers: those that pass either limit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SliversFile {
    /// Less than this share of the median volume, 0 to 1.
    #[serde(default = "default_volume_share")]
    pub volume_share: f64,
    /// Longer than this many times their smallest thickness, at least 2.
    #[serde(default = "default_aspect")]
    pub aspect: f64,
}

/// Joints of one orientation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointSetFile {
    /// Dip, down from the horizontal, 0 to 90; degrees.
    pub dip_deg: f64,
    /// Dip direction, clockwise from north (+y); degrees.
    pub dip_direction_deg: f64,
    /// Distance of the joints; m.
    pub spacing: f64,
    /// A point through which one joint passes; m.
    #[serde(default)]
    pub origin: Triple,
    /// Chance that a joint cuts a block which it meets, 0 to 1.
    #[serde(default = "one")]
    pub persistence: f64,
    /// Standard deviation of the tilt of a joint about each of two axes; tilts beyond three of them are
    /// drawn again; degrees.
    #[serde(default)]
    pub scatter_deg: f64,
    /// A joint lies off its place by at most this share of the spacing, 0 to 0.5.
    #[serde(default)]
    pub spacing_scatter: f64,
}

/// Free balls, named `name_0001` and on, on a cubic lattice, filled in from below. None overlap at the start.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GrainsFile {
    /// Unique name.
    pub name: String,
    /// Name of their material.
    pub material: String,
    /// Where they are at the start; no ball reaches out of it.
    pub region: GrainRegionFile,
    /// Smallest and largest diameter, the same for equal balls; all between are as likely; m.
    pub diameter: (f64, f64),
    /// How many; as many as fit when left out.
    #[serde(default)]
    pub count: Option<u32>,
    /// Distance of the places of the lattice; the closest without overlap when left out: the largest diameter times
    /// (1 + 2 jitter); m.
    #[serde(default)]
    pub spacing: Option<f64>,
    /// Along each axis a ball lies off its place by at most this share of the largest diameter.
    #[serde(default = "default_jitter")]
    pub jitter: f64,
    /// Of the random numbers of sizes and places.
    #[serde(default)]
    pub seed: u64,
    /// Initial velocity; m/s.
    #[serde(default)]
    pub velocity: Triple,
}

/// Where balls are at the start.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum GrainRegionFile {
    /// A box along the axes.
    Box {
        /// Lower corner; m.
        min: Triple,
        /// Upper corner; m.
        max: Triple,
    },
    /// An upright cylinder.
    Cylinder {
        /// Middle of its lower end; m.
        base: Triple,
        /// Radius; m.
        radius: f64,
        /// Height; m.
        height: f64,
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

/// A load, support or rock bolt. Points are places at t = 0 and move with their block.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum AttachmentFile {
    /// Constant force at a point of a block.
    PointLoad {
        /// Name of the block.
        block: String,
        /// Where; m.
        point: Triple,
        /// N.
        force: Triple,
    },
    /// Constant force per mass on a block, beside gravity.
    BodyLoad {
        /// Name of the block.
        block: String,
        /// m/s².
        acceleration: Triple,
    },
    /// Pressure on the face of a block that looks most in a direction; it follows the face.
    Pressure {
        /// Name of the block.
        block: String,
        /// Outward direction of the face at t = 0.
        face: Triple,
        /// Pushes inward if > 0; Pa.
        pressure: f64,
    },
    /// Spring that holds a point of a block at its place.
    FixedPoint {
        /// Name of the block.
        block: String,
        /// Where; m.
        point: Triple,
        /// N/m.
        stiffness: f64,
    },
    /// Elastic bar that yields, between points of two blocks.
    RockBolt {
        /// Name of the block at one end.
        from: String,
        /// Place of that end; m.
        from_point: Triple,
        /// Name of the block at the other end.
        to: String,
        /// Place of that end; m.
        to_point: Triple,
        /// Young's modulus times section over length; N/m.
        stiffness: f64,
        /// Tension at t = 0; N.
        #[serde(default)]
        pretension: f64,
        /// It takes no more than this; N.
        yield_force: f64,
    },
}

/// Geometry of a block.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum ShapeFile {
    /// A box along the axes.
    Box {
        /// Lower corner; m.
        min: Triple,
        /// Upper corner; m.
        max: Triple,
    },
    /// A right-triangular prism: corners (0,0), (length,0), (0,height) in the x-z plane, drawn from
    /// y = 0 to y = width.
    Wedge {
        /// Leg along x; m.
        length: f64,
        /// Leg along z; m.
        height: f64,
        /// Along y; m.
        width: f64,
    },
    /// The convex hull of points.
    Hull {
        /// At least four, not in one plane; m.
        points: Vec<Triple>,
    },
    /// A closed polyhedron; faces counter-clockwise seen from outside.
    Polyhedron {
        /// Corners; m.
        vertices: Vec<Triple>,
        /// Corner numbers of each face.
        faces: Vec<Vec<u32>>,
    },
    /// Closed polyhedra that adjoin, as one rigid union.
    Polyhedra {
        /// The convex parts.
        parts: Vec<PartFile>,
    },
    /// A polygon drawn along an axis; a non-convex one becomes a rigid union of convex parts.
    Extrusion {
        /// Corners in the plane across the axis, in the order of the remaining axes (for `Y`:
        /// x, z); either sense; m.
        polygon: Vec<(f64, f64)>,
        /// Direction of the extrusion.
        axis: Axis,
        /// Start along the axis; m.
        from: f64,
        /// End along the axis; m.
        to: f64,
    },
    /// A ball.
    Sphere {
        /// Centre; m.
        center: Triple,
        /// Radius; m.
        radius: f64,
    },
    /// A closed triangle mesh, STL, OBJ or VTK; every connected shell must be convex, several
    /// shells become one rigid union.
    Mesh {
        /// Path, relative to the scene file.
        file: String,
        /// Metres per unit of the file.
        scale: f64,
    },
    /// An open or closed surface of triangles, STL, OBJ or VTK, of a fixed block: solid on the side away
    /// from the normals, which must look to one side.
    Surface {
        /// Path, relative to the scene file.
        file: String,
        /// Metres per unit of the file.
        scale: f64,
    },
    /// Terrain of a fixed block from an ESRI ASCII grid; each square is halved along its shorter diagonal.
    Raster {
        /// Path, relative to the scene file.
        file: String,
        /// Point of the map that becomes x = y = 0; m.
        #[serde(default)]
        origin: (f64, f64),
    },
}

/// A closed convex polyhedron; faces counter-clockwise seen from outside.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartFile {
    /// Corners; m.
    pub vertices: Vec<Triple>,
    /// Corner numbers of each face.
    pub faces: Vec<Vec<u32>>,
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
    /// Along a record: CSV with columns time (s) and displacement x, y, z (m); `#` comments.
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

/// The water.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FluidFile {
    /// Reference density; kg/m³.
    #[serde(default = "default_fluid_density")]
    pub density: f64,
    /// Dynamic viscosity, for schemes whose viscosity is that of the fluid; Pa s. What keeps the published
    /// scheme calm is this number: see `cases/README.md`.
    #[serde(default = "default_dynamic_viscosity")]
    pub dynamic_viscosity: f64,
    /// How it flows, for mud; Newtonian with `dynamic_viscosity` when left out.
    #[serde(default)]
    pub rheology: Option<RheologyFile>,
    /// How fine.
    pub resolution: ResolutionFile,
    /// Where the water stands at the start.
    pub regions: Vec<RegionFile>,
}

/// How fine the fluid is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ResolutionFile {
    /// Particle spacing; m.
    Spacing(f64),
    /// Wanted number of particles, met as nearly as whole rows allow; a miss of more than 10 % is
    /// refused.
    Count(u32),
}

/// A body of water at the start.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RegionFile {
    /// Name, for messages.
    pub name: String,
    /// Extent.
    pub shape: RegionShapeFile,
    /// Initial velocity; m/s.
    #[serde(default)]
    pub velocity: Triple,
    /// How what starts here flows; that of the fluid when left out.
    #[serde(default)]
    pub rheology: Option<RheologyFile>,
}

/// How stress follows the rate of shear.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum RheologyFile {
    /// In proportion.
    Newtonian {
        /// Dynamic viscosity; Pa s.
        dynamic_viscosity: f64,
    },
    /// In proportion beyond a yield stress.
    Bingham {
        /// Plastic viscosity; Pa s.
        dynamic_viscosity: f64,
        /// Yield stress; Pa.
        yield_stress: f64,
        /// How it creeps below the yield stress.
        regularization: RegularizationFile,
    },
    /// By a power beyond a yield stress.
    HerschelBulkley {
        /// Consistency; Pa sⁿ.
        consistency: f64,
        /// Exponent n, above 0; below 1 for a fluid that thins when sheared.
        exponent: f64,
        /// Yield stress; Pa.
        yield_stress: f64,
        /// How it creeps below the yield stress.
        regularization: RegularizationFile,
    },
}

/// How a fluid with a yield stress creeps below it. A stopped layer of thickness H on a slope goes on at
/// `ρ g sin θ H²/(2 η)`, η its viscosity at rest; the step is proportional to 1/η.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum RegularizationFile {
    /// Papanastasiou's exponential with its time, 100 to 1000 s for mud; the viscosity at rest is the plastic
    /// one plus yield stress times time; s.
    Papanastasiou(f64),
    /// A largest viscosity, 100 to 1000 times the plastic one; Pa s.
    Bilinear(f64),
}

/// Extent of a body of water.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum RegionShapeFile {
    /// A box; it must not overlap a block.
    Box {
        /// Lower corner; m.
        min: Triple,
        /// Upper corner; m.
        max: Triple,
    },
    /// Everything below a level that water poured in at `seed` would reach; blocks and walls must
    /// close the basin.
    Below {
        /// Still-water level, a height along z; m.
        level: f64,
        /// A wet point; m.
        seed: Triple,
    },
}

/// A side of a box along the axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SideFile {
    /// The side of lowest x.
    XMin,
    /// The side of highest x.
    XMax,
    /// The side of lowest y.
    YMin,
    /// The side of highest y.
    YMax,
    /// The lower side.
    ZMin,
    /// The upper side.
    ZMax,
}

impl SideFile {
    /// The axis across it, 0 to 2, and whether it is the upper side.
    pub fn axis(self) -> (usize, bool) {
        match self {
            Self::XMin => (0, false),
            Self::XMax => (0, true),
            Self::YMin => (1, false),
            Self::YMax => (1, true),
            Self::ZMin => (2, false),
            Self::ZMax => (2, true),
        }
    }
}

/// A box in which the water is damped: `dv/dt = −rate (s/L)² v`, with `s` from 0 to its length `L`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AbsorberFile {
    /// Unique name.
    pub name: String,
    /// Lower corner; m.
    pub min: Triple,
    /// Upper corner; m.
    pub max: Triple,
    /// The side at which it is strongest, the end of the flume.
    pub towards: SideFile,
    /// Damping there; chosen from depth and length when left out; 1/s.
    #[serde(default)]
    pub rate: Option<f64>,
}

/// A box of water that moves as given, filled with whole rows, and the face through which it flows in. At least a
/// support radius and a spacing long.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InflowFile {
    /// Unique name.
    pub name: String,
    /// Lower corner, on the bed; m.
    pub min: Triple,
    /// Upper corner; m.
    pub max: Triple,
    /// The side that the water goes to: the face to the modelled water.
    pub towards: SideFile,
    /// Rows of time and velocity, linear between and constant outside; this or `discharge`; s, m/s.
    #[serde(default)]
    pub velocity: Vec<(f64, f64)>,
    /// Rows of time and discharge through the face, in a plane of the slice; s, m³/s.
    #[serde(default)]
    pub discharge: Vec<(f64, f64)>,
    /// Rows of time and depth over the bottom of the box, met to whole rows of particles; that of the box
    /// when left out; s, m.
    #[serde(default)]
    pub depth: Vec<(f64, f64)>,
}

/// A box through which water leaves, keeping its velocity, and the face past which it is taken out. At least a
/// support radius long.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutflowFile {
    /// Unique name.
    pub name: String,
    /// Lower corner, on the bed; m.
    pub min: Triple,
    /// Upper corner; m.
    pub max: Triple,
    /// The side that the water goes to and leaves by.
    pub towards: SideFile,
    /// Rows of time and depth over the bottom of the box, whose pressures are held; as they come when left
    /// out; s, m.
    #[serde(default)]
    pub depth: Vec<(f64, f64)>,
}

/// How fluid and blocks push each other.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InterfaceFile {
    /// How walls hold the fluid; the preset's way when left out.
    #[serde(default)]
    pub walls: Option<WallMethodFile>,
    /// Whether the fluid slides along walls; with penalty walls it always does.
    #[serde(default)]
    pub slip: SlipFile,
    /// Spring `K_S` between a particle and a surface; N/m.
    #[serde(default)]
    pub penalty_stiffness: Option<f64>,
    /// Dashpot `K_D` between a particle and a surface; N s/m.
    #[serde(default)]
    pub penalty_damping: Option<f64>,
}

/// How walls hold the fluid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum WallMethodFile {
    /// A spring and a dashpot between each particle and each surface, as published: cheap, and off by about
    /// a tenth in forces.
    Penalty,
    /// Particles inside the walls, with pressures continued from the fluid.
    Particles,
    /// Exact integrals of the kernel over polyhedra: no wall particles, for large faces and thin bodies. Wants
    /// Wendland's kernel, density from continuity, three dimensions, no periodic direction and no plane of symmetry.
    Integral,
}

/// What the fluid does along a wall.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum SlipFile {
    /// It slides.
    #[default]
    Free,
    /// It sticks.
    None,
    /// It sticks until Coulomb's friction gives way, at this angle, from 0 to below 90; degrees.
    Friction(f64),
}

/// Schemes and their numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[derive(Default)]
pub struct NumericsFile {
    /// The fluid scheme whose numbers hold where none is given.
    #[serde(default)]
    pub preset: Preset,
    /// Smoothing kernel.
    #[serde(default)]
    pub kernel: Option<KernelFile>,
    /// How density is found.
    #[serde(default)]
    pub density: Option<DensityFile>,
    /// Pressure from density.
    #[serde(default)]
    pub state_equation: Option<StateEquationFile>,
    /// What smooths the density of `Continuity`; the number is its coefficient, customarily 0.1.
    #[serde(default)]
    pub density_diffusion: Option<DensityDiffusionFile>,
    /// What resists shear.
    #[serde(default)]
    pub viscosity: Option<ViscosityFile>,
    /// What keeps particles evenly spread.
    #[serde(default)]
    pub shifting: Option<ShiftingFile>,
    /// How a step is taken.
    #[serde(default)]
    pub stepping: Option<SteppingFile>,
    /// Width of numbers in the sums over neighbours.
    #[serde(default)]
    pub precision: Option<PrecisionFile>,
    /// Smoothing length over particle spacing; the support radius is twice the smoothing length.
    #[serde(default)]
    pub smoothing_length_ratio: Option<f64>,
    /// Numerical sound speed; m/s. Chosen as ten times the fastest expected speed when left out.
    #[serde(default)]
    pub sound_speed: Option<f64>,
    /// Fastest flow expected, from which the sound speed follows; m/s.
    #[serde(default)]
    pub expected_speed: Option<f64>,
    /// Share of the fluid's stability limit that a step may use, above 0 and at most 1.
    #[serde(default)]
    pub time_step_factor: Option<f64>,
    /// What is done with pressures below zero.
    #[serde(default)]
    pub negative_pressure: Option<NegativePressure>,
    /// Share of the blocks' stability limit that a sub-step may use, above 0 and at most 1.
    #[serde(default)]
    pub block_time_step_factor: Option<f64>,
    /// How the common plane of two blocks is found.
    #[serde(default)]
    pub contact_detection: ContactDetectionFile,
    /// How balls answer to being pressed.
    #[serde(default)]
    pub normal_law: NormalLawFile,
    /// Which turning the rolling resistance of balls opposes.
    #[serde(default)]
    pub rolling_law: RollingLawFile,
    /// Damping of blocks in a search for a state of rest; none for blocks that move.
    #[serde(default)]
    pub static_damping: Option<StaticDampingFile>,
}

/// How the common plane of two blocks is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ContactDetectionFile {
    /// Verified by the separating-axis test: no overlap is missed.
    #[default]
    Verified,
    /// By the fast common plane alone, as published; for comparison.
    FastCommonPlane,
}

/// How balls answer to being pressed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum NormalLawFile {
    /// Spring of the material's `contact_stiffness`.
    #[default]
    Linear,
    /// Hertz's, from the elastic moduli, which every material then needs.
    Hertz,
}

/// Which turning the rolling resistance of balls opposes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum RollingLawFile {
    /// That of one against the other: equal and opposite torques.
    #[default]
    Relative,
    /// That of each ball on its own, as published by Zhou et al. (1999); angular momentum is lost.
    OwnSpin,
}

/// Damping for statics. What it takes stands in the ledger.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum StaticDampingFile {
    /// Force against velocity, per mass; 1/s.
    MassProportional(f64),
    /// Share of each component of force and torque, against its velocity, in [0, 1).
    Local(f64),
    /// Factor on velocities after each block step, above 0 and at most 1.
    Kinetic(f64),
}

/// A fluid scheme with its numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Preset {
    /// Density by summation and Mueller's kernels, as published, misprints corrected.
    Mueller2003,
    /// What coastal engineers use: Wendland's kernel, density from continuity with diffusion, particles in walls.
    #[default]
    Standard,
    /// Accuracy first: a wider kernel, third-order diffusion, shifting, double precision, a smaller step.
    Reference,
}

/// Dimensions of the flow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum DimensionsFile {
    /// In a vertical plane.
    Two,
    /// In space.
    #[default]
    Three,
}

/// A smoothing kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum KernelFile {
    /// Poly6 for density, spiky for pressure; in space only.
    Mueller,
    /// Wendland's C2.
    WendlandC2,
    /// The cubic spline, for comparison: particles pair above some 60 neighbours.
    CubicSpline,
}

/// How density is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum DensityFile {
    /// By a sum over neighbours: low near surfaces and walls.
    Summation,
    /// By integrating the equation of continuity.
    Continuity,
}

/// Pressure from density.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum StateEquationFile {
    /// `p = c₀² (ρ − ρ₀)`.
    Linear,
    /// `p = c₀² ρ₀/7 ((ρ/ρ₀)⁷ − 1)`.
    Tait,
}

/// What smooths the density, with its coefficient.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum DensityDiffusionFile {
    /// Nothing.
    None,
    /// Works on the hydrostatic gradient too: wrong near free surfaces.
    MolteniColagrossi(f64),
    /// Spares the hydrostatic gradient.
    Fourtakas(f64),
    /// Spares every linear gradient; one more sum.
    Antuono(f64),
}

/// What resists shear. All but the artificial one use the viscosity of the fluid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ViscosityFile {
    /// Nothing.
    None,
    /// The published form.
    Published,
    /// Monaghan's, with its coefficient, 0.01 to 0.1.
    Artificial(f64),
    /// Along the line of centres: conserves angular momentum.
    Laminar,
    /// Along the difference of velocities: better in shear.
    Morris,
    /// That of Morris with a viscosity of each particle from the flow laws of the fluid and its regions; chosen
    /// where there are any.
    Rheological,
    /// Smagorinsky's eddies smaller than the spacing, with its coefficient, customarily 0.12, on top of the
    /// viscosity of the fluid; only where the spacing resolves the flow.
    SubParticleScale(f64),
}

/// What keeps particles evenly spread.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ShiftingFile {
    /// Nothing.
    None,
    /// Towards where particles are sparse, with its coefficient, customarily 2.
    Fickian(f64),
}

/// How a step is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SteppingFile {
    /// Half kick, drift with density half way, half kick: second order, one evaluation a step.
    KickDriftKick,
    /// That of DualSPHysics: second order, two evaluations and shorter steps; wants density diffusion.
    PredictorCorrector,
    /// As published: velocities, then positions with them; one evaluation a step, `Summation` only.
    SymplecticEuler,
}

/// Width of numbers in the sums over neighbours; everything else is in double precision.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum PrecisionFile {
    /// 7 digits, twice as fast.
    Single,
    /// 16 digits.
    Double,
}

/// What is done with pressures below zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum NegativePressure {
    /// Set to zero: water does not pull.
    Clamped,
    /// Kept.
    Kept,
}

/// How long.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimeFile {
    /// Simulated time, after settling; s.
    pub duration: f64,
    /// Time before t = 0 in which the water comes to rest: blocks are held, the fluid is damped;
    /// s. Nothing of it enters the records or the energy ledger.
    #[serde(default)]
    pub settle: f64,
}

/// A recording instrument.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum GaugeFile {
    /// Height of the free surface over a point of the plan; m, NaN when dry.
    SurfaceElevation {
        /// Column name in `gauges.csv`.
        name: String,
        /// m.
        x: f64,
        /// m.
        y: f64,
    },
    /// Pressure at a point; Pa, NaN when dry.
    Pressure {
        /// Column name.
        name: String,
        /// m.
        position: Triple,
    },
    /// Fluid velocity at a point, three columns; m/s, NaN when dry.
    Velocity {
        /// Column name.
        name: String,
        /// m.
        position: Triple,
    },
    /// Force and moment on a block from fluid and from contacts, twelve columns; N, N m about the
    /// centroid.
    BlockForce {
        /// Column name.
        name: String,
        /// Name of the block.
        block: String,
    },
    /// Highest point that water touches above a line of the plan; m, NaN when dry.
    RunUp {
        /// Column name.
        name: String,
        /// Start of the line, (x, y); m.
        from: (f64, f64),
        /// End of the line, (x, y); m.
        to: (f64, f64),
    },
}

/// Which blocks are followed on their way: `trajectories.csv` has a row per block and time, `rockfall.csv`
/// one per block.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrajectoriesFile {
    /// Names of free blocks; every free block when empty.
    #[serde(default)]
    pub blocks: Vec<String>,
    /// Between two looks at a block; extremes are those of the looks; s. A thousandth of the duration when
    /// left out.
    #[serde(default)]
    pub interval: Option<f64>,
}

/// What is written, and how often.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutputFile {
    /// Between VTK frames; s. A fiftieth of the duration when left out.
    #[serde(default)]
    pub frame_interval: Option<f64>,
    /// Between rows of `gauges.csv`; s. A five-hundredth of the duration when left out.
    #[serde(default)]
    pub gauge_interval: Option<f64>,
    /// Between rows of `blocks.csv` and `energy.csv`; s. As `gauge_interval` when left out.
    #[serde(default)]
    pub ledger_interval: Option<f64>,
    /// Arrays of the water files. The first four when left out, all for a fluid with flow laws.
    #[serde(default)]
    pub water_fields: Option<Vec<WaterField>>,
    /// Arrays of the block files besides `BlockId`.
    #[serde(default = "all_block_fields")]
    pub block_fields: Vec<BlockField>,
    /// Whether contact points are written.
    #[serde(default)]
    pub contacts: bool,
}

impl Default for OutputFile {
    fn default() -> Self {
        Self {
            frame_interval: None,
            gauge_interval: None,
            ledger_interval: None,
            water_fields: None,
            block_fields: all_block_fields(),
            contacts: false,
        }
    }
}

/// An array of the water files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum WaterField {
    /// m/s.
    Velocity,
    /// kg/m³.
    Density,
    /// Pa.
    Pressure,
    /// Number of the particle, the same in every frame.
    Id,
    /// Apparent viscosity; Pa s.
    Viscosity,
    /// 1 where the stress is above the yield stress, 0 elsewhere.
    Yielded,
}

/// An array of the block files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum BlockField {
    /// Of the centroid; m/s.
    Velocity,
    /// rad/s.
    AngularVelocity,
    /// From the water; N.
    ForceFluid,
    /// From other blocks; N.
    ForceContact,
}

/// The eye of `riprap render`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraFile {
    /// Where it stands; m.
    pub position: Triple,
    /// What it looks at; m.
    pub look_at: Triple,
    /// Horizontal angle of view; degrees.
    #[serde(default = "default_field_of_view")]
    pub field_of_view_deg: f64,
}

fn default_jitter() -> f64 {
    0.02
}

fn default_maximum_blocks() -> u32 {
    20_000
}

fn default_volume_share() -> f64 {
    0.01
}

fn default_aspect() -> f64 {
    20.0
}

fn one() -> f64 {
    1.0
}

fn standard_gravity() -> Triple {
    (0.0, 0.0, -9.81)
}

fn default_shear_stiffness_ratio() -> f64 {
    0.8
}

fn default_fluid_density() -> f64 {
    1000.0
}

/// Water at 20 degrees; Pa s.
fn default_dynamic_viscosity() -> f64 {
    1.002e-3
}

fn default_field_of_view() -> f64 {
    40.0
}

fn all_block_fields() -> Vec<BlockField> {
    vec![
        BlockField::Velocity,
        BlockField::AngularVelocity,
        BlockField::ForceFluid,
        BlockField::ForceContact,
    ]
}
