//! The lie of the land, and the rock that slides off it.

use serde::{Deserialize, Serialize};

use super::{DeformableFile, JointSetFile, SliversFile, Triple, one};

/// Heights over the plan from rasters and surveys: what a block of the shape `Terrain` is made of. Files are in coordinates
/// of the map, everything in the scene is in metres from `origin`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TerrainFile {
    /// Where heights come from: at each place the first that has one there, so that land and bathymetry may be two.
    pub sources: Vec<HeightsFile>,
    /// The point of the map that is x = y = 0 in the scene, and the height that is z = 0; m.
    #[serde(default)]
    pub origin: Triple,
    /// Lower and upper corner of what is used, (x, y); all that the first source covers when left out; m.
    #[serde(default)]
    pub clip: Option<((f64, f64), (f64, f64))>,
    /// Distance of the points that are used, where sources are averaged or interpolated; that of the first raster when
    /// left out, but no less than a fifth of the spacing of the water; m.
    #[serde(default)]
    pub spacing: Option<f64>,
    /// How far the triangles may be off the points: what is flat within it becomes few; 0.01 spacings when left out; m.
    #[serde(default)]
    pub tolerance: Option<f64>,
    /// What becomes of places that no source covers.
    #[serde(default)]
    pub gaps: GapsFile,
    /// Where the ground was taken away: scars of slides that are under way or gone.
    #[serde(default)]
    pub excavations: Vec<ExcavationFile>,
}

/// A file of heights.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeightsFile {
    /// Path, relative to the scene file: a raster (.asc; .tif if riprap was built with GeoTIFF), or a triangulated survey (.stl, .obj,
    /// .vtk, .vtp, .vtu) whose highest triangle counts.
    pub file: String,
    /// Metres per unit of its heights: 0.3048 for feet.
    #[serde(default = "one")]
    pub height_scale: f64,
    /// Added to its heights, for another zero; m.
    #[serde(default)]
    pub height_shift: f64,
    /// Heights outside of this range count as missing: land that has 0 for water, say; m, scaled and shifted.
    #[serde(default)]
    pub heights: Option<(f64, f64)>,
}

/// What becomes of places without a height.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum GapsFile {
    /// They are an error that names the first of them.
    #[default]
    Refused,
    /// They get heights between those around them, as a membrane would, where none is farther from a known one than this; m.
    Filled(f64),
}

/// Ground that was taken away within an outline, down to a surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExcavationFile {
    /// Where.
    pub outline: OutlineFile,
    /// Down to where.
    pub failure_surface: FailureSurfaceFile,
}

/// Rock that slides: what lies within an outline between the terrain and a failure surface is taken out of the ground, cut into free
/// blocks by joint sets, and the ground is left with the scar. The blocks are named `name.0001` and on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SlideFile {
    /// Unique name.
    pub name: String,
    /// Name of its material.
    pub material: String,
    /// Where it lies.
    pub outline: OutlineFile,
    /// On what it slides.
    pub failure_surface: FailureSurfaceFile,
    /// The joints; one block without any.
    #[serde(default)]
    pub joint_sets: Vec<JointSetFile>,
    /// Of the random numbers of scatter and persistence.
    #[serde(default)]
    pub seed: u64,
    /// Joins slivers with the neighbour with which they share the largest area; kept when left out.
    #[serde(default)]
    pub merge_slivers: Option<SliversFile>,
    /// Blocks of several parts become convex where that adds no more than this share of their volume: the last digit of a
    /// raster leaves dents, and convex blocks touch faster. 0: none.
    #[serde(default)]
    pub convex_within: f64,
    /// Smaller blocks are left out, after slivers are merged, and counted; m³.
    #[serde(default)]
    pub minimum_volume: f64,
    /// More blocks are refused.
    #[serde(default = "default_maximum_blocks")]
    pub maximum_blocks: u32,
    /// Makes the blocks deformable.
    #[serde(default)]
    pub deformable: Option<DeformableFile>,
    /// No water gets into joints too narrow for particles; as of a block.
    #[serde(default)]
    pub sealed: bool,
}

/// A polygon in the plan, in either sense.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum OutlineFile {
    /// Corners, (x, y); m.
    Corners(Vec<(f64, f64)>),
    /// A table of corners in coordinates of the map, columns x and y; m. Path, relative to the scene file.
    File(String),
}

/// A surface within an outline.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum FailureSurfaceFile {
    /// A plane.
    Plane {
        /// A point of it; m.
        point: Triple,
        /// Dip, down from the horizontal, 0 to below 90; degrees.
        dip_deg: f64,
        /// Dip direction, clockwise from north (+y); degrees.
        dip_direction_deg: f64,
    },
    /// Heights of a raster.
    Raster {
        /// Path, relative to the scene file.
        file: String,
        /// Metres per unit of its heights.
        #[serde(default = "one")]
        height_scale: f64,
        /// Added to its heights; m.
        #[serde(default)]
        height_shift: f64,
    },
}

fn default_maximum_blocks() -> u32 {
    20_000
}
