//! Results of a barrier for the summary of a run.

use serde::Serialize;

use super::clogging::{self, OpeningResult};
use super::flow::Reach;
use super::forces::{KINDS, Thrust};
use super::{REST, Record};

/// Results of a barrier at the end of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BarrierResult {
    /// Name of the barrier.
    pub name: String,
    /// Forces of contacts.
    pub solid: LoadResult,
    /// Forces of the water; `None` without.
    pub fluid: Option<LoadResult>,
    /// Both; `None` without water. Largest loads of cells are of one of them.
    pub total: Option<LoadResult>,
    /// Bodies beyond the downstream side at any row.
    pub passed_number: usize,
    /// Their mass; kg.
    pub passed_mass: f64,
    /// Over the mass of all free blocks; `None` without any.
    pub passed_share: Option<f64>,
    /// Volume of the water that was there at any row; `None` without water; m³.
    pub passed_water_volume: Option<f64>,
    /// Kinetic energy of the bodies downstream at the last row; J.
    pub downstream_kinetic_energy: f64,
    /// Largest force over the weight of free blocks and water at the start along the flow, `F/(W sin θ)`; `None` where gravity has no part
    /// along it.
    pub largest_over_slope_weight: Option<f64>,
    /// Speed of the flow upstream at the first row after the largest force; `None` without any; m/s.
    pub speed_at_peak: Option<f64>,
    /// Its depth; m.
    pub depth_at_peak: Option<f64>,
    /// `F/(ρ g h² b)` with that depth, the width `b` and the bulk density `ρ` of the reach.
    pub static_coefficient: Option<f64>,
    /// `F/(ρ v² h b)`.
    pub dynamic_coefficient: Option<f64>,
    /// Clogging of each opening.
    pub openings: Vec<OpeningResult>,
}

/// Forces of a source on a barrier.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LoadResult {
    /// First contact with a moving body, or first wetted cell; s.
    pub first_arrival: Option<f64>,
    /// Largest resultant of a step; N.
    pub largest: f64,
    /// Its time; s.
    pub largest_time: Option<f64>,
    /// Largest resultant of a step on a cell; N.
    pub largest_local: f64,
    /// Its time; s.
    pub largest_local_time: Option<f64>,
    /// Impulse along the flow; N s.
    pub impulse: f64,
    /// Resultant of the mean force of the last second, of a shorter run all of it; N.
    pub at_rest: f64,
}

impl Record {
    fn load_result(&self, kind: usize) -> LoadResult {
        let state = &self.state;
        let impulse = state.tracks[0][kind].impulse;
        let time = state.time.unwrap_or(0.0);
        // rows of the last second and one before, or the first of a shorter run
        let is_old = |&&(at, _): &&(f64, [Thrust; 3])| at <= time - REST;
        let since = state.rows.iter().rfind(is_old).or(state.rows.front());
        let at_rest = since.filter(|(at, _)| *at < time).map(|(at, before)| {
            let gained = impulse.minus(before[kind]);
            gained.force.norm() / (time - at)
        });
        let local = match kind {
            0 | 1 => state.local_peak[kind],
            // of either, the larger one
            _ => {
                let [solid, fluid] = state.local_peak;
                if solid.value < fluid.value {
                    fluid
                } else {
                    solid
                }
            }
        };
        let [by_bodies, by_water] = state.arrival;
        let first_arrival = match kind {
            0 => by_bodies,
            1 => by_water,
            _ => by_bodies.into_iter().chain(by_water).reduce(f64::min),
        };
        LoadResult {
            first_arrival,
            largest: state.peak[kind].value,
            largest_time: state.peak[kind].time,
            largest_local: local.value,
            largest_local_time: local.time,
            impulse: impulse.force.dot(&self.barrier.axes[0]),
            at_rest: at_rest.unwrap_or_else(|| state.tracks[0][kind].now.force.norm()),
        }
    }

    /// Results so far, with the mass of the water at the start; kg.
    pub(super) fn result(&self, water: f64) -> BarrierResult {
        let Self { barrier, state, .. } = self;
        let wet = |kind| self.has_water.then(|| self.load_result(kind));
        let largest = state.peak[KINDS.len() - 1].value;
        let Reach { mass, speed, depth } = state.at_peak;
        let known = |value: f64| value.is_finite().then_some(value);
        // ρ h b L is the mass in the reach, of length L
        let per_length = largest * barrier.upstream / mass;
        let weight = barrier
            .along_flow
            .map(|gravity| gravity * (barrier.released + water));
        let weight = weight.filter(|weight| 0.0 < *weight);
        let openings = barrier.openings.iter().zip(&state.slices);
        let openings = openings.filter(|_| self.clogging.is_some());
        BarrierResult {
            name: barrier.name.clone(),
            solid: self.load_result(0),
            fluid: wet(1),
            total: wet(2),
            passed_number: state.passed.number,
            passed_mass: state.passed.mass,
            passed_share: known(state.passed.mass / state.passed.released),
            passed_water_volume: self.has_water.then_some(state.passed.water),
            downstream_kinetic_energy: state.flow.kinetic[0],
            largest_over_slope_weight: weight.map(|weight| largest / weight),
            speed_at_peak: known(speed),
            depth_at_peak: known(depth),
            static_coefficient: known(per_length / (self.gravity * depth)),
            dynamic_coefficient: known(per_length / speed.powi(2)),
            openings: openings
                .map(|(opening, slices)| {
                    clogging::result(slices, (barrier, opening), state.arrival[0])
                })
                .collect(),
        }
    }
}
