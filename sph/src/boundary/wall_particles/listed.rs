//! Neighbors across walls, listed as often as those within the fluid, or as the points are sorted.

use crate::fluid::wall_sums::SortedPoints;
use crate::neighbors::lists::Lists;
use crate::{Fluid, Vec3};

/// Lists of both directions.
#[derive(Clone, Debug, Default)]
pub(super) struct Listed {
    /// Points near particles.
    of_particles: OneWay,
    /// Particles near points.
    of_points: OneWay,
}

/// Lists of one direction.
#[derive(Clone, Debug, Default)]
struct OneWay {
    /// Making of the fluid's lists that these go with.
    made_for: Option<u64>,
    lists: Lists,
    receivers: Vec<u32>,
}

impl OneWay {
    fn are_of(&self, fluid: &Fluid) -> bool {
        self.made_for.is_some() && self.made_for == fluid.listing()
    }

    /// Lists the neighbors of some receivers, unless it is done.
    fn update(
        &mut self,
        fluid: &Fluid,
        receivers: &[u32],
        list: impl FnOnce(&mut Lists) -> Option<u64>,
    ) {
        if self.are_of(fluid) && self.receivers == receivers {
            return;
        }
        self.made_for = list(&mut self.lists);
        self.receivers.clear();
        self.receivers.extend_from_slice(receivers);
    }

    fn valid(&self, fluid: &Fluid) -> Option<&Lists> {
        self.are_of(fluid).then_some(&self.lists)
    }
}

impl Listed {
    /// Whether any go with the present lists of a fluid.
    pub(super) fn are_of(&self, fluid: &Fluid) -> bool {
        self.of_particles.are_of(fluid) || self.of_points.are_of(fluid)
    }

    /// Makes the next updates list anew.
    pub(super) fn forget(&mut self) {
        self.of_particles.made_for = None;
        self.of_points.made_for = None;
    }

    /// Points near particles, where they are listed.
    pub(super) fn of_particles(&self, fluid: &Fluid) -> Option<&Lists> {
        self.of_particles.valid(fluid)
    }

    /// Particles near points, where they are listed.
    pub(super) fn of_points(&self, fluid: &Fluid) -> Option<&Lists> {
        self.of_points.valid(fluid)
    }

    /// Lists the points near some particles, unless it is done.
    pub(super) fn update_particles(
        &mut self,
        fluid: &Fluid,
        walls: &SortedPoints,
        particles: &[u32],
    ) {
        self.of_particles.update(fluid, particles, |lists| {
            fluid.list_walls(walls, particles, lists)
        });
    }

    /// Lists the particles near some points at their positions when sorted (m), unless it is done.
    pub(super) fn update_points(&mut self, fluid: &Fluid, positions: &[Vec3], points: &[u32]) {
        self.of_points.update(fluid, points, |lists| {
            fluid.list_by_walls((positions, points), lists)
        });
    }
}
