//! Before t = 0: water that calms down among held blocks, or blocks that come to rest among walls and gates.

use riprap_dda::Vec3;

use super::counters::{Counters, Settled, Stage, speed_of_block};
use super::observers::Observers;
use super::{Event, Run, RunError};
use crate::files::table::Start;
use crate::output::summary::SettledBlocks;
use crate::scene::resolved::Settling;
use crate::world::time_step::TimeStep;
use crate::world::{StepError, World};

/// Damping rate of settling water times its duration: initial motion decays to `e⁻²⁰` at the end.
const DECAY: f64 = 20.0;
/// Fraction of settling, at its end, without damping, to reveal motion suppressed by damping.
const UNDAMPED_SHARE: f64 = 0.1;
/// Shares of the spheres whose centers bound the core of a heap along each axis.
const CORE: [f64; 2] = [0.2, 0.8];
/// Points along each axis at which the core of a heap is solid or not: a share of 0.6 to 0.01.
const N_POINTS: usize = 48;

impl Run<'_> {
    /// Step before t = 0; whether it was the last one.
    pub(super) fn settle(&mut self, step: TimeStep) -> Result<bool, StepError> {
        match &self.scene.settle_blocks {
            Some(asked) => self.settle_blocks(step, asked),
            None => self.settle_water(step),
        }
    }

    fn settle_water(&mut self, step: TimeStep) -> Result<bool, StepError> {
        let settle = self.scene.settle;
        let Stage::Settling { time, steps } = &mut self.counters.stage else {
            return Ok(false);
        };
        let is_damped = *time < (1.0 - UNDAMPED_SHARE) * settle;
        let rate = if is_damped { DECAY / settle } else { 0.0 };
        self.world.settle_step(step.dt, rate)?;
        *time += step.dt;
        *steps += 1;
        let is_over = settle <= *time;
        if is_over {
            self.world.release()?;
        }
        Ok(is_over)
    }

    fn settle_blocks(&mut self, step: TimeStep, asked: &Settling) -> Result<bool, StepError> {
        let Stage::Settling { time, steps } = &mut self.counters.stage else {
            return Ok(false);
        };
        self.world.settle_blocks_step(step, *time)?;
        *time += step.dt;
        *steps += 1;
        let (time, steps) = (*time, *steps);
        self.counters.watch_rest(&self.world, asked.speed, time);
        let since = self.counters.at_rest_since;
        let at_rest = since.is_some_and(|since| asked.time <= time - since);
        if !at_rest && time < asked.at_most {
            return Ok(false);
        }
        let speeds = (0..self.world.blocks.n_blocks()).map(|b| speed_of_block(&self.world, b));
        let found = SettledBlocks {
            time,
            steps,
            at_rest,
            fastest: speeds.fold(0.0, f64::max),
            solid_fraction: solid_fraction(&self.world),
        };
        self.world.release_blocks(&asked.gates)?;
        self.counters.settled = Some(Settled {
            found,
            world: Vec::new(),
        });
        Ok(true)
    }

    /// Opens the records of blocks that have settled: what they compare with is where these lie now.
    pub(super) fn open_records(&mut self) -> Result<(), RunError> {
        let Some(settled) = &mut self.counters.settled else {
            return Ok(());
        };
        if self.observers.is_some() {
            settled.world = self.world.save(Vec::new())?;
            let observers = Observers::new(self.scene, &self.folder, &self.world, Start::New)?;
            self.observers = Some(observers);
        }
        self.notices.push(Event::Settled(settled.found));
        Ok(())
    }

    /// Opens the records of a saved state again, as they were at t = 0 of blocks that had settled.
    pub(super) fn reopen_records(&mut self, state: &[u8]) -> Result<(), RunError> {
        if self.observers.is_none() || self.scene.settle_blocks.is_none() {
            return Ok(());
        }
        let (counters, _): (Counters, _) = postcard::take_from_bytes(state)?;
        let Some(settled) = counters.settled else {
            return Ok(());
        };
        self.world.read(&settled.world)?;
        let observers = Observers::new(self.scene, &self.folder, &self.world, Start::Resume)?;
        self.observers = Some(observers);
        Ok(())
    }
}

/// Share of the core of a heap of spheres that is solid, see [`SettledBlocks::solid_fraction`]; –.
fn solid_fraction(world: &World) -> Option<f64> {
    let blocks = &world.blocks;
    let free = (0..blocks.n_blocks()).filter(|&b| blocks.is_free(b));
    let sphere = |b: usize| Some((blocks.centroid(b), blocks.sphere_radius(b)?));
    let spheres: Vec<(Vec3, f64)> = free.map(sphere).collect::<Option<_>>()?;
    let mut bounds = [[0.0; 2]; 3];
    for (axis, bounds) in bounds.iter_mut().enumerate() {
        let mut along: Vec<f64> = spheres.iter().map(|(center, _)| center[axis]).collect();
        along.sort_by(f64::total_cmp);
        let last = along.len().checked_sub(1)? as f64;
        *bounds = CORE.map(|share| along[(share * last).round() as usize]);
    }
    let spacing = bounds.map(|[low, high]| (high - low) / N_POINTS as f64);
    if spacing.iter().any(|&spacing| spacing <= 0.0) {
        return None;
    }
    let place = |axis: usize, k: usize| bounds[axis][0] + (k as f64 + 0.5) * spacing[axis];
    let mut is_solid = vec![false; N_POINTS * N_POINTS * N_POINTS];
    for (center, radius) in spheres {
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let of = |x: f64| ((x - bounds[axis][0]) / spacing[axis]).clamp(0.0, N_POINTS as f64);
            of(center[axis] - radius) as usize..of(center[axis] + radius).ceil() as usize
        });
        for (i, j) in x.flat_map(|i| y.clone().map(move |j| (i, j))) {
            for k in z.clone() {
                let point = Vec3::new(place(0, i), place(1, j), place(2, k));
                if (point - center).norm_squared() <= radius * radius {
                    is_solid[(i * N_POINTS + j) * N_POINTS + k] = true;
                }
            }
        }
    }
    let n_solid = is_solid.iter().filter(|&&is| is).count();
    Some(n_solid as f64 / is_solid.len() as f64)
}
