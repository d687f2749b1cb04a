//! Walls of particles: the generalised wall of Adami, Hu & Adams (2012), in volumes.
//!
//! Bodies carry points inside their surface, each with a volume. The pressure of a point is extrapolated from the
//! nearby fluid along the acceleration of gravity minus that of the wall, so that
//! water at rest has no force along the wall and exactly its weight on it:
//!
//! ```text
//! p_w  = ( Σ_f p_f W + (g − a_w)·Σ_f ρ_f (x_w − x_f) W ) / Σ_f W,   not below p_min
//! F_aw = −2 V_a V_w (ρ_w p_a + ρ_a p_w)/(ρ_a + ρ_w) ∇W_aw            −F on the wall at x_w   [N]
//! dρ_a/dt += ρ_a V_w (v_a − v_w)·∇W_aw                                              [kg/(m³ s)]
//! ```
//! The printed force has V_a² + V_w² for 2 V_a V_w; this one matches the pair force of the fluid. For
//! viscous forces a wall that does not slip moves as `2 v_w − Σ v_f W/Σ W`, and has the viscosity of the
//! particle that it acts on.
//!
//! Along a wall with friction the fluid sticks up to the Coulomb limit of the tangential
//! force; beyond it, the viscous force of a particle is scaled as a whole, and so is the part of every pair on the
//! wall:
//!
//! ```text
//! s_a = min(1, μ_w |F^p_a|/|F^t_a|),   F^p_a = Σ_w pressure,   F^t_a = Σ_w viscous, across F^p_a
//! ```
//! The normal is the direction of the wall's pressure on the particle; a particle under tension slides.
//!
//! Along a rough wall the shear of a particle is scaled to what the law of the wall says for its speed relative to the wall and its
//! distance, both from the sums over the wall points:
//!
//! ```text
//! n |g| = Σ_w V_w ∇W,   v_a − v_w = −Σ_w V_w (v_w − v_a) (∇W·n)/|g|,   distance from −Σ_w V_w x·∇W
//! ```
//!
//! At planes of symmetry points are mirrored like the fluid: no point may be beyond one.
//!
//! Points keep the order of their cells, and their neighbors are listed from where they were sorted, until one of them has moved
//! by what the particles have left of the skin, or the fluid is sorted after they moved.

mod listed;
mod slip;

use rayon::prelude::*;

use super::wall_law::PlaneDistances;
use crate::fluid::wall_sums::{self, Near, SortedPoints};
use crate::neighbors::cells::CellGrid;
use crate::neighbors::sweep::{AnyPoints, PairKind};
use crate::neighbors::thin_solids::Facet;
use crate::terms::concentration::Concentration;
use crate::terms::continuity::Rate;
use crate::terms::extrapolation::Extrapolated;
use crate::terms::gradient::StrainSums;
use crate::terms::momentum::ForceDensity;
use crate::terms::sums::{self, Places};
use crate::{CHUNK, Fluid, Vec3};
use listed::Listed;
pub use slip::Slip;

/// Response of the fluid force on a point to the point's acceleration `a`: an increment of `(L·a) slope`.
///
/// ```text
/// L_w = Σ_f ρ_f (x_w − x_f) W/Σ_f W,   slope = V_w Σ_f V_f ∇W
/// ```
/// To first order in the Mach number squared: densities of the pair count as equal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AddedMassResponse {
    /// `L_w`: the pressure falls by `L_w·a`; kg/m².
    pub lever: Vec3,
    /// Towards the fluid: the force falls by it for each Pa; m².
    pub slope: Vec3,
}

/// Points of a set of bodies, in the order of the bodies.
#[derive(Clone, Debug)]
pub struct WallParticles {
    volume: Vec<f64>,
    /// Faces of thin solids that points are behind; for all points, or empty.
    facets: Vec<Facet>,
    position: Vec<Vec3>,
    /// Empty as long as all were at rest.
    velocity: Vec<Vec3>,
    acceleration: Vec<Vec3>,
    /// Pressure continued from the fluid; Pa.
    pressure: Vec<f64>,
    /// Velocity used in viscous forces; empty where it is zero; m/s.
    seen_velocity: Vec<Vec3>,
    slip: Slip,
    /// Distances of particles from rough walls.
    distances: PlaneDistances,
    /// Viscosities of the fluid towards walls with friction.
    viscosities: AnyPoints,
    /// Cells with the points near fluid, in the order of [`WetPoints::all`], and the present places of these.
    grid: CellGrid,
    sorted: Vec<Vec3>,
    /// All points in the order of the cells that they were sorted into.
    order: Vec<u32>,
    /// Positions when they were sorted, in the order of the bodies; empty where they are the present ones; m.
    sorted_at: Vec<Vec3>,
    is_sorted: bool,
    /// Whether they were placed since their motion was found.
    is_placed: bool,
    /// Farthest that a point is from where it was sorted; m.
    moved: f64,
    sorted_facets: Vec<Facet>,
    points: AnyPoints,
    /// Cells that hold points, in order, each with one past its last point.
    occupied: Vec<(u32, u32)>,
    /// Of each occupied cell, whether water and whether awake water is near it; scratch.
    looks: Vec<(bool, bool)>,
    /// Cells whose fluid may be within the support of a point.
    near: Vec<u32>,
    /// Fluid particles near points, but those that sleep, and points near fluid.
    nearby_particles: Vec<u32>,
    wet: WetPoints,
    /// Sort of the fluid that `grid` and `sorted` are of.
    laid_out_for: Option<u64>,
    /// Number of changes of the sleeping set at the last update of the pressure of all wet points.
    known_at: Option<u64>,
    listed: Listed,
    scratch: Scratch,
}

/// Occupied cells that one thread looks at.
const CELLS_AT_ONCE: usize = 256;

/// Points near fluid; no sum reads the others.
#[derive(Clone, Debug, Default)]
struct WetPoints {
    /// In the order of their cells.
    all: Vec<u32>,
    /// Those near fluid that is awake, where fluid may sleep.
    wet_and_awake: Vec<u32>,
    /// Whether only these are updated: the others keep their values, as the sleeping set is unchanged.
    is_partial: bool,
}

impl WetPoints {
    /// Points that are updated from the fluid.
    fn updated(&self) -> &[u32] {
        if self.is_partial {
            &self.wet_and_awake
        } else {
            &self.all
        }
    }
}

/// What remains of the sums over the fluid near a point; see [`Extrapolated`].
#[derive(Clone, Copy, Debug, Default)]
struct Continued {
    weight: f64,
    /// Pa.
    pressure: f64,
    /// kg/m².
    moment: [f64; 3],
}

impl Continued {
    /// Pressure of a point on which gravity pulls like this (m/s²), Pa; `None` without fluid near it.
    fn pressure(&self, pull: Vec3) -> Option<f64> {
        let pressure = (self.pressure + pull.dot(&Vec3::from(self.moment))) / self.weight;
        // a wall does not pull
        (0.0 < self.weight).then(|| pressure.max(0.0))
    }
}

#[derive(Clone, Debug, Default)]
struct Scratch {
    rates: Vec<Rate>,
    forces: Vec<ForceDensity>,
    extrapolated: Vec<Extrapolated>,
    /// Of the points updated, where they may be accelerated.
    continued: Vec<Continued>,
    /// Slopes of the added mass of the points, where they were asked for; see [`Extrapolated::slope`].
    slopes: Vec<[f64; 3]>,
    concentrations: Vec<Concentration>,
    strains: Vec<StrainSums>,
    drags: Vec<[f64; 3]>,
    /// Share of its viscous force that each particle keeps; above 1 where a unit viscosity was summed.
    kept: Vec<f64>,
    /// The same for the particles near walls.
    shares: Vec<f64>,
}

impl WallParticles {
    /// Points with the given volumes, in m³, for a fluid; without position before [`Self::place`].
    pub fn new(fluid: &Fluid, volume: Vec<f64>, slip: Slip) -> Self {
        let n = volume.len();
        Self {
            volume,
            facets: Vec::new(),
            position: vec![Vec3::zeros(); n],
            velocity: Vec::new(),
            acceleration: Vec::new(),
            pressure: vec![0.0; n],
            seen_velocity: Vec::new(),
            slip,
            distances: PlaneDistances::new(
                fluid.settings.scheme.kernel,
                fluid.settings.support_radius(),
                fluid.settings.dimensions,
            ),
            viscosities: AnyPoints::default(),
            grid: fluid.grid().without_particles(),
            sorted: Vec::new(),
            order: Vec::new(),
            sorted_at: Vec::new(),
            is_sorted: false,
            is_placed: false,
            moved: 0.0,
            sorted_facets: Vec::new(),
            points: AnyPoints::default(),
            occupied: Vec::new(),
            looks: Vec::new(),
            near: Vec::new(),
            nearby_particles: Vec::new(),
            wet: WetPoints::default(),
            laid_out_for: None,
            known_at: None,
            listed: Listed::default(),
            scratch: Scratch::default(),
        }
    }

    /// The same points, visible only through faces of [thin solids](crate::neighbors::thin_solids): one facet per point, or none at all.
    #[must_use]
    pub fn behind(mut self, facets: Vec<Facet>) -> Self {
        self.facets = facets;
        self
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.volume.len()
    }

    /// Whether it is empty.
    pub fn is_empty(&self) -> bool {
        self.volume.is_empty()
    }

    /// Positions; m.
    pub fn positions(&self) -> &[Vec3] {
        &self.position
    }

    /// Volumes; m³.
    pub fn volumes(&self) -> &[f64] {
        &self.volume
    }

    /// Changes the volumes; m³.
    pub fn set_volumes(&mut self, of_point: impl Fn(usize) -> f64) {
        for (w, volume) in self.volume.iter_mut().enumerate() {
            *volume = of_point(w);
        }
    }

    /// Pressures extrapolated from the fluid, zero without fluid; Pa.
    pub fn pressures(&self) -> &[f64] {
        &self.pressure
    }

    /// Points that had fluid within their support at the last [`Self::find_wet`].
    pub fn wet(&self) -> &[u32] {
        &self.wet.all
    }

    /// Sets position, velocity and acceleration of every point; m, m/s, m/s².
    pub fn place(&mut self, of_point: impl Fn(usize) -> [Vec3; 3] + Sync) {
        if self.is_sorted && self.sorted_at.is_empty() {
            self.sorted_at.extend_from_slice(&self.position);
        }
        self.is_placed = true;
        if self.velocity.is_empty() {
            let is_moving = self
                .position
                .par_iter_mut()
                .enumerate()
                .with_min_len(CHUNK)
                .map(|(w, x)| {
                    let (v, a);
                    [*x, v, a] = of_point(w);
                    v != Vec3::zeros() || a != Vec3::zeros()
                })
                .reduce(|| false, |a, b| a | b);
            if !is_moving {
                return;
            }
            self.velocity.resize(self.position.len(), Vec3::zeros());
            self.acceleration.resize(self.position.len(), Vec3::zeros());
        }
        self.position
            .par_iter_mut()
            .zip(self.velocity.par_iter_mut())
            .zip(self.acceleration.par_iter_mut())
            .enumerate()
            .with_min_len(CHUNK)
            .for_each(|(w, ((x, v), a))| [*x, *v, *a] = of_point(w));
    }

    /// Positions when they were sorted, in the order of the bodies; empty where they are the present ones; m.
    pub fn sorted_at(&self) -> &[Vec3] {
        &self.sorted_at
    }

    /// Sorts the points where they were sorted before a run was stopped, of [`Self::sorted_at`]; placing comes next.
    pub fn sort_again(&mut self, sorted_at: &[Vec3]) {
        self.forget();
        self.is_sorted = false;
        self.sorted_at.clear();
        if sorted_at.len() == self.position.len() {
            self.position.copy_from_slice(sorted_at);
            self.sort();
        }
    }

    /// Brings the places in their order up to date; sorts if one of the points has moved too far since the last time, or the
    /// fluid was just sorted.
    fn sort_if_due(&mut self, fluid: &Fluid) {
        if std::mem::take(&mut self.is_placed) {
            self.moved = self.farthest_from_sort();
            self.pick_sorted();
        }
        let is_new_order = 0.0 < self.moved && fluid.moved() == 0.0;
        if !self.is_sorted || is_new_order || fluid.room_of_walls() < self.moved {
            self.sort();
        }
    }

    fn farthest_from_sort(&self) -> f64 {
        let pairs = self.position.par_iter().zip(self.sorted_at.par_iter());
        let squares = pairs.map(|(x, from)| (x - from).norm_squared());
        // a maximum is the same in any order
        let farthest = squares.with_min_len(4096).reduce(|| 0.0, f64::max);
        farthest.sqrt()
    }

    fn pick_sorted(&mut self) {
        self.sorted.clear();
        self.sorted
            .extend(self.wet.all.iter().map(|&w| self.position[w as usize]));
    }

    fn sort(&mut self) {
        let mut cells = Vec::new();
        self.grid.sort(&self.position, &mut cells, &mut self.order);
        self.sorted_at.clear();
        (self.is_sorted, self.moved) = (true, 0.0);
        self.laid_out_for = None;
        self.listed.forget();
        self.occupied.clear();
        for (&w, end) in self.order.iter().zip(1..) {
            let cell = cells[w as usize];
            match self.occupied.last_mut() {
                Some(last) if last.0 == cell => last.1 = end,
                _ => self.occupied.push((cell, end)),
            }
        }
        let mut is_near = vec![false; self.grid.n_cells()];
        self.near.clear();
        for &(cell, _) in &self.occupied {
            let near = &mut self.near;
            self.grid.rows_round(cell as usize, |row| {
                for cell in row {
                    if !is_near[cell] {
                        is_near[cell] = true;
                        near.push(cell as u32);
                    }
                }
            });
        }
        self.near.sort_unstable();
    }

    /// Finds the particles and points that may be within the support of each other; after every
    /// [`Self::place`] and every sort of the fluid.
    pub fn find_wet(&mut self, fluid: &Fluid) {
        self.sort_if_due(fluid);
        if !fluid.may_sleep() && self.listed.are_of(fluid) {
            return;
        }
        let cells = fluid.grid();
        self.nearby_particles.clear();
        for &cell in &self.near {
            let particles = cells.particles_in(cell as usize);
            if fluid.is_still(particles.clone()) {
                continue;
            }
            let awake = particles.filter(|&a| fluid.is_awake(a));
            self.nearby_particles.extend(awake.map(|a| a as u32));
        }
        let wet = &mut self.wet;
        // points near awake water may be dry now
        for &w in &wet.wet_and_awake {
            self.pressure[w as usize] = 0.0;
        }
        wet.all.clear();
        wet.wet_and_awake.clear();
        wet.is_partial = fluid.may_sleep() && self.known_at == fluid.changes_of_rest();
        let look = |&(cell, _): &(u32, u32)| {
            let (mut is_wet, mut is_awake) = (false, false);
            cells.rows_round(cell as usize, |row| {
                let particles = cells.particles_in_row(row);
                is_wet |= !particles.is_empty();
                is_awake |= !particles.is_empty() && !fluid.is_still(particles);
            });
            (is_wet, is_awake)
        };
        let cells_at_once = self.occupied.par_iter().with_min_len(CELLS_AT_ONCE);
        cells_at_once.map(look).collect_into_vec(&mut self.looks);
        let mut n_in_cells = Vec::new();
        let mut start = 0;
        for (&(cell, end), &(is_wet, is_awake)) in self.occupied.iter().zip(&self.looks) {
            let points = start..end as usize;
            start = points.end;
            if is_wet {
                n_in_cells.push((cell, points.len() as u32));
                wet.all.extend_from_slice(&self.order[points.clone()]);
                if is_awake && fluid.may_sleep() {
                    wet.wet_and_awake.extend_from_slice(&self.order[points]);
                }
            }
        }
        // what is wet follows from the cells
        if self.laid_out_for == Some(fluid.sorts()) || self.order.is_empty() {
            return;
        }
        self.laid_out_for = Some(fluid.sorts());
        self.grid.count(n_in_cells.into_iter());
        self.pick_sorted();
        self.sorted_facets.clear();
        if !self.facets.is_empty() {
            let wet = self.wet.all.iter();
            self.sorted_facets
                .extend(wet.map(|&w| self.facets[w as usize]));
        }
    }

    /// Makes the next update include all wet points, with neighbors listed anew.
    pub fn forget(&mut self) {
        self.known_at = None;
        self.listed.forget();
    }

    /// Lists the points near particles, unless those of the particles at hand are listed.
    fn list_points(&mut self, fluid: &Fluid) {
        if fluid.room_of_walls() < self.moved {
            return;
        }
        let then: Vec<Vec3>;
        let walls = SortedPoints {
            grid: &self.grid,
            positions: match self.sorted_at.is_empty() {
                true => &self.sorted,
                false => {
                    let wet = self.wet.all.iter();
                    then = wet.map(|&w| self.sorted_at[w as usize]).collect();
                    &then
                }
            },
        };
        self.listed
            .update_particles(fluid, &walls, &self.nearby_particles);
    }

    /// Lists the particles near points, unless those of the points at hand are listed.
    fn list_particles(&mut self, fluid: &Fluid) {
        if fluid.room_of_walls() < self.moved {
            return;
        }
        let positions = match self.sorted_at.is_empty() {
            true => &self.position,
            false => &self.sorted_at,
        };
        self.listed
            .update_points(fluid, positions, self.wet.updated());
    }

    /// Particles near points.
    fn near_points(&self, fluid: &Fluid) -> Near<'_> {
        let listed = self.valid(fluid);
        let lists = listed.and_then(|listed| listed.of_particles(fluid));
        Near::new(&self.nearby_particles, lists)
    }

    /// Points near particles that are updated.
    fn near_particles(&self, fluid: &Fluid) -> Near<'_> {
        let listed = self.valid(fluid);
        let lists = listed.and_then(|listed| listed.of_points(fluid));
        Near::new(self.wet.updated(), lists)
    }

    fn valid(&self, fluid: &Fluid) -> Option<&Listed> {
        (self.moved <= fluid.room_of_walls()).then_some(&self.listed)
    }

    fn neighborhood<'a>(&'a self, fluid: &'a Fluid) -> sums::Neighborhood<'a> {
        sums::Neighborhood {
            grid: &self.grid,
            frame: &fluid.frame,
            points: &self.points,
            moved: self.moved,
            occlusion: sums::occlusion(
                &fluid.thin_solids,
                &self.sorted,
                PairKind::ParticlesAndWalls(&self.sorted_facets),
            ),
        }
    }

    fn places(&self) -> Places<'_> {
        Places {
            positions: &self.position,
            facets: &self.facets,
        }
    }

    /// Packs velocities and volumes for the sums.
    fn pack_flow(&mut self, fluid: &Fluid) {
        let (order, velocity, volume) = (&self.wet.all, &self.velocity, &self.volume);
        self.points.pack(
            fluid.settings.scheme.precision,
            &fluid.frame,
            &self.sorted,
            |k| {
                let w = order[k] as usize;
                let v = known(velocity, w);
                [v.x, v.y, v.z, 0.0, volume[w]]
            },
        );
    }

    /// Adds the walls' part of the rates of density.
    pub fn add_rates(&mut self, fluid: &mut Fluid) {
        if self.nearby_particles.is_empty() {
            return;
        }
        self.list_points(fluid);
        self.pack_flow(fluid);
        let mut rates = std::mem::take(&mut self.scratch.rates);
        let mut of_particles = std::mem::take(&mut fluid.scratch.rates);
        for near in self.near_points(fluid).parts() {
            rates.resize(near.len(), Rate::default());
            wall_sums::rates(fluid, self.neighborhood(fluid), near, &mut rates);
            for (&a, rate) in near.chosen().iter().zip(&rates) {
                of_particles.add_walls(a as usize, rate);
            }
        }
        fluid.scratch.rates = of_particles;
        self.scratch.rates = rates;
    }

    /// Adds the walls' part of the particle concentration.
    pub fn add_concentrations(&mut self, fluid: &mut Fluid) {
        if self.nearby_particles.is_empty() {
            return;
        }
        self.list_points(fluid);
        self.pack_flow(fluid);
        let mut concentrations = std::mem::take(&mut self.scratch.concentrations);
        concentrations.resize(self.nearby_particles.len(), Concentration::default());
        wall_sums::concentrations(
            fluid,
            self.neighborhood(fluid),
            self.near_points(fluid),
            &mut concentrations,
        );
        for (&a, concentration) in self.nearby_particles.iter().zip(&concentrations) {
            fluid.scratch.concentrations[a as usize] += *concentration;
        }
        self.scratch.concentrations = concentrations;
    }

    /// Continues pressure and velocity of the fluid to the points, which move with the accelerations they were
    /// placed with.
    pub fn extrapolate(&mut self, fluid: &Fluid) {
        self.continue_fluid::<false>(fluid);
    }

    /// Extrapolates, with the responses for [`Self::visit_added_mass`].
    pub fn extrapolate_with_added_mass(&mut self, fluid: &Fluid) {
        self.continue_fluid::<true>(fluid);
    }

    fn continue_fluid<const SLOPED: bool>(&mut self, fluid: &Fluid) {
        self.list_particles(fluid);
        let mut extrapolated = std::mem::take(&mut self.scratch.extrapolated);
        let mut continued = std::mem::take(&mut self.scratch.continued);
        let mut slopes = std::mem::take(&mut self.scratch.slopes);
        let mut seen_velocity = std::mem::take(&mut self.seen_velocity);
        let mut pressure = std::mem::take(&mut self.pressure);
        continued.clear();
        slopes.clear();
        seen_velocity.clear();
        seen_velocity.extend_from_slice(&self.velocity);
        if self.slip.sticks() {
            seen_velocity.resize(self.position.len(), Vec3::zeros());
        }
        if !self.wet.is_partial {
            pressure.fill(0.0);
        }
        for near in self.near_particles(fluid).parts() {
            extrapolated.resize(near.len(), Extrapolated::default());
            wall_sums::extrapolation::<SLOPED>(fluid, self.places(), near, &mut extrapolated);
            for (&w, sum) in near.chosen().iter().zip(&extrapolated) {
                let w = w as usize;
                if self.slip.sticks() && 0.0 < sum.weight {
                    let beside = Vec3::from(sum.velocity) / sum.weight;
                    seen_velocity[w] = known(&self.velocity, w) * 2.0 - beside;
                }
                let sums = Continued {
                    weight: sum.weight,
                    pressure: sum.pressure,
                    moment: sum.moment,
                };
                if let Some(p) = sums.pressure(self.pull(fluid, w)) {
                    pressure[w] = p;
                }
                if SLOPED {
                    continued.push(sums);
                    slopes.push(sum.slope);
                }
            }
        }
        self.known_at = fluid.changes_of_rest();
        self.pressure = pressure;
        self.seen_velocity = seen_velocity;
        self.scratch.extrapolated = extrapolated;
        self.scratch.continued = continued;
        self.scratch.slopes = slopes;
        self.pack_forces(fluid);
    }

    /// Adds to the acceleration (m/s²) of wet points and continues the pressure again; after
    /// [`Self::extrapolate_with_added_mass`].
    pub fn accelerate(&mut self, fluid: &Fluid, more: impl Fn(usize) -> Vec3) {
        self.velocity.resize(self.position.len(), Vec3::zeros());
        self.acceleration.resize(self.position.len(), Vec3::zeros());
        for &w in self.wet.updated() {
            self.acceleration[w as usize] += more(w as usize);
        }
        for (&w, sums) in self.wet.updated().iter().zip(&self.scratch.continued) {
            let w = w as usize;
            if let Some(pressure) = sums.pressure(self.pull(fluid, w)) {
                self.pressure[w] = pressure;
            }
        }
        self.pack_forces(fluid);
    }

    /// Gravity as a point with its acceleration feels it; m/s².
    fn pull(&self, fluid: &Fluid, w: usize) -> Vec3 {
        fluid.settings.gravity - known(&self.acceleration, w)
    }

    /// Packs velocities seen, pressures and volumes for the sums.
    fn pack_forces(&mut self, fluid: &Fluid) {
        let (order, volume) = (&self.wet.all, &self.volume);
        let (seen_velocity, pressure) = (&self.seen_velocity, &self.pressure);
        self.points.pack(
            fluid.settings.scheme.precision,
            &fluid.frame,
            &self.sorted,
            |k| {
                let w = order[k] as usize;
                let v = known(seen_velocity, w);
                // a point without fluid in its support has no pressure and is inactive
                [v.x, v.y, v.z, pressure[w], volume[w]]
            },
        );
    }

    /// Calls `visit` with those of the points under pressure that are chosen, and how the force on each answers
    /// to its acceleration; after [`Self::extrapolate_with_added_mass`].
    pub fn visit_added_mass(
        &self,
        is_chosen: impl Fn(usize) -> bool,
        mut visit: impl FnMut(usize, AddedMassResponse),
    ) {
        let of_points = self.scratch.continued.iter().zip(&self.scratch.slopes);
        for (&w, (sum, &slope)) in self.wet.updated().iter().zip(of_points) {
            let w = w as usize;
            if 0.0 < self.pressure[w] && is_chosen(w) {
                let lever = Vec3::from(sum.moment) / sum.weight;
                let slope = Vec3::from(slope) * self.volume[w];
                visit(w, AddedMassResponse { lever, slope });
            }
        }
    }

    /// Adds the walls to the sums of the velocity gradient, after [`Self::extrapolate`]. Walls along which the fluid slides
    /// do not contribute to shear.
    pub fn add_strains(&mut self, fluid: &mut Fluid) {
        if self.nearby_particles.is_empty() || !self.slip.sticks() {
            return;
        }
        self.list_points(fluid);
        let mut strains = std::mem::take(&mut self.scratch.strains);
        strains.resize(self.nearby_particles.len(), StrainSums::default());
        wall_sums::strains(
            fluid,
            self.neighborhood(fluid),
            self.near_points(fluid),
            &mut strains,
        );
        for (&a, strain) in self.nearby_particles.iter().zip(&strains) {
            fluid.scratch.strains[a as usize] += *strain;
        }
        self.scratch.strains = strains;
    }

    /// Adds the forces of the walls to the accelerations; after [`Self::extrapolate`]. Returns their sum; the
    /// power of viscosity is booked with the kick as that of the fluid; N.
    pub fn add_forces(&mut self, fluid: &mut Fluid) -> Vec3 {
        if self.nearby_particles.is_empty() {
            return Vec3::zeros();
        }
        self.list_points(fluid);
        self.begin_shear(fluid);
        let mut forces = std::mem::take(&mut self.scratch.forces);
        let mut total = Vec3::zeros();
        if self.slip.is_scaled() {
            let near = self.near_points(fluid);
            self.sum_forces(fluid, near, &mut forces);
            self.scale_shear(fluid, &mut forces);
            add_all(fluid, (&self.nearby_particles, &forces), &mut total);
        } else {
            for near in self.near_points(fluid).parts() {
                self.sum_forces(fluid, near, &mut forces);
                add_all(fluid, (near.chosen(), &forces), &mut total);
            }
        }
        self.scratch.forces = forces;
        total
    }

    /// Forces of the walls on some particles, per volume.
    fn sum_forces(&self, fluid: &Fluid, near: Near, forces: &mut Vec<ForceDensity>) {
        forces.resize(near.len(), ForceDensity::default());
        let (walls, shear) = (self.neighborhood(fluid), self.shearing(fluid));
        wall_sums::forces(fluid, walls, near, shear, forces);
    }

    /// Forces of the fluid on some of the points, in their order, as in [`Self::visit_reactions`];
    /// for gauges, which sample rarely; N.
    pub fn reactions(&self, fluid: &Fluid, points: &[u32]) -> Vec<[Vec3; 2]> {
        let unlisted = Near::new(points, None);
        let (mut forces, mut drags) = (Vec::new(), Vec::new());
        self.sum_reactions(fluid, unlisted, (&mut forces, &mut drags));
        points
            .iter()
            .zip(forces.iter().zip(&drags))
            .map(|(&w, (force, drag))| {
                let [pressure, viscous] = force.times(self.volume[w as usize]);
                [pressure, viscous + self.drag_of(w as usize, drag)]
            })
            .collect()
    }

    /// Calls `visit` with every wet point, its position (m) and the forces of the fluid's pressure and viscosity on it (N), in
    /// order; those of an implicit viscous step included once it is solved.
    pub fn visit_reactions(
        &mut self,
        fluid: &Fluid,
        mut visit: impl FnMut(usize, &Vec3, [Vec3; 2]),
    ) {
        let mut forces = std::mem::take(&mut self.scratch.forces);
        let mut drags = std::mem::take(&mut self.scratch.drags);
        for near in self.near_particles(fluid).parts() {
            self.sum_reactions(fluid, near, (&mut forces, &mut drags));
            let of_points = forces.iter().zip(&drags);
            for (&w, (force, drag)) in near.chosen().iter().zip(of_points) {
                let w = w as usize;
                let [pressure, viscous] = force.times(self.volume[w]);
                let viscous = viscous + self.drag_of(w, drag);
                visit(w, &self.position[w], [pressure, viscous]);
            }
        }
        self.scratch.forces = forces;
        self.scratch.drags = drags;
    }

    /// Forces of the fluid on some points, and those of an implicit viscous step; per volume.
    fn sum_reactions(
        &self,
        fluid: &Fluid,
        near: Near,
        (forces, drags): (&mut Vec<ForceDensity>, &mut Vec<[f64; 3]>),
    ) {
        forces.resize(near.len(), ForceDensity::default());
        let seen = (self.seen_velocity.as_slice(), self.pressure.as_slice());
        let shear = self.shearing(fluid);
        wall_sums::reactions(fluid, self.places(), seen, near, shear, forces);
        drags.clear();
        drags.resize(near.len(), [0.0; 3]);
        self.sum_drags(fluid, near, drags);
    }
}

/// Adds forces of walls, per volume, to the accelerations of some particles, and those in newtons to their sum.
fn add_all(fluid: &mut Fluid, (chosen, forces): (&[u32], &[ForceDensity]), total: &mut Vec3) {
    let particles = &mut fluid.particles;
    for (&number, force) in chosen.iter().zip(forces) {
        let a = number as usize;
        let (by_pressure, by_viscosity) = (Vec3::from(force.pressure), Vec3::from(force.viscous));
        let both = by_pressure + by_viscosity;
        particles.acceleration[a] += both / particles.density[a];
        (fluid.scratch.pushes).push((number, by_pressure / particles.density[a]));
        for (sum, f) in particles.viscous_acceleration[a]
            .iter_mut()
            .zip(&by_viscosity)
        {
            *sum += (f / particles.density[a]) as f32;
        }
        *total += both * (particles.mass[a] / particles.density[a]);
    }
}

/// Entry of a column that is empty where all are zero.
#[inline(always)]
fn known(column: &[Vec3], w: usize) -> Vec3 {
    column.get(w).copied().unwrap_or_default()
}
