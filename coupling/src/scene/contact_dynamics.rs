//! Contact dynamics of blocks: numbers where the file has none, and refusals.

use riprap_dda::{
    BlockDefinition, ContactDynamics, ContactSolver, DEFAULT_SHEAR_DAMPING_RATIO, Integrator,
    Motion, Vec3,
};

use super::error::Problem;
use super::file::{
    BlockIntegratorFile, ContactSolverFile, DeformableModelFile, NormalLawFile, RollingLawFile,
    SceneFile, vec3,
};
use crate::messages::Code;

/// Step over the time in which the smallest block falls half its size: 5 ms for 0.3 m.
const STEP: f64 = 0.03;
/// Longest step over the duration, where nothing else limits it.
const SHARE_OF_DURATION: f64 = 1e-2;

/// The integrator of the blocks, with problems of what it does not model.
pub(super) fn integrator(
    file: &SceneFile,
    blocks: &[BlockDefinition],
    problems: &mut Vec<Problem>,
) -> Integrator {
    let BlockIntegratorFile::ContactDynamics {
        time_step,
        tolerance,
        sweeps,
        solver,
    } = file.numerics.blocks
    else {
        problems.extend(twisting_of_springs(file));
        return Integrator::CentralDifference;
    };
    problems.extend(not_modeled(file));
    problems.extend(without_effect(file));
    let usual = ContactDynamics::default();
    Integrator::ContactDynamics(ContactDynamics {
        time_step: time_step
            .unwrap_or_else(|| step_for(blocks, &vec3(file.gravity), file.time.duration)),
        tolerance: tolerance.unwrap_or(usual.tolerance),
        n_iterations: sweeps.map_or(usual.n_iterations, |sweeps| sweeps as usize),
        solver: match solver {
            ContactSolverFile::Chosen => ContactSolver::Chosen,
            ContactSolverFile::GaussSeidel => ContactSolver::GaussSeidel,
            ContactSolverFile::Gradient => ContactSolver::Gradient,
        },
    })
}

/// Contact dynamics with the numbers that suit a scene of these blocks.
pub(crate) fn suitable(blocks: &[BlockDefinition], gravity: &Vec3, duration: f64) -> Integrator {
    Integrator::ContactDynamics(ContactDynamics {
        time_step: step_for(blocks, gravity, duration),
        ..ContactDynamics::default()
    })
}

/// Step that suits the smallest free block; s.
fn step_for(blocks: &[BlockDefinition], gravity: &Vec3, duration: f64) -> f64 {
    let free = blocks.iter().filter(|b| matches!(b.motion, Motion::Free));
    let smallest = free.map(|b| b.shape.volume().cbrt());
    let smallest = smallest.fold(f64::INFINITY, f64::min);
    // infinite without gravity and without free blocks
    (STEP * (smallest / gravity.norm()).sqrt()).min(SHARE_OF_DURATION * duration)
}

/// Errors of a resistance to twisting, which springs do not have.
fn twisting_of_springs(file: &SceneFile) -> Vec<Problem> {
    let message = "springs do not resist twisting; take `numerics.blocks: ContactDynamics()`, or leave `twisting_friction` out";
    let refuse = |path| Problem::error(Code::IncompatibleOptions, path, message);
    let materials = (file.materials.iter().enumerate())
        .filter(|(_, material)| 0.0 < material.twisting_friction)
        .map(|(index, _)| format!("materials[{index}].twisting_friction"));
    let joints = (file.joints.iter().enumerate())
        .filter(|(_, joint)| joint.twisting_friction.is_some_and(|mu| 0.0 < mu))
        .map(|(index, _)| format!("joints[{index}].twisting_friction"));
    materials.chain(joints).map(refuse).collect()
}

/// Errors of models that only springs have.
fn not_modeled(file: &SceneFile) -> Vec<Problem> {
    let mut found = Vec::new();
    let mut refuse = |path: String, message: &str| {
        found.push(Problem::error(Code::IncompatibleOptions, path, message));
    };
    for (index, block) in file.blocks.iter().enumerate() {
        let Some(deformable) = &block.deformable else {
            continue;
        };
        if deformable.model == DeformableModelFile::Classical {
            refuse(
                format!("blocks[{index}].deformable.model"),
                "contact dynamics has no classical unknowns, whose stress follows increments; take `Affine`, or `numerics.blocks: CentralDifference`",
            );
        }
        if 1.0 < deformable.strain_mass_factor {
            refuse(
                format!("blocks[{index}].deformable.strain_mass_factor"),
                "the strain of a block does not limit the step of contact dynamics; leave `strain_mass_factor` out",
            );
        }
    }
    let no_residual = "contact dynamics has no residual cohesion, with which friction is no cone; leave it out, or set it to 0";
    for (index, material) in file.materials.iter().enumerate() {
        if 0.0 < material.residual_cohesion {
            refuse(format!("materials[{index}].residual_cohesion"), no_residual);
        }
    }
    for (index, joint) in file.joints.iter().enumerate() {
        if joint
            .residual_cohesion
            .is_some_and(|cohesion| 0.0 < cohesion)
        {
            refuse(format!("joints[{index}].residual_cohesion"), no_residual);
        }
    }
    let rolls = file.materials.iter().any(|m| 0.0 < m.rolling_friction)
        || (file.joints.iter()).any(|j| j.rolling_friction.is_some_and(|mu| 0.0 < mu));
    if rolls && file.numerics.rolling_law == RollingLawFile::OwnSpin {
        refuse(
            "numerics.rolling_law".to_owned(),
            "contact dynamics resists rolling between bodies, not against the world; take `Relative`",
        );
    }
    if file.numerics.static_damping.is_some() {
        refuse(
            "numerics.static_damping".to_owned(),
            "contact dynamics comes to rest by itself; leave `static_damping` out",
        );
    }
    found
}

/// Warnings of numbers of springs.
fn without_effect(file: &SceneFile) -> Vec<Problem> {
    let mut found = Vec::new();
    let mut warn = |path: String| {
        let message = "has no effect with contact dynamics, which has no springs at contacts";
        found.push(Problem::warning(Code::OptionWithoutEffect, path, message));
    };
    for (index, material) in file.materials.iter().enumerate() {
        for (field, is_given) in [
            ("contact_stiffness", material.contact_stiffness.is_some()),
            ("joint_stiffness", material.joint_stiffness.is_some()),
            (
                "shear_damping_ratio",
                material.shear_damping_ratio != DEFAULT_SHEAR_DAMPING_RATIO,
            ),
        ] {
            if is_given {
                warn(format!("materials[{index}].{field}"));
            }
        }
    }
    for (index, joint) in file.joints.iter().enumerate() {
        if joint.shear_damping_ratio.is_some() {
            warn(format!("joints[{index}].shear_damping_ratio"));
        }
    }
    if file.numerics.block_step_bound.is_some() {
        warn("numerics.block_step_bound".to_owned());
    }
    if file.numerics.normal_law == NormalLawFile::Hertz {
        warn("numerics.normal_law".to_owned());
    }
    found
}
