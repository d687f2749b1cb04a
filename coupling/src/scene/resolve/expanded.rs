//! Blocks in place of rock masses, slides and grains.

use std::ops::Range;

use super::places::failures_into_the_hill;
use crate::messages::Code;
use crate::scene::access::Access;
use crate::scene::error::Problem;
use crate::scene::estimate;
use crate::scene::file::{ExcavationFile, JointSetFile, MassFile, SceneFile, SlideFile};
use crate::scene::fluid::is_averaged;
use crate::scene::geometry::grains::{GrainsReport, blocks_of_grains};
use crate::scene::geometry::rock_mass::{RockMassReport, blocks_of_masses};
use crate::scene::geometry::slides::blocks_of_slides;
use crate::scene::geometry::terrain::{self, Terrain};
use crate::scene::resolved::GrainList;

/// A scene of single blocks.
pub(super) struct Expanded {
    /// The file with blocks in place of rock masses, slides and grains, and with the scars of slides as excavations:
    /// it describes the same scene.
    pub(super) file: SceneFile,
    pub(super) terrain: Option<Terrain>,
    /// Indices of the blocks of slides.
    pub(super) of_slides: Range<usize>,
    /// Reports of rock masses, then of slides.
    pub(super) rock_masses: Vec<RockMassReport>,
    pub(super) grains: Vec<GrainsReport>,
    /// Their blocks, list by list.
    pub(super) grain_lists: Vec<GrainList>,
    /// Doubtful points of slides.
    pub(super) warnings: Vec<Problem>,
}

/// Makes the blocks of rock masses, slides and grains.
pub(super) fn expand(mut file: SceneFile, access: &Access) -> Result<Expanded, Vec<Problem>> {
    let terrain = terrain::resolve(&file, access)?;
    let masses = std::mem::take(&mut file.rock_masses);
    let (blocks, mut rock_masses) = blocks_of_masses(&masses, access)?;
    file.blocks.extend(blocks);

    let slides = std::mem::take(&mut file.slides);
    let whole = (masses.iter().zip(&rock_masses).enumerate())
        .filter_map(|(k, (mass, report))| uncut(("rock_masses", k), &mass.joint_sets, report));
    let mut warnings: Vec<Problem> = whole.collect();
    let into_the_hill = (terrain.as_ref())
        .map(|terrain| failures_into_the_hill(&slides, terrain))
        .unwrap_or_default();
    warnings.extend(into_the_hill);
    let rock = terrain.as_ref().map_or(&[][..], |terrain| &terrain.rock);
    let (blocks, reports) = blocks_of_slides(&slides, rock)?;
    let of_slides = file.blocks.len()..file.blocks.len() + blocks.len();
    file.blocks.extend(blocks);
    let whole_slides = (slides.iter().zip(&reports).enumerate())
        .filter_map(|(k, (slide, report))| uncut(("slides", k), &slide.joint_sets, report));
    warnings.extend(whole_slides);
    rock_masses.extend(reports);
    let file = with_scars(file, slides);

    let most = (access.bytes() / estimate::PER_BLOCK) as usize;
    let (blocks, grains) =
        blocks_of_grains(&file.grains, &file.blocks, &file.materials, (most, access))?;
    let grain_lists = grain_lists(&file, &grains)?;
    let mut file = file;
    file.grains.clear();
    file.blocks.extend(blocks);
    Ok(Expanded {
        file,
        terrain,
        of_slides,
        rock_masses,
        grains,
        grain_lists,
        warnings,
    })
}

/// Lists of grains, whose blocks follow those of the file.
fn grain_lists(file: &SceneFile, reports: &[GrainsReport]) -> Result<Vec<GrainList>, Vec<Problem>> {
    let mut first = file.blocks.len();
    let (mut lists, mut problems) = (Vec::new(), Vec::new());
    for (index, (list, report)) in file.grains.iter().zip(reports).enumerate() {
        let is_averaged =
            is_averaged((index, list), file.fluid.as_ref()).unwrap_or_else(|problem| {
                problems.push(problem);
                false
            });
        let material = file.materials.iter().find(|m| m.name == list.material);
        lists.push(GrainList {
            index,
            name: list.name.clone(),
            blocks: first..first + report.n_grains,
            diameters: [list.smallest(), list.largest()],
            density: material.map_or(0.0, |m| m.density),
            is_averaged,
        });
        first += report.n_grains;
    }
    match problems.is_empty() {
        true => Ok(lists),
        false => Err(problems),
    }
}

/// A warning about a mass that none of its joints crosses.
fn uncut(
    (list, index): (&str, usize),
    sets: &[JointSetFile],
    report: &RockMassReport,
) -> Option<Problem> {
    let is_whole = report.n_blocks == 1 && report.n_merged + report.n_removed == 0;
    let closest = sets.iter().map(|set| set.spacing).reduce(f64::min)?;
    is_whole.then(|| {
        let what = format!(
            "`{}` is a single block: no joint crosses it, the closest spacing is {closest} m; lengths are in meters",
            report.name
        );
        Problem::warning(Code::NoJointCrosses, format!("{list}[{index}].joint_sets"), what)
    })
}

/// The file with an excavation and a tracked mass for each slide.
fn with_scars(mut file: SceneFile, slides: Vec<SlideFile>) -> SceneFile {
    let Some(terrain) = &mut file.terrain else {
        return file;
    };
    for slide in slides {
        if file.masses.iter().all(|mass| mass.name != slide.name) {
            file.masses.push(MassFile {
                blocks: format!("{}.", slide.name),
                name: slide.name,
            });
        }
        terrain.excavations.push(ExcavationFile {
            outline: slide.outline,
            failure_surface: slide.failure_surface,
        });
    }
    file
}
