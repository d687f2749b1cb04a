//! Faces of straining blocks that the pressure on their wall particles presses.
//!
//! Wall particles lie inside of a block, up to a support deep, where the pressure of water acts on its faces. Neither force nor torque changes
//! along the line of a force, but the moment that strains a block does: taken at the particles it falls short by their mean depth, more
//! than a spacing, on each side. So each force moves along the normals of the faces that it presses, from the nearest on:
//!
//! ```text
//! M = Σ f ⊗ r + Σ_faces (f·n) d n ⊗ n,   f·n < 0                                                            [N m]
//! ```
//! `d` is the depth below the face; the next face takes what is left of `f` without its part along `n`. That is exact for faces at right
//! angles to each other. Thin solids are left as they are: their particles may lie outside.

use nalgebra::Matrix3;
use riprap_dda::{BlockDefinition, Blocks};
use riprap_sph::Vec3;
use riprap_sph::boundary::thin_solids::Facet;

use super::points::Points;
use crate::walls::{Part, parts};

/// Height above a plane within which a point is on it, over the depth of another.
const ON_PLANE: f64 = 1e-9;

/// Faces above the wall particles of straining blocks.
#[derive(Clone, Debug, Default)]
pub(super) struct FacesAbove {
    /// First face of each point, and the end; empty where no block strains.
    first: Vec<u32>,
    /// From a point to the face above it, nearest first, in the axes and the shape of the start; m.
    offsets: Vec<Vec3>,
}

impl FacesAbove {
    /// Faces above moving points within a reach (m). `turned_back` takes world axes to those of a block.
    pub(super) fn new(
        points: &Points,
        (definitions, blocks): (&[BlockDefinition], &Blocks),
        reach: f64,
        turned_back: impl Fn(u32, &Vec3) -> Vec3,
    ) -> Self {
        let solids: Vec<Vec<Part>> = (definitions.iter().enumerate())
            .map(|(b, definition)| match blocks.is_deformable(b) {
                true => parts(&definition.shape),
                false => Vec::new(),
            })
            .collect();
        if solids.iter().all(Vec::is_empty) {
            return Self::default();
        }
        let mut above = Self::default();
        let placed = points.samples.iter().zip(&points.facets);
        for (&b, (sample, &facet)) in points.blocks.iter().zip(placed) {
            above.first.push(above.offsets.len() as u32);
            if facet == Facet::NONE {
                let mut found = faces_above(&solids[b as usize], &sample.position, reach);
                found.sort_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()));
                let found = found.iter().map(|offset| turned_back(b, offset));
                above.offsets.extend(found);
            }
        }
        above.first.push(above.offsets.len() as u32);
        above
    }

    /// By how much the moment of the pressure (N) on a point strains its block more than at the point itself; N m. `gradient` of the block.
    pub(super) fn more_stretch(
        &self,
        point: usize,
        pressure: &Vec3,
        gradient: &Matrix3<f64>,
    ) -> Matrix3<f64> {
        let mut more = Matrix3::zeros();
        let Some(&[start, end]) = self
            .first
            .get(point..point + 2)
            .and_then(|s| s.first_chunk())
        else {
            return more;
        };
        let mut left = *pressure;
        for offset in &self.offsets[start as usize..end as usize] {
            let offset = gradient * offset;
            let depth = offset.norm();
            let normal = offset / depth;
            let push = left.dot(&normal);
            if push < 0.0 {
                more += normal * normal.transpose() * (push * depth);
                left -= normal * push;
            }
        }
        more
    }
}

/// From a point inside of a solid of convex parts to the faces above it within a reach, where they are open; m.
fn faces_above(solid: &[Part], x: &Vec3, reach: f64) -> Vec<Vec3> {
    let heights = |part: &Part, x: &Vec3| -> Vec<(Vec3, f64)> {
        (part.faces.iter())
            .filter_map(|(normal, corners)| Some((*normal, normal.dot(&(x - corners.first()?)))))
            .collect()
    };
    let is_inside = |part: &Part, x: &Vec3, below: f64| {
        heights(part, x).iter().all(|(_, height)| *height < below)
    };
    let mut found = Vec::new();
    for (k, part) in solid.iter().enumerate() {
        let planes = heights(part, x);
        if planes.iter().any(|(_, height)| 0.0 <= *height) {
            continue;
        }
        for (normal, height) in planes {
            let depth = -height;
            let foot = x + normal * depth;
            let is_open = (solid.iter().enumerate())
                .all(|(other, part)| other == k || !is_inside(part, &foot, ON_PLANE * reach));
            if depth < reach && is_open && is_inside(part, &foot, ON_PLANE * reach) {
                found.push(normal * depth);
            }
        }
    }
    found
}
