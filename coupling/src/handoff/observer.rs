//! The hand-off during a run: `handoff_lines.csv`, and `handoff/` when it is time.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::lines::{LEVELS, Line};
use super::package::{Request, Setting};
use super::readiness::{Readiness, Reason, State};
use crate::files::table::{Column, Start, Table, TableData, read_table};
use crate::output::observe::{ObserveError, Observer, Schedule};
use crate::output::run_folder;
use crate::saved::Saved;
use crate::scene::resolve::Scene;
use crate::scene::resolved::recording::{Handoff, HandoffTimes};
use crate::world::World;
use crate::world::ground::Ground;

/// Hands the water over during a run.
#[derive(Debug)]
pub struct HandOver {
    schedule: Schedule,
    folder: PathBuf,
    asked: Handoff,
    setting: Setting,
    lines: Vec<Line>,
    table: Option<Table>,
    /// `None` where times are given.
    readiness: Option<Readiness>,
    progress: Progress,
}

/// Hand-offs so far.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Progress {
    /// Times given that have been reached.
    n_done: usize,
    /// Whether the automatic one has been made.
    is_made: bool,
    readiness: State,
}

impl HandOver {
    /// The hand-off of a scene, with a table of its lines in `folder`; `None` without water.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] when the table cannot be created.
    pub fn new(
        folder: &Path,
        asked: &Handoff,
        (scene, world): (&Scene, &World),
        start: Start,
    ) -> Result<Option<Self>, ObserveError> {
        let Some(setting) = Setting::new(scene, asked.cell, asked.level) else {
            return Ok(None);
        };
        let Some(water) = setting.water(world) else {
            return Ok(None);
        };
        let ground = Ground::of(&world.blocks);
        let lines = asked.lines.iter();
        let lines: Vec<Line> = lines
            .map(|(_, line)| Line::new(*line, &ground, water.spacing))
            .collect();
        let table = match lines.is_empty() {
            true => None,
            false => {
                let path = folder.join(run_folder::HANDOFF_LINES);
                Some(Table::open(&path, &line_columns(asked), start)?)
            }
        };
        Ok(Some(Self {
            schedule: Schedule::every(scene.output.gauge_interval),
            folder: folder.to_owned(),
            asked: asked.clone(),
            readiness: (asked.times == HandoffTimes::Auto)
                .then(|| Readiness::new(scene, setting.raster, water)),
            setting,
            lines,
            table,
            progress: Progress::default(),
        }))
    }

    /// Hands over what there is when a run ends before the wave is made.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] names the file.
    pub fn finish(&self, world: &World) -> Result<(), ObserveError> {
        if self.readiness.is_none() || self.progress.is_made {
            return Ok(());
        }
        let folder = self.folder.join(run_folder::HANDOFF);
        self.write(world, &folder, Reason::EndOfRun)
    }

    /// Time of the next hand-off that is given; s.
    fn next_given(&self) -> Option<f64> {
        match &self.asked.times {
            HandoffTimes::At(times) => times.get(self.progress.n_done).copied(),
            HandoffTimes::Auto => None,
        }
    }

    /// Writes a hand-off into a folder.
    fn write(&self, world: &World, folder: &Path, reason: Reason) -> Result<(), ObserveError> {
        let Some(package) = self.setting.package(world) else {
            return Ok(());
        };
        let records = self.records()?;
        let request = Request {
            folder,
            formats: &self.asked.formats,
            lines: (&self.asked.lines, records.as_ref()),
            reason: (reason, self.readiness.as_ref().map(|r| r.state)),
        };
        self.setting.write(&package, world, request)
    }

    /// Records of the lines so far.
    fn records(&self) -> Result<Option<TableData>, ObserveError> {
        match &self.table {
            None => Ok(None),
            Some(_) => Ok(Some(read_table(
                &self.folder.join(run_folder::HANDOFF_LINES),
            )?)),
        }
    }

    /// A row of the lines, and a look at whether the wave is made.
    fn sample(&mut self, world: &World) -> Result<(), ObserveError> {
        let Some(water) = self.setting.water(world) else {
            return Ok(());
        };
        if let Some(table) = &mut self.table {
            let mut row = vec![world.time()];
            for line in &self.lines {
                let flow = line.flow(water);
                row.extend([flow.surface, flow.depth, flow.discharge]);
                row.extend(flow.velocity);
            }
            table.row(&row)?;
        }
        let Some(readiness) = &mut self.readiness else {
            return Ok(());
        };
        let reason = readiness.look(water, (world.time(), world.work_on_water()));
        if let Some(reason) = reason.filter(|_| !self.progress.is_made) {
            self.progress.is_made = true;
            self.write(world, &self.folder.join(run_folder::HANDOFF), reason)?;
        }
        Ok(())
    }
}

/// Columns of the table of lines.
fn line_columns(asked: &Handoff) -> Vec<Column> {
    let mut columns = vec![Column::new("time", "s")];
    for (name, _) in &asked.lines {
        columns.push(Column::new(format!("{name}.surface"), "m"));
        columns.push(Column::new(format!("{name}.depth"), "m"));
        columns.push(Column::new(format!("{name}.discharge"), "m3/s"));
        columns.extend((1..=LEVELS).map(|k| Column::new(format!("{name}.u{k}"), "m/s")));
    }
    columns
}

impl Observer for HandOver {
    fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    fn is_due(&self, world: &World) -> bool {
        let is_given = |at| at <= world.time();
        self.schedule.is_due(world.time()) || self.next_given().is_some_and(is_given)
    }

    fn observe(&mut self, world: &World) -> Result<(), ObserveError> {
        if self.schedule.is_due(world.time()) {
            self.sample(world)?;
            self.schedule.done(world.time());
        }
        while let Some(at) = self.next_given().filter(|&at| at <= world.time()) {
            self.progress.n_done += 1;
            let folder = self
                .folder
                .join(run_folder::HANDOFF)
                .join(format!("t_{at}"));
            self.write(world, &folder, Reason::Given)?;
        }
        Ok(())
    }

    fn save(&self, out: Vec<u8>) -> Saved {
        let length = self.table.as_ref().map_or(0, Table::length);
        let readiness = self.readiness.as_ref().map(|readiness| readiness.state);
        let progress = Progress {
            readiness: readiness.unwrap_or_default(),
            ..self.progress
        };
        postcard::to_extend(&(self.schedule, length, progress), out)
    }

    fn sync(&mut self) -> Result<(), ObserveError> {
        if let Some(table) = &self.table {
            table.sync()?;
        }
        Ok(())
    }

    fn read<'a>(&mut self, bytes: &'a [u8]) -> Result<&'a [u8], ObserveError> {
        let (schedule, length, rest);
        ((schedule, length, self.progress), rest) = postcard::take_from_bytes(bytes)?;
        self.schedule.resume(schedule);
        if let Some(readiness) = &mut self.readiness {
            readiness.state = self.progress.readiness;
        }
        if let Some(table) = &mut self.table {
            table.cut(length)?;
        }
        Ok(rest)
    }
}
