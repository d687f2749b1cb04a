//! `riprap compare`.

use std::path::PathBuf;

use super::{Exit, say, show};
use crate::study::compare::{Options, compare_files, json, text};

/// Compare a recorded column with a reference.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// A table of a run, such as runs/NAME/gauges.csv.
    gauges: PathBuf,
    /// The reference: CSV with time and value, `#` comments.
    reference: PathBuf,
    /// Column of the run; all common columns when left out.
    #[arg(long)]
    column: Option<String>,
    /// Added to the times of the run; s.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    shift: f64,
    /// Start of the comparison in the time of the reference; s.
    #[arg(long, allow_negative_numbers = true)]
    from: Option<f64>,
    /// End of the comparison in the time of the reference; s.
    #[arg(long, allow_negative_numbers = true)]
    to: Option<f64>,
    /// Write JSON.
    #[arg(long)]
    json: bool,
}

pub(crate) fn execute(arguments: &Arguments) -> Exit {
    let options = Options {
        shift: arguments.shift,
        from: arguments.from,
        to: arguments.to,
        ..Options::default()
    };
    let reports = compare_files(
        &arguments.gauges,
        &arguments.reference,
        arguments.column.as_deref(),
        options,
    );
    match reports {
        Ok(reports) if arguments.json => match json(&reports) {
            Ok(text) => {
                show(&text);
                Exit::Done
            }
            Err(error) => {
                say(&format!("error: {error}"));
                Exit::Failed
            }
        },
        Ok(reports) => {
            show(text(&reports).trim_end());
            Exit::Done
        }
        Err(error) => {
            say(&format!("error: {error}"));
            Exit::BadInput
        }
    }
}
