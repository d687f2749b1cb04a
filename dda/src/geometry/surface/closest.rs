//! Closest points of a surface, in front of it and behind.

use super::{FLAT, NONE, Surface};
use crate::geometry::bounds::Bounds;
use crate::{SurfacePoint, Vec3};
use parry3d_f64::partitioning::BvhNode;
use std::cell::Cell;

impl Surface {
    /// Triangles near a body whose boxes are no farther than some depth (m) from a box, and a quarter of it.
    pub(crate) fn within(
        &self,
        near: &NearTriangles,
        (low, high): &Bounds,
        depth: f64,
        triangles: &mut Vec<u32>,
    ) {
        let reach = ABOVE_A_FOOT * depth;
        let meets = |t: &u32| {
            let (from, to) = &self.boxes[*t as usize];
            (0..3).all(|k| from[k] - high[k] <= reach && low[k] - to[k] <= reach)
        };
        triangles.clear();
        triangles.extend(near.triangles.iter().copied().filter(meets));
    }

    /// Is every point of a polygon in the region of a triangle as deep as the plane of that triangle says? `within`: the
    /// triangles [`Self::within`] a depth of the polygon. Depths below `flush` (m) need no check.
    ///
    /// They are if all of those triangles meet the first in a corner at least and lean by no more than
    /// `β = acos(0.85)` to it, so that the surface is a graph of slope `tan β` over its plane, and no point lies farther than
    /// `tan(β/2)` of its depth d beside it, as behind the bottom of a valley. The graph is then at least
    /// `(1 − tan β tan(β/2)) d = 0.82 d` above the point, and so no point of it is nearer than `0.82 d cos β = 0.70 d`: no part
    /// is nearer than the depth over the leeway, and the point is behind it.
    pub(crate) fn is_plain(&self, own: u32, within: &[u32], polygon: &[Vec3], flush: f64) -> bool {
        let (corners, n) = (&self.triangles[own as usize], &self.normal[own as usize]);
        let goes_on = |&other: &u32| {
            let t = other as usize;
            !self.neighbor[t].contains(&NONE)
                && self.normal[t].dot(n) > LEANS
                && self.triangles[t].iter().any(|v| corners.contains(v))
        };
        let is_beside = |x: &Vec3| {
            let height = self.height(own, x);
            let (square, ..) = self.closest(own, x);
            let beside = (square - height * height).max(0.0);
            beside <= (BESIDE * height.abs() + flush).powi(2)
        };
        within.iter().all(goes_on) && polygon.iter().all(is_beside)
    }

    /// Checks a depth (m) behind the plane in whose region a point lies: regions of planes at an angle to each other reach
    /// out of the surface again, and behind something thin its other side is nearer. The triangle in whose region it lies, and those
    /// that may be as near.
    pub(crate) fn checked(
        &self,
        near: &NearTriangles,
        (own, within): (u32, &[u32]),
        x: &Vec3,
        depth: f64,
    ) -> Checked {
        let depth_up = depth * (1.0 + ROUND_OFF);
        // its own triangle first: most of the others then are farther by their boxes or planes
        let first = self.nearest_on(own, x);
        let nearer = self.nearest(within.iter().copied(), x, Some(first));
        let nearest = if nearer.is_some_and(|n| n.square <= depth_up.min(near.reach).powi(2)) {
            nearer
        } else {
            // nothing as near as the plane: the point is behind the bottom of a valley, or not behind the surface at all
            self.nearest_of_all(near, x, nearer)
        };
        match nearest.and_then(|nearest| self.leaning(&nearest, x)) {
            None => Checked::InFront,
            Some(mut behind) if LEEWAY * behind.depth < depth => {
                behind.depth *= LEEWAY;
                behind.leans_on = behind.leans_on.map(|(place, n, d)| (place, n, LEEWAY * d));
                Checked::Nearer(behind)
            }
            Some(_) => Checked::True,
        }
    }

    /// Closest point of the surface to a point behind it, `None` for one in front.
    pub(crate) fn behind(&self, near: &NearTriangles, x: &Vec3) -> Option<Behind> {
        let nearest = self.nearest_of_all(near, x, None)?;
        self.leaning(&nearest, x)
    }

    /// Closest point, of all triangles if those that are near do not hold it for certain. `first`: the closest of some.
    fn nearest_of_all(
        &self,
        near: &NearTriangles,
        x: &Vec3,
        first: Option<Nearest>,
    ) -> Option<Nearest> {
        let nearest = self.nearest(near.triangles.iter().copied(), x, first)?;
        if nearest.square <= near.reach * near.reach {
            return Some(nearest);
        }
        self.nearest_within(x, nearest.square).or(Some(nearest))
    }

    /// Closest point of all triangles no farther than a squared distance (m²). Ties between neighbors go to the lowest triangle,
    /// whatever the tree.
    fn nearest_within(&self, x: &Vec3, square: f64) -> Option<Nearest> {
        let best = Cell::new(None::<Nearest>);
        let to_box = |node: &BvhNode, _| {
            let (low, high) = (node.mins(), node.maxs());
            let outside = |low: f64, high: f64, x: f64| (low - x).max(x - high).max(0.0);
            let u = outside(low.x, high.x, x.x);
            let v = outside(low.y, high.y, x.y);
            let w = outside(low.z, high.z, x.z);
            // less the round-off, so that neighbors as far as the best are seen
            (1.0 - ROUND_OFF) * (u * u + v * v + w * w)
        };
        let to_triangle = |triangle: u32, least: f64| {
            if self.is_farther(triangle, x, least.min(square)) {
                return None;
            }
            best.set(self.nearest(std::iter::once(triangle), x, best.get()));
            best.get().map(|found| found.square)
        };
        self.tree
            .find_best(square * (1.0 + ROUND_OFF), to_box, to_triangle);
        best.get().filter(|found| found.square <= square)
    }

    /// Is a triangle farther than a squared distance (m²), by its box or its plane?
    fn is_farther(&self, triangle: u32, x: &Vec3, square: f64) -> bool {
        let (low, high) = &self.boxes[triangle as usize];
        let outside = |k: usize| (low[k] - x[k]).max(x[k] - high[k]).max(0.0);
        let (u, v, w) = (outside(0), outside(1), outside(2));
        if u * u + v * v + w * w > square {
            return true;
        }
        let height = self.height(triangle, x);
        height * height > square
    }

    fn nearest_on(&self, triangle: u32, x: &Vec3) -> Nearest {
        let (square, foot, feature) = self.closest(triangle, x);
        Nearest {
            triangle,
            square,
            foot,
            feature,
        }
    }

    /// Closest point of some triangles, and of a first. Ties between neighbors go to the lowest triangle, in whatever order they
    /// come.
    fn nearest(
        &self,
        triangles: impl Iterator<Item = u32>,
        x: &Vec3,
        first: Option<Nearest>,
    ) -> Option<Nearest> {
        let mut best = first;
        for triangle in triangles {
            // Cheap bounds first: most triangles are farther than the best so far.
            let is_out = |best: Nearest| {
                best.triangle == triangle || self.is_farther(triangle, x, best.square)
            };
            if best.is_some_and(is_out) {
                continue;
            }
            let found = self.nearest_on(triangle, x);
            let is_better = |best: Nearest| {
                found.square < best.square
                    || found.square == best.square && triangle < best.triangle
            };
            if best.is_none_or(is_better) {
                best = Some(found);
            }
        }
        best
    }

    /// Exit paths of a point behind its closest point, `None` for one in front.
    fn leaning(&self, nearest: &Nearest, x: &Vec3) -> Option<Behind> {
        let Nearest {
            triangle, feature, ..
        } = *nearest;
        let found = self.signed(nearest, x);
        let t = triangle as usize;
        let (normal, depth) = (found.normal, -found.distance);
        let whole = |place| [(place, normal, depth), (place, normal, 0.0)];
        let leans_on = match feature {
            Feature::Face => whole(self.plane[t]),
            Feature::Side(k) => match self.neighbor[t][k] {
                NONE => whole(self.plane[t]),
                other => {
                    // At the bottom of a valley: d m = a n_A + b n_B.
                    let (n, m) = (self.normal[t], self.normal[other as usize]);
                    let cos = n.dot(&m);
                    let (along_n, along_m) = (depth * normal.dot(&n), depth * normal.dot(&m));
                    let square = 1.0 - cos * cos;
                    if square > FLAT * FLAT {
                        let a = (along_n - cos * along_m) / square;
                        let b = (along_m - cos * along_n) / square;
                        [(self.plane[t], n, a), (self.plane[other as usize], m, b)]
                    } else {
                        whole(self.plane[t])
                    }
                }
            },
            Feature::Vertex(k) => whole(OF_VERTEX | self.triangles[t][k]),
        };
        (depth > 0.0).then_some(Behind { depth, leans_on })
    }

    /// Closest point, with the distance negative behind the surface, or `None` if it is farther than `cutoff`
    /// (m). At the rim of an open surface the side is that of the plane that ends there.
    pub fn surface_point_within(&self, x: &Vec3, cutoff: f64) -> Option<SurfacePoint> {
        let nearest = self.nearest_within(x, cutoff * cutoff)?;
        Some(self.signed(&nearest, x))
    }

    fn signed(&self, nearest: &Nearest, x: &Vec3) -> SurfacePoint {
        let Nearest {
            triangle,
            square,
            foot,
            feature,
        } = *nearest;
        let distance = square.sqrt();
        let t = triangle as usize;
        let outward = match feature {
            Feature::Face => self.normal[t],
            Feature::Side(k) => match self.neighbor[t][k] {
                NONE => self.normal[t],
                other => self.normal[t] + self.normal[other as usize],
            },
            Feature::Vertex(k) => self.vertex_normal[self.triangles[t][k] as usize],
        };
        let sign = if outward.dot(&(x - foot)) < 0.0 {
            -1.0
        } else {
            1.0
        };
        let normal = if matches!(feature, Feature::Face) || distance == 0.0 {
            outward.normalize()
        } else {
            (x - foot) * (sign / distance)
        };
        SurfacePoint {
            distance: sign * distance,
            normal,
            point: foot,
        }
    }

    /// Squared distance, foot, and its feature. Source: Ericson, Real-Time Collision Detection (2004), 5.1.5.
    fn closest(&self, triangle: u32, x: &Vec3) -> (f64, Vec3, Feature) {
        let corners = self.triangles[triangle as usize].map(|v| self.vertices[v as usize]);
        let n = &self.normal[triangle as usize];
        let is_inside = (0..3).all(|k| {
            let along = corners[(k + 1) % 3] - corners[k];
            along.cross(&(x - corners[k])).dot(n) >= 0.0
        });
        if is_inside {
            let height = self.height(triangle, x);
            return (height * height, x - n * height, Feature::Face);
        }
        let mut best = (f64::INFINITY, *x, Feature::Face);
        for k in 0..3 {
            let (a, along) = (corners[k], corners[(k + 1) % 3] - corners[k]);
            let share = (x - a).dot(&along) / along.norm_squared();
            let (foot, feature) = if share <= 0.0 {
                (a, Feature::Vertex(k))
            } else if share >= 1.0 {
                (corners[(k + 1) % 3], Feature::Vertex((k + 1) % 3))
            } else {
                (a + along * share, Feature::Side(k))
            };
            let square = (x - foot).norm_squared();
            if square < best.0 {
                best = (square, foot, feature);
            }
        }
        best
    }

    /// Foot on a triangle and distance of a point in front of the surface, where no neighbor comes nearer to
    /// it: a sphere on a flat mesh touches it once, in a valley twice.
    pub(crate) fn local_foot(&self, triangle: u32, x: &Vec3) -> Option<(Vec3, f64)> {
        let (square, foot, feature) = self.closest(triangle, x);
        let t = triangle as usize;
        let away = x - foot;
        let is_nearest = match feature {
            Feature::Face => away.dot(&self.normal[t]) > 0.0,
            Feature::Side(k) => match self.neighbor[t][k] {
                NONE => away.dot(&self.normal[t]) > 0.0,
                other => {
                    let (a, b) = (self.triangles[t][k], self.triangles[t][(k + 1) % 3]);
                    let along = self.vertices[b as usize] - self.vertices[a as usize];
                    // Into the neighbor, in its plane; its side has the opposite direction.
                    let inward = self.normal[other as usize].cross(&-along);
                    let outward = self.normal[t] + self.normal[other as usize];
                    away.dot(&outward) > 0.0 && away.dot(&inward) <= 0.0
                }
            },
            Feature::Vertex(k) => {
                let v = self.triangles[t][k] as usize;
                let row = self.spokes_start[v] as usize..self.spokes_start[v + 1] as usize;
                away.dot(&self.vertex_normal[v]) > 0.0
                    && self.spokes[row].iter().all(|&end| {
                        away.dot(&(self.vertices[end as usize] - self.vertices[v])) <= 0.0
                    })
            }
        };
        is_nearest.then(|| (foot, square.sqrt()))
    }
}

/// Triangles near a body, in rising order.
#[derive(Clone, Copy)]
pub(crate) struct NearTriangles<'a> {
    pub triangles: &'a [u32],
    /// Distance from every point of the body within which all triangles are among them; m.
    pub reach: f64,
}

/// Closest point of a surface.
#[derive(Clone, Copy)]
struct Nearest {
    triangle: u32,
    /// Squared distance; m².
    square: f64,
    foot: Vec3,
    feature: Feature,
}

/// Depths that differ by less are equal; –.
const ROUND_OFF: f64 = 1e-9;
/// Depth behind the plane of a region over the distance from the surface, up to which it counts. Around a vertex the regions of
/// its triangles leave or overlap a little, and the potential of linear depths should not have the kinks of the distance there; –.
const LEEWAY: f64 = 1.5;

/// Cosine of the angle to a triangle up to which others go on from it: `cos β`, see [`Surface::is_plain`]; –.
const LEANS: f64 = 0.85;
/// Distance of a point beside a triangle over its depth: `tan(β/2)`; –.
const BESIDE: f64 = 0.28;
/// Height of the surface above a point over its depth: at most `1 + tan β tan(β/2) = 1.18`; –.
const ABOVE_A_FOOT: f64 = 1.25;

/// Whether a point is as deep as the plane of its region says.
pub(crate) enum Checked {
    True,
    /// Another part of the surface is nearer.
    Nearer(Behind),
    InFront,
}

/// A point behind the surface.
pub(crate) struct Behind {
    /// Distance; m.
    pub depth: f64,
    /// Number of the plane or vertex, unit normal out of the surface, and the part of the exit path along it
    /// (m): one plane, or the two of a valley.
    pub leans_on: [(u32, Vec3, f64); 2],
}

impl Behind {
    /// Is some place on the outer side of the plane where a point at `x` comes out?
    pub fn faces(&self, place: &Vec3, x: &Vec3) -> bool {
        let (_, normal, depth) = self.leans_on[0];
        normal.dot(&(place - x)) >= depth
    }
}

/// Mark of the numbers of vertices among those of planes.
const OF_VERTEX: u32 = 1 << 31;

/// Feature of a triangle on which a point lies.
#[derive(Clone, Copy, Debug)]
enum Feature {
    Face,
    Side(usize),
    Vertex(usize),
}
