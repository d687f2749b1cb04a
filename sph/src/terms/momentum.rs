//! Forces of pressure and viscosity.
//!
//! Records hold velocity, pressure and volume.

use crate::Vec3;
use crate::kernel::{PairKernel, Viscous};
use crate::neighbors::sweep::{Pair, Term};
use crate::simd::lanes::{Lanes, RECORD, Record};
use crate::terms::{Lanes3, add_scaled, dot, minus, signed, splat3, totals};

/// Force per volume of the receiver.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ForceDensity {
    /// Of pressure; N/m³.
    pub pressure: [f64; 3],
    /// Of viscosity; N/m³.
    pub viscous: [f64; 3],
}

impl ForceDensity {
    /// Forces of pressure and viscosity on a volume (m³); N.
    pub(crate) fn times(&self, volume: f64) -> [Vec3; 2] {
        [self.pressure, self.viscous].map(|f| Vec3::from(f) * volume)
    }
}

/// Receivers, one slot per particle.
#[derive(Clone, Copy)]
pub(crate) struct ForceOwn<'a> {
    pub velocity: &'a [Vec3],
    pub pressure: &'a [f64],
}

/// `f_a = −Σ V_b p_ab ∇W + viscous`, `p_ab` the pressure of the pair.
pub(crate) struct Momentum<'a, L, K, P, V> {
    kernel: K,
    pair_pressure: P,
    viscosity: V,
    own: ForceOwn<'a>,
    zero: L,
}

impl<'a, L, K, P, V> Momentum<'a, L, K, P, V>
where
    L: Lanes,
    K: PairKernel<L>,
    P: PairPressure<L>,
    V: PairViscosity<L>,
{
    pub(crate) fn new(
        machine: L::Machine,
        kernel: K,
        pair_pressure: P,
        viscosity: V,
        own: ForceOwn<'a>,
    ) -> Self {
        Self {
            kernel,
            pair_pressure,
            viscosity,
            own,
            zero: L::splat(machine, 0.0),
        }
    }
}

impl<L, K, P, V> Term<L> for Momentum<'_, L, K, P, V>
where
    L: Lanes,
    K: PairKernel<L>,
    P: PairPressure<L>,
    V: PairViscosity<L>,
{
    type Own = (Lanes3<L>, L, V::Own);
    type Sums = [Lanes3<L>; 2];
    type Out = ForceDensity;
    const READS_IDS: bool = V::READS_IDS;
    const COUNTS: bool = false;

    #[inline(always)]
    fn own(&self, machine: L::Machine, a: usize) -> Self::Own {
        // walls at rest have none
        let velocity = self.own.velocity.get(a);
        (
            splat3(machine, velocity.copied().unwrap_or_default().into()),
            L::splat(machine, self.own.pressure[a]),
            self.viscosity.own(machine, a),
        )
    }

    #[inline(always)]
    fn zero(&self, _: L::Machine) -> Self::Sums {
        [[self.zero; 3]; 2]
    }

    #[inline(always)]
    fn add(
        &self,
        (velocity, pressure, own): &Self::Own,
        pair: &Pair<L>,
        ids: &[u32],
        [by_pressure, by_viscosity]: &mut Self::Sums,
    ) {
        let [vx, vy, vz, neighbor, volume] = pair.b;
        let weight = volume * self.kernel.gradient_factor(pair.r2);
        let joint = self.pair_pressure.of(*pressure, neighbor);
        add_scaled(by_pressure, weight * joint, &pair.offset);
        let jump = minus(velocity, &[vx, vy, vz]);
        let sheared = Sheared {
            pair,
            jump,
            volume,
            weight,
            ids,
        };
        self.viscosity.add(own, &sheared, by_viscosity);
    }

    #[inline(always)]
    fn mirrored(&self, (velocity, pressure, own): &Self::Own, signs: &Lanes3<L>) -> Self::Own {
        // the receiver's quantity in a viscous force is a scalar
        (signed(velocity, signs), *pressure, *own)
    }

    #[inline(always)]
    fn mirror(&self, [pressure, viscous]: &mut Self::Sums, signs: &Lanes3<L>) {
        *pressure = signed(pressure, signs);
        *viscous = signed(viscous, signs);
    }

    #[inline(always)]
    fn finish(&self, _: usize, sums: Self::Sums, _: u32, out: &mut ForceDensity) {
        let [pressure, viscous] = sums;
        *out = ForceDensity {
            pressure: totals(pressure).map(|f| -f),
            viscous: totals(viscous),
        };
    }
}

/// Pressure that a pair shares.
pub(crate) trait PairPressure<L>: Sync {
    /// `p_ab` from the two.
    fn of(&self, a: L, b: L) -> L;
}

/// `p_a + p_b`: with the continuity sum of the same kernel the scheme keeps its energy exactly.
///
/// The published pair term is the mean. Round a particle the p_a part cancels, so the mean yields
/// half the gradient, and water at rest would show twice the hydrostatic pressure. The published
/// stiffness is free, so the same forces follow from `k = 2c₀²` in the mean or from
/// `p = c₀²(ρ − ρ₀)` in the sum; the sum is used, and `p` is the pressure. In print Eq. 14 of Geraili
/// Mikola & Sitar (2014) has a minus between the pressures, which would break action = reaction.
pub(crate) struct SumOfPressures;

impl<L: Lanes> PairPressure<L> for SumOfPressures {
    #[inline(always)]
    fn of(&self, a: L, b: L) -> L {
        a + b
    }
}

/// `2 (ρ_b p_a + ρ_a p_b)/(ρ_a + ρ_b)`, `ρ = ρ₀ + p/c₀²`: the pressure of a face between fluid and wall.
///
/// Adami, Hu & Adams (2012), Eq. 11, in volumes.
pub(crate) struct WeightedByDensity<L> {
    reference_density: L,
    inverse_c2: L,
    two: L,
}

impl<L: Lanes> WeightedByDensity<L> {
    pub(crate) fn new(machine: L::Machine, reference_density: f64, sound_speed: f64) -> Self {
        Self {
            reference_density: L::splat(machine, reference_density),
            inverse_c2: L::splat(machine, 1.0 / (sound_speed * sound_speed)),
            two: L::splat(machine, 2.0),
        }
    }
}

impl<L: Lanes> PairPressure<L> for WeightedByDensity<L> {
    #[inline(always)]
    fn of(&self, a: L, b: L) -> L {
        let density = |p: L| p.mul_add(self.inverse_c2, self.reference_density);
        let (rho_a, rho_b) = (density(a), density(b));
        self.two * (rho_b * a + rho_a * b) / (rho_a + rho_b)
    }
}

/// Pair quantities of a viscous force in a register.
pub(crate) struct Sheared<'a, L> {
    pub pair: &'a Pair<L>,
    /// `v_a − v_b`; m/s.
    pub jump: Lanes3<L>,
    /// `V_b`; m³.
    pub volume: L,
    /// `V_b W'/r`.
    pub weight: L,
    /// Indices of the neighbors.
    pub ids: &'a [u32],
}

/// A viscous force of a pair.
pub(crate) trait PairViscosity<L: Lanes>: Sync {
    /// Values of the receiver; scalars, the same for its mirror image.
    type Own: Copy;
    /// Whether [`Self::add`] reads the indices of neighbors.
    const READS_IDS: bool = false;
    /// Those of receiver `a`.
    fn own(&self, machine: L::Machine, a: usize) -> Self::Own;
    /// Adds the force per volume of the receiver.
    fn add(&self, own: &Self::Own, sheared: &Sheared<L>, sum: &mut Lanes3<L>);
}

/// Along the line of centers: Monaghan's artificial and the laminar viscosity.
///
/// ```text
/// f_a = c Σ V_b (v_ab·x_ab)/(r² + 0.01 h²) ∇W
/// artificial  c = ρ₀ α c₀ h, approaching pairs only     laminar  c = 2 (d + 2) ρ₀ ν
/// ```
/// The mean density of the pair is taken as ρ₀, which keeps the force symmetric; they differ by the
/// squared Mach number. Source: Monaghan (1994, 2005).
pub(crate) struct Central<L, const APPROACHING: bool> {
    coefficient: L,
    softening: L,
    zero: L,
}

impl<L: Lanes, const APPROACHING: bool> Central<L, APPROACHING> {
    pub(crate) fn new(machine: L::Machine, coefficient: f64, smoothing_length: f64) -> Self {
        Self {
            coefficient: L::splat(machine, coefficient),
            softening: L::splat(machine, 0.01 * smoothing_length * smoothing_length),
            zero: L::splat(machine, 0.0),
        }
    }
}

impl<L: Lanes, const APPROACHING: bool> PairViscosity<L> for Central<L, APPROACHING> {
    type Own = ();

    #[inline(always)]
    fn own(&self, _: L::Machine, _: usize) {}

    #[inline(always)]
    fn add(&self, (): &(), sheared: &Sheared<L>, sum: &mut Lanes3<L>) {
        let pair = sheared.pair;
        let mut opening = dot(&sheared.jump, &pair.offset);
        if APPROACHING {
            opening = opening.min(self.zero);
        }
        let factor = self.coefficient * sheared.weight * (opening / (pair.r2 + self.softening));
        add_scaled(sum, factor, &pair.offset);
    }
}

/// Along the difference of velocities: Morris, Fox & Zhu (1997), Eq. 22.
///
/// ```text
/// f_a = 2 ρ₀ ν Σ V_b (x_ab·∇W)/(r² + 0.01 h²) v_ab
/// ```
pub(crate) struct Shear<L> {
    coefficient: L,
    softening: L,
}

impl<L: Lanes> Shear<L> {
    pub(crate) fn new(machine: L::Machine, coefficient: f64, smoothing_length: f64) -> Self {
        Self {
            coefficient: L::splat(machine, coefficient),
            softening: L::splat(machine, 0.01 * smoothing_length * smoothing_length),
        }
    }
}

impl<L: Lanes> PairViscosity<L> for Shear<L> {
    type Own = ();

    #[inline(always)]
    fn own(&self, _: L::Machine, _: usize) {}

    #[inline(always)]
    fn add(&self, (): &(), sheared: &Sheared<L>, sum: &mut Lanes3<L>) {
        let r2 = sheared.pair.r2;
        let factor = self.coefficient * sheared.weight * (r2 / (r2 + self.softening));
        add_scaled(sum, factor, &sheared.jump);
    }
}

/// Shear with viscosities of particles; a pair takes the harmonic mean, the stress of two
/// layers in series.
///
/// ```text
/// f_a = 2 Σ V_b η_ab (x_ab·∇W)/(r² + 0.01 h²) v_ab,   η_ab = 2 η_a η_b/(η_a + η_b)
/// ```
/// Towards a wall, which has no viscosity, it is that of the particle: `OF_RECEIVER` alone for the force on
/// the particle, `OF_NEIGHBOR` alone for that on the wall. Source: Cleary (1998) for the mean.
pub(crate) struct VariableShear<'a, L: Lanes, const OF_RECEIVER: bool, const OF_NEIGHBOR: bool> {
    /// `η` first in each record; Pa s.
    viscosities: &'a [L::Record],
    softening: L,
    two: L,
    four: L,
    machine: L::Machine,
}

/// Smallest viscosity of a receiver: two particles without any share none; Pa s.
const SMALLEST_VISCOSITY: f64 = 1e-30;

impl<'a, L: Lanes, const OF_RECEIVER: bool, const OF_NEIGHBOR: bool>
    VariableShear<'a, L, OF_RECEIVER, OF_NEIGHBOR>
{
    pub(crate) fn new(
        machine: L::Machine,
        viscosities: &'a [L::Record],
        smoothing_length: f64,
    ) -> Self {
        Self {
            viscosities,
            softening: L::splat(machine, 0.01 * smoothing_length * smoothing_length),
            two: L::splat(machine, 2.0),
            four: L::splat(machine, 4.0),
            machine,
        }
    }
}

impl<L: Lanes, const OF_RECEIVER: bool, const OF_NEIGHBOR: bool> PairViscosity<L>
    for VariableShear<'_, L, OF_RECEIVER, OF_NEIGHBOR>
{
    type Own = L;
    const READS_IDS: bool = OF_NEIGHBOR;

    #[inline(always)]
    fn own(&self, machine: L::Machine, a: usize) -> L {
        let viscosity = if OF_RECEIVER {
            self.viscosities[a].value(0).max(SMALLEST_VISCOSITY)
        } else {
            0.0
        };
        L::splat(machine, viscosity)
    }

    #[inline(always)]
    fn add(&self, own: &L, sheared: &Sheared<L>, sum: &mut Lanes3<L>) {
        let r2 = sheared.pair.r2;
        let (dividend, divisor) = if OF_NEIGHBOR {
            let [neighbor, ..]: [L; RECORD] =
                L::gather(self.machine, self.viscosities, sheared.ids);
            if OF_RECEIVER {
                (self.four * *own * neighbor, *own + neighbor)
            } else {
                (self.two * neighbor, L::splat(self.machine, 1.0))
            }
        } else {
            (self.two * *own, L::splat(self.machine, 1.0))
        };
        let factor = sheared.weight * (dividend * r2) / (divisor * (r2 + self.softening));
        add_scaled(sum, factor, &sheared.jump);
    }
}

/// The published form: `f_a = μ Σ V_b (v_b − v_a) ∇²W`, `∇²W = 45/(π H⁶)(H − r)`.
///
/// Eq. 18 of Geraili Mikola & Sitar (2014) prints v_a − v_b, a negative viscosity.
pub(crate) struct Published<L> {
    /// `−45 μ/(π H⁶)`, see [`Viscous`].
    coefficient: L,
    support: L,
    zero: L,
}

impl<L: Lanes> Published<L> {
    pub(crate) fn new(machine: L::Machine, dynamic_viscosity: f64, kernel: &Viscous) -> Self {
        Self {
            coefficient: L::splat(machine, -dynamic_viscosity * kernel.factor()),
            support: L::splat(machine, kernel.support_radius()),
            zero: L::splat(machine, 0.0),
        }
    }
}

impl<L: Lanes> PairViscosity<L> for Published<L> {
    type Own = ();

    #[inline(always)]
    fn own(&self, _: L::Machine, _: usize) {}

    #[inline(always)]
    fn add(&self, (): &(), sheared: &Sheared<L>, sum: &mut Lanes3<L>) {
        let left = (self.support - sheared.pair.r2.sqrt()).max(self.zero);
        add_scaled(sum, self.coefficient * sheared.volume * left, &sheared.jump);
    }
}

/// Any viscosity that is the same for all particles, chosen at run time.
pub(crate) enum AnyViscosity<L> {
    Inviscid,
    Artificial(Central<L, true>),
    Laminar(Central<L, false>),
    Shear(Shear<L>),
    Published(Published<L>),
}

impl<L: Lanes> PairViscosity<L> for AnyViscosity<L> {
    type Own = ();

    #[inline(always)]
    fn own(&self, _: L::Machine, _: usize) {}

    #[inline(always)]
    fn add(&self, (): &(), sheared: &Sheared<L>, sum: &mut Lanes3<L>) {
        match self {
            Self::Inviscid => {}
            Self::Artificial(viscosity) => viscosity.add(&(), sheared, sum),
            Self::Laminar(viscosity) => viscosity.add(&(), sheared, sum),
            Self::Shear(viscosity) => viscosity.add(&(), sheared, sum),
            Self::Published(viscosity) => viscosity.add(&(), sheared, sum),
        }
    }
}
