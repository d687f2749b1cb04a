//! Points of moving blocks inside fixed solids, which are no walls there.

use riprap_dda::Blocks;
use riprap_sph::Vec3;
use riprap_sph::boundary::thin_solids::Facet;

use super::Frame;
use super::points::Points;

/// Depth in a fixed solid, in spacings, from which on points are buried: more than contacts press.
const BURIED_DEPTH: f64 = 0.02;

/// Moving points, except those of thin solids, inside a fixed solid.
#[derive(Clone, Debug)]
pub(super) struct Buried {
    /// m³.
    volumes: Vec<f64>,
    is_of_thin_solid: Vec<bool>,
    /// From this depth on; m.
    depth: f64,
    pub(super) is_buried: Vec<bool>,
    /// Whether there are any, or were when points were placed last.
    pub(super) is_any: bool,
    /// Parts of fixed polyhedra, and those near a block.
    fixed: Vec<usize>,
    near: Vec<usize>,
}

impl Buried {
    /// None of the moving points, before they are placed; the spacing is in m.
    pub(super) fn new(points: &Points, blocks: &Blocks, spacing: f64) -> Self {
        let is_solid = |part: &usize| {
            blocks.is_fixed(blocks.block_of_part(*part)) && !blocks.is_surface(*part)
        };
        Self {
            volumes: points.samples.iter().map(|s| s.volume).collect(),
            is_of_thin_solid: points.facets.iter().map(|&f| f != Facet::NONE).collect(),
            depth: BURIED_DEPTH * spacing,
            is_buried: vec![false; points.blocks.len()],
            is_any: false,
            fixed: (0..blocks.n_parts()).filter(is_solid).collect(),
            near: Vec::new(),
        }
    }

    /// Finds them among points of blocks in order, where these are.
    pub(super) fn find(
        &mut self,
        block: &[u32],
        local: &[Vec3],
        (frames, blocks): (&[Frame], &Blocks),
    ) {
        let had_any = std::mem::take(&mut self.is_any);
        let mut first = 0;
        for of_block in block.chunk_by(|a, b| a == b) {
            let points = first..first + of_block.len();
            first = points.end;
            let b = of_block[0] as usize;
            self.near.clear();
            self.near.extend(self.fixed.iter().copied().filter(|&part| {
                let (low, high) = blocks.part_aabb(part);
                blocks.parts_of(b).any(|own| {
                    let (min, max) = blocks.part_aabb(own);
                    (0..3).all(|k| low[k] + self.depth < max[k] && min[k] + self.depth < high[k])
                })
            }));
            for w in points {
                let is_inside = |part: &usize| {
                    let place = frames[b].place(&local[w]);
                    let surface = blocks.surface_point_within(*part, &place, 0.0);
                    surface.is_some_and(|surface| surface.distance < -self.depth)
                };
                self.is_buried[w] = !self.is_of_thin_solid[w] && self.near.iter().any(is_inside);
                self.is_any |= self.is_buried[w];
            }
        }
        self.is_any |= had_any;
    }

    /// Volume of a point, in m³.
    pub(super) fn volume(&self, w: usize) -> f64 {
        if self.is_buried[w] {
            0.0
        } else {
            self.volumes[w]
        }
    }
}
