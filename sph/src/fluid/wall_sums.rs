//! Sums between the fluid and its walls: over wall points for some of the particles, over the fluid for some wall points.

use crate::neighbors::sweep::{PairKind, Receivers};
use crate::terms::concentration::Concentration;
use crate::terms::continuity::{Rate, RateOwn};
use crate::terms::extrapolation::Extrapolated;
use crate::terms::gradient::StrainSums;
use crate::terms::momentum::{ForceDensity, ForceOwn};
use crate::terms::sums::formulas::{Concentrations, Extrapolations, Strains, WallRates};
use crate::terms::sums::{
    Formula, Neighborhood, Places, Reactions, Setup, Shearing, WallForces, WallPairs, run_term,
};
use crate::{Fluid, Vec3};

impl Fluid {
    /// Sums over walls for some of the particles.
    fn to_some<'a>(&'a self, walls: Neighborhood<'a>, chosen: &'a [u32]) -> Setup<'a> {
        Setup {
            settings: &self.settings,
            from: walls,
            receivers: some(&self.particles.position, chosen),
            lists: None,
        }
    }

    /// Sums over the fluid for some of many wall points.
    fn to_places<'a>(&'a self, places: Places<'a>, chosen: &'a [u32]) -> Setup<'a> {
        let between = PairKind::WallsAndParticles(places.facets);
        Setup {
            settings: &self.settings,
            from: self.neighborhood(&self.scratch.points, between),
            receivers: some(places.positions, chosen),
            lists: None,
        }
    }
}

/// Some of many receivers.
fn some<'a>(positions: &'a [Vec3], chosen: &'a [u32]) -> Receivers<'a> {
    Receivers {
        positions,
        chosen: Some(chosen),
    }
}

fn across<F: Formula>(setup: &Setup, formula: &F, out: &mut [F::Out]) {
    run_term::<WallPairs, F>(setup, formula, out);
}

/// Rates of density of some particles from wall points, which hold velocity and volume.
pub(crate) fn rates(fluid: &Fluid, walls: Neighborhood, chosen: &[u32], out: &mut [Rate]) {
    let own = RateOwn {
        velocity: &fluid.particles.velocity,
        density: &fluid.particles.density,
    };
    across(&fluid.to_some(walls, chosen), &WallRates { own }, out);
}

/// Gradient of velocity of some particles as far as wall points, which hold velocity and volume, make it.
pub(crate) fn strains(fluid: &Fluid, walls: Neighborhood, chosen: &[u32], out: &mut [StrainSums]) {
    let velocity = &fluid.particles.velocity;
    across(&fluid.to_some(walls, chosen), &Strains { velocity }, out);
}

/// Concentration of some particles as far as wall points make it.
pub(crate) fn concentrations(
    fluid: &Fluid,
    walls: Neighborhood,
    chosen: &[u32],
    out: &mut [Concentration],
) {
    across(&fluid.to_some(walls, chosen), &Concentrations, out);
}

/// Forces per volume of wall points, which hold velocity, pressure and volume, on some particles.
pub(crate) fn forces(
    fluid: &Fluid,
    walls: Neighborhood,
    chosen: &[u32],
    shear: Shearing,
    out: &mut [ForceDensity],
) {
    let own = ForceOwn {
        velocity: &fluid.particles.velocity,
        pressure: &fluid.particles.pressure,
    };
    across(
        &fluid.to_some(walls, chosen),
        &WallForces { own, shear },
        out,
    );
}

/// Forces per volume of the fluid on some wall points, with given velocities and
/// pressures; after [`Fluid::pack_forces`].
pub(crate) fn reactions(
    fluid: &Fluid,
    places: Places,
    (velocity, pressure): (&[Vec3], &[f64]),
    chosen: &[u32],
    shear: Shearing,
    out: &mut [ForceDensity],
) {
    let own = ForceOwn { velocity, pressure };
    across(
        &fluid.to_places(places, chosen),
        &Reactions { own, shear },
        out,
    );
}

/// Pressure and velocity of the fluid continued to some points, with `SLOPED` those of the points that each sees; after
/// [`Fluid::pack_forces`].
pub(crate) fn extrapolation<const SLOPED: bool>(
    fluid: &Fluid,
    places: Places,
    chosen: &[u32],
    out: &mut [Extrapolated],
) {
    across(
        &fluid.to_places(places, chosen),
        &Extrapolations::<SLOPED>,
        out,
    );
}
