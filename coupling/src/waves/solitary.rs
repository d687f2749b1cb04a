//! Solitary waves by a piston.

use super::{StillWater, Stroke};

/// Truncation of the wave, where tanh is nearly one: a thousandth of its height is left out.
const FADE: f64 = 4.0;
/// Intervals of a record.
const INTERVALS: u32 = 400;

/// Solitary wave, `η = H sech²(K (x − ct))`, with Rayleigh's decay of its outskirts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solitary {
    /// m.
    pub height: f64,
    /// m.
    pub depth: f64,
    /// Decay `K = √(3H/(4h²(h + H)))`; 1/m.
    pub decay: f64,
    /// `√(g (h + H))`; m/s.
    pub celerity: f64,
}

impl Solitary {
    /// Solitary wave of a height (m).
    ///
    /// Source: Rayleigh (1876). Boussinesq's decay, `√(3H/4h³)`, leaves more waves behind: Guizien & Barthelemy (2002).
    pub fn new(water: StillWater, height: f64) -> Self {
        let StillWater { depth, gravity } = water;
        Self {
            height,
            depth,
            decay: (0.75 * height / (depth + height)).sqrt() / depth,
            celerity: (gravity * (depth + height)).sqrt(),
        }
    }

    /// Way of the piston: the volume of the wave over the depth.
    ///
    /// ```text
    /// S = ∫η dx/h = 2H/(K h) = √(16 H (h + H)/3)                                                       [m]
    /// ```
    /// With Boussinesq's decay it is Goring's `√(16 H h/3)`.
    pub fn stroke_length(&self) -> f64 {
        2.0 * self.height / (self.decay * self.depth)
    }

    /// Length that holds 95 % of the volume of the wave: twice the distance at which tanh is 0.95; m.
    pub fn length(&self) -> f64 {
        2.0 * 0.95_f64.atanh() / self.decay
    }

    /// Motion of the piston, which moves with the depth-averaged water at its own place. It starts at rest.
    ///
    /// ```text
    /// dξ/dt = c η(ξ, t)/(h + η(ξ, t)),   ξ = S/2 tanh(K (ct − ξ))                                      [m]
    /// ```
    /// Source: Goring (1978), W. M. Keck Lab. report KH-R-38.
    pub fn stroke(&self) -> Stroke {
        let phases =
            (0..=INTERVALS).map(|k| FADE * (2.0 * f64::from(k) / f64::from(INTERVALS) - 1.0));
        let (time, place) = phases
            .map(|phase| {
                (
                    self.time(phase) - self.time(-FADE),
                    self.place(phase) - self.place(-FADE),
                )
            })
            .unzip();
        Stroke { time, place }
    }

    /// Place of the piston where the wave has a phase before it, from the middle of its way; m.
    fn place(&self, phase: f64) -> f64 {
        0.5 * self.stroke_length() * phase.tanh()
    }

    /// Time at which the wave has a phase before the piston, which gives it without iteration, from that of the crest; s.
    fn time(&self, phase: f64) -> f64 {
        (phase / self.decay + self.place(phase)) / self.celerity
    }

    /// Surface at a distance (m) from the piston at rest; m.
    pub fn surface(&self, distance: f64, time: f64) -> f64 {
        let (t, x) = (time + self.time(-FADE), distance + self.place(-FADE));
        let phase = self.decay * (self.celerity * t - x);
        self.height / phase.cosh().powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WATER: StillWater = StillWater {
        depth: 1.0,
        gravity: 9.81,
    };

    /// The stroke is the volume of the wave over the depth, by the sum over its profile, and for small waves Goring's.
    #[test]
    fn the_stroke_displaces_the_volume_of_the_wave() {
        for height in [0.01, 0.3, 0.6] {
            let wave = Solitary::new(WATER, height);
            let step = 0.01;
            let profile = |x: f64| height / (wave.decay * x).cosh().powi(2);
            let volume: f64 = (-20_000..=20_000)
                .map(|k| profile(f64::from(k) * step) * step)
                .sum();
            // a sum over a smooth peak is exact to round-off; the ends at 200 m have 1e-15 of it
            assert!((wave.stroke_length() * WATER.depth / volume - 1.0).abs() < 1e-10);
            let goring = (16.0 * height * WATER.depth / 3.0).sqrt();
            let rayleigh = (1.0 + height / WATER.depth).sqrt();
            assert!((wave.stroke_length() / (goring * rayleigh) - 1.0).abs() < 1e-14);
        }
    }

    /// At every place of the record the piston has the speed of the depth-averaged water; chords of the record are good to
    /// the square of their phase.
    #[test]
    fn the_piston_moves_with_the_water() {
        let wave = Solitary::new(WATER, 0.3);
        let stroke = wave.stroke();
        let start = 0.5 * wave.stroke_length() * FADE.tanh();
        let zero = (FADE / wave.decay + start) / wave.celerity;
        for (time, place) in stroke.time.windows(2).zip(stroke.place.windows(2)) {
            let speed = (place[1] - place[0]) / (time[1] - time[0]);
            let (t, x) = (
                0.5 * (time[0] + time[1]) - zero,
                0.5 * (place[0] + place[1]) - start,
            );
            let eta = 0.3 / (wave.decay * (wave.celerity * t - x)).cosh().powi(2);
            let expected = wave.celerity * eta / (WATER.depth + eta);
            assert!((speed - expected).abs() < 2e-4 * wave.celerity, "{t}");
        }
        // what the truncation leaves of the way: 1 - tanh 4
        assert!((stroke.length() / wave.stroke_length() - FADE.tanh()).abs() < 1e-12);
        assert_eq!((stroke.time[0], stroke.place[0]), (0.0, 0.0));
    }
}
