//! `riprap check`: report of the model of a scene and its cost.

mod landslide;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use riprap_dda::{Motion, Shape};

use super::{Exit, files_from, load, say, show};
use crate::run::build;
use crate::run::ineffective::ineffective_options;
use crate::scene::access::Access;
use crate::scene::estimate::Estimate;
use crate::scene::file::ShapeFile;
use crate::scene::mesh;
use crate::scene::parse::Override;
use crate::scene::resolve::Scene;
use crate::walls::WallMethod;
use crate::world::World;
use crate::world::time_step::Cause;

/// Largest wall time of the timed probe.
const PROBE_TIME: Duration = Duration::from_secs(2);
/// Largest number of steps of the probe.
const PROBE_STEPS: u32 = 50;

/// Check a scene and report its model and cost.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// The scene, a RON file; see cases/README.md.
    case: PathBuf,
    /// Set a field of the scene, e.g. --set fluid.resolution="Count(5000)"; may be repeated.
    #[arg(long = "set", value_name = "PATH=VALUE")]
    set: Vec<Override>,
    /// Allow the scene to name files outside of its folder.
    #[arg(long)]
    allow_outside: bool,
}

pub(crate) fn execute(arguments: &Arguments) -> Exit {
    let files = files_from(arguments.allow_outside);
    let scene = match load(&arguments.case, &arguments.set, files) {
        Ok(scene) => scene,
        Err(exit) => return exit,
    };
    let access = Access {
        files,
        ..Access::of(arguments.case.parent().unwrap_or(Path::new(".")))
    };
    show(&describe(&scene, &access));
    for one in ineffective_options(&scene) {
        show(&format!("  no effect at this resolution: {one}"));
    }
    match cost(&scene) {
        Ok(text) => {
            show(&text);
            Exit::Done
        }
        Err(error) => {
            say(&format!("error: {error}"));
            Exit::Failed
        }
    }
}

/// Kinematics and contact of the free blocks.
fn block_motion(scene: &Scene) -> String {
    let deformable = scene
        .blocks
        .iter()
        .filter(|b| b.deformability.is_some())
        .count();
    let kind = match deformable {
        0 => "rigid, no deformable model in this scene".to_owned(),
        n => format!("{n} deformable, the others rigid"),
    };
    let stiffest =
        |of: fn(&riprap_dda::Material) -> f64| scene.materials.iter().map(of).fold(0.0, f64::max);
    if scene.materials.iter().all(|m| m.joint_stiffness.is_some()) {
        let stiffness = stiffest(|m| m.joint_stiffness.unwrap_or(0.0));
        format!("{kind}; joint stiffness {stiffness:.3e} Pa/m")
    } else {
        format!(
            "{kind}; contact stiffness {:.3e} N/m",
            stiffest(|m| m.contact_stiffness)
        )
    }
}

/// Report of the modeled and the neglected effects, with reasons.
pub(crate) fn describe(scene: &Scene, access: &Access) -> String {
    let mut text = format!("{}\n", scene.file.title);
    let count = |test: fn(&Motion) -> bool| scene.blocks.iter().filter(|b| test(&b.motion)).count();
    let free = count(|m| matches!(m, Motion::Free));
    let fixed = count(|m| matches!(m, Motion::Fixed));
    let prescribed = count(|m| matches!(m, Motion::Prescribed(_)));
    let parts: usize = scene
        .blocks
        .iter()
        .map(|b| match &b.shape {
            Shape::Polyhedra(parts) => parts.len(),
            Shape::Sphere { .. } => 1,
            Shape::Surface(_) => 0,
        })
        .sum();
    let triangles: usize = scene
        .blocks
        .iter()
        .map(|b| match &b.shape {
            Shape::Surface(surface) => surface.triangles().len(),
            Shape::Polyhedra(_) | Shape::Sphere { .. } => 0,
        })
        .sum();
    let mut line = |what: &str, value: String| {
        let _ = writeln!(text, "  {what:<14} {value}");
    };
    line(
        "blocks",
        format!("{free} free, {prescribed} prescribed, {fixed} fixed; {parts} convex parts"),
    );
    if let Some(terrain) = &scene.terrain {
        let (low, high) = (terrain.grid.corner, terrain.grid.far_corner());
        let origin = scene
            .file
            .terrain
            .as_ref()
            .map_or((0.0, 0.0, 0.0), |t| t.origin);
        let filled = match terrain.n_filled {
            0 => String::new(),
            n => format!("; {n} points lay in gaps"),
        };
        line(
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
        );
    }
    if triangles > 0 {
        line("surfaces", format!("{triangles} triangles"));
    }
    line(
        "block motion",
        match (free, prescribed) {
            (0, 0) => "none: fixed blocks only, so no block dynamics and no contact search".into(),
            (0, _) => "prescribed only: no block dynamics, no contact search between walls".into(),
            _ => block_motion(scene),
        },
    );
    for report in &scene.rock_masses {
        line("rock mass", report.to_string());
    }
    for (what, value) in landslide::lines(scene) {
        line(what, value);
    }
    for report in &scene.grains {
        line("grains", report.to_string());
    }
    if !scene.attachments.is_empty() || !scene.holds.is_empty() {
        line(
            "constraints",
            format!(
                "{} loads, supports and bolts; {} held blocks",
                scene.attachments.len(),
                scene.holds.len()
            ),
        );
    }
    match &scene.fluid {
        None => line("fluid", "none: no fluid is modeled".into()),
        Some(fluid) => {
            let s = &fluid.settings;
            let n = fluid.lattice.positions.len();
            line(
                "fluid",
                format!(
                    "{n} particles, spacing {:.4} m, {:.1} rows in {:.3} m of depth",
                    fluid.walls.particle_spacing,
                    fluid.lattice.depth / s.particle_spacing[2],
                    fluid.lattice.depth
                ),
            );
            line(
                "scheme",
                format!(
                    "{:?}: {:?} kernel, support {:.4} m, {:?} density, {:?}, {:?}, {:?} stepping, {:?} precision",
                    scene.file.numerics.preset,
                    s.scheme.kernel,
                    s.support_radius(),
                    s.scheme.density,
                    s.scheme.diffusion,
                    s.scheme.viscosity,
                    s.scheme.stepping,
                    s.scheme.precision,
                ),
            );
            line(
                "sound speed",
                format!(
                    "{:.2} m/s, {:.1} times the fastest expected {:.2} m/s",
                    s.sound_speed,
                    s.sound_speed / fluid.expected_speed.max(1e-300),
                    fluid.expected_speed
                ),
            );
            if let Some(sleeping) = &fluid.sleeping {
                line(
                    "sleep",
                    format!(
                        "until the water beside it moves by {} spacings; at rest below {:.2e} m/s for {:.3} s",
                        sleeping.displacement, sleeping.speed, sleeping.time
                    ),
                );
            }
            line(
                "walls",
                match fluid.wall_method {
                    WallMethod::Penalty => format!(
                        "penalty, K_S {:.3e} N/m, K_D {:.3e} N s/m, from half a spacing off the surface",
                        fluid.walls.stiffness, fluid.walls.damping
                    ),
                    WallMethod::Particles => {
                        "particles inside, pressure extrapolated from the fluid".to_owned()
                    }
                    WallMethod::Integral => format!(
                        "kernel integrals over polyhedra; penalty {:.3e} N/m within {:.3e} m of the surface",
                        fluid.walls.stiffness, fluid.walls.standoff
                    ),
                },
            );
        }
    }
    for (block, file, scale) in scene.file.blocks.iter().filter_map(|b| match &b.shape {
        ShapeFile::Mesh { file, scale } => Some((b, file, *scale)),
        _ => None,
    }) {
        // the scene was resolved, so its meshes can be read
        if let Ok(found) = mesh::survey(access, file, scale) {
            let size = found.max - found.min;
            line(
                "mesh",
                format!(
                    "`{}` from {file}: watertight {}, {} shells, {} triangles, {:.6} m3, box {:.3} x {:.3} x {:.3} m",
                    block.name,
                    if found.is_watertight { "yes" } else { "no" },
                    found.n_shells,
                    found.n_triangles,
                    found.volume,
                    size.x,
                    size.y,
                    size.z
                ),
            );
        }
    }
    let axes: Vec<String> = scene
        .file
        .domain
        .periodic
        .iter()
        .map(|a| format!("{a:?}"))
        .collect();
    if !axes.is_empty() {
        line("periodic", format!("along {}", axes.join(", ")));
    }
    let sides = &scene.file.domain.symmetry;
    if !sides.is_empty() {
        let sides: Vec<String> = sides.iter().map(|side| format!("{side:?}")).collect();
        line(
            "symmetry",
            format!(
                "in {}; loads and energies are those of this part",
                sides.join(", ")
            ),
        );
    }
    let time = &scene.file.time;
    let settling = match (&scene.fluid, time.settle > 0.0) {
        (Some(_), true) => format!(", after {} s of settling with blocks held", time.settle),
        _ => String::new(),
    };
    line("time", format!("{} s{settling}", time.duration));
    line("memory", Estimate::of(scene).to_string());
    text.pop();
    text
}

/// Step limits, steps, memory, disk and wall time from a timed probe.
fn cost(scene: &Scene) -> Result<String, crate::run::RunError> {
    let mut world = build(scene)?;
    let duration = scene.file.time.duration;
    let settle = if scene.fluid.is_some() {
        scene.file.time.settle
    } else {
        0.0
    };
    let mut text = String::new();
    let limits = world.limits();
    let step = world.next_step(duration)?;
    let borne = world.stability();
    let _ = writeln!(text, "  step limits");
    for (cause, limit) in limits
        .common
        .iter()
        .copied()
        .chain([(Cause::Contact, limits.blocks)])
    {
        let value = if limit.is_finite() {
            format!("{limit:.3e} s")
        } else {
            "no limit".into()
        };
        let governs = if cause == step.cause {
            "  <- governs"
        } else {
            ""
        };
        let stable = borne
            .iter()
            .find(|(other, _)| *other == cause)
            .map_or(String::new(), |(_, dt)| format!(", stable to {dt:.3e} s"));
        let name = format!("{cause:?}").to_lowercase();
        let _ = writeln!(text, "    {name:<12} {value}{stable}{governs}");
    }
    let steps = ((duration + settle) / step.dt).ceil();
    let _ = writeln!(
        text,
        "  steps          about {steps:.0}, {} block sub-steps in each",
        step.block_substeps
    );
    let n = scene
        .fluid
        .as_ref()
        .map_or(0, |f| f.lattice.positions.len()) as f64;
    let output = &scene.file.output;
    let frames = duration / output.frame_interval.unwrap_or(duration);
    // measured: about 30 bytes a particle and frame, compressed
    let disk = frames * n * 30.0 + duration / output.gauge_interval.unwrap_or(duration) * 500.0;
    let _ = writeln!(
        text,
        "  disk           about {:.0} MB in {frames:.0} frames",
        disk / 1e6
    );
    let (taken, mut wall) = wall_time(&mut world, duration, steps)?;
    drop(world);
    let mut asleep = String::new();
    if scene.fluid.as_ref().is_some_and(|f| f.sleeping.is_some()) {
        let mut awake = scene.clone();
        if let Some(fluid) = &mut awake.fluid {
            fluid.sleeping = None;
        }
        asleep = format!(" with all water awake, {wall:.0} s with the initial sleep,");
        wall = wall_time(&mut build(&awake)?, duration, steps)?.1;
    }
    let _ = write!(
        text,
        "  wall time      about {wall:.0} s{asleep} with {} threads, from {taken} steps on this machine",
        rayon::current_num_threads(),
    );
    Ok(text)
}

/// Takes some steps; returns their number, and the predicted wall time of a run, s.
fn wall_time(
    world: &mut World,
    duration: f64,
    steps: f64,
) -> Result<(u32, f64), crate::run::RunError> {
    let (taken, wall) = probe(world, duration)?;
    Ok((taken, wall.as_secs_f64() / f64::from(taken) * steps))
}

/// Takes some steps and measures their time.
fn probe(world: &mut World, duration: f64) -> Result<(u32, Duration), crate::run::RunError> {
    let start = Instant::now();
    let mut taken = 0;
    while taken < PROBE_STEPS && start.elapsed() < PROBE_TIME {
        let step = world.next_step(duration)?;
        world.step(step)?;
        taken += 1;
    }
    Ok((taken, start.elapsed()))
}
