//! Linear waves over constant depth, exact in time: a first look at what a far field will show, and the test of what is written.
//!
//! ```text
//! η_t = k tanh(kd) φ,  φ_t = −g η;     U = ∇φ tanh(kd)/(kd)  mean over the depth;     ω² = g k tanh(kd)
//! ```

use rustfft::num_complex::Complex;

use super::columns::Raster;
use super::spectrum::Spectrum;

/// Most cells of a transform.
const MOST_CELLS: usize = 1 << 24;

/// State of linear waves on a raster and around it.
#[derive(Clone, Debug)]
pub struct Waves {
    /// Surface.
    surface: Spectrum,
    /// Potential at the surface.
    potential: Spectrum,
    /// The raster with cells around it.
    raster: Raster,
    /// m.
    depth: f64,
    /// m/s².
    gravity: f64,
}

/// Surface over the level of rest at one time.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Where it is.
    pub raster: Raster,
    /// m.
    pub elevation: Vec<f64>,
}

impl Waves {
    /// Waves with a surface over the level of rest (m) and mean velocities over the depth (m/s) on a raster, over a constant depth (m)
    /// under gravity (m/s²). Around the raster are as many cells as long waves pass in `time` (s), so that none leaves on one side and
    /// comes back on the other; `None` where these are too many.
    pub fn new(
        (surface, velocity): (&[f64], &[[f64; 2]]),
        raster: Raster,
        (depth, gravity): (f64, f64),
        time: f64,
    ) -> Option<Self> {
        let way = (gravity * depth).sqrt() * time;
        let beside = [0, 1].map(|axis| match raster.n[axis] {
            1 => 0,
            _ => (way / raster.side[axis]).ceil() as usize + 1,
        });
        let n = [0, 1].map(|axis| raster.n[axis].saturating_add(beside[axis].saturating_mul(2)));
        if MOST_CELLS < n[0].saturating_mul(n[1]) {
            return None;
        }
        let spread = |value: &dyn Fn(usize) -> f64| {
            let mut all = vec![0.0; n[0] * n[1]];
            for cell in 0..raster.n_cells() {
                let [i, j] = [
                    cell % raster.n[0] + beside[0],
                    cell / raster.n[0] + beside[1],
                ];
                all[j * n[0] + i] = value(cell);
            }
            Spectrum::of(&all, n, raster.side)
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
        Some(Self {
            surface,
            potential,
            raster: Raster {
                n,
                corner: [0, 1]
                    .map(|axis| raster.corner[axis] - beside[axis] as f64 * raster.side[axis]),
                side: raster.side,
            },
            depth,
            gravity,
        })
    }

    /// Cell of a place; `None` outside of all.
    pub fn place(&self, at: [f64; 2]) -> Option<usize> {
        self.raster.cell_at(at)
    }

    /// Surface after a time (s).
    pub fn after(&self, time: f64) -> Surface {
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
        Surface {
            raster: self.raster,
            elevation: surface.inverted(),
        }
    }
}

impl Surface {
    /// Place (m) and elevation (m) of the highest cell.
    pub fn highest(&self) -> ([f64; 2], f64) {
        let elevation = &self.elevation;
        let cells = 0..elevation.len();
        let highest = cells.max_by(|&a, &b| elevation[a].total_cmp(&elevation[b]));
        let cell = highest.unwrap_or(0);
        (self.raster.center(cell), elevation[cell])
    }

    /// Elevation of the cell at a place; NaN outside; m.
    pub fn at(&self, place: [f64; 2]) -> f64 {
        let cell = self.raster.cell_at(place);
        cell.map_or(f64::NAN, |cell| self.elevation[cell])
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
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
        let raster = Raster {
            n: [n, 1],
            corner: [0.0; 2],
            side: [side, 1.0],
        };
        let time = 100.0;
        let state = (surface.as_slice(), velocity.as_slice());
        let waves = Waves::new(state, raster, (depth, gravity), time).unwrap();
        let beside = (waves.raster.n[0] - n) / 2;
        let center = |surface: &[f64]| {
            let energy: f64 = surface.iter().map(|z| z * z).sum();
            let moment: f64 = surface
                .iter()
                .enumerate()
                .map(|(cell, z)| at(cell) * z * z)
                .sum();
            (moment / energy, energy)
        };
        let (from, before) = center(&surface);
        let later = waves.after(time).elevation;
        let later = &later[beside..beside + n];
        let (to, after) = center(later);
        let group = 0.5 * omega / k * (1.0 + 2.0 * k * depth / (2.0 * k * depth).sinh());
        // the velocities of a packet are those of its middle wave number, to (1/(k width))² of it
        assert!(((to - from) / time / group - 1.0).abs() < 0.01);
        assert!((after / before - 1.0).abs() < 0.01, "{after} {before}");
        let back = later[..400]
            .iter()
            .fold(0.0_f64, |most, z| most.max(z.abs()));
        assert!(back < 0.02, "{back}");
        // at once it is what was given
        let same = waves.after(0.0).elevation;
        assert!(
            same[beside..]
                .iter()
                .zip(&surface)
                .all(|(a, b)| (a - b).abs() < 1e-12)
        );
    }
}
