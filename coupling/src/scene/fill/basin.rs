//! Water in a basin: the connected space below a level.
//!
//! A lattice that is to be packed against its walls also has the nodes closer to a wall than half a spacing, so that it
//! has the volume of the basin, and a mould of water above the level, which keeps the surface in place. Packing evens out what is near;
//! a slope that takes half a row too few over its whole length would draw a wave of that height from the rest of the basin. In a plane
//! each column therefore has the particles of its volume, and what is left of a particle goes to the next column.

use std::collections::VecDeque;

use riprap_dda::{Shape, Vec3};
use riprap_sph::Symmetry;

use super::columns::Columns;
use super::drawn::Cells;
use super::obstacles::Obstacles;
use super::{FillError, Pouring, Room, rows};
use crate::scene::file::{Axis, DimensionsFile, DomainFile, LatticeFile, planes_of_symmetry, vec3};

/// Lattice nodes of the domain below a level.
struct Basin {
    spacing: [f64; 3],
    counts: [usize; 3],
    /// Rows below the level; those above belong to the mould.
    n_wet_rows: usize,
    first: Vec3,
    /// Offset of alternate layers, to either side; m.
    stagger: Vec3,
    periodic: [bool; 3],
    /// Planes of symmetry.
    symmetry: Symmetry,
}

/// Filled region; m.
#[derive(Debug, Default)]
pub(super) struct Poured {
    pub(super) water: Vec<Vec3>,
    /// Particles above the level.
    pub(super) mould: Vec<Vec3>,
    /// Volume as drawn, where it is measured; m³.
    pub(super) drawn: Option<f64>,
    /// Spacing along z with which whole rows reach the floor, where most of it is level; m.
    pub(super) fitting_height: Option<f64>,
}

/// State of a node.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Node {
    Unknown,
    Blocked,
    Wet,
    Mould,
}

/// Nodes connected to `seed` below the level, in the order of the lattice, and a mould of `n_mould_rows` above it.
pub(super) fn fill(
    domain: &DomainFile,
    (spacing, arrangement): ([f64; 3], LatticeFile),
    (level, seed): (f64, &Vec3),
    solids: &[(String, Shape)],
    pouring: Pouring,
) -> Result<Poured, FillError> {
    let Pouring {
        n_mould_rows, room, ..
    } = pouring;
    let basin = Basin::new(domain, (spacing, arrangement), level, (n_mould_rows, room))?;
    let obstacles = Obstacles::new(solids, &basin.first, spacing, basin.counts);
    let start = basin.start(seed, level, domain, &obstacles, solids)?;
    let mut nodes = basin.flood(start, &obstacles)?;
    if 0 < n_mould_rows {
        basin.spread(&mut nodes, Node::Wet, &obstacles);
        for _ in 0..n_mould_rows {
            basin.spread(&mut nodes, Node::Mould, &obstacles);
        }
    }
    let is_water = |node: &&Node| matches!(node, Node::Wet | Node::Mould);
    room.holds(nodes.iter().filter(is_water).count() as f64)?;
    let mut poured = Poured::default();
    if pouring.is_measured {
        let drawn = basin.drawn_columns(&nodes, domain, solids);
        poured.drawn = Some(drawn.volumes.iter().sum());
        // a staggered lattice that is stretched one way is not the densest any more
        if arrangement == LatticeFile::Cubic {
            poured.fitting_height = drawn.fitting_height(spacing);
        }
        // in space columns along edges and round bodies would crowd particles
        if 0 < n_mould_rows && domain.dimensions == DimensionsFile::Two {
            let volume = spacing.iter().product();
            poured.water = basin.match_columns(&mut nodes, &drawn.missing(volume));
        }
    }
    for k in 0..basin.counts[2] {
        for j in 0..basin.counts[1] {
            for i in 0..basin.counts[0] {
                let position = basin.position([i, j, k]);
                match nodes[basin.index([i, j, k])] {
                    Node::Wet => poured.water.push(position),
                    Node::Mould => poured.mould.push(position),
                    Node::Unknown | Node::Blocked => {}
                }
            }
        }
    }
    Ok(poured)
}

impl Basin {
    /// Basin whose top row is half a spacing below the level; in plan view the first row is half a spacing inside the
    /// domain.
    fn new(
        domain: &DomainFile,
        (spacing, arrangement): ([f64; 3], LatticeFile),
        level: f64,
        (n_mould_rows, room): (usize, Room),
    ) -> Result<Self, FillError> {
        let (min, max) = (vec3(domain.min), vec3(domain.max));
        if !(level <= max.z) {
            return Err(FillError::LevelAboveDomain { level, top: max.z });
        }
        let top = Vec3::new(max.x, max.y, level);
        let counts = [0, 1, 2].map(|k| rows(top[k] - min[k], spacing[k]));
        if !counts.iter().all(|&n| n >= 1.0) {
            return Err(FillError::NoRow { bottom: min.z });
        }
        let n_wet_rows = counts[2] as usize;
        let all = [counts[0], counts[1], counts[2] + n_mould_rows as f64];
        room.look_at(all.iter().product())?;
        let stagger = match (arrangement, domain.dimensions) {
            (LatticeFile::Cubic, _) => [0.0; 3],
            (LatticeFile::Staggered, DimensionsFile::Two) => [0.25 * spacing[0], 0.0, 0.0],
            (LatticeFile::Staggered, DimensionsFile::Three) => {
                [0.25 * spacing[0], 0.25 * spacing[1], 0.0]
            }
        };
        Ok(Self {
            spacing,
            counts: all.map(|n| n as usize),
            n_wet_rows,
            first: Vec3::new(
                min.x + 0.5 * spacing[0],
                min.y + 0.5 * spacing[1],
                level - (counts[2] - 0.5) * spacing[2],
            ),
            stagger: Vec3::from(stagger),
            // a flow in a plane is the same everywhere across it
            periodic: [Axis::X, Axis::Y, Axis::Z].map(|axis| {
                domain.periodic.contains(&axis)
                    || (axis == Axis::Y && domain.dimensions == DimensionsFile::Two)
            }),
            symmetry: planes_of_symmetry(&domain.symmetry),
        })
    }

    fn position(&self, node: [usize; 3]) -> Vec3 {
        // the layers at the level are the same however deep the domain is
        let is_odd = (node[2] + self.n_wet_rows) % 2 == 1;
        let to_and_fro = if is_odd { self.stagger } else { -self.stagger };
        let row = Vec3::from_fn(|axis, _| node[axis] as f64 * self.spacing[axis]);
        self.first + row + to_and_fro
    }

    fn index(&self, node: [usize; 3]) -> usize {
        (node[2] * self.counts[1] + node[1]) * self.counts[0] + node[0]
    }

    /// Takes particles out of columns with too many, and returns further ones of those with too few, m: one at the bottom, more
    /// evenly over the height. Packing makes room for them.
    fn match_columns(&self, nodes: &mut [Node], missing: &[i32]) -> Vec<Vec3> {
        let [nx, ny, _] = self.counts;
        let mut added = Vec::new();
        for (column, &missing) in missing.iter().enumerate() {
            let [i, j] = [column % (nx + 1), column / (nx + 1)];
            if missing == 0 || nx <= i || ny <= j {
                continue;
            }
            let is_wet = |k: &usize| nodes[self.index([i, j, *k])] == Node::Wet;
            let wet: Vec<usize> = (0..self.n_wet_rows).filter(is_wet).collect();
            let n = missing.unsigned_abs() as usize;
            for k in (0..n).filter_map(|m| wet.get(m * wet.len() / n)) {
                if missing < 0 {
                    nodes[self.index([i, j, *k])] = Node::Blocked;
                } else {
                    let down = if k + 1 == self.n_wet_rows { -0.5 } else { 0.5 };
                    let offset = Vec3::new(0.0, 0.0, down * self.spacing[2]);
                    added.push(self.position([i, j, *k]) + offset);
                }
            }
        }
        added
    }

    /// Columns of water as they are drawn.
    fn drawn_columns(
        &self,
        nodes: &[Node],
        domain: &DomainFile,
        solids: &[(String, Shape)],
    ) -> Columns {
        let (min, max) = (vec3(domain.min), vec3(domain.max));
        let level = self.first.z + (self.n_wet_rows as f64 - 0.5) * self.spacing[2];
        // what is left of the domain beyond whole rows takes a cell more
        let counts = [self.counts[0] + 1, self.counts[1] + 1, self.n_wet_rows + 1];
        let water = |[i, j, above]: [usize; 3]| {
            let node = [i, j, above.checked_sub(1)?];
            let is_node = (0..3).all(|axis| node[axis] < self.counts[axis]);
            (is_node && nodes[self.index(node)] == Node::Wet).then(|| self.position(node))
        };
        let cells = Cells {
            first: self.first - Vec3::new(0.0, 0.0, self.spacing[2]),
            spacing: self.spacing,
            counts,
            bounds: (min, Vec3::new(max.x, max.y, level)),
            dimensions: domain.dimensions,
            water: &water,
        };
        let [nx, ny, _] = self.counts;
        let filled = |column: usize| {
            let [i, j] = [column % (nx + 1), column / (nx + 1)];
            let is_wet = |k: &usize| nodes[self.index([i, j, *k])] == Node::Wet;
            match i < nx && j < ny {
                true => (0..self.n_wet_rows).filter(is_wet).count(),
                false => 0,
            }
        };
        Columns {
            per_row: nx + 1,
            volumes: cells.columns(solids),
            filled: (0..(nx + 1) * (ny + 1)).map(filled).collect(),
        }
    }

    /// Number of nodes along an axis that may be wet.
    fn reach(&self, axis: usize) -> usize {
        if axis == 2 {
            self.n_wet_rows
        } else {
            self.counts[axis]
        }
    }

    /// The next node along an axis that may be wet; `None` beyond an edge and above the level.
    fn step(&self, node: [usize; 3], axis: usize, forward: bool) -> Option<[usize; 3]> {
        self.beside(node, axis, forward)
            .filter(|next| next[2] < self.n_wet_rows)
    }

    /// The next node along an axis, across periodic sides; `None` beyond an edge.
    fn beside(&self, node: [usize; 3], axis: usize, forward: bool) -> Option<[usize; 3]> {
        let n = self.counts[axis];
        let mut next = node;
        next[axis] = match (forward, node[axis]) {
            (true, at) if at + 1 < n => at + 1,
            (false, at) if at > 0 => at - 1,
            (true, _) if self.periodic[axis] => 0,
            (false, _) if self.periodic[axis] => n - 1,
            _ => return None,
        };
        Some(next)
    }

    /// The closest node to the seed with room for a particle and open water between, among the 27 around it: the seed
    /// of a coarse lattice may be close to a wall.
    fn start(
        &self,
        seed: &Vec3,
        level: f64,
        domain: &DomainFile,
        obstacles: &Obstacles,
        solids: &[(String, Shape)],
    ) -> Result<[usize; 3], FillError> {
        let name = |block: usize| solids[block].0.clone();
        let at = [seed.x, seed.y, seed.z];
        let (min, max) = (vec3(domain.min), vec3(domain.max));
        let is_inside = (0..3).all(|k| min[k] <= seed[k] && seed[k] <= max[k]);
        if !(is_inside && seed.z < level) {
            return Err(FillError::SeedOutside { seed: at });
        }
        let nearest = [0, 1, 2].map(|axis| {
            let place = (seed[axis] - self.first[axis]) / self.spacing[axis];
            (place.round().max(0.0) as usize).min(self.reach(axis) - 1)
        });
        if let Some(block) = obstacles.holder(nearest, seed) {
            let block = name(block);
            return Err(FillError::SeedInBlock { seed: at, block });
        }
        let mut best: Option<(f64, [usize; 3])> = None;
        let mut in_the_way = None;
        for shift in 0..27 {
            let moved = |axis: usize, step: usize| (nearest[axis] + step).checked_sub(1);
            let (Some(i), Some(j), Some(k)) = (
                moved(0, shift % 3),
                moved(1, shift / 3 % 3),
                moved(2, shift / 9),
            ) else {
                continue;
            };
            let node = [i, j, k];
            if (0..3).any(|axis| node[axis] >= self.reach(axis)) {
                continue;
            }
            let x = self.position(node);
            let distance = (x - seed).norm();
            if let Some(block) = obstacles.blocker(node, &x) {
                in_the_way = in_the_way.or(Some(block));
            } else if best.is_none_or(|(least, _)| distance < least)
                && !obstacles.is_crossed(node, seed, &x)
            {
                best = Some((distance, node));
            }
        }
        best.map(|(_, node)| node)
            .ok_or_else(|| FillError::SeedTooNarrow {
                seed: at,
                block: in_the_way.map_or_else(String::new, name),
            })
    }

    fn flood(&self, start: [usize; 3], obstacles: &Obstacles) -> Result<Vec<Node>, FillError> {
        let mut nodes = vec![Node::Unknown; self.counts.iter().product()];
        nodes[self.index(start)] = Node::Wet;
        let mut queue = VecDeque::from([start]);
        while let Some(node) = queue.pop_front() {
            let from = self.position(node);
            for (axis, forward) in (0..3).flat_map(|axis| [(axis, false), (axis, true)]) {
                let mut beyond = from;
                beyond[axis] += if forward { 1.0 } else { -1.0 } * self.spacing[axis];
                let Some(next) = self.step(node, axis, forward) else {
                    // upward there is air, not an edge, and beyond a plane of symmetry more water; a wall may
                    // stand at the edge itself
                    let is_air = axis == 2 && forward;
                    if is_air
                        || self.symmetry[axis][usize::from(forward)]
                        || obstacles.blocker(node, &beyond).is_some()
                        || obstacles.is_barred(node, &from, &beyond)
                    {
                        continue;
                    }
                    return Err(FillError::Leak { at: from });
                };
                let index = self.index(next);
                if nodes[index] != Node::Unknown {
                    continue;
                }
                let to = self.position(next);
                if obstacles.blocker(next, &to).is_some() {
                    nodes[index] = Node::Blocked;
                    continue;
                }
                // round a periodic direction the step is seen from both of its ends
                let before = to - (beyond - from);
                if obstacles.is_barred(node, &from, &beyond)
                    || obstacles.is_barred(next, &before, &to)
                {
                    continue;
                }
                nodes[index] = Node::Wet;
                queue.push_back(next);
            }
        }
        Ok(nodes)
    }

    /// Adds the free neighbors of wet nodes and of the mould: water below the level, mould above it.
    fn spread(&self, nodes: &mut [Node], to: Node, obstacles: &Obstacles) {
        let rows = match to {
            Node::Wet => 0..self.n_wet_rows,
            _ => self.n_wet_rows..self.counts[2],
        };
        let mut found = Vec::new();
        for k in rows {
            for j in 0..self.counts[1] {
                for i in 0..self.counts[0] {
                    let node = [i, j, k];
                    if matches!(nodes[self.index(node)], Node::Wet | Node::Mould) {
                        continue;
                    }
                    let x = self.position(node);
                    let is_open = |axis: usize, forward: bool| {
                        let mut from = x;
                        from[axis] += if forward { 1.0 } else { -1.0 } * self.spacing[axis];
                        self.beside(node, axis, forward).is_some_and(|beside| {
                            matches!(nodes[self.index(beside)], Node::Wet | Node::Mould)
                                && !obstacles.is_crossed(node, &from, &x)
                        })
                    };
                    let mut sides = (0..3).flat_map(|axis| [(axis, false), (axis, true)]);
                    if obstacles.touches(node, &x) || !sides.any(|(axis, up)| is_open(axis, up)) {
                        continue;
                    }
                    found.push(self.index(node));
                }
            }
        }
        for index in found {
            nodes[index] = to;
        }
    }
}
