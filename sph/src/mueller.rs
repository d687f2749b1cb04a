//! The published scheme: density by summation, Mueller's kernels.
//!
//! Source: Mueller, Charypar & Gross (2003), Eqs. 3, 10 and 14; Geraili Mikola & Sitar (2014),
//! Eqs. 11 to 22 with the misprints of Eqs. 12, 14, 15, 16 and 18 corrected.

use rayon::prelude::*;

use crate::kernel::{Kernel, Poly6, Spiky, Viscous};
use crate::neighbors::{Neighbor, NeighborLists};
use crate::state_equation::LinearState;
use crate::{CHUNK, Vec3};

/// What a pair sum reads of a particle, in one cache line.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(crate) struct Record {
    position: [f64; 3],
    velocity: [f64; 3],
    pressure: f64,
    specific_volume: f64,
}

/// The published scheme with its constants.
#[derive(Clone, Debug)]
pub(crate) struct Mueller {
    density_kernel: Poly6,
    pressure_kernel: Spiky,
    viscous_kernel: Viscous,
    /// Kernel sum over the undisturbed lattice.
    lattice_sum: f64,
    /// kg.
    particle_mass: f64,
    /// Pa s.
    dynamic_viscosity: f64,
    state: LinearState,
    periodic: bool,
}

impl Mueller {
    pub(crate) fn new(
        support_radius: f64,
        spacing: [f64; 3],
        state: LinearState,
        dynamic_viscosity: f64,
        periodic: bool,
    ) -> Self {
        let density_kernel = Poly6::new(support_radius);
        Self {
            density_kernel,
            pressure_kernel: Spiky::new(support_radius),
            viscous_kernel: Viscous::new(support_radius),
            lattice_sum: density_kernel.lattice_sum(spacing),
            particle_mass: state.reference_density * spacing.iter().product::<f64>(),
            dynamic_viscosity,
            state,
            periodic,
        }
    }

    pub(crate) fn particle_mass(&self) -> f64 {
        self.particle_mass
    }

    pub(crate) fn state(&self) -> &LinearState {
        &self.state
    }

    /// Density and pressure of every particle.
    ///
    /// ```text
    /// ρ_a = Σ_b m W_poly6(r_ab) / S                          b = a included       [kg/m³]
    /// ```
    /// Eq. 12 sums over the wrong index in print.
    pub(crate) fn densities(
        &self,
        lists: &NeighborLists,
        positions: &[Vec3],
        (density, pressure): (&mut [f64], &mut [f64]),
    ) {
        let scale = self.particle_mass * self.density_kernel.factor() / self.lattice_sum;
        density
            .par_chunks_mut(CHUNK)
            .zip(pressure.par_chunks_mut(CHUNK))
            .zip(positions.par_chunks(CHUNK))
            .enumerate()
            .for_each(|(chunk, ((density, pressure), own))| {
                let lists_of_chunk = lists.lists_of_chunk(chunk);
                for (((density, pressure), x), list) in density
                    .iter_mut()
                    .zip(pressure)
                    .zip(own)
                    .zip(lists_of_chunk)
                {
                    let sum = if self.periodic {
                        self.shape_sum::<true>(x, list, positions, lists.shifts())
                    } else {
                        self.shape_sum::<false>(x, list, positions, lists.shifts())
                    };
                    *density = scale * sum;
                    *pressure = self.state.pressure(*density);
                }
            });
    }

    #[inline]
    fn shape_sum<const PERIODIC: bool>(
        &self,
        x: &Vec3,
        list: &[Neighbor],
        positions: &[Vec3],
        shifts: &[Vec3],
    ) -> f64 {
        let shape = |b: &Neighbor| {
            let mut offset = x - positions[b.index()];
            if PERIODIC {
                offset -= shifts[b.image()];
            }
            self.density_kernel.shape(offset.norm_squared())
        };
        // four partial sums: the additions of one would wait for each other
        let (quads, rest) = list.as_chunks::<4>();
        let mut sums = [0.0; 4];
        for quad in quads {
            for (sum, b) in sums.iter_mut().zip(quad) {
                *sum += shape(b);
            }
        }
        (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest.iter().map(shape).sum::<f64>()
    }

    /// Packs what the pair sums of [`Self::accelerations`] read.
    pub(crate) fn pack(
        &self,
        positions: &[Vec3],
        velocities: &[Vec3],
        (density, pressure): (&[f64], &[f64]),
        records: &mut Vec<Record>,
    ) {
        records.resize(positions.len(), Record::default());
        records
            .par_iter_mut()
            .with_min_len(4096)
            .enumerate()
            .for_each(|(a, record)| {
                *record = Record {
                    position: positions[a].into(),
                    velocity: velocities[a].into(),
                    pressure: pressure[a],
                    specific_volume: 1.0 / density[a],
                };
            });
    }

    /// Accelerations from pressure and viscosity, and gravity; the viscous part also by itself.
    ///
    /// ```text
    /// a_a^p = − Σ_b m (p_a + p_b)/(ρ_a ρ_b) ∇W_spiky                               [m/s²]
    /// a_a^v = μ Σ_b m (v_b − v_a)/(ρ_a ρ_b) ∇²W_visc                               [m/s²]
    /// ```
    /// Eq. 14 prints a minus between the pressures, which would break action = reaction; Eq. 18
    /// prints v_a − v_b, a negative viscosity. Forces per volume are divided by ρ_a here.
    ///
    /// The published pair term is the mean, `(p_a + p_b)/2`. Round a particle the p_a part cancels,
    /// so the mean yields half the gradient, and water at rest would show twice the hydrostatic
    /// pressure. The published stiffness is free, so the same forces follow from `k = 2c₀²` in the
    /// mean or from `p = c₀²(ρ − ρ₀)` in the sum; the sum is used, and `p` is the pressure.
    pub(crate) fn accelerations(
        &self,
        lists: &NeighborLists,
        records: &[Record],
        gravity: &Vec3,
        (acceleration, viscous): (&mut [Vec3], &mut [Vec3]),
    ) {
        acceleration
            .par_chunks_mut(CHUNK)
            .zip(viscous.par_chunks_mut(CHUNK))
            .zip(records.par_chunks(CHUNK))
            .enumerate()
            .for_each(|(chunk, ((acceleration, viscous), own))| {
                let lists_of_chunk = lists.lists_of_chunk(chunk);
                for (((acceleration, viscous), a), list) in acceleration
                    .iter_mut()
                    .zip(viscous)
                    .zip(own)
                    .zip(lists_of_chunk)
                {
                    let (pressure_sum, viscous_sum) = if self.periodic {
                        self.pair_sums::<true>(a, list, records, lists.shifts())
                    } else {
                        self.pair_sums::<false>(a, list, records, lists.shifts())
                    };
                    let scale = self.particle_mass * a.specific_volume;
                    *viscous = viscous_sum * (self.dynamic_viscosity * scale);
                    *acceleration = gravity - pressure_sum * scale + *viscous;
                }
            });
    }

    /// `Σ_b (p_a + p_b)/ρ_b ∇W_spiky` and `Σ_b (v_b − v_a)/ρ_b ∇²W_visc`.
    ///
    /// The particle itself is in its list: at no distance and no relative velocity it adds nothing.
    #[inline]
    fn pair_sums<const PERIODIC: bool>(
        &self,
        a: &Record,
        list: &[Neighbor],
        records: &[Record],
        shifts: &[Vec3],
    ) -> (Vec3, Vec3) {
        let position = Vec3::from(a.position);
        let velocity = Vec3::from(a.velocity);
        let mut pressure_sum = Vec3::zeros();
        let mut viscous_sum = Vec3::zeros();
        for neighbor in list {
            let b = &records[neighbor.index()];
            let mut offset = position - Vec3::from(b.position);
            if PERIODIC {
                offset -= shifts[neighbor.image()];
            }
            let r = offset.norm();
            let pair = (a.pressure + b.pressure) * b.specific_volume;
            pressure_sum += offset * (pair * self.pressure_kernel.gradient_factor(r));
            viscous_sum += (Vec3::from(b.velocity) - velocity)
                * (b.specific_volume * self.viscous_kernel.laplacian(r));
        }
        (pressure_sum, viscous_sum)
    }
}
