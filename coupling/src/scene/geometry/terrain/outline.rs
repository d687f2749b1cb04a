//! Polygons in plan view.

use crate::files::table::table_from;
use crate::scene::access::Access;
use crate::scene::file::OutlineFile;

/// A polygon in plan view.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Corners, counter-clockwise; m.
    pub corners: Vec<[f64; 2]>,
}

impl Outline {
    /// Polygon of a scene; files are in map coordinates, `origin` is that of the scene in them.
    ///
    /// # Errors
    ///
    /// A message on the fault.
    pub fn read(file: &OutlineFile, origin: (f64, f64), access: &Access) -> Result<Self, String> {
        let corners = match file {
            OutlineFile::Corners(corners) => corners.iter().map(|&(x, y)| [x, y]).collect(),
            OutlineFile::File(name) => corners_of(name, origin, access)?,
        };
        Self::new(corners)
    }

    /// A polygon of at least three corners that enclose an area.
    ///
    /// # Errors
    ///
    /// A message on the fault.
    pub fn new(mut corners: Vec<[f64; 2]>) -> Result<Self, String> {
        // a ring may be closed by its first corner
        if 1 < corners.len() && corners.first() == corners.last() {
            corners.pop();
        }
        if corners.len() < 3 {
            return Err(format!(
                "an outline needs at least three corners, found {}",
                corners.len()
            ));
        }
        if let Some(k) = corners
            .iter()
            .position(|c| !c.iter().all(|x| x.is_finite()))
        {
            return Err(format!("corner {} of the outline is not finite", k + 1));
        }
        let outline = Self { corners };
        let area = outline.signed_area();
        if !(area.abs() > 0.0) {
            return Err("the outline encloses no area".into());
        }
        let mut corners = outline.corners;
        if area < 0.0 {
            corners.reverse();
        }
        Ok(Self { corners })
    }

    /// Enclosed area; m².
    pub fn area(&self) -> f64 {
        self.signed_area()
    }

    /// Signed area by the shoelace formula from the first corner, positive if counter-clockwise; m².
    fn signed_area(&self) -> f64 {
        let [x0, y0] = self.corners[0];
        let twice = self.corners.windows(2).map(|pair| {
            let [[ax, ay], [bx, by]] = [pair[0], pair[1]];
            (ax - x0) * (by - y0) - (bx - x0) * (ay - y0)
        });
        0.5 * twice.sum::<f64>()
    }

    fn sides(&self) -> impl Iterator<Item = ([f64; 2], [f64; 2])> + '_ {
        let next = self.corners.iter().cycle().skip(1);
        self.corners.iter().copied().zip(next.copied())
    }

    /// True for a point inside, by the crossings of a ray along x.
    pub fn holds(&self, [x, y]: [f64; 2]) -> bool {
        let is_crossed = |&([ax, ay], [bx, by]): &([f64; 2], [f64; 2])| {
            (ay <= y) != (by <= y) && x < ax + (y - ay) / (by - ay) * (bx - ax)
        };
        self.sides().filter(is_crossed).count() % 2 == 1
    }

    /// Distance of a point from the closest side; m.
    pub fn distance(&self, [x, y]: [f64; 2]) -> f64 {
        let to = |([ax, ay], [bx, by]): ([f64; 2], [f64; 2])| {
            let (dx, dy) = (bx - ax, by - ay);
            let share = ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy);
            // a side of no length has no share
            let share = if share.is_nan() {
                0.0
            } else {
                share.clamp(0.0, 1.0)
            };
            (ax + share * dx - x).hypot(ay + share * dy - y)
        };
        self.sides().map(to).fold(f64::INFINITY, f64::min)
    }
}

fn corners_of(name: &str, origin: (f64, f64), access: &Access) -> Result<Vec<[f64; 2]>, String> {
    let bytes = access
        .read(name)
        .map_err(|fault| format!("`{name}`: {fault}"))?;
    let text =
        String::from_utf8(bytes).map_err(|error| format!("`{name}` is not text: {error}"))?;
    let table = table_from(std::path::Path::new(name), &text).map_err(|error| error.to_string())?;
    let column = |axis: &str| table.column(axis).map_err(|error| error.to_string());
    let (x, y) = (column("x")?, column("y")?);
    let corners = x.iter().zip(y);
    Ok(corners.map(|(x, y)| [x - origin.0, y - origin.1]).collect())
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    /// An L of three squares, clockwise and closed.
    fn corner_house() -> Outline {
        let ring = [
            [0.0, 0.0],
            [0.0, 2.0],
            [1.0, 2.0],
            [1.0, 1.0],
            [2.0, 1.0],
            [2.0, 0.0],
            [0.0, 0.0],
        ];
        Outline::new(ring.to_vec()).unwrap()
    }

    #[test]
    fn an_outline_knows_its_area_and_what_it_holds() {
        let outline = corner_house();
        assert_eq!((outline.corners.len(), outline.area()), (6, 3.0));
        for (place, expected) in [
            ([0.5, 1.5], true),
            ([1.5, 0.5], true),
            ([1.5, 1.5], false),
            ([-0.5, 0.5], false),
        ] {
            assert_eq!(outline.holds(place), expected, "{place:?}");
        }
        assert_eq!(outline.distance([1.5, 1.5]), 0.5);
        assert_eq!(outline.distance([0.5, 0.25]), 0.25);
    }

    #[test]
    fn lines_and_points_are_no_outlines() {
        let refused = |corners: &[[f64; 2]]| Outline::new(corners.to_vec()).unwrap_err();
        assert!(refused(&[[0.0, 0.0], [1.0, 0.0], [0.0, 0.0]]).contains("at least three"));
        assert!(refused(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]).contains("no area"));
        assert!(refused(&[[0.0, 0.0], [f64::NAN, 1.0], [2.0, 2.0]]).contains("corner 2"));
    }
}
