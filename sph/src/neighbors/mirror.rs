//! Planes of symmetry: sides of the domain that mirror water and walls.
//!
//! The image of a neighbor has a mirrored position, reversed components of velocity and of gradients across the
//! plane, and the same density, pressure, volume and viscosity. Images are never created: the reflection
//! `R` preserves every term and is an involution, so that the sum of a receiver over the images of its neighbors
//! is the mirrored sum of its own image over the neighbors themselves,
//!
//! ```text
//! Σ_b f(a, R b) = R Σ_b f(R a, b)
//! ```
//! with the receiver's own image among the `R b`. Where two planes meet, images in both count, and in
//! three at a corner.

use crate::Vec3;

/// Sides of the domain that are planes of symmetry: the lower and the upper one along x, y, z.
pub type Symmetry = [[bool; 2]; 3];

/// Largest number of images of a point, including itself: along each axis in the lower plane, the upper one, or neither.
pub(crate) const MOST_IMAGES: usize = 27;

/// Worth of the digits of [`Image::planes`].
const PLANE_DIGITS: [u8; 3] = [1, 3, 9];

/// A side of the domain that is a plane of symmetry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SymmetryPlane {
    /// Direction across it: 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// Whether it is the upper side.
    pub is_upper: bool,
    /// Its coordinate; m.
    pub place: f64,
}

impl SymmetryPlane {
    /// Distance of a point from it, below zero beyond; m.
    pub fn distance(&self, x: &Vec3) -> f64 {
        if self.is_upper {
            self.place - x[self.axis]
        } else {
            x[self.axis] - self.place
        }
    }

    /// Unit normal, out of the domain.
    pub fn normal(&self) -> Vec3 {
        let mut normal = Vec3::zeros();
        normal[self.axis] = if self.is_upper { 1.0 } else { -1.0 };
        normal
    }

    /// Mirror image of a point; m.
    pub fn image_of(&self, x: &Vec3) -> Vec3 {
        let mut image = *x;
        image[self.axis] = 2.0 * self.place - x[self.axis];
        image
    }
}

/// A point, or its image in one plane or several.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Image {
    /// m.
    pub position: Vec3,
    /// Planes: a digit to base 3 for each axis, that of x the lowest; 0 for none, 1 the lower, 2 the upper.
    pub planes: u8,
}

impl Image {
    /// −1 along axes that are reversed, 1 along others.
    pub(crate) fn signs(&self) -> [f64; 3] {
        signs_in(self.planes)
    }
}

/// Signs of all images in given planes, see [`Image::planes`].
#[inline(always)]
pub(crate) fn signs_in(planes: u8) -> [f64; 3] {
    PLANE_DIGITS.map(|digit| match planes / digit % 3 {
        0 => 1.0,
        _ => -1.0,
    })
}

/// Positions of the planes; infinitely far away without a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mirrors {
    /// Whether there is a plane at all.
    is_any: bool,
    low: Vec3,
    high: Vec3,
}

impl Mirrors {
    /// Those of given sides of the domain.
    pub(crate) fn of(planes: impl Iterator<Item = SymmetryPlane>) -> Self {
        let mut mirrors = Self {
            is_any: false,
            low: Vec3::repeat(f64::NEG_INFINITY),
            high: Vec3::repeat(f64::INFINITY),
        };
        for plane in planes {
            mirrors.is_any = true;
            let side = if plane.is_upper {
                &mut mirrors.high
            } else {
                &mut mirrors.low
            };
            side[plane.axis] = plane.place;
        }
        mirrors
    }

    /// Writes a point and all its images within `reach` of the modeled side; returns
    /// their number. A point beyond a plane has its image in front of it.
    #[inline(always)]
    pub(crate) fn images_within(
        &self,
        position: &Vec3,
        reach: f64,
        images: &mut [Image; MOST_IMAGES],
    ) -> usize {
        images[0] = Image {
            position: *position,
            planes: 0,
        };
        if !self.is_any {
            return 1;
        }
        let mut n = 1;
        for axis in 0..3 {
            let n_before = n;
            let digit = PLANE_DIGITS[axis];
            for (distance, place, digit) in [
                (position[axis] - self.low[axis], self.low[axis], digit),
                (self.high[axis] - position[axis], self.high[axis], 2 * digit),
            ] {
                // without a plane the distance is infinite, and so is the reach before the first sort
                if distance < reach {
                    for k in 0..n_before {
                        let mut image = images[k];
                        image.position[axis] = 2.0 * place - position[axis];
                        image.planes += digit;
                        images[n] = image;
                        n += 1;
                    }
                }
            }
        }
        n
    }

    /// Whether there is a plane across an axis.
    pub(crate) fn are_across(&self, axis: usize) -> bool {
        self.low[axis].is_finite() || self.high[axis].is_finite()
    }

    /// Image of a point in given planes, see [`Image::planes`]; m.
    #[inline(always)]
    pub(crate) fn mirrored(&self, planes: u8, position: &Vec3) -> Vec3 {
        let mut image = *position;
        for axis in 0..3 {
            let place = match planes / PLANE_DIGITS[axis] % 3 {
                0 => continue,
                1 => self.low[axis],
                _ => self.high[axis],
            };
            image[axis] = 2.0 * place - position[axis];
        }
        image
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mirrors() -> Mirrors {
        Mirrors {
            is_any: true,
            low: Vec3::new(0.0, 0.0, f64::NEG_INFINITY),
            high: Vec3::new(1.0, f64::INFINITY, f64::INFINITY),
        }
    }

    fn images(x: Vec3) -> Vec<[f64; 3]> {
        let mut images = [Image::default(); MOST_IMAGES];
        let n = mirrors().images_within(&x, 0.2, &mut images);
        for image in &images[..n] {
            assert_eq!(mirrors().mirrored(image.planes, &x), image.position);
        }
        images[..n].iter().map(|i| i.position.into()).collect()
    }

    #[test]
    fn a_point_far_from_all_planes_has_no_image() {
        assert_eq!(images(Vec3::repeat(0.5)), [[0.5; 3]]);
    }

    #[test]
    fn a_point_at_an_edge_has_three_images() {
        let found = images(Vec3::new(0.125, 0.0625, 0.0));
        let expected = [
            [0.125, 0.0625, 0.0],
            [-0.125, 0.0625, 0.0],
            [0.125, -0.0625, 0.0],
            [-0.125, -0.0625, 0.0],
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn a_point_beyond_a_plane_has_its_image_before_it() {
        let found = images(Vec3::new(1.5, 0.5, 0.0));
        assert_eq!(found, [[1.5, 0.5, 0.0], [0.5, 0.5, 0.0]]);
    }
}
