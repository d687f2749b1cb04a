//! Rock masses: bodies cut into blocks by joint sets, each block an entry of its own.

use std::path::Path;

use riprap_dda::{
    BlockQuality, JointError, JointSet, JointedMass, Polyhedron, Shape, cut_by_joints,
};

use super::error::Problem;
use super::file::{
    BlockFile, JointSetFile, MotionFile, PlacementFile, RockMassFile, SceneFile, ShapeFile,
};
use super::resolve::vec3;
use super::shape::solid;

/// What became of a rock mass.
#[derive(Clone, Debug, PartialEq)]
pub struct RockMassReport {
    /// Its name.
    pub name: String,
    /// Blocks made.
    pub n_blocks: usize,
    /// Cuts that were not made, because a piece would have been too thin to be a block.
    pub n_uncut: usize,
    /// Blocks smaller than the least volume, left out.
    pub n_removed: usize,
    /// Their volume over that of the mass.
    pub removed_share: f64,
    /// Smallest, median and largest volume; m³.
    pub volumes: [f64; 3],
    /// Largest length over thickness of a block.
    pub worst_aspect: f64,
    /// Blocks longer than 20 times their thickness.
    pub n_slivers: usize,
}

/// Length over thickness above which a block is a sliver.
const SLIVER: f64 = 20.0;

/// Cuts the rock masses of the file and puts their blocks in its list, named `mass.0001` and on; the
/// masses are taken out, so that the file then says what is run.
///
/// # Errors
///
/// Problems of shapes and joint sets, all together.
pub fn expand(file: &mut SceneFile, folder: &Path) -> Result<Vec<RockMassReport>, Vec<Problem>> {
    let mut problems = Vec::new();
    let mut reports = Vec::new();
    for (index, mass) in std::mem::take(&mut file.rock_masses).iter().enumerate() {
        match blocks_of(mass, index, folder) {
            Ok((bodies, report)) => {
                reports.push(report);
                let blocks = bodies
                    .iter()
                    .enumerate()
                    .map(|(k, body)| block(mass, k, body));
                file.blocks.extend(blocks);
            }
            Err(found) => problems.extend(found),
        }
    }
    if problems.is_empty() {
        Ok(reports)
    } else {
        Err(problems)
    }
}

fn block(mass: &RockMassFile, number: usize, body: &Polyhedron) -> BlockFile {
    BlockFile {
        name: format!("{}.{:04}", mass.name, number + 1),
        material: mass.material.clone(),
        shape: ShapeFile::Polyhedron {
            vertices: body.vertices().iter().map(|x| (x.x, x.y, x.z)).collect(),
            faces: (0..body.n_faces())
                .map(|face| body.face_vertices(face).collect())
                .collect(),
        },
        placement: PlacementFile::default(),
        motion: MotionFile::Free,
        velocity: (0.0, 0.0, 0.0),
        angular_velocity: (0.0, 0.0, 0.0),
        deformable: mass.deformable.clone(),
        hold: None,
    }
}

fn blocks_of(
    mass: &RockMassFile,
    index: usize,
    folder: &Path,
) -> Result<(Vec<Polyhedron>, RockMassReport), Vec<Problem>> {
    let refused = |field: &str, what: String| {
        let message = format!("rock mass `{}`: {what}", mass.name);
        vec![Problem::error(
            format!("rock_masses[{index}].{field}"),
            message,
        )]
    };
    let whole = BlockFile {
        shape: mass.boundary.clone(),
        ..block(mass, 0, &unit_cube().map_err(|e| refused("boundary", e))?)
    };
    let shape = solid(&whole, 0, folder).map_err(|found| {
        let texts: Vec<String> = found.into_iter().map(|problem| problem.message).collect();
        refused("boundary", texts.join("; "))
    })?;
    let Shape::Polyhedra(bodies) = shape else {
        return Err(refused("boundary", "a ball cannot be cut by joints".into()));
    };
    let volume: f64 = bodies.iter().map(riprap_dda::volume).sum();
    let sets: Vec<JointSet> = mass.joint_sets.iter().map(joint_set).collect();
    let cut = cut_by_joints(bodies, &sets, mass.seed, mass.maximum_blocks as usize);
    let JointedMass {
        mut blocks,
        n_uncut,
    } = cut.map_err(|error| match error {
        JointError::Set { set, field, .. } => {
            let field = match field {
                "dip" | "dip_direction" | "scatter" => format!("{field}_deg"),
                _ => field.to_owned(),
            };
            refused(&format!("joint_sets[{set}].{field}"), error.to_string())
        }
        JointError::TooMany { set, .. } => {
            refused(&format!("joint_sets[{set}].spacing"), error.to_string())
        }
    })?;
    let n_cut = blocks.len();
    blocks.retain(|body| riprap_dda::volume(body) >= mass.minimum_volume);
    if blocks.is_empty() {
        let what = format!(
            "all {n_cut} blocks are smaller than {} m3; lower minimum_volume",
            mass.minimum_volume
        );
        return Err(refused("minimum_volume", what));
    }
    let qualities: Vec<BlockQuality> = blocks.iter().map(BlockQuality::of).collect();
    let mut volumes: Vec<f64> = qualities.iter().map(|quality| quality.volume).collect();
    volumes.sort_by(f64::total_cmp);
    let kept: f64 = volumes.iter().sum();
    let report = RockMassReport {
        name: mass.name.clone(),
        n_blocks: blocks.len(),
        n_uncut,
        n_removed: n_cut - blocks.len(),
        removed_share: ((volume - kept) / volume).max(0.0),
        volumes: [
            volumes[0],
            volumes[volumes.len() / 2],
            volumes[volumes.len() - 1],
        ],
        worst_aspect: qualities.iter().map(|q| q.aspect).fold(0.0, f64::max),
        n_slivers: qualities.iter().filter(|q| q.aspect > SLIVER).count(),
    };
    Ok((blocks, report))
}

fn unit_cube() -> Result<Polyhedron, String> {
    Polyhedron::cuboid(vec3((0.0, 0.0, 0.0)), vec3((1.0, 1.0, 1.0))).map_err(|e| e.to_string())
}

fn joint_set(file: &JointSetFile) -> JointSet {
    JointSet {
        dip: file.dip_deg.to_radians(),
        dip_direction: file.dip_direction_deg.to_radians(),
        spacing: file.spacing,
        origin: vec3(file.origin),
        persistence: file.persistence,
        scatter: file.scatter_deg.to_radians(),
        spacing_scatter: file.spacing_scatter,
    }
}

impl std::fmt::Display for RockMassReport {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [smallest, median, largest] = self.volumes;
        write!(
            f,
            "`{}`: {} blocks of {smallest:.3e} to {largest:.3e} m3, median {median:.3e}; longest over thinnest up to {:.1}",
            self.name, self.n_blocks, self.worst_aspect
        )?;
        if self.n_slivers > 0 {
            write!(f, "; {} slivers above {SLIVER}", self.n_slivers)?;
        }
        if self.n_uncut > 0 {
            write!(
                f,
                "; {} joints left out where they would shave off a piece too thin to be a block",
                self.n_uncut
            )?;
        }
        if self.n_removed > 0 {
            write!(
                f,
                "; {} too small left out, {:.2e} of the volume",
                self.n_removed, self.removed_share
            )?;
        }
        Ok(())
    }
}
