//! `riprap handoff`.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::{Exit, failed, refused, report_scene_error, show};
use crate::handoff::columns::{Columns, Raster, Water, columns, ground_with_blocks};
use crate::handoff::fitness::{Fitness, elevation, fitness};
use crate::handoff::formats::Sheet;
use crate::handoff::propagator::Waves;
use crate::messages::{Code, Message, of_writing};
use crate::output::checkpoint_file as checkpoint;
use crate::output::observe::ObserveError;
use crate::output::run_folder;
use crate::run::Run;
use crate::scene;
use crate::scene::resolve::Scene;
use crate::study::trade::results::write;
use crate::world::World;

/// Cell over the particle spacing, unless one is asked for.
const CELL: f64 = 2.0;
/// Times of a look.
const LOOKS: usize = 20;

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
    /// Side of a cell in meters; two particle spacings when left out.
    #[arg(long, value_name = "M")]
    cell: Option<f64>,
    /// Level of rest in meters; that of the scene, its highest water at the start, when left out.
    #[arg(long, value_name = "Z", allow_negative_numbers = true)]
    level: Option<f64>,
    /// Files to write; netcdf and esri when left out. A section has section.csv alone.
    #[arg(long, value_name = "FORMAT", value_delimiter = ',')]
    format: Vec<Format>,
    /// Carry the waves on for a time in seconds, linearly over the mean depth, and write their crest to look.csv: a first look.
    #[arg(long, value_name = "T")]
    look: Option<f64>,
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
    /// GeoClaw: topography, surface, discharges.
    Geoclaw,
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
    let (Some(water), Some(fluid)) = (&world.water, &settings.fluid) else {
        let message = "the run has no water to hand over";
        return Err(refused(Message::new(Code::UnusableArgument, message)));
    };
    let particles = water.fluid.particles();
    let spacing = fluid.walls.particle_spacing;
    let water = Water {
        position: &particles.position,
        velocity: &particles.velocity,
        mass: &particles.mass,
        volume: water.fluid.particle_volume(),
        spacing,
    };
    let raster = raster(arguments, &settings, spacing)?;
    let columns = columns(raster, water, &ground_with_blocks(&world.blocks));
    let level = arguments.level.unwrap_or(fluid.lattice.still_water_level);
    let gravity = settings.gravity.norm();
    let found = fitness(&columns, water, level, gravity);
    let folder = arguments
        .output
        .clone()
        .unwrap_or_else(|| arguments.run.join("handoff"));
    let sheet = Sheet {
        columns: &columns,
        title: &settings.title,
        origin: settings
            .terrain
            .as_ref()
            .map_or((0.0, 0.0, 0.0), |terrain| terrain.origin),
        crs: settings
            .terrain
            .as_ref()
            .and_then(|terrain| terrain.crs.as_ref()),
        level,
        time: world.time(),
    };
    write_files(arguments, &sheet, &folder).map_err(failed)?;
    write_numbers(&found, &sheet, world, &folder).map_err(failed)?;
    show(&words(&found, &sheet, &folder));
    if let Some(time) = arguments.look {
        look(&sheet, (time, gravity), &folder).map_err(failed)?;
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

/// Cells over the domain.
fn raster(arguments: &Arguments, scene: &Scene, spacing: f64) -> Result<Raster, Exit> {
    let cell = arguments.cell.unwrap_or(CELL * spacing);
    if !(spacing <= cell && cell.is_finite()) {
        let message =
            format!("--cell {cell}: a column is at least a particle spacing wide, {spacing} m");
        return Err(refused(Message::new(Code::UnusableArgument, message)));
    }
    let (min, max) = (scene.domain.min, scene.domain.max);
    let size = [max.x - min.x, max.y - min.y];
    let is_section = scene.fluid.as_ref().is_some_and(|fluid| {
        matches!(
            fluid.settings.dimensions,
            riprap_sph::Dimensions::Two { .. }
        )
    });
    let n = size.map(|size| ((size / cell).ceil() as usize).max(1));
    Ok(match is_section {
        true => Raster {
            n: [n[0], 1],
            corner: [min.x, min.y],
            side: [cell, size[1]],
        },
        false => Raster {
            n,
            corner: [min.x, min.y],
            side: [cell; 2],
        },
    })
}

fn write_files(arguments: &Arguments, sheet: &Sheet, folder: &Path) -> Result<(), ObserveError> {
    std::fs::create_dir_all(folder).map_err(|source| ObserveError::Write {
        path: folder.display().to_string(),
        source,
    })?;
    if sheet.columns.raster.n[1] == 1 {
        return sheet.write_section(folder);
    }
    let usual = [Format::Netcdf, Format::Esri];
    let formats = if arguments.format.is_empty() {
        &usual
    } else {
        arguments.format.as_slice()
    };
    formats.iter().try_for_each(|format| match format {
        Format::Netcdf => sheet.write_netcdf(folder),
        Format::Esri => sheet.write_esri(folder),
        Format::Funwave => sheet.write_funwave(folder),
        Format::Geoclaw => sheet.write_geoclaw(folder),
    })
}

/// `handoff.json`: fitness, and both sides of what is conserved.
fn write_numbers(
    found: &Fitness,
    sheet: &Sheet,
    world: &World,
    folder: &Path,
) -> Result<(), Message> {
    let columns = sheet.columns;
    let sum = |axis: usize| columns.momentum.iter().map(|p| p[axis]).sum::<f64>();
    let mut momentum = [0.0; 2];
    let mut volume = 0.0;
    if let Some(water) = &world.water {
        let particles = water.fluid.particles();
        volume = particles.len() as f64 * water.fluid.particle_volume();
        for (mass, v) in particles.mass.iter().zip(&particles.velocity) {
            momentum[0] += mass * v.x;
            momentum[1] += mass * v.y;
        }
    }
    let text = json!({
        "time_s": sheet.time,
        "still_water_level_m": sheet.level,
        "cells": columns.raster.n,
        "cell_m": columns.raster.side,
        "volume_of_columns_m3": columns.volume.iter().sum::<f64>(),
        "volume_of_particles_m3": volume,
        "momentum_of_columns_kg_m_per_s": [sum(0), sum(1)],
        "momentum_of_particles_kg_m_per_s": momentum,
        "fitness": found,
    });
    let path = folder.join("handoff.json");
    write(&path, format!("{text:#}\n").as_bytes()).map_err(|error| {
        let words = format!("cannot write {}: {error}", path.display());
        Message::new(of_writing(&error), words)
    })
}

fn words(found: &Fitness, sheet: &Sheet, folder: &Path) -> String {
    let [above, below] = found.volume_above_and_below;
    format!(
        "t = {:.3} s, {} by {} cells\n  \
         columns carry {:.0} % of the kinetic energy; kd {:.2}; {:.2} of what waves of that length have\n  \
         {} of {} wet cells break; {above:.4e} m3 above the level of rest, {below:.4e} below; energy {:.3e} J\n  \
         {}\nfiles are in {}",
        sheet.time,
        sheet.columns.raster.n[0],
        sheet.columns.raster.n[1],
        100.0 * found.column_share,
        found.kd,
        found.quality,
        found.breaking_cells,
        found.wet_cells,
        found.kinetic_energy + found.potential_energy,
        found.advice,
        folder.display()
    )
}

/// `look.csv`: the highest crest over time, by linear waves over the mean depth.
fn look(sheet: &Sheet, (time, gravity): (f64, f64), folder: &Path) -> Result<(), Message> {
    let columns: &Columns = sheet.columns;
    let eta = elevation(columns, sheet.level);
    let wet: Vec<f64> = (0..eta.len())
        .filter(|&cell| 0.0 < columns.depth[cell] && columns.ground[cell] < sheet.level)
        .map(|cell| sheet.level - columns.ground[cell])
        .collect();
    let depth = wet.iter().sum::<f64>() / wet.len().max(1) as f64;
    let waves = Waves::new(
        (&eta, &columns.velocity),
        (columns.raster.n, columns.raster.side),
        depth,
        gravity,
    );
    let mut text = "time [s],crest [m],x [m],y [m]\n".to_owned();
    for k in 0..=LOOKS {
        let after = time * k as f64 / LOOKS as f64;
        let surface = waves.after(after);
        let crest = (0..surface.len()).max_by(|&a, &b| surface[a].total_cmp(&surface[b]));
        if let Some(cell) = crest {
            let [x, y] = columns.raster.center(cell);
            text += &format!("{},{},{x},{y}\n", sheet.time + after, surface[cell]);
        }
    }
    let path = folder.join("look.csv");
    write(&path, text.as_bytes()).map_err(|error| {
        let words = format!("cannot write {}: {error}", path.display());
        Message::new(of_writing(&error), words)
    })?;
    show(&format!(
        "look.csv: linear waves over {depth:.2} m of water, {time} s further"
    ));
    Ok(())
}
