//! Coupling of fluid and blocks.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Coupling of fluid and blocks.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InterfaceFile {
    /// Wall method; that of the preset when left out.
    #[serde(default)]
    pub walls: Option<WallMethodFile>,
    /// Slip of the fluid along walls; penalty walls always have free slip.
    #[serde(default)]
    pub slip: SlipFile,
    /// Spring `K_S` between a particle and a surface; N/m. When left out, chosen for a penetration of a tenth of a spacing by the
    /// first row of still water and of a quarter by a particle at the expected speed.
    #[serde(default)]
    #[schemars(extend("x-unit" = "N/m"))]
    pub penalty_stiffness: Option<f64>,
    /// Dashpot `K_D` between a particle and a surface; N s/m. A damping ratio of 0.5 when left out.
    #[serde(default)]
    #[schemars(extend("x-unit" = "N s/m", "minimum" = 0))]
    pub penalty_damping: Option<f64>,
}

/// Wall method.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum WallMethodFile {
    /// A spring and a dashpot between each particle and each surface, as published: cheap, with errors from a tenth to a half in
    /// forces on bodies.
    Penalty,
    /// Particles inside the walls, with pressures extrapolated from the fluid. Thin and sharp bodies separate the
    /// water on their two sides.
    Particles,
    /// Exact integrals of the kernel over polyhedra: no wall particles, for large faces. Requires the Wendland
    /// kernel, density from continuity and no plane of symmetry; in a periodic domain, blocks that extend through the
    /// whole period.
    Integral,
}

/// Slip of the fluid along a wall.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub enum SlipFile {
    /// Free slip.
    #[default]
    Free,
    /// No slip.
    None,
    /// No slip up to Coulomb friction with this angle, from 0 to below 90; degrees.
    #[schemars(extend("x-unit" = "degrees"))]
    Friction(f64),
    /// Turbulent friction by the law of the wall, with this equivalent sand roughness, from 0 for a smooth wall to a particle spacing. For
    /// beds and walls whose boundary layer is thinner than a spacing; m.
    #[schemars(extend("x-unit" = "m"))]
    Rough(f64),
}
