//! Loads, elastic supports, rock bolts and exact joints of blocks. Each acts on material points, which move and strain with their block.

pub(crate) mod exact_joints;

use super::energy::Account;
use crate::geometry::parts::Part;
use crate::{BlockError, Integrator, Load, Motion, Vec3};
use exact_joints::ExactJoint;
use nalgebra::Matrix3;
use serde::{Deserialize, Serialize};

/// A load, a support or a joint. Points are world positions at t = 0.
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
        /// Inward if > 0; Pa.
        pressure: f64,
    },
    /// Spring from a material point to its position at t = 0.
    FixedPoint {
        /// The block.
        block: usize,
        /// Position; m.
        point: Vec3,
        /// In every direction, > 0; N/m.
        stiffness: f64,
    },
    /// Elastic, perfectly plastic bar from a point of one block to a point of another.
    RockBolt {
        /// The two blocks.
        blocks: (usize, usize),
        /// Ends, one in each; m.
        points: (Vec3, Vec3),
        /// `E A / length`, > 0; N/m.
        stiffness: f64,
        /// Tension at t = 0, at most the yield force; N.
        pretension: f64,
        /// Largest force, in tension or compression, > 0; N.
        yield_force: f64,
    },
    /// Material point that stays where it is, exactly. Of contact dynamics only, as the two that follow.
    HeldPoint {
        /// A free block.
        block: usize,
        /// Position; m.
        point: Vec3,
    },
    /// Common point of two blocks, about which they rotate freely. They touch each other elsewhere as without it.
    BallJoint {
        /// Two blocks, of which one may be fixed or prescribed.
        blocks: (usize, usize),
        /// Position; m.
        point: Vec3,
    },
    /// Rigid bar without mass, of the length that it has at t = 0.
    Rod {
        /// Two blocks, of which one may be fixed or prescribed.
        blocks: (usize, usize),
        /// Ends, one in each; m.
        points: (Vec3, Vec3),
        /// Largest mean force of a step in tension or compression, > 0: where it is reached the rod breaks, for good. Infinite of a rod
        /// that never does; N.
        strength: f64,
    },
}

/// End of an attachment: its block and the position relative to the centroid, in the initial axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct End {
    pub block: u32,
    pub offset_rel: Vec3,
}

/// Law of an attachment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Kind {
    /// Constant force; N.
    Force(Vec3),
    /// Pressure on a face of a part, which is counted among all parts; Pa.
    Pressure { part: u32, face: u32, pressure: f64 },
    /// Spring to a fixed point.
    Spring { anchor: Vec3, stiffness: f64 },
    /// Bolt to a second end.
    Bolt {
        other: End,
        /// Without tension; m.
        length: f64,
        stiffness: f64,
        yield_force: f64,
    },
}

/// An attachment and its state.
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
    /// Joints of contact dynamics.
    pub joints: Vec<ExactJoint>,
    /// Whether the last step left one of them open. Joints that contradict each other pull as hard as iterations let them, and the next
    /// step must not start from that.
    pub has_open_joint: bool,
    /// Sum of their forces on each block, empty without attachments; those of joints from the kick of a step to its end; N, N m.
    pub loads: Vec<Load>,
    /// Straining moment of their forces; one per deformable block; N m.
    pub stretch: Vec<Matrix3<f64>>,
    /// Sum of the external forces on free blocks; N.
    pub outer_force: Vec3,
    /// Energy of springs and bolts; J.
    pub elastic: f64,
    /// Dissipated by bolts that yield and rods that break; J.
    pub plastic: Account,
    /// Work of forces and pressures; J.
    pub work: Account,
    /// Given by joints as they restore positions; J.
    pub joint_correction: Account,
}

/// Blocks at t = 0, as far as attachments need them.
pub(crate) struct Bodies<'a> {
    /// Centroids; m.
    pub centroid: &'a [Vec3],
    /// Masses; kg.
    pub mass: &'a [f64],
    /// First part of each block, and the number of parts.
    pub part_start: &'a [u32],
    /// Parts of all blocks.
    pub parts: &'a [Part],
    /// Motions.
    pub motion: &'a [Motion],
    pub integrator: &'a Integrator,
}

/// Reason to refuse an attachment.
type Refusal = &'static str;

/// An attachment, checked.
enum Resolved {
    /// By its force, with its end.
    Item(End, Kind),
    Joint(ExactJoint),
}

impl Attachments {
    pub fn is_empty(&self) -> bool {
        self.items.is_empty() && self.joints.is_empty()
    }

    /// Adds one; the error names it by its `number`.
    pub fn push(
        &mut self,
        attachment: &Attachment,
        number: usize,
        bodies: &Bodies,
    ) -> Result<(), BlockError> {
        let refuse = |reason| BlockError::Attachment {
            attachment: number,
            reason,
        };
        match bodies.resolve(attachment).map_err(refuse)? {
            Resolved::Joint(joint) => self.joints.push(joint),
            Resolved::Item(end, kind) => self.items.push(Item {
                end,
                kind,
                plastic: 0.0,
                force: Vec3::zeros(),
                at: Vec3::zeros(),
            }),
        }
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
        f(f64::from(u8::from(self.has_open_joint)));
        self.joints
            .iter()
            .for_each(|joint| joint.for_each_state_f64(f));
        f(self.plastic.total());
        f(self.work.total());
        f(self.joint_correction.total());
    }
}

impl Bodies<'_> {
    fn resolve(&self, attachment: &Attachment) -> Result<Resolved, Refusal> {
        let (end, kind) = match *attachment {
            Attachment::PointLoad {
                block,
                point,
                force,
            } => self.point_load(block, point, force)?,
            Attachment::BodyLoad {
                block,
                acceleration,
            } => self.body_load(block, acceleration)?,
            Attachment::FaceLoad {
                block,
                part,
                face,
                pressure,
            } => self.face_load(block, part, face, pressure)?,
            Attachment::FixedPoint {
                block,
                point,
                stiffness,
            } => self.fixed_point(block, point, stiffness)?,
            Attachment::RockBolt {
                blocks,
                points,
                stiffness,
                pretension,
                yield_force,
            } => {
                let (end, other) = self.bolt_ends(blocks, points)?;
                let kind = Kind::Bolt {
                    other,
                    length: unstressed_length(points, stiffness, pretension, yield_force)?,
                    stiffness,
                    yield_force,
                };
                (end, kind)
            }
            Attachment::HeldPoint { block, point } => {
                return self.held_point(block, point).map(Resolved::Joint);
            }
            Attachment::BallJoint { blocks, point } => {
                return self.ball_joint(blocks, point).map(Resolved::Joint);
            }
            Attachment::Rod {
                blocks,
                points,
                strength,
            } => return self.rod(blocks, points, strength).map(Resolved::Joint),
        };
        Ok(Resolved::Item(end, kind))
    }

    fn point_load(&self, block: usize, point: Vec3, force: Vec3) -> Result<(End, Kind), Refusal> {
        self.check_block(block)?;
        if !is_finite(&point) || !is_finite(&force) {
            return Err("point and force must be finite");
        }
        Ok((self.end(block, point), Kind::Force(force)))
    }

    fn body_load(&self, block: usize, acceleration: Vec3) -> Result<(End, Kind), Refusal> {
        self.check_block(block)?;
        if !is_finite(&acceleration) {
            return Err("the acceleration must be finite");
        }
        let force = acceleration * self.mass[block];
        Ok((self.end(block, self.centroid[block]), Kind::Force(force)))
    }

    fn face_load(
        &self,
        block: usize,
        part: usize,
        face: usize,
        pressure: f64,
    ) -> Result<(End, Kind), Refusal> {
        self.check_block(block)?;
        if !pressure.is_finite() {
            return Err("the pressure must be finite");
        }
        let index = self.part_start[block] as usize + part;
        let is_of_block = index < self.part_start[block + 1] as usize;
        match self.parts.get(index).filter(|_| is_of_block) {
            Some(Part::Polyhedron(body)) if face < body.n_faces() => {}
            _ => return Err("the block has no such part with such a face"),
        }
        let kind = Kind::Pressure {
            part: index as u32,
            face: face as u32,
            pressure,
        };
        Ok((self.end(block, self.centroid[block]), kind))
    }

    fn fixed_point(
        &self,
        block: usize,
        point: Vec3,
        stiffness: f64,
    ) -> Result<(End, Kind), Refusal> {
        self.check_block(block)?;
        if !(is_finite(&point) && stiffness > 0.0 && stiffness.is_finite()) {
            return Err("the point must be finite and the stiffness > 0 N/m");
        }
        let kind = Kind::Spring {
            anchor: point,
            stiffness,
        };
        Ok((self.end(block, point), kind))
    }

    fn bolt_ends(
        &self,
        (i, j): (usize, usize),
        points: (Vec3, Vec3),
    ) -> Result<(End, End), Refusal> {
        let n = self.centroid.len();
        if i >= n || j >= n || i == j {
            return Err("a bolt needs two different blocks");
        }
        Ok((self.end(i, points.0), self.end(j, points.1)))
    }

    fn check_block(&self, block: usize) -> Result<(), Refusal> {
        if block >= self.centroid.len() {
            return Err("there is no such block");
        }
        Ok(())
    }

    fn end(&self, block: usize, point: Vec3) -> End {
        let offset = point - self.centroid[block];
        let offset_rel = match &self.motion[block] {
            // a path may begin turned
            Motion::Prescribed(path) => path.turn(0.0).inverse() * offset,
            Motion::Free | Motion::Fixed => offset,
        };
        End {
            block: block as u32,
            offset_rel,
        }
    }
}

/// Length of a bolt without tension: the distance of its ends less the elongation by its pretension `P`, `L − P/k`; m.
fn unstressed_length(
    points: (Vec3, Vec3),
    stiffness: f64,
    pretension: f64,
    yield_force: f64,
) -> Result<f64, Refusal> {
    let length = (points.1 - points.0).norm();
    if !(length > 0.0 && length.is_finite()) {
        return Err("the ends of a bolt must be apart");
    }
    if !(stiffness > 0.0 && stiffness.is_finite() && yield_force > 0.0) {
        return Err("stiffness and yield force of a bolt must be > 0");
    }
    if !(pretension.abs() <= yield_force) {
        return Err("the pretension of a bolt must not exceed its yield force");
    }
    Ok(length - pretension / stiffness)
}

fn is_finite(v: &Vec3) -> bool {
    v.iter().all(|c| c.is_finite())
}
