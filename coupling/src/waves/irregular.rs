//! Irregular waves and focused groups by a piston, as sums of linear waves.

use std::f64::consts::PI;

use super::{StillWater, Stroke, smooth_start};

/// Frequencies that are made; × peak frequency. Below a half there is next to no energy, and long strokes; beyond three
/// waves are shorter than a tenth of the peak's.
const BAND: (f64, f64) = (0.5, 3.0);
/// Fewest and most components.
const COMPONENTS: (f64, f64) = (200.0, 2000.0);
/// Points of a record per peak period: fourteen for the shortest wave.
const POINTS: f64 = 100.0;
/// Width of the peak of JONSWAP below and above it; Hasselmann et al. (1973).
const WIDTH: (f64, f64) = (0.07, 0.09);
/// Intervals of the sum that scales a spectrum, and its end; × peak frequency.
const MOMENT: (u32, f64) = (20_000, 40.0);

/// Shape of a spectrum of waves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spectrum {
    /// Growing sea; the peak enhancement γ, 1 to 7, 3.3 on average.
    Jonswap(f64),
    /// Fully grown sea: JONSWAP without enhancement.
    PiersonMoskowitz,
}

impl Spectrum {
    /// Peak enhancement; –.
    pub fn enhancement(&self) -> f64 {
        match *self {
            Self::Jonswap(gamma) => gamma,
            Self::PiersonMoskowitz => 1.0,
        }
    }

    /// Shape over the frequency in peak frequencies, in no unit.
    ///
    /// ```text
    /// s(x) = x⁻⁵ exp(−5/4 x⁻⁴) γ^exp(−(x − 1)²/(2σ²)),   σ = 0.07 for x ≤ 1, else 0.09
    /// ```
    /// Source: Hasselmann et al. (1973); Pierson & Moskowitz (1964).
    fn shape(&self, x: f64) -> f64 {
        if x <= 0.0 {
            return 0.0;
        }
        let width = if x <= 1.0 { WIDTH.0 } else { WIDTH.1 };
        let near = (-(x - 1.0).powi(2) / (2.0 * width * width)).exp();
        x.powi(-5) * (-1.25 * x.powi(-4)).exp() * self.enhancement().powf(near)
    }

    /// Spectral density whose zeroth moment is a sixteenth of the square of the significant height (m), for a peak period
    /// (s), at some frequencies (Hz); m² s.
    pub fn density(&self, (height, period): (f64, f64), frequencies: &[f64]) -> Vec<f64> {
        let (n, end) = MOMENT;
        let step = end / f64::from(n);
        let sum: f64 = (0..n)
            .map(|k| self.shape((f64::from(k) + 0.5) * step) * step)
            .sum();
        let scale = height * height / 16.0 * period / sum;
        let density = |f: &f64| scale * self.shape(f * period);
        frequencies.iter().map(density).collect()
    }
}

/// Linear wave of a sum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Component {
    /// 1/s.
    pub angular_frequency: f64,
    /// 1/m.
    pub wave_number: f64,
    /// Of the wave; m.
    pub amplitude: f64,
    /// Of the wave at the piston at rest, `η = a cos(ωt + φ)`; rad.
    pub phase: f64,
}

/// Waves of a spectrum.
#[derive(Clone, Debug, PartialEq)]
pub struct Waves {
    /// Peak period; s.
    pub period: f64,
    /// Their sum is the surface at the piston.
    pub components: Vec<Component>,
    water: StillWater,
}

impl Waves {
    /// Waves of random phases with a significant height (m) and a peak period (s). No two frequencies are multiples of one,
    /// so that the record does not repeat; a seed gives the same waves always.
    ///
    /// Components have one frequency each in equal intervals, at most `1/duration` wide. They are scaled to the significant
    /// height exactly, the tails that are left out included. Waves bound to groups are left out: the theory is linear.
    pub fn irregular(
        water: StillWater,
        (spectrum, height, period): (Spectrum, f64, f64),
        (duration, seed): (f64, u64),
    ) -> Self {
        let (low, high) = (BAND.0 / period, BAND.1 / period);
        let n = (duration * (high - low))
            .clamp(COMPONENTS.0, COMPONENTS.1)
            .ceil();
        let interval = (high - low) / n;
        let mut random = Random(seed);
        let frequencies: Vec<f64> = (0..n as u32)
            .map(|k| low + (f64::from(k) + random.share()) * interval)
            .collect();
        let density = spectrum.density((height, period), &frequencies);
        let energy: f64 = density.iter().map(|s| s * interval).sum();
        let scale = height * height / 16.0 / energy;
        let components = frequencies.iter().zip(&density).map(|(&f, s)| {
            let angular_frequency = 2.0 * PI * f;
            Component {
                angular_frequency,
                wave_number: water.wave_number(angular_frequency),
                amplitude: (2.0 * scale * s * interval).sqrt(),
                phase: 2.0 * PI * random.share(),
            }
        });
        Self {
            period,
            components: components.collect(),
            water,
        }
    }

    /// Group of waves whose crests meet at a distance (m) from the piston at a time (s), where they add up to an amplitude
    /// (m): the expected surface beside the highest crest of a sea, with amplitudes in proportion to the spectrum.
    ///
    /// ```text
    /// a_i = A S(f_i)/Σ S(f_j),   φ_i = k_i x − ω_i t                                                   [m]
    /// ```
    /// Source: Tromans, Anaturk & Hagemeijer (1991).
    pub fn focused(
        water: StillWater,
        (spectrum, amplitude, period): (Spectrum, f64, f64),
        (distance, time): (f64, f64),
    ) -> Self {
        let (low, high) = (BAND.0 / period, BAND.1 / period);
        let n = COMPONENTS.0;
        let frequencies: Vec<f64> = (0..n as u32)
            .map(|k| low + (f64::from(k) + 0.5) * (high - low) / n)
            .collect();
        let density = spectrum.density((1.0, period), &frequencies);
        let sum: f64 = density.iter().sum();
        let components = frequencies.iter().zip(&density).map(|(&f, s)| {
            let angular_frequency = 2.0 * PI * f;
            let wave_number = water.wave_number(angular_frequency);
            Component {
                angular_frequency,
                wave_number,
                amplitude: amplitude * s / sum,
                phase: wave_number * distance - angular_frequency * time,
            }
        });
        Self {
            period,
            components: components.collect(),
            water,
        }
    }

    /// Significant height, four times the root of the variance; m.
    pub fn significant_height(&self) -> f64 {
        let variance: f64 = (self.components.iter())
            .map(|one| 0.5 * one.amplitude * one.amplitude)
            .sum();
        4.0 * variance.sqrt()
    }

    /// Surface of linear theory at a distance (m) from the piston; m.
    pub fn surface(&self, distance: f64, time: f64) -> f64 {
        let of = |one: &Component| {
            let phase = one.angular_frequency * time - one.wave_number * distance + one.phase;
            one.amplitude * phase.cos()
        };
        self.components.iter().map(of).sum()
    }

    /// Amplitudes of the near field at a distance (m) before the piston, of each component; m.
    pub fn near_amplitudes(&self, distance: f64) -> Vec<f64> {
        let of = |one: &Component| {
            let stroke = one.amplitude / self.water.height_over_stroke(one.wave_number);
            stroke * self.water.near_field(one.angular_frequency, distance)
        };
        self.components.iter().map(of).collect()
    }

    /// Surface of the near field of some amplitudes, in phase with the piston, after a smooth start over `ramp` (s); m.
    pub fn near_field(&self, amplitudes: &[f64], time: f64, ramp: f64) -> f64 {
        let of = |(one, amplitude): (&Component, &f64)| {
            amplitude * (one.angular_frequency * time + one.phase).sin()
        };
        let parts = self.components.iter().zip(amplitudes);
        smooth_start(time, ramp) * parts.map(of).sum::<f64>()
    }

    /// Motion of the piston for a duration (s), after a smooth start over `ramp` (s).
    ///
    /// ```text
    /// ξ = Σ a_i/m_i sin(ω_i t + φ_i),   m = H/S                                                        [m]
    /// ```
    pub fn stroke(&self, duration: f64, ramp: f64) -> Stroke {
        let water = self.water;
        let parts: Vec<(f64, f64, f64)> = (self.components.iter())
            .map(|one| {
                let amplitude = one.amplitude / water.height_over_stroke(one.wave_number);
                (amplitude, one.angular_frequency, one.phase)
            })
            .collect();
        Stroke::sampled(duration, self.period / POINTS, |t| {
            let place: f64 = (parts.iter())
                .map(|(amplitude, omega, phase)| amplitude * (omega * t + phase).sin())
                .sum();
            smooth_start(t, ramp) * place
        })
    }
}

/// Random numbers by SplitMix64, the same on every machine; Steele, Lea & Flood (2014).
struct Random(u64);

impl Random {
    /// From 0 to below 1.
    fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WATER: StillWater = StillWater {
        depth: 1.0,
        gravity: 9.81,
    };
    const SEA: (Spectrum, f64, f64) = (Spectrum::Jonswap(3.3), 0.12, 2.0);

    /// Zeroth moments by a sum three times finer than that which scales the spectrum; Pierson & Moskowitz's has a closed
    /// form, `S = 5/16 H² f_p⁴ f⁻⁵ exp(−5/4 (f_p/f)⁴)`, and JONSWAP's scale one fitted by Goda (1988) within
    /// 1 %.
    #[test]
    fn the_zeroth_moment_gives_the_significant_height() {
        let step = 2e-4;
        let frequencies: Vec<f64> = (1..100_000).map(|k| f64::from(k) * step).collect();
        for spectrum in [
            Spectrum::PiersonMoskowitz,
            Spectrum::Jonswap(3.3),
            Spectrum::Jonswap(7.0),
        ] {
            let density = spectrum.density((0.12, 2.0), &frequencies);
            let moment: f64 = density.iter().map(|s| s * step).sum();
            assert!(
                (4.0 * moment.sqrt() / 0.12 - 1.0).abs() < 1e-4,
                "{spectrum:?}"
            );
        }
        let density = |spectrum: Spectrum| spectrum.density((0.12, 2.0), &[0.5])[0];
        let closed = 5.0 / 16.0 * 0.12 * 0.12 * 2.0 * (-1.25_f64).exp();
        // what is beyond 40 peak frequencies: 1e-6
        assert!((density(Spectrum::PiersonMoskowitz) / closed - 1.0).abs() < 2e-6);
        let goda = 0.0624 / (0.230 + 0.0336 * 3.3 - 0.185 / (1.9 + 3.3));
        let peak = goda * 0.12 * 0.12 * 2.0 * (-1.25_f64).exp() * 3.3;
        assert!((density(Spectrum::Jonswap(3.3)) / peak - 1.0).abs() < 0.01);
    }

    /// The record of the surface at the piston has the significant height within its scatter, 1/√(2n) of n waves for the
    /// energy, and the second half is no copy of the first.
    #[test]
    fn a_record_has_its_height_and_does_not_repeat() {
        let duration = 600.0;
        let waves = Waves::irregular(WATER, SEA, (duration, 7));
        assert!((waves.significant_height() / 0.12 - 1.0).abs() < 1e-12);
        let record: Vec<f64> = (0..6000)
            .map(|k| waves.surface(0.0, 0.1 * f64::from(k)))
            .collect();
        let square = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64;
        let found = 4.0 * square(&record).sqrt();
        assert!((found / 0.12 - 1.0).abs() < 0.06, "{found}");
        // no shift of a tenth of the record or more brings it back: a copy would correlate by 1
        for shift in (600..4000).step_by(7) {
            let n = record.len() - shift;
            let product: f64 = (0..n).map(|k| record[k] * record[k + shift]).sum();
            let correlation = product / n as f64 / square(&record);
            assert!(correlation.abs() < 0.6, "{shift}: {correlation}");
        }
        assert_eq!(waves, Waves::irregular(WATER, SEA, (duration, 7)));
        assert_ne!(waves, Waves::irregular(WATER, SEA, (duration, 8)));
    }

    /// Crests meet where and when they should: the sum of amplitudes there, and less anywhere else.
    #[test]
    fn a_group_is_highest_at_its_focus() {
        let waves = Waves::focused(WATER, (SEA.0, 0.1, 2.0), (12.0, 30.0));
        assert!((waves.surface(12.0, 30.0) - 0.1).abs() < 1e-12);
        for (x, t) in [
            (12.0, 29.0),
            (12.0, 31.5),
            (6.0, 30.0),
            (0.0, 30.0),
            (20.0, 33.0),
        ] {
            assert!(waves.surface(x, t).abs() < 0.09, "{x} {t}");
        }
    }

    /// One component through the piston: its amplitude over the transfer, a quarter of a period behind the surface.
    #[test]
    fn the_piston_moves_by_the_transfer_of_each_wave() {
        let one = Component {
            angular_frequency: 3.0,
            wave_number: WATER.wave_number(3.0),
            amplitude: 0.01,
            phase: 0.4,
        };
        let waves = Waves {
            period: 2.0 * PI / 3.0,
            components: vec![one],
            water: WATER,
        };
        let stroke = waves.stroke(10.0, 0.0);
        let amplitude = 0.01 / WATER.height_over_stroke(one.wave_number);
        for (t, place) in stroke.time.iter().zip(&stroke.place) {
            assert!((place - amplitude * (3.0 * t + 0.4).sin()).abs() < 1e-15);
        }
        assert!((stroke.length() / (2.0 * amplitude) - 1.0).abs() < 1e-3);
    }
}
