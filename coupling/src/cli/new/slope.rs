//! Rock slope above water, on the user's terrain.

mod crossing;
mod failure;
mod layout;
mod text;

use std::path::{Path, PathBuf};

use super::digits::significant;
use super::survey::Survey;
use super::{Draft, Target, checked, folder_of, name_beside};
use crate::cli::check::wall_seconds;
use crate::scene::access::Access;
use crate::scene::geometry::terrain::outline::Outline;
use failure::{Failure, Stated, failure};
use layout::{Layout, layout};

/// Rows of particles in the depth: the fewest that carry a wave, and the most that are tried.
const COARSEST: f64 = 4.0;
const FINEST: f64 = 24.0;
/// Power of the spacing in the run time of water: particles times steps.
const POWER: f64 = 4.0;

/// Write the scene of a rock slope above water: rasters, outline and water level are the user's, everything else is chosen.
#[derive(Debug, clap::Args)]
pub(super) struct Options {
    #[command(flatten)]
    pub target: Target,
    /// Elevations of land and bed; may be repeated, the first with a value counts (land first).
    #[arg(long, required = true, value_name = "FILE")]
    dem: Vec<PathBuf>,
    /// Outline of the failing rock in map coordinates: a table with columns x and y, GeoJSON or a shapefile.
    #[arg(long, value_name = "FILE")]
    outline: PathBuf,
    /// Elevation of the still water on the map; m.
    #[arg(long, value_name = "Z", allow_negative_numbers = true)]
    level: f64,
    /// Dip of the failure plane; degrees. Chosen for the volume when left out.
    #[arg(long, value_name = "DEG", conflicts_with_all = ["volume", "thickness"])]
    dip: Option<f64>,
    /// Dip direction of the failure plane, clockwise from north; degrees. That of the ground along the outline when left out.
    #[arg(long, value_name = "DEG")]
    dip_direction: Option<f64>,
    /// Volume of the rock; m³. By the area of the outline when left out.
    #[arg(long, value_name = "M3", conflicts_with = "thickness")]
    volume: Option<f64>,
    /// Mean thickness of the rock; m.
    #[arg(long, value_name = "M")]
    thickness: Option<f64>,
    /// Particle spacing of the water; m. Chosen for the run time when left out.
    #[arg(long, value_name = "M")]
    spacing: Option<f64>,
    /// Run time on this machine that the spacing is chosen for; minutes.
    #[arg(long, value_name = "MIN", default_value_t = 10.0)]
    minutes: f64,
}

/// Reason for the spacing of the water.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Reason {
    Stated,
    /// An estimate of the run time; minutes.
    Time(f64),
    /// The scene has faults, so that no time could be estimated.
    Rows,
}

/// All that the scene is written from.
struct Sheet<'a> {
    survey: &'a Survey,
    /// Name of the file of the outline.
    outline: &'a str,
    failure: Failure,
    layout: Layout,
}

pub(super) fn draft(options: &Options, path: &Path) -> Result<Draft, String> {
    refuse_negative(options)?;
    let survey = Survey::read(&options.dem, path)?;
    let name = name_beside(&options.outline, path)?;
    let access = Access::of(folder_of(path));
    let outline = Outline::on_map(&name, &access)?;
    let stated = Stated {
        dip: options.dip,
        dip_direction: options.dip_direction,
        volume: options.volume,
        thickness: options.thickness,
    };
    let failure = failure(&survey, &outline, stated)?;
    let layout = layout(
        &survey,
        &outline,
        &failure,
        (options.level, options.spacing),
    )?;
    let mut sheet = Sheet {
        survey: &survey,
        outline: &name,
        failure,
        layout,
    };
    let reason = match options.spacing {
        Some(_) => Reason::Stated,
        None => sheet.fit(options.minutes, path),
    };
    Ok(Draft {
        scene: text::scene(&sheet, reason),
        beside: Vec::new(),
        notes: vec![text::summary(&sheet, reason)],
    })
}

impl Sheet<'_> {
    /// Settles the spacing so that the run takes some minutes, by estimates from the first steps of the scene.
    ///
    /// ```text
    /// t = t_rock + t_water (s₀/s)⁴
    /// ```
    /// Where the rock alone takes more than half of the time, the water is given as much as the rock.
    fn fit(&mut self, minutes: f64, path: &Path) -> Reason {
        let depth = self.layout.crossing.depth;
        let estimate = |scene: &str| {
            let (scene, _) = checked(scene, path).ok()?;
            Some(wall_seconds(&scene).ok()? / 60.0)
        };
        let of_water = estimate(&text::scene_of_water(self));
        let of_all = estimate(&text::scene(self, Reason::Rows));
        let Some((water, all)) = of_water.zip(of_all) else {
            return Reason::Rows;
        };
        let rock = (all - water).max(0.0);
        let finer = (water / (minutes - rock).max(rock)).powf(1.0 / POWER);
        let spacing = self.layout.spacing * finer;
        self.layout.spacing = significant(spacing.clamp(depth / FINEST, depth / COARSEST), 2);
        match estimate(&text::scene(self, Reason::Rows)) {
            Some(minutes) => Reason::Time(minutes),
            None => Reason::Rows,
        }
    }
}

fn refuse_negative(options: &Options) -> Result<(), String> {
    let given = [
        ("--dip", options.dip),
        ("--volume", options.volume),
        ("--thickness", options.thickness),
        ("--spacing", options.spacing),
        ("--minutes", Some(options.minutes)),
    ];
    for (name, value) in given {
        if let Some(value) = value.filter(|value| !(0.0 < *value && value.is_finite())) {
            return Err(format!("{name} must be above 0, got {value}"));
        }
    }
    match options.dip {
        Some(dip) if 85.0 < dip => Err(format!("--dip must be at most 85 degrees, got {dip}")),
        _ => Ok(()),
    }
}
