//! Prescribed motion along a path: straight pieces and arcs in a plane.

use nalgebra::Vector2;
use thiserror::Error;

use super::table::table_at;
use crate::Vec3;

/// Smallest distance of two points, and largest of a point from the plane of the path; × its size.
const ROUND_OFF: f64 = 1e-9;
/// Iterations for the ends of a base; Newton's method takes five.
const ITERATIONS: usize = 50;

/// Smooth path in a plane: straight pieces between points, and arcs at the bends.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// First point; m.
    origin: Vec3,
    /// Unit vectors in its plane: along the first piece, and across it.
    along: Vec3,
    across: Vec3,
    pieces: Vec<Piece>,
    length: f64,
    cuts: Vec<Cut>,
}

/// A piece of a path, in its plane.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Piece {
    start: Vector2<f64>,
    /// Angle of its direction at the start; rad.
    heading: f64,
    /// 0 of a straight piece; 1/m.
    curvature: f64,
    /// Length of the path up to it; m.
    way: f64,
}

/// An arc in the place of a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// Number of the point that it passes by.
    pub point: usize,
    /// Its radius; m.
    pub radius: f64,
    /// Its distance from the point; m.
    pub distance: f64,
}

/// A list of points that no path goes through.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum PathError {
    /// Fewer than two points.
    #[error("a path needs at least two points")]
    TooFewPoints,
    /// A point in the place of the one before it.
    #[error("point {0} is where the one before it is")]
    Repeated(usize),
    /// A point outside of the plane of those before it.
    #[error("point {0} is not in the plane of the points before it")]
    NotPlane(usize),
    /// A point at which the path turns back.
    #[error("the path turns back at point {0}")]
    TurnsBack(usize),
}

impl Path {
    /// Path along points (m), with arcs of a radius (m), or smaller ones where half of a neighboring piece is too short for that.
    ///
    /// # Errors
    ///
    /// [`PathError`] with the number of the point, from 0.
    pub fn through(points: &[Vec3], radius: f64) -> Result<Self, PathError> {
        let [origin, second, ..] = points else {
            return Err(PathError::TooFewPoints);
        };
        let size = points
            .iter()
            .map(|x| (x - origin).norm())
            .fold(0.0, f64::max);
        let along = (second - origin)
            .try_normalize(ROUND_OFF * size)
            .ok_or(PathError::Repeated(1))?;
        let aside = |x: &Vec3| (x - origin) - along * along.dot(&(x - origin));
        let off = points
            .iter()
            .map(aside)
            .find(|off| ROUND_OFF * size < off.norm());
        // without a bend there is no rotation, and any plane serves
        let across = off.unwrap_or_else(|| {
            let axis = along.iamin();
            along.cross(&Vec3::ith(axis, 1.0))
        });
        let across = across.normalize();
        let mut flat: Vec<Vector2<f64>> = Vec::with_capacity(points.len());
        for (k, x) in points.iter().enumerate() {
            let rel = x - origin;
            let place = Vector2::new(along.dot(&rel), across.dot(&rel));
            if ROUND_OFF * size < (rel - along * place.x - across * place.y).norm() {
                return Err(PathError::NotPlane(k));
            }
            if let Some(last) = flat.last()
                && (place - last).norm() <= ROUND_OFF * size
            {
                return Err(PathError::Repeated(k));
            }
            flat.push(place);
        }
        let mut path = Self {
            origin: *origin,
            along,
            across,
            pieces: Vec::new(),
            length: 0.0,
            cuts: Vec::new(),
        };
        path.lay(&flat, radius)?;
        Ok(path)
    }

    fn lay(&mut self, points: &[Vector2<f64>], radius: f64) -> Result<(), PathError> {
        let legs: Vec<Vector2<f64>> = points.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let mut heading = 0.0;
        // length of a leg that the arc before it takes
        let mut taken = 0.0;
        for (k, leg) in legs.iter().enumerate() {
            let length = leg.norm();
            let direction = leg / length;
            let next = legs.get(k + 1).map(|next| {
                let next = next.normalize();
                (direction.perp(&next).atan2(direction.dot(&next)), next)
            });
            let turn = next.map_or(0.0, |(turn, _)| turn);
            if (1.0 - ROUND_OFF) * std::f64::consts::PI < turn.abs() {
                return Err(PathError::TurnsBack(k + 1));
            }
            let per_radius = (0.5 * turn.abs()).tan();
            let room = 0.5
                * legs
                    .get(k + 1)
                    .map_or(length, |next| length.min(next.norm()));
            let is_bend = ROUND_OFF < turn.abs();
            let given = match is_bend {
                true => room.min(radius * per_radius),
                false => 0.0,
            };
            self.push(
                points[k] + direction * taken,
                (heading, 0.0),
                length - taken - given,
            );
            if is_bend {
                let radius = given / per_radius;
                let arc = radius * turn.abs();
                let start = points[k + 1] - direction * given;
                self.push(start, (heading, turn.signum() / radius), arc);
                self.cuts.push(Cut {
                    point: k + 1,
                    radius,
                    distance: radius * (1.0 / (0.5 * turn).cos() - 1.0),
                });
            }
            heading += turn;
            taken = given;
        }
        Ok(())
    }

    fn push(&mut self, start: Vector2<f64>, (heading, curvature): (f64, f64), length: f64) {
        self.pieces.push(Piece {
            start,
            heading,
            curvature,
            way: self.length,
        });
        self.length += length.max(0.0);
    }

    /// Length; m.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Arcs in the place of corners, in order.
    pub fn cuts(&self) -> &[Cut] {
        &self.cuts
    }

    /// Unit vector across its plane, which it turns about.
    pub fn axis(&self) -> Vec3 {
        self.along.cross(&self.across)
    }

    fn in_space(&self, v: Vector2<f64>) -> Vec3 {
        self.along * v.x + self.across * v.y
    }

    /// Place in its plane (m) and angle (rad) at a way (m), straight on before its start and beyond its end.
    fn at(&self, way: f64) -> (Vector2<f64>, f64) {
        let n = self.pieces.partition_point(|piece| piece.way <= way);
        let piece = self.pieces[n.max(1) - 1];
        let s = way - piece.way;
        let turned = piece.curvature * s;
        let heading = piece.heading + turned;
        // chord of the arc: sin(κs/2)/(κ/2), in the mean direction
        let half = 0.5 * turned;
        let chord = match half == 0.0 {
            true => s,
            false => s * half.sin() / half,
        };
        (
            piece.start + direction(piece.heading + half) * chord,
            heading,
        )
    }

    /// Curvature at a way (m), positive towards its left; 1/m.
    fn curvature(&self, way: f64) -> f64 {
        let n = self.pieces.partition_point(|piece| piece.way <= way);
        match way < self.length {
            true => self.pieces[n.max(1) - 1].curvature,
            false => 0.0,
        }
    }

    /// Half of the way between the two ends of a base of a length (m) in the middle of which the way is `way` (m): Newton's method from
    /// a straight path on, as far as the path is no shorter than a chord of it.
    fn half_base(&self, way: f64, base: f64) -> f64 {
        let mut half = 0.5 * base;
        for _ in 0..ITERATIONS {
            let ((rear, from), (front, to)) = (self.at(way - half), self.at(way + half));
            let chord = front - rear;
            let excess = chord.norm_squared() - base * base;
            let slope = 2.0 * chord.dot(&(direction(to) + direction(from)));
            if excess.abs() <= 4.0 * f64::EPSILON * base * base || slope <= 0.0 {
                break;
            }
            half = (half - excess / slope).clamp(0.5 * base, base);
        }
        half
    }
}

fn direction(angle: f64) -> Vector2<f64> {
    Vector2::new(angle.cos(), angle.sin())
}

/// Motion of a body along a path, turned as the path is: by its direction at one point, or by both ends of a base of a length `L`.
///
/// ```text
/// |P(w + h) − P(w − h)| = L,   h' = −w' D·(T₊ − T₋)/D·(T₊ + T₋),   D = P(w + h) − P(w − h)
/// ```
/// with the way `w`, the path `P` and its tangents `T` at the ends. The way is a table, by monotone cubics.
#[derive(Clone, Debug, PartialEq)]
pub struct Sliding {
    path: Path,
    base: f64,
    time: Vec<f64>,
    /// Way in the first component; m.
    way: Vec<Vec3>,
    /// From the place on the path to the centroid, as drawn; m.
    arm: Vec3,
    /// Place and angle on the path, as drawn.
    drawn: (Vec3, f64),
}

/// Place on a path, and its rate.
struct Pose {
    place: Vec3,
    velocity: Vec3,
    angle: f64,
    spin: f64,
}

impl Sliding {
    /// Motion of a body with a centroid (m), drawn where it is at the first of its times (s); `base` (m) may be 0; way in m.
    pub fn new(path: Path, base: f64, table: &[[f64; 2]], centroid: Vec3) -> Self {
        let mut sliding = Self {
            path,
            base,
            time: table.iter().map(|row| row[0]).collect(),
            way: table.iter().map(|row| Vec3::x() * row[1]).collect(),
            arm: Vec3::zeros(),
            drawn: (Vec3::zeros(), 0.0),
        };
        if let Some(&[first, _]) = table.first() {
            let Pose { place, angle, .. } = sliding.pose(first);
            sliding.arm = centroid - place;
            sliding.drawn = (place, angle);
        }
        sliding
    }

    /// The path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Place on the path that the body is drawn at; m.
    pub fn place_drawn(&self) -> Vec3 {
        self.drawn.0
    }

    /// Ways of the rear and of the front end of its base when its way is `way`; m.
    pub fn ends(&self, way: f64) -> [f64; 2] {
        let half = self.path.half_base(way, self.base);
        [way - half, way + half]
    }

    /// Displacement and velocity of the centroid at a time (s); m, m/s.
    pub(super) fn displacement(&self, time: f64) -> (Vec3, Vec3) {
        let pose = self.pose(time);
        let axis = self.path.axis();
        let turn = nalgebra::UnitQuaternion::from_scaled_axis(axis * (pose.angle - self.drawn.1));
        let arm = turn * self.arm;
        let moved = pose.place - self.drawn.0 + arm - self.arm;
        (moved, pose.velocity + axis.cross(&arm) * pose.spin)
    }

    /// Rotation vector and its rate at a time (s); rad, rad/s.
    pub(super) fn turning(&self, time: f64) -> (Vec3, Vec3) {
        let pose = self.pose(time);
        let axis = self.path.axis();
        (axis * (pose.angle - self.drawn.1), axis * pose.spin)
    }

    /// Whether its numbers make a motion.
    pub(super) fn check(&self) -> Result<(), &'static str> {
        let way = self.way.iter().map(|way| way.x);
        if self.time.is_empty() {
            Err("the motion along a path needs at least one time")
        } else if !self.time.windows(2).all(|t| t[0] < t[1]) {
            Err("the times of the motion along a path must increase")
        } else if !self.time.iter().copied().chain(way).all(f64::is_finite) {
            Err("the motion along a path has a number that is not finite")
        } else if !(0.0 <= self.base && self.base.is_finite()) {
            Err("the base on the path must be >= 0 m")
        } else {
            Ok(())
        }
    }

    fn pose(&self, time: f64) -> Pose {
        let (way, rate) = table_at(&self.time, &self.way, time);
        let (way, rate) = (way.x, rate.x);
        let path = &self.path;
        if self.base == 0.0 {
            let (place, angle) = path.at(way);
            let curvature = path.curvature(way);
            return Pose {
                place: path.origin + path.in_space(place),
                velocity: path.in_space(direction(angle)) * rate,
                angle,
                spin: curvature * rate,
            };
        }
        let half = path.half_base(way, self.base);
        let ((rear, from), (front, to)) = (path.at(way - half), path.at(way + half));
        let (from, to) = (direction(from), direction(to));
        let chord = front - rear;
        let widening = -rate * chord.dot(&(to - from)) / chord.dot(&(to + from));
        let (of_rear, of_front) = (from * (rate - widening), to * (rate + widening));
        Pose {
            place: path.origin + path.in_space((rear + front) * 0.5),
            velocity: path.in_space((of_rear + of_front) * 0.5),
            angle: chord.y.atan2(chord.x),
            spin: chord.perp(&(of_front - of_rear)) / chord.norm_squared(),
        }
    }
}
