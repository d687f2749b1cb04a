//! Viscosity that varies: flow laws of particles, rates of shear, apparent viscosities.

use rayon::prelude::*;

use crate::fluid::sums;
use crate::scheme::Viscosity;
use crate::{CHUNK, Fluid, FluidError, Particles, Rheology};

impl Fluid {
    /// Gives particles flow laws of their own: `kinds` has the number of the law of every particle, in order
    /// of id; particles beyond its end keep theirs. Where the viscosity of the scheme is not
    /// [`Viscosity::Rheological`] the laws take no part.
    ///
    /// # Errors
    ///
    /// [`FluidError::Setting`] for a law out of range or a number that has no law.
    pub fn set_rheologies(
        &mut self,
        rheologies: Vec<Rheology>,
        kinds: &[u8],
    ) -> Result<(), FluidError> {
        rheologies.iter().try_for_each(Rheology::check)?;
        let particles = &mut self.particles;
        for (kind, &id) in particles.kind.iter_mut().zip(&particles.id) {
            *kind = kinds.get(id.index()).copied().unwrap_or(*kind);
            if rheologies.len() <= usize::from(*kind) {
                return Err(FluidError::Setting {
                    name: "kind",
                    value: f64::from(*kind),
                    range: "the number of a flow law",
                });
            }
        }
        self.rheologies = rheologies;
        Ok(())
    }

    /// Whether each particle has its own viscosity.
    pub fn varies_viscosity(&self) -> bool {
        self.settings.scheme.viscosity.varies()
    }

    /// Apparent viscosity of a particle, by its index in the current order; Pa s.
    pub fn apparent_viscosity(&self, particle: usize) -> f64 {
        let constant = || self.settings.kinematic_viscosity() * self.settings.reference_density;
        let viscosity = self.particles.viscosity.get(particle);
        viscosity.copied().unwrap_or_else(constant)
    }

    /// Whether a particle flows, by its index in the current order; always true without a yield stress.
    pub fn is_yielded(&self, particle: usize) -> bool {
        let p = &self.particles;
        match (p.shear_rate.get(particle), p.kind.get(particle)) {
            (Some(&rate), Some(&kind)) => {
                let rheology = self.rheologies.get(usize::from(kind));
                rheology.is_none_or(|rheology| rheology.is_yielded(rate))
            }
            _ => true,
        }
    }

    /// Sums the gradient of velocity over the fluid; walls are added afterward, then
    /// [`Self::update_viscosity`]. After [`Self::update_pressure`], and only where viscosity varies.
    pub fn update_strain(&mut self) {
        sums::strains(self);
    }

    /// Rates of shear and apparent viscosities, which the forces of this step share.
    pub fn update_viscosity(&mut self) {
        let Particles {
            kind,
            shear_rate,
            viscosity,
            ..
        } = &mut self.particles;
        let (settings, rheologies) = (&self.settings, &self.rheologies);
        let reference = settings.reference_density;
        let mixing_length = settings.mixing_length();
        let of = |kind: u8, rate: f64| match settings.scheme.viscosity {
            Viscosity::SubParticleScale {
                kinematic_viscosity,
                ..
            } => reference * (kinematic_viscosity + mixing_length * mixing_length * rate),
            // a number without a law was refused
            _ => rheologies
                .get(usize::from(kind))
                .map_or(0.0, |rheology| rheology.apparent_viscosity(rate)),
        };
        shear_rate.resize(kind.len(), 0.0);
        viscosity.resize(kind.len(), 0.0);
        shear_rate
            .par_chunks_mut(CHUNK)
            .zip(viscosity.par_chunks_mut(CHUNK))
            .zip(kind.par_chunks(CHUNK))
            .zip(self.scratch.strains.par_chunks(CHUNK))
            .for_each(|(((rates, viscosities), kinds), strains)| {
                for (((rate, viscosity), kind), strain) in
                    rates.iter_mut().zip(viscosities).zip(kinds).zip(strains)
                {
                    *rate = strain.shear_rate(settings.dimensions);
                    *viscosity = of(*kind, *rate);
                }
            });
        let precision = settings.scheme.precision;
        let packed = &mut self.scratch.viscosities;
        packed.pack_values(precision, viscosity.len(), |a| {
            [viscosity[a], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
        });
    }
}
