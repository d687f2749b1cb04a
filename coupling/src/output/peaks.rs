//! Peaks of gauges: the largest value, its time, and the arrival of the wave.

use std::path::Path;

use serde::Serialize;

use crate::files::table::read_table;
use crate::output::observe::ObserveError;
use crate::output::observe::gauges::Gauges;
use crate::output::run_folder;
use crate::scene::resolve::Scene;
use crate::scene::resolved::recording::NOTICED_RISE;

/// Peak of a gauge over a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Peak {
    /// Name of the gauge.
    pub name: String,
    /// Unit of its values.
    pub unit: String,
    /// Value at the start; `None` if dry.
    pub start: Option<f64>,
    /// Largest value; `None` if always dry.
    pub largest: Option<f64>,
    /// Its time; s.
    pub time: Option<f64>,
    /// Time at which a surface has changed since the start as maps count it; `None` for other gauges, and where no wave came; s.
    pub arrival: Option<f64>,
}

impl Peak {
    /// Peak of a record of times (s) and values, with the change that counts as arrival.
    pub fn of(name: &str, unit: &str, record: (&[f64], &[f64]), threshold: Option<f64>) -> Self {
        let (times, values) = record;
        let rows = || times.iter().copied().zip(values.iter().copied());
        let known = || rows().filter(|(_, value)| value.is_finite());
        let start = values.first().copied().filter(|value| value.is_finite());
        // the first of equal ones
        let largest = known().reduce(|most, row| if most.1 < row.1 { row } else { most });
        let has_come = |value: f64, threshold: f64| match start {
            Some(start) => threshold < (value - start).abs(),
            None => true,
        };
        let arrival =
            threshold.and_then(|threshold| known().find(|(_, value)| has_come(*value, threshold)));
        Self {
            name: name.to_owned(),
            unit: unit.to_owned(),
            start,
            largest: largest.map(|(_, value)| value),
            time: largest.map(|(time, _)| time),
            arrival: arrival.map(|(time, _)| time),
        }
    }
}

/// Peaks of the gauges with one column, from the table of a run.
///
/// # Errors
///
/// [`ObserveError`] names the table.
pub fn peaks(folder: &Path, scene: &Scene) -> Result<Vec<Peak>, ObserveError> {
    let columns = Gauges::scalar_columns(scene);
    if columns.is_empty() {
        return Ok(Vec::new());
    }
    let table = read_table(&folder.join(run_folder::GAUGES))?;
    let noticed = noticed(scene);
    let peaks = columns.iter().filter_map(|(place, name, unit)| {
        let record = (
            table.values.first()?.as_slice(),
            table.values.get(*place)?.as_slice(),
        );
        // gauges in meters are those of the surface
        let threshold = noticed.filter(|_| unit == "m");
        Some(Peak::of(name, unit, record, threshold))
    });
    Ok(peaks.collect())
}

/// Change of a surface that counts as arrival: that of the maps, a quarter of a particle spacing without maps; m.
pub fn noticed(scene: &Scene) -> Option<f64> {
    let spacing = scene.fluid.as_ref()?.walls.particle_spacing;
    let of_maps = scene.maps.as_ref().map(|maps| maps.arrival_threshold);
    Some(of_maps.unwrap_or(NOTICED_RISE * spacing))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAN: f64 = f64::NAN;

    #[test]
    fn a_peak_is_the_first_of_the_largest_values() {
        let times = [0.0, 1.0, 2.0, 3.0, 4.0];
        let peak = |values: &[f64; 5]| Peak::of("g", "m", (&times, values), Some(0.5));
        let wave = peak(&[10.0, 10.4, 11.0, 12.0, 12.0]);
        assert_eq!(
            (wave.start, wave.largest, wave.time, wave.arrival),
            (Some(10.0), Some(12.0), Some(3.0), Some(2.0))
        );
        // a trough comes, too
        assert_eq!(peak(&[10.0, 9.4, 11.0, NAN, 10.0]).arrival, Some(1.0));
        // dry land is reached when it is wet
        let shore = peak(&[NAN, NAN, 3.0, 2.0, NAN]);
        assert_eq!(
            (shore.start, shore.largest, shore.time, shore.arrival),
            (None, Some(3.0), Some(2.0), Some(2.0))
        );
        let dry = peak(&[NAN; 5]);
        assert_eq!((dry.largest, dry.time, dry.arrival), (None, None, None));
        let still = peak(&[10.0, 10.1, 9.9, 10.0, 10.2]);
        assert_eq!((still.time, still.arrival), (Some(4.0), None));
        assert_eq!(
            Peak::of("p", "Pa", (&times, &[0.0, 9.0, 0.0, 0.0, 0.0]), None).arrival,
            None
        );
    }
}
