//! Regions of the triangles behind a surface: sharp ridges that bound them, and planes of several triangles.

use super::topology::Around;
use super::{Divide, FLAT, NONE};
use crate::Vec3;
use rayon::prelude::*;

/// Cosine of the least angle between the sides of a sharp ridge.
const RIDGE: f64 = 0.9;
/// Cosine of the largest angle between triangles considered almost coplanar.
const GOES_ON: f64 = 0.99;

/// Triangles that one task measures.
const CHUNK: usize = 1024;

/// Planes at sharp ridges that bound the region of each triangle: start of those of each triangle, and all.
///
/// The ridges are those of almost coplanar triangles within two rings of neighbors, by vertex, if the triangle lies entirely on the
/// inner side of the plane.
pub(super) fn ridges_beside(
    (vertices, triangles, normal): (&[Vec3], &[[u32; 3]], &[Vec3]),
    (around, neighbor, divide): (&Around, &[[u32; 3]], &[[Divide; 3]]),
) -> (Vec<u32>, Vec<Divide>) {
    let is_ridge = |t: usize, k: usize| {
        let other = neighbor[t][k];
        other != NONE && {
            let other = other as usize;
            let beyond = triangles[other].map(|v| vertices[v as usize]);
            let on_the_side = vertices[triangles[t][k] as usize];
            normal[t].dot(&normal[other]) < RIDGE
                && beyond
                    .iter()
                    .map(|x| normal[t].dot(&(x - on_the_side)))
                    .sum::<f64>()
                    < 0.0
        }
    };
    let ridges: Vec<[bool; 3]> = (0..triangles.len())
        .into_par_iter()
        .map(|t| [0, 1, 2].map(|k| is_ridge(t, k)))
        .collect();
    let has_ridge = ridges
        .iter()
        .map(|sides| sides.iter().any(|&is| is))
        .collect();
    // most triangles have none within two rings
    let is_near = next_ring(&next_ring(&has_ridge, triangles, around), triangles, around);
    let of_chunk = |chunk: usize| {
        let mut counts = Vec::with_capacity(CHUNK);
        let mut found = Vec::new();
        let mut beside: Vec<usize> = Vec::new();
        for t in chunk * CHUNK..((chunk + 1) * CHUNK).min(triangles.len()) {
            let before = found.len();
            if is_near[t] {
                almost_coplanar(t, (triangles, normal), around, &mut beside);
                let [a, b, c] = triangles[t].map(|v| vertices[v as usize]);
                let slack = FLAT * ((b - a).norm() + (c - b).norm());
                for &u in beside.iter().filter(|&&u| u != t) {
                    for k in (0..3).filter(|&k| ridges[u][k]) {
                        let (outward, offset) = divide[u][k];
                        if [a, b, c].iter().all(|x| outward.dot(x) <= offset + slack) {
                            found.push((outward, offset));
                        }
                    }
                }
            }
            counts.push((found.len() - before) as u32);
        }
        (counts, found)
    };
    let n_chunks = triangles.len().div_ceil(CHUNK);
    let chunks: Vec<(Vec<u32>, Vec<Divide>)> =
        (0..n_chunks).into_par_iter().map(of_chunk).collect();
    let mut start = vec![0];
    let mut all = Vec::new();
    let mut n = 0;
    for (counts, found) in chunks {
        for count in counts {
            n += count;
            start.push(n);
        }
        all.extend(found);
    }
    (start, all)
}

/// Triangles that are marked or share a vertex with one that is.
fn next_ring(marked: &Vec<bool>, triangles: &[[u32; 3]], around: &Around) -> Vec<bool> {
    let mut ring = marked.clone();
    for (corners, _) in triangles.iter().zip(marked).filter(|(_, is)| **is) {
        for (t, _) in corners.iter().flat_map(|&v| around.of(v)) {
            ring[t] = true;
        }
    }
    ring
}

/// Triangles within two rings of a triangle that are almost coplanar with it, it included, in ascending order.
fn almost_coplanar(
    t: usize,
    (triangles, normal): (&[[u32; 3]], &[Vec3]),
    around: &Around,
    beside: &mut Vec<usize>,
) {
    beside.clear();
    beside.push(t);
    for _ring in 0..2 {
        let inner = beside.len();
        for k in 0..inner {
            let corners = triangles[beside[k]];
            let others = corners.iter().flat_map(|&v| around.of(v));
            beside.extend(others.map(|(u, _)| u));
        }
        beside.sort_unstable();
        beside.dedup();
        beside.retain(|&u| normal[u].dot(&normal[t]) > GOES_ON);
    }
}

/// Number of the plane of each triangle: that of the first of connected triangles that are coplanar with it.
pub(super) fn planes(normal: &[Vec3], neighbor: &[[u32; 3]]) -> Vec<u32> {
    let mut plane = vec![NONE; normal.len()];
    let mut open = Vec::new();
    for first in 0..normal.len() {
        if plane[first] != NONE {
            continue;
        }
        plane[first] = first as u32;
        open.push(first);
        while let Some(triangle) = open.pop() {
            for &other in &neighbor[triangle] {
                if other != NONE
                    && plane[other as usize] == NONE
                    && normal[other as usize].cross(&normal[first]).norm() < FLAT
                    && normal[other as usize].dot(&normal[first]) > 0.0
                {
                    plane[other as usize] = first as u32;
                    open.push(other as usize);
                }
            }
        }
    }
    plane
}
