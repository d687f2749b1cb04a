//! Volume, centroid and second moments of bodies of density 1.

use crate::Vec3;
use nalgebra::Matrix3;

/// Integrals over a body of density 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassProperties {
    /// Volume `V`; m³.
    pub volume: f64,
    /// Centroid `x_c`; m.
    pub centroid: Vec3,
    /// Second moment about the centroid, `S = ∫ (x − x_c)(x − x_c)ᵀ dV`; m⁵.
    pub second_moment: Matrix3<f64>,
}

impl MassProperties {
    /// Of a sphere.
    ///
    /// ```text
    /// V = 4/3 π r³        S = V r²/5 I
    /// ```
    pub fn of_sphere(center: Vec3, radius: f64) -> Self {
        let volume = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
        Self {
            volume,
            centroid: center,
            second_moment: Matrix3::identity() * (volume * radius * radius / 5.0),
        }
    }

    /// Of a union of bodies that do not overlap: sums, with each second moment shifted to the
    /// common centroid (parallel axes).
    ///
    /// ```text
    /// S = Σ_k S_k + V_k (x_k − x_c)(x_k − x_c)ᵀ
    /// ```
    pub fn of_union(parts: &[Self]) -> Self {
        let volume: f64 = parts.iter().map(|part| part.volume).sum();
        let origin = parts.first().map_or_else(Vec3::zeros, |part| part.centroid);
        let first_moment: Vec3 = parts
            .iter()
            .map(|part| (part.centroid - origin) * part.volume)
            .sum();
        let centroid = origin + first_moment / volume;
        let second_moment = parts
            .iter()
            .map(|part| {
                let r = part.centroid - centroid;
                part.second_moment + r * r.transpose() * part.volume
            })
            .sum();
        Self {
            volume,
            centroid,
            second_moment,
        }
    }

    /// Inertia tensor of density 1 about the centroid, `J = tr(S) I − S`; m⁵.
    pub fn inertia(&self) -> Matrix3<f64> {
        Matrix3::identity() * self.second_moment.trace() - self.second_moment
    }
}
