//! Formulas of the forces: pressure of the pair and viscosity, within the fluid and between it and walls.

use super::{Formula, PairSource, Registers, Summing};
use crate::kernel::{PairKernel, Viscous};
use crate::neighbors::sweep::{AnyPoints, PackedIn};
use crate::scheme::Viscosity;
use crate::terms::drag::{Drag, DragOwn};
use crate::terms::momentum::{
    AnyViscosity, Central, ForceDensity, ForceOwn, Momentum, PairPressure, PairViscosity,
    Published, Shear, SumOfPressures, VariableShear, WeightedByDensity,
};

/// Resistance to shear in a force sum.
#[derive(Clone, Copy)]
pub(crate) enum Shearing<'a> {
    /// The same for all.
    Uniform(Viscosity),
    /// Viscosities of the fluid's particles.
    OfParticles(&'a AnyPoints),
}

/// Forces of the fluid on itself.
pub(crate) struct FluidForces<'a> {
    pub own: ForceOwn<'a>,
    pub shear: Shearing<'a>,
}

/// Forces of walls on the fluid.
pub(crate) struct WallForces<'a> {
    pub own: ForceOwn<'a>,
    pub shear: Shearing<'a>,
}

/// Forces of the fluid on walls.
pub(crate) struct Reactions<'a> {
    pub own: ForceOwn<'a>,
    pub shear: Shearing<'a>,
}

macro_rules! force_formula {
    ($name:ident, $pressure:expr, $of_receiver:literal, $of_neighbor:literal) => {
        impl Formula for $name<'_> {
            type Out = ForceDensity;

            fn apply<L, K, W>(&self, summing: Summing<L, K, W, ForceDensity>) -> u64
            where
                L: Registers,
                K: PairKernel<L>,
                W: PairSource,
            {
                let pressure = $pressure(&summing);
                match self.shear {
                    Shearing::Uniform(viscosity) => {
                        summing.with_uniform(pressure, viscosity, self.own)
                    }
                    Shearing::OfParticles(viscosities) => {
                        let shear = VariableShear::<L, $of_receiver, $of_neighbor>::new(
                            summing.machine,
                            L::Record::of(viscosities).records(),
                            summing.settings.smoothing_length,
                        );
                        summing.with_viscosity(pressure, shear, self.own)
                    }
                }
            }
        }
    };
}

force_formula!(
    FluidForces,
    |_: &Summing<L, K, W, ForceDensity>| SumOfPressures,
    true,
    true
);
force_formula!(WallForces, Summing::face_pressure, true, false);
force_formula!(Reactions, Summing::face_pressure, false, true);

/// Viscous forces of a field of velocities: of the fluid on itself with both viscosities of a pair, of walls on the fluid with that of the
/// receiver, of the fluid on walls with that of the neighbor.
pub(crate) struct Drags<'a, const OF_RECEIVER: bool, const OF_NEIGHBOR: bool> {
    pub own: DragOwn<'a>,
    pub shear: Shearing<'a>,
}

impl<const OF_RECEIVER: bool, const OF_NEIGHBOR: bool> Formula
    for Drags<'_, OF_RECEIVER, OF_NEIGHBOR>
{
    type Out = [f64; 3];

    fn apply<L, K, W>(&self, summing: Summing<L, K, W, [f64; 3]>) -> u64
    where
        L: Registers,
        K: PairKernel<L>,
        W: PairSource,
    {
        let (machine, kernel) = (summing.machine, summing.kernel);
        match self.shear {
            Shearing::Uniform(viscosity) => {
                let viscosity = summing.uniform(viscosity);
                summing.of(&Drag::new(machine, kernel, viscosity, self.own))
            }
            Shearing::OfParticles(viscosities) => {
                let shear = VariableShear::<L, OF_RECEIVER, OF_NEIGHBOR>::new(
                    machine,
                    L::Record::of(viscosities).records(),
                    summing.settings.smoothing_length,
                );
                summing.of(&Drag::new(machine, kernel, shear, self.own))
            }
        }
    }
}

impl<L, K, W> Summing<'_, L, K, W, ForceDensity>
where
    L: Registers,
    K: PairKernel<L>,
    W: PairSource,
{
    /// Pressure of a face between fluid and wall.
    fn face_pressure(&self) -> WeightedByDensity<L> {
        let s = self.settings;
        WeightedByDensity::new(self.machine, s.reference_density, s.sound_speed)
    }

    /// Sums with a viscosity that is the same for all: those of the presets have code of their own.
    fn with_uniform<P>(self, pressure: P, viscosity: Viscosity, own: ForceOwn) -> u64
    where
        P: PairPressure<L>,
    {
        match self.uniform(viscosity) {
            AnyViscosity::Artificial(term) if K::IS_SPECIALIZED => {
                self.with_viscosity(pressure, term, own)
            }
            AnyViscosity::Laminar(term) if K::IS_SPECIALIZED => {
                self.with_viscosity(pressure, term, own)
            }
            any => self.with_viscosity(pressure, any, own),
        }
    }

    fn with_viscosity<P, V>(self, pressure: P, viscosity: V, own: ForceOwn) -> u64
    where
        P: PairPressure<L>,
        V: PairViscosity<L>,
    {
        let term = Momentum::new(self.machine, self.kernel, pressure, viscosity, own);
        self.of(&term)
    }
}

impl<L: Registers, K, W, O> Summing<'_, L, K, W, O> {
    /// A viscosity that is the same for all.
    fn uniform(&self, viscosity: Viscosity) -> AnyViscosity<L> {
        let (s, machine) = (self.settings, self.machine);
        let (h, rho) = (s.smoothing_length, s.reference_density);
        let laminar_factor = 2.0 * (s.dimensions.count() + 2.0);
        match viscosity {
            Viscosity::None
            // these are of particles, see `Shearing`
            | Viscosity::Rheological { .. }
            | Viscosity::SubParticleScale { .. } => AnyViscosity::Inviscid,
            Viscosity::Published { dynamic_viscosity } => {
                let kernel = Viscous::new(s.support_radius(), s.dimensions);
                AnyViscosity::Published(Published::new(machine, dynamic_viscosity, &kernel))
            }
            Viscosity::Artificial { alpha } => {
                let factor = rho * alpha * s.sound_speed * h;
                AnyViscosity::Artificial(Central::new(machine, factor, h))
            }
            Viscosity::Laminar {
                kinematic_viscosity,
            } => {
                let factor = laminar_factor * rho * kinematic_viscosity;
                AnyViscosity::Laminar(Central::new(machine, factor, h))
            }
            Viscosity::Morris {
                kinematic_viscosity,
            } => AnyViscosity::Shear(Shear::new(machine, 2.0 * rho * kinematic_viscosity, h)),
        }
    }
}
