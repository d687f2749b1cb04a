//! Renormalised gradients of density and velocity.
//!
//! ```text
//! B_a = Σ V_b (x_b − x_a) ⊗ ∇W_ab,   ∇f_a = B_a⁻¹ Σ V_b (f_b − f_a) ∇W_ab
//! ```
//! exact for linear fields wherever `B` can be inverted. Records hold velocity, density less the
//! reference density, and volume.

use nalgebra::{Matrix3, Vector3};

use crate::kernel::{Dimensions, PairKernel};
use crate::lanes::Lanes;
use crate::sweep::{Pair, Term};
use crate::terms::continuity::RateOwn;
use crate::terms::{Lanes3, add_scaled, minus, splat3, totals};

/// Determinant of `B` below which it is not inverted: at a spray of few particles. `B` is the unit
/// matrix inside.
const SMALLEST_DETERMINANT: f64 = 1e-2;

/// Gradients at a particle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gradients {
    /// kg/m⁴.
    pub density: Vector3<f64>,
    /// `∂v_i/∂x_j`; 1/s.
    pub velocity: Matrix3<f64>,
}

impl Default for Gradients {
    fn default() -> Self {
        Self {
            density: Vector3::zeros(),
            velocity: Matrix3::zeros(),
        }
    }
}

/// The sums of both gradients; `VELOCITY` includes that of velocity.
pub(crate) struct Gradient<'a, L, K, const VELOCITY: bool> {
    kernel: K,
    own: RateOwn<'a>,
    reference_density: f64,
    dimensions: Dimensions,
    zero: L,
}

impl<'a, L: Lanes, K: PairKernel<L>, const VELOCITY: bool> Gradient<'a, L, K, VELOCITY> {
    pub(crate) fn new(
        machine: L::Machine,
        kernel: K,
        own: RateOwn<'a>,
        reference_density: f64,
        dimensions: Dimensions,
    ) -> Self {
        Self {
            kernel,
            own,
            reference_density,
            dimensions,
            zero: L::splat(machine, 0.0),
        }
    }
}

/// Sums of a gradient under way.
pub(crate) struct GradientSums<L> {
    /// Upper half of `−B`: xx, yy, zz, yz, zx, xy.
    moments: [L; 6],
    density: Lanes3<L>,
    velocity: [Lanes3<L>; 3],
}

impl<L: Lanes, K: PairKernel<L>, const VELOCITY: bool> Term<L> for Gradient<'_, L, K, VELOCITY> {
    type Own = (Lanes3<L>, L);
    type Sums = GradientSums<L>;
    type Out = Gradients;

    #[inline(always)]
    fn own(&self, machine: L::Machine, a: usize) -> Self::Own {
        (
            splat3(machine, self.own.velocity[a].into()),
            L::splat(machine, self.own.density[a] - self.reference_density),
        )
    }

    #[inline(always)]
    fn zero(&self, _: L::Machine) -> Self::Sums {
        GradientSums {
            moments: [self.zero; 6],
            density: [self.zero; 3],
            velocity: [[self.zero; 3]; 3],
        }
    }

    #[inline(always)]
    fn add(
        &self,
        (velocity, density): &Self::Own,
        pair: &Pair<L>,
        _: &[u32],
        sums: &mut Self::Sums,
    ) {
        let [vx, vy, vz, excess, volume] = pair.b;
        let weight = volume * self.kernel.gradient_factor(pair.r2);
        let [x, y, z] = pair.offset;
        let (wx, wy, wz) = (weight * x, weight * y, weight * z);
        let m = &mut sums.moments;
        m[0] = wx.mul_add(x, m[0]);
        m[1] = wy.mul_add(y, m[1]);
        m[2] = wz.mul_add(z, m[2]);
        m[3] = wy.mul_add(z, m[3]);
        m[4] = wz.mul_add(x, m[4]);
        m[5] = wx.mul_add(y, m[5]);
        let gradient = [wx, wy, wz];
        add_scaled(&mut sums.density, excess - *density, &gradient);
        if VELOCITY {
            let jump = minus(&[vx, vy, vz], velocity);
            for (sum, jump) in sums.velocity.iter_mut().zip(jump) {
                add_scaled(sum, jump, &gradient);
            }
        }
    }

    #[inline(always)]
    fn finish(&self, _: usize, sums: Self::Sums, _: u32, out: &mut Gradients) {
        let m = sums.moments.map(|lanes| -lanes.sum());
        let middle = match self.dimensions {
            Dimensions::Three => m[1],
            Dimensions::Two { .. } => 1.0,
        };
        let b = Matrix3::new(m[0], m[5], m[4], m[5], middle, m[3], m[4], m[3], m[2]);
        let inverse = if SMALLEST_DETERMINANT < b.determinant() {
            b.try_inverse().unwrap_or_else(Matrix3::identity)
        } else {
            Matrix3::zeros()
        };
        out.density = inverse * Vector3::from(totals(sums.density));
        if VELOCITY {
            for axis in 0..3 {
                let row = inverse * Vector3::from(totals(sums.velocity[axis]));
                out.velocity.set_row(axis, &row.transpose());
            }
        }
    }
}
