//! Sort of the particles by cell, and what leaves the domain.

use rayon::prelude::*;

use crate::fluid::at_start::AtStart;
use crate::fluid::scratch::Scratch;
use crate::particles::filter;
use crate::{CHUNK, Dimensions, Fluid, ParticleId, Particles, Vec3};

/// Distance from the domain beyond which a particle has left it; × spacing. One that passed the face of a solid where the domain
/// ends, by up to half a spacing in a step, is put back by that face first.
const OUTSIDE: f64 = 1.0;

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
        self.widest_skin
    }

    /// Number of sorts so far: particles keep their order while it stays the same.
    pub fn sorts(&self) -> u64 {
        self.sorts
    }

    /// Approach of two particles after which [`Self::refresh`] sorts them again; m.
    pub fn skin(&self) -> f64 {
        self.skin.now()
    }

    /// What of the skin may have been used up since the last sort: by a pair of particles, or by one and a point of a wall; m.
    fn used(&self) -> f64 {
        self.approached.max(self.moved)
    }

    /// Whether the last sort still holds.
    pub(crate) fn is_sorted(&self) -> bool {
        self.used() <= self.skin()
    }

    /// Makes the next [`Self::refresh`] sort.
    pub(crate) fn forget_order(&mut self) {
        (self.moved, self.approached) = (f64::INFINITY, f64::INFINITY);
    }

    /// Sorts the particles by cell if they have moved far enough since the last time: then sends back those that
    /// passed a plane of symmetry, removes those that left the domain by more than a spacing, and takes those that left through a
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
        let margin = OUTSIDE * self.settings.mean_spacing();
        let (positions, grid) = (&self.particles.position, &self.grid);
        let is_inside = |x: &Vec3| grid.contains(x, margin);
        if positions.par_iter().with_min_len(CHUNK).all(is_inside) {
            return 0;
        }
        let mut keep = std::mem::take(&mut self.scratch.keep);
        keep.clear();
        keep.extend(positions.iter().map(is_inside));
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
        let Scratch { cell, order, .. } = &mut self.scratch;
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
        // the next evaluation finds pressures and accelerations anew: until then their columns are spare ones
        let Particles {
            id,
            position,
            velocity,
            mass,
            density,
            pressure: numbers,
            acceleration: vectors,
            kind,
            bulk_pressure,
            porosity,
            carried,
            grain_flux,
            ..
        } = &mut self.particles;
        reorder(position, order, vectors);
        reorder(velocity, order, vectors);
        reorder(density, order, numbers);
        reorder(mass, order, numbers);
        if !bulk_pressure.is_empty() {
            // those that came in wait for their first rates
            bulk_pressure.resize(order.len(), 0.0);
            reorder(bulk_pressure, order, numbers);
        }
        if !porosity.is_empty() {
            reorder(porosity, order, numbers);
        }
        if !carried.is_empty() {
            reorder(carried, order, numbers);
        }
        if !grain_flux.is_empty() {
            reorder(grain_flux, order, vectors);
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
        vectors
            .par_chunks_mut(CHUNK)
            .for_each(|chunk| chunk.fill(Vec3::zeros()));
        numbers
            .par_chunks_mut(CHUNK)
            .for_each(|chunk| chunk.fill(0.0));
        cell.par_chunks_mut(CHUNK)
            .zip(order.par_chunks(CHUNK))
            .for_each(|(cell, order)| {
                for (slot, &a) in cell.iter_mut().zip(order) {
                    *slot = id[a as usize].into();
                }
            });
        for (id, &moved) in id.iter_mut().zip(cell.iter()) {
            *id = ParticleId::from(moved);
        }
        if kind.iter().any(|&kind| kind != 0) {
            let moved = order.iter().map(|&a| kind[a as usize]).collect();
            *kind = moved;
        }
        self.lists.forget();
        let support = self.settings.support_radius();
        let dimensions = match self.settings.dimensions {
            Dimensions::Two { .. } => 2,
            Dimensions::Three => 3,
        };
        (self.skin).choose(self.used(), (support, self.widest_skin), dimensions);
        (self.moved, self.approached) = (0.0, 0.0);
        self.sorts += 1;
        self.find_rests();
    }
}
