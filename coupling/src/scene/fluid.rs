//! From the fluid of the file to what the solver needs: presets, sound speed, walls, the state at rest.

use riprap_sph::boundary::wall_particles::Slip;
use riprap_sph::scheme::{
    ALPHA, DIFFUSION, DensityDiffusion, DensityMethod, SHIFTING, Shifting, Stepping, Viscosity,
};
use riprap_sph::state_equation::State;
use riprap_sph::{
    Dimensions, KernelChoice, NegativePressure as Clamping, Precision, Scheme, StateEquation, Vec3,
};

use riprap_dda::Shape;

use super::error::Problem;
use super::file::{
    Axis, DensityDiffusionFile, DensityFile, DimensionsFile, FluidFile, KernelFile,
    NegativePressure, NumericsFile, PrecisionFile, Preset, RegionShapeFile, SceneFile,
    ShiftingFile, SlipFile, StateEquationFile, ViscosityFile, WallMethodFile,
};
use super::fill::Lattice;
use super::resolve::{FluidScene, vec3};
use crate::interface::{DAMPING_RATIO, STANDOFF, WallSettings};
use crate::walls::integral::CLOSEST;

/// Sound speed over the fastest expected flow: density then varies by about 1 %.
const SOUND_SPEED_RATIO: f64 = 10.0;
/// Depth, in spacings, to which still water presses its lowest row into a penalty wall.
const STATIC_PENETRATION: f64 = 0.1;
/// Depth, in spacings, to which a particle at the expected speed enters a penalty wall.
const IMPACT_PENETRATION: f64 = 0.25;

/// Numbers of a preset, each where the file has none.
struct PresetNumbers {
    smoothing_length_ratio: f64,
    time_step_factor: f64,
    kernel: KernelFile,
    density: DensityFile,
    diffusion: DensityDiffusionFile,
    viscosity: ViscosityFile,
    shifting: ShiftingFile,
    negative_pressure: NegativePressure,
    precision: PrecisionFile,
    walls: WallMethodFile,
}

impl Preset {
    fn numbers(self, dimensions: DimensionsFile) -> PresetNumbers {
        let standard = PresetNumbers {
            // in space a support of 2.6 spacings, 80 neighbours; in a plane one of 4, 50 neighbours: with the
            // 21 of 2.6 still water stirs itself
            smoothing_length_ratio: match dimensions {
                DimensionsFile::Three => 1.3,
                DimensionsFile::Two => 2.0,
            },
            // customary; a lattice allows 1.3
            time_step_factor: 0.5,
            kernel: KernelFile::WendlandC2,
            density: DensityFile::Continuity,
            diffusion: DensityDiffusionFile::Fourtakas(DIFFUSION),
            viscosity: ViscosityFile::Artificial(ALPHA),
            shifting: ShiftingFile::None,
            negative_pressure: NegativePressure::Kept,
            precision: PrecisionFile::Single,
            walls: WallMethodFile::Particles,
        };
        match self {
            Self::Standard => standard,
            Self::Mueller2003 => PresetNumbers {
                // support of three spacings: the lattice sum of poly6 within 0.3 % of one
                smoothing_length_ratio: 1.5,
                // half the lattice limit leaves room for disorder
                time_step_factor: 0.5,
                kernel: KernelFile::Mueller,
                density: DensityFile::Summation,
                diffusion: DensityDiffusionFile::None,
                viscosity: ViscosityFile::Published,
                // summation density is low at surfaces: without the clamp particles clump
                negative_pressure: NegativePressure::Clamped,
                precision: PrecisionFile::Double,
                walls: WallMethodFile::Penalty,
                ..standard
            },
            Self::Reference => PresetNumbers {
                // support of four spacings: waves that travel far (Colagrossi et al. 2013)
                smoothing_length_ratio: 2.0,
                time_step_factor: 0.2,
                diffusion: DensityDiffusionFile::Antuono(DIFFUSION),
                viscosity: ViscosityFile::Laminar,
                shifting: ShiftingFile::Fickian(SHIFTING),
                precision: PrecisionFile::Double,
                ..standard
            },
        }
    }
}

/// Fills in what the file leaves to riprap and makes the settings of the fluid.
pub(super) fn resolve(
    file: &mut SceneFile,
    lattice: Lattice,
    expected_speed: f64,
    problems: &mut Vec<Problem>,
) -> FluidScene {
    let gravity = vec3(file.gravity);
    let (density, viscosity) = file.fluid.as_ref().map_or((1000.0, 0.0), |fluid| {
        (fluid.density, fluid.dynamic_viscosity)
    });
    let preset = file.numerics.preset.numbers(file.domain.dimensions);
    let dimensions = match file.domain.dimensions {
        DimensionsFile::Three => Dimensions::Three,
        DimensionsFile::Two => Dimensions::Two {
            width: file.domain.max.1 - file.domain.min.1,
        },
    };
    let ratio = *file
        .numerics
        .smoothing_length_ratio
        .get_or_insert(preset.smoothing_length_ratio);
    let factor = *file
        .numerics
        .time_step_factor
        .get_or_insert(preset.time_step_factor);
    let sound_speed = sound_speed(
        &mut file.numerics,
        expected_speed.max((gravity.norm() * lattice.depth).sqrt()),
        problems,
    );
    let scheme = scheme(&mut file.numerics, &preset, (density, viscosity));
    let spacing = lattice.particle_spacing(dimensions);
    let mass = density * lattice.particle_volume();
    let method = *file.interface.walls.get_or_insert(preset.walls);
    let walls = match method {
        WallMethodFile::Particles => WallSettings {
            stiffness: 0.0,
            damping: 0.0,
            particle_spacing: spacing,
            standoff: STANDOFF * spacing,
        },
        WallMethodFile::Integral => {
            refuse_integrals(file, &scheme, problems);
            let stiffness = mass * (sound_speed / spacing).powi(2);
            WallSettings {
                stiffness,
                damping: 2.0 * DAMPING_RATIO * (stiffness * mass).sqrt(),
                particle_spacing: spacing,
                standoff: CLOSEST * spacing,
            }
        }
        WallMethodFile::Penalty => {
            let least = expected_speed.max((gravity.norm() * lattice.depth).sqrt());
            let stiffness = *file.interface.penalty_stiffness.get_or_insert(
                (density * gravity.norm() * lattice.depth * spacing / STATIC_PENETRATION)
                    .max(mass * (least / (IMPACT_PENETRATION * spacing)).powi(2)),
            );
            let damping = *file
                .interface
                .penalty_damping
                .get_or_insert(2.0 * DAMPING_RATIO * (stiffness * mass).sqrt());
            WallSettings {
                stiffness,
                damping,
                particle_spacing: spacing,
                standoff: STANDOFF * spacing,
            }
        }
    };
    let state = State {
        equation: scheme.state_equation,
        reference_density: density,
        sound_speed,
        negative: scheme.negative_pressure,
    };
    let pressures = hydrostatic(&lattice, file.fluid.as_ref(), &gravity, &state);
    FluidScene {
        settings: riprap_sph::Settings {
            particle_spacing: lattice.spacing,
            smoothing_length: ratio * spacing,
            reference_density: density,
            sound_speed,
            scheme,
            dimensions,
            gravity,
            time_step_factor: factor,
            domain: (vec3(file.domain.min), vec3(file.domain.max)),
            periodic: [Axis::X, Axis::Y, Axis::Z].map(|axis| file.domain.periodic.contains(&axis)),
        },
        walls,
        wall_method: method,
        slip: match file.interface.slip {
            SlipFile::Free => Slip::Free,
            SlipFile::None => Slip::None,
        },
        expected_speed,
        pressures,
        lattice,
    }
}

/// What walls of integrals cannot do yet.
fn refuse_integrals(file: &SceneFile, scheme: &Scheme, problems: &mut Vec<Problem>) {
    let mut refuse = |found: &str| {
        problems.push(Problem::error(
            "interface.walls",
            format!("Integral {found}; use Particles"),
        ));
    };
    if scheme.kernel != KernelChoice::WendlandC2 {
        refuse("is known for the kernel WendlandC2 only");
    }
    if scheme.density != DensityMethod::Continuity {
        refuse("wants `numerics.density` Continuity");
    }
    if file.domain.dimensions == DimensionsFile::Two {
        refuse("is known in three dimensions only");
    }
    if !file.domain.periodic.is_empty() {
        refuse("does not see blocks across a periodic side");
    }
}

/// Refuses shapes that walls other than penalty springs cannot be made of: water would run through them.
pub(super) fn refuse_shapes(
    file: &SceneFile,
    solids: &[(String, Shape)],
    method: WallMethodFile,
    problems: &mut Vec<Problem>,
) {
    if method == WallMethodFile::Penalty {
        return;
    }
    let hollow = |shape: &Shape| matches!(shape, Shape::Sphere { .. } | Shape::Surface(_));
    let mut found = solids
        .iter()
        .enumerate()
        .filter(|(_, (_, shape))| hollow(shape));
    let Some((index, (name, shape))) = found.next() else {
        return;
    };
    let what = match shape {
        Shape::Sphere { .. } => "a ball",
        _ => "a surface of triangles",
    };
    let others = match found.count() {
        0 => String::new(),
        n => format!(" and {n} more like it"),
    };
    // grains are blocks past the end of the list of the text
    let path = match file.blocks.get(index) {
        Some(_) => format!("blocks[{index}].shape"),
        None => "interface.walls".to_owned(),
    };
    problems.push(Problem::error(
        path,
        format!(
            "block `{name}`{others}: {what} has no walls of {method:?}, and water would run through it; set \
             interface.walls to Penalty, or use a polyhedron"
        ),
    ));
}

/// Pressures of water at rest below the level of each region, compressed by its own weight.
fn hydrostatic(
    lattice: &Lattice,
    fluid: Option<&FluidFile>,
    gravity: &Vec3,
    state: &State,
) -> Vec<f64> {
    let levels: Vec<f64> = fluid
        .iter()
        .flat_map(|fluid| &fluid.regions)
        .map(|region| match region.shape {
            RegionShapeFile::Box { max, .. } => max.2,
            RegionShapeFile::Below { level, .. } => level,
        })
        .collect();
    let pull = (-gravity.z).max(0.0);
    lattice
        .positions
        .iter()
        .zip(&lattice.region)
        .map(|(x, &region)| {
            let depth = levels.get(region as usize).map_or(0.0, |level| level - x.z);
            state.hydrostatic_pressure(pull, depth.max(0.0))
        })
        .collect()
}

/// The sound speed of the file, or that which the fastest expected flow asks for.
fn sound_speed(numerics: &mut NumericsFile, fastest: f64, problems: &mut Vec<Problem>) -> f64 {
    // water without gravity or motion has no speed of its own: any positive number will do
    let fallback = if fastest > 0.0 {
        SOUND_SPEED_RATIO * fastest
    } else {
        1.0
    };
    let sound_speed = *numerics.sound_speed.get_or_insert(fallback);
    if sound_speed < 0.999 * SOUND_SPEED_RATIO * fastest {
        problems.push(Problem::warning(
            "numerics.sound_speed",
            format!(
                "{sound_speed:.3} m/s is less than {SOUND_SPEED_RATIO} times the fastest expected speed of \
                 {fastest:.3} m/s: density will vary by {:.1} %; raise it to {:.1} m/s",
                100.0 * (fastest / sound_speed).powi(2),
                SOUND_SPEED_RATIO * fastest,
            ),
        ));
    }
    sound_speed
}

fn scheme(
    numerics: &mut NumericsFile,
    preset: &PresetNumbers,
    (density, dynamic_viscosity): (f64, f64),
) -> Scheme {
    let method = *numerics.density.get_or_insert(preset.density);
    // summation has no rate that diffusion could act on
    let diffusion = match method {
        DensityFile::Continuity => preset.diffusion,
        DensityFile::Summation => DensityDiffusionFile::None,
    };
    let kinematic_viscosity = dynamic_viscosity / density;
    Scheme {
        kernel: match *numerics.kernel.get_or_insert(preset.kernel) {
            KernelFile::Mueller => KernelChoice::Mueller,
            KernelFile::WendlandC2 => KernelChoice::WendlandC2,
            KernelFile::CubicSpline => KernelChoice::CubicSpline,
        },
        density: match method {
            DensityFile::Summation => DensityMethod::Summation,
            DensityFile::Continuity => DensityMethod::Continuity,
        },
        state_equation: match *numerics
            .state_equation
            .get_or_insert(StateEquationFile::Linear)
        {
            StateEquationFile::Linear => StateEquation::Linear,
            StateEquationFile::Tait => StateEquation::Tait,
        },
        negative_pressure: match *numerics
            .negative_pressure
            .get_or_insert(preset.negative_pressure)
        {
            NegativePressure::Clamped => Clamping::Clamped,
            NegativePressure::Kept => Clamping::Kept,
        },
        diffusion: match *numerics.density_diffusion.get_or_insert(diffusion) {
            DensityDiffusionFile::None => DensityDiffusion::None,
            DensityDiffusionFile::MolteniColagrossi(delta) => {
                DensityDiffusion::MolteniColagrossi(delta)
            }
            DensityDiffusionFile::Fourtakas(delta) => DensityDiffusion::Fourtakas(delta),
            DensityDiffusionFile::Antuono(delta) => DensityDiffusion::Antuono(delta),
        },
        viscosity: match *numerics.viscosity.get_or_insert(preset.viscosity) {
            ViscosityFile::None => Viscosity::None,
            ViscosityFile::Published => Viscosity::Published { dynamic_viscosity },
            ViscosityFile::Artificial(alpha) => Viscosity::Artificial { alpha },
            ViscosityFile::Laminar => Viscosity::Laminar {
                kinematic_viscosity,
            },
            ViscosityFile::Morris => Viscosity::Morris {
                kinematic_viscosity,
            },
        },
        shifting: match *numerics.shifting.get_or_insert(preset.shifting) {
            ShiftingFile::None => Shifting::None,
            ShiftingFile::Fickian(coefficient) => Shifting::Fickian { coefficient },
        },
        stepping: Stepping::KickDriftKick,
        precision: match *numerics.precision.get_or_insert(preset.precision) {
            PrecisionFile::Single => Precision::Single,
            PrecisionFile::Double => Precision::Double,
        },
    }
}
