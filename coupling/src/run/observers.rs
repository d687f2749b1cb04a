//! The observers of a run together.

use std::path::Path;

use crate::files::table::Start;
use crate::handoff::observer::HandOver;
use crate::output::bodies;
use crate::output::observe::barriers::{BarrierResult, Barriers};
use crate::output::observe::counters::{BlockCounters, Counted};
use crate::output::observe::forces::Forces;
use crate::output::observe::frames::Frames;
use crate::output::observe::gauges::Gauges;
use crate::output::observe::ledgers::Ledgers;
use crate::output::observe::maps::Maps;
use crate::output::observe::masses::Masses;
use crate::output::observe::motions::Motions;
use crate::output::observe::reactions::{LargestReaction, Reactions};
use crate::output::observe::trajectories::Trajectories;
use crate::output::observe::{ObserveError, Observer};
use crate::picture::overview_data::OverviewData;
use crate::saved::Saved;
use crate::scene::resolve::Scene;
use crate::world::World;

/// Observers of the world of a run.
#[derive(Debug)]
pub(super) struct Observers {
    pub frames: Frames,
    pub gauges: Gauges,
    pub ledgers: Ledgers,
    /// `None` if no block that the scene asks for can move.
    motions: Option<Motions>,
    /// `None` unless requested by the scene.
    forces: Option<Forces>,
    trajectories: Option<Trajectories>,
    maps: Option<Maps>,
    masses: Option<Masses>,
    counters: Option<BlockCounters>,
    reactions: Option<Reactions>,
    barriers: Option<Barriers>,
    handoff: Option<HandOver>,
    overview: OverviewData,
}

impl Observers {
    /// Observers of a scene.
    pub fn new(
        scene: &Scene,
        folder: &Path,
        world: &World,
        start: Start,
    ) -> Result<Self, ObserveError> {
        if start == Start::New && 0 < world.blocks.n_blocks() {
            bodies::write(folder, scene, world)?;
        }
        Ok(Self {
            frames: Frames::new(folder, scene, world)?,
            gauges: Gauges::new(folder, scene, world, start)?,
            ledgers: Ledgers::new(folder, scene, world, start)?,
            motions: Motions::new(folder, scene, start)?,
            forces: match &scene.forces {
                None => None,
                Some(asked) => {
                    let asked = (asked, scene.block_names.as_slice());
                    Some(Forces::new(folder, asked, world, start)?)
                }
            },
            trajectories: match &scene.trajectories {
                None => None,
                Some(asked) => {
                    let asked = (asked, scene.block_names.as_slice());
                    Some(Trajectories::new(folder, asked, world, start)?)
                }
            },
            maps: (scene.maps.as_ref()).map(|asked| Maps::new(folder, asked, scene, world)),
            masses: if scene.masses.is_empty() {
                None
            } else {
                Some(Masses::new(folder, scene, world, start)?)
            },
            counters: if scene.counters.is_empty() {
                None
            } else {
                Some(BlockCounters::new(folder, scene, start)?)
            },
            reactions: if scene.reactions.is_empty() {
                None
            } else {
                Some(Reactions::new(folder, scene, start)?)
            },
            barriers: if scene.barriers.is_empty() {
                None
            } else {
                Some(Barriers::new(folder, scene, world, start)?)
            },
            handoff: match &scene.handoff {
                None => None,
                Some(asked) => HandOver::new(folder, asked, (scene, world), start)?,
            },
            overview: OverviewData::new(scene, world),
        })
    }

    /// Observers that write during the run, frames last: every existing frame has its rows in every table.
    fn all(&self) -> impl Iterator<Item = &dyn Observer> {
        let Self {
            frames,
            gauges,
            ledgers,
            motions,
            forces,
            trajectories,
            maps,
            masses,
            counters,
            reactions,
            barriers,
            handoff,
            overview: _,
        } = self;
        let observers: [Option<&dyn Observer>; 12] = [
            Some(gauges),
            Some(ledgers),
            motions.as_ref().map(|motions| motions as _),
            forces.as_ref().map(|forces| forces as _),
            trajectories.as_ref().map(|trajectories| trajectories as _),
            maps.as_ref().map(|maps| maps as _),
            masses.as_ref().map(|masses| masses as _),
            counters.as_ref().map(|counters| counters as _),
            reactions.as_ref().map(|reactions| reactions as _),
            barriers.as_ref().map(|barriers| barriers as _),
            handoff.as_ref().map(|handoff| handoff as _),
            Some(frames),
        ];
        observers.into_iter().flatten()
    }

    fn all_mut(&mut self) -> impl Iterator<Item = &mut dyn Observer> {
        let Self {
            frames,
            gauges,
            ledgers,
            motions,
            forces,
            trajectories,
            maps,
            masses,
            counters,
            reactions,
            barriers,
            handoff,
            overview: _,
        } = self;
        let observers: [Option<&mut dyn Observer>; 12] = [
            Some(gauges),
            Some(ledgers),
            motions.as_mut().map(|motions| motions as _),
            forces.as_mut().map(|forces| forces as _),
            trajectories.as_mut().map(|trajectories| trajectories as _),
            maps.as_mut().map(|maps| maps as _),
            masses.as_mut().map(|masses| masses as _),
            counters.as_mut().map(|counters| counters as _),
            reactions.as_mut().map(|reactions| reactions as _),
            barriers.as_mut().map(|barriers| barriers as _),
            handoff.as_mut().map(|handoff| handoff as _),
            Some(frames),
        ];
        observers.into_iter().flatten()
    }

    /// Calls the observers that are due.
    pub fn observe(&mut self, world: &World) -> Result<(), ObserveError> {
        self.overview.add_view(world);
        for observer in self.all_mut().filter(|observer| observer.is_due(world)) {
            observer.observe(world)?;
        }
        Ok(())
    }

    /// Counts of each counter so far.
    pub fn counted(&self) -> Vec<Counted> {
        let counters = self.counters.as_ref();
        counters.map_or_else(Vec::new, BlockCounters::counted)
    }

    /// Largest values of each reaction so far.
    pub fn largest_reactions(&self) -> Vec<LargestReaction> {
        let reactions = self.reactions.as_ref();
        reactions.map_or_else(Vec::new, Reactions::largest)
    }

    /// Results of each barrier so far, with the mass of the water at the start; kg.
    pub fn barriers(&self, water: f64) -> Vec<BarrierResult> {
        let barriers = self.barriers.as_ref();
        barriers.map_or_else(Vec::new, |barriers| barriers.results(water))
    }

    /// Records the last state of a run that ends early.
    pub fn observe_last(&mut self, world: &World) {
        // the run ends with its own error; that the last frame could not be written either must not hide it
        let _ = self.frames.observe_last(world);
        let _ = self.gauges.observe_last(world);
        let _ = self.ledgers.observe_last(world);
        if let Some(motions) = &mut self.motions {
            let _ = motions.observe_last(world);
        }
    }

    /// Writes the final output.
    pub fn finish(
        &mut self,
        folder: &Path,
        world: &World,
        subtitle: String,
    ) -> Result<(), ObserveError> {
        // that of files of an earlier moment comes first
        let synced = self.sync();
        let followed = match &mut self.trajectories {
            None => Ok(()),
            Some(trajectories) => {
                let finished = trajectories.finish(world);
                self.overview.add_trajectories(trajectories);
                finished
            }
        };
        if let Some(maps) = &self.maps {
            self.overview.add_maps(maps);
        }
        if let Some(barriers) = &self.barriers {
            barriers.write_cells(folder, world)?;
        }
        if let Some(handoff) = &self.handoff {
            handoff.finish(world)?;
        }
        self.overview.write(folder, world, subtitle)?;
        synced.and(followed)
    }

    /// Flushes the file to disk, so that it survives a power failure.
    pub fn sync(&mut self) -> Result<(), ObserveError> {
        self.all_mut().try_for_each(|observer| observer.sync())
    }

    /// Appends their states to a byte buffer.
    pub fn save(&self, out: Vec<u8>) -> Saved {
        let out = self
            .all()
            .try_fold(out, |out, observer| observer.save(out))?;
        self.overview.save(out)
    }

    /// Restores their states and removes later output; returns the rest of the bytes.
    pub fn read<'b>(&mut self, bytes: &'b [u8]) -> Result<&'b [u8], ObserveError> {
        let rest = self
            .all_mut()
            .try_fold(bytes, |bytes, observer| observer.read(bytes))?;
        Ok(self.overview.read(rest)?)
    }
}
