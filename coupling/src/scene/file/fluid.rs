//! The water: how fine it is, where it stands, how it flows.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Triple;

/// The water.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FluidFile {
    /// Reference density; kg/m³.
    #[serde(default = "default_fluid_density")]
    #[schemars(extend("x-unit" = "kg/m³", "exclusiveMinimum" = 0))]
    pub density: f64,
    /// Dynamic viscosity, for schemes with the physical viscosity; Pa s. That of water at 20 degrees, 1.002e-3, when left out;
    /// with the published viscosity, which needs it for stability, `0.012 ρ c0 H`: with less, short waves grow whatever the time
    /// step.
    #[serde(default)]
    #[schemars(extend("x-unit" = "Pa s"))]
    pub dynamic_viscosity: Option<f64>,
    /// Flow law, for mud; Newtonian with `dynamic_viscosity` when left out.
    #[serde(default)]
    pub rheology: Option<RheologyFile>,
    /// Resolution.
    pub resolution: ResolutionFile,
    /// Initial arrangement of its particles.
    #[serde(default)]
    pub lattice: LatticeFile,
    /// Averaged forces with grains.
    #[serde(default)]
    pub grains: GrainExchangeFile,
    /// Initial bodies of water.
    pub regions: Vec<RegionFile>,
}

/// Averaged forces between water and grains that are too small for its particles to flow around them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GrainExchangeFile {
    /// Drag law.
    #[serde(default)]
    pub drag: DragLawFile,
    /// Radius of the kernel of the averages, at least the support of the water; × diameter. 4, for grains of two spacings and more 3,
    /// when left out.
    #[serde(default)]
    #[schemars(extend("x-unit" = "-", "minimum" = 2))]
    pub kernel_radius: Option<f64>,
    /// Water that grains accelerate with them, half their volume.
    #[serde(default)]
    pub added_mass: AddedMassFile,
}

/// Law of the drag of grains.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum DragLawFile {
    /// Beetstra, van der Hoef & Kuipers (2007): from simulations of the flow through packings, at all porosities.
    #[default]
    Beetstra,
    /// Di Felice (1994): a single grain's, with an exponent for its neighbors.
    DiFelice,
    /// Gidaspow (1994): Ergun's below a porosity of 0.75, Wen & Yu's above 0.85, mixed in between.
    Gidaspow,
    /// Ergun (1952), for packed beds.
    Ergun,
    /// Wen & Yu (1966), for dilute suspensions.
    WenYu,
}

/// Water that grains accelerate with them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum AddedMassFile {
    /// On for grains of less than three times the density of the water.
    #[default]
    Auto,
    /// Adds to their inertia.
    On,
    /// Left out.
    Off,
}

/// Resolution of the fluid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub enum ResolutionFile {
    /// Particle spacing; m.
    #[schemars(extend("x-unit" = "m"))]
    Spacing(f64),
    /// Target number of particles, matched as closely as whole rows allow; a deviation of more than 10 % is rejected.
    Count(u32),
}

/// Initial arrangement of particles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum LatticeFile {
    /// In rows directly above each other, which fit boxes. Deep water settles off this lattice once it is disturbed,
    /// and disturbs itself by that: its surface drops by a hundredth of the depth for a while.
    #[default]
    Cubic,
    /// Each layer over the gaps of the one below, as water packs itself: face-centered cubic, in two dimensions
    /// hexagonal. For regions `Below` a level.
    Staggered,
}

/// An initial body of water.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegionFile {
    /// Name, for messages.
    pub name: String,
    /// Extent.
    pub shape: RegionShapeFile,
    /// Initial velocity; m/s.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m/s"))]
    pub velocity: Triple,
    /// Initial flow, in addition to `velocity`.
    #[serde(default)]
    pub flow: Option<FlowFile>,
    /// Flow law of the water of this region; that of the fluid when left out.
    #[serde(default)]
    pub rheology: Option<RheologyFile>,
}

/// Extent of a body of water.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum RegionShapeFile {
    /// A box; it must not overlap a block.
    Box {
        /// Lower corner; m.
        #[schemars(extend("x-unit" = "m"))]
        min: Triple,
        /// Upper corner; m.
        #[schemars(extend("x-unit" = "m"))]
        max: Triple,
    },
    /// Everything below a level that is connected to `seed`; blocks and walls must close the basin.
    Below {
        /// Still-water level, a height along z; m.
        #[schemars(extend("x-unit" = "m"))]
        level: f64,
        /// A wet point; m.
        #[schemars(extend("x-unit" = "m"))]
        seed: Triple,
    },
}

/// Initial flow of the water.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum FlowFile {
    /// A standing wave along x of small height on constant depth, at the instant of a level surface; the surface
    /// first rises at `crest`.
    StandingWave {
        /// From trough to crest; m.
        #[schemars(extend("x-unit" = "m"))]
        height: f64,
        /// Wave length, twice that of the shortest basin that holds it; m.
        #[schemars(extend("x-unit" = "m"))]
        length: f64,
        /// Water depth, below the region's top; m.
        #[schemars(extend("x-unit" = "m"))]
        depth: f64,
        /// x of a crest; m.
        #[schemars(extend("x-unit" = "m"))]
        crest: f64,
    },
}

/// Flow law: stress as a function of the shear rate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum RheologyFile {
    /// Proportional.
    Newtonian {
        /// Dynamic viscosity; Pa s.
        #[schemars(extend("x-unit" = "Pa s"))]
        dynamic_viscosity: f64,
    },
    /// Linear above a yield stress.
    Bingham {
        /// Plastic viscosity; Pa s.
        #[schemars(extend("x-unit" = "Pa s"))]
        dynamic_viscosity: f64,
        /// Yield stress; Pa.
        #[schemars(extend("x-unit" = "Pa"))]
        yield_stress: f64,
        /// Creep below the yield stress.
        regularization: RegularizationFile,
    },
    /// A power law above a yield stress.
    HerschelBulkley {
        /// Consistency; Pa sⁿ.
        #[schemars(extend("x-unit" = "Pa sⁿ"))]
        consistency: f64,
        /// Exponent n, above 0; below 1 for a shear-thinning fluid.
        #[schemars(extend("x-unit" = "-"))]
        exponent: f64,
        /// Yield stress; Pa.
        #[schemars(extend("x-unit" = "Pa"))]
        yield_stress: f64,
        /// Creep below the yield stress.
        regularization: RegularizationFile,
    },
}

/// Creep of a fluid below its yield stress. A stopped layer of thickness H on a slope still moves at `ρ g sin θ H²/(2
/// η)`, where η is its viscosity at rest; explicit viscous steps are proportional to 1/η.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub enum RegularizationFile {
    /// Papanastasiou's exponential with its time constant, 100 to 1000 s for mud; the viscosity at rest is the
    /// plastic one plus yield stress times time constant; s.
    #[schemars(extend("x-unit" = "s"))]
    Papanastasiou(f64),
    /// Largest viscosity, 100 to 1000 times the plastic one; Pa s.
    #[schemars(extend("x-unit" = "Pa s"))]
    Bilinear(f64),
}

fn default_fluid_density() -> f64 {
    1000.0
}
