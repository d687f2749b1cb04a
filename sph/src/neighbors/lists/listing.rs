//! Making the lists of a chunk: first the runs of candidates of all receivers, and from these the windows; then the filter.

use std::ops::Range;

use super::slots::{LONGEST_RUN, Slots};
use super::window::{Limits, Runs, fill_ids};
use super::{ChunkLists, Page, PagePoints, Span, Surroundings};
use crate::CHUNK;
use crate::neighbors::cells::{MAX_RUNS, OWN_IMAGE, Run};
use crate::neighbors::chords::{Chords, Rows};
use crate::neighbors::mirror::{Image, MOST_IMAGES};
use crate::neighbors::points::Places;
use crate::neighbors::rest::Rest;
use crate::neighbors::sweep::FILTER_MARGIN;
use crate::simd::lanes::{FILTER_WIDTH, FilterSphere, Lanes, MOST_LANES, Machine, Task};

/// Room that lists keep for water that gathers a little more as it moves; 1/ROOM of their length.
const ROOM: usize = 16;

/// Memory of the making of lists, kept from chunk to chunk.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    rows: Rows,
    candidates: Vec<Range<u32>>,
    groups: Vec<Group>,
    /// Windows of the pages.
    windows: Vec<PageWindow>,
    found: Vec<u32>,
    slots: Slots,
    spans: Vec<Span>,
    /// Points of a window, where water may sleep.
    ids: Vec<u32>,
}

/// Window of some groups, one after the other.
#[derive(Debug)]
struct PageWindow {
    groups: Range<usize>,
    /// From the first candidate to the last.
    whole: Range<u32>,
    /// Whether it is this part of the points.
    is_part: bool,
    /// Candidates, merged, where it is not.
    runs: Runs,
    hints: [usize; MAX_RUNS],
}

/// Runs of candidates of a receiver in a plane, at most.
const RUNS_IN_PLANE: usize = 3;

/// No candidates.
const NONE: Range<u32> = Range {
    start: u32::MAX,
    end: 0,
};

impl Default for PageWindow {
    fn default() -> Self {
        Self {
            groups: 0..0,
            whole: NONE,
            is_part: true,
            runs: Runs::default(),
            hints: [0; MAX_RUNS],
        }
    }
}

impl PageWindow {
    /// Starts over at a group, with the memory that there is, for a part of the points or for runs.
    fn open(&mut self, group: usize, part: Option<&Range<u32>>) {
        self.groups = group..group;
        self.whole = part.cloned().unwrap_or(NONE);
        self.is_part = part.is_some();
        self.runs.clear();
    }

    fn include(&mut self, candidates: &[Range<u32>]) {
        for (run, hint) in candidates.iter().zip(&mut self.hints) {
            self.runs.include(run, hint);
        }
    }

    /// Whether those of another group, too, may be more than a window holds.
    fn is_full(&self, candidates: &[Range<u32>], largest: usize) -> bool {
        largest < self.runs.len() + candidates.iter().map(Range::len).sum::<usize>()
    }

    /// Slot of the first point of a run; `hint` as in [`Runs::slot`].
    #[inline(always)]
    fn slot(&self, run: &Range<u32>, hint: &mut usize) -> u32 {
        match self.is_part {
            true => run.start - self.whole.start,
            false => self.runs.slot(run.start, hint),
        }
    }

    /// Its points for sums; those of its runs go to the others of the chunk.
    fn points(&self, of_chunk: &mut Vec<Range<u32>>) -> PagePoints {
        if self.is_part {
            return PagePoints::Part(self.whole.start.min(self.whole.end)..self.whole.end);
        }
        let first = of_chunk.len() as u32;
        of_chunk.extend(self.runs.by_slot());
        PagePoints::Runs(first..of_chunk.len() as u32)
    }
}

/// From the first point of some runs to the last.
fn hull(runs: &[Range<u32>]) -> Range<u32> {
    (runs.iter().filter(|run| !run.is_empty()))
        .fold(NONE, |a, b| a.start.min(b.start)..a.end.max(b.end))
}

/// Candidates of a receiver that are seen from one place.
#[derive(Clone, Debug)]
struct Group {
    /// Their runs.
    candidates: Range<usize>,
    receiver: usize,
    /// Place from which they are seen; quanta.
    place: [i32; 3],
    image: u8,
    planes: u8,
    /// Slot that adds nothing.
    padding: u32,
}

/// Making the lists of a chunk.
pub(super) struct Listing<'a, L: Lanes> {
    pub machine: L::Machine,
    pub from: Surroundings<'a>,
    /// Those of its reach.
    pub chords: &'a Chords,
    /// First of the receivers.
    pub first: usize,
    pub points: &'a Places,
    pub limits: Limits,
    pub scratch: &'a mut Scratch,
    pub lists: &'a mut ChunkLists,
}

impl<L: Lanes> Task for Listing<'_, L>
where
    L::Machine: Machine,
{
    #[inline(always)]
    fn run(self) {
        let Self {
            machine,
            from,
            chords,
            first,
            points,
            limits,
            scratch,
            lists,
        } = self;
        let receivers = first..from.receivers.len().min(first + CHUNK);
        scratch.find_candidates(&from, chords, receivers.clone(), limits.largest);
        let may_be_short = scratch.find_windows::<L>(limits);
        scratch.number(&from, points);
        let is_near = |window: &PageWindow| window.runs.longest() <= LONGEST_RUN;
        lists.are_short = may_be_short && scratch.windows.iter().all(is_near);
        let Scratch {
            candidates,
            groups,
            windows,
            found,
            slots,
            spans,
            ids,
            ..
        } = scratch;
        slots.clear();
        spans.clear();
        lists.pages.clear();
        lists.runs.clear();
        lists.n_receivers = 0;
        let scale = from.frame.quantum().map(|q| q as f32);
        let radius2 = (from.radius * from.radius * FILTER_MARGIN) as f32;
        let (mut group, mut page) = (0, 0);
        for k in receivers {
            let a = from.receivers.index(k);
            let rest = from.rests.get(a).copied().unwrap_or_default();
            let before = (spans.len(), slots.end());
            let mut has_awake = rest != Rest::Beside;
            while let Some(of) = groups.get(group).filter(|of| of.receiver == k) {
                if lists.pages.is_empty() || windows[page].groups.end <= group {
                    page += usize::from(!lists.pages.is_empty());
                    let points_of = windows[page].points(&mut lists.runs);
                    if !from.rests.is_empty() {
                        match &points_of {
                            PagePoints::Part(part) => {
                                ids.clear();
                                ids.extend(part.clone());
                            }
                            PagePoints::Runs(of_page) => {
                                let of_page = of_page.start as usize..of_page.end as usize;
                                fill_ids(&lists.runs[of_page], points.len() as u32, ids);
                            }
                        }
                    }
                    lists.pages.push(Page {
                        first_span: spans.len() as u32,
                        points: points_of,
                    });
                }
                let sphere = FilterSphere {
                    place: of.place,
                    scale,
                    radius2,
                };
                let (mut n, mut hint) = (0, 0);
                let (mut in_order, mut end) = (true, 0);
                for run in &candidates[of.candidates.clone()] {
                    let slot = windows[page].slot(run, &mut hint);
                    let run = run.start as usize..run.end as usize;
                    // the filter writes whole registers
                    let room = n + run.len() + FILTER_WIDTH;
                    if found.len() < room {
                        found.resize(room, 0);
                    }
                    hint += 1;
                    in_order &= end <= slot;
                    end = slot + run.len() as u32;
                    n = machine.filter(points.columns(), (run, slot), &sphere, found, n);
                }
                group += 1;
                if n == 0 {
                    continue;
                }
                has_awake = has_awake
                    || found[..n].iter().any(|&slot| {
                        from.rests.get(ids[slot as usize] as usize) == Some(&Rest::Awake)
                    });
                let found = &found[..n];
                if lists.are_short {
                    slots.add_short(found, &windows[page].runs, in_order);
                } else {
                    slots.add::<L>(found, of.padding);
                }
                spans.push(Span {
                    end: slots.end(),
                    image: of.image,
                    planes: of.planes,
                    is_last: false,
                });
            }
            if !has_awake {
                spans.truncate(before.0);
                slots.truncate(before.1);
                for page in &mut lists.pages {
                    page.first_span = page.first_span.min(before.0 as u32);
                }
            }
            lists.n_receivers += u64::from(before.0 < spans.len());
            match spans[before.0..].last_mut() {
                Some(last) => last.is_last = true,
                None => spans.push(Span::nothing(slots.end())),
            }
        }
        take(slots.bytes(), lists.slots.bytes_mut());
        take(spans, &mut lists.spans);
    }
}

impl Scratch {
    /// Finds the candidates of all receivers, group by group: no more in a group than a window holds.
    #[inline(always)]
    fn find_candidates(
        &mut self,
        from: &Surroundings,
        chords: &Chords,
        receivers: Range<usize>,
        largest: usize,
    ) {
        self.candidates.clear();
        self.groups.clear();
        let mut images = [Image::default(); MOST_IMAGES];
        let mut runs = [Run::default(); MAX_RUNS];
        for k in receivers {
            let a = from.receivers.index(k);
            if from.rests.get(a) == Some(&Rest::Asleep) {
                continue;
            }
            let position = from.receivers.position(from.frame, a);
            let n_images = from
                .mirrors
                .images_within(&position, from.reach, &mut images);
            for image in &images[..n_images] {
                let n_runs =
                    (from.grid).runs_by_chords(&image.position, chords, &mut self.rows, &mut runs);
                let runs = &mut runs[..n_runs];
                // rows that cross a periodic side have both of its images: one group for each
                if runs.iter().any(|run| run.image != OWN_IMAGE) {
                    runs.sort_unstable_by_key(|run| (run.image, run.start));
                }
                for runs in runs.chunk_by(|a, b| a.image == b.image) {
                    let shift = from.grid.image_shift(runs[0].image);
                    let group = |candidates| Group {
                        candidates,
                        receiver: k,
                        place: from.frame.place(&(image.position - shift)).quanta,
                        image: runs[0].image,
                        planes: image.planes,
                        padding: 0,
                    };
                    let mut room = largest;
                    let mut first = self.candidates.len();
                    for run in runs {
                        let mut run = run.start..run.end;
                        // more than a window holds become groups of their own
                        while room < run.len() {
                            let cut = run.start + room as u32;
                            if 0 < room {
                                self.candidates.push(run.start..cut);
                            }
                            run.start = cut;
                            self.groups.push(group(first..self.candidates.len()));
                            (room, first) = (largest, self.candidates.len());
                        }
                        room -= run.len();
                        self.candidates.push(run);
                    }
                    self.groups.push(group(first..self.candidates.len()));
                }
            }
        }
    }

    /// Finds the windows of all groups: one part of the points where that holds all; runs elsewhere, for few receivers each where
    /// registers may be short. Returns whether they may: in space, where lists are long, and in single precision, where
    /// records are small and registers wide enough to be worth the copies.
    #[inline(always)]
    fn find_windows<L: Lanes>(&mut self, limits: Limits) -> bool {
        let Self {
            candidates,
            groups,
            windows,
            ..
        } = self;
        let whole = hull(candidates);
        let is_part = whole.end.saturating_sub(whole.start) as usize <= limits.part;
        let is_in_space = RUNS_IN_PLANE * groups.len() < candidates.len();
        let may_be_short = !is_part && is_in_space && L::WIDTH == MOST_LANES;
        let mut n_windows = 0;
        for (g, group) in groups.iter().enumerate() {
            let own = &candidates[group.candidates.clone()];
            let is_new = match windows[..n_windows].last() {
                None => true,
                Some(_) if is_part => false,
                Some(last) => {
                    let is_long = limits.groups <= g - last.groups.start;
                    may_be_short && is_long || last.is_full(own, limits.largest)
                }
            };
            if is_new {
                if windows.len() == n_windows {
                    windows.push(PageWindow::default());
                }
                windows[n_windows].open(g, is_part.then_some(&whole));
                n_windows += 1;
            }
            let window = &mut windows[n_windows - 1];
            if !is_part {
                window.include(own);
            }
            window.groups.end = g + 1;
        }
        windows.truncate(n_windows);
        may_be_short
    }

    /// Gives the points of all windows their slots, and finds padding for all groups.
    fn number(&mut self, from: &Surroundings, points: &Places) {
        let quantum = from.frame.quantum();
        let radius2 = from.radius * from.radius * FILTER_MARGIN * FILTER_MARGIN;
        let is_far = |group: &Group, point: u32| {
            let place = points.of(point as usize);
            let square = |axis: usize| {
                let way = group.place[axis].wrapping_sub(place[axis]);
                (f64::from(way) * quantum[axis]).powi(2)
            };
            radius2 < (0..3).map(square).sum::<f64>()
        };
        for window in &mut self.windows {
            let whole = window.whole.clone();
            // lists hold as long as what is far stays beyond the support
            let padding = |group: &Group| {
                [whole.start, whole.end.saturating_sub(1)]
                    .into_iter()
                    .find(|&point| whole.contains(&point) && is_far(group, point))
                    .map(|point| point - whole.start)
            };
            if window.is_part {
                for group in &mut self.groups[window.groups.clone()] {
                    match padding(group) {
                        Some(slot) => group.padding = slot,
                        None => window.is_part = false,
                    }
                }
                if window.is_part {
                    continue;
                }
                for group in &mut self.groups[window.groups.clone()] {
                    group.padding = 0;
                    window.include(&self.candidates[group.candidates.clone()]);
                }
            }
            // as receivers meet them, so that what a register holds is near together
            window.runs.number(|point| {
                let place = from.frame.position(points.of(point as usize));
                let [i, j, k] = from.grid.coordinates_of(&place);
                [j, k, i]
            });
        }
    }
}

/// Copies a column into memory that is kept unless it is much too large.
fn take<T: Copy>(column: &[T], into: &mut Vec<T>) {
    into.clear();
    let wanted = column.len() + column.len() / ROOM;
    if into.capacity() < column.len() || wanted + wanted / 4 < into.capacity() {
        *into = Vec::with_capacity(wanted);
    }
    into.extend_from_slice(column);
}
