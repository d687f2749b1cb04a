//! `bodies.csv`: who is who among the blocks of a run.

use std::path::Path;

use csv::{Reader, Writer};
use riprap_dda::Motion;
use serde::{Deserialize, Serialize};

use crate::output::observe::ObserveError;
use crate::world::World;

/// Name of the table in a run folder.
pub const FILE: &str = "bodies.csv";

/// A block of a run at its start.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BodyRow {
    /// Number, as in `blocks.csv` and in `BlockId` of the VTK files.
    pub block: usize,
    /// Name in the scene.
    pub name: String,
    /// `free`, `fixed` or `prescribed`.
    pub kind: String,
    /// kg.
    #[serde(rename = "mass [kg]")]
    pub mass: f64,
    /// m³.
    #[serde(rename = "volume [m3]")]
    pub volume: f64,
    /// Centroid; m.
    #[serde(rename = "x [m]")]
    pub x: f64,
    /// Centroid; m.
    #[serde(rename = "y [m]")]
    pub y: f64,
    /// Centroid; m.
    #[serde(rename = "z [m]")]
    pub z: f64,
}

/// Writes the blocks of a world under their names.
///
/// # Errors
///
/// [`ObserveError::Write`] names the file.
pub fn write(folder: &Path, names: &[String], world: &World) -> Result<(), ObserveError> {
    let path = folder.join(FILE);
    let failed = |source| ObserveError::Write {
        path: path.display().to_string(),
        source,
    };
    let blocks = &world.blocks;
    let mut table = Writer::from_path(&path).map_err(|error| failed(error.into()))?;
    for b in 0..blocks.n_blocks() {
        let kind = match blocks.motion(b) {
            _ if world.is_fixed(b) => "fixed",
            Motion::Prescribed(_) => "prescribed",
            _ => "free",
        };
        let place = blocks.centroid(b);
        let row = BodyRow {
            block: b,
            name: names.get(b).cloned().unwrap_or_default(),
            kind: kind.to_owned(),
            mass: blocks.mass(b),
            volume: blocks.volume(b),
            x: place.x,
            y: place.y,
            z: place.z,
        };
        table.serialize(row).map_err(|error| failed(error.into()))?;
    }
    table.flush().map_err(failed)
}

/// Reads the blocks of a run folder; none where it has no such file, as folders of earlier versions.
///
/// # Errors
///
/// A line that names the file and its fault.
pub fn read(folder: &Path) -> Result<Vec<BodyRow>, String> {
    let path = folder.join(FILE);
    if !path.exists() {
        return Ok(Vec::new());
    }
    let told = |error: csv::Error| format!("{}: {error}", path.display());
    let mut table = Reader::from_path(&path).map_err(told)?;
    table.deserialize().map(|row| row.map_err(told)).collect()
}
