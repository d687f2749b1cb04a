//! The `riprap` program.

use std::process::ExitCode;

fn main() -> ExitCode {
    riprap::cli::main()
}
