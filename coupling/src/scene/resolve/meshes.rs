//! Mesh files of blocks, and how their convex parts differ from what is drawn.

use riprap_dda::Shape;

use super::solids::Solids;
use crate::messages::Code;
use crate::scene::access::Access;
use crate::scene::error::Problem;
use crate::scene::file::{BlockFile, ShapeFile};
use crate::scene::geometry::mesh::{self, Deviation};
use crate::scene::geometry::shape::placement;
use crate::scene::resolved::MeshSource;

/// Error of the volume of convex parts that a user should know of; –.
const MUCH: f64 = 0.03;

/// Error of the volume of convex shells, by round-off in the file; –.
const ROUND_OFF: f64 = 1e-6;

/// The mesh files of all blocks.
pub(super) fn sources(blocks: &[BlockFile], solids: &Solids, access: &Access) -> Vec<MeshSource> {
    let numbered = blocks.iter().enumerate().zip(&solids.named);
    let source = |((block, of), (_, shape)): ((usize, &BlockFile), &(String, Shape))| {
        let ShapeFile::Mesh { file, scale, .. } = &of.shape else {
            return None;
        };
        // the solids are there, so the mesh can be read
        let survey = mesh::survey(access, file, *scale).ok()?;
        let n_parts = match shape {
            Shape::Polyhedra(parts) => parts.len(),
            Shape::Sphere { .. } | Shape::Surface(_) => 0,
        };
        let made = (n_parts, &shape.mass_properties());
        let deviation = Deviation::of(made, &survey.drawn, &placement(&of.placement)?);
        let is_split = n_parts > survey.n_shells || ROUND_OFF < deviation.volume.abs();
        Some(MeshSource {
            block,
            file: file.clone(),
            survey,
            deviation: is_split.then_some(deviation),
        })
    };
    numbered.filter_map(source).collect()
}

/// A warning about convex parts that have much more volume than the drawing.
pub(super) fn much_volume_added(source: &MeshSource) -> Option<Problem> {
    let deviation = source.deviation.filter(|found| MUCH < found.volume.abs())?;
    let what = format!(
        "`{}` is not convex: {deviation}; raise split.most_parts, or lower split.volume_error",
        source.file
    );
    let path = format!("blocks[{}].shape.file", source.block);
    Some(Problem::warning(Code::MeshNotConvex, path, what))
}
