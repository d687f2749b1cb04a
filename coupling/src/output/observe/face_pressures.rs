//! Water pressure on the faces of blocks, tile by tile.

use riprap_dda::{Blocks, Vec3};
use riprap_sph::boundary::integral::Face;
use riprap_sph::boundary::sampling::tiles;
use riprap_sph::fluid::ContinuedPressure;

use super::arrays::{integers, scalars, single};
use crate::files::vtk::PolyData;
use crate::scene::resolved::recording::Sampling;
use crate::walls::face_lattice;
use crate::world::Water;

/// Water fraction of the kernel support, `Σ V W`, below which a tile is dry; at a wetted plane wall it is one half.
const DRY: f64 = 0.05;

/// Wet tiles, about a spacing wide, of the faces of all blocks, with the pressure extrapolated to the center of each.
pub(super) fn face_pressures(water: &Water, blocks: &Blocks, sampling: &Sampling) -> PolyData {
    let (spacing, middle) = face_lattice(&water.fluid);
    let (mut outlines, mut places, mut owner) = (Vec::new(), Vec::new(), Vec::new());
    for block in (0..blocks.n_blocks()).filter(|&b| !blocks.is_removed(b)) {
        let (vertices, faces) = blocks.world_polygons(block);
        for face in &faces {
            let corners: Vec<Vec3> = face.iter().map(|&v| vertices[v as usize]).collect();
            let Some(normal) = normal_of(&corners) else {
                continue;
            };
            // a slice is cut from prisms without ends
            if middle.is_some() && 0.5 < normal.y.abs() {
                continue;
            }
            let face = Face {
                normal,
                vertices: &corners,
            };
            for (outline, mut place) in tiles(&face, spacing) {
                place.y = middle.unwrap_or(place.y);
                if !sampling.holds(&place) {
                    continue;
                }
                outlines.push(outline);
                places.push(place);
                owner.push(block as i32);
            }
        }
    }
    let mut continued = ContinuedPressure::default();
    continued.find(&water.fluid, &places);
    let mut data = PolyData::default();
    let (mut ids, mut pressures) = (Vec::new(), Vec::new());
    for ((outline, block), [share, pressure]) in outlines.iter().zip(owner).zip(continued.found()) {
        if share < DRY {
            continue;
        }
        let polygons = &mut data.polygons;
        for corner in outline {
            polygons.connectivity.push(data.points.len() as i32);
            data.points.push(single(corner));
        }
        polygons.offsets.push(polygons.connectivity.len() as i32);
        ids.push(block);
        pressures.push(pressure as f32);
    }
    data.cell_data = vec![integers("BlockId", ids), scalars("Pressure", pressures)];
    data
}

/// Outward unit normal of a face, if it has an area.
fn normal_of(corners: &[Vec3]) -> Option<Vec3> {
    let first = corners.first()?;
    let area: Vec3 = corners
        .windows(2)
        .map(|pair| (pair[0] - first).cross(&(pair[1] - first)))
        .sum();
    area.try_normalize(0.0)
}
