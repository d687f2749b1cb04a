//! Overlaps deeper than a step allows, with their places.

use std::collections::BTreeMap;

use crate::{BlockId, Blocks, DeepOverlap, Vec3};

type Parts = (u32, u32);

impl Blocks {
    /// Overlaps beyond what a step allows, by the contacts of the present position: at most one for two parts.
    pub fn deep_overlaps(&self) -> Vec<DeepOverlap> {
        let deep: Vec<(Parts, f64)> = self
            .touching_parts()
            .filter(|&(parts, depth)| self.allowed_overlap(parts) < depth)
            .collect();
        if deep.is_empty() {
            return Vec::new();
        }
        let places = self.deepest_points();
        let overlap = |&(parts, depth): &(Parts, f64)| self.overlap_of(parts, depth, &places);
        deep.iter().map(overlap).collect()
    }

    /// Overlap of two parts, by its depth (m).
    pub(crate) fn deep_overlap(&self, parts: Parts, depth: f64) -> DeepOverlap {
        self.overlap_of(parts, depth, &self.deepest_points())
    }

    /// Overlap that a step allows between two parts; m.
    pub(crate) fn allowed_overlap(&self, parts: Parts) -> f64 {
        self.constants.overlap_limits().of(parts)
    }

    /// Parts that touch, with the depth of their overlap; m.
    fn touching_parts(&self) -> impl Iterator<Item = (Parts, f64)> + '_ {
        let contacts = &self.contacts;
        let pairs = contacts.pairs.iter().filter(|pair| pair.is_touching);
        let spheres = self.touching_spheres().map(|k| {
            let depth = contacts.sphere_contacts[k].overlap;
            (contacts.sphere_pairs[k].parts, depth)
        });
        let surfaces = contacts.surface_pairs.iter().filter(|p| p.is_touching);
        pairs
            .map(|pair| (pair.parts, pair.loads.deepest))
            .chain(spheres)
            .chain(surfaces.map(|pair| (pair.parts, pair.loads.deepest)))
    }

    /// Deepest point of contact of each two parts that touch; m.
    fn deepest_points(&self) -> BTreeMap<Parts, (f64, Vec3)> {
        let mut deepest = BTreeMap::<Parts, (f64, Vec3)>::new();
        for contact in self.contacts() {
            let parts = (contact.parts.0.into(), contact.parts.1.into());
            let found = (contact.overlap, contact.point);
            let entry = deepest.entry(parts).or_insert(found);
            if entry.0 < found.0 {
                *entry = found;
            }
        }
        deepest
    }

    fn overlap_of(
        &self,
        parts: Parts,
        depth: f64,
        places: &BTreeMap<Parts, (f64, Vec3)>,
    ) -> DeepOverlap {
        let block = |part: u32| BlockId::from(self.constants.block_of_part[part as usize]);
        let (a, b) = (block(parts.0), block(parts.1));
        DeepOverlap {
            blocks: (a.min(b), a.max(b)),
            at: places
                .get(&parts)
                .map_or_else(|| self.middle_of(parts), |(_, at)| *at),
            depth,
            allowed: self.allowed_overlap(parts),
            size: self.constants.overlap_limits().size_of(parts),
        }
    }

    /// Middle of what the boxes of two parts share; m.
    fn middle_of(&self, parts: Parts) -> Vec3 {
        let (a, b) = (
            self.state.boxes[parts.0 as usize],
            self.state.boxes[parts.1 as usize],
        );
        0.5 * (a.0.sup(&b.0) + a.1.inf(&b.1))
    }
}
