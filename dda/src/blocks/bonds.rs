//! Rigid bonds of contact dynamics.

use crate::Blocks;
use crate::contact::bond::center;
use crate::contact::detection::patch::Patch;
use crate::contact::detection::polyhedra::NarrowPhase;
use crate::contact::dynamics::kept::KeptBond;
use crate::contact::penalty::polyhedra::Pair;
use crate::geometry::parts::Part;

impl Blocks {
    /// Makes the bonds of the pairs rigid, as they lie at the start.
    pub(super) fn fix_bonds(&mut self) {
        let pairs = self.contacts.pairs.iter();
        self.state.bonds = pairs.filter_map(|pair| self.rigid_bond(pair)).collect();
    }

    fn rigid_bond(&self, pair: &Pair) -> Option<KeptBond> {
        let bond = pair.history.bond?;
        let part = |part: u32| &self.derived.parts[part as usize];
        let (Part::Polyhedron(a), Part::Polyhedron(b)) = (part(pair.parts.0), part(pair.parts.1))
        else {
            return None;
        };
        let narrow = NarrowPhase {
            bodies: (a, b),
            detection: self.constants.settings.contact_detection,
            gravity: self.constants.settings.gravity,
            scaling: self.joint_between(pair.parts).scaling,
        };
        let mut patch = Patch::default();
        narrow.find_bonded(&pair.axis, &mut patch);
        let normal = patch.manifold.normal;
        let outline: Vec<_> = patch.bonded_outline().collect();
        let middle = center(&outline, &normal)?;
        let [first, second] = [pair.blocks.0, pair.blocks.1].map(|b| b as usize);
        let attitudes = [first, second].map(|b| self.state.attitude[b]);
        let from_first = attitudes[0].inverse();
        Some(KeptBond {
            parts: pair.parts,
            blocks: pair.blocks,
            bond,
            anchors: [first, second].map(|b| {
                let arm = middle - self.state.centroid[b];
                self.state.attitude[b].inverse_transform_vector(&arm)
            }),
            attitude: from_first * attitudes[1],
            normal: from_first * normal,
            outline: outline.iter().map(|x| from_first * (x - middle)).collect(),
        })
    }
}
