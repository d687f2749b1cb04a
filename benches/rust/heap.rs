//! Angle of repose of glass beads, by the discharging method of `cases/heap.ron`.
//!
//! `cargo bench -p riprap --bench heap -- 10 5 2` makes a heap of beads of 10, 5 and 2 mm each and prints its angle
//! beside the published one; `seed=2` makes another heap, `wide=40` one in a box of 40 instead of 20 diameters, so on a
//! plate of 30 instead of 10, `deep=8` one in a box of 8 instead of 4; `relative` one that resists the rolling of one bead
//! against the other instead of each bead's own.
#![expect(clippy::print_stdout, reason = "a benchmark reports")]

use std::path::Path;
use std::time::Instant;

use riprap::run::build;
use riprap::scene::file::{GrainRegionFile, RollingLawFile, SceneFile, ShapeFile, Triple};
use riprap::scene::parse;
use riprap::scene::resolve::Scene;
use riprap::world::World;
use riprap_dda::Vec3;

/// Diameter of the beads of the case; m.
const DIAMETER: f64 = 0.01;
/// Width and depth of the box; diameters.
const WIDTH: f64 = 20.0;
const DEPTH: f64 = 4.0;
/// Width of the outlet at each side; diameters.
const OUTLET: f64 = 5.0;
/// Rolling lengths, bead on bead and bead on wall; m.
const ROLLING: (f64, f64) = (0.05e-3, 0.1e-3);
/// The gates are open; s.
const OPEN: f64 = 0.6;
/// Zhou, Xu, Yu & Zulli (2002): diameter (mm) and angle (degrees).
const PUBLISHED: [(f64, f64); 3] = [(2.0, 26.0), (5.0, 22.0), (10.0, 19.0)];
const GRAVITY: f64 = 9.81;

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Varied parameters.
#[derive(Clone, Copy)]
struct Variant {
    /// m.
    diameter: f64,
    seed: u64,
    /// Inside the box; diameters.
    width: f64,
    depth: f64,
    law: RollingLawFile,
}

/// The case for another diameter: lengths, and what follows from them so that overlaps and times keep their
/// proportions. Only rolling, given by lengths, changes.
///
/// ```text
/// K ~ m g/d ~ d²,    t ~ √(d/g)
/// ```
fn heap(variant: &Variant) -> Result<Scene, Failure> {
    let &Variant {
        diameter,
        seed,
        width,
        depth,
        law,
    } = variant;
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../cases");
    let text = std::fs::read_to_string(folder.join("heap.ron"))?;
    let mut file: SceneFile = parse::read(&text).map_err(|error| error.message)?;
    file.numerics.rolling_law = law;
    let scale = diameter / DIAMETER;
    // what lies beyond the middle of the box moves away
    let moved = |x: f64, from: f64, to: f64| {
        let shift = if x > 0.5 * from * DIAMETER {
            (to - from) * DIAMETER
        } else {
            0.0
        };
        scale * (x + shift)
    };
    let scaled = |x: &mut Triple| {
        *x = (
            moved(x.0, WIDTH, width),
            moved(x.1, DEPTH, depth),
            scale * x.2,
        );
    };
    scaled(&mut file.domain.min);
    scaled(&mut file.domain.max);
    for block in &mut file.blocks {
        if let ShapeFile::Box { min, max } = &mut block.shape {
            scaled(min);
            scaled(max);
        }
    }
    for grains in &mut file.grains {
        if let GrainRegionFile::Box { min, max } = &mut grains.region {
            scaled(min);
            scaled(max);
        }
        grains.diameter = (diameter, diameter);
        grains.count = grains.count.map(|n| (f64::from(n) * depth / DEPTH) as u32);
        grains.seed = seed;
    }
    for material in &mut file.materials {
        material.contact_stiffness = material.contact_stiffness.map(|k| k * scale * scale);
        // the effective radius of two equal spheres is half their radius
        if material.rolling_friction > 0.0 {
            material.rolling_friction = ROLLING.0 / (0.25 * diameter);
        }
    }
    for joint in &mut file.joints {
        joint.rolling_friction = Some(ROLLING.1 / (0.5 * diameter));
    }
    file.time.duration = OPEN + 2.0 * (file.time.duration - OPEN) * scale.sqrt();
    Scene::resolve(file, &folder).map_err(|problems| {
        let words: Vec<String> = problems.into_iter().map(|p| p.message).collect();
        words.join("; ").into()
    })
}

/// Runs until no bead has left for a while and all are at rest, or to the end.
fn settle(world: &mut World, scene: &Scene, diameter: f64) -> Result<(), Failure> {
    let duration = scene.duration;
    // a bead falls its own diameter, some ten times
    let quiet = 10.0 * (diameter / GRAVITY).sqrt();
    let slow = 1e-2 * (GRAVITY * diameter).sqrt();
    let (mut left, mut since) = (0, 0.0);
    while world.time() < duration {
        let step = world.next_step(duration)?;
        world.step(step)?;
        let time = world.time();
        let fastest = || {
            let of = |b: usize| world.blocks.velocity(b).norm();
            free(world).map(of).fold(0.0, f64::max)
        };
        let gone = world.blocks.n_removed();
        if gone != left || time < OPEN {
            (left, since) = (gone, time);
        } else if time - since > quiet {
            if fastest() < slow {
                return Ok(());
            }
            since = time - 0.9 * quiet;
        }
    }
    Ok(())
}

fn free(world: &World) -> impl Iterator<Item = usize> {
    let blocks = &world.blocks;
    (0..blocks.n_blocks()).filter(|&b| blocks.is_free(b) && !blocks.is_removed(b))
}

/// Highest bead of each column one diameter wide, in slices one diameter (or the whole depth) deep.
fn surface(beads: &[Vec3], diameter: f64, slice: f64) -> Vec<Vec3> {
    let mut highest: Vec<((i64, i64), Vec3)> = Vec::new();
    for x in beads {
        let cell = (
            (x.x / diameter).floor() as i64,
            (x.y / slice).floor() as i64,
        );
        match highest.iter_mut().find(|(key, _)| *key == cell) {
            Some((_, top)) if top.z < x.z => *top = *x,
            Some(_) => {}
            None => highest.push((cell, *x)),
        }
    }
    highest.sort_by_key(|(key, _)| *key);
    highest.into_iter().map(|(_, top)| top).collect()
}

/// Angle of the least-squares line through the points at one side of the middle; degrees.
fn flank(points: &[Vec3], middle: f64, side: f64) -> f64 {
    let of: Vec<(f64, f64)> = points
        .iter()
        .map(|x| (side * (x.x - middle), x.z))
        .filter(|(off, _)| *off > 0.0)
        .collect();
    let n = of.len() as f64;
    let (x, z) = of
        .iter()
        .fold((0.0, 0.0), |(x, z), (a, b)| (x + a / n, z + b / n));
    let (covariance, variance) = of.iter().fold((0.0, 0.0), |(c, v), (a, b)| {
        (c + (a - x) * (b - z), v + (a - x) * (a - x))
    });
    (-covariance / variance).atan().to_degrees()
}

fn measure(variant: &Variant) -> Result<(), Failure> {
    let start = Instant::now();
    let scene = heap(variant)?;
    let &Variant {
        diameter,
        seed,
        width,
        depth,
        law,
    } = variant;
    let mut world = build(&scene)?;
    let n = world.blocks.n_free();
    settle(&mut world, &scene, diameter)?;
    let beads: Vec<Vec3> = free(&world).map(|b| world.blocks.centroid(b)).collect();
    let energy: f64 = free(&world).map(|b| world.blocks.kinetic_energy(b)).sum();
    let mass: f64 = free(&world).map(|b| world.blocks.mass(b)).sum();
    let middle = 0.5 * width * diameter;
    let on_plate: Vec<Vec3> = beads
        .iter()
        .filter(|x| (x.x - middle).abs() < (0.5 * width - OUTLET) * diameter && x.z > 0.0)
        .copied()
        .collect();
    let envelope = surface(&on_plate, diameter, 2.0 * depth * diameter);
    let heights: Vec<String> = envelope
        .iter()
        .map(|x| format!("{:.2}", x.z / diameter))
        .collect();
    let millimeters = 1e3 * diameter;
    let published = PUBLISHED
        .iter()
        .find(|(d, _)| (d - millimeters).abs() < 1e-6);
    println!(
        "d {millimeters} mm, {law:?}, seed {seed}, box {width} d x {depth} d: {} of {n} beads stay, {} above the plate, at rest after {:.2} s \
         (kinetic energy {:.1e} m g d), {} steps, {:.0} s of wall",
        beads.len(),
        on_plate.len(),
        world.time(),
        energy / (mass * GRAVITY * diameter),
        world.clock().steps,
        start.elapsed().as_secs_f64()
    );
    println!("  deepest overlap {:.2} % of d", {
        // the size is the cube root of the volume
        let size = (std::f64::consts::PI / 6.0).cbrt();
        100.0 * size * world.blocks.max_overlap_over_size()
    });
    println!(
        "  highest beads by columns of 1 d, in d: {}",
        heights.join(" ")
    );
    for (what, points) in [
        ("highest over the depth", envelope),
        (
            "highest in slices of 1 d",
            surface(&on_plate, diameter, diameter),
        ),
    ] {
        let (left, right) = (flank(&points, middle, -1.0), flank(&points, middle, 1.0));
        println!(
            "  {what}: left {left:.1}, right {right:.1}, mean {:.1} degrees; published {}",
            0.5 * (left + right),
            published.map_or("nothing".to_owned(), |(_, angle)| angle.to_string())
        );
    }
    Ok(())
}

fn main() -> Result<(), Failure> {
    let (mut seed, mut width, mut depth) = (1, WIDTH, DEPTH);
    let mut law = RollingLawFile::OwnSpin;
    let mut diameters = Vec::new();
    for argument in std::env::args().skip(1) {
        if let Some(value) = argument.strip_prefix("seed=") {
            seed = value.parse()?;
        } else if let Some(value) = argument.strip_prefix("wide=") {
            width = value.parse()?;
        } else if let Some(value) = argument.strip_prefix("deep=") {
            depth = value.parse()?;
        } else if argument == "relative" {
            law = RollingLawFile::Relative;
        } else if let Ok(millimeters) = argument.parse::<f64>() {
            diameters.push(1e-3 * millimeters);
        }
    }
    if diameters.is_empty() {
        diameters.push(DIAMETER);
    }
    // within the pool, so that steps of a fraction of a millisecond need not wake it
    rayon::ThreadPoolBuilder::new().build()?.install(|| {
        diameters.into_iter().try_for_each(|diameter| {
            measure(&Variant {
                diameter,
                seed,
                width,
                depth,
                law,
            })
        })
    })
}
