//! Width of the kernel against the thinnest body, film and gap: across thinner ones a sum over neighbors sees both sides.

use riprap_dda::{Polyhedron, Shape, Vec3};
use riprap_sph::Dimensions;

use crate::scene::fill::{PASSABLE, gaps};
use crate::scene::resolved::{FluidScene, Scene};

/// Of lengths as wide as the kernel; relative.
const ROUND_OFF: f64 = 1e-9;

/// Distance within which water is at a side; × spacing.
const BESIDE: f64 = 1.5;

/// Heading and text of a line.
type Line = (&'static str, String);

/// The thinnest body with water on two sides, the thinnest film and the narrowest gap, of those narrower than the kernel.
pub(super) fn thinnest(scene: &Scene) -> Vec<Line> {
    let Some(fluid) = &scene.fluid else {
        return Vec::new();
    };
    let width = 2.0 * fluid.settings.support_radius();
    let spacing = fluid.settings.mean_spacing();
    let line = |what: String, thickness: f64, then: &str| {
        let text = format!(
            "{:.1} spacings wide, {width:.4} m, wider than {what}: {thickness:.4} m, {:.1} spacings; {then}; fluid.resolution: \
             Spacing({:.2e}) resolves it",
            width / spacing,
            thickness / spacing,
            spacing * thickness / width,
        );
        ("kernel", text)
    };
    let name = |block: usize| &scene.block_names[block];
    let bodies = scene.blocks.iter().enumerate();
    let thicknesses = bodies.filter_map(|(b, body)| {
        let thickness = thickness(&body.shape)?;
        let is_thin = thickness.size < width * (1.0 - ROUND_OFF);
        (is_thin && has_water_on_two_sides(fluid, &body.shape, &thickness))
            .then_some((b, thickness.size))
    });
    let body = thicknesses.min_by(|a, b| a.1.total_cmp(&b.1));
    let mut bottoms = vec![f64::INFINITY; fluid.regions.len()];
    for (x, &region) in fluid.lattice.positions.iter().zip(&fluid.lattice.region) {
        let bottom = &mut bottoms[region as usize];
        *bottom = bottom.min(x.z - 0.5 * fluid.settings.particle_spacing[2]);
    }
    let film = (fluid.regions.iter().zip(&bottoms))
        .map(|(region, bottom)| (&region.name, region.level - bottom))
        .filter(|(_, depth)| *depth < width * (1.0 - ROUND_OFF))
        .min_by(|a, b| a.1.total_cmp(&b.1));
    let shapes = scene.blocks.iter().map(|block| &block.shape);
    // narrower ones have a warning
    let gap = gaps(
        shapes,
        fluid.lattice.still_water_level,
        [PASSABLE * spacing, width],
    );
    let mut lines = Vec::new();
    if let Some((b, size)) = body {
        let then = "water on its two sides is kept apart by walls of particles only, and loads are smoothed across it";
        lines.push(line(format!("body `{}`", name(b)), size, then));
    }
    if let Some((region, depth)) = film {
        let then = "its surface and its bed are in one sum, and layers of less than three spacings push too little";
        lines.push(line(format!("film `{region}`"), depth, then));
    }
    if let Some(gap) = gap {
        let [i, j] = gap.between;
        let what = format!("the gap between `{}` and `{}`", name(i), name(j));
        lines.push(line(
            what,
            gap.narrowest,
            "water in it feels both walls at once",
        ));
    }
    lines
}

/// Thickness of a body, with the direction across it and the place of its middle along that; m.
struct Thickness {
    size: f64,
    across: Vec3,
    middle: f64,
}

/// Least width of a convex body along the normals of its faces; `None` for surfaces and for bodies of parts.
fn thickness(shape: &Shape) -> Option<Thickness> {
    match shape {
        Shape::Polyhedra(parts) => match parts.as_slice() {
            [part] => thickness_of(part),
            _ => None,
        },
        Shape::Sphere { center, radius } => Some(Thickness {
            size: 2.0 * radius,
            across: Vec3::z(),
            middle: center.z,
        }),
        Shape::Surface(_) => None,
    }
}

fn thickness_of(part: &Polyhedron) -> Option<Thickness> {
    let width = |face: usize| {
        let across = part.face_normal(face);
        let heights = part.vertices().iter().map(|x| across.dot(x));
        let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        (high - low, across, 0.5 * (low + high))
    };
    let (size, across, middle) = (0..part.n_faces())
        .map(width)
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(Thickness {
        size,
        across,
        middle,
    })
}

/// Whether there are particles at the two sides of a body; in a plane the width of the slice is not a thickness.
fn has_water_on_two_sides(fluid: &FluidScene, shape: &Shape, thickness: &Thickness) -> bool {
    let is_plane = matches!(fluid.settings.dimensions, Dimensions::Two { .. });
    if is_plane && 0.5 < thickness.across.y.abs() {
        return false;
    }
    let reach = BESIDE * fluid.settings.mean_spacing();
    let half = 0.5 * thickness.size;
    [-1.0, 1.0].iter().all(|side| {
        let is_there = |x: &&Vec3| {
            let out = side * (thickness.across.dot(x) - thickness.middle) - half;
            0.0 < out && out < reach && shape.signed_distance(x).distance < reach
        };
        fluid.lattice.positions.iter().any(|x| is_there(&x))
    })
}
