//! Joints whose strength falls with time.

use crate::series::Series;
use crate::world::World;

/// A joint that weakens.
#[derive(Clone, Debug, PartialEq)]
pub struct Weakening {
    /// Numbers of its two materials.
    pub materials: (usize, usize),
    /// Share of the tangent of its friction angles over time.
    pub friction: Series,
    /// Share of its cohesions over time.
    pub cohesion: Series,
}

impl World {
    /// Weakens the joints by their series at the current time.
    pub(crate) fn weaken(&mut self) {
        let time = self.progress.clock.time;
        for weakening in &self.weakenings {
            let shares = (weakening.friction.at(time), weakening.cohesion.at(time));
            self.blocks.weaken(weakening.materials, shares.0, shares.1);
        }
    }
}
