//! Linear waves over constant depth, exact in time: a first look at what a far field will show, and the test of what is written.
//!
//! ```text
//! η_t = k tanh(kd) φ,  φ_t = −g η;     U = ∇φ tanh(kd)/(kd)  mean over the depth;     ω² = g k tanh(kd)
//! ```

use rustfft::num_complex::Complex;

use super::spectrum::Spectrum;

/// Cells over the raster along each side: waves that leave do not come back before they have crossed what is added.
const PADDING: usize = 2;

/// State of linear waves on a raster.
#[derive(Clone, Debug)]
pub struct Waves {
    /// Surface.
    surface: Spectrum,
    /// Potential at the surface.
    potential: Spectrum,
    /// Cells of the raster without padding.
    n: [usize; 2],
    /// m.
    depth: f64,
    /// m/s².
    gravity: f64,
}

impl Waves {
    /// Waves with a surface over the level of rest (m) and mean velocities over the depth (m/s) on a raster with a constant depth (m).
    pub fn new(
        (surface, velocity): (&[f64], &[[f64; 2]]),
        (n, side): ([usize; 2], [f64; 2]),
        depth: f64,
        gravity: f64,
    ) -> Self {
        let padded = n.map(|n| if n == 1 { 1 } else { PADDING * n });
        let spread = |value: &dyn Fn(usize) -> f64| {
            let mut all = vec![0.0; padded[0] * padded[1]];
            for cell in 0..n[0] * n[1] {
                all[cell / n[0] * padded[0] + cell % n[0]] = value(cell);
            }
            Spectrum::of(&all, padded, side)
        };
        let [u, v] = [0, 1].map(|axis| spread(&|cell| velocity[cell][axis]));
        let surface = spread(&|cell| surface[cell]);
        let mut potential = surface.clone();
        for (index, value) in potential.values.iter_mut().enumerate() {
            let [kx, ky] = u.wave_vector(index);
            let k = kx.hypot(ky);
            *value = match 0.0 < k {
                // rotation is no wave
                true => {
                    let along = u.values[index] * kx + v.values[index] * ky;
                    Complex::new(0.0, -1.0) * along * depth / (k * (k * depth).tanh())
                }
                false => Complex::default(),
            };
        }
        Self {
            surface,
            potential,
            n,
            depth,
            gravity,
        }
    }

    /// Surface over the level of rest after a time (s), on the raster without padding; m.
    pub fn after(&self, time: f64) -> Vec<f64> {
        let mut surface = self.surface.clone();
        for (index, value) in surface.values.iter_mut().enumerate() {
            let [kx, ky] = self.surface.wave_vector(index);
            let k = kx.hypot(ky);
            if 0.0 < k {
                let rise = k * (k * self.depth).tanh();
                let omega = (self.gravity * rise).sqrt();
                let (sin, cos) = (omega * time).sin_cos();
                *value = *value * cos + self.potential.values[index] * (rise * sin / omega);
            }
        }
        let columns = surface.n[0];
        let all = surface.inverted();
        let cell = |k: usize| all[k / self.n[0] * columns + k % self.n[0]];
        (0..self.n[0] * self.n[1]).map(cell).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A progressive packet moves with the group velocity, keeps its volume, and none of it runs back.
    #[test]
    fn a_packet_moves_on_with_its_group_velocity() {
        let (n, side, depth, gravity) = (2048, 0.5, 2.0, 9.81);
        let k: f64 = 1.0;
        let omega = (gravity * k * (k * depth).tanh()).sqrt();
        let (x0, width) = (200.0, 25.0);
        let eta = |x: f64| (-((x - x0) / width).powi(2)).exp() * (k * x).cos();
        let at = |cell: usize| (cell as f64 + 0.5) * side;
        let surface: Vec<f64> = (0..n).map(|cell| eta(at(cell))).collect();
        // U = ω η/(k d), of a linear wave to the right
        let velocity: Vec<[f64; 2]> = surface
            .iter()
            .map(|z| [omega * z / (k * depth), 0.0])
            .collect();
        let waves = Waves::new((&surface, &velocity), ([n, 1], [side, 1.0]), depth, gravity);
        let center = |surface: &[f64]| {
            let energy: f64 = surface.iter().map(|z| z * z).sum();
            let moment: f64 = surface
                .iter()
                .enumerate()
                .map(|(cell, z)| at(cell) * z * z)
                .sum();
            (moment / energy, energy)
        };
        let ((from, before), time) = (center(&surface), 100.0);
        let later = waves.after(time);
        let (to, after) = center(&later);
        let group = 0.5 * omega / k * (1.0 + 2.0 * k * depth / (2.0 * k * depth).sinh());
        // the velocities of a packet are those of its middle wave number, to (1/(k width))² of it
        assert!(((to - from) / time / group - 1.0).abs() < 0.01);
        assert!((after / before - 1.0).abs() < 0.01, "{after} {before}");
        let back = later[..400]
            .iter()
            .fold(0.0_f64, |most, z| most.max(z.abs()));
        assert!(back < 0.02, "{back}");
        // at once it is what was given
        let same = waves.after(0.0);
        assert!(
            same.iter()
                .zip(&surface)
                .all(|(a, b)| (a - b).abs() < 1e-12)
        );
    }
}
