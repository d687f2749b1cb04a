//! `summary.json`: statistics of a run under stable names, SI units.

use std::collections::BTreeMap;
use std::path::Path;

use riprap_dda::Blocks;
use serde::{Deserialize, Serialize};

use crate::files::vtk::replace_file;
use crate::messages::Code;
use crate::openings::Passed;
use crate::output::observe::ObserveError;
use crate::output::observe::barriers::BarrierResult;
use crate::output::observe::counters::Counted;
use crate::output::observe::reactions::LargestReaction;
use crate::output::peaks::Peak;
use crate::output::run_folder;
use crate::output::verdict::{doubts, verdict};
use crate::world::ledger::Energy;
use crate::world::time_step::Cause;

/// Statistics of a run.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Title of the scene.
    pub case: String,
    /// Version of riprap.
    pub version: String,
    /// Commit of the build, if known.
    pub commit: String,
    /// Threads used.
    pub threads: usize,
    /// Arithmetic of the fluid's pair sums.
    pub precision: String,
    /// Stepping of the fluid, or of blocks by themselves.
    pub stepping: String,
    /// Whether the run reached its end.
    pub completed: bool,
    /// Reason for its end.
    pub stop_reason: String,
    /// s.
    pub simulated_time: f64,
    /// From the first step to the last record, settling included; s.
    pub wall_time: f64,
    /// Part of it spent on settling; s.
    pub settling_wall_time: f64,
    /// Settling of the blocks before t = 0; `None` of scenes without.
    pub settled_blocks: Option<SettledBlocks>,
    /// Common steps.
    pub steps: u64,
    /// Steps of the blocks inside them.
    pub block_substeps: u64,
    /// At the start.
    pub fluid_particles: usize,
    /// Wall particles: 0 with penalty walls.
    pub wall_particles: usize,
    /// Blocks moved by forces.
    pub free_blocks: usize,
    /// Blocks that never move.
    pub fixed_blocks: usize,
    /// Blocks moved by a record or formula.
    pub prescribed_blocks: usize,
    /// Particle spacing; m.
    pub particle_spacing: f64,
    /// Mean number of neighbors of a particle, excluding itself, over the run.
    pub mean_neighbors: f64,
    /// Particles times steps, without settling (as all that follows) and without sleeping particles.
    pub particle_steps: u64,
    /// Fraction of awake particles over the run: 1 where water does not sleep.
    pub awake_share: f64,
    /// Evaluated ordered pairs of neighbors.
    pub pair_interactions: u64,
    /// Evaluated contact points.
    pub contact_updates: u64,
    /// Particles times steps over wall time without settling; 1/s.
    pub particle_steps_per_second: f64,
    /// Evaluated ordered pairs of neighbors over wall time without settling; 1/s.
    pub pair_interactions_per_second: f64,
    /// Evaluated contact points over wall time without settling; 1/s.
    pub contact_updates_per_second: f64,
    /// Wall time by phase; s.
    pub time_by_phase: TimeByPhase,
    /// Mean number of products of an implicit viscous step, each a sum over neighbors; `None` with explicit ones.
    pub products_per_viscous_step: Option<f64>,
    /// Smallest step; s.
    pub dt_min: f64,
    /// Largest step; s.
    pub dt_max: f64,
    /// Fraction of the steps governed by each cause.
    pub dt_governed_by: BTreeMap<Cause, f64>,
    /// Number of failed steps after which the run returned to its last good state.
    pub fell_back: u64,
    /// Largest unexplained energy gain in ten steps (in fifty for blocks without water), over the kinetic and strain energy.
    pub largest_unexplained_gain: f64,
    /// Number of resumptions from a checkpoint.
    pub resumed: u64,
    /// Checkpoints written.
    pub checkpoints: u64,
    /// Size of the last one; bytes.
    pub checkpoint_bytes: u64,
    /// Largest particle speed over sound speed.
    pub max_mach: f64,
    /// Root mean square of ρ/ρ₀ − 1 over compressed particles at the end.
    pub density_error_rms: f64,
    /// Particles that left the domain.
    pub particles_escaped: u64,
    /// Their mass; kg.
    pub mass_escaped: f64,
    /// Mass of the fluid at the start and at the end; kg.
    pub fluid_mass: [f64; 2],
    /// Volume of the fluid's regions as drawn, and of its particles at the start; m³.
    pub fluid_volume: [f64; 2],
    /// Mass of the fluid's regions as drawn, at the reference density; that at the start has what its weight compresses in
    /// addition; kg.
    pub fluid_mass_drawn: f64,
    /// Water that passed inflows and outflows.
    pub openings: Vec<Passed>,
    /// Particles found inside a solid and pushed back.
    pub particles_pushed_back: u64,
    /// Times that a particle closed in by bodies, compressed by more than a fifth at a surface, was relieved.
    pub reliefs: u64,
    /// Blocks that left the domain.
    pub blocks_escaped: u64,
    /// Largest penetration of a particle into a solid over the spacing.
    pub max_wall_penetration_over_spacing: f64,
    /// Gap between walls and the first row of particles at the end over the spacing; `None` without water at walls.
    pub wall_gap_over_spacing: Option<f64>,
    /// Largest overlap of blocks over their size.
    pub max_block_overlap_over_size: f64,
    /// Contacts of all steps of contact dynamics; `None` with springs.
    pub contact_solution: Option<SolvedContacts>,
    /// Unexplained momentum over the momentum exchanged.
    pub momentum_residual: f64,
    /// The energy ledger at the end; J.
    pub energy: Energy,
    /// Largest value, its time and the arrival of the wave for each gauge with one column.
    pub gauges: Vec<Peak>,
    /// Blocks that passed, those inside at the end, first and last time of each counter.
    pub counters: Vec<Counted>,
    /// Largest sum and largest single normal force of each reaction, with their times.
    pub reactions: Vec<LargestReaction>,
    /// Arrival, peaks, values at rest, passage and clogging of each barrier.
    pub barriers: Vec<BarrierResult>,
    /// Whether the account of energy closes, how well the waves are resolved, and what to look at.
    pub verdict: [String; 3],
    /// Hash of the final state: equal for equal runs, whatever the number of threads.
    pub state_hash: String,
    /// Peak memory; bytes, 0 if unknown.
    pub peak_memory: u64,
}

/// Settling of free blocks before t = 0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SettledBlocks {
    /// s.
    pub time: f64,
    /// Steps.
    pub steps: u64,
    /// Whether nothing was faster than the scene's speed for as long as it asks.
    pub at_rest: bool,
    /// Largest speed of any point of a block, of a sphere of its center, at its end; m/s.
    pub fastest: f64,
    /// Share of the volume that spheres fill, in the box between the 20th and 80th percentile of their centers along each axis; `None`
    /// where free blocks are no spheres; –.
    pub solid_fraction: Option<f64>,
}

/// Contacts of all steps of contact dynamics.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct SolvedContacts {
    /// Steps of the blocks.
    pub steps: u64,
    /// Mean number of sweeps and iterations of a step.
    pub mean_sweeps: f64,
    /// Largest number of them.
    pub most_sweeps: usize,
    /// Largest number of contact points of a step.
    pub most_contacts: usize,
    /// Largest residual of the laws of contact.
    pub largest_residual: f64,
    /// Largest spurious over available energy of a step.
    pub largest_energy_error: f64,
    /// Steps left with a residual above 0.01.
    pub unsolved_steps: u64,
    /// Most points of a step that bear with a friction above Painlevé's limit.
    pub most_above_painleve: usize,
}

impl SolvedContacts {
    /// Those of a system of blocks, if it has any.
    pub fn of(blocks: &Blocks) -> Option<Self> {
        let solved = blocks.solved_steps();
        (0 < solved.n_steps).then(|| Self {
            steps: solved.n_steps,
            mean_sweeps: solved.n_iterations as f64 / solved.n_steps as f64,
            most_sweeps: solved.most_iterations,
            most_contacts: solved.most_contacts,
            largest_residual: solved.largest_residual,
            largest_energy_error: solved.largest_energy_error,
            unsolved_steps: solved.n_unsolved,
            most_above_painleve: solved.most_above_painleve,
        })
    }
}

/// Wall time by phase; s.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct TimeByPhase {
    /// Sorting and neighbor search.
    pub neighbors: f64,
    /// Densities and pressures.
    pub density: f64,
    /// Pair forces in the fluid.
    pub forces: f64,
    /// Broad phase of the blocks.
    pub contact_detection: f64,
    /// Narrow phase and contact law of the blocks, which share a loop over pairs.
    pub contact_forces: f64,
    /// Placement of walls, and search of particles near them.
    pub wall_search: f64,
    /// Sums and forces between particles and blocks.
    pub coupling: f64,
    /// Kicks, drifts and step limits of both media.
    pub integration: f64,
    /// Observers.
    pub output: f64,
    /// Saving and checking the last good state.
    pub guards: f64,
    /// Writing checkpoints.
    pub checkpoints: f64,
}

impl Summary {
    /// With the verdict of its numbers, under the names that the file has, as for runs of which only that is left.
    pub fn judged(mut self) -> Self {
        if let Ok(numbers) = serde_json::to_value(&self) {
            self.verdict = verdict(&numbers);
        }
        self
    }

    /// Codes of the doubts in its verdict.
    pub fn doubts(&self) -> Vec<Code> {
        serde_json::to_value(self).map_or_else(|_| Vec::new(), |numbers| doubts(&numbers))
    }

    /// Writes `summary.json` under a temporary name and renames it.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] names the file.
    pub fn write(&self, folder: &Path) -> Result<(), ObserveError> {
        let path = folder.join(run_folder::SUMMARY);
        let failed = |source| ObserveError::Write {
            path: path.display().to_string(),
            source,
        };
        let text = serde_json::to_string_pretty(self).map_err(|e| failed(e.into()))?;
        replace_file(&path, &[text.as_bytes(), b"\n"])?;
        Ok(())
    }
}

/// Peak memory of this process; bytes, 0 if unknown: other systems than Linux do not tell.
pub fn peak_memory() -> u64 {
    of_status("VmHWM:")
}

/// Memory of this process; bytes, 0 if unknown.
#[cfg(target_os = "linux")]
pub fn memory() -> u64 {
    of_status("VmRSS:")
}

/// Memory of this process; bytes, 0 if unknown.
#[cfg(not(target_os = "linux"))]
pub fn memory() -> u64 {
    use sysinfo::{ProcessRefreshKind, ProcessesToUpdate, System, get_current_pid};
    let Ok(pid) = get_current_pid() else {
        return 0;
    };
    let mut system = System::new();
    let only = ProcessesToUpdate::Some(&[pid]);
    let kind = ProcessRefreshKind::nothing().with_memory();
    system.refresh_processes_specifics(only, true, kind);
    system.process(pid).map_or(0, sysinfo::Process::memory)
}

/// A line of Linux such as "VmHWM:     12345 kB"; bytes.
fn of_status(name: &str) -> u64 {
    std::fs::read_to_string("/proc/self/status")
        .ok()
        .and_then(|status| {
            let line = status.lines().find(|line| line.starts_with(name))?;
            line.split_whitespace().nth(1)?.parse::<u64>().ok()
        })
        .map_or(0, |kib| kib * 1024)
}
