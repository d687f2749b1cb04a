//! `riprap render`.

use std::path::PathBuf;

use super::{Exit, failed, say};
use crate::picture::color::ColorMap;
use crate::picture::render::{RenderOptions, WaterLook, render};

/// Render pictures of a run with POV-Ray.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// A run folder, finished or running.
    run: PathBuf,
    /// Every N-th frame of the run.
    #[arg(long, value_name = "N", default_value_t = 1)]
    every: usize,
    /// Size of the pictures in pixels.
    #[arg(long, value_name = "WxH", default_value = "960x540", value_parser = size)]
    size: (u32, u32),
    /// Water as a smooth surface, the default.
    #[arg(long, conflicts_with = "particles")]
    surface: bool,
    /// Water as spheres colored by speed.
    #[arg(long)]
    particles: bool,
    /// Colors of the speed of particles: viridis, cividis, turbo or riprap.
    #[arg(long, value_name = "MAP", default_value = "viridis")]
    colors: ColorMap,
}

pub(crate) fn execute(arguments: &Arguments) -> Exit {
    let default = RenderOptions::default();
    let options = RenderOptions {
        every: arguments.every,
        size: arguments.size,
        water: match (arguments.surface, arguments.particles) {
            (true, _) => WaterLook::Surface,
            (_, true) => WaterLook::Particles,
            _ => default.water,
        },
        colors: arguments.colors,
        ..default
    };
    match render(&arguments.run, &options, &mut |line| say(line)) {
        Ok(summary) => {
            say(&format!(
                "{} scenes and {} pictures in {}",
                summary.scenes.len(),
                summary.pictures.len(),
                summary.folder.display()
            ));
            Exit::Done
        }
        Err(error) => failed(error),
    }
}

fn size(text: &str) -> Result<(u32, u32), String> {
    text.split_once('x')
        .and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)))
        .filter(|&(w, h)| w > 0 && h > 0)
        .ok_or_else(|| format!("`{text}` is not WIDTHxHEIGHT, such as 1280x720"))
}
