//! Water at rest that sleeps: nothing of it is computed until it is disturbed.
//!
//! In plan view the domain is divided into tiles, columns of whole cells over the full height. A tile is awake or asleep; the
//! water in a sleeping tile is held in position. At a fixed interval of steps each awake tile is examined:
//!
//! ```text
//! disturbed   |mean of the level part of x − x₀| > ε dp        its eight neighbors wake
//! at rest     root mean square of |v| ≤ v_r for a time t_r     x₀ = x; it sleeps once its neighbors sleep or are at rest
//! ```
//! `x₀` is the last rest position of a particle, level means perpendicular to gravity. Surface waves of any length move the
//! water below them horizontally. Sound does not wake: its particle speeds are far above those of relevant
//! waves, but it displaces the water by `v/ω` only, mostly vertically, as other sound does not travel far under a free surface;
//! neither does slight settlement on waking. The mean ignores single particles.
//!
//! Movable bodies keep the tiles near them awake. A moving particle stays awake in a sleeping tile, and wakes
//! it once it is half a spacing from its rest position. The residual motion removed by sleep is reported.
//!
//! # Sleeping water next to awake water
//!
//! Sleeping particles within the support of awake ones are held in position, and their density is advanced, so that the
//! water next to them can act on them as on a wall. Holding particles at rest does no work, so that energy is conserved
//! as without sleep, and the density is right when they wake. Their neighbor lists are made; those of all other sleeping
//! particles are empty, which is all that sums know of sleep. Chunks of particles that all sleep are skipped
//! otherwise.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::exact_sum::ExactSum;
use crate::fluid::energy::fixed_order_sum;
use crate::fluid::exchange::Exchange;
use crate::neighbors::cells::{CellGrid, ROW_SPLIT};
use crate::neighbors::rest::{Rest, Still};
use crate::scheme::{DensityDiffusion, DensityMethod, Stepping, ViscousStep};
use crate::terms::momentum::ForceDensity;
use crate::{CHUNK, Fluid, FluidError, Particles, Settings, Vec3};

/// Cells of a tile along x and y: three supports, so that a tile does not affect any beyond the next.
const TILE: [usize; 2] = [3 * ROW_SPLIT as usize, 3];
/// Steps between two examinations: sound crosses three quarters of a tile in them, waves a tenth of that.
const LOOK_INTERVAL: u32 = 10;
/// Displacement of a particle in a sleeping tile, over the spacing, at which it wakes the tile: larger than any jitter at the
/// edge of awake water.
const STRAYED: f64 = 0.5;
/// Distance over the support radius within which bodies that may move keep water awake: it then has a support of room
/// to move in.
const MARGIN: f64 = 2.0;
/// Mean level acceleration of a tile, over gravity, beyond which it is not at rest at the start but has to fall. Walls
/// that do not fit the initial lattice cause less, and such motion soon stops.
const IMBALANCE: f64 = 0.05;

/// Criteria of sleep of water.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sleeping {
    /// Mean displacement of the water in a tile, level, at which its neighbors wake; × spacing.
    pub displacement: f64,
    /// Root mean square of the speed in a tile up to which it is at rest; m/s.
    pub speed: f64,
    /// Time for which it has to be no faster before it sleeps; s.
    pub time: f64,
}

/// State of sleep.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Sleep {
    settings: Sleeping,
    /// Tiles along x and y.
    counts: [usize; 2],
    tiles: Vec<Tile>,
    /// Steps and time (s) since the last examination.
    since: (u32, f64),
    /// Last rest position of each particle; m.
    pub(crate) home: Vec<Vec3>,
    /// Of each particle, since the last sort or change.
    rests: Vec<Rest>,
    /// Particles awake, and their mass; kg.
    awake: (usize, f64),
    /// Number of changes of the sleeping set.
    n_changes: u64,
    #[serde(skip)]
    still: Vec<bool>,
    #[serde(skip)]
    pub(crate) kept: Kept,
}

#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Tile {
    is_awake: bool,
    /// Whether any particle in it is awake.
    has_awake: bool,
    /// Whether a body that may move is near its water.
    near_moving_body: bool,
    is_dry: bool,
    /// Time for which it has been no faster than water at rest; s.
    time_at_rest: f64,
    #[serde(skip)]
    seen: Seen,
    /// Times that particles in it were found awake, in this process.
    #[serde(skip)]
    n_stirred: u64,
}

/// Statistics of the awake particles in a tile.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    n: usize,
    /// Sum of the level ways from where they were at rest; m.
    way: Vec3,
    /// Square of the longest of these ways; m².
    longest2: f64,
    /// Sum of the squares of their speeds; m²/s².
    speed2: f64,
    is_at_rest: bool,
    is_disturbed: bool,
}

/// Results for sleeping chunks from the previous step, since the last sort or change.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Kept {
    pub flow: bool,
    pub pressure: bool,
    pub forces: bool,
}

impl<'a> Still<'a> {
    /// Chunks of a fluid that may sleep.
    pub(crate) fn of(sleep: Option<&'a Sleep>) -> Self {
        sleep.map_or(Self::NONE, |sleep| Self::new(&sleep.still))
    }

    /// Chunks of a fluid whose results were kept.
    pub(crate) fn kept(sleep: Option<&'a Sleep>, is_kept: impl Fn(&Kept) -> bool) -> Self {
        Self::of(sleep.filter(|sleep| is_kept(&sleep.kept)))
    }
}

impl Sleeping {
    fn check(&self) -> Result<(), FluidError> {
        let Self {
            displacement,
            speed,
            time,
        } = *self;
        for (name, value) in [
            ("displacement of sleeping", displacement),
            ("speed of sleeping", speed),
            ("time of sleeping", time),
        ] {
            if !(value.is_finite() && 0.0 < value) {
                return Err(FluidError::Setting {
                    name,
                    value,
                    range: "finite and > 0",
                });
            }
        }
        Ok(())
    }
}

impl Sleep {
    /// Everything awake, and at rest where it is.
    fn new(settings: Sleeping, fluid: &Fluid) -> Self {
        let [nx, ny, _] = fluid.grid.counts();
        let counts = [nx / TILE[0], ny / TILE[1]].map(|n| n.max(1));
        let awake = Tile {
            is_awake: true,
            ..Tile::default()
        };
        Self {
            settings,
            counts,
            tiles: vec![awake; counts[0] * counts[1]],
            since: (0, 0.0),
            home: fluid.particles.position.clone(),
            rests: Vec::new(),
            awake: (0, 0.0),
            n_changes: 0,
            still: Vec::new(),
            kept: Kept::default(),
        }
    }

    /// Whether it is of these particles and cells.
    pub(crate) fn is_of(&self, grid: &CellGrid, n: usize) -> bool {
        let [nx, ny, _] = grid.counts();
        self.counts == [nx / TILE[0], ny / TILE[1]].map(|n| n.max(1))
            && self.tiles.len() == self.counts[0] * self.counts[1]
            && self.home.len() == n
            && self.rests.len() == n
    }

    /// Finds chunks that sleep entirely; without results yet.
    pub(crate) fn find_still(&mut self) {
        self.still.clear();
        let chunks = self.rests.chunks(CHUNK);
        self.still
            .extend(chunks.map(|rests| rests.iter().all(|&rest| rest == Rest::Asleep)));
        self.kept = Kept::default();
    }

    /// Modifies the entries of sleeping particles in a column, except for chunks that sleep entirely.
    fn hold<T: Send>(&self, column: &mut [T], hold: impl Fn(&mut T) + Sync) {
        self.hold_part(0, column, hold);
    }

    /// The same for a part of a column, which begins after so many chunks.
    fn hold_part<T: Send>(&self, n_chunks: usize, part: &mut [T], hold: impl Fn(&mut T) + Sync) {
        let still = Still::of(Some(self));
        part.par_chunks_mut(CHUNK)
            .zip(self.rests[n_chunks * CHUNK..].par_chunks(CHUNK))
            .enumerate()
            .filter(|(chunk, _)| !still.has(n_chunks + chunk))
            .for_each(|(_, (entries, rests))| {
                for (entry, &rest) in entries.iter_mut().zip(rests) {
                    if rest != Rest::Awake {
                        hold(entry);
                    }
                }
            });
    }

    /// The tile of a cell, by its index along x or y.
    fn tile_along(&self, axis: usize, cell: usize) -> usize {
        (cell / TILE[axis]).min(self.counts[axis] - 1)
    }

    /// Cells of a tile along x and y: the last one has the remainder.
    fn cells_of(&self, tile: usize, grid: &CellGrid) -> [std::ops::Range<usize>; 2] {
        let at = [tile % self.counts[0], tile / self.counts[0]];
        std::array::from_fn(|axis| {
            let end = match at[axis] + 1 == self.counts[axis] {
                true => grid.counts()[axis],
                false => (at[axis] + 1) * TILE[axis],
            };
            at[axis] * TILE[axis]..end
        })
    }

    /// Runs of the particles in a tile, in order.
    fn runs<'a>(
        &self,
        tile: usize,
        grid: &'a CellGrid,
    ) -> impl Iterator<Item = std::ops::Range<usize>> + use<'a> {
        let [across, rows] = self.cells_of(tile, grid);
        (0..grid.counts()[2]).flat_map(move |k| {
            let across = across.clone();
            rows.clone().map(move |j| {
                let [first, last] = [across.start, across.end - 1].map(|i| grid.cell_at([i, j, k]));
                grid.particles_in(first).start..grid.particles_in(last).end
            })
        })
    }

    /// Whether a test holds for any of the eight tiles round one.
    fn any_beside(&self, tile: usize, periodic: [bool; 3], test: impl Fn(&Tile) -> bool) -> bool {
        let at = [tile % self.counts[0], tile / self.counts[0]];
        let step = |axis: usize, by: i64| {
            let (n, to) = (self.counts[axis] as i64, at[axis] as i64 + by);
            if periodic[axis] {
                Some(to.rem_euclid(n) as usize)
            } else {
                (0..n).contains(&to).then_some(to as usize)
            }
        };
        (-1..=1).any(|dy| {
            (-1..=1).any(|dx| {
                let other = step(0, dx).zip(step(1, dy));
                other
                    .map(|(i, j)| j * self.counts[0] + i)
                    .is_some_and(|other| other != tile && test(&self.tiles[other]))
            })
        })
    }

    /// Wakes the tiles whose water is within `margin` (m) of bodies, by their boxes (m); returns whether any slept.
    fn wake_near(
        &mut self,
        bodies: impl Iterator<Item = (Vec3, Vec3)>,
        (grid, margin): (&CellGrid, f64),
    ) -> bool {
        for tile in &mut self.tiles {
            tile.near_moving_body = false;
        }
        let mut has_woken = false;
        for (min, max) in bodies {
            let (mut min, mut max) = (min.add_scalar(-margin), max.add_scalar(margin));
            for axis in 0..3 {
                let (start, end) = (grid.min()[axis], grid.min()[axis] + grid.extent()[axis]);
                if grid.periodic()[axis] && (min[axis] < start || end < max[axis]) {
                    (min[axis], max[axis]) = (start, end);
                }
            }
            let (low, high) = (grid.coordinates_of(&min), grid.coordinates_of(&max));
            for j in self.tile_along(1, low[1])..=self.tile_along(1, high[1]) {
                for i in self.tile_along(0, low[0])..=self.tile_along(0, high[0]) {
                    let tile = j * self.counts[0] + i;
                    if self.tiles[tile].near_moving_body {
                        continue;
                    }
                    let [across, rows] = self.cells_of(tile, grid);
                    let is_near = (low[2]..=high[2]).any(|k| {
                        rows.clone().any(|j| {
                            let first = grid.cell_at([across.start, j, k]);
                            grid.has_particles(first..first + across.len())
                        })
                    });
                    if is_near {
                        let tile = &mut self.tiles[tile];
                        tile.near_moving_body = true;
                        has_woken |= !tile.is_awake;
                        tile.wake();
                    }
                }
            }
        }
        has_woken
    }
}

impl Tile {
    fn wake(&mut self) {
        if !self.is_awake {
            self.is_awake = true;
            self.time_at_rest = 0.0;
        }
    }
}

impl Settings {
    /// Rejects schemes that are incompatible with sleep.
    ///
    /// # Errors
    ///
    /// [`FluidError::Sleepless`].
    pub fn check_sleep(&self) -> Result<(), FluidError> {
        let scheme = &self.scheme;
        let refused = if scheme.density != DensityMethod::Continuity {
            "density by `Summation`, which is that of the places of all neighbors; use `Continuity`"
        } else if scheme.stepping != Stepping::KickDriftKick {
            "a stepping other than `KickDriftKick`; use that"
        } else if let DensityDiffusion::Antuono(_) = scheme.diffusion {
            "the diffusion `Antuono`, which wants gradients where nothing is computed; use `Fourtakas`"
        } else if scheme.viscous_step == ViscousStep::Implicit {
            "implicit viscous steps, in which all water takes part; use `Explicit` ones"
        } else if scheme.viscosity.varies() {
            "a viscosity that varies, as the rate of shear is not known where nothing is computed; use another, or none"
        } else {
            return Ok(());
        };
        Err(FluidError::Sleepless { refused })
    }
}

impl Fluid {
    /// Enables sleep of water at rest; `bodies` are bounding boxes (m) of movable bodies. All forces must be
    /// known: water out of balance stays awake. Returns the (negative) contribution.
    ///
    /// # Errors
    ///
    /// [`FluidError::Setting`] for a number out of range, [`FluidError::Sleepless`] for a scheme that cannot.
    pub fn let_sleep(
        &mut self,
        settings: Sleeping,
        bodies: impl Iterator<Item = (Vec3, Vec3)>,
    ) -> Result<Exchange, FluidError> {
        settings.check()?;
        self.settings.check_sleep()?;
        let mut sleep = Sleep::new(settings, self);
        sleep.wake_near(bodies, (&self.grid, self.margin()));
        let most = IMBALANCE * self.settings.gravity.norm();
        let mut lost = Exchange::default();
        for tile in 0..sleep.tiles.len() {
            let (mut n, mut speed2, mut pull) = (0, 0.0, Vec3::zeros());
            for a in sleep.runs(tile, &self.grid).flatten() {
                n += 1;
                speed2 += self.particles.velocity[a].norm_squared();
                pull += self.level(self.particles.acceleration[a]);
            }
            let n = f64::from(n);
            let is_at_rest =
                speed2 <= n * settings.speed * settings.speed && pull.norm() <= n * most;
            if is_at_rest && !sleep.tiles[tile].near_moving_body {
                sleep.tiles[tile].is_awake = false;
                lost += stop(&mut self.particles, sleep.runs(tile, &self.grid).flatten());
            }
        }
        self.sleep = Some(Box::new(sleep));
        self.find_rests();
        Ok(lost)
    }

    /// Whether water may sleep.
    pub fn may_sleep(&self) -> bool {
        self.sleep.is_some()
    }

    /// Wakes disturbed water and puts calm water to sleep, after a step of `dt` (s) and before its forces;
    /// `bodies` are bounding boxes (m) of movable bodies. Returns the (negative) contribution.
    pub fn watch_rest(&mut self, dt: f64, bodies: impl Iterator<Item = (Vec3, Vec3)>) -> Exchange {
        let Some(mut sleep) = self.sleep.take() else {
            return Exchange::default();
        };
        let mut has_changed = sleep.wake_near(bodies, (&self.grid, self.margin()));
        let (steps, elapsed) = (sleep.since.0 + 1, sleep.since.1 + dt);
        sleep.since = (steps, elapsed);
        let mut lost = Exchange::default();
        if LOOK_INTERVAL <= steps {
            sleep.since = (0, 0.0);
            self.look(&mut sleep, elapsed);
            let changed;
            (changed, lost) = self.change(&mut sleep);
            has_changed |= changed;
        }
        sleep.n_changes += u64::from(has_changed);
        self.sleep = Some(sleep);
        if has_changed {
            self.find_rests();
        }
        lost
    }

    /// Horizontal part of a vector: without the component across a 2-D flow; all of it without gravity.
    fn level(&self, vector: Vec3) -> Vec3 {
        let gravity = self.settings.gravity;
        let square = gravity.norm_squared();
        if square == 0.0 {
            return vector;
        }
        vector - gravity * (gravity.dot(&vector) / square)
    }

    fn margin(&self) -> f64 {
        MARGIN * self.settings.support_radius()
    }

    /// Examines all tiles with awake particles, `elapsed` (s) after the last time.
    fn look(&self, sleep: &mut Sleep, elapsed: f64) {
        let mut tiles = std::mem::take(&mut sleep.tiles);
        let all = &*sleep;
        let Sleeping {
            displacement,
            speed,
            time,
        } = sleep.settings;
        let farthest = displacement * self.settings.least_spacing();
        let (position, velocity) = (&self.particles.position, &self.particles.velocity);
        tiles.par_iter_mut().enumerate().for_each(|(number, tile)| {
            tile.seen = Seen::default();
            if !tile.has_awake {
                return;
            }
            let seen = &mut tile.seen;
            let particles = all.runs(number, &self.grid).flatten();
            for a in particles.filter(|&a| all.rests[a] == Rest::Awake) {
                let way = self.level(position[a] - all.home[a]);
                seen.n += 1;
                seen.way += way;
                seen.longest2 = seen.longest2.max(way.norm_squared());
                seen.speed2 += velocity[a].norm_squared();
            }
            if !tile.is_awake {
                return;
            }
            let n = seen.n as f64;
            tile.time_at_rest = match seen.speed2 <= n * speed * speed {
                true => tile.time_at_rest + elapsed,
                false => 0.0,
            };
            seen.is_at_rest = time <= tile.time_at_rest;
            seen.is_disturbed = !seen.is_at_rest && n * farthest < seen.way.norm();
        });
        sleep.tiles = tiles;
    }

    /// Wakes tiles and puts them to sleep by the results; returns whether anything changed, and the contribution.
    fn change(&mut self, sleep: &mut Sleep) -> (bool, Exchange) {
        let periodic = self.settings.periodic;
        let strayed = STRAYED * self.settings.least_spacing();
        let mut changes = std::mem::take(&mut self.scratch.changing);
        changes.clear();
        changes.extend(sleep.tiles.iter().enumerate().map(|(number, tile)| {
            let seen = &tile.seen;
            if tile.is_awake {
                let is_awake = |other: &Tile| other.is_awake && !other.seen.is_at_rest;
                seen.is_at_rest
                    && !tile.near_moving_body
                    && !sleep.any_beside(number, periodic, |other| !other.is_dry && is_awake(other))
            } else {
                let is_disturbed = |other: &Tile| other.seen.is_disturbed;
                strayed * strayed < seen.longest2
                    || (!tile.is_dry && sleep.any_beside(number, periodic, is_disturbed))
            }
        }));
        let mut lost = Exchange::default();
        let mut has_changed = false;
        for (number, &changes) in changes.iter().enumerate() {
            if sleep.tiles[number].seen.is_at_rest {
                for run in sleep.runs(number, &self.grid) {
                    sleep.home[run.clone()].copy_from_slice(&self.particles.position[run]);
                }
            }
            if !changes {
                continue;
            }
            has_changed = true;
            if sleep.tiles[number].is_awake {
                sleep.tiles[number].is_awake = false;
                lost += stop(
                    &mut self.particles,
                    sleep.runs(number, &self.grid).flatten(),
                );
            } else {
                sleep.tiles[number].wake();
            }
        }
        self.scratch.changing = changes;
        let (stopped, brought) = self.stop_strays(sleep);
        lost += brought;
        (has_changed | stopped, lost)
    }

    /// Stops particles that jitter in sleeping tiles among sleeping tiles.
    fn stop_strays(&mut self, sleep: &mut Sleep) -> (bool, Exchange) {
        let periodic = self.settings.periodic;
        let mut lost = Exchange::default();
        let mut has_stopped = false;
        for number in 0..sleep.tiles.len() {
            let tile = &sleep.tiles[number];
            let is_left = tile.has_awake
                && !tile.is_awake
                && !sleep.any_beside(number, periodic, |other| other.is_awake);
            if !is_left {
                continue;
            }
            for a in sleep.runs(number, &self.grid).flatten() {
                let speed = self.particles.velocity[a].norm();
                if 0.0 < speed && speed <= sleep.settings.speed {
                    lost += stop(&mut self.particles, std::iter::once(a));
                    sleep.home[a] = self.particles.position[a];
                    has_stopped = true;
                }
            }
        }
        (has_stopped, lost)
    }

    /// Finds the sleeping particles, from their tiles and their motion; after every sort and change.
    pub(crate) fn find_rests(&mut self) {
        let Some(mut sleep) = self.sleep.take() else {
            return;
        };
        let periodic = self.settings.periodic;
        sleep.rests.clear();
        sleep.rests.resize(self.particles.len(), Rest::Awake);
        let (velocity, still) = (&self.particles.velocity, Vec3::zeros());
        for number in 0..sleep.tiles.len() {
            let is_dry = sleep.runs(number, &self.grid).all(|run| run.is_empty());
            let has_awake = sleep.tiles[number].is_awake || {
                let mut particles = sleep.runs(number, &self.grid).flatten();
                particles.any(|a| velocity[a] != still)
            };
            let tile = &mut sleep.tiles[number];
            (tile.is_dry, tile.has_awake) = (is_dry, has_awake);
            tile.n_stirred += u64::from(has_awake);
        }
        for number in 0..sleep.tiles.len() {
            let tile = sleep.tiles[number];
            if tile.is_awake {
                continue;
            }
            let is_beside =
                tile.has_awake || sleep.any_beside(number, periodic, |other| other.has_awake);
            let rest = if is_beside {
                Rest::Beside
            } else {
                Rest::Asleep
            };
            for run in sleep.runs(number, &self.grid) {
                for a in run.filter(|&a| !tile.has_awake || velocity[a] == still) {
                    sleep.rests[a] = rest;
                    self.particles.acceleration[a] = still;
                    self.particles.viscous_acceleration[a] = [0.0; 3];
                    // nothing flows round it
                    if let (Rest::Asleep, Some(bulk)) =
                        (rest, self.particles.bulk_pressure.get_mut(a))
                    {
                        *bulk = 0.0;
                    }
                }
            }
        }
        let (rests, mass) = (&sleep.rests, &self.particles.mass);
        let is_awake = |a: usize| rests[a] == Rest::Awake;
        let n = fixed_order_sum(rests.len(), |a| usize::from(is_awake(a)));
        let mass = ExactSum::over(rests.len(), |a| if is_awake(a) { mass[a] } else { 0.0 }).value();
        sleep.awake = (n, mass);
        sleep.find_still();
        self.sleep = Some(sleep);
        self.lists.forget();
    }

    /// A number that stays the same for as long as nothing moves within the support of the vertical through a point in plan view (m);
    /// `None` while something may. It is one of this process: checkpoints do not have it.
    pub fn stillness(&self, x: f64, y: f64) -> Option<u64> {
        let sleep = self.sleep.as_ref()?;
        let grid = &self.grid;
        let reach = self.settings.support_radius() + self.widest_skin;
        let (low, high) = ([x - reach, y - reach], [x + reach, y + reach]);
        let is_cut = (0..2).any(|axis| {
            let start = grid.min()[axis];
            let end = start + grid.extent()[axis];
            grid.periodic()[axis] && (low[axis] < start || end < high[axis])
        });
        if is_cut {
            return None;
        }
        let [low, high] = [low, high].map(|[x, y]| grid.coordinates_of(&Vec3::new(x, y, 0.0)));
        let range = |axis| sleep.tile_along(axis, low[axis])..=sleep.tile_along(axis, high[axis]);
        let mut n_stirred = 0;
        for j in range(1) {
            for i in range(0) {
                let tile = &sleep.tiles[j * sleep.counts[0] + i];
                if tile.has_awake {
                    return None;
                }
                n_stirred += tile.n_stirred;
            }
        }
        Some(n_stirred)
    }

    /// Treatment of each particle; empty if all are awake.
    pub(crate) fn rests(&self) -> &[Rest] {
        self.sleep.as_ref().map_or(&[], |sleep| &sleep.rests)
    }

    /// Whether a particle is awake, by its index in the current order.
    pub fn is_awake(&self, particle: usize) -> bool {
        let rest = self.rests().get(particle);
        rest.is_none_or(|&rest| rest == Rest::Awake)
    }

    /// Particles that are awake.
    pub fn n_awake(&self) -> usize {
        let sleep = self.sleep.as_ref();
        sleep.map_or(self.particles.len(), |sleep| sleep.awake.0)
    }

    /// Mass of the particles that are awake; kg.
    pub fn awake_mass(&self) -> f64 {
        let sleep = self.sleep.as_ref();
        sleep.map_or_else(|| self.mass(), |sleep| sleep.awake.1)
    }

    /// Whether all particles in a range of the current order sleep, and none of them is beside an awake one. For
    /// whole chunks only; false for other ranges.
    pub fn is_still(&self, particles: std::ops::Range<usize>) -> bool {
        let still = Still::of(self.sleep.as_deref());
        !particles.is_empty()
            && (particles.start / CHUNK..=(particles.end - 1) / CHUNK).all(|chunk| still.has(chunk))
    }

    /// Number of changes of the sleeping set; `None` if sleep is off.
    pub(crate) fn changes_of_rest(&self) -> Option<u64> {
        self.sleep.as_ref().map(|sleep| sleep.n_changes)
    }

    /// Prevents sleeping particles from being treated as drops, which have hardly a neighbor.
    pub(crate) fn hold_rates(&mut self) {
        if let Some(sleep) = &self.sleep {
            sleep.hold(self.scratch.rates.n_found_mut(), |n| *n = u32::MAX);
        }
    }

    /// Removes the fluid forces on sleeping particles among a part of all, which begins after so many chunks.
    pub(crate) fn hold_forces(&self, n_chunks: usize, forces: &mut [ForceDensity]) {
        if let Some(sleep) = &self.sleep {
            sleep.hold_part(n_chunks, forces, |force| *force = ForceDensity::default());
        }
    }

    /// Holds sleeping particles in position.
    pub(crate) fn hold_accelerations(&mut self) {
        if let Some(sleep) = &self.sleep {
            sleep.hold(&mut self.particles.acceleration, |a| *a = Vec3::zeros());
        }
    }
}

/// Stops some particles; returns the contribution.
fn stop(of: &mut Particles, particles: impl Iterator<Item = usize>) -> Exchange {
    let mut sum = Exchange::default();
    for a in particles {
        let v = std::mem::replace(&mut of.velocity[a], Vec3::zeros());
        sum.momentum -= v * of.mass[a];
        sum.energy -= 0.5 * of.mass[a] * v.norm_squared();
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Dimensions, NegativePressure, Precision, Scheme, Start};

    /// A long box with random particles as dense as water, of which those at its near end move.
    fn stirred() -> Result<Fluid, FluidError> {
        let extent = Vec3::new(4.0, 0.8, 0.8);
        let settings = Settings {
            particle_spacing: [0.06; 3],
            smoothing_length: 0.1,
            reference_density: 1000.0,
            sound_speed: 30.0,
            scheme: Scheme {
                precision: Precision::Double,
                negative_pressure: NegativePressure::Kept,
                bulk_viscosity: 0.1,
                ..Scheme::artificial()
            },
            dimensions: Dimensions::Three,
            gravity: Vec3::new(0.0, 0.0, -9.81),
            time_step_factor: 0.5,
            domain: (Vec3::zeros(), extent),
            periodic: [false; 3],
            symmetry: [[false; 2]; 3],
        };
        let mut state = 88_172_645_463_325_252_u64;
        let mut random = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let n = (extent.product() / 0.06_f64.powi(3)) as usize;
        let positions: Vec<Vec3> = (0..n).map(|_| extent.map(|l| l * random())).collect();
        let start = Start {
            velocities: positions
                .iter()
                .map(|x| if x.x < 0.3 { Vec3::x() } else { Vec3::zeros() })
                .collect(),
            pressures: (0..n).map(|_| 1e4 * random()).collect(),
            positions,
        };
        let mut fluid = Fluid::new(start, settings)?;
        fluid.refresh();
        Ok(fluid)
    }

    const SLEEPING: Sleeping = Sleeping {
        displacement: 0.01,
        speed: 1e-3,
        time: 1.0,
    };

    fn evaluate(fluid: &mut Fluid) -> Result<(), FluidError> {
        fluid.update_rates();
        fluid.update_bulk_pressure();
        fluid.update_pressure()?;
        fluid.update_accelerations();
        Ok(())
    }

    #[test]
    fn what_is_awake_feels_what_sleeps_as_ever() -> Result<(), FluidError> {
        let (mut awake, mut fluid) = (stirred()?, stirred()?);
        fluid.let_sleep(SLEEPING, std::iter::empty())?;
        evaluate(&mut awake)?;
        evaluate(&mut fluid)?;
        let n = fluid.particles.len();
        assert!(0 < fluid.n_awake() && fluid.n_awake() < n / 2);
        let (mut n_held, mut n_left) = (0, 0);
        for a in 0..n {
            let (rate, expected) = (fluid.scratch.rates.of(a), awake.scratch.rates.of(a));
            let acceleration = fluid.particles.acceleration[a];
            if fluid.is_awake(a) {
                // the same neighbors in the same order
                assert_eq!(
                    (rate.flow, rate.diffusion),
                    (expected.flow, expected.diffusion)
                );
                assert_eq!(acceleration, awake.particles.acceleration[a]);
                continue;
            }
            assert_eq!(acceleration, Vec3::zeros());
            if rate.diffusion == 0.0 {
                n_left += 1;
                // nothing flows where nothing moves
                assert_eq!(expected.flow, 0.0);
            } else {
                n_held += 1;
                assert_eq!(
                    (rate.flow, rate.diffusion),
                    (expected.flow, expected.diffusion)
                );
            }
        }
        assert!(0 < n_held && n_held < n_left, "{n_held} {n_left}");
        assert_eq!(fluid.n_receivers() as usize, fluid.n_awake() + n_held);
        assert!(fluid.n_pairs() < awake.n_pairs() / 2);
        Ok(())
    }

    #[test]
    fn bodies_wake_the_water_that_they_come_near() -> Result<(), FluidError> {
        let mut fluid = stirred()?;
        fluid.let_sleep(SLEEPING, std::iter::empty())?;
        let before = fluid.n_awake();
        let body = |x: f64, z: f64| {
            let at = Vec3::new(x, 0.4, z);
            std::iter::once((at.add_scalar(-0.1), at.add_scalar(0.1)))
        };
        fluid.watch_rest(1e-4, body(3.5, 2.0));
        // above the domain it counts to its uppermost cells
        let above = fluid.n_awake();
        fluid.watch_rest(1e-4, body(3.5, 0.4));
        assert!(before <= above && above <= fluid.n_awake() && before < fluid.n_awake());
        Ok(())
    }

    #[test]
    fn motion_that_is_put_to_sleep_is_reported() -> Result<(), FluidError> {
        let mut fluid = stirred()?;
        let (energy, momentum) = (fluid.energies().kinetic, fluid.momentum());
        // fast water too, as it is said to be at rest; exact but for round-off
        let all = Sleeping {
            speed: 10.0,
            ..SLEEPING
        };
        let lost = fluid.let_sleep(all, std::iter::empty())?;
        assert_eq!((fluid.n_awake(), fluid.energies().kinetic), (0, 0.0));
        assert!((lost.energy + energy).abs() < 1e-12 * energy);
        assert!((lost.momentum + momentum).norm() < 1e-12 * momentum.norm());
        Ok(())
    }
}
