//! Gauges read when asked for, without a table.

use super::{Instrument, columns_of, instrument};
use crate::files::table::Column;
use crate::output::observe::Schedule;
use crate::scene::resolve::Scene;
use crate::world::World;

/// Gauges of a scene at the present state of its world.
///
/// Pressures and forces are those of the moment, not means. Run-up keeps its correction of t = 0, and overtopping is
/// sampled at the interval of the gauges.
#[derive(Debug)]
pub struct PresentGauges {
    gauges: Vec<PresentGauge>,
    schedule: Schedule,
    /// Between two samples; s.
    interval: f64,
}

#[derive(Debug)]
struct PresentGauge {
    name: String,
    columns: Vec<Column>,
    instrument: Instrument,
    /// Of a gauge that needs all samples, the last one.
    sample: Vec<f64>,
}

/// Reading of a gauge.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Name of the gauge.
    pub name: String,
    /// Its columns, as in `gauges.csv`.
    pub columns: Vec<Column>,
    /// A value per column; NaN when dry.
    pub values: Vec<f64>,
}

impl PresentGauges {
    /// The gauges of a scene, on blocks at their initial positions.
    pub fn new(scene: &Scene, world: &World) -> Self {
        let gauges = scene.gauges.iter().map(|gauge| PresentGauge {
            name: gauge.name.clone(),
            columns: columns_of(gauge),
            instrument: instrument(gauge, scene, &world.blocks),
            sample: Vec::new(),
        });
        let interval = scene.output.gauge_interval;
        Self {
            gauges: gauges.collect(),
            schedule: Schedule::every(interval),
            interval,
        }
    }

    /// Names of the gauges.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.gauges.iter().map(|gauge| gauge.name.as_str())
    }

    /// Takes the samples that are due; to be called at t = 0 and after every step.
    pub fn follow(&mut self, world: &World) {
        if !self.schedule.is_due(world.time()) {
            return;
        }
        for gauge in &mut self.gauges {
            let needs_it = match &gauge.instrument {
                Instrument::Overtopping(_) => true,
                Instrument::RunUp(run_up) => run_up.raise.is_none(),
                _ => false,
            };
            if needs_it {
                gauge.sample.clear();
                gauge
                    .instrument
                    .read(world, self.interval, &mut gauge.sample);
            }
        }
        self.schedule.done(world.time());
    }

    /// Reading of a gauge, if there is one of this name.
    pub fn read(&self, name: &str, world: &World) -> Option<Reading> {
        let gauge = self.gauges.iter().find(|gauge| gauge.name == name)?;
        let values = match &gauge.instrument {
            Instrument::Overtopping(_) if gauge.sample.is_empty() => vec![0.0; gauge.columns.len()],
            Instrument::Overtopping(_) => gauge.sample.clone(),
            other => {
                let mut values = Vec::with_capacity(gauge.columns.len());
                // a copy, whose memory of this reading makes no mean of the next one
                other.clone().read(world, self.interval, &mut values);
                values
            }
        };
        Some(Reading {
            name: gauge.name.clone(),
            columns: gauge.columns.clone(),
            values,
        })
    }
}
