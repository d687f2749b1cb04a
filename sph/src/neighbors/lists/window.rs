//! Windows: the points that some receivers of a chunk may see, one after the other, so that lists number them in 16 bits or in 8.
//!
//! The candidates of neighboring receivers are nearly the same few runs of points. Where all of them are within 65,536 points, the
//! window is that part of the points. Elsewhere, in much water, it holds the runs alone, merged, with a slot that adds
//! nothing before each and at the end: a sum then copies the records of the window before it reads them, some ten a receiver. In
//! space and in single precision it is for few receivers, and the copies are some seventeen: neighbors that follow each other in a list are then
//! near together in it, and its records in the first cache.

use std::ops::Range;

use crate::neighbors::points::Points;
use crate::simd::lanes::Record;

/// Slots from the lowest of a short register on that it may hold.
pub(super) const WITHIN: usize = 1 << u8::BITS;

/// Most points of windows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// Of a part of the points. As runs they need no more slots: between two runs, which do not touch, is a point of neither.
    pub part: usize,
    /// Of runs.
    pub largest: usize,
    /// Groups of candidates of a window with short registers.
    pub groups: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            part: usize::from(u16::MAX),
            // no more runs than points, each with one that adds nothing, are numbered in 16 bits
            largest: usize::from(u16::MAX / 2),
            groups: 64,
        }
    }
}

/// Merged runs of points, in order.
#[derive(Clone, Debug, Default)]
pub(super) struct Runs {
    runs: Vec<Range<u32>>,
    /// Points in them.
    n: usize,
    /// First slot of each run, once [`Self::number`] was called.
    slots: Vec<u32>,
    /// Runs in the order of their slots.
    order: Vec<u32>,
}

impl Runs {
    pub(super) fn clear(&mut self) {
        self.runs.clear();
        self.slots.clear();
        self.order.clear();
        self.n = 0;
    }

    /// Runs in the order of their slots.
    pub(super) fn by_slot(&self) -> impl Iterator<Item = Range<u32>> + '_ {
        self.order
            .iter()
            .map(|&run| self.runs[run as usize].clone())
    }

    /// Number of points.
    pub(super) fn len(&self) -> usize {
        self.n
    }

    /// Adds the points of a run; `hint` is where a similar one was, and then where this one is.
    #[inline(always)]
    pub(super) fn include(&mut self, run: &Range<u32>, hint: &mut usize) {
        let holds = |held: &Range<u32>| held.start <= run.start && run.end <= held.end;
        if !self.runs.get(*hint).is_some_and(holds) {
            *hint = self.merge(run);
        }
    }

    #[inline(never)]
    fn merge(&mut self, run: &Range<u32>) -> usize {
        let first = self.runs.partition_point(|held| held.end < run.start);
        let touching = self.runs[first..]
            .iter()
            .take_while(|held| held.start <= run.end)
            .count();
        let replaced = first..first + touching;
        let before: usize = self.runs[replaced.clone()].iter().map(Range::len).sum();
        let merged = self.runs[replaced.clone()]
            .iter()
            .fold(run.clone(), |a, b| a.start.min(b.start)..a.end.max(b.end));
        self.n = self.n + merged.len() - before;
        self.runs.splice(replaced, [merged]);
        first
    }

    /// Gives every point its slot in a window of the runs, in the order of keys of their first points.
    pub(super) fn number<K: Ord>(&mut self, key: impl Fn(u32) -> K) {
        let Self {
            runs, slots, order, ..
        } = self;
        order.clear();
        order.extend((0..runs.len() as u32).filter(|&run| !runs[run as usize].is_empty()));
        order.sort_by_cached_key(|&run| key(runs[run as usize].start));
        slots.clear();
        slots.resize(runs.len(), 0);
        let mut next = 1;
        for &run in order.iter() {
            slots[run as usize] = next;
            // and one that adds nothing
            next += runs[run as usize].len() as u32 + 1;
        }
    }

    /// Slots that add nothing before and after the run of a slot.
    pub(super) fn nothing_beside(&self, slot: u32) -> [u32; 2] {
        let first = |&run: &u32| self.slots[run as usize];
        let run = self.order.partition_point(|run| first(run) <= slot) - 1;
        let run = self.order[run] as usize;
        let first = self.slots[run];
        [first - 1, first + self.runs[run].len() as u32]
    }

    /// Points of the longest run.
    pub(super) fn longest(&self) -> usize {
        self.runs.iter().map(Range::len).max().unwrap_or(0)
    }

    /// Slot of a point; `hint` as in [`Self::include`].
    #[inline(always)]
    pub(super) fn slot(&self, point: u32, hint: &mut usize) -> u32 {
        if !self.runs.get(*hint).is_some_and(|run| run.contains(&point)) {
            *hint = self.runs.partition_point(|held| held.end <= point);
        }
        self.slots[*hint] + (point - self.runs[*hint].start)
    }
}

/// A window while a sum reads it. Memory is kept from chunk to chunk.
#[derive(Debug)]
pub(super) struct Window<R> {
    records: Vec<R>,
    ids: Vec<u32>,
}

impl<R> Default for Window<R> {
    fn default() -> Self {
        Self {
            records: Vec::new(),
            ids: Vec::new(),
        }
    }
}

impl<R: Record + Default> Window<R> {
    /// Takes over the points of some runs; their numbers too where something reads these.
    #[inline(always)]
    pub(super) fn load(&mut self, runs: &[Range<u32>], points: &Points<R>, has_ids: bool) {
        let n = 1 + runs.iter().map(|run| run.len() + 1).sum::<usize>();
        if self.records.len() < n + WITHIN {
            self.records.resize(n + WITHIN, R::default());
        }
        self.records[0] = R::far();
        let mut next = 1;
        for run in runs {
            let end = next + run.len();
            self.records[next..end]
                .copy_from_slice(&points.records()[run.start as usize..run.end as usize]);
            self.records[end] = R::far();
            next = end + 1;
        }
        if has_ids {
            fill_ids(runs, points.nothing(), &mut self.ids);
        }
    }

    /// Records by slot, and after them as many as a short register may reach, which are not read.
    #[inline(always)]
    pub(super) fn records(&self) -> &[R] {
        &self.records
    }

    /// Numbers by slot.
    #[inline(always)]
    pub(super) fn ids(&self) -> &[u32] {
        &self.ids
    }
}

/// Writes the numbers of the points of some runs by their slots.
#[inline(always)]
pub(super) fn fill_ids(runs: &[Range<u32>], nothing: u32, ids: &mut Vec<u32>) {
    ids.clear();
    ids.push(nothing);
    for run in runs {
        ids.extend(run.clone());
        ids.push(nothing);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_merged_where_they_touch() {
        let mut runs = Runs::default();
        let mut hint = 7;
        for run in [20..30, 5..8, 40..41, 28..35, 8..10, 21..22, 0..0, 9..20] {
            runs.include(&run, &mut hint);
        }
        assert_eq!(runs.len(), 31);
        // the last run first
        runs.number(std::cmp::Reverse);
        let by_slot: Vec<_> = runs.by_slot().collect();
        assert_eq!(by_slot, [40..41, 5..35]);
        let mut ids = Vec::new();
        fill_ids(&by_slot, 99, &mut ids);
        assert_eq!(ids.len(), 34);
        for point in (5..35).chain([40]) {
            let slot = runs.slot(point, &mut hint);
            assert_eq!(ids[slot as usize], point);
            for nothing in runs.nothing_beside(slot) {
                assert_eq!(ids[nothing as usize], 99);
            }
        }
    }
}
