//! Time stepping: kick, drift, kick, with exact rotations; and the largest stable step.
//!
//! ```text
//! v += dt/2 M⁻¹f;   x += dt v,  Q := Q R;   contacts, f;   v += dt/2 M⁻¹f
//! ```

use crate::{Blocks, Load, Motion, StepError, Vec3, broad_phase};
use nalgebra::UnitQuaternion;
use rayon::prelude::*;

/// Fewer pairs than this are not worth waking threads for.
const PARALLEL_PAIRS: usize = 64;

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
    /// ω_i² ≤ s Σ ( k_n w_n + k_t (w_t1 + w_t2) )      s = 2 if the partner is free, else 1
    /// dt   = C_b min_i (2/ω_i)(√(1 + ξ²) − ξ)                                                  [s]
    /// ```
    /// ξ is the largest damping ratio at the block. A candidate pair that does not touch yet counts
    /// with its worst contact point, so that no impact starts with an unbounded step. A free block
    /// among others may also not travel more than half the margin of its candidate search.
    pub fn critical_time_step(&self) -> CriticalStep {
        let mut found = CriticalStep {
            dt: f64::INFINITY,
            block: None,
            contact: None,
        };
        let medium = self.medium();
        let n = self.n_blocks();
        let mut rate = vec![0.0; n];
        let mut ratio = vec![self.settings.shear_damping_ratio; n];
        let mut stiffest = vec![(0.0, None); n];
        for pair in &self.pairs {
            let (i, j) = (pair.blocks.0 as usize, pair.blocks.1 as usize);
            let rates = pair.stiffness_rate(&medium, (self.radius[i], self.radius[j]));
            for (block, partner, share) in [(i, j, rates.0), (j, i, rates.1)] {
                let share = if self.is_free(partner) {
                    2.0 * share
                } else {
                    share
                };
                rate[block] += share;
                ratio[block] = f64::max(ratio[block], medium.joint(pair).damping_ratio);
                if share > stiffest[block].0 {
                    stiffest[block] = (share, Some((i, j)));
                }
            }
        }
        let fastest_path = (0..n)
            .filter(|&b| matches!(self.motion[b], Motion::Prescribed(_)) && !self.is_removed[b])
            .map(|b| self.velocity[b].norm())
            .fold(0.0, f64::max);
        let n_others = self.n_free() + self.n_fixed() + self.n_prescribed();
        for b in (0..n).filter(|&b| self.is_free(b)) {
            if rate[b] > 0.0 {
                let xi: f64 = ratio[b];
                let dt = self.settings.time_step_factor * 2.0 / rate[b].sqrt()
                    * ((1.0 + xi * xi).sqrt() - xi);
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
            + self.angular_velocity(b).norm() * self.radius[b];
        let g = self.settings.gravity.norm();
        // The positive root, in the form that survives g = 0.
        margin / (v + (v * v + g * margin).sqrt())
    }

    /// Gives every free block the impulse `loads · dt`, `v += dt M⁻¹ load`: the half kicks of a
    /// fluid. Fixed, prescribed and removed blocks ignore theirs.
    pub fn apply_impulse(&mut self, loads: &[Load], dt: f64) {
        for (b, load) in loads.iter().enumerate().take(self.n_blocks()) {
            if self.is_free(b) {
                self.kick(b, load, dt);
                self.set_kinematics(b);
            }
        }
    }

    fn kick(&mut self, b: usize, load: &Load, dt: f64) {
        self.velocity[b] += load.force * (dt / self.mass[b]);
        self.angular_momentum[b] += self.attitude[b].inverse_transform_vector(&load.torque) * dt;
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
        self.book_external_work(dt);
        self.half_kick(dt);
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
        let mut impulse = Vec3::zeros();
        for b in 0..self.n_blocks() {
            let mut load = self.contact_load[b];
            if self.is_free(b) {
                load.force += gravity * self.mass[b];
                self.kick(b, &load, 0.5 * dt);
                impulse += gravity * (self.mass[b] * 0.5 * dt);
            } else {
                impulse -= load.force * (0.5 * dt);
            }
        }
        self.support_impulse += impulse;
    }

    fn drift(&mut self, from: f64, to: f64, dt: f64) {
        for b in 0..self.n_blocks() {
            if self.is_free(b) {
                self.centroid[b] += self.velocity[b] * dt;
                rotate(
                    &mut self.attitude[b],
                    &mut self.angular_momentum[b],
                    &self.inertia[b],
                    dt,
                );
            } else if let Motion::Prescribed(path) = &self.motion[b] {
                let (before, after) = (path.displacement(from), path.displacement(to));
                self.centroid[b] = self.initial_centroid[b] + after;
                // Mean over the sub-step, as the half-step velocity of the free blocks is.
                self.velocity[b] = (after - before) / dt;
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
        let limit = self.settings.overlap_limit;
        for pair in &self.pairs {
            let size = self.parts[pair.parts.0 as usize]
                .size()
                .min(self.parts[pair.parts.1 as usize].size());
            if pair.deepest > limit * size {
                return Err(StepError::Overlap {
                    first: pair.blocks.0 as usize,
                    second: pair.blocks.1 as usize,
                    overlap: pair.deepest,
                    size,
                    limit,
                    time,
                });
            }
        }
        Ok(())
    }
}

/// Free rotation over `dt` (s), as five rotations about the principal axes 1, 2, 3, 2, 1.
///
/// ```text
/// angle θ = dt' p_k/J_k;   p := R_kᵀ(θ) p,   Q := Q R_k(θ);   dt' = dt/2, dt/2, dt, dt/2, dt/2
/// ```
/// Time-reversible; keeps the spatial angular momentum to round-off, the energy error bounded and
/// second order. Source: Dullweber, Leimkuhler & McLachlan (1997).
pub(crate) fn rotate(attitude: &mut UnitQuaternion<f64>, p: &mut Vec3, inertia: &Vec3, dt: f64) {
    for (axis, share) in [(0, 0.5), (1, 0.5), (2, 1.0), (1, 0.5), (0, 0.5)] {
        let angle = share * dt * p[axis] / inertia[axis];
        let mut scaled = Vec3::zeros();
        scaled[axis] = angle;
        let turn = UnitQuaternion::from_scaled_axis(scaled);
        *p = turn.inverse_transform_vector(p);
        *attitude *= turn;
    }
    attitude.renormalize();
}

#[cfg(test)]
mod tests {
    use super::*;

    /// D09: a body spun about its middle axis tumbles.
    fn tumble(dt: f64) -> (u32, f64, f64) {
        let inertia = Vec3::new(1.0, 2.0, 3.0);
        let mut p = Vec3::new(0.01, 1.0, 0.01).component_mul(&inertia);
        let mut attitude = UnitQuaternion::identity();
        let energy = |p: &Vec3| 0.5 * p.dot(&p.component_div(&inertia));
        let (start, start_energy) = (p, energy(&p));
        let (mut flips, mut worst) = (0, 0.0_f64);
        for _ in 0..(2000.0 / dt).round() as u32 {
            let before = p.y;
            rotate(&mut attitude, &mut p, &inertia, dt);
            flips += u32::from(before * p.y < 0.0);
            worst = worst.max((energy(&p) / start_energy - 1.0).abs());
        }
        let drift = (attitude * p - start).norm() / start.norm();
        (flips, worst, drift)
    }

    #[test]
    fn tumbling_keeps_momentum_and_energy() {
        let coarse = tumble(0.05);
        let fine = tumble(0.025);
        // 102 flips, errors 1.7e-5 and 4.3e-6: values of an independent program.
        assert_eq!((coarse.0, fine.0), (102, 102));
        assert!((coarse.1 / 1.7e-5 - 1.0).abs() < 0.05, "{:e}", coarse.1);
        assert!((fine.1 / 4.3e-6 - 1.0).abs() < 0.05, "{:e}", fine.1);
        assert!(
            coarse.2 < 1e-12 && fine.2 < 1e-12,
            "{:e} {:e}",
            coarse.2,
            fine.2
        ); // measured 3e-14
    }
}
