//! `riprap check`: report of the model of a scene and its cost.

mod cost;
mod describe;
mod disk;
mod facts;
mod json;
mod kernel;
mod landslide;
mod mach;
mod water;

use std::path::PathBuf;

use super::{Exit, failed, files_from, load, show, told};
use crate::run::ineffective::ineffective_options;
use crate::scene::parse::Override;
use cost::cost;
pub(crate) use cost::wall_seconds;
pub(crate) use describe::describe;

/// Check a scene and report its model and cost.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// The scene, a RON, JSON or YAML file; see docs/reference/scene.
    case: PathBuf,
    /// Set a field of the scene, e.g. --set fluid.resolution="Count(5000)"; may be repeated.
    #[arg(long = "set", value_name = "PATH=VALUE")]
    set: Vec<Override>,
    /// Allow the scene to name files outside of its folder.
    #[arg(long)]
    allow_outside: bool,
    /// Print one JSON object: problems, model, step, cost, memory and disk, with units in the names; errors of the scene, too.
    #[arg(long)]
    json: bool,
}

pub(crate) fn execute(arguments: &Arguments) -> Exit {
    let files = files_from(arguments.allow_outside);
    if arguments.json {
        return json::report(&arguments.case, &arguments.set, files);
    }
    let scene = match load(&arguments.case, &arguments.set, files) {
        Ok(scene) => scene,
        Err(exit) => return exit,
    };
    show(&describe(&scene));
    for one in ineffective_options(&scene) {
        show(&format!("  no effect at this resolution: {one}"));
    }
    if let Some(warning) = mach::warning(&scene) {
        show(&format!("  warning        {}", told::coded(&warning)));
    }
    match cost(&scene) {
        Ok(cost) => {
            show(&cost.to_string());
            Exit::Done
        }
        Err(error) => failed(error),
    }
}
