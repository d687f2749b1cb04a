//! Slides: rock taken out of the ground and cut into blocks by joint sets, each block an entry of its own.

use riprap_dda::{JointSet, cut_union_by_joints};

use super::rock_mass::{Cleaning, Cut, Maker, Refusal, RockMassReport, blamed, joint_set};
use super::terrain::{Rock, Terrain};
use crate::scene::error::Problem;
use crate::scene::file::{ExcavationFile, MassFile, SceneFile, SlideFile};

/// Cuts the slides of the file and puts their blocks in its list, named `slide.0001` and on. The slides are taken out and their holes
/// become excavations of the terrain, so that the file then says what is run.
///
/// # Errors
///
/// Problems of joint sets, all together.
pub fn expand(
    file: &mut SceneFile,
    terrain: Option<&Terrain>,
) -> Result<Vec<RockMassReport>, Vec<Problem>> {
    let slides = std::mem::take(&mut file.slides);
    let (Some(terrain), Some(terrain_file)) = (terrain, &mut file.terrain) else {
        return Ok(Vec::new());
    };
    let mut problems = Vec::new();
    let mut reports = Vec::new();
    for (index, (slide, rock)) in slides.iter().zip(&terrain.rock).enumerate() {
        match cut(slide, rock) {
            Ok((blocks, report)) => {
                reports.push(report);
                let maker = Maker {
                    name: &slide.name,
                    material: &slide.material,
                    deformable: slide.deformable.as_ref(),
                    sealed: slide.sealed,
                };
                file.blocks.extend(maker.blocks(&blocks));
                if file.masses.iter().all(|mass| mass.name != slide.name) {
                    file.masses.push(MassFile {
                        name: slide.name.clone(),
                        blocks: format!("{}.", slide.name),
                    });
                }
                terrain_file.excavations.push(ExcavationFile {
                    outline: slide.outline.clone(),
                    failure_surface: slide.failure_surface.clone(),
                });
            }
            Err((field, what)) => problems.push(Problem::error(
                format!("slides[{index}].{field}"),
                format!("slide `{}`: {what}", slide.name),
            )),
        }
    }
    if problems.is_empty() {
        Ok(reports)
    } else {
        Err(problems)
    }
}

fn cut(slide: &SlideFile, rock: &Rock) -> Result<Cut, Refusal> {
    let sets: Vec<JointSet> = slide.joint_sets.iter().map(joint_set).collect();
    let limit = slide.maximum_blocks as usize;
    let cut = cut_union_by_joints(rock.bodies.clone(), &sets, slide.seed, limit)
        .map_err(|error| (blamed(&error), error.to_string()))?;
    let cleaning = Cleaning {
        name: &slide.name,
        merge_slivers: slide.merge_slivers.as_ref(),
        convex_within: slide.convex_within,
        minimum_volume: slide.minimum_volume,
        volume: rock.volume,
    };
    cleaning.clean(cut)
}
