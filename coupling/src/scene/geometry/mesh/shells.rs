//! Closed shells of loose triangles.

use nalgebra::Matrix3;
use riprap_dda::{MassProperties, Vec3};

use super::Soup;

/// Weld distance of coordinates; × diagonal of the mesh.
const WELD_DISTANCE: f64 = 1e-9;
/// Angle below which two triangles coincide; rad.
const FOLD_ANGLE: f64 = 1e-9;

/// The triangles of one connected piece, with its own points.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Shell {
    pub(super) points: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// Connectivity of the edges of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Seam {
    /// Every edge has its two sides.
    Closed,
    /// Some have one.
    Open {
        n_edges: usize,
        /// Middle of the first in the order of the file.
        at: Vec3,
    },
    /// Two sides that run the same way.
    Unoriented { at: Vec3 },
}

/// Shells in the order of their first triangles, and the connectivity of their edges.
pub(super) struct Sorted {
    pub(super) shells: Vec<Shell>,
    pub(super) seam: Seam,
}

impl Shell {
    /// Volume by the divergence theorem, about the first point so that no digits are lost far from the origin; m³.
    pub(super) fn volume(&self) -> f64 {
        let Some(&origin) = self.points.first() else {
            return 0.0;
        };
        let corner = |v: u32| self.points[v as usize] - origin;
        self.triangles
            .iter()
            .map(|&[a, b, c]| corner(a).dot(&corner(b).cross(&corner(c))) / 6.0)
            .sum()
    }
}

/// Volume, centroid and second moment of what shells enclose: sums over the tetrahedra of each triangle and the first point,
/// negative where the triangle is seen from outside.
///
/// ```text
/// S = V/20 Σ_k (x_k − x_c)(x_k − x_c)ᵀ        of a tetrahedron of corners x_k
/// ```
pub(super) fn mass_properties(shells: &[Shell]) -> MassProperties {
    let origin = shells.iter().find_map(|shell| shell.points.first());
    let origin = origin.copied().unwrap_or_default();
    let of_triangle = |shell: &Shell, triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|v| shell.points[v as usize] - origin);
        let volume = a.dot(&b.cross(&c)) / 6.0;
        let centroid = (a + b + c) / 4.0;
        let spread = [Vec3::zeros(), a, b, c].map(|x| x - centroid);
        let second_moment: Matrix3<f64> = spread.iter().map(|x| x * x.transpose()).sum();
        MassProperties {
            volume,
            centroid,
            second_moment: second_moment * (volume / 20.0),
        }
    };
    let tetrahedra: Vec<MassProperties> = shells
        .iter()
        .flat_map(|shell| shell.triangles.iter().map(move |t| of_triangle(shell, t)))
        .collect();
    let mut sum = MassProperties::of_union(&tetrahedra);
    sum.centroid += origin;
    sum
}

/// Welds the corners, pairs the edges and collects connected triangles.
pub(super) fn sort(soup: &Soup) -> Sorted {
    let welded = outward(weld(soup));
    let edges = half_edges(&welded);
    let mut root: Vec<u32> = (0..welded.triangles.len() as u32).collect();
    let mut open: Vec<HalfEdge> = Vec::new();
    let mut unoriented: Option<HalfEdge> = None;
    for group in edges.chunk_by(|a, b| a.ends() == b.ends()) {
        // backward ones sort after forward ones
        let (forward, backward) = group.split_at(group.partition_point(|e| !e.is_backward));
        if forward.len() == backward.len() {
            for (a, b) in pairs(&welded, forward, backward) {
                join(&mut root, a.triangle, b.triangle);
            }
            continue;
        }
        // still one piece, for whoever counts them
        group.windows(2).for_each(|pair| {
            join(&mut root, pair[0].triangle, pair[1].triangle);
        });
        if group.len().is_multiple_of(2) {
            unoriented = unoriented.or(Some(group[0]));
        } else {
            open.push(group[0]);
        }
    }
    let middle =
        |e: &HalfEdge| 0.5 * (welded.points[e.low as usize] + welded.points[e.high as usize]);
    let seam = match (open.iter().min_by_key(|e| e.triangle), unoriented) {
        (Some(first), _) => Seam::Open {
            n_edges: open.len(),
            at: middle(first),
        },
        (None, Some(edge)) => Seam::Unoriented { at: middle(&edge) },
        (None, None) => Seam::Closed,
    };
    Sorted {
        shells: collect(&welded, &mut root),
        seam,
    }
}

/// One side of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct HalfEdge {
    low: u32,
    high: u32,
    /// True for a side that runs from `high` to `low`.
    is_backward: bool,
    triangle: u32,
}

impl HalfEdge {
    fn ends(&self) -> (u32, u32) {
        (self.low, self.high)
    }
}

fn half_edges(soup: &Soup) -> Vec<HalfEdge> {
    let mut edges = Vec::with_capacity(3 * soup.triangles.len());
    for (t, corners) in soup.triangles.iter().enumerate() {
        for k in 0..3 {
            let (from, to) = (corners[k], corners[(k + 1) % 3]);
            edges.push(HalfEdge {
                low: from.min(to),
                high: from.max(to),
                is_backward: from > to,
                triangle: t as u32,
            });
        }
    }
    edges.sort_unstable();
    edges
}

/// The sides of an edge that belong to one body each.
///
/// Convex parts that adjoin, as a split body has them, share edges: four or more triangles meet
/// there. Turning about the edge from a triangle through the rock behind it, the first triangle
/// that runs the other way bounds the same body. One that lies on the triangle itself bounds the
/// neighbor, so it comes last.
fn pairs(soup: &Soup, forward: &[HalfEdge], backward: &[HalfEdge]) -> Vec<(HalfEdge, HalfEdge)> {
    if let ([a], [b]) = (forward, backward) {
        return vec![(*a, *b)];
    }
    let mut left: Vec<HalfEdge> = backward.to_vec();
    let mut found = Vec::with_capacity(forward.len());
    for &side in forward {
        let angle = |other: &HalfEdge| angle_through_body(soup, side, *other);
        let nearest = (0..left.len()).min_by(|&a, &b| angle(&left[a]).total_cmp(&angle(&left[b])));
        if let Some(k) = nearest {
            found.push((side, left.swap_remove(k)));
        }
    }
    found
}

/// Angle from a forward triangle to another, rotating against its outward normal; rad.
fn angle_through_body(soup: &Soup, side: HalfEdge, other: HalfEdge) -> f64 {
    let start = soup.points[side.low as usize];
    let along = (soup.points[side.high as usize] - start).normalize();
    // from the edge into the triangle, across the edge
    let into = |e: HalfEdge| {
        let third = soup.triangles[e.triangle as usize]
            .iter()
            .find(|&&v| v != e.low && v != e.high)
            .map_or(start, |&v| soup.points[v as usize]);
        let arm = third - start;
        arm - along * along.dot(&arm)
    };
    let (from, to) = (into(side), into(other));
    // outward normal of a triangle whose edge runs along `along`
    let outward = along.cross(&from);
    let angle = (-outward.dot(&to)).atan2(from.dot(&to));
    if angle > FOLD_ANGLE {
        angle
    } else {
        angle + std::f64::consts::TAU
    }
}

/// Welds coincident corners and removes triangles of fewer than three corners.
///
/// Each coordinate is snapped by itself: sorted values that follow within the weld distance get
/// one number. Three sorts, whatever the mesh looks like.
pub(super) fn weld(soup: &Soup) -> Soup {
    let nothing = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    let used = || soup.triangles.iter().flatten();
    let (min, max) = used().fold(nothing, |(min, max), &v| {
        let x = &soup.points[v as usize];
        (min.inf(x), max.sup(x))
    });
    let near = WELD_DISTANCE * (max - min).norm();
    let mut order: Vec<u32> = used().copied().collect();
    order.sort_unstable();
    order.dedup();
    let mut place = vec![[0_u32; 3]; soup.points.len()];
    let mut snap = |axis: usize| {
        let value = |v: u32| soup.points[v as usize][axis];
        order.sort_unstable_by(|&a, &b| value(a).total_cmp(&value(b)).then(a.cmp(&b)));
        let mut level = 0;
        for (k, &v) in order.iter().enumerate() {
            if k > 0 && value(v) - value(order[k - 1]) > near {
                level += 1;
            }
            place[v as usize][axis] = level;
        }
    };
    (0..3).for_each(&mut snap);
    order.sort_unstable_by_key(|&v| (place[v as usize], v));
    let mut new = vec![u32::MAX; soup.points.len()];
    let mut points = Vec::new();
    for group in order.chunk_by(|&a, &b| place[a as usize] == place[b as usize]) {
        group
            .iter()
            .for_each(|&v| new[v as usize] = points.len() as u32);
        points.push(soup.points[group[0] as usize]);
    }
    let triangles = soup
        .triangles
        .iter()
        .map(|corners| corners.map(|v| new[v as usize]))
        .filter(|[a, b, c]| a != b && b != c && c != a)
        .collect();
    Soup { points, triangles }
}

/// Reverses all triangles of a closed mesh that is written clockwise.
fn outward(mut soup: Soup) -> Soup {
    let whole = Shell {
        points: soup.points,
        triangles: soup.triangles,
    };
    let is_inside_out = whole.volume() < 0.0;
    (soup.points, soup.triangles) = (whole.points, whole.triangles);
    if is_inside_out {
        soup.triangles
            .iter_mut()
            .for_each(|corners| corners.swap(1, 2));
    }
    soup
}

fn find(root: &mut [u32], mut t: u32) -> u32 {
    while root[t as usize] != t {
        root[t as usize] = root[root[t as usize] as usize];
        t = root[t as usize];
    }
    t
}

fn join(root: &mut [u32], a: u32, b: u32) {
    let (a, b) = (find(root, a), find(root, b));
    root[a.max(b) as usize] = a.min(b);
}

fn collect(soup: &Soup, root: &mut [u32]) -> Vec<Shell> {
    // the root is the first triangle of a shell, so shells come in the order of the file
    let mut members: Vec<(u32, u32)> = (0..soup.triangles.len() as u32)
        .map(|t| (find(root, t), t))
        .collect();
    members.sort_unstable();
    let mut place = vec![u32::MAX; soup.points.len()];
    let mut shells = Vec::new();
    for group in members.chunk_by(|a, b| a.0 == b.0) {
        let mut shell = Shell::default();
        let mut used = Vec::new();
        for &(_, t) in group {
            let corners = soup.triangles[t as usize].map(|v| {
                if place[v as usize] == u32::MAX {
                    place[v as usize] = shell.points.len() as u32;
                    shell.points.push(soup.points[v as usize]);
                    used.push(v);
                }
                place[v as usize]
            });
            shell.triangles.push(corners);
        }
        used.iter().for_each(|&v| place[v as usize] = u32::MAX);
        shells.push(shell);
    }
    shells
}
