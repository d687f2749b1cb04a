//! Triangulation of terrain: coarse where it is flat, with the outlines of excavations among its edges.
//!
//! A constrained Delaunay triangulation that starts with the corners of the grid and the outlines and inserts the point of the
//! grid with the largest error until no error exceeds the tolerance (Garland & Heckbert 1995).

use riprap_dda::Vec3;
use spade::{
    ConstrainedDelaunayTriangulation, HasPosition, InsertionError, Point2, Triangulation,
    handles::FixedVertexHandle,
};

use super::grid::Grid;
use super::outline::Outline;

/// Distance of points of the grid from an outline below which they would make slivers; × spacing.
const CLEAR_OF_OUTLINES: f64 = 0.2;

/// Terrain as triangles, counter-clockwise from above.
#[derive(Clone, Debug, PartialEq)]
pub struct Triangles {
    /// Points; m.
    pub points: Vec<Vec3>,
    /// Corners of each triangle.
    pub corners: Vec<[u32; 3]>,
    /// Number of the outline around each triangle.
    pub outline: Vec<Option<usize>>,
}

/// Error of triangulation.
#[derive(Debug, thiserror::Error)]
pub enum TrianglesError {
    /// A side of an outline crosses another side.
    #[error(
        "its side from ({:.2}, {:.2}) to ({:.2}, {:.2}) m crosses another side or outline, or runs along it; draw it so that none does",
        from[0], from[1], to[0], to[1]
    )]
    Crossing {
        /// Number of the outline.
        outline: usize,
        /// m.
        from: [f64; 2],
        /// m.
        to: [f64; 2],
    },
    /// A corner lies beyond the terrain.
    #[error(
        "its corner at ({:.2}, {:.2}) m is not within the terrain, which goes from ({:.2}, {:.2}) to ({:.2}, {:.2}) m",
        at[0], at[1], low[0], low[1], high[0], high[1]
    )]
    Outside {
        /// Number of the outline.
        outline: usize,
        /// m.
        at: [f64; 2],
        /// m.
        low: [f64; 2],
        /// m.
        high: [f64; 2],
    },
    /// Two outlines overlap.
    #[error(
        "it overlaps another outline at ({:.2}, {:.2}) m; draw them side by side", at[0], at[1]
    )]
    Overlap {
        /// Number of the outline.
        outline: usize,
        /// m.
        at: [f64; 2],
    },
    /// A coordinate that is not finite or too large.
    #[error("cannot be triangulated: {0}")]
    Place(#[from] InsertionError),
}

/// A point in plan view with its elevation; m.
#[derive(Clone, Copy)]
struct Node {
    place: Point2<f64>,
    height: f64,
}

impl HasPosition for Node {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.place
    }
}

type Net = ConstrainedDelaunayTriangulation<Node>;

/// Triangles within a tolerance (m) of the points of a grid, except beside outlines. `beneath` are elevations of the
/// surfaces below the outlines, which the triangles within follow, too.
///
/// # Errors
///
/// [`TrianglesError`]
pub fn triangulated(
    grid: &Grid,
    outlines: &[Outline],
    beneath: impl Fn(usize, [f64; 2]) -> f64,
    tolerance: f64,
) -> Result<Triangles, TrianglesError> {
    let mut net = Net::new();
    let [columns, rows] = grid.n;
    for point in [
        [0, 0],
        [columns - 1, 0],
        [0, rows - 1],
        [columns - 1, rows - 1],
    ] {
        net.insert(node(grid, point))?;
    }
    for (number, outline) in outlines.iter().enumerate() {
        constrain(&mut net, grid, number, outline)?;
    }
    let mut is_pending: Vec<bool> = grid
        .points()
        .map(|point| {
            let place = grid.place(point);
            let is_clear =
                |outline: &Outline| CLEAR_OF_OUTLINES * grid.spacing < outline.distance(place);
            outlines.iter().all(is_clear)
        })
        .collect();
    for point in [
        [0, 0],
        [columns - 1, 0],
        [0, rows - 1],
        [columns - 1, rows - 1],
    ] {
        is_pending[grid.index(point)] = false;
    }
    let within: Vec<Option<usize>> = grid
        .points()
        .map(|point| {
            outlines
                .iter()
                .position(|outline| outline.holds(grid.place(point)))
        })
        .collect();
    loop {
        let farthest = farthest_points(&net, grid, &is_pending, |k, place| {
            within[k].map(|outline| beneath(outline, place))
        });
        let mut n_taken = 0;
        for (point, distance) in farthest {
            if tolerance < distance {
                net.insert(node(grid, point))?;
                is_pending[grid.index(point)] = false;
                n_taken += 1;
            }
        }
        if n_taken == 0 {
            break;
        }
    }
    collected(&net, outlines)
}

fn node(grid: &Grid, point: [usize; 2]) -> Node {
    let [x, y] = grid.place(point);
    Node {
        place: Point2::new(x, y),
        height: grid.heights[grid.index(point)],
    }
}

/// Makes the sides of an outline edges of triangles.
fn constrain(
    net: &mut Net,
    grid: &Grid,
    number: usize,
    outline: &Outline,
) -> Result<(), TrianglesError> {
    let (low, high) = (grid.corner, grid.far_corner());
    let mut handles: Vec<FixedVertexHandle> = Vec::new();
    for &at in &outline.corners {
        let is_within = (0..2).all(|axis| low[axis] < at[axis] && at[axis] < high[axis]);
        let height = grid.height(at).filter(|_| is_within);
        let Some(height) = height else {
            return Err(TrianglesError::Outside {
                outline: number,
                at,
                low,
                high,
            });
        };
        handles.push(net.insert(Node {
            place: Point2::new(at[0], at[1]),
            height,
        })?);
    }
    for (k, &from) in handles.iter().enumerate() {
        let next = (k + 1) % handles.len();
        if net.try_add_constraint(from, handles[next]).is_empty() {
            return Err(TrianglesError::Crossing {
                outline: number,
                from: outline.corners[k],
                to: outline.corners[next],
            });
        }
    }
    Ok(())
}

/// For each triangle, the pending point of the grid with the largest vertical distance, and that distance (m).
fn farthest_points(
    net: &Net,
    grid: &Grid,
    is_pending: &[bool],
    beneath: impl Fn(usize, [f64; 2]) -> Option<f64>,
) -> Vec<([usize; 2], f64)> {
    let mut found = Vec::new();
    for face in net.inner_faces() {
        let corners = face.vertices().map(|v| *v.data());
        let [a, b, c] = corners;
        let twice_area = cross(&a, &b, &c.place);
        let range = |axis: usize| {
            let at = |n: &Node| [n.place.x, n.place.y][axis];
            let (low, high) = (
                at(&a).min(at(&b)).min(at(&c)),
                at(&a).max(at(&b)).max(at(&c)),
            );
            let number = |x: f64| (x - grid.corner[axis]) / grid.spacing;
            let first = number(low).ceil().max(0.0) as usize;
            let last = number(high).floor().max(0.0) as usize;
            first..(last + 1).min(grid.n[axis])
        };
        let mut worst: Option<([usize; 2], f64)> = None;
        for j in range(1) {
            for i in range(0) {
                let k = grid.index([i, j]);
                if !is_pending[k] {
                    continue;
                }
                let place = grid.place([i, j]);
                let at = Point2::new(place[0], place[1]);
                let weights = [
                    cross(&b, &c, &at) / twice_area,
                    cross(&c, &a, &at) / twice_area,
                    cross(&a, &b, &at) / twice_area,
                ];
                if weights.iter().any(|&w| w < 0.0) {
                    continue;
                }
                let between = |heights: [f64; 3]| -> f64 {
                    weights.iter().zip(heights).map(|(w, z)| w * z).sum()
                };
                let mut distance = (between(corners.map(|n| n.height)) - grid.heights[k]).abs();
                if let Some(own) = beneath(k, place)
                    && let [Some(a), Some(b), Some(c)] =
                        corners.map(|n| beneath(k, [n.place.x, n.place.y]))
                {
                    distance = distance.max((between([a, b, c]) - own).abs());
                }
                if worst.is_none_or(|(_, most)| most < distance) {
                    worst = Some(([i, j], distance));
                }
            }
        }
        found.extend(worst);
    }
    found
}

/// Twice the area of a triangle; m².
fn cross(a: &Node, b: &Node, at: &Point2<f64>) -> f64 {
    let (a, b) = (a.place, b.place);
    (b.x - a.x) * (at.y - a.y) - (b.y - a.y) * (at.x - a.x)
}

fn collected(net: &Net, outlines: &[Outline]) -> Result<Triangles, TrianglesError> {
    let points = net
        .vertices()
        .map(|v| Vec3::new(v.data().place.x, v.data().place.y, v.data().height))
        .collect();
    let corners: Vec<[u32; 3]> = net
        .inner_faces()
        .map(|face| face.vertices().map(|v| v.fix().index() as u32))
        .collect();
    let owner = |at: [f64; 2]| {
        let mut holders = (0..outlines.len()).filter(|&o| outlines[o].holds(at));
        match (holders.next(), holders.next()) {
            (_, Some(outline)) => Err(TrianglesError::Overlap { outline, at }),
            (owner, None) => Ok(owner),
        }
    };
    let centers = net.inner_faces().map(|face| face.center());
    let outline = centers.map(|center| owner([center.x, center.y]));
    Ok(Triangles {
        points,
        corners,
        outline: outline.collect::<Result<_, _>>()?,
    })
}
