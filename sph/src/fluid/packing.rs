//! Packing: a lattice that does not fit its walls, spread evenly between them before a run.

use rayon::prelude::*;

use crate::{CHUNK, Fluid, ParticleId, Vec3};

/// Displacement of a particle per iteration over `h² ∇C`: a lattice with alternating disturbances still comes to rest.
const GAIN: f64 = 0.2;
/// Most that a particle moves in a round; × spacing.
const LONGEST_WAY: f64 = 0.1;
/// Fractions of a full neighborhood between which particles start to take part: a plane surface, left unchanged, has
/// one half.
const TAKING_PART: [f64; 2] = [0.7, 0.9];

impl Fluid {
    /// Moves particles a little towards where they are sparse, after [`Self::update_concentration`] and the walls' part;
    /// returns the largest `h |∇C|` of those that move. Velocities stay.
    ///
    /// ```text
    /// δx = −0.2 h² ∇C,   ∇C = Σ V ∇W over fluid and walls,   at most 0.1 dp
    /// ```
    /// after Colagrossi, Bouscasse, Antuono & Marrone (2012). `is_held` tells by id whether a particle is fixed.
    pub fn even_out(&mut self, is_held: impl Fn(ParticleId) -> bool + Sync) -> f64 {
        let settings = &self.settings;
        let h = settings.smoothing_length;
        let least = settings.least_spacing();
        let full = settings.dimensions.count();
        let [none, all] = TAKING_PART;
        let share = |divergence: f64| ((divergence / full - none) / (all - none)).clamp(0.0, 1.0);
        let particles = &mut self.particles;
        let largest = particles
            .position
            .par_chunks_mut(CHUNK)
            .zip(particles.id.par_chunks(CHUNK))
            .zip(self.scratch.concentrations.par_chunks(CHUNK))
            .map(|((positions, ids), concentrations)| {
                let mut largest = 0.0_f64;
                for ((x, &id), concentration) in positions.iter_mut().zip(ids).zip(concentrations) {
                    if is_held(id) {
                        continue;
                    }
                    let uneven =
                        Vec3::from(concentration.gradient) * (h * share(concentration.divergence));
                    let way = GAIN * h * uneven;
                    *x -= way * (LONGEST_WAY * least / way.norm()).min(1.0);
                    largest = largest.max(uneven.norm());
                }
                largest
            })
            .reduce(|| 0.0, f64::max);
        self.forget_order();
        largest
    }
}
