//! Grids of elevations from ESRI ASCII files.

use super::MOST_POINTS;
use crate::scene::access::fault::Fault;
use crate::scene::geometry::terrain::grid::Grid;

/// Header of a raster.
struct Header {
    n_columns: usize,
    n_rows: usize,
    /// Map coordinates of the first column and the last row; m.
    corner: [f64; 2],
    cell_size: f64,
    /// Value of missing elevations.
    no_data: f64,
}

/// Grid of elevations in the content of a file, in map coordinates.
///
/// # Errors
///
/// [`Fault`], with the line and the remedy.
pub fn grid_from(content: &[u8]) -> Result<Grid, Fault> {
    let content = String::from_utf8_lossy(content);
    let (header, first_row) = header(&content)?;
    let mut heights = heights(&content, first_row, &header)?;
    // rows of a file run from north to south
    for row in 0..header.n_rows / 2 {
        let (north, south) = heights.split_at_mut((header.n_rows - 1 - row) * header.n_columns);
        let start = row * header.n_columns;
        north[start..start + header.n_columns].swap_with_slice(&mut south[..header.n_columns]);
    }
    for height in &mut heights {
        if *height == header.no_data {
            *height = f64::NAN;
        }
    }
    Ok(Grid {
        n: [header.n_columns, header.n_rows],
        corner: header.corner,
        spacing: header.cell_size,
        heights,
    })
}

fn refuse(line: usize, what: impl std::fmt::Display) -> Fault {
    Fault::Format(format!("line {line}: {what}"))
}

/// The header and the number of the first line after it, from 0.
fn header(content: &str) -> Result<(Header, usize), Fault> {
    let mut n_columns = None;
    let mut n_rows = None;
    let mut corner = [None, None];
    let mut is_center = [false, false];
    let mut cell_size = None;
    let mut no_data = -9999.0;
    let mut first_row = 0;
    for (k, line) in content.lines().enumerate() {
        let mut words = line.split_whitespace();
        let Some(key) = words.next() else {
            continue;
        };
        if !key.starts_with(|c: char| c.is_ascii_alphabetic()) || key.eq_ignore_ascii_case("nan") {
            first_row = k;
            break;
        }
        let value: f64 = words
            .next()
            .and_then(|word| word.parse().ok())
            .filter(|value: &f64| value.is_finite())
            .ok_or_else(|| refuse(k + 1, format!("`{key}` needs a number after it")))?;
        let count = || {
            let is_count = (2.0..=MOST_POINTS as f64).contains(&value) && value.fract() == 0.0;
            is_count.then_some(value as usize).ok_or_else(|| {
                refuse(
                    k + 1,
                    format!("`{key}` must be a whole number, at least 2, found {value}"),
                )
            })
        };
        match key.to_ascii_lowercase().as_str() {
            "ncols" => n_columns = Some(count()?),
            "nrows" => n_rows = Some(count()?),
            "xllcorner" => corner[0] = Some(value),
            "yllcorner" => corner[1] = Some(value),
            "xllcenter" => (corner[0], is_center[0]) = (Some(value), true),
            "yllcenter" => (corner[1], is_center[1]) = (Some(value), true),
            "cellsize" if value > 0.0 => cell_size = Some(value),
            "cellsize" => {
                return Err(refuse(
                    k + 1,
                    format!("`{key}` must be > 0 m, found {value}"),
                ));
            }
            "nodata_value" => no_data = value,
            _ => {
                let known = "ncols, nrows, xllcorner, yllcorner, xllcenter, yllcenter, cellsize, NODATA_value";
                return Err(refuse(k + 1, format!("`{key}` is none of {known}")));
            }
        }
    }
    let missing = |key: &str| Fault::Format(format!("has no `{key}` before the heights"));
    let cell_size = cell_size.ok_or_else(|| missing("cellsize"))?;
    let at = |axis: usize, key: &str| {
        let value: f64 = corner[axis].ok_or_else(|| missing(key))?;
        let half = if is_center[axis] {
            0.0
        } else {
            0.5 * cell_size
        };
        Ok::<f64, Fault>(value + half)
    };
    let header = Header {
        n_columns: n_columns.ok_or_else(|| missing("ncols"))?,
        n_rows: n_rows.ok_or_else(|| missing("nrows"))?,
        corner: [at(0, "xllcorner")?, at(1, "yllcorner")?],
        cell_size,
        no_data,
    };
    if header.n_columns.saturating_mul(header.n_rows) > MOST_POINTS {
        return Err(Fault::Format(format!(
            "has {} x {} points, more than {MOST_POINTS}; resample it",
            header.n_columns, header.n_rows
        )));
    }
    Ok((header, first_row))
}

/// Elevations row by row from the north, independent of line breaks.
fn heights(content: &str, first_row: usize, header: &Header) -> Result<Vec<f64>, Fault> {
    let n = header.n_columns * header.n_rows;
    // a header may promise more than the file has
    let mut heights = Vec::with_capacity(n.min(content.len() / 2 + 1));
    for (k, line) in content.lines().enumerate().skip(first_row) {
        for word in line.split_whitespace() {
            let height = word
                .parse()
                .ok()
                .filter(|height: &f64| height.is_finite())
                .ok_or_else(|| refuse(k + 1, format!("`{word}` is not a height")))?;
            heights.push(height);
        }
    }
    if heights.len() != n {
        return Err(Fault::Format(format!(
            "has {} heights; {} columns and {} rows need {n}",
            heights.len(),
            header.n_columns,
            header.n_rows
        )));
    }
    Ok(heights)
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    const GRID: &str = "ncols 3\nnrows 2\nxllcorner 100\nyllcorner 200\ncellsize 10\nNODATA_value -1\n\
                        5 6 7\n1 2 3\n";

    #[test]
    fn faults_name_the_line() {
        let fault = |content: &str| grid_from(content.as_bytes()).unwrap_err().to_string();
        for (content, expected) in [
            (
                GRID.replace("1 2 3", "1 2 x"),
                "line 8: `x` is not a height",
            ),
            (
                GRID.replace("1 2 3", "1 2"),
                "has 5 heights; 3 columns and 2 rows need 6",
            ),
            (
                GRID.replace("cellsize 10", "cellsize 0"),
                "line 5: `cellsize` must be > 0 m, found 0",
            ),
            (
                GRID.replace("nrows 2", "nrows 1"),
                "line 2: `nrows` must be a whole number, at least 2, found 1",
            ),
            (
                GRID.replace("nrows 2\n", ""),
                "has no `nrows` before the heights",
            ),
            (
                GRID.replace("nrows 2", "rows 2"),
                "line 2: `rows` is none of ncols",
            ),
        ] {
            let found = fault(&content);
            assert!(found.starts_with(expected), "{found}");
        }
    }
}
