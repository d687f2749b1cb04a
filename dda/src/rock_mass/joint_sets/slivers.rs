//! Slivers of a cut rock mass, joined with a neighbor.
//!
//! Two blocks are neighbors if they share a piece of a face. The blocks and their shared areas
//! are a graph, and merging two blocks contracts an edge of it: areas add up without new measurement.

use super::JointError;
use crate::geometry::bounds::{Bounds, candidates, grown};
use crate::geometry::clip::{OnPlane, clip};
use crate::{BlockQuality, Polyhedron, Vec3, face_area, volume};
use std::collections::{BTreeMap, BTreeSet};

/// Definition of slivers: blocks beyond either limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SliverLimits {
    /// Blocks with less than this share of the median volume are slivers, 0 (none is) to 1.
    pub volume_share: f64,
    /// Blocks with a larger [`BlockQuality::aspect`] are slivers, ≥ 2 (a cube has 1.7); infinite: none is.
    pub aspect: f64,
}

/// A rock mass without slivers.
#[derive(Clone, Debug, PartialEq)]
pub struct MergedMass {
    /// Convex parts of each block, in the order in which the joints made the blocks: most have one.
    pub blocks: Vec<Vec<Polyhedron>>,
    /// Slivers that were joined with a neighbor.
    pub n_merged: usize,
    /// Slivers that are left, because they share no face with another block.
    pub n_left: usize,
}

/// Joins slivers with the neighbor with which they share the largest area, the smallest first, until no
/// block with a neighbor is a sliver. Nothing is removed: the volume stays the same.
///
/// A convex union becomes one polyhedron; any other is a block of several parts, reduced by merging convex
/// pairs. The median volume is that of the blocks before. Of equal areas the one
/// with the smaller neighbor counts. Volumes and areas that agree within 1e-9 are equal, and of equals the
/// block created first goes first, so that a rotated mass is merged identically.
///
/// # Errors
///
/// [`JointError::Slivers`] for limits out of range.
pub fn merge_slivers(
    blocks: Vec<Polyhedron>,
    limits: &SliverLimits,
) -> Result<MergedMass, JointError> {
    merge_union_slivers(
        blocks.into_iter().map(|block| vec![block]).collect(),
        limits,
    )
}

/// As [`merge_slivers`], of blocks of several convex parts.
///
/// # Errors
///
/// As [`merge_slivers`].
pub fn merge_union_slivers(
    blocks: Vec<Vec<Polyhedron>>,
    limits: &SliverLimits,
) -> Result<MergedMass, JointError> {
    limits.check()?;
    let of_block = |parts: &Vec<Polyhedron>| parts.iter().map(volume).sum();
    let mut volumes: Vec<f64> = blocks.iter().map(of_block).collect();
    volumes.sort_by(f64::total_cmp);
    let median = volumes.get(volumes.len() / 2).copied().unwrap_or(0.0);
    let mut shared = shared_areas(&blocks);
    let mut parts = blocks;
    let judge = |parts: &[Polyhedron]| {
        let quality = BlockQuality::of_union(parts);
        (
            (quality.volume / (SAME * median)).round() as u64,
            limits.is_passed(&quality, median),
        )
    };
    let (mut ranks, is_sliver): (Vec<u64>, Vec<bool>) = parts.iter().map(|p| judge(p)).unzip();
    let mut slivers: BTreeSet<(u64, usize)> = (0..parts.len())
        .filter(|&block| is_sliver[block])
        .map(|block| (ranks[block], block))
        .collect();
    let (mut n_merged, mut n_left) = (0, 0);
    while let Some((_, sliver)) = slivers.pop_first() {
        let Some(neighbor) = largest(&shared[sliver], &ranks) else {
            n_left += 1;
            continue;
        };
        n_merged += 1;
        contract(&mut shared, sliver, neighbor);
        slivers.remove(&(ranks[neighbor], neighbor));
        let added = std::mem::take(&mut parts[sliver]);
        let union = union(std::mem::take(&mut parts[neighbor]), added);
        let (rank, is_sliver) = judge(&union);
        ranks[neighbor] = rank;
        if is_sliver {
            slivers.insert((rank, neighbor));
        }
        parts[neighbor] = union;
    }
    parts.retain(|parts| !parts.is_empty());
    Ok(MergedMass {
        blocks: parts,
        n_merged,
        n_left,
    })
}

/// Volumes and areas that differ by less than this are the same; relative. A volume's rank is its number of
/// such steps of the median.
const SAME: f64 = 1e-9;

impl SliverLimits {
    fn check(&self) -> Result<(), JointError> {
        let refused = |field, value, rule| Err(JointError::Slivers { field, value, rule });
        if !(0.0..=1.0).contains(&self.volume_share) {
            return refused("volume_share", self.volume_share, "must be in [0, 1]");
        }
        if !(2.0 <= self.aspect) {
            return refused("aspect", self.aspect, "must be >= 2; a cube has 1.7");
        }
        Ok(())
    }

    fn is_passed(&self, quality: &BlockQuality, median: f64) -> bool {
        quality.volume < self.volume_share * median || quality.aspect > self.aspect
    }
}

/// Areas that each block shares with its neighbors; m².
type SharedAreas = Vec<BTreeMap<usize, f64>>;

/// The neighbor with the largest area; of those alike the smallest, so that a pile of slivers becomes
/// blocks and not one block, and of these the first.
fn largest(areas: &BTreeMap<usize, f64>, ranks: &[u64]) -> Option<usize> {
    let most = areas.values().copied().fold(0.0, f64::max);
    let alike = areas
        .iter()
        .filter(|(_, area)| **area >= (1.0 - SAME) * most);
    alike
        .map(|(&block, _)| block)
        .min_by_key(|&block| ranks[block])
}

/// The neighbors of a block become those of another one.
fn contract(shared: &mut SharedAreas, gone: usize, kept: usize) {
    for (other, area) in std::mem::take(&mut shared[gone]) {
        shared[other].remove(&gone);
        if other != kept {
            *shared[other].entry(kept).or_default() += area;
            *shared[kept].entry(other).or_default() += area;
        }
    }
}

fn shared_areas(blocks: &[Vec<Polyhedron>]) -> SharedAreas {
    let parts: Vec<(usize, &Polyhedron)> = blocks
        .iter()
        .enumerate()
        .flat_map(|(block, parts)| parts.iter().map(move |part| (block, part)))
        .collect();
    let boxes: Vec<Bounds> = parts
        .iter()
        .map(|(_, part)| grown(&part.aabb(), gap(part)))
        .collect();
    let mut pairs = Vec::new();
    let are_of_two = |a: u32, b: u32| parts[a as usize].0 != parts[b as usize].0;
    candidates(&boxes, &vec![true; parts.len()], are_of_two, &mut pairs);
    let mut shared: SharedAreas = vec![BTreeMap::new(); blocks.len()];
    for (a, b) in pairs {
        let ((a, part), (b, other)) = (parts[a as usize], parts[b as usize]);
        let area = shared_area(part, other);
        if area > 0.0 {
            *shared[a].entry(b).or_default() += area;
            *shared[b].entry(a).or_default() += area;
        }
    }
    shared
}

/// Largest distance of touching faces; m. Ten times the tolerance of a cut, which refers to the block
/// that was cut, whose parts may be smaller.
fn gap(block: &Polyhedron) -> f64 {
    10.0 * block.same_place()
}

/// Area of the faces that two convex blocks share; m².
pub(super) fn shared_area(a: &Polyhedron, b: &Polyhedron) -> f64 {
    let gap = gap(a).max(gap(b));
    let lies_in = |small: &Polyhedron, face: usize, large: &Polyhedron, plane: usize| {
        let mut corners = corners(small, face);
        corners.all(|x| large.plane_distance(plane, &x).abs() <= gap)
    };
    let mut area = 0.0;
    for i in 0..a.n_faces() {
        for j in 0..b.n_faces() {
            // The plane of a large face is more accurate than that of a small one.
            if a.face_normal(i).dot(&b.face_normal(j)) < -0.9
                && (lies_in(a, i, b, j) || lies_in(b, j, a, i))
            {
                let common = common_area(corners(a, i).collect(), b, j);
                // Faces that only share an edge have rounding in common.
                if common > SAME * face_area(a, i).min(face_area(b, j)) {
                    area += common;
                }
            }
        }
    }
    area
}

fn corners(body: &Polyhedron, face: usize) -> impl Iterator<Item = Vec3> + '_ {
    body.face_vertices(face)
        .map(|v| body.vertices()[v as usize])
}

/// Area of a convex polygon inside a face, clipped along the sides of the face one by one; m².
fn common_area(mut polygon: Vec<Vec3>, body: &Polyhedron, face: usize) -> f64 {
    let normal = body.face_normal(face);
    let rim: Vec<Vec3> = corners(body, face).collect();
    let mut spare = Vec::with_capacity(polygon.len() + 1);
    for (k, from) in rim.iter().enumerate() {
        let inward = normal.cross(&(rim[(k + 1) % rim.len()] - from));
        clip(
            (&mut polygon, &mut spare),
            OnPlane::Once,
            |x| -inward.dot(&(x - from)),
            |at| at.point(),
        );
    }
    let Some(first) = polygon.first() else {
        return 0.0;
    };
    let fan = polygon
        .windows(2)
        .map(|side| (side[0] - first).cross(&(side[1] - first)));
    fan.sum::<Vec3>().norm() / 2.0
}

/// The parts of a block, joined as far as two of them, or all, are convex together.
pub(super) fn united(parts: Vec<Polyhedron>) -> Vec<Polyhedron> {
    union(Vec::new(), parts)
}

/// Convex parts of the union of two blocks, joined as far as two of them, or all, are convex together.
fn union(mut parts: Vec<Polyhedron>, added: Vec<Polyhedron>) -> Vec<Polyhedron> {
    for mut part in added {
        while let Some((k, larger)) = parts
            .iter()
            .enumerate()
            .find_map(|(k, other)| Some((k, convex_union(&[other, &part])?)))
        {
            parts.remove(k);
            part = larger;
        }
        parts.push(part);
    }
    let whole = match parts.len() {
        0..=2 => None,
        _ => convex_union(&parts.iter().collect::<Vec<_>>()),
    };
    whole.map_or(parts, |whole| vec![whole])
}

/// The union of polyhedra that do not overlap, if it is convex: if their hull has no more volume than they
/// have.
fn convex_union(parts: &[&Polyhedron]) -> Option<Polyhedron> {
    let hull = hull_of(parts)?;
    let sum: f64 = parts.iter().map(|part| volume(part)).sum();
    // Rounding moves the surface of the hull by that of its corners.
    let farthest = hull.vertices().iter().map(|x| x.amax()).fold(0.0, f64::max);
    let surface: f64 = (0..hull.n_faces()).map(|face| face_area(&hull, face)).sum();
    let rounding = 4.0 * f64::EPSILON * farthest * surface;
    ((volume(&hull) - sum).abs() <= CONVEX * sum + rounding).then_some(hull)
}

/// The hull of a block of several convex parts, if it has no more volume than they have and a share of it on top,
/// ≥ 0: dents of a raster's last digit are filled.
#[must_use]
pub fn hull_within(parts: &[Polyhedron], share: f64) -> Option<Polyhedron> {
    let hull = hull_of(&parts.iter().collect::<Vec<_>>())?;
    let sum: f64 = parts.iter().map(volume).sum();
    (volume(&hull) <= (1.0 + share) * sum).then_some(hull)
}

fn hull_of(parts: &[&Polyhedron]) -> Option<Polyhedron> {
    let mut points: Vec<Vec3> = Vec::new();
    let size = parts.iter().map(|part| part.size()).fold(0.0, f64::max);
    // Corners in common may differ by rounding, of which no hull can be made.
    for x in parts.iter().flat_map(|part| part.vertices()) {
        if points.iter().all(|y| (y - x).norm() > SAME * size) {
            points.push(*x);
        }
    }
    Polyhedron::convex_hull(&points).ok()
}

/// A union is convex if its hull has the volume of its parts within this share. A thousand times stricter
/// than the shape of a block needs, so that the volume of a mass stays the same within it.
const CONVEX: f64 = 1e-12;
