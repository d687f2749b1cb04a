//! Gaps between blocks that are too narrow for particles to flow through.

use riprap_dda::{Shape, Vec3, separating_axes};

use super::Lattice;
use super::obstacles::{Part, parts_of};
use crate::messages::Code;
use crate::scene::error::Problem;
use crate::scene::file::DimensionsFile;

/// Smallest width of a gap that water passes; × spacing.
pub const PASSABLE: f64 = 2.0;
/// Distance of touching blocks, between which no water is meant to pass; × spacing.
const CLOSED: f64 = 0.05;

/// Gaps below the water level.
pub struct Gaps {
    /// Width of the narrowest; m.
    pub narrowest: f64,
    /// Blocks beside it.
    pub between: [usize; 2],
    /// Number of others.
    pub n_others: usize,
}

/// Gaps between blocks below the level of the water that are at least `least` and less than `most` wide; m. The width is that along
/// the best separating axis of two convex bodies: exact between faces and edges, too small between corners.
pub fn gaps<'a>(
    shapes: impl Iterator<Item = &'a Shape>,
    level: f64,
    [least, most]: [f64; 2],
) -> Option<Gaps> {
    let parts = parts_of(shapes);
    let bodies: Vec<_> = parts
        .iter()
        .filter_map(|(block, part)| match part {
            Part::Convex(body) => Some((*block, *body, body.aabb())),
            Part::Ball { .. } | Part::Surface(_) => None,
        })
        .filter(|(_, _, (min, _))| min.z < level)
        .collect();
    let mut order: Vec<usize> = (0..bodies.len()).collect();
    order.sort_by(|&a, &b| bodies[a].2.0.x.total_cmp(&bodies[b].2.0.x).then(a.cmp(&b)));
    let mut found: Vec<(f64, [usize; 2])> = Vec::new();
    for (k, &a) in order.iter().enumerate() {
        let (i, body, (min, max)) = &bodies[a];
        let near = order[k + 1..]
            .iter()
            .take_while(|&&b| bodies[b].2.0.x < max.x + most);
        for &b in near {
            let (j, other, (low, high)) = &bodies[b];
            let apart: Vec3 = (low - max).sup(&(min - high));
            if i == j || most <= apart.max() {
                continue;
            }
            let gap = separating_axes(body, other).best().gap;
            if least < gap && gap < most * (1.0 - 1e-9) {
                found.push((gap, [*i.min(j), *i.max(j)]));
            }
        }
    }
    found.sort_by(|p, q| p.0.total_cmp(&q.0).then(p.1.cmp(&q.1)));
    let &(narrowest, between) = found.first()?;
    Some(Gaps {
        narrowest,
        between,
        n_others: found.len() - 1,
    })
}

/// Warning about water between blocks less than two spacings apart, with the narrowest gap.
pub fn narrow_gaps(
    solids: &[(String, Shape)],
    lattice: &Lattice,
    dimensions: DimensionsFile,
) -> Option<Problem> {
    let [dx, dy, dz] = lattice.spacing;
    let spacing = match dimensions {
        DimensionsFile::Three => dx.max(dy).max(dz),
        DimensionsFile::Two => dx.max(dz),
    };
    let shapes = solids.iter().map(|(_, shape)| shape);
    let widths = [CLOSED * spacing, PASSABLE * spacing];
    let Gaps {
        narrowest,
        between: [i, j],
        n_others,
    } = gaps(shapes, lattice.still_water_level, widths)?;
    let others = match n_others {
        0 => String::new(),
        n => format!(" and {n} more gaps like it"),
    };
    Some(Problem::warning(
        Code::GapNarrowerThanSpacing,
        "fluid.resolution",
        format!(
            "the gap of {narrowest:.3} m between blocks `{}` and `{}`{others} below the water level is narrower than \
             two spacings of {spacing:.3} m: water passes it as if it were closed; for a flow through it refine to \
             {:.3} m",
            solids[i].0,
            solids[j].0,
            narrowest / PASSABLE,
        ),
    ))
}
