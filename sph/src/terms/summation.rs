//! Density by summation.

use crate::kernel::PairKernel;
use crate::neighbors::sweep::{Pair, Term};
use crate::simd::lanes::Lanes;
use crate::terms::Lanes3;

/// `Σ_b m_b W_ab`, b = a included; kg/m³. Records hold the mass instead of the volume.
///
/// Geraili Mikola & Sitar (2014), Eq. 12 sums over the wrong index in print.
pub(crate) struct Summation<L, K> {
    kernel: K,
    zero: L,
}

impl<L: Lanes, K: PairKernel<L>> Summation<L, K> {
    pub(crate) fn new(machine: L::Machine, kernel: K) -> Self {
        Self {
            kernel,
            zero: L::splat(machine, 0.0),
        }
    }
}

impl<L: Lanes, K: PairKernel<L>> Term<L> for Summation<L, K> {
    type Own = ();
    type Sums = L;
    type Out = f64;
    const READS_IDS: bool = false;
    const COUNTS: bool = true;

    #[inline(always)]
    fn own(&self, _: L::Machine, _: usize) {}

    #[inline(always)]
    fn zero(&self, _: L::Machine) -> L {
        self.zero
    }

    #[inline(always)]
    fn add(&self, _: &(), pair: &Pair<L>, _: &[u32], sum: &mut L) {
        *sum = pair.b[4].mul_add(self.kernel.value(pair.r2), *sum);
    }

    #[inline(always)]
    fn mirrored(&self, (): &(), _: &Lanes3<L>) {}

    #[inline(always)]
    fn mirror(&self, _: &mut L, _: &Lanes3<L>) {}

    #[inline(always)]
    fn finish(&self, _: usize, sum: L, _: u32, out: &mut f64) {
        *out = sum.sum();
    }
}
