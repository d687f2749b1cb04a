//! Convex parts cut by planes: solids that overlap become solids that do not, and solids end at planes of symmetry.

use riprap_sph::{SymmetryPlane, Vec3};

use super::Part;

/// Corners this near to a plane are on it; × size of the part.
const ON_PLANE: f64 = 1e-9;

/// Parts that fill the same space and do not overlap, in order.
///
/// Of two overlapping parts the later one is cut: its overlap with the earlier one is removed
/// along the planes of the latter's faces. Adjoining parts remain unchanged.
pub(super) fn disjoint(parts: Vec<Part>) -> Vec<Part> {
    let mut result: Vec<Part> = Vec::with_capacity(parts.len());
    for part in parts {
        let mut pieces = vec![part];
        for other in &result {
            pieces = pieces
                .into_iter()
                .flat_map(|piece| without(piece, other))
                .collect();
        }
        result.extend(pieces);
    }
    result
}

/// The pieces into which planes cut a part, each a normal and its offset `n·x` in m.
pub(super) fn pieces(part: Part, planes: impl Iterator<Item = (Vec3, f64)>) -> Vec<Part> {
    planes.fold(vec![part], |pieces, (normal, offset)| {
        let halves = |piece: &Part| {
            [
                below(piece, &normal, offset),
                below(piece, &-normal, -offset),
            ]
        };
        pieces.iter().flat_map(halves).flatten().collect()
    })
}

/// The part in front of planes of symmetry; `None` if it is beyond one.
pub(crate) fn clipped_by_symmetry(part: &Part, planes: &[SymmetryPlane]) -> Option<Part> {
    planes.iter().try_fold(part.clone(), |part, plane| {
        let normal = plane.normal();
        below(&part, &normal, normal[plane.axis] * plane.place)
    })
}

/// The mirror image of a part in a plane of symmetry.
pub(super) fn image(part: &Part, plane: &SymmetryPlane) -> Part {
    let faces = part.faces.iter().map(|(normal, corners)| {
        let mut normal = *normal;
        normal[plane.axis] = -normal[plane.axis];
        // mirrored, a loop is reversed
        let corners = corners.iter().rev().map(|x| plane.image_of(x)).collect();
        (normal, corners)
    });
    Part {
        faces: faces.collect(),
    }
}

/// Difference of two parts.
fn without(part: Part, other: &Part) -> Vec<Part> {
    let ((min, max), (other_min, other_max)) = (part.aabb(), other.aabb());
    if (0..3).any(|axis| max[axis] <= other_min[axis] || other_max[axis] <= min[axis]) {
        return vec![part];
    }
    let mut outside = Vec::new();
    let mut rest = part.clone();
    for (normal, corners) in &other.faces {
        let Some(corner) = corners.first() else {
            continue;
        };
        let offset = normal.dot(corner);
        outside.extend(below(&rest, &-normal, -offset));
        match below(&rest, normal, offset) {
            Some(inside) => rest = inside,
            // nothing in common
            None => return vec![part],
        }
    }
    outside
}

/// The piece of a convex part on the side `n·x ≤ offset` (m) of a plane; `None` without volume.
fn below(part: &Part, normal: &Vec3, offset: f64) -> Option<Part> {
    let (min, max) = part.aabb();
    let slack = ON_PLANE * (max - min).norm();
    let height = |x: &Vec3| {
        let s = normal.dot(x) - offset;
        if s.abs() <= slack { 0.0 } else { s }
    };
    if part.corners().all(|x| 0.0 <= height(x)) {
        return None;
    }
    if part.corners().all(|x| height(x) <= 0.0) {
        return Some(part.clone());
    }
    let mut rim: Vec<Vec3> = Vec::new();
    let mut faces = Vec::with_capacity(part.faces.len() + 1);
    for (face_normal, corners) in &part.faces {
        let mut kept = Vec::with_capacity(corners.len() + 2);
        let next = corners.iter().cycle().skip(1);
        for (p, q) in corners.iter().zip(next) {
            let (a, b) = (height(p), height(q));
            if a <= 0.0 {
                kept.push(*p);
            }
            if a * b < 0.0 {
                kept.push(p + (q - p) * (a / (a - b)));
            }
        }
        for x in &kept {
            let is_new = rim.iter().all(|y| slack < (x - y).norm());
            if height(x) == 0.0 && is_new {
                rim.push(*x);
            }
        }
        if kept.iter().any(|x| height(x) < 0.0) {
            faces.push((*face_normal, kept));
        }
    }
    if rim.len() < 3 {
        return None;
    }
    let center = rim.iter().sum::<Vec3>() / rim.len() as f64;
    let u = (rim[0] - center).normalize();
    let v = normal.cross(&u);
    let angle = |x: &Vec3| v.dot(&(x - center)).atan2(u.dot(&(x - center)));
    rim.sort_by(|x, y| angle(x).total_cmp(&angle(y)));
    faces.push((*normal, rim));
    Some(Part { faces })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cuboid(min: [f64; 3], max: [f64; 3]) -> Part {
        let (min, max) = (Vec3::from(min), Vec3::from(max));
        riprap_dda::Polyhedron::cuboid(min, max)
            .map(|p| super::super::parts(&riprap_dda::Shape::Polyhedra(vec![p])).remove(0))
            .unwrap_or_default()
    }

    /// `V = Σ_f n_f·x_f A_f/3`, with every face fanned from its first corner.
    fn volume(part: &Part) -> f64 {
        let cone = |(_, x): &(Vec3, Vec<Vec3>)| {
            let fan = x.windows(2).skip(1);
            fan.map(|e| x[0].dot(&(e[0] - x[0]).cross(&(e[1] - x[0]))) / 6.0)
                .sum::<f64>()
        };
        part.faces.iter().map(cone).sum()
    }

    #[test]
    fn overlapping_boxes_fill_the_volume_of_their_union() {
        let floor = cuboid([0.0, 0.0, 0.0], [4.0, 3.0, 1.0]);
        let wall = cuboid([-0.5, 0.0, 0.5], [1.0, 3.0, 5.0]);
        let inner = cuboid([1.0, 1.0, 0.25], [2.0, 2.0, 0.75]);
        let parts = disjoint(vec![floor, wall, inner]);
        let total: f64 = parts.iter().map(volume).sum();
        // 12 + 1.5·3·4.5 less the corner in common, 1·3·0.5; the third box is inside the first
        let expected = 12.0 + 20.25 - 1.5;
        assert!((total - expected).abs() < 1e-12 * expected, "{total}");
    }

    #[test]
    fn a_box_across_an_edge_of_symmetry_is_cut_and_mirrored() {
        let planes = [(0, true), (1, false)].map(|(axis, is_upper)| SymmetryPlane {
            axis,
            is_upper,
            place: 1.0,
        });
        let quarter = clipped_by_symmetry(&cuboid([0.0; 3], [2.0; 3]), &planes).unwrap_or_default();
        let (min, max) = quarter.aabb();
        assert_eq!(
            (min, max),
            (Vec3::new(0.0, 1.0, 0.0), Vec3::new(1.0, 2.0, 2.0))
        );
        assert!((volume(&quarter) - 2.0).abs() < 1e-12);
        let image = image(&quarter, &planes[0]);
        assert_eq!(image.aabb().1, Vec3::new(2.0, 2.0, 2.0));
        // outward faces are counter-clockwise: the volume is above zero
        assert!((volume(&image) - 2.0).abs() < 1e-12);
        assert!(clipped_by_symmetry(&cuboid([1.0; 3], [2.0; 3]), &planes).is_none());
    }

    #[test]
    fn parts_that_adjoin_stay_whole() {
        let floor = cuboid([0.0, 0.0, 0.0], [4.0, 3.0, 1.0]);
        let wall = cuboid([0.0, 0.0, 1.0], [1.0, 3.0, 5.0]);
        let parts = vec![floor, wall];
        assert_eq!(disjoint(parts.clone()), parts);
    }

    #[test]
    fn a_box_is_cut_into_nine() {
        let planes = [Vec3::x(), Vec3::y()].map(|n| [(n, 0.25), (-n, -0.5), (n, 1.0)]);
        let pieces = pieces(cuboid([0.0; 3], [1.0; 3]), planes.into_iter().flatten());
        let total: f64 = pieces.iter().map(volume).sum();
        assert_eq!(pieces.len(), 9);
        assert!((total - 1.0).abs() < 1e-12, "{total}");
    }

    #[test]
    fn a_corner_is_cut_off_a_box() {
        let cube = cuboid([0.0; 3], [1.0; 3]);
        let diagonal = Vec3::repeat(1.0).normalize();
        // the plane through three neighbors of the corner (1, 1, 1) leaves 5/6
        let left = below(&cube, &diagonal, 2.0 / 3.0_f64.sqrt());
        let left = left.map_or(0.0, |part| volume(&part));
        assert!((left - 5.0 / 6.0).abs() < 1e-12, "{left}");
    }
}
