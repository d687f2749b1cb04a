//! The largest stable sub-step, and the block that sets it.

use crate::blocks::CHUNK;
use crate::contact::rates::{BlockRates, Listed};
use crate::motion::rigid::is_isotropic;
use crate::step::eigenvalues::HORIZON;
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
}

/// Bound of the step by one block.
#[derive(Clone, Copy)]
struct Bound {
    /// s.
    dt: f64,
    block: usize,
    /// False if the speed of the block sets it.
    is_by_contact: bool,
}

impl Bound {
    const NONE: Self = Self {
        dt: f64::INFINITY,
        block: usize::MAX,
        is_by_contact: false,
    };

    fn of_contacts(dt: f64, block: usize) -> Self {
        Self {
            dt,
            block,
            is_by_contact: true,
        }
    }

    fn of_speed(dt: f64, block: usize) -> Self {
        Self {
            dt,
            block,
            is_by_contact: false,
        }
    }
}

/// Quantities of the whole system that bound the step of a block.
struct Limits {
    /// Of springs and bolts, empty without attachments; 1/s².
    attached: Vec<f64>,
    has_others: bool,
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
    /// With [`StepBound::Eigenvalues`] the sums over the contacts that touch are replaced by the largest eigenvalues. Contact dynamics has
    /// a step of its own, which only motion and attachments shorten.
    pub fn critical_time_step(&self) -> CriticalStep {
        if let Integrator::ContactDynamics(dynamics) = &self.constants.settings.integrator {
            return self.step_of_contact_dynamics(dynamics);
        }
        let limits = Limits {
            attached: self.attached_stiffness(),
            has_others: self.has_others(),
            fastest_path: self.fastest_path(),
        };
        let slowest = |first: usize, rates: &[BlockRates]| self.least_bound(&limits, first, rates);
        let rates = self.state.rates.as_slice();
        let chunk = match self.constants.settings.step_bound {
            StepBound::Compliances => CHUNK,
            StepBound::Eigenvalues => EIGENVALUE_CHUNK,
        };
        let least = chunks::in_pool(rates.len() > 8 * chunk, || {
            chunks::reduce(rates, chunk, &slowest, &|a, b| {
                if b.dt < a.dt { b } else { a }
            })
        });
        CriticalStep {
            dt: least.dt,
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

    /// Least bound of consecutive blocks from `first` on.
    fn least_bound(&self, limits: &Limits, first: usize, rates: &[BlockRates]) -> Bound {
        let mut least = Bound::NONE;
        // a block less stiff and less damped than the one that bounds so far cannot bound more
        let mut worst = (0.0, 0.0);
        for (b, rates) in (first..).zip(rates) {
            if !self.is_free(b) {
                continue;
            }
            let mut k = rates.stiffness + rates.next_stiffness;
            let mut c = rates.damping + rates.next_damping;
            k += limits.attached.get(b).copied().unwrap_or(0.0);
            if let Some(of) = self.constants.deformable_of[b] {
                let (square, xi) = self.state.deformables[of as usize].stiffness_rate();
                k += square;
                c += 2.0 * xi * square.sqrt();
            }
            if (k > worst.0 || c > worst.1) && self.longest_step(k, c) < least.dt {
                (k, c) = self.tightened(b, rates, (k, c));
                let dt = self.longest_step(k, c);
                if dt < least.dt {
                    least = Bound::of_contacts(dt, b);
                    worst = (k, c);
                }
            }
            if let Some(dt) = self.turning_time(b, least.dt) {
                least = Bound::of_speed(dt, b);
                worst = (0.0, 0.0);
            }
            if limits.has_others && self.may_travel_too_far(b, limits.fastest_path, least.dt) {
                let dt = self.travel_time(b, limits.fastest_path);
                if dt < least.dt {
                    least = Bound::of_speed(dt, b);
                    worst = (0.0, 0.0);
                }
            }
        }
        least
    }

    /// `C_b` × the bound by stiffness (1/s²) and damping (1/s); s.
    fn longest_step(&self, k: f64, c: f64) -> f64 {
        self.constants.settings.time_step_factor * ((c * c + 4.0 * k).sqrt() - c) / k
    }

    /// Stiffness (1/s²) and damping (1/s) of a block, with eigenvalues for the sums over its contacts if that is the setting.
    fn tightened(&self, b: usize, sums: &BlockRates, (k, c): (f64, f64)) -> (f64, f64) {
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
        let next = self.next_rates(b, HORIZON * self.longest_step(touching.0, touching.1));
        (
            k.min(touching.0 + next.stiffness),
            c.min(touching.1 + next.damping),
        )
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

    /// Quick and conservative check for a travel within `dt` (s) of more than half the margin of a block.
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
        let margin = self.constants.least_margin[b];
        let v = fastest_path
            + self.state.velocity[b].norm()
            + self.state.kinematics[b].spin.norm() * self.constants.radius[b]
            + self.state.kinematics[b]
                .strain_rate
                .map_or(0.0, |rate| rate.norm() * self.constants.radius[b]);
        let g = self.constants.settings.gravity.norm();
        // the positive root, in the form that is defined at g = 0
        margin / (v + (v * v + g * margin).sqrt())
    }
}
