//! Vectors of three registers.

use super::lanes::Lanes;

/// Three registers.
pub(crate) type Lanes3<L> = [L; 3];

/// `a·b`.
#[inline(always)]
pub(crate) fn dot<L: Lanes>(a: &Lanes3<L>, b: &Lanes3<L>) -> L {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

/// `sum += factor · v`.
#[inline(always)]
pub(crate) fn add_scaled<L: Lanes>(sum: &mut Lanes3<L>, factor: L, v: &Lanes3<L>) {
    for axis in 0..3 {
        sum[axis] = factor.mul_add(v[axis], sum[axis]);
    }
}

/// `a − b`.
#[inline(always)]
pub(crate) fn minus<L: Lanes>(a: &Lanes3<L>, b: &Lanes3<L>) -> Lanes3<L> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Reverses components: `signs` are −1 or 1.
#[inline(always)]
pub(crate) fn signed<L: Lanes>(v: &Lanes3<L>, signs: &Lanes3<L>) -> Lanes3<L> {
    [v[0] * signs[0], v[1] * signs[1], v[2] * signs[2]]
}

/// The sums over lanes of three registers.
#[inline(always)]
pub(crate) fn totals<L: Lanes>(sums: Lanes3<L>) -> [f64; 3] {
    [sums[0].sum(), sums[1].sum(), sums[2].sum()]
}

/// Three numbers, each in all lanes.
#[inline(always)]
pub(crate) fn splat3<L: Lanes>(machine: L::Machine, v: [f64; 3]) -> Lanes3<L> {
    [
        L::splat(machine, v[0]),
        L::splat(machine, v[1]),
        L::splat(machine, v[2]),
    ]
}
