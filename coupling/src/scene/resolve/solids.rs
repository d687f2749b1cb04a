//! Solids of the blocks in their places, their motions and materials.

use riprap_dda::{BlockDefinition, Motion, Shape};

use crate::scene::access::Access;
use crate::scene::attachments::deformability;
use crate::scene::error::Problem;
use crate::scene::file::{MotionFile, SceneFile, vec3};
use crate::scene::geometry::shape::solid_on;
use crate::scene::geometry::terrain::Terrain;
use crate::scene::motion::motion;
use crate::scene::names::Names;
use crate::scene::sliding::sliding;
use crate::scene::wave_maker::{WaveMaker, wave_maker};

/// Solids of the blocks of a scene, one entry per block.
pub(super) struct Solids {
    /// Name and shape.
    pub(super) named: Vec<(String, Shape)>,
    pub(super) motions: Vec<Motion>,
    /// Pistons among them that make waves.
    pub(super) wave_makers: Vec<WaveMaker>,
    /// Number of the material.
    pub(super) materials: Vec<usize>,
}

impl Solids {
    /// Solids of the blocks of a file.
    ///
    /// # Errors
    ///
    /// Problems of shapes and motions, all together.
    pub(super) fn of(
        file: &SceneFile,
        names: &Names,
        access: &Access,
        terrain: Option<&Terrain>,
    ) -> Result<Self, Vec<Problem>> {
        let (mut named, mut motions) = (Vec::new(), Vec::new());
        let mut problems = Vec::new();
        for (index, block) in file.blocks.iter().enumerate() {
            match solid_on(block, index, access, terrain) {
                Ok(shape) => named.push((block.name.clone(), shape)),
                Err(found) => problems.extend(found),
            }
        }
        let mut wave_makers = Vec::new();
        let are_whole = problems.is_empty();
        for (index, block) in file.blocks.iter().enumerate() {
            // the depth before a piston is known once all shapes are
            if matches!(block.motion, MotionFile::Waves { .. }) && !are_whole {
                continue;
            }
            let maker = match wave_maker(file, index, &named) {
                Ok(maker) => maker,
                Err(problem) => {
                    problems.push(problem);
                    continue;
                }
            };
            if let Some(maker) = maker {
                motions.push(maker.motion());
                wave_makers.push(maker);
                continue;
            }
            let shape = named
                .get(index)
                .filter(|_| are_whole)
                .map(|(_, shape)| shape);
            let found = match sliding(file, index, shape, access) {
                Ok(Some(motion)) => Ok(motion),
                Ok(None) => motion(&block.motion, &format!("blocks[{index}].motion"), access),
                Err(problem) => Err(problem),
            };
            match found {
                Ok(found) => motions.push(found),
                Err(problem) => problems.push(problem),
            }
        }
        if !problems.is_empty() {
            return Err(problems);
        }
        let materials = file.blocks.iter().map(|b| names.material(&b.material));
        Ok(Self {
            named,
            motions,
            wave_makers,
            materials: materials.collect(),
        })
    }

    /// Free blocks: index, shape and number of the material.
    pub(super) fn free(&self) -> impl Iterator<Item = (usize, &Shape, usize)> {
        let all = self.named.iter().zip(&self.motions).zip(&self.materials);
        all.enumerate()
            .filter(|(_, ((_, motion), _))| matches!(motion, Motion::Free))
            .map(|(index, (((_, shape), _), &material))| (index, shape, material))
    }

    /// Definitions for the block solver.
    pub(super) fn definitions(self, file: &SceneFile) -> Vec<BlockDefinition> {
        let bodies = self.named.into_iter().zip(self.motions).zip(self.materials);
        bodies
            .zip(&file.blocks)
            .map(
                |((((_, shape), motion), material), block)| BlockDefinition {
                    shape,
                    material,
                    motion,
                    velocity: vec3(block.velocity),
                    angular_velocity: vec3(block.angular_velocity),
                    deformability: block.deformable.as_ref().map(deformability),
                },
            )
            .collect()
    }
}
