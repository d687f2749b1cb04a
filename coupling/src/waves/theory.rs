//! Waves of a piston in theory: its motion, the surface it expects, and how it takes out waves that come back.

use std::f64::consts::PI;

use nalgebra::Complex;

use super::irregular::Waves;
use super::regular::Regular;
use super::solitary::Solitary;
use super::{StillWater, Stroke, between, smooth_start};

/// Time over which an absorbing piston forgets the mean level and its own way; × period. Over less it would not absorb the
/// wave, over more it would drift.
const MEMORY: f64 = 10.0;
/// Points of an expected surface per period: straight lines between them are good to a thousandth of the shortest wave made.
const POINTS: f64 = 200.0;

/// Waves of a piston.
#[derive(Clone, Debug, PartialEq)]
pub enum Theory {
    /// Of one period.
    Regular(Regular),
    /// A solitary wave.
    Solitary(Solitary),
    /// A sum of linear waves.
    Sum(Waves),
    /// None: the piston absorbs those that come, of a period (s) best.
    Still(f64),
}

impl Theory {
    /// Period of the peak; that of a solitary wave is the time its length takes; s.
    pub fn period(&self) -> f64 {
        match self {
            Self::Regular(wave) => wave.period,
            Self::Solitary(wave) => wave.length() / wave.celerity,
            Self::Sum(waves) => waves.period,
            Self::Still(period) => *period,
        }
    }
}

/// Piston in still water, with its waves.
#[derive(Clone, Debug, PartialEq)]
pub struct Piston {
    /// Before it.
    pub water: StillWater,
    /// Its waves.
    pub theory: Theory,
    /// Smooth start of waves with a period; s.
    pub ramp: f64,
    /// s.
    pub duration: f64,
}

/// Control that moves a piston by the surface before it, so that waves that come back leave through it.
///
/// With the surface `r` in excess of the expected one, the piston gets the velocity
///
/// ```text
/// u + lag du/dt = −gain (r − r̄),   memory dr̄/dt = r − r̄,   dx/dt = u − x/memory                          [m/s]
/// ```
/// A wave `a exp i(ωt + kx)` that arrives is taken out where the piston goes with `U = −a ω/c`, `c` its height over stroke; the
/// reading at a distance `x` before it is then `a exp(ikx) − i e U/ω` with its near field `e(x)`, so that
///
/// ```text
/// U = −ω/c r/(cos kx + i (sin kx + e/c))
/// ```
/// which gain and lag are at one frequency, that of the peak, with what is forgotten counted in. There nothing is reflected; with
/// the gain `√(g/h)` of long waves and no lag, as in Schäffer & Klopman (2000), J. Waterway Port Coastal Ocean Eng. 126, 88-97, a
/// piston on kh = 2 gives back 17 %.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Control {
    /// 1/s.
    pub gain: f64,
    /// s.
    pub lag: f64,
    /// s.
    pub memory: f64,
    /// Surface that the piston makes where it is read, above still water, at rest before and after its times; s, m.
    pub expected: Stroke,
}

impl Piston {
    /// Motion of the piston.
    pub fn stroke(&self) -> Stroke {
        let (duration, ramp) = (self.duration, self.ramp);
        match &self.theory {
            Theory::Regular(wave) => wave.stroke(duration, ramp),
            Theory::Solitary(wave) => wave.stroke(),
            Theory::Sum(waves) => waves.stroke(duration, ramp),
            Theory::Still(_) => Stroke {
                time: vec![0.0],
                place: vec![0.0],
            },
        }
    }

    /// Surface above still water at a distance (m) from the piston at rest, without what decays near it; m.
    pub fn surface(&self, distance: f64, time: f64) -> f64 {
        match &self.theory {
            Theory::Regular(wave) => wave.surface(self.water, (distance, time), self.ramp),
            Theory::Solitary(wave) => wave.surface(distance, time),
            Theory::Sum(waves) => {
                let speed = self.water.group_speed(self.wave_number());
                let started = smooth_start(time - distance / speed, self.ramp);
                started * waves.surface(distance, time)
            }
            Theory::Still(_) => 0.0,
        }
    }

    /// Control by readings at a distance (m) before the moving piston.
    pub fn control(&self, distance: f64) -> Control {
        let expected = self.expected(distance);
        let StillWater { depth, gravity } = self.water;
        if let Theory::Solitary(wave) = &self.theory {
            let total = depth + wave.height;
            return Control {
                // the water behind a long wave moves at c η/(h + η)
                gain: (gravity / total).sqrt(),
                lag: distance / wave.celerity,
                memory: MEMORY * self.period(),
                expected,
            };
        }
        let omega = 2.0 * PI / self.period();
        let wave_number = self.wave_number();
        let transfer = self.water.height_over_stroke(wave_number);
        let near = self.water.near_field(omega, distance);
        let memory = MEMORY * self.period();
        // reading over velocity of the piston, before what is forgotten runs ahead
        let (sin, cos) = (wave_number * distance).sin_cos();
        let asked = Complex::new(cos, sin + near / transfer) * (transfer / omega);
        let ahead = Complex::new(1.0, -1.0 / (omega * memory));
        let answer = asked / (ahead * ahead);
        Control {
            gain: 1.0 / answer.re,
            lag: answer.im / (answer.re * omega),
            memory,
            expected,
        }
    }

    /// Surface at a distance before the moving piston, near field included.
    fn expected(&self, distance: f64) -> Stroke {
        let (water, ramp) = (self.water, self.ramp);
        let stroke = self.stroke();
        let before = |t: f64| stroke.at(t) + distance;
        let interval = self.period() / POINTS;
        match &self.theory {
            Theory::Regular(wave) => {
                let near = wave.near_amplitudes(water, distance);
                Stroke::sampled(self.duration, interval, |t| {
                    self.surface(before(t), t) + wave.near_field(near, t, ramp)
                })
            }
            Theory::Solitary(wave) => Stroke {
                place: (stroke.time.iter())
                    .map(|&t| wave.surface(before(t), t))
                    .collect(),
                time: stroke.time,
            },
            Theory::Sum(waves) => {
                let near = waves.near_amplitudes(distance);
                Stroke::sampled(self.duration, interval, |t| {
                    self.surface(before(t), t) + waves.near_field(&near, t, ramp)
                })
            }
            Theory::Still(_) => stroke,
        }
    }

    fn period(&self) -> f64 {
        self.theory.period()
    }

    fn wave_number(&self) -> f64 {
        self.water.wave_number(2.0 * PI / self.period())
    }
}

/// What a control remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Memory {
    /// Velocity before what draws the piston back; m/s.
    velocity: f64,
    /// Mean of the excess; m.
    mean: f64,
    /// Way that the control went; m.
    way: f64,
}

impl Control {
    /// Velocity over the step `dt` (s) from a time, by the surface (m) read at its start; m/s.
    pub fn velocity(&self, memory: &mut Memory, surface: f64, (time, dt): (f64, f64)) -> f64 {
        let excess = surface - self.expected_at(time);
        let forgotten = 1.0 - (-dt / self.memory).exp();
        memory.mean += forgotten * (excess - memory.mean);
        let wanted = -self.gain * (excess - memory.mean);
        memory.velocity += (1.0 - (-dt / self.lag).exp()) * (wanted - memory.velocity);
        let velocity = memory.velocity - memory.way / self.memory;
        memory.way += velocity * dt;
        velocity
    }

    /// Surface that the piston makes where it is read; m.
    pub fn expected_at(&self, time: f64) -> f64 {
        let Stroke { time: times, place } = &self.expected;
        match times.last() {
            Some(end) if time <= *end => between((times, place), time),
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WATER: StillWater = StillWater {
        depth: 1.0,
        gravity: 1.0,
    };

    fn still(kh: f64) -> Piston {
        Piston {
            water: WATER,
            theory: Theory::Still(2.0 * PI / WATER.angular_frequency(kh)),
            ramp: 0.0,
            duration: 1.0,
        }
    }

    /// Share of a wave that a controlled piston reflects, in linear theory: of a wave `cos(ωt + kx)` that comes to it, what leaves
    /// is `cos(ωt − kx)` and `c U/ω` as it was `kx/ω` ago, and its way times `e` stands before it. The share is the first
    /// harmonic of what leaves at the piston over the last period.
    fn reflected(control: &Control, kh: f64, distance: f64) -> f64 {
        let omega = WATER.angular_frequency(kh);
        let transfer = WATER.height_over_stroke(kh) / omega;
        let near = WATER.near_field(omega, distance);
        let (n, periods) = (16_000, 80);
        let dt = 2.0 * PI / omega / f64::from(n);
        let phase = kh * distance;
        let late = (phase / (omega * dt)).round() as usize;
        let mut memory = Memory::default();
        let (mut velocities, mut way, mut leaving) = (vec![0.0; late + 1], 0.0, (0.0, 0.0));
        for step in 0..periods * n {
            let t = f64::from(step) * dt;
            let (comes, returns) = ((omega * t + phase).cos(), (omega * t - phase).cos());
            let read = comes + returns + transfer * velocities[0] + near * way;
            let velocity = control.velocity(&mut memory, read, (t, dt));
            way += velocity * dt;
            velocities.push(velocity);
            velocities.remove(0);
            if (periods - 1) * n <= step {
                let (sin, cos) = (omega * t).sin_cos();
                let leaves = 2.0 / f64::from(n) * (cos + transfer * velocity);
                leaving = (leaving.0 + leaves * cos, leaving.1 + leaves * sin);
            }
        }
        f64::hypot(leaving.0, leaving.1)
    }

    /// At its own frequency a piston reflects nothing but the delays of a step, one in the loop and a half in the rounding of the
    /// distance, 1.5 · 2π/16000 = 6e-4, and the transient after 80 periods, exp(−8) = 3e-4.
    #[test]
    fn a_piston_takes_out_the_wave_it_is_made_for() {
        for kh in [0.3, 1.0, 2.0, 3.0] {
            for distance in [0.0, 0.03, 0.1] {
                let share = reflected(&still(kh).control(distance), kh, distance);
                assert!(share < 9e-4, "{kh}, {distance}: {share}");
            }
        }
    }

    /// Waves beside the peak come back in part; what long waves would have it do gives back a sixth at kh = 2.
    #[test]
    fn a_piston_reflects_little_of_waves_beside_the_peak() {
        let control = still(1.0).control(0.03);
        for (ratio, most) in [(0.8, 0.04), (1.25, 0.04), (1.5, 0.09), (2.0, 0.2)] {
            let omega = ratio * WATER.angular_frequency(1.0);
            let share = reflected(&control, WATER.wave_number(omega), 0.03);
            assert!(share < most, "{ratio}: {share}");
        }
        let long = Control {
            gain: 1.0,
            // without any, the loop of steps would be its own delay
            lag: 0.02,
            ..still(2.0).control(0.0)
        };
        let share = reflected(&long, 2.0, 0.0);
        assert!((share - 0.17).abs() < 0.02, "{share}");
    }

    /// What a piston makes is what it expects: a control that reads its own wave does nothing.
    #[test]
    fn a_piston_leaves_its_own_wave_alone() {
        let period = 2.0 * PI / WATER.angular_frequency(1.0);
        let piston = Piston {
            theory: Theory::Regular(Regular::new(WATER, 0.1, period)),
            ramp: period,
            duration: 10.0 * period,
            ..still(1.0)
        };
        let control = piston.control(0.03);
        let mut memory = Memory::default();
        let dt = period / 500.0;
        for step in 0..4000 {
            let t = f64::from(step) * dt;
            let velocity = control.velocity(&mut memory, control.expected_at(t), (t, dt));
            assert_eq!(velocity, 0.0);
        }
    }

    /// The surface that a piston expects has the crest of its wave, and the near field is in phase with its way.
    #[test]
    fn the_expected_surface_is_that_of_theory() {
        let omega = WATER.angular_frequency(2.0);
        let period = 2.0 * PI / omega;
        let wave = Regular::new(WATER, 0.01, period);
        let piston = Piston {
            theory: Theory::Regular(wave),
            ramp: period,
            duration: 10.0 * period,
            ..still(2.0)
        };
        let control = piston.control(0.0);
        // a quarter before a whole period: the piston is at its back, its wave at zero
        let t = 7.75 * period;
        let near = WATER.near_field(omega, 0.0) * -wave.first;
        // second order: (0.01)² k
        assert!((control.expected_at(t) - near).abs() < 1e-4);
        assert!((control.expected_at(8.0 * period) - 0.005).abs() < 1e-4);
    }
}
