//! Fluid at planes of symmetry: reflection of particles that passed one, and the force of the other half of the flow.

use rayon::prelude::*;

use crate::fluid::energy::fixed_order_sum;
use crate::neighbors::rest::Still;
use crate::terms::momentum::ForceDensity;
use crate::{CHUNK, Fluid, Particles, Vec3};

impl Fluid {
    /// Reflects particles that passed a plane of symmetry: mirrored position and velocity, as their image crosses in the
    /// opposite direction. Books the momentum.
    pub(crate) fn reflect(&mut self) {
        for plane in self.settings.symmetry_planes() {
            let axis = plane.axis;
            let particles = &mut self.particles;
            let partial = &mut self.scratch.partial;
            partial.resize(particles.mass.len().div_ceil(CHUNK), 0.0);
            particles
                .position
                .par_chunks_mut(CHUNK)
                .zip(particles.velocity.par_chunks_mut(CHUNK))
                .zip(particles.mass.par_chunks(CHUNK))
                .zip(partial.par_iter_mut())
                .for_each(|(((position, velocity), mass), impulse)| {
                    *impulse = 0.0;
                    for ((x, v), m) in position.iter_mut().zip(velocity).zip(mass) {
                        if plane.distance(x) < 0.0 {
                            *x = plane.image_of(x);
                            *impulse -= 2.0 * m * v[axis];
                            v[axis] = -v[axis];
                        }
                    }
                });
            self.reflected[axis] += partial.iter().sum::<f64>();
        }
    }

    /// Whether a component of the planes' force is that of all pair forces, of which those between particles cancel.
    fn has_plane_force(&self, axis: usize) -> bool {
        self.settings.symmetry[axis] != [false; 2] || self.may_sleep()
    }

    /// Begins the sum of the force of the planes of symmetry, and of sleeping water, on the awake fluid.
    pub(crate) fn clear_plane_force(&mut self) {
        if (0..3).any(|axis| self.has_plane_force(axis)) {
            let n = 3 * self.particles.len().div_ceil(CHUNK);
            self.scratch.partial.clear();
            self.scratch.partial.resize(n, 0.0);
        }
    }

    /// Adds the pair forces of a part of the particles, which begins after so many chunks.
    pub(crate) fn add_plane_force(&mut self, n_chunks: usize, forces: &[ForceDensity]) {
        let n = self.particles.len().div_ceil(CHUNK);
        for axis in 0..3 {
            if !self.has_plane_force(axis) {
                continue;
            }
            let particles = &self.particles;
            let still = Still::of(self.sleep.as_deref());
            forces
                .par_chunks(CHUNK)
                .zip(particles.mass[n_chunks * CHUNK..].par_chunks(CHUNK))
                .zip(particles.density[n_chunks * CHUNK..].par_chunks(CHUNK))
                .zip(self.scratch.partial[axis * n + n_chunks..].par_iter_mut())
                .enumerate()
                .for_each(|(chunk, (((forces, mass), density), sum))| {
                    if still.has(n_chunks + chunk) {
                        return;
                    }
                    for ((force, m), rho) in forces.iter().zip(mass).zip(density) {
                        *sum += m / rho * (force.pressure[axis] + force.viscous[axis]);
                    }
                });
        }
    }

    /// Force of the planes from its parts.
    pub(crate) fn sum_plane_force(&mut self) {
        let n = self.particles.len().div_ceil(CHUNK);
        self.plane_force = Vec3::from_fn(|axis, _| match self.has_plane_force(axis) {
            true => self.scratch.partial[axis * n..(axis + 1) * n].iter().sum(),
            false => 0.0,
        });
    }

    /// Adds pair forces (N) of particles to the force of the planes.
    pub(crate) fn add_to_plane_force(&mut self, force: impl Fn(&Particles, usize) -> Vec3 + Sync) {
        for axis in 0..3 {
            if self.has_plane_force(axis) {
                let particles = &self.particles;
                let sum = fixed_order_sum(particles.len(), |a| force(particles, a)[axis]);
                self.plane_force[axis] += sum;
            }
        }
    }

    /// Force of the planes of symmetry on the fluid since the last [`Self::update_accelerations`], normal to
    /// them: the reaction of the other half of the flow. Includes the force of sleeping water on
    /// awake water; N.
    pub fn plane_force(&self) -> Vec3 {
        self.plane_force
    }

    /// Momentum given to particles that passed a plane of symmetry and were sent back, since the ledger was
    /// opened; kg m/s.
    pub fn reflected(&self) -> Vec3 {
        self.reflected
    }
}
