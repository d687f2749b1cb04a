//! Forces and moments on blocks by source: `forces.csv` with a row per block and interval, `contacts.csv` with a row
//! per block, partner and time.
//!
//! Forces are means over the interval, impulse over time, so that they include all events between two rows;
//! moments are about the centroid. They are followed by the rate of momentum gain of the block and its unexplained part,
//! which is round-off or an error of the program.

use serde::{Deserialize, Serialize};
use std::path::Path;

use riprap_dda::{Impulses, Load, Vec3};

use super::{ObserveError, Observer, Schedule, name_of};
use crate::files::table::{Cell, Column, Start, Table};
use crate::output::run_folder;
use crate::saved::Saved;
use crate::scene::resolved::recording::Tracking;
use crate::world::{FluidImpulses, World};

/// Sources of force in `forces.csv`.
const SOURCES: [&str; 8] = [
    "pressure",
    "shear",
    "joint_water",
    "pushed_back",
    "contact",
    "attached",
    "restrained",
    "gravity",
];

/// Place of the forces that hold a block.
const RESTRAINED: usize = 6;

/// Writes both tables.
#[derive(Debug)]
pub struct Forces {
    schedule: Schedule,
    forces: Table,
    contacts: Table,
    tracks: Vec<Track>,
    /// Name of each block.
    names: Vec<String>,
}

/// A block at its last row.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Track {
    block: usize,
    /// s.
    time: f64,
    momentum: Load,
    by_blocks: Impulses,
    by_fluid: FluidImpulses,
}

impl Track {
    fn of(block: usize, world: &World) -> Self {
        let blocks = &world.blocks;
        Self {
            block,
            time: world.time(),
            momentum: Load {
                force: blocks.velocity(block) * blocks.mass(block),
                torque: blocks.spin_momentum(block),
            },
            by_blocks: blocks.account(block).copied().unwrap_or_default(),
            by_fluid: world.fluid_impulses(block),
        }
    }

    /// Impulses since the last row, in the order of [`SOURCES`], and the momentum gained.
    fn since(&self, before: &Self) -> ([Load; 8], Load) {
        let (f, f0) = (&self.by_fluid, &before.by_fluid);
        let (b, b0) = (&self.by_blocks, &before.by_blocks);
        let gravity = |impulses: &Impulses| Load {
            force: impulses.gravity,
            torque: Vec3::zeros(),
        };
        let sources = [
            less(f.pressure, f0.pressure),
            less(f.shear, f0.shear),
            less(f.joint_water, f0.joint_water),
            less(f.pushed_back, f0.pushed_back),
            less(b.contact, b0.contact),
            less(b.attached, b0.attached),
            less(b.restrained, b0.restrained),
            less(gravity(b), gravity(b0)),
        ];
        (sources, less(self.momentum, before.momentum))
    }
}

fn less(a: Load, b: Load) -> Load {
    Load {
        force: a.force - b.force,
        torque: a.torque - b.torque,
    }
}

fn columns(names: impl Iterator<Item = String>) -> Vec<Column> {
    let mut columns = vec![Column::new("time", "s"), Column::new("block", "-")];
    for name in names {
        for axis in ["x", "y", "z"] {
            columns.push(Column::new(format!("{name}_f{axis}"), "N"));
        }
        for axis in ["x", "y", "z"] {
            columns.push(Column::new(format!("{name}_m{axis}"), "N m"));
        }
    }
    columns.push(Column::new("name", ""));
    columns
}

impl Forces {
    /// Tables in `folder` for blocks whose impulses the world records.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] when a table cannot be created.
    pub fn new(
        folder: &Path,
        (asked, block_names): (&Tracking, &[String]),
        world: &World,
        start: Start,
    ) -> Result<Self, ObserveError> {
        let names = SOURCES.iter().chain(&["gained", "residual"]);
        let mut of_contacts = columns(["contact".to_owned()].into_iter());
        of_contacts.insert(2, Column::new("partner", "-"));
        of_contacts.push(Column::new("partner_name", ""));
        Ok(Self {
            schedule: Schedule::every(asked.interval),
            forces: Table::open(
                &folder.join(run_folder::FORCES),
                &columns(names.map(|name| (*name).to_owned())),
                start,
            )?,
            contacts: Table::open(&folder.join(run_folder::CONTACTS), &of_contacts, start)?,
            tracks: asked.blocks.iter().map(|&b| Track::of(b, world)).collect(),
            names: block_names.to_vec(),
        })
    }

    fn write_contacts(&mut self, world: &World) -> Result<(), ObserveError> {
        let mut loads: Vec<((usize, usize), Load)> = Vec::new();
        for contact in world.blocks.contacts() {
            let on_second = contact.normal * contact.normal_force + contact.shear_force;
            let (i, j) = (contact.blocks.0.index(), contact.blocks.1.index());
            for (block, partner, force) in [(j, i, on_second), (i, j, -on_second)] {
                if !self.tracks.iter().any(|track| track.block == block) {
                    continue;
                }
                let key = (block, partner);
                let k = match loads.binary_search_by_key(&key, |(key, _)| *key) {
                    Ok(k) => k,
                    Err(k) => {
                        loads.insert(k, (key, Load::default()));
                        k
                    }
                };
                let arm = contact.point - world.blocks.centroid(block);
                loads[k].1.add(&force, &arm);
            }
        }
        for ((block, partner), load) in loads {
            if load == Load::default() {
                continue;
            }
            let mut row = vec![
                Cell::Number(world.time()),
                Cell::Whole(block),
                Cell::Whole(partner),
            ];
            let force = load.force.iter().chain(load.torque.iter());
            row.extend(force.copied().map(Cell::Number));
            row.extend([block, partner].map(|b| name_of(&self.names, b)));
            self.contacts.cells(&row)?;
        }
        Ok(())
    }
}

impl Observer for Forces {
    fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    fn observe(&mut self, world: &World) -> Result<(), ObserveError> {
        for track in &mut self.tracks {
            if world.blocks.is_removed(track.block) {
                continue;
            }
            let now = Track::of(track.block, world);
            let time = now.time - track.time;
            if 0.0 < time {
                let (mut sources, gained) = now.since(track);
                if !world.blocks.is_free(track.block) {
                    // whatever prescribes its motion bears the rest
                    sources[RESTRAINED] =
                        sources.iter().fold(gained, |rest, load| less(rest, *load));
                }
                let unexplained = sources.iter().fold(gained, |rest, load| less(rest, *load));
                let mut row = vec![Cell::Number(now.time), Cell::Whole(now.block)];
                for load in sources.iter().chain(&[gained, unexplained]) {
                    let mean = load.force.iter().chain(load.torque.iter());
                    row.extend(mean.map(|impulse| Cell::Number(impulse / time)));
                }
                row.push(name_of(&self.names, now.block));
                self.forces.cells(&row)?;
            }
            *track = now;
        }
        self.write_contacts(world)?;
        self.schedule.done(world.time());
        Ok(())
    }

    fn save(&self, out: Vec<u8>) -> Saved {
        let lengths = (self.forces.length(), self.contacts.length());
        postcard::to_extend(&(self.schedule, lengths, &self.tracks), out)
    }

    fn sync(&mut self) -> Result<(), ObserveError> {
        self.forces.sync()?;
        self.contacts.sync()?;
        Ok(())
    }

    fn read<'a>(&mut self, bytes: &'a [u8]) -> Result<&'a [u8], ObserveError> {
        let (schedule, forces, contacts, rest);
        ((schedule, (forces, contacts), self.tracks), rest) = postcard::take_from_bytes(bytes)?;
        self.schedule.resume(schedule);
        self.forces.cut(forces)?;
        self.contacts.cut(contacts)?;
        Ok(rest)
    }
}
