//! `riprap completions` and `riprap man`: what a shell needs to know of the program.

use std::path::PathBuf;

use clap::Command;
use clap_complete::Shell;

use super::{Exit, failed, show};
use crate::messages::{Message, of_writing};

/// Write completions of a shell to standard output.
#[derive(Debug, clap::Args)]
pub(crate) struct Completions {
    /// The shell; for bash: riprap completions bash > ~/.local/share/bash-completion/completions/riprap
    shell: Shell,
}

/// Write man pages, one per command.
#[derive(Debug, clap::Args)]
pub(crate) struct Man {
    /// Folder for riprap.1, riprap-run.1 ...; it is made.
    folder: PathBuf,
}

pub(crate) fn completions(arguments: &Completions, mut program: Command) -> Exit {
    let mut text = Vec::new();
    clap_complete::generate(arguments.shell, &mut program, "riprap", &mut text);
    show(String::from_utf8_lossy(&text).trim_end());
    Exit::Done
}

pub(crate) fn man(arguments: &Man, program: Command) -> Exit {
    let folder = &arguments.folder;
    let written =
        std::fs::create_dir_all(folder).and_then(|()| clap_mangen::generate_to(program, folder));
    match written {
        Ok(()) => Exit::Done,
        Err(error) => {
            let message = format!("cannot write to {}: {error}", folder.display());
            failed(Message::new(of_writing(&error), message))
        }
    }
}
