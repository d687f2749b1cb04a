//! Pressure from density, and the energy stored in it.

/// Treatment of negative pressures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NegativePressure {
    /// Set to zero. Summation density is low at free surfaces; without this, particles clump.
    Clamped,
    /// Kept.
    Kept,
}

/// Pressure as a function of density.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StateEquation {
    /// `p = c₀² (ρ − ρ₀)`.
    Linear,
    /// `p = B ((ρ/ρ₀)⁷ − 1)`, `B = c₀² ρ₀/7`.
    Tait,
}

/// Pressure from density with its numbers, optionally clamped at zero.
///
/// Geraili Mikola & Sitar (2014), Eq. 16 prints `p = k ρ` with `k` left open; the stiffness is the
/// squared sound speed, and the reference density must be taken off.
#[derive(Clone, Copy, Debug)]
pub struct State {
    /// The law.
    pub equation: StateEquation,
    /// Reference density; kg/m³.
    pub reference_density: f64,
    /// Sound speed at the reference density; m/s.
    pub sound_speed: f64,
    /// Treatment of negative pressures.
    pub negative: NegativePressure,
}

impl State {
    /// Pressure at a density; Pa.
    #[inline]
    pub fn pressure(&self, density: f64) -> f64 {
        let c2 = self.sound_speed * self.sound_speed;
        let excess = density - self.reference_density;
        let p = match self.equation {
            StateEquation::Linear => c2 * excess,
            StateEquation::Tait => {
                // (1 + s)⁷ − 1 by its factors keeps the digits of a small s
                let s = excess / self.reference_density;
                let (r, r2) = (1.0 + s, (1.0 + s) * (1.0 + s));
                let sum = 1.0 + r + r2 * (1.0 + r) + r2 * r2 * (1.0 + r) + r2 * r2 * r2;
                c2 * self.reference_density / 7.0 * s * sum
            }
        };
        match self.negative {
            NegativePressure::Clamped => p.max(0.0),
            NegativePressure::Kept => p,
        }
    }

    /// Density at a pressure; kg/m³. Below `−B` Tait's law is undefined, and zero is returned.
    pub fn density(&self, pressure: f64) -> f64 {
        let c2 = self.sound_speed * self.sound_speed;
        match self.equation {
            StateEquation::Linear => self.reference_density + pressure / c2,
            StateEquation::Tait => {
                let b = c2 * self.reference_density / 7.0;
                self.reference_density * (1.0 + pressure / b).max(0.0).powf(1.0 / 7.0)
            }
        }
    }

    /// Pressure under a depth of water at rest, compressed by its own weight; Pa.
    ///
    /// ```text
    /// linear   p = c₀² ρ₀ (e^{g z/c₀²} − 1)
    /// Tait     p = B ([1 + 6 g z/c₀²]^{7/6} − 1)
    /// ```
    pub fn hydrostatic_pressure(&self, gravity: f64, depth: f64) -> f64 {
        let c2 = self.sound_speed * self.sound_speed;
        let x = gravity * depth / c2;
        match self.equation {
            StateEquation::Linear => c2 * self.reference_density * x.exp_m1(),
            StateEquation::Tait => {
                c2 * self.reference_density / 7.0 * ((1.0 + 6.0 * x).max(0.0).powf(7.0 / 6.0) - 1.0)
            }
        }
    }

    /// Energy of compression per mass, zero at the reference density; J/kg.
    ///
    /// ```text
    /// e = ∫ p/ρ² dρ
    /// linear   c₀² [ ln(1+s) − s/(1+s) ],   s = ρ/ρ₀ − 1
    /// Tait     B/ρ₀ [ ((1+s)⁶ − 1)/6 + 1/(1+s) − 1 ]
    /// ```
    pub fn specific_energy(&self, density: f64) -> f64 {
        if self.negative == NegativePressure::Clamped && density <= self.reference_density {
            return 0.0;
        }
        let s = (density - self.reference_density) / self.reference_density;
        let c2 = self.sound_speed * self.sound_speed;
        match self.equation {
            // ln(1+s) − s/(1+s) with ln_1p is accurate for the small s of nearly
            // incompressible flow, where the two terms cancel
            StateEquation::Linear => c2 * (s.ln_1p() - s / (1.0 + s)),
            // the same bracket as s² times a polynomial over 1 + s
            StateEquation::Tait => {
                let polynomial = 21.0 + s * (35.0 + s * (35.0 + s * (21.0 + s * (7.0 + s))));
                c2 / 7.0 * s * s * polynomial / (6.0 * (1.0 + s))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WATER: State = State {
        equation: StateEquation::Linear,
        reference_density: 1000.0,
        sound_speed: 30.0,
        negative: NegativePressure::Clamped,
    };

    #[test]
    fn misprint_of_eq_16_water_at_rest_has_no_pressure() {
        assert_eq!(WATER.pressure(1000.0), 0.0);
        assert!((WATER.pressure(1010.0) - 9000.0).abs() < 1e-9);
    }

    #[test]
    fn clamping_is_a_choice() {
        assert_eq!(WATER.pressure(990.0), 0.0);
        let kept = State {
            negative: NegativePressure::Kept,
            ..WATER
        };
        assert!((kept.pressure(990.0) + 9000.0).abs() < 1e-9);
    }

    #[test]
    fn energy_is_the_integral_of_pressure_over_density_squared() {
        let (from, to, n) = (1000.0, 1030.0, 10_000);
        let step = (to - from) / f64::from(n);
        let integral: f64 = (0..n)
            .map(|i| {
                let density = from + (f64::from(i) + 0.5) * step;
                WATER.pressure(density) / (density * density) * step
            })
            .sum();
        // midpoint rule, 1e4 intervals
        assert!((integral / WATER.specific_energy(to) - 1.0).abs() < 1e-7);
    }
}
