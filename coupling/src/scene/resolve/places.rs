//! Doubtful places: blocks outside of the domain or far larger than it, gauges that stay dry, failure surfaces that dip into the
//! hill.

use std::cell::OnceCell;

use riprap_dda::{Motion, Polyhedron, Shape, Vec3};

use super::solids::Solids;
use crate::messages::Code;
use crate::scene::error::Problem;
use crate::scene::file::{
    FailureSurfaceFile, GaugeFile, RegionShapeFile, SceneFile, ShapeFile, SlideFile, vec3,
};
use crate::scene::fill::Lattice;
use crate::scene::geometry::cloud::neighbors::Neighbors;
use crate::scene::geometry::terrain::{Slopes, Terrain};
use crate::world::ground::{Ground, fan};

/// Size of a free block over that of the domain above which it is in another unit.
const LARGEST_FREE: f64 = 20.0;
/// The same for a block that does not move, which may well reach out of the domain.
const LARGEST_FIXED: f64 = 200.0;
/// Size of a mesh over that of the domain below which it is in another unit.
const SMALLEST_MESH: f64 = 2e-4;
/// Size of the domain over that of its content above which it is in another unit.
const EMPTIEST: f64 = 200.0;
/// Gap to the domain that is no round-off; × size of the domain.
const NOTICED_GAP: f64 = 1e-6;
/// Slope from which ground and failure plane have a direction.
const SLOPING: f64 = 0.05;
/// Samples of a line in plan view.
const SAMPLES: u32 = 40;

/// Blocks outside of the domain, or of another order of size.
pub(super) fn blocks_out_of_place(file: &SceneFile, solids: &Solids) -> Vec<Problem> {
    let (low, high) = (vec3(file.domain.min), vec3(file.domain.max));
    let room = (high - low).max();
    let mut found: Vec<Problem> = Vec::new();
    let mut told: Vec<&str> = Vec::new();
    let bodies = solids.named.iter().zip(&solids.motions).enumerate();
    for (index, ((name, shape), motion)) in bodies {
        // blocks that were cut or strewn together are one answer
        let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
        let stem = if stem.ends_with(['.', '_']) {
            stem
        } else {
            name
        };
        if told.contains(&stem) {
            continue;
        }
        let body = Body {
            name,
            shape: file.blocks.get(index).map(|block| &block.shape),
            path: format!("blocks[{index}]"),
            corners: shape.aabb(),
        };
        let is_free = matches!(motion, Motion::Free);
        let problem = body
            .of_another_size(room, is_free)
            .or_else(|| body.outside((low, high), motion));
        if let Some(problem) = problem {
            told.push(stem);
            found.push(problem);
        }
    }
    found
}

/// A length without digits below a tenth of a millimeter.
fn digits(length: f64) -> f64 {
    (length * 1e4).round() / 1e4
}

/// A domain far larger than all that is in it.
pub(super) fn empty_domain(file: &SceneFile, solids: &Solids) -> Option<Problem> {
    let room = vec3(file.domain.max) - vec3(file.domain.min);
    let boxes = solids.named.iter().map(|(_, shape)| shape.aabb());
    let regions = file.fluid.iter().flat_map(|fluid| &fluid.regions);
    let water = regions.filter_map(|region| match region.shape {
        RegionShapeFile::Box { min, max } => Some((vec3(min), vec3(max))),
        RegionShapeFile::Below { .. } => None,
    });
    let (low, high) = boxes
        .chain(water)
        .reduce(|(low, high), (min, max)| (low.inf(&min), high.sup(&max)))?;
    let content = (high - low).max();
    (room.max() > EMPTIEST * content).then(|| {
        Problem::warning(
            Code::SuspiciousUnits,
            "domain",
            format!(
                "domain is {} m long, all that is in it {} m; lengths are in meters, not millimeters",
                digits(room.max()),
                digits(content)
            ),
        )
    })
}

/// A block with the box around it.
struct Body<'a> {
    name: &'a str,
    shape: Option<&'a ShapeFile>,
    path: String,
    corners: (Vec3, Vec3),
}

impl Body<'_> {
    fn of_another_size(&self, room: f64, is_free: bool) -> Option<Problem> {
        let size = (self.corners.1 - self.corners.0).max();
        let most = if is_free { LARGEST_FREE } else { LARGEST_FIXED };
        let scale = match self.shape? {
            ShapeFile::Mesh { scale, .. } | ShapeFile::Surface { scale, .. } => Some(*scale),
            ShapeFile::Terrain | ShapeFile::Raster { .. } => return None,
            _ => None,
        };
        let field = if scale.is_some() { ".scale" } else { "" };
        let path = format!("{}.shape{field}", self.path);
        let (length, extent) = (digits(size), digits(room));
        let say = |right: String| {
            format!(
                "block `{}` is {length} m long in a domain of {extent} m; {right}",
                self.name
            )
        };
        if size > most * room {
            let right = match scale {
                Some(scale) => format!("a mesh in millimeters has scale: 0.001, found {scale}"),
                None => "lengths are in meters, not millimeters".to_owned(),
            };
            let message = say(right);
            return Some(if is_free {
                Problem::error(Code::SuspiciousUnits, path, message)
            } else {
                Problem::warning(Code::SuspiciousUnits, path, message)
            });
        }
        let scale = scale.filter(|_| size < SMALLEST_MESH * room)?;
        let right = format!("a mesh in meters has scale: 1, found {scale}");
        Some(Problem::warning(Code::SuspiciousUnits, path, say(right)))
    }

    fn outside(&self, (low, high): (Vec3, Vec3), motion: &Motion) -> Option<Problem> {
        let gap = NOTICED_GAP * (high - low).max();
        let (from, to) = self.corners;
        let axis = (0..3).find(|&k| to[k] < low[k] - gap || high[k] + gap < from[k])?;
        let message = format!(
            "block `{}` is outside of the domain: along {} it is from {} to {} m, the domain from {} to {}",
            self.name,
            ["x", "y", "z"][axis],
            digits(from[axis]),
            digits(to[axis]),
            low[axis],
            high[axis]
        );
        match (motion, self.shape) {
            (Motion::Fixed, Some(ShapeFile::Terrain)) => Some(Problem::error(
                Code::OutsideDomain,
                "terrain.origin",
                format!("{message}; set terrain.origin to the map coordinates of (0, 0, 0)"),
            )),
            (Motion::Free, _) => Some(Problem::error(
                Code::OutsideDomain,
                format!("{}.shape", self.path),
                message,
            )),
            (Motion::Fixed, _) => Some(Problem::warning(
                Code::OutsideDomain,
                format!("{}.shape", self.path),
                format!("{message}; it has no effect"),
            )),
            // a gate or a paddle may come in later
            (Motion::Prescribed(_), _) => None,
        }
    }
}

/// Gauges in rock, or on land higher above the water than it is deep.
pub(super) fn dry_gauges(file: &SceneFile, solids: &Solids, lattice: &Lattice) -> Vec<Problem> {
    if file.gauges.is_empty() {
        return Vec::new();
    }
    let land = Land::new(solids, lattice);
    let mut found = Vec::new();
    for (index, gauge) in file.gauges.iter().enumerate() {
        match gauge {
            GaugeFile::SurfaceElevation { name, x, y } => {
                if let Some(ground) = land.high_ground(&[[*x, *y]]) {
                    let right = format!("it stays dry{}", land.nearest_water([*x, *y]));
                    let message = land.dry(name, ground, &right);
                    found.push(Problem::warning(
                        Code::DryGauge,
                        format!("gauges[{index}].x"),
                        message,
                    ));
                }
            }
            GaugeFile::RunUp { name, from, to } | GaugeFile::Front { name, from, to } => {
                let line: Vec<[f64; 2]> = (0..=SAMPLES)
                    .map(|k| f64::from(k) / f64::from(SAMPLES))
                    .map(|s| [from.0 + s * (to.0 - from.0), from.1 + s * (to.1 - from.1)])
                    .collect();
                if let Some(ground) = land.high_ground(&line) {
                    let near = land.nearest_water([from.0, from.1]);
                    let right = format!("start the line in the water{near}");
                    let message = land.dry(name, ground, &right);
                    found.push(Problem::warning(
                        Code::DryGauge,
                        format!("gauges[{index}].from"),
                        message,
                    ));
                }
            }
            GaugeFile::Pressure { name, position, .. } | GaugeFile::Velocity { name, position } => {
                if let Some(block) = land.block_around(&vec3(*position)) {
                    let near = land.nearest_water([position.0, position.1]);
                    found.push(Problem::warning(
                        Code::DryGauge,
                        format!("gauges[{index}].position"),
                        format!(
                            "gauge `{name}` at {position:?} is inside block `{block}`; move it into the water{near}"
                        ),
                    ));
                }
            }
            _ => {}
        }
    }
    found
}

/// Fixed blocks and the water among them.
struct Land<'a> {
    fixed: Vec<&'a (String, Shape)>,
    ground: Ground,
    lattice: &'a Lattice,
    /// Columns of water in plan view, once a gauge asks for them.
    columns: OnceCell<Option<Neighbors<2>>>,
}

impl<'a> Land<'a> {
    fn new(solids: &'a Solids, lattice: &'a Lattice) -> Self {
        let bodies = solids.named.iter().zip(&solids.motions);
        let fixed: Vec<_> = bodies
            .filter(|(_, motion)| matches!(motion, Motion::Fixed))
            .map(|(named, _)| named)
            .collect();
        let triangles = fixed.iter().flat_map(|(_, shape)| triangles(shape));
        Self {
            ground: Ground::over(triangles.collect()),
            fixed,
            lattice,
            columns: OnceCell::new(),
        }
    }

    fn columns(&self) -> Option<&Neighbors<2>> {
        let columns = self.columns.get_or_init(|| {
            let mut places: Vec<[f64; 2]> = (self.lattice.positions.iter())
                .map(|x| [x.x, x.y])
                .collect();
            places.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
            places.dedup();
            Neighbors::of(places)
        });
        columns.as_ref()
    }

    /// The column of water nearest to a point in plan view, in words.
    fn nearest_water(&self, place: [f64; 2]) -> String {
        self.columns().map_or_else(String::new, |columns| {
            let nearest = columns.nearest(&place);
            let [x, y] = columns.points()[nearest.index].map(digits);
            format!(
                "; the nearest water is at ({x}, {y}), {:.1} m away",
                nearest.distance
            )
        })
    }

    /// Lowest ground at some points in plan view, if all of it is as high above the water as that is deep; m.
    fn high_ground(&self, points: &[[f64; 2]]) -> Option<f64> {
        let top = self.lattice.still_water_level + self.lattice.depth;
        let heights: Option<Vec<f64>> = points
            .iter()
            .map(|point| self.ground.height_under_the_sky(*point))
            .collect();
        let lowest = heights?.into_iter().fold(f64::INFINITY, f64::min);
        (top < lowest && lowest.is_finite() && !self.has_water_at(points)).then_some(lowest)
    }

    /// True for water below one of some points, such as in a tunnel.
    fn has_water_at(&self, points: &[[f64; 2]]) -> bool {
        let [dx, dy, _] = self.lattice.spacing;
        let Some(columns) = self.columns() else {
            return false;
        };
        points.iter().any(|p| {
            // the circle around the rectangle, then the rectangle
            let near = columns.within(p, 1.001 * dx.hypot(dy));
            let is_near = |x: [f64; 2]| (x[0] - p[0]).abs() <= dx && (x[1] - p[1]).abs() <= dy;
            near.into_iter().any(|k| is_near(columns.points()[k]))
        })
    }

    fn dry(&self, name: &str, ground: f64, right: &str) -> String {
        format!(
            "gauge `{name}` is on land {:.3} m above the water, which is {:.3} m deep; {right}",
            ground - self.lattice.still_water_level,
            self.lattice.depth
        )
    }

    /// The fixed block more than a spacing inside of which a point is.
    fn block_around(&self, x: &Vec3) -> Option<&'a str> {
        let spacing = self.lattice.spacing.iter().copied().fold(0.0, f64::max);
        let is_around = |shape: &Shape| shape.signed_distance(x).distance < -spacing;
        let mut fixed = self.fixed.iter();
        fixed
            .find(|(_, shape)| is_around(shape))
            .map(|(name, _)| name.as_str())
    }
}

/// Triangles of a shape; spheres are no ground.
fn triangles(shape: &Shape) -> Vec<[Vec3; 3]> {
    match shape {
        Shape::Surface(surface) => {
            let corner = |&v: &u32| surface.vertices()[v as usize];
            let triangles = surface.triangles().iter();
            triangles
                .map(|[a, b, c]| [corner(a), corner(b), corner(c)])
                .collect()
        }
        Shape::Polyhedra(parts) => {
            let faces = (parts.iter()).flat_map(|part| (0..part.n_faces()).map(move |f| (part, f)));
            let fan_of = |(part, face): (&Polyhedron, usize)| {
                let corners = part.face_vertices(face);
                let corners: Vec<Vec3> = corners.map(|v| part.vertices()[v as usize]).collect();
                fan(&corners).collect::<Vec<_>>()
            };
            faces.flat_map(fan_of).collect()
        }
        Shape::Sphere { .. } => Vec::new(),
    }
}

/// Slides whose failure surface dips against the ground above it.
pub(super) fn failures_into_the_hill(slides: &[SlideFile], terrain: &Terrain) -> Vec<Problem> {
    let mut found = Vec::new();
    for ((index, slide), slopes) in slides.iter().enumerate().zip(&terrain.slopes) {
        let Some(Slopes { ground, failure }) = slopes else {
            continue;
        };
        let steepness = failure[0].hypot(failure[1]);
        // of the ground, down the failure surface
        let fall = (ground[0] * failure[0] + ground[1] * failure[1]) / steepness;
        if steepness > SLOPING && fall < -SLOPING {
            let toward = |slope: &[f64; 2]| {
                let direction = (-slope[0]).atan2(-slope[1]).to_degrees();
                direction.rem_euclid(360.0)
            };
            let (field, what) = match slide.failure_surface {
                FailureSurfaceFile::Plane { .. } => ("dip_direction_deg", "plane"),
                FailureSurfaceFile::Raster { .. } => ("file", "surface"),
            };
            found.push(Problem::warning(
                Code::FailureSurfaceMisplaced,
                format!("slides[{index}].failure_surface.{field}"),
                format!(
                    "slide `{}`: the failure {what} dips into the hill, toward {:.0} degrees; the ground falls toward {:.0}",
                    slide.name,
                    toward(failure),
                    toward(ground)
                ),
            ));
        }
    }
    found
}
