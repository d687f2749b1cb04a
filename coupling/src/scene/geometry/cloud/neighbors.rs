//! Nearest points, by a tree that does not change.
//!
//! Distances are computed here, so that their bits do not depend on the instructions that the tree uses.

use std::num::NonZero;

use kiddo::{ImmutableKdTree, SquaredEuclidean};

/// Margin of a squared radius; –.
const ROUND_OFF: f64 = 1e-12;

/// Points in a tree.
pub struct Neighbors<const D: usize> {
    points: Vec<[f64; D]>,
    tree: ImmutableKdTree<f64, D>,
}

/// A point of the tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbor {
    /// Number of the point.
    pub index: usize,
    /// Its distance; m.
    pub distance: f64,
}

impl<const D: usize> Neighbors<D> {
    /// Tree of points (m), numbered as they are; `None` without points, and for more than 2³² of them.
    pub fn of(points: Vec<[f64; D]>) -> Option<Self> {
        if points.is_empty() {
            return None;
        }
        let tree = ImmutableKdTree::new_from_slice(&points).ok()?;
        Some(Self { points, tree })
    }

    /// The points; m.
    pub fn points(&self) -> &[[f64; D]] {
        &self.points
    }

    /// Nearest point to a place (m).
    pub fn nearest(&self, place: &[f64; D]) -> Neighbor {
        let query = self.tree.query(place);
        let found = query.nearest_one::<SquaredEuclidean<f64>>().execute();
        self.neighbor(found.item, place)
    }

    /// The `n` points nearest to a place (m), or all if there are fewer, by distance and then by number.
    pub fn nearest_n(&self, place: &[f64; D], n: NonZero<usize>, found: &mut Vec<Neighbor>) {
        let query = self.tree.query(place);
        let items = query.nearest_n::<SquaredEuclidean<f64>>(n).execute();
        found.clear();
        found.extend(items.iter().map(|item| self.neighbor(item.item, place)));
        found.sort_unstable_by(|a, b| {
            (a.distance.total_cmp(&b.distance)).then(a.index.cmp(&b.index))
        });
    }

    /// Numbers of the points within a radius (m) of a place (m), in ascending order.
    pub fn within(&self, place: &[f64; D], radius: f64) -> Vec<usize> {
        // the tree's own rounding must not lose a point on the rim
        let square = (radius * radius) * (1.0 + ROUND_OFF);
        let query = self.tree.query(place);
        let items = query.within::<SquaredEuclidean<f64>>(square).execute();
        let mut found: Vec<usize> = items.iter().map(|item| item.item as usize).collect();
        found.retain(|&k| self.neighbor(k as u32, place).distance <= radius);
        found.sort_unstable();
        found
    }

    fn neighbor(&self, item: u32, place: &[f64; D]) -> Neighbor {
        let index = item as usize;
        let apart = self.points[index].iter().zip(place).map(|(a, b)| a - b);
        Neighbor {
            index,
            distance: apart.map(|d| d * d).sum::<f64>().sqrt(),
        }
    }
}
