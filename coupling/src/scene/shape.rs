//! From the shapes of the file to solids in their places.

use std::path::Path;

use nalgebra::{Translation3, Unit, UnitQuaternion};
use riprap_dda::{Isometry, Polyhedron, Shape, Vec3};

use super::error::Problem;
use super::file::{Axis, BlockFile, PlacementFile, ShapeFile};
use super::mesh;
use super::resolve::vec3;

/// The solid of block `index` of the file, turned and shifted into place.
///
/// # Errors
///
/// [`Problem`]s with the path of the shape.
pub fn solid(block: &BlockFile, index: usize, folder: &Path) -> Result<Shape, Vec<Problem>> {
    let shape = build(&block.shape, folder).map_err(|found| {
        let message = format!("block `{}`: {found}", block.name);
        vec![Problem::error(format!("blocks[{index}].shape"), message)]
    })?;
    Ok(shape.transformed(&placement(&block.placement)))
}

fn build(shape: &ShapeFile, folder: &Path) -> Result<Shape, String> {
    let one = |polyhedron: Result<Polyhedron, _>| match polyhedron {
        Ok(polyhedron) => Ok(Shape::Polyhedra(vec![polyhedron])),
        Err(error) => Err(riprap_dda::PolyhedronError::to_string(&error)),
    };
    let points = |list: &[_]| list.iter().copied().map(vec3).collect::<Vec<Vec3>>();
    match shape {
        ShapeFile::Box { min, max } => one(Polyhedron::cuboid(vec3(*min), vec3(*max))),
        ShapeFile::Wedge {
            length,
            height,
            width,
        } => extrusion(
            &[(0.0, 0.0), (*length, 0.0), (0.0, *height)],
            Axis::Y,
            0.0,
            *width,
        ),
        ShapeFile::Hull { points: list } => one(Polyhedron::convex_hull(&points(list))),
        ShapeFile::Polyhedron { vertices, faces } => {
            one(Polyhedron::from_faces(&points(vertices), faces))
        }
        ShapeFile::Extrusion {
            polygon,
            axis,
            from,
            to,
        } => extrusion(polygon, *axis, *from, *to),
        ShapeFile::Sphere { center, radius } => Ok(Shape::Sphere {
            center: vec3(*center),
            radius: *radius,
        }),
        ShapeFile::Mesh { file, scale } => mesh::solid(folder, file, *scale),
    }
}

fn extrusion(polygon: &[(f64, f64)], axis: Axis, from: f64, to: f64) -> Result<Shape, String> {
    let polygon: Vec<[f64; 2]> = polygon.iter().map(|&(a, b)| [a, b]).collect();
    Polyhedron::extrusion(&polygon, axis.index(), from, to)
        .map(Shape::Polyhedra)
        .map_err(|error| error.to_string())
}

/// The turn about a point and the shift after it.
fn placement(file: &PlacementFile) -> Isometry {
    let shift = vec3(file.translate);
    let Some(turn) = &file.rotate else {
        return Isometry::from_parts(Translation3::from(shift), UnitQuaternion::identity());
    };
    let axis = Unit::new_normalize(vec3(turn.axis));
    let rotation = UnitQuaternion::from_axis_angle(&axis, turn.angle_deg.to_radians());
    let about = vec3(turn.about);
    Isometry::from_parts(
        Translation3::from(about - rotation * about + shift),
        rotation,
    )
}
