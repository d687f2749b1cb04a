//! The words and numbers of a report: records of gauges, events, and tables of peaks, blocks and the ledger.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::{Value, json};

use super::forces;
use super::table::{Table, figure, heads, name_of, scaled, table_of};
use crate::files::table::TableData;
use crate::output::run_folder::{self, RunScene};
use crate::picture::overview_data::theory::Theories;

/// Points of a record, at most.
const MOST_POINTS: usize = 600;
/// Events that are told, at most.
const MOST_EVENTS: usize = 24;
/// Blocks in the table, at most: those that went farthest.
const MOST_BLOCKS: usize = 30;
/// Force of water on a block, over the largest one of the run, that counts as the first touch.
const TOUCH: f64 = 0.01;

/// Text of a field of the summary; empty without.
fn text_of(value: &Value, key: &str) -> String {
    let text = value.get(key).and_then(Value::as_str);
    text.unwrap_or_default().to_owned()
}

/// Number for the page: five digits, none if it is not finite.
fn short(value: f64) -> Value {
    match value.is_finite() {
        true => format!("{value:.4e}")
            .parse::<f64>()
            .map_or(Value::Null, |value| json!(value)),
        false => Value::Null,
    }
}

/// Records of all gauges: name, unit, times, values and their theory, thinned so that lows and highs stay.
pub(super) fn gauges(folder: &Path, theories: &Theories) -> Vec<Value> {
    let Some(table) = table_of(folder, run_folder::GAUGES) else {
        return Vec::new();
    };
    let time = &table.values[0];
    let columns = table.columns.iter().zip(&table.values).skip(1);
    columns
        .map(|(column, values)| {
            let kept = thinned(values);
            let times: Vec<f64> = kept.iter().map(|&k| time[k]).collect();
            let mut gauge = json!({
                "name": column.name, "unit": column.unit,
                "t": times.iter().map(|&t| short(t)).collect::<Vec<_>>(),
                "v": kept.iter().map(|&k| short(values[k])).collect::<Vec<_>>(),
            });
            if let Some(theory) = theories.of(&column.name) {
                gauge["theory"] = theory.at(&times).into_iter().map(short).collect();
            }
            gauge
        })
        .collect()
}

/// Places of a record's lowest and highest values in each of its pieces, and of its ends.
fn thinned(values: &[f64]) -> Vec<usize> {
    if values.len() <= MOST_POINTS {
        return (0..values.len()).collect();
    }
    let piece = values.len().div_ceil(MOST_POINTS / 2);
    let mut kept = vec![0];
    for start in (0..values.len()).step_by(piece) {
        let places = || start..values.len().min(start + piece);
        let finite = || places().filter(|&k| values[k].is_finite());
        let order = |a: &usize, b: &usize| values[*a].total_cmp(&values[*b]);
        match (finite().min_by(order), finite().max_by(order)) {
            (Some(low), Some(high)) => kept.extend([low, high]),
            _ => kept.push(start),
        }
    }
    kept.push(values.len() - 1);
    kept.sort_unstable();
    kept.dedup();
    kept
}

/// What happened when: touches of water, arrivals and crests at gauges, in order.
pub(super) fn events(folder: &Path, summary: &Value, scene: &RunScene) -> Vec<Value> {
    let mut events: Vec<(f64, String)> = Vec::new();
    let gauges = summary.get("gauges").and_then(Value::as_array);
    for gauge in gauges.into_iter().flatten() {
        let name = gauge.get("name").and_then(Value::as_str).unwrap_or("gauge");
        let time = |key: &str| gauge.get(key).and_then(Value::as_f64);
        if let Some(at) = time("arrival") {
            events.push((at, format!("wave at {name}")));
        }
        let is_wave =
            gauge.get("unit").and_then(Value::as_str) == Some("m") && time("arrival").is_some();
        if let Some(at) = time("time").filter(|_| is_wave) {
            events.push((at, format!("crest at {name}")));
        }
    }
    let blocks = table_of(folder, run_folder::BLOCKS);
    // the blocks of a group are told of together
    let mut touches = BTreeMap::<String, f64>::new();
    for block in blocks.iter().flat_map(histories) {
        let largest = block.forces.iter().copied().fold(0.0, f64::max);
        let start = block.forces.first().copied().unwrap_or(0.0);
        let touch = block
            .forces
            .iter()
            .position(|&force| TOUCH * largest < force);
        // what stands in water from the start is not touched by it later
        if let (Some(k), true) = (touch, start <= TOUCH * largest && 0.0 < largest) {
            let first = touches
                .entry(group_of(scene, block.id))
                .or_insert(f64::INFINITY);
            *first = first.min(block.time[k]);
        }
    }
    events.extend((touches.into_iter()).map(|(name, at)| (at, format!("{name} meets water"))));
    events.sort_by(|a, b| a.0.total_cmp(&b.0));
    events.truncate(MOST_EVENTS);
    let told = events.into_iter();
    told.map(|(t, name)| json!({"t": short(t), "name": name}))
        .collect()
}

/// Group of a block by its number, or its name without one; of a run of an earlier version what its name begins with.
fn group_of(scene: &RunScene, id: i32) -> String {
    let group = usize::try_from(id).ok().and_then(|id| scene.groups.get(id));
    match group.filter(|group| !group.is_empty()) {
        Some(group) => group.clone(),
        None => {
            let name = name_of(&scene.block_names, id);
            let begin = name.rsplit_once('.').map(|(begin, _)| begin.to_owned());
            begin.unwrap_or(name)
        }
    }
}

/// Record of a block.
struct History {
    id: i32,
    time: Vec<f64>,
    places: Vec<[f64; 3]>,
    speeds: Vec<f64>,
    /// Of water; N.
    forces: Vec<f64>,
}

/// The records in `blocks.csv`, block after block.
fn histories(table: &TableData) -> Vec<History> {
    let all = |names: [&str; 3]| -> Option<[&[f64]; 3]> {
        let [x, y, z] = names.map(|name| table.column(name).ok());
        Some([x?, y?, z?])
    };
    let (Ok(ids), Ok(time)) = (table.column("block"), table.column("time")) else {
        return Vec::new();
    };
    let (Some(x), Some(v), Some(f)) = (
        all(["x", "y", "z"]),
        all(["vx", "vy", "vz"]),
        all(["fluid_fx", "fluid_fy", "fluid_fz"]),
    ) else {
        return Vec::new();
    };
    let size = |of: [&[f64]; 3], k: usize| of.iter().map(|c| c[k] * c[k]).sum::<f64>().sqrt();
    let mut found = BTreeMap::<i32, History>::new();
    for k in 0..ids.len() {
        let id = ids[k] as i32;
        let history = found.entry(id).or_insert_with(|| History {
            id,
            time: Vec::new(),
            places: Vec::new(),
            speeds: Vec::new(),
            forces: Vec::new(),
        });
        history.time.push(time[k]);
        history.places.push([x[0][k], x[1][k], x[2][k]]);
        history.speeds.push(size(v, k));
        history.forces.push(size(f, k));
    }
    found.into_values().collect()
}

/// Largest value, and its place.
fn largest(values: &[f64]) -> Option<(usize, f64)> {
    let all = values
        .iter()
        .copied()
        .enumerate()
        .filter(|(_, value)| value.is_finite());
    all.reduce(|most, one| if most.1 < one.1 { one } else { most })
}

/// Tables of a run.
pub(super) fn tables(folder: &Path, summary: &Value, scene: &RunScene) -> Vec<Table> {
    let names = &scene.block_names;
    let all = [
        peaks(summary),
        forces::by_source(folder, names),
        forces::on_faces(folder, scene),
        blocks(folder, names),
        ledger(summary),
        numbers(summary),
    ];
    all.into_iter()
        .flatten()
        .filter(|table| !table.rows.is_empty())
        .collect()
}

fn peaks(summary: &Value) -> Option<Table> {
    let gauges = summary.get("gauges")?.as_array()?;
    let row = |gauge: &Value| {
        let number = |key: &str| gauge.get(key).and_then(Value::as_f64);
        let text = |key: &str| text_of(gauge, key);
        let told = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), figure);
        vec![
            text("name"),
            text("unit"),
            told(number("start")),
            told(number("largest")),
            told(number("time")),
            told(number("arrival")),
        ]
    };
    Some(Table {
        title: "Peaks at gauges",
        head: heads(&[
            "gauge",
            "unit",
            "at the start",
            "largest",
            "at, s",
            "wave arrives, s",
        ]),
        rows: gauges.iter().map(row).collect(),
        note: String::new(),
    })
}

fn blocks(folder: &Path, names: &[String]) -> Option<Table> {
    let table = table_of(folder, run_folder::BLOCKS)?;
    let mut all: Vec<(f64, History)> = (histories(&table).into_iter())
        .filter_map(|history| {
            let (from, to) = (history.places.first()?, history.places.last()?);
            let travel = (0..3)
                .map(|k| (to[k] - from[k]).powi(2))
                .sum::<f64>()
                .sqrt();
            Some((travel, history))
        })
        .collect();
    all.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.id.cmp(&b.1.id)));
    let n = all.len();
    all.truncate(MOST_BLOCKS);
    let forces = all.iter().flat_map(|(_, history)| &history.forces);
    let newton = scaled(forces.copied(), "N");
    let row = |(travel, history): &(f64, History)| {
        let speed = largest(&history.speeds).unwrap_or_default();
        let force = largest(&history.forces).unwrap_or_default();
        let at = |(k, _): (usize, f64)| history.time.get(k).copied().unwrap_or(f64::NAN);
        let place = history.places.last().copied().unwrap_or_default();
        vec![
            name_of(names, history.id),
            figure(*travel),
            figure(speed.1),
            figure(at(speed)),
            figure(force.1 / newton.0),
            figure(at(force)),
            place.map(figure).join(", "),
        ]
    };
    Some(Table {
        title: "Blocks",
        head: heads(&[
            "block",
            "from start to end, m",
            "largest speed, m/s",
            "at, s",
            &format!("largest force of water, {}", newton.1),
            "at, s",
            "in the end at, m",
        ]),
        rows: all.iter().map(row).collect(),
        note: match MOST_BLOCKS < n {
            true => format!(
                "The {MOST_BLOCKS} of {n} blocks that went farthest; all are in blocks.csv."
            ),
            false => String::new(),
        },
    })
}

/// Terms of the energy ledger, as a reader calls them.
const TERMS: [(&str, &str); 26] = [
    ("kinetic", "kinetic"),
    ("potential", "potential, from the lower side of the domain"),
    ("elastic", "in contacts"),
    ("strain", "strain of blocks"),
    ("internal", "compression of water"),
    (
        "external_work",
        "work done by prescribed motions and forces",
    ),
    ("friction", "friction of blocks"),
    ("plastic", "yield and breakage in contacts"),
    ("damping", "damping of contacts"),
    ("strain_damping", "damping of strain"),
    ("static_damping", "static damping"),
    ("viscous", "viscosity of water"),
    ("bulk", "bulk viscosity"),
    ("drag", "drag of grains in water"),
    ("diffusive", "diffusion of density"),
    ("absorbed", "absorbing layers"),
    ("pushed_back", "particles put back at walls"),
    ("removed", "what left the domain"),
    ("sleep_loss", "put to sleep"),
    ("overlap_removal", "removal of overlap of blocks"),
    (
        "joint_correction",
        "exact joints as they restore their places",
    ),
    ("joint_water", "water in joints"),
    ("through_openings", "through inflows and outflows"),
    ("at_walls", "introduced at walls by the discretization"),
    ("at_grains", "introduced at grains by their averages"),
    ("residual", "unexplained"),
];

fn ledger(summary: &Value) -> Option<Table> {
    let energy = summary.get("energy")?;
    let value = |key: &str| energy.get(key).and_then(Value::as_f64);
    let joule = scaled(
        TERMS.iter().filter_map(|(key, _)| value(key).map(f64::abs)),
        "J",
    );
    let row = |(key, words): &(&str, &str)| {
        let value = value(key)?;
        (value != 0.0).then(|| vec![(*words).to_owned(), figure(value / joule.0)])
    };
    Some(Table {
        title: "Energy at the end",
        head: heads(&["term", &joule.1]),
        rows: TERMS.iter().filter_map(row).collect(),
        note: String::new(),
    })
}

fn numbers(summary: &Value) -> Option<Table> {
    let number = |key: &str| summary.get(key).and_then(Value::as_f64).unwrap_or(0.0);
    let text = |key: &str| text_of(summary, key);
    summary.as_object()?;
    let row = |name: &str, value: String| vec![name.to_owned(), value];
    let mut rows = vec![
        row(
            "riprap",
            format!("{} ({})", text("version"), text("commit")),
        ),
        row("simulated, s", figure(number("simulated_time"))),
        row(
            "computed in, s",
            format!(
                "{} on {} threads",
                figure(number("wall_time")),
                number("threads")
            ),
        ),
        row("steps", format!("{}", number("steps"))),
        row("state hash", text("state_hash")),
    ];
    if 0.0 < number("fluid_particles") {
        rows.insert(
            1,
            row(
                "particles",
                format!(
                    "{} at {} m",
                    number("fluid_particles"),
                    figure(number("particle_spacing"))
                ),
            ),
        );
        rows.push(row(
            "momentum residual",
            format!("{:.1e}", number("momentum_residual")),
        ));
    }
    Some(Table {
        title: "The run",
        head: heads(&["", ""]),
        rows,
        note: String::new(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thinned_record_keeps_its_peaks() {
        let mut values: Vec<f64> = (0..10_000).map(|k| (f64::from(k) * 0.01).sin()).collect();
        values[5003] = 7.0;
        values[7001] = f64::NAN;
        let kept = thinned(&values);
        assert!(kept.len() <= MOST_POINTS + 2, "{}", kept.len());
        assert!(kept.contains(&5003) && kept.contains(&0) && kept.contains(&9999));
    }
}
