//! Sums over pairs of grains and water, several quantities at a time.
//!
//! A dispatched task is compiled for wide registers with all that is inlined into it; closures are not, and quantities are plain arrays
//! for that reason.

use pulp::{Arch, NullaryFnOnce};

/// A particle within the kernel of a grain.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub(super) water: u32,
    /// 1/m³.
    pub(super) kernel: f32,
}

/// Adds the values of a grain times the kernel to those of the particles of its list, counted from `first`.
pub(super) struct Spread<'a, const N: usize> {
    pub(super) list: &'a [Pair],
    pub(super) of_grain: [f64; N],
    pub(super) first: usize,
    pub(super) sums: &'a mut [[f64; N]],
}

impl<const N: usize> Spread<'_, N> {
    pub(super) fn run(self) {
        Arch::new().dispatch(self);
    }
}

impl<const N: usize> NullaryFnOnce for Spread<'_, N> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for pair in self.list {
            let kernel = f64::from(pair.kernel);
            let sums = &mut self.sums[pair.water as usize - self.first];
            for (sum, value) in sums.iter_mut().zip(&self.of_grain) {
                *sum += value * kernel;
            }
        }
    }
}

/// Sums the values of the particles of a list times the kernel, and the last of them times its square.
pub(super) struct Gather<'a, const N: usize> {
    pub(super) list: &'a [Pair],
    pub(super) values: &'a [[f64; N]],
}

impl<const N: usize> Gather<'_, N> {
    pub(super) fn run(self) -> ([f64; N], f64) {
        Arch::new().dispatch(self)
    }
}

impl<const N: usize> NullaryFnOnce for Gather<'_, N> {
    type Output = ([f64; N], f64);

    #[inline(always)]
    fn call(self) -> ([f64; N], f64) {
        let (mut sums, mut last_by_square) = ([0.0; N], 0.0);
        for pair in self.list {
            let kernel = f64::from(pair.kernel);
            let values = &self.values[pair.water as usize];
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum += value * kernel;
            }
            last_by_square += values[N - 1] * kernel * kernel;
        }
        (sums, last_by_square)
    }
}
