//! Prescribed motions: formulas and measured records.

use std::path::Path;

use riprap_dda::{Motion, PrescribedMotion, Vec3};

use super::error::Problem;
use super::file::MotionFile;
use super::mesh::file_inside;
use super::resolve::vec3;

/// The motion that a block of the file asks for; `path` is where the file says so.
///
/// # Errors
///
/// A [`Problem`] that names the record and its line.
pub fn motion(file: &MotionFile, path: &str, folder: &Path) -> Result<Motion, Problem> {
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
        MotionFile::Table { file } => {
            let (time, displacement) = file_inside(folder, file)
                .map_err(|error| error.to_string())
                .and_then(|path| {
                    std::fs::read_to_string(&path).map_err(|e| format!("cannot read `{file}`: {e}"))
                })
                .and_then(|text| record(&text).map_err(|found| format!("`{file}` {found}")))
                .map_err(|message| Problem::error(format!("{path}.file"), message))?;
            Ok(Motion::Prescribed(PrescribedMotion::Table {
                time,
                displacement,
            }))
        }
    }
}

/// Times and displacements of a record: four numbers a line, `#` comments, one optional heading.
fn record(text: &str) -> Result<(Vec<f64>, Vec<Vec3>), String> {
    let (mut times, mut displacements) = (Vec::new(), Vec::new());
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
            // a heading has no number in it; a first row with one wrong letter has three
            Err(_) if heading_allowed && !has_number(line) => {}
            Err(_) => {
                return Err(format!(
                    "line {number}: found `{line}`, needed four numbers t, x, y, z"
                ));
            }
            Ok(row) => {
                let [t, x, y, z] = row[..] else {
                    return Err(format!(
                        "line {number}: found {} columns, needed four: time, x, y, z",
                        row.len()
                    ));
                };
                if !row.iter().all(|value| value.is_finite()) {
                    return Err(format!(
                        "line {number}: numbers must be finite, found `{line}`"
                    ));
                }
                if times.last().is_some_and(|&last| t <= last) {
                    return Err(format!("line {number}: time must increase, found {t} s"));
                }
                times.push(t);
                displacements.push(Vec3::new(x, y, z));
            }
        }
        heading_allowed = false;
    }
    if times.len() < 2 {
        return Err(format!("has {} rows, needs at least two", times.len()));
    }
    Ok((times, displacements))
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
        let (time, displacement) =
            record("# paddle\nt [s], x, y, z\n0, 0, 0, 0\r\n0.5, 0.1, 0, 0 # half\n").unwrap();
        assert_eq!(time, [0.0, 0.5]);
        assert_eq!(displacement[1].x, 0.1);
    }

    #[test]
    fn a_wrong_record_names_its_line() {
        for (text, expected) in [
            ("0,0,0,0\n0,1,0,0\n", "line 2: time must increase"),
            ("0,0,0,0\n1,1,0\n", "line 2: found 3 columns"),
            ("O,0,0,0\n1,1,0,0\n", "line 1: found `O,0,0,0`"),
            ("0,0,0,0\nx,1,0,0\n", "line 2: found `x,1,0,0`"),
            ("0,0,0,0\n1,inf,0,0\n", "line 2: numbers must be finite"),
            ("0,0,0,0\n", "has 1 rows"),
        ] {
            let message = record(text).unwrap_err();
            assert!(message.contains(expected), "{message}");
        }
    }
}
