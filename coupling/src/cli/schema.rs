//! `riprap schema`: the JSON schema of scenes, studies and sweeps, for editors and for programs that write them.

use super::{Exit, show};
use crate::scene::schema;
use crate::study::sweep::file::SweepFile;
use crate::study::trade::file::StudyFile;

/// Print the JSON schema of scenes.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// That of studies instead.
    #[arg(long)]
    studies: bool,
    /// That of sweeps instead.
    #[arg(long, conflicts_with = "studies")]
    sweeps: bool,
}

pub(crate) fn execute(arguments: &Arguments) -> Exit {
    let schema = match (arguments.studies, arguments.sweeps) {
        (true, _) => schema::of::<StudyFile>("riprap study"),
        (_, true) => schema::of::<SweepFile>("riprap sweep"),
        (false, false) => schema::of_scenes(),
    };
    show(&format!("{schema:#}"));
    Exit::Done
}
