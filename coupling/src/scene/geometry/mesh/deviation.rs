//! Differences of the convex parts of a mesh from what is drawn.

use std::fmt;

use riprap_dda::{Isometry, MassProperties};

/// Errors of the convex parts of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Number of parts.
    pub n_parts: usize,
    /// Volume that the parts have more, over that drawn; –.
    pub volume: f64,
    /// Distance of the centers of mass; m.
    pub center: f64,
    /// Largest difference of a principal moment of inertia, over that drawn; –.
    pub inertia: f64,
}

impl Deviation {
    /// Of `n_parts` convex parts with given properties in their place, from a drawing that is still to be placed.
    pub fn of(
        (n_parts, made): (usize, &MassProperties),
        drawn: &MassProperties,
        placement: &Isometry,
    ) -> Self {
        let center = placement.transform_point(&drawn.centroid.into()).coords;
        let moments = principal(made).into_iter().zip(principal(drawn));
        Self {
            n_parts,
            volume: made.volume / drawn.volume - 1.0,
            center: (made.centroid - center).norm(),
            inertia: moments
                .map(|(made, drawn)| made / drawn - 1.0)
                .fold(0.0, |most, this| {
                    if this.abs() > f64::abs(most) {
                        this
                    } else {
                        most
                    }
                }),
        }
    }
}

impl fmt::Display for Deviation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} convex parts, volume {:+.2} %, center of mass {:.1e} m off, moments of inertia up to {:+.2} %",
            self.n_parts,
            percent(self.volume),
            self.center,
            percent(self.inertia)
        )
    }
}

/// Percent to two digits, of which round-off leaves no sign.
fn percent(share: f64) -> f64 {
    (1e4 * share).round() / 1e2 + 0.0
}

/// Principal moments of inertia of density 1, in order; m⁵.
fn principal(properties: &MassProperties) -> [f64; 3] {
    let mut moments: [f64; 3] = properties.inertia().symmetric_eigenvalues().into();
    moments.sort_by(f64::total_cmp);
    moments
}
