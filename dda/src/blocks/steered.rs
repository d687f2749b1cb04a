//! Motion that is added to a prescribed one while it runs: what a control makes of what it measures.

use serde::{Deserialize, Serialize};

use super::Blocks;
use crate::Vec3;
use crate::motion::prescribed::Motion;

/// Motion added to that of a prescribed block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Steered {
    block: u32,
    /// Until now; m.
    displacement: Vec3,
    /// From now on; m/s.
    velocity: Vec3,
}

impl Blocks {
    /// Adds a velocity to the prescribed motion of a block, until it is steered anew; what it went by then stays. Free and
    /// fixed blocks ignore it. m/s.
    pub fn steer(&mut self, block: usize, velocity: Vec3) {
        if !matches!(self.constants.motion[block], Motion::Prescribed(_)) {
            return;
        }
        let steered = &mut self.state.steered;
        let found = steered.iter_mut().find(|one| one.block as usize == block);
        match found {
            Some(one) => one.velocity = velocity,
            None => steered.push(Steered {
                block: block as u32,
                displacement: Vec3::zeros(),
                velocity,
            }),
        }
    }

    /// Displacement (m) and velocity (m/s) that steering adds to the prescribed motion of a block.
    pub(crate) fn steering(&self, block: usize) -> (Vec3, Vec3) {
        let mut steered = self.state.steered.iter();
        steered
            .find(|one| one.block as usize == block)
            .map_or_else(Default::default, |one| (one.displacement, one.velocity))
    }

    /// Takes the motions added through a sub-step (s).
    pub(crate) fn drift_steered(&mut self, dt: f64) {
        for one in &mut self.state.steered {
            one.displacement += one.velocity * dt;
        }
    }
}
