//! Bonds of parts that lay against each other at the start.
//!
//! ```text
//! breaks if   max_outline −(F_n/A + q·(x − c)) > T,      I q = Σ_k F_k (x_k − c),   I = ∫ (x − c)(x − c)ᵀ dA
//!        or   Σ_k |F_s,k| > c A + max(F_n, 0) tan φ                                            [Pa], [N]
//! ```
//! The first is the edge stress `N/A + M/W` of a section that stays plane, from net force and moment
//! rather than from the springs' own stresses: a third of the stiffness sits in the corners of a patch
//! (see `patch`). The second takes sizes before it sums, so that a twist about the normal counts; tension
//! does not take from the cohesion.

use crate::Vec3;
use crate::contact::report::PointState;
use crate::material::Joint;
use nalgebra::Matrix3;
use serde::{Deserialize, Serialize};

/// Bond of two parts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Bond {
    /// `A` at the start; m².
    pub area: f64,
}

impl Bond {
    /// Mohr-Coulomb with tension at the edge, for the bond as a whole. The corners of its patch are the
    /// `outline`.
    pub fn is_overloaded(
        &self,
        joint: &Joint,
        points: &[PointState],
        normal: &Vec3,
        outline: impl Iterator<Item = Vec3> + Clone,
    ) -> bool {
        let pressed: f64 = points.iter().map(|p| p.normal_force).sum();
        let sheared: f64 = points.iter().map(|p| p.shear_force.norm()).sum();
        sheared > self.shear_strength(joint, pressed)
            || edge_tension(points, normal, outline) > joint.tensile_strength
    }

    /// The same for a bond that is rigid, of the force on j (N) and its moment (N m) about the centroid of the patch: shear and twist are
    /// spread over the section as over equal springs, `|V/A + θ n × (x − c)|` at each point.
    pub fn is_rigidly_overloaded(
        &self,
        joint: &Joint,
        (force, moment): (&Vec3, &Vec3),
        normal: &Vec3,
        outline: &[Vec3],
    ) -> bool {
        let corners = outline.iter().copied();
        let Some(section) = Section::of(corners.clone(), normal) else {
            return false;
        };
        let pressed = force.dot(normal);
        let shear = force - normal * pressed;
        let sheared = section.sheared(&shear, moment.dot(normal), corners.clone(), normal);
        let tension = section.edge_tension(pressed, &normal.cross(moment), corners);
        sheared > self.shear_strength(joint, pressed) || tension > joint.tensile_strength
    }

    /// `c A + max(F_n, 0) tan φ`; N.
    fn shear_strength(&self, joint: &Joint, pressed: f64) -> f64 {
        joint.cohesion * self.area + pressed.max(0.0) * joint.friction
    }
}

/// Centroid of a convex polygon; `None` without area.
pub(crate) fn center(outline: &[Vec3], normal: &Vec3) -> Option<Vec3> {
    Section::of(outline.iter().copied(), normal).map(|section| section.center)
}

/// Largest tension at the outline of a patch, negative where all of it is pressed; Pa.
fn edge_tension(
    points: &[PointState],
    normal: &Vec3,
    outline: impl Iterator<Item = Vec3> + Clone,
) -> f64 {
    let Some(section) = Section::of(outline.clone(), normal) else {
        return 0.0;
    };
    let (mut force, mut moment) = (0.0, Vec3::zeros());
    for point in points {
        force += point.normal_force;
        moment += (point.at.position - section.center) * point.normal_force;
    }
    section.edge_tension(force, &moment, outline)
}

/// Triangles of a convex polygon around its first corner: area, middle, and the two other corners.
fn fan<'a>(
    first: Vec3,
    outline: impl Iterator<Item = Vec3> + Clone + 'a,
    normal: &'a Vec3,
) -> impl Iterator<Item = (f64, Vec3, Vec3, Vec3)> + 'a {
    let rest = outline.clone().skip(1);
    rest.zip(outline.skip(2)).map(move |(from, to)| {
        let area = 0.5 * (from - first).cross(&(to - first)).dot(normal);
        (area.abs(), (first + from + to) / 3.0, from, to)
    })
}

/// Area, centroid and second moment of a convex polygon in its plane.
struct Section {
    area: f64,
    center: Vec3,
    /// In the plane; nothing across it; 1/m⁴.
    inverse_second_moment: Matrix3<f64>,
}

impl Section {
    /// `None` without area.
    fn of(outline: impl Iterator<Item = Vec3> + Clone, normal: &Vec3) -> Option<Self> {
        let first = outline.clone().next()?;
        let fan = || fan(first, outline.clone(), normal);
        let area: f64 = fan().map(|(area, ..)| area).sum();
        if area <= 0.0 {
            return None;
        }
        let center: Vec3 = fan()
            .map(|(share, middle, ..)| middle * (share / area))
            .sum();
        let square = |x: &Vec3| {
            let y = x - center;
            let flat = y - normal * y.dot(normal);
            flat * flat.transpose()
        };
        // Corners and centroid integrate quadratics over a triangle.
        let mut second_moment = Matrix3::zeros();
        for (share, middle, from, to) in fan() {
            let corners = square(&first) + square(&from) + square(&to);
            second_moment += (corners / 12.0 + square(&middle) * 0.75) * share;
        }
        // Anything across the plane makes it invertible; nothing lies there.
        let across = normal * normal.transpose();
        let inverse = (second_moment + across * second_moment.trace()).try_inverse()?;
        Some(Self {
            area,
            center,
            inverse_second_moment: inverse - across * across.component_mul(&inverse).sum(),
        })
    }

    /// Largest tension of a force (N) and of its first moment `Σ F_k (x_k − c)` (N m), negative where all is pressed; Pa.
    fn edge_tension(&self, force: f64, moment: &Vec3, outline: impl Iterator<Item = Vec3>) -> f64 {
        let slope = self.inverse_second_moment * moment;
        outline
            .map(|x| -force / self.area - slope.dot(&(x - self.center)))
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// Sum of the sizes of the shear forces of a shear (N) and a twisting moment (N m); N.
    fn sheared(
        &self,
        shear: &Vec3,
        twist: f64,
        outline: impl Iterator<Item = Vec3> + Clone,
        normal: &Vec3,
    ) -> f64 {
        let Some(first) = outline.clone().next() else {
            return 0.0;
        };
        // exact for quadratics, as is the square of the arm
        let integral = |of: &dyn Fn(Vec3) -> f64| -> f64 {
            fan(first, outline.clone(), normal)
                .map(|(share, middle, from, to)| {
                    share * ((of(first) + of(from) + of(to)) / 12.0 + 0.75 * of(middle))
                })
                .sum()
        };
        let arm = |x: Vec3| normal.cross(&(x - self.center));
        let polar = integral(&|x| arm(x).norm_squared());
        integral(&|x| (shear / self.area + arm(x) * (twist / polar)).norm())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `b h³/12` of a rectangle of 2 by 3 m, turned in space and away from the origin.
    #[test]
    fn section_of_a_rectangle() {
        let turn = nalgebra::Rotation3::new(Vec3::new(0.4, -0.7, 1.1));
        let place = |y: f64, z: f64| turn * Vec3::new(0.0, y, z) + Vec3::new(5.0, -2.0, 1.0);
        let outline = [
            place(0.0, 0.0),
            place(2.0, 0.0),
            place(2.0, 3.0),
            place(0.0, 3.0),
        ];
        let section = Section::of(outline.into_iter(), &(turn * Vec3::x())).map(|s| {
            let inverse = turn.matrix().transpose() * s.inverse_second_moment * turn.matrix();
            (s.area, s.center - place(1.0, 1.5), inverse)
        });
        let expected = Matrix3::from_diagonal(&Vec3::new(0.0, 12.0 / 24.0, 12.0 / 54.0));
        assert!(section.is_some_and(|(area, shift, inverse)| {
            (area - 6.0).abs() < 1e-12
                && shift.norm() < 1e-12
                && (inverse - expected).norm() < 1e-12
        }));
    }
}
