//! Fluid of a scene: scheme, sound speed, walls, flow laws, openings, initial pressures.

mod averaged;
mod laws;
mod openings;
mod scheme;
mod viscous_step;
mod walls;

use riprap_sph::preset::SOUND_SPEED_RATIO;
use riprap_sph::state_equation::State;
use riprap_sph::{Rheology, Settings};

use super::error::Problem;
use super::file::{LatticeFile, NumericsFile, RegionFile, RegionShapeFile, SceneFile, vec3};
use super::fill::{Lattice, proportions};
use super::resolved::{Domain, FluidScene, GrainList, Region};
use crate::messages::Code;
use crate::walls::WallMethod;
pub(super) use averaged::is_averaged;
pub(super) use laws::flow_law;
use laws::laws;
pub(super) use openings::short_absorbers;
pub(super) use scheme::{chosen_viscosity, dimensions};
pub(super) use viscous_step::heed_blocks;
use walls::{WallLoads, refuse_scheme, wall_settings};
pub(super) use walls::{refuse_shapes, wall_method};

/// Rows above the level that keep the surface of water in place while it is packed against its walls: those within
/// the support, of a staggered lattice those that are closer to each other. None for penalty walls, which need the
/// lattice half a spacing off.
pub(super) fn mould_rows(file: &SceneFile) -> usize {
    match wall_method(file) {
        WallMethod::Penalty => 0,
        WallMethod::Particles | WallMethod::Integral => {
            let support = 2.0 * scheme::smoothing_length_ratio(file);
            let fluid = file.fluid.as_ref();
            let [.., height] =
                fluid.map_or([1.0; 3], |f| proportions(f.lattice, file.domain.dimensions));
            (support / height).ceil() as usize
        }
    }
}

/// Fluid of the scene on its initial lattice, with every choice made.
pub(super) fn resolve(
    file: &SceneFile,
    (lattice, domain, grains): (Lattice, &Domain, &[GrainList]),
    expected_speed: f64,
    problems: &mut Vec<Problem>,
) -> FluidScene {
    let gravity = vec3(file.gravity);
    let fastest = expected_speed.max((gravity.norm() * lattice.depth).sqrt());
    let sound_speed = sound_speed(file, fastest, problems);
    let laws = laws(file, &lattice, problems);
    let mut settings = settings(
        file,
        &lattice,
        domain,
        (sound_speed, laws.rheologies.first()),
    );
    scheme::stabilize(file, &mut settings);
    problems.extend(scheme::growing_sound(&settings.scheme));
    problems.extend(scheme::bulk_without_rates(&settings.scheme));
    let wall_method = wall_method(file);
    refuse_scheme(file, wall_method, &settings.scheme, problems);
    let loads = WallLoads {
        mass: settings.reference_density * lattice.particle_volume(),
        spacing: lattice.particle_spacing(domain.dimensions),
        depth: lattice.depth,
        fastest,
    };
    let sleeping = super::sleep::sleeping(file, &settings, (wall_method, lattice.depth), problems);
    let averaged = averaged::averaged(file, grains, (&settings, wall_method), problems);
    let work = (file.time.duration, lattice.positions.len());
    let slip = walls::slip(file, wall_method, &settings, problems);
    let viscous_steps =
        viscous_step::choose(file, &mut settings, &laws, (wall_method, slip), problems);
    let has_laws = !laws.rheologies.is_empty();
    problems.extend(viscous_step::slow_viscosity(
        &settings,
        &viscous_steps,
        has_laws,
        work,
    ));
    let fluid = file.fluid.as_ref();
    let arrangement = fluid.map_or(LatticeFile::Cubic, |f| f.lattice);
    super::symmetry::warn_about_rows((&file.domain, arrangement), &lattice, problems);
    let regions: Vec<Region> = fluid.iter().flat_map(|f| &f.regions).map(region).collect();
    FluidScene {
        preset: file.numerics.preset.into(),
        smoothing_length_ratio: scheme::smoothing_length_ratio(file),
        walls: wall_settings(wall_method, &file.interface, &settings, &loads),
        wall_method,
        slip,
        viscous_steps,
        molecular_viscosity: walls::molecular_viscosity(file),
        pressures: hydrostatic(&lattice, &regions, &settings),
        rheologies: laws.rheologies,
        kinds: laws.kinds,
        absorbers: openings::absorbers(file, lattice.depth),
        openings: openings::openings(file, &lattice, &settings, problems),
        sleeping,
        averaged,
        settings,
        lattice,
        regions,
    }
}

fn settings(
    file: &SceneFile,
    lattice: &Lattice,
    domain: &Domain,
    (sound_speed, law): (f64, Option<&Rheology>),
) -> Settings {
    let spacing = lattice.particle_spacing(domain.dimensions);
    let given = file.numerics.time_step_factor;
    Settings {
        particle_spacing: lattice.spacing,
        smoothing_length: scheme::smoothing_length_ratio(file) * spacing,
        reference_density: scheme::water(file).0,
        sound_speed,
        scheme: scheme::scheme(file, law.copied()),
        dimensions: domain.dimensions,
        gravity: vec3(file.gravity),
        time_step_factor: given.unwrap_or_else(|| scheme::preset(file).time_step_factor),
        domain: (domain.min, domain.max),
        periodic: domain.periodic_axes(),
        symmetry: domain.symmetry_planes(),
    }
}

fn region(file: &RegionFile) -> Region {
    let (level, seed) = match file.shape {
        RegionShapeFile::Box { max, .. } => (max.2, None),
        RegionShapeFile::Below { level, seed } => (level, Some(vec3(seed))),
    };
    Region {
        name: file.name.clone(),
        level,
        seed,
    }
}

/// Pressures of water at rest below the level of each region, compressed by its own weight; Pa.
fn hydrostatic(lattice: &Lattice, regions: &[Region], settings: &Settings) -> Vec<f64> {
    let state = State {
        equation: settings.scheme.state_equation,
        reference_density: settings.reference_density,
        sound_speed: settings.sound_speed,
        negative: settings.scheme.negative_pressure,
    };
    let pull = (-settings.gravity.z).max(0.0);
    let water = lattice.positions.iter().zip(&lattice.region);
    water
        .map(|(x, &region)| {
            let depth = (regions.get(region as usize)).map_or(0.0, |region| region.level - x.z);
            state.hydrostatic_pressure(pull, depth.max(0.0))
        })
        .collect()
}

/// Sound speed of the file, or that of its preset for the fastest flow expected (m/s); m/s.
fn sound_speed(file: &SceneFile, fastest: f64, problems: &mut Vec<Problem>) -> f64 {
    let NumericsFile { sound_speed, .. } = file.numerics;
    let Some(given) = sound_speed else {
        // water without gravity or motion has no speed of its own: any positive number will do
        return if fastest > 0.0 {
            scheme::preset(file).sound_speed_ratio * fastest
        } else {
            1.0
        };
    };
    // a preset that is lower than this is meant to be
    let ratio = scheme::preset(file)
        .sound_speed_ratio
        .min(SOUND_SPEED_RATIO);
    if given < 0.999 * ratio * fastest {
        problems.push(Problem::warning(
            Code::LowSoundSpeed,
            "numerics.sound_speed",
            format!(
                "{given:.3} m/s is less than {ratio} times the fastest expected speed of \
                 {fastest:.3} m/s: density will vary by up to {:.1} %; raise it to {:.1} m/s",
                100.0 * (fastest / given).powi(2),
                ratio * fastest,
            ),
        ));
    }
    given
}
