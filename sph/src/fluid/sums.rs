//! Sums of the fluid over itself, and the packing and listing that they need.

use crate::Fluid;
use crate::Vec3;
use crate::fluid::scratch::Scratch;
use crate::neighbors::lists::{ListenerPlaces, Listeners, Lists, Surroundings};
use crate::neighbors::points::Places;
use crate::neighbors::rest::Still;
use crate::neighbors::sweep::{AnyPoints, PackedIn, PairKind, Receivers, Sum, dispatch};
use crate::simd::lanes::{Lanes, Machine};
use crate::terms::continuity::RateOwn;
use crate::terms::drag::DragOwn;
use crate::terms::momentum::{ForceDensity, ForceOwn};
use crate::terms::sums::formulas::{Concentrations, Densities, Gradients, Rates, Strains};
use crate::terms::sums::{
    Drags, FluidForces, FluidPairs, Formula, Neighborhood, Setup, Shearing, occlusion, run_term,
};
use crate::{CHUNK, pieces_at_once};

impl Fluid {
    /// Resistance to shear within the fluid.
    pub(crate) fn shearing(&self) -> Shearing<'_> {
        if self.varies_viscosity() {
            Shearing::OfParticles(&self.scratch.viscosities)
        } else {
            Shearing::Uniform(self.settings.scheme.viscosity)
        }
    }

    pub(super) fn neighborhood<'a>(
        &'a self,
        points: &'a AnyPoints,
        between: PairKind<'a>,
    ) -> Neighborhood<'a> {
        Neighborhood {
            occlusion: occlusion(&self.thin_solids, &self.particles.position, between),
            grid: &self.grid,
            frame: &self.frame,
            points,
            moved: self.moved(),
        }
    }

    /// Sums over the fluid for all its particles.
    fn to_everyone<'a>(&'a self, points: &'a AnyPoints) -> Setup<'a> {
        Setup {
            settings: &self.settings,
            from: self.neighborhood(points, PairKind::Particles),
            receivers: everyone(&self.particles.position),
            lists: self.listed(),
        }
    }

    /// The lists of neighbors, where they hold.
    pub(super) fn listed(&self) -> Option<&Lists> {
        (self.lists.are_made() && self.is_sorted()).then_some(&self.lists)
    }

    /// Particles that sums are made for: those that are awake, and those that sleep right beside them.
    pub fn n_receivers(&self) -> u64 {
        let listed = self.listed().filter(|_| self.may_sleep());
        listed.map_or(self.particles.len() as u64, Lists::n_receivers)
    }

    /// Lists the neighbors of all particles, if they were not since the last sort.
    fn list(&mut self) {
        if self.lists.are_made() || !self.is_sorted() {
            return;
        }
        // what was used up since the sort, by pairs and by walls, will not be again
        let radius = self.settings.support_radius() + self.skin() - self.approached.min(self.moved);
        if self.reach_of_cells() < radius + self.moved {
            return;
        }
        let mut places = self.lists.take_places();
        places.pack(&self.frame, &self.particles.position);
        self.list_within(radius, places);
    }

    /// Farthest that cells may be searched; m.
    fn reach_of_cells(&self) -> f64 {
        self.settings.support_radius() + self.widest_skin
    }

    /// Farthest that what is listed within a radius, now or since the last sort, may have been sorted; m.
    pub(super) fn list_reach(&self, radius: f64) -> f64 {
        (radius + self.moved).min(self.reach_of_cells())
    }

    /// Lists for all particles at these places the others within a radius (m), up to support and skin.
    pub(crate) fn list_within(&mut self, radius: f64, places: Places) {
        let mut lists = std::mem::take(&mut self.lists);
        let listing = Listing {
            from: Surroundings {
                grid: &self.grid,
                frame: &self.frame,
                mirrors: self.settings.mirrors(),
                receivers: Listeners {
                    places: ListenerPlaces::Quanta(&places),
                    chosen: None,
                },
                rests: self.rests(),
                radius,
                reach: self.list_reach(radius),
            },
            points: &places,
            lists: &mut lists,
        };
        dispatch(self.settings.scheme.precision, listing);
        lists.keep_basis(places, radius);
        self.lists = lists;
    }

    /// Packs velocity, of water and grains together where both are, density minus the reference density, and volume.
    fn pack_flow(&mut self, points: &mut AnyPoints) {
        // sums that read no velocity come before the first flux
        let p = &self.particles;
        let flux = Some(self.fluxes()).filter(|flux| flux.len() == p.len());
        let flux = flux.unwrap_or(&p.velocity);
        let reference = self.settings.reference_density;
        let still = Still::kept(self.sleep.as_deref(), |kept| kept.flow);
        points.pack_moving(
            self.settings.scheme.precision,
            &self.frame,
            (&p.position, still),
            |a| {
                let (v, rho) = (flux[a], p.density[a]);
                [
                    v.x,
                    v.y,
                    v.z,
                    p.water_density(a) - reference,
                    p.mass[a] / rho,
                ]
            },
        );
        if let Some(sleep) = &mut self.sleep {
            sleep.kept.flow = true;
        }
    }

    /// Storage of the packed flow: that of the force sums, or a separate one if the former must be kept.
    fn flow_points(&mut self) -> &mut AnyPoints {
        match self.sleep {
            None => &mut self.scratch.points,
            Some(_) => &mut self.scratch.flow,
        }
    }

    /// Packs velocity, pressure and volume, for [`forces`] and walls.
    pub(crate) fn pack_forces(&mut self) {
        let p = &self.particles;
        let still = Still::kept(self.sleep.as_deref(), |kept| kept.forces);
        self.scratch.points.pack_moving(
            self.settings.scheme.precision,
            &self.frame,
            (&p.position, still),
            |a| {
                let v = p.velocity[a];
                [v.x, v.y, v.z, p.pressure[a], p.mass[a] / p.density[a]]
            },
        );
        if let Some(sleep) = &mut self.sleep {
            sleep.kept.forces = true;
        }
    }
}

fn everyone(positions: &[Vec3]) -> Receivers<'_> {
    Receivers::new(positions, None)
}

/// Listing of the neighbors of some receivers.
pub(super) struct Listing<'a> {
    pub from: Surroundings<'a>,
    pub points: &'a Places,
    pub lists: &'a mut Lists,
}

impl Sum for Listing<'_> {
    fn run<L>(self, machine: L::Machine)
    where
        L: Lanes,
        L::Machine: Machine,
        L::Record: Default + PackedIn,
    {
        self.lists.make::<L>(machine, self.from, self.points);
    }
}

/// Records that a sum within the fluid reads.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Packed {
    /// Velocity, density and volume: packed for this sum.
    Flow,
    /// Velocity, pressure and volume: packed before, see [`Fluid::pack_forces`].
    Forces,
}

/// Sums within the fluid into a column of its scratch; returns how many neighbors were found, particles that meet themselves
/// among them.
fn sum_into<O: Clone + Default>(
    fluid: &mut Fluid,
    packed: Packed,
    column: fn(&mut Scratch) -> &mut Vec<O>,
    sum: impl FnOnce(&Fluid, &Setup, &mut [O]) -> u64,
) -> u64 {
    let mut out = std::mem::take(column(&mut fluid.scratch));
    let points_of = |fluid: &mut Fluid| match packed {
        Packed::Flow => std::mem::take(fluid.flow_points()),
        Packed::Forces => std::mem::take(&mut fluid.scratch.points),
    };
    let mut points = points_of(fluid);
    if packed == Packed::Flow {
        fluid.pack_flow(&mut points);
    }
    out.resize(fluid.particles.len(), O::default());
    fluid.list();
    fluid.skin.count_sum();
    let n_found = sum(fluid, &fluid.to_everyone(&points), &mut out);
    match packed {
        Packed::Flow => *fluid.flow_points() = points,
        Packed::Forces => fluid.scratch.points = points,
    }
    *column(&mut fluid.scratch) = out;
    n_found
}

fn within<F: Formula>(setup: &Setup, formula: &F, out: &mut [F::Out]) -> u64 {
    run_term::<FluidPairs, F>(setup, formula, out)
}

/// Density by summation, times a factor; returns the number of ordered pairs.
pub(crate) fn summation(fluid: &mut Fluid, factor: f64) -> u64 {
    let mut points = std::mem::take(&mut fluid.scratch.points);
    let mut density = std::mem::take(&mut fluid.particles.density);
    let mass = &fluid.particles.mass;
    points.pack(
        fluid.settings.scheme.precision,
        &fluid.frame,
        &fluid.particles.position,
        |a| [0.0, 0.0, 0.0, 0.0, mass[a] * factor],
    );
    fluid.list();
    fluid.skin.count_sum();
    let n_found = within(&fluid.to_everyone(&points), &Densities, &mut density);
    fluid.particles.density = density;
    fluid.scratch.points = points;
    n_found - fluid.particles.len() as u64
}

/// Rates of density in the fluid, part by part; returns the number of ordered pairs.
pub(crate) fn rates(fluid: &mut Fluid) -> u64 {
    let mut points = std::mem::take(fluid.flow_points());
    fluid.pack_flow(&mut points);
    let mut all = std::mem::take(&mut fluid.scratch.rate_sums);
    let mut rates = std::mem::take(&mut fluid.scratch.rates);
    rates.begin(fluid.particles.len());
    let mut n_found = 0;
    by_parts(fluid, &mut all, |fluid, part, out| {
        let formula = Rates {
            own: RateOwn {
                velocity: fluid.fluxes(),
                density: fluid.water_densities(),
            },
            gradients: &fluid.scratch.extra,
        };
        n_found += within(&part.of(fluid.to_everyone(&points)), &formula, out);
        rates.write(part.n_chunks, out, Still::of(fluid.sleep.as_deref()));
    });
    fluid.scratch.rates = rates;
    fluid.scratch.rate_sums = all;
    *fluid.flow_points() = points;
    n_found - fluid.n_receivers()
}

/// Part of the particles, in chunks.
#[derive(Clone, Copy)]
struct Part {
    /// Chunks before it.
    n_chunks: usize,
    /// Number of particles in it.
    n: usize,
}

impl Part {
    /// The part of a sum for all.
    fn of<'a>(&self, setup: Setup<'a>) -> Setup<'a> {
        Setup {
            receivers: setup.receivers.part(self.n_chunks, self.n),
            ..setup
        }
    }
}

/// A sum for all particles, part by part into a column as long as a part.
fn by_parts<O: Clone + Default>(
    fluid: &mut Fluid,
    column: &mut Vec<O>,
    mut sum: impl FnMut(&mut Fluid, Part, &mut [O]),
) {
    fluid.list();
    fluid.skin.count_sum();
    let n = fluid.particles.len();
    let n_at_once = n.min(pieces_at_once() * CHUNK).max(1);
    column.resize(n_at_once, O::default());
    for first in (0..n).step_by(n_at_once) {
        let part = Part {
            n_chunks: first / CHUNK,
            n: (n - first).min(n_at_once),
        };
        sum(fluid, part, &mut column[..part.n]);
    }
}

/// Renormalized gradients of density, packed for the sums, into the scratch.
pub(crate) fn density_gradients(fluid: &mut Fluid) {
    sum_into(
        fluid,
        Packed::Flow,
        |scratch| &mut scratch.gradients,
        |fluid, setup, out| {
            let density = fluid.water_densities();
            within(setup, &Gradients { density }, out)
        },
    );
    let precision = fluid.settings.scheme.precision;
    let Scratch {
        gradients, extra, ..
    } = &mut fluid.scratch;
    extra.pack_values(precision, gradients.len(), |a| {
        let [x, y, z] = gradients[a];
        [x, y, z, 0.0, 0.0, 0.0, 0.0, 0.0]
    });
}

/// Sums of the gradient of velocity in the fluid into the scratch; after [`Fluid::pack_forces`].
pub(crate) fn strains(fluid: &mut Fluid) {
    sum_into(
        fluid,
        Packed::Forces,
        |scratch| &mut scratch.strains,
        |fluid, setup, out| {
            let velocity = &fluid.particles.velocity;
            within(setup, &Strains { velocity }, out)
        },
    );
}

/// Concentration of the fluid's particles into the scratch.
pub(crate) fn concentrations(fluid: &mut Fluid) {
    sum_into(
        fluid,
        Packed::Flow,
        |scratch| &mut scratch.concentrations,
        |_, setup, out| within(setup, &Concentrations, out),
    );
}

/// Forces of pressure and viscosity in the fluid, per volume, part by part; after [`Fluid::pack_forces`]. `each` is called with
/// those of a part and the number of chunks before it.
pub(crate) fn forces(
    fluid: &mut Fluid,
    mut each: impl FnMut(&mut Fluid, usize, &mut [ForceDensity]),
) {
    let mut all = std::mem::take(&mut fluid.scratch.forces);
    let points = std::mem::take(&mut fluid.scratch.points);
    by_parts(fluid, &mut all, |fluid, part, out| {
        let forces = FluidForces {
            own: ForceOwn {
                velocity: &fluid.particles.velocity,
                pressure: &fluid.particles.pressure,
            },
            shear: fluid.shearing(),
        };
        within(&part.of(fluid.to_everyone(&points)), &forces, out);
        each(fluid, part.n_chunks, out);
    });
    fluid.scratch.points = points;
    fluid.scratch.forces = all;
}

/// Viscous forces of velocities (m/s) within the fluid, per volume; packs them into `points`.
pub(crate) fn drag(
    fluid: &mut Fluid,
    velocity: &[Vec3],
    (points, out): (&mut AnyPoints, &mut [[f64; 3]]),
) {
    let p = &fluid.particles;
    points.pack(
        fluid.settings.scheme.precision,
        &fluid.frame,
        &p.position,
        |a| {
            let v = velocity[a];
            [v.x, v.y, v.z, 0.0, p.mass[a] / p.density[a]]
        },
    );
    fluid.list();
    fluid.skin.count_sum();
    drag_on(fluid, points, DragOwn::Each(velocity), out);
}

/// Viscous forces on velocities of 1 m/s along x past a fluid at rest, per volume; after [`Fluid::pack_forces`].
pub(crate) fn drag_of_unit(fluid: &mut Fluid, out: &mut [[f64; 3]]) {
    fluid.list();
    fluid.skin.count_sum();
    drag_on(fluid, &fluid.scratch.points, DragOwn::Unit, out);
}

fn drag_on(fluid: &Fluid, points: &AnyPoints, own: DragOwn, out: &mut [[f64; 3]]) {
    let shear = fluid.shearing();
    let drags = Drags::<true, true> { own, shear };
    within(&fluid.to_everyone(points), &drags, out);
}
