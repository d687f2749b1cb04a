//! Regular waves by a piston, to second order.

use std::f64::consts::PI;

use super::{StillWater, Stroke, smooth_start};

/// Points of a record per period: the speed of monotone pieces between them is within a percent.
const POINTS: f64 = 400.0;

/// Regular wave and the piston that makes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Regular {
    /// From trough to crest; m.
    pub height: f64,
    /// s.
    pub period: f64,
    /// Wave number; 1/m.
    pub wave_number: f64,
    /// Amplitude of the piston at the period; m.
    pub first: f64,
    /// Amplitude of the piston at half the period; m.
    pub second: f64,
}

impl Regular {
    /// Piston that makes a regular wave without a free second harmonic, which would travel at its own speed and beat with
    /// the wave.
    ///
    /// ```text
    /// e(t) = S/2 sin ωt + H²/(32 h) (3 cosh kh/sinh³ kh − 2/m) sin 2ωt,   m = H/S                       [m]
    /// ```
    /// Source: Madsen (1971), J. Geophys. Res. 76, 8672-8683, eq. 17, in long waves; evanescent modes are left out. It holds
    /// for `H L²/h³ < 8π²/3`; see [`Self::ursell_share`].
    pub fn new(water: StillWater, height: f64, period: f64) -> Self {
        let wave_number = water.wave_number(2.0 * PI / period);
        let transfer = water.height_over_stroke(wave_number);
        let kh = wave_number * water.depth;
        // cosh/sinh³ in a form that does not overflow
        let bound = 3.0 / (kh.tanh() * kh.sinh().powi(2)) - 2.0 / transfer;
        Self {
            height,
            period,
            wave_number,
            first: 0.5 * height / transfer,
            second: height * height / (32.0 * water.depth) * bound,
        }
    }

    /// Share of the limit beyond which a wave of second order has a second crest in its trough.
    ///
    /// ```text
    /// H L²/h³ / (8π²/3)                                          Madsen (1971)                          [–]
    /// ```
    pub fn ursell_share(&self, water: StillWater) -> f64 {
        let length = 2.0 * PI / self.wave_number;
        self.height * length.powi(2) / water.depth.powi(3) / (8.0 * PI * PI / 3.0)
    }

    /// Place of the piston after a smooth start over `ramp` (s); m.
    pub fn place(&self, time: f64, ramp: f64) -> f64 {
        self.with_piston([self.first, self.second], time, ramp)
    }

    /// Surface of second order at a distance (m) from the piston at rest, after a smooth start over `ramp` (s) that travels with
    /// the energy of the wave; m.
    ///
    /// ```text
    /// η = H/2 cos θ + k H²/16 (3 coth² kh − 1) coth kh cos 2θ,   θ = ωt − kx                            [m]
    /// ```
    /// Source: Stokes (1847); Dean & Dalrymple (1991), eq. 11.44.
    pub fn surface(&self, water: StillWater, (distance, time): (f64, f64), ramp: f64) -> f64 {
        let k = self.wave_number;
        let phase = 2.0 * PI * time / self.period - k * distance;
        let coth = 1.0 / (k * water.depth).tanh();
        let bound = k * self.height.powi(2) / 16.0 * (3.0 * coth * coth - 1.0) * coth;
        let started = smooth_start(time - distance / water.group_speed(k), ramp);
        started * (0.5 * self.height * phase.cos() + bound * (2.0 * phase).cos())
    }

    /// Amplitudes of the near field at a distance (m) before the piston, of the period and of half of it; m.
    pub fn near_amplitudes(&self, water: StillWater, distance: f64) -> [f64; 2] {
        let omega = 2.0 * PI / self.period;
        [
            self.first * water.near_field(omega, distance),
            self.second * water.near_field(2.0 * omega, distance),
        ]
    }

    /// Surface of the near field of some amplitudes; m.
    pub fn near_field(&self, amplitudes: [f64; 2], time: f64, ramp: f64) -> f64 {
        self.with_piston(amplitudes, time, ramp)
    }

    /// Sum of two amplitudes in phase with the piston, after a smooth start.
    fn with_piston(&self, [first, second]: [f64; 2], time: f64, ramp: f64) -> f64 {
        let phase = 2.0 * PI * time / self.period;
        smooth_start(time, ramp) * (first * phase.sin() + second * (2.0 * phase).sin())
    }

    /// Motion for a duration (s).
    pub fn stroke(&self, duration: f64, ramp: f64) -> Stroke {
        Stroke::sampled(duration, self.period / POINTS, |t| self.place(t, ramp))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In long waves the piston moves with the water, `de/dt = c η/(h + η)` at its own place `e`. With the wave of Stokes,
    /// `η = a cos ωt + b cos 2ωt` and `b = (k a²/4) (3 coth² kh − 1) coth kh`, its second harmonic is `(b − a²/h)/(2kh)`;
    /// terms of order (kh)⁴ are left out.
    #[test]
    fn in_long_waves_the_piston_moves_with_the_water() {
        let water = StillWater {
            depth: 0.8,
            gravity: 9.81,
        };
        for kh in [0.02_f64, 0.05, 0.1, 0.3] {
            let k = kh / water.depth;
            let period = 2.0 * PI / water.angular_frequency(k);
            let height = 1e-4;
            let piston = Regular::new(water, height, period);
            let a = 0.5 * height;
            assert!((piston.first * kh / a - 1.0).abs() < 0.1 * kh.powi(4) + 1e-9);
            let coth = 1.0 / kh.tanh();
            let b = 0.25 * k * a * a * (3.0 * coth * coth - 1.0) * coth;
            let expected = (b - a * a / water.depth) / (2.0 * kh);
            // the relation of dispersion is solved to 1e-12, its powers to 1e-9
            let difference = (piston.second / expected - 1.0).abs();
            assert!(difference < kh.powi(4) + 1e-9, "{kh}: {difference}");
        }
    }

    /// A wave of 0.1 m and 2 s on 0.66 m, by bisection of the dispersion relation and the printed formulas elsewhere.
    #[test]
    fn a_wave_of_a_laboratory_has_its_numbers() {
        let water = StillWater {
            depth: 0.66,
            gravity: 9.81,
        };
        let found = Regular::new(water, 0.1, 2.0);
        let numbers = [
            (found.wave_number, 1.388_958_267_597_908_4),
            (found.first, 0.055_277_188_057_566_84),
            (found.second, 7.297_316_830_924_342e-4),
        ];
        for (found, expected) in numbers {
            assert!((found / expected - 1.0).abs() < 1e-12, "{found}");
        }
        assert_eq!(found.place(0.0, 2.0), 0.0);
    }
}
