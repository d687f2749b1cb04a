//! `energy.csv`, `blocks.csv`, `contact_solution.csv` and `joint_forces.csv`.

use std::path::Path;

use riprap_dda::{Integrator, Vec3};

use super::{ObserveError, Observer, Schedule, name_of};
use crate::files::table::{Cell, Column, Start, Table};
use crate::output::run_folder;
use crate::saved::Saved;
use crate::scene::resolve::Scene;
use crate::world::World;
use crate::world::ledger::Energy;

/// Writes the energy ledger and the motion of blocks.
#[derive(Debug)]
pub struct Ledgers {
    schedule: Schedule,
    energy: Table,
    /// `None` if no block can move.
    blocks: Option<Table>,
    /// `None` without contact dynamics.
    solution: Option<Table>,
    /// `None` without exact joints.
    joints: Option<Table>,
    /// Name of each block.
    names: Vec<String>,
    row: Vec<f64>,
}

/// Columns of `blocks.csv`: one row per block that can move and time.
const BLOCK_COLUMNS: [(&str, &str); 29] = [
    ("time", "s"),
    ("block", "-"),
    ("x", "m"),
    ("y", "m"),
    ("z", "m"),
    ("vx", "m/s"),
    ("vy", "m/s"),
    ("vz", "m/s"),
    ("wx", "rad/s"),
    ("wy", "rad/s"),
    ("wz", "rad/s"),
    ("fluid_fx", "N"),
    ("fluid_fy", "N"),
    ("fluid_fz", "N"),
    ("contact_fx", "N"),
    ("contact_fy", "N"),
    ("contact_fz", "N"),
    ("gravity_fx", "N"),
    ("gravity_fy", "N"),
    ("gravity_fz", "N"),
    // attitude: the turn since the start
    ("qx", "-"),
    ("qy", "-"),
    ("qz", "-"),
    ("qw", "-"),
    ("roll", "rad"),
    ("pitch", "rad"),
    ("yaw", "rad"),
    ("asleep", "-"),
    ("name", ""),
];

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
        let blocks = has_movers
            .then(|| {
                let columns = BLOCK_COLUMNS.map(|(name, unit)| Column::new(name, unit));
                Table::open(&folder.join(run_folder::BLOCKS), &columns, start)
            })
            .transpose()?;
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
            blocks,
            solution,
            joints,
            names: scene.block_names.clone(),
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
        if let Some(table) = &mut self.blocks {
            let blocks = &world.blocks;
            for b in (0..blocks.n_blocks()).filter(|&b| !world.is_fixed(b) && !blocks.is_removed(b))
            {
                let fluid = world
                    .water
                    .as_ref()
                    .map_or(Vec3::zeros(), |water| water.interface.loads()[b].force);
                let mut cells = vec![Cell::Number(world.time()), Cell::Whole(b)];
                row.clear();
                for v in [
                    blocks.centroid(b),
                    blocks.velocity(b),
                    blocks.angular_velocity(b),
                    fluid,
                    blocks.contact_force(b).force,
                    world.gravity * blocks.mass(b),
                ] {
                    row.extend(v.iter());
                }
                let attitude = blocks.orientation(b);
                row.extend(attitude.coords.iter());
                let (roll, pitch, yaw) = attitude.euler_angles();
                row.extend([roll, pitch, yaw]);
                cells.extend(row.iter().copied().map(Cell::Number));
                cells.push(Cell::Whole(usize::from(blocks.is_asleep(b))));
                cells.push(name_of(&self.names, b));
                table.cells(&cells)?;
            }
        }
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
        let lengths = [&self.blocks, &self.solution, &self.joints].map(length);
        postcard::to_extend(&(self.schedule, self.energy.length(), lengths), out)
    }

    fn sync(&mut self) -> Result<(), ObserveError> {
        self.energy.sync()?;
        let others = [&self.blocks, &self.solution, &self.joints];
        others.into_iter().flatten().try_for_each(Table::sync)?;
        Ok(())
    }

    fn read<'a>(&mut self, bytes: &'a [u8]) -> Result<&'a [u8], ObserveError> {
        let (schedule, energy, lengths, rest);
        ((schedule, energy, lengths), rest) = postcard::take_from_bytes(bytes)?;
        self.schedule.resume(schedule);
        self.energy.cut(energy)?;
        let lengths: [Option<_>; 3] = lengths;
        let tables = [&mut self.blocks, &mut self.solution, &mut self.joints];
        for (table, length) in tables.into_iter().zip(lengths) {
            if let (Some(table), Some(length)) = (table, length) {
                table.cut(length)?;
            }
        }
        Ok(rest)
    }
}
