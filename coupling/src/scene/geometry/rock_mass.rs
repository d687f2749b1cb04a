//! Rock masses: bodies cut into blocks by joint sets.

pub(super) mod joint_faces;
mod report;

use riprap_dda::{
    BlockQuality, Joint, JointError, JointSet, JointedMass, JointedUnion, MergedMass, Polyhedron,
    Shape, SliverLimits, cut_by_joints, cut_union_by_joints, hull_within, merge_union_slivers,
};

use self::joint_faces::joint_faces;
use super::mesh;
use super::shape::solid;
use crate::messages::Code;
use crate::scene::access::Access;
use crate::scene::error::Problem;
use crate::scene::file::vec3;
use crate::scene::file::{
    BlockFile, DeformableFile, JointSetFile, MotionFile, PartFile, PlacementFile, RockMassFile,
    ShapeFile, SliversFile,
};

/// Blocks made of a rock mass, and their quality.
#[derive(Clone, Debug, PartialEq)]
pub struct RockMassReport {
    /// Its name.
    pub name: String,
    /// Number of blocks.
    pub n_blocks: usize,
    /// Cuts omitted because a piece would have been too thin for a block.
    pub n_uncut: usize,
    /// Slivers merged with a neighbor.
    pub n_merged: usize,
    /// Slivers left because they share no face with another block.
    pub n_unmerged: usize,
    /// Blocks of several parts that became convex.
    pub n_filled: usize,
    /// Volume that they gained, over that of the mass.
    pub gained_share: f64,
    /// Blocks of several convex parts.
    pub n_unions: usize,
    /// Volume that the convex parts of a mesh have more than its shells, over theirs.
    pub split_error: f64,
    /// Blocks removed because they are smaller than the minimum volume.
    pub n_removed: usize,
    /// The minimum volume, given or chosen; m³.
    pub minimum_volume: f64,
    /// Their volume over that of the mass.
    pub removed_share: f64,
    /// Smallest, median and largest volume; m³.
    pub volumes: [f64; 3],
    /// Largest length over thickness of a block.
    pub worst_aspect: f64,
    /// Smallest angle between two faces of a block; rad.
    pub smallest_dihedral: f64,
    /// Blocks longer than 20 times their thickness.
    pub n_slivers: usize,
}

/// Length over thickness above which a block is a sliver.
const SLIVER: f64 = 20.0;

/// Blocks of rock masses, named `mass.0001` and so on, and a report of each mass.
///
/// # Errors
///
/// Problems of shapes and joint sets, all together.
pub fn blocks_of_masses(
    masses: &[RockMassFile],
    access: &Access,
) -> Result<(Vec<BlockFile>, Vec<RockMassReport>), Vec<Problem>> {
    let mut problems = Vec::new();
    let (mut blocks, mut reports) = (Vec::new(), Vec::new());
    for (index, mass) in masses.iter().enumerate() {
        match cut_mass(mass, index, access) {
            Ok(cut) => {
                blocks.extend(template(mass).blocks(&cut));
                reports.push(cut.report);
            }
            Err(found) => problems.extend(found),
        }
    }
    if problems.is_empty() {
        Ok((blocks, reports))
    } else {
        Err(problems)
    }
}

/// A block of a mass, apart from its shape.
pub(super) struct BlockTemplate<'a> {
    pub(super) name: &'a str,
    pub(super) material: &'a str,
    pub(super) deformable: Option<&'a DeformableFile>,
    pub(super) sealed: bool,
    pub(super) joint_sets: &'a [JointSetFile],
}

impl BlockTemplate<'_> {
    fn block(&self, number: usize, shape: ShapeFile) -> BlockFile {
        BlockFile {
            name: format!("{}.{:04}", self.name, number + 1),
            material: self.material.to_owned(),
            shape,
            placement: PlacementFile::default(),
            motion: MotionFile::Free,
            velocity: (0.0, 0.0, 0.0),
            angular_velocity: (0.0, 0.0, 0.0),
            deformable: self.deformable.cloned(),
            hold: None,
            sealed: self.sealed,
            group: Some(self.name.to_owned()),
            joint_faces: Vec::new(),
        }
    }

    /// Entries of the list of blocks, of convex parts each.
    pub(super) fn blocks<'a>(&'a self, cut: &'a Cut) -> impl Iterator<Item = BlockFile> + 'a {
        let numbered = cut.blocks.iter().enumerate();
        numbered.map(|(k, parts)| BlockFile {
            joint_faces: joint_faces(parts, &cut.joints, self.joint_sets),
            ..self.block(k, shape_of(parts))
        })
    }
}

fn template(mass: &RockMassFile) -> BlockTemplate<'_> {
    BlockTemplate {
        name: &mass.name,
        material: &mass.material,
        deformable: mass.deformable.as_ref(),
        sealed: mass.sealed,
        joint_sets: &mass.joint_sets,
    }
}

/// Shape of a block as written.
fn shape_of(block: &[Polyhedron]) -> ShapeFile {
    let written = |body: &Polyhedron| PartFile {
        vertices: body.vertices().iter().map(|x| (x.x, x.y, x.z)).collect(),
        faces: (0..body.n_faces())
            .map(|face| body.face_vertices(face).collect())
            .collect(),
    };
    match block {
        [body] => {
            let PartFile { vertices, faces } = written(body);
            ShapeFile::Polyhedron { vertices, faces }
        }
        parts => ShapeFile::Polyhedra {
            parts: parts.iter().map(written).collect(),
        },
    }
}

fn cut_mass(mass: &RockMassFile, index: usize, access: &Access) -> Result<Cut, Vec<Problem>> {
    let path = format!("rock_masses[{index}]");
    let refused = |(code, field, what): Refusal| {
        let message = format!("rock mass `{}`: {what}", mass.name);
        vec![Problem::error(code, format!("{path}.{field}"), message)]
    };
    let bodies =
        bodies(mass, access).map_err(|(code, what)| refused((code, "boundary".into(), what)))?;
    let volume: f64 = bodies.iter().map(|parts| volume_of(parts)).sum();
    let sets: Vec<JointSet> = mass.joint_sets.iter().map(joint_set).collect();
    let cut = cut_of(bodies, &sets, mass).map_err(|error| refused(refusal(&error)))?;
    let cleaning = Cleaning {
        name: &mass.name,
        merge_slivers: mass.merge_slivers.as_ref(),
        convex_within: 0.0,
        minimum_volume: Some(mass.minimum_volume),
        volume,
    };
    let mut cut = cleaning.clean(cut).map_err(refused)?;
    cut.report.split_error = split_error(mass, volume, access);
    Ok(cut)
}

/// Volume (m³) that the convex parts of a mesh have more than its shells, over theirs.
fn split_error(mass: &RockMassFile, volume: f64, access: &Access) -> f64 {
    let ShapeFile::Mesh { file, scale, .. } = &mass.boundary else {
        return 0.0;
    };
    mesh::survey(access, file, *scale).map_or(0.0, |found| volume / found.drawn.volume - 1.0)
}

/// The bodies of a mass before it is cut, of convex parts each: the shells of a mesh, or a single body of every other part.
fn bodies(mass: &RockMassFile, access: &Access) -> Result<Vec<Vec<Polyhedron>>, (Code, String)> {
    if let ShapeFile::Mesh { file, scale, split } = &mass.boundary {
        let found = mesh::solids(access, file, *scale, (*split).into());
        return found.map_err(|error| (error.fault.code(), error.to_string()));
    }
    let whole = template(mass).block(0, mass.boundary.clone());
    let shape = solid(&whole, 0, access).map_err(|found| {
        let code = found.first().map_or(Code::InvalidShape, |first| first.code);
        let texts: Vec<String> = found.into_iter().map(|problem| problem.message).collect();
        (code, texts.join("; "))
    })?;
    match shape {
        Shape::Polyhedra(parts) => Ok(parts.into_iter().map(|part| vec![part]).collect()),
        Shape::Sphere { .. } | Shape::Surface(_) => {
            let what = "a sphere or a surface cannot be cut by joints";
            Err((Code::InvalidShape, what.into()))
        }
    }
}

/// Bodies cut by joints; one of several parts as a whole.
fn cut_of(
    bodies: Vec<Vec<Polyhedron>>,
    sets: &[JointSet],
    mass: &RockMassFile,
) -> Result<JointedUnion, JointError> {
    let limit = mass.maximum_blocks as usize;
    if bodies.iter().all(|parts| parts.len() == 1) {
        let bodies = bodies.into_iter().flatten().collect();
        let JointedMass {
            blocks,
            n_uncut,
            joints,
        } = cut_by_joints(bodies, sets, mass.seed, limit)?;
        return Ok(JointedUnion {
            blocks: blocks.into_iter().map(|block| vec![block]).collect(),
            n_uncut,
            joints,
        });
    }
    let mut all = JointedUnion {
        blocks: Vec::new(),
        n_uncut: 0,
        joints: Vec::new(),
    };
    for parts in bodies {
        let cut = cut_union_by_joints(parts, sets, mass.seed, limit)?;
        all.blocks.extend(cut.blocks);
        all.n_uncut += cut.n_uncut;
        all.joints.extend(cut.joints);
    }
    Ok(all)
}

/// A mass cut into blocks.
pub(super) struct Cut {
    /// Blocks of convex parts.
    pub(super) blocks: Vec<Vec<Polyhedron>>,
    /// Joints that cut it.
    pub(super) joints: Vec<Joint>,
    pub(super) report: RockMassReport,
}

/// The cause, the faulty field of a mass, and the reason.
pub(super) type Refusal = (Code, String, String);

/// Refusal of joints or slivers.
pub(super) fn refusal(error: &JointError) -> Refusal {
    let code = match error {
        JointError::Set { .. } | JointError::Slivers { .. } => Code::ValueOutOfRange,
        JointError::TooMany { .. } => Code::TooManyBlocks,
    };
    (code, blamed(error), error.to_string())
}

/// Treatment of slivers and small blocks of a mass.
pub(super) struct Cleaning<'a> {
    pub(super) name: &'a str,
    pub(super) merge_slivers: Option<&'a SliversFile>,
    /// Largest gain of volume by which a block of several parts is made convex, over its volume; –.
    pub(super) convex_within: f64,
    /// m³; `None`: chosen.
    pub(super) minimum_volume: Option<f64>,
    /// Volume of the mass before it is cut; m³.
    pub(super) volume: f64,
}

impl Cleaning<'_> {
    /// Blocks without slivers and small ones, and a report of them; or the faulty field and the reason.
    pub(super) fn clean(
        &self,
        JointedUnion {
            blocks,
            n_uncut,
            joints,
        }: JointedUnion,
    ) -> Result<Cut, Refusal> {
        let MergedMass {
            mut blocks,
            n_merged,
            n_left,
        } = match self.merge_slivers {
            Some(file) => {
                let limits = SliverLimits {
                    volume_share: file.volume_share,
                    aspect: file.aspect,
                };
                merge_union_slivers(blocks, &limits).map_err(|error| refusal(&error))?
            }
            None => MergedMass {
                blocks,
                n_merged: 0,
                n_left: 0,
            },
        };
        let (mut n_filled, mut gained) = (0, 0.0);
        if 0.0 < self.convex_within {
            for parts in blocks.iter_mut().filter(|parts| parts.len() > 1) {
                if let Some(hull) = hull_within(parts, self.convex_within) {
                    gained += riprap_dda::volume(&hull) - volume_of(parts);
                    *parts = vec![hull];
                    n_filled += 1;
                }
            }
        }
        let n_cut = blocks.len();
        let minimum = self.minimum_volume.unwrap_or_else(|| negligible(&blocks));
        let mut removed = 0.0;
        blocks.retain(|parts| {
            let volume = volume_of(parts);
            let stays = volume >= minimum;
            removed += if stays { 0.0 } else { volume };
            stays
        });
        if blocks.is_empty() {
            let what =
                format!("all {n_cut} blocks are smaller than {minimum} m3; lower minimum_volume");
            return Err((Code::NoBlockLeft, "minimum_volume".into(), what));
        }
        let report = RockMassReport {
            n_uncut,
            n_merged,
            n_unmerged: n_left,
            n_filled,
            gained_share: gained / self.volume,
            n_removed: n_cut - blocks.len(),
            minimum_volume: minimum,
            removed_share: removed / self.volume,
            ..report(self.name, &blocks)
        };
        Ok(Cut {
            blocks,
            joints,
            report,
        })
    }
}

/// Share of the rock in blocks too small to matter; –.
const NEGLIGIBLE: f64 = 0.003;
/// Largest of them, × the median volume.
const LARGEST_NEGLIGIBLE: f64 = 0.1;

fn volume_of(parts: &[Polyhedron]) -> f64 {
    parts.iter().map(riprap_dda::volume).sum()
}

/// Volume below which blocks hold a negligible share of their mass together; m³.
fn negligible(blocks: &[Vec<Polyhedron>]) -> f64 {
    let mut volumes: Vec<f64> = blocks.iter().map(|parts| volume_of(parts)).collect();
    volumes.sort_by(f64::total_cmp);
    let all: f64 = volumes.iter().sum();
    let mut sum = 0.0;
    let n_small = volumes
        .iter()
        .take_while(|&&volume| {
            sum += volume;
            sum <= NEGLIGIBLE * all
        })
        .count();
    let largest = LARGEST_NEGLIGIBLE * volumes.get(volumes.len() / 2).copied().unwrap_or(0.0);
    volumes.get(n_small).copied().unwrap_or(0.0).min(largest)
}

/// The field of a rock mass that an error refers to.
fn blamed(error: &JointError) -> String {
    match error {
        JointError::Set { set, field, .. } => match *field {
            "dip" | "dip_direction" | "scatter" => format!("joint_sets[{set}].{field}_deg"),
            _ => format!("joint_sets[{set}].{field}"),
        },
        JointError::TooMany { set, .. } => format!("joint_sets[{set}].spacing"),
        JointError::Slivers { field, .. } => format!("merge_slivers.{field}"),
    }
}

/// Report of blocks without the cuts, merges and removals before.
fn report(name: &str, blocks: &[Vec<Polyhedron>]) -> RockMassReport {
    let qualities: Vec<BlockQuality> = blocks
        .iter()
        .map(|parts| BlockQuality::of_union(parts))
        .collect();
    let mut volumes: Vec<f64> = qualities.iter().map(|quality| quality.volume).collect();
    volumes.sort_by(f64::total_cmp);
    let dihedrals = qualities.iter().map(|quality| quality.smallest_dihedral);
    RockMassReport {
        name: name.to_owned(),
        n_blocks: blocks.len(),
        n_uncut: 0,
        n_merged: 0,
        n_unmerged: 0,
        n_filled: 0,
        gained_share: 0.0,
        n_unions: blocks.iter().filter(|parts| parts.len() > 1).count(),
        split_error: 0.0,
        n_removed: 0,
        minimum_volume: 0.0,
        removed_share: 0.0,
        volumes: [
            volumes[0],
            volumes[volumes.len() / 2],
            volumes[volumes.len() - 1],
        ],
        worst_aspect: qualities.iter().map(|q| q.aspect).fold(0.0, f64::max),
        smallest_dihedral: dihedrals.fold(f64::INFINITY, f64::min),
        n_slivers: qualities.iter().filter(|q| q.aspect > SLIVER).count(),
    }
}

pub(super) fn joint_set(file: &JointSetFile) -> JointSet {
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

#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    reason = "a test may stop where a library may not"
)]
mod tests {
    use std::path::Path;

    use crate::scene::file::SceneFile;
    use crate::scene::parse;
    use crate::scene::resolve::Scene;

    fn scene(slivers: &str) -> SceneFile {
        let text = format!(
            r#"(title: "a mass", domain: (min: (-9, -9, -9), max: (9, 9, 9)),
                materials: [(name: "rock", density: 2500, friction_angle_deg: 30)],
                rock_masses: [(name: "mass", material: "rock", boundary: Box(min: (0, 0, 0), max: (5, 4, 3)), seed: 3,
                    joint_sets: [(dip_deg: 60, dip_direction_deg: 100, spacing: 1, scatter_deg: 3, spacing_scatter: 0.4),
                                 (dip_deg: 70, dip_direction_deg: 210, spacing: 1, persistence: 0.8, spacing_scatter: 0.4),
                                 (dip_deg: 25, dip_direction_deg: 330, spacing: 1, scatter_deg: 3, spacing_scatter: 0.4)],
                    {slivers})],
                time: (duration: 1))"#
        );
        parse::read(&text).unwrap()
    }

    fn volume(scene: &Scene) -> f64 {
        scene.blocks.iter().map(|block| block.shape.volume()).sum()
    }

    /// Merged blocks keep the volume, are reported, and are written so that they read back the same.
    #[test]
    fn slivers_are_merged_and_written() {
        let folder = Path::new(".");
        let whole = Scene::resolve(scene(""), folder).unwrap();
        let file = scene("merge_slivers: (volume_share: 0.2, aspect: 8)");
        let merged = Scene::resolve(file, folder).unwrap();
        let (before, after) = (&whole.rock_masses[0], &merged.rock_masses[0]);
        assert_eq!(before.n_blocks, after.n_blocks + after.n_merged);
        assert!(after.n_merged > 0 && after.n_unions > 0 && after.worst_aspect <= 8.0);
        assert!((volume(&whole) / 60.0 - 1.0).abs() < 1e-12);
        assert!((volume(&merged) / 60.0 - 1.0).abs() < 1e-12);
        let said = after.to_string();
        let expected = format!(
            "; {} slivers merged, {} blocks of several parts",
            after.n_merged, after.n_unions
        );
        assert!(said.contains(&expected), "{said}");
        let text = merged.to_text().unwrap();
        let again = Scene::resolve(parse::read(&text).unwrap(), folder).unwrap();
        assert_eq!(again.blocks.len(), merged.blocks.len());
        assert!(
            again
                .blocks
                .iter()
                .zip(&merged.blocks)
                .all(|(a, b)| a.shape == b.shape)
        );
    }

    #[test]
    fn wrong_limits_of_slivers_are_refused_by_name() {
        let problems = Scene::resolve(scene("merge_slivers: (aspect: 1)"), Path::new("."));
        let problems = problems.unwrap_err();
        assert_eq!(problems[0].path, "rock_masses[0].merge_slivers.aspect");
        assert!(
            problems[0].message.contains("aspect is 1, must be >= 2"),
            "{}",
            problems[0].message
        );
    }
}
