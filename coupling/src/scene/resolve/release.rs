//! Speed of water that nothing holds at the start, as in a dam break.

use riprap_dda::{Motion, Polyhedron, Shape, Vec3};

use super::solids::Solids;
use crate::scene::file::{RegionShapeFile, SceneFile, vec3};

/// Heights and places along a side at which it is looked at.
const SAMPLES: usize = 8;
/// Distances outside of a side at which something may hold it; × spacing.
const DISTANCES: [f64; 3] = [0.01, 0.5, 1.0];
/// Rise of a gate from which it holds no water; × height of the water.
const DRAWN: f64 = 0.25;

/// Speed of the front of the highest box of water that has a side without a solid, other water or the end of the domain; 0
/// without one. A gate that is drawn is none.
///
/// ```text
/// v = 2 √(g H)                      H above the lowest place where nothing holds it
/// ```
/// Source: Ritter (1892), front on a dry bed without friction.
pub(super) fn front_speed(file: &SceneFile, solids: &Solids, spacing: f64) -> f64 {
    let boxes: Vec<(Vec3, Vec3)> = (file.fluid.iter())
        .flat_map(|fluid| &fluid.regions)
        .filter_map(|region| match region.shape {
            RegionShapeFile::Box { min, max } => Some((vec3(min), vec3(max))),
            // fills what is closed
            RegionShapeFile::Below { .. } => None,
        })
        .collect();
    let heads = boxes.iter().map(|&water| {
        let is_held = |x: &Vec3| {
            is_outside(x, (vec3(file.domain.min), vec3(file.domain.max)))
                || boxes.iter().any(|&(min, max)| is_within(x, (min, max)))
                || is_in_solid(x, solids, (water, file.time.duration))
        };
        head(water, spacing, is_held)
    });
    2.0 * (vec3(file.gravity).norm() * heads.fold(0.0, f64::max)).sqrt()
}

/// Height of a box of water above the lowest place of its sides where nothing holds it; m.
fn head((min, max): (Vec3, Vec3), spacing: f64, is_held: impl Fn(&Vec3) -> bool) -> f64 {
    let share = |k: usize| (k as f64 + 0.5) / SAMPLES as f64;
    let mut head = 0.0_f64;
    for (axis, along) in [(0, 1), (1, 0)] {
        for (side, outward) in [(min, -1.0), (max, 1.0)] {
            for (height, place) in (0..SAMPLES * SAMPLES).map(|k| (k / SAMPLES, k % SAMPLES)) {
                let mut x = min + (max - min) * share(height);
                x[along] = min[along] + (max - min)[along] * share(place);
                let at = |distance: f64| {
                    let mut x = x;
                    x[axis] = side[axis] + outward * distance * spacing;
                    x
                };
                if !DISTANCES.iter().any(|&distance| is_held(&at(distance))) {
                    // the lowest share stands for the bottom
                    let depth = (max.z - min.z) * (1.0 - height as f64 / SAMPLES as f64);
                    head = head.max(depth);
                }
            }
        }
    }
    head
}

fn is_within(x: &Vec3, (min, max): (Vec3, Vec3)) -> bool {
    (0..3).all(|k| min[k] <= x[k] && x[k] <= max[k])
}

/// Whether a point is beyond a side, where there is nothing to flow to.
fn is_outside(x: &Vec3, (min, max): (Vec3, Vec3)) -> bool {
    (0..2).any(|k| x[k] <= min[k] || max[k] <= x[k])
}

/// Whether a point is in a solid that stays there; surfaces count as one, since they reach below all water.
fn is_in_solid(x: &Vec3, solids: &Solids, (water, duration): ((Vec3, Vec3), f64)) -> bool {
    let height = water.1.z - water.0.z;
    let is_drawn = |motion: &Motion| match motion {
        Motion::Prescribed(path) => DRAWN * height < path.displacement(duration).z,
        Motion::Fixed | Motion::Free => false,
    };
    let mut bodies = solids.motions.iter().zip(&solids.named);
    bodies.any(|(motion, (_, shape))| {
        !is_drawn(motion)
            && match shape {
                Shape::Polyhedra(parts) => parts.iter().any(|part| is_in_part(x, part)),
                Shape::Sphere { .. } => is_within(x, shape.aabb()),
                Shape::Surface(_) => true,
            }
    })
}

fn is_in_part(x: &Vec3, part: &Polyhedron) -> bool {
    (0..part.n_faces()).all(|face| {
        let on_face = part.face_vertices(face).next();
        on_face.is_none_or(|vertex| {
            let corner = part.vertices()[vertex as usize];
            part.face_normal(face).dot(&(x - corner)) <= 0.0
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const COLUMN: (Vec3, Vec3) = (Vec3::new(0.0, 0.0, 0.0), Vec3::new(1.0, 1.0, 2.0));

    #[test]
    fn a_column_stands_if_all_its_sides_are_held() {
        assert_eq!(head(COLUMN, 0.1, |_| true), 0.0);
    }

    #[test]
    fn a_column_falls_from_where_it_is_not_held() {
        // its right side above a quarter of its height
        let is_held = |x: &Vec3| x.x < 1.0 || x.z < 0.5;
        assert_eq!(head(COLUMN, 0.1, is_held), 1.5);
        assert_eq!(head(COLUMN, 0.1, |x| x.x < 1.0), 2.0);
    }
}
