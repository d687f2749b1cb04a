//! Narrow phase of two polyhedra: the common plane, then the patch on it.

use super::common_plane::{Axis, AxisCache, AxisKind, ContactDetection};
use super::patch::Patch;
use crate::material::Scaling;
use crate::{Polyhedron, Vec3};

/// Two polyhedra and the choices of the search.
pub(crate) struct NarrowPhase<'a> {
    /// i and j.
    pub bodies: (&'a Polyhedron, &'a Polyhedron),
    pub detection: ContactDetection,
    /// Breaks ties between faces of one gap; m/s².
    pub gravity: Vec3,
    pub scaling: Scaling,
}

/// Parts nearer than this at the start are bonded; × size of the smaller part.
const BOND_REACH: f64 = 1e-4;

/// Lead of two edges over a face below which bodies that are near each other count as face to face; × size of the smaller part.
const FLAT: f64 = 1e-4;

impl NarrowPhase<'_> {
    /// Leaves the manifold of overlapping bodies in `patch`; false if they are apart.
    pub fn find(&self, cache: &mut AxisCache, patch: &mut Patch) -> bool {
        let (a, b) = self.bodies;
        let Some(axis) = cache.overlapping(a, b, self.detection, &self.gravity) else {
            return false;
        };
        patch.find(a, b, &axis, self.scaling, false);
        !patch.manifold.points.is_empty()
    }

    /// Leaves the points at which the bodies overlap or are nearer than `reach` (m) in `patch`; false if there are none.
    pub fn find_near(&self, cache: &mut AxisCache, patch: &mut Patch, reach: f64) -> bool {
        let (a, b) = self.bodies;
        let axis = match cache.overlapping(a, b, self.detection, &self.gravity) {
            Some(axis) => axis,
            None => {
                let is_near = |axis: &Axis| 0.0 < axis.gap && axis.gap <= reach;
                if !cache.axis.as_ref().is_some_and(is_near) {
                    return false;
                }
                let axes = crate::separating_axes(a, b);
                let (best, face) = (axes.best(), axes.preferred_face(a, b, &self.gravity));
                let is_of_edges = FLAT * a.size().min(b.size()) < best.gap - face.gap;
                if is_of_edges { best } else { face }
            }
        };
        if reach < axis.gap {
            return false;
        }
        patch.find_outline(a, b, &axis);
        !patch.manifold.points.is_empty()
    }

    /// Leaves the manifold of the bonded faces at their current position in `patch`, open or not; false if they have slid past
    /// each other.
    pub fn find_bonded(&self, cache: &AxisCache, patch: &mut Patch) -> bool {
        let (a, b) = self.bodies;
        let Some(axis) = &cache.axis else {
            return false;
        };
        patch.find(a, b, &bonded_faces(a, b, axis), self.scaling, true);
        !patch.manifold.points.is_empty()
    }

    /// Area in which the bodies lie face to face, which its plane then remembers; m². `None` if they do not.
    pub fn find_joint(&self, cache: &mut AxisCache) -> Option<f64> {
        let (a, b) = self.bodies;
        let axes = crate::separating_axes(a, b);
        let axis = axes.preferred_face(a, b, &self.gravity);
        let reach = BOND_REACH * a.size().min(b.size());
        if axes.best().gap > reach || axis.gap.abs() > reach {
            return None;
        }
        let mut patch = Patch::default();
        patch.find(a, b, &axis, self.scaling, true);
        let found = &patch.manifold;
        let is_flat = found.points.iter().all(|p| p.overlap.abs() <= reach);
        if found.area > 0.0 && is_flat {
            cache.axis = Some(axis);
            return Some(found.area);
        }
        None
    }
}

/// The bonded faces at their current position.
fn bonded_faces(a: &Polyhedron, b: &Polyhedron, axis: &Axis) -> Axis {
    let normal = match axis.kind {
        AxisKind::FaceA(face) => a.face_normal(face as usize),
        AxisKind::FaceB(face) => -b.face_normal(face as usize),
        _ => axis.normal,
    };
    Axis {
        normal,
        gap: crate::gap_along(a, b, &normal),
        kind: axis.kind,
    }
}
