//! Points in text: lists of gauges, corners of outlines, clouds of surveys.
//!
//! Columns are separated by commas, semicolons, tabs or spaces; beside semicolons and tabs numbers may have a decimal
//! comma. A header names the columns, `x y z` or `easting northing elevation`, in any case and with units; without one the
//! numbers of a line are x, y and z. A column of text is the name of the points. `#` starts a comment.

mod columns;

use super::rows::{Comments, Row, RowFault, Rows};
use columns::Columns;

/// Points and their names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    /// Positions, z NaN where there is none; m.
    pub positions: Vec<[f64; 3]>,
    /// Names; empty, or one for each point.
    pub names: Vec<String>,
}

/// A line that is no point.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {what}")]
pub struct PointFault {
    /// Number of the line, from 1.
    pub line: usize,
    /// What was found and what would be right.
    pub what: String,
}

/// Points of a text.
///
/// # Errors
///
/// [`PointFault`], for the first wrong line.
pub fn points_from(text: &str) -> Result<Points, PointFault> {
    read(text, |_| Ok(()))
}

/// Points of a text in space, without their names; m.
///
/// # Errors
///
/// [`PointFault`], for the first wrong line, and for lines without z or that are numbered instead of named.
pub fn cloud_from(text: &str) -> Result<Vec<[f64; 3]>, PointFault> {
    let mut may_count = false;
    let points = read(text, |columns| {
        may_count = columns.has_more_than_a_point();
        columns.in_space()
    })?
    .positions;
    // a number before x, y and z counts the points, and no header says so
    let counts = |(k, x): (usize, &[f64; 3])| x[0] == k as f64 + points[0][0];
    let is_counted =
        may_count && points.len() >= LEAST_COUNTED && [0.0, 1.0].contains(&points[0][0]);
    if is_counted && points.iter().enumerate().all(counts) {
        let what = "the first column counts the lines; name the columns in a header: id x y z";
        return Err(PointFault {
            line: 1,
            what: what.into(),
        });
    }
    Ok(points)
}

/// Fewest points whose x counts from 0 or 1 by chance or on purpose in no survey.
const LEAST_COUNTED: usize = 5;

fn read(
    text: &str,
    mut wanted: impl FnMut(&mut Columns) -> Result<(), String>,
) -> Result<Points, PointFault> {
    let refuse = |line: usize, what: String| PointFault { line, what };
    let mut rows = Rows::of(text, Comments::Lines);
    let separator = rows.separator();
    let Some(head) = rows.next()? else {
        return Err(refuse(
            1,
            "has no points; needed are columns x, y and, for terrain, z".into(),
        ));
    };
    let first = head.line;
    let mut columns = Columns::of(&head, separator).map_err(|what| refuse(first, what))?;
    wanted(&mut columns).map_err(|what| refuse(first, what))?;
    let mut points = Points::default();
    let mut add = |row: &Row<'_>| {
        let added = columns.point(row, &mut points);
        added.map_err(|what| refuse(row.line, what))
    };
    if !columns.has_header {
        add(&head)?;
    }
    while let Some(row) = rows.next()? {
        add(&row)?;
    }
    if points.positions.is_empty() {
        return Err(refuse(first, "has a header and no points below it".into()));
    }
    Ok(points)
}

impl From<RowFault> for PointFault {
    fn from(RowFault { line, what }: RowFault) -> Self {
        Self { line, what }
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    const THREE: [[f64; 3]; 2] = [
        [412_100.5, 6_904_200.0, 12.25],
        [412_110.0, 6_904_210.5, -3.0],
    ];

    #[test]
    fn separators_headers_and_decimal_commas() {
        for text in [
            "x,y,z\n412100.5,6904200,12.25\n412110,6904210.5,-3\n",
            "\u{feff}X;Y;Z\r\n412100,5;6904200;12,25\r\n412110;6904210,5;-3\r\n",
            "Easting\tNorthing\tElevation\n412100,5\t6904200\t12,25\n412110\t6904210,5\t-3\n",
            "E N h\n412100.5 6904200 12.25\n 412110   6904210.5 -3\n",
            "412100.5 6904200 12.25\n412110 6904210.5 -3\n",
            "# survey\n\nid, northing [m], easting (m), height_m\na, 6904200, 412100.5, 12.25\nb, 6904210.5, 412110, -3\n",
            "412100.5,6904200,12.25,17,255,255\n412110,6904210.5,-3,18,0,0\n",
            "\"x\";\"y\";\"z [cm]\"\n412100,5;6904200;1225\n412110;6904210,5;-300\n",
            "a 412100.5 6904200 12.25\nb 412110 6904210.5 -3\n",
        ] {
            assert_eq!(points_from(text).unwrap().positions, THREE, "{text}");
        }
    }

    #[test]
    fn a_column_of_text_names_the_points() {
        for text in [
            "name;x;y\nnorth pier;1,5;2\nquay;3;4\n",
            "x,y,label\n1.5,2,north pier\n3,4,quay\n",
            "Gauge,E,N\nnorth pier,1.5,2\nquay,3,4\n",
        ] {
            let points = points_from(text).unwrap();
            assert_eq!(points.names, ["north pier", "quay"], "{text}");
            assert_eq!(points.positions[1][..2], [3.0, 4.0]);
            assert!(points.positions[1][2].is_nan());
        }
        let numbered = points_from("id,x,y\n7,1,2\n").unwrap();
        assert_eq!(numbered.names, ["7"]);
    }

    #[test]
    fn a_cloud_has_heights_and_needs_no_names() {
        let cloud = cloud_from("a 412100.5 6904200 12.25\nb 412110 6904210.5 -3\n");
        assert_eq!(cloud.unwrap(), THREE);
        for (text, expected) in [
            ("x,y\n1,2\n", "line 1: no column is z (or elevation)"),
            (
                "1 2\n3 4\n",
                "line 1: found two numbers, needed are x, y and z",
            ),
            ("1 2 3\n4 5 nan\n", "line 2: z is `nan`, needed is a number"),
            (
                "1 7 2 3\n2 8 2 3\n3 9 2 3\n4 7 3 3\n5 8 3 3\n",
                "line 1: the first column counts the lines; name the columns in a header: id x y z",
            ),
        ] {
            assert_eq!(cloud_from(text).unwrap_err().to_string(), expected);
        }
        // a section along x has three columns
        assert_eq!(
            cloud_from("1 0 2\n2 0 2\n3 0 2\n4 0 3\n5 0 3\n")
                .unwrap()
                .len(),
            5
        );
    }

    #[test]
    fn a_wrong_file_answers_with_its_line_and_what_is_right() {
        for (text, expected) in [
            (
                "",
                "line 1: has no points; needed are columns x, y and, for terrain, z",
            ),
            (
                "a,b\n1,2\n",
                "line 1: no column is x (or easting, E), found a, b",
            ),
            (
                "x,z\n1,2\n",
                "line 1: no column is y (or northing, N), found x, z",
            ),
            (
                "lon,lat\n7,62\n",
                "line 1: columns lon, lat are in degrees; project them: x, y in meters",
            ),
            ("x,y\n1,2\n3\n", "line 3: found 1 column, the header has 2"),
            (
                "x,y\n1,2\n3,4,5\n",
                "line 3: found 3 columns, the header has 2; decimal commas need semicolons between columns",
            ),
            ("x,y\n1,2\n3,4m\n", "line 3: y is `4m`, needed is a number"),
            (
                "x;y\n1;2\n3;inf\n",
                "line 3: y is `inf`, needed is a number",
            ),
            (
                "x [furlong],y\n1,2\n",
                "line 1: unit `furlong` of x is not known; write one of m, mm, cm, dm, km, ft, in",
            ),
            (
                "x,x,y\n1,2,3\n",
                "line 1: two columns are x (or easting, E)",
            ),
            (
                "1 2 3\n4 5\n",
                "line 2: found 2 columns, the first line has 3",
            ),
            ("7\n", "line 1: found one number, needed are x and y"),
            ("x,y\n", "line 1: has a header and no points below it"),
        ] {
            assert_eq!(points_from(text).unwrap_err().to_string(), expected);
        }
    }
}
