//! Lists of neighbors that outlive a sum.
//!
//! Particles that move little keep their neighbors: the points within the support and a skin of a
//! particle at a sort include all of its neighbors until the next sort. Lists are made
//! by the first sum after a sort and read by all others before the next; each sum saves the
//! search, most of which is for candidates in the corners of cells.
//!
//! All entries are summed, those between the support and the end of the skin too: kernels are zero there,
//! and to pick the others out would cost more than to add nothing. Only their number is counted by distance.
//!
//! Lists ignore thin solids. A receiver near one skips, in each sum, the neighbors that are currently
//! hidden.
//!
//! They are made from places rounded to quanta, as sums read them: these alone are kept to make lists again.
//!
//! Entries are in the order of the sweep, separate for each particle, padded to whole
//! registers, and numbered within a [`window`] of their chunk: results are the same bits for any number of threads. Neighbors across a periodic
//! side, or of the image in a plane of symmetry, are a separate span, summed from the shifted position. In much water [`slots`] keep
//! little more than a byte of each.
//!
//! Sleeping particles far from all awake ones have empty lists and are skipped in sums.

mod listing;
mod slots;
mod window;

use std::ops::Range;

use rayon::prelude::*;

use crate::neighbors::cells::{CellGrid, OWN_IMAGE};
use crate::neighbors::chords::Chords;
use crate::neighbors::mirror::{Mirrors, signs_in};
use crate::neighbors::points::{Frame, Places};
use crate::neighbors::rest::Rest;
use crate::neighbors::sweep::{
    BUFFER, FILTER_MARGIN, Occlusion, Receiver, ReceiverChunk, Receivers, Sources, Term,
};
use crate::simd::lanes::{Lanes, MOST_LANES, Machine, Task};
use crate::simd::lanes3::splat3;
use crate::{CHUNK, Vec3};
use listing::{Listing, Scratch};
use slots::{Register, Slots};
use window::{Limits, WITHIN, Window};

/// Neighbor lists of the points of a set, or of some of them.
#[derive(Clone, Debug)]
pub(crate) struct Lists {
    /// One for each [`CHUNK`] of receivers, and more where there were more receivers before.
    chunks: Vec<ChunkLists>,
    is_made: bool,
    /// Number of times that they were made.
    generation: u64,
    /// Receivers with anything listed.
    n_receivers: u64,
    /// Basis of the lists of all particles: their places, and the largest listed distance (m).
    from: (Places, f64),
    /// Most points of windows.
    limits: Limits,
}

impl Default for Lists {
    fn default() -> Self {
        Self {
            chunks: Vec::new(),
            is_made: false,
            generation: 0,
            n_receivers: 0,
            from: (Places::default(), 0.0),
            limits: Limits::default(),
        }
    }
}

/// The lists of some receivers, one after the other. Memory is kept from sort to sort.
#[derive(Clone, Debug, Default)]
struct ChunkLists {
    /// Receivers with anything listed.
    n_receivers: u64,
    /// Those of each receiver, at least one.
    spans: Vec<Span>,
    /// Neighbors of all spans, by their slots in the window of a page.
    slots: Slots,
    /// Whether registers of slots are [short](slots).
    are_short: bool,
    pages: Vec<Page>,
    /// Runs of points of all pages.
    runs: Vec<Range<u32>>,
}

/// Window of the spans from one on, up to those of the next page.
#[derive(Clone, Debug)]
struct Page {
    first_span: u32,
    points: PagePoints,
}

/// Points of a window.
#[derive(Clone, Debug)]
enum PagePoints {
    /// A part of all: spans are padded with one that is far.
    Part(Range<u32>),
    /// Some of the chunk's runs, to be copied: spans are padded with what is between them, which adds nothing.
    Runs(Range<u32>),
}

/// Neighbors of a receiver in one kind of list.
#[derive(Clone, Copy, Debug)]
struct Span {
    /// One past its last register of neighbors.
    end: u32,
    /// Periodic image of the neighbors.
    image: u8,
    /// Planes in which the receiver is mirrored, see [`Image::planes`](crate::neighbors::mirror::Image::planes).
    planes: u8,
    /// Whether it is the last one of its receiver.
    is_last: bool,
}

/// Chunks of receivers that a sum is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Chosen {
    All,
    /// Those without a thin solid nearby.
    Clear,
    /// The others.
    Occluded,
}

/// Receivers of lists.
#[derive(Clone, Copy)]
pub(crate) struct Listeners<'a> {
    pub places: ListenerPlaces<'a>,
    /// Indices of the receivers; all particles when absent.
    pub chosen: Option<&'a [u32]>,
}

/// Places of all from which receivers may be chosen.
#[derive(Clone, Copy)]
pub(crate) enum ListenerPlaces<'a> {
    /// m.
    Positions(&'a [Vec3]),
    /// Those that the fluid's lists were made from.
    Quanta(&'a Places),
}

impl Listeners<'_> {
    fn len(&self) -> usize {
        let n = match self.places {
            ListenerPlaces::Positions(positions) => positions.len(),
            ListenerPlaces::Quanta(places) => places.len(),
        };
        self.chosen.map_or(n, <[u32]>::len)
    }

    /// Index of a receiver.
    #[inline(always)]
    fn index(&self, k: usize) -> usize {
        self.chosen.map_or(k, |chosen| chosen[k] as usize)
    }

    /// Position of a receiver by its index; m.
    #[inline(always)]
    fn position(&self, frame: &Frame, a: usize) -> Vec3 {
        match self.places {
            ListenerPlaces::Positions(positions) => positions[a],
            ListenerPlaces::Quanta(places) => frame.position(places.of(a)),
        }
    }
}

/// Input of neighbor lists.
#[derive(Clone, Copy)]
pub(crate) struct Surroundings<'a> {
    pub grid: &'a CellGrid,
    pub frame: &'a Frame,
    pub mirrors: Mirrors,
    pub receivers: Listeners<'a>,
    /// Treatment of each receiver; empty if all are awake.
    pub rests: &'a [Rest],
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

    /// Invalidates the lists.
    pub(crate) fn forget(&mut self) {
        self.is_made = false;
    }

    /// Number of the making that they hold, `None` without one.
    pub(crate) fn generation(&self) -> Option<u64> {
        self.is_made.then_some(self.generation)
    }

    /// Places of all particles and radius (m) that their lists were made from, if they were.
    pub(crate) fn made_from(&self) -> Option<&(Places, f64)> {
        self.is_made.then_some(&self.from)
    }

    /// Storage of the places for the next lists of all particles.
    pub(crate) fn take_places(&mut self) -> Places {
        std::mem::take(&mut self.from.0)
    }

    /// Keeps what the lists of all particles were made from.
    pub(crate) fn keep_basis(&mut self, places: Places, radius: f64) {
        self.from = (places, radius);
    }

    /// Number of particles with a nonempty list: all, if sleep is off.
    pub(crate) fn n_receivers(&self) -> u64 {
        self.n_receivers
    }

    /// Memory held; bytes.
    pub(crate) fn memory(&self) -> usize {
        let of = |c: &ChunkLists| {
            size_of::<ChunkLists>()
                + c.slots.memory()
                + size_of::<Span>() * c.spans.capacity()
                + size_of::<Page>() * c.pages.capacity()
                + size_of::<Range<u32>>() * c.runs.capacity()
        };
        self.chunks.iter().map(of).sum::<usize>() + self.from.0.memory()
    }

    /// Builds the lists, for sums in registers `L`.
    pub(crate) fn make<L: Lanes>(
        &mut self,
        machine: L::Machine,
        from: Surroundings,
        points: &Places,
    ) where
        L::Machine: Machine,
    {
        let n_chunks = from.receivers.len().div_ceil(CHUNK);
        let chords = Chords::new(&from.grid.cell_size(), from.reach);
        if self.chunks.len() < n_chunks {
            self.chunks.resize_with(n_chunks, ChunkLists::default);
        }
        self.chunks[..n_chunks]
            .par_iter_mut()
            .enumerate()
            .for_each_init(Scratch::default, |scratch, (chunk, lists)| {
                machine.run(Listing::<L> {
                    machine,
                    from,
                    chords: &chords,
                    first: chunk * CHUNK,
                    points,
                    limits: self.limits,
                    scratch,
                    lists,
                });
            });
        self.n_receivers = self.chunks[..n_chunks].iter().map(|c| c.n_receivers).sum();
        self.is_made = true;
        self.generation += 1;
    }

    /// Sums `term` over the neighbors of every receiver of the chosen chunks into `out`; returns how many neighbors were
    /// found, receivers that meet themselves among them. `OCCLUDED` is needed for all chunks but clear ones.
    pub(crate) fn sum<L, T, const OCCLUDED: bool>(
        &self,
        machine: L::Machine,
        term: &T,
        sources: &Sources<L::Record>,
        (receivers, chosen): (Receivers, Chosen),
        out: &mut [T::Out],
    ) -> u64
    where
        L: Lanes,
        L::Machine: Machine,
        L::Record: Default,
        T: Term<L>,
    {
        debug_assert!(self.is_made && out.len() == receivers.len());
        let is_chosen = |receivers: ReceiverChunk| match chosen {
            Chosen::All => true,
            Chosen::Clear => !may_be_occluded(sources, receivers),
            Chosen::Occluded => may_be_occluded(sources, receivers),
        };
        out.par_chunks_mut(CHUNK)
            .zip(&self.chunks[receivers.first_chunk()..])
            .enumerate()
            .filter(|(chunk, _)| is_chosen(receivers.chunk(chunk * CHUNK)))
            .map_init(Window::default, |window, (chunk, (out, lists))| {
                let mut n_found = 0;
                let work = Work {
                    machine,
                    term,
                    sources,
                    receivers: receivers.chunk(chunk * CHUNK),
                    lists,
                    window,
                    out,
                    n_found: &mut n_found,
                };
                if lists.are_short {
                    machine.run(Summing::<L, T, OCCLUDED, true>(work));
                } else {
                    machine.run(Summing::<L, T, OCCLUDED, false>(work));
                }
                n_found
            })
            .sum()
    }
}

/// Whether a thin solid may be between any of the receivers, or its images, and their neighbors.
#[inline(never)]
fn may_be_occluded<R>(sources: &Sources<R>, receivers: ReceiverChunk) -> bool {
    let Some(occlusion) = &sources.occlusion else {
        return false;
    };
    if occlusion.has_facets() {
        return true;
    }
    let nowhere = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    let bounds = (0..receivers.len()).fold(nowhere, |(min, max), k| {
        let (_, x) = receivers.at(k);
        (min.inf(x), max.sup(x))
    });
    // images are elsewhere along these axes only
    let periodic = sources.grid.periodic();
    let axes = std::array::from_fn(|axis| !periodic[axis] && !sources.mirrors.are_across(axis));
    occlusion.thin_solids.may_be_near(&bounds, axes)
}

impl Span {
    /// The only span of a receiver without neighbors.
    fn nothing(end: u32) -> Self {
        Self {
            end,
            image: OWN_IMAGE,
            planes: 0,
            is_last: true,
        }
    }

    /// Position of a receiver relative to a span; m.
    #[inline(always)]
    fn seen_from<R>(&self, sources: &Sources<R>, position: &Vec3) -> Vec3 {
        let mut place = *position;
        if 0 < self.planes {
            place = sources.mirrors.mirrored(self.planes, &place);
        }
        if self.image != OWN_IMAGE {
            place -= sources.grid.image_shift(self.image);
        }
        place
    }
}

/// The sums of a chunk.
struct Work<'a, L: Lanes, T: Term<L>> {
    machine: L::Machine,
    term: &'a T,
    sources: &'a Sources<'a, L::Record>,
    receivers: ReceiverChunk<'a>,
    lists: &'a ChunkLists,
    window: &'a mut Window<L::Record>,
    out: &'a mut [T::Out],
    n_found: &'a mut u64,
}

/// Sums over the lists of a chunk, with or without thin solids and of either kind of registers: separate code, see
/// [`sweep`](crate::neighbors::sweep::sweep).
struct Summing<'a, L: Lanes, T: Term<L>, const OCCLUDED: bool, const SHORT: bool>(Work<'a, L, T>);

impl<L, T, const OCCLUDED: bool, const SHORT: bool> Task for Summing<'_, L, T, OCCLUDED, SHORT>
where
    L: Lanes,
    L::Machine: Machine,
    L::Record: Default,
    T: Term<L>,
{
    #[inline(always)]
    fn run(self) {
        let Work {
            machine,
            term,
            sources,
            receivers,
            lists,
            window,
            out,
            n_found: total,
        } = self.0;
        let occlusion = (sources.occlusion.as_ref())
            .filter(|_| OCCLUDED && may_be_occluded(sources, receivers));
        let ChunkLists {
            spans,
            slots,
            pages,
            runs,
            ..
        } = lists;
        let has_ids = T::READS_IDS || occlusion.is_some();
        let (mut pages, mut part) = (pages.iter().peekable(), None);
        let radius2 = sources.support_radius * sources.support_radius * FILTER_MARGIN;
        let support2 = L::splat(machine, radius2);
        let quanta = splat3(machine, sources.frame.quantum());
        let (mut kept, mut shares) = ([0; BUFFER], [1.0; BUFFER]);
        let (mut next, mut start) = (0, 0);
        for (k, out) in out.iter_mut().enumerate() {
            let (a, position) = receivers.at(k);
            let own = term.own(machine, a);
            let mut sums = term.zero(machine);
            let mut n_found = 0;
            loop {
                let span = &spans[next];
                while let Some(page) = pages.next_if(|page| page.first_span as usize <= next) {
                    part = match &page.points {
                        PagePoints::Part(part) => Some(part.start as usize..part.end as usize),
                        PagePoints::Runs(of_page) => {
                            let runs = &runs[of_page.start as usize..of_page.end as usize];
                            window.load(runs, sources.points, has_ids);
                            None
                        }
                    };
                }
                next += 1;
                let records = match &part {
                    Some(part) => &sources.points.records()[part.clone()],
                    None => window.records(),
                };
                let numbers = match &part {
                    Some(part) => Numbers::From(part.start as u32),
                    None => Numbers::Listed(window.ids()),
                };
                let mut own = own;
                if 0 < span.planes {
                    // the image of the receiver uses the points themselves, see `mirror`
                    let signs = splat3(machine, signs_in(span.planes));
                    own = term.mirrored(&own, &signs);
                    term.mirror(&mut sums, &signs);
                }
                let place = span.seen_from(sources, position);
                let receiver = Receiver::<L>::new(machine, &sources.frame.place(&place), quanta);
                let registers = slots.of_span::<SHORT>(start..span.end as usize);
                match occlusion {
                    Some(occlusion) if OCCLUDED && occlusion.may_hide(sources.grid, &place) => {
                        let slots = registers.slots::<L>();
                        let mut listed = slots.map(|slot| numbers.at(slot)).peekable();
                        while listed.peek().is_some() {
                            let near = (a, &place, radius2);
                            let into = (&mut kept, &mut shares);
                            let n = keep(occlusion, sources.grid, near, &mut listed, into);
                            let found = (&mut kept, &shares, n);
                            receiver.add_all::<_, true>(
                                term,
                                &own,
                                sources.points,
                                found,
                                &mut sums,
                            );
                            n_found += n as u32;
                        }
                    }
                    _ => {
                        for register in registers.iter::<L>() {
                            let register = Register::<SHORT>(register);
                            let pair = if SHORT {
                                let (lowest, ways) = register.ways();
                                // without a look whether each way is among them
                                receiver.pair(&records[lowest..lowest + WITHIN], ways)
                            } else {
                                receiver.pair(records, register.slots())
                            };
                            if T::COUNTS {
                                n_found += pair.r2.below(support2).count_ones();
                            }
                            let mut ids = [0; MOST_LANES];
                            if T::READS_IDS {
                                for (lane, number) in ids[..L::WIDTH].iter_mut().enumerate() {
                                    *number = numbers.at(register.at(lane));
                                }
                            }
                            term.add(&own, &pair, &ids, &mut sums);
                        }
                    }
                }
                if 0 < span.planes {
                    term.mirror(&mut sums, &splat3(machine, signs_in(span.planes)));
                }
                start = span.end as usize;
                if span.is_last {
                    break;
                }
            }
            term.finish(a, sums, n_found, out);
            *total += u64::from(n_found);
        }
    }
}

/// Numbers of points by their slots.
#[derive(Clone, Copy)]
enum Numbers<'a> {
    From(u32),
    Listed(&'a [u32]),
}

impl Numbers<'_> {
    #[inline(always)]
    fn at(&self, slot: usize) -> u32 {
        match self {
            Self::From(first) => first + slot as u32,
            Self::Listed(ids) => ids[slot],
        }
    }
}

/// Keeps the next listed points within the support, by its square (m²), that are visible to receiver `a` from a
/// position, each with its visible fraction; returns their number.
#[inline(never)]
fn keep(
    occlusion: &Occlusion,
    grid: &CellGrid,
    (a, place, radius2): (usize, &Vec3, f64),
    listed: impl Iterator<Item = u32>,
    (kept, shares): (&mut [u32; BUFFER], &mut [f64; BUFFER]),
) -> usize {
    let mut n = 0;
    // the others fill up registers
    let points = listed.filter(|&id| (id as usize) < occlusion.positions.len());
    for id in points.take(BUFFER) {
        if (occlusion.positions[id as usize] - place).norm_squared() < radius2 {
            kept[n] = id;
            n += 1;
        }
    }
    occlusion.keep_visible(grid, a, place, &mut kept[..n], shares)
}

#[cfg(test)]
mod tests {
    use super::window::Runs;
    use super::*;
    use crate::fluid::sums;
    use crate::scheme::{DensityDiffusion, Viscosity};
    use crate::simd::lanes::Portable;
    use crate::terms::continuity::Rate;
    use crate::{Dimensions, Fluid, FluidError, KernelChoice, Precision, Scheme, Settings, Start};

    const RADIUS: f64 = 0.2;

    type Eight = <Portable as Machine>::F32;

    /// A box and how sums are made in it.
    #[derive(Clone, Copy)]
    struct Case {
        extent: [f64; 3],
        periodic: [bool; 3],
        symmetry: [[bool; 2]; 3],
        kernel: KernelChoice,
        viscosity: Viscosity,
        precision: Precision,
    }

    const CLOSED: Case = Case {
        extent: [0.8; 3],
        periodic: [false; 3],
        symmetry: [[false; 2]; 3],
        kernel: KernelChoice::WendlandC2,
        viscosity: Viscosity::Artificial { alpha: 0.1 },
        precision: Precision::Double,
    };

    /// Random particles as dense as water in a box, half of them on their way along x, the others against it.
    fn cloud(of: Case) -> Result<Fluid, FluidError> {
        let extent = Vec3::from(of.extent);
        let settings = Settings {
            particle_spacing: [0.06; 3],
            smoothing_length: 0.5 * RADIUS,
            reference_density: 1000.0,
            sound_speed: 30.0,
            scheme: Scheme {
                precision: of.precision,
                diffusion: DensityDiffusion::Antuono(0.1),
                viscosity: of.viscosity,
                kernel: of.kernel,
                ..Scheme::artificial()
            },
            dimensions: Dimensions::Three,
            gravity: Vec3::zeros(),
            time_step_factor: 0.5,
            domain: (Vec3::zeros(), extent),
            periodic: of.periodic,
            symmetry: of.symmetry,
        };
        let mut state = 88_172_645_463_325_252_u64;
        let mut random = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let n = (extent.product() / 0.06_f64.powi(3)) as usize;
        let start = Start {
            positions: (0..n).map(|_| extent.map(|l| l * random())).collect(),
            velocities: (0..n)
                .map(|a| Vec3::x() * if a % 2 == 0 { 1.0 } else { -1.0 })
                .collect(),
            pressures: (0..n).map(|_| 1e4 * random()).collect(),
        };
        let mut fluid = Fluid::new(start, settings)?;
        fluid.refresh();
        Ok(fluid)
    }

    /// The same fluid without lists: its particles are said to have moved too far for them.
    fn without_lists(fluid: &Fluid) -> Fluid {
        let mut fluid = fluid.clone();
        fluid.approached = 1.1 * fluid.skin();
        fluid
    }

    /// Results of all sums, a column each, and the numbers of neighbors.
    fn all_sums(fluid: &mut Fluid) -> Result<(Vec<Vec<f64>>, Vec<u32>), FluidError> {
        fluid.update_rates();
        fluid.update_pressure()?;
        sums::forces(fluid, |_, _, _| {});
        sums::strains(fluid);
        sums::concentrations(fluid);
        let scratch = &fluid.scratch;
        let dimensions = fluid.settings.dimensions;
        let mut summed = fluid.clone();
        sums::summation(&mut summed, 1.0);
        let of_rates = |value: fn(&Rate) -> f64| -> Vec<f64> {
            let all = (0..scratch.rates.len()).map(|a| scratch.rates.of(a));
            all.map(|rate| value(&rate)).collect()
        };
        let columns = vec![
            of_rates(|rate| rate.flow),
            of_rates(|rate| rate.diffusion),
            scratch.forces.iter().flat_map(|f| f.pressure).collect(),
            scratch.forces.iter().flat_map(|f| f.viscous).collect(),
            scratch.gradients.iter().flatten().copied().collect(),
            (scratch.strains.iter())
                .map(|s| s.shear_rate(dimensions))
                .collect(),
            scratch
                .concentrations
                .iter()
                .map(|s| s.divergence)
                .collect(),
            summed.particles.density,
        ];
        let counts = (0..scratch.rates.len()).map(|a| scratch.rates.of(a).n_found);
        let counts = counts.collect();
        Ok((columns, counts))
    }

    /// Largest difference of the sums by lists from those by sweeps, each over the largest of its column, and
    /// of the numbers of neighbors.
    fn difference(fluid: &mut Fluid) -> Result<(f64, u32), FluidError> {
        let (by_sweep, counted) = all_sums(&mut without_lists(fluid))?;
        let (by_lists, listed) = all_sums(fluid)?;
        assert!(fluid.lists.are_made());
        let mut largest = 0.0_f64;
        for (a, b) in by_lists.iter().zip(&by_sweep) {
            let scale = b.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            assert!(0.0 < scale && a.len() == b.len());
            for (a, b) in a.iter().zip(b) {
                largest = largest.max((a - b).abs() / scale);
            }
        }
        let counts = listed.iter().zip(&counted).map(|(a, b)| a.abs_diff(*b));
        Ok((largest, counts.max().unwrap_or(0)))
    }

    /// Takes all particles as far as they may go without a sort.
    fn approach(fluid: &mut Fluid) {
        fluid.kick(0.0);
        fluid.drift(0.499 * fluid.skin());
        fluid.refresh();
        assert!(0.0 < fluid.moved(), "the drift is within the skin");
    }

    #[test]
    fn sums_by_lists_are_those_of_the_sweep() -> Result<(), FluidError> {
        let both = [true; 2];
        let cases = [
            CLOSED,
            Case {
                extent: [0.8, 0.3, 0.8],
                periodic: [true, true, false],
                ..CLOSED
            },
            Case {
                symmetry: [both, [false; 2], [true, false]],
                ..CLOSED
            },
            Case {
                extent: [0.3, 0.8, 0.8],
                periodic: [false, true, false],
                symmetry: [both, [false; 2], both],
                ..CLOSED
            },
            Case {
                kernel: KernelChoice::CubicSpline,
                viscosity: Viscosity::Morris {
                    kinematic_viscosity: 0.01,
                },
                ..CLOSED
            },
            Case {
                kernel: KernelChoice::Mueller,
                viscosity: Viscosity::Published {
                    dynamic_viscosity: 10.0,
                },
                ..CLOSED
            },
        ];
        for case in cases {
            let mut fluid = cloud(case)?;
            let when_made = difference(&mut fluid)?;
            approach(&mut fluid);
            let after_moving = difference(&mut fluid)?;
            // f64: the order of the sums is another where images are seen, measured 1e-15
            for (sums, counts) in [when_made, after_moving] {
                assert!(sums < 1e-12 && counts == 0, "{sums} {counts}");
            }
        }
        Ok(())
    }

    /// A plate across the box, and images of it through sides and planes.
    #[test]
    fn sums_by_lists_past_thin_solids_are_those_of_the_sweep() -> Result<(), FluidError> {
        let cases = [
            CLOSED,
            Case {
                extent: [0.8, 0.3, 0.8],
                periodic: [true, true, false],
                ..CLOSED
            },
            Case {
                symmetry: [[true; 2], [false; 2], [true, false]],
                ..CLOSED
            },
        ];
        for case in cases {
            let open = cloud(case)?;
            let mut fluid = open.clone();
            for low in [0.02, 0.5] {
                let planes = [
                    (Vec3::x(), low + 0.03),
                    (-Vec3::x(), -low),
                    (Vec3::z(), 0.5),
                    (-Vec3::z(), 0.01),
                ];
                let bounds = (Vec3::new(low, -1.0, -0.01), Vec3::new(low + 0.03, 2.0, 0.5));
                fluid.add_thin_solid(planes.into_iter().zip(0..), bounds);
            }
            let when_made = difference(&mut fluid)?;
            approach(&mut fluid);
            let after_moving = difference(&mut fluid)?;
            // pairs at the very edge of the support are counted by rounded or by exact places
            for (sums, counts) in [when_made, after_moving] {
                assert!(sums < 1e-12 && counts <= 1, "{sums} {counts}");
            }
            let (hidden, unhidden) = (all_sums(&mut fluid)?.1, all_sums(&mut open.clone())?.1);
            assert_ne!(hidden, unhidden, "the plates hide something");
        }
        Ok(())
    }

    /// Windows of some hundred points: several pages for each chunk, and receivers with candidates of more than one.
    #[test]
    fn sums_through_many_windows_are_those_of_the_sweep() -> Result<(), FluidError> {
        let case = Case {
            extent: [0.8, 0.3, 0.8],
            periodic: [true, true, false],
            symmetry: [[false; 2], [false; 2], [true, false]],
            ..CLOSED
        };
        let mut fluid = cloud(case)?;
        for largest in [300, 40] {
            fluid.lists = Lists {
                limits: Limits {
                    part: largest,
                    largest,
                    groups: 30,
                },
                ..Lists::default()
            };
            let (sums, counts) = difference(&mut fluid)?;
            assert!(sums < 1e-12 && counts == 0, "{largest}: {sums} {counts}");
            assert!(fluid.lists.chunks.iter().any(|lists| 2 < lists.pages.len()));
        }
        Ok(())
    }

    /// As in much water: no window is a part of the points.
    fn in_much_water(fluid: &mut Fluid) {
        fluid.lists = Lists {
            limits: Limits {
                part: 0,
                ..Limits::default()
            },
            ..Lists::default()
        };
    }

    #[test]
    fn short_registers_are_of_the_same_bits() -> Result<(), FluidError> {
        let single = Case {
            precision: Precision::Single,
            ..CLOSED
        };
        let cases = [
            (single, true),
            (
                Case {
                    extent: [0.8, 0.6, 0.8],
                    periodic: [true, true, false],
                    ..single
                },
                true,
            ),
            (
                Case {
                    symmetry: [[true; 2], [false; 2], [true, false]],
                    ..single
                },
                true,
            ),
            // rows next to each other are runs too long
            (
                Case {
                    extent: [0.3, 0.3, 1.6],
                    ..single
                },
                false,
            ),
        ];
        for (case, are_short) in cases {
            let mut fluid = cloud(case)?;
            let mut short = fluid.clone();
            in_much_water(&mut short);
            assert_eq!(all_sums(&mut fluid)?, all_sums(&mut short)?);
            assert!(fluid.lists.chunks.iter().all(|c| !c.are_short));
            let chunks = &short.lists.chunks;
            assert_eq!(
                chunks.iter().any(|c| c.are_short),
                are_short,
                "{:?}",
                case.extent
            );
            approach(&mut fluid);
            approach(&mut short);
            assert_eq!(all_sums(&mut fluid)?, all_sums(&mut short)?);
        }
        Ok(())
    }

    /// Neighbors too far apart for a register take two.
    #[test]
    fn short_registers_are_split() {
        let mut window = Runs::default();
        for run in [0..200, 300..500] {
            window.include(&run, &mut 0);
        }
        window.number(|point| point);
        let mut slots = Slots::default();
        // slots 1 to 200 and 202 to 401: the first run and the second
        let register: Vec<u32> = [5, 7, 9, 190, 205, 300, 390, 400].into();
        slots.add_short(&register, &window, true);
        let n = slots.bytes().len();
        assert_eq!(n, 2 * 10);
        let lanes: Vec<usize> = slots.of_span::<true>(0..n).slots::<Eight>().collect();
        let nothing = [0, 201, 402];
        for (lane, slot) in register.iter().enumerate() {
            let in_lane = [lanes[lane], lanes[lane + 8]];
            assert_eq!(in_lane.iter().filter(|&&s| s == *slot as usize).count(), 1);
            assert_eq!(in_lane.iter().filter(|s| nothing.contains(s)).count(), 1);
        }
    }

    /// A block of 32 x 32 x 32 particles on a cubic lattice, with lists of 113 neighbors within it.
    #[test]
    fn lists_are_a_byte_and_a_quarter_a_neighbor_in_much_water() -> Result<(), FluidError> {
        let spacing = 0.05;
        let mut fluid = cloud(Case {
            extent: [32.0 * spacing; 3],
            precision: Precision::Single,
            ..CLOSED
        })?;
        let mut settings = fluid.settings.clone();
        settings.particle_spacing = [spacing; 3];
        settings.smoothing_length = 1.3 * spacing;
        let place = |a: usize| [a % 32, a / 32 % 32, a / 1024].map(|k| (k as f64 + 0.5) * spacing);
        let positions: Vec<Vec3> = (0..32_768).map(|a| Vec3::from(place(a))).collect();
        let start = Start {
            velocities: vec![Vec3::zeros(); positions.len()],
            pressures: Vec::new(),
            positions,
        };
        fluid = Fluid::new(start, settings)?;
        fluid.refresh();
        let n = fluid.particles.len() as f64;
        // a span takes 8 bytes and a half, the place listed from 12, a chunk and its page 1, its many pages and runs 6
        for (is_much, of_eight, beside, altogether) in
            [(false, 16.0, 22.0, 240.0), (true, 10.0, 27.0, 170.0)]
        {
            fluid.lists = Lists::default();
            if is_much {
                in_much_water(&mut fluid);
            }
            fluid.update_rates();
            assert!(fluid.lists.chunks.iter().all(|c| c.are_short == is_much));
            let bytes: usize = (fluid.lists.chunks.iter())
                .map(|c| c.slots.bytes().len())
                .sum();
            let n_listed = 8.0 / of_eight * bytes as f64 / n;
            // neighbors, with itself, within 1.1 supports of 2.6 spacings, fewer at the faces, and what fills up registers
            assert!(85.0 < n_listed && n_listed < 112.0, "{n_listed}");
            // with a sixteenth to spare
            let most = (1.0 + 1.0 / 16.0) * (bytes as f64 / n) + beside;
            let per_particle = fluid.list_memory() as f64 / n;
            assert!(per_particle < most, "{per_particle} of {most}");
            // and with padding no more than that
            assert!(per_particle < altogether, "{per_particle} of {altogether}");
        }
        Ok(())
    }

    #[test]
    fn a_shorter_list_loses_neighbors() -> Result<(), FluidError> {
        let mut fluid = cloud(CLOSED)?;
        fluid.update_pressure()?;
        let mut places = Places::default();
        places.pack(&fluid.frame, &fluid.particles.position);
        fluid.list_within(RADIUS + 0.8 * fluid.skin(), places);
        approach(&mut fluid);
        let (sums, counts) = difference(&mut fluid)?;
        // what is lost is near the edge of the support, where kernels are small
        assert!(1e-9 < sums && 0 < counts, "{sums} {counts}");
        Ok(())
    }

    #[test]
    fn lists_take_no_memory_once_they_had_it() -> Result<(), FluidError> {
        let mut fluid = cloud(CLOSED)?;
        fluid.update_rates();
        let before = fluid.list_memory();
        assert!(0 < before);
        for _ in 0..3 {
            fluid.forget_order();
            fluid.refresh();
            fluid.update_rates();
        }
        assert_eq!(fluid.list_memory(), before);
        Ok(())
    }
}
