//! Rock masses of any shape: convex bodies that adjoin, cut as one.

use super::slivers::{shared_area, united};
use super::{Body, Joint, JointError, JointSet, cut_bodies, expected_blocks};
use crate::{Plane, Polyhedron, Vec3, volume};

/// A rock mass of any shape cut by joints.
#[derive(Clone, Debug, PartialEq)]
pub struct JointedUnion {
    /// Convex parts of each block, which adjoin; most blocks inside the mass have one.
    pub blocks: Vec<Vec<Polyhedron>>,
    /// Cuts of parts that were not made, because a piece would have been too thin to be a polyhedron.
    pub n_uncut: usize,
    /// Joints that cut a block, in the order in which they did.
    pub joints: Vec<Joint>,
}

/// Cuts one body, of adjoining convex parts, by all joints of all sets, in their order: like [`super::cut_by_joints`], but parts
/// are not separate blocks. Rock between the same joints is one block, or several if it is not connected.
///
/// Chance decides about a joint for everything between the joints before it, whatever the body's shape there.
///
/// # Errors
///
/// As [`super::cut_by_joints`].
pub fn cut_union_by_joints(
    parts: Vec<Polyhedron>,
    sets: &[JointSet],
    seed: u64,
    max_blocks: usize,
) -> Result<JointedUnion, JointError> {
    let boxes = parts.iter().map(Polyhedron::aabb);
    let none = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    let (min, max) = boxes.fold(none, |(min, max), (low, high)| {
        (min.inf(&low), max.sup(&high))
    });
    let Ok(whole) = Polyhedron::cuboid(min, max) else {
        return Ok(JointedUnion {
            blocks: Vec::new(),
            n_uncut: 0,
            joints: Vec::new(),
        });
    };
    let filled = parts.iter().map(volume).sum::<f64>() / volume(&whole);
    let expected = expected_blocks(std::slice::from_ref(&whole), sets).about * filled;
    let mass = Compound { whole, parts };
    let cut = cut_bodies(vec![mass], sets, seed, (max_blocks, expected))?;
    let pieces = cut
        .bodies
        .into_iter()
        .flat_map(|compound| connected(compound.parts));
    Ok(JointedUnion {
        blocks: pieces.map(united).collect(),
        n_uncut: cut.n_uncut,
        joints: cut.joints,
    })
}

/// Rock between the same joints.
struct Compound {
    /// All of the space between them, as far as the mass's box goes.
    whole: Polyhedron,
    /// Its rock.
    parts: Vec<Polyhedron>,
}

impl Body for Compound {
    fn whole(&self) -> &Polyhedron {
        &self.whole
    }

    fn corners(&self) -> impl Iterator<Item = &Vec3> {
        self.parts.iter().flat_map(|part| part.vertices())
    }

    fn divided(self, halves: [Polyhedron; 2], plane: &Plane, n_uncut: &mut usize) -> Vec<Self> {
        let mut sides = [Vec::new(), Vec::new()];
        for part in self.parts {
            match part.cut(plane) {
                Ok(Some((below, above))) => {
                    sides[0].push(below);
                    sides[1].push(above);
                }
                uncut => {
                    *n_uncut += usize::from(uncut.is_err());
                    let height: f64 = part.vertices().iter().map(|x| plane.height(x)).sum();
                    sides[usize::from(0.0 < height)].push(part);
                }
            }
        }
        let halves = halves.into_iter().zip(sides);
        halves
            .filter(|(_, parts)| !parts.is_empty())
            .map(|(whole, parts)| Self { whole, parts })
            .collect()
    }
}

/// Parts sorted into bodies that hang together by faces, in the order of their first parts.
fn connected(mut parts: Vec<Polyhedron>) -> Vec<Vec<Polyhedron>> {
    let mut bodies = Vec::new();
    while !parts.is_empty() {
        let mut body = vec![parts.remove(0)];
        let mut next = 0;
        while next < body.len() {
            let (beside, apart) = parts
                .into_iter()
                .partition(|part| 0.0 < shared_area(&body[next], part));
            body.extend::<Vec<_>>(beside);
            parts = apart;
            next += 1;
        }
        bodies.push(body);
    }
    bodies
}
