//! Inflow boundary: rows of particles that enter.

use riprap_sph::exchange::NewParticle;
use riprap_sph::{Fluid, Vec3};

use super::hydrostatic;
use super::passage::Passage;
use crate::series::Series;

/// Driving condition of an inflow.
#[derive(Clone, Debug, PartialEq)]
pub enum Drive {
    /// Velocity, uniform over the depth; m/s.
    Velocity(Series),
    /// Through the whole face; m³/s.
    Discharge(Series),
}

/// Inflow boundary.
#[derive(Clone, Debug, PartialEq)]
pub struct Inflow {
    /// Its name.
    pub name: String,
    /// Its box.
    pub passage: Passage,
    /// Velocity or discharge.
    pub drive: Drive,
    /// Depth above the bottom of the box, rounded to whole rows; m.
    pub depth: Series,
    /// Distance that the rows have moved since the last one was added; m.
    pub(super) advanced: f64,
    /// Velocity at the last hold; m/s.
    pub(super) speed: f64,
}

/// Rows across the flow and upward, and their first position.
struct Rows {
    counts: [usize; 2],
    axes: [usize; 2],
    first: Vec3,
    spacing: Vec3,
}

impl Inflow {
    /// Inflow at rest until it is first held.
    pub fn new(name: String, passage: Passage, drive: Drive, depth: Series) -> Self {
        Self {
            name,
            passage,
            drive,
            depth,
            advanced: 0.0,
            speed: 0.0,
        }
    }

    fn rows(&self, fluid: &Fluid, time: f64) -> Rows {
        let spacing = Vec3::from(fluid.settings().particle_spacing);
        let Passage { min, max, axis, .. } = self.passage;
        let across = 1 - axis;
        let count = |length: f64, spacing: f64| (length / spacing).round().max(1.0) as usize;
        Rows {
            counts: [
                count(max[across] - min[across], spacing[across]),
                count(self.depth.at(time), spacing.z),
            ],
            axes: [across, 2],
            first: min + spacing * 0.5,
            spacing,
        }
    }

    /// Velocity along the flow; m/s.
    pub(super) fn speed_at(&self, fluid: &Fluid, time: f64) -> f64 {
        match &self.drive {
            Drive::Velocity(velocity) => velocity.at(time),
            Drive::Discharge(discharge) => {
                let rows = self.rows(fluid, time);
                let area = (0..2)
                    .map(|k| rows.counts[k] as f64 * rows.spacing[rows.axes[k]])
                    .product::<f64>();
                discharge.at(time) / area
            }
        }
    }

    /// Row across the flow at a distance `before` upstream of the face.
    pub(super) fn row(&self, fluid: &Fluid, time: f64, before: f64) -> Vec<NewParticle> {
        let rows = self.rows(fluid, time);
        let Passage {
            min,
            max,
            axis,
            upward,
        } = self.passage;
        let mut position = rows.first;
        position[axis] = if upward {
            max[axis] - before
        } else {
            min[axis] + before
        };
        let velocity = self.passage.direction() * self.speed_at(fluid, time);
        let mut made = Vec::with_capacity(rows.counts[0] * rows.counts[1]);
        for k in 0..rows.counts[1] {
            for j in 0..rows.counts[0] {
                let mut x = position;
                x[rows.axes[0]] += j as f64 * rows.spacing[rows.axes[0]];
                x.z += k as f64 * rows.spacing.z;
                made.push(NewParticle {
                    position: x,
                    velocity,
                    density: hydrostatic(fluid, min.z + self.depth.at(time) - x.z),
                });
            }
        }
        made
    }

    /// Number and spacing of the rows along the flow.
    pub(super) fn n_rows(&self, fluid: &Fluid) -> (usize, f64) {
        let spacing = fluid.settings().particle_spacing[self.passage.axis];
        // round-off of the lengths in a scene
        let n = (self.passage.length() / spacing + 1e-6).floor() as usize;
        (n, spacing)
    }
}
