//! Attachments of blocks: loads, elastic supports, rock bolts. Each acts on material points, which
//! move and strain with their block.

use crate::geometry::parts::Part;
use crate::motion::kinematics::{Kinematics, stretch};
use crate::step::energy::Account;
use crate::{BlockError, Load, Vec3};
use nalgebra::Matrix3;
use serde::{Deserialize, Serialize};

/// A load or support. Points are world positions at t = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Attachment {
    /// Constant force at a material point.
    PointLoad {
        /// The block.
        block: usize,
        /// Position; m.
        point: Vec3,
        /// World; N.
        force: Vec3,
    },
    /// Constant force per mass, beside gravity.
    BodyLoad {
        /// The block.
        block: usize,
        /// World; m/s².
        acceleration: Vec3,
    },
    /// Pressure on a face, which it follows as the block rotates and strains.
    FaceLoad {
        /// The block.
        block: usize,
        /// Part of the block, from 0.
        part: usize,
        /// Face of the part.
        face: usize,
        /// Pushes inward if > 0; Pa.
        pressure: f64,
    },
    /// Spring from a material point to where it was at t = 0.
    FixedPoint {
        /// The block.
        block: usize,
        /// Position; m.
        point: Vec3,
        /// In every direction, > 0; N/m.
        stiffness: f64,
    },
    /// Elastic bar that yields, from a point of one block to a point of another.
    RockBolt {
        /// The two blocks.
        blocks: (usize, usize),
        /// Ends, one in each; m.
        points: (Vec3, Vec3),
        /// `E A / length`, > 0; N/m.
        stiffness: f64,
        /// Tension at t = 0, at most the yield force; N.
        pretension: f64,
        /// It takes no more than this, in tension or compression, > 0; N.
        yield_force: f64,
    },
}

/// An end: the block and the position relative to its centroid, in the initial axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct End {
    block: u32,
    offset_rel: Vec3,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum Kind {
    Force(Vec3),
    /// Index of the part among all parts, and its face.
    Pressure {
        part: u32,
        face: u32,
        pressure: f64,
    },
    Spring {
        anchor: Vec3,
        stiffness: f64,
    },
    Bolt {
        other: End,
        length: f64,
        stiffness: f64,
        yield_force: f64,
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Item {
    end: End,
    kind: Kind,
    /// Length by which a bolt has yielded; state; m.
    plastic: f64,
    /// Force on the block of `end` and where it acted, of the last evaluation.
    force: Vec3,
    at: Vec3,
}

/// All attachments of a system, with their work.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Attachments {
    items: Vec<Item>,
    /// One per block, empty without attachments.
    pub loads: Vec<Load>,
    /// One per deformable block.
    pub stretch: Vec<Matrix3<f64>>,
    /// Force from outside on free blocks; N.
    pub outer_force: Vec3,
    /// Energy of springs and bolts; J.
    pub elastic: f64,
    pub plastic: Account,
    /// Work of forces and pressures.
    pub work: Account,
}

/// State of the blocks used by attachments.
pub(crate) struct Surroundings<'a> {
    pub kinematics: &'a [Kinematics],
    /// World from the initial axes, rotated and strained; one per block.
    pub gradient: &'a dyn Fn(usize) -> Matrix3<f64>,
    pub is_free: &'a dyn Fn(usize) -> bool,
    pub deformable_of: &'a [Option<u32>],
    pub parts: &'a [Part],
}

impl Attachments {
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// Adds one; `part_start` of each block, masses and initial centroids as in `Blocks`.
    pub fn push(
        &mut self,
        attachment: &Attachment,
        number: usize,
        centroid: &[Vec3],
        mass: &[f64],
        part_start: &[u32],
        parts: &[Part],
    ) -> Result<(), BlockError> {
        let refuse = |reason| {
            Err(BlockError::Attachment {
                attachment: number,
                reason,
            })
        };
        let n = centroid.len();
        let end = |block: usize, point: Vec3| End {
            block: block as u32,
            offset_rel: point - centroid[block],
        };
        let finite = |v: &Vec3| v.iter().all(|c| c.is_finite());
        let (end, kind) = match *attachment {
            Attachment::PointLoad {
                block,
                point,
                force,
            } => {
                if block >= n {
                    return refuse("there is no such block");
                }
                if !finite(&point) || !finite(&force) {
                    return refuse("point and force must be finite");
                }
                (end(block, point), Kind::Force(force))
            }
            Attachment::BodyLoad {
                block,
                acceleration,
            } => {
                if block >= n {
                    return refuse("there is no such block");
                }
                if !finite(&acceleration) {
                    return refuse("the acceleration must be finite");
                }
                (
                    end(block, centroid[block]),
                    Kind::Force(acceleration * mass[block]),
                )
            }
            Attachment::FaceLoad {
                block,
                part,
                face,
                pressure,
            } => {
                if block >= n {
                    return refuse("there is no such block");
                }
                if !pressure.is_finite() {
                    return refuse("the pressure must be finite");
                }
                let index = part_start[block] as usize + part;
                match parts
                    .get(index)
                    .filter(|_| index < part_start[block + 1] as usize)
                {
                    Some(Part::Polyhedron(body)) if face < body.n_faces() => {}
                    _ => return refuse("the block has no such part with such a face"),
                }
                let kind = Kind::Pressure {
                    part: index as u32,
                    face: face as u32,
                    pressure,
                };
                (end(block, centroid[block]), kind)
            }
            Attachment::FixedPoint {
                block,
                point,
                stiffness,
            } => {
                if block >= n {
                    return refuse("there is no such block");
                }
                if !(finite(&point) && stiffness > 0.0 && stiffness.is_finite()) {
                    return refuse("the point must be finite and the stiffness > 0 N/m");
                }
                (
                    end(block, point),
                    Kind::Spring {
                        anchor: point,
                        stiffness,
                    },
                )
            }
            Attachment::RockBolt {
                blocks: (i, j),
                points,
                stiffness,
                pretension,
                yield_force,
            } => {
                if i >= n || j >= n || i == j {
                    return refuse("a bolt needs two different blocks");
                }
                let length = (points.1 - points.0).norm();
                if !(length > 0.0 && length.is_finite()) {
                    return refuse("the ends of a bolt must be apart");
                }
                if !(stiffness > 0.0 && stiffness.is_finite() && yield_force > 0.0) {
                    return refuse("stiffness and yield force of a bolt must be > 0");
                }
                if !(pretension.abs() <= yield_force) {
                    return refuse("the pretension of a bolt must not exceed its yield force");
                }
                let kind = Kind::Bolt {
                    other: end(j, points.1),
                    length: length - pretension / stiffness,
                    stiffness,
                    yield_force,
                };
                (end(i, points.0), kind)
            }
        };
        self.items.push(Item {
            end,
            kind,
            plastic: 0.0,
            force: Vec3::zeros(),
            at: Vec3::zeros(),
        });
        Ok(())
    }

    /// Forces at the current position; books work and yield since the last evaluation, unless it is the
    /// first.
    pub fn evaluate(&mut self, around: &Surroundings, is_first: bool) {
        self.loads.clear();
        self.loads.resize(around.kinematics.len(), Load::default());
        let n_deformable = around.deformable_of.iter().flatten().count();
        self.stretch.clear();
        self.stretch.resize(n_deformable, Matrix3::zeros());
        self.outer_force = Vec3::zeros();
        self.elastic = 0.0;
        for item in &mut self.items {
            let place = |end: &End| {
                let b = end.block as usize;
                around.kinematics[b].centroid + (around.gradient)(b) * end.offset_rel
            };
            let mut at = place(&item.end);
            let mut partner = None;
            let force = match item.kind {
                Kind::Force(force) => force,
                Kind::Pressure {
                    part,
                    face,
                    pressure,
                } => {
                    let (area, middle) = face_moment(&around.parts[part as usize], face as usize);
                    at = middle;
                    -area * pressure
                }
                Kind::Spring { anchor, stiffness } => {
                    let pull = anchor - at;
                    self.elastic += 0.5 * stiffness * pull.norm_squared();
                    pull * stiffness
                }
                Kind::Bolt {
                    other,
                    length,
                    stiffness,
                    yield_force,
                } => {
                    let far = place(&other);
                    let along = far - at;
                    let present = along.norm();
                    let trial = stiffness * (present - length - item.plastic);
                    let tension = trial.clamp(-yield_force, yield_force);
                    let yielded = (trial - tension) / stiffness;
                    item.plastic += yielded;
                    self.plastic.book(tension * yielded);
                    self.elastic += 0.5 * tension * tension / stiffness;
                    let force = along * (tension / present.max(f64::MIN_POSITIVE));
                    partner = Some((other.block as usize, far, -force));
                    force
                }
            };
            let b = item.end.block as usize;
            if partner.is_none() && (around.is_free)(b) {
                self.outer_force += force;
                let is_given = matches!(item.kind, Kind::Force(_) | Kind::Pressure { .. });
                if is_given && !is_first {
                    self.work
                        .book(0.5 * (item.force + force).dot(&(at - item.at)));
                }
            }
            item.force = force;
            item.at = at;
            for (block, x, force) in std::iter::once((b, at, force)).chain(partner) {
                let offset = x - around.kinematics[block].centroid;
                self.loads[block].add(&force, &offset);
                if let Some(k) = around.deformable_of[block] {
                    self.stretch[k as usize] += stretch(&force, &offset);
                }
            }
        }
    }

    /// Adds the stiffness of springs and bolts to the rate bound of each block; 1/s².
    pub fn add_stiffness_rates(
        &self,
        kinematics: &[Kinematics],
        is_free: impl Fn(usize) -> bool,
        rate: &mut [f64],
    ) {
        for item in &self.items {
            let b = item.end.block as usize;
            match item.kind {
                Kind::Spring { stiffness, .. } => {
                    rate[b] += stiffness * kinematics[b].compliance_trace(&item.at);
                }
                Kind::Bolt {
                    other, stiffness, ..
                } => {
                    let j = other.block as usize;
                    let far = kinematics[j].centroid + other.offset_rel;
                    for (block, partner, x) in [(b, j, item.at), (j, b, far)] {
                        let share = if is_free(partner) { 2.0 } else { 1.0 };
                        rate[block] += share * stiffness * kinematics[block].compliance_trace(&x);
                    }
                }
                Kind::Force(_) | Kind::Pressure { .. } => {}
            }
        }
    }

    /// Tension of each attachment that is a bolt, in the order given, with its yielded length; N, m.
    pub fn bolts(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.items.iter().filter_map(|item| match item.kind {
            Kind::Bolt { .. } => Some((item.force.norm(), item.plastic)),
            _ => None,
        })
    }

    pub fn for_each_state_f64(&self, f: &mut dyn FnMut(f64)) {
        for item in &self.items {
            f(item.plastic);
            item.force.iter().chain(item.at.iter()).for_each(|&c| f(c));
        }
        f(self.plastic.total());
        f(self.work.total());
    }
}

/// Outward normal times area, and the centroid of a face; m², m.
fn face_moment(part: &Part, face: usize) -> (Vec3, Vec3) {
    let Part::Polyhedron(body) = part else {
        return (Vec3::zeros(), Vec3::zeros());
    };
    let mut corners = body
        .face_vertices(face)
        .map(|v| body.vertices()[v as usize]);
    let (Some(first), Some(mut before)) = (corners.next(), corners.next()) else {
        return (Vec3::zeros(), Vec3::zeros());
    };
    let normal = body.face_normal(face);
    let (mut area, mut moment) = (0.0, Vec3::zeros());
    for corner in corners {
        let piece = 0.5 * (before - first).cross(&(corner - first)).dot(&normal);
        area += piece;
        moment += (first + before + corner) * (piece / 3.0);
        before = corner;
    }
    (normal * area, moment / area)
}
