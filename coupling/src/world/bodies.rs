//! Blocks in a coupled step: their part of it, and bodies that leave the domain or reach a plane of symmetry.

use nalgebra::Matrix3;
use riprap_dda::{BlockId, Blocks, Kicks, Load, Phase};
use riprap_sph::{SymmetryPlane, Vec3};

use crate::walls::added_mass::Acceleration;
use crate::world::accounts::Account;
use crate::world::progress::{Held, Progress, Stopwatch};
use crate::world::time_step::BlockSteps;
use crate::world::{OutOfDomain, StepError, TOUCH};

/// State of the coupling on the side of the blocks.
#[derive(Debug)]
pub(crate) struct Bodies {
    /// Box that blocks may not leave; m.
    pub domain: (Vec3, Vec3),
    pub out_of_domain: OutOfDomain,
    /// Planes of symmetry of the fluid.
    planes: Vec<SymmetryPlane>,
    /// Blocks that move and are to stay clear of planes of symmetry.
    kept_clear: Vec<usize>,
    /// Blocks that deform.
    pub deformable: Vec<usize>,
    /// Acceleration of each block by everything beside the fluid, over its last steps.
    pub dry: Vec<Acceleration>,
    /// Largest area that a free block turns to the water on both sides, over its mass; m²/kg.
    pub largest_area_per_mass: f64,
    /// Scratch: velocities of the blocks before their steps, with what the fluid gave them.
    velocities_before: Vec<[Vec3; 2]>,
    /// Impulses of the fluid on the blocks of which accounts are kept, ascending.
    pub accounts: Vec<Account>,
    /// Scratch: loads of the fluid at the start of a predictor-corrector step.
    pub loads_at_start: Vec<Load>,
    /// The same: strains of blocks that deform.
    pub stretches_at_start: Vec<Matrix3<f64>>,
}

impl Bodies {
    pub(super) fn new(
        blocks: &Blocks,
        planes: Vec<SymmetryPlane>,
        gravity: &Vec3,
        (domain, out_of_domain): ((Vec3, Vec3), OutOfDomain),
    ) -> Self {
        let n_blocks = blocks.n_blocks();
        // a block that touches a plane from the start was found to move along it
        let touch = TOUCH * (domain.1 - domain.0).norm();
        let is_clear =
            |&b: &usize| !blocks.is_fixed(b) && plane_within(blocks, &planes, b, touch).is_none();
        let kept_clear = match planes.is_empty() {
            true => Vec::new(),
            false => (0..n_blocks).filter(is_clear).collect(),
        };
        let starting = |b: usize| Acceleration {
            linear: gravity + blocks.contact_force(b).force / blocks.mass(b),
            angular: Vec3::zeros(),
        };
        Self {
            domain,
            out_of_domain,
            kept_clear,
            deformable: (0..n_blocks)
                .filter(|&b| blocks.is_free(b) && blocks.is_deformable(b))
                .collect(),
            dry: (0..n_blocks).map(starting).collect(),
            accounts: Vec::new(),
            largest_area_per_mass: (0..n_blocks)
                .filter(|&b| blocks.is_free(b))
                .map(|b| area(blocks, b) / blocks.mass(b))
                .fold(0.0, f64::max),
            velocities_before: Vec::new(),
            loads_at_start: vec![Load::default(); n_blocks],
            stretches_at_start: vec![Matrix3::zeros(); n_blocks],
            planes,
        }
    }

    /// Keeps accounts of some blocks: those open go on, all others end.
    pub(super) fn keep_accounts(&mut self, blocks: &[usize]) {
        let mut chosen = blocks.to_vec();
        chosen.sort_unstable();
        chosen.dedup();
        let before = std::mem::take(&mut self.accounts);
        let account = |block: usize| {
            let found = before.binary_search_by_key(&block, |account| account.block);
            found.map_or_else(|_| Account::new(block), |k| before[k])
        };
        self.accounts = chosen.into_iter().map(account).collect();
    }

    /// Books the impulse (N s, N m s) of a particle that was pushed back, where an account of the block is kept.
    pub(super) fn book_push(&mut self, block: usize, felt: Load) {
        let found = (self.accounts).binary_search_by_key(&block, |account| account.block);
        if let Ok(k) = found {
            self.accounts[k].impulses.pushed_back += felt;
        }
    }
}

/// Largest area that a block turns to the water, both sides of the largest face of the box around it; m².
fn area(blocks: &Blocks, b: usize) -> f64 {
    let boxes = blocks.parts_of(b).map(|part| blocks.part_aabb(part));
    let around = boxes.reduce(|(low, high), (min, max)| (low.inf(&min), high.sup(&max)));
    around.map_or(0.0, |(low, high)| {
        let size = high - low;
        2.0 * (size.x * size.y).max(size.y * size.z).max(size.z * size.x)
    })
}

/// A plane of symmetry from which a block is less than a distance (m).
fn plane_within(
    blocks: &Blocks,
    planes: &[SymmetryPlane],
    block: usize,
    distance: f64,
) -> Option<SymmetryPlane> {
    planes.iter().copied().find(|plane| {
        blocks.parts_of(block).any(|part| {
            let (min, max) = blocks.part_aabb(part);
            plane.distance(if plane.is_upper { &max } else { &min }) < distance
        })
    })
}

/// Boxes round the parts of blocks that may move; m.
pub(super) fn movable(blocks: &Blocks) -> impl Iterator<Item = (Vec3, Vec3)> {
    blocks.movable_parts().map(|part| blocks.part_aabb(part))
}

/// Blocks with the data read and booked in their step.
#[derive(Debug)]
pub(super) struct BlockPhase<'a> {
    pub blocks: &'a mut Blocks,
    pub bodies: &'a mut Bodies,
    pub progress: &'a mut Progress,
    pub watch: Stopwatch,
}

impl BlockPhase<'_> {
    /// Whether blocks are held, as in settling.
    pub(super) fn are_held(&self) -> bool {
        self.progress.held == Held::AllBlocks
    }

    /// Advances the blocks by `dt` (s) from a time, where they are not held; `in_walls` keeps their accelerations. Returns the
    /// number of their steps.
    pub(super) fn advance(
        &mut self,
        from: f64,
        dt: f64,
        steps: BlockSteps,
        in_walls: InWalls,
    ) -> Result<u32, StepError> {
        if self.are_held() {
            return Ok(0);
        }
        if in_walls == InWalls::Yes {
            self.record_velocities();
        }
        let Self {
            blocks,
            progress,
            watch,
            ..
        } = self;
        let phases = &mut progress.phases;
        let mut ended = |phase| {
            let time = match phase {
                Phase::Motion => &mut phases.integration,
                Phase::BroadPhase => &mut phases.broad_phase,
                Phase::Contacts | Phase::Sums => &mut phases.contacts,
            };
            *time += watch.lap();
        };
        let advanced = match steps {
            BlockSteps::Inside(n) => (blocks.advance_watched(from, dt, n, &mut ended))
                .map(|count| Kicks { count, over: dt }),
            BlockSteps::Spanning(period) => blocks.advance_spanning(from, dt, period, &mut ended),
        };
        let taken = advanced.map_err(|source| StepError::Blocks {
            time: progress.clock.time,
            step: progress.clock.steps,
            source,
        })?;
        if in_walls == InWalls::Yes {
            self.record_accelerations(taken);
        }
        let count = self.remove_escaped();
        if count > 0 && self.bodies.out_of_domain == OutOfDomain::Fail {
            return Err(StepError::Left {
                time: self.progress.clock.time,
                step: self.progress.clock.steps,
                count,
                what: "blocks",
            });
        }
        self.check_planes()?;
        Ok(taken.count)
    }

    fn record_velocities(&mut self) {
        let blocks = &*self.blocks;
        let before = &mut self.bodies.velocities_before;
        before.clear();
        before.extend((0..blocks.n_blocks()).map(|b| blocks.velocity_with_outside(b)));
    }

    /// Of the kicks taken; those of the last ones stay where there was none.
    fn record_accelerations(&mut self, taken: Kicks) {
        if taken.count == 0 {
            return;
        }
        let Bodies {
            dry,
            velocities_before,
            ..
        } = &mut *self.bodies;
        for (b, (dry, before)) in dry.iter_mut().zip(velocities_before).enumerate() {
            let after = self.blocks.velocity_with_outside(b);
            *dry = Acceleration {
                linear: (after[0] - before[0]) / taken.over,
                angular: (after[1] - before[1]) / taken.over,
            };
        }
    }

    /// Removes the blocks whose centroid left the domain; returns how many.
    fn remove_escaped(&mut self) -> u64 {
        let (blocks, progress) = (&mut *self.blocks, &mut *self.progress);
        let (min, max) = self.bodies.domain;
        let mut count = 0;
        for block in 0..blocks.n_blocks() {
            if !blocks.is_free(block) {
                continue;
            }
            let x = blocks.centroid(block);
            let inside = (0..3).all(|axis| min[axis] <= x[axis] && x[axis] <= max[axis]);
            if !inside {
                let before = blocks.energies();
                let momentum = blocks.momentum();
                blocks.remove(block);
                let after = blocks.energies();
                progress.ledger.removed_momentum += momentum - blocks.momentum();
                progress.ledger.removed_energy +=
                    before.kinetic + before.potential + before.elastic
                        - after.kinetic
                        - after.potential
                        - after.elastic;
                count += 1;
            }
        }
        progress.extremes.blocks_removed += count;
        count
    }

    fn check_planes(&self) -> Result<(), StepError> {
        for &block in &self.bodies.kept_clear {
            if self.blocks.is_removed(block) {
                continue;
            }
            if let Some(plane) = plane_within(self.blocks, &self.bodies.planes, block, 0.0) {
                return Err(StepError::AtPlane {
                    time: self.progress.clock.time,
                    step: self.progress.clock.steps,
                    block: BlockId::new(block),
                    axis: plane.axis,
                });
            }
        }
        Ok(())
    }
}

/// Whether walls of particles or integrals stand in the blocks, which ask for their accelerations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum InWalls {
    Yes,
    No,
}
