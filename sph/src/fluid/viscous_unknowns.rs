//! Unknowns of an implicit viscous step, and the passes of conjugate gradients over them; see `viscous_step`.

use rayon::prelude::*;

use crate::neighbors::sweep::AnyPoints;
use crate::{CHUNK, Fluid, Particles, Vec3};

/// Residual of the velocities over their root mean square.
const TOLERANCE: f64 = 1e-5;

/// Unknowns of implicit viscous steps, one slot per particle; written before they are read in every step.
#[derive(Clone, Debug, Default)]
pub(crate) struct ViscousUnknowns {
    /// `w`; m/s.
    pub(super) change: Vec<Vec3>,
    /// `M a − (M/dt + K) w`; N.
    residual: Vec<Vec3>,
    /// m/s.
    pub(super) direction: Vec<Vec3>,
    /// Forces of a direction within the fluid, per volume; N/m³.
    pub(super) sums: Vec<[f64; 3]>,
    /// `−K w`; N.
    pub(super) force: Vec<Vec3>,
    /// Of `M/dt + K`; kg/s.
    diagonal: Vec<f64>,
    /// `R_a/V_a`; kg/(m³ s).
    pub(super) resistance: Vec<f64>,
    /// Particles whose velocities are imposed.
    pub(super) is_held: Vec<bool>,
    /// `w` with the volumes, packed for sums.
    pub(super) points: AnyPoints,
    /// Whether it is that of the present evaluation.
    pub(super) is_solved: bool,
    partial: Vec<Dots>,
}

/// Dot products of a pass.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Dots {
    /// Residual times preconditioned residual; W.
    pub(super) residual: f64,
    /// Square of `dt M⁻¹ r`, times mass; kg m²/s².
    error: f64,
    /// Square of `v + w`, times mass; kg m²/s².
    velocity: f64,
}

impl Dots {
    fn total(partial: &[Self]) -> Self {
        partial.iter().fold(Self::default(), |sum, one| Self {
            residual: sum.residual + one.residual,
            error: sum.error + one.error,
            velocity: sum.velocity + one.velocity,
        })
    }

    pub(super) fn relative_error(&self) -> f64 {
        (self.error / self.velocity).sqrt()
    }

    pub(super) fn are_converged(&self) -> bool {
        self.error <= TOLERANCE * TOLERANCE * self.velocity
    }
}

impl ViscousUnknowns {
    /// Starts from no change.
    pub(super) fn begin(&mut self, particles: &Particles, dt: f64) -> Dots {
        let n = particles.len();
        for column in [
            &mut self.change,
            &mut self.residual,
            &mut self.direction,
            &mut self.force,
        ] {
            column.clear();
            column.resize(n, Vec3::zeros());
        }
        self.diagonal.resize(n, 0.0);
        self.partial.resize(n.div_ceil(CHUNK), Dots::default());
        let (sums, resistance, is_held) = (&self.sums, &self.resistance, &self.is_held);
        let columns = (
            self.residual.par_chunks_mut(CHUNK),
            self.direction.par_chunks_mut(CHUNK),
            self.diagonal.par_chunks_mut(CHUNK),
            self.partial.par_iter_mut(),
        );
        columns.into_par_iter().enumerate().for_each(
            |(chunk, (residual, direction, diagonal, dots))| {
                *dots = Dots::default();
                let columns = residual.iter_mut().zip(direction).zip(diagonal);
                for (a, ((r, p), d)) in (chunk * CHUNK..).zip(columns) {
                    let (m, v) = (particles.mass[a], &particles.velocity[a]);
                    // of a unit velocity along x the force is minus the diagonal
                    *d = m / dt + m / particles.density[a] * (resistance[a] - sums[a][0]);
                    if !is_held[a] {
                        *r = particles.acceleration[a] * m;
                    }
                    *p = *r / *d;
                    dots.residual += r.dot(p);
                    dots.error += dt * dt / m * r.norm_squared();
                    dots.velocity += m * v.norm_squared();
                }
            },
        );
        Dots::total(&self.partial)
    }

    /// Direction times the product with it; W.
    pub(super) fn curvature(&mut self, particles: &Particles, dt: f64) -> f64 {
        let (direction, sums, resistance) = (&self.direction, &self.sums, &self.resistance);
        let each = self.partial.par_iter_mut().enumerate();
        each.for_each(|(chunk, dots)| {
            let chunk = chunk * CHUNK..((chunk + 1) * CHUNK).min(direction.len());
            dots.residual = chunk.fold(0.0, |sum, a| {
                let (m, p) = (particles.mass[a], &direction[a]);
                let volume = m / particles.density[a];
                let squared = p.norm_squared() * (m / dt + volume * resistance[a]);
                sum + squared - volume * p.dot(&Vec3::from(sums[a]))
            });
        });
        self.partial.iter().fold(0.0, |sum, one| sum + one.residual)
    }

    /// Goes along the direction by a factor.
    pub(super) fn descend(&mut self, particles: &Particles, dt: f64, factor: f64) -> Dots {
        let (direction, sums, diagonal) = (&self.direction, &self.sums, &self.diagonal);
        let (resistance, is_held) = (&self.resistance, &self.is_held);
        let columns = (
            self.change.par_chunks_mut(CHUNK),
            self.residual.par_chunks_mut(CHUNK),
            self.force.par_chunks_mut(CHUNK),
            self.partial.par_iter_mut(),
        );
        columns
            .into_par_iter()
            .enumerate()
            .for_each(|(chunk, (change, residual, force, dots))| {
                *dots = Dots::default();
                let columns = change.iter_mut().zip(residual).zip(force);
                for (a, ((w, r), f)) in (chunk * CHUNK..).zip(columns) {
                    let (m, p) = (particles.mass[a], &direction[a]);
                    let volume = m / particles.density[a];
                    let viscous = (Vec3::from(sums[a]) - p * resistance[a]) * (volume * factor);
                    *w += p * factor;
                    *f += viscous;
                    if is_held[a] {
                        continue;
                    }
                    *r += viscous - p * (m / dt * factor);
                    dots.residual += r.norm_squared() / diagonal[a];
                    dots.error += dt * dt / m * r.norm_squared();
                    dots.velocity += m * (particles.velocity[a] + *w).norm_squared();
                }
            });
        Dots::total(&self.partial)
    }

    /// The next direction.
    pub(super) fn turn(&mut self, factor: f64) {
        let columns = (
            self.direction.par_chunks_mut(CHUNK),
            self.residual.par_chunks(CHUNK),
            self.diagonal.par_chunks(CHUNK),
        );
        columns
            .into_par_iter()
            .for_each(|(direction, residual, diagonal)| {
                for ((p, r), d) in direction.iter_mut().zip(residual).zip(diagonal) {
                    *p = r / *d + *p * factor;
                }
            });
    }

    /// Packs the change with the volumes.
    pub(super) fn pack_change(&mut self, fluid: &Fluid) {
        let (change, p) = (&self.change, &fluid.particles);
        self.points.pack(
            fluid.settings.scheme.precision,
            &fluid.frame,
            &p.position,
            |a| {
                let w = change[a];
                [w.x, w.y, w.z, 0.0, p.mass[a] / p.density[a]]
            },
        );
    }
}
