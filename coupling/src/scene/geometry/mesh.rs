//! Blocks from mesh files: STL, OBJ, PLY and VTK.
//!
//! A file is read into a soup of triangles (`read`), coincident corners are welded and the triangles sorted into closed
//! shells (`shells`). A convex shell becomes the hull of its corners, with coplanar triangles joined, another several convex
//! parts (`split`).

mod deviation;
mod obj;
mod overlap;
mod ply;
mod shells;
mod split;
mod stl;
mod vtk;

use std::path::Path;
use std::sync::Arc;

use overlap::overlap;
use riprap_dda::{MassProperties, Polyhedron, Shape, Surface, Vec3, volume};
use shells::{Seam, Shell};

use crate::scene::access::Access;
pub use crate::scene::access::fault::{Fault, MeshError};
use crate::scene::access::fault::{
    LARGEST_VOLUME_ERROR, MOST_TRIANGLES, MOST_TRIANGLES_OF_A_SHELL, MOST_TRIANGLES_OF_A_SPLIT,
};
pub use deviation::Deviation;
pub use split::Split;

/// Tolerance of convexity: gain of volume of the hull, over the volume. STL and most VTK files carry
/// 24-bit coordinates, so that a flat side of many triangles is rough by 1e-7 of its size; the
/// volume that a block gains by its hull stays far below any density's uncertainty.
const CONVEX_TOLERANCE: f64 = 1e-6;

/// Summary of a mesh file, for inspection.
#[derive(Clone, Debug, PartialEq)]
pub struct Survey {
    /// True if every edge has two sides of consistent orientation.
    pub is_watertight: bool,
    /// Number of closed shells, of connected pieces if open.
    pub n_shells: usize,
    /// Number of triangles with an area, polygons cut into fans.
    pub n_triangles: usize,
    /// Volume, centroid and second moment of what it encloses, meaningless unless watertight.
    pub drawn: MassProperties,
    /// Lower corner of the box around it; m.
    pub min: Vec3,
    /// Upper corner of the box around it; m.
    pub max: Vec3,
}

/// Triangles as a file lists them, three corners each; m.
#[derive(Clone, Debug, Default, PartialEq)]
struct Soup {
    points: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl Soup {
    /// Adds a polygon as a fan about its first corner.
    fn push_polygon(&mut self, corners: &[u32]) -> Result<(), Fault> {
        let n = self.points.len();
        if let Some(&corner) = corners.iter().find(|&&corner| corner as usize >= n) {
            return Err(Fault::Format(format!(
                "a face names point {corner}, but there are only {n} (0 to {})",
                n.saturating_sub(1)
            )));
        }
        for pair in corners.windows(2).skip(1) {
            self.triangles.push([corners[0], pair[0], pair[1]]);
        }
        if self.triangles.len() > MOST_TRIANGLES {
            return Err(Fault::TooManyTriangles);
        }
        Ok(())
    }
}

/// The solid of a mesh file, `scale` meters per unit: the convex parts of all closed shells.
///
/// # Errors
///
/// [`MeshError`], which names the file, the location and the remedy.
pub fn solid(access: &Access, file: &str, scale: f64, split: Split) -> Result<Shape, MeshError> {
    let solids = solids(access, file, scale, split)?;
    Ok(Shape::Polyhedra(solids.into_iter().flatten().collect()))
}

/// The convex parts of each closed shell of a mesh file, `scale` meters per unit.
///
/// # Errors
///
/// [`MeshError`], as for [`solid`].
pub fn solids(
    access: &Access,
    file: &str,
    scale: f64,
    split: Split,
) -> Result<Vec<Vec<Polyhedron>>, MeshError> {
    with_content(access, file, |content, extension| {
        solids_from(content, extension, scale, split)
    })
}

/// The solid of the content of a mesh file whose name ends in `extension`, as [`solid`].
///
/// # Errors
///
/// [`Fault`].
pub fn solid_from(content: &[u8], extension: &str, scale: f64) -> Result<Shape, Fault> {
    let solids = solids_from(content, extension, scale, Split::default())?;
    Ok(Shape::Polyhedra(solids.into_iter().flatten().collect()))
}

fn solids_from(
    content: &[u8],
    extension: &str,
    scale: f64,
    split: Split,
) -> Result<Vec<Vec<Polyhedron>>, Fault> {
    let sorted = shells::sort(&read(content, extension, scale)?);
    match sorted.seam {
        Seam::Closed => convex_parts(&sorted.shells, split),
        Seam::Open { n_edges, at } => Err(Fault::Open { n_edges, at }),
        Seam::Unoriented { at } => Err(Fault::Unoriented { at }),
    }
}

/// The surface of a mesh file, `scale` meters per unit, oriented as in the file.
///
/// # Errors
///
/// [`MeshError`], as for [`solid`]; the surface need not be closed.
pub fn surface(access: &Access, file: &str, scale: f64) -> Result<Shape, MeshError> {
    with_content(access, file, |content, extension| {
        surface_from(content, extension, scale)
    })
}

/// The surface of the content of a mesh file whose name ends in `extension`, as [`surface`].
///
/// # Errors
///
/// [`Fault`].
pub fn surface_from(content: &[u8], extension: &str, scale: f64) -> Result<Shape, Fault> {
    let Soup { points, triangles } = shells::weld(&read(content, extension, scale)?);
    Ok(Shape::Surface(Arc::new(Surface::new(points, triangles)?)))
}

/// Summary of a mesh file, closed and convex or not.
///
/// # Errors
///
/// [`MeshError`] if the file cannot be read or holds no triangles.
pub fn survey(access: &Access, file: &str, scale: f64) -> Result<Survey, MeshError> {
    with_content(access, file, |content, extension| {
        survey_from(content, extension, scale)
    })
}

/// Summary of the content of a mesh file with a given `extension`, as [`survey`].
///
/// # Errors
///
/// [`Fault`].
pub fn survey_from(content: &[u8], extension: &str, scale: f64) -> Result<Survey, Fault> {
    let sorted = shells::sort(&read(content, extension, scale)?);
    let corners = sorted.shells.iter().flat_map(|shell| &shell.points);
    let nothing = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    let (min, max) = corners.fold(nothing, |(min, max), x| (min.inf(x), max.sup(x)));
    Ok(Survey {
        is_watertight: sorted.seam == Seam::Closed,
        n_shells: sorted.shells.len(),
        n_triangles: sorted.shells.iter().map(|s| s.triangles.len()).sum(),
        drawn: shells::mass_properties(&sorted.shells),
        min,
        max,
    })
}

/// Result of `make` for a file of the scene, from its content and extension.
fn with_content<T>(
    access: &Access,
    file: &str,
    make: impl FnOnce(&[u8], &str) -> Result<T, Fault>,
) -> Result<T, MeshError> {
    let extension = Path::new(file)
        .extension()
        .map(|e| e.to_string_lossy().to_lowercase())
        .unwrap_or_default();
    access
        .read(file)
        .and_then(|content| make(&content, &extension))
        .map_err(|fault| MeshError {
            file: file.to_owned(),
            fault,
        })
}

fn read(content: &[u8], extension: &str, scale: f64) -> Result<Soup, Fault> {
    let mut soup = match extension {
        "stl" => stl::read(content)?,
        "obj" => obj::read(content)?,
        "ply" => ply::read(content)?,
        "vtk" => vtk::read_legacy(content)?,
        "vtp" | "vtu" => vtk::read_xml(content)?,
        _ => return Err(Fault::UnknownKind),
    };
    for point in &mut soup.points {
        *point *= scale;
    }
    // only corners that a triangle uses matter; some programs leave NaN in unused points
    for (t, triangle) in soup.triangles.iter().enumerate() {
        let is_bad = |&v: &u32| !soup.points[v as usize].iter().all(|x| x.is_finite());
        if let Some(k) = triangle.iter().position(is_bad) {
            return Err(Fault::NotFinite {
                corner: k + 1,
                triangle: t + 1,
            });
        }
    }
    if soup.triangles.is_empty() {
        return Err(Fault::Empty);
    }
    Ok(soup)
}

/// The convex parts of each closed shell.
fn convex_parts(shells: &[Shell], split: Split) -> Result<Vec<Vec<Polyhedron>>, Fault> {
    let n_shells = shells.len();
    if n_shells == 0 {
        return Err(Fault::Empty);
    }
    let parts = (1..).zip(shells);
    let parts = parts.map(|(number, shell)| parts_of(shell, (number, n_shells), split));
    let parts: Vec<Vec<Polyhedron>> = parts.collect::<Result<_, _>>()?;
    match overlap(&parts) {
        Some((first, second, depth)) => Err(Fault::Overlapping {
            shells: [first + 1, second + 1],
            n_shells,
            depth,
        }),
        None => Ok(parts),
    }
}

/// The convex parts of a shell: one, the hull, if it is convex.
fn parts_of(
    shell: &Shell,
    (number, n_shells): (usize, usize),
    split: Split,
) -> Result<Vec<Polyhedron>, Fault> {
    let too_fine = |most: usize| Fault::TooFine {
        shell: number,
        n: shell.triangles.len(),
        most,
    };
    if shell.triangles.len() > MOST_TRIANGLES_OF_A_SHELL {
        return Err(too_fine(MOST_TRIANGLES_OF_A_SHELL));
    }
    let drawn = shell.volume();
    if drawn < 0.0 {
        return Err(Fault::InsideOut {
            shell: number,
            n_shells,
        });
    }
    let hull = Polyhedron::convex_hull(&shell.points).map_err(|source| Fault::NoHull {
        shell: number,
        source,
    })?;
    let around = volume(&hull);
    if (around - drawn).abs() <= CONVEX_TOLERANCE * around {
        return Ok(vec![hull]);
    }
    if shell.triangles.len() > MOST_TRIANGLES_OF_A_SPLIT {
        return Err(too_fine(MOST_TRIANGLES_OF_A_SPLIT));
    }
    let parts = split::split(shell, &hull, split)?;
    let made: f64 = parts.iter().map(volume).sum();
    if (made - drawn).abs() > LARGEST_VOLUME_ERROR * drawn {
        return Err(Fault::NotConvex {
            shell: number,
            n_shells,
            n_parts: parts.len(),
            error: made / drawn - 1.0,
        });
    }
    Ok(parts)
}
