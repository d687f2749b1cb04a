//! Pressure of the fluid continued along gravity to places that are not of its particles.

use crate::fluid::wall_sums::{self, Near};
use crate::terms::extrapolation::Extrapolated;
use crate::terms::sums::Places;
use crate::{Fluid, Vec3};

/// Fluid pressure extrapolated along gravity to points other than its particles.
#[derive(Clone, Debug, Default)]
pub struct ContinuedPressure {
    chosen: Vec<u32>,
    sums: Vec<Extrapolated>,
    gravity: Vec3,
}

impl ContinuedPressure {
    /// Samples the fluid at some points (m); after [`Fluid::update_pressure`].
    pub fn find(&mut self, fluid: &Fluid, places: &[Vec3]) {
        self.chosen.clear();
        self.chosen.extend(0..places.len() as u32);
        self.sums.clear();
        self.sums.resize(places.len(), Extrapolated::default());
        self.gravity = fluid.settings.gravity;
        let places = Places {
            positions: places,
            facets: &[],
        };
        let near = Near::new(&self.chosen, None);
        wall_sums::extrapolation::<false>(fluid, places, near, &mut self.sums);
    }

    /// For each point the fluid fraction of its support, `Σ V W`, and the pressure, 0 without fluid; –, Pa.
    pub fn found(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.sums.iter().map(|sum| {
            let pull = self.gravity.dot(&Vec3::from(sum.moment));
            let pressure = (sum.pressure + pull) / sum.weight;
            [sum.weight, if 0.0 < sum.weight { pressure } else { 0.0 }]
        })
    }
}
