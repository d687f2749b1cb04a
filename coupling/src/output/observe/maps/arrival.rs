//! Arrival of waves at the points of a map.
//!
//! Still water moves, too: it settles, and where it is thin its computed surface comes and goes. But a wave comes from somewhere. A
//! point watches its own still water, wet or dry, until the fastest wave from something that moves in the water could have come. Once
//! a wave has arrived close by, the first departure by more than a threshold from all that the point has seen is the arrival there.
//! Water that is let go, without a body that moves, makes itself known by a departure far beyond all that settling does.

use serde::{Deserialize, Serialize};

/// Distance of points that learn of a wave, in addition to its travel between samples; points.
const CLOSE: f64 = 2.0;
/// Speed of the fastest waves over √(g h).
const FASTEST: f64 = 1.5;
/// Departure that needs no wave close by; × particle spacing.
const LARGE: f64 = 2.0;

/// Conditions of an arrival.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rule {
    /// Departure from still water close to a wave; m.
    threshold: f64,
    /// Departure from still water anywhere; m.
    large: f64,
    /// Distance within which a wave may come before the next sample; points.
    reach: usize,
    /// Speed of the fastest waves; points/s.
    speed: f64,
    /// False where water flows from the start: then every point is close to a wave.
    is_still: bool,
}

/// Scales of the water of a map.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scales {
    /// Still-water depth; m.
    pub depth: f64,
    /// m/s².
    pub gravity: f64,
    /// Particle spacing; m.
    pub particles: f64,
    /// Spacing of the points of the map; m.
    pub points: f64,
    /// Time between samples; s.
    pub interval: f64,
}

impl Rule {
    /// Rule for water at rest at the start.
    pub fn still(threshold: f64, scales: Scales) -> Self {
        let speed = FASTEST * (scales.gravity * scales.depth).sqrt() / scales.points;
        Self {
            threshold,
            large: threshold.max(LARGE * scales.particles),
            reach: (CLOSE + speed * scales.interval).ceil() as usize,
            speed,
            is_still: true,
        }
    }

    /// The rule for water that flows from the start.
    pub fn flowing(self) -> Self {
        Self {
            is_still: false,
            ..self
        }
    }

    /// Within which a body that moves in the water makes waves; points.
    pub fn reach(&self) -> usize {
        self.reach
    }
}

/// Still water and arrivals so far, for the points of a grid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Arrival {
    /// Time of arrival, NaN without one; s.
    pub time: Vec<f64>,
    /// Range of the still surface, the ground where dry, NaN without ground; m.
    lowest: Vec<f64>,
    highest: Vec<f64>,
    /// Points that the fastest wave could have reached: what they see is no longer still water.
    passed: Vec<bool>,
    /// Part of a point that it has gone beyond them.
    ahead: f64,
    /// Time of the last sample; s.
    last: f64,
}

impl Arrival {
    /// Nothing seen yet at some points.
    pub fn at(n_points: usize) -> Self {
        let none = vec![f64::NAN; n_points];
        Self {
            time: none.clone(),
            lowest: none.clone(),
            highest: none,
            passed: vec![false; n_points],
            ahead: 0.0,
            last: 0.0,
        }
    }

    /// Takes the still water at the start, for a row of points along x after the other.
    pub fn begin(&mut self, surface: &[f64]) {
        self.lowest.copy_from_slice(surface);
        self.highest.copy_from_slice(surface);
    }

    /// Takes the surface, the ground where dry, at a later time (s); `moving` marks points beside bodies that move in the water.
    pub fn update(
        &mut self,
        rule: Rule,
        columns: usize,
        (surface, moving): (&[f64], &[bool]),
        time: f64,
    ) {
        let sources = self.time.iter().zip(moving);
        let sources: Vec<bool> = sources
            .map(|(time, &moves)| moves || time.is_finite())
            .collect();
        let close = widened(&sources, columns, rule.reach);
        self.pass(rule, columns, &close, time);
        for (k, &now) in surface.iter().enumerate() {
            if self.time[k].is_finite() || now.is_nan() {
                continue;
            }
            let is_close = close[k] || !rule.is_still;
            let enough = if is_close { rule.threshold } else { rule.large };
            if enough < self.departure(k, now) {
                self.time[k] = time;
            } else if rule.is_still && !self.passed[k] {
                // a minimum of NaN and a number is the number
                self.lowest[k] = self.lowest[k].min(now);
                self.highest[k] = self.highest[k].max(now);
            }
        }
    }

    /// Follows the fastest wave from points close to waves and moving bodies.
    fn pass(&mut self, rule: Rule, columns: usize, close: &[bool], time: f64) {
        self.ahead += rule.speed * (time - self.last);
        self.last = time;
        let whole = self.ahead.floor();
        self.ahead -= whole;
        for (passed, &close) in self.passed.iter_mut().zip(close) {
            *passed |= close;
        }
        self.passed = widened(&self.passed, columns, whole as usize);
    }

    /// Distance from the range of the still surface; m.
    fn departure(&self, k: usize, now: f64) -> f64 {
        if self.lowest[k].is_nan() {
            // water where there was neither water nor ground
            return f64::INFINITY;
        }
        (now - self.highest[k]).max(self.lowest[k] - now)
    }
}

/// Points within some rows and columns of marked ones.
fn widened(marked: &[bool], columns: usize, reach: usize) -> Vec<bool> {
    let along = |line: &mut dyn Iterator<Item = usize>, from: &[bool], to: &mut [bool]| {
        let line: Vec<usize> = line.collect();
        for (place, _) in line.iter().enumerate().filter(|(_, k)| from[**k]) {
            let last = (place + reach).min(line.len() - 1);
            for &k in &line[place.saturating_sub(reach)..=last] {
                to[k] = true;
            }
        }
    };
    let rows = marked.len() / columns;
    let mut wide = vec![false; marked.len()];
    for row in 0..rows {
        along(&mut (row * columns..(row + 1) * columns), marked, &mut wide);
    }
    let mut both = vec![false; marked.len()];
    for column in 0..columns {
        along(
            &mut (0..rows).map(|row| row * columns + column),
            &wide,
            &mut both,
        );
    }
    both
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCALES: Scales = Scales {
        depth: 10.0,
        gravity: 10.0,
        particles: 1.0,
        points: 4.0,
        interval: 0.1,
    };

    /// 10 m/s for 0.1 s, half as fast again, are less than a point.
    fn rule() -> Rule {
        let rule = Rule::still(0.25, SCALES);
        assert_eq!((rule.reach(), rule.large), (3, 2.0));
        rule
    }

    #[test]
    fn still_water_that_settles_and_comes_and_goes_is_no_wave() {
        let mut arrival = Arrival::at(8);
        arrival.begin(&[10.0; 8]);
        for step in 0..1000 {
            let time = f64::from(step) * 0.1;
            // sinks by half a spacing, thin water at the end appears and vanishes
            let mut surface = [10.0 - 0.5 * time / 100.0; 8];
            surface[7] = if step % 7 < 3 { 10.0 } else { 9.2 };
            arrival.update(rule(), 8, (&surface, &[false; 8]), time);
        }
        assert!(arrival.time.iter().all(|time| time.is_nan()));
    }

    #[test]
    fn a_wave_arrives_after_its_neighbors_and_above_the_noise_of_each_point() {
        let mut arrival = Arrival::at(12);
        arrival.begin(&[10.0; 12]);
        let mut moving = [false; 12];
        for step in 0..200 {
            let time = f64::from(step) * 0.1;
            // from 5 s on a body at the first point sends a front, a point every half second; a point jumps before it comes
            moving[0] = 5.0 <= time;
            let surface: Vec<f64> = (0..12)
                .map(|k| {
                    let noise = if k == 8 && step % 5 == 0 { 1.0 } else { 0.0 };
                    let has_come = 5.0 + 0.5 * f64::from(k) <= time + 1e-9;
                    10.0 + if has_come { 1.5 } else { noise }
                })
                .collect();
            arrival.update(rule(), 12, (&surface, &moving), time);
        }
        for (k, time) in (0..).zip(&arrival.time) {
            assert!(
                (time - (5.0 + 0.5 * f64::from(k))).abs() < 1e-9,
                "{k}: {time}"
            );
        }
    }

    /// The front rises over a length of many points, which must not pass for still water ahead of it.
    #[test]
    fn a_long_front_arrives_where_it_exceeds_the_threshold() {
        let n = 100;
        let mut arrival = Arrival::at(n);
        arrival.begin(&vec![10.0; n]);
        let mut moving = vec![false; n];
        moving[0] = true;
        for step in 1..600 {
            let time = f64::from(step) * 0.1;
            // 10 m/s are 2.5 points a second; 2 m high after 20 points
            let surface: Vec<f64> = (0..n)
                .map(|k| 10.0 + (0.1 * (2.5 * time - k as f64)).clamp(0.0, 2.0))
                .collect();
            arrival.update(rule(), n, (&surface, &moving), time);
        }
        for (k, time) in arrival.time.iter().enumerate() {
            // 0.25 m are 2.5 points behind the foot; seen at the next sample
            let late = time - (k as f64 + 2.5) / 2.5;
            assert!((-1e-9..0.1 + 1e-9).contains(&late), "{k}: {late}");
        }
    }

    #[test]
    fn water_that_is_let_go_needs_no_body() {
        let mut arrival = Arrival::at(3);
        arrival.begin(&[10.0, 0.0, f64::NAN]);
        arrival.update(rule(), 3, (&[7.0, 0.1, f64::NAN], &[false; 3]), 1.0);
        assert_eq!(arrival.time[0], 1.0);
        // the next points are close to it
        arrival.update(rule(), 3, (&[6.0, 0.5, 0.5], &[false; 3]), 2.0);
        assert_eq!(arrival.time[1..], [2.0, 2.0]);
        // of water that flows a threshold is enough anywhere
        let mut flowing = Arrival::at(1);
        flowing.begin(&[10.0]);
        flowing.update(rule().flowing(), 1, (&[10.3], &[false]), 1.0);
        assert_eq!(flowing.time, [1.0]);
    }

    #[test]
    fn points_are_close_along_both_axes() {
        let mut marked = vec![false; 30];
        marked[2 * 6 + 1] = true;
        let close = widened(&marked, 6, 1);
        let found: Vec<usize> = (0..30).filter(|&k| close[k]).collect();
        assert_eq!(found, [6, 7, 8, 12, 13, 14, 18, 19, 20]);
    }
}
