//! Packing: what of a row is within a radius goes to the front of columns, eight at a time where the processor can.

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::{__m256, __m256i, _CMP_LT_OQ};

use pulp::NullaryFnOnce;
#[cfg(target_arch = "x86_64")]
use pulp::{cast, x86::V3};

/// Particles looked at together; columns of a row are filled up to a multiple of it, and packed ones have room for as many more.
pub(super) const WIDTH: usize = 8;

/// Places and squared distances, a quantity a column.
pub(super) type Columns<'a> = [&'a [[f32; WIDTH]]; 4];

/// Packed columns, and how much of them is filled.
pub(super) struct Packed<'a> {
    pub(super) n: usize,
    pub(super) water: &'a mut [u32],
    pub(super) columns: [&'a mut [f32]; 4],
}

/// Way to pack.
pub(super) trait Packing: Copy {
    /// Runs a task with all that the processor offers for it.
    fn run<T: NullaryFnOnce>(self, task: T) -> T::Output;

    /// Appends particles of a row, counted from `first`, whose squared distance times `scale` is below 1.
    fn pack(self, first: u32, row: Columns, scale: f32, packed: &mut Packed);
}

/// One by one, on any processor.
#[derive(Clone, Copy)]
pub(super) struct OneByOne;

impl Packing for OneByOne {
    fn run<T: NullaryFnOnce>(self, task: T) -> T::Output {
        task.call()
    }

    #[inline(always)]
    fn pack(self, first: u32, row: Columns, scale: f32, packed: &mut Packed) {
        let [x, y, z, squares] = row.map(<[_]>::as_flattened);
        let mut n = packed.n;
        for (k, &square) in squares.iter().enumerate() {
            // half of them are beyond it: to write first and count then leaves the processor nothing to guess
            packed.water[n] = first + k as u32;
            for (column, value) in packed.columns.iter_mut().zip([x[k], y[k], z[k], square]) {
                column[n] = value;
            }
            n += usize::from(square * scale < 1.0);
        }
        packed.n = n;
    }
}

#[cfg(target_arch = "x86_64")]
impl Packing for V3 {
    fn run<T: NullaryFnOnce>(self, task: T) -> T::Output {
        self.vectorize(task)
    }

    #[inline(always)]
    fn pack(self, first: u32, row: Columns, scale: f32, packed: &mut Packed) {
        let (avx, avx2) = (self.avx, self.avx2);
        let [scale, one] = [scale, 1.0].map(|value| avx._mm256_set1_ps(value));
        let [x, y, z, squares] = row;
        let mut n = packed.n;
        let eights = x.iter().zip(y).zip(z).zip(squares);
        for (eight, (((x, y), z), squares)) in eights.enumerate() {
            let share = avx._mm256_mul_ps(cast(*squares), scale);
            let is_within = avx._mm256_cmp_ps::<_CMP_LT_OQ>(share, one);
            let pattern = avx._mm256_movemask_ps(is_within) as usize & 0xff;
            let order: __m256i = cast(ORDERS[pattern]);
            let from = avx._mm256_set1_epi32((first as usize + WIDTH * eight) as i32);
            let water: [u32; WIDTH] = cast(avx2._mm256_add_epi32(order, from));
            packed.water[n..n + WIDTH].copy_from_slice(&water);
            for (column, values) in packed.columns.iter_mut().zip([x, y, z, squares]) {
                let values: __m256 = cast(*values);
                let values: [f32; WIDTH] = cast(avx2._mm256_permutevar8x32_ps(values, order));
                column[n..n + WIDTH].copy_from_slice(&values);
            }
            n += pattern.count_ones() as usize;
        }
        packed.n = n;
    }
}

/// For every pattern of eight bits, the lanes whose bit is set, in order, and then any.
#[cfg(target_arch = "x86_64")]
static ORDERS: [[u32; WIDTH]; 256] = orders();

#[cfg(target_arch = "x86_64")]
const fn orders() -> [[u32; WIDTH]; 256] {
    let mut orders = [[0; WIDTH]; 256];
    let mut pattern = 0;
    while pattern < 256 {
        let (mut lane, mut n) = (0, 0);
        while lane < WIDTH {
            if pattern >> lane & 1 == 1 {
                orders[pattern][n] = lane as u32;
                n += 1;
            }
            lane += 1;
        }
        pattern += 1;
    }
    orders
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Particles and columns packed from rows of squared distances; places follow from these.
    fn packed(packing: impl Packing, rows: &[Vec<[f32; WIDTH]>]) -> (Vec<u32>, [Vec<f32>; 4]) {
        let room = rows.iter().map(|row| WIDTH * row.len()).sum::<usize>() + WIDTH;
        let mut water = vec![0; room];
        let mut columns: [_; 4] = std::array::from_fn(|_| vec![0.0_f32; room]);
        let mut packed = Packed {
            n: 0,
            water: &mut water,
            columns: columns.each_mut().map(Vec::as_mut_slice),
        };
        let mut first = 100;
        for squares in rows {
            let shifted = |by: f32| -> Vec<[f32; WIDTH]> {
                squares.iter().map(|eight| eight.map(|s| s + by)).collect()
            };
            let [x, y, z] = [1.0, 2.0, 3.0].map(shifted);
            packing.pack(first, [&x, &y, &z, squares], 0.5, &mut packed);
            first += (WIDTH * squares.len()) as u32;
        }
        let n = packed.n;
        water.truncate(n);
        for column in &mut columns {
            column.truncate(n);
        }
        (water, columns)
    }

    fn rows() -> Vec<Vec<[f32; WIDTH]>> {
        let mut state = 1_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / 4_194_304.0
        };
        // from none to all of eight within the radius, and a row of none
        let mut row = |n: usize| (0..n).map(|_| std::array::from_fn(|_| random())).collect();
        let mut rows: Vec<Vec<[f32; WIDTH]>> = [1, 0, 7, 300].map(&mut row).into();
        rows.push(vec![[f32::INFINITY; WIDTH], [0.0; WIDTH]]);
        rows
    }

    #[test]
    fn what_is_within_is_packed_in_order() {
        let rows = rows();
        let (water, [x, .., squares]) = packed(OneByOne, &rows);
        let all = (100..).zip(rows.iter().flatten().flatten());
        let within: Vec<(u32, f32)> = (all.map(|(a, &s)| (a, s)))
            .filter(|(_, s)| s * 0.5 < 1.0)
            .collect();
        assert!((1000..1500).contains(&within.len()), "about half of them");
        assert_eq!(water, Vec::from_iter(within.iter().map(|&(a, _)| a)));
        assert_eq!(squares, Vec::from_iter(within.iter().map(|&(_, s)| s)));
        assert_eq!(x, Vec::from_iter(within.iter().map(|&(_, s)| s + 1.0)));
    }

    #[test]
    #[cfg(target_arch = "x86_64")]
    fn registers_pack_the_same() {
        let Some(registers) = V3::try_new() else {
            return;
        };
        let rows = rows();
        assert_eq!(packed(registers, &rows), packed(OneByOne, &rows));
    }
}
