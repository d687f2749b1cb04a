//! Pressure from density, and the energy stored in it.

/// What is done with pressures below zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NegativePressure {
    /// Set to zero. Summation density is low at free surfaces; without this, particles clump.
    Clamped,
    /// Kept.
    Kept,
}

/// `p = c₀² (ρ − ρ₀)`, optionally clamped at zero.
///
/// Geraili Mikola & Sitar (2014), Eq. 16 prints `p = k ρ` with `k` left open; the stiffness is the
/// squared sound speed, and the reference density must be taken off.
#[derive(Clone, Copy, Debug)]
pub struct LinearState {
    /// Reference density; kg/m³.
    pub reference_density: f64,
    /// Sound speed; m/s.
    pub sound_speed: f64,
    /// What is done with pressures below zero.
    pub negative: NegativePressure,
}

impl LinearState {
    /// Pressure at a density; Pa.
    #[inline]
    pub fn pressure(&self, density: f64) -> f64 {
        let p = self.sound_speed * self.sound_speed * (density - self.reference_density);
        match self.negative {
            NegativePressure::Clamped => p.max(0.0),
            NegativePressure::Kept => p,
        }
    }

    /// Energy of compression per mass, zero at the reference density; J/kg.
    ///
    /// ```text
    /// e = ∫ p/ρ² dρ = c₀² [ ln(ρ/ρ₀) + ρ₀/ρ − 1 ]
    /// ```
    pub fn specific_energy(&self, density: f64) -> f64 {
        if self.negative == NegativePressure::Clamped && density <= self.reference_density {
            return 0.0;
        }
        // ln(1+s) − s/(1+s) by way of ln_1p keeps its digits for the small s of nearly
        // incompressible flow, where the two terms cancel
        let s = (density - self.reference_density) / self.reference_density;
        self.sound_speed * self.sound_speed * (s.ln_1p() - s / (1.0 + s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WATER: LinearState = LinearState {
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
        let kept = LinearState {
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
