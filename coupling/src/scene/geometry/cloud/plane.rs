//! Planes through neighboring points.

/// Smallest eigenvalue that counts against the sum of both, so that points on a line give the plane that is level across it; –.
const ON_A_LINE: f64 = 1e-9;
/// Share of the points that the trimmed plane keeps; –.
const KEPT: f64 = 0.65;
/// Steps of concentration: after three the set of points hardly changes (Rousseeuw & Van Driessen 1999, 12 m_j).
const CONCENTRATIONS: usize = 3;

/// A plane `z = z₀ + g·(x − x₀)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    /// Point that it is written about, and its elevation; m.
    center: [f64; 3],
    /// Slopes along x and y; –.
    gradient: [f64; 2],
}

impl Plane {
    /// Least squares plane; `None` without points.
    ///
    /// ```text
    /// C g = b,   C = Σ (x − x₀)(x − x₀)ᵀ,   b = Σ (x − x₀)(z − z₀)                              [m²]
    /// ```
    pub(super) fn through(points: &[[f64; 3]]) -> Option<Self> {
        if points.is_empty() {
            return None;
        }
        let n = points.len() as f64;
        let center = [0, 1, 2].map(|axis| points.iter().map(|p| p[axis]).sum::<f64>() / n);
        let (mut xx, mut xy, mut yy, mut xz, mut yz) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for p in points {
            let [x, y, z] = [0, 1, 2].map(|axis| p[axis] - center[axis]);
            (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
            (xz, yz) = (xz + x * z, yz + y * z);
        }
        let (trace, determinant) = (xx + yy, xx * yy - xy * xy);
        let gradient = if determinant > ON_A_LINE * trace * trace {
            [
                (yy * xz - xy * yz) / determinant,
                (xx * yz - xy * xz) / determinant,
            ]
        } else if trace > 0.0 {
            // C is trace · e eᵀ: the slope along e
            [xz / trace, yz / trace]
        } else {
            [0.0; 2]
        };
        Some(Self { center, gradient })
    }

    /// Least squares plane of the points that are nearest to it, whatever the others are.
    pub(super) fn trimmed(points: &[[f64; 3]]) -> Option<Self> {
        let n_kept = ((KEPT * points.len() as f64).ceil() as usize).max(3);
        // the level of the median is the first guess that a few spikes do not move
        let mut heights: Vec<f64> = points.iter().map(|p| p[2]).collect();
        heights.sort_by(f64::total_cmp);
        let median = *heights.get(heights.len() / 2)?;
        let mut plane = Self {
            center: [0.0, 0.0, median],
            gradient: [0.0; 2],
        };
        let mut best = (f64::INFINITY, plane);
        let n_kept = n_kept.min(points.len());
        let mut ranked: Vec<(f64, [f64; 3])> = Vec::with_capacity(points.len());
        let mut kept: Vec<[f64; 3]> = Vec::with_capacity(n_kept);
        for start in [plane, Self::through(points)?] {
            plane = start;
            for step in 0..=CONCENTRATIONS {
                ranked.clear();
                let residual = |p: &[f64; 3]| (p[2] - plane.height([p[0], p[1]])).abs();
                ranked.extend(points.iter().map(|p| (residual(p), *p)));
                ranked.select_nth_unstable_by(n_kept - 1, |a, b| a.0.total_cmp(&b.0));
                if step < CONCENTRATIONS {
                    kept.clear();
                    kept.extend(ranked[..n_kept].iter().map(|(_, p)| *p));
                    plane = Self::through(&kept)?;
                }
            }
            let error: f64 = ranked[..n_kept].iter().map(|(d, _)| d * d).sum();
            if error < best.0 {
                best = (error, plane);
            }
        }
        Some(best.1)
    }

    /// Elevation at a place; m.
    pub(super) fn height(&self, [x, y]: [f64; 2]) -> f64 {
        self.center[2]
            + self.gradient[0] * (x - self.center[0])
            + self.gradient[1] * (y - self.center[1])
    }
}
