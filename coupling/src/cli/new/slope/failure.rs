//! Failure plane of a slope, from the ground along the outline of the rock.

use super::super::digits::rounded;
use super::super::survey::{Survey, places};
use crate::scene::geometry::terrain::outline::Outline;

/// Volume of landslides by their area, `V = 0.074 A^1.45`: Guzzetti et al. (2009), Earth and Planetary Science Letters 279; m³, m².
const VOLUME_BY_AREA: (f64, f64) = (0.074, 1.45);
/// Part of the outline's length along the dip that is its toe, and the number of samples along that length.
const TOE: f64 = 0.02;
const SAMPLES: f64 = 100.0;
/// Gentlest ground that tells the direction of a slide, and flattest failure plane; degrees.
const FLATTEST: f64 = 3.0;

/// Parts of the failure plane that the user may state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stated {
    /// Degrees.
    pub dip: Option<f64>,
    /// Degrees, clockwise from north.
    pub dip_direction: Option<f64>,
    /// m³.
    pub volume: Option<f64>,
    /// Mean thickness; m.
    pub thickness: Option<f64>,
}

/// Origin of the dip of a failure plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DipFrom {
    Stated,
    StatedVolume,
    Area,
}

/// Failure plane that daylights at the toe, and the rock above it.
#[derive(Clone, Debug)]
pub(super) struct Failure {
    /// Point at the toe, on the map; m.
    pub point: [f64; 3],
    /// Degrees.
    pub dip: f64,
    /// Degrees, clockwise from north.
    pub dip_direction: f64,
    pub dip_from: DipFrom,
    /// Dip of the ground along the rim; degrees.
    pub ground_dip: f64,
    /// m³.
    pub volume: f64,
    /// Plan area of the outline; m².
    pub area: f64,
    /// Mean of the rock where there is some; m.
    pub thickness: f64,
    /// Center of the rock's mass on the map; m.
    pub center: [f64; 3],
    /// Place on the map at the right end of the outline, seen down the dip; m.
    pub side: [f64; 2],
    /// Extent across the dip direction; m.
    pub width: f64,
    /// Extent along it, in plan view; m.
    pub length: f64,
}

/// Direction of dip in plan view.
pub(super) fn direction(dip_direction: f64) -> [f64; 2] {
    let angle = dip_direction.to_radians();
    [angle.sin(), angle.cos()]
}

/// Ground within an outline, seen along the direction of dip.
struct Rim {
    /// Direction of dip in plan view.
    along: [f64; 2],
    /// Points of the rim: distance along the dip direction, place, elevation; m.
    points: Vec<(f64, [f64; 2], f64)>,
    /// Ground within, at the middles of equal squares; m.
    inside: Vec<[f64; 3]>,
    /// Area of a square; m².
    square: f64,
}

/// A failure plane for the rock within an outline on the map.
///
/// The dip direction is that of the plane through the ground along the outline (least squares). The plane daylights at the toe of
/// the outline; it dips as stated, or as steeply as the stated volume or thickness demands.
///
/// # Errors
///
/// A message on what to state, or to correct.
pub(super) fn failure(
    survey: &Survey,
    outline: &Outline,
    stated: Stated,
) -> Result<Failure, String> {
    let ground = rim(survey, outline)?;
    let (downhill, ground_dip) = fitted(&ground);
    if ground_dip < FLATTEST && (stated.dip_direction.is_none() || stated.dip.is_none()) {
        return Err(format!(
            "the ground along the outline dips at {ground_dip:.1} degrees, too gently to tell where the rock would go; state --dip and \
             --dip-direction"
        ));
    }
    let dip_direction = stated
        .dip_direction
        .unwrap_or_else(|| rounded(downhill, 0) % 360.0);
    let rim = Rim::along(ground, survey, outline, direction(dip_direction));
    let area = outline.area();
    let by_area = VOLUME_BY_AREA.0 * area.powf(VOLUME_BY_AREA.1);
    let (dip, dip_from) = match (stated.dip, stated.volume, stated.thickness) {
        (Some(dip), ..) => (dip, DipFrom::Stated),
        (None, Some(volume), _) => (rim.dip_for(volume)?, DipFrom::StatedVolume),
        (None, None, Some(thickness)) => (rim.dip_for(thickness * area)?, DipFrom::StatedVolume),
        (None, None, None) => (rim.dip_for(by_area)?, DipFrom::Area),
    };
    let dip = rounded(dip, 1);
    let point = rim.toe(dip);
    let rock = rim.rock(point, dip);
    if rock.volume <= 0.0 {
        return Err(format!(
            "a plane that dips at {dip} degrees from the toe of the outline leaves no rock above it: the ground along the outline dips at \
             {ground_dip:.0} degrees; lower --dip, or state --volume"
        ));
    }
    let [width, length] = rim.size();
    Ok(Failure {
        point,
        dip,
        dip_direction,
        dip_from,
        ground_dip,
        volume: rock.volume,
        area,
        thickness: rock.volume / rock.area,
        center: rock.center,
        side: rim.side(),
        width,
        length,
    })
}

/// Rock above a plane.
struct Rock {
    volume: f64,
    area: f64,
    center: [f64; 3],
}

/// Ground along an outline: place and elevation; m.
fn rim(survey: &Survey, outline: &Outline) -> Result<Vec<[f64; 3]>, String> {
    let corners = &outline.corners;
    let next = corners.iter().cycle().skip(1);
    let longest = corners.iter().zip(next.clone());
    let around: f64 = longest.map(|(a, b)| (b[0] - a[0]).hypot(b[1] - a[1])).sum();
    let step = survey.cell.min(around / (4.0 * SAMPLES));
    let mut found = Vec::new();
    for (a, b) in corners.iter().zip(next) {
        let length = (b[0] - a[0]).hypot(b[1] - a[1]);
        for share in places(0.0, 1.0, step / length.max(step)) {
            let [x, y] = [0, 1].map(|axis| a[axis] + share * (b[axis] - a[axis]));
            let z = survey.height([x, y]).ok_or_else(|| {
                format!("there is no elevation at ({x:.2}, {y:.2}) on the map, on the outline; its corners are in map coordinates, as the raster is")
            })?;
            found.push([x, y, z]);
        }
    }
    Ok(found)
}

/// Dip direction and dip of the plane through points, by least squares; degrees.
fn fitted(points: &[[f64; 3]]) -> (f64, f64) {
    let n = points.len() as f64;
    let mean = [0, 1, 2].map(|axis| points.iter().map(|p| p[axis]).sum::<f64>() / n);
    let product = |a: usize, b: usize| -> f64 {
        let each = points.iter().map(|p| (p[a] - mean[a]) * (p[b] - mean[b]));
        each.sum()
    };
    let (xx, xy, yy, xz, yz) = (
        product(0, 0),
        product(0, 1),
        product(1, 1),
        product(0, 2),
        product(1, 2),
    );
    let determinant = xx * yy - xy * xy;
    let slope = [
        (xz * yy - yz * xy) / determinant,
        (yz * xx - xz * xy) / determinant,
    ];
    let downhill = (-slope[0]).atan2(-slope[1]).to_degrees().rem_euclid(360.0);
    (downhill, slope[0].hypot(slope[1]).atan().to_degrees())
}

impl Rim {
    fn along(ground: Vec<[f64; 3]>, survey: &Survey, outline: &Outline, along: [f64; 2]) -> Self {
        let place = |[x, y]: [f64; 2]| along[0] * x + along[1] * y;
        let bound = |pick: fn(f64, f64) -> f64, axis: usize| {
            let values = outline.corners.iter().map(|corner| corner[axis]);
            values.reduce(pick).unwrap_or(0.0)
        };
        let (low, high) = (
            [0, 1].map(|axis| bound(f64::min, axis)),
            [0, 1].map(|axis| bound(f64::max, axis)),
        );
        let step = (outline.area() / (SAMPLES * SAMPLES)).sqrt();
        let count = |axis: usize| ((high[axis] - low[axis]) / step).ceil() as u32;
        let middles = (0..count(1)).flat_map(|j| (0..count(0)).map(move |i| [i, j]));
        let inside = middles.filter_map(|[i, j]| {
            let x = low[0] + (f64::from(i) + 0.5) * step;
            let y = low[1] + (f64::from(j) + 0.5) * step;
            let is_inside = outline.holds([x, y]);
            is_inside
                .then(|| survey.height([x, y]).map(|z| [x, y, z]))
                .flatten()
        });
        Self {
            along,
            points: ground
                .iter()
                .map(|&[x, y, z]| (place([x, y]), [x, y], z))
                .collect(),
            inside: inside.collect(),
            square: step * step,
        }
    }

    /// Point in the middle of the toe on the plane of a dip (degrees) that has no ground of the toe above it.
    fn toe(&self, dip: f64) -> [f64; 3] {
        let steepness = dip.to_radians().tan();
        let front = self
            .points
            .iter()
            .map(|p| p.0)
            .fold(f64::NEG_INFINITY, f64::max);
        let reach = TOE * self.size()[1];
        let toe: Vec<_> = self
            .points
            .iter()
            .filter(|p| front - reach <= p.0)
            .collect();
        let n = toe.len() as f64;
        let middle = [0, 1].map(|axis| toe.iter().map(|p| p.1[axis]).sum::<f64>() / n);
        let at_front = toe.iter().map(|p| p.2 - steepness * (front - p.0));
        let height = at_front.fold(f64::NEG_INFINITY, f64::max);
        let behind = front - (self.along[0] * middle[0] + self.along[1] * middle[1]);
        [middle[0], middle[1], height + steepness * behind]
    }

    /// Rock above a plane through a point (m) at a dip (degrees).
    fn rock(&self, point: [f64; 3], dip: f64) -> Rock {
        let steepness = dip.to_radians().tan();
        let mut rock = Rock {
            volume: 0.0,
            area: 0.0,
            center: [0.0; 3],
        };
        for &[x, y, z] in &self.inside {
            let behind = self.along[0] * (point[0] - x) + self.along[1] * (point[1] - y);
            let base = point[2] + steepness * behind;
            if base < z {
                let volume = self.square * (z - base);
                rock.volume += volume;
                rock.area += self.square;
                for (center, at) in rock.center.iter_mut().zip([x, y, 0.5 * (z + base)]) {
                    *center += volume * at;
                }
            }
        }
        let volume = rock.volume;
        rock.center = rock.center.map(|moment| moment / volume);
        rock
    }

    /// Dip of the plane above which there is a volume of rock (m³); degrees.
    fn dip_for(&self, volume: f64) -> Result<f64, String> {
        let above = |dip: f64| self.rock(self.toe(dip), dip).volume;
        let (mut flat, mut steep) = (FLATTEST, 85.0);
        let most = above(flat);
        if most < volume {
            return Err(format!(
                "at most {most:.3e} m3 of rock within the outline lie above a plane from its toe, {volume:.3e} m3 are asked for; lower --volume or \
                 --thickness, or widen the outline"
            ));
        }
        // the volume falls with the dip
        while 0.01 < steep - flat {
            let middle = 0.5 * (flat + steep);
            if volume < above(middle) {
                flat = middle;
            } else {
                steep = middle;
            }
        }
        Ok(flat)
    }

    /// Place farthest to the right, seen down the dip; m.
    fn side(&self) -> [f64; 2] {
        let to_right = |[x, y]: [f64; 2]| self.along[1] * x - self.along[0] * y;
        let places = self.points.iter().map(|&(_, place, _)| place);
        let farthest = places.max_by(|a, b| to_right(*a).total_cmp(&to_right(*b)));
        farthest.unwrap_or_default()
    }

    /// Extents across and along the dip direction; m.
    fn size(&self) -> [f64; 2] {
        let [ux, uy] = self.along;
        [[-uy, ux], [ux, uy]].map(|[x, y]| {
            let places = self.points.iter().map(|(_, at, _)| x * at[0] + y * at[1]);
            let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), s| {
                (low.min(s), high.max(s))
            });
            high - low
        })
    }
}
