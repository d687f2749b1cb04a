//! Gauges as in a laboratory: free surface, pressure, velocity, force, motion of points, run-up, displaced blocks.

mod present;

use std::collections::BTreeMap;
use std::path::Path;

use rayon::prelude::*;
use riprap_dda::{Blocks, SurfacePoint};
use riprap_sph::{Dimensions, Fluid, Vec3};

use super::block_force::{BlockForce, Impulse};
use super::crossing::Crossing;
use super::point_motion::PointMotion;
use super::transducer::{Readings, Transducer};
use super::{ObserveError, Observer, Schedule};
use crate::files::table::{Column, Start, Table};
use crate::output::run_folder;
use crate::saved::Saved;
use crate::scene::resolve::Scene;
use crate::scene::resolved::recording::{Gauge, PlanLine, Quantity};
use crate::world::World;
pub use present::{PresentGauges, Reading};

/// Distance from the ground, in spacings, within which water touches it.
const TOUCHING_DISTANCE: f64 = 1.5;
/// Smallest vertical component of the normal of a face that counts as ground.
const GROUND_SLOPE: f64 = 0.05;

/// Writes `gauges.csv`.
#[derive(Debug)]
pub struct Gauges {
    schedule: Schedule,
    table: Table,
    /// Names of the gauges.
    names: Vec<String>,
    instruments: Vec<Instrument>,
    /// Between rows; s.
    interval: f64,
    row: Vec<f64>,
}

/// A gauge with the state it needs.
#[derive(Clone, Debug)]
enum Instrument {
    SurfaceElevation {
        x: f64,
        y: f64,
    },
    Pressure(Transducer),
    Velocity(Vec3),
    BlockForce(BlockForce),
    PointMotion(PointMotion),
    RunUp(RunUp),
    Front(Line),
    Overtopping(Crossing),
    Displaced {
        starts: Vec<(usize, Vec3)>,
        farther_than: f64,
    },
}

/// Highest wetted point along a line, on ground or up a wall.
///
/// The outermost particle lies inside of the water's edge, by up to a spacing in still water. The gauge takes the level of still water
/// for its reading at t = 0 if it is that close, and adds the difference to all readings.
#[derive(Clone, Debug)]
struct RunUp {
    line: Line,
    /// Still-water level, NaN without; m.
    level: f64,
    /// Added to readings; `None` before the first; m.
    raise: Option<f64>,
}

impl RunUp {
    /// Elevation of the water's edge, NaN if the line is dry; m.
    fn read(&mut self, fluid: Option<&Fluid>, world: &World) -> f64 {
        // on a wall the water itself tells its height
        let reading = farthest(fluid, &world.blocks, &self.line, |surface, water| {
            if is_ground(surface) {
                Some(surface.point.z)
            } else {
                (-GROUND_SLOPE < surface.normal.z).then_some(water.z)
            }
        });
        let raise = *self.raise.get_or_insert_with(|| {
            let close = TOUCHING_DISTANCE * fluid.map_or(0.0, spacing);
            let raise = self.level - reading;
            // what was at rest was so at the start
            if world.time() <= 0.0 && raise.abs() <= close {
                raise
            } else {
                0.0
            }
        });
        reading + raise
    }
}

impl Gauges {
    /// A table in `folder` with the columns of the scene's gauges; blocks are at their initial positions.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] when the table cannot be created.
    pub fn new(
        folder: &Path,
        scene: &Scene,
        world: &World,
        start: Start,
    ) -> Result<Self, ObserveError> {
        let mut columns = vec![Column::new("time", "s")];
        for gauge in &scene.gauges {
            columns.extend(columns_of(gauge));
        }
        let interval = scene.output.gauge_interval;
        Ok(Self {
            schedule: Schedule::every(interval),
            interval,
            table: Table::open(&folder.join(run_folder::GAUGES), &columns, start)?,
            names: scene.gauges.iter().map(|g| g.name.clone()).collect(),
            instruments: (scene.gauges.iter())
                .map(|gauge| instrument(gauge, scene, &world.blocks))
                .collect(),
            row: Vec::with_capacity(columns.len()),
        })
    }

    /// Columns of the scalar gauges and their units, with their indices in the row; for plots.
    pub fn scalar_columns(scene: &Scene) -> Vec<(usize, String, String)> {
        let mut place = 1;
        let mut scalars = Vec::new();
        for gauge in &scene.gauges {
            let columns = columns_of(gauge);
            if let [column] = columns.as_slice() {
                scalars.push((place, column.name.clone(), column.unit.clone()));
            }
            place += columns.len();
        }
        scalars
    }

    fn record(&mut self, world: &World) -> Result<(), ObserveError> {
        self.row.clear();
        self.row.push(world.time());
        for instrument in &mut self.instruments {
            instrument.read(world, self.interval, &mut self.row);
        }
        self.table.row(&self.row)?;
        self.schedule.done(world.time());
        Ok(())
    }

    /// Transducers read within their averaging time.
    fn listen(&mut self, world: &World) {
        let (time, due) = (world.time(), self.schedule.next_due());
        let fluid = world.water.as_ref().map(|water| &water.fluid);
        for instrument in &mut self.instruments {
            if let Instrument::Pressure(transducer) = instrument
                && transducer.is_listening(time, due)
            {
                transducer.listen(fluid, time);
            }
        }
    }

    fn transducers(&self) -> impl Iterator<Item = &Transducer> {
        self.instruments
            .iter()
            .filter_map(|instrument| match instrument {
                Instrument::Pressure(transducer) => Some(transducer),
                _ => None,
            })
    }
}

impl Observer for Gauges {
    fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    fn is_due(&self, world: &World) -> bool {
        let (time, due) = (world.time(), self.schedule.next_due());
        self.schedule.is_due(time) || self.transducers().any(|t| t.is_listening(time, due))
    }

    fn observe(&mut self, world: &World) -> Result<(), ObserveError> {
        if !self.schedule.is_due(world.time()) {
            self.listen(world);
            return Ok(());
        }
        self.record(world)
    }

    fn observe_last(&mut self, world: &World) -> Result<(), ObserveError> {
        match self.schedule.last() {
            Some(time) if time == world.time() => Ok(()),
            _ => self.record(world),
        }
    }

    fn save(&self, out: Vec<u8>) -> Saved {
        let instruments = self.names.iter().zip(&self.instruments);
        let crossings: BTreeMap<&String, &Crossing> = instruments
            .filter_map(|(name, instrument)| Some((name, instrument.crossing()?)))
            .collect();
        let instruments = self.names.iter().zip(&self.instruments);
        let raises: BTreeMap<&String, f64> = instruments
            .filter_map(|(name, instrument)| Some((name, instrument.raise()?)))
            .collect();
        let instruments = self.names.iter().zip(&self.instruments);
        let readings: BTreeMap<&String, &Readings> = instruments
            .filter_map(|(name, instrument)| Some((name, instrument.readings()?)))
            .collect();
        let instruments = self.names.iter().zip(&self.instruments);
        let impulses: BTreeMap<&String, &Impulse> = instruments
            .filter_map(|(name, instrument)| Some((name, instrument.impulse()?)))
            .collect();
        let table = (self.table.headers(), self.table.length());
        let memories = (crossings, raises, readings, impulses);
        postcard::to_extend(&(self.schedule, table, memories), out)
    }

    fn sync(&mut self) -> Result<(), ObserveError> {
        self.table.sync()?;
        Ok(())
    }

    fn read<'a>(&mut self, bytes: &'a [u8]) -> Result<&'a [u8], ObserveError> {
        let (schedule, headers, length, rest): (Schedule, Vec<String>, _, _);
        let mut crossings: BTreeMap<String, Crossing>;
        let raises: BTreeMap<String, f64>;
        let mut readings: BTreeMap<String, Readings>;
        let mut impulses: BTreeMap<String, Impulse>;
        (
            (
                schedule,
                (headers, length),
                (crossings, raises, readings, impulses),
            ),
            rest,
        ) = postcard::take_from_bytes(bytes)?;
        self.schedule.resume(schedule);
        if headers == self.table.headers() {
            self.table.cut(length)?;
        } else {
            // taken further with more gauges
            let last = schedule.last().unwrap_or(f64::NEG_INFINITY);
            self.table.take_over(last)?;
        }
        for (name, instrument) in self.names.iter().zip(&mut self.instruments) {
            match instrument {
                Instrument::Overtopping(crossing) => {
                    if let Some(saved) = crossings.remove(name) {
                        *crossing = saved;
                    }
                }
                Instrument::RunUp(run_up) => run_up.raise = raises.get(name).copied(),
                Instrument::Pressure(transducer) => {
                    transducer.readings = readings.remove(name).unwrap_or_default();
                }
                Instrument::BlockForce(force) => force.before = impulses.remove(name),
                _ => {}
            }
        }
        Ok(rest)
    }
}

fn columns_of(Gauge { name, quantity }: &Gauge) -> Vec<Column> {
    match quantity {
        Quantity::SurfaceElevation { .. } | Quantity::RunUp(_) | Quantity::Front(_) => {
            vec![Column::new(name, "m")]
        }
        Quantity::Pressure(_) => vec![Column::new(name, "Pa")],
        Quantity::Displaced { .. } => vec![Column::new(name, "-")],
        Quantity::Overtopping(_) => vec![
            Column::new(format!("{name}.volume"), "m3"),
            Column::new(format!("{name}.discharge"), "m3/s"),
        ],
        Quantity::Velocity { .. } => ["vx", "vy", "vz"]
            .map(|c| Column::new(format!("{name}.{c}"), "m/s"))
            .to_vec(),
        Quantity::PointMotion { .. } => [
            ["x", "y", "z"].map(|c| (c, "m")),
            ["ux", "uy", "uz"].map(|c| (c, "m")),
            ["vx", "vy", "vz"].map(|c| (c, "m/s")),
        ]
        .iter()
        .flatten()
        .map(|(c, unit)| Column::new(format!("{name}.{c}"), *unit))
        .collect(),
        Quantity::BlockForce { .. } => ["fluid", "contact"]
            .iter()
            .flat_map(|source| {
                [
                    ("fx", "N"),
                    ("fy", "N"),
                    ("fz", "N"),
                    ("mx", "N m"),
                    ("my", "N m"),
                    ("mz", "N m"),
                ]
                .map(|(c, unit)| Column::new(format!("{name}.{source}_{c}"), unit))
            })
            .collect(),
    }
}

/// The instrument of a gauge on blocks at their initial positions.
fn instrument(gauge: &Gauge, scene: &Scene, blocks: &Blocks) -> Instrument {
    let fluid = scene.fluid.as_ref();
    match &gauge.quantity {
        Quantity::SurfaceElevation { x, y } => Instrument::SurfaceElevation { x: *x, y: *y },
        Quantity::Pressure(gauge) => Instrument::Pressure(Transducer::new(gauge, blocks)),
        Quantity::Velocity { position } => Instrument::Velocity(*position),
        Quantity::BlockForce { block } => Instrument::BlockForce(BlockForce::new(*block)),
        Quantity::PointMotion { block, point } => {
            Instrument::PointMotion(match &scene.settle_blocks {
                None => PointMotion::new(*block, *point, blocks),
                Some(_) => PointMotion::of_drawn(*block, *point, blocks),
            })
        }
        Quantity::RunUp(line) => Instrument::RunUp(RunUp {
            line: Line::along(*line),
            level: fluid.map_or(f64::NAN, |fluid| fluid.lattice.still_water_level),
            raise: None,
        }),
        Quantity::Front(line) => Instrument::Front(Line::along(*line)),
        Quantity::Overtopping(line) => Instrument::Overtopping(Crossing::of(*line)),
        Quantity::Displaced {
            blocks: watched,
            farther_than,
        } => Instrument::Displaced {
            starts: watched.iter().map(|&b| (b, blocks.centroid(b))).collect(),
            farther_than: *farther_than,
        },
    }
}

impl Instrument {
    fn crossing(&self) -> Option<&Crossing> {
        match self {
            Self::Overtopping(crossing) => Some(crossing),
            _ => None,
        }
    }

    fn readings(&self) -> Option<&Readings> {
        match self {
            Self::Pressure(transducer) => Some(&transducer.readings),
            _ => None,
        }
    }

    fn impulse(&self) -> Option<&Impulse> {
        match self {
            Self::BlockForce(force) => force.before.as_ref(),
            _ => None,
        }
    }

    fn raise(&self) -> Option<f64> {
        match self {
            Self::RunUp(run_up) => run_up.raise,
            _ => None,
        }
    }

    /// Appends the reading of the gauge; NaN when dry.
    fn read(&mut self, world: &World, interval: f64, row: &mut Vec<f64>) {
        let fluid = world.water.as_ref().map(|water| &water.fluid);
        match self {
            Self::SurfaceElevation { x, y } => {
                let surface = fluid.and_then(|fluid| fluid.surface_elevation(*x, *y));
                row.push(surface.unwrap_or(f64::NAN));
            }
            Self::Pressure(transducer) => row.push(transducer.mean(fluid, world.time())),
            Self::Velocity(point) => {
                let sample = fluid.and_then(|fluid| fluid.sample(point));
                let velocity = sample.map_or(Vec3::repeat(f64::NAN), |s| s.velocity);
                row.extend(velocity.iter());
            }
            Self::BlockForce(force) => {
                for load in force.read(world) {
                    row.extend(load.force.iter());
                    row.extend(load.torque.iter());
                }
            }
            Self::PointMotion(point) => {
                let motion = point.read(&world.blocks);
                row.extend(motion.iter().flatten());
            }
            Self::RunUp(run_up) => row.push(run_up.read(fluid, world)),
            Self::Front(line) => {
                row.push(farthest(fluid, &world.blocks, line, |surface, water| {
                    let way = line.share([water.x, water.y]) * line.length();
                    is_ground(surface).then_some(way)
                }))
            }
            Self::Overtopping(crossing) => {
                let passed = fluid.map_or([f64::NAN; 2], |fluid| {
                    crossing.update(fluid, world.time(), interval)
                });
                row.extend(passed);
            }
            Self::Displaced {
                starts,
                farther_than,
            } => {
                let blocks = &world.blocks;
                let is_displaced = |&&(b, start): &&(usize, Vec3)| {
                    blocks.is_removed(b) || *farther_than < (blocks.centroid(b) - start).norm()
                };
                row.push(starts.iter().filter(is_displaced).count() as f64);
            }
        }
    }
}

/// A line in plan view between two points; m.
#[derive(Clone, Copy, Debug)]
struct Line {
    from: [f64; 2],
    along: [f64; 2],
}

impl Line {
    fn along(PlanLine { from, to }: PlanLine) -> Self {
        Self {
            from,
            along: [to[0] - from[0], to[1] - from[1]],
        }
    }

    fn length(&self) -> f64 {
        self.along[0].hypot(self.along[1])
    }

    /// Relative position along it of the nearest point.
    fn share(&self, point: [f64; 2]) -> f64 {
        let offset = [point[0] - self.from[0], point[1] - self.from[1]];
        let length2 = self.length().powi(2);
        if length2 > 0.0 {
            let along = offset[0] * self.along[0] + offset[1] * self.along[1];
            (along / length2).clamp(0.0, 1.0)
        } else {
            0.0
        }
    }

    /// m.
    fn distance(&self, point: [f64; 2]) -> f64 {
        let share = self.share(point);
        let at = |axis: usize| self.from[axis] + share * self.along[axis];
        (point[0] - at(0)).hypot(point[1] - at(1))
    }
}

/// Particle spacing; m.
fn spacing(fluid: &Fluid) -> f64 {
    let [dx, dy, dz] = fluid.settings().particle_spacing;
    match fluid.settings().dimensions {
        Dimensions::Three => (dx * dy * dz).cbrt(),
        // the width of the slice does not matter
        Dimensions::Two { .. } => (dx * dz).sqrt(),
    }
}

/// Particles that one thread looks at.
const AT_ONCE: usize = 1024;

/// Largest value of a function over the wetted surfaces near a line; NaN if all is dry.
///
/// Water touches a fixed surface where a particle within a spacing of the line is within 1.5 spacings of it; `measure` takes
/// the nearest point of the surface and the particle, and gives nothing for a surface that does not count. A particle without
/// another one beside it is a drop, which reaches nothing.
fn farthest(
    fluid: Option<&Fluid>,
    blocks: &Blocks,
    line: &Line,
    measure: impl Fn(&SurfacePoint, &Vec3) -> Option<f64> + Sync,
) -> f64 {
    let Some(fluid) = fluid else { return f64::NAN };
    let spacing = spacing(fluid);
    let reach = TOUCHING_DISTANCE * spacing;
    let ground: Vec<usize> = blocks.fixed_parts().collect();
    let touch = |x: &Vec3| {
        let values = ground.iter().filter_map(|&part| {
            let surface = blocks.surface_point_within(part, x, reach)?;
            measure(&surface, x)
        });
        values.reduce(f64::max).map(|value| (value, *x))
    };
    let positions = fluid.particles().position.par_iter().with_min_len(AT_ONCE);
    let beside = positions.filter(|x| line.distance([x.x, x.y]) <= spacing);
    let mut touching: Vec<(f64, Vec3)> = beside.filter_map(touch).collect();
    touching.sort_by(|a, b| b.0.total_cmp(&a.0));
    let has_company = |&(k, (_, x)): &(usize, &(f64, Vec3))| {
        let others = touching.iter().enumerate();
        (others.filter(|(other, _)| *other != k)).any(|(_, (_, y))| (y - x).norm() < reach)
    };
    let found = touching.iter().enumerate().find(has_company);
    found.map_or(f64::NAN, |(_, (value, _))| *value)
}

/// True for a surface that water runs up on and not under.
fn is_ground(surface: &SurfacePoint) -> bool {
    GROUND_SLOPE < surface.normal.z
}
