//! Triangles of terrain: error on both sides, angles, outlines, crests.

use super::*;
use riprap::scene::terrain::grid::Grid;
use riprap::scene::terrain::outline::Outline;
use riprap::scene::terrain::triangles::{Triangles, triangulated};
use riprap_dda::Random;

/// Bound of the angles away from outlines, less round-off; degrees.
const SMALLEST_ANGLE: f64 = 19.999;

fn grid(n: [usize; 2], spacing: f64, height: impl Fn(f64, f64) -> f64) -> Grid {
    let mut grid = Grid {
        n,
        corner: [-300.0, 70.0],
        spacing,
        heights: vec![0.0; n[0] * n[1]],
    };
    for point in grid.points() {
        let [x, y] = grid.place(point);
        let k = grid.index(point);
        grid.heights[k] = height(x, y);
    }
    grid
}

/// Hills of several lengths, steep in places.
fn hills(x: f64, y: f64) -> f64 {
    let octaves = [(190.0, 30.0, 0.3), (83.0, 9.0, 1.9), (31.0, 3.0, 4.1)];
    let one = |(l, h, t): (f64, f64, f64)| {
        h * ((x * t.cos() + y * t.sin()) / l).sin() * ((y * t.cos() - x * t.sin()) / l).cos()
    };
    octaves.into_iter().map(one).sum::<f64>() - 0.2 * x
}

fn on(grid: &Grid, outlines: &[Outline], tolerance: f64) -> Triangles {
    triangulated(grid, outlines, |_, _| -1e3, tolerance).unwrap()
}

/// Smallest angle in plan view of the triangles that keep a condition; degrees.
fn smallest_angle(triangles: &Triangles, counts: impl Fn(&[Vec3; 3]) -> bool) -> f64 {
    let corners = triangles.corners.iter();
    let of = |t: &[u32; 3]| t.map(|v| triangles.points[v as usize]);
    let angle = |x: [Vec3; 3]| {
        let at = |k: usize| {
            let [a, b, c] = [k, k + 1, k + 2].map(|i| x[i % 3].xy());
            (b - a).angle(&(c - a))
        };
        at(0).min(at(1)).min(at(2))
    };
    let smallest = corners.map(of).filter(counts).map(angle);
    smallest.fold(f64::INFINITY, f64::min).to_degrees()
}

/// Largest height of triangles above and below the points of a grid that keep a condition; m.
fn errors(triangles: &Triangles, grid: &Grid, counts: impl Fn([f64; 2]) -> bool) -> [f64; 2] {
    let corners = |t: &[u32; 3]| t.map(|v| triangles.points[v as usize]);
    let ground = Ground::over(triangles.corners.iter().map(corners).collect());
    let places = grid.points().map(|point| (grid.place(point), point));
    let off = places
        .filter(|(place, _)| counts(*place))
        .map(|(place, point)| {
            ground.height_under_the_sky(place).unwrap() - grid.heights[grid.index(point)]
        });
    off.fold([0.0; 2], |[above, below], z| [z.max(above), below.max(-z)])
}

/// No triangle is narrow or far from a point, on smooth and on noisy ground, for any tolerance; and what is reported is so.
#[test]
fn triangles_are_within_the_tolerance_and_no_slivers() {
    let mut random = Random::new(7);
    let noise: Vec<f64> = (0..100_000).map(|_| random.uniform() - 0.5).collect();
    for (height, n) in [(0.0, [81, 61]), (1.0, [81, 61]), (0.0, [301, 7])] {
        let mut grid = grid(n, 5.0, hills);
        for (z, noise) in grid.heights.iter_mut().zip(&noise) {
            *z += height * noise;
        }
        for tolerance in [5.0, 1.0, 0.2, 0.01] {
            let triangles = on(&grid, &[], tolerance);
            let [above, below] = errors(&triangles, &grid, |_| true);
            let angle = smallest_angle(&triangles, |_| true);
            println!(
                "{} triangles within {tolerance} m: above by {above:.4}, below by {below:.4} m, {angle:.2} degrees",
                triangles.corners.len()
            );
            // round-off of heights of 100 m
            assert!(above.max(below) <= tolerance + 1e-12);
            assert!(SMALLEST_ANGLE <= angle);
            let said = triangles.quality;
            assert!((said.fit.above - above).abs() < 1e-9 && (said.fit.below - below).abs() < 1e-9);
            assert!((said.smallest_angle.to_degrees() - angle).abs() < 1e-6);
            assert_eq!(triangles, on(&grid, &[], tolerance));
        }
    }
}

/// A plane is two triangles whatever its shape, a fold along the points four, for any tolerance above round-off.
#[test]
fn planes_and_folds_take_the_fewest_triangles() {
    for n in [[81, 61], [301, 7]] {
        let plane = grid(n, 5.0, |x, y| 0.25 * x - 0.5 * y + 3.0);
        assert_eq!(on(&plane, &[], 1e-9).corners.len(), 2);
    }
    let fold = grid([81, 61], 5.0, |x, _| 0.5 * (x + 100.0).abs());
    assert_eq!(on(&fold, &[], 1e-9).corners.len(), 4);
}

/// Ground turned and mirrored keeps the tolerance with about as many triangles: squares halve along either diagonal.
#[test]
fn turned_and_mirrored_ground_is_met_as_well() {
    let original = grid([81, 61], 5.0, hills);
    let [columns, rows] = original.n;
    let n = on(&original, &[], 0.5).corners.len() as f64;
    let mut turned = grid([rows, columns], 5.0, |_, _| 0.0);
    let mut mirrored = original.clone();
    for [i, j] in original.points() {
        let z = original.heights[original.index([i, j])];
        let k = turned.index([rows - 1 - j, i]);
        turned.heights[k] = z;
        let k = mirrored.index([columns - 1 - i, j]);
        mirrored.heights[k] = z;
    }
    for other in [turned, mirrored] {
        let triangles = on(&other, &[], 0.5);
        let share = triangles.corners.len() as f64 / n;
        println!("{share:.3} of {n} triangles");
        let [above, below] = errors(&triangles, &other, |_| true);
        assert!(above.max(below) <= 0.5 + 1e-12);
        // measured 7 %
        assert!((share - 1.0).abs() < 0.1);
    }
}

/// Sides of outlines are edges of triangles, cut where they leave the ground; two outlines share a side, one has a sharp corner.
#[test]
fn outlines_are_kept_as_edges() {
    let grid = grid([81, 61], 5.0, hills);
    let ring = |corners: &[[f64; 2]]| Outline::new(corners.to_vec()).unwrap();
    let outlines = [
        ring(&[
            [-220.0, 130.0],
            [-101.3, 121.7],
            [-98.2, 256.9],
            [-211.1, 243.3],
        ]),
        ring(&[
            [-101.3, 121.7],
            [21.7, 150.2],
            [-60.0, 170.0],
            [-98.2, 256.9],
        ]),
    ];
    let tolerance = 0.2;
    let triangles = on(&grid, &outlines, tolerance);
    let mut edges = std::collections::BTreeSet::new();
    for t in &triangles.corners {
        edges.extend((0..3).map(|k| (t[k], t[(k + 1) % 3])));
    }
    let is_on = |x: &Vec3, (from, to): ([f64; 2], [f64; 2])| {
        let along = [to[0] - from[0], to[1] - from[1]];
        let off = [x.x - from[0], x.y - from[1]];
        let length = along[0].hypot(along[1]);
        let share = (off[0] * along[0] + off[1] * along[1]) / (length * length);
        let across = (off[0] * along[1] - off[1] * along[0]) / length;
        (across.abs() < 1e-9 && (-1e-12..=1.0 + 1e-12).contains(&share)).then_some(share)
    };
    let sides: Vec<_> = outlines.iter().flat_map(Outline::sides).collect();
    for &side in &sides {
        let numbered = (0..).zip(&triangles.points);
        let mut along: Vec<(f64, u32)> = numbered
            .filter_map(|(v, x)| Some((is_on(x, side)?, v)))
            .collect();
        along.sort_by(|a, b| a.0.total_cmp(&b.0));
        assert_eq!((along[0].0, along[along.len() - 1].0.round()), (0.0, 1.0));
        for pair in along.windows(2) {
            let (a, b) = (pair[0].1, pair[1].1);
            assert!(
                edges.contains(&(a, b)) && edges.contains(&(b, a)),
                "{side:?}"
            );
            let (x, y) = (triangles.points[a as usize], triangles.points[b as usize]);
            let middle = 0.5 * (x + y);
            let off = middle.z - grid.height([middle.x, middle.y]).unwrap();
            // between the places where a side may be cut, a spacing apart, bilinear ground bends by a little more
            assert!(off.abs() < 1.5 * tolerance, "{off}");
        }
    }
    let meets = |x: &[Vec3; 3]| {
        x.iter()
            .any(|x| sides.iter().any(|&s| is_on(x, s).is_some()))
    };
    let (away, beside) = (
        smallest_angle(&triangles, |x| !meets(x)),
        smallest_angle(&triangles, |x| meets(x)),
    );
    println!("{away:.2} degrees, {beside:.2} beside outlines");
    assert!(SMALLEST_ANGLE <= away);
    // half of a spacing beside a piece of a spacing and a half at most: atan(0.5 / 1.5) is 18 degrees, less beside a corner;
    // measured 20.7
    assert!(12.0 < beside);
    let area = |outline: usize| -> f64 {
        let within = triangles.corners.iter().zip(&triangles.outline);
        let own = within.filter(|(_, o)| **o == Some(outline));
        own.map(|(t, _)| {
            let [a, b, c] = t.map(|v| triangles.points[v as usize].xy());
            0.5 * (b - a).perp(&(c - a))
        })
        .sum()
    };
    for (k, outline) in outlines.iter().enumerate() {
        assert!((area(k) / outline.area() - 1.0).abs() < 1e-12);
    }
    // half a spacing beside the sides is left to them
    let far = |[x, y]: [f64; 2]| {
        sides.iter().all(|(a, b)| {
            let along = [b[0] - a[0], b[1] - a[1]];
            let share = ((x - a[0]) * along[0] + (y - a[1]) * along[1])
                / (along[0] * along[0] + along[1] * along[1]);
            let share = share.clamp(0.0, 1.0);
            (a[0] + share * along[0] - x).hypot(a[1] + share * along[1] - y) > 2.5 + 1e-9
        })
    };
    let [above, below] = errors(&triangles, &grid, far);
    assert!(above.max(below) <= tolerance + 1e-12);
}

/// A dam one point wide keeps its crest: at each of its points, and between them the ground is no lower than the tolerance allows.
#[test]
fn the_crest_of_a_dam_is_kept() {
    let (crest, tolerance) = (40.0, 0.2);
    let dam = |x: f64, y: f64| {
        let valley = hills(x, y).min(crest - 5.0);
        valley.max(crest - 0.6 * (x + 100.0).abs())
    };
    let grid = grid([81, 61], 5.0, dam);
    let triangles = on(&grid, &[], tolerance);
    let corners = |t: &[u32; 3]| t.map(|v| triangles.points[v as usize]);
    let ground = Ground::over(triangles.corners.iter().map(corners).collect());
    let lowest = (0..=600).map(|k| {
        let y = 70.0 + 0.5 * f64::from(k);
        ground.height_under_the_sky([-100.0, y]).unwrap() - crest
    });
    let lowest = lowest.fold(f64::INFINITY, f64::min);
    println!("the crest is lower by up to {:.3} m", -lowest);
    assert!(-lowest <= tolerance + 1e-12);
    assert!(SMALLEST_ANGLE <= smallest_angle(&triangles, |_| true));
}
