//! `reactions.csv`: contact forces between two blocks or groups of blocks, after the last step before each row.

use std::path::Path;

use riprap_dda::{Contact, ContactState, Vec3};
use serde::{Deserialize, Serialize};

use super::{ObserveError, Observer, Schedule};
use crate::files::table::{Cell, Column, Start, Table};
use crate::output::run_folder;
use crate::saved::Saved;
use crate::scene::resolve::Scene;
use crate::scene::resolved::recording::Reaction;
use crate::world::World;

/// Largest values of a reaction among the rows of its table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LargestReaction {
    /// Name of the reaction.
    pub name: String,
    /// Largest sum of forces: its component along the direction if the scene gives one, else its magnitude; N.
    pub largest: Option<f64>,
    /// Its time; s.
    pub time: Option<f64>,
    /// Largest normal force of a single contact; N.
    pub largest_normal: Option<f64>,
    /// Its time; s.
    pub largest_normal_time: Option<f64>,
}

/// Writes a row per interval of `blocks.csv`.
#[derive(Debug)]
pub struct Reactions {
    schedule: Schedule,
    table: Table,
    sides: Vec<Sides>,
    extremes: Vec<Extremes>,
}

/// A reaction with its sides as flags, for any block in one look.
#[derive(Clone, Debug)]
struct Sides {
    name: String,
    /// For each block, whether it acts, and whether it is acted on.
    members: Vec<[bool; 2]>,
    direction: Option<Vec3>,
}

/// Contacts between two sides at a time.
#[derive(Clone, Copy, Debug, Default)]
struct Bearing {
    /// Of the first side on the second; N.
    sum: Vec3,
    n_contacts: usize,
    /// N.
    largest_normal: f64,
}

/// Largest values so far.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Extremes {
    sum: Option<Largest>,
    normal: Option<Largest>,
}

/// A value and its time, the first of equal ones; N, s.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Largest {
    value: f64,
    time: f64,
}

impl Largest {
    fn update(largest: &mut Option<Self>, value: f64, time: f64) {
        if largest.is_none_or(|largest| largest.value < value) {
            *largest = Some(Self { value, time });
        }
    }
}

impl Sides {
    fn of(reaction: &Reaction, n_blocks: usize) -> Self {
        let mut members = vec![[false; 2]; n_blocks];
        for (side, blocks) in reaction.between.iter().enumerate() {
            for &block in blocks {
                members[block][side] = true;
            }
        }
        Self {
            name: reaction.name.clone(),
            members,
            direction: reaction.direction,
        }
    }

    fn columns(&self) -> Vec<Column> {
        let along = self.direction.map(|_| ("along", "N"));
        let force = [("fx", "N"), ("fy", "N"), ("fz", "N")];
        let contacts = [("contacts", "-"), ("largest_normal", "N")];
        let all = force.into_iter().chain(along).chain(contacts);
        all.map(|(c, unit)| Column::new(format!("{}.{c}", self.name), unit))
            .collect()
    }

    /// Sum over the contacts that bear, each counted once.
    fn bearing(&self, contacts: &[Contact]) -> Bearing {
        let mut bearing = Bearing::default();
        for contact in contacts {
            let (i, j) = (contact.blocks.0.index(), contact.blocks.1.index());
            let on_second = contact.normal * contact.normal_force + contact.shear_force;
            let ways = [(i, j, on_second), (j, i, -on_second)];
            let ways = ways
                .into_iter()
                .filter(|&(by, on, _)| self.members[by][0] && self.members[on][1]);
            let (n_ways, sum) = ways.fold((0, Vec3::zeros()), |(n, sum), (_, _, force)| {
                (n + 1, sum + force)
            });
            if 0 < n_ways {
                bearing.sum += sum;
                bearing.n_contacts += 1;
                bearing.largest_normal = bearing.largest_normal.max(contact.normal_force);
            }
        }
        bearing
    }
}

impl Reactions {
    /// A table in `folder` with the columns of the scene's reactions.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] when the table cannot be created.
    pub fn new(folder: &Path, scene: &Scene, start: Start) -> Result<Self, ObserveError> {
        let reactions = scene.reactions.iter();
        let sides: Vec<Sides> = reactions
            .map(|reaction| Sides::of(reaction, scene.blocks.len()))
            .collect();
        let mut columns = vec![Column::new("time", "s")];
        columns.extend(sides.iter().flat_map(Sides::columns));
        Ok(Self {
            schedule: Schedule::every(scene.output.ledger_interval),
            table: Table::open(&folder.join(run_folder::REACTIONS), &columns, start)?,
            extremes: vec![Extremes::default(); sides.len()],
            sides,
        })
    }

    /// Largest values so far.
    pub fn largest(&self) -> Vec<LargestReaction> {
        let largest = |(sides, extremes): (&Sides, &Extremes)| LargestReaction {
            name: sides.name.clone(),
            largest: extremes.sum.map(|sum| sum.value),
            time: extremes.sum.map(|sum| sum.time),
            largest_normal: extremes.normal.map(|normal| normal.value),
            largest_normal_time: extremes.normal.map(|normal| normal.time),
        };
        let reactions = self.sides.iter().zip(&self.extremes);
        reactions.map(largest).collect()
    }
}

impl Observer for Reactions {
    fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    fn observe(&mut self, world: &World) -> Result<(), ObserveError> {
        let time = world.time();
        let mut contacts = world.blocks.contacts();
        contacts.retain(|contact| contact.state != ContactState::Open);
        let mut row = vec![Cell::Number(time)];
        for (sides, extremes) in self.sides.iter().zip(&mut self.extremes) {
            let bearing = sides.bearing(&contacts);
            let along = sides.direction.map(|along| along.dot(&bearing.sum));
            let force = bearing.sum.iter().copied().chain(along);
            row.extend(force.map(Cell::Number));
            row.push(Cell::Whole(bearing.n_contacts));
            row.push(Cell::Number(bearing.largest_normal));
            let sum = along.unwrap_or_else(|| bearing.sum.norm());
            Largest::update(&mut extremes.sum, sum, time);
            Largest::update(&mut extremes.normal, bearing.largest_normal, time);
        }
        self.table.cells(&row)?;
        self.schedule.done(time);
        Ok(())
    }

    fn save(&self, out: Vec<u8>) -> Saved {
        postcard::to_extend(&(self.schedule, self.table.length(), &self.extremes), out)
    }

    fn sync(&mut self) -> Result<(), ObserveError> {
        self.table.sync()?;
        Ok(())
    }

    fn read<'a>(&mut self, bytes: &'a [u8]) -> Result<&'a [u8], ObserveError> {
        let (schedule, length, rest);
        ((schedule, length, self.extremes), rest) = postcard::take_from_bytes(bytes)?;
        self.schedule.resume(schedule);
        self.table.cut(length)?;
        Ok(rest)
    }
}
