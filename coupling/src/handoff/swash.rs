//! Files for SWASH: bottom, water level, current, and series of the lines, by its manual (version 11.01A, READINP and BOUNDCOND).
//!
//! | file | content |
//! |---|---|
//! | `bottom.txt` | positive down from the level of rest, rows from the south (`idla` 3) |
//! | `level.txt` | surface over the level of rest |
//! | `current.txt` | all components along x, then all along y |
//! | `NAME_discharge.txt`, `NAME_u1.txt`, ... | time as hhmmss.sss and value, of a line: m²/s of its length, m/s from the top layer down |
//! | `INPUT` | commands that read them |

use std::fmt::Write as _;
use std::path::Path;

use super::formats::{NO_DATA, Sheet, made};
use super::lines::LEVELS;
use crate::files::table::TableData;
use crate::files::vtk::replace_file;
use crate::output::observe::ObserveError;
use crate::scene::resolved::recording::PlanLine;

/// Seconds as SWASH's default notation of time, option 7.
fn clock(time: f64) -> String {
    let milliseconds = (time * 1e3).round() as u64;
    let [seconds, rest] = [milliseconds / 1000, milliseconds % 1000];
    let (hours, minutes) = (seconds / 3600, seconds / 60 % 60);
    format!("{hours:02}{minutes:02}{:02}.{rest:03}", seconds % 60)
}

impl Sheet<'_> {
    /// Bottom, water level, current and series of lines for SWASH, with an `INPUT` that reads them.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] names the file.
    pub fn write_swash(
        &self,
        lines: (&[(String, PlanLine)], Option<&TableData>),
        folder: &Path,
    ) -> Result<(), ObserveError> {
        let folder = made(&folder.join("swash"))?;
        // where there is no ground it is land
        let bottom: Vec<f64> = self.bed().iter().map(|z| -z).collect();
        let velocity =
            |axis: usize| -> Vec<f64> { self.columns.velocity.iter().map(|v| v[axis]).collect() };
        let current = self.rows(&velocity(0), false) + &self.rows(&velocity(1), false);
        for (name, text) in [
            ("bottom.txt", self.rows(&bottom, false)),
            ("level.txt", self.rows(&self.eta(), false)),
            ("current.txt", current),
            ("INPUT", self.swash_input()),
        ] {
            replace_file(&folder.join(name), &[text.as_bytes()])?;
        }
        let (lines, Some(table)) = lines else {
            return Ok(());
        };
        for (name, line) in lines {
            write_series((name, *line), table, &folder)?;
        }
        Ok(())
    }

    fn swash_input(&self) -> String {
        let ([nx, ny], [dx, dy]) = (self.n(), self.columns.raster.side);
        let [mx, my] = [nx.saturating_sub(1), ny.saturating_sub(1)];
        let (x, y) = (self.centers(0)[0], self.centers(1)[0]);
        let grid = format!("REG {x:.3} {y:.3} 0. {mx} {my} {dx} {dy}");
        let (width, height) = (mx as f64 * dx, my as f64 * dy);
        format!(
            "$ {title}, handed over at {time} s\n\
             PROJ 'handoff' '1'\n\
             MODE NONSTAT TWOD\n\
             CGRID REG {x:.3} {y:.3} 0. {width} {height} {mx} {my}\n\
             VERT 2\n\
             INPGRID BOTTOM {grid} EXC {NO_DATA}\nREADINP BOTTOM 1. 'bottom.txt' 3 0 FREE\n\
             INPGRID WLEV {grid}\nREADINP WLEV 1. 'level.txt' 3 0 FREE\n\
             INPGRID CURRENT {grid}\nREADINP CURRENT 1. 'current.txt' 3 0 FREE\n\
             $ a line of the hand-off as a boundary instead: its discharge, or velocities, the first layer at the top\n\
             $ BOU SIDE WEST CCW BTYPE DISCH CON SERIES 'NAME_discharge.txt'\n\
             $ BOU SIDE WEST CCW BTYPE VEL LAY 1 CON SERIES 'NAME_u1.txt'\n\
             NONHYD BOX\n\
             $ to be chosen: friction, breaking, sponges, output\n\
             COMPUTE {start} 0.05 SEC {end}\nSTOP\n",
            title = self.title.replace('\n', " "),
            time = self.time,
            start = clock(self.time),
            end = clock(self.time + 60.0),
        )
    }
}

/// Series of a line: discharge over its length, and velocities from the top down.
fn write_series(
    (name, PlanLine { from, to }): (&str, PlanLine),
    table: &TableData,
    folder: &Path,
) -> Result<(), ObserveError> {
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    let write = |file: String, column: &str, scale: f64| -> Result<(), ObserveError> {
        let (times, values) = (table.column("time")?, table.column(column)?);
        let mut text = String::new();
        for (time, value) in times.iter().zip(values) {
            // dry, where nothing flows
            let value = if value.is_finite() {
                value * scale
            } else {
                0.0
            };
            let _ = writeln!(text, "{} {value:.6}", clock(*time));
        }
        replace_file(&folder.join(file), &[text.as_bytes()])?;
        Ok(())
    };
    let discharge = format!("{name}.discharge");
    write(format!("{name}_discharge.txt"), &discharge, 1.0 / length)?;
    for layer in 1..=LEVELS {
        let level = LEVELS + 1 - layer;
        write(
            format!("{name}_u{layer}.txt"),
            &format!("{name}.u{level}"),
            1.0,
        )?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_hours_minutes_and_seconds() {
        assert_eq!(clock(20.25), "000020.250");
        assert_eq!(clock(3723.0004), "010203.000");
        assert_eq!(clock(59.9996), "000100.000");
    }
}
