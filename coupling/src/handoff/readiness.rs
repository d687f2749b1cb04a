//! The instant of a hand-off: once the rock no longer drives the water, and before an absorber takes the crest.

use serde::{Deserialize, Serialize};

use super::columns::{Raster, Water, volumes};
use crate::scene::resolve::Scene;

/// Power of the blocks on the water over the largest one so far, below which the wave is made.
const POWER: f64 = 0.01;
/// Mean elevation in front of an absorber over the largest of such means, from which the leading wave is there.
const FRONT: f64 = 0.25;
/// Cells in front of an absorber that the wave must not reach.
const AHEAD: usize = 2;
/// Depth at the start from which a cell is one of open water; × particle spacing.
const OPEN: f64 = 3.0;

/// Why the water was handed over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Reason {
    /// At a time given.
    Given,
    /// The blocks give the water less than a hundredth of the largest power.
    PowerSpent,
    /// The leading wave is about to get into an absorbing layer.
    WaveAtAbsorber,
    /// The run ended before either.
    EndOfRun,
}

/// Observation of the water until it is to be handed over.
#[derive(Clone, Debug)]
pub struct Readiness {
    raster: Raster,
    /// Volume of each cell at the start; m³.
    at_start: Vec<f64>,
    /// Cells of open water outside of absorbers.
    open: Vec<usize>,
    /// Of each absorber, the rows of these cells across its direction by their distance from it.
    rows: Vec<Vec<Vec<usize>>>,
    /// The part that changes.
    pub state: State,
}

/// Power so far.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct State {
    /// Time (s) and work on the water (J) of the last look.
    last: Option<(f64, f64)>,
    /// Mean power since the look before; W.
    pub power: f64,
    /// Largest power so far; W.
    pub largest_power: f64,
    /// Largest elevation of open water, and the largest mean over a row of cells in front of an absorber, of the last look; m.
    pub crests: [f64; 2],
}

/// Whether a place is in an absorbing layer.
pub fn is_absorbing(scene: &Scene, [x, y]: [f64; 2]) -> bool {
    let absorbers = scene.fluid.iter().flat_map(|fluid| &fluid.absorbers);
    absorbers
        .into_iter()
        .any(|a| (a.min.x..=a.max.x).contains(&x) && (a.min.y..=a.max.y).contains(&y))
}

impl Readiness {
    /// Observation of water as it is at the start.
    pub fn new(scene: &Scene, raster: Raster, water: Water) -> Self {
        let at_start = volumes(raster, water);
        let deep = OPEN * water.spacing * raster.area();
        let in_layer: Vec<bool> = (0..raster.n_cells())
            .map(|cell| is_absorbing(scene, raster.center(cell)))
            .collect();
        let open: Vec<usize> = (0..raster.n_cells())
            .filter(|&cell| deep <= at_start[cell] && !in_layer[cell])
            .collect();
        let absorbers = scene.fluid.iter().flat_map(|fluid| &fluid.absorbers);
        let rows = absorbers.filter(|a| a.axis < 2).map(|absorber| {
            let axis = absorber.axis;
            let mut rows = vec![Vec::new(); raster.n[axis]];
            for &cell in &open {
                let x = raster.center(cell)[axis];
                let way = if absorber.upward {
                    absorber.min[axis] - x
                } else {
                    x - absorber.max[axis]
                };
                if let Some(row) = rows.get_mut((way / raster.side[axis]) as usize)
                    && 0.0 <= way
                {
                    row.push(cell);
                }
            }
            rows.retain(|row| !row.is_empty());
            rows
        });
        Self {
            rows: rows.collect(),
            open,
            raster,
            at_start,
            state: State::default(),
        }
    }

    /// Looks at the water at a time (s), after blocks have done work on it (J); a reason to hand it over now.
    pub fn look(&mut self, water: Water, (time, work): (f64, f64)) -> Option<Reason> {
        let now = volumes(self.raster, water);
        let rise = |&cell: &usize| (now[cell] - self.at_start[cell]) / self.raster.area();
        let crest = self.open.iter().map(rise).fold(0.0, f64::max);
        let mut ahead: f64 = 0.0;
        let mut is_at_absorber = false;
        for rows in &self.rows {
            // the mean over a row has none of the noise of single cells
            let means = rows.iter();
            let means: Vec<f64> = means
                .map(|row| row.iter().map(rise).sum::<f64>() / row.len() as f64)
                .collect();
            let largest = |of: &[f64]| of.iter().copied().fold(0.0, f64::max);
            let in_front = largest(&means[..AHEAD.min(means.len())]);
            ahead = ahead.max(in_front);
            is_at_absorber |= 0.0 < in_front && FRONT * largest(&means) <= in_front;
        }
        let state = &mut self.state;
        state.crests = [crest, ahead];
        if let Some((before, work_before)) = state.last
            && before < time
        {
            state.power = (work - work_before) / (time - before);
            state.largest_power = state.largest_power.max(state.power);
        }
        state.last = Some((time, work));
        let is_wave = 0.5 * water.spacing < crest;
        match () {
            () if !is_wave => None,
            () if is_at_absorber => Some(Reason::WaveAtAbsorber),
            () if 0.0 < state.largest_power && state.power < POWER * state.largest_power => {
                Some(Reason::PowerSpent)
            }
            () => None,
        }
    }
}
