//! Explicit or implicit viscous steps: as the file says, or by what they cost.
//!
//! An implicit step takes the velocity of a wall as it is, and a free block feels it afterward. The mud that sticks to the block within a step
//! follows it a step behind, as an added mass of
//!
//! ```text
//! m = ρ A √(ν dt)              A: surface of the box round the block                                   [kg]
//! ```
//! which, lagged, would make a block of less than `m` swing from step to step, further each time. Blocks of less than twice
//! this mass are refused.

use riprap_dda::{BlockDefinition, Material, Motion};
use riprap_sph::boundary::wall_particles::Slip;
use riprap_sph::{Dimensions, Rheology, Settings, ViscousStep};

use super::laws::Laws;
use crate::messages::Code;
use crate::scene::error::Problem;
use crate::scene::file::{SceneFile, ViscousStepFile};
use crate::scene::resolved::{FluidScene, ViscousSteps};
use crate::walls::WallMethod;

/// Field of the choice.
const PATH: &str = "numerics.viscous_step";
/// Ratio of the acoustic to the viscous step limit above which a warning is due.
const SLOW_VISCOSITY: f64 = 10.0;
/// The same above which viscous steps are implicit. A slump of mud takes the same time of the processor either way at 2.2, half at 11, a fifth
/// at 90.
const IMPLICIT: f64 = 2.0;
/// Mass that sticks to a free block over its own above which it is too light.
const LIGHT: f64 = 0.5;
/// Exponent of a flow law above which viscosities of the step before make its rates of shear oscillate.
const LARGEST_EXPONENT: f64 = 2.0;

/// Largest apparent viscosity at rest of any of the laws, or that of the scheme; Pa s.
fn viscosity_at_rest(settings: &Settings, laws: &Laws) -> f64 {
    let constant = settings.kinematic_viscosity() * settings.reference_density;
    let at_rest = laws.rheologies.iter().map(Rheology::viscosity_at_rest);
    at_rest.fold(constant, f64::max)
}

/// Reason why viscous steps of a scene cannot be implicit, with a remedy.
fn refusal(
    file: &SceneFile,
    settings: &Settings,
    laws: &Laws,
    (method, slip): (WallMethod, Slip),
) -> Option<String> {
    let mut asked = settings.clone();
    asked.scheme.viscous_step = ViscousStep::Implicit;
    if let Err(error) = asked.check_viscous_step() {
        return Some(error.to_string());
    }
    let thickens = |law: &Rheology| matches!(law, Rheology::HerschelBulkley { exponent, .. } if LARGEST_EXPONENT < *exponent);
    let with = match (method, slip) {
        _ if file.numerics.sleeping.is_some() => {
            "`numerics.sleeping`, as all water takes part in them; leave that out"
        }
        (WallMethod::Integral, Slip::None) => {
            "`interface.walls: Integral` that do not slip, whose shear is explicit; use `Particles`, or `slip: Free`"
        }
        (WallMethod::Particles, Slip::Friction(_)) => {
            "`interface.slip: Friction`, as the limit of friction is that of an explicit shear; use `slip: None`"
        }
        _ if laws.rheologies.iter().any(thickens) => {
            "a flow law of an exponent above 2, whose rates of shear would oscillate; use explicit ones"
        }
        _ => return None,
    };
    Some(format!("a viscous step cannot be implicit with {with}"))
}

/// Chooses the viscous steps of a scene; a run of some duration (s) and number of particles is warned of where viscosity limits the
/// step far more than sound does.
pub(super) fn choose(
    file: &SceneFile,
    settings: &mut Settings,
    laws: &Laws,
    (method, slip): (WallMethod, Slip),
    problems: &mut Vec<Problem>,
) -> ViscousSteps {
    let viscosity = viscosity_at_rest(settings, laws);
    let ratio = settings.sound_over_viscous_limit(viscosity / settings.reference_density);
    let asked = file.numerics.viscous_step;
    let wants = match asked {
        ViscousStepFile::Explicit => false,
        ViscousStepFile::Implicit => true,
        ViscousStepFile::Auto => settings.scheme.viscosity.is_after_morris() && IMPLICIT < ratio,
    };
    let refused = match wants {
        true => refusal(file, settings, laws, (method, slip)),
        false => None,
    };
    if asked == ViscousStepFile::Implicit
        && let Some(reason) = &refused
    {
        problems.push(Problem::error(
            Code::IncompatibleOptions,
            PATH,
            reason.clone(),
        ));
    }
    if wants && refused.is_none() {
        settings.scheme.viscous_step = ViscousStep::Implicit;
    }
    ViscousSteps {
        ratio,
        viscosity,
        is_given: asked != ViscousStepFile::Auto,
        refused,
    }
}

/// Refuses implicit steps, or chooses explicit ones, where a free block is too light for what sticks to it.
pub(in crate::scene) fn heed_blocks(
    file: &SceneFile,
    (blocks, materials): (&[BlockDefinition], &[Material]),
    fluid: &mut FluidScene,
    problems: &mut Vec<Problem>,
) {
    let settings = &fluid.settings;
    let sticks = (fluid.wall_method, fluid.slip) == (WallMethod::Particles, Slip::None);
    if settings.scheme.viscous_step == ViscousStep::Explicit || !sticks {
        return;
    }
    let layer = {
        let viscosity = fluid.viscous_steps.viscosity / settings.reference_density;
        let dt = settings.viscous_limit(viscosity) * fluid.viscous_steps.ratio;
        (viscosity * dt).sqrt()
    };
    let share = |block: &BlockDefinition| {
        let (min, max) = block.shape.aabb();
        let [x, y, z] = (max - min).into();
        let area = match settings.dimensions {
            Dimensions::Two { .. } => 2.0 * (x + z) * y,
            Dimensions::Three => 2.0 * (x * y + y * z + z * x),
        };
        let mass = materials[block.material].density * block.shape.volume();
        settings.reference_density * area * layer / mass
    };
    let free = blocks.iter().zip(&file.blocks);
    let free = free.filter(|(block, _)| matches!(block.motion, Motion::Free));
    let shares = free.map(|(block, written)| (share(block), &written.name));
    let Some((share, name)) = shares.max_by(|one, other| one.0.total_cmp(&other.0)) else {
        return;
    };
    if share <= LIGHT {
        return;
    }
    let reason = format!(
        "a viscous step cannot be implicit with block `{name}`: what sticks to it within a step of the largest viscosity has {share:.2} of \
         its mass, and a lag of more than {LIGHT} would make it swing; use `Explicit`, or lower the largest viscosity"
    );
    if fluid.viscous_steps.is_given {
        problems.push(Problem::error(
            Code::IncompatibleOptions,
            PATH,
            reason.clone(),
        ));
    }
    fluid.viscous_steps.refused = Some(reason);
    fluid.settings.scheme.viscous_step = ViscousStep::Explicit;
    let work = (file.time.duration, fluid.lattice.positions.len());
    problems.extend(slow_viscosity(
        &fluid.settings,
        &fluid.viscous_steps,
        !fluid.rheologies.is_empty(),
        work,
    ));
}

/// Warning where viscosity limits explicit steps far more than sound does, in a run of some duration (s) and number of
/// particles.
pub(super) fn slow_viscosity(
    settings: &Settings,
    steps: &ViscousSteps,
    has_laws: bool,
    (duration, n): (f64, usize),
) -> Option<Problem> {
    let &ViscousSteps {
        ratio, viscosity, ..
    } = steps;
    if settings.scheme.viscous_step == ViscousStep::Implicit || ratio <= SLOW_VISCOSITY {
        return None;
    }
    let viscous = settings.viscous_limit(viscosity / settings.reference_density);
    let n_steps = duration / viscous;
    let path = match has_laws {
        true => "fluid.rheology",
        false => "fluid.dynamic_viscosity",
    };
    let implicit = match &steps.refused {
        Some(reason) => format!("; {reason}"),
        None if settings.scheme.viscosity.is_after_morris() => {
            ", or take `numerics.viscous_step: Auto`".to_owned()
        }
        None => String::new(),
    };
    Some(Problem::warning(
        Code::ViscosityLimitsStep,
        path,
        format!(
            "a viscosity of {viscosity:.3e} Pa s limits the step to {viscous:.2e} s, {ratio:.0} times shorter than \
             sound does: {n_steps:.1e} steps and {:.1e} particle steps; up to {:.3e} Pa s it would cost nothing. \
             Choose the regularization from the acceptable creep, or coarsen `fluid.resolution`{implicit}",
            n_steps * n as f64,
            viscosity / ratio,
        ),
    ))
}
