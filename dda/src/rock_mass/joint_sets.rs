//! Rock masses cut into blocks by sets of joints.
//!
//! Orientations as geologists give them: the dip is measured down from the horizontal, the dip
//! direction clockwise from north, which is +y; east is +x. The upward normal of a joint is
//!
//! ```text
//! n = (sin dip sin dd, sin dip cos dd, cos dip)
//! s = (cos dd, −sin dd, 0)                          strike
//! d = (cos dip sin dd, cos dip cos dd, −sin dip)    down the dip
//! ```
//! Orientations scatter about s and d, so that a mass rotated about the vertical with its joints gives
//! the same blocks, rotated. About another axis it does not: s and d stay horizontal and downhill.

mod slivers;
mod unions;

use crate::{Plane, Polyhedron, Random, Vec3};
pub use slivers::{MergedMass, SliverLimits, hull_within, merge_slivers, merge_union_slivers};
use std::ops::RangeInclusive;
use thiserror::Error;
pub use unions::{JointedUnion, cut_union_by_joints};

/// Joints of one orientation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointSet {
    /// Dip, 0 to π/2; rad.
    pub dip: f64,
    /// Dip direction; rad.
    pub dip_direction: f64,
    /// Distance of the joints, > 0; m.
    pub spacing: f64,
    /// A point through which one joint passes; m.
    pub origin: Vec3,
    /// Chance that a joint cuts a block which it meets, 0 to 1.
    pub persistence: f64,
    /// Scatter σ of the orientation, ≥ 0: the normal leans by `σ ξ` along its strike and its dip, ξ standard normal. Leans beyond 3σ, 1.1 % of all, are drawn again: joints lean by 1.23 σ in the
    /// mean and by `atan 3σ` at most; rad.
    pub scatter: f64,
    /// Largest offset of a joint from its regular position, over the spacing, 0 to 0.5.
    pub spacing_scatter: f64,
}

/// Error of cutting a rock mass.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum JointError {
    /// A number of a set is out of range.
    #[error("joint set {set}: {field} is {value}, {rule}")]
    Set {
        /// Position of the set.
        set: usize,
        /// Name of the number.
        field: &'static str,
        /// Its value.
        value: f64,
        /// Its range.
        rule: &'static str,
    },
    /// A limit of slivers is out of range.
    #[error("slivers: {field} is {value}, {rule}")]
    Slivers {
        /// Name of the limit.
        field: &'static str,
        /// Its value.
        value: f64,
        /// Its range.
        rule: &'static str,
    },
    /// More blocks than allowed. The number is the mean over all positions of the joints.
    #[error(
        "the joints would make about {expected:.0} blocks, more than {limit}; joint set {set} has the closest joints \
         ({spacing} m): widen its spacing, or allow more blocks"
    )]
    TooMany {
        /// Blocks expected.
        expected: f64,
        /// Allowed.
        limit: usize,
        /// The set with the closest joints.
        set: usize,
        /// Its spacing; m.
        spacing: f64,
    },
}

/// A rock mass cut by joints.
#[derive(Clone, Debug, PartialEq)]
pub struct JointedMass {
    /// Its blocks, in the order in which the joints made them.
    pub blocks: Vec<Polyhedron>,
    /// Cuts that were not made, because a piece would have been too thin to be a polyhedron.
    pub n_uncut: usize,
    /// Joints that cut a block, in the order in which they did.
    pub joints: Vec<Joint>,
}

/// One joint of a set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// Position of its set.
    pub set: usize,
    /// Its plane.
    pub plane: Plane,
}

impl JointSet {
    /// Upward unit normal.
    pub fn normal(&self) -> Vec3 {
        let (dip, direction) = (self.dip.sin_cos(), self.dip_direction.sin_cos());
        Vec3::new(dip.0 * direction.0, dip.0 * direction.1, dip.1)
    }

    /// Unit vectors along the strike and down the dip.
    fn axes(&self) -> (Vec3, Vec3) {
        let (dip, direction) = (self.dip.sin_cos(), self.dip_direction.sin_cos());
        let strike = Vec3::new(direction.1, -direction.0, 0.0);
        let down = Vec3::new(dip.1 * direction.0, dip.1 * direction.1, -dip.0);
        (strike, down)
    }

    fn check(&self, set: usize) -> Result<(), JointError> {
        let half_pi = std::f64::consts::FRAC_PI_2;
        let fields = [
            (
                "dip",
                self.dip,
                (0.0..=half_pi).contains(&self.dip),
                "must be in [0, π/2] rad",
            ),
            ("dip_direction", self.dip_direction, true, "must be finite"),
            ("spacing", self.spacing, self.spacing > 0.0, "must be > 0 m"),
            ("origin", self.origin.sum(), true, "must be finite"),
            (
                "persistence",
                self.persistence,
                (0.0..=1.0).contains(&self.persistence),
                "must be in [0, 1]",
            ),
            (
                "scatter",
                self.scatter,
                self.scatter >= 0.0,
                "must be >= 0 rad",
            ),
            (
                "spacing_scatter",
                self.spacing_scatter,
                (0.0..=0.5).contains(&self.spacing_scatter),
                "must be in [0, 0.5]",
            ),
        ];
        match fields
            .into_iter()
            .find(|(_, value, is_good, _)| !(*is_good && value.is_finite()))
        {
            Some((field, value, _, rule)) => Err(JointError::Set {
                set,
                field,
                value,
                rule,
            }),
            None => Ok(()),
        }
    }

    /// Numbers of the joints that reach a span of heights along the normal, and one beyond at each end.
    fn numbers(&self, (low, high): (f64, f64)) -> RangeInclusive<i64> {
        let start = self.normal().dot(&self.origin);
        // A joint in the end of the span counts as inside whichever way its height was rounded: with one
        // joint more or less all random numbers after it would change.
        let first = ((low - start) / self.spacing - SAME_PLACE).ceil() as i64 - 1;
        let last = ((high - start) / self.spacing + SAME_PLACE).floor() as i64 + 1;
        first..=last
    }

    /// Joint number `k` of a mass about `middle`.
    fn plane(&self, k: i64, middle: &Vec3, random: &mut Random) -> Plane {
        let normal = self.normal();
        let shift = self.spacing_scatter * (2.0 * random.uniform() - 1.0);
        let offset = normal.dot(&self.origin) + (k as f64 + shift) * self.spacing;
        let (strike, down) = self.axes();
        let (a, b) = lean(random);
        let tilt = (strike * a + down * b) * self.scatter;
        // Tilted about the point nearest to the middle of the mass.
        let pivot = middle + normal * (offset - normal.dot(middle));
        Plane::through(&pivot, &(normal + tilt))
    }
}

/// A joint nearer than this to the end of a mass lies in it; × spacing.
const SAME_PLACE: f64 = 1e-9;

/// Most joints of one set. Beyond the number of blocks that can be computed with; reached only where
/// chance leaves nearly all of them out.
const MOST_JOINTS: i64 = 1_000_000;

/// Cuts convex bodies by all joints of all sets, in their order. The same seed gives the same blocks.
///
/// Volumes of the blocks add up to those of the bodies. A joint that would only shave off a piece too
/// thin to be a body does not cut, and is counted. Random numbers are drawn only for joints that would
/// cut a block, so that a mass far from the origin, where rounding is coarser, gives the same
/// blocks.
///
/// # Errors
///
/// [`JointError::Set`] for numbers out of range, [`JointError::TooMany`] before the first cut if the
/// spacings imply more than `max_blocks`, or as soon as there are more. Memory never holds more
/// than these.
pub fn cut_by_joints(
    bodies: Vec<Polyhedron>,
    sets: &[JointSet],
    seed: u64,
    max_blocks: usize,
) -> Result<JointedMass, JointError> {
    let expected = expected_blocks(&bodies, sets);
    // A whole number of joints may be rounded up.
    if expected.at_least * (1.0 - SAME_PLACE) > max_blocks as f64 {
        check(sets)?;
        return Err(too_many(sets, max_blocks, expected.about));
    }
    let cut = cut_bodies(bodies, sets, seed, (max_blocks, expected.about))?;
    Ok(JointedMass {
        blocks: cut.bodies,
        n_uncut: cut.n_uncut,
        joints: cut.joints,
    })
}

fn check(sets: &[JointSet]) -> Result<(), JointError> {
    let mut numbered = sets.iter().enumerate();
    numbered.try_for_each(|(k, set)| set.check(k))
}

fn too_many(sets: &[JointSet], max_blocks: usize, expected: f64) -> JointError {
    let closest = (0..sets.len()).min_by(|&a, &b| sets[a].spacing.total_cmp(&sets[b].spacing));
    let set = closest.unwrap_or(0);
    JointError::TooMany {
        expected,
        limit: max_blocks,
        set,
        spacing: sets.get(set).map_or(0.0, |set| set.spacing),
    }
}

/// A body cut by joints.
trait Body: Sized {
    /// The convex body about which chance decides.
    fn whole(&self) -> &Polyhedron;

    /// Its corners, which bound the joints needed.
    fn corners(&self) -> impl Iterator<Item = &Vec3>;

    /// Its pieces in the halves of the whole; counts omitted cuts.
    fn divided(self, halves: [Polyhedron; 2], plane: &Plane, n_uncut: &mut usize) -> Vec<Self>;
}

impl Body for Polyhedron {
    fn whole(&self) -> &Polyhedron {
        self
    }

    fn corners(&self) -> impl Iterator<Item = &Vec3> {
        self.vertices().iter()
    }

    fn divided(self, halves: [Polyhedron; 2], _: &Plane, _: &mut usize) -> Vec<Self> {
        halves.into()
    }
}

/// Bodies after the cuts.
struct CutBodies<B> {
    bodies: Vec<B>,
    /// Cuts that were not made.
    n_uncut: usize,
    /// Joints that cut a body.
    joints: Vec<Joint>,
}

/// Cuts bodies by all joints; at most so many blocks, where so many are expected.
fn cut_bodies<B: Body>(
    bodies: Vec<B>,
    sets: &[JointSet],
    seed: u64,
    (max_blocks, expected): (usize, f64),
) -> Result<CutBodies<B>, JointError> {
    check(sets)?;
    let mut random = Random::new(seed);
    // Separate from the joints' numbers: the blocks cut by a joint do not affect the position of the next one.
    let mut chance = Random::new(!seed);
    let mut blocks = bodies;
    let (mut n_uncut, mut joints) = (0, Vec::new());
    for (number, set) in sets.iter().enumerate() {
        let corners = || blocks.iter().flat_map(Body::corners);
        let (low, high) = span(corners(), &set.normal());
        let middle = corners().sum::<Vec3>() / corners().count().max(1) as f64;
        // A tilted joint may reach in from outside of the span: by its largest slope over the radius.
        let reach = corners().map(|x| (x - middle).norm()).fold(0.0, f64::max);
        let margin = LARGEST_LEAN * set.scatter * reach;
        let numbers = set.numbers((low - margin, high + margin));
        if numbers.end().saturating_sub(*numbers.start()) > MOST_JOINTS {
            return Err(JointError::Set {
                set: number,
                field: "spacing",
                value: set.spacing,
                rule: "must leave at most a million joints across the mass, with the margin of their scatter",
            });
        }
        for k in numbers {
            let plane = set.plane(k, &middle, &mut random);
            let mut next = Vec::with_capacity(blocks.len() + 16);
            let mut is_open = false;
            for body in blocks {
                match body.whole().cut(&plane) {
                    Ok(Some((below, above))) if chance.uniform() < set.persistence => {
                        is_open = true;
                        next.extend(body.divided([below, above], &plane, &mut n_uncut));
                    }
                    Ok(_) => next.push(body),
                    Err(_) => {
                        n_uncut += 1;
                        next.push(body);
                    }
                }
            }
            blocks = next;
            if is_open {
                joints.push(Joint { set: number, plane });
            }
            if blocks.len() > max_blocks {
                return Err(too_many(
                    sets,
                    max_blocks,
                    expected.max(blocks.len() as f64),
                ));
            }
        }
    }
    Ok(CutBodies {
        bodies: blocks,
        n_uncut,
        joints,
    })
}

/// Expected number of blocks from joints.
struct Expected {
    /// Lower bound, except for randomness and the positions of single joints.
    at_least: f64,
    /// Mean over all positions of the joints.
    about: f64,
}

/// Counts blocks before the first cut. Planes cut a convex body into as many pieces as there are bodies,
/// planes, lines where two of them meet, and points where three meet, inside of it:
///
/// ```text
/// N = 1 + Σ_i p_i w_i/s_i + Σ_{i<j} p_i p_j A_ij |n_i × n_j|/(s_i s_j)
///       + V Σ_{i<j<k} p_i p_j p_k |n_i · (n_j × n_k)|/(s_i s_j s_k)
/// w: width along the normal   A: section across the line   p: persistence   s: spacing
/// ```
/// Each term is a mean over all positions of the joints. Where they lie in the faces of the body N may be as
/// small as the largest of its terms: a cube cut by faces of cubes has as many blocks as points.
fn expected_blocks(bodies: &[Polyhedron], sets: &[JointSet]) -> Expected {
    let share = |set: &JointSet| set.persistence / set.spacing;
    let mut expected = Expected {
        at_least: 0.0,
        about: 0.0,
    };
    for body in bodies {
        let (mut planes, mut lines, mut points) = (Vec::new(), Vec::new(), 0.0);
        for (i, a) in sets.iter().enumerate() {
            let (low, high) = span(body.vertices().iter(), &a.normal());
            planes.push(share(a) * (high - low));
            for (j, b) in sets.iter().enumerate().skip(i + 1) {
                let along = a.normal().cross(&b.normal());
                lines.push(share(a) * share(b) * section(body, &along));
                for c in &sets[j + 1..] {
                    let angle = along.dot(&c.normal()).abs();
                    points += angle * share(a) * share(b) * share(c) * crate::volume(body);
                }
            }
        }
        let largest = |terms: &[f64]| terms.iter().copied().fold(0.0, f64::max);
        expected.at_least += largest(&planes).max(largest(&lines)).max(points).max(1.0);
        expected.about += 1.0 + planes.iter().sum::<f64>() + lines.iter().sum::<f64>() + points;
    }
    expected
}

/// Projected area of a body along a direction, times the length of that direction.
///
/// ```text
/// A |d| = ½ Σ_f A_f |n_f · d|
/// ```
fn section(body: &Polyhedron, along: &Vec3) -> f64 {
    (0..body.n_faces())
        .map(|face| 0.5 * crate::face_area(body, face) * body.face_normal(face).dot(along).abs())
        .sum()
}

/// Lowest and highest of points along a direction; m.
fn span<'a>(points: impl Iterator<Item = &'a Vec3>, along: &Vec3) -> (f64, f64) {
    points
        .map(|x| along.dot(x))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| {
            (low.min(h), high.max(h))
        })
}

/// Largest tilt of joints; × scatter. It excludes exp(−3²/2) = 1.1 % of a normal distribution in two
/// directions. With a bound, the joints that can reach a mass are a finite number, and none is missed.
const LARGEST_LEAN: f64 = 3.0;

/// Leans in two directions, standard normal but for those beyond the largest.
fn lean(random: &mut Random) -> (f64, f64) {
    loop {
        let (a, b) = (normal(random), normal(random));
        if a.hypot(b) <= LARGEST_LEAN {
            return (a, b);
        }
    }
}

/// Standard normal, by Box & Muller (1958).
fn normal(random: &mut Random) -> f64 {
    let radius = (-2.0 * (1.0 - random.uniform()).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.uniform()).cos()
}
