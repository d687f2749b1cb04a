//! Digital terrain model, and the rock that slides off it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{DeformableFile, JointSetFile, SliversFile, Triple, one};

/// Elevations in plan view from rasters and surveys: the ground of a block with the shape `Terrain`. Files are in map
/// coordinates, everything in the scene is in meters from `origin`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TerrainFile {
    /// Sources of elevations: at each location the first with a value there, so that land and bathymetry may be two
    /// files.
    pub sources: Vec<HeightsFile>,
    /// Map coordinates of x = y = 0 in the scene, and the elevation of z = 0; m.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m"))]
    pub origin: Triple,
    /// Coordinate reference system of the map, `"EPSG:25833"` or the text of a `.prj` file; when left out, that of the
    /// sources, if they name one. Written beside every map.
    #[serde(default)]
    pub crs: Option<String>,
    /// Lower and upper corner of the part in use, (x, y); the extent of the first source when left out; m.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m"))]
    pub clip: Option<((f64, f64), (f64, f64))>,
    /// Spacing of the sampled points where sources are averaged or interpolated; when left out that of the first
    /// raster, but at least a fifth of the spacing of the water; m.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m", "exclusiveMinimum" = 0))]
    pub spacing: Option<f64>,
    /// Largest distance of the triangles from the points, for fewer triangles where the ground is plane within it;
    /// when left out, 0.03 particle spacings or distances of joints, whichever is less, up to 0.1 of it where three times the
    /// noise of the points are more, but no less than 0.01 spacings of the terrain; m.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m", "exclusiveMinimum" = 0))]
    pub tolerance: Option<f64>,
    /// Treatment of locations without a source.
    #[serde(default)]
    pub gaps: GapsFile,
    /// Removed ground: scars of past or ongoing slides.
    #[serde(default)]
    pub excavations: Vec<ExcavationFile>,
}

/// An elevation file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HeightsFile {
    /// Path, relative to the scene file: a raster (.asc, .tif), a cloud of scattered points (.xyz, .csv, .txt with columns x, y and
    /// z; .las, .laz), or a triangulated survey (.stl, .obj, .ply, .vtk, .vtp, .vtu), of which the highest triangle is used.
    pub file: String,
    /// Size of the unit of its elevations: 0.3048 for feet; m.
    #[serde(default = "one")]
    #[schemars(extend("x-unit" = "m", "exclusiveMinimum" = 0))]
    pub height_scale: f64,
    /// Added to its elevations, to change the datum; m.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m"))]
    pub height_shift: f64,
    /// Elevations outside of this range are treated as missing, such as land with the value 0 in a file of
    /// bathymetry; m, scaled and shifted.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m"))]
    pub heights: Option<(f64, f64)>,
    /// Spacing of the points that a cloud is interpolated at; when left out the median of the spacings of its points. Places
    /// farther than three of these spacings and than one cell from any point have no elevation; m.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m", "exclusiveMinimum" = 0))]
    pub cell: Option<f64>,
}

/// Treatment of locations without an elevation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub enum GapsFile {
    /// They are an error that names the first of them.
    #[default]
    Refused,
    /// They are filled from the surrounding elevations, as by a membrane, if none is farther than this from a known
    /// one; m.
    #[schemars(extend("x-unit" = "m"))]
    Filled(f64),
}

/// Ground removed within an outline, down to a surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ExcavationFile {
    /// Extent in plan view.
    pub outline: OutlineFile,
    /// Base of the excavation.
    pub failure_surface: FailureSurfaceFile,
}

/// Sliding rock: the rock within an outline between the terrain and a failure surface is excavated from the ground
/// and cut into free blocks by joint sets; the scar remains. The blocks are named `name.0001` and so on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SlideFile {
    /// Unique name.
    pub name: String,
    /// Name of its material.
    pub material: String,
    /// Extent in plan view.
    pub outline: OutlineFile,
    /// Surface of sliding.
    pub failure_surface: FailureSurfaceFile,
    /// The joints; a single block without any.
    #[serde(default)]
    pub joint_sets: Vec<JointSetFile>,
    /// Seed of the random numbers for scatter and persistence.
    #[serde(default)]
    pub seed: u64,
    /// Merges each sliver with the neighbor that shares the largest area with it; slivers are kept when left out.
    #[serde(default)]
    pub merge_slivers: Option<SliversFile>,
    /// Blocks of several parts are made convex where that adds at most this fraction of their volume: rounding in a
    /// raster leaves dents, and contact of convex blocks is faster. 0: never. When left out, 1 on a plane, so that the roughness of
    /// the ground on top of a block makes no parts, and 0.01 on a raster, which a larger hull would dig into. What it adds is
    /// reported.
    #[serde(default)]
    #[schemars(extend("x-unit" = "-"))]
    pub convex_within: Option<f64>,
    /// Smaller blocks are removed after slivers are merged, and counted; m³. 0: none. When left out, the smallest blocks that
    /// hold 0.3 % of the rock together, none above a tenth of the median: the smallest block sets the time step.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m³"))]
    pub minimum_volume: Option<f64>,
    /// More blocks are rejected.
    #[serde(default = "default_maximum_blocks")]
    pub maximum_blocks: u32,
    /// Makes the blocks deformable.
    #[serde(default)]
    pub deformable: Option<DeformableFile>,
    /// Keeps water out of joints too narrow for particles; as for a block.
    #[serde(default)]
    pub sealed: bool,
}

/// A polygon in plan view, in either sense of rotation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub enum OutlineFile {
    /// Corners, (x, y); m.
    #[schemars(extend("x-unit" = "m"))]
    Corners(Vec<(f64, f64)>),
    /// Corners in map coordinates, (easting, northing); m.
    #[schemars(extend("x-unit" = "m"))]
    OnMap(Vec<(f64, f64)>),
    /// A polygon in map coordinates (.geojson, .shp), or a list of corners with columns x and y, or easting and northing (.csv,
    /// .txt). Path, relative to the scene file.
    File(String),
}

/// A surface within an outline.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum FailureSurfaceFile {
    /// A plane.
    Plane {
        /// A point on it; m.
        #[schemars(extend("x-unit" = "m"))]
        point: Triple,
        /// Dip, down from the horizontal, 0 to below 90; degrees.
        #[schemars(extend("x-unit" = "degrees"))]
        dip_deg: f64,
        /// Dip direction, clockwise from north (+y); degrees.
        #[schemars(extend("x-unit" = "degrees"))]
        dip_direction_deg: f64,
    },
    /// Elevations of a raster.
    Raster {
        /// Path, relative to the scene file.
        file: String,
        /// Size of the unit of its elevations: 0.3048 for feet; m.
        #[serde(default = "one")]
        #[schemars(extend("x-unit" = "m", "exclusiveMinimum" = 0))]
        height_scale: f64,
        /// Added to its elevations; m.
        #[serde(default)]
        #[schemars(extend("x-unit" = "m"))]
        height_shift: f64,
    },
}

fn default_maximum_blocks() -> u32 {
    20_000
}
