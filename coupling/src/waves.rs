//! Water waves of constant depth, and the motion of a piston that makes them. Pure functions; SI units.

pub mod irregular;
pub mod regular;
pub mod solitary;
pub mod theory;

use std::f64::consts::PI;

/// Largest steepness of a wave in deep water, `H/L`; Miche (1944).
const MICHE: f64 = 0.142;
/// Largest height of a solitary wave over the depth; McCowan (1894).
const MCCOWAN: f64 = 0.78;
/// Modes of the near field of a piston that are summed: those left out have a millionth of it.
const NEAR_MODES: u32 = 60;
/// Halvings of a quarter turn, to round-off.
const BISECTIONS: u32 = 52;
/// Steps of Newton's method for the dispersion relation; it converges in four from any depth.
const STEPS: usize = 8;

/// Still water that waves travel on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StillWater {
    /// m.
    pub depth: f64,
    /// Acceleration of gravity; m/s².
    pub gravity: f64,
}

/// Motion of a piston: its places along its direction, at rest before the first and after the last.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stroke {
    /// Increasing; s.
    pub time: Vec<f64>,
    /// One for each time; m.
    pub place: Vec<f64>,
}

/// Value at a time on straight lines between points, the first before and the last after them; 0 without points.
fn between((times, values): (&[f64], &[f64]), time: f64) -> f64 {
    let next = times.partition_point(|t| *t <= time);
    match (values.get(next.wrapping_sub(1)), values.get(next)) {
        (Some(a), Some(b)) => {
            let share = (time - times[next - 1]) / (times[next] - times[next - 1]);
            a + share * (b - a)
        }
        (None, Some(only)) | (Some(only), None) => *only,
        (None, None) => 0.0,
    }
}

impl StillWater {
    /// Wave number of a linear wave of an angular frequency (1/s), by Newton's method from the wave of the shorter of deep
    /// and shallow water.
    ///
    /// ```text
    /// ω² = g k tanh(k h)                                                                              [1/s²]
    /// ```
    pub fn wave_number(&self, angular_frequency: f64) -> f64 {
        let Self { depth, gravity } = *self;
        // in terms of κ = k h and α = ω² h/g: κ tanh κ = α
        let alpha = angular_frequency * angular_frequency * depth / gravity;
        let mut kappa = alpha.max(alpha.sqrt());
        for _ in 0..STEPS {
            let (tanh, sech2) = (kappa.tanh(), kappa.cosh().powi(-2));
            kappa -= (kappa * tanh - alpha) / (tanh + kappa * sech2);
        }
        kappa / depth
    }

    /// Angular frequency of a linear wave of a wave number (1/m); 1/s.
    pub fn angular_frequency(&self, wave_number: f64) -> f64 {
        (self.gravity * wave_number * (wave_number * self.depth).tanh()).sqrt()
    }

    /// Speed at which the energy of a linear wave of a wave number (1/m) travels; m/s.
    ///
    /// ```text
    /// c_g = ω/(2k) (1 + 2kh/sinh 2kh)                                                                 [m/s]
    /// ```
    pub fn group_speed(&self, wave_number: f64) -> f64 {
        let twice = 2.0 * wave_number * self.depth;
        let spread = if twice < 700.0 {
            twice / twice.sinh()
        } else {
            0.0
        };
        0.5 * self.angular_frequency(wave_number) / wave_number * (1.0 + spread)
    }

    /// Height of the wave over the stroke of the piston that makes it, far from the piston; –.
    ///
    /// ```text
    /// H/S = 2 (cosh 2kh − 1)/(sinh 2kh + 2kh)
    /// ```
    /// Source: Havelock (1929); Biesel & Suquet (1951); Dean & Dalrymple (1991), eq. 6.26.
    pub fn height_over_stroke(&self, wave_number: f64) -> f64 {
        let kh = wave_number * self.depth;
        // the same over cosh² kh, which does not overflow
        let tanh = kh.tanh();
        2.0 * tanh * tanh / (tanh + kh / kh.cosh().powi(2))
    }

    /// Surface at a distance (m) before a piston that does not travel, over the displacement of the piston: what decays within
    /// some depths of it, at an angular frequency (1/s); –.
    ///
    /// ```text
    /// Σ 4 sin² k_j h/(sin 2k_j h + 2 k_j h) exp(−k_j x),   ω² = −g k_j tan k_j h
    /// ```
    /// Source: Havelock (1929); Dean & Dalrymple (1991), eq. 6.23.
    pub fn near_field(&self, angular_frequency: f64, distance: f64) -> f64 {
        self.near_modes(angular_frequency)
            .map(|(kh, share)| share * (-kh * distance / self.depth).exp())
            .sum()
    }

    /// Modes of the near field: wave number times depth, surface over displacement at the piston.
    fn near_modes(&self, angular_frequency: f64) -> impl Iterator<Item = (f64, f64)> {
        let alpha = angular_frequency * angular_frequency * self.depth / self.gravity;
        (1..=NEAR_MODES).map(move |j| {
            // κ tan κ = −α between (j − 1/2) π and j π: with κ = jπ − δ, (jπ − δ) tan δ = α
            let end = PI * f64::from(j);
            let (mut low, mut high) = (0.0, 0.5 * PI);
            for _ in 0..BISECTIONS {
                let middle = 0.5 * (low + high);
                if (end - middle) * middle.sin() < alpha * middle.cos() {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            let kh = end - low;
            let share = 4.0 * kh.sin().powi(2) / ((2.0 * kh).sin() + 2.0 * kh);
            (kh, share)
        })
    }

    /// Height at which a regular wave of a wave number (1/m) breaks on constant depth; m.
    ///
    /// ```text
    /// H = 0.142 L tanh(kh)                                        Miche (1944)                         [m]
    /// ```
    pub fn breaking_height(&self, wave_number: f64) -> f64 {
        MICHE * 2.0 * PI / wave_number * (wave_number * self.depth).tanh()
    }

    /// Height at which a solitary wave breaks on constant depth, 0.78 depths; McCowan (1894); m.
    pub fn solitary_breaking_height(&self) -> f64 {
        MCCOWAN * self.depth
    }
}

impl Stroke {
    /// Place at a time (s), on straight lines between its points; m.
    pub fn at(&self, time: f64) -> f64 {
        between((&self.time, &self.place), time)
    }

    /// Way between its ends; m.
    pub fn length(&self) -> f64 {
        let (low, high) = self.range();
        high - low
    }

    /// Lowest and highest place, the start included; m.
    pub fn range(&self) -> (f64, f64) {
        let places = self.place.iter();
        places.fold((0.0, 0.0), |(low, high), &x| {
            (f64::min(low, x), f64::max(high, x))
        })
    }

    /// Largest mean speed between two places; m/s.
    pub fn largest_speed(&self) -> f64 {
        let times = self.time.windows(2);
        times
            .zip(self.place.windows(2))
            .map(|(time, place)| ((place[1] - place[0]) / (time[1] - time[0])).abs())
            .fold(0.0, f64::max)
    }

    /// Places of a function of time (s) in steps of about `interval` (s), from 0 to `duration` (s).
    fn sampled(duration: f64, interval: f64, place: impl Fn(f64) -> f64) -> Self {
        let n = (duration / interval).ceil().max(1.0);
        let time: Vec<f64> = (0..=n as u32)
            .map(|k| f64::from(k) * (duration / n))
            .collect();
        let place = time.iter().map(|&t| place(t)).collect();
        Self { time, place }
    }
}

/// Smooth start: 0 at the beginning, 1 after `ramp` (s), with continuous acceleration.
///
/// ```text
/// r(τ) = τ³ (10 − 15 τ + 6 τ²)
/// ```
fn smooth_start(time: f64, ramp: f64) -> f64 {
    if ramp <= time {
        return 1.0;
    }
    let tau = (time / ramp).max(0.0);
    tau.powi(3) * (10.0 - 15.0 * tau + 6.0 * tau * tau)
}

#[cfg(test)]
mod tests {
    use super::*;

    const WATER: StillWater = StillWater {
        depth: 1.3,
        gravity: 9.81,
    };

    /// From shallow to deep water the relation holds to round-off, and in shallow and deep water its limits do.
    #[test]
    fn the_wave_number_solves_the_dispersion_relation() {
        for exponent in -30..=30 {
            let omega = 3.0 * 10.0_f64.powf(f64::from(exponent) / 10.0);
            let k = WATER.wave_number(omega);
            let back = WATER.angular_frequency(k);
            assert!((back / omega - 1.0).abs() < 1e-12, "{omega}: {k}");
        }
        let deep = WATER.wave_number(40.0);
        assert!((deep / (40.0 * 40.0 / 9.81) - 1.0).abs() < 1e-14);
        // k h = 0.0036: the first term left out is (kh)²/6 = 2e-6
        let shallow = WATER.wave_number(0.01);
        assert!((shallow * (9.81_f64 * 1.3).sqrt() / 0.01 - 1.0).abs() < 3e-6);
    }

    /// A wave of k h = 1: Dean & Dalrymple's eq. 6.26 by its hyperbolic functions typed in.
    #[test]
    fn a_piston_has_its_published_transfer() {
        let k = 1.0 / WATER.depth;
        let (cosh2, sinh2) = (3.762_195_691_083_631_4, 3.626_860_407_847_018_6);
        let expected = 2.0 * (cosh2 - 1.0) / (sinh2 + 2.0);
        assert!((WATER.height_over_stroke(k) / expected - 1.0).abs() < 1e-13);
        // in shallow water k h, in deep water 2
        assert!((WATER.height_over_stroke(1e-4 * k) / 1e-4 - 1.0).abs() < 1e-7);
        assert!((WATER.height_over_stroke(400.0 * k) - 2.0).abs() < 1e-13);
    }

    /// Group speed as the derivative of the frequency by the wave number, by central differences of 1e-5.
    #[test]
    fn energy_travels_at_the_derivative_of_the_frequency() {
        for k in [0.05, 0.5, 2.0, 9.0] {
            let step = 1e-5 * k;
            let slope = (WATER.angular_frequency(k + step) - WATER.angular_frequency(k - step))
                / (2.0 * step);
            // the differences are good to their square
            assert!((WATER.group_speed(k) / slope - 1.0).abs() < 1e-9, "{k}");
        }
    }

    /// The piston displaces `S h` of water when it stands at its end; the wave that travels has `c/k` of it before the piston,
    /// the near field the remainder. The sixty modes miss the tail of a sum over n⁻⁴.
    #[test]
    fn near_field_and_wave_hold_what_the_piston_displaces() {
        for kh in [0.1, 0.5, 1.0, 2.0, 5.0] {
            let k = kh / WATER.depth;
            let near: f64 = (WATER.near_modes(WATER.angular_frequency(k)))
                .map(|(kh, share)| share / kh)
                .sum();
            let travels = WATER.height_over_stroke(k) / kh;
            assert!(
                (near + travels - 1.0).abs() < 1e-5,
                "{kh}: {near} {travels}"
            );
        }
    }

    #[test]
    fn waves_break_at_published_heights() {
        // deep water: a seventh of the length
        let k = 100.0 / WATER.depth;
        assert!((WATER.breaking_height(k) / (0.142 * 2.0 * PI / k) - 1.0).abs() < 1e-15);
        // shallow water: 0.142 · 2π = 0.892 depths
        assert!((WATER.breaking_height(1e-5 * k) / WATER.depth - 0.892).abs() < 3e-4);
    }
}
