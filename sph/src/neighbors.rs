//! Neighbour lists, built once per evaluation and used by every sum of it.
//!
//! Finding a neighbour costs more than using it: only 16 % of the candidates of 27 cells are within
//! the support. So the search is a pass of its own, without branches on the distance, and density
//! and force sums walk its result. Lists are packed per chunk of particles; chunks keep their
//! memory from step to step.

use rayon::prelude::*;

use crate::cells::{CellGrid, MAX_RUNS, OWN_IMAGE, Run};
use crate::{CHUNK, Vec3};

/// Bits of a list entry that number the particle; the rest name the periodic image.
const ID_BITS: u32 = 27;
/// Mask of the particle number.
const ID_MASK: u32 = (1 << ID_BITS) - 1;
/// Most particles that list entries can number.
pub const MAX_PARTICLES: usize = 1 << ID_BITS;
/// Candidates tested together: a width that compilers turn into vector instructions.
const LANES: usize = 8;

/// A neighbour as packed in a list: particle and periodic image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Neighbor(u32);

impl Neighbor {
    /// Index of the particle in sorted order.
    #[inline(always)]
    pub fn index(self) -> usize {
        (self.0 & ID_MASK) as usize
    }

    /// Image through which it is seen.
    #[inline(always)]
    pub fn image(self) -> usize {
        (self.0 >> ID_BITS) as usize
    }
}

/// The neighbours of every particle, itself included, in a fixed order.
#[derive(Clone, Debug, Default)]
pub struct NeighborLists {
    chunks: Vec<Chunk>,
    n_entries: u64,
    /// Shift of each image; m.
    shifts: Vec<Vec3>,
    /// Coordinates of the sorted particles, one array per axis for the vector distance test.
    coordinates: [Vec<f64>; 3],
}

/// Lists of a chunk of particles.
#[derive(Clone, Debug, Default)]
struct Chunk {
    entries: Vec<Neighbor>,
    /// End of each particle's list in `entries`.
    ends: Vec<u32>,
}

impl NeighborLists {
    /// Finds all pairs closer than `support_radius`, for particles sorted by cell.
    pub fn build(&mut self, grid: &CellGrid, positions: &[Vec3], support_radius: f64) {
        if self.shifts.is_empty() {
            self.shifts = (0..27).map(|image| grid.image_shift(image)).collect();
        }
        for (axis, coordinate) in self.coordinates.iter_mut().enumerate() {
            coordinate.clear();
            coordinate.extend(positions.iter().map(|x| x[axis]));
        }
        self.chunks
            .resize_with(positions.len().div_ceil(CHUNK), Chunk::default);
        let (shifts, coordinates) = (&self.shifts, &self.coordinates);
        let r2_max = support_radius * support_radius;
        self.chunks
            .par_iter_mut()
            .zip(positions.par_chunks(CHUNK))
            .for_each(|(chunk, positions)| {
                chunk.fill(grid, positions, coordinates, shifts, r2_max);
            });
        self.n_entries = self.chunks.iter().map(|c| c.n_entries() as u64).sum();
    }

    /// Ordered pairs found by the last build, no particle paired with itself in place.
    pub fn n_pairs(&self) -> u64 {
        let n_particles: usize = self.chunks.iter().map(|c| c.ends.len()).sum();
        self.n_entries - n_particles as u64
    }

    /// Shift of each image, to be added to a neighbour's position; m.
    pub(crate) fn shifts(&self) -> &[Vec3] {
        &self.shifts
    }

    /// The lists of a chunk of particles, one per particle.
    pub(crate) fn lists_of_chunk(&self, chunk: usize) -> impl Iterator<Item = &[Neighbor]> {
        let chunk = &self.chunks[chunk];
        let mut start = 0;
        chunk.ends.iter().map(move |&end| {
            let list = &chunk.entries[start..end as usize];
            start = end as usize;
            list
        })
    }
}

impl Chunk {
    fn n_entries(&self) -> usize {
        self.ends.last().map_or(0, |&end| end as usize)
    }

    fn fill(
        &mut self,
        grid: &CellGrid,
        positions: &[Vec3],
        coordinates: &[Vec<f64>; 3],
        shifts: &[Vec3],
        r2_max: f64,
    ) {
        self.ends.clear();
        let mut runs = [Run::default(); MAX_RUNS];
        let radius = r2_max.sqrt();
        let mut n = 0;
        for position in positions {
            let n_runs = grid.runs_within(position, radius, &mut runs);
            let n_candidates: usize = runs[..n_runs]
                .iter()
                .map(|r| (r.end - r.start) as usize)
                .sum();
            // room for the case that all candidates are neighbours, so that the test below can
            // write first and decide afterwards
            let room = n + n_candidates + LANES;
            if self.entries.len() < room {
                self.entries.resize(room.next_power_of_two(), Neighbor(0));
            }
            for run in &runs[..n_runs] {
                n = append_within(
                    &mut self.entries,
                    n,
                    run,
                    position,
                    coordinates,
                    shifts,
                    r2_max,
                );
            }
            self.ends.push(n as u32);
        }
    }
}

/// Appends the particles of a run that are within the support; returns the new end.
#[inline]
fn append_within(
    entries: &mut [Neighbor],
    mut n: usize,
    run: &Run,
    position: &Vec3,
    coordinates: &[Vec<f64>; 3],
    shifts: &[Vec3],
    r2_max: f64,
) -> usize {
    let seen_from = if run.image == OWN_IMAGE {
        *position
    } else {
        position - shifts[run.image as usize]
    };
    let range = run.start as usize..run.end as usize;
    let [x, y, z] = [0, 1, 2].map(|axis| &coordinates[axis][range.clone()]);
    let image_bits = u32::from(run.image) << ID_BITS;
    let distance2 = |i: usize| {
        let (dx, dy, dz) = (seen_from.x - x[i], seen_from.y - y[i], seen_from.z - z[i]);
        dx * dx + dy * dy + dz * dz
    };
    let whole = x.len() / LANES * LANES;
    let mut r2 = [0.0; LANES];
    for block in (0..whole).step_by(LANES) {
        let (x, y, z) = (
            &x[block..block + LANES],
            &y[block..block + LANES],
            &z[block..block + LANES],
        );
        for lane in 0..LANES {
            let (dx, dy, dz) = (
                seen_from.x - x[lane],
                seen_from.y - y[lane],
                seen_from.z - z[lane],
            );
            r2[lane] = dx * dx + dy * dy + dz * dz;
        }
        let first = run.start + block as u32;
        for (lane, &r2) in r2.iter().enumerate() {
            entries[n] = Neighbor((first + lane as u32) | image_bits);
            n += usize::from(r2 < r2_max);
        }
    }
    for i in whole..x.len() {
        entries[n] = Neighbor((run.start + i as u32) | image_bits);
        n += usize::from(distance2(i) < r2_max);
    }
    n
}

#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    reason = "a test may stop where a library may not"
)]
mod tests {
    use super::*;

    /// All pairs by brute force: (particle, neighbour, image), sorted.
    fn twin(grid: &CellGrid, positions: &[Vec3], support: f64) -> Vec<(usize, usize, u8)> {
        let images: Vec<u8> = (0..27)
            .filter(|&image| {
                let shift = grid.image_shift(image);
                (0..3).all(|axis| shift[axis] == 0.0 || grid.periodic()[axis])
            })
            .collect();
        let mut pairs = Vec::new();
        for (a, xa) in positions.iter().enumerate() {
            for (b, xb) in positions.iter().enumerate() {
                for &image in &images {
                    if (xa - xb - grid.image_shift(image)).norm_squared() < support * support {
                        pairs.push((a, b, image));
                    }
                }
            }
        }
        pairs
    }

    fn scatter(n: usize, extent: Vec3) -> Vec<Vec3> {
        // Weyl sequence: even, reproducible, no lattice ties
        (0..n)
            .map(|i| {
                let t = (i + 1) as f64;
                Vec3::new(
                    (t * 0.754_877_666).fract() * extent.x,
                    (t * 0.569_840_291).fract() * extent.y,
                    (t * 0.438_579_021).fract() * extent.z,
                )
            })
            .collect()
    }

    #[test]
    fn lists_equal_brute_force_for_every_periodicity() {
        let extent = Vec3::new(1.0, 0.31, 0.8);
        for periodic in [
            [false; 3],
            [true, false, false],
            [false, true, false],
            [true, true, true],
        ] {
            for support in [0.11, 0.3] {
                let mut grid =
                    CellGrid::new((Vec3::zeros(), extent), periodic, support, 1 << 20).unwrap();
                let positions = scatter(700, extent);
                let (mut cell, mut order) = (Vec::new(), Vec::new());
                grid.sort(&positions, &mut cell, &mut order);
                let sorted: Vec<Vec3> = order.iter().map(|&a| positions[a as usize]).collect();
                let mut lists = NeighborLists::default();
                lists.build(&grid, &sorted, support);
                let mut found: Vec<(usize, usize, u8)> = (0..sorted.len().div_ceil(CHUNK))
                    .flat_map(|chunk| {
                        lists
                            .lists_of_chunk(chunk)
                            .enumerate()
                            .flat_map(move |(a, list)| {
                                list.iter()
                                    .map(move |b| (chunk * CHUNK + a, b.index(), b.image() as u8))
                            })
                            .collect::<Vec<_>>()
                    })
                    .collect();
                found.sort_unstable();
                assert_eq!(
                    found,
                    twin(&grid, &sorted, support),
                    "{periodic:?} {support}"
                );
                assert_eq!(lists.n_pairs() as usize, found.len() - sorted.len());
            }
        }
    }

    #[test]
    fn a_slab_narrower_than_the_support_is_refused() {
        let grid = CellGrid::new(
            (Vec3::zeros(), Vec3::new(1.0, 0.2, 1.0)),
            [false, true, false],
            0.3,
            1000,
        );
        assert!(grid.is_err());
    }

    #[test]
    fn a_domain_far_larger_than_its_water_stays_within_its_cells() {
        let grid =
            CellGrid::new((Vec3::zeros(), Vec3::repeat(1e4)), [false; 3], 0.1, 10_000).unwrap();
        assert!(grid.n_cells() <= 10_000);
    }
}
