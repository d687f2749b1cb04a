//! From a read scene to a checked one: geometry built, water filled in, every number chosen.

use std::path::Path;

use riprap_dda::{BlockDefinition, Material, Motion, PrescribedMotion, Shape};

use crate::scene::access::Access;
use crate::scene::attachments::{
    attachments, contact_detection, deformability, hold, joints, normal_law, rolling_law,
    static_damping, weakenings,
};
use crate::scene::error::{Problem, Severity};
use crate::scene::estimate;
pub use crate::scene::file::vec3;
use crate::scene::file::{OutputFile, SceneFile, TerrainFile};
use crate::scene::fill::{Lattice, Room, lattice_within, narrow_gaps, overlaps};
use crate::scene::fluid::mould_rows;
use crate::scene::geometry::rock_mass::expand;
use crate::scene::geometry::shape::solid_on;
use crate::scene::geometry::terrain::{self, Terrain};
use crate::scene::geometry::{grains, slides};
use crate::scene::motion::motion;
pub use crate::scene::resolved::{FluidScene, Scene};
use crate::series::Series;

/// A problem with places, where the scene is part of a map.
fn on_the_map(problem: Problem, terrain: Option<&TerrainFile>) -> Problem {
    match terrain.map(|terrain| terrain.origin) {
        Some((x, y, z)) if problem.message.contains(") m") => Problem {
            message: format!(
                "{}; on the map (0, 0, 0) is ({x}, {y}, {z}) m",
                problem.message
            ),
            ..problem
        },
        _ => problem,
    }
}

/// Safety factor of the block step, the customary share of the bound from the contact network.
const BLOCK_TIME_STEP_FACTOR: f64 = 0.8;
/// Blocks press into each other by no more than this share of their size under their weight.
const STATIC_OVERLAP: f64 = 1e-3;
/// Blocks enter each other by no more than this share of their size at the expected speed.
const IMPACT_OVERLAP: f64 = 0.02;
/// Nor by more than this share of the thickness of the thinnest block: half of what a step allows.
const IMPACT_SHARE_OF_THICKNESS: f64 = 0.25;
/// From this share of its size on the user should know how far a block sinks in at rest.
const NOTICED_STATIC_OVERLAP: f64 = 1e-2;
/// Looks at a falling block in a run: at 20 s one per 0.02 s, which misses 0.5 mm of the top of a leap.
const TRAJECTORY_SAMPLES: f64 = 1000.0;
/// Points of maps stand this far apart: waves that water of this spacing has are longer; × particle spacing.
const MAP_SPACING: f64 = 2.0;
/// Looks at the water for maps in a run.
const MAP_LOOKS: f64 = 200.0;
/// Water that rises by this has noticed; × particle spacing.
const NOTICED_RISE: f64 = 0.25;
/// Contact stiffness of scenes in which no block can move; N/m.
const IDLE_STIFFNESS: f64 = 1e6;

impl Scene {
    /// Builds what the file describes. Files that it names are in `folder`.
    ///
    /// # Errors
    ///
    /// All problems of the geometry together.
    pub fn resolve(file: SceneFile, folder: &Path) -> Result<Self, Vec<Problem>> {
        Self::resolve_within(file, &Access::of(folder))
    }

    /// Builds what the file describes, in reach of files and memory.
    ///
    /// # Errors
    ///
    /// All problems of the geometry together.
    pub fn resolve_within(mut file: SceneFile, access: &Access) -> Result<Self, Vec<Problem>> {
        let terrain = terrain::resolve(&mut file, access)?;
        let mut rock_masses = expand(&mut file, access)?;
        rock_masses.extend(slides::expand(&mut file, terrain.as_ref())?);
        let bytes = access
            .memory
            .map_or(f64::INFINITY, |memory| memory.bytes as f64);
        let grains = grains::expand(&mut file, (bytes / estimate::PER_BLOCK) as usize)?;
        let mut problems = Vec::new();
        if let Some(terrain) = &terrain {
            problems.extend(terrain.questions.iter().cloned());
        }
        let solids = named_solids(&file, (access, terrain.as_ref()), &mut problems);
        let motions = motions(&file, access, &mut problems);
        if solids.len() != file.blocks.len() || motions.len() != file.blocks.len() {
            return Err(problems);
        }
        problems.extend(overlaps(&solids, &motions));
        super::symmetry::refuse_blocks(&file, &solids, &motions, &mut problems);
        let room = Room {
            bytes,
            bytes_per_particle: estimate::PER_PARTICLE,
        };
        let mut lattice = match &file.fluid {
            None => None,
            Some(fluid) => lattice_within(fluid, &file.domain, &solids, mould_rows(&file), room)
                .map_err(|found| {
                    let placed = found
                        .into_iter()
                        .map(|p| on_the_map(p, file.terrain.as_ref()));
                    problems.extend(placed);
                })
                .ok(),
        };
        if problems.iter().any(|p| p.severity == Severity::Error) {
            return Err(problems);
        }
        problems.extend(
            lattice
                .as_ref()
                .and_then(|water| narrow_gaps(&solids, water, file.domain.dimensions)),
        );

        if let Some(lattice) = &mut lattice {
            super::flow::start(lattice, &file);
        }
        let speed = expected_speed(&file, &solids, &motions, lattice.as_ref());
        file.numerics.expected_speed.get_or_insert(speed);
        resolve_output(&mut file.output, file.time.duration);
        if let Some(forces) = &mut file.forces {
            let interval = file.output.gauge_interval;
            forces.interval = forces.interval.or(interval);
        }
        if let Some(trajectories) = &mut file.trajectories {
            let interval = &mut trajectories.interval;
            interval.get_or_insert(file.time.duration / TRAJECTORY_SAMPLES);
        }
        if let (Some(maps), Some(water)) = (&mut file.maps, &lattice) {
            let [dx, dy, dz] = water.spacing;
            let spacing = (dx * dy * dz).cbrt();
            maps.spacing.get_or_insert(MAP_SPACING * spacing);
            maps.interval.get_or_insert(file.time.duration / MAP_LOOKS);
            maps.arrival_threshold.get_or_insert(NOTICED_RISE * spacing);
        }
        resolve_stiffness(&mut file, &solids, &motions, speed);
        problems.extend(soft_contacts(&file, &solids, &motions));
        let fluid =
            lattice.map(|lattice| super::fluid::resolve(&mut file, lattice, speed, &mut problems));
        if let Some(fluid) = &fluid {
            super::fluid::refuse_shapes(&file, &solids, fluid.wall_method, &mut problems);
        }
        if problems.iter().any(|p| p.severity == Severity::Error) {
            return Err(problems);
        }
        let block_factor = *file
            .numerics
            .block_time_step_factor
            .get_or_insert(BLOCK_TIME_STEP_FACTOR);

        let blocks = solids
            .into_iter()
            .zip(motions)
            .zip(&file.blocks)
            .map(|(((_, shape), motion), block)| BlockDefinition {
                shape,
                // validation has verified that the name exists
                material: file
                    .materials
                    .iter()
                    .position(|m| m.name == block.material)
                    .unwrap_or(0),
                motion,
                velocity: vec3(block.velocity),
                angular_velocity: vec3(block.angular_velocity),
                deformability: block.deformable.as_ref().map(deformability),
            })
            .collect::<Vec<_>>();
        let resting = super::sleep::resting(&mut file, &blocks, &mut problems);
        if problems.iter().any(|p| p.severity == Severity::Error) {
            return Err(problems);
        }
        Ok(Self {
            terrain,
            rock_masses,
            grains,
            attachments: attachments(&file, &blocks),
            holds: file
                .blocks
                .iter()
                .enumerate()
                .filter_map(|(number, block)| Some((number, hold(block.hold.as_ref()?))))
                .collect(),
            blocks,
            materials: materials(&file),
            joints: joints(&file),
            weakenings: weakenings(&file),
            block_settings: riprap_dda::Settings {
                gravity: vec3(file.gravity),
                time_step_factor: block_factor,
                contact_detection: contact_detection(file.numerics.contact_detection),
                normal_law: normal_law(file.numerics.normal_law),
                rolling_law: rolling_law(file.numerics.rolling_law),
                static_damping: file.numerics.static_damping.map(static_damping),
                resting,
                ..riprap_dda::Settings::default()
            },
            fluid,
            warnings: problems,
            file,
        })
    }
}

fn named_solids(
    file: &SceneFile,
    (access, terrain): (&Access, Option<&Terrain>),
    problems: &mut Vec<Problem>,
) -> Vec<(String, Shape)> {
    let mut solids = Vec::new();
    for (index, block) in file.blocks.iter().enumerate() {
        match solid_on(block, index, access, terrain) {
            Ok(shape) => solids.push((block.name.clone(), shape)),
            Err(found) => problems.extend(found),
        }
    }
    solids
}

fn motions(file: &SceneFile, access: &Access, problems: &mut Vec<Problem>) -> Vec<Motion> {
    let mut motions = Vec::new();
    for (index, block) in file.blocks.iter().enumerate() {
        match motion(&block.motion, &format!("blocks[{index}].motion"), access) {
            Ok(found) => motions.push(found),
            Err(problem) => problems.push(problem),
        }
    }
    motions
}

/// Fastest motion that the scene suggests: long waves, falls to the still-water level (or to the
/// bottom of the domain), prescribed and initial velocities; m/s.
fn expected_speed(
    file: &SceneFile,
    solids: &[(String, Shape)],
    motions: &[Motion],
    lattice: Option<&Lattice>,
) -> f64 {
    if let Some(given) = file.numerics.expected_speed {
        return given;
    }
    let gravity = vec3(file.gravity).norm();
    let depth = lattice.map_or(0.0, |l| l.depth);
    let floor = lattice.map_or(file.domain.min.2, |l| l.still_water_level);
    let mut fastest = (gravity * depth).sqrt();
    for ((motion, (_, shape)), block) in motions.iter().zip(solids).zip(&file.blocks) {
        let speed = match motion {
            Motion::Fixed => 0.0,
            Motion::Prescribed(prescribed) => {
                let (min, max) = shape.aabb();
                largest_speed(prescribed, 0.5 * (max - min).norm(), file.time.duration)
            }
            Motion::Free => {
                let drop = (shape.aabb().0.z - floor).max(0.0);
                (vec3(block.velocity).norm_squared() + 2.0 * gravity * drop).sqrt()
            }
        };
        fastest = fastest.max(speed);
    }
    for region in file.fluid.iter().flat_map(|fluid| &fluid.regions) {
        fastest = fastest.max(vec3(region.velocity).norm());
    }
    for inflow in &file.inflows {
        let (axis, _) = inflow.towards.axis();
        let extent = vec3(inflow.max) - vec3(inflow.min);
        let across = extent[1 - axis.min(1)];
        for &(_, velocity) in &inflow.velocity {
            fastest = fastest.max(velocity);
        }
        for &(time, discharge) in &inflow.discharge {
            let depth = if inflow.depth.is_empty() {
                extent.z
            } else {
                Series::new(inflow.depth.clone()).at(time)
            };
            fastest = fastest.max(discharge / (across * depth).max(f64::MIN_POSITIVE));
        }
    }
    fastest
}

/// Largest speed of a body of a radius (m).
fn largest_speed(motion: &PrescribedMotion, radius: f64, duration: f64) -> f64 {
    // a thousand looks find the maximum of any record a laboratory would drive
    let speed = |t: f64| motion.velocity(t).norm() + motion.spin(t).norm() * radius;
    (0..=1000)
        .map(|i| speed(duration * f64::from(i) / 1000.0))
        .fold(0.0, f64::max)
}

fn resolve_output(output: &mut OutputFile, duration: f64) {
    output.frame_interval.get_or_insert(duration / 50.0);
    let gauge = *output.gauge_interval.get_or_insert(duration / 500.0);
    output.ledger_interval.get_or_insert(gauge);
}

/// Gives every material without a contact stiffness the one its heaviest demand asks for.
///
/// ```text
/// K ≥ m g/(ε L)   overlap ε L at rest,        K ≥ m v²/(η L)²   overlap η L at speed v
/// ```
/// neither above a quarter of the thickness of the thinnest block.
fn resolve_stiffness(
    file: &mut SceneFile,
    solids: &[(String, Shape)],
    motions: &[Motion],
    speed: f64,
) {
    let gravity = vec3(file.gravity).norm();
    let thinnest = solids
        .iter()
        .map(|(_, shape)| shape.thickness())
        .fold(f64::INFINITY, f64::min);
    let deepest = IMPACT_SHARE_OF_THICKNESS * thinnest;
    let mut stiffness: f64 = 0.0;
    for (((_, shape), motion), block) in solids.iter().zip(motions).zip(&file.blocks) {
        let density = file
            .materials
            .iter()
            .find(|m| m.name == block.material)
            .map_or(0.0, |m| m.density);
        if matches!(motion, Motion::Free) {
            let size = shape.volume().cbrt();
            let mass = density * shape.volume();
            stiffness = stiffness
                .max(mass * gravity / (STATIC_OVERLAP * size).min(deepest))
                .max(mass * (speed / (IMPACT_OVERLAP * size).min(deepest)).powi(2));
        }
    }
    if stiffness == 0.0 {
        stiffness = IDLE_STIFFNESS;
    }
    for material in &mut file.materials {
        material.contact_stiffness.get_or_insert(stiffness);
    }
}

/// A warning for each material so soft that a block of it sinks in by its weight, of the block that does most.
fn soft_contacts(file: &SceneFile, solids: &[(String, Shape)], motions: &[Motion]) -> Vec<Problem> {
    let gravity = vec3(file.gravity).norm();
    let mut found = Vec::new();
    for (index, material) in file.materials.iter().enumerate() {
        let (Some(stiffness), None) = (material.contact_stiffness, material.joint_stiffness) else {
            continue;
        };
        let share = |shape: &Shape| {
            let volume = shape.volume();
            material.density * volume * gravity / (stiffness * volume.cbrt())
        };
        let of_material = solids
            .iter()
            .zip(motions)
            .zip(&file.blocks)
            .filter(|((_, motion), block)| {
                matches!(motion, Motion::Free) && block.material == material.name
            })
            .map(|(((name, shape), _), _)| (name, share(shape)));
        let worst = of_material.max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((name, share)) = worst
            && share > NOTICED_STATIC_OVERLAP
        {
            found.push(Problem::warning(
                format!("materials[{index}].contact_stiffness"),
                format!(
                    "at rest block `{name}` sinks into another of its kind by {:.1} % of its size; a stiffness of {:.1e} N/m \
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

fn materials(file: &SceneFile) -> Vec<Material> {
    file.materials
        .iter()
        .map(|m| Material {
            density: m.density,
            friction_angle: m.friction_angle_deg.to_radians(),
            residual_friction_angle: m.residual_friction_angle_deg.map(f64::to_radians),
            cohesion: m.cohesion,
            residual_cohesion: m.residual_cohesion,
            tensile_strength: m.tensile_strength,
            restitution: m.restitution,
            contact_stiffness: m.contact_stiffness.unwrap_or(IDLE_STIFFNESS),
            joint_stiffness: m.joint_stiffness,
            shear_stiffness_ratio: m.shear_stiffness_ratio,
            rolling_friction: m.rolling_friction,
            elastic: m.elastic.map(|e| riprap_dda::Elastic {
                young_modulus: e.young_modulus,
                poisson_ratio: e.poisson_ratio,
                viscosity: e.viscosity,
            }),
        })
        .collect()
}
