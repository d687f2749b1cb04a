//! Renormalised gradients of density and velocity.
//!
//! ```text
//! B_a = Σ V_b (x_b − x_a) ⊗ ∇W_ab,   ∇f_a = B_a⁻¹ Σ V_b (f_b − f_a) ∇W_ab
//! ```
//! exact for linear fields wherever `B` can be inverted.

use nalgebra::{Matrix3, Vector3};

use crate::Vec3;
use crate::kernel::{Dimensions, PairKernel};
use crate::neighbors::sweep::{Pair, Term};
use crate::simd::lanes::Lanes;
use crate::terms::{Lanes3, add_scaled, minus, signed, splat3, totals};

/// Determinant of `B` below which it is not inverted: at a spray of few particles. `B` is the unit
/// matrix inside.
const SMALLEST_DETERMINANT: f64 = 1e-2;

/// The inverse of `B` from the sums of [`add_moments`]; zero if singular.
fn renormalization(m: &[f64; 6], dimensions: Dimensions) -> Matrix3<f64> {
    let middle = match dimensions {
        Dimensions::Three => m[1],
        Dimensions::Two { .. } => 1.0,
    };
    let b = Matrix3::new(m[0], m[5], m[4], m[5], middle, m[3], m[4], m[3], m[2]);
    if SMALLEST_DETERMINANT < b.determinant() {
        b.try_inverse().unwrap_or_else(Matrix3::identity)
    } else {
        Matrix3::zeros()
    }
}

/// Adds to the upper half of `−B`: xx, yy, zz, yz, zx, xy; `w` is `V W'/r (x_a − x_b)`.
#[inline(always)]
fn add_moments<L: Lanes>(m: &mut [L; 6], [wx, wy, wz]: &Lanes3<L>, [x, y, z]: Lanes3<L>) {
    m[0] = wx.mul_add(x, m[0]);
    m[1] = wy.mul_add(y, m[1]);
    m[2] = wz.mul_add(z, m[2]);
    m[3] = wy.mul_add(z, m[3]);
    m[4] = wz.mul_add(x, m[4]);
    m[5] = wx.mul_add(y, m[5]);
}

/// Totals of what [`add_moments`] summed, with their sign; by hand, as `map` would be a call without the registers of its caller.
#[inline(always)]
fn moments_of<L: Lanes>([a, b, c, d, e, f]: [L; 6]) -> [f64; 6] {
    [-a.sum(), -b.sum(), -c.sum(), -d.sum(), -e.sum(), -f.sum()]
}

/// Mirrors what [`add_moments`] summed: yz, zx and xy change sign where one of the two axes is reversed.
#[inline(always)]
fn mirror_moments<L: Lanes>(m: &mut [L; 6], [sx, sy, sz]: &Lanes3<L>) {
    m[3] = m[3] * (*sy * *sz);
    m[4] = m[4] * (*sz * *sx);
    m[5] = m[5] * (*sx * *sy);
}

/// Sums of the density gradient; kg/m⁴. Records hold density minus the reference density, and volume.
pub(crate) struct Gradient<'a, L, K> {
    kernel: K,
    density: &'a [f64],
    reference_density: f64,
    dimensions: Dimensions,
    zero: L,
}

impl<'a, L: Lanes, K: PairKernel<L>> Gradient<'a, L, K> {
    pub(crate) fn new(
        machine: L::Machine,
        kernel: K,
        density: &'a [f64],
        reference_density: f64,
        dimensions: Dimensions,
    ) -> Self {
        Self {
            kernel,
            density,
            reference_density,
            dimensions,
            zero: L::splat(machine, 0.0),
        }
    }
}

impl<L: Lanes, K: PairKernel<L>> Term<L> for Gradient<'_, L, K> {
    type Own = L;
    type Sums = ([L; 6], Lanes3<L>);
    type Out = [f64; 3];
    const READS_IDS: bool = false;
    const COUNTS: bool = false;

    #[inline(always)]
    fn own(&self, machine: L::Machine, a: usize) -> L {
        L::splat(machine, self.density[a] - self.reference_density)
    }

    #[inline(always)]
    fn zero(&self, _: L::Machine) -> Self::Sums {
        ([self.zero; 6], [self.zero; 3])
    }

    #[inline(always)]
    fn add(&self, density: &L, pair: &Pair<L>, _: &[u32], (moments, gradient): &mut Self::Sums) {
        let [_, _, _, excess, volume] = pair.b;
        let weight = volume * self.kernel.gradient_factor(pair.r2);
        let [x, y, z] = pair.offset;
        let weighted = [weight * x, weight * y, weight * z];
        add_moments(moments, &weighted, pair.offset);
        add_scaled(gradient, excess - *density, &weighted);
    }

    #[inline(always)]
    fn mirrored(&self, density: &L, _: &Lanes3<L>) -> L {
        *density
    }

    #[inline(always)]
    fn mirror(&self, (moments, gradient): &mut Self::Sums, signs: &Lanes3<L>) {
        mirror_moments(moments, signs);
        *gradient = signed(gradient, signs);
    }

    #[inline(always)]
    fn finish(&self, _: usize, (moments, gradient): Self::Sums, _: u32, out: &mut [f64; 3]) {
        let inverse = renormalization(&moments_of(moments), self.dimensions);
        *out = (inverse * Vector3::from(totals(gradient))).into();
    }
}

/// Sums of a velocity gradient before renormalization: walls are added first.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct StrainSums {
    moments: [f64; 6],
    /// Row i is `Σ V_b (v_b − v_a)_i ∇W`; 1/s.
    velocity: [[f64; 3]; 3],
}

impl std::ops::AddAssign for StrainSums {
    fn add_assign(&mut self, other: Self) {
        let rows = self.velocity.iter_mut().zip(&other.velocity);
        let all = rows.flat_map(|(row, other)| row.iter_mut().zip(other));
        for (sum, x) in all.chain(self.moments.iter_mut().zip(&other.moments)) {
            *sum += x;
        }
    }
}

impl StrainSums {
    /// `Σ V_b (v_b − v_a) (∇W·n)` for a direction `n`; 1/s.
    pub(crate) fn difference_along(&self, direction: &Vec3) -> Vec3 {
        Vec3::from(self.velocity.map(|row| Vec3::from(row).dot(direction)))
    }

    /// `γ̇ = √(2 D:D)`, D the symmetric part of the renormalized gradient; 1/s.
    pub(crate) fn shear_rate(&self, dimensions: Dimensions) -> f64 {
        let inverse = renormalization(&self.moments, dimensions);
        let [x, y, z] = self.velocity.map(|row| inverse * Vector3::from(row));
        let diagonal = x.x * x.x + y.y * y.y + z.z * z.z;
        let (xy, yz, zx) = (x.y + y.x, y.z + z.y, z.x + x.z);
        (2.0 * diagonal + xy * xy + yz * yz + zx * zx).sqrt()
    }
}

/// [`StrainSums`] of velocity. Records hold velocity first and volume last.
pub(crate) struct Strain<'a, L, K> {
    kernel: K,
    velocity: &'a [Vec3],
    dimensions: Dimensions,
    zero: L,
}

impl<'a, L: Lanes, K: PairKernel<L>> Strain<'a, L, K> {
    pub(crate) fn new(
        machine: L::Machine,
        kernel: K,
        velocity: &'a [Vec3],
        dimensions: Dimensions,
    ) -> Self {
        Self {
            kernel,
            velocity,
            dimensions,
            zero: L::splat(machine, 0.0),
        }
    }
}

impl<L: Lanes, K: PairKernel<L>> Term<L> for Strain<'_, L, K> {
    type Own = Lanes3<L>;
    type Sums = ([L; 6], [Lanes3<L>; 3]);
    type Out = StrainSums;
    const READS_IDS: bool = false;
    const COUNTS: bool = false;

    #[inline(always)]
    fn own(&self, machine: L::Machine, a: usize) -> Lanes3<L> {
        splat3(machine, self.velocity[a].into())
    }

    #[inline(always)]
    fn zero(&self, _: L::Machine) -> Self::Sums {
        ([self.zero; 6], [[self.zero; 3]; 3])
    }

    #[inline(always)]
    fn add(
        &self,
        velocity: &Lanes3<L>,
        pair: &Pair<L>,
        _: &[u32],
        (moments, gradient): &mut Self::Sums,
    ) {
        let [vx, vy, vz, _, volume] = pair.b;
        let weight = volume * self.kernel.gradient_factor(pair.r2);
        let [x, y, z] = pair.offset;
        let weighted = [weight * x, weight * y, weight * z];
        add_moments(moments, &weighted, pair.offset);
        let jump = minus(&[vx, vy, vz], velocity);
        for (sum, jump) in gradient.iter_mut().zip(jump) {
            add_scaled(sum, jump, &weighted);
        }
    }

    #[inline(always)]
    fn mirrored(&self, velocity: &Lanes3<L>, signs: &Lanes3<L>) -> Lanes3<L> {
        signed(velocity, signs)
    }

    #[inline(always)]
    fn mirror(&self, (moments, gradient): &mut Self::Sums, signs: &Lanes3<L>) {
        mirror_moments(moments, signs);
        for axis in 0..3 {
            let row = signed(&gradient[axis], signs);
            gradient[axis] = [
                row[0] * signs[axis],
                row[1] * signs[axis],
                row[2] * signs[axis],
            ];
        }
    }

    #[inline(always)]
    fn finish(&self, _: usize, (m, v): Self::Sums, _: u32, out: &mut StrainSums) {
        // horizontal sums of lanes are a large part of the cost: in two dimensions eight of the fifteen sums are zero
        *out = match self.dimensions {
            Dimensions::Three => StrainSums {
                moments: moments_of(m),
                velocity: [totals(v[0]), totals(v[1]), totals(v[2])],
            },
            Dimensions::Two { .. } => StrainSums {
                moments: [-m[0].sum(), 0.0, -m[2].sum(), 0.0, -m[4].sum(), 0.0],
                velocity: [
                    [v[0][0].sum(), 0.0, v[0][2].sum()],
                    [0.0; 3],
                    [v[2][0].sum(), 0.0, v[2][2].sum()],
                ],
            },
        };
    }
}
