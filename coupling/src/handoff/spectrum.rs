//! Fourier transforms of rasters.

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

/// A field on a raster, as its transform.
#[derive(Clone, Debug)]
pub struct Spectrum {
    /// Cells along x and y.
    pub n: [usize; 2],
    /// Sides of a cell; m.
    pub side: [f64; 2],
    /// Coefficients, row by row.
    pub values: Vec<Complex<f64>>,
}

impl Spectrum {
    /// Transform of values, row by row.
    pub fn of(values: &[f64], n: [usize; 2], side: [f64; 2]) -> Self {
        let values = values.iter().map(|&x| Complex::new(x, 0.0)).collect();
        let mut spectrum = Self { n, side, values };
        spectrum.transform(false);
        spectrum
    }

    /// The values.
    pub fn inverted(mut self) -> Vec<f64> {
        self.transform(true);
        let scale = 1.0 / self.values.len() as f64;
        self.values.iter().map(|value| value.re * scale).collect()
    }

    fn transform(&mut self, is_inverse: bool) {
        let [columns, rows] = self.n;
        let mut planner = FftPlanner::new();
        let mut plan = |n| match is_inverse {
            true => planner.plan_fft_inverse(n),
            false => planner.plan_fft_forward(n),
        };
        let (along, across) = (plan(columns), plan(rows));
        along.process(&mut self.values);
        let mut column = vec![Complex::default(); rows];
        for i in 0..columns {
            for (j, value) in column.iter_mut().enumerate() {
                *value = self.values[j * columns + i];
            }
            across.process(&mut column);
            for (j, value) in column.iter().enumerate() {
                self.values[j * columns + i] = *value;
            }
        }
    }

    /// Wave vector of a coefficient; 1/m.
    pub fn wave_vector(&self, index: usize) -> [f64; 2] {
        let place = [index % self.n[0], index / self.n[0]];
        [0, 1].map(|axis| {
            let (k, n) = (place[axis] as f64, self.n[axis] as f64);
            let signed = if 2.0 * k <= n { k } else { k - n };
            std::f64::consts::TAU * signed / (n * self.side[axis])
        })
    }
}
