//! Polygons in plan view.

use crate::files::features::{Feature, Form};
use crate::scene::access::Access;
use crate::scene::file::{OutlineFile, Triple};
use crate::scene::geometry::crs::Crs;
use crate::scene::geometry::features;

/// A polygon in plan view.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Corners, counter-clockwise; m.
    pub corners: Vec<[f64; 2]>,
}

impl Outline {
    /// Polygon of a scene, and the reference system of its file; map coordinates are those of files, `origin` is that of the
    /// scene in them.
    ///
    /// # Errors
    ///
    /// A message on the fault.
    pub fn read(
        file: &OutlineFile,
        origin: Triple,
        access: &Access,
    ) -> Result<(Self, Option<Crs>), String> {
        let (corners, crs) = match file {
            OutlineFile::Corners(corners) => (corners.iter().map(|&(x, y)| [x, y]).collect(), None),
            OutlineFile::OnMap(corners) => {
                let shifted = |&(x, y): &(f64, f64)| [x - origin.0, y - origin.1];
                (corners.iter().map(shifted).collect(), None)
            }
            OutlineFile::File(name) => {
                let map = features::read(access, name, origin).map_err(|e| e.to_string())?;
                let ring = ring(&map.list).map_err(|what| format!("`{name}` {what}"))?;
                (ring, map.crs)
            }
        };
        Ok((Self::new(corners)?, crs))
    }

    /// Polygon of a file in map coordinates.
    ///
    /// # Errors
    ///
    /// A message on the fault.
    pub fn on_map(name: &str, access: &Access) -> Result<Self, String> {
        let file = OutlineFile::File(name.to_owned());
        Ok(Self::read(&file, (0.0, 0.0, 0.0), access)?.0)
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

    /// Sides, each from one corner to the next; m.
    pub fn sides(&self) -> impl Iterator<Item = ([f64; 2], [f64; 2])> + '_ {
        let next = self.corners.iter().cycle().skip(1);
        self.corners.iter().copied().zip(next.copied())
    }

    /// True for a point inside, by the crossings of a ray along x.
    pub fn holds(&self, [x, y]: [f64; 2]) -> bool {
        self.crossings(y).filter(|&at| x < at).count() % 2 == 1
    }

    /// x where the sides cross a line along x; m.
    pub fn crossings(&self, y: f64) -> impl Iterator<Item = f64> + '_ {
        self.sides()
            .filter(move |([_, ay], [_, by])| (*ay <= y) != (*by <= y))
            .map(move |([ax, ay], [bx, by])| ax + (y - ay) / (by - ay) * (bx - ax))
    }
}

/// Corners of the only polygon or line of a file, or its points in their order.
fn ring(list: &[Feature]) -> Result<Vec<[f64; 2]>, String> {
    let flat = |[x, y, _]: &[f64; 3]| [*x, *y];
    let is_point = |feature: &Feature| matches!(feature.form, Form::Point(_));
    match list {
        all if all.iter().all(is_point) => {
            let points = all.iter().flat_map(|feature| feature.form.points());
            Ok(points.map(flat).collect())
        }
        [one] => Ok(one.form.points().iter().map(flat).collect()),
        _ => {
            let shapes = list.iter().filter(|feature| !is_point(feature)).count();
            Err(format!(
                "has {shapes} polygons or lines, an outline is one; save the one of this slide in a file of its own"
            ))
        }
    }
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
        let mut crossed: Vec<f64> = outline.crossings(1.5).collect();
        crossed.sort_by(f64::total_cmp);
        assert_eq!(crossed, [0.0, 1.0]);
    }

    /// A square by corners of the scene, of the map, and by files of the map.
    #[test]
    fn outlines_are_drawn_in_the_scene_or_on_the_map() {
        let folder = tempfile::tempdir().unwrap();
        for (file, text) in [
            ("a.csv", "x,y\n101,201\n103,201\n103,203\n101,203\n"),
            (
                "b.txt",
                "\u{feff}id;E;N\r\n1;101,0;201\r\n2;103;201\r\n3;103;203\r\n4;101;203\r\n",
            ),
            (
                "c.geojson",
                r#"{"type": "Polygon", "coordinates": [[[101, 201], [101, 203], [103, 203], [103, 201], [101, 201]]]}"#,
            ),
        ] {
            std::fs::write(folder.path().join(file), text).unwrap();
        }
        let access = Access::of(folder.path());
        let read = |file: OutlineFile| Outline::read(&file, (100.0, 200.0, 0.0), &access);
        let square = vec![(1.0, 1.0), (3.0, 1.0), (3.0, 3.0), (1.0, 3.0)];
        let (expected, none) = read(OutlineFile::Corners(square.clone())).unwrap();
        assert_eq!((expected.area(), none), (4.0, None));
        let on_map = square.iter().map(|(x, y)| (x + 100.0, y + 200.0)).collect();
        assert_eq!(read(OutlineFile::OnMap(on_map)).unwrap().0, expected);
        for file in ["a.csv", "b.txt", "c.geojson"] {
            let (found, _) = read(OutlineFile::File(file.into())).unwrap();
            assert_eq!(
                (found.area(), found.holds([2.0, 2.0])),
                (4.0, true),
                "{file}"
            );
        }
        std::fs::write(
            folder.path().join("two.geojson"),
            r#"{"type": "MultiLineString", "coordinates": [[[101, 201], [101, 203]], [[103, 203], [103, 201]]]}"#,
        )
        .unwrap();
        assert_eq!(
            read(OutlineFile::File("two.geojson".into())).unwrap_err(),
            "`two.geojson` has 2 polygons or lines, an outline is one; save the one of this slide in a file of its own"
        );
    }

    #[test]
    fn lines_and_points_are_no_outlines() {
        let refused = |corners: &[[f64; 2]]| Outline::new(corners.to_vec()).unwrap_err();
        assert!(refused(&[[0.0, 0.0], [1.0, 0.0], [0.0, 0.0]]).contains("at least three"));
        assert!(refused(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]).contains("no area"));
        assert!(refused(&[[0.0, 0.0], [f64::NAN, 1.0], [2.0, 2.0]]).contains("corner 2"));
    }
}
