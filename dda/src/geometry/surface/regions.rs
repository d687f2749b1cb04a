//! Regions of the triangles behind a surface: sharp ridges that bound them, and planes of several triangles.

use super::{Divide, FLAT, NONE};
use crate::Vec3;

/// Cosine of the least angle between the sides of a sharp ridge.
const RIDGE: f64 = 0.9;
/// Cosine of the largest angle between triangles considered almost coplanar.
const GOES_ON: f64 = 0.99;

/// Planes at sharp ridges that bound the region of each triangle: start of those of each triangle, and all.
///
/// The ridges are those of almost coplanar triangles within two rings of neighbors, by vertex, if the triangle lies entirely on the
/// inner side of the plane.
pub(super) fn ridges_beside(
    (vertices, triangles, normal): (&[Vec3], &[[u32; 3]], &[Vec3]),
    (neighbor, divide): (&[[u32; 3]], &[[Divide; 3]]),
) -> (Vec<u32>, Vec<Divide>) {
    let mut around = vec![Vec::new(); vertices.len()];
    for (t, corners) in triangles.iter().enumerate() {
        for &v in corners {
            around[v as usize].push(t);
        }
    }
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
    let mut start = vec![0];
    let mut ridges = Vec::new();
    let mut beside: Vec<usize> = Vec::new();
    for (t, corners) in triangles.iter().enumerate() {
        beside.clear();
        beside.push(t);
        for _ring in 0..2 {
            let inner = beside.len();
            for k in 0..inner {
                let corners = triangles[beside[k]];
                beside.extend(corners.iter().flat_map(|&v| &around[v as usize]));
            }
            beside.sort_unstable();
            beside.dedup();
            beside.retain(|&u| normal[u].dot(&normal[t]) > GOES_ON);
        }
        beside.retain(|&u| u != t);
        let [a, b, c] = corners.map(|v| vertices[v as usize]);
        let slack = FLAT * ((b - a).norm() + (c - b).norm());
        for &u in &beside {
            for k in (0..3).filter(|&k| is_ridge(u, k)) {
                let (outward, offset) = divide[u][k];
                if [a, b, c].iter().all(|x| outward.dot(x) <= offset + slack) {
                    ridges.push((outward, offset));
                }
            }
        }
        start.push(ridges.len() as u32);
    }
    (start, ridges)
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
