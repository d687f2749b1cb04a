//! `riprap compare`.

use std::path::{Path, PathBuf};

use super::{Exit, failed, refused, show};
use crate::files::table::TableError;
use crate::files::vtk::replace_file;
use crate::messages::{Code, Coded, Message};
use crate::scene::geometry::terrain::sources::is_surface;
use crate::study::compare::surfaces::{self, compare_surfaces, load};
use crate::study::compare::{
    CompareError, Options, ReferenceColumns, compare_files, compare_with, json, text,
};

/// Compare a recorded column with a reference, or a deposit with a survey.
///
/// Two surfaces are compared over the area that both cover, in map coordinates: a run folder (its ground and blocks at the end),
/// a raster (.asc, .tif), a mesh, or a cloud of points (.xyz, .las, .laz; .csv and .txt beside one of these).
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// A table of a run, such as runs/NAME/gauges.csv; or a surface, such as runs/NAME.
    gauges: PathBuf,
    /// The reference: CSV with time and value, `#` comments; or a surface. With --reference-column or --reference-time a table of
    /// any columns, separated by commas, semicolons, tabs or spaces, with or without a heading, in other units.
    reference: PathBuf,
    /// Column of the run; all common columns when left out.
    #[arg(long)]
    column: Option<String>,
    /// Column of the reference, by its heading, with or without its unit, or its number from 1; that of --column when left out.
    /// Its unit is converted by its heading: "eta [mm]", "p (kPa)", or a line of units below.
    #[arg(long, value_name = "NAME")]
    reference_column: Option<String>,
    /// Column of the times of the reference, likewise; `time` or `t`, or else the first one, when left out.
    #[arg(long, value_name = "NAME")]
    reference_time: Option<String>,
    /// Added to the times of the run; s.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    shift: f64,
    /// Start of the comparison in the time of the reference; s.
    #[arg(long, allow_negative_numbers = true)]
    from: Option<f64>,
    /// End of the comparison in the time of the reference; s.
    #[arg(long, allow_negative_numbers = true)]
    to: Option<f64>,
    /// Distance of the points at which surfaces are compared, that of the coarser when left out; m.
    #[arg(long, value_parser = positive)]
    cell: Option<f64>,
    /// Table of the comparison of surfaces; when left out beside the first, as NAME_compared.csv, or compared.csv in a run folder.
    #[arg(long, short)]
    output: Option<PathBuf>,
    /// Write JSON.
    #[arg(long)]
    json: bool,
}

fn positive(text: &str) -> Result<f64, String> {
    let value = text
        .parse()
        .ok()
        .filter(|v: &f64| v.is_finite() && *v > 0.0);
    value.ok_or_else(|| format!("must be a length above 0 m, found {text}"))
}

pub(crate) fn execute(arguments: &Arguments) -> Exit {
    let paths = [&arguments.gauges, &arguments.reference];
    if (paths.iter()).any(|path| path.is_dir() || is_surface(&path.to_string_lossy())) {
        return surfaces(arguments);
    }
    let options = Options {
        shift: arguments.shift,
        from: arguments.from,
        to: arguments.to,
        ..Options::default()
    };
    let columns = ReferenceColumns {
        value: arguments.reference_column.clone(),
        time: arguments.reference_time.clone(),
    };
    let (run, reference) = (&arguments.gauges, &arguments.reference);
    let column = arguments.column.as_deref();
    let reports = match columns.are_given() {
        true => compare_with(run, reference, (column, &columns), options),
        false => compare_files(run, reference, column, options),
    };
    match reports {
        Ok(reports) if arguments.json => shown(json(&reports)),
        Ok(reports) => {
            show(text(&reports).trim_end());
            Exit::Done
        }
        Err(error) => {
            let has_other_names = matches!(
                error,
                CompareError::NothingShared { .. }
                    | CompareError::Table(TableError::NoColumn { .. })
            );
            match has_other_names && !columns.are_given() {
                true => refused(Message::new(
                    error.code(),
                    format!(
                        "{error}; a column of another name in the reference: --reference-column"
                    ),
                )),
                false => refused(error),
            }
        }
    }
}

fn surfaces(arguments: &Arguments) -> Exit {
    let pair = load(&arguments.gauges).and_then(|first| Ok((first, load(&arguments.reference)?)));
    let found = pair.and_then(|(first, second)| compare_surfaces(&first, &second, arguments.cell));
    let found = match found {
        Ok(found) => found,
        Err(error) => return refused(error),
    };
    let file = (arguments.output.clone()).unwrap_or_else(|| table_of(&arguments.gauges));
    if let Err(error) = replace_file(&file, &[surfaces::table(&found).as_bytes()]) {
        return failed(error);
    }
    if arguments.json {
        return shown(surfaces::json(&found));
    }
    show(&format!(
        "{} less {}\n{}  written to {}",
        arguments.gauges.display(),
        arguments.reference.display(),
        surfaces::text(&found),
        file.display()
    ));
    Exit::Done
}

/// File of the table of a comparison, by the first surface.
fn table_of(first: &Path) -> PathBuf {
    if first.is_dir() {
        return first.join("compared.csv");
    }
    let stem = first.file_stem().unwrap_or_default().to_string_lossy();
    first.with_file_name(format!("{stem}_compared.csv"))
}

fn shown(text: Result<String, serde_json::Error>) -> Exit {
    match text {
        Ok(text) => {
            show(&text);
            Exit::Done
        }
        Err(error) => failed(Message::new(Code::CannotWrite, error.to_string())),
    }
}
