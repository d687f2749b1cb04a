//! Slides: rock excavated from the ground and cut into blocks by joint sets.

use riprap_dda::{JointSet, cut_union_by_joints};

use super::rock_mass::{BlockTemplate, Cleaning, Cut, Refusal, RockMassReport, joint_set, refusal};
use super::terrain::Rock;
use crate::scene::error::Problem;
use crate::scene::file::{BlockFile, FailureSurfaceFile, SlideFile};

/// Gain of volume within which blocks become convex unless a slide says otherwise, on a plane and on a raster; –.
const CONVEX_WITHIN: (f64, f64) = (1.0, 0.01);

/// Blocks of slides, named `slide.0001` and so on, and a report of each slide; `rock` is their rock in the same order.
///
/// # Errors
///
/// Problems of joint sets, all together.
pub fn blocks_of_slides(
    slides: &[SlideFile],
    rock: &[Rock],
) -> Result<(Vec<BlockFile>, Vec<RockMassReport>), Vec<Problem>> {
    let mut problems = Vec::new();
    let (mut blocks, mut reports) = (Vec::new(), Vec::new());
    for (index, (slide, rock)) in slides.iter().zip(rock).enumerate() {
        match cut(slide, rock) {
            Ok(cut) => {
                let template = BlockTemplate {
                    name: &slide.name,
                    material: &slide.material,
                    deformable: slide.deformable.as_ref(),
                    sealed: slide.sealed,
                    joint_sets: &slide.joint_sets,
                };
                blocks.extend(template.blocks(&cut));
                reports.push(cut.report);
            }
            Err((code, field, what)) => problems.push(Problem::error(
                code,
                format!("slides[{index}].{field}"),
                format!("slide `{}`: {what}", slide.name),
            )),
        }
    }
    if problems.is_empty() {
        Ok((blocks, reports))
    } else {
        Err(problems)
    }
}

/// Gain of volume within which the blocks of a slide become convex; –.
pub fn convex_within(slide: &SlideFile) -> f64 {
    let chosen = match slide.failure_surface {
        FailureSurfaceFile::Plane { .. } => CONVEX_WITHIN.0,
        FailureSurfaceFile::Raster { .. } => CONVEX_WITHIN.1,
    };
    slide.convex_within.unwrap_or(chosen)
}

fn cut(slide: &SlideFile, rock: &Rock) -> Result<Cut, Refusal> {
    let sets: Vec<JointSet> = slide.joint_sets.iter().map(joint_set).collect();
    let limit = slide.maximum_blocks as usize;
    let cut = cut_union_by_joints(rock.bodies.clone(), &sets, slide.seed, limit)
        .map_err(|error| refusal(&error))?;
    let cleaning = Cleaning {
        name: &slide.name,
        merge_slivers: slide.merge_slivers.as_ref(),
        convex_within: convex_within(slide),
        minimum_volume: slide.minimum_volume,
        volume: rock.volume,
    };
    cleaning.clean(cut)
}
