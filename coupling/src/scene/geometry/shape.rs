//! Solids of blocks, from the shapes of the file.

use nalgebra::{Translation3, Unit, UnitQuaternion};
use riprap_dda::{Isometry, Polyhedron, PolyhedronError, Shape, Vec3};

use super::mesh;
use super::raster;
use super::terrain::Terrain;
use crate::messages::Code;
use crate::scene::access::Access;
use crate::scene::access::fault::MeshError;
use crate::scene::error::Problem;
use crate::scene::file::vec3;
use crate::scene::file::{Axis, BlockFile, PartFile, PlacementFile, ShapeFile};

/// The solid of block `index` of the file in its place, in a scene without terrain.
///
/// # Errors
///
/// [`Problem`]s with the path of the faulty field.
pub fn solid(block: &BlockFile, index: usize, access: &Access) -> Result<Shape, Vec<Problem>> {
    solid_on(block, index, access, None)
}

/// The solid of block `index` of the file in its place, in a scene with or without terrain.
///
/// # Errors
///
/// [`Problem`]s with the path of the faulty field.
pub fn solid_on(
    block: &BlockFile,
    index: usize,
    access: &Access,
    terrain: Option<&Terrain>,
) -> Result<Shape, Vec<Problem>> {
    let refused = |code: Code, field: &str, found: String| {
        let message = format!("block `{}`: {found}", block.name);
        vec![Problem::error(
            code,
            format!("blocks[{index}].{field}"),
            message,
        )]
    };
    let placement = placement(&block.placement).ok_or_else(|| {
        refused(
            Code::UnusableDirection,
            "placement.rotate.axis",
            "the axis has no direction".into(),
        )
    })?;
    match build(&block.shape, access, terrain) {
        Ok(shape) => Ok(shape.transformed(&placement)),
        Err(found) => {
            let field = blamed(&block.shape, &found);
            Err(refused(
                found.code(),
                &format!("shape{field}"),
                found.to_string(),
            ))
        }
    }
}

/// Reason why a shape is not a solid.
#[derive(Debug, thiserror::Error)]
enum ShapeError {
    #[error(transparent)]
    Polyhedron(#[from] PolyhedronError),
    #[error(transparent)]
    Mesh(#[from] MeshError),
    #[error("radius must be finite and > 0, got {0}")]
    Radius(f64),
    #[error("the scene has no terrain; say with `terrain` where its heights come from")]
    NoTerrain,
    #[error("scale must be finite and > 0, got {0}")]
    Scale(f64),
}

impl ShapeError {
    fn code(&self) -> Code {
        match self {
            Self::Polyhedron(_) => Code::InvalidShape,
            Self::Mesh(error) => error.fault.code(),
            Self::Radius(_) | Self::Scale(_) => Code::ValueOutOfRange,
            Self::NoTerrain => Code::TerrainBlock,
        }
    }
}

fn build(
    shape: &ShapeFile,
    access: &Access,
    terrain: Option<&Terrain>,
) -> Result<Shape, ShapeError> {
    let one = |part| Shape::Polyhedra(vec![part]);
    let points = |list: &[_]| list.iter().copied().map(vec3).collect::<Vec<Vec3>>();
    let is_positive = |value: f64| value.is_finite() && value > 0.0;
    Ok(match shape {
        ShapeFile::Box { min, max } => one(Polyhedron::cuboid(vec3(*min), vec3(*max))?),
        ShapeFile::Wedge {
            length,
            height,
            width,
        } => {
            let corners = [(0.0, 0.0), (*length, 0.0), (0.0, *height)];
            extrusion(&corners, Axis::Y, 0.0, *width)?
        }
        ShapeFile::Hull { points: list } => one(Polyhedron::convex_hull(&points(list))?),
        ShapeFile::Polyhedron { vertices, faces } => {
            one(Polyhedron::from_faces(&points(vertices), faces)?)
        }
        ShapeFile::Polyhedra { parts } => {
            let build =
                |part: &PartFile| Polyhedron::from_faces(&points(&part.vertices), &part.faces);
            Shape::Polyhedra(parts.iter().map(build).collect::<Result<_, _>>()?)
        }
        ShapeFile::Extrusion {
            polygon,
            axis,
            from,
            to,
        } => extrusion(polygon, *axis, *from, *to)?,
        ShapeFile::Sphere { radius, .. } if !is_positive(*radius) => {
            return Err(ShapeError::Radius(*radius));
        }
        ShapeFile::Sphere { center, radius } => Shape::Sphere {
            center: vec3(*center),
            radius: *radius,
        },
        ShapeFile::Mesh { scale, .. } | ShapeFile::Surface { scale, .. }
            if !is_positive(*scale) =>
        {
            return Err(ShapeError::Scale(*scale));
        }
        ShapeFile::Mesh { file, scale, split } => {
            mesh::solid(access, file, *scale, (*split).into())?
        }
        ShapeFile::Surface { file, scale } => mesh::surface(access, file, *scale)?,
        ShapeFile::Raster { file, origin } => raster::terrain(access, file, *origin)?,
        ShapeFile::Terrain => {
            let terrain = terrain.ok_or(ShapeError::NoTerrain)?;
            Shape::Surface(terrain.surface.clone())
        }
    })
}

/// The field of a shape that an error refers to, with its dot.
fn blamed(shape: &ShapeFile, error: &ShapeError) -> &'static str {
    match (shape, error) {
        (_, ShapeError::Radius(_)) => ".radius",
        (_, ShapeError::Scale(_)) => ".scale",
        (ShapeFile::Hull { .. }, _) => ".points",
        (ShapeFile::Polyhedra { .. }, _) => ".parts",
        (ShapeFile::Mesh { .. } | ShapeFile::Surface { .. } | ShapeFile::Raster { .. }, _) => {
            ".file"
        }
        (
            ShapeFile::Polyhedron { .. },
            ShapeError::Polyhedron(
                PolyhedronError::NotFinite { .. }
                | PolyhedronError::RepeatedVertex { .. }
                | PolyhedronError::UnusedVertex { .. },
            ),
        ) => ".vertices",
        (
            ShapeFile::Polyhedron { .. },
            ShapeError::Polyhedron(PolyhedronError::NoVolume { .. }),
        ) => "",
        (ShapeFile::Polyhedron { .. }, _) => ".faces",
        (ShapeFile::Extrusion { from, to, .. }, _) if from == to => ".to",
        (ShapeFile::Extrusion { .. }, _) => ".polygon",
        _ => "",
    }
}

fn extrusion(
    polygon: &[(f64, f64)],
    axis: Axis,
    from: f64,
    to: f64,
) -> Result<Shape, PolyhedronError> {
    let polygon: Vec<[f64; 2]> = polygon.iter().map(|&(a, b)| [a, b]).collect();
    Polyhedron::extrusion(&polygon, axis.index(), from, to).map(Shape::Polyhedra)
}

/// Rotation about a point and translation after it; `None` if the axis has no direction.
pub(in crate::scene) fn placement(file: &PlacementFile) -> Option<Isometry> {
    let shift = vec3(file.translate);
    let Some(turn) = &file.rotate else {
        let still = UnitQuaternion::identity();
        return Some(Isometry::from_parts(Translation3::from(shift), still));
    };
    let axis = Unit::try_new(vec3(turn.axis), 0.0)?;
    let rotation = UnitQuaternion::from_axis_angle(&axis, turn.angle_deg.to_radians());
    let about = vec3(turn.about);
    let translation = Translation3::from(about - rotation * about + shift);
    Some(Isometry::from_parts(translation, rotation))
}
