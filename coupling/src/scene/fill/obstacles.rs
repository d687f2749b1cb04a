//! Convex parts of blocks near a lattice node: a grid of cells over the lattice, each
//! with a short list of parts to search.

use riprap_dda::{Polyhedron, Shape, Surface, Vec3};

/// Tolerance of the distance of half a spacing from a wall, for the rounding of typed digits; × spacing.
pub(super) const WALL_SLACK: f64 = 1e-3;
/// Nodes along the edge of a cell: a few hundred nodes share a list, and a cell is still small
/// beside a basin.
const NODES_PER_CELL: usize = 8;

/// A convex part of a block.
#[derive(Clone, Copy, Debug)]
pub(super) enum Part<'a> {
    Convex(&'a Polyhedron),
    Ball { center: Vec3, radius: f64 },
    Surface(&'a Surface),
}

/// All parts, each with the number of its block.
pub(super) fn parts(solids: &[(String, Shape)]) -> Vec<(usize, Part<'_>)> {
    parts_of(solids.iter().map(|(_, shape)| shape))
}

/// All parts of some shapes, each with the number of its shape.
pub(super) fn parts_of<'a>(shapes: impl Iterator<Item = &'a Shape>) -> Vec<(usize, Part<'a>)> {
    let mut found = Vec::new();
    for (block, shape) in shapes.enumerate() {
        match shape {
            Shape::Polyhedra(parts) => {
                found.extend(parts.iter().map(|part| (block, Part::Convex(part))));
            }
            Shape::Sphere { center, radius } => {
                let (center, radius) = (*center, *radius);
                found.push((block, Part::Ball { center, radius }));
            }
            Shape::Surface(surface) => found.push((block, Part::Surface(surface))),
        }
    }
    found
}

impl Part<'_> {
    pub(super) fn aabb(&self) -> (Vec3, Vec3) {
        match self {
            Self::Convex(polyhedron) => polyhedron.aabb(),
            Self::Ball { center, radius } => {
                (center.add_scalar(-radius), center.add_scalar(*radius))
            }
            Self::Surface(surface) => {
                // What is behind it reaches beyond its own box: as far as it is wide will do.
                let (lower, upper) = surface.aabb();
                let extent = (upper - lower).norm();
                (lower.add_scalar(-extent), upper.add_scalar(extent))
            }
        }
    }

    /// True for a point inside, or closer to the surface than a distance.
    pub(super) fn is_within(&self, x: &Vec3, distance: f64) -> bool {
        match self {
            Self::Convex(polyhedron) => polyhedron
                .surface_point_within(x, distance)
                .is_some_and(|surface| surface.distance < distance),
            Self::Ball { center, radius } => (x - center).norm() - radius < distance,
            Self::Surface(surface) => height(surface, x) < distance,
        }
    }

    /// Depth of a point below the surface, 0 outside; m.
    pub(super) fn depth(&self, x: &Vec3) -> f64 {
        match self {
            Self::Convex(polyhedron) => polyhedron
                .surface_point_within(x, 0.0)
                .map_or(0.0, |surface| -surface.distance),
            Self::Ball { center, radius } => (radius - (x - center).norm()).max(0.0),
            Self::Surface(surface) => (-height(surface, x)).max(0.0),
        }
    }

    /// Part of a segment inside a body, where it enters and leaves it as shares of its length. `None` outside, and for
    /// surfaces.
    ///
    /// The segment is clipped by the planes of a convex body (Cyrus & Beck 1978).
    pub(super) fn share_inside(&self, from: &Vec3, to: &Vec3) -> Option<(f64, f64)> {
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        match self {
            Self::Convex(polyhedron) => {
                for face in 0..polyhedron.n_faces() {
                    let start = polyhedron.plane_distance(face, from);
                    let end = polyhedron.plane_distance(face, to);
                    if start >= 0.0 && end >= 0.0 {
                        return None;
                    }
                    let at = start / (start - end);
                    if start > 0.0 {
                        enter = enter.max(at);
                    } else if end > 0.0 {
                        leave = leave.min(at);
                    }
                }
            }
            Self::Ball { center, radius } => {
                let (along, off) = (to - from, from - center);
                let (a, b) = (along.norm_squared(), off.dot(&along));
                let root = (b * b - a * (off.norm_squared() - radius * radius)).sqrt();
                // a line that misses the ball has no root
                if !(0.0 < root) {
                    return None;
                }
                enter = enter.max((-b - root) / a);
                leave = leave.min((-b + root) / a);
            }
            Self::Surface(_) => return None,
        }
        (enter < leave).then_some((enter, leave))
    }

    /// True for a segment that passes through the inside.
    fn is_crossed(&self, from: &Vec3, to: &Vec3) -> bool {
        match self {
            Self::Convex(_) => self.share_inside(from, to).is_some(),
            Self::Ball { center, radius } => {
                let along = to - from;
                let share = (center - from).dot(&along) / along.norm_squared();
                let nearest = from + along * share.clamp(0.0, 1.0);
                (nearest - center).norm() < *radius
            }
            Self::Surface(surface) => (height(surface, from) > 0.0) != (height(surface, to) > 0.0),
        }
    }
}

/// Signed distance from a surface; m.
pub(super) fn height(surface: &Surface, x: &Vec3) -> f64 {
    surface
        .surface_point_within(x, f64::INFINITY)
        .map_or(f64::INFINITY, |at| at.distance)
}

/// The parts near each cell of a lattice.
pub(super) struct Obstacles<'a> {
    parts: Vec<(usize, Part<'a>)>,
    cells: [usize; 3],
    /// First entry of each cell in `near`, and at the end their number.
    start: Vec<u32>,
    near: Vec<u32>,
    /// Smallest distance of a particle from a block; m.
    clearance: f64,
}

impl<'a> Obstacles<'a> {
    /// Obstacles of a lattice of `counts` nodes from `first` on.
    pub(super) fn new(
        solids: &'a [(String, Shape)],
        first: &Vec3,
        spacing: [f64; 3],
        counts: [usize; 3],
    ) -> Self {
        let parts = parts(solids);
        let cells = counts.map(|n| n.div_ceil(NODES_PER_CELL));
        // the least spacing, so that a stretched periodic direction costs no row along a wall
        let least = spacing.iter().copied().fold(f64::INFINITY, f64::min);
        let clearance = (0.5 - WALL_SLACK) * least;
        let size = Vec3::from(spacing) * NODES_PER_CELL as f64;
        // nodes of a cell ask for points up to a step beyond their own, those of staggered layers a quarter more
        let reach = clearance + 1.25 * spacing.iter().copied().fold(0.0, f64::max);
        let origin = first - 0.5 * Vec3::from(spacing);
        let mut found: Vec<(u32, u32)> = Vec::new();
        for (p, (_, part)) in parts.iter().enumerate() {
            let (min, max) = part.aabb();
            let range = |axis: usize| {
                let cell = |x: f64| ((x - origin[axis]) / size[axis]).floor();
                let begin = cell(min[axis] - reach).max(0.0) as usize;
                let end = (cell(max[axis] + reach) + 1.0).max(0.0) as usize;
                begin..end.min(cells[axis])
            };
            for k in range(2) {
                for j in range(1) {
                    for i in range(0) {
                        let middle = Vec3::from_fn(|axis, _| [i, j, k][axis] as f64 + 0.5);
                        let middle = origin + middle.component_mul(&size);
                        // a slanted body fills little of its box
                        if part.is_within(&middle, 0.5 * size.norm() + reach) {
                            let cell = (k * cells[1] + j) * cells[0] + i;
                            found.push((cell as u32, p as u32));
                        }
                    }
                }
            }
        }
        found.sort_unstable();
        let n_cells = cells.iter().product::<usize>() as u32;
        let start = (0..=n_cells)
            .map(|cell| found.partition_point(|&(c, _)| c < cell) as u32)
            .collect();
        Self {
            parts,
            cells,
            start,
            near: found.into_iter().map(|(_, p)| p).collect(),
            clearance,
        }
    }

    /// Parts within reach of a node and of points one step from it, with their blocks.
    pub(super) fn near(&self, node: [usize; 3]) -> impl Iterator<Item = &(usize, Part<'a>)> {
        let [i, j, k] = node.map(|n| n / NODES_PER_CELL);
        let cell = (k * self.cells[1] + j) * self.cells[0] + i;
        let range = self.start[cell] as usize..self.start[cell + 1] as usize;
        self.near[range].iter().map(|&p| &self.parts[p as usize])
    }

    /// Number of a block that leaves no room for a particle at `x`, at most a step from the node.
    pub(super) fn blocker(&self, node: [usize; 3], x: &Vec3) -> Option<usize> {
        self.near(node)
            .find(|(_, part)| part.is_within(x, self.clearance))
            .map(|(block, _)| *block)
    }

    /// True for a point, at most a step from the node, in a block or on its surface.
    pub(super) fn touches(&self, node: [usize; 3], x: &Vec3) -> bool {
        // half a spacing less a clearance is the slack of a lattice
        let slack = self.clearance * WALL_SLACK / (0.5 - WALL_SLACK);
        self.near(node).any(|(_, part)| part.is_within(x, slack))
    }

    /// Number of a block that holds `x`, at most a step from the node.
    pub(super) fn holder(&self, node: [usize; 3], x: &Vec3) -> Option<usize> {
        self.near(node)
            .find(|(_, part)| part.is_within(x, 0.0))
            .map(|(block, _)| *block)
    }

    /// True if the segment between two points, at most a step from the node, passes through a block.
    pub(super) fn is_crossed(&self, node: [usize; 3], from: &Vec3, to: &Vec3) -> bool {
        self.near(node).any(|(_, part)| part.is_crossed(from, to))
    }

    /// True if a block separates a node from a point at most a step away, both with room for a particle.
    ///
    /// A body between two such points is within half the step less a clearance of its middle, so that nearly all are
    /// ruled out by one distance.
    pub(super) fn is_barred(&self, node: [usize; 3], from: &Vec3, to: &Vec3) -> bool {
        let middle = 0.5 * (from + to);
        let room = (0.5 * (to - from).norm() - self.clearance).max(0.0);
        self.near(node)
            .any(|(_, part)| part.is_within(&middle, 1.01 * room) && part.is_crossed(from, to))
    }
}
