//! Several numbers at once: the arithmetic of pair loops in vector registers, chosen when the
//! program runs.
//!
//! A sum over neighbors is written once, over any [`Lanes`]; [`Machine`] says which registers this
//! processor has. With AVX2 and fused multiply-add a register holds eight `f32` or four `f64`; the
//! portable machine does the same work in arrays. Both add in the same order, but fused and
//! separate roundings differ in the last bits: results are the same bits on machines of one kind.

#[cfg(target_arch = "x86_64")]
mod avx2;

use std::ops::{Add, Div, Mul, Sub};

#[cfg(target_arch = "x86_64")]
pub(crate) use avx2::Avx2;

/// Values of a record: place (three), and what a sum reads of a neighbor (five).
pub(crate) const RECORD: usize = 8;
/// Most numbers of a register.
pub(crate) const MOST_LANES: usize = 8;
/// Candidates that the filter tests together; columns are padded by as many.
pub(crate) const FILTER_WIDTH: usize = 8;

/// Particle data read by a sum, in one cache line or half of one.
pub(crate) trait Record: Copy + Send + Sync {
    /// Coordinates in the frame of the sums, and five values.
    fn pack(place: &Place, values: [f64; 5]) -> Self;
    /// Record without position: additional values of a particle, of which sums use a subset.
    fn of_values(values: [f64; RECORD]) -> Self;
    /// A place from which no point of a frame is seen, without values.
    fn far() -> Self;
    /// A value as it is stored.
    fn value(&self, which: usize) -> f64;
    /// Quanta of the place, by those of a position (m).
    fn quanta(&self, of: impl Fn(&[f64; 3]) -> [i32; 3]) -> [i32; 3];
}

/// A position twice: in meters, and in the integers of the frame.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Place {
    /// m.
    pub meters: [f64; 3],
    /// Quanta of the frame; differences wrap.
    pub quanta: [i32; 3],
}

/// Single precision: 32 bytes. Coordinates are integers in disguise: differences are exact.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(32))]
pub(crate) struct Single([f32; RECORD]);

/// Double precision: 64 bytes.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(64))]
pub(crate) struct Double([f64; RECORD]);

impl Record for Single {
    #[inline(always)]
    fn far() -> Self {
        // half as far from both ends of the longest domain as integers wrap
        Self([
            f32::from_bits((-1_i32 << 30) as u32),
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
        ])
    }

    fn pack(place: &Place, values: [f64; 5]) -> Self {
        let [x, y, z] = place.quanta.map(|q| f32::from_bits(q as u32));
        let [a, b, c, d, e] = values.map(|v| v as f32);
        Self([x, y, z, a, b, c, d, e])
    }

    fn of_values(values: [f64; RECORD]) -> Self {
        Self(values.map(|v| v as f32))
    }

    fn value(&self, which: usize) -> f64 {
        f64::from(self.0[which])
    }

    #[inline(always)]
    fn quanta(&self, _: impl Fn(&[f64; 3]) -> [i32; 3]) -> [i32; 3] {
        let [x, y, z, ..] = self.0;
        [x, y, z].map(|bits| bits.to_bits() as i32)
    }
}

impl Record for Double {
    #[inline(always)]
    fn far() -> Self {
        Self([-1e15, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    }

    fn pack(place: &Place, values: [f64; 5]) -> Self {
        let [x, y, z] = place.meters;
        let [a, b, c, d, e] = values;
        Self([x, y, z, a, b, c, d, e])
    }

    fn of_values(values: [f64; RECORD]) -> Self {
        Self(values)
    }

    fn value(&self, which: usize) -> f64 {
        self.0[which]
    }

    #[inline(always)]
    fn quanta(&self, of: impl Fn(&[f64; 3]) -> [i32; 3]) -> [i32; 3] {
        let [x, y, z, ..] = self.0;
        of(&[x, y, z])
    }
}

/// Number of a record, in as many bits as a list has for it.
pub(crate) trait Index: Copy {
    /// Place among the records.
    fn index(self) -> usize;
}

impl Index for u8 {
    #[inline(always)]
    fn index(self) -> usize {
        usize::from(self)
    }
}

/// 16 bits, the lower half first.
impl Index for [u8; 2] {
    #[inline(always)]
    fn index(self) -> usize {
        usize::from(u16::from_le_bytes(self))
    }
}

impl Index for u32 {
    #[inline(always)]
    fn index(self) -> usize {
        self as usize
    }
}

/// A register of numbers and its arithmetic.
pub(crate) trait Lanes:
    Copy
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
{
    /// Numbers in a register.
    const WIDTH: usize;
    /// Whether sums are compiled for the usual terms one by one; without, they take their terms when they run.
    const IS_SPECIALIZED: bool;
    /// Proof that the processor has such registers.
    type Machine: Copy + Send + Sync;
    /// Records that fill it.
    type Record: Record;

    /// The same number in all lanes.
    fn splat(machine: Self::Machine, value: f64) -> Self;
    /// The first `WIDTH` numbers.
    fn load(machine: Self::Machine, values: &[f64]) -> Self;
    /// `self · b + c`.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// The larger, lane by lane.
    fn max(self, other: Self) -> Self;
    /// The smaller, lane by lane.
    fn min(self, other: Self) -> Self;
    /// Mask of lanes below those of a bound.
    fn below(self, bound: Self) -> u32;
    /// Sum over the lanes, in a fixed order.
    fn sum(self) -> f64;
    /// The records of `WIDTH` particles, one register per value.
    fn gather<I: Index>(
        machine: Self::Machine,
        records: &[Self::Record],
        ids: &[I],
    ) -> [Self; RECORD];
    /// One coordinate of a place, ready for [`Self::separation`].
    fn coordinate(machine: Self::Machine, place: &Place, axis: usize) -> Self;
    /// `self − other` for coordinates; `scale` is the quantum in meters.
    fn separation(self, other: Self, scale: Self) -> Self;
}

/// Registers of a kind of processor.
pub(crate) trait Machine: Copy + Send + Sync {
    /// Single precision.
    type F32: Lanes<Machine = Self, Record = Single>;
    /// Double precision.
    type F64: Lanes<Machine = Self, Record = Double>;

    /// Runs `task` compiled for this machine; everything in it must be inlined.
    fn run<T: Task>(self, task: T);

    /// Appends the particles of `start..end` closer than the radius to `found`, from `n` on, numbered from a given number; returns
    /// the new end. Room for `FILTER_WIDTH` more must be left.
    fn filter(
        self,
        columns: [&[i32]; 3],
        candidates: (std::ops::Range<usize>, u32),
        from: &FilterSphere,
        found: &mut [u32],
        n: usize,
    ) -> usize;
}

/// Work that a machine runs.
pub(crate) trait Task {
    /// Runs the task with this instruction set.
    fn run(self);
}

/// Sphere within which a filter keeps points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FilterSphere {
    /// Quanta.
    pub place: [i32; 3],
    /// Meters per quantum.
    pub scale: [f32; 3],
    /// Squared radius; m².
    pub radius2: f32,
}

/// Any processor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Portable;

/// Arrays in the place of registers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Array<T, const N: usize>([T; N]);

macro_rules! portable {
    ($scalar:ty, $width:literal, $record:ty, $separation:expr, $coordinate:expr) => {
        portable!(operator $scalar, $width, Add, add, +);
        portable!(operator $scalar, $width, Sub, sub, -);
        portable!(operator $scalar, $width, Mul, mul, *);
        portable!(operator $scalar, $width, Div, div, /);

        impl Array<$scalar, $width> {
            #[inline(always)]
            fn zip(self, other: Self, f: impl Fn($scalar, $scalar) -> $scalar) -> Self {
                Self(std::array::from_fn(|lane| f(self.0[lane], other.0[lane])))
            }
        }

        impl Lanes for Array<$scalar, $width> {
            const WIDTH: usize = $width;
            const IS_SPECIALIZED: bool = false;
            type Machine = Portable;
            type Record = $record;

            #[inline(always)]
            fn splat(_: Portable, value: f64) -> Self {
                Self([value as $scalar; $width])
            }

            #[inline(always)]
            fn load(_: Portable, values: &[f64]) -> Self {
                Self(std::array::from_fn(|lane| values[lane] as $scalar))
            }

            #[inline(always)]
            fn mul_add(self, b: Self, c: Self) -> Self {
                self * b + c
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                Self(self.0.map(<$scalar>::sqrt))
            }

            #[inline(always)]
            fn max(self, other: Self) -> Self {
                self.zip(other, <$scalar>::max)
            }

            #[inline(always)]
            fn min(self, other: Self) -> Self {
                self.zip(other, <$scalar>::min)
            }

            #[inline(always)]
            fn below(self, bound: Self) -> u32 {
                let bit = |lane: usize| u32::from(self.0[lane] < bound.0[lane]) << lane;
                (0..$width).map(bit).sum()
            }

            #[inline(always)]
            fn sum(self) -> f64 {
                self.0.iter().map(|&x| f64::from(x)).sum()
            }

            #[inline(always)]
            fn gather<I: Index>(_: Portable, records: &[$record], ids: &[I]) -> [Self; RECORD] {
                std::array::from_fn(|value| {
                    Self(std::array::from_fn(|lane| records[ids[lane].index()].0[value]))
                })
            }

            #[inline(always)]
            fn coordinate(_: Portable, place: &Place, axis: usize) -> Self {
                Self([$coordinate(place, axis); $width])
            }

            #[inline(always)]
            fn separation(self, other: Self, scale: Self) -> Self {
                Self(std::array::from_fn(|lane| {
                    $separation(self.0[lane], other.0[lane], scale.0[lane])
                }))
            }
        }
    };
    (operator $scalar:ty, $width:literal, $trait:ident, $method:ident, $op:tt) => {
        impl $trait for Array<$scalar, $width> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(std::array::from_fn(|lane| self.0[lane] $op other.0[lane]))
            }
        }
    };
}

portable!(
    f32,
    8,
    Single,
    |a: f32, b: f32, scale: f32| {
        (a.to_bits() as i32).wrapping_sub(b.to_bits() as i32) as f32 * scale
    },
    |place: &Place, axis: usize| f32::from_bits(place.quanta[axis] as u32)
);
portable!(
    f64,
    4,
    Double,
    |a: f64, b: f64, _scale: f64| a - b,
    |place: &Place, axis: usize| place.meters[axis]
);

impl Machine for Portable {
    type F32 = Array<f32, 8>;
    type F64 = Array<f64, 4>;

    fn run<T: Task>(self, task: T) {
        task.run();
    }

    #[inline(always)]
    fn filter(
        self,
        [x, y, z]: [&[i32]; 3],
        (range, first): (std::ops::Range<usize>, u32),
        from: &FilterSphere,
        found: &mut [u32],
        mut n: usize,
    ) -> usize {
        for (b, number) in range.zip(first..) {
            let offset = |axis: usize, column: &[i32]| {
                from.place[axis].wrapping_sub(column[b]) as f32 * from.scale[axis]
            };
            let (dx, dy, dz) = (offset(0, x), offset(1, y), offset(2, z));
            // written first and counted afterward: no branch on the distance
            found[n] = number;
            n += usize::from(dx * dx + dy * dy + dz * dz < from.radius2);
        }
        n
    }
}
