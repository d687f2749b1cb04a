//! Mistakes of newcomers, each answered once, in its place, with what was found and what would be right.

mod clouds;

use std::fmt::Write as _;
use std::path::Path;

use riprap::messages::guide;
use riprap::scene::access::Access;
use riprap::scene::crs::Crs;
use riprap::scene::error::{Located, Severity};
use riprap::scene::load_text;

/// An edit of a scene, text and replacement; the text that the answer points at; severity and first words of the answer.
type Row = (
    &'static str,
    &'static str,
    &'static str,
    Severity,
    &'static str,
);

use Severity::{Error, Warning};

/// Longest answer: two lines; characters.
const TWO_LINES: usize = 240;

const TANK: &str = r#"(
    title: "tank",
    domain: (min: (0, 0, 0), max: (4, 1, 2)),
    materials: [
        (name: "rock", density: 2650, friction_angle_deg: 31),
        (name: "wall", density: 2400, friction_angle_deg: 35),
    ],
    blocks: [
        (name: "floor", material: "wall", motion: Fixed, shape: Box(min: (-1, -1, -0.5), max: (5, 2, 0))),
        (name: "cube", material: "rock", shape: Box(min: (3, 0.3, 0), max: (3.5, 0.8, 0.5))),
    ],
    fluid: (
        resolution: Spacing(0.1),
        regions: [(name: "column", shape: Box(min: (0, 0, 0), max: (1, 1, 1)))],
    ),
    time: (duration: 1),
    gauges: [
        SurfaceElevation(name: "near", x: 0.5, y: 0.5),
        Pressure(name: "p", position: (0.5, 0.5, 0.2)),
    ],
)"#;

/// Rock above a lake: the ground falls along x, `slope.asc`.
const SLOPE: &str = r#"(
    title: "slope",
    domain: (min: (0, 0, -50), max: (400, 200, 300)),
    materials: [(name: "rock", density: 2650, friction_angle_deg: 30)],
    terrain: (sources: [(file: "slope.asc")]),
    slides: [(
        name: "slide", material: "rock",
        outline: Corners([(100, 60), (200, 60), (200, 140), (100, 140)]),
        failure_surface: Plane(point: (200, 100, 90), dip_deg: 30, dip_direction_deg: 90),
        joint_sets: [(dip_deg: 90, dip_direction_deg: 270, spacing: 60)],
    )],
    blocks: [(name: "ground", material: "rock", motion: Fixed, shape: Terrain)],
    fluid: (resolution: Spacing(5), regions: [(name: "lake", shape: Below(level: 40, seed: (345, 100, 35)))]),
    time: (duration: 1),
    gauges: [
        SurfaceElevation(name: "near", x: 340, y: 100),
        RunUp(name: "shore", from: (340, 100), to: (250, 100)),
        Velocity(name: "v", position: (345, 100, 35)),
    ],
)"#;

const CUBE: &str = "Box(min: (3, 0.3, 0), max: (3.5, 0.8, 0.5))";

/// Habits of other formats.
#[rustfmt::skip] // one row a line
const WRITING: &[Row] = &[
    ("density: 2650", "density: 2,65", "2,65", Error, "`2,65` has a comma; write 2.65"),
    ("density: 2650", "density: 2,650", "2,650", Error, "`2,650` has a comma; write 2.650, or 2650"),
    ("friction_angle_deg: 31", "friction_angle_deg: 0,6", "0,6", Error, "`0,6` has a comma; write 0.6"),
    ("Spacing(0.1)", "Spacing(0,1)", "0,1", Error, "`0,1` has a comma; write 0.1"),
    ("(0.5, 0.5, 0.2)", "(0,5, 0.5, 0.2)", "0,5", Error, "`0,5` has a comma; write 0.5"),
    ("(4, 1, 2)", "(4,0, 1,0, 2,0)", "4,0", Error, "`4,0` has a comma; write 4.0"),
    ("Spacing(0.1)", "40", "40", Error, "`resolution` does not say what 40 is; write Spacing(40)"),
    ("Spacing(0.1)", "(0.1)", "(", Error, "`resolution` does not say which kind it is before `(`; write Spacing(0.1)"),
    ("Spacing(0.1)", "\"0.1\"", "\"0.1\"", Error, "`resolution` takes a number, found \"0.1\" in quotes; write Spacing(0.1)"),
    ("Spacing(0.1)", "Spacing(\"0.1\")", "\"0.1\"", Error, "`Spacing` takes a number, found \"0.1\" in quotes; write 0.1"),
    ("Spacing(0.1)", "Spacing", ",", Error, "`Spacing` takes its value in parentheses, such as Spacing(1)"),
    ("Spacing(0.1)", "spacing(0.1)", "spacing", Error, "unknown variant `spacing` of ResolutionFile, did you mean `Spacing`?"),
    ("Spacing(0.1)", "Spacing(0.1 m)", "m", Error, "`0.1` is followed by `m`; write 0.1 alone"),
    ("Spacing(0.1)", "Count(1000.5)", "1000.5", Error, "`Count` takes a whole number, found 1000.5"),
    ("density: 2650", "density: \"2650\"", "\"2650\"", Error, "`density` takes a number, found \"2650\" in quotes; write 2650"),
    ("density: 2650", "density: \"2650 kg\"", "\"2650 kg\"", Error, "`density`: found \"2650 kg\"; write a density in kg/m3, g/cm3, t/m3, lb/ft3"),
    ("Spacing(0.1)", "\"0.1 m\"", "\"0.1 m\"", Error, "`resolution` does not say what \"0.1 m\" is; write Spacing(\"0.1 m\")"),
    ("density: 2650", "density: 2650 kg/m3", "kg", Error, "`2650` is followed by `kg`; write 2650 alone"),
    ("density: 2650", "density: 2 650", "650", Error, "found `2 650`; a comma goes between numbers, nothing between thousands"),
    ("density: 2650", "density: 2'650", "'", Error, "found `2'650`; a comma goes between numbers, nothing between thousands"),
    ("density: 2650", "density: 5300/2", "/", Error, "a number is not computed, found `5300/`; write the result"),
    ("density: 2650", "density: 2.650.0", "2.650.0", Error, "`density` takes a number, found `2.650.0`"),
    ("density: 2650", "density: true", "true", Error, "`density` takes a number, found `true`"),
    ("density: 2650", "density: ", ",", Error, "`density` has no value; write a number after it"),
    ("density: 2650", "density = 2650", "=", Error, "a field and its value are separated by a colon, found `=`"),
    ("density: 2650", "\"density\": 2650", "\"density\"", Error, "expected the name of a field, found \"density\" in quotes; write density"),
    ("name: \"rock\"", "name: rock", "rock", Error, "`name` takes a text in double quotes, found `rock`; write \"rock\""),
    ("name: \"rock\"", "name: 'rock'", "'rock'", Error, "`name` takes a text in double quotes, found `'rock'`; write \"rock\""),
    ("motion: Fixed", "motion: \"Fixed\"", "\"Fixed\"", Error, "`motion` takes a word, found \"Fixed\" in quotes; write Fixed"),
    ("motion: Fixed", "motion: fixed", "fixed", Error, "unknown variant `fixed` of MotionFile, did you mean `Fixed`?"),
    ("motion: Fixed", "motion: Fixed()", "(", Error, "`Fixed` takes no parentheses; write Fixed"),
    ("(4, 1, 2)", "[4, 1, 2]", "[", Error, "`max` takes numbers in parentheses, found `[`"),
    ("(4, 1, 2)", "(4, 1)", "(4, 1)", Error, "found 2 numbers in `(4, 1)`, one or more are missing"),
    ("(4, 1, 2)", "4", "4", Error, "`max` takes several numbers, such as (x, y, z), found `4`"),
    ("(4, 1, 2)", "(x: 4, y: 1, z: 2)", "x", Error, "a point is three numbers without names, (x, y, z), found `x:`"),
    ("domain: (", "gravity: -9.81, domain: (", "-9.81", Error, "`gravity` takes several numbers, such as (x, y, z), found `-9.81`"),
    ("time: (duration: 1)", "time: 1", "1", Error, "`time` takes fields in parentheses, (name: value, ...), found `1`"),
    ("time: (duration: 1)", "time: (duration: 60 min)", "min", Error, "`60` is followed by `min`; write 60 alone"),
    ("time: (duration: 1)", "duration: 1", "duration", Error, "unknown field `duration` in SceneFile; expected one of"),
    ("title: \"tank\",", "title: \"tank\"", "\"", Error, "expected a comma after this, before `domain`"),
    ("time: (duration: 1),", "time: (duration: 1),\n# a comment", "#", Error, "a comment begins with `//`, found `#`"),
    ("time: (duration: 1),", "time: (duration: 1), time: (duration: 2),", "time", Error, "`time` is written twice; keep one"),
    ("time: (duration: 1),", "time: (duration: 1), interface: (slip: 20),", "20", Error, "`slip` does not say what 20 is; write Friction(20)"),
    ("time: (duration: 1),", "time: (duration: 1), maps: true,", "true", Error, "`maps` takes its fields in parentheses, found `true`; write maps: ()"),
    (CUBE, "(min: (3, 0.3, 0), max: (3.5, 0.8, 0.5))", "(", Error, "`shape` does not say which kind it is before `(`; such as Box("),
    (CUBE, "Box((3, 0.3, 0), (3.5, 0.8, 0.5))", "(", Error, "`Box` takes its fields by name, Box(name: value, ...), found `(`"),
    (CUBE, "Cube(min: (3, 0.3, 0), max: (3.5, 0.8, 0.5))", "Cube", Error, "unknown variant `Cube` of ShapeFile"),
    ("blocks: [", "blocks: (", "(", Error, "`blocks` takes a list in brackets, [...], found `(`"),
    ("Pressure(name: \"p\"", "(name: \"p\"", "(", Error, "`gauges` does not say which kind it is before `(`; such as Pressure("),
    ("friction_angle_deg: 31", "friction: 0.6", "friction", Error, "unknown field `friction` in MaterialFile, did you mean `friction_angle_deg`?"),
];

/// Quantities in another unit or sense.
#[rustfmt::skip] // one row a line
const UNITS: &[Row] = &[
    ("friction_angle_deg: 31", "friction_angle_deg: 0.6", "0.6", Warning, "material `rock`: friction angle is 0.6 degrees, hardly any; 0.6 rad are 34.4 degrees, a tangent of 0.6 is 31.0"),
    ("friction_angle_deg: 31", "friction_angle_deg: 31, residual_friction_angle_deg: 0.36", "0.36", Warning, "material `rock`: residual friction angle is 0.36 degrees, hardly any"),
    ("friction_angle_deg: 31", "friction_angle_deg: -31", "-31", Error, "material `rock`: friction angle must be in [0, 90) degrees, found -31"),
    ("friction_angle_deg: 31", "friction_angle_deg: 31, restitution: 60", "60", Error, "material `rock`: restitution must be in [0, 1], found 60"),
    ("friction_angle_deg: 31", "friction_angle_deg: 31, cohesion: -1", "-1", Error, "material `rock`: cohesion must be >= 0, found -1"),
    ("friction_angle_deg: 31", "friction_angle_deg: 31, elastic: (young_modulus: 30, poisson_ratio: 0.2)", "30", Warning, "material `rock`: Young's modulus is 30 Pa, softer than foam; 30 GPa are 30e9 Pa"),
    ("time: (", "joints: [(between: (\"rock\", \"wall\"), friction_angle_deg: 0.5236)], time: (", "0.5236", Warning, "joint of `rock` and `wall`: friction angle is 0.5236 degrees, hardly any"),
    ("time: (", "interface: (slip: Friction(0.35)), time: (", "Friction(0.35)", Warning, "interface: friction angle is 0.35 degrees, hardly any"),
    ("time: (", "interface: (slip: Rough(-0.01)), time: (", "Rough(-0.01)", Error, "interface: sand roughness must be >= 0, found -0.01"),
    ("time: (", "interface: (slip: Rough(20)), time: (", "Rough(20)", Warning, "a sand roughness of 20 m is larger than the particle spacing"),
    ("time: (", "interface: (walls: Penalty, slip: None), time: (", "None", Warning, "the fluid slides freely along walls of the method Penalty, which has no such slip"),
    ("time: (", "interface: (walls: Integral, slip: Friction(20)), time: (", "Friction(20)", Warning, "the fluid slides freely along walls of the method Integral, which has no such slip"),
    ("domain: (", "gravity: (0, 0, 9.81), domain: (", "(0, 0, 9.81)", Error, "gravity acts upward, found 9.81 along z; z is up: write -9.81"),
    ("domain: (", "gravity: (0, -9.81, 0), domain: (", "(0, -9.81, 0)", Warning, "gravity acts along the horizon, found (0, -9.81, 0); z is up: write (0, 0, -9.81)"),
    ("domain: (", "gravity: (0, 0, -981), domain: (", "(0, 0, -981)", Warning, "gravity is 981 m/s2, as if in cm/s2"),
    ("density: 2650", "density: 2.65", "2.65", Error, "material `rock`: density is 2.65 kg/m3, as if in t/m3; write 2650"),
    ("density: 2650", "density: 1.0", "1.0", Error, "material `rock`: density is 1 kg/m3, as if in t/m3; write 1000"),
    ("density: 2650", "density: 26.5", "26.5", Warning, "material `rock`: density is 26.5 kg/m3; a unit weight of 26.5 kN/m3 is 2701 kg/m3"),
    ("density: 2650", "density: 26500", "26500", Warning, "material `rock`: density is 26500 kg/m3; a unit weight of 26.5 kN/m3 is 2701 kg/m3"),
    ("density: 2400", "density: 2.4", "2.4", Warning, "material `wall`: density is 2.4 kg/m3; rock has 2000 to 3000"),
    ("resolution:", "density: 1.0, resolution:", "1.0", Error, "fluid: density is 1 kg/m3, as if in t/m3; write 1000"),
    ("friction_angle_deg: 31", "friction_angle_deg: 31, cohesion: 2.5", "2.5", Warning, "a cohesion of 2.5 Pa has no effect: block `cube` weighs 1.3e4 Pa on its face; 2.5 kPa are 2500 Pa"),
    ("resolution:", "density: 9810, resolution:", "9810", Warning, "fluid: density is 9810 kg/m3; a unit weight of 9810 N/m3 is 1000 kg/m3"),
    ("shape: Box(min: (3", "placement: (rotate: (axis: (0, 0, 1), angle_deg: 0.7854)), shape: Box(min: (3", "0.7854", Warning, "block `cube`: it is turned by 0.7854 degrees; 0.7854 rad are 45 degrees"),
    ("shape: Box(min: (3", "velocity: (0, 0, -3000), shape: Box(min: (3", "(0, 0, -3000)", Warning, "block `cube`: it starts at 3000 m/s, faster than sound in air"),
    ("time: (duration: 1)", "time: (duration: -1)", "-1", Error, "duration must be > 0, found -1"),
    ("time: (", "output: (frame_interval: 50), time: (", "50", Warning, "frame interval is 50 s, longer than the run of 1 s"),
    ("Spacing(0.1)", "Spacing(40)", "Box(min: (0, 0, 0), max: (1, 1, 1))", Error, "fluid region `column` is too thin: no particle fits in 1 m along x"),
    ("Spacing(0.1)", "Spacing(0.0001)", "Spacing(0.0001)", Error, "fluid region `column` needs 1.0e12 lattice nodes"),
];

/// Blocks and gauges out of place or of another size.
#[rustfmt::skip] // one row a line
const PLACES: &[Row] = &[
    ("max: (4, 1, 2)", "max: (4000, 1000, 2000)", "(min: (0, 0, 0), max: (4000", Warning, "domain is 4000 m long, all that is in it 6 m; lengths are in meters, not millimeters"),
    (CUBE, "Box(min: (3000, 300, 0), max: (3500, 800, 500))", "Box(min: (3000", Error, "block `cube` is 500 m long in a domain of 4 m; lengths are in meters, not millimeters"),
    (CUBE, "Box(min: (3, 0.3, 10), max: (3.5, 0.8, 10.5))", "Box(min: (3, 0.3, 10)", Error, "block `cube` is outside of the domain: along z it is from 10 to 10.5 m, the domain from 0 to 2"),
    (CUBE, "Box(min: (3, 0.3, -0.2), max: (3.5, 0.8, 0.5))", "(name: \"cube\"", Error, "block `cube` overlaps block `floor`"),
    (CUBE, "Box(min: (3, 0.3, 0.5), max: (3.5, 0.8, 0))", "(3.5, 0.8, 0)", Error, "block `cube`: max (3.5, 0.8, 0.0) must exceed min (3.0, 0.3, 0.5) in every direction"),
    (CUBE, "Mesh(file: \"mm.obj\", scale: 1)", "1", Error, "block `cube` is 500 m long in a domain of 4 m; a mesh in millimeters has scale: 0.001, found 1"),
    (CUBE, "Mesh(file: \"one.obj\", scale: 0.001), placement: (translate: (2, 0.3, 0))", "0.001", Warning, "block `cube` is 0.0005 m long in a domain of 4 m; a mesh in meters has scale: 1, found 0.001"),
    (CUBE, "Mesh(file: \"two.obj\", scale: 1), placement: (translate: (2, 0.3, 0))", "\"two.obj\"", Error, "block `cube`: `two.obj`: shells 1 and 2 of 2 overlap by 1.000e-1 m: mass and buoyancy of what they share would count twice"),
    (CUBE, "Mesh(file: \"nested.obj\", scale: 1), placement: (translate: (2, 0.3, 0))", "\"nested.obj\"", Error, "block `cube`: `nested.obj`: shells 1 and 2 of 2 overlap by 4.000e-1 m"),
    ("motion: Fixed", "motion: Table(file: \"furlongs.csv\")", "\"furlongs.csv\"", Error, "`furlongs.csv` line 1: unit `furlong` of x is not known; write one of m, mm, cm, dm, km, ft, in"),
    ("max: (5, 2, 0)", "max: (5, 2, -0.4)", "", Warning, "block `floor` is outside of the domain: along z it is from -0.5 to -0.4 m, the domain from 0 to 2; it has no effect"),
    ("x: 0.5", "x: 500", "500", Error, "gauge `near` at (500.0, 0.5, 0.0) is outside of the domain"),
    ("(0.5, 0.5, 0.2)", "(0.5, 0.5, -0.2)", "(0.5, 0.5, -0.2)", Error, "gauge `p` at (0.5, 0.5, -0.2) is outside of the domain"),
];

/// Orientation of planes, and instruments on land.
#[rustfmt::skip] // one row a line
const HILL: &[Row] = &[
    ("30, dip_direction_deg: 90", "30, dip_direction_deg: 270", "270", Warning, "slide `slide`: the failure plane dips into the hill, toward 270 degrees; the ground falls toward 90"),
    ("Plane(point: (200, 100, 90), dip_deg: 30, dip_direction_deg: 90)", "Raster(file: \"rising.asc\")", "\"rising.asc\"", Warning, "slide `slide`: the failure surface dips into the hill, toward 270 degrees; the ground falls toward 90"),
    ("dip_deg: 30", "dip_deg: -30", "-30", Error, "dip must be in [0, 90) degrees, found -30; write 30 with dip_direction_deg: 270"),
    ("dip_deg: 30", "dip_deg: 0.52", "0.52", Warning, "failure plane: dip is 0.52 degrees, nearly level; 0.52 rad are 29.8 degrees"),
    ("dip_deg: 90, dip_direction_deg: 270", "dip_deg: -70, dip_direction_deg: 90", "-70", Error, "slide `slide`: joint set 0: dip must be in [0, 90] degrees, found -70; write 70 with dip_direction_deg: 270"),
    ("dip_deg: 90, dip_direction_deg: 270", "dip_deg: 1.22, dip_direction_deg: 90", "1.22", Warning, "slide `slide`: joint set 0: dip is 1.22 degrees, nearly level; 1.22 rad are 69.9 degrees"),
    ("dip_deg: 90, dip_direction_deg: 270", "dip_deg: 90, dip_direction_deg: 400", "400", Warning, "slide `slide`: joint set 0: dip direction is 400 degrees, more than a full turn"),
    ("spacing: 60", "spacing: 60, persistence: 80", "80", Error, "slide `slide`: joint set 0: persistence must be in [0, 1], found 80"),
    ("spacing: 60", "spacing: 60000, origin: (0, 0, 0)", "[(dip_deg: 90", Warning, "`slide` is a single block: no joint crosses it, the closest spacing is 60000 m"),
    ("spacing: 60", "spacing: 0", "0", Error, "slide `slide`: joint set 0: spacing must be > 0, found 0"),
    ("point: (200, 100, 90)", "point: (200, 100, 400)", "Plane(", Error, "the failure surface is nowhere below the terrain within the outline"),
    ("Corners([(100, 60), (200, 60), (200, 140), (100, 140)])", "[(100, 60), (200, 60), (200, 140), (100, 140)]", "[", Error, "`outline` does not say which kind it is before `[`; such as Corners(["),
    ("Corners([(100, 60), (200, 60)", "Corners([(1000, 60), (2000, 60)", "Corners", Error, "its corner at (1000.00, 60.00) m is not within the terrain"),
    ("x: 340", "x: 20", "20", Warning, "gauge `near` is on land 150.000 m above the water, which is"),
    ("from: (340, 100), to: (250, 100)", "from: (90, 100), to: (30, 100)", "(90, 100)", Warning, "gauge `shore` is on land"),
    ("position: (345, 100, 35)", "position: (250, 100, 35)", "(250, 100, 35)", Warning, "gauge `v` at (250.0, 100.0, 35.0) is inside block `ground`; move it into the water; the nearest water is at (3"),
    ("seed: (345, 100, 35)", "seed: (20, 100, 35)", "(20, 100, 35)", Error, "fluid region `lake` has its seed [20.0, 100.0, 35.0] m inside block `ground`"),
];

/// Maps in other systems and units.
#[rustfmt::skip] // one row a line
const MAPS: &[Row] = &[
    ("\"slope.asc\"", "\"degrees.asc\"", "\"degrees.asc\"", Error, "`degrees.asc`: is in degrees, terrain is in meters; project it: gdalwarp -s_srs EPSG:4326 -t_srs EPSG:32632 in out.tif"),
    ("\"slope.asc\"", "\"etrs.asc\"", "\"etrs.asc\"", Error, "`etrs.asc`: is in degrees of EPSG:4258 (ETRS89), terrain is in meters; project it: gdalwarp -t_srs EPSG:32632 in out.tif"),
    ("\"slope.asc\"", "\"feet.asc\"", "\"feet.asc\"", Error, "`feet.asc`: has a plan in units of 0.304801 m, EPSG:2230 (NAD83 / California zone 6 (ftUS)); project it to meters with gdalwarp -t_srs"),
    ("\"slope.asc\"", "\"torn.asc\"", "\"torn.asc\"", Error, "`torn.prj`: is no well-known text of a reference system; export it again, or remove it and name the system with `crs`"),
    ("(file: \"slope.asc\")", "(file: \"zone32.asc\"), (file: \"zone33.asc\")", "\"zone33.asc\"", Error, "`zone33.asc` is in EPSG:25833 (ETRS89 / UTM zone 33N), `zone32.asc` in EPSG:25832 (ETRS89 / UTM zone 32N); project it: gdalwarp -t_srs EPSG:25832 in out.tif"),
    ("(file: \"slope.asc\")]", "(file: \"zone32.asc\")], crs: \"EPSG:25833\"", "\"zone32.asc\"", Error, "`zone32.asc` is in EPSG:25832 (ETRS89 / UTM zone 32N), the terrain in EPSG:25833"),
    ("(file: \"slope.asc\")]", "(file: \"slope.asc\")], crs: \"EPSG:4326\"", "\"EPSG:4326\"", Error, "EPSG:4326 (WGS 84) is not in meters; project the sources, to a zone of UTM say, and write its code"),
    ("(file: \"slope.asc\")]", "(file: \"slope.asc\")], crs: \"UTM 33\"", "\"UTM 33\"", Error, "`UTM 33` is no coordinate reference system; write \"EPSG:25833\", or the text of a .prj file"),
    ("Corners([(100, 60), (200, 60), (200, 140), (100, 140)])", "File(\"holed.geojson\")", "File(", Error, "`holed.geojson`: feature 1: has a polygon of 2 rings; one without holes is needed"),
    ("Corners([(100, 60), (200, 60), (200, 140), (100, 140)])", "File(\"three.csv\")", "File(", Error, "`three.csv`: line 3: found 3 columns, the header has 2; decimal commas need semicolons between columns"),
    ("SurfaceElevation(name: \"near\", x: 340, y: 100)", "FromFile(file: \"zone33.geojson\", kind: SurfaceElevation)", "\"zone33.geojson\"", Error, "`zone33.geojson`: `zone33_1` is a line or a polygon, a gauge of kind SurfaceElevation needs points"),
    ("SurfaceElevation(name: \"near\", x: 340, y: 100)", "FromFile(file: \"far.csv\", kind: SurfaceElevation)", "\"far.csv\"", Error, "gauge `ferry` at (5000.0, 100.0, -50.0) is outside of the domain"),
    ("SurfaceElevation(name: \"near\", x: 340, y: 100)", "FromFile(file: \"lonlat.csv\", kind: SurfaceElevation)", "\"lonlat.csv\"", Error, "`lonlat.csv`: line 1: columns lon, lat are in degrees; project them: x, y in meters"),
    ("SurfaceElevation(name: \"near\", x: 340, y: 100)", "OnMap(SurfaceElevation(name: \"near\", x: 34000, y: 100))", "34000", Error, "gauge `near` at (34000.0, 100.0, -50.0) is outside of the domain"),
    ("\"slope.asc\"", "\"empty.tif\"", "\"empty.tif\"", Error, "`empty.tif`: is not a readable GeoTIFF: "),
];

/// Outlines and gauges in another system than the terrain, EPSG:25832.
#[rustfmt::skip] // one row a line
const SYSTEMS: &[Row] = &[
    ("Corners([(100, 60), (200, 60), (200, 140), (100, 140)])", "File(\"zone33.geojson\")", "File(", Error, "`zone33.geojson` is in EPSG:25833 (ETRS89 / UTM zone 33N), `zone32.asc` in EPSG:25832 (ETRS89 / UTM zone 32N); project it: ogr2ogr -t_srs EPSG:25832 out.geojson in"),
    ("SurfaceElevation(name: \"near\", x: 340, y: 100)", "FromFile(file: \"points33.geojson\", kind: SurfaceElevation)", "\"points33.geojson\"", Error, "`points33.geojson` is in EPSG:25833 (ETRS89 / UTM zone 33N), the terrain in EPSG:25832 (ETRS89 / UTM zone 32N); project it: ogr2ogr -t_srs EPSG:25832 out.geojson in"),
];

/// Axis-aligned boxes as an OBJ file.
fn boxes(path: &Path, boxes: &[[f64; 6]]) {
    let mut text = String::new();
    for (k, &[x0, y0, z0, x1, y1, z1]) in boxes.iter().enumerate() {
        for [x, y, z] in [
            [x0, y0, z0],
            [x0, y0, z1],
            [x0, y1, z0],
            [x0, y1, z1],
            [x1, y0, z0],
            [x1, y0, z1],
            [x1, y1, z0],
            [x1, y1, z1],
        ] {
            writeln!(text, "v {x} {y} {z}").unwrap();
        }
        for face in [
            [1, 2, 4, 3],
            [5, 7, 8, 6],
            [1, 5, 6, 2],
            [3, 4, 8, 7],
            [1, 3, 7, 5],
            [2, 6, 8, 4],
        ] {
            let [a, b, c, d] = face.map(|corner: usize| corner + 8 * k);
            writeln!(text, "f {a} {b} {c} {d}").unwrap();
        }
    }
    std::fs::write(path, text).unwrap();
}

/// Meshes, and a raster of ground that falls along x to a lake between higher rims.
fn files(folder: &Path) {
    boxes(&folder.join("one.obj"), &[[0.0, 0.0, 0.0, 0.5, 0.5, 0.5]]);
    boxes(
        &folder.join("mm.obj"),
        &[[0.0, 0.0, 0.0, 500.0, 500.0, 500.0]],
    );
    let first = [0.0, 0.0, 0.0, 0.5, 0.5, 0.5];
    boxes(
        &folder.join("two.obj"),
        &[first, [0.4, 0.0, 0.0, 0.9, 0.5, 0.5]],
    );
    boxes(
        &folder.join("nested.obj"),
        &[first, [0.1, 0.1, 0.1, 0.4, 0.4, 0.4]],
    );
    boxes(
        &folder.join("adjoining.obj"),
        &[first, [0.5, 0.0, 0.0, 0.9, 0.5, 0.5]],
    );
    raster(&folder.join("slope.asc"), [0.0, 0.0], 5.0);
    // a failure surface that rises along x
    let row = "40 80 120\n";
    let rising = format!("ncols 3\nnrows 2\nxllcenter 0\nyllcenter 0\ncellsize 200\n{row}{row}");
    std::fs::write(folder.join("rising.asc"), rising).unwrap();
    maps(folder);
}

/// The raster with its first point and its cells elsewhere.
fn raster(path: &Path, [x, y]: [f64; 2], cell: f64) {
    let mut text = format!(
        "ncols 81\nnrows 41\nxllcenter {x}\nyllcenter {y}\ncellsize {cell}\nNODATA_value -9999\n"
    );
    for j in 0..41 {
        for i in 0..81 {
            let (x, y) = (5.0 * f64::from(i), 5.0 * f64::from(j));
            let along = (200.0 - 0.5 * x).max(3.0 * (x - 340.0));
            let across = (3.0 * ((y - 100.0).abs() - 80.0)).max(0.0);
            write!(text, "{} ", along + across).unwrap();
        }
        text.push('\n');
    }
    std::fs::write(path, text).unwrap();
}

/// The raster in other systems.
fn maps(folder: &Path) {
    let prj = |code| Crs::of_epsg(code).unwrap().wkt;
    raster(&folder.join("degrees.asc"), [7.0, 62.0], 1e-4);
    let torn = prj(25_833).replace(']', "");
    for (name, wkt) in [
        ("etrs", prj(4258)),
        ("feet", prj(2230)),
        ("zone32", prj(25_832)),
        ("zone33", prj(25_833)),
        ("torn", torn),
    ] {
        let file = folder.join(name);
        let (corner, cell) = match name {
            "etrs" => ([7.0, 62.0], 1e-4),
            _ => ([0.0; 2], 5.0),
        };
        raster(&file.with_extension("asc"), corner, cell);
        std::fs::write(file.with_extension("prj"), wkt).unwrap();
    }
    let ring = "[[100, 60], [200, 60], [200, 140], [100, 140], [100, 60]]";
    let of = |crs: &str, rings: &str| {
        format!(
            r#"{{"type": "FeatureCollection", {crs} "features": [{{"type": "Feature", "properties": {{}},
                "geometry": {{"type": "Polygon", "coordinates": [{rings}]}}}}]}}"#
        )
    };
    let zone = r#""crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::25833"}},"#;
    for (file, text) in [
        ("holed.geojson", of("", &format!("{ring}, {ring}"))),
        ("zone33.geojson", of(zone, ring)),
        (
            "points33.geojson",
            of(zone, ring)
                .replace("Polygon", "MultiPoint")
                .replace("[[[", "[[")
                .replace("]]]", "]]"),
        ),
        (
            "furlongs.csv",
            "time [s],x [furlong],y,z\n0,0,0,0\n1,1,0,0\n".to_owned(),
        ),
        ("three.csv", "x,y\n100,60\n200,5,60\n".to_owned()),
        ("far.csv", "name;E;N\nferry;5000;100\n".to_owned()),
        ("lonlat.csv", "name,lon,lat\nquay,7,62\n".to_owned()),
    ] {
        std::fs::write(folder.join(file), text).unwrap();
    }
    std::fs::write(folder.join("empty.tif"), b"II*\0\0\0\0\0").unwrap();
}

/// Answers to a scene.
fn answers(folder: &Path, text: &str) -> Vec<Located> {
    let found = load_text("scene.ron", text, &[], &Access::of(folder));
    let (Ok((_, error)) | Err(error)) = found;
    error.located().to_vec()
}

fn check(folder: &Path, right: &str, rows: &[Row]) -> Vec<String> {
    let mut missed = Vec::new();
    for &(from, to, at, severity, words) in rows {
        assert!(right.contains(from), "{from}");
        let text = right.replacen(from, to, 1);
        let found = answers(folder, &text);
        let is_answered = matches!(found.as_slice(), [one] if one.severity == severity
            && one.message.starts_with(words)
            && one.message.chars().count() <= TWO_LINES
            && guide::paragraphs(one.code).len() > 2
            && text[one.span.clone()].starts_with(at));
        if !is_answered {
            let said = found.iter().map(|one| {
                format!(
                    "{:?} at `{}`: {}",
                    one.severity,
                    &text[one.span.clone()],
                    one.message
                )
            });
            let said: Vec<String> = said.collect();
            missed.push(format!(
                "{to}\n  expected {severity:?} at `{at}`: {words}\n  found {said:#?}"
            ));
        }
    }
    missed
}

/// Each mistake is answered once, where it is, in at most two lines.
#[test]
fn mistakes_are_answered_in_their_place() {
    let folder = tempfile::tempdir().unwrap();
    files(folder.path());
    let in_zone_32 = SLOPE.replace("slope.asc", "zone32.asc");
    let tables = [
        (TANK, WRITING),
        (TANK, UNITS),
        (TANK, PLACES),
        (SLOPE, HILL),
        (SLOPE, MAPS),
        (&in_zone_32, SYSTEMS),
    ];
    let missed: Vec<String> = (tables.iter())
        .flat_map(|(right, rows)| check(folder.path(), right, rows))
        .collect();
    assert_none_missed(&missed);
}

fn assert_none_missed(missed: &[String]) {
    assert!(
        missed.is_empty(),
        "{} missed:\n{}",
        missed.len(),
        missed.join("\n")
    );
}

/// The scenes without a mistake, and edits that look like one, pass without a word.
#[test]
fn right_scenes_pass_without_a_word() {
    let folder = tempfile::tempdir().unwrap();
    files(folder.path());
    for (right, from, to) in [
        (TANK, "tank", "tank"),
        (SLOPE, "slope", "slope"),
        (TANK, "friction_angle_deg: 31", "friction_angle_deg: 0"),
        (TANK, "friction_angle_deg: 31", "friction_angle_deg: 1"),
        (TANK, "domain: (", "gravity: (0, 0, 0), domain: ("),
        (TANK, "domain: (", "gravity: (1.5, 0, -9.7), domain: ("),
        (TANK, "density: 2650", "density: 500"),
        (TANK, "density: 2650", "density: 2_650"),
        (TANK, "density: 2650", "density: \"2650 kg/m3\""),
        (
            TANK,
            CUBE,
            "Mesh(file: \"adjoining.obj\", scale: 1), placement: (translate: (2, 0.3, 0))",
        ),
        (TANK, "x: 0.5", "x: 2.5"),
        (
            SLOPE,
            "dip_deg: 90, dip_direction_deg: 270",
            "dip_deg: 1, dip_direction_deg: -90",
        ),
        (SLOPE, "dip_deg: 30", "dip_deg: 0"),
        (SLOPE, "slope.asc", "zone32.asc"),
        (
            SLOPE,
            "[(file: \"slope.asc\")]",
            "[(file: \"slope.asc\")], crs: \"EPSG:25833\"",
        ),
    ] {
        let text = right.replacen(from, to, 1);
        let found = answers(folder.path(), &text);
        assert!(found.is_empty(), "{to}: {found:?}");
    }
}
