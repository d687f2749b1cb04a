//! Pistons that absorb: each reads the surface before it and is steered by its control.

use std::f64::consts::PI;

use riprap_dda::Blocks;
use riprap_sph::{Dimensions, Fluid, Vec3};

use crate::waves::theory::{Control, Memory};

/// Length before the piston within which the surface is read; × spacing. Particles count less the farther they are, so that
/// none counts at once when it comes in.
const WINDOW: f64 = 4.0;
/// Length behind its face within which particles count as at it; × window, one spacing.
const BEHIND: f64 = 0.25;
/// Mean distance of the water that is read; × window.
const MEAN_DISTANCE: f64 = 0.5 - 2.0 / (PI * PI);

/// Piston that absorbs.
#[derive(Clone, Debug)]
pub struct AbsorbingPiston {
    /// Number of the block.
    block: usize,
    /// Unit vector into the water.
    direction: Vec3,
    /// Place before it, from its centroid; m.
    front: Vec3,
    /// Half of its extent across; m.
    half_width: f64,
    /// Depth of the still water before it; m.
    depth: f64,
    /// Length before it within which water is read; m.
    window: f64,
    control: Control,
    state: State,
}

/// State of a piston: the water read at the start of the run, and what its control remembers.
pub(super) type State = (Option<f64>, Memory);

impl AbsorbingPiston {
    /// Distance before a piston at which it reads the surface; m.
    pub fn reads_at(spacing: f64) -> f64 {
        MEAN_DISTANCE * WINDOW * spacing
    }

    /// Piston of a block, in still water of a depth (m).
    pub fn new(
        (block, direction): (usize, Vec3),
        (front, half_width): (Vec3, f64),
        (depth, spacing): (f64, f64),
        control: Control,
    ) -> Self {
        Self {
            block,
            direction,
            front,
            half_width,
            depth,
            window: WINDOW * spacing,
            control,
            state: State::default(),
        }
    }

    /// Steers the piston over the step `dt` (s) from a time.
    pub(super) fn steer(&mut self, fluid: &Fluid, blocks: &mut Blocks, (time, dt): (f64, f64)) {
        let front = blocks.centroid(self.block) + self.front;
        let reading = self.reading(fluid, &front);
        let (start, memory) = &mut self.state;
        let start = *start.get_or_insert(reading);
        // water that was before it and is gone tells nothing of the level
        let surface = match 0.0 < start {
            true => self.depth * (reading / start - 1.0),
            false => 0.0,
        };
        let velocity = self.control.velocity(memory, surface, (time, dt));
        blocks.steer(self.block, self.direction * velocity);
    }

    /// Particles before the piston, each by its distance, `(1 + cos πs/L)/2`.
    fn reading(&self, fluid: &Fluid, front: &Vec3) -> f64 {
        let across = Vec3::z().cross(&self.direction);
        let is_plane = matches!(fluid.settings().dimensions, Dimensions::Two { .. });
        let weight = |x: &Vec3| {
            let away = x - front;
            let s = away.dot(&self.direction);
            // what pressed into its face counts, water behind a thin piston does not
            let is_before = -BEHIND * self.window < s && s < self.window;
            if !is_before || (!is_plane && self.half_width < away.dot(&across).abs()) {
                return 0.0;
            }
            0.5 * (1.0 + (PI * s.max(0.0) / self.window).cos())
        };
        fluid.particles().position.iter().map(weight).sum()
    }

    pub(super) fn state(&self) -> &State {
        &self.state
    }

    pub(super) fn restore(&mut self, state: State) {
        self.state = state;
    }
}
