//! Shear along walls: none, of the fluid itself, up to Coulomb's limit, or by the law of the wall.

use rayon::prelude::*;

use super::WallParticles;
use crate::boundary::wall_law::WallLaw;
use crate::fluid::wall_sums::{self, Near};
use crate::scheme::Viscosity;
use crate::terms::concentration::Concentration;
use crate::terms::gradient::StrainSums;
use crate::terms::momentum::ForceDensity;
use crate::terms::sums::Shearing;
use crate::{CHUNK, Fluid, Vec3};

/// Slip of the fluid along a wall.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Slip {
    /// It slides: no viscous force.
    #[default]
    Free,
    /// It sticks.
    None,
    /// No slip up to this ratio of tangential to normal force, the coefficient of friction
    /// `μ_w`; >= 0. Shear is that of Morris with the viscosity of the particle, or of the fluid.
    Friction(f64),
    /// The law of the wall of a turbulent boundary layer; see [`wall_law`](crate::boundary::wall_law).
    Rough {
        /// Equivalent sand roughness `k_s`; m, >= 0.
        roughness: f64,
        /// Molecular one of the fluid, which that of the scheme may exceed; m²/s, >= 0.
        kinematic_viscosity: f64,
    },
}

impl Slip {
    /// Whether the fluid sees walls that move against it: no slip, or none up to a limit.
    pub(super) fn sticks(self) -> bool {
        matches!(self, Self::None | Self::Friction(_))
    }

    /// Whether shear is summed first, and scaled then.
    pub(super) fn is_scaled(self) -> bool {
        matches!(self, Self::Friction(_) | Self::Rough { .. })
    }
}

/// Viscosity with which shear along rough walls is summed, before it is scaled to the law of the wall; Pa s.
const UNIT_VISCOSITY: f64 = 1.0;

/// Change of the velocity of a particle against that of its mirror image in a wall at rest, over its own.
const MIRRORED: f64 = 2.0;

impl WallParticles {
    /// Viscosity model along these walls.
    pub(super) fn shearing<'a>(&'a self, fluid: &'a Fluid) -> Shearing<'a> {
        match self.slip {
            Slip::Free => Shearing::Uniform(Viscosity::None),
            Slip::None => fluid.shearing(),
            Slip::Friction(_) | Slip::Rough { .. } => Shearing::OfParticles(&self.viscosities),
        }
    }

    /// Evaluates forces on the walls before [`Self::add_forces`] knows how much of the shear stays: all of it where Coulomb
    /// friction limits it, none of it along rough walls, where it is small beside the pressure.
    pub fn stick(&mut self, fluid: &Fluid) {
        match self.slip {
            Slip::Free | Slip::None => {}
            Slip::Friction(_) => self.keep(fluid, 1.0),
            Slip::Rough { .. } => self.keep(fluid, 0.0),
        }
    }

    fn keep(&mut self, fluid: &Fluid, share: f64) {
        self.scratch.kept.clear();
        self.scratch.kept.resize(fluid.particles.len(), share);
        self.pack_viscosities(fluid);
    }

    /// Writes the viscosities towards the walls times the share that each particle keeps.
    fn pack_viscosities(&mut self, fluid: &Fluid) {
        let kept = &self.scratch.kept;
        let is_rough = matches!(self.slip, Slip::Rough { .. });
        self.viscosities
            .pack_values(fluid.settings.scheme.precision, kept.len(), |a| {
                let viscosity = match is_rough {
                    true => UNIT_VISCOSITY,
                    false => fluid.apparent_viscosity(a),
                };
                [viscosity * kept[a], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
            });
    }

    /// Prepares the shear that [`Self::scale_shear`] scales: all of it where Coulomb friction limits it, that of a unit viscosity along rough
    /// walls.
    pub(super) fn begin_shear(&mut self, fluid: &Fluid) {
        if self.slip.is_scaled() {
            self.keep(fluid, 1.0);
        }
    }

    /// Resists the change of velocity of the fluid in an implicit viscous step: walls along which it does not slip. Shear up to the
    /// limit of friction, or by the law of the wall, stays that of the present velocities.
    pub fn add_resistance(&mut self, fluid: &mut Fluid) {
        if self.nearby_particles.is_empty() || self.slip != Slip::None {
            return;
        }
        self.list_points(fluid);
        let mut drags = std::mem::take(&mut self.scratch.drags);
        for near in self.near_points(fluid).parts() {
            drags.resize(near.len(), [0.0; 3]);
            let (walls, shear) = (self.neighborhood(fluid), self.shearing(fluid));
            wall_sums::drags_of_unit(fluid, walls, near, shear, &mut drags);
            let each = near.chosen().iter().zip(&drags);
            fluid.resist(each.map(|(&a, drag)| (a, -MIRRORED * drag[0])));
        }
        self.scratch.drags = drags;
    }

    /// Whether the fluid drags these walls along in the implicit viscous step just solved.
    fn are_dragged(&self, fluid: &Fluid) -> bool {
        self.slip == Slip::None && fluid.has_viscous_change()
    }

    /// Forces of the implicit viscous step just solved on some points, if there was one, per volume and as of particles that are
    /// not mirrored; see [`Self::drag_of`].
    pub(super) fn sum_drags(&self, fluid: &Fluid, near: Near, drags: &mut [[f64; 3]]) {
        if self.are_dragged(fluid) {
            let places = (fluid.packed_viscous_change(), self.places());
            wall_sums::drags_on_walls(fluid, places, near, self.shearing(fluid), drags);
        }
    }

    /// Force on a point; N.
    pub(super) fn drag_of(&self, point: usize, drag: &[f64; 3]) -> Vec3 {
        Vec3::from(*drag) * (MIRRORED * self.volume[point])
    }

    /// Calls `visit` with every wet point and the force (N) of the implicit viscous step just solved on it, in order.
    pub fn visit_drag(&mut self, fluid: &Fluid, mut visit: impl FnMut(usize, &Vec3)) {
        if !self.are_dragged(fluid) {
            return;
        }
        let mut drags = std::mem::take(&mut self.scratch.drags);
        for near in self.near_particles(fluid).parts() {
            drags.resize(near.len(), [0.0; 3]);
            self.sum_drags(fluid, near, &mut drags);
            for (&w, drag) in near.chosen().iter().zip(&drags) {
                visit(w as usize, &self.drag_of(w as usize, drag));
            }
        }
        self.scratch.drags = drags;
    }

    /// Scales the shear of particles to the limit of friction, or to the law of the wall.
    pub(super) fn scale_shear(&mut self, fluid: &Fluid, forces: &mut [ForceDensity]) {
        match self.slip {
            Slip::Free | Slip::None => {}
            Slip::Friction(coefficient) => self.limit(fluid, coefficient, forces),
            Slip::Rough {
                roughness,
                kinematic_viscosity,
            } => {
                let law = WallLaw {
                    height: fluid.settings.mean_spacing(),
                    kinematic_viscosity,
                    roughness,
                };
                self.roughen(fluid, law, forces);
            }
        }
    }

    /// Scales the forces of a unit viscosity to the law of the wall.
    fn roughen(&mut self, fluid: &Fluid, law: WallLaw, forces: &mut [ForceDensity]) {
        let near = &self.nearby_particles;
        let mut concentrations = std::mem::take(&mut self.scratch.concentrations);
        concentrations.resize(near.len(), Concentration::default());
        wall_sums::concentrations(
            fluid,
            self.neighborhood(fluid),
            self.near_points(fluid),
            &mut concentrations,
        );
        let mut strains = std::mem::take(&mut self.scratch.strains);
        let are_still = self.velocity.is_empty();
        if !are_still {
            strains.resize(near.len(), StrainSums::default());
            wall_sums::strains(
                fluid,
                self.neighborhood(fluid),
                self.near_points(fluid),
                &mut strains,
            );
        }
        let particles = &fluid.particles;
        let mut shares = std::mem::take(&mut self.scratch.shares);
        (forces, near, &concentrations)
            .into_par_iter()
            .with_min_len(CHUNK)
            .enumerate()
            .map(|(k, (force, &a, concentration))| {
                let weight = law.weight(self.distances.at(concentration.divergence));
                let gradient = Vec3::from(concentration.gradient);
                let size = gradient.norm();
                let share = if 0.0 < weight && 0.0 < size {
                    let normal = gradient / size;
                    let across = |v: Vec3| (v - normal * normal.dot(&v)).norm();
                    let relative = match are_still {
                        true => particles.velocity[a as usize],
                        false => strains[k].difference_along(&normal) / size,
                    };
                    let stress =
                        particles.density[a as usize] * law.stress_over_density(across(relative));
                    let found = across(Vec3::from(force.viscous));
                    let wanted = weight * stress / law.height;
                    if 0.0 < found { wanted / found } else { 0.0 }
                } else {
                    0.0
                };
                force.viscous = force.viscous.map(|f| f * share);
                share
            })
            .collect_into_vec(&mut shares);
        for (&a, &share) in near.iter().zip(&shares) {
            self.scratch.kept[a as usize] = share;
        }
        self.scratch.concentrations = concentrations;
        self.scratch.strains = strains;
        self.scratch.shares = shares;
        self.pack_viscosities(fluid);
    }

    /// Scales viscous forces down to the friction limit.
    fn limit(&mut self, fluid: &Fluid, coefficient: f64, forces: &mut [ForceDensity]) {
        for (&a, force) in self.nearby_particles.iter().zip(forces) {
            let (normal, viscous) = (Vec3::from(force.pressure), Vec3::from(force.viscous));
            let size = normal.norm();
            let direction = normal / size.max(f64::MIN_POSITIVE);
            let along = (viscous - direction * direction.dot(&viscous)).norm();
            let presses = 0.0 < fluid.particles.pressure[a as usize];
            let most = if presses { coefficient * size } else { 0.0 };
            if most < along {
                let share = most / along;
                self.scratch.kept[a as usize] = share;
                force.viscous = (viscous * share).into();
            }
        }
        self.pack_viscosities(fluid);
    }
}
