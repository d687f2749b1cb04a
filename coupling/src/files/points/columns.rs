//! Meaning of the columns of a list of points.

use super::Points;
use crate::files::rows::{Row, Separator};
use crate::files::units::{Quantity, split};

/// Names of the columns of a coordinate, in lower case; the first is that of messages.
const X: [&str; 7] = ["x", "easting", "e", "east", "x_coord", "xcoord", "utm_x"];
const Y: [&str; 7] = ["y", "northing", "n", "north", "y_coord", "ycoord", "utm_y"];
const Z: [&str; 9] = [
    "z",
    "elevation",
    "height",
    "h",
    "elev",
    "altitude",
    "alt",
    "z_coord",
    "level",
];
const NAMES: [&str; 7] = ["name", "id", "label", "gauge", "station", "point", "fid"];
const DEGREES: [&str; 8] = [
    "lon",
    "lat",
    "long",
    "longitude",
    "latitude",
    "lng",
    "lambda",
    "phi",
];
/// Names of coordinates in messages.
const CALLED: [&str; 3] = [
    "x (or easting, E)",
    "y (or northing, N)",
    "z (or elevation)",
];

/// Places of the columns.
pub(super) struct Columns {
    separator: Separator,
    pub(super) has_header: bool,
    n: usize,
    /// Column of each coordinate and the size of its unit; m.
    axes: [Option<(usize, f64)>; 3],
    name: Option<usize>,
}

impl Columns {
    /// Columns by the cells of the first line, which may be a header.
    pub(super) fn of(head: &Row<'_>, separator: Separator) -> Result<Self, String> {
        let numbers: Vec<bool> = head.numbers().map(|number| number.is_some()).collect();
        if numbers.iter().filter(|is_number| **is_number).count() >= 2 {
            Ok(Self::by_place(&numbers, separator))
        } else if numbers == [true] {
            Err("found one number, needed are x and y".into())
        } else {
            Self::by_name(&head.heading(), separator)
        }
    }

    /// The first three numbers are x, y and z; the first text is the name.
    fn by_place(numbers: &[bool], separator: Separator) -> Self {
        let places = |wanted: bool| (0..numbers.len()).filter(move |k| numbers[*k] == wanted);
        let mut axes = places(true);
        Self {
            separator,
            has_header: false,
            n: numbers.len(),
            axes: [(); 3].map(|()| axes.next().map(|k| (k, 1.0))),
            name: places(false).next(),
        }
    }

    fn by_name(cells: &[String], separator: Separator) -> Result<Self, String> {
        let split: Vec<(String, &str)> = (cells.iter())
            .map(|cell| split(cell, Quantity::Length))
            .map(|(name, unit)| (name.to_lowercase(), unit))
            .collect();
        let listed = |names: &[&str]| -> Vec<usize> {
            let is_listed = |k: &usize| names.contains(&split[*k].0.as_str());
            (0..split.len()).filter(is_listed).collect()
        };
        let degrees = listed(&DEGREES);
        if !degrees.is_empty() {
            let found: Vec<&str> = degrees.iter().map(|k| cells[*k].as_str()).collect();
            return Err(format!(
                "columns {} are in degrees; project them: x, y in meters",
                found.join(", ")
            ));
        }
        let mut axes = [None; 3];
        for (axis, names) in [&X[..], &Y[..], &Z[..]].into_iter().enumerate() {
            axes[axis] = match listed(names)[..] {
                [] if axis == 2 => None,
                [] => {
                    let (called, found) = (CALLED[axis], cells.join(", "));
                    return Err(format!("no column is {called}, found {found}"));
                }
                [k] => Some((k, size_of(&split[k])?)),
                [..] => return Err(format!("two columns are {}", CALLED[axis])),
            };
        }
        Ok(Self {
            separator,
            has_header: true,
            n: cells.len(),
            axes,
            name: listed(&NAMES).first().copied(),
        })
    }

    /// Makes z a must, and leaves names out.
    pub(super) fn in_space(&mut self) -> Result<(), String> {
        self.name = None;
        match (self.axes[2], self.has_header) {
            (Some(_), _) => Ok(()),
            (None, true) => Err(format!("no column is {}", CALLED[2])),
            (None, false) => Err("found two numbers, needed are x, y and z".into()),
        }
    }

    /// Whether there is no header and at least one number beside x, y and z.
    pub(super) fn has_more_than_a_point(&self) -> bool {
        !self.has_header && self.axes[0].map(|(k, _)| k) == Some(0) && self.n > 3
    }

    /// Appends the point of a line.
    pub(super) fn point(&self, row: &Row<'_>, points: &mut Points) -> Result<(), String> {
        let n = row.cells().count();
        if n != self.n {
            return Err(self.other_count(n));
        }
        let mut position = [f64::NAN; 3];
        for (k, cell) in row.cells().enumerate() {
            if self.name == Some(k) {
                points.names.push(cell.to_owned());
            }
            let of_axis = |axis: &usize| self.axes[*axis].is_some_and(|(place, _)| place == k);
            let Some(axis) = (0..3).find(of_axis) else {
                continue;
            };
            let unit = self.axes[axis].map_or(1.0, |(_, unit)| unit);
            let value = self.separator.number(cell);
            let value = value.filter(|value| value.is_finite()).ok_or_else(|| {
                let name = ["x", "y", "z"][axis];
                format!("{name} is `{cell}`, needed is a number")
            })?;
            position[axis] = if unit == 1.0 { value } else { unit * value };
        }
        points.positions.push(position);
        Ok(())
    }

    fn other_count(&self, found: usize) -> String {
        let plural = if found == 1 { "" } else { "s" };
        let head = if self.has_header {
            "the header"
        } else {
            "the first line"
        };
        let comma = if self.separator == Separator::Comma && found > self.n {
            "; decimal commas need semicolons between columns"
        } else {
            ""
        };
        format!("found {found} column{plural}, {head} has {}{comma}", self.n)
    }
}

fn size_of((name, unit): &(String, &str)) -> Result<f64, String> {
    if unit.is_empty() {
        return Ok(1.0);
    }
    Quantity::Length.unit(unit).ok_or_else(|| {
        let known = Quantity::Length.known();
        format!("unit `{unit}` of {name} is not known; write one of {known}")
    })
}
