//! Implicit viscous step: viscosity that does not limit the step.
//!
//! An evaluation ends with the accelerations `a` by all forces at the velocities `v` at hand. Those that the next kicks add are
//! found from a change `w` of velocities over the step `dt`, at the viscosities of this evaluation:
//!
//! ```text
//! (M/dt + K) w = M a                a ← a − M⁻¹ K w
//! (K w)_a = −2 V_a Σ_b V_b η_ab (x_ab·∇W)/(r² + 0.01 h²) (w_a − w_b) + R_a w_a                              [N]
//! ```
//! Then `a dt = w`: within the fluid this is backward Euler, `M (v + w − v)/dt = F − K (v + w)` with `F` all other forces. A wave that
//! viscosity damps at a rate `λ` is multiplied by `1/(1 + λ dt)`, however long the step; a steady flow is that of explicit
//! steps. `K` is the pair form of Morris with the harmonic mean of viscosities, symmetric and positive semi-definite: the
//! force of a pair is equal and opposite whatever `w`, so that momentum is that of explicit steps, to round-off. Kicks book its work as that of any
//! other force, with the mean of velocities before and after, and the accounts close.
//!
//! A wall that does not slip is seen by explicit forces with the velocity of the fluid continued into it, which depends on neighbors and would make
//! `K` unsymmetrical. The change is resisted as if each particle saw its own mirrored there, with walls that keep their
//! velocity: `R_a = 2 Σ_w` of the pair's factor. Both have the same force on an even shear. The force of `w` on the walls is the opposite of
//! theirs on the fluid, point by point.
//!
//! Kicks of kick-drift-kick use an acceleration in half of the step before and half of the next one. With a next step of `dt'` the factor is
//! `(1 + λ (dt − dt')/2)/(1 + λ dt)`, within −0.03 and 1 for steps that grow by 5 %. The first evaluation of a run takes the limit of
//! sound for `dt`.
//!
//! Viscosities are those of the rate of shear before the step. Where stress is given, the rate of shear of a law of exponent `n` then goes to its
//! own by a factor of `1 − n` a step, of a yield stress by `τ_y/τ`: without oscillation for fluids that thin.
//!
//! Conjugate gradients from `w = 0`, preconditioned with the diagonal. The products are sums over neighbors with their lists, in the precision of
//! the scheme, and the dot products sums over chunks in a fixed order. They end with
//!
//! ```text
//! |dt M⁻¹ (M a − (M/dt + K) w)| ≤ 10⁻⁵ |v + w|        root mean squares, weighted with mass
//! ```
//! The left side is the very difference between the velocities after the kicks and those of backward Euler: 10⁻⁵ is that of
//! the rounding of single-precision sums where viscosity would need steps a hundred times shorter.
//!
//! Sources: Hestenes & Stiefel (1952); Weiler, Koschier, Brand & Bender (2018) for conjugate gradients over particles.

use rayon::prelude::*;

use crate::fluid::sums;
use crate::fluid::viscous_unknowns::ViscousUnknowns;
use crate::neighbors::sweep::AnyPoints;
use crate::{CHUNK, Fluid, FluidError, Particles};

/// Most products of a step: those of viscosity that would need steps ten thousand times shorter, three times over.
const MOST_PRODUCTS: u32 = 2000;

impl Fluid {
    /// Products of the last implicit viscous step.
    pub fn n_products(&self) -> u32 {
        self.n_products
    }

    /// Prepares an implicit viscous step, after all forces; resistances of walls and particles held are added next.
    pub(crate) fn begin_viscous_step(&mut self) {
        let mut unknowns = std::mem::take(&mut self.scratch.viscous_step);
        let n = self.particles.len();
        unknowns.sums.resize(n, [0.0; 3]);
        unknowns.resistance.clear();
        unknowns.resistance.resize(n, 0.0);
        unknowns.is_held.clear();
        unknowns.is_held.resize(n, false);
        sums::drag_of_unit(self, &mut unknowns.sums);
        self.scratch.viscous_step = unknowns;
    }

    /// Resists the change of velocity of some particles in the implicit viscous step to come; kg/(m³ s), >= 0.
    pub fn resist(&mut self, resistances: impl Iterator<Item = (u32, f64)>) {
        for (a, resistance) in resistances {
            self.scratch.viscous_step.resistance[a as usize] += resistance;
        }
    }

    /// Keeps the velocities of some particles in the implicit viscous step to come.
    pub fn hold_in_viscous_step(&mut self, particles: impl Iterator<Item = u32>) {
        for a in particles {
            self.scratch.viscous_step.is_held[a as usize] = true;
        }
    }

    /// Finds the change of velocities over `dt` (s), 0 before the first step, and adds its viscous force to the accelerations.
    ///
    /// # Errors
    ///
    /// [`FluidError::ViscousStep`] where it does not converge.
    pub(crate) fn solve_viscous_step(&mut self, dt: f64) -> Result<(), FluidError> {
        let dt = if 0.0 < dt {
            dt
        } else {
            self.step_limits().sound
        };
        let mut unknowns = std::mem::take(&mut self.scratch.viscous_step);
        let mut dots = unknowns.begin(&self.particles, dt);
        let mut products = 0;
        while !dots.are_converged() {
            if MOST_PRODUCTS <= products || !dots.residual.is_finite() {
                return Err(FluidError::ViscousStep {
                    products,
                    relative: dots.relative_error(),
                });
            }
            products += 1;
            let before = dots.residual;
            let ViscousUnknowns {
                direction,
                points,
                sums,
                ..
            } = &mut unknowns;
            sums::drag(self, direction, (points, sums));
            let curvature = unknowns.curvature(&self.particles, dt);
            dots = unknowns.descend(&self.particles, dt, before / curvature);
            unknowns.turn(dots.residual / before);
        }
        self.n_products = products;
        self.add_viscous_change(&unknowns);
        unknowns.pack_change(self);
        unknowns.is_solved = true;
        self.scratch.viscous_step = unknowns;
        Ok(())
    }

    /// Adds `−K w` to the accelerations, and its part across planes of symmetry to their force.
    fn add_viscous_change(&mut self, unknowns: &ViscousUnknowns) {
        let Particles {
            acceleration,
            viscous_acceleration,
            mass,
            ..
        } = &mut self.particles;
        let columns = (
            acceleration.par_chunks_mut(CHUNK),
            viscous_acceleration.par_chunks_mut(CHUNK),
            mass.par_chunks(CHUNK),
            unknowns.force.par_chunks(CHUNK),
        );
        columns
            .into_par_iter()
            .for_each(|(accelerations, viscous, masses, forces)| {
                for (((a, viscous), m), force) in accelerations
                    .iter_mut()
                    .zip(viscous)
                    .zip(masses)
                    .zip(forces)
                {
                    let change = force / *m;
                    *a += change;
                    for (sum, change) in viscous.iter_mut().zip(&change) {
                        *sum += *change as f32;
                    }
                }
            });
        self.add_to_plane_force(|particles, a| {
            let volume = particles.mass[a] / particles.density[a];
            unknowns.force[a] + unknowns.change[a] * (unknowns.resistance[a] * volume)
        });
    }

    /// Whether an implicit viscous step has been solved in the present evaluation.
    pub(crate) fn has_viscous_change(&self) -> bool {
        self.scratch.viscous_step.is_solved
    }

    /// Forgets the implicit viscous step of the evaluation before.
    pub(crate) fn forget_viscous_change(&mut self) {
        self.scratch.viscous_step.is_solved = false;
    }

    /// Change of velocities in the implicit viscous step just solved, packed with the volumes.
    pub(crate) fn packed_viscous_change(&self) -> &AnyPoints {
        &self.scratch.viscous_step.points
    }
}
