//! Scheme of the fluid: that of the preset, with the choices of the file in place of its own.

use riprap_sph::scheme::{DensityDiffusion, DensityMethod, Stepping, Viscosity};
use riprap_sph::{
    Dimensions, FluidError, PresetParameters, Rheology, Scheme, Settings, StateEquation,
    ViscousStep,
};

use crate::messages::Code;
use crate::scene::error::Problem;
use crate::scene::file::{
    DimensionsFile, DomainFile, FluidFile, NumericsFile, SceneFile, ViscosityFile,
};

/// Water at 20 degrees; Pa s.
const WATER_VISCOSITY: f64 = 1.002e-3;
/// Dynamic viscosity at which the published scheme is stable, over `ρ c0 H`.
const STABLE: f64 = 0.012;

/// Density of the fluid (kg/m³) and its dynamic viscosity (Pa s).
pub(super) type Water = (f64, f64);

/// Density and dynamic viscosity of the fluid, or those of a scene without any.
pub(super) fn water(file: &SceneFile) -> Water {
    file.fluid.as_ref().map_or((1000.0, 0.0), |fluid| {
        (fluid.density, dynamic_viscosity(fluid))
    })
}

/// Dynamic viscosity of the file, or that of water; Pa s.
pub(super) fn dynamic_viscosity(fluid: &FluidFile) -> f64 {
    fluid.dynamic_viscosity.unwrap_or(WATER_VISCOSITY)
}

/// Dynamic viscosity of the fluid under a scheme; Pa s.
pub(in crate::scene) fn chosen_viscosity(fluid: &FluidFile, scheme: &Scheme) -> f64 {
    match scheme.viscosity {
        Viscosity::Published { dynamic_viscosity } => dynamic_viscosity,
        _ => dynamic_viscosity(fluid),
    }
}

/// Gives the published viscosity, where the file leaves it out, that which its pair of kernels needs to be stable.
pub(super) fn stabilize(file: &SceneFile, settings: &mut Settings) {
    let given = file
        .fluid
        .as_ref()
        .and_then(|fluid| fluid.dynamic_viscosity);
    if let (Viscosity::Published { dynamic_viscosity }, None) =
        (&mut settings.scheme.viscosity, given)
    {
        let support = 2.0 * settings.smoothing_length;
        *dynamic_viscosity = STABLE * settings.reference_density * settings.sound_speed * support;
    }
}

/// Dimensions of the flow.
pub(in crate::scene) fn dimensions(domain: &DomainFile) -> Dimensions {
    match domain.dimensions {
        DimensionsFile::Three => Dimensions::Three,
        DimensionsFile::Two => Dimensions::Two {
            width: domain.max.1 - domain.min.1,
        },
    }
}

/// Parameters of the preset for the fluid of the file.
pub(super) fn preset(file: &SceneFile) -> PresetParameters {
    let (density, viscosity) = water(file);
    let preset = riprap_sph::Preset::from(file.numerics.preset);
    preset.parameters(dimensions(&file.domain), density, viscosity)
}

/// Ratio of smoothing length to particle spacing; –.
pub(super) fn smoothing_length_ratio(file: &SceneFile) -> f64 {
    let given = file.numerics.smoothing_length_ratio;
    given.unwrap_or_else(|| preset(file).smoothing_length_ratio)
}

/// Scheme of the file; `law` is the first flow law of the fluid, if it has any.
pub(super) fn scheme(file: &SceneFile, law: Option<Rheology>) -> Scheme {
    let numerics = &file.numerics;
    let base = preset(file).scheme;
    let density = numerics.density.map_or(base.density, Into::into);
    // summation has no rate that diffusion could act on
    let diffusion = match density {
        DensityMethod::Continuity => base.diffusion,
        DensityMethod::Summation => DensityDiffusion::None,
    };
    // nor may symplectic Euler go with a rate
    let stepping = match (density, base.stepping) {
        (DensityMethod::Continuity, Stepping::SymplecticEuler) => Stepping::KickDriftKick,
        (_, stepping) => stepping,
    };
    Scheme {
        kernel: numerics.kernel.map_or(base.kernel, Into::into),
        density,
        state_equation: (numerics.state_equation).map_or(StateEquation::Linear, Into::into),
        negative_pressure: (numerics.negative_pressure).map_or(base.negative_pressure, Into::into),
        diffusion: numerics.density_diffusion.map_or(diffusion, Into::into),
        viscosity: viscosity(numerics, base.viscosity, water(file), law),
        // chosen once flow laws and walls are known
        viscous_step: ViscousStep::Explicit,
        bulk_viscosity: numerics.bulk_viscosity.unwrap_or(base.bulk_viscosity),
        shifting: numerics.shifting.map_or(base.shifting, Into::into),
        stepping: numerics.stepping.map_or(stepping, Into::into),
        precision: numerics.precision.map_or(base.precision, Into::into),
    }
}

fn viscosity(
    numerics: &NumericsFile,
    of_preset: Viscosity,
    (density, dynamic_viscosity): Water,
    law: Option<Rheology>,
) -> Viscosity {
    let kinematic_viscosity = dynamic_viscosity / density;
    let rheological = |law: Option<Rheology>| Viscosity::Rheological {
        rheology: law.unwrap_or(Rheology::Newtonian { dynamic_viscosity }),
    };
    match numerics.viscosity {
        None if law.is_some() => rheological(law),
        None => of_preset,
        Some(ViscosityFile::Off) => Viscosity::None,
        Some(ViscosityFile::Published) => Viscosity::Published { dynamic_viscosity },
        Some(ViscosityFile::Artificial(alpha)) => Viscosity::Artificial { alpha },
        Some(ViscosityFile::Laminar) => Viscosity::Laminar {
            kinematic_viscosity,
        },
        Some(ViscosityFile::Morris) => Viscosity::Morris {
            kinematic_viscosity,
        },
        Some(ViscosityFile::Rheological) => rheological(law),
        Some(ViscosityFile::SubParticleScale(smagorinsky)) => Viscosity::SubParticleScale {
            kinematic_viscosity,
            smagorinsky,
        },
    }
}

/// Refusal of bulk viscosity that has no rate of density to act on.
pub(super) fn bulk_without_rates(scheme: &Scheme) -> Option<Problem> {
    let is_refused = 0.0 < scheme.bulk_viscosity && scheme.density == DensityMethod::Summation;
    is_refused.then(|| {
        Problem::error(
            Code::IncompatibleOptions,
            "numerics.bulk_viscosity",
            "bulk viscosity acts on the rate of density, which `Summation` does not have; use `Continuity`, or leave it out",
        )
    })
}

/// Refusal of a stepping that makes sound grow, and a warning where it may.
pub(super) fn growing_sound(scheme: &Scheme) -> Option<Problem> {
    let path = "numerics.stepping";
    match (scheme.stepping, scheme.density, scheme.diffusion) {
        (Stepping::SymplecticEuler, DensityMethod::Continuity, _) => Some(Problem::error(
            Code::GrowingSound,
            path,
            FluidError::GrowingSound.to_string(),
        )),
        (Stepping::PredictorCorrector, DensityMethod::Continuity, DensityDiffusion::None) => {
            Some(Problem::warning(
                Code::GrowingSound,
                path,
                "without density diffusion the predictor-corrector lets sound of frequency ω grow by (ω dt)⁴/8 a step, \
             which viscosity has to take; set `numerics.density_diffusion`, or use `KickDriftKick`",
            ))
        }
        _ => None,
    }
}
