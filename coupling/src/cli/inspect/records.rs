//! Records of the blocks of a run: where they were, how fast, and under which forces.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::files::table::{TableData, read_npy, table_from};
use crate::messages::{Code, Message};
use crate::output::run_folder;

/// Sources of `forces.csv` that are water.
const WATER: [&str; 4] = ["pressure", "shear", "joint_water", "pushed_back"];

/// A block at a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct State {
    /// s.
    pub time: f64,
    /// m.
    pub place: [f64; 3],
    /// m/s.
    pub speed: f64,
    /// Of water; N.
    pub water: f64,
    /// Of contacts; N.
    pub contact: f64,
    pub is_asleep: bool,
}

/// Records of a run, also of one that is under way.
pub(super) struct Records {
    /// `blocks.csv`, and the rows of each block.
    blocks: Option<(TableData, Rows)>,
    /// `forces.csv`, likewise.
    forces: Option<(TableData, Rows)>,
}

type Rows = BTreeMap<usize, Vec<usize>>;

impl Records {
    pub(super) fn read(folder: &Path) -> Result<Self, Message> {
        let numbered = |name: &str| -> Result<Option<(TableData, Rows)>, Message> {
            let Some(table) = table_of(&folder.join(name))? else {
                return Ok(None);
            };
            let mut rows = Rows::new();
            let ids = table.column("block").map_err(Message::of)?;
            for (row, id) in ids.iter().enumerate() {
                rows.entry(*id as usize).or_default().push(row);
            }
            Ok(Some((table, rows)))
        };
        Ok(Self {
            blocks: numbered(run_folder::BLOCKS)?,
            forces: numbered(run_folder::FORCES)?,
        })
    }

    /// Blocks with records.
    pub(super) fn blocks(&self) -> impl Iterator<Item = usize> {
        let all = self.blocks.iter().flat_map(|(_, rows)| rows.keys());
        all.copied()
    }

    /// Last time of any block until a time; s.
    pub(super) fn last_time(&self, until: f64) -> Option<f64> {
        let (table, _) = self.blocks.as_ref()?;
        let times = table.column("time").ok()?.iter().copied();
        times.filter(|time| *time <= until).reduce(f64::max)
    }

    /// States of a block until a time, s.
    pub(super) fn states(&self, block: usize, until: f64) -> Vec<State> {
        let Some((table, rows)) = &self.blocks else {
            return Vec::new();
        };
        let number = |name: &str, row: usize| table.column(name).map_or(f64::NAN, |c| c[row]);
        let three = |names: [&str; 3], row: usize| names.map(|name| number(name, row));
        let state = |&row: &usize| State {
            time: number("time", row),
            place: three(["x", "y", "z"], row),
            speed: size(three(["vx", "vy", "vz"], row)),
            water: size(three(["fluid_fx", "fluid_fy", "fluid_fz"], row)),
            contact: size(three(["contact_fx", "contact_fy", "contact_fz"], row)),
            // runs of earlier versions have no such column
            is_asleep: number("asleep", row) == 1.0,
        };
        let own = rows.get(&block).into_iter().flatten().map(state);
        own.take_while(|state| state.time <= until).collect()
    }

    /// Largest force of water and of contacts on a block until a time (s), N: by the means of `forces.csv` where it has the block.
    pub(super) fn largest_forces(&self, block: usize, until: f64) -> [f64; 2] {
        if let Some((table, rows)) = &self.forces
            && let Some(rows) = rows.get(&block)
        {
            return [&WATER[..], &["contact"]].map(|sources| {
                let sizes = rows.iter().map(|&row| by_sources(table, sources, row));
                let times = table.column("time").unwrap_or_default();
                let timed = rows.iter().zip(sizes);
                let until_then = timed.filter(|(row, _)| times[**row] <= until);
                until_then.map(|(_, size)| size).fold(0.0, f64::max)
            });
        }
        let states = self.states(block, until);
        let largest = |of: fn(&State) -> f64| states.iter().map(of).fold(0.0, f64::max);
        [largest(|state| state.water), largest(|state| state.contact)]
    }
}

/// Size of the sum of the forces of some sources in a row; N.
fn by_sources(table: &TableData, sources: &[&str], row: usize) -> f64 {
    let along = |axis: &str| -> f64 {
        let values = sources.iter().filter_map(|source| {
            let column = table.column(&format!("{source}_f{axis}")).ok()?;
            Some(column[row])
        });
        values.sum()
    };
    size(["x", "y", "z"].map(along))
}

fn size(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// A table, if there is one; of a run under way up to the last line that is complete.
fn table_of(path: &Path) -> Result<Option<TableData>, Message> {
    if !path.exists() {
        let binary = path.with_extension("npy");
        let table = binary.exists().then(|| read_npy(&binary));
        return table.transpose().map_err(Message::of);
    }
    let text = fs::read_to_string(path).map_err(|error| {
        let what = format!("cannot read {}: {error}", path.display());
        Message::new(Code::FileNotReadable, what)
    })?;
    let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
    let table = table_from(path, whole).map_err(Message::of)?;
    Ok(Some(table))
}
