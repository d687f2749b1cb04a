//! Contact forces of all pairs, and what they add up to for each block.

use crate::{
    Blocks, Load, Vec3,
    blocks::CHUNK,
    broad_phase, chunks,
    contact::{Pair, Rates},
    critical_step::{BlockRates, Listed},
    kinematics::stretch,
    sphere_contact::{Rolling, SphereLoads, SpherePair},
    surface_contact::SurfacePair,
};
use nalgebra::Matrix3;

/// Pairs of polyhedra that one thread takes at a time.
pub(crate) const PAIR_CHUNK: usize = 16;

/// What the pairs of a chunk add up to in a step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally {
    /// Lost; J.
    pub friction: f64,
    pub damping: f64,
    /// Angular impulse that rolling resistance took out of both sides together; N m s.
    pub rolling_impulse: Vec3,
    pub n_touching: u64,
    pub n_broken: u64,
    /// Full separating-axis tests.
    pub n_searches: u64,
    /// Deepest overlap, × size of the smaller part.
    pub deepest_over_size: f64,
    /// Deepest overlap, × what is allowed, with its parts.
    pub worst: (f64, (u32, u32)),
}

impl Tally {
    fn with(self, other: Self) -> Self {
        Self {
            friction: self.friction + other.friction,
            damping: self.damping + other.damping,
            rolling_impulse: self.rolling_impulse + other.rolling_impulse,
            n_touching: self.n_touching + other.n_touching,
            n_broken: self.n_broken + other.n_broken,
            n_searches: self.n_searches + other.n_searches,
            deepest_over_size: self.deepest_over_size.max(other.deepest_over_size),
            worst: if other.worst.0 > self.worst.0 {
                other.worst
            } else {
                self.worst
            },
        }
    }

    /// Notes how deep two parts overlap; × what is allowed and × size.
    pub fn note_overlap(&mut self, parts: (u32, u32), over_allowed: f64, over_size: f64) {
        self.n_touching += 1;
        self.deepest_over_size = self.deepest_over_size.max(over_size);
        if over_allowed > self.worst.0 {
            self.worst = (over_allowed, parts);
        }
    }
}

impl Blocks {
    /// Contact forces in the present place, and what they lost in the last `dt` (s).
    pub(crate) fn evaluate_contacts(&mut self, dt: f64) {
        let pairs = self.evaluate_pairs(dt);
        let spheres = self.evaluate_spheres(dt);
        let tally = pairs.with(spheres).with(self.evaluate_surfaces(dt));
        std::mem::swap(&mut self.contact_load, &mut self.contact_load_before);
        self.sum_loads();
        self.friction.book(tally.friction);
        self.damping.book(tally.damping);
        self.rolling_impulse += tally.rolling_impulse;
        self.n_broken_bonds += tally.n_broken;
        self.n_axis_searches += tally.n_searches;
        self.n_contact_updates += tally.n_touching;
        self.max_overlap_over_size = self.max_overlap_over_size.max(tally.deepest_over_size);
        self.worst_overlap = tally.worst;
    }

    fn evaluate_pairs(&mut self, dt: f64) -> Tally {
        let (lists, medium, boxes) = self.split_pairs();
        let update = |_, pairs: &mut [Pair]| {
            let mut tally = Tally::default();
            for pair in pairs {
                let is_near = broad_phase::overlap(
                    &boxes[pair.parts.0 as usize],
                    &boxes[pair.parts.1 as usize],
                );
                pair.evaluate(&medium, dt, is_near);
                tally.friction += pair.friction;
                tally.damping += pair.damping;
                tally.n_broken += u64::from(pair.has_broken);
                tally.n_searches += u64::from(is_near && pair.axis.has_searched);
                if pair.is_touching() {
                    tally.note_overlap(
                        pair.parts,
                        pair.deepest / medium.least_of(pair.parts, medium.deepest_allowed),
                        pair.deepest / medium.least_of(pair.parts, medium.size),
                    );
                }
            }
            tally
        };
        chunks::reduce(
            lists.pairs.as_mut_slice(),
            PAIR_CHUNK,
            &update,
            &Tally::with,
        )
    }

    fn evaluate_spheres(&mut self, dt: f64) -> Tally {
        let (lists, medium, _) = self.split_pairs();
        let (pairs, loads) = (
            lists.sphere_pairs.as_mut_slice(),
            lists.sphere_loads.as_mut_slice(),
        );
        type Rows<'a> = (&'a mut [SpherePair], &'a mut [SphereLoads]);
        if lists.sphere_rolling.is_empty() {
            let update = |_, (pairs, loads): Rows| {
                let mut tally = Tally::default();
                for (pair, loads) in pairs.iter_mut().zip(loads) {
                    pair.evaluate(&medium, loads, None, dt, &mut tally);
                }
                tally
            };
            return chunks::reduce((pairs, loads), CHUNK, &update, &Tally::with);
        }
        let update = |_, (rows, rolling): (Rows, &mut [Rolling])| {
            let mut tally = Tally::default();
            for ((pair, loads), rolling) in rows.0.iter_mut().zip(rows.1).zip(rolling) {
                pair.evaluate(&medium, loads, Some(rolling), dt, &mut tally);
            }
            tally
        };
        let columns = ((pairs, loads), lists.sphere_rolling.as_mut_slice());
        chunks::reduce(columns, CHUNK, &update, &Tally::with)
    }

    fn evaluate_surfaces(&mut self, dt: f64) -> Tally {
        let (lists, medium, _) = self.split_pairs();
        let update = |_, pairs: &mut [SurfacePair]| {
            let mut tally = Tally::default();
            for pair in pairs {
                pair.evaluate(&medium, dt);
                tally.friction += pair.friction;
                tally.damping += pair.damping;
                tally.rolling_impulse += pair.rolling_impulse;
                if pair.is_touching {
                    tally.note_overlap(
                        pair.parts,
                        pair.deepest / medium.least_of(pair.parts, medium.deepest_allowed),
                        pair.deepest / medium.least_of(pair.parts, medium.size),
                    );
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
            contact_load,
            rates,
            links,
            sphere_links,
            pairs,
            sphere_loads,
            surface_links,
            surface_pairs,
            ..
        } = self;
        let sum = |first: usize, (loads, rates): (&mut [Load], &mut [BlockRates])| {
            for ((b, load), all) in (first..).zip(loads).zip(rates) {
                *load = Load::default();
                *all = BlockRates::default();
                for (k, is_second) in links.of(b) {
                    let pair = &pairs[k];
                    let (part, rates) = if is_second {
                        (&pair.loads.1, &pair.rates.1)
                    } else {
                        (&pair.loads.0, &pair.rates.0)
                    };
                    if pair.is_touching() {
                        *load += *part;
                    }
                    if all.add(rates, pair.is_touching()) {
                        all.contact = Some((Listed::Pair, k as u32));
                    }
                }
                for (k, is_second) in sphere_links.of(b) {
                    let pair = &sphere_loads[k];
                    let (sign, torque, rates) = if is_second {
                        (1.0, &pair.torques.1, &pair.rates.1)
                    } else {
                        (-1.0, &pair.torques.0, &pair.rates.0)
                    };
                    load.force += pair.force * sign;
                    load.torque += torque;
                    if all.add(rates, pair.is_touching) {
                        all.contact = Some((Listed::Sphere, k as u32));
                    }
                }
                for (k, is_second) in surface_links.of(b) {
                    let pair = &surface_pairs[k];
                    if is_second {
                        *load += pair.loads.1;
                        continue;
                    }
                    *load += pair.loads.0;
                    if all.add(&pair.rates, pair.is_touching) {
                        all.contact = Some((Listed::Surface, k as u32));
                    }
                }
            }
        };
        chunks::for_each(
            (contact_load.as_mut_slice(), rates.as_mut_slice()),
            CHUNK,
            &sum,
        );
        if !self.deformables.is_empty() {
            self.sum_stretch();
        }
    }

    /// What the contact forces strain, deformable blocks only.
    fn sum_stretch(&mut self) {
        self.contact_stretch.clear();
        self.contact_stretch
            .resize(self.deformables.len(), Matrix3::zeros());
        for pair in self.pairs.iter().filter(|pair| pair.is_touching()) {
            for (block, sign) in [(pair.blocks.0, -1.0), (pair.blocks.1, 1.0)] {
                let b = block as usize;
                let Some(k) = self.deformable_of[b] else {
                    continue;
                };
                for point in &pair.points {
                    let force = (pair.normal * point.normal_force + point.shear_force) * sign;
                    let offset = point.patch.position - self.kinematics[b].centroid;
                    self.contact_stretch[k as usize] += stretch(&force, &offset);
                }
            }
        }
        for pair in &self.surface_pairs {
            let b = pair.blocks.0 as usize;
            if let Some(k) = self.deformable_of[b] {
                pair.for_each_contact(&mut |contact| {
                    let force = -(contact.normal * contact.normal_force + contact.shear_force);
                    let offset = contact.point - self.kinematics[b].centroid;
                    self.contact_stretch[k as usize] += stretch(&force, &offset);
                });
            }
        }
        for (pair, loads) in self.sphere_pairs.iter().zip(&self.sphere_loads) {
            for (block, sign) in [(pair.blocks.0, -1.0), (pair.blocks.1, 1.0)] {
                let b = block as usize;
                if let Some(k) = self.deformable_of[b] {
                    let offset = pair.contact.point - self.kinematics[b].centroid;
                    self.contact_stretch[k as usize] += stretch(&(loads.force * sign), &offset);
                }
            }
        }
    }
}

impl BlockRates {
    /// Adds a pair; is it the stiffest so far?
    fn add(&mut self, rates: &Rates, is_touching: bool) -> bool {
        if is_touching {
            self.stiffness += rates.stiffness;
            self.damping += rates.damping;
        } else {
            self.next_stiffness = self.next_stiffness.max(rates.stiffness);
            self.next_damping = self.next_damping.max(rates.damping);
        }
        let is_stiffest = rates.stiffness > self.stiffest;
        if is_stiffest {
            self.stiffest = rates.stiffness;
        }
        is_stiffest
    }
}
