//! Water within the kernel of a grain, several particles at a time.

use std::f64::consts::PI;
use std::ops::Range;

#[cfg(target_arch = "x86_64")]
use pulp::x86::V3;
use pulp::{Arch, NullaryFnOnce};
use riprap_sph::{CellGrid, Vec3};

use super::packing::{OneByOne, Packed, Packing, WIDTH};
use super::sums::Pair;

/// The water as lists are made of it.
pub(super) struct Water<'a> {
    pub(super) grid: &'a CellGrid,
    /// Way of the particles since they were sorted into cells; m.
    pub(super) moved: f64,
    /// Positions, an axis a column; m.
    pub(super) places: [&'a [f64]; 3],
    /// Of each particle; m³.
    pub(super) volume: &'a [f64],
}

/// A row of cells whose particles may be within the kernel of a grain.
#[derive(Clone, Debug)]
pub(super) struct Cells {
    pub(super) particles: Range<usize>,
    /// Of their particles to the image that is near; m.
    pub(super) shift: Vec3,
}

/// Particles within the kernel of a grain.
#[derive(Clone, Debug, Default)]
pub(super) struct Nearby {
    pub(super) cells: Vec<Cells>,
    n: usize,
    water: Vec<u32>,
    /// 1/m³.
    kernel: Vec<f32>,
    /// Places from the grain, an axis a column, and their squared distances, all that are kept; m, m².
    places: [Vec<f32>; 4],
    /// The same of all in one row of cells.
    of_row: [Vec<[f32; WIDTH]>; 4],
}

impl Nearby {
    /// Particles, in order of the rows, with their kernels.
    pub(super) fn pairs(&self) -> impl Iterator<Item = Pair> + '_ {
        let pairs = self.water.iter().zip(&self.kernel).take(self.n);
        pairs.map(|(&water, &kernel)| Pair { water, kernel })
    }

    /// Their places from the grain, an axis a column; m.
    pub(super) fn offsets(&self) -> [&[f32]; 3] {
        let [x, y, z, _] = &self.places;
        [x, y, z].map(|column| &column[..self.n])
    }

    /// Keeps those of the rows of cells that are within the kernel of a grain at `x` (m).
    pub(super) fn keep(&mut self, water: &Water, x: &Vec3, kernel: &Wendland) {
        let lengths = self.cells.iter().map(|cells| cells.particles.len());
        let (all, longest) = lengths.fold((0, 0), |(sum, most), n| (sum + n, most.max(n)));
        // columns only ever grow: to clear them for each grain takes as long as to fill them
        grow(&mut self.water, all + WIDTH);
        grow(&mut self.kernel, all);
        for (column, of_row) in self.places.iter_mut().zip(&mut self.of_row) {
            grow(column, all + WIDTH);
            grow(of_row, longest.div_ceil(WIDTH));
        }
        #[cfg(target_arch = "x86_64")]
        if let Some(registers) = V3::try_new() {
            self.keep_by(registers, water, x, kernel);
            return;
        }
        self.keep_by(OneByOne, water, x, kernel);
    }

    fn keep_by(&mut self, packing: impl Packing, water: &Water, x: &Vec3, kernel: &Wendland) {
        self.n = packing.run(Keep {
            packing,
            nearby: self,
            water,
            x,
            kernel,
        });
    }

    /// Keeps what is wanted, by its place from the grain; m.
    pub(super) fn retain(&mut self, is_wanted: impl Fn(&Vec3) -> bool) {
        let mut n = 0;
        for k in 0..self.n {
            let place = [0, 1, 2].map(|axis| f64::from(self.places[axis][k]));
            self.water[n] = self.water[k];
            for column in &mut self.places {
                column[n] = column[k];
            }
            n += usize::from(is_wanted(&Vec3::from(place)));
        }
        self.n = n;
    }

    /// Finds the kernel of each, as the sum over a grain at `x` (m) and its images (m).
    pub(super) fn find_kernel(&mut self, x: &Vec3, images: &[Vec3], kernel: &Wendland) {
        Arch::new().dispatch(FindKernel {
            nearby: self,
            x,
            images,
            kernel,
        });
    }
}

/// The first `n` of a column.
#[inline(always)]
fn flat(column: &mut [[f32; WIDTH]], n: usize) -> &mut [f32] {
    &mut column.as_flattened_mut()[..n]
}

fn grow<T: Copy + Default>(column: &mut Vec<T>, n: usize) {
    if column.len() < n {
        column.resize(n, T::default());
    }
}

/// Task of [`Nearby::keep`]; the number that it kept.
struct Keep<'a, P> {
    packing: P,
    nearby: &'a mut Nearby,
    water: &'a Water<'a>,
    x: &'a Vec3,
    kernel: &'a Wendland,
}

impl<P: Packing> NullaryFnOnce for Keep<'_, P> {
    type Output = usize;

    #[inline(always)]
    fn call(self) -> usize {
        let Nearby {
            cells,
            water,
            places,
            of_row,
            ..
        } = self.nearby;
        let mut packed = Packed {
            n: 0,
            water: water.as_mut_slice(),
            columns: places.each_mut().map(Vec::as_mut_slice),
        };
        // arrays are taken apart by hand: their `map` would be a call without the registers that this task is compiled for
        let [columns_x, columns_y, columns_z, columns_squares] = of_row;
        for Cells { particles, shift } in cells.iter() {
            let (first, n) = (particles.start, particles.len());
            let end = first + n;
            let to_grain = shift - self.x;
            let [x, y, z] = self.water.places;
            let (x, y, z) = (&x[first..end], &y[first..end], &z[first..end]);
            let (dx, dy) = (flat(columns_x, n), flat(columns_y, n));
            let (dz, squares) = (flat(columns_z, n), flat(columns_squares, n));
            for k in 0..n {
                let [x, y, z] = [x[k] + to_grain.x, y[k] + to_grain.y, z[k] + to_grain.z];
                (dx[k], dy[k], dz[k]) = (x as f32, y as f32, z as f32);
                squares[k] = (x * x + y * y + z * z) as f32;
            }
            let eights = n.div_ceil(WIDTH);
            columns_squares[..eights].as_flattened_mut()[n..].fill(f32::INFINITY);
            let row = [
                &columns_x[..eights],
                &columns_y[..eights],
                &columns_z[..eights],
                &columns_squares[..eights],
            ];
            (self.packing).pack(first as u32, row, self.kernel.inverse_square, &mut packed);
        }
        packed.n
    }
}

/// Task of [`Nearby::find_kernel`].
struct FindKernel<'a> {
    nearby: &'a mut Nearby,
    x: &'a Vec3,
    images: &'a [Vec3],
    kernel: &'a Wendland,
}

impl NullaryFnOnce for FindKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Nearby {
            n, kernel, places, ..
        } = self.nearby;
        let values = &mut kernel[..*n];
        let [x, y, z, squares] = &*places;
        for (value, &square) in values.iter_mut().zip(squares) {
            *value = self.kernel.value(square);
        }
        for image in self.images {
            let image = image - self.x;
            let [ix, iy, iz] = [image.x as f32, image.y as f32, image.z as f32];
            for (((value, x), y), z) in values.iter_mut().zip(x).zip(y).zip(z) {
                let [dx, dy, dz] = [x - ix, y - iy, z - iz];
                *value += self.kernel.value(dx * dx + dy * dy + dz * dz);
            }
        }
    }
}

/// Wendland's kernel C2 in space, in single precision: all sums use the same values.
///
/// ```text
/// W = 21/(2π R³) (1 − r/R)⁴ (1 + 4 r/R)
/// ```
pub(super) struct Wendland {
    /// `1/R²`; 1/m².
    inverse_square: f32,
    /// 1/m³.
    factor: f32,
}

impl Wendland {
    pub(super) fn new(reach: f64) -> Self {
        Self {
            inverse_square: (1.0 / (reach * reach)) as f32,
            factor: (21.0 / (2.0 * PI * reach.powi(3))) as f32,
        }
    }

    /// At a squared distance (m²), 0 beyond the radius; 1/m³.
    #[inline(always)]
    fn value(&self, square: f32) -> f32 {
        let q = (square * self.inverse_square).sqrt().min(1.0);
        let w2 = (1.0 - q) * (1.0 - q);
        self.factor * w2 * w2 * (1.0 + 4.0 * q)
    }
}
