//! From the fluid of the file to what the solver needs: presets, sound speed, walls, the state at rest.

use riprap_sph::boundary::wall_particles::Slip;
use riprap_sph::scheme::{
    ALPHA, DIFFUSION, DensityDiffusion, DensityMethod, Shifting, Stepping, Viscosity,
};
use riprap_sph::state_equation::State;
use riprap_sph::{
    Absorber, Dimensions, FluidError, KernelChoice, NegativePressure as Clamping, Precision,
    Regularization, Rheology, Scheme, Settings, StateEquation, Vec3,
};

use riprap_dda::{Polyhedron, Shape};

use super::error::Problem;
use super::file::vec3;
use super::file::{
    Axis, DensityDiffusionFile, DensityFile, DimensionsFile, FluidFile, KernelFile, LatticeFile,
    NegativePressure, NumericsFile, PrecisionFile, Preset, RegionShapeFile, RegularizationFile,
    RheologyFile, SceneFile, ShiftingFile, SideFile, SlipFile, StateEquationFile, SteppingFile,
    ViscosityFile, WallMethodFile, WaterField,
};
use super::fill::{Lattice, proportions};
use super::resolved::FluidScene;
use crate::openings::{Drive, Inflow, Openings, Outflow, Passage};
use crate::series::Series;
use crate::walls::WallMethod;
use crate::walls::integral::CLOSEST;
use crate::walls::penalty::{DAMPING_RATIO, STANDOFF, WallSettings};

/// Sound speed over the fastest expected flow, below which a warning is due: density varies by about 1 % there.
const SOUND_SPEED_RATIO: f64 = 10.0;
/// Damping rate at the end of an absorbing layer times the time in which long waves cross it. On their way in and
/// back they lose all but `e^{−10/3}`, 4 %. Measured for waves as long as the layer, kd = 1.26: 5.6 % come back at 3,
/// 0.7 % at 7, and 1.9 % at 20, where the ramp itself reflects.
const ABSORBER_STRENGTH: f64 = 10.0;
/// Depth, in spacings, to which still water presses its lowest row into a penalty wall.
const STATIC_PENETRATION: f64 = 0.1;
/// Depth, in spacings, to which a particle at the expected speed enters a penalty wall.
const IMPACT_PENETRATION: f64 = 0.25;

/// A viscous limit this many times shorter than that of sound is worth a warning.
const SLOW_VISCOSITY: f64 = 10.0;
/// Flow laws that a particle's number can tell apart.
const MOST_LAWS: usize = 256;

/// Numbers of a preset, each where the file has none.
struct PresetNumbers {
    smoothing_length_ratio: f64,
    time_step_factor: f64,
    sound_speed_ratio: f64,
    kernel: KernelFile,
    density: DensityFile,
    diffusion: DensityDiffusionFile,
    viscosity: ViscosityFile,
    shifting: ShiftingFile,
    stepping: SteppingFile,
    negative_pressure: NegativePressure,
    precision: PrecisionFile,
    walls: WallMethodFile,
}

impl Preset {
    fn numbers(self, dimensions: DimensionsFile) -> PresetNumbers {
        let standard = PresetNumbers {
            // in space a support of 2.6 spacings, 80 neighbors; in a plane one of 4, 50 neighbors: with the
            // 21 of 2.6 still water stirs itself
            smoothing_length_ratio: match dimensions {
                DimensionsFile::Three => 1.3,
                DimensionsFile::Two => 2.0,
            },
            // customary; a lattice allows 1.54
            time_step_factor: 0.5,
            sound_speed_ratio: SOUND_SPEED_RATIO,
            kernel: KernelFile::WendlandC2,
            density: DensityFile::Continuity,
            diffusion: DensityDiffusionFile::Fourtakas(DIFFUSION),
            viscosity: ViscosityFile::Artificial(ALPHA),
            shifting: ShiftingFile::None,
            stepping: SteppingFile::KickDriftKick,
            negative_pressure: NegativePressure::Kept,
            precision: PrecisionFile::Single,
            walls: WallMethodFile::Particles,
        };
        match self {
            Self::Standard => standard,
            // a third of the work, for the errors in benches/trade/README.md
            Self::Preview => PresetNumbers {
                time_step_factor: 1.0,
                sound_speed_ratio: 7.0,
                ..standard
            },
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
                stepping: SteppingFile::SymplecticEuler,
                precision: PrecisionFile::Double,
                walls: WallMethodFile::Penalty,
                ..standard
            },
            Self::Reference => PresetNumbers {
                // support of four spacings: waves that travel far (Colagrossi et al. 2013)
                smoothing_length_ratio: 2.0,
                sound_speed_ratio: 14.0,
                // the artificial one takes a fifth of a standing wave in six periods, water's own next to nothing
                viscosity: ViscosityFile::Laminar,
                ..standard
            },
        }
    }
}

/// Rows above the level that keep the surface of water in place while it is packed against its walls: those
/// within the support, of a staggered lattice those that are nearer to each other. None where penalty springs hold the water, which need its lattice half a spacing off.
pub(super) fn mould_rows(file: &SceneFile) -> usize {
    let preset = file.numerics.preset.numbers(file.domain.dimensions);
    let ratio = file.numerics.smoothing_length_ratio;
    match file.interface.walls.unwrap_or(preset.walls) {
        WallMethodFile::Penalty => 0,
        WallMethodFile::Particles | WallMethodFile::Integral => {
            let support = 2.0 * ratio.unwrap_or(preset.smoothing_length_ratio);
            let fluid = file.fluid.as_ref();
            let [.., height] =
                fluid.map_or([1.0; 3], |f| proportions(f.lattice, file.domain.dimensions));
            (support / height).ceil() as usize
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
        preset.sound_speed_ratio,
        expected_speed.max((gravity.norm() * lattice.depth).sqrt()),
        problems,
    );
    let laws = laws(file, &lattice, problems);
    let scheme = scheme(&mut file.numerics, &preset, (density, viscosity), &laws);
    problems.extend(growing_sound(&scheme));
    file.output.water_fields.get_or_insert_with(|| {
        let mut fields = vec![
            WaterField::Velocity,
            WaterField::Density,
            WaterField::Pressure,
            WaterField::Id,
        ];
        if !laws.rheologies.is_empty() {
            fields.extend([WaterField::Viscosity, WaterField::Yielded]);
        }
        fields
    });
    let spacing = lattice.particle_spacing(dimensions);
    let mass = density * lattice.particle_volume();
    let method = *file.interface.walls.get_or_insert(preset.walls);
    let walls = match method {
        WallMethodFile::Particles => {
            refuse_particles(&scheme, problems);
            WallSettings {
                stiffness: 0.0,
                damping: 0.0,
                particle_spacing: spacing,
                standoff: STANDOFF * spacing,
            }
        }
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
    let settings = Settings {
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
        symmetry: super::symmetry::symmetry(&file.domain),
    };
    let sleeping = super::sleep::sleeping(file, &settings, lattice.depth, problems);
    let work = (file.time.duration, lattice.positions.len());
    problems.extend(slow_viscosity(&settings, &laws, work));
    super::symmetry::question_rows(
        (
            &file.domain,
            file.fluid
                .as_ref()
                .map_or(LatticeFile::Cubic, |f| f.lattice),
        ),
        &lattice,
        problems,
    );
    FluidScene {
        settings,
        walls,
        wall_method: method.into(),
        slip: match file.interface.slip {
            SlipFile::Free => Slip::Free,
            SlipFile::None => Slip::None,
            SlipFile::Friction(angle_deg) => Slip::Friction(angle_deg.to_radians().tan()),
        },
        expected_speed,
        pressures,
        rheologies: laws.rheologies,
        kinds: laws.kinds,
        absorbers: absorbers(file, lattice.depth),
        openings: openings(file, &lattice, (ratio, dimensions), problems),
        sleeping,
        lattice,
    }
}

/// A flow law of the file as the solver has it.
pub(super) fn flow_law(file: &RheologyFile) -> Rheology {
    let regularized = |file: RegularizationFile| match file {
        RegularizationFile::Papanastasiou(time) => Regularization::Papanastasiou(time),
        RegularizationFile::Bilinear(largest) => Regularization::Bilinear(largest),
    };
    match *file {
        RheologyFile::Newtonian { dynamic_viscosity } => Rheology::Newtonian { dynamic_viscosity },
        RheologyFile::Bingham {
            dynamic_viscosity,
            yield_stress,
            regularization,
        } => Rheology::Bingham {
            dynamic_viscosity,
            yield_stress,
            regularization: regularized(regularization),
        },
        RheologyFile::HerschelBulkley {
            consistency,
            exponent,
            yield_stress,
            regularization,
        } => Rheology::HerschelBulkley {
            consistency,
            exponent,
            yield_stress,
            regularization: regularized(regularization),
        },
    }
}

/// Flow laws of the regions, each once; none where the file has none.
#[derive(Default)]
struct Laws {
    rheologies: Vec<Rheology>,
    /// One per particle.
    kinds: Vec<u8>,
}

fn laws(file: &SceneFile, lattice: &Lattice, problems: &mut Vec<Problem>) -> Laws {
    let Some(fluid) = &file.fluid else {
        return Laws::default();
    };
    let has_laws = fluid.rheology.is_some() || fluid.regions.iter().any(|r| r.rheology.is_some());
    let asked = file.numerics.viscosity;
    if !has_laws && asked != Some(ViscosityFile::Rheological) {
        return Laws::default();
    }
    if asked.is_some_and(|viscosity| viscosity != ViscosityFile::Rheological) {
        problems.push(Problem::warning(
            "numerics.viscosity",
            "the flow laws of the fluid take no part with this viscosity; leave it out, or set it to Rheological",
        ));
        return Laws::default();
    }
    let of_fluid = RheologyFile::Newtonian {
        dynamic_viscosity: fluid.dynamic_viscosity,
    };
    let of_fluid = flow_law(fluid.rheology.as_ref().unwrap_or(&of_fluid));
    let mut rheologies = Vec::new();
    let mut of_region = Vec::with_capacity(fluid.regions.len());
    for region in &fluid.regions {
        let law = region.rheology.as_ref().map_or(of_fluid, flow_law);
        let known = rheologies.iter().position(|known| *known == law);
        of_region.push(known.unwrap_or(rheologies.len()));
        if known.is_none() {
            rheologies.push(law);
        }
    }
    if MOST_LAWS < rheologies.len() {
        problems.push(Problem::error(
            "fluid.regions",
            format!("{} flow laws are more than {MOST_LAWS}", rheologies.len()),
        ));
    }
    let kind = |&region: &u32| of_region.get(region as usize).map_or(0, |&k| k as u8);
    Laws {
        kinds: lattice.region.iter().map(kind).collect(),
        rheologies,
    }
}

/// Refuses a stepping that makes sound grow, and says so where one may.
fn growing_sound(scheme: &Scheme) -> Option<Problem> {
    let path = "numerics.stepping";
    match (scheme.stepping, scheme.density, scheme.diffusion) {
        (Stepping::SymplecticEuler, DensityMethod::Continuity, _) => {
            Some(Problem::error(path, FluidError::GrowingSound.to_string()))
        }
        (Stepping::PredictorCorrector, DensityMethod::Continuity, DensityDiffusion::None) => {
            Some(Problem::warning(
                path,
                "without density diffusion the predictor-corrector lets sound of frequency ω grow by (ω dt)⁴/8 a step, \
             which viscosity has to take; set `numerics.density_diffusion`, or use `KickDriftKick`",
            ))
        }
        _ => None,
    }
}

/// Says so where viscosity makes steps much shorter than sound does.
fn slow_viscosity(
    settings: &Settings,
    laws: &Laws,
    (duration, n): (f64, usize),
) -> Option<Problem> {
    let h = settings.smoothing_length;
    let constant = settings.kinematic_viscosity() * settings.reference_density;
    let at_rest = laws.rheologies.iter().map(Rheology::viscosity_at_rest);
    let viscosity = at_rest.fold(constant, f64::max);
    let factor = settings.time_step_factor;
    // the limits of continuity; those of summation are nearly the same
    let sound = factor * h / settings.sound_speed;
    let viscous = factor * 0.25 * h * h * settings.reference_density / viscosity;
    let ratio = sound / viscous;
    (SLOW_VISCOSITY < ratio).then(|| {
        let steps = duration / viscous;
        let path = if laws.rheologies.is_empty() {
            "fluid.dynamic_viscosity"
        } else {
            "fluid.rheology"
        };
        Problem::warning(
            path,
            format!(
                "a viscosity of {viscosity:.3e} Pa s limits the step to {viscous:.2e} s, {ratio:.0} times shorter than \
                 sound does: {steps:.1e} steps and {:.1e} particle steps; up to {:.3e} Pa s it would cost nothing. \
                 Choose the regularization from the creep that can be borne, or coarsen `fluid.resolution`",
                steps * n as f64,
                viscosity / ratio,
            ),
        )
    })
}

/// Layers that damp waves, each with its rate.
fn absorbers(file: &mut SceneFile, depth: f64) -> Vec<Absorber> {
    let wave_speed = (vec3(file.gravity).norm() * depth).sqrt();
    file.absorbers
        .iter_mut()
        .map(|layer| {
            let (axis, upward) = layer.towards.axis();
            let (min, max) = (vec3(layer.min), vec3(layer.max));
            let crossing = (max[axis] - min[axis]) / wave_speed;
            // without gravity no wave has a speed of its own, and any number will do
            let rate = if crossing.is_finite() {
                ABSORBER_STRENGTH / crossing
            } else {
                1.0
            };
            Absorber {
                min,
                max,
                axis,
                upward,
                rate: *layer.rate.get_or_insert(rate),
            }
        })
        .collect()
}

fn openings(
    file: &SceneFile,
    lattice: &Lattice,
    (ratio, dimensions): (f64, Dimensions),
    problems: &mut Vec<Problem>,
) -> Openings {
    let support = 2.0 * ratio * lattice.particle_spacing(dimensions);
    let passage = |min, max, towards: SideFile| {
        let (axis, upward) = towards.axis();
        let (mut min, mut max) = (vec3(min), vec3(max));
        if let Dimensions::Two { .. } = dimensions {
            (min.y, max.y) = (file.domain.min.1, file.domain.max.1);
        }
        Passage {
            min,
            max,
            axis,
            upward,
        }
    };
    let mut inflows = Vec::new();
    for (index, inflow) in file.inflows.iter().enumerate() {
        let (path, name) = (format!("inflows[{index}]"), &inflow.name);
        let passage = passage(inflow.min, inflow.max, inflow.towards);
        let least = support + lattice.spacing[passage.axis];
        // by the digits that a user types
        if passage.length() < (1.0 - 1e-6) * least {
            problems.push(Problem::error(
                &path,
                format!(
                    "inflow `{name}` is {} m long; water must see {least:.4} m of it: move `min` or `max`, or \
                     refine `fluid.resolution`",
                    passage.length()
                ),
            ));
        }
        if lattice.positions.iter().any(|x| passage.contains(x, 0.0)) {
            problems.push(Problem::error(
                &path,
                format!(
                    "inflow `{name}` fills its own box, and a fluid region reaches into it; end the region at \
                     its face"
                ),
            ));
        }
        let depth = if inflow.depth.is_empty() {
            vec![(0.0, inflow.max.2 - inflow.min.2)]
        } else {
            inflow.depth.clone()
        };
        let drive = if inflow.velocity.is_empty() {
            Drive::Discharge(Series::new(inflow.discharge.clone()))
        } else {
            Drive::Velocity(Series::new(inflow.velocity.clone()))
        };
        inflows.push(Inflow::new(
            name.clone(),
            passage,
            drive,
            Series::new(depth),
        ));
    }
    let mut outflows = Vec::new();
    for (index, outflow) in file.outflows.iter().enumerate() {
        let passage = passage(outflow.min, outflow.max, outflow.towards);
        if passage.length() < (1.0 - 1e-6) * support {
            problems.push(Problem::error(
                format!("outflows[{index}]"),
                format!(
                    "outflow `{}` is {} m long; water must see {support:.4} m of it: move `min` or `max`, or \
                     refine `fluid.resolution`",
                    outflow.name,
                    passage.length()
                ),
            ));
        }
        let (min, max) = (vec3(file.domain.min), vec3(file.domain.max));
        let axis = passage.axis;
        let room = if passage.upward {
            max[axis] - passage.max[axis]
        } else {
            passage.min[axis] - min[axis]
        };
        // what passes the face must still be inside when it is looked for, or it counts as escaped
        if room < 0.5 * lattice.spacing[axis] {
            problems.push(Problem::error(
                format!("outflows[{index}]"),
                format!(
                    "outflow `{}` ends {room} m before the end of the domain; leave a spacing between, or enlarge \
                     `domain`",
                    outflow.name
                ),
            ));
        }
        outflows.push(Outflow {
            name: outflow.name.clone(),
            passage,
            depth: (!outflow.depth.is_empty()).then(|| Series::new(outflow.depth.clone())),
        });
    }
    if file.numerics.density == Some(DensityFile::Summation)
        && !(inflows.is_empty() && outflows.is_empty())
    {
        problems.push(Problem::error(
            "numerics.density",
            "an inflow or outflow imposes densities, which Summation does not know; choose Continuity or the \
             Standard preset",
        ));
    }
    Openings::new(inflows, outflows)
}

/// Walls of particles add to rates of density; a sum for the density itself does not see them.
fn refuse_particles(scheme: &Scheme, problems: &mut Vec<Problem>) {
    if scheme.density != DensityMethod::Continuity {
        problems.push(Problem::error(
            "interface.walls",
            "Particles wants `numerics.density` Continuity; use Penalty",
        ));
    }
}

/// Rejects options that walls of integrals do not support.
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
    if !file.domain.symmetry.is_empty() {
        refuse("does not see blocks mirrored in a plane of symmetry");
    }
}

/// Refuses shapes that walls other than penalty springs cannot be made of: water would run through them.
pub(super) fn refuse_shapes(
    file: &SceneFile,
    solids: &[(String, Shape)],
    method: WallMethod,
    problems: &mut Vec<Problem>,
) {
    if method == WallMethod::Penalty {
        return;
    }
    if method == WallMethod::Integral {
        refuse_ends(file, solids, problems);
    }
    let is_any_shape =
        method == WallMethod::Particles && file.domain.dimensions != DimensionsFile::Two;
    let hollow = |shape: &Shape| match shape {
        Shape::Sphere { .. } | Shape::Surface(_) => !is_any_shape,
        Shape::Polyhedra(_) => false,
    };
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
            "block `{name}`{others}: {what} has no walls of {method:?} here, and water would run through it; set \
             interface.walls to Penalty, or use a polyhedron"
        ),
    ));
}

/// Refuses solids that end within a domain that repeats itself: integrals do not see their images.
fn refuse_ends(file: &SceneFile, solids: &[(String, Shape)], problems: &mut Vec<Problem>) {
    let (min, max) = (vec3(file.domain.min), vec3(file.domain.max));
    for axis in &file.domain.periodic {
        let k = axis.index();
        let slack = 1e-6 * (max[k] - min[k]);
        for (index, (name, shape)) in solids.iter().enumerate() {
            let Shape::Polyhedra(parts) = shape else {
                continue;
            };
            let ends = |part: &Polyhedron| {
                let places = || part.vertices().iter().map(|x| x[k]);
                places().all(|x| min[k] + slack < x) || places().all(|x| x < max[k] - slack)
            };
            if parts.iter().any(ends) {
                problems.push(Problem::error(
                    format!("blocks[{index}].shape"),
                    format!(
                        "interface.walls: Integral sees in a domain that repeats itself along {axis:?} only what \
                         goes through all of it; `{name}` ends between {} and {} m: make it longer, or use Particles",
                        min[k], max[k]
                    ),
                ));
            }
        }
    }
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
fn sound_speed(
    numerics: &mut NumericsFile,
    ratio: f64,
    fastest: f64,
    problems: &mut Vec<Problem>,
) -> f64 {
    // water without gravity or motion has no speed of its own: any positive number will do
    let fallback = if fastest > 0.0 { ratio * fastest } else { 1.0 };
    let given = numerics.sound_speed;
    let sound_speed = *numerics.sound_speed.get_or_insert(fallback);
    // who asks for a preview knows
    if given.is_some() && sound_speed < 0.999 * SOUND_SPEED_RATIO * fastest {
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
    laws: &Laws,
) -> Scheme {
    let method = *numerics.density.get_or_insert(preset.density);
    // summation has no rate that diffusion could act on
    let diffusion = match method {
        DensityFile::Continuity => preset.diffusion,
        DensityFile::Summation => DensityDiffusionFile::None,
    };
    // nor may symplectic Euler go with a rate
    let stepping = match (method, preset.stepping) {
        (DensityFile::Continuity, SteppingFile::SymplecticEuler) => SteppingFile::KickDriftKick,
        (_, stepping) => stepping,
    };
    let kinematic_viscosity = dynamic_viscosity / density;
    let first = laws.rheologies.first().copied();
    let viscosity = first.map_or(preset.viscosity, |_| ViscosityFile::Rheological);
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
        viscosity: match *numerics.viscosity.get_or_insert(viscosity) {
            ViscosityFile::None => Viscosity::None,
            ViscosityFile::Published => Viscosity::Published { dynamic_viscosity },
            ViscosityFile::Artificial(alpha) => Viscosity::Artificial { alpha },
            ViscosityFile::Laminar => Viscosity::Laminar {
                kinematic_viscosity,
            },
            ViscosityFile::Morris => Viscosity::Morris {
                kinematic_viscosity,
            },
            ViscosityFile::Rheological => Viscosity::Rheological {
                rheology: first.unwrap_or(Rheology::Newtonian { dynamic_viscosity }),
            },
            ViscosityFile::SubParticleScale(smagorinsky) => Viscosity::SubParticleScale {
                kinematic_viscosity,
                smagorinsky,
            },
        },
        shifting: match *numerics.shifting.get_or_insert(preset.shifting) {
            ShiftingFile::None => Shifting::None,
            ShiftingFile::Fickian(coefficient) => Shifting::Fickian { coefficient },
        },
        stepping: match *numerics.stepping.get_or_insert(stepping) {
            SteppingFile::KickDriftKick => Stepping::KickDriftKick,
            SteppingFile::PredictorCorrector => Stepping::PredictorCorrector,
            SteppingFile::SymplecticEuler => Stepping::SymplecticEuler,
        },
        precision: match *numerics.precision.get_or_insert(preset.precision) {
            PrecisionFile::Single => Precision::Single,
            PrecisionFile::Double => Precision::Double,
        },
    }
}
