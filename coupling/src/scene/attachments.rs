//! Loads, supports, bolts, holds, joints, deformability, damping and detection for the block solver.

use riprap_dda::{
    Attachment, BlockDefinition, ContactDetection, Deformability, DeformableModel, Hold,
    JointOverride, NormalLaw, RollingLaw, Shape, StaticDamping, StepBound, StressLaw, Turning,
    Vec3,
};

use super::file::vec3;
use super::file::{
    AttachmentFile, Axis, ContactDetectionFile, DeformableFile, DeformableModelFile, HoldFile,
    JointFile, NormalLawFile, RollingLawFile, SceneFile, StaticDampingFile, StepBoundFile,
    TurningFile,
};
use super::names::Names;
use crate::series::Series;
use crate::world::Weakening;

/// Loads, supports, bolts and joints of the file.
pub(super) fn attachments(
    file: &SceneFile,
    names: &Names,
    blocks: &[BlockDefinition],
) -> Vec<Attachment> {
    let attachments = file.attachments.iter();
    attachments
        .map(|one| attachment(one, names, blocks))
        .collect()
}

fn attachment(file: &AttachmentFile, names: &Names, blocks: &[BlockDefinition]) -> Attachment {
    let number = |name: &String| names.block(name);
    match file {
        AttachmentFile::PointLoad {
            block,
            point,
            force,
        } => Attachment::PointLoad {
            block: number(block),
            point: vec3(*point),
            force: vec3(*force),
        },
        AttachmentFile::BodyLoad {
            block,
            acceleration,
        } => Attachment::BodyLoad {
            block: number(block),
            acceleration: vec3(*acceleration),
        },
        AttachmentFile::Pressure {
            block,
            face,
            pressure,
        } => {
            let block = number(block);
            let (part, face) = facing(&blocks[block].shape, &vec3(*face));
            Attachment::FaceLoad {
                block,
                part,
                face,
                pressure: *pressure,
            }
        }
        AttachmentFile::FixedPoint {
            block,
            point,
            stiffness,
        } => Attachment::FixedPoint {
            block: number(block),
            point: vec3(*point),
            stiffness: *stiffness,
        },
        AttachmentFile::RockBolt {
            from,
            from_point,
            to,
            to_point,
            stiffness,
            pretension,
            yield_force,
        } => Attachment::RockBolt {
            blocks: (number(from), number(to)),
            points: (vec3(*from_point), vec3(*to_point)),
            stiffness: *stiffness,
            pretension: *pretension,
            yield_force: *yield_force,
        },
        AttachmentFile::HeldPoint { block, point } => Attachment::HeldPoint {
            block: number(block),
            point: vec3(*point),
        },
        AttachmentFile::BallJoint { from, to, point } => Attachment::BallJoint {
            blocks: (number(from), number(to)),
            point: vec3(*point),
        },
        AttachmentFile::Rod {
            from,
            from_point,
            to,
            to_point,
            strength,
        } => Attachment::Rod {
            blocks: (number(from), number(to)),
            points: (vec3(*from_point), vec3(*to_point)),
            strength: strength.unwrap_or(f64::INFINITY),
        },
    }
}

/// Joint properties between two materials.
pub(super) fn joints(file: &SceneFile, names: &Names) -> Vec<JointOverride> {
    file.joints
        .iter()
        .map(|joint| JointOverride {
            materials: numbers(names, joint),
            friction_angle: joint.friction_angle_deg.map(f64::to_radians),
            residual_friction_angle: joint.residual_friction_angle_deg.map(f64::to_radians),
            cohesion: joint.cohesion,
            residual_cohesion: joint.residual_cohesion,
            tensile_strength: joint.tensile_strength,
            restitution: joint.restitution,
            shear_damping_ratio: joint.shear_damping_ratio,
            rolling_friction: joint.rolling_friction,
            twisting_friction: joint.twisting_friction,
        })
        .collect()
}

/// Joints that weaken with time.
pub(super) fn weakenings(file: &SceneFile, names: &Names) -> Vec<Weakening> {
    let series = |ramp: &[(f64, f64)]| {
        let whole = vec![(0.0, 1.0)];
        Series::new(if ramp.is_empty() {
            whole
        } else {
            ramp.to_vec()
        })
    };
    let weakening = |joint: &JointFile| {
        let (friction, cohesion) = (&joint.friction_ramp, &joint.cohesion_ramp);
        (!(friction.is_empty() && cohesion.is_empty())).then(|| Weakening {
            materials: numbers(names, joint),
            friction: series(friction),
            cohesion: series(cohesion),
        })
    };
    file.joints.iter().filter_map(weakening).collect()
}

/// Numbers of the two materials of a joint.
fn numbers(names: &Names, joint: &JointFile) -> (usize, usize) {
    let (first, second) = &joint.between;
    (names.material(first), names.material(second))
}

/// Part and face whose normal is closest to a direction; (0, 0) for a sphere, which has none.
fn facing(shape: &Shape, direction: &Vec3) -> (usize, usize) {
    let mut best = (f64::NEG_INFINITY, (0, 0));
    if let Shape::Polyhedra(parts) = shape {
        for (part, body) in parts.iter().enumerate() {
            for face in 0..body.n_faces() {
                let along = body.face_normal(face).dot(direction);
                if along > best.0 {
                    best = (along, (part, face));
                }
            }
        }
    }
    best.1
}

pub fn deformability(file: &DeformableFile) -> Deformability {
    let (xx, yy, zz, yz, zx, xy) = file.initial_stress;
    Deformability {
        model: match file.model {
            DeformableModelFile::Affine => {
                DeformableModel::Affine12(StressLaw::SaintVenantKirchhoff)
            }
            DeformableModelFile::Corotational => DeformableModel::Affine12(StressLaw::Corotational),
            DeformableModelFile::Classical => DeformableModel::Dda12,
        },
        initial_stress: [xx, yy, zz, yz, zx, xy],
        strain_mass_factor: file.strain_mass_factor,
    }
}

pub fn hold(file: &HoldFile) -> Hold {
    Hold {
        directions: file.directions.iter().map(|&axis| unit(axis)).collect(),
        turning: match file.turning {
            TurningFile::Free => Turning::Free,
            TurningFile::About(axis) => Turning::About(unit(axis)),
            TurningFile::Held => Turning::Held,
        },
    }
}

fn unit(axis: Axis) -> Vec3 {
    let mut direction = Vec3::zeros();
    direction[axis.index()] = 1.0;
    direction
}

pub fn step_bound(file: StepBoundFile) -> StepBound {
    match file {
        StepBoundFile::Compliances => StepBound::Compliances,
        StepBoundFile::Eigenvalues => StepBound::Eigenvalues,
    }
}

pub fn contact_detection(file: ContactDetectionFile) -> ContactDetection {
    match file {
        ContactDetectionFile::Verified => ContactDetection::Verified,
        ContactDetectionFile::FastCommonPlane => ContactDetection::FastCommonPlane,
    }
}

pub fn normal_law(file: NormalLawFile) -> NormalLaw {
    match file {
        NormalLawFile::Linear => NormalLaw::Linear,
        NormalLawFile::Hertz => NormalLaw::Hertz,
    }
}

pub fn rolling_law(file: RollingLawFile) -> RollingLaw {
    match file {
        RollingLawFile::Relative => RollingLaw::Relative,
        RollingLawFile::OwnSpin => RollingLaw::OwnSpin,
    }
}

pub fn static_damping(file: StaticDampingFile) -> StaticDamping {
    match file {
        StaticDampingFile::MassProportional(alpha) => StaticDamping::MassProportional(alpha),
        StaticDampingFile::Local(alpha) => StaticDamping::Local(alpha),
        StaticDampingFile::Kinetic(kappa) => StaticDamping::Kinetic(kappa),
    }
}
