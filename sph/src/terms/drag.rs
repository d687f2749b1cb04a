//! Viscous force of a field of velocities, without pressure: the product of an implicit viscous step.
//!
//! Records hold velocity in their first three places and volume in the last.

use crate::Vec3;
use crate::kernel::PairKernel;
use crate::neighbors::sweep::{Pair, Term};
use crate::simd::lanes::Lanes;
use crate::terms::momentum::{PairViscosity, Sheared};
use crate::terms::{Lanes3, minus, signed, splat3, totals};

/// Velocities of the receivers; m/s.
#[derive(Clone, Copy)]
pub(crate) enum DragOwn<'a> {
    /// One for each.
    Each(&'a [Vec3]),
    /// All at rest.
    AtRest,
    /// 1 m/s along x past neighbors at rest: the sum along x is minus the diagonal of the product, for viscosities whose force is along
    /// the difference of velocities.
    Unit,
}

/// Viscous force per volume of the receiver; N/m³.
pub(crate) struct Drag<'a, L, K, V> {
    kernel: K,
    viscosity: V,
    own: DragOwn<'a>,
    /// 0 where neighbors are at rest, 1 otherwise.
    moving: L,
    zero: L,
}

impl<'a, L, K, V> Drag<'a, L, K, V>
where
    L: Lanes,
    K: PairKernel<L>,
    V: PairViscosity<L>,
{
    pub(crate) fn new(machine: L::Machine, kernel: K, viscosity: V, own: DragOwn<'a>) -> Self {
        let moving = match own {
            DragOwn::Unit => 0.0,
            DragOwn::Each(_) | DragOwn::AtRest => 1.0,
        };
        Self {
            kernel,
            viscosity,
            own,
            moving: L::splat(machine, moving),
            zero: L::splat(machine, 0.0),
        }
    }
}

impl<L, K, V> Term<L> for Drag<'_, L, K, V>
where
    L: Lanes,
    K: PairKernel<L>,
    V: PairViscosity<L>,
{
    type Own = (Lanes3<L>, V::Own);
    type Sums = Lanes3<L>;
    type Out = [f64; 3];
    const READS_IDS: bool = V::READS_IDS;
    const COUNTS: bool = false;

    #[inline(always)]
    fn own(&self, machine: L::Machine, a: usize) -> Self::Own {
        let velocity = match self.own {
            DragOwn::Each(velocities) => velocities[a],
            DragOwn::AtRest => Vec3::zeros(),
            DragOwn::Unit => Vec3::x(),
        };
        (
            splat3(machine, velocity.into()),
            self.viscosity.own(machine, a),
        )
    }

    #[inline(always)]
    fn zero(&self, _: L::Machine) -> Self::Sums {
        [self.zero; 3]
    }

    #[inline(always)]
    fn add(&self, (velocity, own): &Self::Own, pair: &Pair<L>, ids: &[u32], sums: &mut Self::Sums) {
        let [vx, vy, vz, _, volume] = pair.b;
        let weight = volume * self.kernel.gradient_factor(pair.r2);
        let neighbor = [vx * self.moving, vy * self.moving, vz * self.moving];
        let sheared = Sheared {
            pair,
            jump: minus(velocity, &neighbor),
            volume,
            weight,
            ids,
        };
        self.viscosity.add(own, &sheared, sums);
    }

    #[inline(always)]
    fn mirrored(&self, (velocity, own): &Self::Own, signs: &Lanes3<L>) -> Self::Own {
        (signed(velocity, signs), *own)
    }

    #[inline(always)]
    fn mirror(&self, sums: &mut Self::Sums, signs: &Lanes3<L>) {
        *sums = signed(sums, signs);
    }

    #[inline(always)]
    fn finish(&self, _: usize, sums: Self::Sums, _: u32, out: &mut [f64; 3]) {
        *out = totals(sums);
    }
}
