//! How fluid and blocks push each other.

use serde::{Deserialize, Serialize};

/// How fluid and blocks push each other.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InterfaceFile {
    /// How walls hold the fluid; the preset's way when left out.
    #[serde(default)]
    pub walls: Option<WallMethodFile>,
    /// Whether the fluid slides along walls; with penalty walls it always does.
    #[serde(default)]
    pub slip: SlipFile,
    /// Spring `K_S` between a particle and a surface; N/m.
    #[serde(default)]
    pub penalty_stiffness: Option<f64>,
    /// Dashpot `K_D` between a particle and a surface; N s/m.
    #[serde(default)]
    pub penalty_damping: Option<f64>,
}

/// How walls hold the fluid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum WallMethodFile {
    /// A spring and a dashpot between each particle and each surface, as published: cheap, and off by about
    /// a tenth in forces.
    Penalty,
    /// Particles inside the walls, with pressures continued from the fluid. Thin and sharp bodies keep the water on
    /// their two sides apart.
    Particles,
    /// Exact integrals of the kernel over polyhedra: no wall particles, for large faces. Wants Wendland's kernel,
    /// density from continuity and no plane of symmetry; in a domain that repeats itself, blocks that go through all of it.
    Integral,
}

/// What the fluid does along a wall.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum SlipFile {
    /// It slides.
    #[default]
    Free,
    /// It sticks.
    None,
    /// It sticks until Coulomb's friction gives way, at this angle, from 0 to below 90; degrees.
    Friction(f64),
}
