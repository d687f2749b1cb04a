//! Solids continued beyond the sides of the slice of a 2-D flow, or of a periodic domain.

use riprap_sph::boundary::sampling::Region;
use riprap_sph::{Dimensions, Fluid, Periodicity, Vec3};

use super::{Part, face_lattice};

/// Stretch of a solid along an axis without ends, so that its ends are beyond the support.
const STRETCH: f64 = 1e3;
/// The least width it then has, however thin the slice; × the spacing.
const LEAST_WIDTH: f64 = 100.0;

/// In which directions solids have no end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Endless {
    /// Region inside the periodic sides; solids beyond are already present as images; m.
    pub(super) domain: Region,
    pub(super) periodic: Periodicity,
    is_plane: bool,
    /// Between particles; m.
    spacing: f64,
    /// Solids this near to a side reach it; m.
    slack: f64,
}

impl Endless {
    pub(super) fn of(fluid: &Fluid) -> Self {
        let settings = fluid.settings();
        let (min, max) = settings.domain;
        let (spacing, _) = face_lattice(fluid);
        Self {
            domain: Region { min, max },
            periodic: settings.periodic,
            is_plane: settings.dimensions != Dimensions::Three,
            spacing,
            // of a slice much thinner than a spacing a thousandth of its width
            slack: 1e-6 * spacing.min(1e3 * (max.y - min.y)),
        }
    }

    /// Whether a 2-D flow includes a part, which is not beside its slice.
    pub(super) fn reaches_domain(&self, part: &Part) -> bool {
        let (low, high) = part.aabb();
        let Region { min, max } = &self.domain;
        !self.is_plane || (low.y < max.y - self.slack && min.y + self.slack < high.y)
    }

    /// Whether a part spans the whole slice of a 2-D flow, or the whole period of the domain.
    pub(super) fn has_no_end(&self, part: &Part, axis: usize) -> bool {
        let Region { min, max } = &self.domain;
        let (low, high) = part.aabb();
        let spans = low[axis] < min[axis] + self.slack && max[axis] - self.slack < high[axis];
        (self.is_plane && axis == 1) || (self.periodic[axis] && spans)
    }

    /// The part without its ends across a 2-D flow, or at both sides of a periodic domain.
    pub(super) fn without_ends(&self, part: &Part) -> Part {
        let Region { min, max } = &self.domain;
        (0..3)
            .filter(|&axis| self.has_no_end(part, axis))
            .fold(part.clone(), |part, axis| {
                let middle = 0.5 * (min[axis] + max[axis]);
                let stretch = STRETCH.max(LEAST_WIDTH * self.spacing / (max[axis] - min[axis]));
                part.along(axis, |x| middle + stretch * (x - middle))
            })
    }

    /// The part with the ends that it has there at a distance (m) beyond the sides, and a prism's no farther.
    pub(super) fn ending_beyond(&self, part: &Part, distance: f64) -> Part {
        let Region { min, max } = &self.domain;
        (0..3)
            .filter(|&axis| self.has_no_end(part, axis))
            .fold(part.clone(), |part, axis| {
                let (low, high) = (min[axis], max[axis]);
                let is_slice = self.is_plane && axis == 1;
                let middle = 0.5 * (low + high);
                part.along(axis, |x| {
                    if x < low + self.slack || (is_slice && x < middle) {
                        low - distance
                    } else if high - self.slack < x || is_slice {
                        high + distance
                    } else {
                        x
                    }
                })
            })
    }

    /// The portion of the part inside the domain along axes without ends, which is all that counts there.
    pub(super) fn inside(&self, part: &Part) -> Part {
        let Region { min, max } = &self.domain;
        (0..3)
            .filter(|&axis| self.has_no_end(part, axis))
            .fold(part.clone(), |part, axis| {
                part.along(axis, |x| x.clamp(min[axis], max[axis]))
            })
    }

    /// The first axis in which a part has no end.
    pub(super) fn first_of(&self, part: &Part) -> Option<usize> {
        (0..3).find(|&axis| self.has_no_end(part, axis))
    }
}

impl Part {
    /// With every corner moved along an axis.
    pub(super) fn along(&self, axis: usize, map: impl Fn(f64) -> f64) -> Self {
        let moved = |x: &Vec3| {
            let mut x = *x;
            x[axis] = map(x[axis]);
            x
        };
        Self {
            faces: self
                .faces
                .iter()
                .map(|(normal, corners)| (*normal, corners.iter().map(moved).collect()))
                .collect(),
        }
    }
}
