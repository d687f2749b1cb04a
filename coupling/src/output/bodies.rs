//! `bodies.csv`: who is who among the blocks of a run.

use std::fs;
use std::path::Path;

use riprap_dda::Motion;

use crate::files::table::{TableError, TextRow, TextTable, texts};
use crate::output::observe::ObserveError;
use crate::scene::resolve::Scene;
use crate::world::World;

/// Name of the table in a run folder.
pub const FILE: &str = "bodies.csv";

/// A block of a run at its start.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyRow {
    /// Number, as in `blocks.csv` and in `BlockId` of the VTK files.
    pub block: usize,
    /// Name in the scene.
    pub name: String,
    /// `free`, `fixed` or `prescribed`.
    pub kind: String,
    /// kg.
    pub mass: f64,
    /// m³.
    pub volume: f64,
    /// Centroid; m.
    pub x: f64,
    /// Centroid; m.
    pub y: f64,
    /// Centroid; m.
    pub z: f64,
    /// Group: the rock mass, slide or grains that it is of, or the one that the scene gives; empty without.
    pub group: String,
    /// Name of its material.
    pub material: String,
    /// Names of the joint sets that bound it, ` + ` between them.
    pub joint_sets: String,
}

/// Headers of the columns, in the order of the fields of a [`BodyRow`].
const HEADS: [&str; 11] = [
    "block",
    "name",
    "kind",
    "mass [kg]",
    "volume [m3]",
    "x [m]",
    "y [m]",
    "z [m]",
    "group",
    "material",
    "joint_sets",
];

impl BodyRow {
    fn cells(self) -> Vec<String> {
        let Self {
            block,
            name,
            kind,
            mass,
            volume,
            x,
            y,
            z,
            group,
            material,
            joint_sets,
        } = self;
        let numbers = [mass, volume, x, y, z].map(|number| format!("{number:?}"));
        let texts = [block.to_string(), name, kind];
        let labels = [group, material, joint_sets];
        texts.into_iter().chain(numbers).chain(labels).collect()
    }

    fn of(row: &TextRow<'_>) -> Result<Self, TableError> {
        Ok(Self {
            block: row.number("block")? as usize,
            name: row.text("name")?.to_owned(),
            kind: row.text("kind")?.to_owned(),
            mass: row.number("mass [kg]")?,
            volume: row.number("volume [m3]")?,
            x: row.number("x [m]")?,
            y: row.number("y [m]")?,
            z: row.number("z [m]")?,
            // folders of earlier versions do not have them
            group: row.text("group").unwrap_or_default().to_owned(),
            material: row.text("material").unwrap_or_default().to_owned(),
            joint_sets: row.text("joint_sets").unwrap_or_default().to_owned(),
        })
    }
}

/// Writes the blocks of a world under their names.
///
/// # Errors
///
/// [`ObserveError::Write`] names the file.
pub fn write(folder: &Path, scene: &Scene, world: &World) -> Result<(), ObserveError> {
    let path = folder.join(FILE);
    let (blocks, register) = (&world.blocks, &scene.register);
    let row = |b: usize| {
        let kind = match blocks.motion(b) {
            _ if world.is_fixed(b) => "fixed",
            Motion::Prescribed(_) => "prescribed",
            _ => "free",
        };
        let place = blocks.centroid(b);
        let row = BodyRow {
            block: b,
            name: scene.block_names.get(b).cloned().unwrap_or_default(),
            kind: kind.to_owned(),
            mass: blocks.mass(b),
            volume: blocks.volume(b),
            x: place.x,
            y: place.y,
            z: place.z,
            group: register.group_name(b).to_owned(),
            material: register.material_name(b).to_owned(),
            joint_sets: register.joint_set_names(b).collect::<Vec<_>>().join(" + "),
        };
        row.cells()
    };
    let rows: Vec<Vec<String>> = (0..blocks.n_blocks()).map(row).collect();
    let text = match rows.is_empty() {
        true => String::new(),
        false => texts(&HEADS.map(str::to_owned), &rows),
    };
    fs::write(&path, text).map_err(|source| ObserveError::Write {
        path: path.display().to_string(),
        source,
    })
}

/// Reads the blocks of a run folder; none where it has no such file, as folders of earlier versions.
///
/// # Errors
///
/// A line that names the file and its fault.
pub fn read(folder: &Path) -> Result<Vec<BodyRow>, String> {
    let path = folder.join(FILE);
    let is_empty = |file: fs::Metadata| file.len() == 0;
    if fs::metadata(&path).map_or(true, is_empty) {
        return Ok(Vec::new());
    }
    let told = |error: TableError| error.to_string();
    let table = TextTable::read(&path).map_err(told)?;
    table
        .rows()
        .map(|row| BodyRow::of(&row).map_err(told))
        .collect()
}
