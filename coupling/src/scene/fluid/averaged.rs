//! Grains in water: those that water flows around, and those whose forces are averages.

use riprap_sph::Settings;
use riprap_sph::scheme::{DensityMethod, Stepping};

use super::scheme::dynamic_viscosity;
use crate::grains::{self, drag::DragLaw};
use crate::messages::Code;
use crate::scene::error::Problem;
use crate::scene::file::{
    AddedMassFile, DimensionsFile, DragLawFile, FluidFile, GrainsFile, InWaterFile, ResolutionFile,
    RheologyFile, SceneFile,
};
use crate::scene::resolved::{Averaged, GrainList};
use crate::walls::WallMethod;

/// Diameter from which on water flows around a grain; × spacing.
const RESOLVED: f64 = 8.0;
/// By how much spacings differ from the drawn one where water is fitted to its volume; –.
const FITTED: f64 = 1e-3;
/// Diameter up to which a grain is small beside the particles of water; × spacing.
const SMALL: f64 = 2.0;
/// Radius of the averaging kernel; × diameter. Water that a grain drags along makes it fall too fast by the diameter over this
/// radius or so.
const KERNEL_RADIUS: f64 = 4.0;
/// The same of grains that span two spacings or more, whose kernels hold many particles; × diameter.
const KERNEL_RADIUS_OF_LARGE: f64 = 3.0;
/// Density of grains over that of water from which on the water that they accelerate is left out.
const HEAVY: f64 = 3.0;
/// Yield stress that holds a grain, over its submerged weight per area of its square; Beris, Tsamopoulos, Armstrong & Brown
/// (1985).
const HOLDING: f64 = 0.0477;

/// Does water flow around a grain of a diameter over the spacing?
fn is_wide(width: f64) -> bool {
    (1.0 - FITTED) * RESOLVED <= width
}

/// Whether the forces between the grains of a list and the water are averages; the problem if the file leaves that open.
pub(in crate::scene) fn is_averaged(
    (index, list): (usize, &GrainsFile),
    fluid: Option<&FluidFile>,
) -> Result<bool, Problem> {
    let Some(fluid) = fluid else {
        return Ok(false);
    };
    match (list.in_water, fluid.resolution) {
        (InWaterFile::Resolved, _) => Ok(false),
        (InWaterFile::Averaged, _) => Ok(true),
        (InWaterFile::Auto, ResolutionFile::Spacing(spacing)) => {
            Ok(!is_wide(list.smallest() / spacing))
        }
        (InWaterFile::Auto, ResolutionFile::Count(_)) => Err(Problem::error(
            Code::MissingField,
            format!("grains[{index}].in_water"),
            format!(
                "grains `{}`: whether water flows around them depends on its spacing, which follows from a count; give \
                 `fluid.resolution: Spacing(..)`, or `in_water: Averaged` or `Resolved`",
                list.name
            ),
        )),
    }
}

/// Exchange of the grains of some lists, with what is doubtful or impossible.
pub(in crate::scene) fn averaged(
    file: &SceneFile,
    lists: &[GrainList],
    (settings, method): (&Settings, WallMethod),
    problems: &mut Vec<Problem>,
) -> Option<Averaged> {
    let fluid = file.fluid.as_ref()?;
    let spacing = settings.mean_spacing();
    let of_list = |list: &GrainList, what: String| {
        let path = format!("grains[{}].in_water", list.index);
        Problem::warning(
            Code::GrainsInWater,
            path,
            format!("grains `{}`: {what}", list.name),
        )
    };
    for list in lists {
        let width = list.diameters[0] / spacing;
        if !list.is_averaged && !is_wide(width) {
            problems.push(of_list(list, format!(
                "{width:.1} spacings wide, less than the {RESOLVED} at which water flows around them; their drag is not resolved. \
                 Take `in_water: Averaged`, or a spacing of {:.4} m",
                list.diameters[0] / RESOLVED
            )));
        }
        if list.is_averaged && SMALL < width {
            problems.push(of_list(list, format!(
                "{width:.1} spacings wide: averages are for grains of up to {SMALL}, and water flows around those of {RESOLVED}. Forces \
                 between are averages, too; take a spacing of {:.4} m or more, or of {:.4} m",
                list.diameters[0] / SMALL,
                list.diameters[0] / RESOLVED
            )));
        }
    }
    let averaged: Vec<&GrainList> = lists.iter().filter(|list| list.is_averaged).collect();
    let largest = averaged
        .iter()
        .map(|list| list.diameters[1])
        .reduce(f64::max)?;
    let exchange = &fluid.grains;
    let kernel_radius = exchange
        .kernel_radius
        .unwrap_or(match SMALL * spacing <= largest {
            true => KERNEL_RADIUS_OF_LARGE,
            false => KERNEL_RADIUS,
        });
    let (viscosity, yield_stress) = match fluid.rheology {
        None => (dynamic_viscosity(fluid), 0.0),
        Some(RheologyFile::Newtonian { dynamic_viscosity }) => (dynamic_viscosity, 0.0),
        Some(RheologyFile::Bingham {
            dynamic_viscosity,
            yield_stress,
            ..
        }) => (dynamic_viscosity, yield_stress),
        Some(RheologyFile::HerschelBulkley {
            consistency,
            yield_stress,
            ..
        }) => {
            problems.push(Problem::error(
                Code::IncompatibleOptions,
                "fluid.rheology",
                "drag laws of grains are for Newtonian and Bingham fluids; take `Bingham` with the viscosity at the rate of shear around \
                 a grain, or grains of `in_water: Resolved`",
            ));
            (consistency, yield_stress)
        }
    };
    refuse(file, (settings, method), kernel_radius * largest, problems);
    let lightest = averaged
        .iter()
        .map(|list| list.density)
        .fold(f64::INFINITY, f64::min);
    for list in &averaged {
        let held = HOLDING
            * (list.density - fluid.density).abs()
            * settings.gravity.norm()
            * list.diameters[1];
        if 0.0 < held && held < yield_stress {
            problems.push(of_list(list, format!(
                "a yield stress of {yield_stress} Pa holds single grains: above {held:.3} Pa they neither sink nor rise in mud at rest"
            )));
        }
    }
    Some(Averaged {
        blocks: averaged
            .iter()
            .flat_map(|list| list.blocks.clone())
            .collect(),
        settings: grains::Settings {
            drag: match exchange.drag {
                DragLawFile::Beetstra => DragLaw::Beetstra,
                DragLawFile::DiFelice => DragLaw::DiFelice,
                DragLawFile::Gidaspow => DragLaw::Gidaspow,
                DragLawFile::Ergun => DragLaw::Ergun,
                DragLawFile::WenYu => DragLaw::WenYu,
            },
            kernel_radius,
            dynamic_viscosity: viscosity,
            yield_stress,
            has_added_mass: match exchange.added_mass {
                AddedMassFile::Auto => lightest < HEAVY * fluid.density,
                AddedMassFile::On => true,
                AddedMassFile::Off => false,
            },
        },
    })
}

/// Refuses what averages are not made for; `reach` is the largest radius of a kernel, m.
fn refuse(
    file: &SceneFile,
    (settings, method): (&Settings, WallMethod),
    reach: f64,
    problems: &mut Vec<Problem>,
) {
    let mut refuse = |is_wrong: bool, path: &str, what: String| {
        if is_wrong {
            problems.push(Problem::error(Code::GrainsInWater, path, what));
        }
    };
    let scheme = &settings.scheme;
    let averages = "averaged forces between grains and water";
    refuse(
        file.domain.dimensions == DimensionsFile::Two,
        "domain.dimensions",
        format!(
            "{averages} are for three dimensions, where spheres are spheres; leave `dimensions` out"
        ),
    );
    refuse(
        !file.domain.symmetry.is_empty(),
        "domain.symmetry",
        format!(
            "{averages} do not see images in planes of symmetry; take a slip wall in its place, or the whole domain"
        ),
    );
    refuse(
        method != WallMethod::Particles,
        "interface.walls",
        format!("{averages} need walls of particles; take `walls: Particles`"),
    );
    refuse(
        scheme.density != DensityMethod::Continuity,
        "numerics.density",
        format!("{averages} need a density that follows the flow; take `density: Continuity`"),
    );
    refuse(
        scheme.stepping != Stepping::KickDriftKick,
        "numerics.stepping",
        format!("{averages} are integrated by `KickDriftKick`"),
    );
    refuse(
        file.numerics.sleeping.is_some(),
        "numerics.sleeping",
        format!(
            "{averages} change in water at rest as grains move through it; leave `sleeping` out"
        ),
    );
    let extent = settings.domain.1 - settings.domain.0;
    for axis in (0..3).filter(|&axis| settings.periodic[axis]) {
        refuse(
            extent[axis] < 2.0 * reach,
            "domain.periodic",
            format!(
                "the period of {} m is less than the width of the averages, {:.4} m; make the domain wider, or `fluid.grains.kernel_radius` \
                 smaller",
                extent[axis],
                2.0 * reach
            ),
        );
    }
}
