//! Geometry of blocks.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Axis, Triple};

/// Geometry of a block.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum ShapeFile {
    /// An axis-aligned box.
    Box {
        /// Lower corner; m.
        #[schemars(extend("x-unit" = "m"))]
        min: Triple,
        /// Upper corner; m.
        #[schemars(extend("x-unit" = "m"))]
        max: Triple,
    },
    /// A right-triangular prism: corners (0,0), (length,0), (0,height) in the x-z plane, extruded from y = 0 to y =
    /// width.
    Wedge {
        /// Leg along x; m.
        #[schemars(extend("x-unit" = "m", "exclusiveMinimum" = 0))]
        length: f64,
        /// Leg along z; m.
        #[schemars(extend("x-unit" = "m", "exclusiveMinimum" = 0))]
        height: f64,
        /// Along y; m.
        #[schemars(extend("x-unit" = "m", "exclusiveMinimum" = 0))]
        width: f64,
    },
    /// The convex hull of points.
    Hull {
        /// At least four points, not coplanar; m.
        #[schemars(extend("x-unit" = "m"))]
        points: Vec<Triple>,
    },
    /// A closed polyhedron; faces counter-clockwise seen from outside.
    Polyhedron {
        /// Corners; m.
        #[schemars(extend("x-unit" = "m"))]
        vertices: Vec<Triple>,
        /// Corner numbers of each face.
        faces: Vec<Vec<u32>>,
    },
    /// Adjoining closed polyhedra, as one rigid union.
    Polyhedra {
        /// The convex parts.
        parts: Vec<PartFile>,
    },
    /// A polygon extruded along an axis; a non-convex one becomes a rigid union of convex parts.
    Extrusion {
        /// Corners in the plane across the axis, in the order of the remaining axes (for `Y`: x, z); either sense of
        /// rotation; m.
        #[schemars(extend("x-unit" = "m"))]
        polygon: Vec<(f64, f64)>,
        /// Direction of the extrusion.
        axis: Axis,
        /// Start along the axis; m.
        #[schemars(extend("x-unit" = "m"))]
        from: f64,
        /// End along the axis; m.
        #[schemars(extend("x-unit" = "m"))]
        to: f64,
    },
    /// A sphere.
    Sphere {
        /// Center; m.
        #[schemars(extend("x-unit" = "m"))]
        center: Triple,
        /// Radius; m.
        #[schemars(extend("x-unit" = "m", "exclusiveMinimum" = 0))]
        radius: f64,
    },
    /// A closed triangle mesh, STL, OBJ, PLY or VTK. A connected shell that is not convex is split into convex parts; several
    /// shells become one rigid union, and as the boundary of a rock mass a block each.
    Mesh {
        /// Path, relative to the scene file.
        file: String,
        /// Size of the unit of the file: 0.001 for millimeters; m.
        #[schemars(extend("x-unit" = "m", "exclusiveMinimum" = 0))]
        scale: f64,
        /// Limits of the split of a shell that is not convex.
        #[serde(default)]
        split: SplitFile,
    },
    /// An open or closed surface of triangles, STL, OBJ, PLY or VTK, of a fixed block: solid on the side opposite to the
    /// normals, which must all point to the same side.
    Surface {
        /// Path, relative to the scene file.
        file: String,
        /// Size of the unit of the file: 0.001 for millimeters; m.
        #[schemars(extend("x-unit" = "m", "exclusiveMinimum" = 0))]
        scale: f64,
    },
    /// Terrain of a fixed block from an ESRI ASCII grid; each cell is split along its shorter diagonal.
    Raster {
        /// Path, relative to the scene file.
        file: String,
        /// Map coordinates of x = y = 0; m.
        #[serde(default)]
        #[schemars(extend("x-unit" = "m"))]
        origin: (f64, f64),
    },
    /// The scene's `terrain`, of a fixed block.
    Terrain,
}

/// Limits of the split of a mesh into convex parts, which touch but do not overlap: it ends at either. `check` states the errors
/// of volume, center of mass and moments of inertia.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SplitFile {
    /// Largest number of parts of a shell; contacts cost time by the part.
    #[serde(default = "default_most_parts")]
    pub most_parts: u32,
    /// Volume that the parts may have more than the shell, over its volume; an error above 3 % is a warning, one above 10 % is
    /// rejected.
    #[serde(default = "default_volume_error")]
    #[schemars(extend("x-unit" = "-"))]
    pub volume_error: f64,
}

fn default_most_parts() -> u32 {
    32
}

fn default_volume_error() -> f64 {
    0.01
}

impl Default for SplitFile {
    fn default() -> Self {
        Self {
            most_parts: default_most_parts(),
            volume_error: default_volume_error(),
        }
    }
}

/// A closed convex polyhedron; faces counter-clockwise seen from outside.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PartFile {
    /// Corners; m.
    #[schemars(extend("x-unit" = "m"))]
    pub vertices: Vec<Triple>,
    /// Corner numbers of each face.
    pub faces: Vec<Vec<u32>>,
}
