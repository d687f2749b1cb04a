//! Formulas of the terms whose constants follow from the settings, but for forces.

use super::{Formula, PairSource, Registers, Summing};
use crate::Vec3;
use crate::kernel::PairKernel;
use crate::neighbors::sweep::{AnyPoints, PackedIn};
use crate::scheme::DensityDiffusion;
use crate::terms::concentration::{Concentration, ConcentrationTerm};
use crate::terms::continuity::{
    AnyDiffusion, Continuity, GradientDiffusion, JumpDiffusion, NoDiffusion, Rate, RateOwn,
};
use crate::terms::extrapolation::{Extrapolated, Extrapolation};
use crate::terms::gradient::{Gradient, Strain, StrainSums};
use crate::terms::summation::Summation;

/// Density by summation.
pub(crate) struct Densities;

impl Formula for Densities {
    type Out = f64;

    fn apply<L, K, W>(&self, summing: Summing<L, K, W, f64>) -> u64
    where
        L: Registers,
        K: PairKernel<L>,
        W: PairSource,
    {
        let term = Summation::new(summing.machine, summing.kernel);
        summing.of(&term)
    }
}

/// Rates of density with their diffusion.
pub(crate) struct Rates<'a> {
    pub own: RateOwn<'a>,
    /// Gradients of density, packed, for Antuono's diffusion.
    pub gradients: &'a AnyPoints,
}

impl Formula for Rates<'_> {
    type Out = Rate;

    fn apply<L, K, W>(&self, summing: Summing<L, K, W, Rate>) -> u64
    where
        L: Registers,
        K: PairKernel<L>,
        W: PairSource,
    {
        let (s, machine) = (summing.settings, summing.machine);
        let h = s.smoothing_length;
        let jump = |gravity: Vec3, delta: f64| {
            let hydrostatic = gravity * (-s.reference_density / (s.sound_speed * s.sound_speed));
            JumpDiffusion::new(machine, hydrostatic, h, delta * h * s.sound_speed)
        };
        let diffusion = match s.scheme.diffusion {
            DensityDiffusion::None => AnyDiffusion::None(NoDiffusion(L::splat(machine, 0.0))),
            DensityDiffusion::MolteniColagrossi(delta) => {
                AnyDiffusion::Jump(jump(Vec3::zeros(), delta))
            }
            DensityDiffusion::Fourtakas(delta) => AnyDiffusion::Jump(jump(s.gravity, delta)),
            DensityDiffusion::Antuono(delta) => {
                let gradients = L::Record::of(self.gradients).records();
                let strength = delta * h * s.sound_speed;
                AnyDiffusion::Gradient(GradientDiffusion::new(machine, h, strength, gradients))
            }
        };
        let (kernel, rho) = (summing.kernel, s.reference_density);
        match diffusion {
            AnyDiffusion::Jump(jump) if K::IS_SPECIALIZED => {
                summing.of(&Continuity::new(machine, kernel, jump, self.own, rho))
            }
            any => summing.of(&Continuity::new(machine, kernel, any, self.own, rho)),
        }
    }
}

/// Rates of density by walls, which nothing diffuses into.
pub(crate) struct WallRates<'a> {
    pub own: RateOwn<'a>,
}

impl Formula for WallRates<'_> {
    type Out = Rate;

    fn apply<L, K, W>(&self, summing: Summing<L, K, W, Rate>) -> u64
    where
        L: Registers,
        K: PairKernel<L>,
        W: PairSource,
    {
        let machine = summing.machine;
        let term = Continuity::new(
            machine,
            summing.kernel,
            NoDiffusion(L::splat(machine, 0.0)),
            self.own,
            summing.settings.reference_density,
        );
        summing.of(&term)
    }
}

/// Renormalized gradients of density.
pub(crate) struct Gradients<'a> {
    pub density: &'a [f64],
}

impl Formula for Gradients<'_> {
    type Out = [f64; 3];

    fn apply<L, K, W>(&self, summing: Summing<L, K, W, [f64; 3]>) -> u64
    where
        L: Registers,
        K: PairKernel<L>,
        W: PairSource,
    {
        let s = summing.settings;
        let term = Gradient::new(
            summing.machine,
            summing.kernel,
            self.density,
            s.reference_density,
            s.dimensions,
        );
        summing.of(&term)
    }
}

/// Gradients of velocity.
pub(crate) struct Strains<'a> {
    pub velocity: &'a [Vec3],
}

impl Formula for Strains<'_> {
    type Out = StrainSums;

    fn apply<L, K, W>(&self, summing: Summing<L, K, W, StrainSums>) -> u64
    where
        L: Registers,
        K: PairKernel<L>,
        W: PairSource,
    {
        let dimensions = summing.settings.dimensions;
        let term = Strain::new(summing.machine, summing.kernel, self.velocity, dimensions);
        summing.of(&term)
    }
}

/// Concentration of particles and its gradient.
pub(crate) struct Concentrations;

impl Formula for Concentrations {
    type Out = Concentration;

    fn apply<L, K, W>(&self, summing: Summing<L, K, W, Concentration>) -> u64
    where
        L: Registers,
        K: PairKernel<L>,
        W: PairSource,
    {
        let term = ConcentrationTerm::new(summing.machine, summing.kernel);
        summing.of(&term)
    }
}

/// Pressure and velocity continued to wall points; with `SLOPED`, also the slopes of the points that each sees.
pub(crate) struct Extrapolations<const SLOPED: bool>;

impl<const SLOPED: bool> Formula for Extrapolations<SLOPED> {
    type Out = Extrapolated;

    fn apply<L, K, W>(&self, summing: Summing<L, K, W, Extrapolated>) -> u64
    where
        L: Registers,
        K: PairKernel<L>,
        W: PairSource,
    {
        let (machine, s) = (summing.machine, summing.settings);
        let (rho, c) = (s.reference_density, s.sound_speed);
        let term = Extrapolation::<L, K, SLOPED>::new(machine, summing.kernel, rho, c);
        summing.of(&term)
    }
}
