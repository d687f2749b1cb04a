//! Terrain from scattered points: exact bounds, outliers, gaps, formats.

use super::*;

use las::{Builder, Writer, point::Format};
use riprap::scene::cloud::{Cloud, CloudReport};
use riprap::scene::crs::Crs;
use riprap::scene::terrain::grid::Grid;

/// Random numbers in [0, 1): Knuth's generator (MMIX), its upper bits.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = (self.0)
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Of mean 0 and deviation 1: Box and Muller.
    fn normal(&mut self) -> f64 {
        let (u, v) = (1.0 - self.next(), self.next());
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }
}

/// Points strewn over a rectangle at the map's (500000, 6.5e6), in multiples of 2⁻¹⁰ m.
fn strewn(n: usize, size: [f64; 2], height: impl Fn(f64, f64) -> f64, seed: u64) -> Vec<[f64; 3]> {
    let mut random = Random(seed);
    let exact = |x: f64| (1024.0 * x).round() / 1024.0;
    let mut point = || {
        let [x, y] = size.map(|side| exact(side * random.next()));
        [500_000.0 + x, 6_500_000.0 + y, exact(height(x, y))]
    };
    (0..n).map(|_| point()).collect()
}

fn cloud(points: Vec<[f64; 3]>) -> Cloud {
    Cloud {
        n_in_file: points.len(),
        points,
        crs: None,
    }
}

fn gridded(points: Vec<[f64; 3]>, cell: Option<f64>) -> (Grid, CloudReport) {
    let (raster, report) = cloud(points).grid(cell).unwrap();
    (raster.grid, report)
}

fn text(points: &[[f64; 3]], separator: &str) -> String {
    let line = |p: &[f64; 3]| format!("{:?}{separator}{:?}{separator}{:?}\n", p[0], p[1], p[2]);
    points.iter().map(line).collect()
}

/// Linear interpolation has no error on a plane, nor has the plane beyond the rim.
#[test]
fn a_cloud_of_a_plane_gives_the_plane() {
    let plane = |x: f64, y: f64| 40.0 + 0.5 * x - 0.25 * y;
    let mut points = strewn(5000, [400.0, 300.0], plane, 1);
    for p in &mut points {
        p[2] = plane(p[0] - 500_000.0, p[1] - 6_500_000.0);
    }
    let (grid, report) = gridded(points, None);
    println!("{report}");
    let worst = grid.points().map(|point| {
        let [x, y] = grid.place(point);
        let z = grid.heights[grid.index(point)];
        (z - plane(x - 500_000.0, y - 6_500_000.0)).abs()
    });
    let worst = worst.fold(0.0, f64::max);
    println!("{} x {} points, off by {worst:.1e} m", grid.n[0], grid.n[1]);
    // heights of 300 m have round-off of 6e-14 m, coordinates of 6.5e6 m one of 1e-9 m times the slope
    assert!(worst < 2e-9, "{worst}");
    assert!(report.outliers.is_empty());
    // 5000 points on 120,000 m²: 4.9 m apart, of which the mean distance of four neighbors is 0.82
    assert!((report.spacing / (0.82 * 24.0_f64.sqrt()) - 1.0).abs() < 0.03);
}

/// On `a (x² + y²)` the triangle whose corners are on a circle of radius R is off by `a (R² − d²)`, d from the center: between 0
/// and `a R²`. No point is within that circle: away from the rim its center is in the extent, and R at most the largest gap.
#[test]
fn a_cloud_of_a_paraboloid_is_within_the_bound_of_the_interpolation() {
    let a = 0.002;
    let bowl = |x: f64, y: f64| a * (x * x + y * y);
    let mut points = strewn(20_000, [400.0, 400.0], bowl, 2);
    for p in &mut points {
        p[2] = bowl(p[0] - 500_000.0, p[1] - 6_500_000.0);
    }
    let (grid, report) = gridded(points, Some(2.0));
    let radius = report.gap.distance;
    let inner = |x: f64| (20.0..380.0).contains(&x);
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for point in grid.points() {
        let [x, y] = grid.place(point);
        let (x, y) = (x - 500_000.0, y - 6_500_000.0);
        if inner(x) && inner(y) {
            let error = grid.heights[grid.index(point)] - bowl(x, y);
            (least, most) = (least.min(error), most.max(error));
        }
    }
    println!(
        "errors from {least:.2e} to {most:.2e} m, bound {:.2e} m",
        a * radius * radius
    );
    // the grid finds the center of the largest empty circle to within half a diagonal of its cells
    let bound = a * (radius + 2.0_f64.sqrt()).powi(2);
    assert!(most <= bound, "{most} {bound}");
    // round-off of coordinates, times the slope of 1.6
    assert!(-5e-9 < least, "{least}");
    // the bound is met to a factor that the points leave: it is no empty statement
    assert!(0.2 * bound < most);
}

/// Ten spikes of 20 m among 5000 points of rough ground are found, and with them no good point in a thousand.
#[test]
fn planted_spikes_are_found_and_the_ground_is_kept() {
    for seed in 0..5 {
        let hills = |x: f64, y: f64| 30.0 * (x / 60.0).sin() + 20.0 * (y / 45.0).cos() + 0.4 * x;
        let mut points = strewn(5010, [400.0, 300.0], hills, 10 + seed);
        let mut random = Random(seed);
        for p in &mut points {
            p[2] += 0.2 * random.normal();
        }
        let planted: Vec<[f64; 3]> = (0..10)
            .map(|k| {
                let p = &mut points[500 * k + 7];
                p[2] += if k % 2 == 0 { 20.0 } else { -20.0 };
                *p
            })
            .collect();
        let (_, report) = gridded(points, None);
        let found = |p: &&[f64; 3]| report.outliers.contains(p);
        assert_eq!(planted.iter().filter(found).count(), 10, "{report}");
        let lost = report.outliers.len() - 10;
        println!("{lost} of 5000 good points left out");
        assert!(lost <= 5, "{lost}");
    }
}

/// A crest one point wide, the rim of a cliff and a lone tower of four points are terrain.
#[test]
fn crests_and_cliffs_are_no_outliers() {
    let points: Vec<[f64; 3]> = (0..60)
        .flat_map(|j| (0..60).map(move |i| (i, j)))
        .map(|(i, j)| {
            let z = match (i, j) {
                (20, _) => 15.0,
                (40.., _) => -30.0,
                (30..=31, 30..=31) => 12.0,
                _ => 0.1 * f64::from(i),
            };
            [2.0 * f64::from(i), 2.0 * f64::from(j), z]
        })
        .collect();
    let (grid, report) = gridded(points, None);
    // the ends of the crest have one neighbor on it within two rings
    assert!(report.outliers.len() <= 2, "{report}");
    assert_eq!(grid.spacing, 2.0);
    assert_eq!(grid.height([40.0, 60.0]), Some(15.0));
}

/// A hole of 60 m is told with its place; it is refused as a hole of a raster is, or filled.
#[test]
fn a_gap_is_told_with_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let center = [500_240.0, 6_500_130.0];
    let mut points = strewn(8000, [400.0, 300.0], |x, _| 0.1 * x, 3);
    points.retain(|p| (p[0] - center[0]).hypot(p[1] - center[1]) > 30.0);
    let (grid, report) = gridded(points.clone(), None);
    println!("{report}");
    let [x, y] = [0, 1].map(|axis| (report.gap.at[axis] - center[axis]).abs());
    // the hole is round to within the spacing of 3.2 m
    assert!(x.hypot(y) < 5.0, "{report}");
    assert!((28.0..36.0).contains(&report.gap.distance), "{report}");
    let missing = grid.heights.iter().filter(|z| z.is_nan()).count();
    assert_eq!(missing, report.n_gaps);
    let area = missing as f64 * grid.spacing * grid.spacing;
    let radius = (area / std::f64::consts::PI).sqrt();
    assert!(
        (radius - (30.0 - report.widest_gap)).abs() < 3.0,
        "{radius}"
    );
    assert!(report.within[1] < 0.985 && report.within[0] < report.within[1]);
    std::fs::write(folder.path().join("holed.xyz"), text(&points, " ")).unwrap();
    let of = |gaps: &str| {
        let terrain =
            format!("(sources: [(file: \"holed.xyz\")], origin: (500000, 6500150, 0), {gaps})");
        terrain_of(folder.path(), &terrain)
    };
    let refused = of("").unwrap_err();
    assert_eq!(refused.path, "terrain.sources");
    assert!(
        refused.message.contains("on the map (5002"),
        "{}",
        refused.message
    );
    let filled = of("gaps: Filled(40)").unwrap();
    assert_eq!(filled.n_filled, missing);
    assert_eq!(filled.clouds[0].1, report);
}

/// The order of the points is not seen: the same bits.
#[test]
fn permuted_points_give_the_same_bits() {
    let mut random = Random(5);
    let mut points = strewn(3000, [200.0, 200.0], |x, y| (x / 9.0).sin() * y / 20.0, 4);
    // with places of two heights, and a lattice, where neighbors tie
    for k in 0..20 {
        let [x, y, z] = points[k];
        points.push([x, y, z + 0.5]);
    }
    for k in 0..400 {
        points.push([
            500_300.0 + f64::from(k % 20),
            6_500_100.0 + f64::from(k / 20),
            3.0,
        ]);
    }
    let (grid, report) = gridded(points.clone(), None);
    assert_eq!(report.steps.n, 20);
    let bits = |grid: &Grid| grid.heights.iter().map(|z| z.to_bits()).collect::<Vec<_>>();
    for _ in 0..3 {
        for k in (1..points.len()).rev() {
            points.swap(k, (random.next() * (k + 1) as f64) as usize);
        }
        let (again, told) = gridded(points.clone(), None);
        assert_eq!((bits(&again), told), (bits(&grid), report.clone()));
    }
}

/// Points of a raster are that raster.
#[test]
fn a_lattice_is_its_raster() {
    let folder = tempfile::tempdir().unwrap();
    let raster = valley();
    raster.write(&folder.path().join("grid.asc"), hummocky);
    let points = (0..raster.n[1]).flat_map(|j| (0..raster.n[0]).map(move |i| (i, j)));
    let points: Vec<[f64; 3]> = points
        .map(|(i, j)| {
            let at = |axis: usize, k: usize| raster.corner[axis] + k as f64 * raster.cell;
            [at(0, i), at(1, j), hummocky(at(0, i), at(1, j))]
        })
        .collect();
    std::fs::write(folder.path().join("grid.txt"), text(&points, "\t")).unwrap();
    let of = |file: &str| {
        terrain_of(folder.path(), &format!("(sources: [(file: \"{file}\")])")).unwrap()
    };
    let (raster, cloud) = (of("grid.asc"), of("grid.txt"));
    assert_eq!(
        (raster.grid.n, raster.grid.corner),
        (cloud.grid.n, cloud.grid.corner)
    );
    let heights = raster.grid.heights.iter().zip(&cloud.grid.heights);
    // coordinates over cells have round-off of 1e-15, heights change by 20 m a cell
    assert!(heights.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) < 1e-11);
    assert_eq!(cloud.clouds[0].1.spacing, 10.0);
}

/// A LAS file in steps of 2⁻¹⁰ m, of points that have a class or are not classified.
pub(crate) fn las(
    points: &[[f64; 3]],
    classes: &[u8],
    (version, format): ((u8, u8), u8),
    (laz, wkt): (bool, Option<String>),
) -> Vec<u8> {
    let mut builder = Builder::from(version);
    builder.point_format = Format::new(format).unwrap();
    builder.point_format.is_compressed = laz;
    let transform = |offset| las::Transform {
        scale: 1.0 / 1024.0,
        offset,
    };
    builder.transforms = las::Vector {
        x: transform(points.first().map_or(0.0, |p| p[0].floor())),
        y: transform(points.first().map_or(0.0, |p| p[1].floor())),
        z: transform(0.0),
    };
    let mut header = builder.into_header().unwrap();
    if let Some(wkt) = wkt {
        header.set_wkt_crs(wkt.into_bytes()).unwrap();
    }
    let mut writer = Writer::new(std::io::Cursor::new(Vec::new()), header).unwrap();
    for (k, p) in points.iter().enumerate() {
        let class = classes.get(k).copied().unwrap_or(1);
        let point = las::Point {
            x: p[0],
            y: p[1],
            z: p[2],
            classification: las::point::Classification::new(class).unwrap(),
            gps_time: (format != 0).then_some(0.1 * k as f64),
            ..las::Point::default()
        };
        writer.write_point(point).unwrap();
    }
    writer.into_inner().unwrap().into_inner()
}

/// The same points as text, LAS and LAZ, of the layout up to 1.3 and of that of 1.4, give the same bits; points of the ground are
/// taken where there are any; the reference system is that of the file.
#[test]
fn formats_give_the_same_terrain() {
    let folder = tempfile::tempdir().unwrap();
    let points = strewn(
        3000,
        [400.0, 300.0],
        |x, y| 30.0 + 0.2 * x + 5.0 * (y / 40.0).sin(),
        6,
    );
    let mut classes = vec![2; points.len()];
    let mut with_trees = points.clone();
    for [x, y, z] in &points[..500] {
        with_trees.push([x + 1.0, *y, z + 12.0]);
        classes.push(5);
    }
    let wkt = || Some(Crs::of_epsg(25_833).unwrap().wkt);
    let line = |p: &[f64; 3]| format!("p{};{:?};{:?};{:?}\n", p[2], p[0], p[1], p[2]);
    let named = "id;X;Y;Z\n".to_owned() + &points.iter().map(line).collect::<String>();
    for (file, content) in [
        ("a.xyz", text(&points, " ").into_bytes()),
        ("b.csv", named.into_bytes()),
        ("c.las", las(&points, &[], ((1, 2), 0), (false, None))),
        ("d.laz", las(&points, &[], ((1, 2), 1), (true, None))),
        (
            "e.las",
            las(&with_trees, &classes, ((1, 4), 6), (false, wkt())),
        ),
        (
            "f.laz",
            las(&with_trees, &classes, ((1, 4), 6), (true, wkt())),
        ),
    ] {
        std::fs::write(folder.path().join(file), content).unwrap();
    }
    let of = |file: &str| {
        let terrain = format!(
            "(sources: [(file: \"{file}\")], origin: (500000, 6500150, 0), gaps: Filled(20))"
        );
        terrain_of(folder.path(), &terrain).unwrap()
    };
    let first = of("a.xyz");
    assert_eq!(first.crs, None);
    for file in ["b.csv", "c.las", "d.laz", "e.las", "f.laz"] {
        let terrain = of(file);
        assert_eq!(terrain.grid, first.grid, "{file}");
        assert_eq!(terrain.surface, first.surface, "{file}");
        let epsg = terrain.crs.and_then(|crs| crs.epsg);
        let has_system = file.starts_with(['e', 'f']);
        assert_eq!(epsg, has_system.then_some(25_833), "{file}");
    }
    let report = &of("f.laz").clouds[0].1;
    assert_eq!((report.n_points, report.n_in_file), (3000, 3500));
}

/// A million points are read and gridded; the time is printed, not asserted.
#[test]
fn a_million_points_are_gridded() {
    let points = strewn(
        1_000_000,
        [1000.0, 1000.0],
        |x, y| 0.1 * x + 3.0 * (y / 50.0).sin(),
        7,
    );
    let start = std::time::Instant::now();
    let (grid, report) = gridded(points, None);
    println!(
        "{:.1} s, {} x {}: {report}",
        start.elapsed().as_secs_f64(),
        grid.n[0],
        grid.n[1]
    );
    // strewn at random, 1 m²/point: no place without a point within three spacings
    assert_eq!(report.n_gaps, 0);
    assert!(report.outliers.len() < 100, "{report}");
}
