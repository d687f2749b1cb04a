//! `blocks.csv` or `blocks.npy`: place, motion and forces of blocks that can move, a row per block and time.

use std::path::Path;

use riprap_dda::Vec3;

use super::{ObserveError, Observer, Schedule, name_of};
use crate::files::table::{Cell, Column, NpyKind, NpyTable, Start, Table};
use crate::output::run_folder;
use crate::saved::Saved;
use crate::scene::resolve::Scene;
use crate::scene::resolved::recording::TableFormat;
use crate::world::World;

/// Columns, their units, and their kinds in a binary table: times and places with all their digits.
const COLUMNS: [(&str, &str, NpyKind); 28] = [
    ("time", "s", NpyKind::Double),
    ("block", "-", NpyKind::Whole),
    ("x", "m", NpyKind::Double),
    ("y", "m", NpyKind::Double),
    ("z", "m", NpyKind::Double),
    ("vx", "m/s", NpyKind::Single),
    ("vy", "m/s", NpyKind::Single),
    ("vz", "m/s", NpyKind::Single),
    ("wx", "rad/s", NpyKind::Single),
    ("wy", "rad/s", NpyKind::Single),
    ("wz", "rad/s", NpyKind::Single),
    ("fluid_fx", "N", NpyKind::Single),
    ("fluid_fy", "N", NpyKind::Single),
    ("fluid_fz", "N", NpyKind::Single),
    ("contact_fx", "N", NpyKind::Single),
    ("contact_fy", "N", NpyKind::Single),
    ("contact_fz", "N", NpyKind::Single),
    ("gravity_fx", "N", NpyKind::Single),
    ("gravity_fy", "N", NpyKind::Single),
    ("gravity_fz", "N", NpyKind::Single),
    // attitude: the turn since the blocks were drawn
    ("qx", "-", NpyKind::Single),
    ("qy", "-", NpyKind::Single),
    ("qz", "-", NpyKind::Single),
    ("qw", "-", NpyKind::Single),
    ("roll", "rad", NpyKind::Single),
    ("pitch", "rad", NpyKind::Single),
    ("yaw", "rad", NpyKind::Single),
    ("asleep", "-", NpyKind::Flag),
];
/// Columns of whole numbers.
const WHOLE: [usize; 2] = [1, 27];

/// Writes the motion of blocks.
#[derive(Debug)]
pub struct Motions {
    schedule: Schedule,
    file: Rows,
    blocks: Vec<usize>,
    /// Name of each block of the scene.
    names: Vec<String>,
}

#[derive(Debug)]
enum Rows {
    Text(Table),
    Binary(NpyTable),
}

impl Motions {
    /// A table in `folder` of the blocks that the scene asks for; `None` if there are none.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] when the table cannot be created.
    pub fn new(folder: &Path, scene: &Scene, start: Start) -> Result<Option<Self>, ObserveError> {
        let asked = &scene.block_table;
        if asked.blocks.is_empty() {
            return Ok(None);
        }
        let file = match asked.format {
            TableFormat::Csv => {
                let mut columns = COLUMNS
                    .map(|(name, unit, _)| Column::new(name, unit))
                    .to_vec();
                columns.push(Column::new("name", ""));
                let path = folder.join(run_folder::BLOCKS);
                Rows::Text(Table::open(&path, &columns, start)?)
            }
            TableFormat::Npy => {
                let columns = COLUMNS.map(|(name, _, kind)| (name, kind));
                let path = folder.join(run_folder::BLOCKS_BINARY);
                Rows::Binary(NpyTable::open(&path, &columns, start)?)
            }
        };
        Ok(Some(Self {
            schedule: Schedule::every(asked.interval),
            file,
            blocks: asked.blocks.clone(),
            names: scene.block_names.clone(),
        }))
    }
}

/// Values of a block, in the order of [`COLUMNS`].
fn row(world: &World, b: usize) -> [f64; COLUMNS.len()] {
    let blocks = &world.blocks;
    let fluid = world
        .water
        .as_ref()
        .map_or(Vec3::zeros(), |water| water.interface.loads()[b].force);
    let attitude = blocks.orientation(b);
    let (roll, pitch, yaw) = attitude.euler_angles();
    let vectors = [
        blocks.centroid(b),
        blocks.velocity(b),
        blocks.angular_velocity(b),
        fluid,
        blocks.contact_force(b).force,
        world.gravity * blocks.mass(b),
    ];
    let mut row = [0.0; COLUMNS.len()];
    let values = [world.time(), b as f64]
        .into_iter()
        .chain(vectors.iter().flat_map(|v| v.iter().copied()))
        .chain(attitude.coords.iter().copied())
        .chain([roll, pitch, yaw, f64::from(u8::from(blocks.is_asleep(b)))]);
    for (place, value) in row.iter_mut().zip(values) {
        *place = value;
    }
    row
}

impl Observer for Motions {
    fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    fn observe(&mut self, world: &World) -> Result<(), ObserveError> {
        let present = self.blocks.iter().filter(|&&b| !world.blocks.is_removed(b));
        for &b in present {
            let row = row(world, b);
            match &mut self.file {
                Rows::Binary(table) => table.push(&row)?,
                Rows::Text(table) => {
                    let cell = |(k, &value): (usize, &f64)| match WHOLE.contains(&k) {
                        true => Cell::Whole(value as usize),
                        false => Cell::Number(value),
                    };
                    let cells = row.iter().enumerate().map(cell);
                    let cells = cells.chain(std::iter::once(name_of(&self.names, b)));
                    table.cells(&cells.collect::<Vec<_>>())?;
                }
            }
        }
        if let Rows::Binary(table) = &mut self.file {
            table.flush()?;
        }
        self.schedule.done(world.time());
        Ok(())
    }

    fn save(&self, out: Vec<u8>) -> Saved {
        let length = match &self.file {
            Rows::Text(table) => table.length(),
            Rows::Binary(table) => table.n_rows(),
        };
        postcard::to_extend(&(self.schedule, length), out)
    }

    fn sync(&mut self) -> Result<(), ObserveError> {
        match &self.file {
            Rows::Text(table) => table.sync()?,
            Rows::Binary(table) => table.sync()?,
        }
        Ok(())
    }

    fn read<'a>(&mut self, bytes: &'a [u8]) -> Result<&'a [u8], ObserveError> {
        let (schedule, length, rest);
        ((schedule, length), rest) = postcard::take_from_bytes(bytes)?;
        self.schedule.resume(schedule);
        match &mut self.file {
            Rows::Text(table) => table.cut(length)?,
            Rows::Binary(table) => table.cut(length)?,
        }
        Ok(rest)
    }
}
