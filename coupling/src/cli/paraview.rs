//! `riprap paraview`.

use std::path::PathBuf;

use super::{Exit, failed, show};
use crate::output::run_folder;
use crate::picture::paraview::{Coloring, paraview};

/// Write a Python script that opens a run in ParaView.
///
/// Water as spheres colored by speed or elevation, on a scale of the whole run with its legend and unit; blocks, walls, shaded
/// terrain, time, and the camera of the scene. Open it with File > Load State, choosing `.py`, or from a terminal:
///
///   paraview --script=RUN/open_in_paraview.py
///
///   pvbatch RUN/open_in_paraview.py picture.png 2.5      a picture at t = 2.5 s, without a window
///
/// Sizes, scales and colors are at the top of the script. It finds the run from its own place, also after both were moved; ParaView's
/// File > Load State does not say where a script is, so that it then looks where the run was when the script was written.
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct Arguments {
    /// A run folder, finished or running.
    run: PathBuf,
    /// The script; open_in_paraview.py in the run folder when left out.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Quantity that colors the water at first; ParaView's menu has the other.
    #[arg(long, value_enum, default_value_t = Color::Speed)]
    color: Color,
}

/// Quantity that colors the water.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum Color {
    /// Speed; m/s.
    Speed,
    /// Elevation; m.
    Elevation,
}

pub(crate) fn execute(arguments: &Arguments) -> Exit {
    let output = arguments.output.clone();
    let file = output.unwrap_or_else(|| arguments.run.join(run_folder::PARAVIEW));
    let coloring = match arguments.color {
        Color::Speed => Coloring::Speed,
        Color::Elevation => Coloring::Elevation,
    };
    match paraview(&arguments.run, &file, coloring) {
        Ok(()) => {
            show(&format!(
                "{}: open it with paraview --script={}, or with File > Load State",
                file.display(),
                file.display()
            ));
            Exit::Done
        }
        Err(error) => failed(error),
    }
}
