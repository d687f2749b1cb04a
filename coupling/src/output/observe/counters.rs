//! `counters.csv`: blocks that have passed a plane or been in a box, and those that are there.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{ObserveError, Observer, Schedule};
use crate::files::table::{Cell, Column, Start, Table};
use crate::output::run_folder;
use crate::saved::Saved;
use crate::scene::resolve::Scene;
use crate::scene::resolved::recording::Counter;
use crate::world::World;

/// Counts of a counter up to the end of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Counted {
    /// Name of the counter.
    pub name: String,
    /// Blocks that have been in its region.
    pub passed: usize,
    /// Blocks in it at the end.
    pub inside: usize,
    /// Time of the step after which the first of them was there; `None` without any; s.
    pub first_time: Option<f64>,
    /// Time of the step after which the last of them was there for the first time; s.
    pub last_time: Option<f64>,
}

/// Counts blocks after every step, and writes a row per interval of `blocks.csv`.
#[derive(Debug)]
pub struct BlockCounters {
    schedule: Schedule,
    table: Table,
    counters: Vec<Counter>,
    counts: Vec<Count>,
}

/// Blocks that a counter has seen so far.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Count {
    /// Whether each of its blocks has been in the region.
    has_passed: Vec<bool>,
    passed: usize,
    inside: usize,
    /// s.
    first_time: Option<f64>,
    /// s.
    last_time: Option<f64>,
}

impl Count {
    fn of(counter: &Counter) -> Self {
        Self {
            has_passed: vec![false; counter.blocks.len()],
            passed: 0,
            inside: 0,
            first_time: None,
            last_time: None,
        }
    }

    fn update(&mut self, counter: &Counter, world: &World) {
        let before = self.passed;
        self.inside = 0;
        for (&block, has_passed) in counter.blocks.iter().zip(&mut self.has_passed) {
            // a block that leaves the domain stays where it left: it may have passed in that very step
            if !counter.region.holds(&world.blocks.centroid(block)) {
                continue;
            }
            self.passed += usize::from(!*has_passed);
            *has_passed = true;
            self.inside += usize::from(!world.blocks.is_removed(block));
        }
        if before < self.passed {
            self.first_time.get_or_insert(world.time());
            self.last_time = Some(world.time());
        }
    }
}

impl BlockCounters {
    /// A table in `folder` with the columns of the scene's counters.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] when the table cannot be created.
    pub fn new(folder: &Path, scene: &Scene, start: Start) -> Result<Self, ObserveError> {
        let of_counter = |counter: &Counter| {
            ["passed", "inside"].map(|c| Column::new(format!("{}.{c}", counter.name), "-"))
        };
        let mut columns = vec![Column::new("time", "s")];
        columns.extend(scene.counters.iter().flat_map(of_counter));
        Ok(Self {
            schedule: Schedule::every(scene.output.ledger_interval),
            table: Table::open(&folder.join(run_folder::COUNTERS), &columns, start)?,
            counters: scene.counters.clone(),
            counts: scene.counters.iter().map(Count::of).collect(),
        })
    }

    /// Counts so far.
    pub fn counted(&self) -> Vec<Counted> {
        let counted = |(counter, count): (&Counter, &Count)| Counted {
            name: counter.name.clone(),
            passed: count.passed,
            inside: count.inside,
            first_time: count.first_time,
            last_time: count.last_time,
        };
        self.counters
            .iter()
            .zip(&self.counts)
            .map(counted)
            .collect()
    }
}

impl Observer for BlockCounters {
    fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    /// After every step: between two rows a block may be through a box and out again.
    fn is_due(&self, _: &World) -> bool {
        true
    }

    fn observe(&mut self, world: &World) -> Result<(), ObserveError> {
        for (counter, count) in self.counters.iter().zip(&mut self.counts) {
            count.update(counter, world);
        }
        if self.schedule.is_due(world.time()) {
            let counts = self.counts.iter().flat_map(|c| [c.passed, c.inside]);
            let mut row = vec![Cell::Number(world.time())];
            row.extend(counts.map(Cell::Whole));
            self.table.cells(&row)?;
            self.schedule.done(world.time());
        }
        Ok(())
    }

    fn save(&self, out: Vec<u8>) -> Saved {
        postcard::to_extend(&(self.schedule, self.table.length(), &self.counts), out)
    }

    fn sync(&mut self) -> Result<(), ObserveError> {
        self.table.sync()?;
        Ok(())
    }

    fn read<'a>(&mut self, bytes: &'a [u8]) -> Result<&'a [u8], ObserveError> {
        let (schedule, length, rest);
        ((schedule, length, self.counts), rest) = postcard::take_from_bytes(bytes)?;
        self.schedule.resume(schedule);
        self.table.cut(length)?;
        Ok(rest)
    }
}
