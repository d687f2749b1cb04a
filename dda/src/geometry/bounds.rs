//! Axis-aligned bounding boxes, and the pairs of them that overlap, in a fixed order.
//!
//! The broad phase of contact asks with boxes grown by a margin: its list of pairs then remains complete until a part leaves
//! its grown box.

use crate::Vec3;
use parry3d_f64::{
    bounding_volume::{Aabb, BoundingVolume},
    math::Vector,
    partitioning::{Bvh, BvhBuildStrategy},
};

/// Lower and upper corner; m.
pub(crate) type Bounds = (Vec3, Vec3);

/// True if two boxes share a point.
pub(crate) fn overlap(a: &Bounds, b: &Bounds) -> bool {
    (0..3).all(|k| a.0[k] <= b.1[k] && b.0[k] <= a.1[k])
}

/// Distance along the axis on which two boxes are farthest apart, negative if they overlap; m.
pub(crate) fn gap(a: &Bounds, b: &Bounds) -> f64 {
    let along = |k: usize| f64::max(a.0[k] - b.1[k], b.0[k] - a.1[k]);
    along(0).max(along(1)).max(along(2))
}

/// True if the second box lies within the first.
pub(crate) fn holds(outer: &Bounds, inner: &Bounds) -> bool {
    (0..3).all(|k| outer.0[k] <= inner.0[k] && inner.1[k] <= outer.1[k])
}

/// A box enlarged by a margin (m) on every side.
pub(crate) fn grown(bounds: &Bounds, margin: f64) -> Bounds {
    (bounds.0.add_scalar(-margin), bounds.1.add_scalar(margin))
}

/// Pairs (lower, higher) of boxes that overlap and are wanted, at least one of which can move; sorted.
///
/// Almost linear in the number of boxes: a tree of bounding volumes, queried once for each box that `can_move`.
pub(crate) fn candidates(
    boxes: &[Bounds],
    can_move: &[bool],
    is_wanted: impl Fn(u32, u32) -> bool,
    pairs: &mut Vec<(u32, u32)>,
) {
    pairs.clear();
    let leaves: Vec<Aabb> = boxes
        .iter()
        .map(|(lower, upper)| {
            Aabb::new(
                Vector::new(lower.x, lower.y, lower.z),
                Vector::new(upper.x, upper.y, upper.z),
            )
        })
        .collect();
    let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves);
    for (i, leaf) in leaves.iter().enumerate().filter(|(i, _)| can_move[*i]) {
        for j in tree.leaves(|node| node.aabb().intersects(leaf)) {
            let (low, high) = (j.min(i as u32), j.max(i as u32));
            // a pair of which both can move is found twice: from the lower one it is listed
            let is_first = !can_move[j as usize] || (i as u32) < j;
            if low != high
                && is_first
                && overlap(&boxes[i], &boxes[j as usize])
                && is_wanted(low, high)
            {
                pairs.push((low, high));
            }
        }
    }
    pairs.sort_unstable();
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn brute_force(boxes: &[Bounds], can_move: &[bool]) -> Vec<(u32, u32)> {
        let n = boxes.len();
        (0..n)
            .flat_map(|i| (i + 1..n).map(move |j| (i, j)))
            .filter(|&(i, j)| (can_move[i] || can_move[j]) && overlap(&boxes[i], &boxes[j]))
            .map(|(i, j)| (i as u32, j as u32))
            .collect()
    }

    proptest! {
        #[test]
        fn the_tree_finds_what_brute_force_finds(
            rows in prop::collection::vec((prop::array::uniform3(-5.0..5.0_f64), prop::array::uniform3(0.0..3.0_f64), any::<bool>()), 0..60)
        ) {
            let boxes: Vec<Bounds> = rows.iter().map(|(x, s, _)| (Vec3::from(*x), Vec3::from(*x) + Vec3::from(*s))).collect();
            let can_move: Vec<bool> = rows.iter().map(|row| row.2).collect();
            let mut pairs = Vec::new();
            candidates(&boxes, &can_move, |_, _| true, &mut pairs);
            prop_assert_eq!(pairs, brute_force(&boxes, &can_move));
        }
    }
}
