//! The fluid's pressure and velocity continued into a wall.
//!
//! Records hold velocity, pressure and volume.

use crate::kernel::PairKernel;
use crate::neighbors::sweep::{Pair, Term};
use crate::simd::lanes::Lanes;
use crate::terms::{Lanes3, add_scaled, signed, totals};

/// Sums over the fluid near a point, each weighted with `V_f W`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Extrapolated {
    /// `Σ V W`: the share of the support that is fluid.
    pub weight: f64,
    /// `Σ p V W`; Pa.
    pub pressure: f64,
    /// `Σ ρ (x_w − x_f) V W`; kg/m².
    pub moment: [f64; 3],
    /// `Σ v V W`; m/s.
    pub velocity: [f64; 3],
    /// `Σ V ∇W`, where it was asked for; 1/m.
    pub slope: [f64; 3],
}

/// The sums of [`Extrapolated`], with the slope or without.
pub(crate) struct Extrapolation<L, K, const SLOPED: bool> {
    kernel: K,
    reference_density: L,
    inverse_c2: L,
    zero: L,
}

impl<L: Lanes, K: PairKernel<L>, const SLOPED: bool> Extrapolation<L, K, SLOPED> {
    pub(crate) fn new(
        machine: L::Machine,
        kernel: K,
        reference_density: f64,
        sound_speed: f64,
    ) -> Self {
        Self {
            kernel,
            reference_density: L::splat(machine, reference_density),
            inverse_c2: L::splat(machine, 1.0 / (sound_speed * sound_speed)),
            zero: L::splat(machine, 0.0),
        }
    }
}

/// Partial sums.
pub(crate) struct ExtrapolationSums<L> {
    weight: L,
    pressure: L,
    moment: Lanes3<L>,
    velocity: Lanes3<L>,
    slope: Lanes3<L>,
}

impl<L: Lanes, K: PairKernel<L>, const SLOPED: bool> Term<L> for Extrapolation<L, K, SLOPED> {
    type Own = ();
    type Sums = ExtrapolationSums<L>;
    type Out = Extrapolated;
    const READS_IDS: bool = false;
    const COUNTS: bool = false;

    #[inline(always)]
    fn own(&self, _: L::Machine, _: usize) {}

    #[inline(always)]
    fn zero(&self, _: L::Machine) -> Self::Sums {
        ExtrapolationSums {
            weight: self.zero,
            pressure: self.zero,
            moment: [self.zero; 3],
            velocity: [self.zero; 3],
            slope: [self.zero; 3],
        }
    }

    #[inline(always)]
    fn add(&self, _: &(), pair: &Pair<L>, _: &[u32], sums: &mut Self::Sums) {
        let [vx, vy, vz, pressure, volume] = pair.b;
        let weight = volume * self.kernel.value(pair.r2);
        sums.weight = sums.weight + weight;
        sums.pressure = weight.mul_add(pressure, sums.pressure);
        let density = pressure.mul_add(self.inverse_c2, self.reference_density);
        add_scaled(&mut sums.moment, weight * density, &pair.offset);
        add_scaled(&mut sums.velocity, weight, &[vx, vy, vz]);
        if SLOPED {
            let factor = volume * self.kernel.gradient_factor(pair.r2);
            add_scaled(&mut sums.slope, factor, &pair.offset);
        }
    }

    #[inline(always)]
    fn mirrored(&self, (): &(), _: &Lanes3<L>) {}

    #[inline(always)]
    fn mirror(&self, sums: &mut Self::Sums, signs: &Lanes3<L>) {
        sums.moment = signed(&sums.moment, signs);
        sums.velocity = signed(&sums.velocity, signs);
        if SLOPED {
            sums.slope = signed(&sums.slope, signs);
        }
    }

    #[inline(always)]
    fn finish(&self, _: usize, sums: Self::Sums, _: u32, out: &mut Extrapolated) {
        *out = Extrapolated {
            weight: sums.weight.sum(),
            pressure: sums.pressure.sum(),
            moment: totals(sums.moment),
            velocity: totals(sums.velocity),
            slope: if SLOPED { totals(sums.slope) } else { [0.0; 3] },
        };
    }
}
