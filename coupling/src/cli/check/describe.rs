//! Report of the modeled and the neglected effects, with reasons: one function per subject.

use std::fmt::Write as _;

use super::facts::{Blocks, Water};
use super::{kernel, landslide, water};
use crate::scene::estimate::Estimate;
use crate::scene::resolved::recording::Barrier;
use crate::scene::resolved::{FluidScene, GrainList, MeshSource, Scene, ViscousSteps};
use crate::scene::terrain::Terrain;
use crate::scene::terrain::triangles::Quality;
use crate::walls::WallMethod;
use riprap_dda::{ContactDynamics, Integrator};
use riprap_sph::boundary::wall_law::WallLaw;
use riprap_sph::boundary::wall_particles::Slip;
use riprap_sph::scheme::{Viscosity, ViscousStep};

/// Heading and text of a line.
pub(super) type Line = (&'static str, String);

/// Subjects of the report, in order.
const SUBJECTS: [fn(&Scene) -> Vec<Line>; 15] = [
    blocks,
    terrain,
    surfaces,
    block_motion,
    rock_masses,
    landslide::lines,
    grains,
    constraints,
    fluid,
    kernel::thinnest,
    water::amounts,
    water::wave_makers,
    meshes,
    borders,
    barriers,
];

/// Lines of the report.
pub(super) fn lines(scene: &Scene) -> impl Iterator<Item = Line> + '_ {
    (SUBJECTS.iter().flat_map(|subject| subject(scene)))
        .chain([time(scene), ("memory", Estimate::of(scene).to_string())])
}

/// Report of the modeled and the neglected effects, with reasons.
pub(crate) fn describe(scene: &Scene) -> String {
    let lines = lines(scene);
    let mut text = scene.title.clone();
    for (heading, value) in lines {
        let _ = write!(text, "\n  {heading:<14} {value}");
    }
    text
}

fn blocks(scene: &Scene) -> Vec<Line> {
    let Blocks {
        free,
        prescribed,
        fixed,
        convex_parts,
        triangles: _,
    } = Blocks::of(scene);
    vec![(
        "blocks",
        format!("{free} free, {prescribed} prescribed, {fixed} fixed; {convex_parts} convex parts"),
    )]
}

fn terrain(scene: &Scene) -> Vec<Line> {
    let Some(terrain) = &scene.terrain else {
        return Vec::new();
    };
    let (low, high) = (terrain.grid.corner, terrain.grid.far_corner());
    let origin = terrain.origin;
    let filled = match terrain.n_filled {
        0 => String::new(),
        n => format!("; {n} points lay in gaps"),
    };
    let clouds = terrain.clouds.iter();
    let mut lines: Vec<Line> = clouds
        .map(|(file, report)| ("cloud", format!("`{file}`: {report}")))
        .collect();
    lines.push((
        "terrain",
        format!(
            "{} x {} points {} m apart, x from {:.3} to {:.3}, y from {:.3} to {:.3}; (0, 0, 0) is ({}, {}, {}) on the map{filled}",
            terrain.grid.n[0],
            terrain.grid.n[1],
            terrain.grid.spacing,
            low[0],
            high[0],
            low[1],
            high[1],
            origin.0,
            origin.1,
            origin.2
        ),
    ));
    lines.push(("ground", fit(terrain)));
    lines
}

/// Errors and angles of the triangles of terrain, and the time they took.
fn fit(terrain: &Terrain) -> String {
    let Quality {
        fit,
        smallest_angle,
        smallest_angle_beside,
    } = terrain.quality;
    let beside = if terrain.is_excavated {
        format!(
            "; beside outlines {:.3} m and {:.1} degrees",
            fit.beside_outlines,
            smallest_angle_beside.to_degrees()
        )
    } else {
        String::new()
    };
    format!(
        "within {:.3} m, {}: above the points by at most {:.3} m, below by {:.3} m, smallest angle {:.1} degrees{beside}; \
         read in {:.2} s, triangles in {:.2} s",
        terrain.tolerance,
        terrain.tolerance_of,
        fit.above,
        fit.below,
        smallest_angle.to_degrees(),
        terrain.making.reading.as_secs_f64(),
        terrain.making.triangles.as_secs_f64()
    )
}

fn surfaces(scene: &Scene) -> Vec<Line> {
    match Blocks::of(scene).triangles {
        0 => Vec::new(),
        n => vec![("surfaces", format!("{n} triangles"))],
    }
}

fn block_motion(scene: &Scene) -> Vec<Line> {
    let Blocks {
        free, prescribed, ..
    } = Blocks::of(scene);
    let text = match (free, prescribed) {
        (0, 0) => "none: fixed blocks only, so no block dynamics and no contact search".into(),
        (0, _) => "prescribed only: no block dynamics, no contact search between walls".into(),
        _ => kinematics(scene),
    };
    vec![("block motion", text)]
}

/// Kinematics and contact of the free blocks.
fn kinematics(scene: &Scene) -> String {
    let deformable = scene.blocks.iter().filter(|b| b.deformability.is_some());
    let kind = match deformable.count() {
        0 => "rigid, no deformable model in this scene".to_owned(),
        n => format!("{n} deformable, the others rigid"),
    };
    if let Integrator::ContactDynamics(dynamics) = scene.block_settings.integrator {
        return format!("{kind}; {}", in_contact_dynamics(&dynamics));
    }
    let stiffest =
        |of: fn(&riprap_dda::Material) -> f64| scene.materials.iter().map(of).fold(0.0, f64::max);
    if scene.materials.iter().all(|m| m.joint_stiffness.is_some()) {
        let stiffness = stiffest(|m| m.joint_stiffness.unwrap_or(0.0));
        format!("{kind}; joint stiffness {stiffness:.3e} Pa/m")
    } else {
        let stiffness = stiffest(|m| m.contact_stiffness);
        let (at_rest, at_speed) = overlaps(scene, stiffness);
        format!(
            "{kind}; contact stiffness {stiffness:.3e} N/m: blocks overlap by up to {:.2} % of their size at rest, {:.1} % in a hit \
             at {:.1} m/s",
            100.0 * at_rest,
            100.0 * at_speed,
            scene.expected_speed
        )
    }
}

fn in_contact_dynamics(dynamics: &ContactDynamics) -> String {
    let ContactDynamics {
        time_step,
        tolerance,
        n_iterations,
        solver: _,
    } = dynamics;
    format!(
        "contacts solved together to {tolerance:.0e} in at most {n_iterations} sweeps, without springs, in steps of {time_step:.2e} s; impacts \
         and changes between sticking and sliding are good to the first order of the step"
    )
}

/// Largest overlaps of the free blocks over their size, at rest `m g/(K L)` and in a hit on something fixed `v √(m/K)/L`; –.
fn overlaps(scene: &Scene, stiffness: f64) -> (f64, f64) {
    let gravity = scene.gravity.norm();
    let free = (scene.blocks.iter()).filter(|b| matches!(b.motion, riprap_dda::Motion::Free));
    free.map(|block| {
        let volume = block.shape.volume();
        let (mass, size) = (
            scene.materials[block.material].density * volume,
            volume.cbrt(),
        );
        let hit = scene.expected_speed * (mass / stiffness).sqrt();
        (mass * gravity / (stiffness * size), hit / size)
    })
    .fold((0.0, 0.0), |a, b| (f64::max(a.0, b.0), f64::max(a.1, b.1)))
}

fn rock_masses(scene: &Scene) -> Vec<Line> {
    let reports = scene.rock_masses.iter();
    reports.map(|r| ("rock mass", r.to_string())).collect()
}

fn grains(scene: &Scene) -> Vec<Line> {
    let reports = scene.grains.iter();
    let mut lines: Vec<Line> = reports.map(|r| ("grains", r.to_string())).collect();
    if let Some(fluid) = &scene.fluid {
        let of = |list| ("in water", in_water(list, fluid));
        lines.extend(scene.grain_lists.iter().map(of));
    }
    lines
}

/// Forces between the grains of a list and the water, and why.
fn in_water(list: &GrainList, fluid: &FluidScene) -> String {
    let width = 0.5 * (list.diameters[0] + list.diameters[1]) / fluid.settings.mean_spacing();
    let name = &list.name;
    match fluid.averaged.as_ref().filter(|_| list.is_averaged) {
        None => format!("`{name}`: resolved, water flows around grains of {width:.1} spacings"),
        Some(averaged) => format!(
            "`{name}`: averaged, grains of {width:.1} spacings share space with the water; drag by {:?}, kernel of {} diameters, {} added mass",
            averaged.settings.drag,
            averaged.settings.kernel_radius,
            match averaged.settings.has_added_mass {
                true => "with",
                false => "without",
            }
        ),
    }
}

fn constraints(scene: &Scene) -> Vec<Line> {
    if scene.attachments.is_empty() && scene.holds.is_empty() {
        return Vec::new();
    }
    vec![(
        "constraints",
        format!(
            "{} loads, supports and bolts; {} held blocks",
            scene.attachments.len(),
            scene.holds.len()
        ),
    )]
}

fn fluid(scene: &Scene) -> Vec<Line> {
    let Some(fluid) = &scene.fluid else {
        return vec![("fluid", "none: no fluid is modeled".into())];
    };
    let s = &fluid.settings;
    let water = Water::of(fluid, scene);
    let mut lines = vec![
        (
            "fluid",
            format!(
                "{} particles, spacing {:.4} m, {:.1} rows in {:.3} m of depth",
                water.particles, water.spacing_m, water.rows_in_depth, water.depth_m
            ),
        ),
        (
            "scheme",
            format!(
                "{:?}: {:?} kernel, support {:.4} m, {:?} density, {:?}, {:?}, bulk viscosity {}, {:?} stepping, {:?} precision",
                fluid.preset,
                s.scheme.kernel,
                water.support_m,
                s.scheme.density,
                s.scheme.diffusion,
                s.scheme.viscosity,
                s.scheme.bulk_viscosity,
                s.scheme.stepping,
                s.scheme.precision,
            ),
        ),
        (
            "sound speed",
            format!(
                "{:.2} m/s, {:.1} times the fastest expected {:.2} m/s",
                water.sound_speed_m_per_s,
                water.sound_speed_m_per_s / water.expected_speed_m_per_s.max(1e-300),
                water.expected_speed_m_per_s
            ),
        ),
    ];
    if let Some(sleeping) = &fluid.sleeping {
        lines.push((
            "sleep",
            format!(
                "until the water beside it moves by {} spacings; at rest below {:.2e} m/s for {:.3} s",
                sleeping.displacement, sleeping.speed, sleeping.time
            ),
        ));
    }
    if s.scheme.viscosity.is_after_morris() {
        lines.push(("viscous step", viscous_step(fluid)));
    }
    lines.push(("walls", walls(fluid)));
    lines.push(("friction", friction(fluid, scene.fastest_flow)));
    lines
}

/// Viscous steps, and why they are explicit or implicit.
fn viscous_step(fluid: &FluidScene) -> String {
    let ViscousSteps {
        ratio,
        viscosity,
        is_given,
        refused,
    } = &fluid.viscous_steps;
    let given = if *is_given { ", as given" } else { "" };
    let share = match 1.0 < *ratio {
        true => format!("{ratio:.1} times shorter than that of sound"),
        false => format!("{:.2} times that of sound", 1.0 / ratio),
    };
    let explicit = format!("an explicit one with {viscosity:.3e} Pa s is {share}");
    match (fluid.settings.scheme.viscous_step, refused) {
        (ViscousStep::Implicit, _) => format!("implicit{given}: {explicit}"),
        (ViscousStep::Explicit, Some(refused)) => format!("explicit: {refused}; {explicit}"),
        (ViscousStep::Explicit, None) if *is_given => format!("explicit{given}: {explicit}"),
        (ViscousStep::Explicit, None) => {
            format!("explicit: {explicit}, and implicit ones pay beyond twice")
        }
    }
}

/// Friction of the walls, and how far a film of one spacing goes before the law of the wall has halved its speed (m/s).
fn friction(fluid: &FluidScene, speed: f64) -> String {
    let settings = &fluid.settings;
    let is_mud = matches!(settings.scheme.viscosity, Viscosity::Rheological { .. });
    let halved = |roughness, kinematic_viscosity| {
        let law = WallLaw {
            height: settings.mean_spacing(),
            kinematic_viscosity,
            roughness,
        };
        let per_length = law.stress_over_density(speed) / (speed * speed * law.height);
        format!(
            "a film of one spacing at {speed:.2} m/s halves its speed within {:.3} m",
            std::f64::consts::LN_2 / per_length
        )
    };
    match fluid.slip {
        Slip::Free if is_mud || speed <= 0.0 => "none".to_owned(),
        Slip::Free => format!(
            "none; by the law of the wall, `slip: Rough(0)` for smooth walls, {}",
            halved(0.0, fluid.molecular_viscosity)
        ),
        Slip::None => "no slip, with the viscosity of the scheme".to_owned(),
        Slip::Friction(coefficient) => {
            format!("no slip up to Coulomb friction of {coefficient:.3}")
        }
        Slip::Rough {
            roughness,
            kinematic_viscosity,
        } => format!(
            "law of the wall, sand roughness {roughness} m; {}",
            halved(roughness, kinematic_viscosity)
        ),
    }
}

fn walls(fluid: &FluidScene) -> String {
    let walls = &fluid.walls;
    match fluid.wall_method {
        WallMethod::Penalty => format!(
            "penalty, K_S {:.3e} N/m, K_D {:.3e} N s/m, from half a spacing off the surface",
            walls.stiffness, walls.damping
        ),
        WallMethod::Particles => {
            "particles inside, pressure extrapolated from the fluid".to_owned()
        }
        WallMethod::Integral => format!(
            "kernel integrals over polyhedra; penalty {:.3e} N/m within {:.3e} m of the surface",
            walls.stiffness, walls.standoff
        ),
    }
}

/// Meshes of blocks, as they are found in their files, and as they are modeled.
fn meshes(scene: &Scene) -> Vec<Line> {
    let mut lines = Vec::new();
    for MeshSource {
        block,
        file,
        survey,
        deviation,
    } in &scene.meshes
    {
        let size = survey.max - survey.min;
        let split = deviation.map_or(String::new(), |found| {
            format!("; not convex: split into {found}")
        });
        lines.push((
            "mesh",
            format!(
                "`{}` from {file}: watertight {}, {} shells, {} triangles, {:.6} m3, box {:.3} x {:.3} x {:.3} m{split}",
                scene.block_names[*block],
                if survey.is_watertight { "yes" } else { "no" },
                survey.n_shells,
                survey.n_triangles,
                survey.drawn.volume,
                size.x,
                size.y,
                size.z
            ),
        ));
    }
    lines
}

/// Sides of the domain that are periodic or planes of symmetry.
fn borders(scene: &Scene) -> Vec<Line> {
    let domain = &scene.domain;
    let axes: Vec<String> = domain.periodic.iter().map(|a| format!("{a:?}")).collect();
    let sides: Vec<String> = domain.symmetry.iter().map(|s| format!("{s:?}")).collect();
    let mut lines = Vec::new();
    if !axes.is_empty() {
        lines.push(("periodic", format!("along {}", axes.join(", "))));
    }
    if !sides.is_empty() {
        lines.push((
            "symmetry",
            format!(
                "in {}; loads and energies are those of this part",
                sides.join(", ")
            ),
        ));
    }
    lines
}

/// Size of each recorded barrier, and of its cells.
fn barriers(scene: &Scene) -> Vec<Line> {
    let line = |barrier: &Barrier| {
        let openings: Vec<String> = (barrier.openings.iter())
            .map(|opening| format!("{:.3}", opening.across[1] - opening.across[0]))
            .collect();
        let openings = match openings.is_empty() {
            true => String::new(),
            false => format!(", openings of {} m", openings.join(", ")),
        };
        let text = format!(
            "`{}`: {} blocks, {:.3} x {:.3} m across the flow, in cells of {:.4} m{openings}; speed and depth over {:.3} m upstream",
            barrier.name,
            barrier.blocks.len(),
            barrier.width(),
            barrier.height(),
            barrier.cell,
            barrier.upstream
        );
        ("barrier", text)
    };
    scene.barriers.iter().map(line).collect()
}

fn time(scene: &Scene) -> Line {
    let settling = match &scene.settle_blocks {
        Some(asked) => {
            let gates: Vec<String> = (asked.gates.iter())
                .map(|&gate| format!("`{}`", scene.block_names[gate]))
                .collect();
            let gates = match gates.is_empty() {
                true => String::new(),
                false => format!(", behind {}, removed at t = 0", gates.join(", ")),
            };
            format!(
                ", after settling of the blocks until nothing is faster than {} m/s for {} s, {} s at most{gates}",
                asked.speed, asked.time, asked.at_most
            )
        }
        None if scene.longest_settling() > 0.0 => {
            format!(", after {} s of settling with blocks held", scene.settle)
        }
        None => String::new(),
    };
    ("time", format!("{} s{settling}", scene.duration))
}
