//! PLY, text or binary of either byte order: vertices `x`, `y`, `z` and faces of any number of corners; other elements and
//! properties are skipped.
//!
//! Format: Turk (1994), The PLY polygon file format. A reader of its own, because the usual one builds a table of named values for
//! each vertex, and takes memory for as many as the header claims.

mod body;
mod header;

use riprap_dda::Vec3;

use super::Soup;
use crate::scene::access::fault::{Fault, MOST_TRIANGLES};
use body::Body;
use header::{Element, Header, Kind};

/// Names of the list of corners of a face.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Faces of any number of corners, one after another.
#[derive(Default)]
struct Faces {
    corners: Vec<u32>,
    /// End of each face in the list of corners.
    ends: Vec<usize>,
}

pub(super) fn read(content: &[u8]) -> Result<Soup, Fault> {
    let (header, body) = Header::read(content)?;
    let mut body = Body::new(header.encoding, body, header.n_lines);
    let (mut points, mut faces) = (Vec::new(), Faces::default());
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => read_points(element, &mut body, &mut points)?,
            "face" => read_faces(element, &mut body, &mut faces)?,
            _ => skip(element, &mut body)?,
        }
    }
    let mut soup = Soup {
        points,
        triangles: Vec::new(),
    };
    let mut start = 0;
    for end in faces.ends {
        soup.push_polygon(&faces.corners[start..end])?;
        start = end;
    }
    Ok(soup)
}

fn read_points(element: &Element, body: &mut Body, points: &mut Vec<Vec3>) -> Result<(), Fault> {
    let axis = ["x", "y", "z"].map(|name| element.scalar(name));
    let [Some(x), Some(y), Some(z)] = axis else {
        return Err(Fault::Format(
            "has vertices without the properties x, y and z".into(),
        ));
    };
    let mut numbers = Vec::new();
    for item in 0..element.n {
        body.begin(element, item)?;
        numbers.clear();
        for property in &element.properties {
            // lists keep a place, so that properties are counted as in the header
            numbers.push(match property.kind {
                Kind::Scalar(scalar) => body.number(scalar)?,
                Kind::List { .. } => {
                    body.list(property.kind, |_| Ok(()))?;
                    0.0
                }
            });
        }
        body.end()?;
        points.push(Vec3::new(numbers[x], numbers[y], numbers[z]));
    }
    Ok(())
}

fn read_faces(element: &Element, body: &mut Body, faces: &mut Faces) -> Result<(), Fault> {
    let names = element.properties.iter().map(|p| p.name.as_str());
    let Some(of_corners) = names.clone().position(|name| CORNERS.contains(&name)) else {
        return Err(Fault::Format(
            "has faces without the list `vertex_indices`".into(),
        ));
    };
    for item in 0..element.n {
        body.begin(element, item)?;
        for (k, property) in element.properties.iter().enumerate() {
            let is_corners = k == of_corners;
            body.list(property.kind, |number| {
                if is_corners {
                    faces.corners.push(corner(number)?);
                }
                Ok(())
            })?;
        }
        body.end()?;
        faces.ends.push(faces.corners.len());
        // faces of less than three corners make no triangles, but take memory
        if faces.ends.len() > MOST_TRIANGLES {
            return Err(Fault::TooManyTriangles);
        }
    }
    Ok(())
}

fn corner(number: f64) -> Result<u32, Fault> {
    if number.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&number) {
        Ok(number as u32)
    } else {
        Err(Fault::Format(format!(
            "a face names point {number}; points are counted from 0"
        )))
    }
}

fn skip(element: &Element, body: &mut Body) -> Result<(), Fault> {
    // nothing to read in a binary file, however many
    if element.properties.is_empty() {
        return Ok(());
    }
    for item in 0..element.n {
        body.begin(element, item)?;
        for property in &element.properties {
            body.list(property.kind, |_| Ok(()))?;
        }
        body.end()?;
    }
    Ok(())
}
