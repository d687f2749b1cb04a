//! Way of the wave: from the slide over the water to the opposite shore.

use super::super::GRAVITY;
use super::super::survey::Survey;

/// Turns of the way from the dip direction, the first that meets water counts; degrees.
const TURNS: [f64; 11] = [
    0.0, 10.0, -10.0, 20.0, -20.0, 30.0, -30.0, 45.0, -45.0, 60.0, -60.0,
];
/// Water wider than this is taken as open; × its depth.
const OPEN: f64 = 20.0;
/// Steps of the way; × cell.
const STEP: f64 = 0.5;

/// Straight way from the slide over the water, on the map.
#[derive(Clone, Debug)]
pub(super) struct Crossing {
    /// Where the way meets the water; m.
    pub shore: [f64; 2],
    /// Direction.
    pub along: [f64; 2],
    /// Length over the water; m.
    pub length: f64,
    /// Distances from the shore to the opposite one and to a height above the water (m), `None` if the water is open.
    pub opposite: Option<Opposite>,
    /// Largest depth on the way; m.
    pub depth: f64,
    /// Place of that depth; m.
    pub deepest: [f64; 2],
    /// Travel time of a long wave at the mean depth, `L/√(g h)`; s.
    pub travel: f64,
}

/// Land across the water.
#[derive(Clone, Copy, Debug)]
pub(super) struct Opposite {
    /// Distance from the near shore to the end of the way up the land; m.
    pub end: f64,
}

impl Crossing {
    /// Place at a distance from the shore (m); m.
    pub fn at(&self, distance: f64) -> [f64; 2] {
        [0, 1].map(|axis| self.shore[axis] + distance * self.along[axis])
    }
}

/// Way from a point in a direction over water below a level (m), and up the opposite shore to a height above it (m).
///
/// # Errors
///
/// A message if there is no water ahead.
pub(super) fn crossing(
    survey: &Survey,
    from: [f64; 2],
    along: [f64; 2],
    (level, height): (f64, f64),
) -> Result<Crossing, String> {
    let turned = |turn: &f64| {
        let (sin, cos) = turn.to_radians().sin_cos();
        [
            cos * along[0] - sin * along[1],
            sin * along[0] + cos * along[1],
        ]
    };
    let mut ways = TURNS.iter().map(turned);
    let way = ways.find_map(|along| over_water(survey, from, along, (level, height)));
    way.ok_or_else(|| {
        format!(
            "no ground below {level} m lies ahead of the slide within the elevations; --level is the elevation of the still water on the map; \
             are land and bed in two files, give both, --dem LAND --dem BED"
        )
    })
}

fn over_water(
    survey: &Survey,
    from: [f64; 2],
    along: [f64; 2],
    (level, height): (f64, f64),
) -> Option<Crossing> {
    let step = STEP * survey.cell;
    let at = |k: u32| [0, 1].map(|axis| from[axis] + f64::from(k) * step * along[axis]);
    let ground = |k: u32| survey.height(at(k));
    let is_wet = |k: u32| ground(k).map(|z| z < level);
    // a puddle of one cell is no water
    let first = (0..)
        .map_while(|k| Some((k, is_wet(k)?)))
        .find(|&(k, wet)| wet && is_wet(k + 2) == Some(true))?
        .0;
    let mut found = Crossing {
        shore: at(first),
        along,
        length: 0.0,
        opposite: None,
        depth: 0.0,
        deepest: at(first),
        travel: 0.0,
    };
    let (mut k, mut sum) = (first, 0.0);
    while let Some(z) = ground(k).filter(|z| *z < level) {
        let depth = level - z;
        if found.depth < depth {
            (found.depth, found.deepest) = (depth, at(k));
        }
        k += 1;
        sum += depth;
        found.length = f64::from(k - first) * step;
        found.travel = found.length / (GRAVITY * sum / f64::from(k - first)).sqrt();
        if OPEN * found.depth.max(step) < found.length {
            return Some(found);
        }
    }
    // land, unless the elevations end here
    ground(k)?;
    let top = (k..)
        .take_while(|&k| ground(k).is_some())
        .find(|&k| ground(k).is_some_and(|z| level + height < z));
    let top = top.unwrap_or_else(|| {
        (k..)
            .take_while(|&k| ground(k).is_some())
            .last()
            .unwrap_or(k)
    });
    found.opposite = Some(Opposite {
        end: f64::from(top - first) * step,
    });
    Some(found)
}
