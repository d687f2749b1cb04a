//! Sort of the particles by cell, and what leaves the domain.

use rayon::prelude::*;

use crate::fluid::at_start::AtStart;
use crate::fluid::scratch::Scratch;
use crate::particles::filter;
use crate::{CHUNK, Dimensions, Fluid};

impl Fluid {
    /// Farthest that a particle may be from where it was when it was sorted; m.
    pub fn moved(&self) -> f64 {
        self.moved
    }

    /// Largest speed at the last kick, with which particles drift; m/s.
    pub fn drift_speed(&self) -> f64 {
        self.max_speed
    }

    /// Farthest that a particle may ever be from where it was sorted; m.
    pub fn farthest_from_sort(&self) -> f64 {
        0.5 * self.widest_skin
    }

    /// Number of sorts so far: particles keep their order while it stays the same.
    pub fn sorts(&self) -> u64 {
        self.sorts
    }

    /// Approach of two particles after which [`Self::refresh`] sorts them again; m.
    pub fn skin(&self) -> f64 {
        self.skin.now()
    }

    /// Whether the last sort still holds.
    pub(crate) fn is_sorted(&self) -> bool {
        // both of a pair may have moved
        2.0 * self.moved <= self.skin()
    }

    /// Makes the next [`Self::refresh`] sort.
    pub(crate) fn forget_order(&mut self) {
        self.moved = f64::INFINITY;
    }

    /// Sorts the particles by cell if they have moved far enough since the last time: then sends back those that
    /// passed a plane of symmetry, removes those that left the domain, and takes those that left through a
    /// periodic side to the other one.
    /// Returns how many were removed. Accelerations are stale after a sort.
    pub fn refresh(&mut self) -> u64 {
        self.skin.look();
        if self.is_sorted() {
            return 0;
        }
        if self.settings.has_symmetry() {
            self.reflect();
        }
        let gone = self.remove_escaped();
        self.sort();
        gone
    }

    fn remove_escaped(&mut self) -> u64 {
        let keep = &mut self.scratch.keep;
        keep.clear();
        keep.extend(
            self.particles
                .position
                .iter()
                .map(|x| self.grid.contains(x)),
        );
        if keep.iter().all(|&inside| inside) {
            return 0;
        }
        let keep = std::mem::take(keep);
        let mut gone = 0;
        for (a, _) in keep.iter().enumerate().filter(|(_, inside)| !**inside) {
            let content = self.content(a);
            self.removed.mass += content.mass;
            self.removed.momentum += content.momentum;
            self.removed.energy += content.energy;
            gone += 1;
        }
        self.removed.count += gone;
        self.particles.retain(&keep);
        self.at_start.retain(&keep);
        if let Some(sleep) = &mut self.sleep {
            filter(&mut sleep.home, &keep);
        }
        self.scratch.keep = keep;
        gone
    }

    fn sort(&mut self) {
        if self.settings.periodic.contains(&true) {
            let grid = &self.grid;
            if let Some(sleep) = &mut self.sleep {
                // the displacement is unchanged when a particle continues at the other side
                for (home, x) in sleep.home.iter_mut().zip(&self.particles.position) {
                    *home += grid.wrapped(*x) - x;
                }
            }
            self.particles
                .position
                .par_chunks_mut(CHUNK)
                .for_each(|chunk| chunk.iter_mut().for_each(|x| *x = grid.wrapped(*x)));
        }
        let Scratch {
            cell,
            order,
            ids,
            vectors,
            numbers,
            kinds,
            ..
        } = &mut self.scratch;
        self.grid.sort(&self.particles.position, cell, order);
        fn reorder<T: Copy + Send + Sync + Default>(
            column: &mut Vec<T>,
            order: &[u32],
            spare: &mut Vec<T>,
        ) {
            spare.resize(order.len(), T::default());
            spare
                .par_chunks_mut(CHUNK)
                .zip(order.par_chunks(CHUNK))
                .for_each(|(spare, order)| {
                    for (slot, &a) in spare.iter_mut().zip(order) {
                        *slot = column[a as usize];
                    }
                });
            std::mem::swap(column, spare);
        }
        let particles = &mut self.particles;
        reorder(&mut particles.id, order, ids);
        reorder(&mut particles.position, order, vectors);
        reorder(&mut particles.velocity, order, vectors);
        reorder(&mut particles.density, order, numbers);
        reorder(&mut particles.mass, order, numbers);
        reorder(&mut particles.kind, order, kinds);
        if !particles.bulk_pressure.is_empty() {
            // those that came in wait for their first rates
            particles.bulk_pressure.resize(order.len(), 0.0);
            reorder(&mut particles.bulk_pressure, order, numbers);
        }
        let AtStart { velocity, density } = &mut self.at_start;
        if !velocity.is_empty() {
            reorder(velocity, order, vectors);
        }
        if !density.is_empty() {
            reorder(density, order, numbers);
        }
        if let Some(sleep) = &mut self.sleep {
            reorder(&mut sleep.home, order, vectors);
        }
        self.lists.forget();
        let support = self.settings.support_radius();
        let dimensions = match self.settings.dimensions {
            Dimensions::Two { .. } => 2,
            Dimensions::Three => 3,
        };
        (self.skin).choose(self.moved, (support, self.widest_skin), dimensions);
        self.moved = 0.0;
        self.sorts += 1;
        self.find_rests();
    }
}
