//! Surfaces from VTK files: legacy `.vtk`, and XML `.vtp` and `.vtu`.
//!
//! The two formats are read in `legacy` and `xml`; their cells become triangles here.

mod legacy;
mod xml;

pub(super) use legacy::read as read_legacy;
pub(super) use xml::read as read_xml;

use riprap_dda::Vec3;

use super::Soup;
use crate::scene::access::fault::Fault;

/// Adds points, three numbers each, and returns the number of the first.
fn push_points(soup: &mut Soup, numbers: &[f64]) -> u64 {
    let first = soup.points.len() as u64;
    let points = numbers.as_chunks::<3>().0;
    soup.points.extend(points.iter().map(|p| Vec3::from(*p)));
    first
}

/// Adds the surface of a cell of one of VTK's types, whose corners count from `first`; points and lines have none.
fn push_cell(soup: &mut Soup, first: u64, kind: u8, corners: &[u64]) -> Result<(), Fault> {
    match kind {
        // triangle, polygon, quad
        5 | 7 | 9 => push_polygon(soup, first, corners),
        6 => push_strip(soup, first, corners),
        // vertex, poly-vertex, line, poly-line
        1..=4 => Ok(()),
        _ => {
            let name = match kind {
                8 => "Pixel",
                10 => "Tetra",
                11 => "Voxel",
                12 => "Hexahedron",
                13 => "Wedge",
                14 => "Pyramid",
                42 => "Polyhedron",
                _ => return Err(unusable(&kind.to_string())),
            };
            Err(unusable(name))
        }
    }
}

fn unusable(kind: &str) -> Fault {
    Fault::Format(format!(
        "has cells of type {kind}; extract the surface and save that"
    ))
}

fn push_polygon(soup: &mut Soup, first: u64, corners: &[u64]) -> Result<(), Fault> {
    let far = |_| Fault::Format("has a cell with a corner that is not there".into());
    let corners: Result<Vec<u32>, _> = corners
        .iter()
        .map(|v| u32::try_from(first.saturating_add(*v)))
        .collect();
    soup.push_polygon(&corners.map_err(far)?)
}

/// Adds a strip, of which every second triangle is reversed.
fn push_strip(soup: &mut Soup, first: u64, corners: &[u64]) -> Result<(), Fault> {
    for (k, triangle) in corners.windows(3).enumerate() {
        let (a, b, c) = (triangle[0], triangle[1], triangle[2]);
        let turned = if k % 2 == 0 { [a, b, c] } else { [b, a, c] };
        push_polygon(soup, first, &turned)?;
    }
    Ok(())
}

fn unreadable(error: impl std::fmt::Display) -> Fault {
    Fault::Format(format!("is not readable as VTK: {error}"))
}

/// Error of corner lists that do not match their lengths.
fn broken_lists() -> Fault {
    Fault::Format("has cells whose corner lists do not add up".into())
}

/// Error of a file without a surface.
fn no_surface() -> Fault {
    Fault::Format("holds a grid, not a surface; extract the surface and save it as .vtp".into())
}
