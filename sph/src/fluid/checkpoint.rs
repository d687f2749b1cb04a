//! The state as bytes: saved in a run, read back into a fluid of the same settings.
//!
//! Lists of neighbors are long and are not kept: they are made again from the positions that they were made from, so that
//! sums add the same numbers in the same order.

use postcard::Error;
use serde::{Serialize, Serializer};

use crate::fluid::rates::Rates;
use crate::fluid::sleep::Sleep;
use crate::neighbors::points::{Frame, Places};
use crate::particles::Particles;
use crate::{Fluid, Vec3};

/// No particle is farther from the domain; × its diagonal.
const FARTHEST: f64 = 1e6;

impl Fluid {
    /// Appends the state to some bytes.
    ///
    /// # Errors
    ///
    /// None is expected: the format accepts any fluid.
    pub fn save(&self, out: Vec<u8>) -> Result<Vec<u8>, Error> {
        // no `..`: a new column cannot be forgotten
        let Self {
            particles,
            at_start: _,
            sleep,
            grid,
            lists,
            moved,
            approached,
            max_speed,
            closing_speed,
            n_pairs,
            viscous_loss,
            bulk_loss,
            from_walls,
            diffusive_loss,
            withheld_loss,
            from_walls_by_grains,
            removed,
            plane_force,
            reflected,
            scratch,
            // of the step before
            n_products: _,
            // walls set them up again
            thin_solids: _,
            skin,
            // constants
            frame,
            settings: _,
            state: _,
            rheologies: _,
            particle_volume: _,
            lattice_sum: _,
            widest_skin: _,
            sorts: _,
        } = self;
        let out = postcard::to_extend(particles, out)?;
        let out = postcard::to_extend(grid.starts(), out)?;
        let listed = lists.made_from().filter(|_| self.is_sorted());
        let positions = &particles.position;
        let listed = listed.map(|(places, radius)| {
            let way = Way {
                positions,
                places,
                frame,
            };
            (way, radius)
        });
        let out = postcard::to_extend(&listed, out)?;
        let losses = (viscous_loss, bulk_loss, diffusive_loss, withheld_loss);
        let energies = (losses, (from_walls, from_walls_by_grains));
        let momenta = (removed, plane_force, reflected);
        let ways = (moved, approached, max_speed, closing_speed);
        let rest = (ways, skin, n_pairs, energies, momenta);
        let out = postcard::to_extend(&rest, out)?;
        // the next step starts with these
        let keeps = self.settings.scheme.stepping.rates_with_forces();
        let rates = keeps.then_some(&scratch.rates);
        postcard::to_extend(&(&scratch.pushes, rates, sleep), out)
    }

    /// Restores the state from the front of bytes written by [`Self::save`]; returns the rest. The continuation is bitwise
    /// identical.
    ///
    /// # Errors
    ///
    /// The bytes end early, are invalid, or belong to another fluid. This one can then not be continued.
    pub fn read<'a>(&mut self, bytes: &'a [u8]) -> Result<&'a [u8], Error> {
        let bad = Err(Error::DeserializeBadEncoding);
        let (particles, bytes) = postcard::take_from_bytes::<Particles>(bytes)?;
        let n = particles.len();
        if !particles.is_whole() || !self.are_near(&particles.position) {
            return bad;
        }
        self.particles = particles;
        if self.settings.bulk_viscosity() == 0.0 {
            // of a run that had some until here
            self.particles.bulk_pressure.clear();
        }
        self.sorts += 1;
        let (starts, bytes) = postcard::take_from_bytes(bytes)?;
        if !self.grid.set_starts(starts, n) {
            return bad;
        }
        let (listed, bytes) = postcard::take_from_bytes::<Option<(Vec<[i32; 3]>, f64)>>(bytes)?;
        let (rest, bytes) = postcard::take_from_bytes(bytes)?;
        let (ways, energies, momenta);
        (ways, self.skin, self.n_pairs, energies, momenta) = rest;
        (
            self.moved,
            self.approached,
            self.max_speed,
            self.closing_speed,
        ) = ways;
        if !(self.skin).is_of(self.settings.support_radius(), self.widest_skin) {
            return bad;
        }
        let ((viscous, bulk, diffusive, withheld), from_walls) = energies;
        (self.viscous_loss, self.bulk_loss) = (viscous, bulk);
        (self.diffusive_loss, self.withheld_loss) = (diffusive, withheld);
        (self.from_walls, self.from_walls_by_grains) = from_walls;
        (self.removed, self.plane_force, self.reflected) = momenta;
        let (last, bytes) = postcard::take_from_bytes(bytes)?;
        let rates: Option<Rates>;
        (self.scratch.pushes, rates, self.sleep) = last;
        self.scratch.rates = rates.unwrap_or_default();
        let is_of_these = |sleep: &Sleep| sleep.is_of(&self.grid, n) && self.are_near(&sleep.home);
        if !self.sleep.as_deref().is_none_or(is_of_these) {
            return bad;
        }
        if let Some(sleep) = &mut self.sleep {
            sleep.find_still();
        }
        let are_known = self.scratch.pushes.iter().all(|&(a, _)| (a as usize) < n);
        let rates = &self.scratch.rates;
        if !are_known || !rates.is_whole() || ![0, n].contains(&rates.len()) {
            return bad;
        }
        self.lists.forget();
        if let Some((mut places, radius)) = listed {
            let is_within = radius <= self.settings.support_radius() + self.skin();
            if places.len() != n || !is_within {
                return bad;
            }
            for (quanta, x) in places.iter_mut().zip(&self.particles.position) {
                let now = self.frame.place(x).quanta;
                *quanta = std::array::from_fn(|axis| now[axis].wrapping_add(quanta[axis]));
            }
            self.list_within(radius, Places::from_quanta(&places));
        }
        self.pack_forces();
        Ok(bytes)
    }

    /// Whether all positions are finite and within the range of cell numbers; a run cannot continue with others.
    fn are_near(&self, positions: &[Vec3]) -> bool {
        let (min, max) = self.settings.domain;
        let farthest = FARTHEST * (max - min).norm();
        positions.iter().all(|x| (x - min).norm() <= farthest)
    }
}

/// Places as they are saved, particle by particle: from where they are now, as they have not moved far.
struct Way<'a> {
    /// m.
    positions: &'a [Vec3],
    places: &'a Places,
    frame: &'a Frame,
}

impl Serialize for Way<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let both = self.places.iter().zip(self.positions);
        serializer.collect_seq(both.map(|(then, x)| {
            let now = self.frame.place(x).quanta;
            [0, 1, 2].map(|axis: usize| then[axis].wrapping_sub(now[axis]))
        }))
    }
}
