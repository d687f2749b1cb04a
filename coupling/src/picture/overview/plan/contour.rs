//! Contour lines.

use std::collections::BTreeMap;

use crate::scene::terrain::grid::Grid;

/// Edge of a grid cell: its lower point and its axis.
type Side = ([usize; 2], usize);

/// Contour lines of a grid at a level (m), in plan view; m. Closed lines end at their start. Cells with a NaN corner are
/// skipped.
///
/// Marching squares: in each cell lines connect the points on its edges where the elevation crosses the level, by linear
/// interpolation; if it crosses on all four edges, the mean of the corners decides which points are connected.
pub(super) fn lines(grid: &Grid, level: f64) -> Vec<Vec<[f64; 2]>> {
    let mut next: BTreeMap<Side, Vec<Side>> = BTreeMap::new();
    let inner = grid
        .points()
        .filter(|[i, j]| i + 1 < grid.n[0] && j + 1 < grid.n[1]);
    for point in inner {
        for [a, b] in cuts(grid, point, level) {
            next.entry(a).or_default().push(b);
            next.entry(b).or_default().push(a);
        }
    }
    let mut lines = Vec::new();
    // open lines first: the remaining ones are closed
    let ends: Vec<Side> = next
        .iter()
        .filter(|(_, beside)| beside.len() == 1)
        .map(|(side, _)| *side)
        .collect();
    let all: Vec<Side> = next.keys().copied().collect();
    for start in ends.into_iter().chain(all) {
        let mut line = vec![start];
        let mut here = start;
        while let Some(there) = next.get_mut(&here).and_then(Vec::pop) {
            if let Some(back) = next.get_mut(&there) {
                back.retain(|side| *side != here);
            }
            line.push(there);
            here = there;
        }
        if line.len() > 1 {
            lines.push(
                line.into_iter()
                    .map(|side| crossing(grid, side, level))
                    .collect(),
            );
        }
    }
    lines
}

/// Segments of a line within a cell, from edge to edge.
fn cuts(grid: &Grid, [i, j]: [usize; 2], level: f64) -> Vec<[Side; 2]> {
    let corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
    let heights = corners.map(|corner| grid.heights[grid.index(corner)]);
    if !heights.iter().all(|z| z.is_finite()) {
        return Vec::new();
    }
    let is_above = heights.map(|z| level <= z);
    // south, east, north, west: side k goes from corner k to the next
    let sides: [Side; 4] = [([i, j], 0), ([i + 1, j], 1), ([i, j + 1], 0), ([i, j], 1)];
    let cut: Vec<Side> = (0..4)
        .filter(|&k| is_above[k] != is_above[(k + 1) % 4])
        .map(|k| sides[k])
        .collect();
    match cut[..] {
        [a, b] => vec![[a, b]],
        [south, east, north, west] => {
            let is_middle_above = level <= 0.25 * heights.iter().sum::<f64>();
            // a corner on the other side than the middle is cut off
            match is_middle_above == is_above[0] {
                true => vec![[south, east], [north, west]],
                false => vec![[south, west], [east, north]],
            }
        }
        _ => Vec::new(),
    }
}

/// Position of a level along an edge; m.
fn crossing(grid: &Grid, (point, axis): Side, level: f64) -> [f64; 2] {
    let mut end = point;
    end[axis] += 1;
    let [low, high] = [point, end].map(|p| grid.heights[grid.index(p)]);
    let mut place = grid.place(point);
    place[axis] += (level - low) / (high - low) * grid.spacing;
    place
}

/// A simplified line within a tolerance of the original points (in their unit).
///
/// Source: Douglas and Peucker (1973).
pub(super) fn simplified(line: &[[f64; 2]], tolerance: f64) -> Vec<[f64; 2]> {
    let Some(last) = line.len().checked_sub(1) else {
        return Vec::new();
    };
    let mut is_kept = vec![false; line.len()];
    is_kept[0] = true;
    is_kept[last] = true;
    let mut open = vec![(0, last)];
    while let Some((from, to)) = open.pop() {
        let farthest = (from + 1..to)
            .map(|k| (distance(line[k], line[from], line[to]), k))
            .max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((far, k)) = farthest
            && tolerance < far
        {
            is_kept[k] = true;
            open.extend([(from, k), (k, to)]);
        }
    }
    let kept = line.iter().zip(is_kept).filter(|(_, is_kept)| *is_kept);
    kept.map(|(point, _)| *point).collect()
}

/// Distance of a point from the segment between two others.
fn distance(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let along = [b[0] - a[0], b[1] - a[1]];
    let offset = [p[0] - a[0], p[1] - a[1]];
    let length2 = along[0] * along[0] + along[1] * along[1];
    let share = match 0.0 < length2 {
        true => ((offset[0] * along[0] + offset[1] * along[1]) / length2).clamp(0.0, 1.0),
        false => 0.0,
    };
    (offset[0] - share * along[0]).hypot(offset[1] - share * along[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(n: usize, height: impl Fn([f64; 2]) -> f64) -> Grid {
        let mut grid = Grid {
            n: [n, n],
            corner: [-20.0, -20.0],
            spacing: 40.0 / (n - 1) as f64,
            heights: Vec::new(),
        };
        grid.heights = grid.points().map(|p| height(grid.place(p))).collect();
        grid
    }

    #[test]
    fn the_contour_of_a_cone_is_one_closed_circle() {
        let cone = grid(41, |[x, y]| 30.0 - x.hypot(y));
        let found = lines(&cone, 17.5);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].first(), found[0].last());
        let mut turned = 0.0;
        for pair in found[0].windows(2) {
            for [x, y] in pair {
                // along a side the cone is bent by at most spacing²/8 r = 0.01 m, half a cell is 0.5 m
                assert!((x.hypot(*y) - 12.5).abs() < 0.02, "{x} {y}");
            }
            let [[a, b], [c, d]] = [pair[0], pair[1]];
            turned += (a * d - b * c).atan2(a * c + b * d);
        }
        assert!((turned.abs() - std::f64::consts::TAU).abs() < 1e-9);
    }

    #[test]
    fn lines_end_at_the_rim_and_beside_gaps() {
        let mut plane = grid(5, |[x, _]| x);
        let found = lines(&plane, 5.0);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].len(), 5);
        assert!(found[0].iter().all(|[x, _]| (x - 5.0).abs() < 1e-12));
        // the point (0, 0) is a corner of the second and the third row of squares
        let middle = plane.index([2, 2]);
        plane.heights[middle] = f64::NAN;
        let found = lines(&plane, 5.0);
        assert_eq!(found.len(), 2);
        assert!(found.iter().all(|line| line.len() == 2));
        assert!(lines(&plane, 100.0).is_empty());
    }

    #[test]
    fn at_a_saddle_the_middle_decides() {
        let mut saddle = Grid {
            n: [2, 2],
            corner: [0.0; 2],
            spacing: 1.0,
            heights: vec![1.0, 0.0, 0.0, 1.0],
        };
        // south-west and north-east are high; so is the middle at 0.4, and the low corners are cut off
        let found = lines(&saddle, 0.4);
        assert_eq!(found.len(), 2);
        assert!(found.contains(&vec![[0.6, 0.0], [1.0, 0.4]]));
        saddle.heights = vec![1.0, 0.0, 0.0, 1.0];
        // at 0.6 it is low, and the high ones are
        assert!(lines(&saddle, 0.6).contains(&vec![[0.4, 0.0], [0.0, 0.4]]));
    }

    #[test]
    fn a_simplified_line_stays_within_the_tolerance() {
        let line: Vec<[f64; 2]> = (0..=100)
            .map(|k| [f64::from(k), (0.1 * f64::from(k)).sin()])
            .collect();
        let few = simplified(&line, 0.05);
        assert!(few.len() < 30, "{}", few.len());
        assert_eq!((few.first(), few.last()), (line.first(), line.last()));
        for p in &line {
            let near = few.windows(2).map(|pair| distance(*p, pair[0], pair[1]));
            assert!(near.fold(f64::INFINITY, f64::min) <= 0.05);
        }
        assert_eq!(
            simplified(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]], 0.0).len(),
            2
        );
    }
}
