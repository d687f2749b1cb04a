//! Explicit three-dimensional discontinuous deformation analysis of rock blocks.
//!
//! Blocks are unions of convex polyhedra, rigid or with one strain each, or rigid balls. They meet
//! through penalty springs and dashpots at the points of a contact patch, with Coulomb friction that
//! remembers its shear, and move by a central-difference step in kick-drift-kick form.
//!
//! ```text
//! m v' = Σ f + m g        Q (J ω)' = Σ r × f          [N], [N m]
//! ```
//!
//! **Reading order.** [`Polyhedron`] (geometry), [`mass_properties`], [`Shape`], [`Material`] and the
//! joint of two materials, [`Blocks`] (the state), then the step: [`Blocks::advance`] in `integrate`,
//! `broad_phase`, `common_plane`, `patch`, `contact`, `friction`; `sphere_contact` for balls and
//! `surface_contact` for terrain; `forces`, which sums them. Beside it: `deformation`,
//! `attachments`, `holds`, `damping`; and before it [`cut_by_joints`] and [`merge_slivers`], which
//! make blocks of a rock mass.
//!
//! **Signs.** SI units. Faces counter-clockwise seen from outside, z up. A contact normal points from
//! block i to block j; a gap below zero is overlap. World frame unless a name says otherwise
//! (`offset_rel`: from the block's centroid).
//!
//! **Results are the same bits for any number of threads**: each pair of parts writes its own forces,
//! and they are summed in the order of the list.
//!
//! **Limits.** Parts of a union, and fixed blocks that adjoin, collide one by one, each at the faces
//! and corners that the others leave visible; adjoining blocks that move against each other keep their
//! edges. Where another face or an edge takes a contact over, it goes on with the energy that was held. Contacts
//! too soft for an impact end the run with an error before a body could come out on the other side.
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
//!     rolling_friction: 0.0,
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

mod accounts;
mod attachments;
mod block_quality;
mod blocks;
mod broad_phase;
mod chunks;
mod common_plane;
mod contact;
mod critical_step;
mod cut;
mod damping;
mod deformation;
mod distance;
mod energy;
mod error;
mod forces;
mod friction;
mod holds;
mod integrate;
mod joint_sets;
mod kinematics;
mod links;
mod material;
mod measure;
mod motion;
mod parts;
mod patch;
mod polyhedron;
mod random;
mod rest;
mod rigid;
mod shape;
mod sphere_contact;
mod stability;
mod surface;
mod surface_contact;

/// Vector of three `f64`.
pub type Vec3 = nalgebra::Vector3<f64>;
/// Turn and shift.
pub type Isometry = nalgebra::Isometry3<f64>;

pub use accounts::Impulses;
pub use attachments::Attachment;
pub use block_quality::BlockQuality;
pub use blocks::{BlockDefinition, Blocks, Settings};
pub use common_plane::{
    Axis, AxisKind, ContactDetection, SeparatingAxes, fast_common_plane, gap_along, separating_axes,
};
pub use contact::{Contact, ContactState};
pub use critical_step::CriticalStep;
pub use cut::Plane;
pub use damping::StaticDamping;
pub use deformation::{
    Deformability, DeformableModel, StressLaw, Voigt, classical_mass_matrix, natural_frequencies,
};
pub use distance::SurfacePoint;
pub use energy::Energies;
pub use error::{BlockError, StepError};
pub use holds::{Hold, Turning};
pub use integrate::Phase;
pub use joint_sets::{
    JointError, JointSet, JointedMass, JointedUnion, MergedMass, SliverLimits, cut_by_joints,
    cut_union_by_joints, hull_within, merge_slivers, merge_union_slivers,
};
pub use kinematics::Load;
pub use material::{
    Elastic, JointOverride, Material, NormalLaw, RollingLaw, clamped_restitution, damping_ratio,
};
pub use measure::{MassProperties, face_area, mass_properties, volume};
pub use motion::{Accelerogram, Motion, PrescribedMotion};
pub use polyhedron::{Polyhedron, PolyhedronError};
pub use random::Random;
pub use rest::Resting;
pub use shape::Shape;
pub use surface::{Surface, SurfaceError};
