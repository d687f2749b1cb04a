//! Barriers: their blocks by name, the frame of the flow, cells and openings.

use riprap_dda::{BlockDefinition, Motion, Shape, Vec3};
use std::f64::consts::PI;

use crate::messages::Code;
use crate::scene::error::{Problem, Severity};
use crate::scene::file::{BarrierFile, BlockFile, BoxFile, MotionFile, SceneFile, vec3};
use crate::scene::parse::suggestion;
use crate::scene::resolved::FluidScene;
use crate::scene::resolved::recording::{Barrier, BarrierOpening};
use crate::walls::WallMethod;

/// Most cells of a barrier, 150 bytes each.
const MOST_CELLS: f64 = 1e6;
/// Side of a cell with water; × particle spacing.
const CELL_OVER_SPACING: f64 = 2.0;
/// Side of a cell among grains; × mean diameter.
const CELL_OVER_GRAIN: f64 = 0.5;
/// Side of a cell with neither; × height of the barrier.
const CELL_OVER_HEIGHT: f64 = 0.05;
/// Component of gravity across the flow below which there is no bed to measure depths from; × gravity.
const NO_BED: f64 = 1e-6;
/// Gap between two blocks below which they are one wall; × height of the barrier.
const NO_GAP: f64 = 1e-6;

/// Names of barriers that no block has, and blocks that are free to move; the file has the blocks of its rock masses, slides and grains.
pub(super) fn unknown_blocks(file: &SceneFile) -> Vec<Problem> {
    let mut problems = Vec::new();
    for (index, barrier) in file.barriers.iter().enumerate() {
        for (k, name) in barrier.blocks.iter().enumerate() {
            let path = format!("barriers[{index}].blocks[{k}]");
            let who = format!("barrier `{}`", barrier.name);
            let members = || file.blocks.iter().filter(|block| fits(block, name));
            if members().next().is_none() {
                let all: Vec<&str> = file.blocks.iter().map(|b| b.name.as_str()).collect();
                let bare = name.trim_end_matches('*');
                let what = format!(
                    "{who}: no block is called `{name}`{}",
                    suggestion(bare, &all)
                );
                problems.push(Problem::error(Code::UnknownName, path, what));
            } else if let Some(free) = members().find(|b| matches!(b.motion, MotionFile::Free)) {
                let what = format!(
                    "{who}: block `{}` is free to move; a barrier is of fixed or prescribed blocks, forces on free ones are those of \
                     `forces`",
                    free.name
                );
                problems.push(Problem::error(Code::IncompatibleOptions, path, what));
            }
        }
    }
    problems
}

/// Whether a name, or its beginning before a `*`, is that of a block.
pub(super) fn fits(block: &BlockFile, name: &str) -> bool {
    match name.strip_suffix('*') {
        Some(prefix) => block.name.starts_with(prefix),
        None => block.name == name,
    }
}

/// Barriers in their frames; those that cannot be recorded are told.
pub(super) fn barriers(
    file: &SceneFile,
    blocks: &[BlockDefinition],
    fluid: Option<&FluidScene>,
    problems: &mut Vec<Problem>,
) -> Vec<Barrier> {
    let grain = mean_grain(file, blocks);
    let mut barriers = Vec::new();
    for (index, asked) in file.barriers.iter().enumerate() {
        let site = Site {
            index,
            asked,
            file,
            blocks,
            fluid,
            grain,
        };
        let members = site.members();
        let unusable = site.unusable_blocks(&members);
        if unusable.iter().any(|p| p.severity == Severity::Error) {
            problems.extend(unusable);
            continue;
        }
        let barrier = site.barrier(members);
        problems.extend(unusable);
        problems.extend(site.unusable_cells(&barrier));
        problems.extend(site.narrow_openings(&barrier));
        barriers.push(barrier);
    }
    barriers
}

/// Mean diameter (m) of the free blocks, of spheres of their volumes, and mean mass (kg).
fn mean_grain(file: &SceneFile, blocks: &[BlockDefinition]) -> Option<[f64; 2]> {
    let free = || {
        blocks
            .iter()
            .filter(|block| matches!(block.motion, Motion::Free))
    };
    let n = free().count();
    let diameter = |block: &BlockDefinition| (6.0 * block.shape.volume() / PI).cbrt();
    let sums = free().fold([0.0; 2], |[diameters, masses], block| {
        [diameters + diameter(block), masses + mass(file, block)]
    });
    (0 < n).then(|| sums.map(|sum| sum / n as f64))
}

fn mass(file: &SceneFile, block: &BlockDefinition) -> f64 {
    let material = file.materials.get(block.material);
    material.map_or(0.0, |material| material.density) * block.shape.volume()
}

/// A barrier as the scene asks for it.
struct Site<'a> {
    index: usize,
    asked: &'a BarrierFile,
    file: &'a SceneFile,
    blocks: &'a [BlockDefinition],
    fluid: Option<&'a FluidScene>,
    grain: Option<[f64; 2]>,
}

impl Site<'_> {
    fn path(&self, field: &str) -> String {
        format!("barriers[{}].{field}", self.index)
    }

    fn members(&self) -> Vec<usize> {
        let blocks = self.file.blocks.iter().enumerate();
        let members = blocks.filter(|(_, block)| {
            let names = &mut self.asked.blocks.iter();
            names.any(|name| fits(block, name))
        });
        members.map(|(number, _)| number).collect()
    }

    /// Blocks without faces, and those whose load by water is unknown.
    fn unusable_blocks(&self, members: &[usize]) -> Vec<Problem> {
        let who = format!("barrier `{}`", self.asked.name);
        let unusable = members.iter().filter_map(|&b| {
            let name = &self.file.blocks[b].name;
            let body = match &self.blocks[b].shape {
                Shape::Polyhedra(_) => None,
                Shape::Sphere { .. } => Some("a sphere"),
                Shape::Surface(_) => Some("a surface of triangles"),
            };
            if let Some(body) = body {
                let what = format!(
                    "{who}: block `{name}` is {body}, which has no faces to divide into cells; build the barrier of boxes, prisms or meshes"
                );
                return Some(Problem::error(
                    Code::InvalidShape,
                    self.path("blocks"),
                    what,
                ));
            }
            let walls = self.fluid.map(|fluid| fluid.wall_method);
            let is_fixed = matches!(self.blocks[b].motion, Motion::Fixed);
            (is_fixed && walls == Some(WallMethod::Integral)).then(|| {
                let what = format!(
                    "{who}: `interface.walls: Integral` treats all fixed blocks as one body, so that the load of the water on block \
                     `{name}` is unknown; use `Particles`"
                );
                Problem::error(Code::UnusableWalls, self.path("blocks"), what)
            })
        });
        unusable.take(1).collect()
    }

    fn barrier(&self, blocks: Vec<usize>) -> Barrier {
        let gravity = vec3(self.file.gravity);
        let axes = axes(vec3(self.asked.flow).normalize(), &gravity);
        let extents: Vec<[[f64; 2]; 3]> = (blocks.iter())
            .map(|&b| extent(&self.blocks[b].shape, &axes))
            .collect();
        let mut extent = extents.iter().fold(NOTHING, |all, of| joined(&all, of));
        extent[1] = self.within_domain(extent[1], &axes);
        let height = extent[2][1] - extent[2][0];
        let cell = self.asked.cell.unwrap_or_else(|| self.chosen_cell(height));
        let lowest_edge = axes[0] * extent[0][0]
            + axes[1] * (0.5 * (extent[1][0] + extent[1][1]))
            + axes[2] * extent[2][0];
        let openings = match &self.asked.openings {
            Some(boxes) => boxes.iter().map(|o| opening(o, &axes)).collect(),
            None => gaps(&extents, &extent),
        };
        let free = (self.blocks.iter()).filter(|block| matches!(block.motion, Motion::Free));
        let released: f64 = free.map(|block| mass(self.file, block)).sum();
        let along = gravity.dot(&axes[0]);
        Barrier {
            name: self.asked.name.clone(),
            block_names: (blocks.iter())
                .map(|&b| self.file.blocks[b].name.clone())
                .collect(),
            blocks,
            axes,
            extent,
            foot: self.asked.foot.map_or(lowest_edge, vec3),
            cell,
            upstream: self.asked.upstream.unwrap_or(height),
            openings,
            grain: self.grain,
            released,
            along_flow: (NO_BED * gravity.norm() < along).then_some(along),
        }
    }

    /// The part of a range across the flow (m) that is in the domain: blocks reach beyond a slice, and beyond walls of water.
    fn within_domain(&self, [from, to]: [f64; 2], axes: &[Vec3; 3]) -> [f64; 2] {
        let domain = &self.file.domain;
        let corners = BoxFile {
            min: domain.min,
            max: domain.max,
        };
        let [low, high] = opening(&corners, axes).across;
        match (from.max(low), to.min(high)) {
            (from, to) if from < to => [from, to],
            _ => [from, to],
        }
    }

    fn chosen_cell(&self, height: f64) -> f64 {
        match (self.fluid, self.grain) {
            (Some(fluid), _) => CELL_OVER_SPACING * fluid.settings.mean_spacing(),
            (None, Some([diameter, _])) => CELL_OVER_GRAIN * diameter,
            (None, None) => CELL_OVER_HEIGHT * height,
        }
    }

    /// Cells larger than the barrier, and more than memory should hold.
    fn unusable_cells(&self, barrier: &Barrier) -> Option<Problem> {
        let who = format!("barrier `{}`", barrier.name);
        let cell = barrier.cell;
        let face = barrier.width().min(barrier.height());
        if self.asked.cell.is_some() && face < cell {
            let what = format!(
                "{who}: cells of {cell} m are larger than its face of {:.6} x {:.6} m",
                barrier.width(),
                barrier.height()
            );
            return Some(Problem::error(
                Code::ValueOutOfRange,
                self.path("cell"),
                what,
            ));
        }
        let [along, across, up] = barrier.extent.map(|[min, max]| (max - min) / cell);
        // both sides of the box around it: its own faces may be more, as of many piles, but not by much
        let n = 2.0 * (along * across + across * up + up * along);
        (MOST_CELLS < n).then(|| {
            let what = format!(
                "{who}: cells of {cell} m would be about {n:.1e}, more than {MOST_CELLS:.0e}; take larger ones"
            );
            Problem::error(Code::NotEnoughMemory, self.path("cell"), what)
        })
    }

    fn narrow_openings(&self, barrier: &Barrier) -> Vec<Problem> {
        let Some([diameter, _]) = barrier.grain else {
            return Vec::new();
        };
        let narrow = barrier.openings.iter().enumerate().filter_map(|(k, opening)| {
            let width = opening.across[1] - opening.across[0];
            (width < diameter).then(|| {
                let what = format!(
                    "barrier `{}`: opening {} is {width:.6} m wide, narrower than a free block of mean diameter {diameter:.6} m: nothing \
                     can clog it",
                    barrier.name,
                    k + 1
                );
                Problem::warning(Code::GrainsDoNotFit, self.path("openings"), what)
            })
        });
        narrow.collect()
    }
}

const NOTHING: [[f64; 2]; 3] = [[f64::INFINITY, f64::NEG_INFINITY]; 3];

fn joined(a: &[[f64; 2]; 3], b: &[[f64; 2]; 3]) -> [[f64; 2]; 3] {
    [0, 1, 2].map(|k| [a[k][0].min(b[k][0]), a[k][1].max(b[k][1])])
}

/// Unit vectors along the flow, across it and from the bed up. Up is against gravity, at right angles to the flow; a flow along gravity,
/// as of a rockfall on a gallery, has no bed, and its up is the direction that lies most along z, y or x.
fn axes(flow: Vec3, gravity: &Vec3) -> [Vec3; 3] {
    let across_flow = |v: &Vec3| v - flow * flow.dot(v);
    let up = across_flow(&-gravity);
    let candidates = [Vec3::z(), Vec3::y(), Vec3::x()].map(|axis| across_flow(&axis));
    let up = if NO_BED * gravity.norm() < up.norm() {
        up
    } else {
        let mut best = candidates[0];
        for candidate in &candidates[1..] {
            if best.norm() + 1e-9 < candidate.norm() {
                best = *candidate;
            }
        }
        best
    };
    let up = up.normalize();
    [flow, up.cross(&flow), up]
}

/// Box around a shape, along some axes; m.
fn extent(shape: &Shape, axes: &[Vec3; 3]) -> [[f64; 2]; 3] {
    let Shape::Polyhedra(parts) = shape else {
        return NOTHING;
    };
    let corners = parts.iter().flat_map(|part| part.vertices());
    corners.fold(NOTHING, |all, x| {
        let at = axes.map(|axis| [axis.dot(x); 2]);
        joined(&all, &at)
    })
}

/// Box of an opening, by its corners along some axes.
fn opening(asked: &BoxFile, axes: &[Vec3; 3]) -> BarrierOpening {
    let (min, max) = (vec3(asked.min), vec3(asked.max));
    let corners = (0..8).map(|k| {
        let of_axis = |axis: usize| {
            if k >> axis & 1 == 0 {
                min[axis]
            } else {
                max[axis]
            }
        };
        Vec3::new(of_axis(0), of_axis(1), of_axis(2))
    });
    let [_, across, height] = corners.fold(NOTHING, |all, x| {
        let at = axes.map(|axis| [axis.dot(&x); 2]);
        joined(&all, &at)
    });
    BarrierOpening { across, height }
}

/// Gaps between blocks across the flow, over the whole height.
fn gaps(extents: &[[[f64; 2]; 3]], all: &[[f64; 2]; 3]) -> Vec<BarrierOpening> {
    let mut sides: Vec<[f64; 2]> = extents.iter().map(|of| of[1]).collect();
    sides.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let height = all[2];
    let least = NO_GAP * (height[1] - height[0]);
    let mut gaps = Vec::new();
    let mut reached = f64::INFINITY;
    for [from, to] in sides {
        if least < from - reached {
            gaps.push(BarrierOpening {
                across: [reached, from],
                height,
            });
        }
        reached = if reached.is_finite() {
            reached.max(to)
        } else {
            to
        };
    }
    gaps
}
