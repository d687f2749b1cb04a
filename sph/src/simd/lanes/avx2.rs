//! Registers of a processor with AVX2 and fused multiply-add.

use std::arch::x86_64::{__m128, __m256, __m256d, __m256i, _CMP_LT_OQ};
use std::ops::{Add, Div, Mul, Sub};

use pulp::x86::V3;
use pulp::{NullaryFnOnce, cast};

use super::{
    Double, FILTER_WIDTH, FilterSphere, Index, Lanes, Machine, Place, RECORD, Single, Task,
};

/// A processor with AVX2 and fused multiply-add.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx2(V3);

/// Eight of single precision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct F32x8(V3, __m256);

/// Four of double precision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct F64x4(V3, __m256d);

impl Avx2 {
    /// The machine, if this processor is one.
    pub(crate) fn detect() -> Option<Self> {
        V3::try_new().map(Self)
    }
}

macro_rules! operators {
    ($lanes:ty, $($trait:ident $method:ident $intrinsic:ident),*) => {$(
        impl $trait for $lanes {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0, self.0.avx.$intrinsic(self.1, other.1))
            }
        }
    )*};
}

operators!(F32x8, Add add _mm256_add_ps, Sub sub _mm256_sub_ps, Mul mul _mm256_mul_ps, Div div _mm256_div_ps);
operators!(F64x4, Add add _mm256_add_pd, Sub sub _mm256_sub_pd, Mul mul _mm256_mul_pd, Div div _mm256_div_pd);

impl Lanes for F32x8 {
    const WIDTH: usize = 8;
    const IS_SPECIALIZED: bool = true;
    type Machine = Avx2;
    type Record = Single;

    #[inline(always)]
    fn splat(machine: Avx2, value: f64) -> Self {
        Self(machine.0, machine.0.avx._mm256_set1_ps(value as f32))
    }

    #[inline(always)]
    fn load(machine: Avx2, values: &[f64]) -> Self {
        let values: [f32; 8] = std::array::from_fn(|lane| values[lane] as f32);
        Self(machine.0, cast(values))
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Self(self.0, self.0.fma._mm256_fmadd_ps(self.1, b.1, c.1))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0, self.0.avx._mm256_sqrt_ps(self.1))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(self.0, self.0.avx._mm256_max_ps(self.1, other.1))
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(self.0, self.0.avx._mm256_min_ps(self.1, other.1))
    }

    #[inline(always)]
    fn below(self, bound: Self) -> u32 {
        let avx = self.0.avx;
        let is_below = avx._mm256_cmp_ps::<_CMP_LT_OQ>(self.1, bound.1);
        avx._mm256_movemask_ps(is_below) as u32
    }

    #[inline(always)]
    fn sum(self) -> f64 {
        let avx = self.0.avx;
        let low = avx._mm256_cvtps_pd(avx._mm256_castps256_ps128(self.1));
        let high = avx._mm256_cvtps_pd(avx._mm256_extractf128_ps::<1>(self.1));
        let [a, b, c, d]: [f64; 4] = cast(avx._mm256_add_pd(low, high));
        (a + b) + (c + d)
    }

    #[inline(always)]
    fn gather<I: Index>(machine: Avx2, records: &[Single], ids: &[I]) -> [Self; RECORD] {
        let [a, b, c, d] = transposed_single(machine, records, ids, 0);
        let [e, f, g, h] = transposed_single(machine, records, ids, 4);
        let m = machine.0;
        [
            Self(m, a),
            Self(m, b),
            Self(m, c),
            Self(m, d),
            Self(m, e),
            Self(m, f),
            Self(m, g),
            Self(m, h),
        ]
    }

    #[inline(always)]
    fn coordinate(machine: Avx2, place: &Place, axis: usize) -> Self {
        let value = machine.0.avx._mm256_set1_epi32(place.quanta[axis]);
        Self(machine.0, cast::<__m256i, __m256>(value))
    }

    #[inline(always)]
    fn separation(self, other: Self, scale: Self) -> Self {
        let quanta = self.0.avx2._mm256_sub_epi32(cast(self.1), cast(other.1));
        Self(self.0, self.0.avx._mm256_cvtepi32_ps(quanta)) * scale
    }
}

impl Lanes for F64x4 {
    const WIDTH: usize = 4;
    const IS_SPECIALIZED: bool = true;
    type Machine = Avx2;
    type Record = Double;

    #[inline(always)]
    fn splat(machine: Avx2, value: f64) -> Self {
        Self(machine.0, machine.0.avx._mm256_set1_pd(value))
    }

    #[inline(always)]
    fn load(machine: Avx2, values: &[f64]) -> Self {
        let values: [f64; 4] = std::array::from_fn(|lane| values[lane]);
        Self(machine.0, cast(values))
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Self(self.0, self.0.fma._mm256_fmadd_pd(self.1, b.1, c.1))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0, self.0.avx._mm256_sqrt_pd(self.1))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(self.0, self.0.avx._mm256_max_pd(self.1, other.1))
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(self.0, self.0.avx._mm256_min_pd(self.1, other.1))
    }

    #[inline(always)]
    fn below(self, bound: Self) -> u32 {
        let avx = self.0.avx;
        let is_below = avx._mm256_cmp_pd::<_CMP_LT_OQ>(self.1, bound.1);
        avx._mm256_movemask_pd(is_below) as u32
    }

    #[inline(always)]
    fn sum(self) -> f64 {
        let [a, b, c, d]: [f64; 4] = cast(self.1);
        (a + b) + (c + d)
    }

    #[inline(always)]
    fn gather<I: Index>(machine: Avx2, records: &[Double], ids: &[I]) -> [Self; RECORD] {
        let [a, b, c, d] = transposed_double(machine, records, ids, 0);
        let [e, f, g, h] = transposed_double(machine, records, ids, 4);
        let m = machine.0;
        [
            Self(m, a),
            Self(m, b),
            Self(m, c),
            Self(m, d),
            Self(m, e),
            Self(m, f),
            Self(m, g),
            Self(m, h),
        ]
    }

    #[inline(always)]
    fn coordinate(machine: Avx2, place: &Place, axis: usize) -> Self {
        Self(machine.0, machine.0.avx._mm256_set1_pd(place.meters[axis]))
    }

    #[inline(always)]
    fn separation(self, other: Self, _scale: Self) -> Self {
        self - other
    }
}

/// Four values of eight records, from value `first` on. Functions and not closures: closures are
/// not inlined here, and intrinsics that are called cost more than all the rest.
#[inline(always)]
fn transposed_single<I: Index>(
    machine: Avx2,
    records: &[Single],
    ids: &[I],
    first: usize,
) -> [__m256; 4] {
    let avx = machine.0.avx;
    // lanes 0..4 in the low halves, 4..8 in the high ones: two 4 x 4 transposes at once
    let rows = [
        pair_of_rows(machine, records, [ids[0], ids[4]], first),
        pair_of_rows(machine, records, [ids[1], ids[5]], first),
        pair_of_rows(machine, records, [ids[2], ids[6]], first),
        pair_of_rows(machine, records, [ids[3], ids[7]], first),
    ];
    let low01 = avx._mm256_unpacklo_ps(rows[0], rows[1]);
    let high01 = avx._mm256_unpackhi_ps(rows[0], rows[1]);
    let low23 = avx._mm256_unpacklo_ps(rows[2], rows[3]);
    let high23 = avx._mm256_unpackhi_ps(rows[2], rows[3]);
    [
        avx._mm256_shuffle_ps::<0b01_00_01_00>(low01, low23),
        avx._mm256_shuffle_ps::<0b11_10_11_10>(low01, low23),
        avx._mm256_shuffle_ps::<0b01_00_01_00>(high01, high23),
        avx._mm256_shuffle_ps::<0b11_10_11_10>(high01, high23),
    ]
}

#[inline(always)]
fn pair_of_rows<I: Index>(
    machine: Avx2,
    records: &[Single],
    [low, high]: [I; 2],
    first: usize,
) -> __m256 {
    let avx = machine.0.avx;
    avx._mm256_insertf128_ps::<1>(
        avx._mm256_castps128_ps256(quad(&records[low.index()], first)),
        quad(&records[high.index()], first),
    )
}

#[inline(always)]
fn quad(record: &Single, first: usize) -> __m128 {
    let r = &record.0;
    cast::<[f32; 4], __m128>([r[first], r[first + 1], r[first + 2], r[first + 3]])
}

/// Four values of four records, from value `first` on.
#[inline(always)]
fn transposed_double<I: Index>(
    machine: Avx2,
    records: &[Double],
    ids: &[I],
    first: usize,
) -> [__m256d; 4] {
    let avx = machine.0.avx;
    let rows = [
        row(&records[ids[0].index()], first),
        row(&records[ids[1].index()], first),
        row(&records[ids[2].index()], first),
        row(&records[ids[3].index()], first),
    ];
    let low01 = avx._mm256_unpacklo_pd(rows[0], rows[1]);
    let high01 = avx._mm256_unpackhi_pd(rows[0], rows[1]);
    let low23 = avx._mm256_unpacklo_pd(rows[2], rows[3]);
    let high23 = avx._mm256_unpackhi_pd(rows[2], rows[3]);
    [
        avx._mm256_permute2f128_pd::<0x20>(low01, low23),
        avx._mm256_permute2f128_pd::<0x20>(high01, high23),
        avx._mm256_permute2f128_pd::<0x31>(low01, low23),
        avx._mm256_permute2f128_pd::<0x31>(high01, high23),
    ]
}

#[inline(always)]
fn row(record: &Double, first: usize) -> __m256d {
    let r = &record.0;
    cast::<[f64; 4], __m256d>([r[first], r[first + 1], r[first + 2], r[first + 3]])
}

/// Meters along one axis to eight candidates.
#[inline(always)]
fn offsets(machine: Avx2, column: &[i32], place: i32, scale: f32) -> __m256 {
    let (avx, avx2) = (machine.0.avx, machine.0.avx2);
    let lanes: [i32; FILTER_WIDTH] = [
        column[0], column[1], column[2], column[3], column[4], column[5], column[6], column[7],
    ];
    let quanta = avx2._mm256_sub_epi32(
        avx._mm256_set1_epi32(place),
        cast::<[i32; FILTER_WIDTH], __m256i>(lanes),
    );
    avx._mm256_mul_ps(avx._mm256_cvtepi32_ps(quanta), avx._mm256_set1_ps(scale))
}

/// Mask of eight candidates within the radius.
#[inline(always)]
fn near(machine: Avx2, [x, y, z]: [&[i32]; 3], from: &FilterSphere, radius2: __m256) -> usize {
    let (avx, fma) = (machine.0.avx, machine.0.fma);
    let dx = offsets(machine, x, from.place[0], from.scale[0]);
    let dy = offsets(machine, y, from.place[1], from.scale[1]);
    let dz = offsets(machine, z, from.place[2], from.scale[2]);
    let r2 = fma._mm256_fmadd_ps(
        dx,
        dx,
        fma._mm256_fmadd_ps(dy, dy, avx._mm256_mul_ps(dz, dz)),
    );
    let near = avx._mm256_cmp_ps::<_CMP_LT_OQ>(r2, radius2);
    avx._mm256_movemask_ps(near) as usize
}

/// Appends the candidates of a pattern, counted from `first`; returns the new end.
#[inline(always)]
fn append(machine: Avx2, pattern: usize, first: u32, found: &mut [u32], n: usize) -> usize {
    let (avx, avx2) = (machine.0.avx, machine.0.avx2);
    let packed = avx2._mm256_add_epi32(
        cast::<[u32; FILTER_WIDTH], __m256i>(PACKED[pattern & 0xff]),
        avx._mm256_set1_epi32(first as i32),
    );
    let packed: [u32; FILTER_WIDTH] = cast(packed);
    found[n..n + FILTER_WIDTH].copy_from_slice(&packed);
    n + pattern.count_ones() as usize
}

/// A task as the dispatcher wants it.
struct Call<T>(T);

/// A variable at the start of a line of the cache.
///
/// Loops with more sums than registers keep some on the stack, 32 bytes each, and only a function with such a variable aligns
/// it. Elsewhere the depth of calls decides whether a sum lies across two lines: forces then take 1.4 times as long, rates in
/// double precision 1.6 times.
#[repr(align(64))]
struct AtLine(#[expect(dead_code, reason = "what matters is where it is")] u8);

impl<T: Task> NullaryFnOnce for Call<T> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let mut at_line = AtLine(0);
        std::hint::black_box(&mut at_line);
        self.0.run();
    }
}

/// For every pattern of eight bits, the lanes whose bit is set, in order.
static PACKED: [[u32; FILTER_WIDTH]; 256] = packed();

const fn packed() -> [[u32; FILTER_WIDTH]; 256] {
    let mut table = [[0; FILTER_WIDTH]; 256];
    let mut pattern = 0;
    while pattern < 256 {
        let (mut lane, mut n) = (0, 0);
        while lane < FILTER_WIDTH {
            if pattern >> lane & 1 == 1 {
                table[pattern][n] = lane as u32;
                n += 1;
            }
            lane += 1;
        }
        pattern += 1;
    }
    table
}

impl Machine for Avx2 {
    type F32 = F32x8;
    type F64 = F64x4;

    #[inline(always)]
    fn run<T: Task>(self, task: T) {
        self.0.vectorize(Call(task));
    }

    #[inline(always)]
    fn filter(
        self,
        columns: [&[i32]; 3],
        (range, mut first): (std::ops::Range<usize>, u32),
        from: &FilterSphere,
        found: &mut [u32],
        mut n: usize,
    ) -> usize {
        let radius2 = self.0.avx._mm256_set1_ps(from.radius2);
        let whole = range.len() / FILTER_WIDTH * FILTER_WIDTH;
        let end = range.start + range.len().next_multiple_of(FILTER_WIDTH);
        let [x, y, z] = columns;
        let (x, y, z) = (
            &x[range.start..end],
            &y[range.start..end],
            &z[range.start..end],
        );
        let blocks = x[..whole]
            .chunks_exact(FILTER_WIDTH)
            .zip(y[..whole].chunks_exact(FILTER_WIDTH))
            .zip(z[..whole].chunks_exact(FILTER_WIDTH));
        for ((x, y), z) in blocks {
            let pattern = near(self, [x, y, z], from, radius2);
            n = append(self, pattern, first, found, n);
            first += FILTER_WIDTH as u32;
        }
        if whole < range.len() {
            let pattern = near(self, [&x[whole..], &y[whole..], &z[whole..]], from, radius2);
            // lanes beyond the end belong to other cells
            let inside = (1 << (range.len() - whole)) - 1;
            n = append(self, pattern & inside, first, found, n);
        }
        n
    }
}
