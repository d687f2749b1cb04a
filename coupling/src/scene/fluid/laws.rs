//! Flow laws of the fluid and its regions.

use riprap_sph::{Regularization, Rheology};

use super::scheme;
use crate::messages::Code;
use crate::scene::error::Problem;
use crate::scene::file::{RegularizationFile, RheologyFile, SceneFile, ViscosityFile};
use crate::scene::fill::Lattice;

/// Largest number of flow laws, which the type of a particle's number can tell apart.
const MOST_LAWS: usize = 256;

/// A flow law of the file.
pub(in crate::scene) fn flow_law(file: &RheologyFile) -> Rheology {
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

/// Flow laws of the regions, each once; empty if the file has none.
#[derive(Default)]
pub(super) struct Laws {
    pub(super) rheologies: Vec<Rheology>,
    /// Number of the law of each particle.
    pub(super) kinds: Vec<u8>,
}

/// Flow laws in use.
pub(super) fn laws(file: &SceneFile, lattice: &Lattice, problems: &mut Vec<Problem>) -> Laws {
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
            Code::OptionWithoutEffect,
            "numerics.viscosity",
            "the flow laws of the fluid have no effect with this viscosity; leave it out, or set it to Rheological",
        ));
        return Laws::default();
    }
    let of_fluid = RheologyFile::Newtonian {
        dynamic_viscosity: scheme::dynamic_viscosity(fluid),
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
            Code::ValueOutOfRange,
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
