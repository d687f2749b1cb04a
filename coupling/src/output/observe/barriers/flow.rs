//! Bodies and water that have passed a barrier, their energy, and the flow before it.

use riprap_dda::Vec3;
use serde::{Deserialize, Serialize};

use crate::scene::resolved::recording::Barrier;
use crate::world::World;

/// What has passed a barrier: seen beyond its downstream side at a row. Saved in checkpoints.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Passed {
    /// One per block.
    has_passed: Vec<bool>,
    /// One per particle, by its number.
    has_flowed: Vec<bool>,
    pub number: usize,
    /// kg.
    pub mass: f64,
    /// m³.
    pub water: f64,
    /// Mass of the free blocks of the scene; kg.
    pub released: f64,
}

/// Kinetic energies downstream, and the flow in the reach upstream.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Flow {
    /// Of bodies and of water; J.
    pub kinetic: [f64; 2],
    pub reach: Reach,
}

/// Flow in the reach before a barrier, bodies and water together; NaN without any, and depths where there is no bed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Reach {
    /// kg.
    pub mass: f64,
    /// Along the flow, mean over the mass; m/s.
    pub speed: f64,
    /// Twice the mean height of the mass above the foot, which is that of an even layer; m.
    pub depth: f64,
}

impl Default for Reach {
    fn default() -> Self {
        Self {
            mass: 0.0,
            speed: f64::NAN,
            depth: f64::NAN,
        }
    }
}

/// Sums over the reach.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    mass: f64,
    momentum: f64,
    height: f64,
}

impl Sums {
    fn add(&mut self, barrier: &Barrier, (x, v): (&Vec3, &Vec3), mass: f64) {
        let at = barrier.coordinates(x);
        let before = barrier.extent[0][0] - at[0];
        let [left, right] = barrier.extent[1];
        if 0.0 <= before && before <= barrier.upstream && left <= at[1] && at[1] <= right {
            self.mass += mass;
            self.momentum += mass * v.dot(&barrier.axes[0]);
            self.height += mass * (at[2] - barrier.axes[2].dot(&barrier.foot));
        }
    }

    fn reach(&self) -> Reach {
        if self.mass <= 0.0 {
            return Reach::default();
        }
        Reach {
            mass: self.mass,
            speed: self.momentum / self.mass,
            depth: 2.0 * self.height / self.mass,
        }
    }
}

impl Passed {
    pub fn of(world: &World) -> Self {
        let blocks = &world.blocks;
        let free = (0..blocks.n_blocks()).filter(|&b| blocks.is_free(b));
        Self {
            has_passed: vec![false; blocks.n_blocks()],
            released: free.map(|b| blocks.mass(b)).sum(),
            ..Self::default()
        }
    }

    /// Looks at all bodies and particles.
    pub fn look(&mut self, barrier: &Barrier, world: &World) -> Flow {
        let beyond = |x: &Vec3| barrier.extent[0][1] < barrier.axes[0].dot(x);
        let (mut sums, mut kinetic) = (Sums::default(), [0.0; 2]);
        let blocks = &world.blocks;
        for (b, has_passed) in self.has_passed.iter_mut().enumerate() {
            // a block that left the domain stays where it left
            if !matches!(blocks.motion(b), riprap_dda::Motion::Free) {
                continue;
            }
            let x = blocks.centroid(b);
            if beyond(&x) {
                self.number += usize::from(!*has_passed);
                self.mass += if *has_passed { 0.0 } else { blocks.mass(b) };
                *has_passed = true;
            }
            if !blocks.is_free(b) {
                continue;
            }
            if beyond(&x) {
                kinetic[0] += blocks.kinetic_energy(b);
            }
            sums.add(barrier, (&x, &blocks.velocity(b)), blocks.mass(b));
        }
        if let Some(water) = &world.water {
            let particles = water.fluid.particles();
            let moving = particles.position.iter().zip(&particles.velocity);
            let bodies = moving.zip(&particles.mass).zip(&particles.id);
            for (((x, v), &mass), id) in bodies {
                if beyond(x) {
                    kinetic[1] += 0.5 * mass * v.norm_squared();
                    self.flowed(id.index(), water.fluid.particle_volume());
                }
                sums.add(barrier, (x, v), mass);
            }
        }
        Flow {
            kinetic,
            reach: sums.reach(),
        }
    }

    fn flowed(&mut self, particle: usize, volume: f64) {
        if self.has_flowed.len() <= particle {
            self.has_flowed.resize(particle + 1, false);
        }
        if !std::mem::replace(&mut self.has_flowed[particle], true) {
            self.water += volume;
        }
    }
}
