//! Clogging of the openings of a barrier, by slices over their height.
//!
//! A slice is from four mean radii before the barrier to its downstream side, as wide as the opening, a tenth of its height. It is calm
//! while it has bodies and their kinetic energy is below `1e-6 m g d` of the mean body, and clogged once that has lasted for 1 s. The arch
//! is as high as the clogged slices from the floor up without a gap, up to the highest of them that no mean body could pass straight:
//! a few bodies that lie in a wide opening close nothing.

use serde::{Deserialize, Serialize};

use crate::scene::resolved::recording::{Barrier, BarrierOpening};
use crate::world::World;

/// Slices of an opening.
pub(super) const SLICES: usize = 10;
/// Way before the barrier that belongs to an opening; × mean radius.
const REACH: f64 = 4.0;
/// Kinetic energy below which a slice is calm; × m g d.
const CALM: f64 = 1e-6;
/// Time that a slice must be calm; s.
const HOLD: f64 = 1.0;
/// Time from arrival to stop below which clogging is sudden; s.
const SUDDEN: f64 = 5.0;
/// Height of a sudden arch, at least; × height of the opening.
const HIGH: f64 = 0.7;
/// Height of a late arch, at most; × mean diameter.
const LOW: f64 = 3.0;

/// A slice of an opening. Saved in checkpoints.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Slice {
    pub bodies: usize,
    /// J.
    pub kinetic: f64,
    /// Width of the widest free way past its bodies; m.
    pub gap: f64,
    /// Time since when it is calm; s.
    calm_since: Option<f64>,
    pub is_clogged: bool,
}

impl Slice {
    /// Time at which its bodies stopped, once they are known to have; s.
    pub fn stopped(&self) -> Option<f64> {
        self.calm_since.filter(|_| self.is_clogged)
    }

    fn update(&mut self, limit: f64, time: f64) {
        let is_calm = 0 < self.bodies && self.kinetic < limit;
        self.calm_since = match self.calm_since {
            _ if !is_calm => None,
            None => Some(time),
            since => since,
        };
        self.is_clogged = self.calm_since.is_some_and(|since| HOLD <= time - since);
    }
}

/// Class of the clogging of an opening.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Clogging {
    /// Within 5 s of the first arrival, over more than 0.7 of the height.
    Sudden,
    /// In any other way.
    Progressive,
    /// At most three mean diameters high.
    Late,
    /// No arch.
    None,
}

/// Clogging of an opening at the end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OpeningResult {
    /// m.
    pub width: f64,
    /// Height of the arch above the floor of the opening; m.
    pub arch_height: f64,
    /// Time at which the last of its slices stopped; s.
    pub stop_time: Option<f64>,
    /// Its class.
    pub clogging: Clogging,
}

/// Sets the slices of an opening to the bodies that are there now.
pub(super) fn update(
    slices: &mut [Slice; SLICES],
    (barrier, opening): (&Barrier, &BarrierOpening),
    world: &World,
) {
    let Some([diameter, mass]) = barrier.grain else {
        return;
    };
    for slice in slices.iter_mut() {
        (slice.bodies, slice.kinetic) = (0, 0.0);
    }
    let mut covered: [Vec<[f64; 2]>; SLICES] = Default::default();
    let reach = 0.5 * REACH * diameter;
    let [floor, top] = opening.height;
    let height = (top - floor) / SLICES as f64;
    let blocks = &world.blocks;
    for b in (0..blocks.n_blocks()).filter(|&b| blocks.is_free(b)) {
        let [along, across, up] = barrier.coordinates(&blocks.centroid(b));
        let is_there = barrier.extent[0][0] - reach <= along && along <= barrier.extent[0][1];
        let radius = blocks.radius(b);
        let [left, right] = opening.across;
        if !is_there || across + radius < left || right < across - radius {
            continue;
        }
        // one beside the opening may cover a part of it
        let is_within = left <= across && across <= right;
        let kinetic = blocks.kinetic_energy(b);
        for (k, slice) in slices.iter_mut().enumerate() {
            let bottom = floor + k as f64 * height;
            if bottom < up + radius && up - radius < bottom + height {
                covered[k].push([across - radius, across + radius]);
                if is_within {
                    slice.bodies += 1;
                    slice.kinetic += kinetic;
                }
            }
        }
    }
    let limit = CALM * mass * world.gravity.norm() * diameter;
    for (slice, covered) in slices.iter_mut().zip(&mut covered) {
        slice.gap = widest_gap(opening.across, covered);
        slice.update(limit, world.time());
    }
}

/// Longest part of an interval that none of some others covers; sorts these.
fn widest_gap([start, end]: [f64; 2], covered: &mut [[f64; 2]]) -> f64 {
    covered.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
    let (mut gap, mut reached) = (0.0_f64, start);
    for [from, to] in covered {
        gap = gap.max(*from - reached);
        reached = reached.max(*to);
    }
    gap.max(end - reached)
}

/// Height of the arch (m) of bodies of a mean diameter (m), and the time at which it stopped (s).
pub(super) fn arch(
    slices: &[Slice; SLICES],
    opening: &BarrierOpening,
    diameter: f64,
) -> (f64, Option<f64>) {
    let calm = slices.iter().map_while(Slice::stopped).count();
    let closed = slices[..calm]
        .iter()
        .rposition(|slice| slice.gap < diameter);
    let arch = &slices[..closed.map_or(0, |k| k + 1)];
    let height = opening.height[1] - opening.height[0];
    (
        height * arch.len() as f64 / SLICES as f64,
        arch.iter().filter_map(Slice::stopped).reduce(f64::max),
    )
}

/// Clogging of an opening of a barrier that the first body reached at a time (s).
pub(super) fn result(
    slices: &[Slice; SLICES],
    (barrier, opening): (&Barrier, &BarrierOpening),
    arrival: Option<f64>,
) -> OpeningResult {
    let diameter = barrier.mean_diameter();
    let (arch_height, stop_time) = arch(slices, opening, diameter);
    let height = opening.height[1] - opening.height[0];
    let clogging = match stop_time {
        None => Clogging::None,
        Some(time) => {
            let took = time - arrival.unwrap_or(time);
            if took < SUDDEN && HIGH * height < arch_height {
                Clogging::Sudden
            } else if arch_height <= LOW * diameter {
                Clogging::Late
            } else {
                Clogging::Progressive
            }
        }
    };
    OpeningResult {
        width: opening.across[1] - opening.across[0],
        arch_height,
        stop_time,
        clogging,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPENING: BarrierOpening = BarrierOpening {
        across: [1.0, 2.0],
        height: [0.0, 1.0],
    };

    /// Slices of which so many from the floor have stopped, one after the other, with their gaps (m).
    fn slices(gaps: &[f64]) -> [Slice; SLICES] {
        std::array::from_fn(|k| Slice {
            bodies: 1,
            kinetic: 0.0,
            gap: gaps.get(k).copied().unwrap_or(1.0),
            calm_since: (k < gaps.len()).then_some(k as f64),
            is_clogged: k < gaps.len(),
        })
    }

    #[test]
    fn the_widest_free_way_is_between_bodies_or_at_a_side() {
        let gap = |mut covered: Vec<[f64; 2]>| widest_gap(OPENING.across, &mut covered);
        assert_eq!(gap(vec![]), 1.0);
        // one that stands out of the opening, and one within another
        assert_eq!(gap(vec![[1.5, 1.75], [0.5, 1.25], [1.5, 1.625]]), 0.25);
        assert_eq!(gap(vec![[1.125, 1.5]]), 0.5);
        assert_eq!(gap(vec![[1.5, 2.25], [0.875, 1.5]]), 0.0);
    }

    #[test]
    fn an_arch_ends_where_a_body_could_pass() {
        let found = |gaps: &[f64]| arch(&slices(gaps), &OPENING, 0.2);
        assert_eq!(found(&[]), (0.0, None));
        // two bodies at the sides of a wide opening
        assert_eq!(found(&[0.8, 0.9]), (0.0, None));
        assert_eq!(found(&[0.2]), (0.0, None), "as wide as a body");
        assert_eq!(found(&[0.1, 0.19, 0.5]), (0.2, Some(1.0)));
        // a hole below a slice that is closed is behind other bodies
        assert_eq!(found(&[0.0, 0.5, 0.1]), (0.3, Some(2.0)));
    }
}
