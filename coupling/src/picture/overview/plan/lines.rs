//! Contour lines and outlines of blocks as paths.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use super::contour;
use super::layout::Chart;
use super::panels::Panel;
use super::{Footprint, Plan};
use crate::picture::chart::axis::nice_up;
use crate::scene::terrain::grid::Grid;

/// Budgets of contour lines and of outlines of blocks; bytes of text.
const LINE_BUDGET: usize = 45_000;
const OUTLINE_BUDGET: usize = 45_000;
/// Approximate number of contour levels from the lowest to the highest ground.
const N_CONTOURS: f64 = 12.0;
/// Tolerance of simplified lines; px.
const LINE_TOLERANCES: [f64; 4] = [0.2, 0.4, 0.8, 1.5];
/// Smaller lines are omitted; px.
const LEAST_LINE: f64 = 4.0;
/// Lattices on which corners of outlines are rounded, finest first; tenths of px.
const LATTICES: [i32; 5] = [1, 5, 10, 20, 40];

/// Contour lines; text of paths.
#[derive(Debug, Default)]
pub(super) struct Lines {
    pub land: String,
    pub bed: String,
    pub shore: String,
    /// Contour interval, if there are not too many lines; m.
    pub step: Option<f64>,
}

impl Lines {
    /// As many and as fine as the budget allows.
    pub fn new(chart: Chart, plan: &Plan) -> Self {
        let (low, high) = plan.ground.range();
        let shore = |tolerance| {
            let level = plan.still_level?;
            Some(path_of_level(chart, &plan.ground, level, tolerance))
        };
        let mut step = nice_up((high - low) / N_CONTOURS);
        if !(step.is_finite() && 0.0 < step) {
            return Self::default();
        }
        // rough ground has long lines: fewer and simpler ones until they fit
        for tolerance in LINE_TOLERANCES {
            let mut lines = Self {
                shore: shore(tolerance).unwrap_or_default(),
                step: Some(step),
                ..Self::default()
            };
            let raise = plan.origin[2];
            let first = ((low + raise) / step).ceil();
            let levels = (0..).map(|k| (first + f64::from(k)) * step - raise);
            for level in levels.take_while(|&level| level < high) {
                let over_rest = level - plan.still_level.unwrap_or(f64::NEG_INFINITY);
                // the contour of still water is the shore
                if over_rest.abs() < 1e-6 * step {
                    continue;
                }
                let path = path_of_level(chart, &plan.ground, level, tolerance);
                match 0.0 < over_rest {
                    true => lines.land += &path,
                    false => lines.bed += &path,
                }
            }
            if lines.land.len() + lines.bed.len() + lines.shore.len() <= LINE_BUDGET {
                return lines;
            }
            step = nice_up(1.5 * step);
        }
        let [.., coarsest] = LINE_TOLERANCES;
        let shore = shore(coarsest).filter(|path| path.len() <= LINE_BUDGET);
        Self {
            shore: shore.unwrap_or_default(),
            ..Self::default()
        }
    }
}

/// Outlines of the blocks of each plan, under water and not, as fine as the budget allows; text of paths.
pub(super) fn outlines(chart: Chart, panels: &[Panel<'_>]) -> Vec<[String; 2]> {
    let mut outlines = Vec::new();
    for lattice in LATTICES {
        let of = |panel: &Panel<'_>| {
            [true, false].map(|is_under_water| {
                let blocks = panel.blocks.iter();
                let chosen = blocks.filter(|block| block.is_under_water == is_under_water);
                path_of_blocks(chart, chosen, lattice)
            })
        };
        outlines = panels.iter().map(of).collect();
        if outlines.iter().flatten().map(String::len).sum::<usize>() <= OUTLINE_BUDGET {
            break;
        }
    }
    outlines
}

/// Path of a contour (m) within a tolerance (px); lines of a few pixels are omitted.
pub(super) fn path_of_level(chart: Chart, ground: &Grid, level: f64, tolerance: f64) -> String {
    let mut path = String::new();
    for line in contour::lines(ground, level) {
        let line: Vec<[f64; 2]> = line.into_iter().map(|place| chart.pixel(place)).collect();
        let extent = |axis: usize| {
            let along = line.iter().map(|p| p[axis]);
            along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
        };
        if LEAST_LINE <= extent(0).max(extent(1)) {
            let points = contour::simplified(&line, tolerance);
            let points = points.into_iter().map(|p| p.map(|c| tenths(c, 1)));
            push_path(&mut path, &points.collect::<Vec<_>>());
        }
    }
    path
}

/// Path of blocks with corners on a lattice (tenths of a pixel), without duplicates.
fn path_of_blocks<'a>(
    chart: Chart,
    blocks: impl Iterator<Item = &'a Footprint>,
    lattice: i32,
) -> String {
    let mut path = String::new();
    let mut drawn = BTreeSet::new();
    for block in blocks {
        let known = block
            .points
            .iter()
            .filter(|p| p.iter().all(|c| c.is_finite()));
        let mut corners: Vec<[i32; 2]> = known
            .map(|p| chart.pixel(p.map(f64::from)).map(|c| tenths(c, lattice)))
            .collect();
        corners.dedup();
        if !corners.is_empty() && drawn.insert(corners.clone()) {
            push_path(&mut path, &corners);
            path.push('z');
        }
    }
    path
}

/// Appends a line through points in tenths of a pixel, in relative coordinates, which halves the text.
fn push_path(path: &mut String, points: &[[i32; 2]]) {
    let mut before: Option<[i32; 2]> = None;
    for &[x, y] in points {
        let (command, [from_x, from_y]) = match before {
            None => ('M', [0, 0]),
            Some(before) => ('l', before),
        };
        let [dx, dy] = [x - from_x, y - from_y].map(|n| f64::from(n) / 10.0);
        // writing to a string does not fail
        let _ = write!(path, "{command}{dx} {dy}");
        before = Some([x, y]);
    }
}

/// Position in tenths of a pixel, rounded to a multiple and clamped to the range of renderers.
fn tenths(pixel: f64, multiple: i32) -> i32 {
    let n = 10.0 * pixel.clamp(-1e4, 1e4) / f64::from(multiple);
    n.round() as i32 * multiple
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::chart::page::Frame;

    /// 0.5 px/m.
    const CHART: Chart = Chart {
        frame: Frame {
            left: 0.0,
            top: 0.0,
            width: 400.0,
            height: 200.0,
        },
        min: [-300.0, 0.0],
        max: [500.0, 400.0],
    };

    fn block(points: &[[f32; 2]]) -> Footprint {
        Footprint {
            points: points.to_vec(),
            is_under_water: false,
        }
    }

    #[test]
    fn a_block_is_drawn_where_it_is() {
        // 100 m to 140 m east of the western edge, 20 m to 60 m south of the northern one
        let square = block(&[
            [-200.0, 340.0],
            [-160.0, 340.0],
            [-160.0, 380.0],
            [-200.0, 380.0],
        ]);
        let path = path_of_blocks(CHART, [&square].into_iter(), 1);
        assert_eq!(path, "M50 30l20 0l0 -20l-20 0z");
    }

    #[test]
    fn blocks_that_look_alike_are_drawn_once() {
        let blocks =
            [0.0, 0.4, 100.0].map(|x| block(&[[x, 0.0], [x + 40.0, 0.0], [x + 40.0, 40.0]]));
        let count = |lattice| {
            path_of_blocks(CHART, blocks.iter(), lattice)
                .matches('M')
                .count()
        };
        assert_eq!((count(1), count(10)), (3, 2));
        let nowhere = block(&[[f32::NAN, 0.0], [f32::INFINITY, 1.0]]);
        assert_eq!(path_of_blocks(CHART, [&nowhere].into_iter(), 1), "");
        let far = block(&[[1e30, 0.0]]);
        assert_eq!(path_of_blocks(CHART, [&far].into_iter(), 1), "M10000 200z");
    }
}
