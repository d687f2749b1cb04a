//! Boulders released on the user's terrain.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::digits::{down_to, rounded, significant, up_to};
use super::survey::Survey;
use super::{Draft, GRAVITY, Target};

/// Line from the start, below the horizontal, beyond which boulders do not get: the least inclination that Onofri & Candian (1979)
/// found; degrees.
const ENERGY_LINE: f64 = 28.5;
/// Ground on both sides of the path; × its length.
const ASIDE: f64 = 0.3;
/// Mean speed of a boulder on its way; × that of a free fall over the drop.
const SLOWED: f64 = 0.3;
/// Boulders of a row across the slope, and their distance; × size.
const ROW: u32 = 5;
const APART: f64 = 3.0;
/// Steps of the path; × cell.
const STEP: f64 = 0.5;
/// Longest path; steps.
const MOST_STEPS: usize = 100_000;

/// Write the scene of boulders released on terrain.
#[derive(Debug, clap::Args)]
pub(super) struct Options {
    #[command(flatten)]
    pub target: Target,
    /// Elevations; may be repeated, the first with a value counts.
    #[arg(long, required = true, value_name = "FILE")]
    dem: Vec<PathBuf>,
    /// Place of release on the map, X,Y; m.
    #[arg(
        long,
        value_name = "X,Y",
        value_delimiter = ',',
        num_args = 1,
        required = true,
        allow_negative_numbers = true
    )]
    from: Vec<f64>,
    /// Number of boulders.
    #[arg(long, value_name = "N", default_value_t = 10)]
    count: u32,
    /// Edge of a boulder; m.
    #[arg(long, value_name = "M", default_value_t = 1.0)]
    size: f64,
}

/// Way down from the place of release, on the map.
struct Descent {
    /// m.
    places: Vec<[f64; 2]>,
    /// Direction of the steepest descent at the start.
    along: [f64; 2],
    /// Elevation of the start over the end; m.
    drop: f64,
    /// In plan view; m.
    length: f64,
}

/// Domain of a scene.
struct Layout {
    /// Map coordinates of x = y = z = 0; m.
    origin: [f64; 3],
    /// Lower and upper corner; m.
    domain: [[f64; 3]; 2],
    has_gaps: bool,
}

pub(super) fn draft(options: &Options, path: &Path) -> Result<Draft, String> {
    let Options { count, size, .. } = *options;
    let &[x, y] = options.from.as_slice() else {
        return Err("--from must be the easting and the northing of the release, such as --from 412000,6904000".into());
    };
    if !(0.0 < size && size.is_finite() && (1..=1000).contains(&count)) {
        return Err(format!(
            "--size must be above 0 and --count 1 to 1000, got {size} and {count}"
        ));
    }
    let survey = Survey::read(&options.dem, path)?;
    let descent = descent(&survey, [x, y], size)?;
    let places = release(&survey, &descent, options);
    let places = places
        .ok_or("the elevations end at the place of release; move --from, or lower --count")?;
    let layout = layout(&survey, &descent, (&places, size));
    Ok(Draft {
        scene: scene(&survey, &descent, &layout, (&places, size)),
        beside: Vec::new(),
        notes: vec![format!(
            "path: {:.0} m long, {:.0} m down, to where a line of {ENERGY_LINE} degrees from the release meets the ground",
            descent.length, descent.drop
        )],
    })
}

/// Steepest descent from a place, straight on where the ground is level, down to the energy line or to the end of the elevations.
fn descent(survey: &Survey, from: [f64; 2], size: f64) -> Result<Descent, String> {
    let [x, y] = from;
    let [low, high] = survey.extent;
    let top = survey.height(from).ok_or_else(|| {
        format!(
            "there is no elevation at ({x}, {y}); --from is in map coordinates, and the elevations reach from ({:.1}, {:.1}) to ({:.1}, {:.1})",
            low[0], low[1], high[0], high[1]
        )
    })?;
    let step = STEP * survey.cell;
    let steepness = ENERGY_LINE.to_radians().tan();
    let mut found = Descent {
        places: vec![from],
        along: [0.0; 2],
        drop: 0.0,
        length: 0.0,
    };
    let (mut at, mut along) = (from, [0.0; 2]);
    while found.places.len() < MOST_STEPS {
        let Some(slope) = slope(survey, at) else {
            break;
        };
        // the way so far counts as well: a boulder does not follow every furrow
        let turned = [0, 1].map(|axis| along[axis] - slope[axis]);
        let norm = turned[0].hypot(turned[1]);
        if norm < 1e-9 {
            break;
        }
        along = turned.map(|share| share / norm);
        if found.places.len() == 1 {
            found.along = along;
        }
        at = [0, 1].map(|axis| at[axis] + step * along[axis]);
        let Some(z) = survey.height(at) else { break };
        found.places.push(at);
        found.length += step;
        found.drop = top - z;
        let straight = (at[0] - x).hypot(at[1] - y);
        // the first steps may be on a brink
        if 20.0 * step < found.length && found.drop < steepness * straight {
            break;
        }
    }
    if found.length < 10.0 * size || found.drop < steepness * size {
        return Err(format!(
            "boulders would not go far from ({x}, {y}): the ground falls by {:.1} m in {:.0} m; choose a steeper place with --from",
            found.drop, found.length
        ));
    }
    Ok(found)
}

/// Slope of the ground over two cells; –.
fn slope(survey: &Survey, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
    let h = survey.cell;
    let along_x = survey.height([x + h, y])? - survey.height([x - h, y])?;
    let along_y = survey.height([x, y + h])? - survey.height([x, y - h])?;
    Some([along_x / (2.0 * h), along_y / (2.0 * h)])
}

/// Centers of the boulders on the map, in rows across the slope, clear of the ground; m.
fn release(survey: &Survey, descent: &Descent, options: &Options) -> Option<Vec<[f64; 3]>> {
    let Options { count, size, .. } = *options;
    let [ux, uy] = descent.along;
    let row = ROW.min(count);
    let centers = (0..count).map(|k| {
        let across = APART * size * (f64::from(k % row) - 0.5 * f64::from(row - 1));
        let uphill = APART * size * f64::from(k / row);
        let [x, y] = descent.places[0];
        let (x, y) = (x - uy * across - ux * uphill, y + ux * across - uy * uphill);
        // half a diagonal of the boulder over the highest ground that it could touch
        let around = [-1.0, -0.5, 0.0, 0.5, 1.0].map(|share| share * size);
        let heights = around
            .iter()
            .flat_map(|dx| around.map(|dy| survey.height([x + dx, y + dy])));
        let highest = heights
            .collect::<Option<Vec<f64>>>()?
            .into_iter()
            .fold(f64::NEG_INFINITY, f64::max);
        Some([x, y, highest + size])
    });
    centers.collect()
}

fn layout(survey: &Survey, descent: &Descent, (boulders, size): (&[[f64; 3]], f64)) -> Layout {
    let margin = (ASIDE * descent.length).max(10.0 * size);
    let (mut low, mut high) = (survey.extent[0], survey.extent[1]);
    for axis in 0..2 {
        let places = descent.places.iter().map(|place| place[axis]);
        let places = places.chain(boulders.iter().map(|boulder| boulder[axis]));
        let (least, most) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        low[axis] = low[axis].max(least - margin);
        high[axis] = high[axis].min(most + margin);
    }
    let origin = [0, 1].map(|axis| down_to(descent.places[0][axis], 1.0));
    let (lowest, highest, has_gaps) = survey.range([low, high]);
    let datum = down_to(lowest, 10.0);
    let top = boulders
        .iter()
        .map(|boulder| boulder[2])
        .fold(highest, f64::max);
    let [low, high] =
        [low, high].map(|corner| [0, 1].map(|axis| rounded(corner[axis] - origin[axis], 1)));
    Layout {
        origin: [origin[0], origin[1], datum],
        domain: [
            [low[0], low[1], down_to(lowest - datum - 5.0 * size, 1.0)],
            [high[0], high[1], up_to(top - datum + 20.0 * size, 1.0)],
        ],
        has_gaps,
    }
}

/// One block per line, each turned and sized differently.
fn boulders(places: &[[f64; 3]], size: f64, origin: [f64; 3]) -> String {
    let mut text = String::new();
    for (k, place) in (0u32..).zip(places) {
        let [x, y, z] = [0, 1, 2].map(|axis| rounded(place[axis] - origin[axis], 2));
        // edges differ by a quarter, turns by the golden angle: no two alike, and the same each time
        let edge = |k: u32| significant(0.5 * size * (0.75 + 0.25 * f64::from(k % 3)), 3);
        let [a, b, c] = [edge(k), edge(k / 3), edge(k + 1)];
        let angle = rounded(137.5 * f64::from(k) % 360.0, 1);
        // writing to a string does not fail
        let _ = writeln!(
            text,
            "        (name: \"boulder_{:03}\", material: \"boulder\", shape: Box(min: (-{a}, -{b}, -{c}), max: ({a}, {b}, {c})),\n         \
             placement: (rotate: (axis: (1, 2, 3), angle_deg: {angle}), translate: ({x}, {y}, {z}))),",
            k + 1
        );
    }
    text
}

fn scene(
    survey: &Survey,
    descent: &Descent,
    layout: &Layout,
    (places, size): (&[[f64; 3]], f64),
) -> String {
    let Layout { origin, domain, .. } = layout;
    let [low, high] = domain.map(|[x, y, z]| format!("({x}, {y}, {z})"));
    let gaps = if layout.has_gaps {
        format!(
            ",\n        // some elevations are missing: filled from around them\n        gaps: Filled({})",
            10.0 * survey.cell
        )
    } else {
        String::new()
    };
    let [[x0, y0, _], [x1, y1, _]] = *domain;
    let time =
        descent.length.hypot(descent.drop) / (SLOWED * (2.0 * GRAVITY * descent.drop).sqrt());
    format!(
        r#"// Boulders released on terrain, from {names}; written by `riprap new rockfall`.
//
// Lengths in meters, angles in degrees; x east, y north, z up. Dry.
(
    title: "Rockfall",
    // the way of the steepest descent to where a line of {ENERGY_LINE} degrees from the release meets the ground, and {ASIDE} of its length
    // around it
    domain: (min: {low}, max: {high}),
    materials: [
        // a restitution of a third as on talus: soil has less, bare rock more
        (name: "ground", density: 2600, friction_angle_deg: 35, restitution: 0.33),
        (name: "boulder", density: 2700, friction_angle_deg: 33, restitution: 0.33),
    ],
    terrain: (
        sources: [{sources}],
        // easting, northing and elevation of x = y = z = 0
        origin: ({ox}, {oy}, {oz}),
        // no more ground than the domain
        clip: (({x0}, {y0}), ({x1}, {y1})){gaps},
    ),
    blocks: [
        (name: "ground", material: "ground", motion: Fixed, shape: Terrain),
        // {count} boulders of about {size} m in rows across the slope, clear of the ground; add your own, `Hull` and `Sphere` too
{boulders}    ],
    // the way down at {SLOWED} times the speed of a free fall from the release
    time: (duration: {duration}),
    // paths, bounce heights, speeds and energies over time, and one row per boulder
    trajectories: (),
)
"#,
        names = survey.names.join(" and "),
        sources = survey.sources(),
        ox = origin[0],
        oy = origin[1],
        oz = origin[2],
        count = places.len(),
        boulders = boulders(places, size, *origin),
        duration = up_to(time, 5.0),
    )
}
