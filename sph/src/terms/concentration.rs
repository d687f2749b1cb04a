//! Gradient of the particle concentration, and proximity to the free surface.

use crate::kernel::PairKernel;
use crate::neighbors::sweep::{Pair, Term};
use crate::simd::lanes::Lanes;
use crate::terms::{Lanes3, add_scaled, signed, totals};

/// Concentration of the neighbors of a particle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Concentration {
    /// `∇C = Σ V_b ∇W`; 1/m.
    pub gradient: [f64; 3],
    /// `∇·x = −Σ V_b x·∇W`: the number of dimensions inside, half of it at a plane surface.
    pub divergence: f64,
}

impl std::ops::AddAssign for Concentration {
    fn add_assign(&mut self, other: Self) {
        for axis in 0..3 {
            self.gradient[axis] += other.gradient[axis];
        }
        self.divergence += other.divergence;
    }
}

/// The sums of [`Concentration`]. Records hold the volume last.
pub(crate) struct ConcentrationTerm<L, K> {
    kernel: K,
    zero: L,
}

impl<L: Lanes, K: PairKernel<L>> ConcentrationTerm<L, K> {
    pub(crate) fn new(machine: L::Machine, kernel: K) -> Self {
        Self {
            kernel,
            zero: L::splat(machine, 0.0),
        }
    }
}

impl<L: Lanes, K: PairKernel<L>> Term<L> for ConcentrationTerm<L, K> {
    type Own = ();
    type Sums = (Lanes3<L>, L);
    type Out = Concentration;
    const READS_IDS: bool = false;
    const COUNTS: bool = false;

    #[inline(always)]
    fn own(&self, _: L::Machine, _: usize) {}

    #[inline(always)]
    fn zero(&self, _: L::Machine) -> Self::Sums {
        ([self.zero; 3], self.zero)
    }

    #[inline(always)]
    fn add(&self, _: &(), pair: &Pair<L>, _: &[u32], (gradient, divergence): &mut Self::Sums) {
        let weight = pair.b[4] * self.kernel.gradient_factor(pair.r2);
        add_scaled(gradient, weight, &pair.offset);
        *divergence = weight.mul_add(pair.r2, *divergence);
    }

    #[inline(always)]
    fn mirrored(&self, (): &(), _: &Lanes3<L>) {}

    #[inline(always)]
    fn mirror(&self, (gradient, _): &mut Self::Sums, signs: &Lanes3<L>) {
        *gradient = signed(gradient, signs);
    }

    #[inline(always)]
    fn finish(
        &self,
        _: usize,
        (gradient, divergence): Self::Sums,
        _: u32,
        out: &mut Concentration,
    ) {
        *out = Concentration {
            gradient: totals(gradient),
            divergence: -divergence.sum(),
        };
    }
}
