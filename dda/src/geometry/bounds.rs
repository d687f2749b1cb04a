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
use rayon::prelude::*;

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
/// Linear in the number of boxes that are about as large as most that can move: they are sorted into cells of that size. The others, walls and
/// bodies much larger than the rest, are in a tree of bounding volumes, which each of the small ones asks.
pub(crate) fn candidates(
    boxes: &[Bounds],
    can_move: &[bool],
    is_wanted: impl Fn(u32, u32) -> bool + Sync,
    pairs: &mut Vec<(u32, u32)>,
) {
    pairs.clear();
    let cells = Cells::of(boxes, can_move);
    let tree = Large::of(boxes, &cells);
    let list = |i: u32, j: u32, found: &mut Vec<(u32, u32)>| {
        let (low, high) = (i.min(j), i.max(j));
        if overlap(&boxes[i as usize], &boxes[j as usize]) && is_wanted(low, high) {
            found.push((low, high));
        }
    };
    let of_small = |first: usize, small: &[u32]| {
        let mut found = Vec::new();
        for (place, &i) in (first..).zip(small) {
            let moves = can_move[i as usize];
            cells.after(place, |j| {
                if moves || can_move[j as usize] {
                    list(i, j, &mut found);
                }
            });
            if moves {
                tree.touching(&boxes[i as usize], |j| list(i, j, &mut found));
            }
        }
        found
    };
    let chunks: Vec<Vec<(u32, u32)>> = if cells.order.len() <= AT_ONCE {
        vec![of_small(0, &cells.order)]
    } else {
        let chunks = cells.order.par_chunks(AT_ONCE).enumerate();
        chunks
            .map(|(k, small)| of_small(k * AT_ONCE, small))
            .collect()
    };
    chunks.iter().for_each(|found| pairs.extend(found));
    for &i in tree.numbers.iter().filter(|&&i| can_move[i as usize]) {
        tree.touching(&boxes[i as usize], |j| {
            if i < j || (i != j && !can_move[j as usize]) {
                list(i, j, pairs);
            }
        });
        // small ones that can move have listed it
        let resting = cells.order.iter().filter(|&&j| !can_move[j as usize]);
        resting.for_each(|&j| list(i, j, pairs));
    }
    pairs.sort_unstable();
}

/// Boxes that one thread looks at.
const AT_ONCE: usize = 512;
/// Largest side of a box in cells, × the median of those that can move.
const SMALL: f64 = 2.0;
/// Fewest boxes for which cells are worth their while.
const FEWEST: usize = 32;
/// Most cells a box.
const CELLS_PER_BOX: f64 = 4.0;

/// Small boxes by the cell of their middle, whose side is the largest of theirs: those that overlap are in cells side by side.
struct Cells {
    /// Numbers of the boxes, cell by cell, and the boxes in that order.
    order: Vec<u32>,
    boxes: Vec<Bounds>,
    /// First place of each cell in the order, with one past the last.
    start: Vec<u32>,
    n: [usize; 3],
    /// m.
    corner: Vec3,
    /// m.
    side: f64,
    is_small: Vec<bool>,
}

fn longest_side((low, high): &Bounds) -> f64 {
    (high - low).max()
}

fn middle((low, high): &Bounds) -> Vec3 {
    0.5 * (low + high)
}

impl Cells {
    fn of(boxes: &[Bounds], can_move: &[bool]) -> Self {
        let sides: Vec<f64> = boxes.iter().map(longest_side).collect();
        // what has left the domain is nowhere
        let is_somewhere = |i: &usize| 0.0 < sides[*i] && sides[*i].is_finite();
        let mut moving: Vec<f64> = (0..boxes.len())
            .filter(|i| can_move[*i] && is_somewhere(i))
            .map(|i| sides[i])
            .collect();
        let half = moving.len() / 2;
        let median = if FEWEST <= moving.len() {
            *moving.select_nth_unstable_by(half, f64::total_cmp).1
        } else {
            0.0
        };
        let small: Vec<usize> = (0..boxes.len())
            .filter(|i| is_somewhere(i) && sides[*i] <= SMALL * median)
            .collect();
        let mut cells = Self {
            order: vec![0; small.len()],
            boxes: Vec::new(),
            start: Vec::new(),
            n: [1; 3],
            corner: Vec3::zeros(),
            side: f64::INFINITY,
            is_small: vec![false; boxes.len()],
        };
        small.iter().for_each(|&i| cells.is_small[i] = true);
        if let Some(&first) = small.first() {
            let ends = small.iter().map(|&i| middle(&boxes[i]));
            let at = middle(&boxes[first]);
            let (low, high) = ends.fold((at, at), |(low, high), x| (low.inf(&x), high.sup(&x)));
            let largest = small.iter().map(|&i| sides[i]).fold(0.0, f64::max);
            let extent = high - low;
            // few boxes far apart get larger cells
            let most = CELLS_PER_BOX * small.len() as f64;
            let mut side = largest * (1.0 + 1e-12);
            while most < extent.iter().map(|l| (l / side).floor() + 1.0).product() {
                side *= 1.5;
            }
            cells.side = side;
            cells.corner = low;
            cells.n = [0, 1, 2].map(|k| (extent[k] / side) as usize + 1);
        }
        let of = |i: usize| cells.index(cells.place(&middle(&boxes[i])));
        let mut start = vec![0u32; cells.n.iter().product::<usize>() + 1];
        small.iter().for_each(|&i| start[of(i) + 1] += 1);
        for k in 1..start.len() {
            start[k] += start[k - 1];
        }
        let mut next = start.clone();
        let mut order = std::mem::take(&mut cells.order);
        for &i in &small {
            let place = &mut next[cells.index(cells.place(&middle(&boxes[i])))];
            order[*place as usize] = i as u32;
            *place += 1;
        }
        cells.boxes = order.iter().map(|&i| boxes[i as usize]).collect();
        (cells.start, cells.order) = (start, order);
        cells
    }

    fn place(&self, x: &Vec3) -> [usize; 3] {
        [0, 1, 2].map(|k| (((x[k] - self.corner[k]) / self.side) as usize).min(self.n[k] - 1))
    }

    fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        (k * self.n[1] + j) * self.n[0] + i
    }

    /// Small boxes that overlap the one at a place of the order, each pair of them found at one of its places only: those after it in its own cell,
    /// and those in half of the cells around.
    fn after(&self, place: usize, mut each: impl FnMut(u32)) {
        let bounds = &self.boxes[place];
        let [i, j, k] = self.place(&middle(bounds));
        let (west, east) = (i.saturating_sub(1), (i + 1).min(self.n[0] - 1));
        // cells side by side along x are one piece
        let end = |j: usize, k: usize| self.start[self.index([east, j, k]) + 1] as usize;
        let row = |j: usize, k: usize| self.start[self.index([west, j, k])] as usize..end(j, k);
        let mut look = |places: std::ops::Range<usize>| {
            let others = self.boxes[places.clone()].iter().zip(&self.order[places]);
            others
                .filter(|(other, _)| overlap(bounds, other))
                .for_each(|(_, &number)| each(number));
        };
        look(place + 1..end(j, k));
        if j + 1 < self.n[1] {
            look(row(j + 1, k));
        }
        if k + 1 < self.n[2] {
            let rows = j.saturating_sub(1)..=(j + 1).min(self.n[1] - 1);
            rows.for_each(|j| look(row(j, k + 1)));
        }
    }
}

/// The other boxes, in a tree.
struct Large {
    numbers: Vec<u32>,
    tree: Bvh,
}

impl Large {
    fn of(boxes: &[Bounds], cells: &Cells) -> Self {
        let numbers: Vec<u32> = (0..boxes.len() as u32)
            .filter(|&i| !cells.is_small[i as usize])
            .collect();
        let leaves: Vec<Aabb> = numbers.iter().map(|&i| leaf(&boxes[i as usize])).collect();
        Self {
            numbers,
            tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves),
        }
    }

    /// Boxes that touch one, itself among them.
    fn touching(&self, bounds: &Bounds, mut each: impl FnMut(u32)) {
        let asked = leaf(bounds);
        for j in self.tree.leaves(|node| node.aabb().intersects(&asked)) {
            each(self.numbers[j as usize]);
        }
    }
}

fn leaf((lower, upper): &Bounds) -> Aabb {
    Aabb::new(
        Vector::new(lower.x, lower.y, lower.z),
        Vector::new(upper.x, upper.y, upper.z),
    )
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

        /// Many boxes of about one size, a few that are larger, some of both at rest, some nowhere.
        #[test]
        fn cells_and_tree_find_what_brute_force_finds(
            rows in prop::collection::vec((prop::array::uniform3(-5.0..5.0_f64), 0.3..1.2_f64, 0..20_u8), 40..400)
        ) {
            let nowhere = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
            let bounds = |(x, side, kind): &([f64; 3], f64, u8)| {
                let side = if *kind == 0 { 6.0 * side } else { *side };
                let low = Vec3::from(*x);
                if *kind == 1 { nowhere } else { (low, low.add_scalar(side)) }
            };
            let boxes: Vec<Bounds> = rows.iter().map(bounds).collect();
            let can_move: Vec<bool> = rows.iter().enumerate().map(|(k, (.., kind))| (*kind + k as u8) % 5 != 2).collect();
            let mut pairs = Vec::new();
            candidates(&boxes, &can_move, |_, _| true, &mut pairs);
            prop_assert_eq!(pairs, brute_force(&boxes, &can_move));
        }
    }
}
