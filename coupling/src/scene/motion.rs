//! Prescribed motions: formulas and measured records.

use riprap_dda::{Accelerogram, Motion, PrescribedMotion, Vec3};

use super::access::Access;
use super::error::Problem;
use super::file::MotionFile;
use super::file::vec3;
use crate::files::rows::{Comments, Rows};
use crate::files::units::{Quantity, split};
use crate::messages::Code;

/// Columns of a record of displacement, and where it turns.
const DISPLACEMENT: Columns = Columns {
    names: "time, x, y, z, and where it turns the rotation vector rx, ry, rz",
    allowed: &[4, 7],
    quantities: &[
        Quantity::Time,
        Quantity::Length,
        Quantity::Length,
        Quantity::Length,
        Quantity::Angle,
        Quantity::Angle,
        Quantity::Angle,
    ],
};
/// Columns of a record of the way along a path.
const WAY: Columns = Columns {
    names: "time, way",
    allowed: &[2],
    quantities: &[Quantity::Time, Quantity::Length],
};
/// Columns of a record of acceleration.
const ACCELERATION: Columns = Columns {
    names: "time, acceleration",
    allowed: &[2],
    quantities: &[Quantity::Time, Quantity::Acceleration],
};

/// Columns of a record.
#[derive(Clone, Copy)]
struct Columns {
    /// Names for errors.
    names: &'static str,
    /// Numbers on a line.
    allowed: &'static [usize],
    quantities: &'static [Quantity],
}

/// Motion of a block; `path` is its location in the file.
///
/// # Errors
///
/// A [`Problem`] that names the record and its line.
pub fn motion(file: &MotionFile, path: &str, access: &Access) -> Result<Motion, Problem> {
    match file {
        MotionFile::Free => Ok(Motion::Free),
        MotionFile::Fixed => Ok(Motion::Fixed),
        MotionFile::Sinusoid {
            direction,
            amplitude,
            period,
            phase_deg,
            ramp,
        } => {
            let direction = vec3(*direction).try_normalize(0.0).ok_or_else(|| {
                Problem::error(
                    Code::UnusableDirection,
                    format!("{path}.direction"),
                    "the motion has no direction",
                )
            })?;
            Ok(Motion::Prescribed(PrescribedMotion::Sinusoid {
                direction,
                amplitude: *amplitude,
                period: *period,
                phase: phase_deg.to_radians(),
                ramp: *ramp,
            }))
        }
        MotionFile::Waves { .. } => Err(Problem::error(
            Code::IncompatibleOptions,
            path,
            "a wave maker takes its motion from the water of its scene",
        )),
        MotionFile::Path { .. } => Err(Problem::error(
            Code::IncompatibleOptions,
            path,
            "a motion along a path needs the shape of its block",
        )),
        MotionFile::Table { file: name } | MotionFile::Shaking { file: name, .. } => {
            let text = text_of(access, name)
                .map_err(|(code, message)| Problem::error(code, format!("{path}.file"), message))?;
            recorded(file, path, &text)
        }
    }
}

/// Motion of a block from the text of the record that `file` names; `path` is its location in the scene.
///
/// # Errors
///
/// A [`Problem`] that names the record and its line.
pub fn recorded(file: &MotionFile, path: &str, text: &str) -> Result<Motion, Problem> {
    match file {
        MotionFile::Table { file } => {
            let rows = rows(file, text, path, DISPLACEMENT)?;
            Ok(Motion::Prescribed(PrescribedMotion::Table {
                time: rows.iter().map(|row| row[0]).collect(),
                displacement: rows.iter().map(|row| vec3_of(&row[1..4])).collect(),
                turning: rows
                    .iter()
                    .filter(|row| row.len() == 7)
                    .map(|row| vec3_of(&row[4..7]).map(f64::to_radians))
                    .collect(),
            }))
        }
        MotionFile::Shaking { direction, file } => {
            let direction = vec3(*direction).try_normalize(0.0).ok_or_else(|| {
                Problem::error(
                    Code::UnusableDirection,
                    format!("{path}.direction"),
                    "the shaking has no direction",
                )
            })?;
            let rows = rows(file, text, path, ACCELERATION)?;
            let interval = rows[1][0] - rows[0][0];
            let uneven = rows
                .iter()
                .enumerate()
                .find(|(k, row)| (row[0] - *k as f64 * interval).abs() > 1e-3 * interval);
            if let Some((_, row)) = uneven {
                return Err(Problem::error(
                    Code::UnusableFile,
                    format!("{path}.file"),
                    format!(
                        "`{file}`: times must go from 0 in equal steps of {interval} s; {} s does not fit",
                        row[0]
                    ),
                ));
            }
            let record =
                Accelerogram::new(direction, interval, rows.iter().map(|row| row[1]).collect());
            Ok(Motion::Prescribed(PrescribedMotion::Shaking(record)))
        }
        MotionFile::Free
        | MotionFile::Fixed
        | MotionFile::Sinusoid { .. }
        | MotionFile::Path { .. }
        | MotionFile::Waves { .. } => Err(Problem::error(
            Code::IncompatibleOptions,
            path,
            "the motion is not read from a record",
        )),
    }
}

/// Times and ways of the record that a motion along a path names; `path` is the location of the motion in the file; s, m.
///
/// # Errors
///
/// A [`Problem`] that names the record and its line.
pub(super) fn ways(name: &str, path: &str, access: &Access) -> Result<Vec<[f64; 2]>, Problem> {
    let text = text_of(access, name)
        .map_err(|(code, message)| Problem::error(code, format!("{path}.file"), message))?;
    let rows = rows(name, &text, path, WAY)?;
    Ok(rows.iter().map(|row| [row[0], row[1]]).collect())
}

fn vec3_of(numbers: &[f64]) -> Vec3 {
    Vec3::from_column_slice(numbers)
}

/// The text of a record that the scene names.
fn text_of(access: &Access, file: &str) -> Result<String, (Code, String)> {
    access
        .read(file)
        .map_err(|fault| (fault.code(), format!("`{file}`: {fault}")))
        .and_then(|bytes| {
            String::from_utf8(bytes)
                .map_err(|error| (Code::UnusableFile, format!("`{file}` is not text: {error}")))
        })
}

/// The rows of a record that the scene names at `path`, with columns as for [`record`].
fn rows(file: &str, text: &str, path: &str, columns: Columns) -> Result<Vec<Vec<f64>>, Problem> {
    record(text, columns).map_err(|found| {
        Problem::error(
            Code::UnusableFile,
            format!("{path}.file"),
            format!("`{file}` {found}"),
        )
    })
}

/// Rows of a record: one of the allowed counts of numbers on every line, the first an increasing time; `#` comments, one optional
/// heading, whose units scale the numbers. Columns are separated as in a list of points.
fn record(text: &str, columns: Columns) -> Result<Vec<Vec<f64>>, String> {
    let mut rows: Vec<Vec<f64>> = Vec::new();
    let mut units: Vec<f64> = Vec::new();
    let mut heading_allowed = true;
    let mut lines = Rows::of(text, Comments::BehindCells);
    while let Some(row) = lines.next().map_err(|fault| fault.to_string())? {
        let (number, line) = (row.line, row.text);
        let numbers: Vec<Option<f64>> = row.numbers().collect();
        let at = |what: String| format!("line {number}: {what}");
        match numbers.iter().copied().collect::<Option<Vec<f64>>>() {
            // a heading has no number in it; a first row with one wrong letter has others
            None if heading_allowed && numbers.iter().all(Option::is_none) => {
                units = columns.units(&row.heading()).map_err(at)?;
            }
            None => {
                return Err(at(format!(
                    "found `{line}`, needed {} numbers: {}",
                    columns.needed(),
                    columns.names
                )));
            }
            Some(mut row) => {
                for (value, unit) in row.iter_mut().zip(&units) {
                    *value *= unit;
                }
                columns.check(&row, rows.last()).map_err(|what| {
                    at(what.unwrap_or_else(|| format!("numbers must be finite, found `{line}`")))
                })?;
                rows.push(row);
            }
        }
        heading_allowed = false;
    }
    if rows.len() < 2 {
        return Err(format!("has {} rows, needs at least two", rows.len()));
    }
    Ok(rows)
}

impl Columns {
    /// Counts of numbers, for errors.
    fn needed(&self) -> String {
        let counts: Vec<String> = self.allowed.iter().map(usize::to_string).collect();
        counts.join(" or ")
    }

    /// Size of the unit of each column by the cells of a heading; s, m, degrees and m/s².
    fn units(&self, cells: &[String]) -> Result<Vec<f64>, String> {
        let size = |(cell, quantity): (&String, &Quantity)| match split(cell, *quantity) {
            (_, "") => Ok(1.0),
            (name, unit) => quantity.unit(unit).ok_or_else(|| {
                let known = quantity.known();
                format!("unit `{unit}` of {name} is not known; write one of {known}")
            }),
        };
        cells.iter().zip(self.quantities).map(size).collect()
    }

    /// Check of a row after the last one; no message for numbers that are not finite.
    fn check(&self, row: &[f64], last: Option<&Vec<f64>>) -> Result<(), Option<String>> {
        if !self.allowed.contains(&row.len()) {
            return Err(Some(format!(
                "found {} columns, needed {}: {}",
                row.len(),
                self.needed(),
                self.names
            )));
        }
        if last.is_some_and(|last| row.len() != last.len()) {
            return Err(Some(format!(
                "found {} columns, the lines before have others",
                row.len()
            )));
        }
        if !row.iter().all(|value| value.is_finite()) {
            return Err(None);
        }
        match last {
            Some(last) if row[0] <= last[0] => {
                Err(Some(format!("time must increase, found {} s", row[0])))
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    reason = "a test may stop where a library may not"
)]
mod tests {
    use super::*;

    #[test]
    fn a_record_reads_with_comments_and_heading() {
        let text = "# paddle\nt [s], x, y, z\n0, 0, 0, 0\r\n0.5, 0.1, 0, 0 # half\n";
        let rows = record(text, DISPLACEMENT).unwrap();
        assert_eq!(rows, [[0.0; 4], [0.5, 0.1, 0.0, 0.0]]);
    }

    /// The heading's units, separators and decimal commas give the rows of the same record in SI.
    #[test]
    fn a_heading_scales_its_columns() {
        let expected = record("0,0,0,0,0,0,0\n0.5,0.25,0,-0.125,90,0,0\n", DISPLACEMENT).unwrap();
        for text in [
            "time [ms],x_mm,y (cm),z [dm],rx [deg],ry,rz\n0,0,0,0,0,0,0\n500,250,0,-1.25,90,0,0\n",
            "\u{feff}t (s);x [cm];y;z [mm];rx;ry;rz\r\n0;0;0;0;0;0;0\r\n0,5;25;0;-125;90;0;0\r\n",
            "t\tx\ty\tz\trx [rad]\try\trz\n0\t0\t0\t0\t0\t0\t0\n0.5\t0.25\t0\t-0.125\t1.5707963267948966\t0\t0\n",
        ] {
            let found = record(text, DISPLACEMENT).unwrap();
            for (row, expected) in found.iter().zip(&expected) {
                // a product with a unit rounds once
                let near = row
                    .iter()
                    .zip(expected)
                    .all(|(a, b)| (a - b).abs() <= 1e-14 * b.abs());
                assert!(near, "{text}: {row:?}");
            }
        }
        let shaken = record("time,a [g]\n0,0\n1,0.5\n", ACCELERATION).unwrap();
        assert_eq!(shaken[1], [1.0, 0.5 * 9.806_65]);
        let unknown = record("t,x [furlong],y,z\n0,0,0,0\n1,1,0,0\n", DISPLACEMENT);
        assert_eq!(
            unknown.unwrap_err(),
            "line 1: unit `furlong` of x is not known; write one of m, mm, cm, dm, km, ft, in"
        );
    }

    #[test]
    fn a_wrong_record_names_its_line() {
        for (text, expected) in [
            ("0,0,0,0\n0,1,0,0\n", "line 2: time must increase"),
            ("0,0,0,0\n1,1,0\n", "line 2: found 3 columns"),
            ("0,0,0,0\n1,1,0,0,0,0,0\n", "the lines before have others"),
            ("O,0,0,0\n1,1,0,0\n", "line 1: found `O,0,0,0`"),
            ("0,0,0,0\nx,1,0,0\n", "line 2: found `x,1,0,0`"),
            ("0,0,0,0\n1,inf,0,0\n", "line 2: numbers must be finite"),
            ("0,0,0,0\n", "has 1 rows"),
        ] {
            let message = record(text, DISPLACEMENT).unwrap_err();
            assert!(message.contains(expected), "{message}");
        }
    }
}
