//! Contact forces of all pairs, and their sums for each block.

use crate::blocks::{CHUNK, Contacts, Derived, State};
use crate::chunks::PerChunk;
use crate::contact::detection::broad_phase;
use crate::contact::penalty::PointForce;
use crate::contact::penalty::polyhedra::{Pair, Workspace};
use crate::contact::penalty::spheres::{
    PairRates, Rolling, SphereContact, SphereLoads, SphereMark, SpherePair, SphereRow,
};
use crate::contact::penalty::terrain::SurfacePair;
use crate::contact::rates::{BlockRates, Listed};
use crate::contact::tally::{PAIR_CHUNK, Tally};
use crate::motion::kinematics::stretch;
use crate::step::phase::Phase;
use crate::{Blocks, Load, Vec3, chunks};
use nalgebra::Matrix3;

impl Blocks {
    /// Contact forces at the current position, and their dissipation in the last `dt` (s).
    pub(crate) fn evaluate_contacts(&mut self, dt: f64, ended: &mut impl FnMut(Phase)) {
        let pairs = self.evaluate_pairs(dt);
        let spheres = self.evaluate_spheres(dt);
        let tally = pairs.with(spheres).with(self.evaluate_surfaces(dt));
        ended(Phase::Contacts);
        std::mem::swap(
            &mut self.state.contact_load,
            &mut self.state.contact_load_before,
        );
        self.sum_loads();
        ended(Phase::Sums);
        self.state.totals.friction.book(tally.friction);
        self.state.totals.damping.book(tally.damping);
        self.state.totals.rolling_impulse += tally.rolling_impulse;
        self.state.totals.n_broken_bonds += tally.n_broken;
        self.state.totals.n_axis_searches += tally.n_searches;
        self.state.totals.n_contact_updates += tally.n_touching;
        self.state.totals.max_overlap_over_size = self
            .state
            .totals
            .max_overlap_over_size
            .max(tally.deepest_over_size);
        self.state.worst_overlap = tally.worst;
        self.derived.has_half_kick_corrections = tally.n_cut > 0;
    }

    /// Clears the half-kick corrections after the step: those of bodies that met or parted in it do not apply to
    /// the next one.
    pub(crate) fn drop_half_kick_corrections(&mut self) {
        if !std::mem::take(&mut self.derived.has_half_kick_corrections) {
            return;
        }
        for pair in &mut self.contacts.pairs {
            pair.loads.half_kick_corrections.clear();
        }
        for pair in &mut self.contacts.surface_pairs {
            pair.loads.half_kick_corrections.clear();
        }
        self.sum_loads();
    }

    fn evaluate_pairs(&mut self, dt: f64) -> Tally {
        let (lists, context, boxes) = self.split_pairs();
        type Rows<'a> = (&'a mut [Pair], PerChunk<'a, Workspace>);
        let update = |_, (pairs, workspaces): Rows| {
            let mut tally = Tally::default();
            let Some(work) = workspaces.rows.first_mut() else {
                return tally;
            };
            for pair in pairs {
                if context.are_still(pair.blocks)
                    || context.travel_of(pair.blocks) < pair.apart_until
                {
                    continue;
                }
                let is_near = broad_phase::overlap(
                    &boxes[pair.parts.0 as usize],
                    &boxes[pair.parts.1 as usize],
                );
                if pair.is_idle && !is_near {
                    continue;
                }
                pair.evaluate(&context, dt, is_near, work);
                tally.add(&pair.loads);
                tally.n_searches += u64::from(is_near && pair.axis.has_searched);
                if pair.is_touching {
                    context.note_overlap(pair.parts, pair.loads.deepest, &mut tally);
                }
            }
            tally
        };
        let pairs = lists.pairs.as_mut_slice();
        let workspaces = PerChunk {
            rows: lists.workspaces.as_mut_slice(),
            len: pairs.len(),
            chunk: PAIR_CHUNK,
        };
        chunks::reduce((pairs, workspaces), PAIR_CHUNK, &update, &Tally::with)
    }

    fn evaluate_spheres(&mut self, dt: f64) -> Tally {
        let (lists, context, _) = self.split_pairs();
        type Rows<'a> = (
            &'a [SpherePair],
            &'a mut [SphereMark],
            &'a mut [SphereContact],
            &'a mut [SphereLoads],
            &'a mut [PairRates],
        );
        let columns = (
            lists.sphere_pairs.as_slice(),
            lists.sphere_marks.as_mut_slice(),
            lists.sphere_contacts.as_mut_slice(),
            lists.sphere_loads.as_mut_slice(),
            lists.sphere_rates.as_mut_slice(),
        );
        let evaluate = |rows: Rows, rolling: Option<&mut [Rolling]>| {
            let mut tally = Tally::default();
            let mut rolling = rolling.into_iter().flatten();
            let rows = rows
                .0
                .iter()
                .zip(rows.1)
                .zip(rows.2)
                .zip(rows.3)
                .zip(rows.4);
            for ((((pair, mark), contact), loads), rates) in rows {
                let rolling = rolling.next();
                if context.are_still(pair.blocks) {
                    continue;
                }
                let row = SphereRow {
                    pair,
                    mark,
                    contact,
                    loads,
                    rates,
                    rolling,
                };
                row.evaluate(&context, dt, &mut tally);
            }
            tally
        };
        if lists.sphere_rolling.is_empty() {
            let update = |_, rows: Rows| evaluate(rows, None);
            return chunks::reduce(columns, CHUNK, &update, &Tally::with);
        }
        let update = |_, (rows, rolling): (Rows, &mut [Rolling])| evaluate(rows, Some(rolling));
        let columns = (columns, lists.sphere_rolling.as_mut_slice());
        chunks::reduce(columns, CHUNK, &update, &Tally::with)
    }

    fn evaluate_surfaces(&mut self, dt: f64) -> Tally {
        let (lists, context, _) = self.split_pairs();
        let update = |_, pairs: &mut [SurfacePair]| {
            let mut tally = Tally::default();
            for pair in pairs {
                if context.are_still(pair.blocks) {
                    continue;
                }
                pair.evaluate(&context, dt);
                tally.add(&pair.loads);
                if pair.is_touching {
                    context.note_overlap(pair.parts, pair.loads.deepest, &mut tally);
                }
            }
            tally
        };
        let pairs = lists.surface_pairs.as_mut_slice();
        chunks::reduce(pairs, PAIR_CHUNK, &update, &Tally::with)
    }

    /// Sums the pairs' forces and step bounds for each block, in the order of the lists, whatever thread
    /// found them.
    pub(crate) fn sum_loads(&mut self) {
        let Self {
            state:
                State {
                    contact_load,
                    rates,
                    kinematics,
                    ..
                },
            derived,
            contacts,
            ..
        } = self;
        let sums = PairSums { contacts, derived };
        let sum = |first: usize, (loads, rates): (&mut [Load], &mut [BlockRates])| {
            for ((b, load), rates) in (first..).zip(loads).zip(rates) {
                let has_new_rates;
                (*load, has_new_rates) = sums.load(b, &kinematics[b].centroid);
                if has_new_rates {
                    *rates = sums.rates(b);
                }
            }
        };
        chunks::for_each(
            (contact_load.as_mut_slice(), rates.as_mut_slice()),
            CHUNK,
            &sum,
        );
        self.derived.has_new_links = false;
        if !self.state.deformables.is_empty() {
            self.sum_stretch();
        }
    }

    /// Generalized strain forces from contacts, deformable blocks only.
    fn sum_stretch(&mut self) {
        self.state.contact_stretch.clear();
        self.state
            .contact_stretch
            .resize(self.state.deformables.len(), Matrix3::zeros());
        let acts = |pair: &&Pair| pair.is_touching || !pair.loads.half_kick_corrections.is_empty();
        for pair in self.contacts.pairs.iter().filter(acts) {
            for (block, sign) in [(pair.blocks.0, -1.0), (pair.blocks.1, 1.0)] {
                let b = block as usize;
                let Some(k) = self.constants.deformable_of[b] else {
                    continue;
                };
                for correction in &pair.loads.half_kick_corrections {
                    let offset = correction.point - self.state.kinematics[b].centroid;
                    self.state.contact_stretch[k as usize] +=
                        stretch(&(correction.force * sign), &offset);
                }
                for point in &pair.history.points {
                    let force =
                        (pair.history.normal * point.normal_force + point.shear_force) * sign;
                    let offset = point.at.position - self.state.kinematics[b].centroid;
                    self.state.contact_stretch[k as usize] += stretch(&force, &offset);
                }
            }
        }
        for pair in &self.contacts.surface_pairs {
            let b = pair.blocks.0 as usize;
            if let Some(k) = self.constants.deformable_of[b] {
                pair.for_each_contact(&mut |contact| {
                    let force = -(contact.normal * contact.normal_force + contact.shear_force);
                    let offset = contact.point - self.state.kinematics[b].centroid;
                    self.state.contact_stretch[k as usize] += stretch(&force, &offset);
                });
                for correction in &pair.loads.half_kick_corrections {
                    let offset = correction.point - self.state.kinematics[b].centroid;
                    self.state.contact_stretch[k as usize] += stretch(&-correction.force, &offset);
                }
            }
        }
        for (k, pair) in self.contacts.sphere_pairs.iter().enumerate() {
            let loads = &self.contacts.sphere_loads[k];
            for (block, sign) in [(pair.blocks.0, -1.0), (pair.blocks.1, 1.0)] {
                let b = block as usize;
                if let Some(k) = self.constants.deformable_of[b] {
                    let offset = loads.point - self.state.kinematics[b].centroid;
                    self.state.contact_stretch[k as usize] +=
                        stretch(&(loads.force * sign), &offset);
                }
            }
        }
    }
}

/// Sums of the pairs of a block.
#[derive(Clone, Copy)]
struct PairSums<'a> {
    contacts: &'a Contacts,
    derived: &'a Derived,
}

impl PairSums<'_> {
    /// Load on a block of some centroid (m), and whether the share of any of its pairs in the step bound has changed.
    fn load(&self, b: usize, centroid: &Vec3) -> (Load, bool) {
        let mut load = Load::default();
        let mut has_new_rates = self.derived.has_new_links;
        for (k, is_second) in self.derived.links.of(b) {
            has_new_rates = true;
            let pair = &self.contacts.pairs[k];
            if pair.is_touching {
                load += *side(&pair.loads.on_blocks, is_second);
            }
            load.add_all(&pair.loads.half_kick_corrections, is_second, centroid);
        }
        for (k, is_second) in self.derived.sphere_links.of(b) {
            has_new_rates |= self.contacts.sphere_marks[k].has_new_rates;
            // those of a pair that is apart are zero: to add them takes less time than to ask
            let SphereLoads { force, point } = &self.contacts.sphere_loads[k];
            let sign = if is_second { 1.0 } else { -1.0 };
            load.add(&(force * sign), &(point - centroid));
            if let Some(rolling) = self.contacts.sphere_rolling.get(k) {
                load.torque += side(&rolling.torques, is_second);
            }
        }
        for (k, is_second) in self.derived.surface_links.of(b) {
            has_new_rates = true;
            let pair = &self.contacts.surface_pairs[k];
            load += *side(&pair.loads.on_blocks, is_second);
            load.add_all(&pair.loads.half_kick_corrections, is_second, centroid);
        }
        (load, has_new_rates)
    }

    /// Share of the contacts of a block in its step bound.
    fn rates(&self, b: usize) -> BlockRates {
        let mut all = BlockRates::default();
        for (k, is_second) in self.derived.links.of(b) {
            let pair = &self.contacts.pairs[k];
            let rates = side(&pair.rates, is_second);
            all.add(rates, pair.is_touching, (Listed::Pair, k as u32));
        }
        for (k, is_second) in self.derived.sphere_links.of(b) {
            let rates = side(&self.contacts.sphere_rates[k], is_second);
            let is_touching = self.contacts.sphere_marks[k].is_touching;
            all.add(rates, is_touching, (Listed::Sphere, k as u32));
        }
        for (k, is_second) in self.derived.surface_links.of(b) {
            if !is_second {
                let pair = &self.contacts.surface_pairs[k];
                let contact = (Listed::Surface, k as u32);
                all.add(&pair.rates, pair.is_touching, contact);
            }
        }
        all
    }
}

impl Load {
    /// Adds forces on the second body of a pair, or the reactions on the first; its centroid, m.
    fn add_all(&mut self, forces: &[PointForce], is_second: bool, centroid: &Vec3) {
        let sign = if is_second { 1.0 } else { -1.0 };
        for at in forces {
            self.add(&(at.force * sign), &(at.point - centroid));
        }
    }
}

fn side<T>(of: &(T, T), is_second: bool) -> &T {
    if is_second { &of.1 } else { &of.0 }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::{BlockDefinition, Material, Motion, Polyhedron, Settings, Shape, Vec3};

    /// Spheres, a cube among them, that fall on a floor.
    fn shower() -> Blocks {
        let rock = Material {
            density: 2500.0,
            friction_angle: 0.5,
            residual_friction_angle: None,
            cohesion: 0.0,
            residual_cohesion: 0.0,
            tensile_strength: 0.0,
            restitution: 0.5,
            contact_stiffness: 1e7,
            joint_stiffness: None,
            shear_stiffness_ratio: 0.5,
            shear_damping_ratio: 0.2,
            rolling_friction: 0.0,
            twisting_friction: 0.0,
            elastic: None,
        };
        let body = |shape, motion| BlockDefinition {
            shape,
            material: 0,
            motion,
            velocity: Vec3::zeros(),
            angular_velocity: Vec3::zeros(),
            deformability: None,
        };
        let cuboid = |from: [f64; 3], to: [f64; 3]| {
            Shape::Polyhedra(vec![Polyhedron::cuboid(from.into(), to.into()).unwrap()])
        };
        let mut bodies = vec![
            body(cuboid([-5.0, -5.0, -1.0], [5.0, 5.0, 0.0]), Motion::Fixed),
            body(cuboid([0.0, 0.0, 1.5], [0.8, 0.8, 2.3]), Motion::Free),
        ];
        for k in 0..64 {
            let place = Vec3::from([k % 4, k / 4 % 4, k / 16].map(f64::from));
            let sideways = Vec3::new(0.1 * place.z, 0.05 * place.x, 0.0);
            let center = place * 0.9 + sideways + Vec3::new(-1.5, -1.5, 2.9);
            let ball = Shape::Sphere {
                center,
                radius: 0.4,
            };
            bodies.push(body(ball, Motion::Free));
        }
        Blocks::new(bodies, vec![rock], Settings::default()).unwrap()
    }

    #[test]
    fn rates_that_are_kept_are_those_that_a_new_sum_gives() {
        let mut blocks = shower();
        let (mut kept, mut n_contacts) = (0, 0);
        for _ in 0..4000 {
            let dt = blocks.critical_time_step().dt;
            blocks.advance(0.0, dt, 1).unwrap();
            kept += usize::from(
                blocks
                    .contacts
                    .sphere_marks
                    .iter()
                    .all(|mark| !mark.has_new_rates),
            );
            n_contacts = n_contacts.max(blocks.n_contacts());
            let before = blocks.critical_time_step();
            let rates = blocks.state.rates.clone();
            blocks.derived.has_new_links = true;
            blocks.sum_loads();
            assert_eq!(blocks.critical_time_step(), before);
            for (new, old) in blocks.state.rates.iter().zip(&rates) {
                let all = |r: &BlockRates| (r.stiffness, r.damping, r.next_stiffness, r.stiffest);
                assert_eq!(all(new), all(old));
            }
        }
        assert!(kept > 100 && n_contacts > 60, "{kept} {n_contacts}");
    }
}
