//! Forces of loads, elastic supports and rock bolts.

use crate::blocks::attachments::{Attachments, End, Kind};
use crate::geometry::parts::Part;
use crate::motion::kinematics::{Kinematics, stretch};
use crate::{Blocks, Load, Vec3};
use nalgebra::Matrix3;

/// State of the blocks used by attachments.
struct Surroundings<'a> {
    kinematics: &'a [Kinematics],
    /// World from the initial axes, rotated and strained; one per block.
    gradient: &'a dyn Fn(usize) -> Matrix3<f64>,
    is_free: &'a dyn Fn(usize) -> bool,
    deformable_of: &'a [Option<u32>],
    parts: &'a [Part],
}

impl Blocks {
    /// Forces of the attachments at the current position; the first evaluation books no work.
    pub(crate) fn evaluate_attachments(&mut self, is_first: bool) {
        if self.state.attachments.is_empty() {
            return;
        }
        let mut attachments = std::mem::take(&mut self.state.attachments);
        attachments.evaluate(
            &Surroundings {
                kinematics: &self.state.kinematics,
                gradient: &|b| self.placement_gradient(b),
                is_free: &|b| self.is_free(b),
                deformable_of: &self.constants.deformable_of,
                parts: &self.derived.parts,
            },
            is_first,
        );
        self.state.attachments = attachments;
    }
}

impl Attachments {
    /// Forces at the current position. Except at the first evaluation, the work and yield since the last one are booked.
    fn evaluate(&mut self, around: &Surroundings, is_first: bool) {
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
}

/// Area vector, along the outward normal, and centroid of a face; m², m.
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
