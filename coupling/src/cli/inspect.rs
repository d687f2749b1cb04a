//! `riprap inspect`.

mod records;

use std::path::{Path, PathBuf};

use super::{Exit, failed, show};
use crate::messages::{Code, Message};
use crate::output::bodies::{self, BodyRow};
use crate::output::run_folder::{self, RunScene};
use crate::scene::parse::suggestion;
use records::{Records, State};

/// Blocks that are listed unless all are asked for: those that went farthest. Also rows of a history.
const LISTED: usize = 20;
/// Speed, over that of a fall by the size of the block, below which it is at rest.
const RESTS: f64 = 1e-3;

/// Print who is who among the blocks of a run, where they are and how fast.
///
/// A block rests when its speed is below a thousandth of √(g L), L the cube root of its volume; it is asleep when it is not
/// computed until its load changes. Forces are the largest so far: means by source where the scene has `forces`, or else those at the
/// times of blocks.csv.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// A run folder, finished or running, of any age.
    run: PathBuf,
    /// Time in seconds, of which the last rows before it are shown; the latest when left out.
    #[arg(long, value_name = "T")]
    at: Option<f64>,
    /// History of one block, by its name.
    #[arg(long, value_name = "NAME")]
    block: Option<String>,
    /// All blocks, also the fixed ones; all rows of a history.
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

/// A line of the list.
struct Entry<'a> {
    body: &'a BodyRow,
    /// From its start; m.
    way: f64,
    /// The last one; `None` for a fixed block.
    state: Option<State>,
    /// `moves`, `rests`, `asleep`, `fixed` or `left`.
    word: &'static str,
    /// Largest of water and of contacts; N.
    forces: [f64; 2],
}

fn listed(arguments: &Arguments) -> Result<Vec<String>, Message> {
    let folder = &arguments.run;
    let summary = run_folder::read_summary(folder).map_err(Message::of)?;
    let scene = run_folder::read_scene(folder).map_err(Message::of)?;
    let records = Records::read(folder)?;
    let bodies = bodies_of(folder, &scene, &records)?;
    let until = arguments.at.unwrap_or(f64::INFINITY);
    if let Some(name) = &arguments.block {
        return history(name, (&bodies, &scene, &records), (until, arguments.all));
    }
    let mut all: Vec<Entry> = bodies
        .iter()
        .map(|body| entry(body, &scene, &records, until))
        .filter(|entry| arguments.all || entry.body.kind != "fixed")
        .collect();
    all.sort_by(|a, b| {
        b.way
            .total_cmp(&a.way)
            .then(a.body.block.cmp(&b.body.block))
    });
    let n = all.len();
    if !arguments.all {
        all.truncate(LISTED);
    }
    let n_fixed = bodies.iter().filter(|body| body.kind == "fixed").count();
    let mut lines = vec![scene.title.clone()];
    lines.push(format!(
        "{} blocks, {n_fixed} of them fixed{}",
        bodies.len(),
        (records.last_time(until)).map_or_else(String::new, |time| format!("; at t = {time:.4} s"))
    ));
    lines.extend(table(&all));
    if all.len() < n {
        lines.push(format!(
            "and {} more that went less far: --all",
            n - all.len()
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

/// The blocks of a run; of one without `bodies.csv`, as of earlier versions, by the scene and by their first records.
fn bodies_of(folder: &Path, scene: &RunScene, records: &Records) -> Result<Vec<BodyRow>, Message> {
    let found = bodies::read(folder).map_err(|what| Message::new(Code::UnusableRunFolder, what))?;
    if !found.is_empty() {
        return Ok(found);
    }
    let movers: Vec<usize> = records.blocks().collect();
    let named = scene.block_names.iter().enumerate();
    Ok(named
        .map(|(block, name)| {
            let first = records.states(block, f64::INFINITY).first().copied();
            let [x, y, z] = first.map_or([f64::NAN; 3], |state| state.place);
            BodyRow {
                block,
                name: name.clone(),
                kind: if movers.contains(&block) {
                    "moving"
                } else {
                    "fixed"
                }
                .to_owned(),
                mass: f64::NAN,
                volume: f64::NAN,
                x,
                y,
                z,
                group: String::new(),
                material: scene.materials.get(block).cloned().unwrap_or_default(),
                joint_sets: String::new(),
            }
        })
        .collect())
}

fn entry<'a>(body: &'a BodyRow, scene: &RunScene, records: &Records, until: f64) -> Entry<'a> {
    let state = records.states(body.block, until).last().copied();
    let start = [body.x, body.y, body.z];
    let way = state.as_ref().map_or(0.0, |state| {
        let square = |k: usize| (state.place[k] - start[k]).powi(2);
        (0..3).map(square).sum::<f64>().sqrt()
    });
    let has_left = state.is_some_and(|state| records.last_time(until) > Some(state.time));
    Entry {
        body,
        way,
        state,
        word: match &state {
            None => "fixed",
            Some(_) if has_left => "left",
            Some(state) => word(state, body, scene),
        },
        forces: records.largest_forces(body.block, until),
    }
}

/// State of motion of a block.
fn word(state: &State, body: &BodyRow, scene: &RunScene) -> &'static str {
    // the size of a block of an earlier version is not known
    let size = if body.volume.is_finite() {
        body.volume.cbrt()
    } else {
        1.0
    };
    match state.speed <= RESTS * (scene.gravity * size).sqrt() {
        _ if state.is_asleep => "asleep",
        true => "rests",
        false => "moves",
    }
}

/// The list in columns as wide as their cells.
fn table(entries: &[Entry]) -> Vec<String> {
    let widest = |title: &str, of: &dyn Fn(&BodyRow) -> usize| {
        let cells = entries.iter().map(|entry| of(entry.body));
        cells.chain([title.len()]).max().unwrap_or(0)
    };
    let name = widest("name", &|body| body.name.chars().count());
    let group = widest("group", &|body| body.group.chars().count());
    let material = widest("material", &|body| body.material.chars().count());
    let mut lines = vec![format!(
        "{:>6}  {:name$}  {:group$}  {:material$}  {:10}  {:6}  {:>10}  {:>9}  {:>9}  {:>10}  {:>10}  at x, y, z in m",
        "block",
        "name",
        "group",
        "material",
        "kind",
        "state",
        "mass, kg",
        "way, m",
        "m/s",
        "water, N",
        "contact, N"
    )];
    lines.extend(entries.iter().map(|entry| {
        let body = entry.body;
        let place = (entry.state.as_ref()).map_or([body.x, body.y, body.z], |state| state.place);
        format!(
            "{:>6}  {:name$}  {:group$}  {:material$}  {:10}  {:6}  {:>10.3e}  {:>9.3}  {:>9.3}  {:>10.3e}  {:>10.3e}  {:.3}, {:.3}, {:.3}",
            body.block,
            body.name,
            body.group,
            body.material,
            body.kind,
            entry.word,
            body.mass,
            entry.way,
            entry.state.as_ref().map_or(0.0, |state| state.speed),
            entry.forces[0],
            entry.forces[1],
            place[0],
            place[1],
            place[2]
        )
    }));
    lines
}

/// States of one block over time: some of them, first and last included, or all.
fn history(
    name: &str,
    (bodies, scene, records): (&[BodyRow], &RunScene, &Records),
    (until, is_whole): (f64, bool),
) -> Result<Vec<String>, Message> {
    let Some(body) = bodies.iter().find(|body| body.name == name) else {
        let names: Vec<&str> = bodies.iter().map(|body| body.name.as_str()).collect();
        let what = format!("there is no block `{name}`{}", suggestion(name, &names));
        return Err(Message::new(Code::UnknownName, what));
    };
    let about = [
        ("group", &body.group),
        ("material", &body.material),
        ("joint sets", &body.joint_sets),
    ];
    let known = about.iter().filter(|(_, text)| !text.is_empty());
    let known: Vec<String> = known
        .map(|(what, text)| format!("; {what} {text}"))
        .collect();
    let mut lines = vec![format!(
        "block {} `{name}`, {}: {:.3e} kg, {:.3e} m3{}",
        body.block,
        body.kind,
        body.mass,
        body.volume,
        known.concat()
    )];
    let states = records.states(body.block, until);
    if states.is_empty() {
        lines.push("it does not move, and has no records".to_owned());
        return Ok(lines);
    }
    lines.push(format!(
        "{:>10}  {:>10}  {:>10}  {:>10}  {:>9}  {:6}  {:>10}  {:>10}",
        "t, s", "x, m", "y, m", "z, m", "m/s", "state", "water, N", "contact, N"
    ));
    let n = states.len();
    let is_shown = |k: &usize| is_whole || n <= LISTED || (k * (LISTED - 1)) % (n - 1) < LISTED - 1;
    for state in (0..n).filter(is_shown).map(|k| &states[k]) {
        let [x, y, z] = state.place;
        lines.push(format!(
            "{:>10.4}  {x:>10.3}  {y:>10.3}  {z:>10.3}  {:>9.3}  {:6}  {:>10.3e}  {:>10.3e}",
            state.time,
            state.speed,
            word(state, body, scene),
            state.water,
            state.contact
        ));
    }
    if !is_whole && LISTED < n {
        lines.push(format!("some of {n} rows: --all"));
    }
    Ok(lines)
}
