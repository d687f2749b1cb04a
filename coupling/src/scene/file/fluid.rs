//! The water: how fine it is, where it stands, how it flows.

use serde::{Deserialize, Serialize};

use super::Triple;

/// The water.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FluidFile {
    /// Reference density; kg/m³.
    #[serde(default = "default_fluid_density")]
    pub density: f64,
    /// Dynamic viscosity, for schemes whose viscosity is that of the fluid; Pa s. What keeps the published
    /// scheme calm is this number: see `cases/README.md`.
    #[serde(default = "default_dynamic_viscosity")]
    pub dynamic_viscosity: f64,
    /// How it flows, for mud; Newtonian with `dynamic_viscosity` when left out.
    #[serde(default)]
    pub rheology: Option<RheologyFile>,
    /// How fine.
    pub resolution: ResolutionFile,
    /// How its particles stand at the start.
    #[serde(default)]
    pub lattice: LatticeFile,
    /// Where the water stands at the start.
    pub regions: Vec<RegionFile>,
}

/// How fine the fluid is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ResolutionFile {
    /// Particle spacing; m.
    Spacing(f64),
    /// Wanted number of particles, met as nearly as whole rows allow; a miss of more than 10 % is
    /// refused.
    Count(u32),
}

/// How particles stand at the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum LatticeFile {
    /// In rows one above the other, which fit boxes. Deep water comes down from them once it is stirred, and stirs
    /// itself by that: its surface dips by a hundredth of the depth for a while.
    #[default]
    Cubic,
    /// Each layer over the gaps of the one below, as water packs itself: face-centred, in a plane hexagonal. For
    /// regions that are `Below` a level.
    Staggered,
}

/// A body of water at the start.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RegionFile {
    /// Name, for messages.
    pub name: String,
    /// Extent.
    pub shape: RegionShapeFile,
    /// Initial velocity; m/s.
    #[serde(default)]
    pub velocity: Triple,
    /// Initial flow, on top of `velocity`.
    #[serde(default)]
    pub flow: Option<FlowFile>,
    /// How what starts here flows; that of the fluid when left out.
    #[serde(default)]
    pub rheology: Option<RheologyFile>,
}

/// Extent of a body of water.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum RegionShapeFile {
    /// A box; it must not overlap a block.
    Box {
        /// Lower corner; m.
        min: Triple,
        /// Upper corner; m.
        max: Triple,
    },
    /// Everything below a level that water poured in at `seed` would reach; blocks and walls must
    /// close the basin.
    Below {
        /// Still-water level, a height along z; m.
        level: f64,
        /// A wet point; m.
        seed: Triple,
    },
}

/// Flow of water at the start.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum FlowFile {
    /// A standing wave along x as its surface passes through rest, of small height on constant depth; the surface rises first
    /// at `crest`.
    StandingWave {
        /// From trough to crest; m.
        height: f64,
        /// Of the wave, twice that of a basin which it just fits; m.
        length: f64,
        /// Of the water, under the region's top; m.
        depth: f64,
        /// x of a crest; m.
        crest: f64,
    },
}

/// How stress follows the rate of shear.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum RheologyFile {
    /// In proportion.
    Newtonian {
        /// Dynamic viscosity; Pa s.
        dynamic_viscosity: f64,
    },
    /// In proportion beyond a yield stress.
    Bingham {
        /// Plastic viscosity; Pa s.
        dynamic_viscosity: f64,
        /// Yield stress; Pa.
        yield_stress: f64,
        /// How it creeps below the yield stress.
        regularization: RegularizationFile,
    },
    /// By a power beyond a yield stress.
    HerschelBulkley {
        /// Consistency; Pa sⁿ.
        consistency: f64,
        /// Exponent n, above 0; below 1 for a fluid that thins when sheared.
        exponent: f64,
        /// Yield stress; Pa.
        yield_stress: f64,
        /// How it creeps below the yield stress.
        regularization: RegularizationFile,
    },
}

/// How a fluid with a yield stress creeps below it. A stopped layer of thickness H on a slope goes on at
/// `ρ g sin θ H²/(2 η)`, η its viscosity at rest; the step is proportional to 1/η.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum RegularizationFile {
    /// Papanastasiou's exponential with its time, 100 to 1000 s for mud; the viscosity at rest is the plastic
    /// one plus yield stress times time; s.
    Papanastasiou(f64),
    /// A largest viscosity, 100 to 1000 times the plastic one; Pa s.
    Bilinear(f64),
}

fn default_fluid_density() -> f64 {
    1000.0
}

/// Water at 20 degrees; Pa s.
fn default_dynamic_viscosity() -> f64 {
    1.002e-3
}
