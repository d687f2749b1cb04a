//! Data of `overview.svg`: three side views, plan views, paths of falling blocks, gauge records, the energy ledger.

mod charts;
mod plan;
mod side_view;
pub(in crate::picture) mod theory;

use std::path::{Path, PathBuf};

use super::overview::plan::FromAbove;
use super::overview::{Overview, Record, keep_seen, svg};
use crate::files::table::{TableData, read_table};
use crate::output::observe::ObserveError;
use crate::output::observe::gauges::Gauges;
use crate::output::observe::maps::Maps;
use crate::output::observe::trajectories::Trajectories;
use crate::output::peaks::{Peak, noticed};
use crate::output::run_folder;
use crate::saved::{Read, Saved};
use crate::scene::resolve::Scene;
use crate::world::World;
use crate::world::ledger::Energy;
use charts::{bounce_heights, reached};
use side_view::{Section, snapshot};
use theory::Theory;

/// Collects the data of `overview.svg` during a run.
#[derive(Debug)]
pub struct OverviewData {
    overview: Overview,
    section: Section,
    /// Change of a surface that counts as arrival for each gauge record, `None` for other gauges; m.
    noticed: Vec<Option<f64>>,
    /// Index of each gauge record in the row of gauges.
    places: Vec<usize>,
    /// Theory of each gauge record, where there is one.
    theories: Vec<Option<Theory>>,
    duration: f64,
}

impl OverviewData {
    /// Nothing seen yet.
    pub fn new(scene: &Scene, world: &World) -> Self {
        let columns = Gauges::scalar_columns(scene);
        let record = |name: &str, unit: &str| Record {
            name: name.to_owned(),
            unit: unit.to_owned(),
            ..Record::default()
        };
        let section = Section::of(scene);
        let noticed = noticed(scene);
        Self {
            noticed: (columns
                .iter()
                .map(|(_, _, unit)| noticed.filter(|_| unit == "m")))
            .collect(),
            overview: Overview {
                title: scene.title.clone(),
                subtitle: String::new(),
                particle_spacing: scene
                    .fluid
                    .as_ref()
                    .map_or(0.0, |f| f.walls.particle_spacing),
                snapshots: Vec::new(),
                charts: Vec::new(),
                gauges: columns
                    .iter()
                    .map(|(_, name, unit)| record(name, unit))
                    .collect(),
                energy: Energy::TERMS.iter().map(|name| record(name, "J")).collect(),
                peaks: Vec::new(),
                view: section.view((scene.domain.min, scene.domain.max)),
                along: section.label(),
                plan: plan::begun(scene, world),
            },
            theories: (columns.iter())
                .map(|(_, name, _)| Theory::of(scene, name))
                .collect(),
            places: columns.iter().map(|(place, _, _)| *place).collect(),
            duration: scene.duration,
            section,
        }
    }

    /// Takes the records of gauges and of the energy ledger from the tables of the run.
    fn read_records(&mut self, folder: &Path) -> Result<(), ObserveError> {
        let gauges = read_table(&folder.join(run_folder::GAUGES))?;
        let energy = read_table(&folder.join(run_folder::ENERGY))?;
        let places = self.places.iter().copied();
        fill(&mut self.overview.gauges, &gauges, places);
        fill(&mut self.overview.energy, &energy, 1..);
        for (record, theory) in self.overview.gauges.iter_mut().zip(&self.theories) {
            if let Some(theory) = theory {
                record.theory = theory.at(&record.time);
            }
        }
        for record in &mut self.overview.energy {
            // losses count from the start; of what is stored only changes matter, and gravity has no zero
            let start = record.value.first().copied().unwrap_or(0.0);
            record.value.iter_mut().for_each(|value| *value -= start);
        }
        let records = self.overview.gauges.iter().zip(&self.noticed);
        let peak = |(r, noticed): (&Record, &Option<f64>)| {
            Peak::of(&r.name, &r.unit, (&r.time, &r.value), *noticed)
        };
        self.overview.peaks = records.map(peak).collect();
        Ok(())
    }

    /// Appends the views taken so far to some bytes.
    pub fn save(&self, out: Vec<u8>) -> Saved {
        let plans = self.overview.plan.as_ref().map(|plan| &plan.views);
        postcard::to_extend(&(&self.overview.snapshots, plans), out)
    }

    /// Restores the views; returns the rest of the bytes.
    pub fn read<'a>(&mut self, bytes: &'a [u8]) -> Read<'a> {
        let (views, rest): (Option<Vec<FromAbove>>, _);
        ((self.overview.snapshots, views), rest) = postcard::take_from_bytes(bytes)?;
        if let Some((plan, views)) = self.overview.plan.as_mut().zip(views) {
            plan.views = views;
        }
        Ok(rest)
    }

    /// Plots bounce heights and run-out of the tracked blocks.
    pub fn add_trajectories(&mut self, trajectories: &Trajectories) {
        let run_outs = trajectories.run_outs();
        if run_outs.is_empty() {
            return;
        }
        self.overview.charts = vec![bounce_heights(&trajectories.heights()), reached(&run_outs)];
    }

    /// Draws the maps.
    pub fn add_maps(&mut self, maps: &Maps) {
        if let Some(plan) = &mut self.overview.plan {
            plan::add_maps(plan, maps);
        }
    }

    /// Takes the view at the start, also from above, and once at the middle.
    pub fn add_view(&mut self, world: &World) {
        let due = match self.overview.snapshots.len() {
            0 => 0.0,
            1 => 0.5 * self.duration,
            _ => return,
        };
        if due <= world.time() {
            if self.overview.snapshots.is_empty() {
                self.add_plan_view(world);
            }
            self.add_side_view(world);
        }
    }

    fn add_side_view(&mut self, world: &World) {
        let mut snapshot = snapshot(world, &self.section);
        let Overview {
            snapshots,
            view,
            particle_spacing,
            ..
        } = &mut self.overview;
        keep_seen(&mut snapshot, *view, *particle_spacing);
        snapshots.push(snapshot);
    }

    fn add_plan_view(&mut self, world: &World) {
        if let Some(plan) = &mut self.overview.plan {
            plan.views.push(plan::from_above(plan, world));
        }
    }

    /// Takes the last view and writes `overview.svg`.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] names the file.
    pub fn write(
        &mut self,
        folder: &Path,
        world: &World,
        subtitle: String,
    ) -> Result<PathBuf, ObserveError> {
        self.add_side_view(world);
        self.add_plan_view(world);
        self.overview.subtitle = subtitle;
        self.read_records(folder)?;
        // terms absent from the scene are omitted from the legend
        self.overview
            .energy
            .retain(|record| record.value.iter().any(|&value| value != 0.0));
        let path = folder.join(run_folder::OVERVIEW);
        std::fs::write(&path, svg(&self.overview)).map_err(|source| ObserveError::Write {
            path: path.display().to_string(),
            source,
        })?;
        Ok(path)
    }
}

/// Fills records with the columns of a table at these places; the first is the time.
fn fill(records: &mut [Record], table: &TableData, places: impl Iterator<Item = usize>) {
    let Some(time) = table.values.first() else {
        return;
    };
    for (record, place) in records.iter_mut().zip(places) {
        if let Some(values) = table.values.get(place) {
            record.time.clone_from(time);
            record.value.clone_from(values);
        }
    }
}
