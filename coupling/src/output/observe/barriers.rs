//! Records of barriers: forces after every step, what passes them and clogs their openings at rows, and the largest loads of their cells.
//!
//! Impulses are those of the accounts of the blocks, to which no event is too short; forces of a step are those of the contacts at its end,
//! with contact dynamics their means over it, and the mean force of the water in it.

mod cells;
mod clogging;
mod flow;
mod forces;
mod result;

use std::collections::VecDeque;
use std::path::Path;

use riprap_dda::{Integrator, Load};
use serde::{Deserialize, Serialize};

use super::{ObserveError, Observer, Schedule};
use crate::files::table::{Cell, Column, Start, Table};
use crate::files::vtk;
use crate::output::run_folder;
use crate::saved::Saved;
use crate::scene::resolve::Scene;
use crate::scene::resolved::recording::Barrier;
use crate::world::World;
use cells::{CellLoads, Grid, Local, Probe, StepShares};
pub use clogging::{Clogging, OpeningResult};
use clogging::{SLICES, Slice};
use flow::{Flow, Passed, Reach};
use forces::{Accounted, COMPONENTS, KINDS, Peak, Thrust, Track};
pub use result::{BarrierResult, LoadResult};

/// Time before the end over which forces at rest are means; s.
const REST: f64 = 1.0;

/// State of the record of a barrier. Saved in checkpoints.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct State {
    /// Last step, and last row; s.
    time: Option<f64>,
    row_time: Option<f64>,
    accounted: Vec<Accounted>,
    /// Sources of the whole, then of each block.
    tracks: Vec<[Track; 3]>,
    cells: CellLoads,
    /// Largest local force of a step since the last row, N, and its integral, N s; of contacts and of water.
    local: [[f64; 2]; 2],
    local_peak: [Peak; 2],
    peak: [Peak; 3],
    arrival: [Option<f64>; 2],
    passed: Passed,
    flow: Flow,
    /// Flow upstream at the row after the largest force, and whether that row is to come.
    at_peak: Reach,
    has_new_peak: bool,
    /// Time (s) and impulses of the rows of the last second.
    rows: VecDeque<(f64, [Thrust; 3])>,
    slices: Vec<[Slice; SLICES]>,
}

/// Record of a barrier.
#[derive(Debug)]
struct Record {
    barrier: Barrier,
    grid: Grid,
    table: Table,
    clogging: Option<Table>,
    state: State,
    probe: Probe,
    has_water: bool,
    has_springs: bool,
    /// m/s².
    gravity: f64,
}

/// Writes `barrier_NAME.csv`, `clogging_NAME.csv` and `barrier_NAME.vtp` of each barrier, a row per interval of `blocks.csv`.
#[derive(Debug)]
pub struct Barriers {
    schedule: Schedule,
    records: Vec<Record>,
}

impl Barriers {
    /// Tables in `folder` for the scene's barriers, whose impulses the world records.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] when a table cannot be created.
    pub fn new(
        folder: &Path,
        scene: &Scene,
        world: &World,
        start: Start,
    ) -> Result<Self, ObserveError> {
        let record = |barrier: &Barrier| Record::new(folder, (scene, barrier), world, start);
        let records: Result<_, ObserveError> = scene.barriers.iter().map(record).collect();
        Ok(Self {
            schedule: Schedule::every(scene.output.ledger_interval),
            records: records?,
        })
    }

    /// Results so far, with the mass of the water at the start; kg.
    pub fn results(&self, water: f64) -> Vec<BarrierResult> {
        self.records.iter().map(|r| r.result(water)).collect()
    }

    /// Writes the largest loads of all cells.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] names the file.
    pub fn write_cells(&self, folder: &Path, world: &World) -> Result<(), ObserveError> {
        for record in &self.records {
            let Record { barrier, grid, .. } = record;
            let path = folder.join(run_folder::barrier_cells(&barrier.name));
            let cells = &record.state.cells;
            vtk::write(&path, &cells.envelope(grid, barrier, world.time()))?;
        }
        Ok(())
    }
}

impl Record {
    fn new(
        folder: &Path,
        (scene, barrier): (&Scene, &Barrier),
        world: &World,
        start: Start,
    ) -> Result<Self, ObserveError> {
        let grid = Grid::new(barrier, &scene.blocks);
        let has_water = world.water.is_some();
        let path = |name: String| folder.join(name);
        let clogging = match barrier.openings.is_empty() || barrier.grain.is_none() {
            true => None,
            false => Some(Table::open(
                &path(run_folder::clogging(&barrier.name)),
                &clogging_columns(),
                start,
            )?),
        };
        let state = State {
            time: None,
            row_time: None,
            accounted: vec![Accounted::default(); barrier.blocks.len()],
            tracks: vec![Default::default(); 1 + barrier.blocks.len()],
            cells: CellLoads::of(&grid, has_water),
            local: Default::default(),
            local_peak: Default::default(),
            peak: Default::default(),
            arrival: Default::default(),
            passed: Passed::of(world),
            flow: Flow::default(),
            at_peak: Reach::default(),
            has_new_peak: false,
            rows: VecDeque::new(),
            slices: vec![Default::default(); barrier.openings.len()],
        };
        Ok(Self {
            table: Table::open(
                &path(run_folder::barrier_table(&barrier.name)),
                &columns(barrier, has_water),
                start,
            )?,
            clogging,
            barrier: barrier.clone(),
            grid,
            state,
            probe: Probe::default(),
            has_water,
            has_springs: scene.block_settings.integrator == Integrator::CentralDifference,
            gravity: scene.gravity.norm(),
        })
    }

    /// Takes the forces of a step.
    fn step(&mut self, world: &World) {
        let time = world.time();
        let dt = time - self.state.time.unwrap_or(time);
        self.state.time = Some(time);
        self.book_forces(world, dt);
        let mut local = Local {
            step: StepShares {
                time,
                contacts: match self.has_springs {
                    true => [0.5 * dt; 2],
                    false => [0.0, dt],
                },
                water: dt,
            },
            ..Local::default()
        };
        let (site, state) = ((&self.grid, &self.barrier), &mut self.state);
        state.cells.book_contacts(site, &world.blocks, &mut local);
        if let Some(water) = &world.water {
            let media = (water, &world.blocks);
            let probe = &mut self.probe;
            state.cells.book_water(site, media, probe, &mut local);
        }
        for (k, &largest) in local.largest.iter().enumerate() {
            state.local[k][0] = state.local[k][0].max(largest);
            state.local[k][1] += largest * dt;
            state.local_peak[k].update(largest, time);
            if local.has_arrived[k] {
                state.arrival[k].get_or_insert(time);
            }
        }
    }

    fn book_forces(&mut self, world: &World, dt: f64) {
        let Self { barrier, state, .. } = self;
        let (flow, time) = (&barrier.axes[0], world.time());
        let mut whole = [[Thrust::default(); 3]; 2];
        for (k, &b) in barrier.blocks.iter().enumerate() {
            let centroid = world.blocks.centroid(b);
            let thrust = |load: &Load| Thrust::of(load, &centroid, barrier);
            let accounted = Accounted::of(b, world);
            let before = std::mem::replace(&mut state.accounted[k], accounted);
            let [solid, fluid] = accounted.since(&before).map(|load| thrust(&load));
            // in a step of the water blocks take many, whose peaks the force after the last one misses
            let [solid_now, fluid_now] = match self.has_water && 0.0 < dt {
                true => [solid, fluid].map(|impulse| impulse.times(1.0 / dt)),
                false => [
                    thrust(&world.blocks.contact_force(b)),
                    thrust(&world.fluid_load(b)),
                ],
            };
            let impulses = [solid, fluid, solid.plus(fluid)];
            let now = [solid_now, fluid_now, solid_now.plus(fluid_now)];
            for kind in 0..KINDS.len() {
                state.tracks[1 + k][kind].book(impulses[kind], now[kind], flow);
                whole[0][kind] = whole[0][kind].plus(impulses[kind]);
                whole[1][kind] = whole[1][kind].plus(now[kind]);
            }
        }
        let [impulses, now] = whole;
        for kind in 0..KINDS.len() {
            state.tracks[0][kind].book(impulses[kind], now[kind], flow);
            let is_new = state.peak[kind].update(now[kind].force.norm(), time);
            state.has_new_peak |= is_new && kind + 1 == KINDS.len();
        }
    }

    /// Writes a row of each table.
    fn row(&mut self, world: &World) -> Result<(), ObserveError> {
        let Self { barrier, state, .. } = self;
        let time = world.time();
        let over = time - state.row_time.unwrap_or(time);
        state.row_time = Some(time);
        let n_kinds = n_kinds(self.has_water);
        let flow = barrier.axes[0];
        state.flow = state.passed.look(barrier, world);
        if std::mem::take(&mut state.has_new_peak) {
            state.at_peak = state.flow.reach;
        }
        let mut row = vec![time];
        for (body, tracks) in state.tracks.iter_mut().enumerate() {
            for (kind, track) in tracks.iter_mut().enumerate().take(n_kinds) {
                row.extend(track.row(over, &flow).as_flattened());
                if body == 0 {
                    if let Some(local) = state.local.get_mut(kind) {
                        let [largest, integral] = std::mem::take(local);
                        let mean = if 0.0 < over { integral / over } else { largest };
                        row.extend([mean, largest]);
                    }
                    row.push(track.impulse.force.dot(&flow));
                }
            }
        }
        let (passed, reach) = (&state.passed, state.flow.reach);
        row.extend([passed.mass, passed.number as f64, state.flow.kinetic[0]]);
        if self.has_water {
            row.extend([passed.water, state.flow.kinetic[1]]);
        }
        row.extend([reach.speed, reach.depth]);
        let cells: Vec<Cell> = row.into_iter().map(Cell::Number).collect();
        self.table.cells(&cells)?;
        let is_old = |at: Option<&(f64, _)>| at.is_some_and(|at| at.0 <= time - REST);
        while is_old(state.rows.get(1)) {
            state.rows.pop_front();
        }
        let impulses = [0, 1, 2].map(|kind| state.tracks[0][kind].impulse);
        state.rows.push_back((time, impulses));
        self.write_slices(world)
    }

    fn write_slices(&mut self, world: &World) -> Result<(), ObserveError> {
        let Some(table) = &mut self.clogging else {
            return Ok(());
        };
        let openings = self.barrier.openings.iter().zip(&mut self.state.slices);
        for (number, (opening, slices)) in openings.enumerate() {
            clogging::update(slices, (&self.barrier, opening), world);
            let [floor, top] = opening.height;
            let height = (top - floor) / SLICES as f64;
            let arch = clogging::arch(slices, opening, self.barrier.mean_diameter()).0;
            for (k, slice) in slices.iter().enumerate() {
                table.cells(&[
                    Cell::Number(world.time()),
                    Cell::Whole(number + 1),
                    Cell::Whole(k + 1),
                    Cell::Number(k as f64 * height),
                    Cell::Number((k + 1) as f64 * height),
                    Cell::Whole(slice.bodies),
                    Cell::Number(slice.kinetic),
                    Cell::Number(slice.gap),
                    Cell::Number(slice.stopped().unwrap_or(f64::NAN)),
                    Cell::Number(arch),
                ])?;
            }
        }
        Ok(())
    }
}

/// Number of sources with columns.
fn n_kinds(has_water: bool) -> usize {
    if has_water { KINDS.len() } else { 1 }
}

fn columns(barrier: &Barrier, has_water: bool) -> Vec<Column> {
    let mut columns = vec![Column::new("time", "s")];
    let names = barrier.block_names.iter().map(|name| format!("{name}."));
    for (body, prefix) in std::iter::once(String::new()).chain(names).enumerate() {
        for (kind, source) in KINDS.iter().enumerate().take(n_kinds(has_water)) {
            let mut push = |what: &str, unit: &'static str| {
                columns.push(Column::new(format!("{prefix}{source}.{what}"), unit));
            };
            for (component, unit) in COMPONENTS {
                push(component, unit);
            }
            for (component, unit) in COMPONENTS {
                push(&format!("largest_{component}"), unit);
            }
            if body == 0 {
                if kind < 2 {
                    push("local", "N");
                    push("largest_local", "N");
                }
                push("impulse", "N s");
            }
        }
    }
    let mut push = |name: &str, unit: &'static str| columns.push(Column::new(name, unit));
    push("passed.mass", "kg");
    push("passed.number", "-");
    push("downstream.kinetic", "J");
    if has_water {
        push("passed.water_volume", "m³");
        push("downstream.water_kinetic", "J");
    }
    push("upstream.speed", "m/s");
    push("upstream.depth", "m");
    columns
}

fn clogging_columns() -> [Column; 10] {
    [
        Column::new("time", "s"),
        Column::new("opening", "-"),
        Column::new("slice", "-"),
        Column::new("bottom", "m"),
        Column::new("top", "m"),
        Column::new("bodies", "-"),
        Column::new("kinetic", "J"),
        Column::new("gap", "m"),
        Column::new("stopped", "s"),
        Column::new("arch_height", "m"),
    ]
}

impl Observer for Barriers {
    fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    /// After every step: the largest force may be between two rows.
    fn is_due(&self, _: &World) -> bool {
        true
    }

    fn observe(&mut self, world: &World) -> Result<(), ObserveError> {
        let has_row = self.schedule.is_due(world.time());
        for record in &mut self.records {
            record.step(world);
            if has_row {
                record.row(world)?;
            }
        }
        if has_row {
            self.schedule.done(world.time());
        }
        Ok(())
    }

    fn save(&self, out: Vec<u8>) -> Saved {
        let of_record = |record: &Record| {
            let clogging = record.clogging.as_ref().map(Table::length);
            (record.table.length(), clogging)
        };
        let lengths: Vec<_> = self.records.iter().map(of_record).collect();
        let states: Vec<&State> = self.records.iter().map(|record| &record.state).collect();
        postcard::to_extend(&(self.schedule, lengths, states), out)
    }

    fn sync(&mut self) -> Result<(), ObserveError> {
        for record in &self.records {
            record.table.sync()?;
            if let Some(table) = &record.clogging {
                table.sync()?;
            }
        }
        Ok(())
    }

    fn read<'a>(&mut self, bytes: &'a [u8]) -> Result<&'a [u8], ObserveError> {
        type Saved = (Schedule, Vec<(u64, Option<u64>)>, Vec<State>);
        let ((schedule, lengths, states), rest): (Saved, _) = postcard::take_from_bytes(bytes)?;
        self.schedule.resume(schedule);
        let saved = lengths.into_iter().zip(states);
        for (record, ((length, clogging), state)) in self.records.iter_mut().zip(saved) {
            record.table.cut(length)?;
            if let (Some(table), Some(length)) = (&mut record.clogging, clogging) {
                table.cut(length)?;
            }
            record.state = state;
        }
        Ok(rest)
    }
}
