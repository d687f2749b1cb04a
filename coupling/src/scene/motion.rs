//! Prescribed motions: formulas and measured records.

use riprap_dda::{Accelerogram, Motion, PrescribedMotion, Vec3};

use super::access::Access;
use super::error::Problem;
use super::file::MotionFile;
use super::file::vec3;

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
                Problem::error(format!("{path}.direction"), "the motion has no direction")
            })?;
            Ok(Motion::Prescribed(PrescribedMotion::Sinusoid {
                direction,
                amplitude: *amplitude,
                period: *period,
                phase: phase_deg.to_radians(),
                ramp: *ramp,
            }))
        }
        MotionFile::Table { file: name } | MotionFile::Shaking { file: name, .. } => {
            let text = text_of(access, name)
                .map_err(|message| Problem::error(format!("{path}.file"), message))?;
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
            let columns = "time, x, y, z, and where it turns the rotation vector rx, ry, rz";
            let rows = rows(file, text, path, (columns, &[4, 7]))?;
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
                Problem::error(format!("{path}.direction"), "the shaking has no direction")
            })?;
            let rows = rows(file, text, path, ("time, acceleration", &[2]))?;
            let interval = rows[1][0] - rows[0][0];
            let uneven = rows
                .iter()
                .enumerate()
                .find(|(k, row)| (row[0] - *k as f64 * interval).abs() > 1e-3 * interval);
            if let Some((_, row)) = uneven {
                return Err(Problem::error(
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
        MotionFile::Free | MotionFile::Fixed | MotionFile::Sinusoid { .. } => {
            Err(Problem::error(path, "the motion is not read from a record"))
        }
    }
}

fn vec3_of(numbers: &[f64]) -> Vec3 {
    Vec3::from_column_slice(numbers)
}

/// The text of a record that the scene names.
fn text_of(access: &Access, file: &str) -> Result<String, String> {
    access
        .read(file)
        .map_err(|fault| format!("`{file}`: {fault}"))
        .and_then(|bytes| {
            String::from_utf8(bytes).map_err(|error| format!("`{file}` is not text: {error}"))
        })
}

/// The rows of a record that the scene names at `path`, with columns as for [`record`].
fn rows(
    file: &str,
    text: &str,
    path: &str,
    columns: (&str, &[usize]),
) -> Result<Vec<Vec<f64>>, Problem> {
    record(text, columns)
        .map_err(|found| Problem::error(format!("{path}.file"), format!("`{file}` {found}")))
}

/// Rows of a record: one of the allowed counts of numbers on every line, the first an increasing time; `#` comments, one optional heading. `columns` names them for errors.
fn record(text: &str, (columns, allowed): (&str, &[usize])) -> Result<Vec<Vec<f64>>, String> {
    let needed = || {
        let counts: Vec<String> = allowed.iter().map(usize::to_string).collect();
        counts.join(" or ")
    };
    let mut rows: Vec<Vec<f64>> = Vec::new();
    let mut heading_allowed = true;
    for (index, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default().trim();
        if line.is_empty() {
            continue;
        }
        let numbers: Result<Vec<f64>, _> =
            line.split(',').map(|field| field.trim().parse()).collect();
        let number = index + 1;
        match numbers {
            // a heading has no number in it; a first row with one wrong letter has others
            Err(_) if heading_allowed && !has_number(line) => {}
            Err(_) => {
                return Err(format!(
                    "line {number}: found `{line}`, needed {} numbers: {columns}",
                    needed()
                ));
            }
            Ok(found) => {
                let row = found;
                if !allowed.contains(&row.len()) {
                    return Err(format!(
                        "line {number}: found {} columns, needed {}: {columns}",
                        row.len(),
                        needed()
                    ));
                }
                if rows.last().is_some_and(|last| row.len() != last.len()) {
                    return Err(format!(
                        "line {number}: found {} columns, the lines before have others",
                        row.len()
                    ));
                }
                if !row.iter().all(|value| value.is_finite()) {
                    return Err(format!(
                        "line {number}: numbers must be finite, found `{line}`"
                    ));
                }
                if rows.last().is_some_and(|last| row[0] <= last[0]) {
                    return Err(format!(
                        "line {number}: time must increase, found {} s",
                        row[0]
                    ));
                }
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

fn has_number(line: &str) -> bool {
    line.split(',')
        .any(|field| field.trim().parse::<f64>().is_ok())
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
        let rows = record(text, ("time, x, y, z", &[4])).unwrap();
        assert_eq!(rows, [[0.0; 4], [0.5, 0.1, 0.0, 0.0]]);
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
            let message = record(text, ("time, x, y, z", &[4, 7])).unwrap_err();
            assert!(message.contains(expected), "{message}");
        }
    }
}
