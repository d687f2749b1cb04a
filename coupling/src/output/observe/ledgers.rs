//! `energy.csv`, `contact_solution.csv` and `joint_forces.csv`.

use std::path::Path;

use riprap_dda::Integrator;

use super::{ObserveError, Observer, Schedule};
use crate::files::table::{Cell, Column, Start, Table};
use crate::output::run_folder;
use crate::saved::Saved;
use crate::scene::resolve::Scene;
use crate::world::World;
use crate::world::ledger::Energy;

/// Writes the energy ledger, and how contacts and exact joints of blocks were solved.
#[derive(Debug)]
pub struct Ledgers {
    schedule: Schedule,
    energy: Table,
    /// `None` without contact dynamics.
    solution: Option<Table>,
    /// `None` without exact joints.
    joints: Option<Table>,
    row: Vec<f64>,
}

/// Columns of `contact_solution.csv`: the last step of the blocks at each time.
const SOLUTION_COLUMNS: [(&str, &str); 8] = [
    ("time", "s"),
    ("contacts", "-"),
    ("sweeps", "-"),
    ("residual", "-"),
    ("energy_error", "-"),
    ("max_overlap_over_size", "-"),
    ("unsolved_steps", "-"),
    ("above_painleve", "-"),
];

/// Columns of `joint_forces.csv`: one row per exact joint and time, numbered as the scene has them.
const JOINT_COLUMNS: [(&str, &str); 6] = [
    ("time", "s"),
    ("joint", "-"),
    ("fx", "N"),
    ("fy", "N"),
    ("fz", "N"),
    ("broken", "-"),
];

impl Ledgers {
    /// Tables in `folder`, with a row per interval of the scene.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] when a table cannot be created.
    pub fn new(
        folder: &Path,
        scene: &Scene,
        world: &World,
        start: Start,
    ) -> Result<Self, ObserveError> {
        let interval = scene.output.ledger_interval;
        let mut columns = vec![Column::new("time", "s")];
        columns.extend(Energy::TERMS.iter().map(|term| Column::new(*term, "J")));
        let has_movers = (0..world.blocks.n_blocks()).any(|b| !world.is_fixed(b));
        let is_solved = matches!(
            world.blocks.settings().integrator,
            Integrator::ContactDynamics(_)
        );
        let solution = (has_movers && is_solved)
            .then(|| {
                let columns = SOLUTION_COLUMNS.map(|(name, unit)| Column::new(name, unit));
                Table::open(&folder.join(run_folder::CONTACT_SOLUTION), &columns, start)
            })
            .transpose()?;
        let has_joints = world.blocks.joint_forces().next().is_some();
        let joints = has_joints
            .then(|| {
                let columns = JOINT_COLUMNS.map(|(name, unit)| Column::new(name, unit));
                Table::open(&folder.join(run_folder::JOINT_FORCES), &columns, start)
            })
            .transpose()?;
        Ok(Self {
            schedule: Schedule::every(interval),
            energy: Table::open(&folder.join(run_folder::ENERGY), &columns, start)?,
            solution,
            joints,
            row: Vec::new(),
        })
    }
}

impl Observer for Ledgers {
    fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    fn observe(&mut self, world: &World) -> Result<(), ObserveError> {
        let row = &mut self.row;
        row.clear();
        row.push(world.time());
        row.extend(world.energy().terms());
        self.energy.row(row)?;
        if let Some(table) = &mut self.solution {
            let blocks = &world.blocks;
            let (last, all) = (blocks.contact_solution(), blocks.solved_steps());
            table.row(&[
                world.time(),
                last.n_contacts as f64,
                last.n_iterations as f64,
                last.residual,
                last.energy_error,
                blocks.max_overlap_over_size(),
                all.n_unsolved as f64,
                last.n_above_painleve as f64,
            ])?;
        }
        if let Some(table) = &mut self.joints {
            for (number, (force, is_broken)) in world.blocks.joint_forces().enumerate() {
                let mut cells = vec![Cell::Number(world.time()), Cell::Whole(number)];
                cells.extend(force.iter().copied().map(Cell::Number));
                cells.push(Cell::Whole(usize::from(is_broken)));
                table.cells(&cells)?;
            }
        }
        self.schedule.done(world.time());
        Ok(())
    }

    fn save(&self, out: Vec<u8>) -> Saved {
        let length = |table: &Option<Table>| table.as_ref().map(Table::length);
        let lengths = [&self.solution, &self.joints].map(length);
        postcard::to_extend(&(self.schedule, self.energy.length(), lengths), out)
    }

    fn sync(&mut self) -> Result<(), ObserveError> {
        self.energy.sync()?;
        let others = [&self.solution, &self.joints];
        others.into_iter().flatten().try_for_each(Table::sync)?;
        Ok(())
    }

    fn read<'a>(&mut self, bytes: &'a [u8]) -> Result<&'a [u8], ObserveError> {
        let (schedule, energy, lengths, rest);
        ((schedule, energy, lengths), rest) = postcard::take_from_bytes(bytes)?;
        self.schedule.resume(schedule);
        self.energy.cut(energy)?;
        let lengths: [Option<_>; 2] = lengths;
        let tables = [&mut self.solution, &mut self.joints];
        for (table, length) in tables.into_iter().zip(lengths) {
            if let (Some(table), Some(length)) = (table, length) {
                table.cut(length)?;
            }
        }
        Ok(rest)
    }
}
