//! Balances of the whole system: contacts, energies, momentum, counts.

use crate::contact::dynamics::kept::KeptImpulse;
use crate::material::{Joint, SphereJoint};
use crate::{Blocks, Contact, ContactState, Energies, Vec3};

impl Blocks {
    /// Contact points of the last step, sorted by parts; those of spheres after the others,
    /// those on surfaces last, the surface second. Of contact dynamics those that bear an impulse, all sorted by parts.
    pub fn contacts(&self) -> Vec<Contact> {
        let of_pairs = (0..self.contacts.pairs.len()).flat_map(|k| self.contacts_of_pair(k));
        let of_spheres = self.touching_spheres().map(|k| self.sphere_contact(k));
        let mut contacts: Vec<Contact> = of_pairs.chain(of_spheres).collect();
        for pair in &self.contacts.surface_pairs {
            pair.for_each_contact(&mut |contact| contacts.push(contact));
        }
        for of_parts in self.state.impulses.chunk_by(|a, b| a.parts == b.parts) {
            let kept = of_parts.iter().zip(0..);
            let bear = kept.filter(|(kept, _)| kept.state != ContactState::Open);
            contacts.extend(bear.map(|(kept, key)| kept.contact(key)));
        }
        contacts
    }

    /// Visits the contact points of some blocks, in ascending order, after the last step: as [`Self::contacts`], but at the cost of
    /// their own contacts alone, and without a list. A point between two of the blocks is visited for each of them.
    pub fn for_each_contact_of(&self, blocks: &[usize], visit: &mut dyn FnMut(usize, &Contact)) {
        for &b in blocks {
            for (k, _) in self.derived.links.of(b) {
                for contact in self.contacts_of_pair(k) {
                    visit(b, &contact);
                }
            }
            for (k, _) in self.derived.sphere_links.of(b) {
                if self.contacts.sphere_marks[k].is_touching {
                    visit(b, &self.sphere_contact(k));
                }
            }
            for (k, _) in self.derived.surface_links.of(b) {
                self.contacts.surface_pairs[k].for_each_contact(&mut |contact| visit(b, &contact));
            }
        }
        // contact dynamics has no list for each block; its points are few beside the work of solving them
        let bear = |kept: &&KeptImpulse| kept.state != ContactState::Open;
        for kept in self.state.impulses.iter().filter(bear) {
            for b in [kept.blocks.0, kept.blocks.1].map(|b| b as usize) {
                if blocks.binary_search(&b).is_ok() {
                    visit(b, &kept.contact(0));
                }
            }
        }
    }

    fn contacts_of_pair(&self, k: usize) -> impl Iterator<Item = Contact> + '_ {
        let pair = &self.contacts.pairs[k];
        pair.history.points.iter().map(move |point| Contact {
            blocks: (pair.blocks.0.into(), pair.blocks.1.into()),
            parts: (pair.parts.0.into(), pair.parts.1.into()),
            key: point.at.key,
            point: point.at.position,
            normal: pair.history.normal,
            normal_force: point.normal_force,
            shear_force: point.shear_force,
            overlap: point.at.overlap,
            state: point.state,
        })
    }

    fn sphere_contact(&self, k: usize) -> Contact {
        let (pair, loads) = (
            &self.contacts.sphere_pairs[k],
            &self.contacts.sphere_loads[k],
        );
        let contact = &self.contacts.sphere_contacts[k];
        Contact {
            blocks: (pair.blocks.0.into(), pair.blocks.1.into()),
            parts: (pair.parts.0.into(), pair.parts.1.into()),
            key: 0,
            point: loads.point,
            normal: contact.normal,
            normal_force: contact.normal_force,
            shear_force: loads.force - contact.normal * contact.normal_force,
            overlap: contact.overlap,
            state: contact.state(),
        }
    }

    /// Number of contact points of the last step, without making their list.
    pub fn n_contacts(&self) -> usize {
        let of_pairs: usize = self
            .contacts
            .pairs
            .iter()
            .map(|pair| pair.history.points.len())
            .sum();
        let of_surfaces = self
            .contacts
            .surface_pairs
            .iter()
            .map(|pair| pair.n_contacts());
        let kept = self.state.impulses.iter();
        let solved = kept.filter(|kept| kept.state != ContactState::Open).count();
        of_pairs + self.touching_spheres().count() + of_surfaces.sum::<usize>() + solved
    }

    /// Force evaluations of pairs of parts so far.
    pub fn contact_updates(&self) -> u64 {
        self.state.totals.n_contact_updates
    }

    /// Full separating-axis tests so far: the rest of the contact updates went on with the common plane of
    /// the step before.
    pub fn axis_searches(&self) -> u64 {
        self.state.totals.n_axis_searches
    }

    /// Bonds broken so far.
    pub fn broken_bonds(&self) -> u64 {
        self.state.totals.n_broken_bonds
    }

    /// Deepest overlap so far, × size of the smaller part (cube root of its volume).
    pub fn max_overlap_over_size(&self) -> f64 {
        self.state.totals.max_overlap_over_size
    }

    /// Energies and works; J.
    pub fn energies(&self) -> Energies {
        let mut energies = Energies {
            elastic: self
                .contacts
                .pairs
                .iter()
                .map(|pair| pair.history.elastic.0 + pair.history.elastic.1)
                .sum::<f64>()
                + self.sphere_energy()
                + self.surface_energy()
                + self.state.attachments.elastic,
            strain_damping: self.state.totals.strain_damping.total(),
            static_damping: self.state.totals.static_damping.total(),
            sleep_loss: self.state.totals.sleep_loss.total(),
            plastic: self.state.attachments.plastic.total(),
            friction: self.state.totals.friction.total(),
            damping: self.state.totals.damping.total(),
            overlap_removal: self.state.totals.overlap_removal.total(),
            joint_correction: self.state.attachments.joint_correction.total(),
            external_work: self.state.totals.external_work.total()
                + self.state.attachments.work.total(),
            ..Energies::default()
        };
        for b in (0..self.n_blocks()).filter(|&b| self.is_free(b)) {
            energies.kinetic += self.kinetic_energy(b);
            energies.potential -= self.constants.mass[b]
                * self.constants.settings.gravity.dot(&self.state.centroid[b]);
        }
        for deformable in &self.state.deformables {
            let added = deformable.body().added_kinetic_energy();
            energies.kinetic += added;
            energies.added_kinetic += added;
            energies.strain += deformable.strain_energy();
        }
        energies
    }

    fn sphere_energy(&self) -> f64 {
        self.touching_spheres()
            .map(|k| {
                let joint = self.sphere_joint(self.contacts.sphere_pairs[k].parts);
                self.contacts.sphere_contacts[k].energy(joint, self.contacts.sphere_rolling.get(k))
            })
            .sum()
    }

    /// Indices in the list of pairs with a sphere.
    pub(crate) fn touching_spheres(&self) -> impl Iterator<Item = usize> + '_ {
        let marks = self.contacts.sphere_marks.iter().enumerate();
        marks.filter(|(_, mark)| mark.is_touching).map(|(k, _)| k)
    }

    fn surface_energy(&self) -> f64 {
        self.contacts
            .surface_pairs
            .iter()
            .map(|pair| {
                let radius = self.constants.radius[pair.blocks.0 as usize];
                pair.energy(self.sphere_joint(pair.parts), radius)
            })
            .sum()
    }

    pub(crate) fn joint_between(&self, parts: (u32, u32)) -> &Joint {
        let material = |part: u32| self.constants.material_of_part[part as usize] as usize;
        &self.state.joints[material(parts.0) * self.constants.n_materials + material(parts.1)]
    }

    fn sphere_joint(&self, parts: (u32, u32)) -> &SphereJoint {
        &self.joint_between(parts).spheres
    }

    /// Momentum of the free blocks, with what acted from outside and waits for the next step of contact dynamics; N s.
    pub fn momentum(&self) -> Vec3 {
        let outside = |b: usize| {
            self.state
                .outside
                .get(b)
                .map_or(Vec3::zeros(), |of| of.force)
        };
        (0..self.n_blocks())
            .filter(|&b| self.is_free(b))
            .map(|b| self.state.velocity[b] * self.constants.mass[b] + outside(b))
            .sum()
    }

    /// Impulse that gravity, fixed and prescribed blocks, held points, loads, holds and damping for statics gave to
    /// free blocks so far; N s.
    pub fn support_impulse(&self) -> Vec3 {
        self.state.totals.support_impulse
    }

    /// Sum of the magnitudes of the impulses of gravity and of the supports, the scale of a momentum
    /// residual; N s.
    pub fn impulse_exchanged(&self) -> f64 {
        self.state.totals.impulse_exchanged
    }

    /// Angular impulse by [`RollingLaw::OwnSpin`](crate::RollingLaw::OwnSpin) on spheres so far, without reaction on another
    /// body: the defect of the angular momentum balance; zero with the other law; N m s.
    pub fn rolling_impulse(&self) -> Vec3 {
        self.state.totals.rolling_impulse
    }
}
