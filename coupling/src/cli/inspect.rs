//! `riprap inspect`.

use std::path::{Path, PathBuf};

use super::{Exit, failed, show};
use crate::files::table::{TableData, read_table};
use crate::messages::{Code, Message};
use crate::output::bodies::{self, BodyRow};
use crate::output::run_folder;

/// Blocks that are listed unless all are asked for: those that went farthest.
const LISTED: usize = 20;

/// Print who is who among the blocks of a run, where they are and how fast.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// A run folder, finished or running.
    run: PathBuf,
    /// Time in seconds, of which the last rows before it are shown; the latest when left out.
    #[arg(long, value_name = "T")]
    at: Option<f64>,
    /// All blocks, also the fixed ones.
    #[arg(long)]
    all: bool,
}

pub(crate) fn execute(arguments: &Arguments) -> Exit {
    match listed(arguments) {
        Ok(lines) => {
            show(&lines.join("\n"));
            Exit::Done
        }
        Err(message) => failed(message),
    }
}

/// Where a block is.
struct State {
    /// s.
    time: f64,
    /// m.
    place: [f64; 3],
    /// m/s.
    speed: f64,
}

/// A line of the list: block, way from its start (m), and where it is; `None` for fixed ones.
type Entry<'a> = (&'a BodyRow, f64, Option<State>);

fn listed(arguments: &Arguments) -> Result<Vec<String>, Message> {
    let folder = &arguments.run;
    let summary = run_folder::read_summary(folder).map_err(Message::of)?;
    let scene = run_folder::read_scene(folder).map_err(Message::of)?;
    let bodies =
        bodies::read(folder).map_err(|message| Message::new(Code::UnusableRunFolder, message))?;
    let records = records(folder)?;
    let mut all: Vec<Entry> = bodies
        .iter()
        .map(|body| {
            let state = records
                .as_ref()
                .and_then(|table| state(table, body.block, arguments.at));
            let start = [body.x, body.y, body.z];
            let way = state.as_ref().map_or(0.0, |state| {
                let square = |k: usize| (state.place[k] - start[k]).powi(2);
                (0..3).map(square).sum::<f64>().sqrt()
            });
            (body, way, state)
        })
        .filter(|(body, ..)| arguments.all || body.kind != "fixed")
        .collect();
    all.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.block.cmp(&b.0.block)));
    let n = all.len();
    if !arguments.all {
        all.truncate(LISTED);
    }
    let n_fixed = bodies.iter().filter(|body| body.kind == "fixed").count();
    let mut lines = vec![scene.title];
    let time = all
        .iter()
        .filter_map(|(.., state)| state.as_ref())
        .map(|state| state.time);
    lines.push(format!(
        "{} blocks, {n_fixed} of them fixed{}",
        bodies.len(),
        time.reduce(f64::max)
            .map_or_else(String::new, |time| format!("; at t = {time:.4} s"))
    ));
    let width = all
        .iter()
        .map(|(body, ..)| body.name.len())
        .max()
        .unwrap_or(0)
        .max(4);
    lines.push(format!(
        "{:>6}  {:width$}  {:10}  {:>10}  {:>9}  {:>9}  at x, y, z in m",
        "block", "name", "kind", "mass, kg", "way, m", "m/s"
    ));
    lines.extend(all.iter().map(|entry| line(entry, width)));
    if all.len() < n {
        lines.push(format!(
            "and {} more that went less far: --all",
            n - all.len()
        ));
    }
    if bodies.is_empty() {
        lines.push(format!(
            "{} has no bodies.csv: it is of an earlier version, or has no blocks",
            folder.display()
        ));
    }
    if let Some(verdict) = summary.as_ref().and_then(|s| s.get("verdict")?.as_array()) {
        lines.extend(
            verdict
                .iter()
                .filter_map(|line| Some(line.as_str()?.to_owned())),
        );
    }
    Ok(lines)
}

fn line((body, way, state): &Entry, width: usize) -> String {
    let start = [body.x, body.y, body.z];
    let place = state.as_ref().map_or(start, |state| state.place);
    let speed = state.as_ref().map_or(0.0, |state| state.speed);
    format!(
        "{:>6}  {:width$}  {:10}  {:>10.3e}  {way:>9.3}  {speed:>9.3}  {:.3}, {:.3}, {:.3}",
        body.block, body.name, body.kind, body.mass, place[0], place[1], place[2]
    )
}

/// The table of the blocks that can move, if there is one.
fn records(folder: &Path) -> Result<Option<TableData>, Message> {
    let path = folder.join(run_folder::BLOCKS);
    if !path.exists() {
        return Ok(None);
    }
    read_table(&path).map(Some).map_err(Message::of)
}

/// The last row of a block until a time (s).
fn state(table: &TableData, block: usize, until: Option<f64>) -> Option<State> {
    let column = |name: &str| table.column(name).ok();
    let (ids, time) = (column("block")?, column("time")?);
    let is_row = |&k: &usize| ids[k] == block as f64 && until.is_none_or(|until| time[k] <= until);
    let row = (0..ids.len()).rev().find(is_row)?;
    let three = |names: [&str; 3]| {
        let [x, y, z] = names.map(column);
        Some([x?[row], y?[row], z?[row]])
    };
    let velocity = three(["vx", "vy", "vz"])?;
    Some(State {
        time: time[row],
        place: three(["x", "y", "z"])?,
        speed: velocity.iter().map(|v| v * v).sum::<f64>().sqrt(),
    })
}
