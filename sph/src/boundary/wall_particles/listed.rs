//! Neighbors across walls that stand, listed as often as those within the fluid.

use crate::neighbors::cells::CellGrid;
use crate::neighbors::lists::Lists;
use crate::neighbors::sweep::AnyPoints;
use crate::{Fluid, Vec3};

/// Lists of both directions.
#[derive(Clone, Debug, Default)]
pub(super) struct Listed {
    /// Making of the fluid's lists that these go with.
    made_for: Option<u64>,
    /// Points near particles, and the particles.
    pub(super) of_particles: Lists,
    particles: Vec<u32>,
    /// Particles near points, and the points.
    pub(super) of_points: Lists,
    points: Vec<u32>,
    packed: AnyPoints,
}

/// Points of walls that stand.
pub(super) struct Standing<'a> {
    pub(super) grid: &'a CellGrid,
    /// Positions by cell, and in the order of the bodies; m.
    pub(super) sorted: &'a [Vec3],
    pub(super) positions: &'a [Vec3],
}

impl Listed {
    /// Whether they go with the present lists of a fluid.
    pub(super) fn are_of(&self, fluid: &Fluid) -> bool {
        self.made_for.is_some() && self.made_for == fluid.listing()
    }

    /// Makes the next update list anew.
    pub(super) fn forget(&mut self) {
        self.made_for = None;
    }

    /// Lists the neighbors of some particles and points, unless it is done.
    pub(super) fn update(
        &mut self,
        fluid: &Fluid,
        walls: &Standing,
        particles: &[u32],
        points: &[u32],
    ) {
        if self.are_of(fluid) && self.particles == particles && self.points == points {
            return;
        }
        self.made_for = fluid.list_walls(
            (walls.grid, walls.sorted),
            (particles, &mut self.of_particles),
            (points, walls.positions, &mut self.of_points),
            &mut self.packed,
        );
        self.particles.clear();
        self.particles.extend_from_slice(particles);
        self.points.clear();
        self.points.extend_from_slice(points);
    }
}
