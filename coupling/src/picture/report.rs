//! A report of a run: one HTML file that plays it, without a network, made from the run folder alone.
//!
//! ```text
//! RUN/case.ron, *.vtp ─render::recording→ water, shapes ─packed→ blocks of text ┐
//!     *.csv, summary.json ─story→ gauges, events, tables                         ├ page → report.html
//!     overview.svg, viewer.js, viewer.css ───────────────────────────────────────┘
//! ```
//!
//! Particles are shown one by one in a plane and in small scenes, otherwise the height of their surface. If that is more than the file
//! may have, frames are left out, and the page says so.

mod forces;
mod maps;
mod packed;
mod page;
mod shapes;
mod story;
mod table;
mod water;

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Map, Value, json};

use super::color::{self, ColorMap};
use super::overview_data::theory::Theories;
use super::render::RenderError;
use super::render::recording::{self, Recording};
use crate::files::vtk::{VtkError, replace_file};
use crate::output::run_folder;
use crate::output::verdict::verdict;
use packed::{Frames, Range, in_base64};
use shapes::PackedMesh;
use water::{Look, Water};

/// Frames are left out until a file has its size, but no more than all but every sixteenth.
const LARGEST_STRIDE: usize = 16;
/// Colors of speeds, between which the page interpolates.
const N_SPEEDS: usize = 9;
/// Base64 has four characters for three bytes.
const BASE64: f64 = 4.0 / 3.0;

/// Outcome of a report.
#[derive(Clone, Debug, PartialEq)]
pub struct ReportSummary {
    /// The file.
    pub path: PathBuf,
    /// Its size; bytes.
    pub size: u64,
    /// What it shows of the water and the blocks.
    pub description: String,
}

/// A named block of text in the page.
struct Blob {
    id: &'static str,
    text: String,
}

/// What a page plays, as far as it is put together.
#[derive(Default)]
struct Played {
    /// For the script, by name.
    meta: Map<String, Value>,
    blobs: Vec<Blob>,
    /// What is shown.
    said: Vec<String>,
}

impl Played {
    fn tell(&mut self, name: &str, value: Value) {
        self.meta.insert(name.to_owned(), value);
    }

    fn add_blob(&mut self, id: &'static str, bytes: &[u8]) {
        let text = in_base64(bytes);
        self.blobs.push(Blob { id, text });
    }

    fn add_fixed(&mut self, run: &Recording) {
        let fixed = shapes::fixed(run).packed();
        if 0 < fixed.n_triangles {
            let mut told = mesh_of(&fixed);
            told["walls"] = json!(run.fixed.iter().any(|body| !body.is_terrain));
            self.tell("fixed", told);
            self.add_blob("fixed", &fixed.bytes);
        }
    }

    fn add_moving(&mut self, run: &Recording) -> Result<(), RenderError> {
        let Some(moving) = shapes::moving(run)? else {
            return Ok(());
        };
        let mesh = moving.mesh.packed();
        let name = |&id: &i32| table::name_of(&run.scene.block_names, id);
        let names: Vec<String> = moving.ids.iter().map(name).collect();
        self.tell(
            "blocks",
            json!({
                "ids": moving.ids, "names": names, "times": moving.times,
                "lo": moving.ranges.map(|range| range.lo), "step": moving.ranges.map(Range::quantum),
                "mesh": mesh_of(&mesh), "checksum": checksum(&moving.poses, 1),
            }),
        );
        let blocks = if names.len() == 1 { "block" } else { "blocks" };
        self.said.push(format!(
            "{} moving {blocks} in {} frames",
            names.len(),
            moving.times.len()
        ));
        self.add_blob("shapes", &mesh.bytes);
        self.add_blob("poses", &moving.poses.packed(1));
        Ok(())
    }

    /// Adds the water in what `limit` bytes leave of room.
    fn add_water(&mut self, water: &Water, run: &Recording, limit: u64) {
        let taken: usize = self.blobs.iter().map(|blob| blob.text.len()).sum();
        let room = limit.saturating_sub(taken as u64);
        let (stride, bytes) = within(&water.frames, room as f64 / BASE64);
        self.tell("water", water_of(water, run, stride));
        self.said.insert(0, described(water, stride));
        self.add_blob("water", &bytes);
    }
}

/// Writes the report of a run folder to a file of about `limit` bytes at most, the shapes of very large scenes aside.
///
/// # Errors
///
/// [`RenderError`] if the frames of the run cannot be read, or the file not be written. Tables that are missing are left out.
pub fn report(folder: &Path, file: &Path, limit: u64) -> Result<ReportSummary, RenderError> {
    report_in(folder, file, limit, ColorMap::default())
}

/// Writes a report as [`report`] does, with the colors of a map for speeds and for what the maps show.
///
/// # Errors
///
/// As [`report`].
pub fn report_in(
    folder: &Path,
    file: &Path,
    limit: u64,
    color_map: ColorMap,
) -> Result<ReportSummary, RenderError> {
    let run = recording::open(folder)?;
    // a report can be made while the run is under way
    let summary = run_folder::read_summary(folder)?.unwrap_or(Value::Null);
    let overview = fs::read_to_string(folder.join(run_folder::OVERVIEW)).unwrap_or_default();
    let scene = fs::read_to_string(folder.join(run_folder::CASE)).unwrap_or_default();
    let end = run.end();
    let maps = maps::maps(folder, run.scene.map.0.2, (limit, color_map));
    let water = water::water(&run)?;

    let mut played = Played::default();
    played.tell("title", json!(run.scene.title));
    played.tell("duration", json!(end.max(1e-9)));
    played.tell("isThin", json!(run.scene.is_thin));
    played.tell("colors", colors(color_map));
    played.tell("bounds", bounds(&run, water.as_ref())?);
    played.tell("relief", relief(&run, water.as_ref()));
    played.tell(
        "gauges",
        json!(story::gauges(folder, &Theories::of_folder(folder))),
    );
    played.tell("events", json!(story::events(folder, &summary, &run.scene)));
    played.add_fixed(&run);
    played.add_moving(&run)?;
    if let Some(water) = &water {
        let text = (overview.len() + scene.len() + maps.html.len()) as u64;
        played.add_water(water, &run, limit.saturating_sub(text));
    }

    played
        .said
        .extend(Some(maps.said).filter(|said| !said.is_empty()));
    let description = played.said.join(", ");
    let text = page::page(&page::Contents {
        title: &run.scene.title,
        verdict: summary.is_object().then(|| verdict(&summary)),
        description: &description,
        tables: &story::tables(folder, &summary, &run.scene),
        maps: &maps.html,
        overview: &overview,
        scene: &scene,
        meta: &Value::Object(played.meta),
        blobs: &played.blobs,
    });
    write_whole(file, &text)?;
    Ok(ReportSummary {
        path: file.to_owned(),
        size: text.len() as u64,
        description,
    })
}

/// Writes a file whole or not at all.
fn write_whole(file: &Path, text: &str) -> Result<(), RenderError> {
    replace_file(file, &[text.as_bytes()]).map_err(|error| match error {
        VtkError::Io { cause: source, .. } => RenderError::Write {
            path: file.to_owned(),
            source,
        },
        other => RenderError::BadFile {
            path: file.to_owned(),
            reason: other.to_string(),
        },
    })
}

fn mesh_of(mesh: &PackedMesh) -> Value {
    json!({
        "corners": mesh.n_corners, "triangles": mesh.n_triangles,
        "lo": mesh.range.lo, "step": mesh.range.quantum(),
    })
}

/// Colors of water by speed and by elevation, of land and of the background, from 0 to 1.
fn colors(color_map: ColorMap) -> Value {
    let share = |color: &[u8; 3]| color.map(|part| (f64::from(part) / 255.0 * 1e3).round() / 1e3);
    let all = |colors: &[[u8; 3]]| colors.iter().map(share).collect::<Vec<_>>();
    let elevation = color::elevation(3);
    let trough: Vec<[u8; 3]> = elevation[..4].iter().rev().copied().collect();
    json!({
        "speed": all(&color_map.speeds(N_SPEEDS)), "trough": all(&trough), "crest": all(&elevation[3..]),
        "land": all(&color::land(5)), "bed": share(&color::BED), "background": [0.945, 0.957, 0.965],
    })
}

/// Heights between which the colors of land go, from the shore up, or from the lowest ground; null without terrain; m.
fn relief(run: &Recording, water: Option<&Water>) -> Value {
    let terrain = run.fixed.iter().filter(|body| body.is_terrain);
    let heights = terrain.flat_map(|body| body.corners.iter().map(|corner| corner[2]));
    let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| {
        (low.min(z), high.max(z))
    });
    if low >= high {
        return Value::Null;
    }
    let rest = water.and_then(|water| match water.look {
        Look::Surface { height, .. } => Some(water.swing(height).0),
        Look::Particles { .. } => None,
    });
    json!([rest.unwrap_or(low).min(high - 1e-6 * (high - low)), high])
}

/// The smallest stride at which the frames have at most `room` bytes, or the largest one, with their bytes.
fn within(frames: &Frames, room: f64) -> (usize, Vec<u8>) {
    let mut stride = 1;
    loop {
        let bytes = frames.packed(stride);
        if bytes.len() as f64 <= room || LARGEST_STRIDE <= stride {
            return (stride, bytes);
        }
        stride *= 2;
    }
}

/// Sum over all codes, by which the page knows that it has read them.
fn checksum(frames: &Frames, stride: usize) -> u32 {
    let codes = frames.codes.iter().step_by(stride).flatten();
    codes.fold(0_u32, |sum, &code| {
        sum.wrapping_mul(31).wrapping_add(u32::from(code))
    })
}

fn water_of(water: &Water, run: &Recording, stride: usize) -> Value {
    let times: Vec<f64> = water.times.iter().step_by(stride).copied().collect();
    let mut value = json!({
        "items": water.frames.n_items, "times": times, "fastest": water.largest_speed,
        "spacing": run.spacing.unwrap_or(0.0), "checksum": checksum(&water.frames, stride),
    });
    let more = match &water.look {
        Look::Particles { ranges } => {
            let axes: &[&str] = if ranges.len() == 2 {
                &["x", "z"]
            } else {
                &["x", "y", "z"]
            };
            json!({
                "kind": "particles", "axes": axes, "absent": ranges[0].absent(),
                "lo": ranges.iter().map(|r| r.lo).collect::<Vec<_>>(),
                "step": ranges.iter().map(|r| r.quantum()).collect::<Vec<_>>(),
            })
        }
        Look::Surface {
            corner,
            cell,
            size,
            height,
        } => {
            let (rest, swing) = water.swing(*height);
            json!({
                "kind": "surface", "axes": ["z"], "absent": height.absent(), "corner": corner, "cell": cell, "size": size,
                "lo": [height.lo], "step": [height.quantum()], "rest": rest, "swing": swing,
            })
        }
    };
    if let (Some(value), Value::Object(more)) = (value.as_object_mut(), more) {
        value.extend(more);
    }
    value
}

fn described(water: &Water, stride: usize) -> String {
    let n_frames = water.times.len().div_ceil(stride);
    let left_out = match stride {
        1 => String::new(),
        stride => format!(
            " (every {stride}. of {}, for the size of this file)",
            water.times.len()
        ),
    };
    match &water.look {
        Look::Particles { .. } => format!(
            "{} particles in {n_frames} frames{left_out}",
            water.frames.n_items
        ),
        Look::Surface { cell, size, .. } => format!(
            "the water's surface on {} by {} cells of {cell:.3} m in {n_frames} frames{left_out}",
            size[0], size[1]
        ),
    }
}

/// Corners of a box around water and moving blocks over the whole run, or of the domain without both; m.
fn bounds(run: &Recording, water: Option<&Water>) -> Result<Value, RenderError> {
    let mut lo = [f64::INFINITY; 3];
    let mut hi = [f64::NEG_INFINITY; 3];
    let mut add = |x: [f64; 3]| {
        for k in 0..3 {
            if x[k].is_finite() {
                (lo[k], hi[k]) = (lo[k].min(x[k]), hi[k].max(x[k]));
            }
        }
    };
    let (min, max) = run.scene.domain;
    match water.map(|water| &water.look) {
        Some(Look::Particles { ranges }) if ranges.len() == 2 => {
            add([f64::from(ranges[0].lo), min.y, f64::from(ranges[1].lo)]);
            add([f64::from(ranges[0].hi), max.y, f64::from(ranges[1].hi)]);
        }
        Some(Look::Particles { ranges }) => {
            add([0, 1, 2].map(|k| f64::from(ranges[k].lo)));
            add([0, 1, 2].map(|k| f64::from(ranges[k].hi)));
        }
        Some(Look::Surface {
            corner,
            cell,
            size,
            height,
        }) => {
            let far = [0, 1].map(|k| f64::from(corner[k] + cell * size[k] as f32));
            add([
                f64::from(corner[0]),
                f64::from(corner[1]),
                f64::from(height.lo),
            ]);
            add([far[0], far[1], f64::from(height.hi)]);
        }
        None => {}
    }
    let frames = [run.blocks.first(), run.blocks.last()];
    for frame in frames.into_iter().flatten() {
        for body in run.blocks_at(frame.time)?.0 {
            for corner in &body.corners {
                add([0, 1, 2].map(|k| corner[k].clamp(min[k], max[k])));
            }
        }
    }
    if lo[0] > hi[0] {
        (lo, hi) = (min.into(), max.into());
    }
    Ok(json!([lo, hi]))
}
