//! Materials, with the contact stiffness that the scene requires.

use std::ops::Range;

use riprap_dda::{Elastic, Material, Shape};

use super::solids::Solids;
use crate::messages::Code;
use crate::scene::error::Problem;
use crate::scene::file::{MaterialFile, SceneFile, vec3};

/// Largest overlap of blocks under their weight, over their size.
const STATIC_OVERLAP: f64 = 1e-3;
/// Largest overlap of blocks at the expected speed, over their size.
const IMPACT_OVERLAP: f64 = 0.02;
/// The same of the blocks of a slide: half of what a step allows.
const SLIDE_IMPACT_OVERLAP: f64 = 0.1;
/// Largest overlap over the thickness of the thinnest block: half of what a step allows.
const IMPACT_SHARE_OF_THICKNESS: f64 = 0.25;
/// Static overlap above which a warning is due, over the size of the block.
const NOTICED_STATIC_OVERLAP: f64 = 1e-2;
/// Strength of a joint over the pressure of a block of the smallest size, below which it has no effect: a cohesion in kPa or MPa
/// where Pa are meant; –.
const NO_STRENGTH: f64 = 1e-3;
/// Contact stiffness of scenes in which no block can move; N/m.
const IDLE_STIFFNESS: f64 = 1e6;

/// Materials in the order of the file; those without a contact stiffness get the one that the most demanding free block
/// requires at the expected speed (m/s). `of_slides`: indices of the blocks of slides.
pub(super) fn materials(
    file: &SceneFile,
    solids: &Solids,
    of_slides: &Range<usize>,
    speed: f64,
) -> Vec<Material> {
    let stiffness = required_stiffness(file, solids, of_slides, speed);
    let of = |m: &MaterialFile| Material {
        density: m.density,
        friction_angle: m.friction_angle_deg.to_radians(),
        residual_friction_angle: m.residual_friction_angle_deg.map(f64::to_radians),
        cohesion: m.cohesion,
        residual_cohesion: m.residual_cohesion,
        tensile_strength: m.tensile_strength,
        restitution: m.restitution,
        contact_stiffness: m.contact_stiffness.unwrap_or(stiffness),
        joint_stiffness: m.joint_stiffness,
        shear_stiffness_ratio: m.shear_stiffness_ratio,
        shear_damping_ratio: m.shear_damping_ratio,
        rolling_friction: m.rolling_friction,
        twisting_friction: m.twisting_friction,
        elastic: m.elastic.map(|e| Elastic {
            young_modulus: e.young_modulus,
            poisson_ratio: e.poisson_ratio,
            viscosity: e.viscosity,
        }),
    };
    file.materials.iter().map(of).collect()
}

/// Contact stiffness that limits the overlap of every free block; N/m.
///
/// ```text
/// K ≥ m g/(ε L)   overlap ε L at rest,        K ≥ m v²/(η L)²   overlap η L at speed v
/// ```
/// neither above a quarter of the thickness of the thinnest block; of the blocks of a slide η is a tenth, and each has its
/// own thickness: they start at rest on each other, and their thinnest must not make all of them stiff.
fn required_stiffness(
    file: &SceneFile,
    solids: &Solids,
    of_slides: &Range<usize>,
    speed: f64,
) -> f64 {
    let gravity = vec3(file.gravity).norm();
    let thinnest = solids
        .named
        .iter()
        .map(|(_, shape)| shape.thickness())
        .fold(f64::INFINITY, f64::min);
    let deepest = IMPACT_SHARE_OF_THICKNESS * thinnest;
    let mut stiffness: f64 = 0.0;
    for (index, shape, material) in solids.free() {
        let (impact, deepest) = if of_slides.contains(&index) {
            let own = IMPACT_SHARE_OF_THICKNESS * shape.thickness();
            (SLIDE_IMPACT_OVERLAP, own)
        } else {
            (IMPACT_OVERLAP, deepest)
        };
        let density = file.materials.get(material).map_or(0.0, |m| m.density);
        let size = shape.volume().cbrt();
        let mass = density * shape.volume();
        stiffness = stiffness
            .max(mass * gravity / (STATIC_OVERLAP * size).min(deepest))
            .max(mass * (speed / (impact * size).min(deepest)).powi(2));
    }
    if stiffness == 0.0 {
        IDLE_STIFFNESS
    } else {
        stiffness
    }
}

/// Warnings of cohesion and tensile strength far below the weight of the smallest free block over its face.
pub(super) fn no_strength(materials: &[Material], solids: &Solids, gravity: f64) -> Vec<Problem> {
    let mut found = Vec::new();
    for (index, material) in materials.iter().enumerate() {
        let sizes = (solids.free())
            .filter(|(_, _, number)| *number == index)
            .map(|(block, shape, _)| (block, shape.volume().cbrt()));
        let Some((block, size)) = sizes.min_by(|a, b| a.1.total_cmp(&b.1)) else {
            continue;
        };
        let pressure = material.density * gravity * size;
        for (field, what, strength) in [
            ("cohesion", "cohesion", material.cohesion),
            (
                "tensile_strength",
                "tensile strength",
                material.tensile_strength,
            ),
        ] {
            if 0.0 < strength && strength < NO_STRENGTH * pressure {
                found.push(Problem::warning(
                    Code::StrengthWithoutEffect,
                    format!("materials[{index}].{field}"),
                    format!(
                        "a {what} of {strength} Pa has no effect: block `{}` weighs {pressure:.1e} Pa on its face; {strength} kPa are {} Pa",
                        solids.named[block].0,
                        1e3 * strength
                    ),
                ));
            }
        }
    }
    found
}

/// A warning for each material so soft that a block of it overlaps another by its weight, about the block with the
/// largest overlap.
pub(super) fn soft_contacts(materials: &[Material], solids: &Solids, gravity: f64) -> Vec<Problem> {
    let mut found = Vec::new();
    for (index, material) in materials.iter().enumerate() {
        if material.joint_stiffness.is_some() {
            continue;
        }
        let stiffness = material.contact_stiffness;
        let share = |shape: &Shape| {
            let volume = shape.volume();
            material.density * volume * gravity / (stiffness * volume.cbrt())
        };
        let of_material = solids
            .free()
            .filter(|(_, _, number)| *number == index)
            .map(|(block, shape, _)| (&solids.named[block].0, share(shape)));
        let worst = of_material.max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((name, share)) = worst
            && share > NOTICED_STATIC_OVERLAP
        {
            found.push(Problem::warning(
                Code::SoftContacts,
                format!("materials[{index}].contact_stiffness"),
                format!(
                    "at rest block `{name}` overlaps another of its kind by {:.1} % of its size; a stiffness of {:.1e} N/m \
                     makes that {:.1} %",
                    100.0 * share,
                    stiffness * share / STATIC_OVERLAP,
                    100.0 * STATIC_OVERLAP
                ),
            ));
        }
    }
    found
}
