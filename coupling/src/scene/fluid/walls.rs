//! Walls of the fluid: method, penalty springs, and refusals.

use riprap_dda::{Polyhedron, Shape};
use riprap_sph::boundary::wall_particles::Slip;
use riprap_sph::scheme::{DensityMethod, Viscosity};
use riprap_sph::{KernelChoice, Scheme, Settings};

use super::scheme::dynamic_viscosity;
use crate::messages::Code;
use crate::scene::error::Problem;
use crate::scene::file::{DimensionsFile, InterfaceFile, Preset, SceneFile, SlipFile, vec3};
use crate::walls::WallMethod;
use crate::walls::integral::CLOSEST;
use crate::walls::penalty::{DAMPING_RATIO, STANDOFF, WallSettings};

/// Depth, in spacings, to which still water presses its lowest row into a penalty wall.
const STATIC_PENETRATION: f64 = 0.1;
/// Depth, in spacings, to which a particle at the expected speed enters a penalty wall.
const IMPACT_PENETRATION: f64 = 0.25;

/// Wall method of the file, or that of its preset.
pub(in crate::scene) fn wall_method(file: &SceneFile) -> WallMethod {
    let of_preset = match file.numerics.preset {
        Preset::Mueller2003 => WallMethod::Penalty,
        Preset::Preview | Preset::Standard | Preset::Reference => WallMethod::Particles,
    };
    file.interface.walls.map_or(of_preset, Into::into)
}

/// Slip along the walls of a method, with a warning where the method has no such slip.
pub(super) fn slip(
    file: &SceneFile,
    method: WallMethod,
    settings: &Settings,
    problems: &mut Vec<Problem>,
) -> Slip {
    let path = "interface.slip";
    let slides = match (method, file.interface.slip) {
        (WallMethod::Penalty, SlipFile::None | SlipFile::Friction(_) | SlipFile::Rough(_)) => true,
        (WallMethod::Integral, SlipFile::Friction(_)) => true,
        (WallMethod::Penalty | WallMethod::Particles | WallMethod::Integral, _) => false,
    };
    if slides {
        problems.push(Problem::warning(
            Code::OptionWithoutEffect,
            path,
            format!("the fluid slides freely along walls of the method {method:?}, which has no such slip; `walls: Particles` has all kinds"),
        ));
    }
    match file.interface.slip {
        SlipFile::Free => Slip::Free,
        SlipFile::None => Slip::None,
        SlipFile::Friction(angle_deg) => Slip::Friction(angle_deg.to_radians().tan()),
        SlipFile::Rough(roughness) => {
            let spacing = settings.mean_spacing();
            if spacing < roughness {
                problems.push(Problem::warning(
                    Code::ValueOutOfRange,
                    path,
                    format!("a sand roughness of {roughness} m is larger than the particle spacing, {spacing:.4} m, over which the law of the wall is averaged; draw such a bed, or use a larger spacing"),
                ));
            }
            if let Viscosity::Rheological { .. } = settings.scheme.viscosity {
                problems.push(Problem::error(
                    Code::IncompatibleOptions,
                    path,
                    "the law of the wall is that of water; with flow laws use `slip: None` or `slip: Friction(20)`".to_owned(),
                ));
            }
            Slip::Rough {
                roughness,
                kinematic_viscosity: molecular_viscosity(file),
            }
        }
    }
}

/// Kinematic viscosity of the fluid itself; m²/s.
pub(super) fn molecular_viscosity(file: &SceneFile) -> f64 {
    let fluid = file.fluid.as_ref();
    fluid.map_or(0.0, |f| dynamic_viscosity(f) / f.density)
}

/// Loads of the fluid on penalty springs.
pub(super) struct WallLoads {
    /// Mass of a particle; kg.
    pub(super) mass: f64,
    /// Particle spacing; m.
    pub(super) spacing: f64,
    /// Largest depth of the water at rest; m.
    pub(super) depth: f64,
    /// Fastest flow expected; m/s.
    pub(super) fastest: f64,
}

/// Penalty springs of a wall method.
///
/// ```text
/// Penalty     K_S = max(ρ₀ |g| d s/0.1, m (v/(0.25 s))²)     K_D = 2 ζ √(K_S m)       [N/m], [N s/m]
/// Integral    K_S = m (c₀/s)²
/// ```
pub(super) fn wall_settings(
    method: WallMethod,
    interface: &InterfaceFile,
    settings: &Settings,
    loads: &WallLoads,
) -> WallSettings {
    let &WallLoads {
        mass,
        spacing,
        depth,
        fastest,
    } = loads;
    let dashpot = |stiffness: f64| 2.0 * DAMPING_RATIO * (stiffness * mass).sqrt();
    let (stiffness, damping) = match method {
        WallMethod::Particles => (0.0, 0.0),
        WallMethod::Integral => {
            let stiffness = mass * (settings.sound_speed / spacing).powi(2);
            (stiffness, dashpot(stiffness))
        }
        WallMethod::Penalty => {
            let (density, gravity) = (settings.reference_density, settings.gravity.norm());
            let stiffness = interface.penalty_stiffness.unwrap_or_else(|| {
                (density * gravity * depth * spacing / STATIC_PENETRATION)
                    .max(mass * (fastest / (IMPACT_PENETRATION * spacing)).powi(2))
            });
            let damping = interface.penalty_damping;
            (stiffness, damping.unwrap_or_else(|| dashpot(stiffness)))
        }
    };
    let standoff = match method {
        WallMethod::Integral => CLOSEST,
        WallMethod::Particles | WallMethod::Penalty => STANDOFF,
    };
    WallSettings {
        stiffness,
        damping,
        particle_spacing: spacing,
        standoff: standoff * spacing,
    }
}

/// Refuses schemes that a wall method does not work with.
pub(super) fn refuse_scheme(
    file: &SceneFile,
    method: WallMethod,
    scheme: &Scheme,
    problems: &mut Vec<Problem>,
) {
    let mut refuse = |found: &str, other: &str| {
        problems.push(Problem::error(
            Code::UnusableWalls,
            "interface.walls",
            format!("{method:?} {found}; use {other}"),
        ));
    };
    let needs_continuity = "requires `numerics.density` Continuity";
    let has_rates = scheme.density == DensityMethod::Continuity;
    match method {
        WallMethod::Penalty => {}
        // they add to rates of density; a sum for the density itself does not see them
        WallMethod::Particles => {
            if !has_rates {
                refuse(needs_continuity, "Penalty");
            }
        }
        WallMethod::Integral => {
            if scheme.kernel != KernelChoice::WendlandC2 {
                refuse("is known for the kernel WendlandC2 only", "Particles");
            }
            if !has_rates {
                refuse(needs_continuity, "Particles");
            }
            if !file.domain.symmetry.is_empty() {
                refuse(
                    "does not see blocks mirrored in a plane of symmetry",
                    "Particles",
                );
            }
        }
    }
}

/// Refuses shapes for which a wall method has no walls: water would run through them.
pub(in crate::scene) fn refuse_shapes(
    file: &SceneFile,
    solids: &[(String, Shape)],
    method: WallMethod,
    problems: &mut Vec<Problem>,
) {
    if method == WallMethod::Penalty {
        return;
    }
    if method == WallMethod::Integral {
        refuse_ends(file, solids, problems);
    }
    let is_any_shape =
        method == WallMethod::Particles && file.domain.dimensions != DimensionsFile::Two;
    let hollow = |shape: &Shape| match shape {
        Shape::Sphere { .. } | Shape::Surface(_) => !is_any_shape,
        Shape::Polyhedra(_) => false,
    };
    let mut found = solids
        .iter()
        .enumerate()
        .filter(|(_, (_, shape))| hollow(shape));
    let Some((index, (name, shape))) = found.next() else {
        return;
    };
    let what = match shape {
        Shape::Sphere { .. } => "a sphere",
        _ => "a surface of triangles",
    };
    let others = match found.count() {
        0 => String::new(),
        n => format!(" and {n} more like it"),
    };
    problems.push(Problem::error(
        Code::UnusableWalls,
        format!("blocks[{index}].shape"),
        format!(
            "block `{name}`{others}: {what} has no walls of {method:?} here, and water would run through it; set \
             interface.walls to Penalty, or use a polyhedron"
        ),
    ));
}

/// Refuses solids that end within a periodic domain: integrals do not see their images.
fn refuse_ends(file: &SceneFile, solids: &[(String, Shape)], problems: &mut Vec<Problem>) {
    let (min, max) = (vec3(file.domain.min), vec3(file.domain.max));
    for axis in &file.domain.periodic {
        let k = axis.index();
        let slack = 1e-6 * (max[k] - min[k]);
        for (index, (name, shape)) in solids.iter().enumerate() {
            let Shape::Polyhedra(parts) = shape else {
                continue;
            };
            let ends = |part: &Polyhedron| {
                let places = || part.vertices().iter().map(|x| x[k]);
                places().all(|x| min[k] + slack < x) || places().all(|x| x < max[k] - slack)
            };
            if parts.iter().any(ends) {
                problems.push(Problem::error(
                    Code::UnusableWalls,
                    format!("blocks[{index}].shape"),
                    format!(
                        "interface.walls: in a domain periodic along {axis:?} Integral sees only blocks that extend through the \
                         whole period; `{name}` ends between {} and {} m: make it longer, or use Particles",
                        min[k], max[k]
                    ),
                ));
            }
        }
    }
}
