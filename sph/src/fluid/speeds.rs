//! Range of the velocities of particles: how fast one of them moves, and how fast two approach each other.
//!
//! Water that runs down a slope or behind a front moves much and changes little: a pair approaches no faster than the diagonal of
//! the box that holds all velocities, which is less than twice the largest speed where all flow one way.

use crate::Vec3;
use crate::neighbors::mirror::Symmetry;

/// Box of some velocities.
#[derive(Clone, Copy, Debug)]
pub(super) struct Speeds {
    /// Square of the largest speed; m²/s².
    square: f64,
    /// m/s.
    low: Vec3,
    high: Vec3,
}

impl Speeds {
    /// Those of no particle.
    pub(super) const NOTHING: Self = Self {
        square: 0.0,
        low: Vec3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY),
        high: Vec3::new(f64::NEG_INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY),
    };

    /// Those of particles at rest.
    pub(super) const STILL: Self = Self {
        square: 0.0,
        low: Vec3::new(0.0, 0.0, 0.0),
        high: Vec3::new(0.0, 0.0, 0.0),
    };

    #[inline(always)]
    pub(super) fn include(&mut self, velocity: &Vec3) {
        self.square = self.square.max(velocity.norm_squared());
        self.low = self.low.inf(velocity);
        self.high = self.high.sup(velocity);
    }

    /// Those of either; the same in any order.
    pub(super) fn and(self, other: Self) -> Self {
        Self {
            square: self.square.max(other.square),
            low: self.low.inf(&other.low),
            high: self.high.sup(&other.high),
        }
    }

    /// Largest speed; m/s.
    pub(super) fn largest(&self) -> f64 {
        self.square.sqrt()
    }

    /// Bound on the relative speed of two particles, or of one and the image of another; m/s.
    pub(super) fn closing(&self, symmetry: Symmetry) -> f64 {
        let mut extent = self.high - self.low;
        for axis in 0..3 {
            if symmetry[axis].contains(&true) {
                // images move the other way
                extent[axis] = 2.0 * self.high[axis].abs().max(self.low[axis].abs());
            }
        }
        // without particles it is below zero
        let twice = 2.0 * self.largest();
        extent.map(|e| e.max(0.0)).norm().min(twice)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPEN: Symmetry = [[false; 2]; 3];

    fn of(velocities: &[Vec3]) -> Speeds {
        let mut speeds = Speeds::NOTHING;
        velocities.iter().for_each(|v| speeds.include(v));
        speeds
    }

    #[test]
    fn flow_one_way_closes_by_its_differences() {
        let flow = of(&[Vec3::new(3.0, 0.0, 0.0), Vec3::new(3.5, 0.1, -0.2)]);
        // by hand: the diagonal of 0.5, 0.1 and 0.2
        assert!((flow.closing(OPEN) - 0.3_f64.sqrt()).abs() < 1e-15);
        assert!((flow.largest() - 12.3_f64.sqrt()).abs() < 1e-15);
        // water at rest beside it
        let beside = flow.and(Speeds::STILL);
        assert!(3.5 < beside.closing(OPEN) && beside.closing(OPEN) < 3.6);
    }

    #[test]
    fn opposite_flows_close_at_twice_their_speed() {
        let spray = [Vec3::x(), -Vec3::x(), Vec3::z(), -Vec3::z()].map(|v| 2.0 * v);
        // the diagonal of the box is longer
        assert_eq!(of(&spray).closing(OPEN), 4.0);
    }

    #[test]
    fn an_image_moves_the_other_way_across_its_plane() {
        let flow = of(&[Vec3::new(3.0, 1.0, 0.0)]);
        assert_eq!(flow.closing(OPEN), 0.0);
        assert_eq!(flow.closing([[true, false], [false; 2], [false; 2]]), 6.0);
        assert_eq!(flow.closing([[false; 2], [false, true], [false; 2]]), 2.0);
    }

    #[test]
    fn nothing_closes_on_nothing() {
        assert_eq!(Speeds::NOTHING.closing(OPEN), 0.0);
        assert_eq!(Speeds::STILL.closing(OPEN), 0.0);
    }
}
