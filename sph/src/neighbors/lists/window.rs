//! Windows: the points that the receivers of a chunk may see, one after the other, so that lists number them in 16 bits.
//!
//! The candidates of neighboring receivers are nearly the same few runs of points. Where all of them are within 65,536 points, the
//! window is that part of the points. Elsewhere, in much water, it holds the runs alone, merged, after a slot 0 that adds
//! nothing: a sum then copies the records of the window before it reads them, some ten a receiver.

use std::ops::Range;

use crate::neighbors::points::Points;
use crate::simd::lanes::Record;

/// Points that a window may hold, beside the one that adds nothing.
pub(super) const LARGEST: usize = u16::MAX as usize;

/// Merged runs of points, in order.
#[derive(Clone, Debug, Default)]
pub(super) struct Runs {
    runs: Vec<Range<u32>>,
    /// Points in them.
    n: usize,
    /// First slot of each run, once [`Self::number`] was called.
    slots: Vec<u32>,
}

impl Runs {
    pub(super) fn clear(&mut self) {
        self.runs.clear();
        self.slots.clear();
        self.n = 0;
    }

    pub(super) fn as_slice(&self) -> &[Range<u32>] {
        &self.runs
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

    /// Gives every point its slot in a window of the runs alone.
    pub(super) fn number(&mut self) {
        let mut next = 1;
        self.slots.clear();
        self.slots.extend(self.runs.iter().map(|run| {
            let slot = next;
            next += run.len() as u32;
            slot
        }));
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
        self.records.clear();
        self.records.push(R::default());
        for run in runs {
            let run = run.start as usize..run.end as usize;
            self.records.extend_from_slice(&points.records()[run]);
        }
        if has_ids {
            fill_ids(runs, points.nothing(), &mut self.ids);
        }
    }

    /// Records by slot.
    #[inline(always)]
    pub(super) fn records(&self) -> &[R] {
        &self.records
    }

    /// Numbers by slot, that of the point that adds nothing first.
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
        assert_eq!(runs.as_slice(), [0..0, 5..35, 40..41]);
        assert_eq!(runs.len(), 31);
        runs.number();
        let mut ids = Vec::new();
        fill_ids(runs.as_slice(), 99, &mut ids);
        assert_eq!((ids.len(), ids[0]), (32, 99));
        for point in (5..35).chain([40]) {
            assert_eq!(ids[runs.slot(point, &mut hint) as usize], point);
        }
    }
}
