//! Summary of a run from its world, counters and costs.

use std::collections::BTreeMap;

use riprap_dda::Motion;
use riprap_sph::{Fluid, Precision, ViscousStep};

use super::observers::Observers;
use super::{Ending, Run, RunError};
use crate::build_info::COMMIT;
use crate::output::peaks::peaks;
use crate::output::summary::{SolvedContacts, Summary, TimeByPhase, peak_memory};
use crate::scene::resolve::Scene;
use crate::walls::Walls;
use crate::walls::gap::gap_over_spacing;
use crate::world::time_step::{CAUSES, Cause};

impl Run<'_> {
    pub(super) fn summary(&self, ending: &Result<Ending, RunError>) -> Summary {
        let (world, counters, costs) = (&self.world, &self.counters, &self.costs);
        let (clock, extremes, blocks) = (world.clock(), world.extremes(), &world.blocks);
        let water = world.water.as_ref();
        let fluid = water.map(|water| &water.fluid);
        let removed = fluid.map(Fluid::removed);
        let drawn: f64 = (self.scene.fluid.iter())
            .flat_map(|fluid| &fluid.lattice.amounts)
            .map(|amount| amount.drawn)
            .sum();
        let wall_time = self.wall_time();
        let running = (wall_time - costs.settling).max(1e-9);
        let count =
            |test: &dyn Fn(usize) -> bool| (0..blocks.n_blocks()).filter(|&b| test(b)).count();
        let ratio = |part: u64, whole: u64| part as f64 / whole.max(1) as f64;
        let per_second = |n: u64| n as f64 / running;
        Summary {
            case: self.scene.title.clone(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            commit: COMMIT.to_owned(),
            threads: rayon::current_num_threads(),
            precision: precision(self.scene).to_owned(),
            stepping: format!("{:?}", world.stepping()),
            completed: matches!(ending, Ok(Ending::Completed)),
            stop_reason: match ending {
                Ok(Ending::Completed) if self.is_at_rest() => "completed: at rest".to_owned(),
                _ => stop_reason(ending),
            },
            simulated_time: world.time(),
            wall_time,
            settling_wall_time: costs.settling,
            settled_blocks: counters.settled.as_ref().map(|settled| settled.found),
            steps: clock.steps,
            block_substeps: clock.block_substeps,
            fluid_particles: counters.particles_at_start,
            wall_particles: water
                .and_then(|w| w.walls.as_ref())
                .map_or(0, Walls::n_points),
            free_blocks: count(&|b| blocks.is_free(b)),
            fixed_blocks: blocks.n_fixed(),
            prescribed_blocks: count(&|b| matches!(blocks.motion(b), Motion::Prescribed(_))),
            particle_spacing: (self.scene.fluid.as_ref()).map_or(0.0, |f| f.walls.particle_spacing),
            mean_neighbors: ratio(extremes.pair_interactions, extremes.particle_steps),
            particle_steps_per_second: per_second(extremes.particle_steps),
            particle_steps: extremes.particle_steps,
            awake_share: ratio(
                extremes.particle_steps_awake,
                extremes.particle_steps_of_all,
            ),
            pair_interactions: extremes.pair_interactions,
            contact_updates: blocks.contact_updates(),
            pair_interactions_per_second: per_second(extremes.pair_interactions),
            contact_updates_per_second: per_second(blocks.contact_updates()),
            time_by_phase: self.time_by_phase(),
            products_per_viscous_step: fluid
                .filter(|fluid| fluid.settings().scheme.viscous_step == ViscousStep::Implicit)
                .map(|_| ratio(extremes.viscous_products, clock.steps)),
            dt_min: Some(counters.dt_min)
                .filter(|dt| dt.is_finite())
                .unwrap_or(0.0),
            dt_max: counters.dt_max,
            dt_governed_by: self.governing_causes(),
            fell_back: counters.reduction.n_falls(),
            largest_unexplained_gain: counters.detector.largest_gain(),
            resumed: costs.n_resumed,
            checkpoints: costs.n_checkpoints,
            checkpoint_bytes: costs.checkpoint_size,
            max_mach: extremes.max_mach,
            density_error_rms: fluid.map_or(0.0, Fluid::density_error_rms),
            particles_escaped: removed.map_or(0, |removed| removed.count),
            mass_escaped: removed.map_or(0.0, |removed| removed.mass),
            fluid_mass: [counters.mass_at_start, fluid.map_or(0.0, Fluid::mass)],
            fluid_volume: [
                drawn,
                fluid.map_or(0.0, |fluid| {
                    counters.particles_at_start as f64 * fluid.particle_volume()
                }),
            ],
            fluid_mass_drawn: fluid.map_or(0.0, |fluid| drawn * fluid.settings().reference_density),
            openings: water.map_or(Vec::new(), |w| w.openings.passed().to_vec()),
            particles_pushed_back: extremes.particles_pushed_back,
            reliefs: extremes.reliefs,
            blocks_escaped: extremes.blocks_removed,
            max_wall_penetration_over_spacing: extremes.max_wall_penetration_over_spacing,
            wall_gap_over_spacing: water.and_then(|water| {
                gap_over_spacing(water.interface.settings(), blocks, &water.fluid)
            }),
            max_block_overlap_over_size: blocks.max_overlap_over_size(),
            contact_solution: SolvedContacts::of(blocks),
            momentum_residual: world.momentum_residual(),
            energy: world.energy(),
            // the overview reads the same table and reports what is wrong with it
            gauges: peaks(&self.folder, self.scene).unwrap_or_default(),
            counters: self
                .observers
                .as_ref()
                .map_or_else(Vec::new, Observers::counted),
            reactions: self
                .observers
                .as_ref()
                .map_or_else(Vec::new, Observers::largest_reactions),
            barriers: (self.observers.as_ref()).map_or_else(Vec::new, |observers| {
                observers.barriers(counters.mass_at_start)
            }),
            verdict: <[String; 3]>::default(),
            state_hash: world.state_hash(),
            peak_memory: peak_memory(),
        }
        .judged()
    }

    /// Fraction of the steps by the cause that limited them.
    fn governing_causes(&self) -> BTreeMap<Cause, f64> {
        let steps = self.world.clock().steps.max(1) as f64;
        let n_steps = |cause: &Cause| self.counters.governed.get(cause).copied().unwrap_or(0);
        let share = |cause: &Cause| (*cause, n_steps(cause) as f64 / steps);
        CAUSES.iter().map(share).collect()
    }

    fn time_by_phase(&self) -> TimeByPhase {
        let phases = self.world.phases();
        TimeByPhase {
            neighbors: phases.neighbors.as_secs_f64(),
            density: phases.density.as_secs_f64(),
            forces: phases.forces.as_secs_f64(),
            contact_detection: phases.broad_phase.as_secs_f64(),
            contact_forces: phases.contacts.as_secs_f64(),
            wall_search: phases.wall_search.as_secs_f64(),
            coupling: phases.coupling.as_secs_f64(),
            integration: phases.integration.as_secs_f64(),
            output: self.costs.output,
            guards: self.costs.guards,
            checkpoints: self.costs.checkpoints,
        }
    }
}

fn stop_reason(ending: &Result<Ending, RunError>) -> String {
    match ending {
        Ok(Ending::Completed) => "completed".to_owned(),
        Ok(Ending::Interrupted) => "interrupted".to_owned(),
        Ok(Ending::OutOfTime) => "stopped at its wall limit".to_owned(),
        Err(error) => error.to_string(),
    }
}

/// Precision of the fluid's sums; blocks are always in double precision.
fn precision(scene: &Scene) -> &'static str {
    match scene.fluid.as_ref().map(|f| f.settings.scheme.precision) {
        Some(Precision::Single) => "f32 pair sums",
        Some(Precision::Double) | None => "f64",
    }
}

/// Subtitle of the overview.
pub(super) fn subtitle(summary: &Summary) -> String {
    format!(
        "{} particles, {} free blocks, {} steps, {:.3} s simulated in {:.0} s, {}",
        summary.fluid_particles,
        summary.free_blocks,
        summary.steps,
        summary.simulated_time,
        summary.wall_time,
        summary.stop_reason,
    )
}
