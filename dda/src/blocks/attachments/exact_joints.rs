//! Exact joints of contact dynamics: balls, held points and rods.

use super::{Bodies, End, Refusal, is_finite};
use crate::{Integrator, Motion, Vec3};
use serde::{Deserialize, Serialize};

/// Restriction by a joint.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Tie {
    /// To a place in the world; m.
    Place(Vec3),
    /// To a point of another block.
    Ball(End),
    /// At a distance from a point of another block.
    Rod {
        other: End,
        /// m.
        length: f64,
        /// N.
        strength: f64,
    },
}

/// An exact joint and its state.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ExactJoint {
    pub end: End,
    pub tie: Tie,
    /// Mean force on the block of `end` in the last step, from which the next one starts; N.
    pub force: Vec3,
    pub is_broken: bool,
}

impl ExactJoint {
    /// The blocks, the second one if there is one.
    pub fn blocks(&self) -> (u32, Option<u32>) {
        let second = match self.tie {
            Tie::Place(_) => None,
            Tie::Ball(other) | Tie::Rod { other, .. } => Some(other.block),
        };
        (self.end.block, second)
    }

    pub fn for_each_state_f64(&self, f: &mut dyn FnMut(f64)) {
        self.force.iter().for_each(|&c| f(c));
        f(f64::from(u8::from(self.is_broken)));
    }
}

impl Bodies<'_> {
    pub(super) fn held_point(&self, block: usize, point: Vec3) -> Result<ExactJoint, Refusal> {
        self.check_block(block)?;
        if !is_finite(&point) {
            return Err("the point must be finite");
        }
        if !self.is_free(block) {
            return Err("only a free block can be held");
        }
        self.exact(self.end(block, point), Tie::Place(point))
    }

    pub(super) fn ball_joint(
        &self,
        blocks: (usize, usize),
        point: Vec3,
    ) -> Result<ExactJoint, Refusal> {
        self.check_joined(blocks)?;
        if !is_finite(&point) {
            return Err("the point must be finite");
        }
        let other = self.end(blocks.1, point);
        self.exact(self.end(blocks.0, point), Tie::Ball(other))
    }

    pub(super) fn rod(
        &self,
        blocks: (usize, usize),
        points: (Vec3, Vec3),
        strength: f64,
    ) -> Result<ExactJoint, Refusal> {
        self.check_joined(blocks)?;
        let length = (points.1 - points.0).norm();
        if !(length > 0.0 && length.is_finite()) {
            return Err("the ends of a rod must be apart");
        }
        // infinite for one that never breaks; NaN is refused
        if !(strength > 0.0) {
            return Err("the strength of a rod must be > 0 N");
        }
        let tie = Tie::Rod {
            other: self.end(blocks.1, points.1),
            length,
            strength,
        };
        self.exact(self.end(blocks.0, points.0), tie)
    }

    /// Central differences have springs instead: a supported point, a bolt.
    fn exact(&self, end: End, tie: Tie) -> Result<ExactJoint, Refusal> {
        if !matches!(self.integrator, Integrator::ContactDynamics(_)) {
            return Err("an exact joint requires contact dynamics");
        }
        Ok(ExactJoint {
            end,
            tie,
            force: Vec3::zeros(),
            is_broken: false,
        })
    }

    fn check_joined(&self, (i, j): (usize, usize)) -> Result<(), Refusal> {
        self.check_block(i)?;
        self.check_block(j)?;
        if i == j {
            return Err("a joint needs two different blocks");
        }
        if !self.is_free(i) && !self.is_free(j) {
            return Err("one of the two blocks must be free");
        }
        Ok(())
    }

    fn is_free(&self, block: usize) -> bool {
        matches!(self.motion[block], Motion::Free)
    }
}
