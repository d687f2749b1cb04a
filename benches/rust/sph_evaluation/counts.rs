//! How much there is to do in an evaluation: candidates and pairs, counted from outside, and from them the
//! arithmetic and the bytes that the code of the sums needs.
//!
//! An operation is one addition, subtraction, multiplication, multiply-add, comparison, minimum, maximum or
//! conversion of one number in the loops over candidates and pairs: each takes a slot of the vector units, as a
//! multiply-add does. Divisions and square roots have a unit of their own and are counted apart. Loads, shuffles
//! and the packing of those found are not arithmetic and count nowhere; neither do empty lanes.
//!
//! Bytes are those of arrays read or written once by each loop over particles. Records of neighbors are read
//! many times, but from the caches: they count once. Lists of neighbors are read once by each sum.

use std::ops::Add;

use rayon::prelude::*;
use riprap_sph::cells::{MAX_RUNS, Run};
use riprap_sph::{CellGrid, Precision, Vec3};

use crate::tank::Tank;

/// Particles that a thread takes at a time, as in the sums.
const CHUNK: usize = 256;

/// Candidates examined by the receivers of a sum.
#[derive(Clone, Copy, Default)]
pub struct Seen {
    /// Receivers with at least one candidate.
    pub receivers: f64,
    /// Candidates whose distance is tested.
    pub candidates: f64,
    /// Candidates within the support; a receiver that is among the points meets itself.
    pub pairs: f64,
}

impl Add for Seen {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            receivers: self.receivers + other.receivers,
            candidates: self.candidates + other.candidates,
            pairs: self.pairs + other.pairs,
        }
    }
}

/// Counts what receivers see of points that are sorted in a grid; `moved` as in the sums.
fn seen(
    (grid, points): (&CellGrid, &[Vec3]),
    receivers: &[Vec3],
    (support_radius, moved): (f64, f64),
) -> Seen {
    receivers
        .par_chunks(CHUNK)
        .map(|receivers| {
            let mut sum = Seen::default();
            let mut runs = [Run::default(); MAX_RUNS];
            for x in receivers {
                let n = grid.runs_within(x, support_radius + 2.0 * moved, &mut runs);
                for run in &runs[..n] {
                    let points = &points[run.start as usize..run.end as usize];
                    let is_near =
                        |y: &&Vec3| (x - *y).norm_squared() < support_radius * support_radius;
                    sum.candidates += points.len() as f64;
                    sum.pairs += points.iter().filter(is_near).count() as f64;
                }
                sum.receivers += f64::from(u32::from(0 < n));
            }
            sum
        })
        .reduce(Seen::default, Add::add)
}

/// Pair counts of a tank.
#[derive(Clone, Copy, Default)]
pub struct Counts {
    pub particles: f64,
    /// Points of the walls, and those of them near water.
    pub points: f64,
    pub wet: f64,
    /// Entries of the particles' lists of each other.
    pub entries: f64,
    /// Particles that look at points of the walls.
    pub from_walls: Seen,
    /// Points of the walls that look at particles.
    pub to_walls: Seen,
}

impl Counts {
    /// Counts in a tank; after the walls' last `find_wet`.
    pub fn of(tank: &Tank) -> Self {
        let (fluid, walls) = (&tank.fluid, &tank.walls);
        let particles = &fluid.particles().position;
        // whoever is listed was within the support and the skin at the last sort
        let listed = fluid.settings().support_radius() + fluid.skin();
        let entries = seen((fluid.grid(), particles), particles, (listed, 0.0));
        let reach = (fluid.settings().support_radius(), fluid.moved());
        let mut grid = fluid.grid().clone();
        let (mut cell, mut order) = (Vec::new(), Vec::new());
        grid.sort(walls.positions(), &mut cell, &mut order);
        let points: Vec<Vec3> = order
            .iter()
            .map(|&w| walls.positions()[w as usize])
            .collect();
        Self {
            particles: particles.len() as f64,
            points: points.len() as f64,
            wet: walls.wet().len() as f64,
            entries: entries.pairs,
            from_walls: seen((&grid, &points), particles, reach),
            to_walls: seen((fluid.grid(), particles), &points, reach),
        }
    }
}

/// Lower bound on the operations of a part of an evaluation.
#[derive(Clone, Copy, Default)]
pub struct Need {
    pub bytes: f64,
    pub operations: f64,
    pub divisions: f64,
    pub roots: f64,
}

impl Add for Need {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            bytes: self.bytes + other.bytes,
            operations: self.operations + other.operations,
            divisions: self.divisions + other.divisions,
            roots: self.roots + other.roots,
        }
    }
}

/// Arithmetic of a sum for each pair.
struct Term {
    operations: f64,
    divisions: f64,
}

/// Continuity with Fourtakas' diffusion: kernel and volume 7, approach 6, its sum 1, jump of density 1,
/// diffusion 7, its sum 1.
const RATE: Term = Term {
    operations: 23.0,
    divisions: 1.0,
};
/// Pressure and artificial viscosity: kernel and volume 7, pressure 2, its sum 3, jump of velocity 3,
/// viscosity 7, its sum 3.
const FORCE: Term = Term {
    operations: 25.0,
    divisions: 1.0,
};
/// Continuity without diffusion: kernel and volume 7, approach 6, sums 2.
const WALL_RATE: Term = Term {
    operations: 15.0,
    divisions: 0.0,
};
/// Kernel and volume 9, weight 1, pressure 1, density 1, moment 4, velocity 3.
const EXTRAPOLATION: Term = Term {
    operations: 19.0,
    divisions: 0.0,
};
/// Pressure of a face, walls along which the fluid slides: kernel and volume 7, pressure 6, its sum 4.
const WALL_FORCE: Term = Term {
    operations: 17.0,
    divisions: 1.0,
};
/// The filter, in integers and single precision always: differences 3, conversions 3, meters 3, square 3,
/// comparison 1, number of the candidate 1.
const FILTER: f64 = 14.0;

const NUMBER: f64 = 8.0;
const VECTOR: f64 = 24.0;
const INDEX: f64 = 4.0;
/// A rate as it is stored, with the number of neighbors.
const STORED_RATE: f64 = 40.0;
/// Particles whose forces are summed at a time.
const PART: f64 = 32_768.0;
/// Particles near walls, or points near water, that are summed at a time.
const WALL_PART: f64 = 16_384.0;
/// Number of a neighbor in a list, where it is not a way within a register.
const SLOT: f64 = 2.0;
/// Of sums per receiver: rate of density, force, extrapolation.
const RATE_SUMS: f64 = 24.0;
const FORCE_SUMS: f64 = 48.0;
const EXTRAPOLATED: f64 = 88.0;
/// What is kept of the latter.
const CONTINUED: f64 = 40.0;

/// Needs of the parts of an evaluation, from what there is to see.
pub struct Needs {
    pub precision: Precision,
    pub counts: Counts,
}

impl Needs {
    /// Record of a particle.
    fn packed(&self) -> f64 {
        match self.precision {
            Precision::Single => 32.0,
            Precision::Double => 64.0,
        }
    }

    /// Operations of the distance of a pair: differences of places, of integers in single precision, and their square.
    fn geometry(&self) -> f64 {
        match self.precision {
            Precision::Single => 12.0,
            Precision::Double => 6.0,
        }
    }

    /// A sum over all entries of the lists, each compared with the support.
    fn listed_sum(&self, term: &Term, bytes: f64) -> Need {
        let entries = self.counts.entries;
        Need {
            bytes: bytes + SLOT * entries,
            operations: (self.geometry() + 1.0 + term.operations) * entries,
            divisions: term.divisions * entries,
            roots: entries,
        }
    }

    /// A sum over what is found in the cells.
    fn sum(&self, seen: &Seen, term: &Term, bytes: f64) -> Need {
        let geometry = self.geometry();
        Need {
            bytes,
            operations: FILTER * seen.candidates + (geometry + term.operations) * seen.pairs,
            divisions: term.divisions * seen.pairs,
            roots: seen.pairs,
        }
    }

    /// Packs places, velocities, densities and masses; sums; writes rates.
    pub fn rates(&self) -> Need {
        let c = &self.counts;
        let packing = 2.0 * VECTOR + 2.0 * NUMBER + self.packed();
        let sums = self.packed() + 2.0 * VECTOR + NUMBER + RATE_SUMS;
        self.listed_sum(&RATE, c.particles * (packing + sums))
    }

    /// State equation, look for bad densities, packing.
    pub fn pressure(&self) -> Need {
        let state = 3.0 * NUMBER;
        let packing = 2.0 * VECTOR + 3.0 * NUMBER + self.packed();
        Need {
            bytes: self.counts.particles * (state + packing),
            ..Need::default()
        }
    }

    /// Sums; writes forces, reads them again, writes accelerations and, in single precision, their viscous part.
    pub fn forces(&self) -> Need {
        let c = &self.counts;
        let sums = self.packed() + 2.0 * VECTOR + NUMBER + FORCE_SUMS;
        let accelerations = FORCE_SUMS + NUMBER + 1.5 * VECTOR;
        self.listed_sum(&FORCE, c.particles * (sums + accelerations))
    }

    /// Packs all points; sums over those near water; adds to the rates.
    pub fn wall_rates(&self) -> Need {
        let c = &self.counts;
        let packing = INDEX + 2.0 * VECTOR + NUMBER + self.packed();
        let sums = 2.0 * VECTOR + NUMBER + 2.0 * (INDEX + RATE_SUMS) + 2.0 * RATE_SUMS;
        let bytes = c.points * packing + c.wet * self.packed() + c.from_walls.receivers * sums;
        self.sum(&c.from_walls, &WALL_RATE, bytes)
    }

    /// Sums for the points near water over the particles near them; clears and packs all points.
    pub fn extrapolation(&self) -> Need {
        let c = &self.counts;
        let packing = INDEX + 2.0 * VECTOR + 2.0 * NUMBER + self.packed();
        let clearing = NUMBER + 2.0 * VECTOR;
        let sums = 2.0 * VECTOR + 2.0 * (INDEX + EXTRAPOLATED) + NUMBER;
        let bytes =
            c.points * (packing + clearing) + c.wet * sums + c.from_walls.receivers * self.packed();
        self.sum(&c.to_walls, &EXTRAPOLATION, bytes)
    }

    /// Sums over points near water; adds to the accelerations and their viscous part.
    pub fn wall_forces(&self) -> Need {
        let c = &self.counts;
        let sums = 2.0 * VECTOR + NUMBER + 2.0 * (INDEX + FORCE_SUMS);
        let adding = 3.0 * VECTOR + 2.0 * NUMBER;
        let bytes = c.wet * self.packed() + c.from_walls.receivers * (sums + adding);
        self.sum(&c.from_walls, &WALL_FORCE, bytes)
    }

    /// Memory of the fluid's arrays: columns of the state, 113 bytes a particle; cell and order of the sort; packed points; sums
    /// of rates, and of the forces of a part of the particles; a number of each cell. Without its lists.
    pub fn fluid_memory(&self, n_cells: usize) -> f64 {
        let per_particle = 113.0 + 2.0 * INDEX + self.packed() + STORED_RATE;
        self.counts.particles * per_particle
            + self.counts.particles.min(PART) * (2.0 * VECTOR)
            + INDEX * n_cells as f64
    }

    /// That of walls at rest: columns of the points and their order, 44 bytes each; of those near water order, places, packed
    /// points and what remains of their sums; numbers of particles near walls; the sums of a part of either; a number of each cell.
    /// Without the lists of both.
    pub fn wall_memory(&self, n_cells: usize) -> f64 {
        let c = &self.counts;
        let of_particles = STORED_RATE + 2.0 * VECTOR;
        let of_points = EXTRAPOLATED + VECTOR;
        c.points * 44.0
            + c.wet * (INDEX + VECTOR + self.packed() + CONTINUED)
            + c.from_walls.receivers * INDEX
            + c.from_walls.receivers.min(WALL_PART) * of_particles
            + c.wet.min(WALL_PART) * of_points
            + INDEX * n_cells as f64
    }
}
