//! Clouds of points as newcomers have them.

use std::fmt::Write as _;
use std::path::Path;

use super::{Error, Row, SLOPE, Warning, answers, assert_none_missed, check, files};
use crate::landslide::cloud::las;
use riprap::scene::crs::Crs;

/// The raster of the slope as points, replaced by others.
#[rustfmt::skip] // one row a line
const CLOUDS: &[Row] = &[
    ("\"slope.asc\"", "\"empty.xyz\"", "\"empty.xyz\"", Error, "`empty.xyz`: line 1: has no points; needed are columns x, y and, for terrain, z"),
    ("\"slope.asc\"", "\"header.csv\"", "\"header.csv\"", Error, "`header.csv`: line 1: has a header and no points below it"),
    ("\"slope.asc\"", "\"flat.csv\"", "\"flat.csv\"", Error, "`flat.csv`: line 1: no column is z (or elevation)"),
    ("\"slope.asc\"", "\"line.xyz\"", "\"line.xyz\"", Error, "`line.xyz`: has all points on a line, from (0.00, 0.00) to (400.00, 200.00); terrain needs points on both sides of it"),
    ("\"slope.asc\"", "\"pair.xyz\"", "\"pair.xyz\"", Error, "`pair.xyz`: has points at 2 places; terrain needs three that are not on a line"),
    ("\"slope.asc\"", "\"twice.xyz\"", "\"twice.xyz\"", Warning, "`twice.xyz`: has points one above the other at 1 places, at (200.00, 100.00) 3.000 m apart; the median is taken: are all points of the ground?"),
    ("\"slope.asc\"", "\"nan.xyz\"", "\"nan.xyz\"", Error, "`nan.xyz`: line 2: z is `nan`, needed is a number"),
    ("\"slope.asc\"", "\"counted.xyz\"", "\"counted.xyz\"", Error, "`counted.xyz`: line 1: the first column counts the lines; name the columns in a header: id x y z"),
    ("\"slope.asc\"", "\"commas.csv\"", "\"commas.csv\"", Error, "`commas.csv`: line 2: found 6 columns, the header has 3; decimal commas need semicolons between columns"),
    ("\"slope.asc\"", "\"furlongs.xyz\"", "\"furlongs.xyz\"", Error, "`furlongs.xyz`: line 1: unit `furlong` of x is not known; write one of m, mm, cm, dm, km, ft, in"),
    ("\"slope.asc\"", "\"lonlat.xyz\"", "\"lonlat.xyz\"", Error, "`lonlat.xyz`: line 1: columns lon, lat are in degrees; project them: x, y in meters"),
    ("\"slope.asc\"", "\"degrees.xyz\"", "\"degrees.xyz\"", Error, "`degrees.xyz`: is in degrees, terrain is in meters; project it: pdal translate in out.laz reprojection --filters.reprojection.in_srs=EPSG:4326 --filters.reprojection.out_srs=EPSG:32632"),
    ("\"slope.asc\"", "\"far.xyz\"", "\"far.xyz\"", Error, "`far.xyz`: has a coordinate of 1000000000000 m, beyond any map; export it again"),
    ("\"slope.asc\"", "\"feet.las\"", "\"feet.las\"", Error, "`feet.las`: has a plan in units of 0.304801 m, EPSG:2230 (NAD83 / California zone 6 (ftUS)); project it to meters with pdal translate, --filters.reprojection.out_srs"),
    ("\"slope.asc\"", "\"etrs.las\"", "\"etrs.las\"", Error, "`etrs.las`: is in degrees of EPSG:4258 (ETRS89), terrain is in meters; project it: pdal translate in out.laz reprojection --filters.reprojection.out_srs="),
    ("\"slope.asc\"", "\"cut.las\"", "\"cut.las\"", Error, "`cut.las`: is cut off: its header promises 3321 points, it has 1660; copy it again"),
    ("\"slope.asc\"", "\"cut.laz\"", "\"cut.laz\"", Error, "`cut.laz`: is cut off within its chunk table; copy or export it again"),
    ("\"slope.asc\"", "\"head.las\"", "\"head.las\"", Error, "`head.las`: is cut off within its header; copy or export it again"),
    ("\"slope.asc\"", "\"none.las\"", "\"none.las\"", Error, "`none.las`: has no points; export it again"),
    ("(file: \"slope.asc\")", "(file: \"zone32.asc\"), (file: \"zone33.laz\")", "\"zone33.laz\"", Error, "`zone33.laz` is in EPSG:25833 (ETRS89 / UTM zone 33N), `zone32.asc` in EPSG:25832 (ETRS89 / UTM zone 32N); project it: pdal translate in out.laz reprojection --filters.reprojection.out_srs=EPSG:25832"),
    ("(file: \"slope.asc\")", "(file: \"slope.asc\", cell: 5)", "\"slope.asc\"", Error, "`slope.asc`: has a `cell`, which is of clouds of points (.xyz, .csv, .txt, .las, .laz); leave it out"),
    ("(file: \"slope.asc\")", "(file: \"slope.xyz\", cell: -5)", "-5", Error, "cell of `slope.xyz` must be > 0, found -5"),
    ("(file: \"slope.asc\")", "(file: \"slope.xyz\", cell: 500)", "\"slope.xyz\"", Error, "`slope.xyz`: is 400 x 200 m, and cells of 500 m make 1 x 1 points, needed are two each way; lower `cell`"),
];

/// Points of the raster of the slope.
fn points() -> Vec<[f64; 3]> {
    let lattice =
        (0..41).flat_map(|j| (0..81).map(move |i| (5.0 * f64::from(i), 5.0 * f64::from(j))));
    let height = |x: f64, y: f64| {
        let along = (200.0 - 0.5 * x).max(3.0 * (x - 340.0));
        along + (3.0 * ((y - 100.0).abs() - 80.0)).max(0.0)
    };
    lattice.map(|(x, y)| [x, y, height(x, y)]).collect()
}

fn lines(head: &str, points: &[[f64; 3]], line: impl Fn(usize, &[f64; 3]) -> String) -> String {
    let mut text = head.to_owned();
    for (k, p) in points.iter().enumerate() {
        writeln!(text, "{}", line(k, p)).unwrap();
    }
    text
}

fn clouds(folder: &Path) {
    let points = points();
    let plain = |points: &[[f64; 3]]| lines("", points, |_, [x, y, z]| format!("{x} {y} {z}"));
    let mut twice = points.clone();
    twice.push([200.0, 100.0, 103.0]);
    let diagonal: Vec<[f64; 3]> = (0..9)
        .map(|k| f64::from(k) * 50.0)
        .map(|x| [x, 0.5 * x, x])
        .collect();
    let small: Vec<[f64; 3]> = (points.iter())
        .map(|[x, y, z]| [7.0 + x * 1e-5, 62.0 + y * 1e-5, *z])
        .collect();
    for (file, text) in [
        ("empty.xyz", "# nothing\n".to_owned()),
        ("header.csv", "X;Y;Z\n".to_owned()),
        ("flat.csv", "X;Y\n1;2\n".to_owned()),
        ("line.xyz", plain(&diagonal)),
        ("pair.xyz", plain(&diagonal[..2])),
        ("twice.xyz", plain(&twice)),
        ("nan.xyz", "0 0 1\n5 0 nan\n".to_owned()),
        (
            "counted.xyz",
            lines("", &points, |k, [x, y, z]| format!("{} {x} {y} {z}", k + 1)),
        ),
        ("commas.csv", "x,y,z\n1,0,2,0,3,0\n".to_owned()),
        ("furlongs.xyz", "x[furlong] y z\n1 2 3\n".to_owned()),
        ("lonlat.xyz", "lon lat h\n7 62 3\n".to_owned()),
        ("degrees.xyz", plain(&small)),
        ("far.xyz", "0 0 1\n1e12 0 1\n0 5 1\n5 5 1\n".to_owned()),
        ("slope.xyz", plain(&points)),
        ("slope.txt", plain(&points)),
        (
            "ids.csv",
            lines("Point;E [ft];N [ft];Height [cm]\n", &points, |k, p| {
                let [x, y, z] = [p[0] / 0.3048, p[1] / 0.3048, 100.0 * p[2]];
                format!("p{k};{x:.9};{y:.9};{z}")
            }),
        ),
    ] {
        std::fs::write(folder.join(file), text).unwrap();
    }
    let of = |points: &[[f64; 3]], system: u16, laz: bool| {
        let wkt = (system > 0).then(|| Crs::of_epsg(system).unwrap().wkt);
        las(points, &[], ((1, 4), 6), (laz, wkt))
    };
    let (whole, packed) = (of(&points, 0, false), of(&points, 0, true));
    let end_of_half = whole.len() - 1661 * 30 + 15;
    for (file, content) in [
        ("slope.las", whole.clone()),
        ("slope.laz", packed.clone()),
        ("cut.las", whole[..end_of_half].to_vec()),
        ("cut.laz", packed[..packed.len() / 2].to_vec()),
        ("head.las", whole[..100].to_vec()),
        ("none.las", of(&[], 0, false)),
        ("feet.las", of(&points, 2230, false)),
        ("etrs.las", of(&points, 4258, false)),
        ("zone33.laz", of(&points, 25_833, true)),
    ] {
        std::fs::write(folder.join(file), content).unwrap();
    }
}

/// Each mistake is answered once, where it is, in at most two lines.
#[test]
fn clouds_are_answered_in_their_place() {
    let folder = tempfile::tempdir().unwrap();
    files(folder.path());
    clouds(folder.path());
    assert_none_missed(&check(folder.path(), SLOPE, CLOUDS));
}

/// Points as they come, a column of text and units in the header among them, pass without a word.
#[test]
fn clouds_as_users_have_them_pass() {
    let folder = tempfile::tempdir().unwrap();
    files(folder.path());
    clouds(folder.path());
    for file in [
        "slope.xyz",
        "slope.txt",
        "ids.csv",
        "slope.las",
        "slope.laz",
    ] {
        let text = SLOPE.replace("slope.asc", file);
        let found = answers(folder.path(), &text);
        assert!(found.is_empty(), "{file}: {found:?}");
    }
}
