//! Every number of the state in a fixed order, as a hash of the state reads them.

use crate::Blocks;

impl Blocks {
    /// Visits every number of the state in a fixed order: the content of a restart and of the state
    /// hash.
    pub fn for_each_state_f64(&self, f: &mut dyn FnMut(f64)) {
        for b in 0..self.n_blocks() {
            self.state.centroid[b].iter().for_each(|&c| f(c));
            self.state.velocity[b].iter().for_each(|&c| f(c));
            self.state.attitude[b].coords.iter().for_each(|&c| f(c));
            self.state.angular_momentum[b].iter().for_each(|&c| f(c));
            f(f64::from(u8::from(self.state.is_removed[b])));
        }
        for pair in &self.contacts.pairs {
            let history = &pair.history;
            f(f64::from(pair.parts.0));
            f(f64::from(pair.parts.1));
            f(history.elastic.0);
            f(history.elastic.1);
            history.shear.shift.iter().for_each(|&c| f(c));
            history.shear.center.iter().for_each(|&c| f(c));
            f(history.shear.twist);
            f(history.shear.weight);
            f(f64::from(u8::from(history.has_slipped)));
            f(history.bond.map_or(-1.0, |bond| bond.area));
            f(f64::from(u8::from(history.is_broken)));
            f(history.stiffness_share);
            if let Some(axis) = pair.axis.axis {
                axis.normal.iter().for_each(|&c| f(c));
                f(axis.gap);
            }
            f(pair.axis.verified_gap);
            f(pair.axis.lead);
            f(f64::from(pair.axis.trust));
            f(f64::from(pair.axis.trusted));
            for point in &history.points {
                f(f64::from(point.at.key));
                f(point.normal_force);
                f(point.normal_viscous);
                point.shear_force.iter().for_each(|&c| f(c));
                point.shear_viscous.iter().for_each(|&c| f(c));
            }
        }
        for (k, pair) in self.contacts.sphere_pairs.iter().enumerate() {
            let contact = &self.contacts.sphere_contacts[k];
            f(f64::from(pair.parts.0));
            f(f64::from(pair.parts.1));
            f(f64::from(u8::from(contact.is_slipping)));
            self.contacts.sphere_loads[k]
                .force
                .iter()
                .for_each(|&c| f(c));
            contact.shear.iter().for_each(|&c| f(c));
            f(contact.normal_force);
            if let Some(rolling) = self.contacts.sphere_rolling.get(k) {
                rolling.for_each_state_f64(f);
            }
        }
        for pair in &self.contacts.surface_pairs {
            f(f64::from(pair.parts.0));
            f(f64::from(pair.parts.1));
            pair.for_each_state_f64(f);
        }
        self.for_each_of_contact_dynamics(f);
        for deformable in &self.state.deformables {
            deformable.for_each_state_f64(f);
        }
        self.state.attachments.for_each_state_f64(f);
        f(self.state.totals.strain_damping.total());
        f(self.state.totals.static_damping.total());
        f(self.state.totals.friction.total());
        f(self.state.totals.damping.total());
        f(self.state.totals.external_work.total());
        self.state.totals.support_impulse.iter().for_each(|&c| f(c));
        self.state.totals.rolling_impulse.iter().for_each(|&c| f(c));
        f(self.state.totals.impulse_exchanged);
        f(self.state.totals.max_overlap_over_size);
    }

    /// Impulses of the last step of contact dynamics, and what waits for the next one.
    fn for_each_of_contact_dynamics(&self, f: &mut dyn FnMut(f64)) {
        for kept in &self.state.impulses {
            f(f64::from(kept.parts.0));
            f(f64::from(kept.parts.1));
            let both = kept.impulse.iter().chain(kept.torque.iter());
            both.for_each(|&c| f(c));
            f(f64::from(u8::from(kept.has_slipped)));
        }
        f(self.state.bonds.len() as f64);
        if !self.state.outside.is_empty() {
            f(self.state.spanned.owed);
            f(self.state.spanned.period);
        }
        for outside in self.state.outside.iter().chain(&self.state.spanned.ahead) {
            let both = outside.force.iter().chain(outside.torque.iter());
            both.for_each(|&c| f(c));
        }
        let stretches = self.state.outside_stretch.iter();
        stretches.flat_map(|of| of.iter()).for_each(|&c| f(c));
    }
}
