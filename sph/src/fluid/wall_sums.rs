//! Sums between the fluid and its walls: over wall points for some of the particles, over the fluid for some wall points.

use crate::fluid::sums::Listing;
use crate::neighbors::cells::CellGrid;
use crate::neighbors::lists::{ListenerPlaces, Listeners, Lists, Surroundings};
use crate::neighbors::points::Places;
use crate::neighbors::sweep::{AnyPoints, PairKind, Receivers, dispatch};
use crate::terms::concentration::Concentration;
use crate::terms::continuity::{Rate, RateOwn};
use crate::terms::drag::DragOwn;
use crate::terms::extrapolation::Extrapolated;
use crate::terms::gradient::StrainSums;
use crate::terms::momentum::{ForceDensity, ForceOwn};
use crate::terms::sums::formulas::{Concentrations, Extrapolations, Strains, WallRates};
use crate::terms::sums::{
    Drags, Formula, Neighborhood, Places as WallPlaces, Reactions, Setup, Shearing, WallForces,
    WallPairs, run_term,
};
use crate::{CHUNK, Fluid, Vec3, pieces_at_once};

/// Particles near walls, or wall points near fluid; all of them or a part.
#[derive(Clone, Copy)]
pub(crate) struct Near<'a> {
    /// Numbers of all.
    all: &'a [u32],
    /// Their neighbors, where they are listed.
    lists: Option<&'a Lists>,
    /// Chunks before the part, and how many are in it.
    part: (usize, usize),
}

impl<'a> Near<'a> {
    /// All of some numbers, with their neighbors where they are listed.
    pub(crate) fn new(all: &'a [u32], lists: Option<&'a Lists>) -> Self {
        Self {
            all,
            lists,
            part: (0, all.len()),
        }
    }

    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        self.part.1
    }

    /// Their numbers.
    pub(crate) fn chosen(&self) -> &'a [u32] {
        let (first, n) = (self.part.0 * CHUNK, self.part.1);
        &self.all[first..first + n]
    }

    /// Parts of them, one after the other.
    pub(crate) fn parts(self) -> impl Iterator<Item = Self> {
        let (n, n_at_once) = (self.all.len(), pieces_at_once() * CHUNK);
        (0..n).step_by(n_at_once).map(move |first| Self {
            part: (first / CHUNK, (n - first).min(n_at_once)),
            ..self
        })
    }

    fn receivers(&self, positions: &'a [Vec3]) -> Receivers<'a> {
        let (n_chunks, n) = self.part;
        Receivers::new(positions, Some(self.all)).part(n_chunks, n)
    }
}

/// Points of walls in the order of their cells.
pub(crate) struct SortedPoints<'a> {
    pub grid: &'a CellGrid,
    /// Where they were sorted; m.
    pub positions: &'a [Vec3],
}

impl Fluid {
    /// Sums over walls for some of the particles.
    fn to_some<'a>(&'a self, walls: Neighborhood<'a>, near: Near<'a>) -> Setup<'a> {
        Setup {
            settings: &self.settings,
            from: walls,
            receivers: near.receivers(&self.particles.position),
            lists: near.lists,
        }
    }

    /// Sums over the fluid, packed in `points`, for some of many wall points.
    fn to_places<'a>(
        &'a self,
        points: &'a AnyPoints,
        places: WallPlaces<'a>,
        near: Near<'a>,
    ) -> Setup<'a> {
        let between = PairKind::WallsAndParticles(places.facets);
        Setup {
            settings: &self.settings,
            from: self.neighborhood(points, between),
            receivers: near.receivers(places.positions),
            lists: near.lists,
        }
    }

    /// Lists for some particles the points of walls within the reach of the fluid's own lists, from where both were when those
    /// lists were made and the points were sorted. Returns the number of that making, `None` if there are no such lists.
    pub(crate) fn list_walls(
        &self,
        walls: &SortedPoints,
        particles: &[u32],
        lists: &mut Lists,
    ) -> Option<u64> {
        let listed = self.listed()?;
        let (from, radius) = listed.made_from()?;
        let mut points = Places::default();
        points.pack(&self.frame, walls.positions);
        let receivers = Listeners {
            places: ListenerPlaces::Quanta(from),
            chosen: Some(particles),
        };
        self.list_across((walls.grid, &points), receivers, *radius, lists);
        listed.generation()
    }

    /// Lists for some wall points the particles, in the same way.
    pub(crate) fn list_by_walls(
        &self,
        (positions, points): (&[Vec3], &[u32]),
        lists: &mut Lists,
    ) -> Option<u64> {
        let listed = self.listed()?;
        let (from, radius) = listed.made_from()?;
        let receivers = Listeners {
            places: ListenerPlaces::Positions(positions),
            chosen: Some(points),
        };
        self.list_across((&self.grid, from), receivers, *radius, lists);
        listed.generation()
    }

    fn list_across(
        &self,
        (grid, points): (&CellGrid, &Places),
        receivers: Listeners,
        radius: f64,
        lists: &mut Lists,
    ) {
        let from = Surroundings {
            grid,
            frame: &self.frame,
            mirrors: self.settings.mirrors(),
            receivers,
            rests: &[],
            radius,
            reach: self.list_reach(radius),
        };
        dispatch(
            self.settings.scheme.precision,
            Listing {
                from,
                points,
                lists,
            },
        );
    }

    /// Farthest that wall points may be from where they were listed: what the particles have left of the skin; m.
    pub(crate) fn room_of_walls(&self) -> f64 {
        (self.skin() - self.moved).max(0.0)
    }

    /// Number of the making of the lists of neighbors, where they hold.
    pub(crate) fn listing(&self) -> Option<u64> {
        self.listed().and_then(Lists::generation)
    }
}

fn across<F: Formula>(setup: &Setup, formula: &F, out: &mut [F::Out]) {
    run_term::<WallPairs, F>(setup, formula, out);
}

/// Rates of density of some particles from wall points, which hold velocity and volume.
pub(crate) fn rates(fluid: &Fluid, walls: Neighborhood, near: Near, out: &mut [Rate]) {
    let own = RateOwn {
        velocity: fluid.fluxes(),
        density: &fluid.particles.density,
    };
    across(&fluid.to_some(walls, near), &WallRates { own }, out);
}

/// Gradient of velocity of some particles as far as wall points, which hold velocity and volume, make it.
pub(crate) fn strains(fluid: &Fluid, walls: Neighborhood, near: Near, out: &mut [StrainSums]) {
    let velocity = &fluid.particles.velocity;
    across(&fluid.to_some(walls, near), &Strains { velocity }, out);
}

/// Concentration of some particles as far as wall points make it.
pub(crate) fn concentrations(
    fluid: &Fluid,
    walls: Neighborhood,
    near: Near,
    out: &mut [Concentration],
) {
    across(&fluid.to_some(walls, near), &Concentrations, out);
}

/// Forces per volume of wall points, which hold velocity, pressure and volume, on some particles.
pub(crate) fn forces(
    fluid: &Fluid,
    walls: Neighborhood,
    near: Near,
    shear: Shearing,
    out: &mut [ForceDensity],
) {
    let own = ForceOwn {
        velocity: &fluid.particles.velocity,
        pressure: &fluid.particles.pressure,
    };
    across(&fluid.to_some(walls, near), &WallForces { own, shear }, out);
}

/// Forces per volume of the fluid on some wall points, with given velocities and
/// pressures; after [`Fluid::pack_forces`].
pub(crate) fn reactions(
    fluid: &Fluid,
    places: WallPlaces,
    (velocity, pressure): (&[Vec3], &[f64]),
    near: Near,
    shear: Shearing,
    out: &mut [ForceDensity],
) {
    let own = ForceOwn { velocity, pressure };
    across(
        &fluid.to_places(&fluid.scratch.points, places, near),
        &Reactions { own, shear },
        out,
    );
}

/// Viscous forces per volume on velocities of 1 m/s along x of some particles past wall points at rest, which hold volume.
pub(crate) fn drags_of_unit(
    fluid: &Fluid,
    walls: Neighborhood,
    near: Near,
    shear: Shearing,
    out: &mut [[f64; 3]],
) {
    let own = DragOwn::Unit;
    let drags = Drags::<true, false> { own, shear };
    across(&fluid.to_some(walls, near), &drags, out);
}

/// Viscous forces per volume of the fluid on some wall points at rest; the fluid's velocities and volumes are in `points`.
pub(crate) fn drags_on_walls(
    fluid: &Fluid,
    (points, places): (&AnyPoints, WallPlaces),
    near: Near,
    shear: Shearing,
    out: &mut [[f64; 3]],
) {
    let own = DragOwn::AtRest;
    let drags = Drags::<false, true> { own, shear };
    across(&fluid.to_places(points, places, near), &drags, out);
}

/// Pressure and velocity of the fluid continued to some points, with `SLOPED` those of the points that each sees; after
/// [`Fluid::pack_forces`].
pub(crate) fn extrapolation<const SLOPED: bool>(
    fluid: &Fluid,
    places: WallPlaces,
    near: Near,
    out: &mut [Extrapolated],
) {
    across(
        &fluid.to_places(&fluid.scratch.points, places, near),
        &Extrapolations::<SLOPED>,
        out,
    );
}
