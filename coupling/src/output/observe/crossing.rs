//! Water that crosses a line in plan view: a dam crest, a section of a river.

use riprap_sph::{Fluid, ParticleId, Vec3};
use serde::{Deserialize, Serialize};

use crate::scene::resolved::recording::PlanLine;

/// Volume that has crossed a line, from samples of the water: only flow faster than sound could cross between two samples.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Crossing {
    /// m.
    from: [f64; 2],
    /// From its start to its end; m.
    along: [f64; 2],
    /// Particles that could cross before the next sample: id and position in plan view (m), sorted by id.
    near: Vec<(ParticleId, [f64; 2])>,
    /// Net volume to the right of the line in its direction; m³.
    volume: f64,
    /// Time of the last sample; s.
    time: Option<f64>,
}

impl Crossing {
    pub(super) fn of(PlanLine { from, to }: PlanLine) -> Self {
        Self {
            from,
            along: [to[0] - from[0], to[1] - from[1]],
            near: Vec::new(),
            volume: 0.0,
            time: None,
        }
    }

    /// Volume since the first sample (m³), and mean discharge since the last one (m³/s). The next sample follows within
    /// `interval` (s).
    pub(super) fn update(&mut self, fluid: &Fluid, time: f64, interval: f64) -> [f64; 2] {
        let particles = fluid.particles();
        let way = fluid.settings().sound_speed * interval.max(time - self.time.unwrap_or(time));
        let places = particles.id.iter().zip(&particles.position);
        let mut now: Vec<(ParticleId, [f64; 2])> = places
            .map(|(&id, x): (&ParticleId, &Vec3)| (id, [x.x, x.y]))
            .filter(|&(_, place)| self.distance(place) <= 2.0 * way)
            .collect();
        now.sort_unstable_by_key(|&(id, _)| id);
        let mut passed = 0.0;
        for &(id, before) in &self.near {
            if let Ok(k) = now.binary_search_by_key(&id, |&(id, _)| id) {
                passed += self.passage(before, now[k].1);
            }
        }
        let passed = passed * fluid.particle_volume();
        self.volume += passed;
        let discharge = self.time.map_or(0.0, |before| passed / (time - before));
        now.retain(|&(_, place)| self.distance(place) <= way);
        self.near = now;
        self.time = Some(time);
        [self.volume, discharge]
    }

    /// Signed distance of a point to the left of the line, times its length; m².
    fn side(&self, [x, y]: [f64; 2]) -> f64 {
        self.along[0] * (y - self.from[1]) - self.along[1] * (x - self.from[0])
    }

    /// 1 for a path across the line from left to right, -1 for the reverse, 0 for one past its ends.
    fn passage(&self, before: [f64; 2], now: [f64; 2]) -> f64 {
        let (left, right) = (self.side(before), self.side(now));
        if (0.0 <= left) == (0.0 <= right) {
            return 0.0;
        }
        let share = left / (left - right);
        let at = [0, 1].map(|axis| before[axis] + share * (now[axis] - before[axis]));
        let length2 = self.along[0].powi(2) + self.along[1].powi(2);
        let place = ((at[0] - self.from[0]) * self.along[0]
            + (at[1] - self.from[1]) * self.along[1])
            / length2;
        if !(0.0..1.0).contains(&place) {
            0.0
        } else if 0.0 <= left {
            1.0
        } else {
            -1.0
        }
    }

    /// Distance from the segment; m.
    fn distance(&self, [x, y]: [f64; 2]) -> f64 {
        let offset = [x - self.from[0], y - self.from[1]];
        let length2 = self.along[0].powi(2) + self.along[1].powi(2);
        let share = (offset[0] * self.along[0] + offset[1] * self.along[1]) / length2;
        let share = share.clamp(0.0, 1.0);
        (offset[0] - share * self.along[0]).hypot(offset[1] - share * self.along[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Facing north, east is to the right; flow around the ends does not count.
    #[test]
    fn a_passage_has_a_side_and_ends() {
        let line = Crossing::of(PlanLine {
            from: [0.0, 0.0],
            to: [0.0, 10.0],
        });
        assert_eq!(line.passage([-1.0, 5.0], [1.0, 6.0]), 1.0);
        assert_eq!(line.passage([1.0, 6.0], [-1.0, 5.0]), -1.0);
        assert_eq!(line.passage([-1.0, 11.0], [1.0, 12.0]), 0.0);
        assert_eq!(line.passage([-1.0, 9.0], [1.0, 12.0]), 0.0);
        assert_eq!(line.passage([1.0, 5.0], [2.0, 5.0]), 0.0);
        assert_eq!(line.distance([3.0, 14.0]), 5.0);
    }
}
