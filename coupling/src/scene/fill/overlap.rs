//! Initial overlaps of blocks.

use riprap_dda::{Motion, Polyhedron, Shape, Vec3, separating_axes};

use super::obstacles::{Part, height, parts};
use crate::messages::Code;
use crate::scene::error::Problem;
use crate::scene::file::Triple;
use crate::scene::overlaps::{listed, on_the_map};

/// Overlap above which contact would throw the blocks apart; × size of the smaller one.
const REFUSED: f64 = 1e-2;
/// Overlap by round-off; × size of the smaller one.
const UNNOTICED: f64 = 1e-6;

/// Initial overlaps of free blocks with others. The depth is the shortest translation that separates any two parts;
/// touching blocks do not overlap.
///
/// `motions` goes with `solids`. Problems: an error above 1 % of the smaller size (cube root of the
/// volume), one warning of the deepest above 1e-6 of it: a pile at rest has many.
pub fn overlaps(solids: &[(String, Shape)], motions: &[Motion]) -> Vec<Problem> {
    overlaps_on(solids, motions, None)
}

/// The same, with places on the map, on which the scene begins at `origin`.
pub fn overlaps_on(
    solids: &[(String, Shape)],
    motions: &[Motion],
    origin: Option<Triple>,
) -> Vec<Problem> {
    let found = deepest_of_blocks(solids, motions);
    let message = |pair: &Overlap| {
        let Overlap {
            mover,
            other,
            depth,
            at,
            ..
        } = *pair;
        format!(
            "block `{}` overlaps block `{}` by {depth:.3e} m, {:.2} % of the smaller size, near ({:.3}, {:.3}, {:.3}) m{}",
            solids[mover].0,
            solids[other].0,
            100.0 * pair.share,
            at.x,
            at.y,
            at.z,
            on_the_map(&at, origin)
        )
    };
    let path = |pair: &Overlap| format!("blocks[{}].placement", pair.mover);
    let (refused, noticed): (Vec<_>, Vec<_>) = found
        .into_iter()
        .filter(|pair| UNNOTICED < pair.share)
        .partition(|pair| REFUSED < pair.share);
    let refused = refused.iter().map(|pair| {
        let limit = 100.0 * REFUSED;
        let remedy = format!("; allowed are {limit} %: move them apart");
        Problem::error(Code::OverlappingBlocks, path(pair), message(pair) + &remedy)
    });
    let mut problems = listed(refused.collect(), "than allowed");
    problems.extend(noticed.first().map(|pair| {
        let others = match noticed.len() - 1 {
            0 => String::new(),
            n => format!(", and {n} more pairs less"),
        };
        let words = message(pair) + &others + ": they will push each other apart";
        Problem::warning(Code::OverlappingBlocks, path(pair), words)
    }));
    problems
}

/// Deepest overlap of two blocks.
#[derive(Clone, Copy, Debug)]
struct Overlap {
    /// The one that can be moved.
    mover: usize,
    other: usize,
    /// m.
    depth: f64,
    /// × size of the smaller one.
    share: f64,
    /// A point of it; m.
    at: Vec3,
}

/// Deepest overlap of each two blocks of which one is free, the largest share of the size first.
fn deepest_of_blocks(solids: &[(String, Shape)], motions: &[Motion]) -> Vec<Overlap> {
    let parts = parts(solids);
    let boxes: Vec<(Vec3, Vec3)> = parts.iter().map(|(_, part)| part.aabb()).collect();
    let sizes: Vec<f64> = solids
        .iter()
        .map(|(_, shape)| match shape {
            Shape::Surface(_) => f64::INFINITY,
            _ => shape.volume().cbrt(),
        })
        .collect();
    let is_free = |block: usize| matches!(motions.get(block), Some(Motion::Free));
    // sorted along x, a part meets only those that begin before it ends
    let mut order: Vec<usize> = (0..parts.len()).collect();
    order.sort_by(|&a, &b| boxes[a].0.x.total_cmp(&boxes[b].0.x).then(a.cmp(&b)));
    let mut found: Vec<Overlap> = Vec::new();
    for (k, &a) in order.iter().enumerate() {
        let meets = order[k + 1..]
            .iter()
            .take_while(|&&b| boxes[b].0.x < boxes[a].1.x);
        for &b in meets {
            let (i, j) = (parts[a].0.min(parts[b].0), parts[a].0.max(parts[b].0));
            // the way out along an axis bounds the shortest one
            let way_out = (0..3)
                .map(|k| (boxes[a].1[k] - boxes[b].0[k]).min(boxes[b].1[k] - boxes[a].0[k]))
                .fold(f64::INFINITY, f64::min);
            if i == j || way_out <= 0.0 || !(is_free(i) || is_free(j)) {
                continue;
            }
            let (depth, place) = depth(&parts[a].1, &parts[b].1);
            let depth = depth.min(way_out);
            let (mover, other) = if is_free(i) { (i, j) } else { (j, i) };
            found.push(Overlap {
                mover,
                other,
                depth,
                share: depth / sizes[i].min(sizes[j]),
                at: place.unwrap_or_else(|| middle(&boxes[a], &boxes[b])),
            });
        }
    }
    // deepest first within a pair of blocks
    let pair = |found: &Overlap| {
        let Overlap { mover, other, .. } = *found;
        (mover.min(other), mover.max(other))
    };
    found.sort_by(|a, b| pair(a).cmp(&pair(b)).then(b.depth.total_cmp(&a.depth)));
    found.dedup_by_key(|found| pair(found));
    found.sort_by(|a, b| b.share.total_cmp(&a.share));
    found
}

/// Middle of what two boxes share; m.
fn middle(a: &(Vec3, Vec3), b: &(Vec3, Vec3)) -> Vec3 {
    0.5 * (a.0.sup(&b.0) + a.1.inf(&b.1))
}

/// Depth of the overlap of two parts, 0 if they are apart, and its place beside a surface; m.
fn depth(a: &Part, b: &Part) -> (f64, Option<Vec3>) {
    let of_ball = |body: &Polyhedron, center: &Vec3, radius: f64| {
        body.surface_point_within(center, radius)
            .map_or(0.0, |surface| radius - surface.distance)
    };
    let mut place = None;
    let depth = match (a, b) {
        (Part::Convex(a), Part::Convex(b)) => -separating_axes(a, b).best().gap,
        (Part::Convex(body), Part::Ball { center, radius })
        | (Part::Ball { center, radius }, Part::Convex(body)) => of_ball(body, center, *radius),
        (
            Part::Ball { center, radius },
            Part::Ball {
                center: other,
                radius: other_radius,
            },
        ) => radius + other_radius - (center - other).norm(),
        // Ridges that reach into a face without a corner behind them are left to the first step.
        (Part::Surface(surface), Part::Convex(body))
        | (Part::Convex(body), Part::Surface(surface)) => {
            let mut deepest = 0.0;
            for x in body.vertices() {
                let depth = -height(surface, x);
                if deepest < depth {
                    (deepest, place) = (depth, Some(*x));
                }
            }
            deepest
        }
        (Part::Surface(surface), Part::Ball { center, radius })
        | (Part::Ball { center, radius }, Part::Surface(surface)) => {
            place = Some(*center);
            radius - height(surface, center)
        }
        (Part::Surface(_), Part::Surface(_)) => 0.0,
    };
    (depth.max(0.0), place)
}
