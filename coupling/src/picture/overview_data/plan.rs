//! Plan views of a scene and of a world.

use rayon::prelude::*;
use riprap_dda::Vec3;

use super::side_view::{Section, convex_outline};
use crate::output::observe::maps::Maps;
use crate::picture::overview::plan::{Footprint, FromAbove, Mark, Plan};
use crate::scene::resolve::Scene;
use crate::scene::resolved::recording::{Gauge, Quantity};
use crate::scene::terrain::grid::Grid;
use crate::world::World;
use crate::world::ground::Ground;

/// Largest number of ground points along the longer side of the domain: more than the pixels of a plan at half resolution.
const MOST_POINTS_OF_GROUND: f64 = 480.0;
/// Largest number of water points, which are saved with the state of the run.
const MOST_POINTS_OF_WATER: f64 = 240.0;

/// Empty record, if there is terrain.
pub(super) fn begun(scene: &Scene, world: &World) -> Option<Plan> {
    let terrain = scene.terrain.as_ref()?;
    let origin = terrain.origin;
    let (low, high) = (scene.domain.min, scene.domain.max);
    let view = ([low.x, low.y], [high.x, high.y]);
    let longest = (high.x - low.x).max(high.y - low.y);
    let land = Ground::of(&world.blocks);
    let mut ground = points(
        view,
        terrain.grid.spacing.max(longest / MOST_POINTS_OF_GROUND),
    );
    let height = |point| land.height_under_the_sky(ground.place(point));
    ground.heights = ground
        .points()
        .map(|point| height(point).unwrap_or(f64::NAN))
        .collect();
    let spacing = scene
        .fluid
        .as_ref()
        .map_or(longest, |fluid| fluid.walls.particle_spacing);
    Some(Plan {
        view,
        origin: [origin.0, origin.1, origin.2],
        ground,
        still_level: scene
            .fluid
            .as_ref()
            .map(|fluid| fluid.lattice.still_water_level)
            .filter(|level| level.is_finite()),
        water: points(view, spacing.max(longest / MOST_POINTS_OF_WATER)),
        views: Vec::new(),
        maps: None,
        marks: (scene.gauges.iter().filter_map(mark))
            .chain(line_of_views(scene))
            .collect(),
    })
}

/// Centers of squares that cover a rectangle in plan view, without elevations; m.
fn points((min, max): ([f64; 2], [f64; 2]), spacing: f64) -> Grid {
    let squares = |axis: usize| ((max[axis] - min[axis]) / spacing * (1.0 - 1e-9)).ceil();
    let n = [0, 1].map(|axis| (squares(axis) as usize).max(2));
    Grid {
        n,
        corner: [0, 1]
            .map(|axis| 0.5 * (min[axis] + max[axis]) - 0.5 * (n[axis] - 1) as f64 * spacing),
        spacing,
        heights: Vec::new(),
    }
}

/// Line of the side views, if it follows a slide.
fn line_of_views(scene: &Scene) -> Option<Mark> {
    let section = Section::of(scene);
    let [from, to] = section.ends((scene.domain.min, scene.domain.max));
    section
        .follows_slide()
        .then_some(Mark::Section { from, to })
}

fn mark(gauge: &Gauge) -> Option<Mark> {
    let name = gauge.name.clone();
    match &gauge.quantity {
        Quantity::SurfaceElevation { x, y } => Some(Mark::Point { name, at: [*x, *y] }),
        Quantity::RunUp(line) | Quantity::Front(line) | Quantity::Overtopping(line) => {
            Some(Mark::Line {
                name,
                from: line.from,
                to: line.to,
            })
        }
        Quantity::Pressure(_)
        | Quantity::Velocity { .. }
        | Quantity::BlockForce { .. }
        | Quantity::PointMotion { .. }
        | Quantity::Displaced { .. } => None,
    }
}

/// Takes the final maps.
pub(super) fn add_maps(plan: &mut Plan, maps: &Maps) {
    plan.maps = Some(maps.extremes());
}

/// Current water and blocks.
pub(super) fn from_above(plan: &Plan, world: &World) -> FromAbove {
    let fluid = world.water.as_ref().map(|water| &water.fluid);
    let surface_at = |[x, y]: [f64; 2]| fluid.and_then(|fluid| fluid.surface_elevation(x, y));
    let places: Vec<[f64; 2]> = plan.water.points().map(|p| plan.water.place(p)).collect();
    let surface = places
        .par_iter()
        .map(|&place| surface_at(place).map_or(f32::NAN, |height| height as f32));
    let blocks = &world.blocks;
    // surfaces have no volume
    let shown = (0..blocks.n_blocks())
        .filter(|&b| !blocks.is_removed(b) && !world.is_fixed(b) && blocks.volume(b) > 0.0);
    let mut shown: Vec<(f64, Footprint)> = shown
        .map(|b| {
            let corners: Vec<Vec3> = blocks
                .parts_of(b)
                .flat_map(|part| blocks.part_points(part))
                .collect();
            let top = corners
                .iter()
                .map(|x| x.z)
                .fold(f64::NEG_INFINITY, f64::max);
            let middle = blocks.centroid(b);
            let footprint = Footprint {
                points: footprint(&corners),
                is_under_water: surface_at([middle.x, middle.y]).is_some_and(|height| top < height),
            };
            (top, footprint)
        })
        .collect();
    shown.sort_by(|a, b| a.0.total_cmp(&b.0));
    FromAbove {
        time: world.time(),
        surface: surface.collect(),
        blocks: shown.into_iter().map(|(_, footprint)| footprint).collect(),
    }
}

/// Convex hull of corners (m) in plan view; m.
fn footprint(corners: &[Vec3]) -> Vec<[f32; 2]> {
    convex_outline(corners.iter().map(|x| [x.x as f32, x.y as f32]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::resolved::recording::{PlanLine, PressureGauge};

    #[test]
    fn a_footprint_is_where_the_block_is() {
        // a cube of edge 2 m about (5, -3), turned by 45° about the vertical
        let reach = 2f64.sqrt();
        let corners: Vec<Vec3> = [7.0, 9.0]
            .into_iter()
            .flat_map(|z| {
                [[reach, 0.0], [0.0, reach], [-reach, 0.0], [0.0, -reach]]
                    .map(|[x, y]| Vec3::new(5.0 + x, -3.0 + y, z))
            })
            .collect();
        let found = footprint(&corners);
        let reach = reach as f32;
        let expected = [
            [5.0 - reach, -3.0],
            [5.0, -3.0 - reach],
            [5.0 + reach, -3.0],
            [5.0, -3.0 + reach],
        ];
        assert_eq!(found.len(), 4);
        for (found, expected) in found.iter().zip(expected) {
            // single precision
            assert!((found[0] - expected[0]).abs() < 1e-6 && (found[1] - expected[1]).abs() < 1e-6);
        }
    }

    #[test]
    fn points_are_the_middles_of_squares_that_cover_the_domain() {
        let grid = points(([-10.0, 0.0], [10.0, 7.0]), 2.0);
        assert_eq!((grid.n, grid.corner), ([10, 4], [-9.0, 0.5]));
        assert_eq!(grid.far_corner(), [9.0, 6.5]);
    }

    #[test]
    fn instruments_of_the_plan_are_points_and_lines() {
        let front = Gauge {
            name: "front".to_owned(),
            quantity: Quantity::Front(PlanLine {
                from: [1.0, 2.0],
                to: [3.0, 4.0],
            }),
        };
        let expected = Mark::Line {
            name: "front".to_owned(),
            from: [1.0, 2.0],
            to: [3.0, 4.0],
        };
        assert_eq!(mark(&front), Some(expected));
        let pressure = Gauge {
            name: "p".to_owned(),
            quantity: Quantity::Pressure(PressureGauge {
                position: Vec3::zeros(),
                diameter: 0.0,
                averaging_time: 0.0,
            }),
        };
        assert_eq!(mark(&pressure), None);
    }
}
