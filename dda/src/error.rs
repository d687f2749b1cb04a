//! Errors of creating and advancing blocks.

use std::fmt::{self, Display, Formatter};

use thiserror::Error;

use crate::ranges::PropertyRange;
use crate::{BlockId, Vec3};

/// Error of an invalid system of blocks.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BlockError {
    /// A block refers to a material that is not there.
    #[error("block {block} has material {material}, but there are only {n_materials}")]
    NoSuchMaterial {
        /// The block.
        block: usize,
        /// Its material.
        material: usize,
        /// Materials given.
        n_materials: usize,
    },
    /// A number of a material is out of range.
    #[error("material {material}: {} is {value}, {range}", range.name)]
    Material {
        /// The material.
        material: usize,
        /// Range of the number.
        range: PropertyRange,
        /// Its value.
        value: f64,
    },
    /// A joint is not between two materials of the list, or not the only one.
    #[error("joint override {joint} is unusable: {reason}")]
    JointPair {
        /// Its position in the list.
        joint: usize,
        /// Fault.
        reason: &'static str,
    },
    /// A number of a joint is out of range.
    #[error("joint override {joint}: {} is {value}, {range}", range.name)]
    Joint {
        /// Its position in the list.
        joint: usize,
        /// Range of the number.
        range: PropertyRange,
        /// Its value.
        value: f64,
    },
    /// A block has no parts, or a sphere has no size.
    #[error("block {block} has no volume; give it at least one part or a positive radius")]
    Empty {
        /// The block.
        block: usize,
    },
    /// A surface is not fixed.
    #[error("block {block} is a surface, which has no mass to move; make it fixed")]
    Surface {
        /// The block.
        block: usize,
    },
    /// A velocity is NaN or infinite.
    #[error("block {block} has an initial velocity that is not finite")]
    NotFinite {
        /// The block.
        block: usize,
    },
    /// A block cannot be deformable.
    #[error("block {block} cannot be deformable: {reason}")]
    Deformability {
        /// The block.
        block: usize,
        /// Reason.
        reason: &'static str,
    },
    /// A block cannot be held so.
    #[error("block {block} cannot be held: {reason}")]
    Hold {
        /// The block.
        block: usize,
        /// Reason.
        reason: &'static str,
    },
    /// A load, support or bolt is unusable.
    #[error("attachment {attachment} is unusable: {reason}")]
    Attachment {
        /// Its position in the list.
        attachment: usize,
        /// Fault.
        reason: &'static str,
    },
    /// A path is unusable.
    #[error("the path of block {block} cannot be followed: {reason}")]
    Motion {
        /// The block.
        block: usize,
        /// Fault.
        reason: &'static str,
    },
    /// A number of the settings is out of range.
    #[error("setting {field} is {value}, {rule}")]
    Setting {
        /// Name of the number.
        field: &'static str,
        /// Its value.
        value: f64,
        /// Its range.
        rule: &'static str,
    },
}

/// Error of a step, with what helps beside a shorter step, which is up to the caller. The state is that of the failed sub-step, suitable for a last output only.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum StepError {
    /// A block's state is not finite.
    #[error(
        "block {block} has a position or velocity that is not finite at t = {time:.6} s; look what acts on it"
    )]
    NotFinite {
        /// The block.
        block: BlockId,
        /// Time of the sub-step; s.
        time: f64,
    },
    /// Two blocks overlap too deeply.
    #[error(
        "blocks {} and {} {overlap}, at t = {time:.6} s; raise the contact stiffness or part them at the start",
        overlap.blocks.0, overlap.blocks.1
    )]
    Overlap {
        /// The deepest overlap over the one allowed.
        overlap: DeepOverlap,
        /// Time of the sub-step; s.
        time: f64,
    },
    /// A deformable block is strained beyond the range of its stress law.
    #[error(
        "block {block} is compressed to a strain of {strain:.3} at t = {time:.6} s (limit {limit}); raise its Young's modulus \
         or lower the loads"
    )]
    Crushed {
        /// The block.
        block: BlockId,
        /// Lowest principal value of Green's strain; –.
        strain: f64,
        /// Allowed; –.
        limit: f64,
        /// Time of the sub-step; s.
        time: f64,
    },
    /// Contact dynamics did not find the impulses of contacts and joints in several steps running.
    #[error(
        "{n_steps} steps running were not solved up to t = {time:.6} s: {}",
        left(.joint.as_ref(), *.residual, *.n_iterations)
    )]
    Unsolved {
        /// Steps running.
        n_steps: u32,
        /// Residual of the laws of contact in the last one; –.
        residual: f64,
        /// Sweeps and iterations in it.
        n_iterations: usize,
        /// A joint that was left open in it.
        joint: Option<OpenJoint>,
        /// Time of the last one; s.
        time: f64,
    },
    /// A time step cannot be used.
    #[error("time step {dt} s at t = {time} s; it must be finite and > 0")]
    TimeStep {
        /// The step; s.
        dt: f64,
        /// The time; s.
        time: f64,
    },
}

/// Rest of unsolved steps, and the remedy.
fn left(joint: Option<&OpenJoint>, residual: f64, n_iterations: usize) -> String {
    match joint {
        Some(joint) => format!(
            "{joint}; release it, or look for a joint or a prescribed motion that contradicts it"
        ),
        None => format!(
            "the contacts have a residual of {residual:.1e} after {n_iterations} sweeps; allow more sweeps, or look for blocks that are \
             jammed or overlap at the start"
        ),
    }
}

/// An exact joint whose points a step leaves apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpenJoint {
    /// Position among the exact joints, as they were attached.
    pub joint: usize,
    /// Its blocks; the second one if there is one.
    pub blocks: (BlockId, Option<BlockId>),
    /// Distance of its points, or error of its length; m.
    pub opening: f64,
}

impl Display for OpenJoint {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let Self {
            joint,
            blocks: (first, second),
            opening,
        } = self;
        match second {
            None => write!(f, "exact joint {joint} of block {first}")?,
            Some(second) => write!(f, "exact joint {joint} of blocks {first} and {second}")?,
        }
        write!(f, " stays open by {opening:.1e} m")
    }
}

/// Overlap of two parts beside the one that a step allows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeepOverlap {
    /// The lower and the higher block.
    pub blocks: (BlockId, BlockId),
    /// Deepest point of contact; m.
    pub at: Vec3,
    /// Overlap; m.
    pub depth: f64,
    /// Allowed: a share of the size, half the mean thickness of both at most; m.
    pub allowed: f64,
    /// Size of the smaller part, the cube root of its volume; m.
    pub size: f64,
}

impl Display for DeepOverlap {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let Self {
            at,
            depth,
            allowed,
            size,
            ..
        } = self;
        write!(
            f,
            "overlap by {depth:.3e} m near ({:.3}, {:.3}, {:.3}) m, {:.0} % of the smaller one's size {size:.3e} m (allowed \
             {allowed:.3e} m)",
            at.x,
            at.y,
            at.z,
            100.0 * depth / size
        )
    }
}
