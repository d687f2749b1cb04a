//! Triangulation of terrain: coarse where it is flat, with the outlines of excavations among its edges, and without slivers.
//!
//! A constrained Delaunay triangulation that starts with the corners of the grid and the outlines and inserts the point of the
//! grid with the largest error until no error exceeds the tolerance (Garland & Heckbert 1995), then refines slivers (Ruppert 1995)
//! with points of the grid.

mod field;
mod mesher;
mod refine;
mod sides;

use riprap_dda::Vec3;
use spade::{InsertionError, Triangulation as _};

use super::grid::Grid;
use super::outline::Outline;
use field::Field;
pub use field::Fit;
use mesher::Mesher;
use refine::square_of_smallest_sine;
use sides::sides;

/// Terrain as triangles, counter-clockwise from above.
#[derive(Clone, Debug, PartialEq)]
pub struct Triangles {
    /// Points; m.
    pub points: Vec<Vec3>,
    /// Corners of each triangle.
    pub corners: Vec<[u32; 3]>,
    /// Number of the outline around each triangle.
    pub outline: Vec<Option<usize>>,
    /// Their errors and angles.
    pub quality: Quality,
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

/// Quality of triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quality {
    /// Distances from the points of the grid.
    pub fit: Fit,
    /// Smallest angle in plan view of the triangles away from outlines; rad.
    pub smallest_angle: f64,
    /// Smallest angle in plan view of the triangles that meet an outline, the largest possible without any; rad.
    pub smallest_angle_beside: f64,
}

/// Triangles within a tolerance (m) of the points of a grid, except beside outlines. `beneath` are elevations of the
/// surfaces below the outlines, which the triangles within follow, too.
///
/// No angle in plan view is below 20 degrees, but for triangles that meet an outline and those of a plane.
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
    let sides = sides(grid, outlines)?;
    let field = Field::new(grid, outlines, beneath);
    let mut mesher = Mesher::new(field, sides, tolerance)?;
    mesher.run()?;
    collected(&mesher, outlines)
}

fn collected<B: Fn(usize, [f64; 2]) -> f64>(
    mesher: &Mesher<'_, B>,
    outlines: &[Outline],
) -> Result<Triangles, TrianglesError> {
    let net = &mesher.net;
    let points = net.vertices().map(|v| v.data().x).collect();
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
    let center = |corners: &[Vec3; 3]| {
        let [x, y, _] = ((corners[0] + corners[1] + corners[2]) / 3.0).into();
        [x, y]
    };
    let points: Vec<Vec3> = points;
    let outline = corners
        .iter()
        .map(|corners| owner(center(&corners.map(|v| points[v as usize]))));
    let outline = outline.collect::<Result<_, _>>()?;
    Ok(Triangles {
        points,
        corners,
        outline,
        quality: quality(mesher),
    })
}

fn quality<B: Fn(usize, [f64; 2]) -> f64>(mesher: &Mesher<'_, B>) -> Quality {
    let mut fit = Fit::default();
    // squares of sines of the smallest angles: 60 degrees at most
    let (mut away, mut beside) = (0.75_f64, 0.75_f64);
    for face in mesher.net.inner_faces() {
        let corners = mesher.corners(face.fix());
        mesher.field.fit(&corners, &mut fit);
        let square = square_of_smallest_sine(&corners);
        if face.vertices().iter().any(|v| v.data().is_on_outline) {
            beside = beside.min(square);
        } else {
            away = away.min(square);
        }
    }
    Quality {
        fit,
        smallest_angle: away.sqrt().asin(),
        smallest_angle_beside: beside.sqrt().asin(),
    }
}
