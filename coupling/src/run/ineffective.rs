//! Options without effect at the resolution of a scene: models whose effect is not resolved, or which reduced the error of
//! no shipped study. The figures are those of `benches/trade/README.md`.

use riprap_dda::{Integrator, Motion, Shape};
use riprap_sph::scheme::{Shifting, Viscosity};
use riprap_sph::{Dimensions, Precision, Preset, Scheme};

use crate::scene::resolve::{FluidScene, Scene};

/// Strain below which a block is practically rigid; –.
const LEAST_STRAIN: f64 = 1e-3;
/// Tolerance of a vertex at a side of the slab, over its width; –.
const SIDE_TOLERANCE: f64 = 1e-6;
/// Time-step factor below which no study changed.
const CUSTOMARY_FACTOR: f64 = 0.5;

/// One sentence for each option, with the reason.
pub fn ineffective_options(scene: &Scene) -> Vec<String> {
    let mut found: Vec<String> = strain(scene).into_iter().chain(width(scene)).collect();
    // the studies do not cover this scheme
    if let Some(fluid) = &scene.fluid
        && fluid.preset != Preset::Mueller2003
    {
        found.extend(of_scheme(fluid, scene));
    }
    found
}

/// Deformable blocks with negligible strain: under the weight of all free rock on the smallest of them, or a stop from the
/// largest speed within the travel time of an elastic wave.
fn strain(scene: &Scene) -> Option<String> {
    let gravity = scene.gravity.norm();
    let speed = scene.expected_speed;
    let free = || {
        scene
            .blocks
            .iter()
            .filter(|b| matches!(b.motion, Motion::Free))
    };
    let weight: f64 = free()
        .map(|b| scene.materials[b.material].density * b.shape.volume() * gravity)
        .sum();
    let strains = free().filter(|b| b.deformability.is_some()).map(|b| {
        let material = &scene.materials[b.material];
        let modulus = material.elastic.map_or(f64::INFINITY, |e| e.young_modulus);
        let (min, max) = b.shape.aabb();
        let size = max - min;
        let smallest_side = size.x * size.y * size.z / size.max();
        let wave_speed = (modulus / material.density).sqrt();
        weight / (smallest_side * modulus) + speed / wave_speed
    });
    let largest = strains.reduce(f64::max)?;
    let gain = match scene.block_settings.integrator {
        Integrator::CentralDifference => {
            "take the longer steps of their contacts (sliding block: 13 times the work for 0.1 % of its way)"
        }
        Integrator::ContactDynamics(_) => "cost less (a pile of hulls: two thirds of the work)",
    };
    (largest < LEAST_STRAIN).then(|| {
        format!("deformable blocks: they strain by {largest:.0e} at most; rigid ones {gain}")
    })
}

/// A three-dimensional scene in which every block spans the width.
fn width(scene: &Scene) -> Option<String> {
    let domain = &scene.domain;
    let is_slab = scene.fluid.is_some() && domain.dimensions == Dimensions::Three;
    let (low, high) = (domain.min.y, domain.max.y);
    let slack = SIDE_TOLERANCE * (high - low);
    let is_side = |y: f64| y <= low + slack || high - slack <= y;
    let goes_through = scene.blocks.iter().all(|block| match &block.shape {
        Shape::Polyhedra(parts) => parts
            .iter()
            .all(|part| part.vertices().iter().all(|x| is_side(x.y))),
        Shape::Sphere { .. } | Shape::Surface(_) => false,
    });
    let is_level = domain.min.y.is_finite() && scene.gravity.y == 0.0;
    (is_slab && goes_through && is_level).then(|| {
        "its width: every block goes through from side to side; `domain.dimensions: Two` is a plane of it \
         (sliding wedge: a ninth of the work of a slab of four spacings, its crest 3 % higher)"
            .to_owned()
    })
}

/// Options without effect in the shipped studies.
fn of_scheme(fluid: &FluidScene, scene: &Scene) -> Vec<String> {
    let Scheme {
        precision,
        shifting,
        viscosity,
        ..
    } = fluid.settings.scheme;
    let mut found = Vec::new();
    if precision == Precision::Double {
        found.push(
            "double precision: water at rest and waves agree to four digits with single precision, at 1.3 to 1.4 times the run time".to_owned(),
        );
    }
    if shifting != Shifting::None {
        found.push(
            "shifting: of eleven studies it bettered one, 0.70 to 0.54 % of a wave, and worsened nine, a standing wave's height \
             from 17 to 22 %; it takes 1.4 times as long"
                .to_owned(),
        );
    }
    if let Viscosity::SubParticleScale {
        kinematic_viscosity,
        ..
    } = viscosity
    {
        let layer = (kinematic_viscosity * scene.duration).sqrt();
        let spacing = fluid.walls.particle_spacing;
        if layer < spacing {
            found.push(format!(
                "eddies below the spacing: layers at walls are {layer:.1e} m thick against a spacing of {spacing:.1e} m, so \
                 that nothing sheds them; `Laminar` is the same to 0.1 % in water at rest and waves and takes 0.7 of the time"
            ));
        }
    }
    let factor = fluid.settings.time_step_factor;
    if factor < CUSTOMARY_FACTOR {
        found.push(format!(
            "a time-step factor of {factor}: no study changed between 0.25 and 1 except for noise; 0.5 takes {:.2} of the time",
            factor / CUSTOMARY_FACTOR
        ));
    }
    found
}
