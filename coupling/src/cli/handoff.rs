//! `riprap handoff`.

use std::path::{Path, PathBuf};

use super::{Exit, failed, refused, report_scene_error, show};
use crate::files::table::read_table;
use crate::handoff::columns::Columns;
use crate::handoff::fitness::elevation;
use crate::handoff::package::{Package, Request, Setting};
use crate::handoff::propagator::Waves;
use crate::handoff::readiness::Reason;
use crate::messages::{Code, Message, of_writing};
use crate::output::checkpoint_file as checkpoint;
use crate::output::run_folder;
use crate::run::Run;
use crate::scene;
use crate::scene::resolve::{HANDOFF_CELL, Scene};
use crate::scene::resolved::recording::HandoffFormat;
use crate::study::trade::results::write;

/// Times of a look: one while a long wave passes so many cells, within limits.
const LOOK: f64 = 1.0;
const FEWEST_LOOKS: f64 = 20.0;
const MOST_LOOKS: f64 = 200.0;

/// Hand the water of a run over to a solver of the far field.
///
/// The state is that of the run's end, or of the checkpoint where it was stopped. Run further with `riprap run --resume --until T`
/// where the numbers say that the flow is not ready.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// A run folder, finished or stopped.
    run: PathBuf,
    /// Folder of the files; handoff in the run folder when left out.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Side of a cell in meters; that of the scene's `handoff` or two particle spacings when left out.
    #[arg(long, value_name = "M")]
    cell: Option<f64>,
    /// Level of rest in meters; that of the scene's `handoff` or its highest water at the start when left out.
    #[arg(long, value_name = "Z", allow_negative_numbers = true)]
    level: Option<f64>,
    /// Files to write; those of the scene's `handoff`, or netcdf and esri, when left out. A section has section.csv alone.
    #[arg(long, value_name = "FORMAT", value_delimiter = ',')]
    format: Vec<Format>,
    /// Carry the waves on for a time in seconds, linearly over the mean depth, and write their crest to look.csv: a first look.
    #[arg(long, value_name = "T")]
    look: Option<f64>,
    /// Place whose surface is in look.csv, too, in the scene's coordinates; may be repeated, and be outside of the domain.
    #[arg(long, value_name = "X,Y", value_parser = place, requires = "look", allow_hyphen_values = true)]
    at: Vec<[f64; 2]>,
}

/// Format of the files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Format {
    /// NetCDF-3 with CF names.
    Netcdf,
    /// ESRI ASCII grids and GeoTIFF.
    Esri,
    /// FUNWAVE-TVD: depth, surface, velocities, input.txt.
    Funwave,
    /// GeoClaw: topography, surface, discharges, and the code that reads them.
    Geoclaw,
    /// SWASH: bottom, water level, current, series of the lines of the scene's `handoff`, INPUT.
    Swash,
}

impl From<Format> for HandoffFormat {
    fn from(format: Format) -> Self {
        match format {
            Format::Netcdf => Self::NetCdf,
            Format::Esri => Self::Esri,
            Format::Funwave => Self::Funwave,
            Format::Geoclaw => Self::Geoclaw,
            Format::Swash => Self::Swash,
        }
    }
}

/// `X,Y`.
fn place(text: &str) -> Result<[f64; 2], String> {
    let numbers = text
        .split(',')
        .map(|word| word.trim().parse::<f64>().map_err(|_| word));
    match numbers.collect::<Result<Vec<f64>, &str>>().as_deref() {
        Ok(&[x, y]) if x.is_finite() && y.is_finite() => Ok([x, y]),
        _ => Err(format!(
            "`{text}` is no place; write X,Y in meters, such as 0,2000"
        )),
    }
}

pub(crate) fn execute(arguments: &Arguments) -> Exit {
    hand_over(arguments).unwrap_or_else(|exit| exit)
}

fn hand_over(arguments: &Arguments) -> Result<Exit, Exit> {
    let case = arguments.run.join(run_folder::CASE);
    let text = std::fs::read_to_string(&case).map_err(|error| {
        let message = format!(
            "cannot read {}: {error}; name the folder of a run",
            case.display()
        );
        refused(Message::new(Code::UnusableRunFolder, message))
    })?;
    let (mut scene, _) = scene::load(&case, &[]).map_err(|error| {
        report_scene_error(&error);
        Exit::BadInput
    })?;
    let found =
        checkpoint::newest(&arguments.run, &checkpoint::scene_hash(&text)).map_err(refused)?;
    let Some((state, _)) = found else {
        let message = format!(
            "{} has no checkpoint; run it with this program",
            arguments.run.display()
        );
        return Err(refused(Message::new(Code::NoCheckpoint, message)));
    };
    let settings = scene.clone();
    let mut run = Run::in_memory(&mut scene).map_err(failed)?;
    run.restore(&state).map_err(failed)?;
    // the states of a run are kept from time to time; those to its end are computed again, to the same bits
    let is_complete = is_complete(&arguments.run);
    while is_complete && !run.is_over() {
        run.step().map_err(failed)?;
    }
    let world = run.world();
    let (setting, formats) = setting(arguments, &settings)?;
    let Some(package) = setting.package(world) else {
        let message = "the run has no water to hand over";
        return Err(refused(Message::new(Code::UnusableArgument, message)));
    };
    let lines = settings
        .handoff
        .as_ref()
        .map_or_else(Vec::new, |asked| asked.lines.clone());
    let table = arguments.run.join(run_folder::HANDOFF_LINES);
    let records = match table.exists() {
        true => Some(read_table(&table).map_err(failed)?),
        false => None,
    };
    let folder = arguments
        .output
        .clone()
        .unwrap_or_else(|| arguments.run.join(run_folder::HANDOFF));
    let reason = if is_complete {
        Reason::EndOfRun
    } else {
        Reason::Given
    };
    let request = Request {
        folder: &folder,
        formats: &formats,
        lines: (&lines, records.as_ref()),
        reason: (reason, None),
    };
    setting.write(&package, world, request).map_err(failed)?;
    show(&words(&package, world.time(), &folder));
    if let Some(time) = arguments.look {
        let gravity = settings.gravity.norm();
        look(
            arguments,
            (&package, setting.level),
            (world.time(), time, gravity),
            &folder,
        )?;
    }
    Ok(Exit::Done)
}

/// Whether a run has reached its end.
fn is_complete(run: &Path) -> bool {
    let text = std::fs::read_to_string(run.join(run_folder::SUMMARY));
    let read = |text: String| serde_json::from_str::<serde_json::Value>(&text).ok();
    text.ok()
        .and_then(read)
        .is_some_and(|summary| summary["completed"] == true)
}

/// Cells, level and files, from the arguments, else from the scene.
fn setting(arguments: &Arguments, scene: &Scene) -> Result<(Setting, Vec<HandoffFormat>), Exit> {
    let Some(fluid) = &scene.fluid else {
        let message = "the run has no water to hand over";
        return Err(refused(Message::new(Code::UnusableArgument, message)));
    };
    let spacing = fluid.walls.particle_spacing;
    let asked = scene.handoff.as_ref();
    let cell = arguments
        .cell
        .unwrap_or_else(|| asked.map_or(HANDOFF_CELL * spacing, |asked| asked.cell));
    if !(spacing <= cell && cell.is_finite()) {
        let message =
            format!("--cell {cell}: a column is at least a particle spacing wide, {spacing} m");
        return Err(refused(Message::new(Code::UnusableArgument, message)));
    }
    let still = fluid.lattice.still_water_level;
    let level = arguments
        .level
        .unwrap_or_else(|| asked.map_or(still, |asked| asked.level));
    let formats = match asked {
        _ if !arguments.format.is_empty() => arguments.format.iter().map(|f| (*f).into()).collect(),
        Some(asked) => asked.formats.clone(),
        None => vec![HandoffFormat::NetCdf, HandoffFormat::Esri],
    };
    let setting = Setting::new(scene, cell, level).ok_or(Exit::BadInput)?;
    Ok((setting, formats))
}

fn words(package: &Package, time: f64, folder: &Path) -> String {
    let found = &package.fitness;
    let [above, below] = found.volume_above_and_below;
    let n = package.columns.raster.n;
    format!(
        "t = {time:.3} s, {} by {} cells\n  \
         columns carry {:.0} % of the kinetic energy; kd {:.2}; {:.2} of what waves of that length have; \
         pressure at the bed {:.0} % off the weight of the water\n  \
         {} of {} wet cells break; {above:.4e} m3 above the level of rest, {below:.4e} below; energy {:.3e} J\n  \
         {}\nfiles are in {}",
        n[0],
        n[1],
        100.0 * found.column_share,
        found.kd,
        found.quality,
        100.0 * found.pressure_deviation,
        found.breaking_cells,
        found.wet_cells,
        found.kinetic_energy + found.potential_energy,
        found.advice,
        folder.display()
    )
}

/// `look.csv`: the highest crest and the surface at places over time, by linear waves over the mean depth.
fn look(
    arguments: &Arguments,
    (package, level): (&Package, f64),
    (now, time, gravity): (f64, f64, f64),
    folder: &Path,
) -> Result<(), Exit> {
    let columns = &package.columns;
    let eta = elevation(columns, level);
    let wet: Vec<f64> = (0..eta.len())
        .filter(|&cell| 0.0 < columns.depth[cell] && columns.ground[cell] < level)
        .map(|cell| level - columns.ground[cell])
        .collect();
    let depth = wet.iter().sum::<f64>() / wet.len().max(1) as f64;
    let state = (eta.as_slice(), columns.velocity.as_slice());
    let Some(waves) = Waves::new(state, columns.raster, (depth, gravity), time) else {
        let message = format!(
            "--look {time}: the waves would cross more cells than fit; take a shorter time or a larger --cell than {}",
            columns.raster.side[0]
        );
        return Err(refused(Message::new(Code::UnusableArgument, message)));
    };
    for at in &arguments.at {
        if waves.place(*at).is_none() {
            let message = format!(
                "--at {},{}: no wave gets there in {time} s; look further or nearer",
                at[0], at[1]
            );
            return Err(refused(Message::new(Code::UnusableArgument, message)));
        }
    }
    let mut text = "time [s],crest [m],x [m],y [m]".to_owned();
    for (k, _) in arguments.at.iter().enumerate() {
        text += &format!(",at_{} [m]", k + 1);
    }
    text += "\n";
    let looks = (time / (LOOK * time_of_a_cell(columns, depth, gravity)))
        .ceil()
        .clamp(FEWEST_LOOKS, MOST_LOOKS) as usize;
    for k in 0..=looks {
        let after = time * k as f64 / looks as f64;
        let surface = waves.after(after);
        let ([x, y], crest) = surface.highest();
        text += &format!("{},{crest},{x},{y}", now + after);
        for at in &arguments.at {
            text += &format!(",{}", surface.at(*at));
        }
        text += "\n";
    }
    let path = folder.join("look.csv");
    write(&path, text.as_bytes()).map_err(|error| {
        let words = format!("cannot write {}: {error}", path.display());
        failed(Message::new(of_writing(&error), words))
    })?;
    show(&format!(
        "look.csv: linear waves over {depth:.2} m of water, {time} s further"
    ));
    Ok(())
}

/// Time in which a long wave passes a cell; s.
fn time_of_a_cell(columns: &Columns, depth: f64, gravity: f64) -> f64 {
    columns.raster.side[0] / (gravity * depth).sqrt()
}
