//! Volumes of water, as drawn and as filled, and the volume of a particle that makes both agree.
//!
//! All particles have one volume. Boxes are filled by rows that are stretched to fit. A basin takes the nodes of a lattice
//! that is cut along its walls: particles have the drawn volume over their number, and packing spreads them evenly in it.
//! A factor of a percent on all masses is sound there, because it is what the even spread has; other masses at a wall than
//! in the interior would not be.

use riprap_dda::Vec3;

use super::Lattice;
use crate::messages::Code;
use crate::scene::error::Problem;
use crate::scene::file::{
    DimensionsFile, DomainFile, FluidFile, RegionFile, RegionShapeFile, ResolutionFile, vec3,
};

/// Accepted difference of the filled and the drawn volume; –.
const AGREEMENT: f64 = 1e-3;
/// Stretch of the spacing of a lattice up to which a kernel sums as well as over cubes; –.
const BEARABLE: f64 = 0.12;
/// Change of a particle's volume up to which water that is not packed starts without a jolt; –.
const LARGEST_UNPACKED: f64 = 0.04;
/// Volumes that agree but for the rounding of typed digits.
const ROUNDING: f64 = 1e-9;

/// Volume of a region of water.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Amount {
    /// As drawn; m³.
    pub drawn: f64,
    /// That of its particles; m³.
    pub filled: f64,
}

/// Volume of a particle of basins by their drawn volume and number of particles, near that of the lattice, `own`; m³.
pub(super) fn of_basins(own: f64, (drawn, n): (f64, usize), is_packed: bool) -> f64 {
    let volume = drawn / n as f64;
    let change = (volume / own - 1.0).abs();
    let is_fit = change.is_finite() && ROUNDING < change;
    if is_fit && (is_packed || change <= LARGEST_UNPACKED) {
        volume
    } else {
        own
    }
}

/// Spacings with a product, stretched alike but for those that end at periods, planes of symmetry and the width of a flow
/// in a plane; m.
pub(super) fn stretched(spacing: [f64; 3], volume: f64, domain: &DomainFile) -> [f64; 3] {
    let mut is_free = [true; 3];
    for axis in &domain.periodic {
        is_free[axis.index()] = false;
    }
    for side in &domain.symmetry {
        is_free[side.axis().0] = false;
    }
    if domain.dimensions == DimensionsFile::Two {
        is_free[1] = false;
    }
    let n_free = is_free.iter().filter(|free| **free).count();
    let own: f64 = spacing.iter().product();
    if n_free == 0 || volume == own {
        return spacing;
    }
    let factor = (volume / own).powf(1.0 / n_free as f64);
    [0, 1, 2].map(|axis| spacing[axis] * if is_free[axis] { factor } else { 1.0 })
}

/// Warnings about regions whose filled volume is not the drawn one, and about rows that are stretched further than the
/// kernel bears.
pub fn misfits(fluid: &FluidFile, lattice: &Lattice, dimensions: DimensionsFile) -> Vec<Problem> {
    let wanted = match fluid.resolution {
        ResolutionFile::Spacing(wanted) => wanted,
        ResolutionFile::Count(_) => lattice.particle_volume().cbrt(),
    };
    let regions = fluid.regions.iter().zip(&lattice.amounts).enumerate();
    regions
        .filter_map(|(index, (region, amount))| {
            let message = match &region.shape {
                RegionShapeFile::Box { min, max } => {
                    stretch(region, vec3(*max) - vec3(*min), (wanted, dimensions))
                }
                RegionShapeFile::Below { .. } => None,
            };
            let message = message.or_else(|| misfit(region, amount, wanted))?;
            let path = format!("fluid.regions[{index}].shape");
            Some(Problem::warning(Code::SpacingMisfit, path, message))
        })
        .collect()
}

/// A box whose rows are stretched along an axis by more than the kernel bears, and the spacing that fits.
fn stretch(
    region: &RegionFile,
    extent: Vec3,
    (wanted, dimensions): (f64, DimensionsFile),
) -> Option<String> {
    let axes = match dimensions {
        DimensionsFile::Two => vec![0, 2],
        DimensionsFile::Three => vec![0, 1, 2],
    };
    let by = |&axis: &usize| {
        let rows = extent[axis] / wanted;
        (rows / rows.round() - 1.0, axis)
    };
    let (worst, axis) = (axes.iter().map(by)).max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))?;
    let rows = extent[axis] / wanted;
    (BEARABLE < worst.abs()).then(|| {
        format!(
            "fluid region `{}`: {:.6} m along {} are {rows:.2} rows of {wanted:.6} m, so that particles stand {:.0} % \
             {} there than elsewhere; fluid.resolution: Spacing({:.6}) fits",
            region.name,
            extent[axis],
            ['x', 'y', 'z'][axis],
            100.0 * worst.abs(),
            if 0.0 < worst { "farther apart" } else { "closer" },
            extent[axis] / rows.round(),
        )
    })
}

/// A region with another volume than drawn.
fn misfit(region: &RegionFile, amount: &Amount, wanted: f64) -> Option<String> {
    let off = amount.filled / amount.drawn - 1.0;
    (AGREEMENT < off.abs()).then(|| {
        format!(
            "fluid region `{}`: its particles have {:.6} m3, {:+.1} % of the {:.6} m3 drawn; refine fluid.resolution to \
             Spacing({:.6}), or let its walls stand whole spacings apart",
            region.name,
            amount.filled,
            100.0 * off,
            amount.drawn,
            // what is missing is a share of a row
            wanted * (AGREEMENT / off.abs()).max(0.5),
        )
    })
}
