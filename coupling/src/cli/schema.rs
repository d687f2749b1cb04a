//! `riprap schema`: the JSON schema of scenes and studies, for editors and for programs that write them.

use super::{Exit, show};
use crate::scene::schema;
use crate::study::trade::file::StudyFile;

/// Print the JSON schema of scenes.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// That of studies instead.
    #[arg(long)]
    studies: bool,
}

pub(crate) fn execute(arguments: &Arguments) -> Exit {
    let schema = match arguments.studies {
        true => schema::of::<StudyFile>("riprap study"),
        false => schema::of_scenes(),
    };
    show(&format!("{schema:#}"));
    Exit::Done
}
