//! The largest stable sub-step, and who sets it.

use crate::blocks::CHUNK;
use crate::contact::rates::{BlockRates, Listed};
use crate::motion::rigid::is_isotropic;
use crate::{Blocks, Motion, chunks};

/// Turn of a step of a block whose moments of inertia differ: the energy of a free box of sides 1 : 0.6 : 0.3 then swings
/// by 4e-4, and by 1e-2 at 1 rad; at 2 rad it is lost track of; rad.
const LARGEST_TURN: f64 = 0.2;

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
    /// among others may also not travel more than half the margin of its candidate search, and one whose moments of
    /// inertia differ not turn by more than 0.2 rad.
    pub fn critical_time_step(&self) -> CriticalStep {
        let n = self.n_blocks();
        let has_others = self.has_others();
        let fastest_path = (0..if has_others { n } else { 0 })
            .filter(|&b| {
                matches!(self.constants.motion[b], Motion::Prescribed(_))
                    && !self.state.is_removed[b]
            })
            .map(|b| {
                self.state.velocity[b].norm() + self.angular_velocity(b).norm() * self.radius(b)
            })
            .fold(0.0, f64::max);
        let mut attached = Vec::new();
        if !self.state.attachments.is_empty() {
            attached.resize(n, 0.0);
            self.state.attachments.add_stiffness_rates(
                &self.state.kinematics,
                |b| self.is_free(b),
                &mut attached,
            );
        }
        let slowest = |first: usize, rates: &[BlockRates]| {
            let mut found: (f64, usize, bool) = (f64::INFINITY, usize::MAX, false);
            // A block less stiff and less damped than the worst so far has nothing to say.
            let mut worst = (0.0, 0.0);
            for (b, rates) in (first..).zip(rates) {
                if !self.is_free(b) {
                    continue;
                }
                let mut k = rates.stiffness + rates.next_stiffness;
                let mut c = rates.damping + rates.next_damping;
                k += attached.get(b).copied().unwrap_or(0.0);
                if let Some(of) = self.constants.deformable_of[b] {
                    let (square, xi) = self.state.deformables[of as usize].stiffness_rate();
                    k += square;
                    c += 2.0 * xi * square.sqrt();
                }
                if k > worst.0 || c > worst.1 {
                    let bound = self.constants.settings.time_step_factor
                        * ((c * c + 4.0 * k).sqrt() - c)
                        / k;
                    if bound < found.0 {
                        found = (bound, b, true);
                        worst = (k, c);
                    }
                }
                if let Some(turning) = self.turning_time(b, found.0) {
                    found = (turning, b, false);
                    worst = (0.0, 0.0);
                }
                if has_others && self.may_travel_too_far(b, fastest_path, found.0) {
                    let travel = self.travel_time(b, fastest_path);
                    if travel < found.0 {
                        found = (travel, b, false);
                        worst = (0.0, 0.0);
                    }
                }
            }
            found
        };
        let rates = self.state.rates.as_slice();
        let (dt, block, is_contact) = chunks::in_pool(rates.len() > 8 * CHUNK, || {
            chunks::reduce(rates, CHUNK, &slowest, &|a, b| {
                if b.0 < a.0 { b } else { a }
            })
        });
        CriticalStep {
            dt,
            block: (dt < f64::INFINITY).then_some(block),
            contact: self
                .state
                .rates
                .get(block)
                .filter(|_| is_contact)
                .and_then(|rates| rates.contact)
                .map(|(list, k)| {
                    let k = k as usize;
                    let (i, j) = match list {
                        Listed::Pair => self.contacts.pairs[k].blocks,
                        Listed::Sphere => self.contacts.sphere_pairs[k].blocks,
                        Listed::Surface => self.contacts.surface_pairs[k].blocks,
                    };
                    (i as usize, j as usize)
                }),
        }
    }

    /// Cheap and on the safe side: may the block travel farther in `dt` (s) than half its margin?
    fn may_travel_too_far(&self, b: usize, fastest_path: f64, dt: f64) -> bool {
        let body = &self.state.kinematics[b];
        let radius = self.constants.radius[b];
        let mut square = fastest_path * fastest_path
            + body.velocity.norm_squared()
            + body.spin.norm_squared() * (radius * radius);
        if let Some(rate) = &body.strain_rate {
            square += rate.norm_squared() * (radius * radius);
        }
        let way = 0.5
            * (self.constants.least_margin[b] - self.constants.settings.gravity.norm() * dt * dt);
        // (a + b + c + d)² ≤ 4 (a² + b² + c² + d²). The step is infinite while nothing bounds it.
        !(way > 0.0 && 4.0 * square * dt * dt <= way * way)
    }

    /// Time in which a rigid block turns by [`LARGEST_TURN`], where that is less than `dt` (s) and it matters: the
    /// rotations of a step are exact one by one, but not their order about axes of different moments.
    ///
    /// ```text
    /// rate 2 T/|L| = ω·L/|L|                                                                [1/s]
    /// ```
    /// which a free body keeps. `|ω|` swings as it tumbles, and a step in time with that would pump it.
    fn turning_time(&self, b: usize, dt: f64) -> Option<f64> {
        let square = self.state.kinematics[b].spin.norm_squared();
        // The step is infinite while nothing bounds it.
        if !(square > 0.0 && square * dt * dt > LARGEST_TURN * LARGEST_TURN) {
            return None;
        }
        let (momentum, inertia) = (&self.state.angular_momentum[b], &self.constants.inertia[b]);
        if is_isotropic(inertia) || self.constants.deformable_of[b].is_some() {
            return None;
        }
        let rate = momentum.dot(&momentum.component_div(inertia)) / momentum.norm();
        Some(LARGEST_TURN / rate).filter(|&turning| turning < dt)
    }

    /// Is there more than one block?
    fn has_others(&self) -> bool {
        self.state
            .is_removed
            .iter()
            .filter(|&&gone| !gone)
            .nth(1)
            .is_some()
    }

    /// Time in which no point of the block, with the fastest path (m/s) against it, moves farther than
    /// half its margin, gravity included: `v t + g t²/2 = margin/2`; s.
    fn travel_time(&self, b: usize, fastest_path: f64) -> f64 {
        let margin = self.constants.least_margin[b];
        let v = fastest_path
            + self.state.velocity[b].norm()
            + self.state.kinematics[b].spin.norm() * self.constants.radius[b]
            + self.state.kinematics[b]
                .strain_rate
                .map_or(0.0, |rate| rate.norm() * self.constants.radius[b]);
        let g = self.constants.settings.gravity.norm();
        // The positive root, in the form that survives g = 0.
        margin / (v + (v * v + g * margin).sqrt())
    }
}
