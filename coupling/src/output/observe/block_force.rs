//! A block's force gauge: means of its loads since the last row.

use riprap_dda::Load;
use serde::{Deserialize, Serialize};

use crate::world::World;

/// Impulses on a block up to a time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Impulse {
    /// s.
    time: f64,
    /// Of the fluid; N s, N m s.
    fluid: Load,
    /// Of contacts; N s, N m s.
    contact: Load,
}

/// Force and moment on a block, impulse over time, so that nothing between two rows is missed: a sample every few
/// milliseconds of a load that rings with the water's sound has the mean only by chance, and a particle stopped by a wall
/// gives its momentum within a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct BlockForce {
    block: usize,
    /// At the last row.
    pub(super) before: Option<Impulse>,
}

impl BlockForce {
    pub(super) fn new(block: usize) -> Self {
        Self {
            block,
            before: None,
        }
    }

    /// Means since the last row of the loads of the fluid and of contacts; at the first one those at that time.
    pub(super) fn read(&mut self, world: &World) -> [Load; 2] {
        let contact = world.blocks.account(self.block);
        let now = Impulse {
            time: world.time(),
            fluid: world.fluid_impulses(self.block).total(),
            contact: contact.map_or_else(Load::default, |impulses| impulses.contact),
        };
        match self.before.replace(now) {
            Some(before) if before.time < now.time => {
                let rate = 1.0 / (now.time - before.time);
                let mean = |now: Load, before: Load| Load {
                    force: (now.force - before.force) * rate,
                    torque: (now.torque - before.torque) * rate,
                };
                [
                    mean(now.fluid, before.fluid),
                    mean(now.contact, before.contact),
                ]
            }
            _ => [
                world.fluid_load(self.block),
                world.blocks.contact_force(self.block),
            ],
        }
    }
}
