//! Rate of density, with its diffusion.
//!
//! Records hold velocity, density minus the reference density, and volume.

use crate::Vec3;
use crate::kernel::PairKernel;
use crate::neighbors::sweep::{Pair, Term};
use crate::simd::lanes::{Lanes, RECORD};
use crate::terms::{Lanes3, dot, minus, signed, splat3};

/// Result of a rate sum.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Rate {
    /// By the flow; kg/(m³ s).
    pub flow: f64,
    /// By diffusion; kg/(m³ s).
    pub diffusion: f64,
    /// Neighbors found, the particle itself among them.
    pub n_found: u32,
    /// Concentration of neighbors times the number of dimensions, `−Σ V_b x·∇W`: in open water that number.
    pub crowding: f64,
}

/// Receivers of the rate, one slot per particle.
#[derive(Clone, Copy)]
pub(crate) struct RateOwn<'a> {
    pub velocity: &'a [Vec3],
    pub density: &'a [f64],
}

/// `dρ_a/dt = ρ_a Σ V_b v_ab·∇W + δ h c₀ Σ V_b ψ_ab·∇W`.
pub(crate) struct Continuity<'a, L, K, D> {
    kernel: K,
    diffusion: D,
    own: RateOwn<'a>,
    reference_density: f64,
    zero: L,
}

impl<'a, L: Lanes, K: PairKernel<L>, D: Diffusion<L>> Continuity<'a, L, K, D> {
    pub(crate) fn new(
        machine: L::Machine,
        kernel: K,
        diffusion: D,
        own: RateOwn<'a>,
        reference_density: f64,
    ) -> Self {
        Self {
            kernel,
            diffusion,
            own,
            reference_density,
            zero: L::splat(machine, 0.0),
        }
    }
}

impl<L: Lanes, K: PairKernel<L>, D: Diffusion<L>> Term<L> for Continuity<'_, L, K, D> {
    type Own = (Lanes3<L>, L, D::Own);
    type Sums = [L; 3];
    type Out = Rate;
    const READS_IDS: bool = D::READS_IDS;
    const COUNTS: bool = true;

    #[inline(always)]
    fn own(&self, machine: L::Machine, a: usize) -> Self::Own {
        (
            splat3(machine, self.own.velocity[a].into()),
            L::splat(machine, self.own.density[a] - self.reference_density),
            self.diffusion.own(machine, a),
        )
    }

    #[inline(always)]
    fn zero(&self, _: L::Machine) -> [L; 3] {
        [self.zero; 3]
    }

    #[inline(always)]
    fn add(
        &self,
        (velocity, density, own): &Self::Own,
        pair: &Pair<L>,
        ids: &[u32],
        sums: &mut [L; 3],
    ) {
        let [vx, vy, vz, excess, volume] = pair.b;
        let weight = volume * self.kernel.gradient_factor(pair.r2);
        let approach = dot(&minus(velocity, &[vx, vy, vz]), &pair.offset);
        sums[0] = weight.mul_add(approach, sums[0]);
        let psi = self.diffusion.psi(own, pair, excess - *density, ids);
        sums[1] = weight.mul_add(psi, sums[1]);
        sums[2] = weight.mul_add(pair.r2, sums[2]);
    }

    #[inline(always)]
    fn mirrored(&self, (velocity, density, own): &Self::Own, signs: &Lanes3<L>) -> Self::Own {
        let own = self.diffusion.mirrored(own, signs);
        (signed(velocity, signs), *density, own)
    }

    #[inline(always)]
    fn mirror(&self, _: &mut [L; 3], _: &Lanes3<L>) {}

    #[inline(always)]
    fn finish(&self, a: usize, [flow, diffusion, crowding]: [L; 3], n_found: u32, out: &mut Rate) {
        *out = Rate {
            flow: self.own.density[a] * flow.sum(),
            diffusion: self.diffusion.strength() * diffusion.sum(),
            n_found,
            crowding: -crowding.sum(),
        };
    }
}

/// A density diffusion: `ψ_ab·(x_a − x_b)`, of which the sum is taken.
pub(crate) trait Diffusion<L: Lanes>: Sync {
    /// Values of the receiver.
    type Own: Copy;
    /// Whether [`Self::psi`] reads the indices of neighbors.
    const READS_IDS: bool = false;
    /// Those of receiver `a`.
    fn own(&self, machine: L::Machine, a: usize) -> Self::Own;
    /// Those of the receiver's mirror image, as in [`Term::mirrored`].
    fn mirrored(&self, own: &Self::Own, signs: &Lanes3<L>) -> Self::Own;
    /// `ψ_ab·(x_a − x_b)`; `jump` is `ρ_b − ρ_a`.
    fn psi(&self, own: &Self::Own, pair: &Pair<L>, jump: L, ids: &[u32]) -> L;
    /// `δ h c₀`; m²/s.
    fn strength(&self) -> f64;
}

/// No diffusion, at no cost.
pub(crate) struct NoDiffusion<L>(pub L);

impl<L: Lanes> Diffusion<L> for NoDiffusion<L> {
    type Own = ();

    #[inline(always)]
    fn own(&self, _: L::Machine, _: usize) {}

    #[inline(always)]
    fn mirrored(&self, (): &(), _: &Lanes3<L>) {}

    #[inline(always)]
    fn psi(&self, _: &(), _: &Pair<L>, _: L, _: &[u32]) -> L {
        self.0
    }

    #[inline(always)]
    fn strength(&self) -> f64 {
        0.0
    }
}

/// `ψ = 2 (ρ_b − ρ_a − ρ^H_ab)(x_b − x_a)/(r² + 0.01 h²)`, `ρ^H_ab = −ρ₀ g·x_ab/c₀²`.
///
/// With the hydrostatic part it is that of Fourtakas et al. (2019), whose power law of the equation of
/// state differs by the squared Mach number; without gravity that of Molteni & Colagrossi (2009).
pub(crate) struct JumpDiffusion<L> {
    /// `−ρ₀ g/c₀²`; kg/m⁴.
    hydrostatic: Lanes3<L>,
    softening: L,
    minus_two: L,
    strength: f64,
}

impl<L: Lanes> JumpDiffusion<L> {
    pub(crate) fn new(
        machine: L::Machine,
        hydrostatic: Vec3,
        smoothing_length: f64,
        strength: f64,
    ) -> Self {
        Self {
            hydrostatic: splat3(machine, hydrostatic.into()),
            softening: L::splat(machine, 0.01 * smoothing_length * smoothing_length),
            minus_two: L::splat(machine, -2.0),
            strength,
        }
    }
}

impl<L: Lanes> Diffusion<L> for JumpDiffusion<L> {
    type Own = ();

    #[inline(always)]
    fn own(&self, _: L::Machine, _: usize) {}

    #[inline(always)]
    fn mirrored(&self, (): &(), _: &Lanes3<L>) {}

    #[inline(always)]
    fn psi(&self, _: &(), pair: &Pair<L>, jump: L, _: &[u32]) -> L {
        let dynamic = jump - dot(&self.hydrostatic, &pair.offset);
        self.minus_two * dynamic * (pair.r2 / (pair.r2 + self.softening))
    }

    #[inline(always)]
    fn strength(&self) -> f64 {
        self.strength
    }
}

/// `ψ = 2 (ρ_b − ρ_a)(x_b − x_a)/(r² + 0.01 h²) − (∇ρ_a + ∇ρ_b)`, renormalized gradients.
///
/// Antuono et al. (2010), Eq. 5.
pub(crate) struct GradientDiffusion<'a, L: Lanes> {
    jump: JumpDiffusion<L>,
    /// Gradients of density, three values a record; kg/m⁴.
    gradients: &'a [L::Record],
    machine: L::Machine,
}

impl<'a, L: Lanes> GradientDiffusion<'a, L> {
    pub(crate) fn new(
        machine: L::Machine,
        smoothing_length: f64,
        strength: f64,
        gradients: &'a [L::Record],
    ) -> Self {
        Self {
            jump: JumpDiffusion::new(machine, Vec3::zeros(), smoothing_length, strength),
            gradients,
            machine,
        }
    }
}

impl<L: Lanes> Diffusion<L> for GradientDiffusion<'_, L> {
    type Own = Lanes3<L>;
    const READS_IDS: bool = true;

    #[inline(always)]
    fn own(&self, machine: L::Machine, a: usize) -> Lanes3<L> {
        use crate::simd::lanes::Record;
        let g = &self.gradients[a];
        splat3(machine, [g.value(0), g.value(1), g.value(2)])
    }

    #[inline(always)]
    fn mirrored(&self, gradient: &Lanes3<L>, signs: &Lanes3<L>) -> Lanes3<L> {
        signed(gradient, signs)
    }

    #[inline(always)]
    fn psi(&self, own: &Lanes3<L>, pair: &Pair<L>, jump: L, ids: &[u32]) -> L {
        let [gx, gy, gz, ..]: [L; RECORD] = L::gather(self.machine, self.gradients, ids);
        let both = [own[0] + gx, own[1] + gy, own[2] + gz];
        self.jump.psi(&(), pair, jump, ids) - dot(&both, &pair.offset)
    }

    #[inline(always)]
    fn strength(&self) -> f64 {
        self.jump.strength
    }
}

/// Any diffusion, chosen at run time.
pub(crate) enum AnyDiffusion<'a, L: Lanes> {
    None(NoDiffusion<L>),
    Jump(JumpDiffusion<L>),
    Gradient(GradientDiffusion<'a, L>),
}

impl<L: Lanes> Diffusion<L> for AnyDiffusion<'_, L> {
    /// Gradient of density, where it is used.
    type Own = Lanes3<L>;
    const READS_IDS: bool = true;

    #[inline(always)]
    fn own(&self, machine: L::Machine, a: usize) -> Lanes3<L> {
        match self {
            Self::None(_) | Self::Jump(_) => splat3(machine, [0.0; 3]),
            Self::Gradient(diffusion) => diffusion.own(machine, a),
        }
    }

    #[inline(always)]
    fn mirrored(&self, own: &Lanes3<L>, signs: &Lanes3<L>) -> Lanes3<L> {
        signed(own, signs)
    }

    #[inline(always)]
    fn psi(&self, own: &Lanes3<L>, pair: &Pair<L>, jump: L, ids: &[u32]) -> L {
        match self {
            Self::None(diffusion) => diffusion.psi(&(), pair, jump, ids),
            Self::Jump(diffusion) => diffusion.psi(&(), pair, jump, ids),
            Self::Gradient(diffusion) => diffusion.psi(own, pair, jump, ids),
        }
    }

    #[inline(always)]
    fn strength(&self) -> f64 {
        match self {
            Self::None(diffusion) => Diffusion::<L>::strength(diffusion),
            Self::Jump(diffusion) => diffusion.strength,
            Self::Gradient(diffusion) => diffusion.jump.strength,
        }
    }
}
