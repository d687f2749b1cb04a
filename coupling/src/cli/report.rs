//! `riprap report`.

use std::path::{Path, PathBuf};

use super::{Exit, failed, show};
use crate::output::run_folder;
use crate::picture::color::ColorMap;
use crate::picture::render::RenderError;
use crate::picture::report::report_in;

/// Largest size of a report unless one is asked for; bytes.
pub(crate) const SIZE: u64 = 8_000_000;

/// Make one HTML file that plays a run, without a network.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// A run folder, finished or running, of any age.
    run: PathBuf,
    /// The file; report.html in the run folder when left out.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Largest size, e.g. 4MB: frames are left out until it fits.
    #[arg(long, value_name = "SIZE", default_value = "8MB", value_parser = size)]
    size: u64,
    /// Colors of speeds and maps: riprap, viridis, cividis or turbo.
    #[arg(long, value_name = "MAP", default_value = "riprap")]
    colors: ColorMap,
}

pub(crate) fn execute(arguments: &Arguments) -> Exit {
    let output = arguments.output.clone();
    let file = output.unwrap_or_else(|| arguments.run.join(run_folder::REPORT));
    match write(&arguments.run, &file, (arguments.size, arguments.colors)) {
        Ok(words) => {
            show(&words);
            Exit::Done
        }
        Err(error) => failed(error),
    }
}

/// Writes a report; returns a line that says what it shows.
pub(crate) fn write(
    run: &Path,
    file: &Path,
    (size, colors): (u64, ColorMap),
) -> Result<String, RenderError> {
    let made = report_in(run, file, size, colors)?;
    Ok(format!(
        "{}: {:.1} MB, {}",
        made.path.display(),
        made.size as f64 / 1e6,
        made.description
    ))
}

fn size(text: &str) -> Result<u64, String> {
    let number = text.trim_end_matches("MB");
    let bytes = number.parse::<f64>().ok().map(|number| number * 1e6);
    bytes
        .filter(|bytes| (1e5..1e9).contains(bytes))
        .map(|bytes| bytes as u64)
        .ok_or_else(|| format!("`{text}` is not a size from 0.1MB to 999MB, such as 4MB"))
}
