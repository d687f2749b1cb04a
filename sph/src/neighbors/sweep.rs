//! Sums over neighbors with their own search, in a single loop. Sums within the fluid use
//! [`crate::neighbors::lists`] instead, unless there are thin solids.
//!
//! For each receiving particle the candidates of nine rows of cells are filtered by distance into a
//! short buffer, eight at a time and without a branch; the neighbors found are summed a register at a time
//! by a [`Term`]. Each particle adds its own neighbors in the order of the cells,
//! so that results do not depend on the number of threads.

use rayon::prelude::*;

use crate::neighbors::cells::{CellGrid, MAX_RUNS, OWN_IMAGE, Run};
use crate::neighbors::mirror::{Image, MOST_IMAGES, Mirrors};
use crate::neighbors::points::{Frame, Points};
use crate::neighbors::rest::Still;
use crate::neighbors::thin_solids::{Facet, ThinSolids};
use crate::scheme::Precision;
use crate::simd::lanes::{
    FILTER_WIDTH, FilterSphere, Index, Lanes, Machine, Place, Portable, RECORD, Record, Task,
};
use crate::simd::lanes3::{Lanes3, splat3};
use crate::{CHUNK, Vec3};

/// Neighbors in a buffer before they are summed: 2 KiB, within the first cache.
pub(crate) const BUFFER: usize = 512;
/// Widening of the filter's radius, for its rounding: kernels vanish beyond the support anyway.
pub(crate) const FILTER_MARGIN: f64 = 1.0 + 1e-5;

/// A pair as registers hold it: receiver `a`, neighbors `b`.
#[derive(Clone, Copy)]
pub(crate) struct Pair<L> {
    /// `x_a − x_b`; m.
    pub offset: [L; 3],
    /// `|x_a − x_b|²`; m².
    pub r2: L,
    /// Fields of the neighbors' records; the last is a volume or another weight, which occlusion scales.
    pub b: [L; 5],
}

/// Term of a sum over neighbors.
pub(crate) trait Term<L: Lanes>: Sync {
    /// Values of the receiver, the same in all lanes.
    type Own: Copy;
    /// Partial sums.
    type Sums;
    /// Result of the sum.
    type Out: Send;
    /// Whether [`Self::add`] reads the indices of neighbors.
    const READS_IDS: bool;
    /// Whether anything reads how many neighbors were found.
    const COUNTS: bool;

    /// Values of receiver `a`.
    fn own(&self, machine: L::Machine, a: usize) -> Self::Own;
    /// Sums of nothing.
    fn zero(&self, machine: L::Machine) -> Self::Sums;
    /// Adds a register of neighbors; `ids` are their indices, anything where they are not read.
    fn add(&self, own: &Self::Own, pair: &Pair<L>, ids: &[u32], sums: &mut Self::Sums);
    /// Values of the receiver's mirror image: `signs` are −1 along axes that are reversed, 1 along others.
    fn mirrored(&self, own: &Self::Own, signs: &Lanes3<L>) -> Self::Own;
    /// Mirrors partial sums; an involution.
    fn mirror(&self, sums: &mut Self::Sums, signs: &Lanes3<L>);
    /// Writes the result of receiver `a`; `n_found` neighbors were within the support, itself included.
    fn finish(&self, a: usize, sums: Self::Sums, n_found: u32, out: &mut Self::Out);
}

/// Source of the neighbors of sums.
pub(crate) struct Sources<'a, R> {
    pub grid: &'a CellGrid,
    pub frame: &'a Frame,
    pub points: &'a Points<R>,
    /// Occlusion of points from receivers; `None` without thin solids.
    pub occlusion: Option<Occlusion<'a>>,
    /// Planes in which the points are mirrored.
    pub mirrors: Mirrors,
    /// Support radius; m.
    pub support_radius: f64,
    /// Farthest that points may have moved since the grid was sorted; m.
    pub moved: f64,
}

/// Thin solids between receivers and points.
#[derive(Clone, Copy)]
pub(crate) struct Occlusion<'a> {
    pub thin_solids: &'a ThinSolids,
    /// Positions of the points; m.
    pub positions: &'a [Vec3],
    pub between: PairKind<'a>,
}

/// Kinds of points on the two sides of an occlusion; wall particles with the faces they are behind, none for those beyond
/// the end of the list.
#[derive(Clone, Copy)]
pub(crate) enum PairKind<'a> {
    Particles,
    ParticlesAndWalls(&'a [Facet]),
    WallsAndParticles(&'a [Facet]),
}

impl Occlusion<'_> {
    /// Whether points near a place (m) may be hidden from it: a thin solid may be within the support.
    #[inline(always)]
    pub(crate) fn may_hide(&self, grid: &CellGrid, place: &Vec3) -> bool {
        self.has_facets() || self.thin_solids.are_near(grid.cell_of(place))
    }

    /// Whether there are wall points behind thin solids. They may lie beyond the influence of these, near other receivers.
    #[inline(always)]
    pub(crate) fn has_facets(&self) -> bool {
        match self.between {
            PairKind::Particles => false,
            PairKind::ParticlesAndWalls(facets) | PairKind::WallsAndParticles(facets) => {
                !facets.is_empty()
            }
        }
    }

    /// Keeps the points found that are visible to receiver `a` from a position, each with its visible fraction;
    /// returns their number.
    #[inline(never)]
    pub(crate) fn keep_visible(
        &self,
        grid: &CellGrid,
        a: usize,
        place: &Vec3,
        found: &mut [u32],
        shares: &mut [f64; BUFFER],
    ) -> usize {
        let cell = grid.cell_of(place);
        if !self.may_hide(grid, place) {
            shares[..found.len()].fill(1.0);
            return found.len();
        }
        let facet = |facets: &[Facet], k: usize| facets.get(k).copied().unwrap_or(Facet::NONE);
        let sight = self.thin_solids.sight(cell, place);
        let is_clear = |x: &Vec3| sight.as_ref().is_some_and(|sight| sight.is_clear(x));
        // points behind a face are seen through it only
        let past_nothing = |facet: Facet| f64::from(u8::from(facet == Facet::NONE));
        let mut n = 0;
        for k in 0..found.len() {
            let id = found[k] as usize;
            let x = &self.positions[id];
            let share = match self.between {
                PairKind::Particles if is_clear(x) => 1.0,
                PairKind::Particles => self.thin_solids.visibility(cell, place, x),
                PairKind::ParticlesAndWalls(facets) => match facet(facets, id) {
                    facet if is_clear(x) => past_nothing(facet),
                    facet => self.thin_solids.wall_visibility(cell, place, x, facet),
                },
                PairKind::WallsAndParticles(facets) => match facet(facets, a) {
                    facet if is_clear(x) => past_nothing(facet),
                    facet => self.thin_solids.wall_visibility(cell, x, place, facet),
                },
            };
            if 0.0 < share {
                found[n] = found[k];
                shares[n] = share;
                n += 1;
            }
        }
        n
    }
}

/// Receivers: all particles, or some of them.
#[derive(Clone, Copy)]
pub(crate) struct Receivers<'a> {
    pub positions: &'a [Vec3],
    /// Indices of the receivers; all particles when absent.
    pub chosen: Option<&'a [u32]>,
    /// Chunks before the first receiver, and the number of receivers from it on.
    part: (usize, usize),
}

impl Receivers<'_> {
    pub(crate) fn len(&self) -> usize {
        self.part.1
    }

    /// Chunks before the first one.
    pub(crate) fn first_chunk(&self) -> usize {
        self.part.0
    }

    #[inline(always)]
    fn index(&self, k: usize) -> usize {
        let k = self.part.0 * CHUNK + k;
        self.chosen.map_or(k, |chosen| chosen[k] as usize)
    }
}

impl<'a> Receivers<'a> {
    /// All of some positions (m), or those chosen.
    pub(crate) fn new(positions: &'a [Vec3], chosen: Option<&'a [u32]>) -> Self {
        Self {
            positions,
            chosen,
            part: (0, chosen.map_or(positions.len(), <[u32]>::len)),
        }
    }

    /// A number of receivers after the first chunks.
    pub(crate) fn part(self, n_chunks: usize, n: usize) -> Self {
        Self {
            part: (self.part.0 + n_chunks, n),
            ..self
        }
    }

    /// The [`CHUNK`] of them that begins with the receiver of a number.
    pub(crate) fn chunk(self, first: usize) -> ReceiverChunk<'a> {
        ReceiverChunk {
            all: self,
            first,
            n: CHUNK.min(self.len() - first),
        }
    }
}

/// A [`CHUNK`] of receivers.
#[derive(Clone, Copy)]
pub(crate) struct ReceiverChunk<'a> {
    all: Receivers<'a>,
    first: usize,
    n: usize,
}

impl<'a> ReceiverChunk<'a> {
    pub(crate) fn len(&self) -> usize {
        self.n
    }

    /// Index and position (m) of a receiver.
    #[inline(always)]
    pub(crate) fn at(&self, k: usize) -> (usize, &'a Vec3) {
        let a = self.all.index(self.first + k);
        (a, &self.all.positions[a])
    }
}

/// Sums `term` over the neighbors of every receiver into `out`, one slot per receiver, with or without the code for thin
/// solids; returns how many neighbors were found, receivers that meet themselves among them.
pub(crate) fn sweep<L, T, const OCCLUDED: bool>(
    machine: L::Machine,
    term: &T,
    sources: &Sources<L::Record>,
    receivers: Receivers,
    out: &mut [T::Out],
) -> u64
where
    L: Lanes,
    L::Machine: Machine,
    L::Record: Default,
    T: Term<L>,
{
    debug_assert_eq!(out.len(), receivers.len());
    out.par_chunks_mut(CHUNK)
        .enumerate()
        .map(|(chunk, out)| {
            let mut n_found = 0;
            machine.run(Chunk::<L, T, OCCLUDED> {
                machine,
                term,
                sources,
                receivers,
                first: chunk * CHUNK,
                out,
                n_found: &mut n_found,
            });
            n_found
        })
        .sum()
}

/// The work of one thread at a time. The version with thin solids is separate code: a call within the loop, even if
/// never executed, costs registers and 8 % of the time.
struct Chunk<'a, L: Lanes, T: Term<L>, const OCCLUDED: bool> {
    machine: L::Machine,
    term: &'a T,
    sources: &'a Sources<'a, L::Record>,
    receivers: Receivers<'a>,
    first: usize,
    out: &'a mut [T::Out],
    n_found: &'a mut u64,
}

impl<L, T, const OCCLUDED: bool> Task for Chunk<'_, L, T, OCCLUDED>
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
            receivers,
            first,
            out,
            n_found: total,
        } = self;
        let reach = sources.support_radius + sources.moved;
        let radius2 = (sources.support_radius * sources.support_radius * FILTER_MARGIN) as f32;
        let mut search = Search::<L, T, OCCLUDED> {
            machine,
            term,
            sources,
            scale: sources.frame.quantum().map(|q| q as f32),
            quanta: splat3(machine, sources.frame.quantum()),
            reach,
            radius2,
            runs: [Run::default(); MAX_RUNS],
            candidates: [[0; BUFFER]; 3],
            found: [0; BUFFER],
            shares: [1.0; BUFFER],
        };
        let mut images = [Image::default(); MOST_IMAGES];
        for (k, out) in out.iter_mut().enumerate() {
            let a = receivers.index(first + k);
            let position = &receivers.positions[a];
            let own = term.own(machine, a);
            let mut sums = term.zero(machine);
            let mut n_found = 0;
            let n_images = sources.mirrors.images_within(position, reach, &mut images);
            // the first image is the receiver itself
            for (k, image) in images[..n_images].iter().enumerate() {
                let (mut place, mut own) = (position, own);
                if 0 < k {
                    // the image of the receiver uses the points themselves, see `mirror`
                    let signs = splat3(machine, image.signs());
                    place = &image.position;
                    own = term.mirrored(&own, &signs);
                    term.mirror(&mut sums, &signs);
                }
                n_found += search.add_near(a, place, &own, &mut sums);
                if 0 < k {
                    term.mirror(&mut sums, &splat3(machine, image.signs()));
                }
            }
            term.finish(a, sums, n_found, out);
            *total += u64::from(n_found);
        }
    }
}

/// Visible points of the receivers, one after the other.
struct Search<'a, L: Lanes, T: Term<L>, const OCCLUDED: bool> {
    machine: L::Machine,
    term: &'a T,
    sources: &'a Sources<'a, L::Record>,
    /// Meters per quantum.
    scale: [f32; 3],
    quanta: Lanes3<L>,
    /// Farthest that a point within the support may have been sorted from a receiver; m.
    reach: f64,
    radius2: f32,
    runs: [Run; MAX_RUNS],
    /// Places of candidates; quanta.
    candidates: [[i32; BUFFER]; 3],
    found: [u32; BUFFER],
    /// Their visible fraction past thin solids.
    shares: [f64; BUFFER],
}

impl<L, T, const OCCLUDED: bool> Search<'_, L, T, OCCLUDED>
where
    L: Lanes,
    L::Machine: Machine,
    L::Record: Default,
    T: Term<L>,
{
    /// Adds all points within the support of a position, that of receiver `a` or its image; returns their number.
    #[inline(always)]
    fn add_near(&mut self, a: usize, position: &Vec3, own: &T::Own, sums: &mut T::Sums) -> u32 {
        let Self {
            machine,
            term,
            sources,
            scale,
            quanta,
            reach,
            radius2,
            ref mut runs,
            ref mut candidates,
            ref mut found,
            ref mut shares,
        } = *self;
        let Sources {
            grid,
            frame,
            points,
            ..
        } = *sources;
        let n_runs = grid.runs_within(position, reach, runs);
        let mut n_found = 0;
        let mut from = 0;
        // one pass per periodic image: all its neighbors are relative to the same shifted position
        while from < n_runs {
            let image = runs[from].image;
            let place = if image == OWN_IMAGE {
                frame.place(position)
            } else {
                frame.place(&(position - grid.image_shift(image)))
            };
            let keep_visible =
                |found: &mut [u32], shares: &mut [f64; BUFFER]| match &sources.occlusion {
                    Some(occlusion) if OCCLUDED => {
                        let meters = position - grid.image_shift(image);
                        occlusion.keep_visible(grid, a, &meters, found, shares)
                    }
                    _ => found.len(),
                };
            let sphere = FilterSphere {
                place: place.quanta,
                scale,
                radius2,
            };
            let receiver = Receiver::<L>::new(machine, &place, quanta);
            let mut start = runs[from].start as usize;
            loop {
                // as many candidates as the buffer surely holds
                let mut n = 0;
                while from < n_runs && runs[from].image == image {
                    let end = runs[from].end as usize;
                    let room = (BUFFER - FILTER_WIDTH - n) / FILTER_WIDTH * FILTER_WIDTH;
                    if room == 0 {
                        break;
                    }
                    let stop = end.min(start + room);
                    for (k, record) in points.records()[start..stop].iter().enumerate() {
                        let quanta =
                            record.quanta(|&[x, y, z]| frame.place(&Vec3::new(x, y, z)).quanta);
                        for (column, quanta) in candidates.iter_mut().zip(quanta) {
                            column[k] = quanta;
                        }
                    }
                    let columns = candidates.each_ref().map(|column| column.as_slice());
                    let range = (0..stop - start, start as u32);
                    n = machine.filter(columns, range, &sphere, found, n);
                    start = stop;
                    if start == end {
                        from += 1;
                        start = runs.get(from).map_or(0, |run| run.start as usize);
                    }
                }
                n = keep_visible(&mut found[..n], shares);
                receiver.add_all::<_, OCCLUDED>(term, own, points, (found, shares, n), sums);
                n_found += n as u32;
                if n_runs <= from || runs[from].image != image {
                    break;
                }
            }
        }
        n_found
    }
}

/// The receiver's position in an image.
pub(crate) struct Receiver<L: Lanes> {
    machine: L::Machine,
    place: [L; 3],
    quanta: [L; 3],
}

impl<L: Lanes> Receiver<L>
where
    L::Record: Default,
{
    #[inline(always)]
    pub(crate) fn new(machine: L::Machine, place: &Place, quanta: [L; 3]) -> Self {
        Self {
            machine,
            place: [
                L::coordinate(machine, place, 0),
                L::coordinate(machine, place, 1),
                L::coordinate(machine, place, 2),
            ],
            quanta,
        }
    }

    /// The receiver and a register of points.
    #[inline(always)]
    pub(crate) fn pair<I: Index>(&self, records: &[L::Record], ids: &[I]) -> Pair<L> {
        let [x, y, z, b0, b1, b2, b3, b4]: [L; RECORD] = L::gather(self.machine, records, ids);
        let offset = [
            self.place[0].separation(x, self.quanta[0]),
            self.place[1].separation(y, self.quanta[1]),
            self.place[2].separation(z, self.quanta[2]),
        ];
        let r2 = offset[0].mul_add(
            offset[0],
            offset[1].mul_add(offset[1], offset[2] * offset[2]),
        );
        Pair {
            offset,
            r2,
            b: [b0, b1, b2, b3, b4],
        }
    }

    #[inline(always)]
    pub(crate) fn add_all<T: Term<L>, const OCCLUDED: bool>(
        &self,
        term: &T,
        own: &T::Own,
        points: &Points<L::Record>,
        (found, shares, n): (&mut [u32; BUFFER], &[f64; BUFFER], usize),
        sums: &mut T::Sums,
    ) {
        let whole = n.next_multiple_of(L::WIDTH);
        found[n..whole].fill(points.nothing());
        let registers = found[..whole].chunks_exact(L::WIDTH);
        for (ids, shares) in registers.zip(shares.chunks_exact(L::WIDTH)) {
            let mut pair = self.pair(points.records(), ids);
            if OCCLUDED {
                pair.b[4] = pair.b[4] * L::load(self.machine, shares);
            }
            term.add(own, &pair, ids, sums);
        }
    }
}

/// A sum that can be built for any registers; [`dispatch`] picks them.
pub(crate) trait Sum {
    /// Runs it with registers `L`.
    fn run<L>(self, machine: L::Machine)
    where
        L: Lanes,
        L::Machine: Machine,
        L::Record: Default + PackedIn;
}

/// Runs a sum on the machine at hand.
pub(crate) fn dispatch(precision: Precision, sum: impl Sum) {
    #[cfg(target_arch = "x86_64")]
    if let Some(machine) = crate::simd::lanes::Avx2::detect() {
        return match precision {
            Precision::Single => sum.run::<<crate::simd::lanes::Avx2 as Machine>::F32>(machine),
            Precision::Double => sum.run::<<crate::simd::lanes::Avx2 as Machine>::F64>(machine),
        };
    }
    match precision {
        Precision::Single => sum.run::<<Portable as Machine>::F32>(Portable),
        Precision::Double => sum.run::<<Portable as Machine>::F64>(Portable),
    }
}

/// Points in both precisions; only one is ever filled.
#[derive(Clone, Debug, Default)]
pub(crate) struct AnyPoints {
    single: Points<crate::simd::lanes::Single>,
    double: Points<crate::simd::lanes::Double>,
}

/// A record that knows its points among [`AnyPoints`].
pub(crate) trait PackedIn: Record {
    /// The points of this precision.
    fn of(points: &AnyPoints) -> &Points<Self>;
}

impl PackedIn for crate::simd::lanes::Single {
    fn of(points: &AnyPoints) -> &Points<Self> {
        &points.single
    }
}

impl PackedIn for crate::simd::lanes::Double {
    fn of(points: &AnyPoints) -> &Points<Self> {
        &points.double
    }
}

impl AnyPoints {
    /// Writes positions and values of all points in the given precision.
    pub(crate) fn pack(
        &mut self,
        precision: Precision,
        frame: &Frame,
        positions: &[Vec3],
        values: impl Fn(usize) -> [f64; 5] + Sync,
    ) {
        self.pack_moving(precision, frame, (positions, Still::NONE), values);
    }

    /// Packs all but those in still chunks, which keep their records.
    pub(crate) fn pack_moving(
        &mut self,
        precision: Precision,
        frame: &Frame,
        (positions, still): (&[Vec3], Still),
        values: impl Fn(usize) -> [f64; 5] + Sync,
    ) {
        match precision {
            Precision::Single => self.single.pack(frame, positions, still, values),
            Precision::Double => self.double.pack(frame, positions, still, values),
        }
    }

    /// Writes values without positions, for sums that need more of a particle than one record.
    pub(crate) fn pack_values(
        &mut self,
        precision: Precision,
        n: usize,
        values: impl Fn(usize) -> [f64; RECORD] + Sync,
    ) {
        match precision {
            Precision::Single => self.single.pack_values(n, values),
            Precision::Double => self.double.pack_values(n, values),
        }
    }
}
