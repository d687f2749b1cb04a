//! The scene of a slope above water, as text.

use super::super::digits::{rounded, significant};
use super::failure::DipFrom;
use super::layout::DENSITY;
use super::{Reason, Sheet};

/// Blocks that the joints make of the rock, about.
const BLOCKS: f64 = 50.0;
/// Widest gap in the elevations that is filled; × their spacing.
const GAP: f64 = 10.0;
/// Places of the gauges on the way of the wave; × its length.
const GAUGES: [(&str, f64); 3] = [("near", 0.15), ("middle", 0.5), ("far", 0.85)];

/// The scene.
pub(super) fn scene(sheet: &Sheet, reason: Reason) -> String {
    [
        head(sheet),
        ground(sheet),
        slide(sheet),
        water(sheet, reason),
        records(sheet),
    ]
    .concat()
}

/// The scene without its slide, to estimate the share of the water in the run time.
pub(super) fn scene_of_water(sheet: &Sheet) -> String {
    [
        head(sheet),
        ground(sheet),
        water(sheet, Reason::Rows),
        records(sheet),
    ]
    .concat()
}

/// What was chosen, in a few lines for the terminal.
pub(super) fn summary(sheet: &Sheet, reason: Reason) -> String {
    let Sheet {
        failure, layout, ..
    } = sheet;
    let time = match reason {
        Reason::Time(minutes) => format!(
            "a run takes about {} min on this machine",
            significant(minutes, 2)
        ),
        Reason::Stated => "spacing as stated".to_owned(),
        Reason::Rows => "run time unknown".to_owned(),
    };
    format!(
        "rock: {:.2e} m3, {:.0} m thick, on a plane of {} degrees toward {}\n\
         water: {:.0} m deep, {:.0} m across; first crest about {:.0} m; spacing {} m, {time}",
        failure.volume,
        failure.thickness,
        failure.dip,
        failure.dip_direction,
        layout.crossing.depth,
        layout.crossing.length,
        layout.crest,
        layout.spacing
    )
}

fn head(sheet: &Sheet) -> String {
    let Sheet { survey, layout, .. } = sheet;
    let names = survey.names.join(" and ");
    let [low, high] = layout.domain.map(|[x, y, z]| format!("({x}, {y}, {z})"));
    let (symmetry, sides) = if layout.wet.is_empty() {
        (
            String::new(),
            "    // the basin is closed within them\n".to_owned(),
        )
    } else {
        let sides = layout.wet.join(", ");
        (
            format!(", symmetry: [{sides}]"),
            "    // water meets the sides under `symmetry`: mirrors there, from which waves come back; `absorbers` damp them\n".to_owned(),
        )
    };
    let far = match layout.crossing.opposite {
        Some(_) => format!(
            "to land {:.0} m above the opposite shore, three times the first crest",
            layout.land
        ),
        None => "to open water".to_owned(),
    };
    format!(
        r#"// A rock slope above water, from {names}; written by `riprap new slope`.
//
// Lengths in meters, angles in degrees; x east, y north, z up from the still water. Each choice has its reason beside it: edit what
// you know better. Then `riprap check` for model and cost, `riprap run` to run it.
(
    title: "Rock slope above water",
    // from behind the rock {far}; to either side half as far as the water is wide
{sides}    domain: (min: {low}, max: {high}{symmetry}),
"#
    )
}

fn ground(sheet: &Sheet) -> String {
    let Sheet {
        survey,
        failure,
        layout,
        ..
    } = sheet;
    let [x, y, z] = layout.origin;
    let clip = layout.clip.map_or(String::new(), |[low, high]| {
        format!(
            "\n        // the elevations around the domain; the files hold more\n        clip: (({}, {}), ({}, {})),",
            low[0], low[1], high[0], high[1]
        )
    });
    let gaps = if layout.has_gaps {
        format!(
            "\n        // some elevations are missing: filled from around them\n        gaps: Filled({}),",
            GAP * layout.cell
        )
    } else {
        String::new()
    };
    format!(
        r#"    // intact rock; {friction} degrees of friction let it slide on a plane of {dip}: rapid slides have 10 to 25
    materials: [(name: "rock", density: {DENSITY}, friction_angle_deg: {friction}, restitution: 0.5)],
    terrain: (
        sources: [{sources}],
        // easting, northing and elevation of x = y = z = 0: z = 0 is the still water
        origin: ({x}, {y}, {z}),{clip}{gaps}
    ),
    blocks: [(name: "ground", material: "rock", motion: Fixed, shape: Terrain)],
"#,
        friction = layout.friction,
        dip = failure.dip,
        sources = survey.sources(),
    )
}

fn slide(sheet: &Sheet) -> String {
    let Sheet {
        outline,
        failure,
        layout,
        ..
    } = sheet;
    let [px, py] = layout.of_map([failure.point[0], failure.point[1]]);
    let pz = rounded(failure.point[2] - layout.origin[2], 1);
    let point = format!("({px}, {py}, {pz})");
    let why = match failure.dip_from {
        DipFrom::Stated => "as steep as stated".to_owned(),
        DipFrom::StatedVolume => "as steep as the stated volume demands".to_owned(),
        DipFrom::Area => format!(
            "as steep as the mean volume of landslides of {} m2 demands, 0.074 A^1.45\n        \
             // (Guzzetti et al. 2009), within a factor of 3: state --dip, --volume or --thickness if you know better",
            significant(failure.area, 2)
        ),
    };
    let joints = Joints::of(sheet);
    let [sx, sy] = layout.of_map(failure.side);
    format!(
        r#"    slides: [(
        name: "slide",
        material: "rock",
        // in map coordinates
        outline: File({outline:?}),
        // daylights at the toe of the outline and dips the way the ground along it does (at {ground:.0} degrees);
        // {why}:
        // {volume:.2e} m3, {thickness:.0} m thick on average
        failure_surface: Plane(point: {point}, dip_deg: {dip}, dip_direction_deg: {direction}),
        // about {BLOCKS} blocks: joints parallel to the plane, steep ones behind, and upright ones along the dip that begin at
        // the side of the outline, so that no thin blocks remain there; your own sets will differ
        joint_sets: [
            (dip_deg: {dip}, dip_direction_deg: {direction}, spacing: {thick}, origin: {point}),
            (dip_deg: {steep}, dip_direction_deg: {back}, spacing: {long}, origin: {point}),
            (dip_deg: 90, dip_direction_deg: {across}, spacing: {wide}, origin: ({sx}, {sy}, {pz})),
        ],
        // a tenth of a mean block: smaller ones hold a hundredth of the rock, and would make the time steps shorter
        minimum_volume: {least},
    )],
"#,
        ground = failure.ground_dip,
        volume = failure.volume,
        thickness = failure.thickness,
        dip = failure.dip,
        direction = failure.dip_direction,
        thick = joints.thick,
        long = joints.long,
        wide = joints.wide,
        steep = rounded(90.0 - 0.5 * failure.dip, 0),
        back = (failure.dip_direction + 180.0) % 360.0,
        across = (failure.dip_direction + 90.0) % 360.0,
        least = significant(0.1 * failure.volume / BLOCKS, 2),
    )
}

/// Spacings of the joint sets: across the plane, along the dip, and across the dip; m.
struct Joints {
    thick: f64,
    long: f64,
    wide: f64,
}

impl Joints {
    /// Blocks as thick as the rock, or as long as thick, in whole columns across the slide.
    fn of(sheet: &Sheet) -> Self {
        let failure = &sheet.failure;
        let block = failure.volume / BLOCKS;
        let thick = failure.thickness.min(block.cbrt());
        let long = (block / thick).sqrt();
        let columns = (failure.width / long).round().max(1.0);
        Self {
            thick: significant(thick, 2),
            long: significant(long, 2),
            wide: significant(failure.width / columns, 6),
        }
    }
}

fn water(sheet: &Sheet, reason: Reason) -> String {
    let layout = &sheet.layout;
    let rows = layout.crossing.depth / layout.spacing;
    let why = match reason {
        Reason::Stated => "as stated".to_owned(),
        Reason::Time(minutes) => format!(
            "for a run of about {} min on the machine that wrote this",
            significant(minutes, 2)
        ),
        Reason::Rows => "a first guess".to_owned(),
    };
    let [x, y] = layout.of_map(layout.crossing.deepest);
    format!(
        r#"    fluid: (
        // {rows:.1} of them in the depth of {depth:.0} m, {why};
        // half of it takes about ten times as long
        resolution: Spacing({spacing}),
        // the arrangement in which deep water stays at rest
        lattice: Staggered,
        // all that is connected to the deepest point ahead of the slide
        regions: [(name: "water", shape: Below(level: 0, seed: ({x}, {y}, {z})))],
    ),
    // the rock meets the water at about this speed, sliding from rest; the speed of sound is ten times that
    numerics: (expected_speed: {speed}),
    // the water settles for three times the square root of depth over gravity; the rock takes {slide:.0} s to the shore, the wave
    // {travel:.0} s across, then runs up
    time: (settle: {settle}, duration: {duration}),
"#,
        depth = layout.crossing.depth,
        spacing = layout.spacing,
        z = rounded(-0.5 * layout.crossing.depth, 1),
        speed = layout.speed,
        slide = layout.slide_time,
        travel = layout.crossing.travel,
        settle = layout.settle,
        duration = layout.duration,
    )
}

fn records(sheet: &Sheet) -> String {
    let Sheet { survey, layout, .. } = sheet;
    let way = &layout.crossing;
    let is_wet = |place: [f64; 2]| survey.height(place).is_some_and(|z| z < layout.origin[2]);
    let points = GAUGES.iter().filter_map(|(name, share)| {
        let place = way.at(share * way.length);
        let [x, y] = layout.of_map(place);
        is_wet(place)
            .then(|| format!("        SurfaceElevation(name: {name:?}, x: {x}, y: {y}),\n"))
    });
    let points: String = points.collect();
    let run_up = way.opposite.map_or(String::new(), |opposite| {
        let [[x0, y0], [x1, y1]] = [0.9 * way.length, opposite.end].map(|s| layout.of_map(layout.within(way.at(s))));
        format!("        // from the water up the opposite shore\n        RunUp(name: \"opposite\", from: ({x0}, {y0}), to: ({x1}, {y1})),\n")
    });
    format!(
        r#"    // highest water, first arrival and depth on land, as rasters in map coordinates
    maps: (),
    gauges: [
        // on the way of the wave
{points}{run_up}    ],
)
"#
    )
}
