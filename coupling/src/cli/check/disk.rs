//! Disk space of a run: frames of each kind, records of gauges and of blocks.

use std::fmt;

use riprap_dda::{Motion, Shape};
use serde::Serialize;

use crate::scene::resolved::Scene;
use crate::scene::resolved::recording::{Sampling, TableFormat};

/// Bytes per particle in a frame: measured, compressed, with the first four arrays.
const PER_PARTICLE: f64 = 30.0;
/// Bytes of a file without content.
const PER_FILE: f64 = 2500.0;
/// Bytes per corner of a face of a block in a frame: measured, compressed, with all arrays.
const PER_CORNER: f64 = 8.0;
/// Corners of the faces of the mesh that a sphere is written as.
const CORNERS_OF_SPHERE: f64 = 1000.0;
/// Bytes per row of the gauges.
const PER_ROW: f64 = 500.0;

/// Bytes per block and row of the table of their motion: measured of text, exact of binary numbers.
const PER_TEXT_ROW: f64 = 450.0;
const PER_BINARY_ROW: f64 = 125.0;

/// Frames of a kind.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Kind {
    pub frames: u64,
    /// `null` where it depends on what happens.
    pub size_bytes: Option<f64>,
}

/// Disk space of a run; kinds that are not written are `null`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Disk {
    /// Without contacts and pressures on faces.
    pub total_bytes: f64,
    pub water: Option<Kind>,
    pub blocks: Option<Kind>,
    pub contacts: Option<Kind>,
    pub face_pressures: Option<Kind>,
    pub tables_bytes: f64,
}

impl Disk {
    pub fn of(scene: &Scene) -> Self {
        let output = &scene.output;
        let frames =
            |sampling: &Sampling| (scene.duration / sampling.interval + 1e-9).floor() as u64 + 1;
        let of_size = |sampling: &Sampling, bytes: f64| {
            let frames = frames(sampling);
            Kind {
                frames,
                size_bytes: Some(frames as f64 * (PER_FILE + bytes)),
            }
        };
        let unknown = |sampling: &Sampling| Kind {
            frames: frames(sampling),
            size_bytes: None,
        };
        let has_movers = (scene.blocks.iter()).any(|b| !matches!(b.motion, Motion::Fixed));
        let has_water = scene.fluid.is_some();
        let water = has_water.then(|| of_size(&output.water, particles(scene) * PER_PARTICLE));
        let blocks = has_movers.then(|| of_size(&output.blocks, corners(scene) * PER_CORNER));
        let table = &scene.block_table;
        let per_block = match table.format {
            TableFormat::Csv => PER_TEXT_ROW,
            TableFormat::Npy => PER_BINARY_ROW,
        };
        let of_blocks = scene.duration / table.interval * table.blocks.len() as f64 * per_block;
        let tables_bytes = scene.duration / output.gauge_interval * PER_ROW + of_blocks;
        let sizes = [water, blocks].into_iter().flatten();
        let sizes: f64 = sizes.filter_map(|kind| kind.size_bytes).sum();
        Self {
            total_bytes: tables_bytes + sizes,
            water,
            blocks,
            contacts: output.contacts.then(|| unknown(&output.contact_frames)),
            face_pressures: (output.face_pressures && has_water)
                .then(|| unknown(&output.face_frames)),
            tables_bytes,
        }
    }
}

/// Particles in a frame at the start.
fn particles(scene: &Scene) -> f64 {
    let sampling = &scene.output.water;
    let positions = scene
        .fluid
        .iter()
        .flat_map(|fluid| &fluid.lattice.positions);
    let inside = positions.filter(|x| sampling.holds(x)).count();
    inside as f64 / f64::from(sampling.stride.max(1))
}

/// Corners of all faces of the moving blocks in a frame at the start.
fn corners(scene: &Scene) -> f64 {
    let moving = (scene.blocks.iter()).filter(|b| !matches!(b.motion, Motion::Fixed));
    let shown = moving.filter(|block| {
        let (low, high) = block.shape.aabb();
        scene.output.blocks.holds(&(0.5 * (low + high)))
    });
    shown
        .map(|block| match &block.shape {
            Shape::Polyhedra(parts) => {
                let of_part = |part: &riprap_dda::Polyhedron| {
                    let faces = 0..part.n_faces();
                    faces
                        .map(|face| part.face_vertices(face).count())
                        .sum::<usize>()
                };
                parts.iter().map(of_part).sum::<usize>() as f64
            }
            Shape::Sphere { .. } => CORNERS_OF_SPHERE,
            Shape::Surface(surface) => 3.0 * surface.triangles().len() as f64,
        })
        .sum()
}

impl fmt::Display for Disk {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = if self.total_bytes < 1e7 { 1 } else { 0 };
        write!(f, "about {:.digits$} MB", self.total_bytes / 1e6)?;
        let kinds = [
            ("water", self.water),
            ("blocks", self.blocks),
            ("contacts", self.contacts),
            ("pressures on faces", self.face_pressures),
        ];
        let mut before = ": ";
        for (name, kind) in kinds {
            let Some(Kind { frames, size_bytes }) = kind else {
                continue;
            };
            write!(f, "{before}{frames} frames of {name}")?;
            if let Some(bytes) = size_bytes {
                write!(f, " {:.1} MB", bytes / 1e6)?;
            }
            before = ", ";
        }
        Ok(())
    }
}
