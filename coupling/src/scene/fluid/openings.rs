//! Inflows, outflows and absorbing layers.

use std::f64::consts::TAU;

use riprap_sph::Absorber;
use riprap_sph::scheme::DensityMethod;
use riprap_sph::{Dimensions, Settings};

use crate::messages::Code;
use crate::openings::{Drive, Inflow, Openings, Outflow, Passage};
use crate::scene::error::Problem;
use crate::scene::file::{
    AbsorberFile, BlockFile, DomainFile, InflowFile, MotionFile, OutflowFile, SceneFile, SideFile,
    Triple, vec3,
};
use crate::scene::fill::Lattice;
use crate::scene::wave_maker::WaveMaker;
use crate::series::Series;
use crate::waves::StillWater;

/// Damping rate at the end of an absorbing layer times the time in which long waves cross it. On their way in and
/// back they lose all but `e^{−10/3}`, 4 %. Measured for waves as long as the layer, kd = 1.26: 5.6 % come back at 3,
/// 0.7 % at 7, and 1.9 % at 20, where the ramp itself reflects.
const ABSORBER_STRENGTH: f64 = 10.0;
/// Share of a length that rounding of typed digits may lack.
const ROUNDING: f64 = 1e-6;
/// Length of an absorber over the wave from which on it sends back little more than one as long as the wave.
const LONG_ENOUGH: f64 = 0.95;

/// Absorbing layers, each with its damping rate.
pub(super) fn absorbers(file: &SceneFile, depth: f64) -> Vec<Absorber> {
    let wave_speed = (vec3(file.gravity).norm() * depth).sqrt();
    file.absorbers
        .iter()
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
                rate: layer.rate.unwrap_or(rate),
            }
        })
        .collect()
}

/// Warnings about layers that are shorter than a wave of the scene's wave makers and sinusoidal paddles, much of which they send back.
pub(in crate::scene) fn short_absorbers(
    file: &SceneFile,
    makers: &[WaveMaker],
    depth: f64,
) -> Vec<Problem> {
    let water = StillWater {
        depth,
        gravity: vec3(file.gravity).norm(),
    };
    let of_paddle = |block: &BlockFile| match block.motion {
        MotionFile::Sinusoid { period, .. } if 0.0 < water.gravity * depth => {
            Some(TAU / water.wave_number(TAU / period))
        }
        _ => None,
    };
    let lengths = makers.iter().map(WaveMaker::wave_length);
    let longest = lengths
        .chain(file.blocks.iter().filter_map(of_paddle))
        .fold(0.0, f64::max);
    let short = |(index, layer): (usize, &AbsorberFile)| {
        let (axis, _) = layer.towards.axis();
        let length = vec3(layer.max)[axis] - vec3(layer.min)[axis];
        (axis < 2 && length < longest * LONG_ENOUGH).then(|| {
            Problem::warning(
                Code::AbsorberTooShort,
                format!("absorbers[{index}]"),
                format!(
                    "absorber `{}` is {length:.3} m long, {:.2} of a wave of {longest:.3} m: it sends back much of it, where a \
                     layer as long as the wave sends back 1 to 6 %; let it be {longest:.3} m long",
                    layer.name,
                    length / longest,
                ),
            )
        })
    };
    file.absorbers
        .iter()
        .enumerate()
        .filter_map(short)
        .collect()
}

/// Inflows and outflows of the file, and refusals of those that are too short or too close to other water.
pub(super) fn openings(
    file: &SceneFile,
    lattice: &Lattice,
    settings: &Settings,
    problems: &mut Vec<Problem>,
) -> Openings {
    let support = settings.support_radius();
    let domain = &file.domain;
    let inflows = (file.inflows.iter().enumerate())
        .map(|(index, inflow)| {
            let passage = passage(inflow.min, inflow.max, inflow.towards, settings);
            problems.extend(inflow_refusals((index, inflow), &passage, lattice, support));
            made_inflow(inflow, passage)
        })
        .collect();
    let outflows = (file.outflows.iter().enumerate())
        .map(|(index, outflow)| {
            let passage = passage(outflow.min, outflow.max, outflow.towards, settings);
            let spacing = lattice.spacing[passage.axis];
            let found = outflow_refusals((index, outflow), &passage, domain, (support, spacing));
            problems.extend(found);
            Outflow {
                name: outflow.name.clone(),
                passage,
                depth: (!outflow.depth.is_empty()).then(|| Series::new(outflow.depth.clone())),
            }
        })
        .collect();
    let has_openings = !(file.inflows.is_empty() && file.outflows.is_empty());
    if settings.scheme.density == DensityMethod::Summation && has_openings {
        problems.push(Problem::error(
            Code::IncompatibleOptions,
            "numerics.density",
            "an inflow or outflow imposes densities, which Summation does not know; choose Continuity or the \
             Standard preset",
        ));
    }
    Openings::new(inflows, outflows)
}

/// Box of an opening; in two dimensions as wide as the domain.
fn passage(min: Triple, max: Triple, towards: SideFile, settings: &Settings) -> Passage {
    let (axis, upward) = towards.axis();
    let (mut min, mut max) = (vec3(min), vec3(max));
    if let Dimensions::Two { .. } = settings.dimensions {
        (min.y, max.y) = (settings.domain.0.y, settings.domain.1.y);
    }
    Passage {
        min,
        max,
        axis,
        upward,
    }
}

fn made_inflow(inflow: &InflowFile, passage: Passage) -> Inflow {
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
    Inflow::new(inflow.name.clone(), passage, drive, Series::new(depth))
}

fn inflow_refusals(
    (index, InflowFile { name, .. }): (usize, &InflowFile),
    passage: &Passage,
    lattice: &Lattice,
    support: f64,
) -> Vec<Problem> {
    let path = format!("inflows[{index}]");
    let mut found = Vec::new();
    let least = support + lattice.spacing[passage.axis];
    if passage.length() < (1.0 - ROUNDING) * least {
        found.push(Problem::error(
            Code::UnusableOpening,
            &path,
            format!(
                "inflow `{name}` is {} m long; water must see {least:.4} m of it: move `min` or `max`, or \
                 refine `fluid.resolution`",
                passage.length()
            ),
        ));
    }
    if lattice.positions.iter().any(|x| passage.contains(x, 0.0)) {
        found.push(Problem::error(
            Code::UnusableOpening,
            &path,
            format!(
                "inflow `{name}` fills its own box, and a fluid region reaches into it; end the region at \
                 its face"
            ),
        ));
    }
    found
}

fn outflow_refusals(
    (index, OutflowFile { name, .. }): (usize, &OutflowFile),
    passage: &Passage,
    domain: &DomainFile,
    (support, spacing): (f64, f64),
) -> Vec<Problem> {
    let path = format!("outflows[{index}]");
    let mut found = Vec::new();
    if passage.length() < (1.0 - ROUNDING) * support {
        found.push(Problem::error(
            Code::UnusableOpening,
            &path,
            format!(
                "outflow `{name}` is {} m long; water must see {support:.4} m of it: move `min` or `max`, or \
                 refine `fluid.resolution`",
                passage.length()
            ),
        ));
    }
    let (min, max) = (vec3(domain.min), vec3(domain.max));
    let axis = passage.axis;
    let room = if passage.upward {
        max[axis] - passage.max[axis]
    } else {
        passage.min[axis] - min[axis]
    };
    // a particle beyond the face must still be inside when it is removed, or it counts as lost
    if room < 0.5 * spacing {
        found.push(Problem::error(
            Code::UnusableOpening,
            &path,
            format!(
                "outflow `{name}` ends {room} m before the end of the domain; leave a spacing between, or enlarge \
                 `domain`"
            ),
        ));
    }
    found
}
