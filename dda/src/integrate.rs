//! Time stepping: kick, drift, kick, with exact rotations; and the largest stable step.
//!
//! ```text
//! v += dt/2 M⁻¹f;   x += dt v,  Q := Q R;   contacts, f;   v += dt/2 M⁻¹f
//! ```

use crate::{
    Blocks, Load, Motion, StaticDamping, StepError, Vec3, broad_phase,
    damping::local_damping,
    kinematics::{InternalMotion, Moment, stretch},
    rigid::Rigid6,
};
use nalgebra::Matrix3;
use rayon::prelude::*;

/// Fewer pairs than this are not worth waking threads for.
const PARALLEL_PAIRS: usize = 64;

/// Principal value of Green's strain below which Saint Venant-Kirchhoff's law softens; –.
const CRUSHED: f64 = -0.2;

/// The largest stable sub-step and who sets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CriticalStep {
    /// `C_b` × the bound; infinite when nothing limits; s.
    pub dt: f64,
    /// The block that sets it.
    pub block: Option<usize>,
    /// Its stiffest pair of blocks; none when the block's speed sets the step.
    pub contact: Option<(usize, usize)>,
}

impl Blocks {
    /// Bound of the stable sub-step, from the present contacts and those about to form.
    ///
    /// ```text
    /// ω_i² = Λ_K ≤ ω_el² + s Σ ( k_n w_n + k_t (w_t1 + w_t2) )      s = 2 if the partner is free, else 1
    /// Λ_C ≤ 2 ξ_el ω_el + s Σ ( c_n w_n + c_t (w_t1 + w_t2) )
    /// dt   = C_b min_i (√(Λ_C² + 4 Λ_K) − Λ_C)/Λ_K,   from   (dt/2)² Λ_K + dt/2 Λ_C ≤ 1           [s]
    /// ```
    /// ω_el is the largest natural frequency of a deformable block; springs and bolts count like
    /// contacts. For one mode this is `(2/ω)(√(1 + ξ²) − ξ)`; a dashpot that damps the heave of a block
    /// critically damps its rocking, which is faster, beyond that, and it is the sum over the points that
    /// counts. Of the candidate pairs that do not touch yet the worst one counts, with its worst
    /// contact point: one impact at a time may start without warning. A free block
    /// among others may also not travel more than half the margin of its candidate search.
    pub fn critical_time_step(&self) -> CriticalStep {
        let mut found = CriticalStep {
            dt: f64::INFINITY,
            block: None,
            contact: None,
        };
        let n = self.n_blocks();
        let mut rate = vec![0.0; n];
        let mut damping = vec![0.0; n];
        let mut next = vec![(0.0, 0.0); n];
        let mut stiffest = vec![(0.0, None); n];
        for pair in &self.pairs {
            let (i, j) = (pair.blocks.0 as usize, pair.blocks.1 as usize);
            let rates = pair.rates;
            for (block, partner, rates) in [(i, j, rates.0), (j, i, rates.1)] {
                let both = if self.is_free(partner) { 2.0 } else { 1.0 };
                let share = both * rates.stiffness;
                if pair.is_touching() {
                    rate[block] += share;
                    damping[block] += both * rates.damping;
                } else {
                    next[block].0 = f64::max(next[block].0, share);
                    next[block].1 = f64::max(next[block].1, both * rates.damping);
                }
                if share > stiffest[block].0 {
                    stiffest[block] = (share, Some((i, j)));
                }
            }
        }
        self.attachments
            .add_stiffness_rates(&self.kinematics, |b| self.is_free(b), &mut rate);
        for b in 0..n {
            if let Some(k) = self.deformable_of[b] {
                let (square, xi) = self.deformables[k as usize].stiffness_rate();
                rate[b] += square;
                damping[b] += 2.0 * xi * square.sqrt();
            }
        }
        let fastest_path = (0..n)
            .filter(|&b| matches!(self.motion[b], Motion::Prescribed(_)) && !self.is_removed[b])
            .map(|b| self.velocity[b].norm())
            .fold(0.0, f64::max);
        let n_others = self.n_free() + self.n_fixed() + self.n_prescribed();
        for b in (0..n).filter(|&b| self.is_free(b)) {
            if rate[b] + next[b].0 > 0.0 {
                let (k, c): (f64, f64) = (rate[b] + next[b].0, damping[b] + next[b].1);
                let dt = self.settings.time_step_factor * ((c * c + 4.0 * k).sqrt() - c) / k;
                if dt < found.dt {
                    found = CriticalStep {
                        dt,
                        block: Some(b),
                        contact: stiffest[b].1,
                    };
                }
            }
            let travel = if n_others > 1 {
                self.travel_time(b, fastest_path)
            } else {
                f64::INFINITY
            };
            if travel < found.dt {
                found = CriticalStep {
                    dt: travel,
                    block: Some(b),
                    contact: None,
                };
            }
        }
        found
    }

    /// Time in which no point of the block, with the fastest path (m/s) against it, moves farther than
    /// half its margin, gravity included: `v t + g t²/2 = margin/2`; s.
    fn travel_time(&self, b: usize, fastest_path: f64) -> f64 {
        let margin = self
            .parts_of(b)
            .map(|part| self.margin[part])
            .fold(f64::INFINITY, f64::min);
        let v = fastest_path
            + self.velocity[b].norm()
            + self.angular_velocity(b).norm() * self.radius[b]
            + self.kinematics[b]
                .strain_rate
                .map_or(0.0, |rate| rate.norm() * self.radius[b]);
        let g = self.settings.gravity.norm();
        // The positive root, in the form that survives g = 0.
        margin / (v + (v * v + g * margin).sqrt())
    }

    /// Gives every free block the impulse `loads · dt`, `v += dt M⁻¹ load`: the half kicks of a
    /// fluid. Fixed, prescribed and removed blocks ignore theirs; a deformable one takes force and
    /// torque, not strain.
    pub fn apply_impulse(&mut self, loads: &[Load], dt: f64) {
        for (b, load) in loads.iter().enumerate().take(self.n_blocks()) {
            if !self.is_free(b) {
                continue;
            }
            self.kick_centroid(b, &load.force, dt);
            let moment = Moment {
                torque: load.torque,
                stretch: Matrix3::zeros(),
            };
            match self.deformable_of[b] {
                None => self.rigid(b).kick(&moment, dt),
                Some(k) => self.deformables[k as usize].push(&moment, dt),
            }
            self.hold_velocities(b);
            self.set_kinematics(b);
        }
    }

    fn kick_centroid(&mut self, b: usize, force: &Vec3, dt: f64) {
        self.velocity[b] += force * (dt / self.mass[b]);
    }

    fn rigid(&mut self, b: usize) -> Rigid6<'_> {
        Rigid6 {
            attitude: &mut self.attitude[b],
            angular_momentum: &mut self.angular_momentum[b],
            inertia: &self.inertia[b],
        }
    }

    /// Takes away what a hold does not allow; the impulse is the supports'.
    fn hold_velocities(&mut self, b: usize) {
        let Some(hold) = self.holds.get(b).and_then(Option::as_ref) else {
            return;
        };
        let held = hold.held_part(&self.velocity[b]);
        self.velocity[b] -= held;
        self.support_impulse -= held * self.mass[b];
        hold.hold_turning(
            &self.attitude[b],
            &self.inertia[b],
            &mut self.angular_momentum[b],
        );
    }

    /// Moves all blocks from `time` over `dt` (s) in `n_substeps` equal sub-steps, under gravity and
    /// contact forces; prescribed blocks follow their paths exactly.
    ///
    /// # Errors
    ///
    /// [`StepError`] if the step is unusable, a block's state is no longer finite, or two blocks
    /// overlap by more than the limit of the settings.
    pub fn advance(&mut self, time: f64, dt: f64, n_substeps: u32) -> Result<(), StepError> {
        if !(dt > 0.0 && dt.is_finite()) {
            return Err(StepError::TimeStep { dt, time });
        }
        let n_free = self.n_free();
        if n_free == 0 && self.n_prescribed() == 0 {
            return Ok(());
        }
        let n = f64::from(n_substeps.max(1));
        for k in 0..n_substeps.max(1) {
            let from = time + dt * (f64::from(k) / n);
            let to = time + dt * (f64::from(k + 1) / n);
            self.sub_step(from, to, dt / n)?;
        }
        self.collect_contacts();
        Ok(())
    }

    fn sub_step(&mut self, from: f64, to: f64, dt: f64) -> Result<(), StepError> {
        self.half_kick(dt);
        self.drift(from, to, dt);
        self.place_parts(false);
        if self.is_skin_used_up() {
            self.find_candidates();
        }
        self.evaluate_contacts(dt);
        self.evaluate_attachments(false);
        self.book_external_work(dt);
        self.half_kick(dt);
        self.damp(dt);
        for b in 0..self.n_blocks() {
            if let Motion::Prescribed(path) = &self.motion[b] {
                self.velocity[b] = path.velocity(to);
            }
            self.set_kinematics(b);
        }
        self.check(to)
    }

    fn half_kick(&mut self, dt: f64) {
        let gravity = self.settings.gravity;
        let mut impulse = self.attachments.outer_force * (0.5 * dt);
        let mut exchanged = impulse.norm();
        for b in 0..self.n_blocks() {
            let mut load = self.contact_load[b];
            if let Some(attached) = self.attachments.loads.get(b) {
                load += *attached;
            }
            if !self.is_free(b) {
                impulse -= load.force * (0.5 * dt);
                exchanged += load.force.norm() * (0.5 * dt);
                continue;
            }
            let weight = gravity * self.mass[b];
            load.force += weight;
            impulse += weight * (0.5 * dt);
            exchanged += weight.norm() * (0.5 * dt);
            let damper = self.local_damper(b, &load);
            load += damper;
            impulse += damper.force * (0.5 * dt);
            let before = (self.velocity[b], self.angular_velocity(b));
            self.kick(b, &load, 0.5 * dt);
            self.hold_velocities(b);
            let after = (self.velocity[b], self.angular_velocity(b));
            // The kick of a force f does the work f·(v + v')/2 dt, exactly.
            self.static_damping.book(
                -0.25
                    * dt
                    * (damper.force.dot(&(before.0 + after.0))
                        + damper.torque.dot(&(before.1 + after.1))),
            );
        }
        self.support_impulse += impulse;
        self.impulse_exchanged += exchanged;
    }

    fn local_damper(&self, b: usize, load: &Load) -> Load {
        match self.settings.static_damping {
            Some(StaticDamping::Local(alpha)) => Load {
                force: local_damping(alpha, &load.force, &self.velocity[b]),
                torque: local_damping(alpha, &load.torque, &self.angular_velocity(b)),
            },
            _ => Load::default(),
        }
    }

    /// Forces inside and outside act on a free block.
    fn kick(&mut self, b: usize, load: &Load, dt: f64) {
        self.kick_centroid(b, &load.force, dt);
        let torque = load.torque;
        match self.deformable_of[b] {
            None => self.rigid(b).kick(
                &Moment {
                    torque,
                    stretch: Matrix3::zeros(),
                },
                dt,
            ),
            Some(k) => {
                let k = k as usize;
                let mut stretch = self.contact_stretch[k];
                if let Some(attached) = self.attachments.stretch.get(k) {
                    stretch += attached;
                }
                self.deformables[k]
                    .motion()
                    .kick(&Moment { torque, stretch }, dt);
            }
        }
    }

    fn drift(&mut self, from: f64, to: f64, dt: f64) {
        for b in 0..self.n_blocks() {
            if self.is_free(b) {
                self.centroid[b] += self.velocity[b] * dt;
                self.turn(b, dt);
            } else if let Motion::Prescribed(path) = &self.motion[b] {
                let (before, after) = (path.displacement(from), path.displacement(to));
                self.centroid[b] = self.initial_centroid[b] + after;
                // Mean over the sub-step, as the half-step velocity of the free blocks is.
                self.velocity[b] = (after - before) / dt;
            }
        }
    }

    /// Turns and strains a free block.
    fn turn(&mut self, b: usize, dt: f64) {
        if let Some(k) = self.deformable_of[b] {
            let deformable = &mut self.deformables[k as usize];
            deformable.motion().drift(dt);
            self.strain_damping.book(deformable.viscous_loss());
            return;
        }
        let is_held = self
            .holds
            .get(b)
            .and_then(Option::as_ref)
            .is_some_and(|hold| {
                hold.turn(
                    &mut self.attitude[b],
                    &self.inertia[b],
                    &mut self.angular_momentum[b],
                    dt,
                )
            });
        if !is_held {
            self.rigid(b).drift(dt);
        }
    }

    /// Damping that scales velocities, if the settings ask for it.
    fn damp(&mut self, dt: f64) {
        let Some(damping) = self.settings.static_damping else {
            return;
        };
        let factor = damping.velocity_factor(dt);
        if factor == 1.0 {
            return;
        }
        for b in (0..self.n_blocks())
            .filter(|&b| self.is_free(b))
            .collect::<Vec<_>>()
        {
            self.static_damping
                .book((1.0 - factor * factor) * self.kinetic_energy(b));
            self.support_impulse += self.velocity[b] * (self.mass[b] * (factor - 1.0));
            self.velocity[b] *= factor;
            match self.deformable_of[b] {
                None => self.rigid(b).scale_velocities(factor),
                Some(k) => self.deformables[k as usize]
                    .motion()
                    .scale_velocities(factor),
            }
        }
    }

    fn is_skin_used_up(&self) -> bool {
        (0..self.parts.len()).any(|part| {
            self.can_move[part] && !broad_phase::holds(&self.fat_boxes[part], &self.boxes[part])
        })
    }

    /// Contact forces in the present place, and what they lost in the last `dt` (s).
    pub(crate) fn evaluate_contacts(&mut self, dt: f64) {
        let (pairs, medium, boxes) = self.split_pairs();
        let update = |pair: &mut crate::contact::Pair| {
            let is_near =
                broad_phase::overlap(&boxes[pair.parts.0 as usize], &boxes[pair.parts.1 as usize]);
            pair.evaluate(&medium, dt, is_near);
        };
        if pairs.len() < PARALLEL_PAIRS {
            pairs.iter_mut().for_each(update);
        } else {
            pairs.par_iter_mut().with_min_len(8).for_each(update);
        }
        std::mem::swap(&mut self.contact_load, &mut self.contact_load_before);
        self.sum_loads();
        let parts = &self.parts;
        for pair in &self.pairs {
            self.friction.book(pair.friction);
            self.damping.book(pair.damping);
            self.n_broken_bonds += u64::from(pair.has_broken);
            if pair.is_touching() {
                self.n_contact_updates += 1;
                let size = parts[pair.parts.0 as usize]
                    .size()
                    .min(parts[pair.parts.1 as usize].size());
                self.max_overlap_over_size = self.max_overlap_over_size.max(pair.deepest / size);
            }
        }
    }

    /// Sums the pairs' forces in the order of the list, whatever thread found them.
    pub(crate) fn sum_loads(&mut self) {
        self.contact_load
            .iter_mut()
            .for_each(|load| *load = Load::default());
        for pair in self.pairs.iter().filter(|pair| pair.is_touching()) {
            self.contact_load[pair.blocks.0 as usize] += pair.loads.0;
            self.contact_load[pair.blocks.1 as usize] += pair.loads.1;
        }
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
    }

    /// Work of prescribed blocks on free ones over the sub-step, force at its two ends.
    fn book_external_work(&mut self, dt: f64) {
        for b in 0..self.n_blocks() {
            if matches!(self.motion[b], Motion::Prescribed(_)) {
                let force = 0.5 * (self.contact_load[b].force + self.contact_load_before[b].force);
                self.external_work.book(-force.dot(&self.velocity[b]) * dt);
            }
        }
    }

    fn check(&self, time: f64) -> Result<(), StepError> {
        let is_finite = |b: usize| {
            let numbers = [self.centroid[b], self.velocity[b], self.angular_momentum[b]];
            numbers.iter().flatten().all(|c| c.is_finite())
                && self.attitude[b].coords.iter().all(|c| c.is_finite())
        };
        if let Some(block) = (0..self.n_blocks()).find(|&b| !is_finite(b)) {
            return Err(StepError::NotFinite { block, time });
        }
        for (k, block) in self
            .deformable_of
            .iter()
            .enumerate()
            .filter_map(|(b, k)| k.map(|k| (k, b)))
        {
            let strain = self.deformables[k as usize].lowest_strain();
            // NaN counts as crushed.
            if !(strain >= CRUSHED) {
                return Err(StepError::Crushed {
                    block,
                    strain,
                    limit: CRUSHED,
                    time,
                });
            }
        }
        for pair in &self.pairs {
            let parts = [pair.parts.0 as usize, pair.parts.1 as usize];
            let least = |of: &dyn Fn(usize) -> f64| of(parts[0]).min(of(parts[1]));
            let allowed = least(&|part| self.deepest_allowed[part]);
            if pair.deepest > allowed {
                return Err(StepError::Overlap {
                    first: pair.blocks.0 as usize,
                    second: pair.blocks.1 as usize,
                    overlap: pair.deepest,
                    size: least(&|part| self.parts[part].size()),
                    allowed,
                    time,
                });
            }
        }
        Ok(())
    }
}
