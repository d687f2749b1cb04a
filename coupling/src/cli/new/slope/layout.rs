//! Domain, times and speeds of a slope above water.

use super::super::GRAVITY;
use super::super::digits::{down_to, rounded, significant, up_to};
use super::super::survey::{Survey, places};
use super::crossing::{Crossing, crossing};
use super::failure::{Failure, direction};
use crate::scene::geometry::terrain::outline::Outline;
use crate::scene::impulse_wave::SlideImpact;

/// Rows of particles in the depth before run times are known.
const ROWS: f64 = 6.0;
/// Friction of the failure plane: at most this (degrees), and this part of the tangent of its dip.
const FRICTION: f64 = 20.0;
const FRICTION_SHARE: f64 = 0.6;
/// Rock and water; kg/m³.
pub(super) const DENSITY: f64 = 2650.0;
const WATER: f64 = 1000.0;
/// Land kept above the water at the opposite shore; × first crest.
const RUN_UP: f64 = 3.0;
/// Width of the domain to either side of the way; × its length.
const ASIDE: f64 = 0.45;
/// Ground beyond the domain, which its sides need; × particle spacing.
const BEYOND: f64 = 4.0;
/// Time for run-up and return after the wave has crossed; × its travel time.
const AFTER: f64 = 0.4;
/// Settling time; × √(h/g).
const SETTLE: f64 = 3.0;

/// Domain, times and speeds.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    /// Map coordinates of x = y = z = 0.
    pub origin: [f64; 3],
    /// Lower and upper corner of the domain; m.
    pub domain: [[f64; 3]; 2],
    /// Sides that water meets.
    pub wet: Vec<&'static str>,
    /// Lower and upper corner of the ground in use, x and y, if the files hold much more; m.
    pub clip: Option<[[f64; 2]; 2]>,
    /// Whether elevations are missing in it.
    pub has_gaps: bool,
    /// Spacing of the elevations; m.
    pub cell: f64,
    pub crossing: Crossing,
    /// Height above the water up to which land is kept; m.
    pub land: f64,
    /// Particle spacing; m.
    pub spacing: f64,
    /// Friction angle; degrees.
    pub friction: f64,
    /// Expected speed of the rock at the water; m/s.
    pub speed: f64,
    /// First crest by empirical formulas; m.
    pub crest: f64,
    /// From the start until the rock's center is at the shore; s.
    pub slide_time: f64,
    /// s.
    pub settle: f64,
    /// s.
    pub duration: f64,
}

impl Layout {
    /// Place of the map in the scene; m.
    pub fn of_map(&self, place: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| rounded(place[axis] - self.origin[axis], 1))
    }

    /// Closest place on the map that is in the domain; m.
    pub fn within(&self, place: [f64; 2]) -> [f64; 2] {
        let [low, high] = self.domain;
        [0, 1].map(|axis| {
            let origin = self.origin[axis];
            place[axis].clamp(low[axis] + origin, high[axis] + origin)
        })
    }
}

/// Layout for a water level on the map (m) and a particle spacing (m), if that is stated.
///
/// # Errors
///
/// A message if the slide meets no water.
pub(super) fn layout(
    survey: &Survey,
    outline: &Outline,
    failure: &Failure,
    (level, spacing): (f64, Option<f64>),
) -> Result<Layout, String> {
    let center = [failure.center[0], failure.center[1]];
    let ahead = direction(failure.dip_direction);
    let over = |height: f64| crossing(survey, center, ahead, (level, height));
    let depth = over(0.0)?.depth;
    let (friction, speed) = motion(failure, level, depth);
    let crest = SlideImpact {
        speed,
        thickness: failure.thickness,
        width: failure.width,
        volume: failure.volume,
        slope: failure.dip.to_radians(),
        relative_density: DENSITY / WATER,
        depth,
        gravity: GRAVITY,
    }
    .first_crest();
    let spacing = spacing.unwrap_or_else(|| significant(depth / ROWS, 2));
    let land = RUN_UP * crest + 2.0 * spacing;
    let crossing = over(land)?;
    let plan = plan(survey, outline, &crossing, (failure, spacing));
    let grain = if plan[1][0] - plan[0][0] < 500.0 {
        1.0
    } else {
        10.0
    };
    let origin = [0, 1].map(|axis| up_to(0.5 * (plan[0][axis] + plan[1][axis]), grain));
    let low = [0, 1].map(|axis| up_to(plan[0][axis] - origin[axis], grain));
    let high = [0, 1].map(|axis| down_to(plan[1][axis] - origin[axis], grain));
    let (lowest, highest, _) = survey.range(plan);
    let bottom = down_to(lowest - level - spacing, grain);
    let top = up_to((highest - level).max(land) + spacing, grain);
    let on_map = |corner: [f64; 2]| [0, 1].map(|axis| corner[axis] + origin[axis]);
    let (clip, has_gaps) = clip(
        survey,
        [low, high],
        [on_map(low), on_map(high)],
        BEYOND * spacing,
    );
    let slide_time = slide_time(failure, friction, &crossing);
    Ok(Layout {
        origin: [origin[0], origin[1], level],
        domain: [[low[0], low[1], bottom], [high[0], high[1], top]],
        wet: wet_sides(survey, [on_map(low), on_map(high)], level),
        clip,
        has_gaps,
        cell: survey.cell,
        land,
        spacing,
        friction,
        speed: up_to(speed, 5.0),
        crest,
        slide_time,
        settle: up_to(SETTLE * (depth / GRAVITY).sqrt(), 1.0),
        duration: up_to(slide_time + (1.0 + AFTER) * crossing.travel, 5.0),
        crossing,
    })
}

/// Friction angle with which the rock moves (degrees), and its speed at the water (m/s).
fn motion(failure: &Failure, level: f64, depth: f64) -> (f64, f64) {
    let steepness = failure.dip.to_radians().tan();
    let friction = (FRICTION_SHARE * steepness)
        .atan()
        .to_degrees()
        .min(FRICTION);
    let friction = down_to(friction, 0.5);
    let drop = (failure.center[2] - level).max(0.0);
    let share = 1.0 - friction.to_radians().tan() / steepness;
    let wave = 0.5 * (GRAVITY * depth).sqrt();
    (friction, (2.0 * GRAVITY * drop * share).sqrt().max(wave))
}

/// Time in which the rock's center slides to the shore from rest; s.
fn slide_time(failure: &Failure, friction: f64, crossing: &Crossing) -> f64 {
    let dip = failure.dip.to_radians();
    let acceleration = GRAVITY * (dip.sin() - friction.to_radians().tan() * dip.cos());
    let way = (crossing.shore[0] - failure.center[0]).hypot(crossing.shore[1] - failure.center[1]);
    (2.0 * way / dip.cos() / acceleration).sqrt()
}

/// Rectangle on the map around the rock, the way of the wave and the land across, within the elevations; m.
fn plan(
    survey: &Survey,
    outline: &Outline,
    way: &Crossing,
    (failure, spacing): (&Failure, f64),
) -> [[f64; 2]; 2] {
    let end = way.opposite.map_or(way.length, |opposite| opposite.end);
    let aside = (ASIDE * way.length).max(failure.width);
    let across = [-way.along[1], way.along[0]];
    let strip = [(0.0, -aside), (0.0, aside), (end, -aside), (end, aside)];
    let strip = strip.map(|(s, t)| [0, 1].map(|axis| way.at(s)[axis] + t * across[axis]));
    let margin = (0.15 * failure.length).max(3.0 * survey.cell);
    let (mut low, mut high) = ([0.0; 2], [0.0; 2]);
    for axis in 0..2 {
        let bounds = |points: &mut dyn Iterator<Item = f64>| {
            points.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                (low.min(x), high.max(x))
            })
        };
        let rock = bounds(&mut outline.corners.iter().map(|corner| corner[axis]));
        let water = bounds(&mut strip.iter().map(|corner| corner[axis]));
        let least = (rock.0 - margin)
            .min(water.0)
            .max(survey.extent[0][axis] + BEYOND * spacing);
        let most = (rock.1 + margin)
            .max(water.1)
            .min(survey.extent[1][axis] - BEYOND * spacing);
        // the rock counts more than the ground beyond
        low[axis] = least.min(rock.0 - survey.cell).max(survey.extent[0][axis]);
        high[axis] = most.max(rock.1 + survey.cell).min(survey.extent[1][axis]);
    }
    [low, high]
}

/// Sides of a rectangle on the map along which ground lies below the level (m).
fn wet_sides(survey: &Survey, [low, high]: [[f64; 2]; 2], level: f64) -> Vec<&'static str> {
    let is_wet = |from: [f64; 2], to: [f64; 2]| {
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        places(0.0, 1.0, 0.5 * survey.cell / length).any(|share| {
            let place = [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis]));
            survey.height(place).is_some_and(|z| z < level)
        })
    };
    let (south_east, north_west) = ([high[0], low[1]], [low[0], high[1]]);
    let sides = [
        ("XMin", low, north_west),
        ("XMax", south_east, high),
        ("YMin", low, south_east),
        ("YMax", north_west, high),
    ];
    let wet = sides.into_iter().filter(|&(_, from, to)| is_wet(from, to));
    wet.map(|(name, ..)| name).collect()
}

/// Ground in use if the files hold more than twice that, and whether elevations are missing there.
fn clip(
    survey: &Survey,
    domain: [[f64; 2]; 2],
    on_map: [[f64; 2]; 2],
    beyond: f64,
) -> (Option<[[f64; 2]; 2]>, bool) {
    let [low, high] = survey.extent;
    let used = [
        [0, 1].map(|axis| (on_map[0][axis] - beyond).max(low[axis])),
        [0, 1].map(|axis| (on_map[1][axis] + beyond).min(high[axis])),
    ];
    let area = |[low, high]: [[f64; 2]; 2]| (high[0] - low[0]) * (high[1] - low[1]);
    if area(survey.extent) < 2.0 * area(used) {
        let (_, _, has_gaps) = survey.range(survey.extent);
        return (None, has_gaps);
    }
    let (_, _, has_gaps) = survey.range(used);
    let shifted = [0, 1].map(|end| {
        [0, 1].map(|axis| rounded(domain[end][axis] + used[end][axis] - on_map[end][axis], 1))
    });
    (Some(shifted), has_gaps)
}
