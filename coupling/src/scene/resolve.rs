//! From a read scene to one that can run: a pipe of functions, each of which returns its choices.
//!
//! ```text
//! SceneFile → Placed     gauges of the map and of files in the scene's coordinates
//!           → Expanded   rock masses, slides and grains as blocks
//!           → Solids     shapes, motions and materials of the blocks
//!           → Lattice    initial water
//!           → numbers    speeds, stiffnesses, scheme, intervals
//!           → Scene
//! ```

mod barriers;
mod expanded;
mod materials;
mod meshes;
mod places;
mod recording;
mod release;
mod settling;
mod sides;
mod solids;
mod speed;

use std::ops::Range;
use std::path::Path;

use riprap_dda::{Hold, Motion, PrescribedMotion};

use super::access::Access;
use super::attachments::{
    attachments, contact_detection, hold, joints, normal_law, rolling_law, static_damping,
    step_bound, weakenings,
};
use super::error::{Problem, Severity};
pub use super::file::vec3;
use super::file::{
    BlockFile, BlockIntegratorFile, DomainFile, SceneFile, StepBoundFile, TerrainFile,
};
use super::fill::{Lattice, Room, lattice_within, misfits, narrow_gaps, overlaps_on};
use super::flow::with_flow;
use super::geometry::rock_mass::RockMassReport;
use super::geometry::slides;
use super::names::Names;
use super::placed::placed;
use super::resolved::register::Register;
use super::resolved::{Domain, GrainList};
pub use super::resolved::{FluidScene, Made, Scene};
use super::sliding::warn_about_bends;
use super::{contact_dynamics, estimate, fluid, sleep, symmetry};
use expanded::expand;
pub(crate) use recording::HANDOFF_CELL;
use solids::Solids;

/// Customary safety factor of the block step on the bound from the contact network.
const BLOCK_TIME_STEP_FACTOR: f64 = 0.8;

impl Scene {
    /// Resolves a file; files that it names are in `folder`.
    ///
    /// # Errors
    ///
    /// All problems of the geometry together.
    pub fn resolve(file: SceneFile, folder: &Path) -> Result<Self, Vec<Problem>> {
        Self::resolve_within(file, &Access::of(folder))
    }

    /// Resolves a file with access to files and memory.
    ///
    /// # Errors
    ///
    /// All problems of the geometry together.
    pub fn resolve_within(file: SceneFile, access: &Access) -> Result<Self, Vec<Problem>> {
        let source = placed(file, access)?.file;
        let expanded = expand(source.clone(), access)?;
        let (file, terrain) = (&expanded.file, expanded.terrain.as_ref());
        let mut problems = terrain.map_or_else(Vec::new, |terrain| terrain.warnings.clone());
        problems.extend(expanded.warnings.iter().cloned());
        problems.extend(recording::unknown_blocks(file));
        problems.extend(recording::unusable_rows(file));
        problems.extend(sides::problems(file));
        problems.extend(barriers::unknown_blocks(file));
        problems.extend(settling::problems(file, source.blocks.len()));
        let names = Names::of(file);
        let solids = match Solids::of(file, &names, access, terrain) {
            Ok(solids) => solids,
            Err(found) => return Err(problems.into_iter().chain(found).collect()),
        };
        problems.extend(places::blocks_out_of_place(file, &solids));
        problems.extend(places::empty_domain(file, &solids));
        // a block of the wrong size or place would be in the way of all else
        let mut problems = without_errors(problems)?;
        let lattice = lattice(
            file,
            (&solids, &expanded.grain_lists),
            access,
            &mut problems,
        );
        let mut problems = without_errors(problems)?;
        if let Some(lattice) = &lattice {
            problems.extend(places::dry_gauges(file, &solids, lattice));
        }
        let dimensions = file.domain.dimensions;
        problems.extend((lattice.as_ref()).and_then(|l| narrow_gaps(&solids.named, l, dimensions)));
        let lattice = lattice.map(|lattice| with_flow(lattice, file));
        let expected_speed = speed::expected_speed(file, &solids, lattice.as_ref());
        let front_speed = lattice.as_ref().map_or(0.0, |lattice| {
            release::front_speed(file, &solids, lattice.spacing[0])
        });
        let materials = materials::materials(file, &solids, &expanded.of_slides, expected_speed);
        let gravity = vec3(file.gravity);
        problems.extend(materials::no_strength(&materials, &solids, gravity.norm()));
        if file.numerics.blocks == BlockIntegratorFile::CentralDifference {
            problems.extend(materials::soft_contacts(
                &materials,
                &solids,
                gravity.norm(),
            ));
        }
        let meshes = meshes::sources(&file.blocks, &solids, access);
        problems.extend(meshes.iter().filter_map(meshes::much_volume_added));
        let domain = domain(&file.domain);
        let mut fluid = lattice.map(|lattice| {
            let placed = (lattice, &domain, &expanded.grain_lists[..]);
            fluid::resolve(file, placed, expected_speed, &mut problems)
        });
        if let Some(fluid) = &fluid {
            fluid::refuse_shapes(file, &solids.named, fluid.wall_method, &mut problems);
            for maker in &solids.wave_makers {
                problems.extend(maker.problems(file, &solids.named[maker.block], fluid));
            }
            let depth = fluid.lattice.depth;
            problems.extend(fluid::short_absorbers(file, &solids.wave_makers, depth));
        }
        let spacing = fluid.as_ref().map(|fluid| fluid.lattice.spacing[0]);
        for (index, (motion, (name, shape))) in solids.motions.iter().zip(&solids.named).enumerate()
        {
            if let Motion::Prescribed(PrescribedMotion::Sliding(sliding)) = motion {
                let body = (sliding, shape);
                warn_about_bends((index, name), body, spacing, &mut problems);
            }
        }
        let mut problems = without_errors(problems)?;
        let wave_makers = solids.wave_makers.clone();
        let blocks = solids.definitions(file);
        let resting = sleep::resting(file, &blocks, &mut problems);
        if let Some(fluid) = &mut fluid {
            fluid::heed_blocks(file, (&blocks, &materials), fluid, &mut problems);
        }
        let integrator = contact_dynamics::integrator(file, &blocks, &mut problems);
        let barriers = barriers::barriers(file, &blocks, fluid.as_ref(), &mut problems);
        let warnings = without_errors(problems)?;
        let made = made(&source, file);
        let source = chosen_cuts(source, &expanded.rock_masses);
        let output = recording::output(&file.output, file.time.duration, fluid.as_ref());
        Ok(Self {
            title: file.title.clone(),
            gravity,
            domain,
            duration: file.time.duration,
            settle: file.time.settle,
            settle_blocks: settling::settling(file),
            wall_limit: file.time.wall_limit,
            stop_at_rest: file.time.stop_at_rest.map(|rest| [rest.speed, rest.time]),
            expected_speed,
            fastest_flow: expected_speed.max(front_speed),
            block_names: file.blocks.iter().map(|b| b.name.clone()).collect(),
            register: Register::of(file),
            is_sealed: file.blocks.iter().map(|b| b.sealed).collect(),
            meshes,
            attachments: attachments(file, &names, &blocks),
            holds: holds(&file.blocks),
            blocks,
            materials,
            joints: joints(file, &names),
            weakenings: weakenings(file, &names),
            block_settings: riprap_dda::Settings {
                integrator,
                resting,
                ..block_settings(file, chosen_bound(&expanded.of_slides))
            },
            gauges: recording::gauges(file, &names),
            forces: recording::forces(file, &output),
            block_table: recording::block_table(file, &output),
            output,
            trajectories: recording::trajectories(file),
            maps: recording::maps(file, fluid.as_ref()),
            masses: recording::masses(file),
            counters: sides::counters(file),
            reactions: sides::reactions(file),
            barriers,
            handoff: recording::handoff(file, fluid.as_ref()),
            fluid,
            warnings,
            terrain: expanded.terrain,
            rock_masses: expanded.rock_masses,
            grains: expanded.grains,
            grain_lists: expanded.grain_lists,
            wave_makers,
            made,
            source,
        })
    }
}

/// Blocks that the scene does not list, if it has any.
fn made(source: &SceneFile, expanded: &SceneFile) -> Option<Made> {
    let n_made = expanded.blocks.len() - source.blocks.len();
    let bytes = postcard::to_stdvec(&expanded.blocks).unwrap_or_default();
    (0 < n_made).then(|| Made {
        n_blocks: n_made,
        hash: blake3::hash(&bytes).to_hex().to_string(),
    })
}

/// The scene with the limits that its slides chose; reports are of rock masses, then of slides.
fn chosen_cuts(mut source: SceneFile, reports: &[RockMassReport]) -> SceneFile {
    let of_slides = reports.iter().skip(source.rock_masses.len());
    for (slide, report) in source.slides.iter_mut().zip(of_slides) {
        slide.convex_within = Some(slides::convex_within(slide));
        slide.minimum_volume = Some(report.minimum_volume);
    }
    source
}

/// The problems, if none of them stops the scene.
fn without_errors(problems: Vec<Problem>) -> Result<Vec<Problem>, Vec<Problem>> {
    if problems.iter().any(|p| p.severity == Severity::Error) {
        Err(problems)
    } else {
        Ok(problems)
    }
}

/// Initial water among the solids, and problems of both.
fn lattice(
    file: &SceneFile,
    (solids, grains): (&Solids, &[GrainList]),
    access: &Access,
    problems: &mut Vec<Problem>,
) -> Option<Lattice> {
    let Solids { named, motions, .. } = solids;
    let origin = file.terrain.as_ref().map(|terrain| terrain.origin);
    problems.extend(overlaps_on(named, motions, origin));
    symmetry::refuse_blocks(file, named, motions, problems);
    let room = Room {
        bytes: access.bytes(),
        bytes_per_particle: estimate::PER_PARTICLE,
    };
    let rows = fluid::mould_rows(file);
    let fluid = file.fluid.as_ref()?;
    // grains that share space with the water are not in its way; they are the last blocks
    let is_in_the_way = |block: usize| {
        let list = grains.iter().find(|list| list.blocks.contains(&block));
        !list.is_some_and(|list| list.is_averaged)
    };
    let in_the_way: Vec<_> = (named.iter().enumerate())
        .filter(|(block, _)| is_in_the_way(*block))
        .map(|(_, solid)| solid.clone())
        .collect();
    match lattice_within(fluid, &file.domain, &in_the_way, rows, room) {
        Ok(lattice) => {
            problems.extend(misfits(fluid, &lattice, file.domain.dimensions));
            Some(lattice)
        }
        Err(found) => {
            let terrain = file.terrain.as_ref();
            problems.extend(found.into_iter().map(|p| on_the_map(p, terrain)));
            None
        }
    }
}

/// A problem with map coordinates, where the scene is part of a map.
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

fn domain(file: &DomainFile) -> Domain {
    Domain {
        min: vec3(file.min),
        max: vec3(file.max),
        periodic: file.periodic.clone(),
        symmetry: file.symmetry.clone(),
        out_of_domain: file.leaving.into(),
        dimensions: fluid::dimensions(file),
    }
}

fn holds(blocks: &[BlockFile]) -> Vec<(usize, Hold)> {
    let held = |(number, block): (usize, &BlockFile)| Some((number, hold(block.hold.as_ref()?)));
    blocks.iter().enumerate().filter_map(held).collect()
}

/// The blocks of a slide lie in contact from first to last, and what they lose in hits is a few percent of their energy.
fn chosen_bound(of_slides: &Range<usize>) -> StepBoundFile {
    if of_slides.is_empty() {
        StepBoundFile::Compliances
    } else {
        StepBoundFile::Eigenvalues
    }
}

fn block_settings(file: &SceneFile, chosen: StepBoundFile) -> riprap_dda::Settings {
    let numerics = &file.numerics;
    let factor = numerics.block_time_step_factor;
    riprap_dda::Settings {
        step_bound: step_bound(numerics.block_step_bound.unwrap_or(chosen)),
        gravity: vec3(file.gravity),
        time_step_factor: factor.unwrap_or(BLOCK_TIME_STEP_FACTOR),
        contact_detection: contact_detection(numerics.contact_detection),
        normal_law: normal_law(numerics.normal_law),
        rolling_law: rolling_law(numerics.rolling_law),
        static_damping: numerics.static_damping.map(static_damping),
        ..riprap_dda::Settings::default()
    }
}
