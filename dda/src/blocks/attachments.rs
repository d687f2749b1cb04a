//! Loads, elastic supports and rock bolts of blocks. Each acts on material points, which move and strain with their block.

use super::energy::Account;
use crate::geometry::parts::Part;
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
pub(crate) struct End {
    pub block: u32,
    pub offset_rel: Vec3,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Kind {
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
pub(crate) struct Item {
    pub end: End,
    pub kind: Kind,
    /// Length by which a bolt has yielded; state; m.
    pub plastic: f64,
    /// Force on the block of `end` at the last evaluation; N.
    pub force: Vec3,
    /// Point of application of that force; m.
    pub at: Vec3,
}

/// All attachments of a system, with their work.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Attachments {
    pub items: Vec<Item>,
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
