//! Water: the fluid with everything that holds it.

use riprap_dda::Blocks;
use riprap_sph::{Absorber, Exchange, Fluid, FluidError, Sleeping};

use crate::grains::AveragedGrains;
use crate::joints::JointWater;
use crate::openings::Openings;
use crate::walls::Walls;
use crate::walls::penalty::{Interface, WallSettings};

/// The fluid with the walls that hold it.
#[derive(Debug)]
pub struct Water {
    /// Particles.
    pub fluid: Fluid,
    /// Penalty walls; with other wall methods, only the push-back of particles out of solids.
    pub interface: Interface,
    /// Walls of particles or integrals.
    pub walls: Option<Walls>,
    /// Water in joints too narrow for particles.
    pub joints: JointWater,
    /// Grains that exchange forces with it by averages.
    pub grains: Option<AveragedGrains>,
    /// Inflows and outflows.
    pub openings: Openings,
    /// Layers that damp waves.
    pub(super) absorbers: Vec<Absorber>,
    /// Criteria of sleep of the fluid, if enabled.
    pub(super) sleeping: Option<Sleeping>,
}

/// Boundaries that hold a fluid.
#[derive(Debug)]
pub struct WaterBoundaries {
    /// Parameters of penalty walls, or of the push-back of particles out of solids.
    pub penalty: WallSettings,
    /// Walls of particles or integrals.
    pub walls: Option<Walls>,
    /// Water in joints too narrow for particles.
    pub joints: JointWater,
    /// Grains that exchange forces with it by averages.
    pub grains: Option<AveragedGrains>,
    /// Inflows and outflows.
    pub openings: Openings,
    /// Layers that damp waves.
    pub absorbers: Vec<Absorber>,
    /// Criteria of sleep of the fluid, if enabled.
    pub sleeping: Option<Sleeping>,
}

impl Water {
    /// A fluid within its boundaries, sorted, its openings filled.
    ///
    /// # Errors
    ///
    /// [`FluidError`] when the openings bring in more particles than there may be.
    pub fn new(
        mut fluid: Fluid,
        boundaries: WaterBoundaries,
        blocks: &Blocks,
    ) -> Result<Self, FluidError> {
        let WaterBoundaries {
            penalty,
            walls,
            joints,
            mut grains,
            openings,
            absorbers,
            sleeping,
        } = boundaries;
        openings.fill(&mut fluid)?;
        fluid.refresh();
        let passed: Vec<usize> = grains.iter().flat_map(AveragedGrains::blocks).collect();
        if let Some(grains) = &mut grains {
            grains.leave_room(&mut fluid, blocks);
        }
        Ok(Self {
            interface: Interface::new(penalty, (blocks, &passed), &fluid),
            fluid,
            walls,
            joints,
            grains,
            openings,
            absorbers,
            sleeping,
        })
    }

    /// Damps waves in absorbing layers over `dt` (s); returns the (negative) contribution.
    pub(super) fn absorb(&mut self, dt: f64) -> Exchange {
        self.fluid.absorb(&self.absorbers, dt)
    }

    /// Sleep of the water that is asked for and has not begun.
    pub(super) fn sleep_to_begin(&self) -> Option<Sleeping> {
        self.sleeping.filter(|_| !self.fluid.may_sleep())
    }
}
