//! The common plane of the last step, kept while it is still the best.

use super::{
    ALMOST_PARALLEL, Axis, AxisKind, KEEP_PREFERENCE, Neighbors, SUPPORT_TOLERANCE, axes,
    edge_vector, fast_common_plane, gap_along, separating_axes,
};
use crate::{Polyhedron, Vec3};
use serde::{Deserialize, Serialize};

/// Overlap of parts, over the thickness of the thinner one, above which it does not count ...
const COVERED_DEPTH: f64 = 0.01;
/// ... if in another direction, covered or not, it is less than this share.
const COVERED_SHARE: f64 = 0.5;
/// Relative change of the overlap since the last full test below which no new test is due ...
const TRUSTED_CHANGE: f64 = 0.1;
/// ... nor below this change (× size of the smaller body), at which another axis would give nearly the same force; ...
pub(super) const TRUSTED_DEPTH: f64 = 1e-4;
/// ... nor below this share of the lead of the axis over all others, ...
const TRUSTED_LEAD: f64 = 0.25;
/// ... for this number of steps, doubled each time that the test confirms the axis, ...
const TRUSTED_STEPS: u32 = 16;
/// ... up to this number.
const MOST_TRUSTED_STEPS: u32 = 64;

/// Detection of the common plane of a pair.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ContactDetection {
    /// From the plane of the last step, verified by the separating-axis test.
    #[default]
    Verified,
    /// By the fast common plane alone, from the plane of the last step, as published: a cold start
    /// misses the common plane of some 5 % of overlapping pairs.
    FastCommonPlane,
}

/// Axis of a pair of bodies at the last step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct AxisCache {
    /// Axis of the last step.
    pub axis: Option<Axis>,
    /// Gap at the last full test, and its lead over that of every other axis; m.
    pub verified_gap: f64,
    pub lead: f64,
    /// Remaining steps without a full test, and their number after the last test.
    pub trust: u32,
    pub trusted: u32,
    /// True if the full test was made in the last step.
    pub has_searched: bool,
}

impl AxisCache {
    /// The common plane if the bodies overlap; keeps the separating axis if not.
    pub fn overlapping(
        &mut self,
        a: &Polyhedron,
        b: &Polyhedron,
        detection: ContactDetection,
        down: &Vec3,
    ) -> Option<Axis> {
        self.has_searched = false;
        match detection {
            ContactDetection::Verified => self.verified(a, b, down),
            ContactDetection::FastCommonPlane => {
                let start = match self.axis {
                    Some(axis) => renewed(a, b, &axis),
                    None => centroid_line(a, b),
                };
                let climbed = fast_common_plane(a, b, &start.normal);
                // nothing better was found: the same features still make the plane
                let axis = if climbed.kind == AxisKind::Other && is_supported(a, b, &start) {
                    start
                } else {
                    climbed
                };
                self.axis = Some(axis);
                (axis.gap <= 0.0).then_some(axis)
            }
        }
    }

    fn verified(&mut self, a: &Polyhedron, b: &Polyhedron, down: &Vec3) -> Option<Axis> {
        let mut kept = None;
        if self.trust > 0 && self.verified_gap == f64::NEG_INFINITY {
            self.trust -= 1;
            return None;
        }
        if let Some(axis) = self.axis {
            let shallow = TRUSTED_DEPTH * a.size().min(b.size());
            // neighbors that barely touch alternate between apart and overlapping, which calls for no search
            let was_apart = axis.gap > shallow;
            let axis = renewed(a, b, &axis);
            self.axis = Some(axis);
            if axis.gap > 0.0 {
                self.trust = self.trust.saturating_sub(1);
                return None;
            }
            let is_contact =
                axis.kind != AxisKind::Other && !was_apart && is_supported(a, b, &axis);
            if is_contact
                && self.trust > 0
                && (axis.gap - self.verified_gap).abs() <= self.trusted_change(shallow)
            {
                self.trust -= 1;
                return Some(axis);
            }
            if was_apart {
                let climbed = fast_common_plane(a, b, &axis.normal);
                if climbed.gap > 0.0 {
                    self.axis = Some(Axis {
                        kind: AxisKind::Other,
                        ..climbed
                    });
                    return None;
                }
            }
            kept = is_contact.then_some(axis);
        }
        self.has_searched = true;
        let axes = separating_axes(a, b);
        let found = axes.preferred(a, b, down);
        let axis = match kept {
            Some(kept)
                if found.gap <= 0.0
                    && found.gap - kept.gap <= KEEP_PREFERENCE * -kept.gap
                    && (is_face(&kept)
                        || !is_face(&found)
                        || found.normal.dot(&kept.normal) <= ALMOST_PARALLEL) =>
            {
                kept
            }
            _ => found,
        };
        let is_same = self.trust == 0 && kept.is_some_and(|kept| kept.kind == axis.kind);
        self.trusted = if is_same {
            (2 * self.trusted).clamp(TRUSTED_STEPS, MOST_TRUSTED_STEPS)
        } else {
            TRUSTED_STEPS
        };
        self.axis = Some(axis);
        self.lead = axes.lead(&axis);
        self.trust = self.trusted;
        // nothing of the two is visible to the other here
        let is_hidden = axis.gap == f64::NEG_INFINITY || touch_where_covered(a, b, &axis);
        self.verified_gap = if is_hidden {
            f64::NEG_INFINITY
        } else {
            axis.gap
        };
        (axis.gap <= 0.0 && !is_hidden).then_some(axis)
    }
}

impl AxisCache {
    /// Change of the gap since the last full test that calls for no other one; m.
    fn trusted_change(&self, shallow: f64) -> f64 {
        let relative = TRUSTED_CHANGE * -self.verified_gap;
        let lead = TRUSTED_LEAD * self.lead;
        relative.max(shallow).max(lead)
    }
}

/// True if two bodies, parts of larger ones, touch only where other parts cover their faces or continue their corners. Their exposed
/// faces then give a much deeper overlap than all of their faces: the contact is that of the other parts.
fn touch_where_covered(a: &Polyhedron, b: &Polyhedron, axis: &Axis) -> bool {
    let thinner = a.thickness().min(b.thickness());
    if !(a.has_seams() || b.has_seams()) || -axis.gap <= COVERED_DEPTH * thinner {
        return false;
    }
    axes(a, b, Neighbors::Ignored).best().gap > COVERED_SHARE * axis.gap
}

/// Cold start as published: the line between the mean corners.
fn centroid_line(a: &Polyhedron, b: &Polyhedron) -> Axis {
    let middle =
        |body: &Polyhedron| body.vertices().iter().sum::<Vec3>() / body.vertices().len() as f64;
    let line = middle(b) - middle(a);
    let normal = line.try_normalize(0.0).unwrap_or_else(Vec3::z);
    Axis {
        normal,
        gap: gap_along(a, b, &normal),
        kind: AxisKind::Other,
    }
}

fn is_face(axis: &Axis) -> bool {
    matches!(axis.kind, AxisKind::FaceA(_) | AxisKind::FaceB(_))
}

/// True if the two edges of an axis are still the farthest features along it. Faces always are.
fn is_supported(a: &Polyhedron, b: &Polyhedron, axis: &Axis) -> bool {
    let AxisKind::Edges(edge_a, edge_b) = axis.kind else {
        return true;
    };
    let between = b.vertices()[b.origin(edge_b) as usize] - a.vertices()[a.origin(edge_a) as usize];
    let gap = axis.normal.dot(&between);
    gap - axis.gap <= SUPPORT_TOLERANCE * a.size().min(b.size())
}

/// The same faces or edges at their current position.
fn renewed(a: &Polyhedron, b: &Polyhedron, axis: &Axis) -> Axis {
    let normal = match axis.kind {
        AxisKind::FaceA(face) => a.face_normal(face as usize),
        AxisKind::FaceB(face) => -b.face_normal(face as usize),
        AxisKind::Edges(edge_a, edge_b) => {
            let cross = edge_vector(a, edge_a).cross(&edge_vector(b, edge_b));
            let norm = cross.norm();
            if norm > 0.0 {
                cross * (cross.dot(&axis.normal).signum() / norm)
            } else {
                axis.normal
            }
        }
        AxisKind::Other => axis.normal,
    };
    Axis {
        normal,
        gap: gap_along(a, b, &normal),
        kind: axis.kind,
    }
}
