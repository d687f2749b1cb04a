//! Springs of all contacts that touch.

use crate::Blocks;
use crate::contact::spring::Spring;

impl Blocks {
    /// Those of all pairs; of spheres on surfaces there are none.
    pub(super) fn springs(&self) -> Vec<Spring> {
        let mut springs = Vec::new();
        for pair in self.contacts.pairs.iter().filter(|pair| pair.is_touching) {
            springs.extend(pair.springs(self.joint_between(pair.parts)));
        }
        springs.extend(self.touching_spheres().map(|k| self.spring_of_spheres(k)));
        for pair in &self.contacts.surface_pairs {
            springs.extend(pair.springs(self.joint_between(pair.parts)));
        }
        springs
    }

    /// That of a pair with a sphere.
    pub(super) fn spring_of_spheres(&self, k: usize) -> Spring {
        let (pair, contact) = (
            &self.contacts.sphere_pairs[k],
            &self.contacts.sphere_contacts[k],
        );
        let joint = &self.joint_between(pair.parts).spheres;
        let (along, across) = contact.dashpots();
        Spring {
            blocks: [pair.blocks.0 as usize, pair.blocks.1 as usize],
            point: self.contacts.sphere_loads[k].point,
            normal: contact.normal,
            stiffness: [contact.tangent(joint), contact.shear_stiffness],
            dashpot: [along, across],
        }
    }
}
