//! Water of a row of cells within the kernel of a grain, several particles at a time.

use std::f64::consts::PI;
use std::ops::Range;

use pulp::{Arch, NullaryFnOnce};
use riprap_sph::{CellGrid, Vec3};

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

impl Water<'_> {
    pub(super) fn place(&self, a: u32) -> Vec3 {
        Vec3::from(self.places.map(|column| column[a as usize]))
    }
}

/// Particles of a row of cells within the kernel of a grain.
#[derive(Clone, Debug, Default)]
pub(super) struct Row {
    pub(super) water: Vec<u32>,
    /// 1/m³.
    pub(super) kernel: Vec<f32>,
    /// Squared distances of all in the cells; m².
    squares: Vec<f32>,
    /// Places from the grain, an axis a column; m.
    pub(super) offsets: [Vec<f32>; 3],
}

impl Row {
    /// Keeps those of some particles that are within the kernel of a grain at `-to_grain` (m).
    pub(super) fn keep(
        &mut self,
        water: &Water,
        range: Range<usize>,
        to_grain: &Vec3,
        kernel: &Wendland,
    ) {
        let n = range.len();
        self.water.resize(n, 0);
        self.kernel.resize(n, 0.0);
        self.squares.resize(n, 0.0);
        let places = water.places.map(|column| &column[range.clone()]);
        let kept = Arch::new().dispatch(Keep {
            row: self,
            places,
            first: range.start as u32,
            to_grain,
            kernel,
        });
        self.water.truncate(kept);
        self.kernel.truncate(kept);
    }

    /// Finds the places of those kept from a grain at `-to_grain`; m.
    pub(super) fn find_offsets(&mut self, water: &Water, to_grain: &Vec3) {
        let of_axes = self.offsets.iter_mut().zip(water.places).zip(to_grain);
        for ((offsets, places), to_grain) in of_axes {
            offsets.clear();
            offsets.extend((self.water.iter()).map(|&a| (places[a as usize] + to_grain) as f32));
        }
    }

    /// Keeps what is wanted.
    pub(super) fn retain(&mut self, is_wanted: impl Fn(u32) -> bool) {
        let [x, y, z] = &mut self.offsets;
        let mut n = 0;
        for k in 0..self.water.len() {
            (self.water[n], self.kernel[n]) = (self.water[k], self.kernel[k]);
            (x[n], y[n], z[n]) = (x[k], y[k], z[k]);
            n += usize::from(is_wanted(self.water[k]));
        }
        self.water.truncate(n);
        self.kernel.truncate(n);
        for offsets in &mut self.offsets {
            offsets.truncate(n);
        }
    }

    /// Adds the kernel of an image at a place from the grain; m.
    pub(super) fn add_image(&mut self, image: &Vec3, kernel: &Wendland) {
        Arch::new().dispatch(AddImage {
            row: self,
            image: [image.x, image.y, image.z].map(|x| x as f32),
            kernel,
        });
    }
}

/// Task of [`Row::keep`]; the number that it kept.
struct Keep<'a> {
    row: &'a mut Row,
    places: [&'a [f64]; 3],
    first: u32,
    to_grain: &'a Vec3,
    kernel: &'a Wendland,
}

impl NullaryFnOnce for Keep<'_> {
    type Output = usize;

    #[inline(always)]
    fn call(self) -> usize {
        let Self {
            row,
            places: [x, y, z],
            first,
            to_grain,
            kernel,
        } = self;
        let Row {
            water,
            kernel: values,
            squares,
            ..
        } = row;
        let (water, values) = (water.as_mut_slice(), values.as_mut_slice());
        for (((square, x), y), z) in squares.iter_mut().zip(x).zip(y).zip(z) {
            let [dx, dy, dz] = [x + to_grain.x, y + to_grain.y, z + to_grain.z];
            *square = (dx * dx + dy * dy + dz * dz) as f32;
        }
        let mut kept = 0;
        // half of them are beyond it: to write first and count then leaves the processor nothing to guess
        for (a, &square) in (first..).zip(squares.as_slice()) {
            (water[kept], values[kept]) = (a, square);
            kept += usize::from(kernel.reaches(square));
        }
        for value in &mut values[..kept] {
            *value = kernel.value(*value);
        }
        kept
    }
}

/// Task of [`Row::add_image`].
struct AddImage<'a> {
    row: &'a mut Row,
    /// m.
    image: [f32; 3],
    kernel: &'a Wendland,
}

impl NullaryFnOnce for AddImage<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let [x, y, z] = &self.row.offsets;
        let offsets = x.iter().zip(y).zip(z);
        for (value, ((x, y), z)) in self.row.kernel.iter_mut().zip(offsets) {
            let [dx, dy, dz] = [x - self.image[0], y - self.image[1], z - self.image[2]];
            *value += self.kernel.value(dx * dx + dy * dy + dz * dz);
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

    #[inline(always)]
    fn reaches(&self, square: f32) -> bool {
        square * self.inverse_square < 1.0
    }

    /// At a squared distance (m²), 0 beyond the radius; 1/m³.
    #[inline(always)]
    fn value(&self, square: f32) -> f32 {
        let q = (square * self.inverse_square).sqrt().min(1.0);
        let w2 = (1.0 - q) * (1.0 - q);
        self.factor * w2 * w2 * (1.0 + 4.0 * q)
    }
}
