//! Force on a barrier or one of its blocks: impulse since t = 0, and the largest values of a step in an interval.

use riprap_dda::{Load, Vec3};
use serde::{Deserialize, Serialize};

use crate::scene::resolved::recording::Barrier;
use crate::world::World;

/// Sources of force, in the order of their columns; without water only the first.
pub(super) const KINDS: [&str; 3] = ["solid", "fluid", "total"];

/// Components of a force and its moment, in the order of their columns.
pub(super) const COMPONENTS: [(&str, &str); 4] = [
    ("normal", "N"),
    ("tangential", "N"),
    ("resultant", "N"),
    ("moment", "N m"),
];

/// Force and overturning moment, or their impulses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Thrust {
    /// N, or N s.
    pub force: Vec3,
    /// About the foot, positive for a force with the flow above it; N m, or N m s.
    pub moment: f64,
}

impl Thrust {
    /// Of a load with its moment about the centroid of a block.
    pub fn of(load: &Load, centroid: &Vec3, barrier: &Barrier) -> Self {
        let about_foot = load.torque + (centroid - barrier.foot).cross(&load.force);
        Self {
            force: load.force,
            moment: barrier.axes[1].dot(&about_foot),
        }
    }

    pub fn plus(self, other: Self) -> Self {
        Self {
            force: self.force + other.force,
            moment: self.moment + other.moment,
        }
    }

    pub fn minus(self, other: Self) -> Self {
        self.plus(other.times(-1.0))
    }

    pub fn times(self, factor: f64) -> Self {
        Self {
            force: self.force * factor,
            moment: self.moment * factor,
        }
    }

    /// Along the flow, across it, both, and the moment; N, N m.
    pub fn components(&self, flow: &Vec3) -> [f64; 4] {
        let normal = self.force.dot(flow);
        let tangential = (self.force - flow * normal).norm();
        [normal, tangential, self.force.norm(), self.moment]
    }
}

/// A block at the last step: impulses by its accounts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Accounted {
    solid: Load,
    fluid: Load,
}

impl Accounted {
    /// Impulses on a block so far.
    pub fn of(block: usize, world: &World) -> Self {
        let account = world.blocks.account(block);
        Self {
            solid: account.map_or_else(Load::default, |impulses| impulses.contact),
            fluid: world.fluid_impulses(block).total(),
        }
    }

    /// Impulses since an earlier time, of solids and of the fluid.
    pub fn since(&self, before: &Self) -> [Load; 2] {
        let less = |now: &Load, before: &Load| Load {
            force: now.force - before.force,
            torque: now.torque - before.torque,
        };
        [
            less(&self.solid, &before.solid),
            less(&self.fluid, &before.fluid),
        ]
    }
}

/// Force of a source on a body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Track {
    /// Impulse since t = 0.
    pub impulse: Thrust,
    /// Of these, until the last row.
    at_row: Thrust,
    /// In the last step.
    pub now: Thrust,
    /// Largest component of a step since the last row, the moment by its magnitude.
    largest: [f64; 4],
}

impl Track {
    /// Books a step: its impulse, and its force.
    pub fn book(&mut self, impulse: Thrust, now: Thrust, flow: &Vec3) {
        self.impulse = self.impulse.plus(impulse);
        self.now = now;
        for (largest, value) in self.largest.iter_mut().zip(now.components(flow)) {
            if largest.abs() < value.abs() {
                *largest = value;
            }
        }
    }

    /// Means and largest values since the last row, `time` (s) ago; at the first one those at that time.
    pub fn row(&mut self, time: f64, flow: &Vec3) -> [[f64; 4]; 2] {
        let mean = match 0.0 < time {
            true => self.impulse.minus(self.at_row).times(1.0 / time),
            false => self.now,
        };
        self.at_row = self.impulse;
        let largest = std::mem::take(&mut self.largest);
        [mean.components(flow), largest]
    }
}

/// A value and its time, the first of equal ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Peak {
    pub value: f64,
    /// s.
    pub time: Option<f64>,
}

impl Peak {
    /// Takes a larger value; whether it was one.
    pub fn update(&mut self, value: f64, time: f64) -> bool {
        let is_larger = self.value < value;
        if is_larger {
            *self = Self {
                value,
                time: Some(time),
            };
        }
        is_larger
    }
}
