//! Drag of grains in water.
//!
//! ```text
//! U = ε |u − v|,   Re = ρ U d/η,   φ = 1 − ε,   β = f_d/|u − v|                                            [N s/m]
//! Wen & Yu      f_d = C (π/8) d² ρ U² ε^−3.65,   C = 24/Re (1 + 0.15 Re^0.687), 0.44 above Re 1000
//! Di Felice     f_d = C (π/8) d² ρ U² ε^−ξ,      C = (0.63 + 4.8 Re^−½)²,   ξ = 3.7 − 0.65 exp(−(1.5 − log₁₀ Re)²/2)
//! Ergun         f_d = V ε [150 η φ U/(ε³ d²) + 1.75 ρ U²/(ε³ d)]
//! Gidaspow      Ergun below ε of 0.75, Wen & Yu above 0.85, mixed in between: each alone jumps at 0.8
//! Beetstra      f_d = 3π η d U F,   F = 10 φ/ε² + ε² (1 + 1.5 √φ)
//!               + 0.413 Re/(24 ε²) (1/ε + 3 ε φ + 8.4 Re^−0.343)/(1 + 10^{3φ} Re^{−(1 + 4φ)/2})
//! ```
//! `f_d` is without the force of the pressure gradient on the grain's volume. With a yield stress `τ₀`, `η` is
//! `η (1 + 2.93 Bi^0.83)`, in `Re` too, `Bi = τ₀ d/(η U)`.
//!
//! Sources: Wen & Yu (1966); Di Felice (1994); Ergun (1952); Gidaspow (1994); Beetstra, van der Hoef & Kuipers (2007);
//! Blackery & Mitsoulis (1997).

use std::f64::consts::PI;

/// Slip below which resistance does not change: a law with a yield stress has none at rest; m/s.
const SLOWEST: f64 = 1e-9;
/// Reynolds number above which the drag coefficient of Wen & Yu is constant.
const TURBULENT: f64 = 1000.0;
/// Porosities between which Gidaspow's two laws are mixed.
const MIXED: (f64, f64) = (0.75, 0.85);

/// Law of the drag of grains.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DragLaw {
    /// From simulations of flow through packings, over all porosities.
    #[default]
    Beetstra,
    /// Single grains, with an exponent for neighbors that depends on the flow.
    DiFelice,
    /// Ergun's when dense, Wen & Yu's when dilute.
    Gidaspow,
    /// Packed beds.
    Ergun,
    /// Dilute suspensions.
    WenYu,
}

/// Water that resists.
#[derive(Clone, Copy, Debug)]
pub struct Water {
    /// kg/m³.
    pub density: f64,
    /// Of mud the plastic one; Pa s.
    pub dynamic_viscosity: f64,
    /// Pa.
    pub yield_stress: f64,
}

/// What the laws are written in.
struct Flow {
    /// m.
    diameter: f64,
    /// –.
    porosity: f64,
    /// Superficial slip; m/s.
    speed: f64,
    /// kg/m³.
    density: f64,
    /// Pa s.
    viscosity: f64,
    /// –.
    reynolds: f64,
}

impl DragLaw {
    /// Drag over slip on a grain of a diameter (m) where water fills a share of space (–), at a slip (m/s); N s/m.
    pub fn resistance(self, water: &Water, diameter: f64, porosity: f64, slip: f64) -> f64 {
        let speed = porosity * slip.max(SLOWEST);
        let plastic = water.dynamic_viscosity;
        let bingham = water.yield_stress * diameter / (plastic * speed);
        let viscosity = plastic * (1.0 + 2.93 * bingham.powf(0.83));
        let flow = Flow {
            diameter,
            porosity,
            speed,
            density: water.density,
            viscosity,
            reynolds: water.density * speed * diameter / viscosity,
        };
        let force = match self {
            Self::Beetstra => flow.beetstra(),
            Self::DiFelice => flow.di_felice(),
            Self::Ergun => flow.ergun(),
            Self::WenYu => flow.wen_yu(),
            Self::Gidaspow => {
                let (dense, dilute) = MIXED;
                let share = ((porosity - dense) / (dilute - dense)).clamp(0.0, 1.0);
                match share {
                    0.0 => flow.ergun(),
                    1.0 => flow.wen_yu(),
                    _ => (1.0 - share) * flow.ergun() + share * flow.wen_yu(),
                }
            }
        };
        force * porosity / speed
    }
}

impl Flow {
    /// `3π η d U`; N.
    fn stokes(&self) -> f64 {
        3.0 * PI * self.viscosity * self.diameter * self.speed
    }

    fn wen_yu(&self) -> f64 {
        let factor = match self.reynolds < TURBULENT {
            true => 1.0 + 0.15 * self.reynolds.powf(0.687),
            false => 0.44 * self.reynolds / 24.0,
        };
        self.stokes() * factor * self.porosity.powf(-3.65)
    }

    fn di_felice(&self) -> f64 {
        let exponent = 3.7 - 0.65 * (-0.5 * (1.5 - self.reynolds.log10()).powi(2)).exp();
        // C Re/24
        let factor = (0.63 * self.reynolds.sqrt() + 4.8).powi(2) / 24.0;
        self.stokes() * factor * self.porosity.powf(-exponent)
    }

    fn ergun(&self) -> f64 {
        let (d, u, e) = (self.diameter, self.speed, self.porosity);
        let viscous = 150.0 * self.viscosity * (1.0 - e) / (d * d);
        let inertial = 1.75 * self.density * u / d;
        PI / 6.0 * d.powi(3) * u * (viscous + inertial) / (e * e)
    }

    fn beetstra(&self) -> f64 {
        let (e, phi, re) = (self.porosity, 1.0 - self.porosity, self.reynolds);
        let slow = 10.0 * phi / (e * e) + e * e * (1.0 + 1.5 * phi.sqrt());
        let numerator = 1.0 / e + 3.0 * e * phi + 8.4 * re.powf(-0.343);
        let denominator = 1.0 + 10_f64.powf(3.0 * phi) * re.powf(-0.5 * (1.0 + 4.0 * phi));
        self.stokes() * (slow + 0.413 * re / (24.0 * e * e) * numerator / denominator)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WATER: Water = Water {
        density: 1000.0,
        dynamic_viscosity: 1e-3,
        yield_stress: 0.0,
    };

    /// Speed at which drag carries the submerged weight of one grain of 2500 kg/m³, by bisection; m/s.
    fn settling(law: DragLaw, water: &Water, diameter: f64, porosity: f64) -> f64 {
        let volume = PI / 6.0 * diameter.powi(3);
        // in a suspension that settles in a closed box the pressure gradient carries the mixture
        let weight = volume * (2500.0 - water.density) * 9.81 * porosity;
        let (mut low, mut high) = (1e-9, 10.0);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            match law.resistance(water, diameter, porosity, middle) * middle < weight {
                true => low = middle,
                false => high = middle,
            }
        }
        low
    }

    #[test]
    fn one_grain_sinks_at_the_speed_of_its_law() {
        // computed once from the formulas above by another program
        for (law, diameter, expected) in [
            (DragLaw::WenYu, 1e-4, 0.0072941),
            (DragLaw::DiFelice, 1e-4, 0.0069215),
            (DragLaw::WenYu, 1e-3, 0.145946),
            (DragLaw::DiFelice, 1e-3, 0.134104),
        ] {
            let found = settling(law, &WATER, diameter, 1.0);
            // digits of the values
            assert!((found / expected - 1.0).abs() < 1e-5, "{law:?} {found}");
        }
    }

    #[test]
    fn a_block_of_grains_settles_slower() {
        // closed box: grains sink at ε times the slip
        for (law, at) in [
            (DragLaw::WenYu, [0.106458, 0.074357, 0.029849]),
            (DragLaw::DiFelice, [0.101946, 0.074880, 0.034357]),
            (DragLaw::Beetstra, [0.091064, 0.064547, 0.028114]),
        ] {
            for (porosity, expected) in [0.9, 0.8, 0.6].into_iter().zip(at) {
                let found = porosity * settling(law, &WATER, 1e-3, porosity);
                assert!((found / expected - 1.0).abs() < 1e-4, "{law:?} {found}");
            }
        }
    }

    #[test]
    fn a_packed_bed_takes_the_pressure_of_ergun() {
        let (porosity, speed, diameter) = (0.4, 0.01, 0.01);
        for (law, expected) in [
            (DragLaw::Ergun, 248.44),
            (DragLaw::Gidaspow, 248.44),
            (DragLaw::DiFelice, 243.17),
            (DragLaw::Beetstra, 242.43),
        ] {
            let slip = speed / porosity;
            let force = law.resistance(&WATER, diameter, porosity, slip) * slip;
            let per_volume = (1.0 - porosity) / (PI / 6.0 * diameter.powi(3));
            let gradient = per_volume * force / porosity;
            assert!(
                (gradient / expected - 1.0).abs() < 1e-4,
                "{law:?} {gradient}"
            );
        }
    }

    #[test]
    fn a_yield_stress_holds_a_grain() {
        let mud = |yield_stress| Water {
            density: 1500.0,
            dynamic_viscosity: 20.0,
            yield_stress,
        };
        for (stress, expected) in [
            (0.0, 0.224377),
            (10.0, 0.0941355),
            (20.0, 0.0302088),
            (40.0, 0.0021101),
        ] {
            let found = settling(DragLaw::WenYu, &mud(stress), 0.1, 1.0);
            assert!((found / expected - 1.0).abs() < 1e-4, "{stress} {found}");
        }
    }

    #[test]
    fn resistance_is_finite_at_rest() {
        for law in [
            DragLaw::Beetstra,
            DragLaw::DiFelice,
            DragLaw::Gidaspow,
            DragLaw::Ergun,
            DragLaw::WenYu,
        ] {
            for porosity in [0.2, 0.6, 1.0] {
                let found = law.resistance(&WATER, 1e-3, porosity, 0.0);
                assert!(
                    found.is_finite() && 0.0 < found,
                    "{law:?} {porosity} {found}"
                );
            }
        }
    }
}
