//! Excavation of the rock between the terrain and failure surfaces.
//!
//! Within an outline each triangle of the terrain is above one of the failure surface with the same corners in plan view. Where
//! the two intersect, triangles are cut along the line of intersection. The rock above the failure surface is removed, a prism
//! for each triangle, and the remaining surface has the failure surface there, with vertical walls along the outline.

use std::collections::{BTreeMap, HashMap};

use riprap_dda::{Polyhedron, Vec3};

use super::triangles::Triangles;

/// Smallest thickness of the rock above a corner; thinner rock is none; × longest side of the triangle.
const THINNEST: f64 = 1e-6;

/// Tolerance of coincident floors below a corner; × thickness.
const SAME_FLOOR: f64 = 1e-5;

/// A triangle with the thickness of the rock at each corner; m.
#[derive(Clone, Copy, Debug)]
struct Slab {
    corners: [u32; 3],
    thickness: [f64; 3],
}

/// Ground without the rock.
#[derive(Clone, Debug, Default)]
pub struct Excavated {
    /// Points of the remaining ground; m.
    pub points: Vec<Vec3>,
    /// Triangles, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Excavated rock within each outline: adjoining convex bodies.
    pub rock: Vec<Vec<Polyhedron>>,
    /// Volume of the rock within each outline: area times mean thickness, triangle by triangle; m³.
    pub volumes: Vec<f64>,
    /// Volume of pieces too thin for bodies; m³.
    pub lost: Vec<f64>,
}

/// Removes the rock above the surface `beneath` (m) within each outline.
pub fn excavated(
    ground: &Triangles,
    n_outlines: usize,
    beneath: impl Fn(usize, [f64; 2]) -> f64,
) -> Excavated {
    let mut cut = Cut {
        points: ground.points.clone(),
        on_edge: HashMap::new(),
        thickness: BTreeMap::new(),
    };
    cut.measure(ground, &beneath);
    cut.split_edges(ground);
    let slabs: Vec<(Option<usize>, Slab)> = ground
        .corners
        .iter()
        .zip(&ground.outline)
        .flat_map(|(&corners, &outline)| {
            let parts = cut.parts(corners);
            let cut = &cut;
            parts.into_iter().map(move |corners| {
                let thickness = |corner: u32| outline.map_or(0.0, |o| cut.thickness_at(o, corner));
                let thickness = corners.map(thickness);
                (outline, Slab { corners, thickness })
            })
        })
        .collect();
    let mut found = Excavated {
        rock: vec![Vec::new(); n_outlines],
        volumes: vec![0.0; n_outlines],
        lost: vec![0.0; n_outlines],
        ..Excavated::default()
    };
    for (outline, slab) in &slabs {
        if let (Some(outline), true) = (*outline, slab.is_rock()) {
            let volume = slab.volume(&cut.points);
            found.volumes[outline] += volume;
            match slab.body(&cut.points) {
                Some(body) => found.rock[outline].push(body),
                None => found.lost[outline] += volume,
            }
        }
    }
    (found.points, found.triangles) = cut.left(&slabs);
    found
}

/// Ground being cut.
struct Cut {
    points: Vec<Vec3>,
    /// Intersection of a side, lower corner first, with the failure surface.
    on_edge: HashMap<(u32, u32), u32>,
    /// Thickness of the rock at the corners within an outline, negative where the failure surface is in the air; m.
    thickness: BTreeMap<(usize, u32), f64>,
}

fn side(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

impl Cut {
    fn thickness_at(&self, outline: usize, corner: u32) -> f64 {
        // a corner made on a side is where the rock ends
        self.thickness
            .get(&(outline, corner))
            .copied()
            .unwrap_or(0.0)
    }

    fn measure(&mut self, ground: &Triangles, beneath: &impl Fn(usize, [f64; 2]) -> f64) {
        for (corners, outline) in ground.corners.iter().zip(&ground.outline) {
            let Some(outline) = *outline else { continue };
            let longest = longest_side(&self.points, corners);
            for &corner in corners {
                let x = self.points[corner as usize];
                let thickness = x.z - beneath(outline, [x.x, x.y]);
                let is_thin = thickness.abs() < THINNEST * longest;
                let thickness = if is_thin { 0.0 } else { thickness };
                // of two triangles that differ the one that takes it for thin is right
                let known = self.thickness.entry((outline, corner)).or_insert(thickness);
                if is_thin {
                    *known = 0.0;
                }
            }
        }
    }

    fn split_edges(&mut self, ground: &Triangles) {
        for (corners, outline) in ground.corners.iter().zip(&ground.outline) {
            let Some(outline) = *outline else { continue };
            for k in 0..3 {
                let (a, b) = side(corners[k], corners[(k + 1) % 3]);
                let (above, below) = (self.thickness_at(outline, a), self.thickness_at(outline, b));
                if above * below < 0.0 && !self.on_edge.contains_key(&(a, b)) {
                    let share = above / (above - below);
                    let (from, to) = (self.points[a as usize], self.points[b as usize]);
                    self.on_edge.insert((a, b), self.points.len() as u32);
                    self.points.push(from + (to - from) * share);
                }
            }
        }
    }

    /// A triangle cut at the points on its sides.
    fn parts(&self, [a, b, c]: [u32; 3]) -> Vec<[u32; 3]> {
        let on = |a, b| self.on_edge.get(&side(a, b)).copied();
        match [on(a, b), on(b, c), on(c, a)] {
            [None, None, None] => vec![[a, b, c]],
            [Some(p), None, None] => vec![[a, p, c], [p, b, c]],
            [None, Some(q), None] => vec![[b, q, a], [q, c, a]],
            [None, None, Some(r)] => vec![[c, r, b], [r, a, b]],
            [Some(p), Some(q), None] => vec![[b, q, p], [a, p, q], [a, q, c]],
            [None, Some(q), Some(r)] => vec![[c, r, q], [b, q, r], [b, r, a]],
            [Some(p), None, Some(r)] => vec![[a, p, r], [c, r, p], [c, p, b]],
            [Some(p), Some(q), Some(r)] => vec![[a, p, r], [b, q, p], [c, r, q], [p, q, r]],
        }
    }

    /// The surface without the rock.
    fn left(&self, slabs: &[(Option<usize>, Slab)]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let mut floor = Floor {
            points: self.points.clone(),
            lowered: BTreeMap::new(),
        };
        let mut triangles = Vec::with_capacity(slabs.len());
        // sides of the hole, the rock gone to their left, with the floor there
        let mut rim: BTreeMap<(u32, u32), (u32, u32)> = BTreeMap::new();
        for (outline, slab) in slabs {
            if outline.is_none() || !slab.is_rock() {
                triangles.push(slab.corners);
                continue;
            }
            let mut under = slab.corners;
            for (corner, thickness) in under.iter_mut().zip(slab.thickness) {
                *corner = floor.under(*corner, thickness);
            }
            triangles.push(under);
            for k in 0..3 {
                let next = (k + 1) % 3;
                let side = (slab.corners[k], slab.corners[next]);
                rim.insert(side, (under[k], under[next]));
            }
        }
        for (&(from, to), &low) in &rim {
            // beside another hole the wall ends at the floor of that one, and is made once
            let high = match rim.get(&(to, from)) {
                Some(_) if to < from => continue,
                Some(&(to, from)) => (from, to),
                None => (from, to),
            };
            if low.1 != high.1 {
                triangles.push([low.1, low.0, high.1]);
            }
            if low.0 != high.0 {
                triangles.push([low.0, high.0, high.1]);
            }
        }
        without_unused(floor.points, triangles)
    }
}

/// Corners of the ground and those under them.
struct Floor {
    points: Vec<Vec3>,
    /// Thickness of the rock and the corner under it; m.
    lowered: BTreeMap<u32, Vec<(f64, u32)>>,
}

impl Floor {
    /// The corner below another one, the same corner where there is no rock.
    fn under(&mut self, corner: u32, thickness: f64) -> u32 {
        if thickness <= 0.0 {
            return corner;
        }
        let known = self.lowered.entry(corner).or_default();
        // floors of two holes that meet are one
        let is_same =
            |(other, _): &&(f64, u32)| (other - thickness).abs() <= SAME_FLOOR * thickness;
        if let Some(&(_, under)) = known.iter().find(is_same) {
            return under;
        }
        let under = self.points.len() as u32;
        self.points
            .push(self.points[corner as usize] - Vec3::z() * thickness);
        known.push((thickness, under));
        under
    }
}

impl Slab {
    fn is_rock(&self) -> bool {
        self.thickness.iter().all(|&t| 0.0 <= t) && self.thickness.iter().any(|&t| 0.0 < t)
    }

    /// Area in plan view times mean thickness; m³.
    fn volume(&self, points: &[Vec3]) -> f64 {
        let [a, b, c] = self.corners.map(|v| points[v as usize]);
        let twice_area = (b - a).xy().perp(&(c - a).xy());
        twice_area * self.thickness.iter().sum::<f64>() / 6.0
    }

    /// The rock between the triangle and the failure surface; none where it is too thin for a body.
    fn body(&self, points: &[Vec3]) -> Option<Polyhedron> {
        let top = self.corners.map(|v| points[v as usize]);
        let mut vertices = top.to_vec();
        let mut below = [0, 1, 2];
        for k in 0..3 {
            if 0.0 < self.thickness[k] {
                below[k] = vertices.len() as u32;
                vertices.push(top[k] - Vec3::z() * self.thickness[k]);
            }
        }
        let mut faces = vec![vec![0, 1, 2], vec![below[2], below[1], below[0]]];
        for k in 0..3 {
            let next = (k + 1) % 3;
            let mut face = vec![k as u32, below[k], below[next], next as u32];
            face.dedup();
            if 3 <= face.len() {
                faces.push(face);
            }
        }
        Polyhedron::from_faces(&vertices, &faces).ok()
    }
}

fn longest_side(points: &[Vec3], corners: &[u32; 3]) -> f64 {
    let [a, b, c] = corners.map(|v| points[v as usize]);
    (b - a).norm().max((c - b).norm()).max((a - c).norm())
}

/// The surface without unused points.
fn without_unused(points: Vec<Vec3>, mut triangles: Vec<[u32; 3]>) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut number = vec![u32::MAX; points.len()];
    let mut used = Vec::with_capacity(points.len());
    for corner in triangles.iter_mut().flatten() {
        let old = *corner as usize;
        if number[old] == u32::MAX {
            number[old] = used.len() as u32;
            used.push(points[old]);
        }
        *corner = number[old];
    }
    (used, triangles)
}
