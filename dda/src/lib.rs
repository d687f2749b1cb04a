//! Explicit three-dimensional discontinuous deformation analysis of rock blocks.
//!
//! Blocks are unions of convex polyhedra, rigid or with one uniform strain each, or rigid spheres. They
//! interact through penalty springs and dashpots at the points of a contact patch, with Coulomb friction
//! and its shear history, and move by central differences in kick-drift-kick form.
//!
//! ```text
//! m v' = Σ f + m g        Q (J ω)' = Σ r × f          [N], [N m]
//! ```
//!
//! **Reading order.** `geometry` ([`Polyhedron`], [`mass_properties`], [`Shape`]), `material`
//! ([`Material`] and the joint of two materials), `blocks` ([`Blocks`], the state), then the step:
//! [`Blocks::advance`] with an [`Integrator`] (`step::central_difference`, or `step::mid_step` with [`contact_dynamics`]),
//! `contact::detection` (broad phase, manifolds of polyhedra, spheres and terrain), `contact::penalty` (the law on them),
//! `step::sums`. In addition
//! `motion` (deformation, holds, prescribed motion), `step::attachments` and `step::damping`, and
//! `rock_mass` ([`cut_by_joints`], [`merge_slivers`]), which makes blocks of a rock mass.
//!
//! **Signs.** SI units. Faces counter-clockwise seen from outside, z up. A contact normal points from
//! block i to block j; a gap below zero is overlap. World frame unless a name says otherwise
//! (`offset_rel`: from the block's centroid).
//!
//! **Results are bitwise identical for any number of threads**: each pair of parts writes its own
//! forces, and they are summed in the order of the list.
//!
//! **Limits.** Parts of a union, and adjoining fixed blocks, collide individually, each at its exposed
//! faces and corners; adjoining blocks that move relative to each other keep their edges. When the contact
//! changes to another face or edge, it keeps its stored energy. Contacts too soft for an impact end
//! the run with an error before a body could pass through the other.
//!
//! ```
//! use riprap_dda::{BlockDefinition, Blocks, Material, Motion, Polyhedron, Settings, Shape, Vec3};
//!
//! let rock = Material {
//!     density: 2500.0,
//!     friction_angle: 0.5,
//!     residual_friction_angle: None,
//!     cohesion: 0.0,
//!     residual_cohesion: 0.0,
//!     tensile_strength: 0.0,
//!     restitution: 0.3,
//!     contact_stiffness: 1e8,
//!     joint_stiffness: None,
//!     shear_stiffness_ratio: 0.8,
//!     shear_damping_ratio: 0.2,
//!     rolling_friction: 0.0,
//!     twisting_friction: 0.0,
//!     elastic: None,
//! };
//! let block = |from: [f64; 3], to: [f64; 3], motion| -> Result<BlockDefinition, riprap_dda::PolyhedronError> {
//!     Ok(BlockDefinition {
//!         shape: Shape::Polyhedra(vec![Polyhedron::cuboid(from.into(), to.into())?]),
//!         material: 0,
//!         motion,
//!         velocity: Vec3::zeros(),
//!         angular_velocity: Vec3::zeros(),
//!         deformability: None,
//!     })
//! };
//! let floor = block([-2.0, -2.0, -1.0], [2.0, 2.0, 0.0], Motion::Fixed)?;
//! let stone = block([-0.5, -0.5, 0.0], [0.5, 0.5, 1.0], Motion::Free)?;
//! let mut blocks = Blocks::new(vec![floor, stone], vec![rock], Settings::default())?;
//! let mut time = 0.0;
//! while time < 0.5 {
//!     let dt = blocks.critical_time_step().dt.min(0.01);
//!     blocks.advance(time, dt, 1)?;
//!     time += dt;
//! }
//! // It rests, sunk into the floor by m g/K.
//! assert!((blocks.centroid(1).z - 0.5 + 2500.0 * 9.81 / 1e8).abs() < 1e-6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod blocks;
mod chunks;
mod contact;
mod error;
mod geometry;
mod id;
mod material;
mod motion;
mod random;
mod ranges;
mod rock_mass;
mod step;

/// Vector of three `f64`.
pub type Vec3 = nalgebra::Vector3<f64>;
/// Rotation and translation.
pub type Isometry = nalgebra::Isometry3<f64>;

pub use blocks::accounts::Impulses;
pub use blocks::attachments::Attachment;
pub use blocks::energy::Energies;
pub use blocks::{
    BlockDefinition, Blocks, ContactDynamics, Integrator, Resting, Settings, StaticDamping,
};
pub use contact::detection::common_plane::{
    Axis, AxisKind, ContactDetection, SeparatingAxes, fast_common_plane, gap_along, separating_axes,
};
pub use contact::dynamics as contact_dynamics;
pub use contact::dynamics::kept::{ContactSolution, SolvedSteps};
pub use contact::dynamics::solver::ContactSolver;
pub use contact::rates::StepBound;
pub use contact::report::{Contact, ContactState};
pub use error::{BlockError, DeepOverlap, OpenJoint, StepError};
pub use geometry::block_quality::BlockQuality;
pub use geometry::clip::clipped_polygon;
pub use geometry::cut::Plane;
pub use geometry::distance::SurfacePoint;
pub use geometry::mass_properties::MassProperties;
pub use geometry::passage::Passage;
pub use geometry::polyhedron::integrals::{face_area, mass_properties, volume};
pub use geometry::polyhedron::{Polyhedron, PolyhedronError};
pub use geometry::shape::Shape;
pub use geometry::surface::{Surface, SurfaceError};
pub use id::{BlockId, PartId};
pub use material::{
    DEFAULT_SHEAR_DAMPING_RATIO, Elastic, JointOverride, Material, NormalLaw, RollingLaw,
    clamped_restitution, damping_ratio,
};
pub use motion::deformation::{
    Deformability, DeformableModel, StressLaw, Voigt, classical_mass_matrix, natural_frequencies,
};
pub use motion::holds::{Hold, Turning};
pub use motion::kinematics::Load;
pub use motion::path::{Cut, Path, PathError, Sliding};
pub use motion::prescribed::{Accelerogram, Motion, PrescribedMotion};
pub use random::Random;
pub use ranges::{Interval, Property, PropertyRange};
pub use rock_mass::joint_sets::{
    Joint, JointError, JointSet, JointedMass, JointedUnion, MergedMass, SliverLimits,
    cut_by_joints, cut_union_by_joints, hull_within, merge_slivers, merge_union_slivers,
};
pub use step::mid_step::Kicks;
pub use step::phase::Phase;
pub use step::step_bound::CriticalStep;
