//! Box that the flow of an opening crosses.

use riprap_sph::Vec3;

/// Box, crossed by the flow along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Lower corner; m.
    pub min: Vec3,
    /// Upper corner; m.
    pub max: Vec3,
    /// Direction of the flow: 0 for x, 1 for y.
    pub axis: usize,
    /// Whether the flow is in the positive direction.
    pub upward: bool,
}

impl Passage {
    /// Length along the flow; m.
    pub fn length(&self) -> f64 {
        self.max[self.axis] - self.min[self.axis]
    }

    /// Distance from the upstream face; m.
    pub(super) fn along(&self, x: &Vec3) -> f64 {
        if self.upward {
            x[self.axis] - self.min[self.axis]
        } else {
            self.max[self.axis] - x[self.axis]
        }
    }

    /// Whether a point is in the cross-section of the box, enlarged by `slack`.
    pub(super) fn is_abreast(&self, x: &Vec3, slack: f64) -> bool {
        (0..3)
            .filter(|&axis| axis != self.axis)
            .all(|axis| self.min[axis] - slack <= x[axis] && x[axis] <= self.max[axis] + slack)
    }

    /// Whether a point is in the box or less than a distance (m) from it.
    pub(super) fn is_near(&self, x: &Vec3, distance: f64) -> bool {
        let s = self.along(x);
        -distance < s && s < self.length() + distance && self.is_abreast(x, distance)
    }

    /// Whether a point is in the box, with its cross-section enlarged by `slack`.
    pub fn contains(&self, x: &Vec3, slack: f64) -> bool {
        let s = self.along(x);
        0.0 <= s && s < self.length() && self.is_abreast(x, slack)
    }

    pub(super) fn direction(&self) -> Vec3 {
        let mut direction = Vec3::zeros();
        direction[self.axis] = if self.upward { 1.0 } else { -1.0 };
        direction
    }
}
