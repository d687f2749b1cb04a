//! Space ahead of the points of a block: joints, pores, open places.

use riprap_dda::Blocks;
use riprap_sph::Vec3;

use super::{OPPOSED, REACH};

/// Half widths, in spacings, of spaces that particles cannot enter: between one solid and the block, and between two other
/// solids and the block.
const PORE: [f64; 2] = [0.4, 0.75];

/// Space ahead of a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ahead {
    /// Width of the joint, with the solid at its other side; m.
    pub joint: Option<(f64, u32)>,
    /// Fraction `Σ V W` and pressure of the water; –, Pa.
    pub water: [f64; 2],
    /// Open place beside the block, across the edge that the point is at; m.
    pub beside: Option<Vec3>,
    /// Whether that place, or the space ahead of an open point, is a pore that particles cannot enter.
    pub is_pore: bool,
}

/// Solids near a block.
pub(super) struct Surroundings<'a> {
    pub blocks: &'a Blocks,
    pub block: usize,
    /// Parts of other blocks.
    pub near: &'a [usize],
    pub domain: (Vec3, Vec3),
    pub spacing: f64,
}

impl Surroundings<'_> {
    /// Space ahead of a point of the block with an outward normal, and the direction across the edge that it is at.
    pub fn ahead(&self, x: &Vec3, normal: &Vec3, across: Option<Vec3>) -> Ahead {
        let joint = self.joint(x, normal);
        let at_edge = across.filter(|_| joint.is_some());
        let beside =
            at_edge.map(|across| x + across * self.spacing - normal * (0.5 * self.spacing));
        let ahead = || x + normal * (0.5 * self.spacing);
        let room = beside.or_else(|| joint.is_none().then(ahead));
        Ahead {
            joint,
            water: [0.0; 2],
            beside: beside.filter(|place| self.is_open(place)),
            is_pore: room.is_some_and(|place| self.is_pore(&place)),
        }
    }

    /// Width of the joint ahead (m), with the solid at its other side.
    fn joint(&self, x: &Vec3, normal: &Vec3) -> Option<(f64, u32)> {
        let reach = REACH * self.spacing;
        let widths = self.near.iter().filter_map(|&part| {
            let surface = self.blocks.surface_point_within(part, x, reach)?;
            let is_opposed = surface.normal.dot(normal) < OPPOSED;
            is_opposed.then(|| (surface.distance, self.blocks.block_of_part(part) as u32))
        });
        widths.min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Whether a place is too close to the solids for a particle.
    fn is_pore(&self, place: &Vec3) -> bool {
        let [alone, between] = PORE.map(|reach| reach * self.spacing);
        let mut first = None;
        self.near.iter().any(|&part| {
            let Some(surface) = self.blocks.surface_point_within(part, place, between) else {
                return false;
            };
            let block = self.blocks.block_of_part(part);
            surface.distance < alone || *first.get_or_insert(block) != block
        })
    }

    /// Whether a place is in the domain and in no solid.
    fn is_open(&self, place: &Vec3) -> bool {
        let (low, high) = self.domain;
        let is_inside = (0..3).all(|k| low[k] <= place[k] && place[k] <= high[k]);
        let own = self.blocks.parts_of(self.block);
        let mut parts = self.near.iter().copied().chain(own);
        is_inside
            && !parts.any(|part| {
                let surface = self.blocks.surface_point_within(part, place, 0.0);
                surface.is_some_and(|surface| surface.distance < 0.0)
            })
    }
}
