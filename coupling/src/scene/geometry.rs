//! Geometry of a scene: solids of blocks, terrain, and the bodies that become blocks.

pub mod cloud;
pub mod crs;
pub mod features;
pub mod geotiff;
pub mod grains;
pub mod mesh;
pub mod raster;
pub mod rock_mass;
pub mod shape;
pub mod slides;
pub mod terrain;
