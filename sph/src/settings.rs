//! Settings of the fluid, their checks, and lengths that follow from them.

use crate::Vec3;
use crate::error::FluidError;
use crate::kernel::Dimensions;
use crate::neighbors::cells::Periodicity;
use crate::neighbors::mirror::{Mirrors, Symmetry, SymmetryPlane};
use crate::scheme::{
    DensityMethod, LARGEST_BULK_VISCOSITY, Scheme, Stepping, Viscosity, ViscousStep,
};

/// Margin of cells beyond the support radius, over this radius, so that particles may move before the next sort.
const WIDEST_SKIN: f64 = 0.1;
/// The same where a period leaves no room for more.
const LEAST_SKIN: f64 = 0.05;
/// Least distance between two planes of symmetry across an axis, over the support radius.
const LEAST_BETWEEN_PLANES: f64 = 1.1;

/// Settings of the fluid, constant during a run.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Particle spacing along x, y, z at the start; m. In two dimensions that along y is the width.
    pub particle_spacing: [f64; 3],
    /// Smoothing length `h`; the support radius is `2h`; m.
    pub smoothing_length: f64,
    /// Reference density; kg/m³.
    pub reference_density: f64,
    /// Numerical sound speed; m/s.
    pub sound_speed: f64,
    /// The choices that make the scheme.
    pub scheme: Scheme,
    /// Dimensions of the flow.
    pub dimensions: Dimensions,
    /// Acceleration of gravity; m/s².
    pub gravity: Vec3,
    /// Share of the stability limits that a step may use, above 0 and at most 1.
    pub time_step_factor: f64,
    /// The modeled box; m.
    pub domain: (Vec3, Vec3),
    /// Periodic directions.
    pub periodic: Periodicity,
    /// Sides of the domain that are planes of symmetry; neither along gravity nor in periodic directions.
    pub symmetry: Symmetry,
}

impl Settings {
    /// Support radius `H = 2h` of every kernel; m.
    pub fn support_radius(&self) -> f64 {
        2.0 * self.smoothing_length
    }

    /// Mean spacing of the lattice, `∛(dx dy dz)`, or `√(dx dz)` in a plane, whose width is no spacing; m.
    pub fn mean_spacing(&self) -> f64 {
        let [dx, dy, dz] = self.particle_spacing;
        match self.dimensions {
            Dimensions::Two { .. } => (dx * dz).sqrt(),
            Dimensions::Three => (dx * dy * dz).cbrt(),
        }
    }

    /// Least spacing of the lattice in the directions of the flow; m.
    pub fn least_spacing(&self) -> f64 {
        let [dx, dy, dz] = self.particle_spacing;
        match self.dimensions {
            Dimensions::Two { .. } => dx.min(dz),
            Dimensions::Three => dx.min(dy).min(dz),
        }
    }

    /// Length over which eddies smaller than the spacing mix: Smagorinsky's `C` times the spacing; m.
    pub(crate) fn mixing_length(&self) -> f64 {
        let Viscosity::SubParticleScale { smagorinsky, .. } = self.scheme.viscosity else {
            return 0.0;
        };
        smagorinsky * self.mean_spacing()
    }

    /// Kinematic viscosity that the viscous force amounts to; m²/s.
    ///
    /// The artificial one is `α c₀ h/(2(d+2))` where all pairs take part. Where viscosity varies it is that
    /// at rest.
    pub fn kinematic_viscosity(&self) -> f64 {
        let neighbors_factor = match self.dimensions {
            Dimensions::Two { .. } => 8.0,
            Dimensions::Three => 10.0,
        };
        match self.scheme.viscosity {
            Viscosity::None => 0.0,
            Viscosity::Published { dynamic_viscosity } => {
                dynamic_viscosity / self.reference_density
            }
            Viscosity::Artificial { alpha } => {
                alpha * self.sound_speed * self.smoothing_length / neighbors_factor
            }
            Viscosity::Laminar {
                kinematic_viscosity,
            }
            | Viscosity::Morris {
                kinematic_viscosity,
            }
            | Viscosity::SubParticleScale {
                kinematic_viscosity,
                ..
            } => kinematic_viscosity,
            Viscosity::Rheological { rheology } => {
                rheology.viscosity_at_rest() / self.reference_density
            }
        }
    }

    /// Dynamic bulk viscosity `ζ = α₂ ρ₀ c₀ h`; Pa s.
    pub fn bulk_viscosity(&self) -> f64 {
        self.scheme.bulk_viscosity
            * self.reference_density
            * self.sound_speed
            * self.smoothing_length
    }

    /// The sides of the domain that are planes of symmetry.
    pub fn symmetry_planes(&self) -> impl Iterator<Item = SymmetryPlane> + use<> {
        let (symmetry, (min, max)) = (self.symmetry, self.domain);
        (0..3)
            .flat_map(|axis| [(axis, false), (axis, true)])
            .filter(move |&(axis, is_upper)| symmetry[axis][usize::from(is_upper)])
            .map(move |(axis, is_upper)| SymmetryPlane {
                axis,
                is_upper,
                place: if is_upper { max[axis] } else { min[axis] },
            })
    }

    /// Whether any side is a plane of symmetry.
    pub fn has_symmetry(&self) -> bool {
        self.symmetry != Symmetry::default()
    }

    /// Positions of the planes of symmetry.
    pub(crate) fn mirrors(&self) -> Mirrors {
        Mirrors::of(self.symmetry_planes())
    }

    pub(crate) fn check(&self) -> Result<(), FluidError> {
        let positive = [
            ("particle_spacing x", self.particle_spacing[0]),
            ("particle_spacing y", self.particle_spacing[1]),
            ("particle_spacing z", self.particle_spacing[2]),
            ("smoothing_length", self.smoothing_length),
            ("reference_density", self.reference_density),
            ("sound_speed", self.sound_speed),
            ("time_step_factor", self.time_step_factor),
        ];
        for (name, value) in positive {
            if !(value.is_finite() && 0.0 < value) {
                return Err(FluidError::Setting {
                    name,
                    value,
                    range: "finite and > 0",
                });
            }
        }
        if let Viscosity::Rheological { rheology } = self.scheme.viscosity {
            rheology.check()?;
        }
        let mixing_length = self.mixing_length();
        if !(mixing_length.is_finite() && 0.0 <= mixing_length) {
            return Err(FluidError::Setting {
                name: "mixing length",
                value: mixing_length,
                range: "finite and >= 0",
            });
        }
        let viscosity = self.kinematic_viscosity();
        if !(viscosity.is_finite() && 0.0 <= viscosity) {
            return Err(FluidError::Setting {
                name: "viscosity",
                value: viscosity,
                range: "finite and >= 0",
            });
        }
        let Scheme {
            density,
            stepping,
            bulk_viscosity,
            ..
        } = self.scheme;
        if !(0.0..=LARGEST_BULK_VISCOSITY).contains(&bulk_viscosity) {
            return Err(FluidError::Setting {
                name: "bulk_viscosity",
                value: bulk_viscosity,
                range: "from 0 to 1",
            });
        }
        if 0.0 < bulk_viscosity && density == DensityMethod::Summation {
            return Err(FluidError::Setting {
                name: "bulk_viscosity",
                value: bulk_viscosity,
                range: "0 with density by summation, which has no rates of density",
            });
        }
        if (density, stepping) == (DensityMethod::Continuity, Stepping::SymplecticEuler) {
            return Err(FluidError::GrowingSound);
        }
        self.check_viscous_step()?;
        if 1.0 < self.time_step_factor {
            return Err(FluidError::Setting {
                name: "time_step_factor",
                value: self.time_step_factor,
                range: "at most 1",
            });
        }
        self.check_symmetry(LEAST_BETWEEN_PLANES * self.support_radius())
    }

    /// Refuses schemes without implicit viscous steps, where they are asked for.
    ///
    /// # Errors
    ///
    /// [`FluidError::ExplicitViscosity`].
    pub fn check_viscous_step(&self) -> Result<(), FluidError> {
        let scheme = &self.scheme;
        let refused = if scheme.viscous_step == ViscousStep::Explicit {
            return Ok(());
        } else if !scheme.viscosity.is_after_morris() {
            "this viscosity, whose force is not along the difference of velocities; use `Rheological`, `Morris` or `SubParticleScale`"
        } else if scheme.stepping == Stepping::PredictorCorrector {
            "the stepping `PredictorCorrector`, which takes forces twice; use `KickDriftKick`"
        } else {
            return Ok(());
        };
        Err(FluidError::ExplicitViscosity { refused })
    }

    /// Refuses planes in which the flow has no mirror image; `reach` is the least distance between two, in m.
    pub(crate) fn check_symmetry(&self, reach: f64) -> Result<(), FluidError> {
        let extent = self.domain.1 - self.domain.0;
        for plane in self.symmetry_planes() {
            let axis = plane.axis;
            let reason = if self.periodic[axis] {
                "the domain repeats itself along it"
            } else if self.gravity[axis] != 0.0 {
                "gravity acts along it"
            } else if axis == 1 && matches!(self.dimensions, Dimensions::Two { .. }) {
                "nothing depends on y in two dimensions"
            } else if self.symmetry[axis] == [true; 2] && extent[axis] < reach {
                "the two sides are nearer to each other than 1.1 support radii"
            } else {
                continue;
            };
            return Err(FluidError::Symmetry { axis, reason });
        }
        Ok(())
    }

    /// Greatest approach of two particles without a new sort; m.
    ///
    /// Two particles that leave a domain by opposite periodic sides interact across two periods, which no sum
    /// covers: a period must be at least support and skin, as the distance of two planes of symmetry.
    pub fn widest_skin(&self) -> f64 {
        let support = self.support_radius();
        let extent = self.domain.1 - self.domain.0;
        let room = (0..3)
            .filter(|&axis| self.periodic[axis] || self.symmetry[axis] == [true; 2])
            .fold(f64::INFINITY, |room, axis| room.min(extent[axis] - support));
        room.clamp(LEAST_SKIN * support, WIDEST_SKIN * support)
    }
}

/// Largest steps by cause, the factor of the settings included; s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepLimits {
    /// From pressure waves.
    pub sound: f64,
    /// From viscosity.
    pub viscosity: f64,
    /// From acceleration.
    pub force: f64,
}

impl StepLimits {
    /// The smallest of them; s.
    pub fn smallest(&self) -> f64 {
        self.sound.min(self.viscosity).min(self.force)
    }
}
