//! Initial overlaps of blocks.

use riprap_dda::{Motion, Polyhedron, Shape, Vec3, separating_axes};

use super::obstacles::{Part, height, parts};
use crate::scene::error::Problem;

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
    let mut found: Vec<(usize, usize, f64)> = Vec::new();
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
            let depth = depth(&parts[a].1, &parts[b].1).min(way_out);
            found.push((i, j, depth));
        }
    }
    // deepest first within a pair of blocks
    found.sort_by(|a, b| (a.0, a.1).cmp(&(b.0, b.1)).then(b.2.total_cmp(&a.2)));
    found.dedup_by_key(|(i, j, _)| (*i, *j));
    let share = |&(i, j, depth): &(usize, usize, f64)| depth / sizes[i].min(sizes[j]);
    let (refused, noticed): (Vec<_>, Vec<_>) = found
        .into_iter()
        .filter(|pair| UNNOTICED < share(pair))
        .partition(|pair| REFUSED < share(pair));
    let place_and_message = |&(i, j, depth): &(usize, usize, f64)| {
        // the one that can be moved is named first
        let (mover, other) = if is_free(i) { (i, j) } else { (j, i) };
        let message = format!(
            "block `{}` overlaps block `{}` by {depth:.3e} m, {:.2} % of the smaller size",
            solids[mover].0,
            solids[other].0,
            100.0 * share(&(i, j, depth))
        );
        (format!("blocks[{mover}].placement"), message)
    };
    let mut problems: Vec<Problem> = refused
        .iter()
        .map(|pair| {
            let (path, message) = place_and_message(pair);
            Problem::error(path, message + "; move them apart")
        })
        .collect();
    let deepest = noticed.iter().max_by(|a, b| share(a).total_cmp(&share(b)));
    problems.extend(deepest.map(|pair| {
        let (path, message) = place_and_message(pair);
        let others = match noticed.len() - 1 {
            0 => String::new(),
            n => format!(", and {n} more pairs less"),
        };
        Problem::warning(
            path,
            message + &others + ": they will push each other apart",
        )
    }));
    problems
}

/// Depth of the overlap of two parts, 0 if they are apart; m.
fn depth(a: &Part, b: &Part) -> f64 {
    let of_ball = |body: &Polyhedron, center: &Vec3, radius: f64| {
        body.surface_point_within(center, radius)
            .map_or(0.0, |surface| radius - surface.distance)
    };
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
            let depth = |x: &Vec3| -height(surface, x);
            body.vertices().iter().map(depth).fold(0.0, f64::max)
        }
        (Part::Surface(surface), Part::Ball { center, radius })
        | (Part::Ball { center, radius }, Part::Surface(surface)) => {
            radius - height(surface, center)
        }
        (Part::Surface(_), Part::Surface(_)) => 0.0,
    };
    depth.max(0.0)
}
