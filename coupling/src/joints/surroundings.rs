//! Space ahead of the points of a block: joints, pores, open places.

use riprap_dda::Blocks;
use riprap_sph::Vec3;

use super::{OPPOSED, REACH};

/// Half widths, in spacings, of spaces that particles cannot enter: between one solid and the block, and between two other
/// solids and the block.
const PORE: [f64; 2] = [0.4, 0.75];

/// Distance of the place beside a sealed block, in spacings: particles come and go in the corner between a block that slides and its bed.
const ASIDE: f64 = 1.5;

/// Overlap of a point and a solid, in spacings, from which on there is no joint: a prescribed block may be drawn into its bed.
const OVERLAP: f64 = 0.5;

/// Widening of boxes and distances that only reject, for round-off; –.
const ROUND_OFF: f64 = 1e-9;

/// Space ahead of a point.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ahead {
    /// Width of the joint, with the solid at its other side; m.
    pub joint: Option<(f64, u32)>,
    /// Fraction `Σ V W` and pressure of the water; –, Pa.
    pub water: [f64; 2],
    /// Open place beside the block, across the edge that the point is at; m.
    pub beside: Option<Vec3>,
    /// Whether the joint is a hollow that joints close on all sides.
    pub is_hollow: bool,
    /// Whether that place, or the space ahead of an open point, is a pore that particles cannot enter.
    pub is_pore: bool,
}

/// Solids near a face of a block.
pub(super) struct Surroundings<'a> {
    pub blocks: &'a Blocks,
    pub block: usize,
    /// Parts of other blocks, in order.
    pub near: &'a [u32],
    pub domain: (Vec3, Vec3),
    pub is_sealed: bool,
    pub spacing: f64,
}

impl Surroundings<'_> {
    /// Space ahead of a point of the block with an outward normal, and the direction across the edge that it is at.
    pub fn ahead(&self, x: &Vec3, normal: &Vec3, across: Option<Vec3>) -> Ahead {
        let joint = self.joint(x, normal, REACH * self.spacing);
        let at_edge = across.filter(|_| joint.is_some());
        let beside = at_edge.map(|across| self.beside(x, normal, &across));
        let ahead = || x + normal * (0.5 * self.spacing);
        let room = beside.or_else(|| joint.is_none().then(ahead));
        Ahead {
            joint,
            water: [0.0; 2],
            is_hollow: false,
            beside: beside.filter(|place| self.is_open(place)),
            is_pore: room.is_some_and(|place| self.is_pore(&place)),
        }
    }

    /// Place beside the block, across the edge that a point is at (m).
    pub fn beside(&self, x: &Vec3, normal: &Vec3, across: &Vec3) -> Vec3 {
        let aside = x + (across - normal) * (ASIDE * self.spacing);
        if self.is_sealed && self.is_open(&aside) {
            return aside;
        }
        x + across * self.spacing - normal * (0.5 * self.spacing)
    }

    /// Width of the joint ahead (m), at most `reach` (m), with the solid at its other side: the first of the nearest.
    pub fn joint(&self, x: &Vec3, normal: &Vec3, reach: f64) -> Option<(f64, u32)> {
        let mut nearest: Option<(f64, u32)> = None;
        for part in self.parts_within(x, reach) {
            let within = match nearest {
                // behind triangles the search is limited in distance, and one farther behind is nearer
                Some((distance, _)) if !self.blocks.is_surface(part) => {
                    (distance.max(0.0) + ROUND_OFF * self.spacing).min(reach)
                }
                _ => reach,
            };
            let Some(surface) = self.blocks.surface_point_within(part, x, within) else {
                continue;
            };
            let is_nearer = |(distance, _): (f64, u32)| surface.distance < distance;
            if surface.normal.dot(normal) < OPPOSED && nearest.is_none_or(is_nearer) {
                nearest = Some((surface.distance, self.blocks.block_of_part(part) as u32));
            }
        }
        nearest.filter(|(distance, _)| -OVERLAP * self.spacing < *distance)
    }

    /// Whether a place is too close to the solids for a particle.
    fn is_pore(&self, place: &Vec3) -> bool {
        let [alone, between] = PORE.map(|reach| reach * self.spacing);
        let mut first = None;
        self.parts_within(place, between).any(|part| {
            let Some(surface) = self.blocks.surface_point_within(part, place, between) else {
                return false;
            };
            let block = self.blocks.block_of_part(part);
            surface.distance < alone || *first.get_or_insert(block) != block
        })
    }

    /// Whether a place is in the domain and in no solid.
    pub fn is_open(&self, place: &Vec3) -> bool {
        let (low, high) = self.domain;
        let is_inside = (0..3).all(|k| low[k] <= place[k] && place[k] <= high[k]);
        let own = self.blocks.parts_of(self.block);
        let mut parts = self.parts_within(place, 0.0).chain(own);
        is_inside
            && !parts.any(|part| {
                let surface = self.blocks.surface_point_within(part, place, 0.0);
                surface.is_some_and(|surface| surface.distance < 0.0)
            })
    }

    /// Near parts whose boxes are within a distance (m) of a place.
    fn parts_within(&self, place: &Vec3, distance: f64) -> impl Iterator<Item = usize> {
        let point = (*place, *place);
        let near = self.near.iter().map(|&part| part as usize);
        near.filter(move |&part| {
            is_near(&self.blocks.part_aabb(part), &point, distance, self.spacing)
        })
    }
}

/// Whether two boxes (m) are within a distance (m) of each other along each axis, or no more than round-off beyond it.
pub(super) fn is_near(
    (min, max): &(Vec3, Vec3),
    (low, high): &(Vec3, Vec3),
    distance: f64,
    spacing: f64,
) -> bool {
    let distance = distance + ROUND_OFF * spacing;
    (0..3).all(|k| min[k] - distance <= high[k] && low[k] <= max[k] + distance)
}
