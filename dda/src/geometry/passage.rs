//! Passage of a straight path through a convex part: where it enters, and through which surface it leaves.

use crate::geometry::parts::Part;
use crate::{Polyhedron, Vec3};

/// Passage of a straight path that begins outside of a convex part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Share of the path at which it enters; –.
    pub share: f64,
    /// Outward unit normal there.
    pub normal: Vec3,
    /// Outward unit normal at which it leaves; `None` if it ends inside.
    pub exit: Option<Vec3>,
}

impl Part {
    /// Passage of the path between two points (m) through the part; `None` if it begins inside or misses it, and for a
    /// surface of triangles, behind which all is inside.
    pub fn passage(&self, from: &Vec3, to: &Vec3) -> Option<Passage> {
        match self {
            Self::Polyhedron(body) => through_polyhedron(body, from, to),
            Self::Sphere { center, radius } => {
                through_sphere(&(from - center), &(to - from), *radius)
            }
            Self::Surface(_) => None,
        }
    }
}

/// The part of the path that is behind every face.
fn through_polyhedron(body: &Polyhedron, from: &Vec3, to: &Vec3) -> Option<Passage> {
    let mut entry: Option<(f64, Vec3)> = None;
    let mut exit: Option<(f64, Vec3)> = None;
    for face in 0..body.n_faces() {
        let (before, after) = (
            body.plane_distance(face, from),
            body.plane_distance(face, to),
        );
        if 0.0 < before && 0.0 < after {
            return None;
        }
        let share = before / (before - after);
        if 0.0 < before && entry.is_none_or(|(latest, _)| latest < share) {
            entry = Some((share, body.face_normal(face)));
        } else if 0.0 < after && exit.is_none_or(|(earliest, _)| share < earliest) {
            exit = Some((share, body.face_normal(face)));
        }
    }
    let (share, normal) = entry?;
    let is_hit = exit.is_none_or(|(leaves, _)| share < leaves);
    is_hit.then_some(Passage {
        share,
        normal,
        exit: exit.map(|(_, normal)| normal),
    })
}

/// ```text
/// |f + s d|² = r²
/// ```
/// `f` is the start relative to the center, `d` the path.
fn through_sphere(from: &Vec3, path: &Vec3, radius: f64) -> Option<Passage> {
    let outside = from.norm_squared() - radius * radius;
    let approach = -from.dot(path);
    let square = approach * approach - path.norm_squared() * outside;
    if outside <= 0.0 || approach <= 0.0 || square < 0.0 {
        return None;
    }
    let share = outside / (approach + square.sqrt());
    let leaves = (approach + square.sqrt()) / path.norm_squared();
    let normal = |share: f64| (from + path * share) / radius;
    (share <= 1.0).then(|| Passage {
        share,
        normal: normal(share),
        exit: (leaves < 1.0).then(|| normal(leaves)),
    })
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    #[test]
    fn paths_through_a_plate_and_a_sphere() {
        let plate = Polyhedron::cuboid(Vec3::zeros(), Vec3::new(1.0, 1.0, 0.25)).unwrap();
        let plate = Part::Polyhedron(Box::new(plate));
        let sphere = Part::Sphere {
            center: Vec3::repeat(0.5),
            radius: 0.5,
        };
        let (up, along) = (Vec3::z(), Vec3::x());
        let cases = [
            // part, from, to, share, entry, exit
            (
                &plate,
                [0.5, 0.5, 0.75],
                [0.5, 0.5, -0.25],
                Some((0.5, up, Some(-up))),
            ),
            (
                &plate,
                [0.5, 0.5, 0.75],
                [0.5, 0.5, 0.125],
                Some((0.8, up, None)),
            ),
            (
                &plate,
                [0.75, 0.5, 0.5],
                [1.05, 0.5, 0.0],
                Some((0.5, up, Some(along))),
            ),
            // short of it, past it, from inside, away
            (&plate, [0.5, 0.5, 0.75], [0.5, 0.5, 0.26], None),
            (&plate, [0.9, 0.5, 0.5], [1.4, 0.5, 0.0], None),
            (&plate, [0.5, 0.5, 0.125], [0.5, 0.5, -1.0], None),
            (&plate, [0.5, 0.5, 0.5], [0.5, 0.5, 1.0], None),
            (
                &sphere,
                [-1.0, 0.5, 0.5],
                [3.0, 0.5, 0.5],
                Some((0.25, -along, Some(along))),
            ),
            (
                &sphere,
                [-1.0, 0.5, 0.5],
                [1.0, 0.5, 0.5],
                Some((0.5, -along, None)),
            ),
            (&sphere, [-1.0, 0.5, 0.5], [-0.1, 0.5, 0.5], None),
            (&sphere, [-1.0, 1.1, 0.5], [3.0, 1.1, 0.5], None),
            (&sphere, [0.5, 0.5, 0.5], [3.0, 0.5, 0.5], None),
        ];
        for (part, from, to, expected) in cases {
            let found = part.passage(&from.into(), &to.into());
            let Some((share, normal, exit)) = expected else {
                assert_eq!(found, None, "{from:?} {to:?}");
                continue;
            };
            let found = found.unwrap();
            assert!((found.share - share).abs() < 1e-15, "{found:?}");
            assert!((found.normal - normal).norm() < 1e-15, "{found:?}");
            assert_eq!(found.exit.is_some(), exit.is_some(), "{found:?}");
            if let (Some(found), Some(exit)) = (found.exit, exit) {
                assert!((found - exit).norm() < 1e-15, "{found:?}");
            }
        }
    }
}
