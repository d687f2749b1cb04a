//! Delaunay refinement with points of the grid (Ruppert 1995): a sliver goes by a point near the center of its circumcircle, unless a
//! side of an outline or the rim is in the way, which is halved instead.

use spade::handles::{DirectedEdgeHandle, FixedVertexHandle};
use spade::{CdtEdge, PositionInTriangulation, Triangulation as _};

use super::field::{Corner, Field, Use};
use super::mesher::{Face, Net, Node};

/// Distance from the center of a circumcircle within which points of the grid are looked for; spacings.
const REACH: f64 = 2.5;
/// Points are looked for within this fraction of a circumcircle, so that round-off does not leave the triangle as it is.
const WELL_WITHIN: f64 = 0.999;
/// Most points tried.
const MOST_TRIED: usize = 6;

type Edge<'a> = DirectedEdgeHandle<'a, Node, (), CdtEdge<()>, ()>;

/// A change that removes a sliver.
pub(super) enum Remedy {
    /// A point of the grid becomes a corner.
    Point(usize),
    /// A piece of a side of an outline, by its ends, is halved.
    Cut([FixedVertexHandle; 2]),
}

/// Square of the sine of the smallest angle of a triangle in plan view; –.
pub(super) fn square_of_smallest_sine([a, b, c]: &[Corner; 3]) -> f64 {
    let square = |p: &Corner, q: &Corner| (q[0] - p[0]).powi(2) + (q[1] - p[1]).powi(2);
    let mut sides = [square(a, b), square(b, c), square(c, a)];
    sides.sort_unstable_by(f64::total_cmp);
    // opposite the shortest side; twice the area is the product of the others with the sine between them
    cross(a, b, c).powi(2) / (sides[1] * sides[2])
}

fn cross(a: &[f64], b: &[f64], c: &[f64]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The change that removes a sliver, if there is any; `is_long` says of a piece of a side whether it can be halved.
pub(super) fn remedy<B: Fn(usize, [f64; 2]) -> f64>(
    net: &Net,
    field: &Field<'_, B>,
    face: Face,
    is_long: impl Fn([FixedVertexHandle; 2]) -> bool,
) -> Option<Remedy> {
    let triangle = net.face(face);
    let (center, square_radius) = triangle.circumcircle();
    let center = [center.x, center.y];
    let halved = |edge: &Edge<'_>| halved(field, edge, &is_long);
    if let Some(change) = obstacle(net, face, center).and_then(|edge| halved(&edge)) {
        return Some(change);
    }
    let points = free_points(field, center, square_radius.sqrt());
    let seen = |k: &usize| obstacle(net, face, field.point(*k).map(|n| n as f64)).is_none();
    let point = points.into_iter().take(MOST_TRIED).find(seen)?;
    let place = field.point(point).map(|n| n as f64);
    let hint = triangle.vertices()[0].fix();
    let encroached = encroached(net, place, hint);
    let change = encroached.and_then(|edge| halved(&edge));
    Some(change.unwrap_or(Remedy::Point(point)))
}

/// Halves a piece of a side or of the rim.
fn halved<B: Fn(usize, [f64; 2]) -> f64>(
    field: &Field<'_, B>,
    edge: &Edge<'_>,
    is_long: impl Fn([FixedVertexHandle; 2]) -> bool,
) -> Option<Remedy> {
    let [a, b] = edge.vertices();
    if edge.is_constraint_edge() {
        let ends = [a.fix(), b.fix()];
        return is_long(ends).then_some(Remedy::Cut(ends));
    }
    let [a, b] = [a, b].map(|v| [v.position().x, v.position().y]);
    let middle = [0, 1].map(|axis| (0.5 * (a[axis] + b[axis])).floor() as usize);
    let k = field.grid.index(middle);
    (field.uses[k] == Use::Free).then_some(Remedy::Point(k))
}

/// Free points of the grid within a circle, the closest to its center first.
fn free_points<B: Fn(usize, [f64; 2]) -> f64>(
    field: &Field<'_, B>,
    center: [f64; 2],
    radius: f64,
) -> Vec<usize> {
    let reach = (WELL_WITHIN * radius).min(REACH);
    let mut found: Vec<(f64, usize)> = Vec::new();
    let range = |axis: usize| field.within(axis, [center[axis] - reach, center[axis] + reach]);
    for j in range(1) {
        for i in range(0) {
            let k = field.grid.index([i, j]);
            let square = (i as f64 - center[0]).powi(2) + (j as f64 - center[1]).powi(2);
            if field.uses[k] == Use::Free && square <= reach * reach {
                found.push((square, k));
            }
        }
    }
    found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    found.into_iter().map(|(_, k)| k).collect()
}

fn is_fixed(edge: &Edge<'_>) -> bool {
    edge.is_constraint_edge() || edge.is_part_of_convex_hull()
}

/// The first side or rim on the straight way from a triangle to a place.
fn obstacle(net: &Net, face: Face, to: [f64; 2]) -> Option<Edge<'_>> {
    let start = net.face(face).center();
    let start = [start.x, start.y];
    let mut here = net.face(face);
    let mut entered = None;
    for _ in 0..net.num_inner_faces() {
        let leaves = |edge: &Edge<'_>| {
            let [a, b] = edge.positions().map(|p| [p.x, p.y]);
            Some(edge.fix()) != entered
                && cross(&a, &b, &to) < 0.0
                && cross(&start, &to, &a) <= 0.0
                && 0.0 <= cross(&start, &to, &b)
        };
        let edge = here.adjacent_edges().into_iter().find(leaves)?;
        if is_fixed(&edge) {
            return Some(edge);
        }
        entered = Some(edge.rev().fix());
        here = edge.rev().face().as_inner()?;
    }
    None
}

/// A side or part of the rim in whose diametral circle a place lies, near the place.
fn encroached(net: &Net, place: [f64; 2], hint: FixedVertexHandle) -> Option<Edge<'_>> {
    let at = spade::Point2::new(place[0], place[1]);
    let face = match net.locate_with_hint(at, hint) {
        PositionInTriangulation::OnFace(face) => net.face(face),
        PositionInTriangulation::OnEdge(edge) => {
            let edge = net.directed_edge(edge);
            edge.face().as_inner().or(edge.rev().face().as_inner())?
        }
        _ => return None,
    };
    let beside = face.adjacent_edges();
    let beyond = beside
        .into_iter()
        .filter(|edge| !is_fixed(edge))
        .filter_map(|edge| edge.rev().face().as_inner())
        .flat_map(|face| face.adjacent_edges());
    let is_encroached = |edge: &Edge<'_>| {
        let [a, b] = edge.positions().map(|p| [p.x - place[0], p.y - place[1]]);
        is_fixed(edge) && a[0] * b[0] + a[1] * b[1] < 0.0 && a[0] * b[1] - a[1] * b[0] != 0.0
    };
    beside.into_iter().chain(beyond).find(is_encroached)
}
