//! The largest stable sub-step, and the block that sets it.

use crate::blocks::CHUNK;
use crate::contact::rates::{BlockRates, Bound, KeptBound, Listed, Rates};
use crate::motion::kinematics::Kinematics;
use crate::motion::rigid::is_isotropic;
use crate::{Blocks, Integrator, Motion, StepBound, chunks};

/// Largest rotation in a step of a block whose moments of inertia differ: the energy of a free box of sides 1 : 0.6 : 0.3 then
/// oscillates by 4e-4, and by 1e-2 at 1 rad; at 2 rad it is lost; rad.
const LARGEST_TURN: f64 = 0.2;

/// Blocks of a chunk where eigenvalues are sought.
const EIGENVALUE_CHUNK: usize = 32;

/// The largest stable sub-step and the block that sets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CriticalStep {
    /// `C_b` × the bound; infinite when nothing limits; s.
    pub dt: f64,
    /// The block that sets it.
    pub block: Option<usize>,
    /// Its stiffest pair of blocks; none when the block's speed sets the step.
    pub contact: Option<(usize, usize)>,
    /// Does the way or the turn of the block in a step set it, and not its stiffness?
    pub is_by_speed: bool,
}

/// Steps for which a bound by the eigenvalues of contacts is kept where all contacts are those of spheres: to find it takes as long as the rest
/// of their step, and it changes by little. Beside contacts of polyhedra, whose points come and go, it is found anew in every step.
const KEPT_STEPS: u32 = 4;

/// Steps of a block that nothing touches, × that with the contacts that it may have next.
const FLIGHTS: [f64; 2] = [16.0, 4.0];

/// Stable steps of a sphere over those with which something meets it that nothing else touches: an impact of two then takes four steps. With two,
/// as many as are stable, a gas of spheres that bounce without loss made 4 % of its energy in sixty hits each, with four less than 1 %.
const STEPS_OF_IMPACT: f64 = 2.0;

/// What a block may run into.
struct Others {
    /// Is there any?
    are_there: bool,
    /// m/s.
    fastest_path: f64,
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
    ///
    /// With [`StepBound::Eigenvalues`] the sums over the contacts that touch are replaced by the largest eigenvalues, of spheres
    /// every four steps, with the pairs that may touch until then. Contact dynamics has a step of its own, which only motion and attachments
    /// shorten.
    pub fn critical_time_step(&self) -> CriticalStep {
        if let Integrator::ContactDynamics(dynamics) = &self.constants.settings.integrator {
            return self.step_of_contact_dynamics(dynamics);
        }
        let by_contacts = match self.state.bound.bound {
            Some(kept) => kept,
            None => self.bound_by_contacts(),
        };
        let others = Others {
            are_there: self.has_others(),
            fastest_path: self.fastest_path(),
        };
        let slowest = |first: usize, kinematics: &[Kinematics]| {
            let blocks = first..first + kinematics.len();
            self.least_by_motion(&others, blocks, by_contacts)
        };
        let least = least_of(self.state.kinematics.as_slice(), CHUNK, &slowest);
        CriticalStep {
            dt: least.dt,
            is_by_speed: least.dt < f64::INFINITY && !least.is_by_contact,
            block: (least.dt < f64::INFINITY).then_some(least.block),
            contact: self
                .state
                .rates
                .get(least.block)
                .filter(|_| least.is_by_contact)
                .and_then(|rates| rates.contact)
                .map(|contact| self.blocks_in_contact(contact)),
        }
    }

    /// Finds the bound by eigenvalues anew after a step, if it is old.
    pub(super) fn renew_bound(&mut self) {
        if self.constants.settings.step_bound == StepBound::Compliances {
            return;
        }
        self.state.bound = match self.state.bound {
            KeptBound {
                bound: Some(bound),
                age,
            } if age + 1 < self.kept_steps() => KeptBound {
                bound: Some(bound),
                age: age + 1,
            },
            _ => KeptBound {
                bound: Some(self.bound_by_contacts()),
                age: 0,
            },
        };
    }

    /// Steps for which a bound is kept.
    fn kept_steps(&self) -> u32 {
        match self.contacts.pairs.is_empty() {
            true => KEPT_STEPS,
            false => 1,
        }
    }

    /// Steps within which a pair that is apart counts as about to touch: until the next bound, and a step more.
    fn horizon(&self) -> f64 {
        f64::from(self.kept_steps() + 1)
    }

    /// Bound by contacts, attachments and strains.
    fn bound_by_contacts(&self) -> Bound {
        let attached = self.attached_stiffness();
        let chunk = match self.constants.settings.step_bound {
            StepBound::Compliances => CHUNK,
            StepBound::Eigenvalues => EIGENVALUE_CHUNK,
        };
        let slowest =
            |first: usize, rates: &[BlockRates]| self.least_by_contacts(&attached, first, rates);
        least_of(self.state.rates.as_slice(), chunk, &slowest)
    }

    /// Least bound of consecutive blocks from `first` on, by their contacts, strains, and springs and bolts attached to them, of which there
    /// may be none (1/s²).
    fn least_by_contacts(&self, attached: &[f64], first: usize, rates: &[BlockRates]) -> Bound {
        let mut least = Bound::NONE;
        // a block less stiff and less damped than the one that bounds so far cannot bound more
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
            if (k > worst.0 || c > worst.1) && self.longest_step(k, c) < least.dt {
                (k, c) = self.tightened(b, rates, (k, c), least.dt);
                let dt = self.longest_step(k, c);
                if dt < least.dt {
                    least = Bound::of_contacts(dt, b);
                    worst = (k, c);
                }
            }
        }
        least
    }

    /// Least of a bound and those of blocks by their motion.
    fn least_by_motion(
        &self,
        others: &Others,
        blocks: std::ops::Range<usize>,
        mut least: Bound,
    ) -> Bound {
        for b in blocks.filter(|&b| self.is_free(b)) {
            if let Some(dt) = self.turning_time(b, least.dt) {
                least = Bound::of_speed(dt, b);
            }
            if others.are_there && self.may_travel_too_far(b, others.fastest_path, least.dt) {
                let dt = self.travel_time(b, others.fastest_path);
                if dt < least.dt {
                    least = Bound::of_speed(dt, b);
                }
            }
        }
        least
    }

    /// `C_b` × the bound by stiffness (1/s²) and damping (1/s); s.
    fn longest_step(&self, k: f64, c: f64) -> f64 {
        self.constants.settings.time_step_factor * ((c * c + 4.0 * k).sqrt() - c) / k
    }

    /// Stiffness (1/s²) and damping (1/s) of a block, with eigenvalues for the sums over its contacts if that is the setting. Where they
    /// allow more than a step (s) in any case, those that may touch next all count, near or not.
    fn tightened(&self, b: usize, sums: &BlockRates, (k, c): (f64, f64), dt: f64) -> (f64, f64) {
        let largest = match self.constants.settings.step_bound {
            StepBound::Compliances => None,
            StepBound::Eigenvalues => self.largest_rates(b),
        };
        let Some(largest) = largest else {
            return (k, c);
        };
        // springs, bolts and strain stay
        let others = (
            k - (sums.stiffness + sums.next_stiffness),
            c - (sums.damping + sums.next_damping),
        );
        let touching = (others.0 + largest.stiffness, others.1 + largest.damping);
        let at_most = (
            k.min(touching.0 + sums.next_stiffness),
            c.min(touching.1 + sums.next_damping),
        );
        if dt <= self.longest_step(at_most.0, at_most.1) {
            return at_most;
        }
        if touching.0 <= 0.0 {
            return self.of_free_flight(b, at_most);
        }
        let next = self.next_rates(
            b,
            self.horizon() * self.longest_step(touching.0, touching.1),
        );
        (
            k.min(touching.0 + next.stiffness),
            c.min(touching.1 + next.damping),
        )
    }

    /// Stiffness (1/s²) and damping (1/s) of a block that nothing touches, from those that something may give it next: they are as many
    /// times less as steps may be longer before that is in reach, and of a sphere more once it is.
    fn of_free_flight(&self, b: usize, (k, c): (f64, f64)) -> (f64, f64) {
        let step = self.longest_step(k, c);
        let is_free_for =
            |&longer: &f64| self.next_rates(b, self.horizon() * longer * step) == Rates::default();
        let longer = match FLIGHTS.into_iter().find(is_free_for) {
            Some(longer) => longer,
            None if self.only_sphere(b).is_some() => 1.0 / STEPS_OF_IMPACT,
            None => 1.0,
        };
        (k / (longer * longer), c / longer)
    }

    /// Largest speed of a point of a prescribed block, zero if there is only one block; m/s.
    pub(super) fn fastest_path(&self) -> f64 {
        let n = if self.has_others() {
            self.n_blocks()
        } else {
            0
        };
        (0..n)
            .filter(|&b| {
                matches!(self.constants.motion[b], Motion::Prescribed(_))
                    && !self.state.is_removed[b]
            })
            .map(|b| {
                self.state.velocity[b].norm() + self.angular_velocity(b).norm() * self.radius(b)
            })
            .fold(0.0, f64::max)
    }

    /// Stiffness of supports and bolts over the mass of each block, empty without attachments; 1/s².
    pub(super) fn attached_stiffness(&self) -> Vec<f64> {
        let mut rates = Vec::new();
        if !self.state.attachments.is_empty() {
            rates.resize(self.n_blocks(), 0.0);
            self.state.attachments.add_stiffness_rates(
                &self.state.kinematics,
                |b| self.is_free(b),
                &mut rates,
            );
        }
        rates
    }

    fn blocks_in_contact(&self, (list, k): (Listed, u32)) -> (usize, usize) {
        let k = k as usize;
        let (i, j) = match list {
            Listed::Pair => self.contacts.pairs[k].blocks,
            Listed::Sphere => self.contacts.sphere_pairs[k].blocks,
            Listed::Surface => self.contacts.surface_pairs[k].blocks,
        };
        (i as usize, j as usize)
    }

    /// Twice the longest way of a block in a step: the least margin of its fat boxes, or that of a fast sphere; m.
    fn margin_of_step(&self, b: usize) -> f64 {
        let lead = self.only_sphere(b).map_or(0.0, |part| self.lead_of(part));
        self.constants.least_margin[b].max(2.0 * lead)
    }

    /// Speed of the points of a block as it turns: those of a sphere stay within it; m/s.
    fn turning_speed(&self, b: usize) -> f64 {
        match self.only_sphere(b) {
            Some(_) => 0.0,
            None => self.state.kinematics[b].spin.norm() * self.constants.radius[b],
        }
    }

    /// Quick and conservative check for a travel within `dt` (s) of more than half the margin of a block.
    fn may_travel_too_far(&self, b: usize, fastest_path: f64, dt: f64) -> bool {
        let body = &self.state.kinematics[b];
        let radius = self.constants.radius[b];
        let mut square = fastest_path * fastest_path
            + body.velocity.norm_squared()
            + self.turning_speed(b).powi(2);
        if let Some(rate) = &body.strain_rate {
            square += rate.norm_squared() * (radius * radius);
        }
        let way = 0.5 * (self.margin_of_step(b) - self.constants.settings.gravity.norm() * dt * dt);
        // (a + b + c + d)² ≤ 4 (a² + b² + c² + d²). The step is infinite while nothing bounds it.
        !(way > 0.0 && 4.0 * square * dt * dt <= way * way)
    }

    /// Time in which a rigid block rotates by [`LARGEST_TURN`], if less than `dt` (s) and its moments of inertia differ: the
    /// rotations of a step are exact one by one, but not their sequence about axes of different moments.
    ///
    /// ```text
    /// rate 2 T/|L| = ω·L/|L|                                                                [1/s]
    /// ```
    /// which is constant for a free body. `|ω|` oscillates as it tumbles, and a step in resonance with that would add energy.
    fn turning_time(&self, b: usize, dt: f64) -> Option<f64> {
        let square = self.state.kinematics[b].spin.norm_squared();
        // the step is infinite while nothing bounds it
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

    /// True if more than one block is left.
    fn has_others(&self) -> bool {
        self.state
            .is_removed
            .iter()
            .filter(|&&gone| !gone)
            .nth(1)
            .is_some()
    }

    /// Time in which no point of the block, with the fastest path (m/s) against it, moves by more than half its margin, gravity
    /// included: `v t + g t²/2 = margin/2`; s.
    fn travel_time(&self, b: usize, fastest_path: f64) -> f64 {
        let margin = self.margin_of_step(b);
        let v = fastest_path
            + self.state.velocity[b].norm()
            + self.turning_speed(b)
            + self.state.kinematics[b]
                .strain_rate
                .map_or(0.0, |rate| rate.norm() * self.constants.radius[b]);
        let g = self.constants.settings.gravity.norm();
        // the positive root, in the form that is defined at g = 0
        margin / (v + (v * v + g * margin).sqrt())
    }
}

/// Least of the bounds of chunks of a column.
fn least_of<T: Sync>(
    column: &[T],
    chunk: usize,
    of: &(impl Fn(usize, &[T]) -> Bound + Sync),
) -> Bound {
    chunks::in_pool(column.len() > 8 * chunk, || {
        chunks::reduce(column, chunk, of, &|a, b| if b.dt < a.dt { b } else { a })
    })
}
