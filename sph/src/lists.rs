//! Lists of neighbours that outlive a sum.
//!
//! Particles that move little keep their neighbours: whoever is within the support and a skin of a
//! particle when they are sorted holds all of its neighbours until they are sorted anew. Lists are made
//! by the first sum after a sort and read by all others before the next; what each sum spares is the
//! search, most of which is for candidates of the corners of cells.
//!
//! All entries are summed, those between the support and the end of the skin too: kernels are zero there,
//! and to pick the others out would cost more than to add nothing. Only their number is counted by distance.
//!
//! Entries stand in the order in which the sweep finds them, each particle's own, filled up to whole
//! registers: results are the same bits for any number of threads. What a particle sees through a periodic
//! side, or its image in a plane of symmetry sees, is a span of its own, summed from the shifted place.

use rayon::prelude::*;

use crate::cells::{CellGrid, MAX_RUNS, OWN_IMAGE, Run};
use crate::lanes::{FILTER_WIDTH, Lanes, Machine, Sight, Task};
use crate::mirror::{Image, MOST_IMAGES, Mirrors, signs_in};
use crate::points::{Frame, Points};
use crate::sweep::{FILTER_MARGIN, Seen, Sources, Term};
use crate::terms::splat3;
use crate::{CHUNK, Vec3};

/// Who is near whom, among one set of particles.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lists {
    /// One for each [`CHUNK`] of receivers, and more where there were more receivers before.
    chunks: Vec<ChunkLists>,
    is_made: bool,
}

/// The lists of some receivers, one after the other. Memory is kept from sort to sort.
#[derive(Clone, Debug, Default)]
struct ChunkLists {
    /// One past the last span of each receiver.
    ends: Vec<u32>,
    spans: Vec<Span>,
    /// Neighbours of all spans; what is beyond the last span means nothing.
    ids: Vec<u32>,
}

/// What a receiver sees in one way.
#[derive(Clone, Copy, Debug)]
struct Span {
    /// One past its last register of neighbours.
    end: u32,
    /// Neighbours in its last register.
    n_in_last: u8,
    /// Periodic image of the neighbours.
    image: u8,
    /// Planes in which the receiver is mirrored, see [`Image::planes`].
    planes: u8,
}

impl Span {
    const BYTES: usize = size_of::<Self>();
}

/// Where lists are made from.
#[derive(Clone, Copy)]
pub(crate) struct Surroundings<'a> {
    pub grid: &'a CellGrid,
    pub frame: &'a Frame,
    pub mirrors: Mirrors,
    pub positions: &'a [Vec3],
    /// Farthest that anything to be listed may be from a receiver; m.
    pub radius: f64,
    /// Farthest that it may have been sorted; m.
    pub reach: f64,
}

impl Lists {
    /// Whether they were made since they were last forgotten.
    pub(crate) fn are_made(&self) -> bool {
        self.is_made
    }

    /// Forgets who is near whom.
    pub(crate) fn forget(&mut self) {
        self.is_made = false;
    }

    /// Memory held; bytes.
    pub(crate) fn memory(&self) -> usize {
        let of = |c: &ChunkLists| {
            size_of::<u32>() * (c.ends.capacity() + c.ids.capacity())
                + Span::BYTES * c.spans.capacity()
        };
        self.chunks.iter().map(of).sum()
    }

    /// Lists who is near whom, for sums in registers `L`.
    pub(crate) fn make<L: Lanes>(
        &mut self,
        machine: L::Machine,
        from: Surroundings,
        points: &Points<L::Record>,
    ) where
        L::Machine: Machine,
        L::Record: Default,
    {
        let n_chunks = from.positions.len().div_ceil(CHUNK);
        if self.chunks.len() < n_chunks {
            self.chunks.resize_with(n_chunks, ChunkLists::default);
        }
        self.chunks
            .par_iter_mut()
            .zip(from.positions.par_chunks(CHUNK))
            .for_each(|(lists, positions)| {
                machine.run(Listing::<L> {
                    machine,
                    from,
                    positions,
                    points,
                    lists,
                });
            });
        self.is_made = true;
    }

    /// Sums `term` over the neighbours of every particle into `out`; returns how many neighbours were found,
    /// particles that meet themselves among them.
    pub(crate) fn sum<L, T>(
        &self,
        machine: L::Machine,
        term: &T,
        sources: &Sources<L::Record>,
        positions: &[Vec3],
        out: &mut [T::Out],
    ) -> u64
    where
        L: Lanes,
        L::Machine: Machine,
        L::Record: Default,
        T: Term<L>,
    {
        debug_assert!(self.is_made && out.len() == positions.len());
        out.par_chunks_mut(CHUNK)
            .zip(&self.chunks)
            .enumerate()
            .map(|(chunk, (out, lists))| {
                let mut n_found = 0;
                machine.run(Summing::<L, T> {
                    machine,
                    term,
                    sources,
                    positions,
                    lists,
                    first: chunk * CHUNK,
                    out,
                    n_found: &mut n_found,
                });
                n_found
            })
            .sum()
    }
}

/// Making the lists of a chunk.
struct Listing<'a, L: Lanes> {
    machine: L::Machine,
    from: Surroundings<'a>,
    /// Of the receivers; m.
    positions: &'a [Vec3],
    points: &'a Points<L::Record>,
    lists: &'a mut ChunkLists,
}

impl<L: Lanes> Task for Listing<'_, L>
where
    L::Machine: Machine,
    L::Record: Default,
{
    #[inline(always)]
    fn run(self) {
        let Self {
            machine,
            from,
            positions,
            points,
            lists: ChunkLists { ends, spans, ids },
        } = self;
        let scale = from.frame.quantum().map(|q| q as f32);
        let radius2 = (from.radius * from.radius * FILTER_MARGIN) as f32;
        let nothing = points.nothing();
        let mut images = [Image::default(); MOST_IMAGES];
        let mut runs = [Run::default(); MAX_RUNS];
        ends.clear();
        spans.clear();
        let mut n = 0;
        for position in positions {
            let n_images = from
                .mirrors
                .images_within(position, from.reach, &mut images);
            for image in &images[..n_images] {
                let n_runs = from
                    .grid
                    .runs_within(&image.position, from.reach, &mut runs);
                let runs = &mut runs[..n_runs];
                // rows that cross a periodic side have both of its images: one span for each
                if runs.iter().any(|run| run.image != OWN_IMAGE) {
                    runs.sort_unstable_by_key(|run| (run.image, run.start));
                }
                for runs in runs.chunk_by(|a, b| a.image == b.image) {
                    let shift = from.grid.image_shift(runs[0].image);
                    let sight = Sight {
                        place: from.frame.place(&(image.position - shift)).quanta,
                        scale,
                        radius2,
                    };
                    let start = n;
                    for run in runs {
                        let run = run.start as usize..run.end as usize;
                        // the filter writes whole registers, and the last one is filled up
                        let room = n + run.len() + FILTER_WIDTH;
                        if ids.len() < room {
                            // water gathers a little more as it moves: an eighth to spare
                            let room = room + room / 8;
                            ids.reserve_exact(room - ids.len());
                            ids.resize(room, nothing);
                        }
                        n = machine.filter(points.columns(), run, &sight, ids, n);
                    }
                    if start < n {
                        let end = start + (n - start).next_multiple_of(L::WIDTH);
                        ids[n..end].fill(nothing);
                        spans.push(Span {
                            end: end as u32,
                            n_in_last: (L::WIDTH - (end - n)) as u8,
                            image: runs[0].image,
                            planes: image.planes,
                        });
                        n = end;
                    }
                }
            }
            ends.push(spans.len() as u32);
        }
    }
}

/// Summing over the lists of a chunk.
struct Summing<'a, L: Lanes, T: Term<L>> {
    machine: L::Machine,
    term: &'a T,
    sources: &'a Sources<'a, L::Record>,
    positions: &'a [Vec3],
    lists: &'a ChunkLists,
    /// First receiver.
    first: usize,
    out: &'a mut [T::Out],
    n_found: &'a mut u64,
}

impl<L, T> Task for Summing<'_, L, T>
where
    L: Lanes,
    L::Machine: Machine,
    L::Record: Default,
    T: Term<L>,
{
    #[inline(always)]
    fn run(self) {
        let Self {
            machine,
            term,
            sources,
            positions,
            lists: ChunkLists { ends, spans, ids },
            first,
            out,
            n_found: total,
        } = self;
        let support2 = sources.support_radius * sources.support_radius * FILTER_MARGIN;
        let support2 = L::splat(machine, support2);
        let quanta = splat3(machine, sources.frame.quantum());
        let (mut span, mut start) = (0, 0);
        for (k, (out, &end)) in out.iter_mut().zip(ends).enumerate() {
            let a = first + k;
            let own = term.own(machine, a);
            let mut sums = term.zero(machine);
            let mut n_found = 0;
            for &Span {
                end,
                n_in_last,
                image,
                planes,
            } in &spans[span..end as usize]
            {
                let (mut place, mut own) = (positions[a], own);
                if 0 < planes {
                    // the image of the receiver sees the points themselves, see `mirror`
                    let signs = splat3(machine, signs_in(planes));
                    place = sources.mirrors.mirrored(planes, &place);
                    own = term.mirrored(&own, &signs);
                    term.mirror(&mut sums, &signs);
                }
                if image != OWN_IMAGE {
                    place -= sources.grid.image_shift(image);
                }
                let seen = Seen::<L>::new(machine, &sources.frame.place(&place), quanta);
                let mut near = 0;
                for ids in ids[start..end as usize].chunks_exact(L::WIDTH) {
                    let pair = seen.pair(sources.points.records(), ids);
                    near = pair.r2.below(support2);
                    n_found += near.count_ones();
                    term.add(&own, &pair, ids, &mut sums);
                }
                // what fills up the last register is nowhere
                n_found -= (near >> n_in_last).count_ones();
                if 0 < planes {
                    term.mirror(&mut sums, &splat3(machine, signs_in(planes)));
                }
                start = end as usize;
            }
            span = end as usize;
            term.finish(a, sums, n_found, out);
            *total += u64::from(n_found);
        }
    }
}
