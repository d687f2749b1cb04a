//! Starting the program again, for runs in processes of their own.

use std::ffi::OsString;
use std::io;
use std::process::Command;

/// How the program is started again.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Program {
    /// By the executable of this process.
    ThisExecutable,
    /// By an interpreter: its executable, and arguments of its own.
    Interpreted(OsString, Vec<OsString>),
}

impl Program {
    /// Command line that starts the program, without arguments.
    pub(super) fn command(&self) -> io::Result<Command> {
        match self {
            Self::ThisExecutable => Ok(Command::new(std::env::current_exe()?)),
            Self::Interpreted(interpreter, arguments) => {
                let mut command = Command::new(interpreter);
                command.args(arguments);
                Ok(command)
            }
        }
    }

    /// The same, word by word, for scripts.
    pub(super) fn words(&self) -> io::Result<Vec<String>> {
        let command = self.command()?;
        let all = std::iter::once(command.get_program()).chain(command.get_args());
        Ok(all
            .map(|word| word.to_string_lossy().into_owned())
            .collect())
    }
}
