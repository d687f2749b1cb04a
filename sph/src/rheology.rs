//! Flow laws: how shear stress follows the rate of shear.
//!
//! ```text
//! τ = η(γ̇) 2D,   γ̇ = √(2 D:D),   D = ½ (∇v + ∇vᵀ)
//! Newtonian          η = μ
//! Bingham            η = μ + τ_y/γ̇                 nothing moves where |τ| < τ_y
//! Herschel-Bulkley   η = K γ̇^(n−1) + τ_y/γ̇
//! ```
//! A perfectly rigid state cannot be integrated: with [`Regularization`] the fluid creeps. The
//! residual speed of a stopped layer of thickness `H` on a slope is `ρ g sin θ H²/(2 η_max)`, and explicit steps scale
//! with `h² ρ/η_max`.
//!
//! Sources: Bingham (1922); Herschel & Bulkley (1926); Papanastasiou (1987).

use crate::error::FluidError;

/// Flow of a fluid below its yield stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Regularization {
    /// `τ_y (1 − exp(−m γ̇))/γ̇` in place of `τ_y/γ̇`, with the time `m`, 100 to 1000 s for mud; > 0; s.
    /// The viscosity at rest is `μ + τ_y m`. In Herschel and Bulkley's `K γ̇^(n−1)` of a shear-thinning fluid,
    /// which is also unbounded, `γ̇` is limited to at least `1/m`.
    Papanastasiou(f64),
    /// `η` not above this viscosity, 100 to 1000 times that of the flowing fluid; > 0; Pa s.
    Bilinear(f64),
}

/// A flow law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rheology {
    /// Stress proportional to the rate of shear.
    Newtonian {
        /// Dynamic viscosity `μ`; >= 0; Pa s.
        dynamic_viscosity: f64,
    },
    /// A yield stress and a constant viscosity beyond it.
    Bingham {
        /// Plastic viscosity `μ`; >= 0; Pa s.
        dynamic_viscosity: f64,
        /// Yield stress `τ_y`; >= 0; Pa.
        yield_stress: f64,
        /// Behavior below it.
        regularization: Regularization,
    },
    /// A yield stress and a power law beyond it.
    HerschelBulkley {
        /// Consistency `K`; >= 0; Pa sⁿ.
        consistency: f64,
        /// Exponent `n`, below 1 for a fluid that thins when sheared; > 0.
        exponent: f64,
        /// Yield stress `τ_y`; >= 0; Pa.
        yield_stress: f64,
        /// Behavior below it.
        regularization: Regularization,
    },
}

impl Rheology {
    /// Apparent viscosity `η` at a rate of shear in 1/s; Pa s.
    pub fn apparent_viscosity(&self, shear_rate: f64) -> f64 {
        match *self {
            Self::Newtonian { dynamic_viscosity } => dynamic_viscosity,
            Self::Bingham {
                dynamic_viscosity,
                yield_stress,
                regularization,
            } => regularization.apply(shear_rate, yield_stress, |_| dynamic_viscosity),
            Self::HerschelBulkley {
                consistency,
                exponent,
                yield_stress,
                regularization,
            } => regularization.apply(shear_rate, yield_stress, |rate| {
                consistency * rate.powf(exponent - 1.0)
            }),
        }
    }

    /// Apparent viscosity at rest, for all laws but a fluid that thickens the largest; Pa s.
    pub fn viscosity_at_rest(&self) -> f64 {
        self.apparent_viscosity(0.0)
    }

    /// Yield stress; Pa.
    pub fn yield_stress(&self) -> f64 {
        match *self {
            Self::Newtonian { .. } => 0.0,
            Self::Bingham { yield_stress, .. } | Self::HerschelBulkley { yield_stress, .. } => {
                yield_stress
            }
        }
    }

    /// Whether the stress at a rate of shear in 1/s is above the yield stress; a Newtonian fluid always flows.
    pub fn is_yielded(&self, shear_rate: f64) -> bool {
        let yield_stress = self.yield_stress();
        yield_stress <= 0.0 || yield_stress < self.apparent_viscosity(shear_rate) * shear_rate
    }

    /// Refuses numbers out of range.
    ///
    /// # Errors
    ///
    /// [`FluidError::Setting`] names the first.
    pub fn check(&self) -> Result<(), FluidError> {
        let not_negative = |name, value: f64| {
            if value.is_finite() && 0.0 <= value {
                Ok(())
            } else {
                let range = "finite and >= 0";
                Err(FluidError::Setting { name, value, range })
            }
        };
        match *self {
            Self::Newtonian { dynamic_viscosity } => {
                not_negative("dynamic_viscosity", dynamic_viscosity)
            }
            Self::Bingham {
                dynamic_viscosity,
                yield_stress,
                regularization,
            } => {
                not_negative("dynamic_viscosity", dynamic_viscosity)?;
                not_negative("yield_stress", yield_stress)?;
                regularization.check()
            }
            Self::HerschelBulkley {
                consistency,
                exponent,
                yield_stress,
                regularization,
            } => {
                not_negative("consistency", consistency)?;
                positive("exponent", exponent)?;
                not_negative("yield_stress", yield_stress)?;
                regularization.check()
            }
        }
    }
}

fn positive(name: &'static str, value: f64) -> Result<(), FluidError> {
    if value.is_finite() && 0.0 < value {
        Ok(())
    } else {
        let range = "finite and > 0";
        Err(FluidError::Setting { name, value, range })
    }
}

impl Regularization {
    fn apply(self, rate: f64, yield_stress: f64, viscous: impl Fn(f64) -> f64) -> f64 {
        match self {
            // (1 − exp(−x))/x, which tends to 1 at rest; exp_m1 keeps its digits there
            Self::Papanastasiou(time) => {
                let x = time * rate;
                let share = if 0.0 < x { -(-x).exp_m1() / x } else { 1.0 };
                viscous(rate.max(1.0 / time)) + yield_stress * time * share
            }
            Self::Bilinear(largest) => {
                let plastic = if 0.0 < yield_stress {
                    yield_stress / rate
                } else {
                    0.0
                };
                (viscous(rate) + plastic).min(largest)
            }
        }
    }

    fn check(self) -> Result<(), FluidError> {
        match self {
            Self::Papanastasiou(time) => positive("regularization time", time),
            Self::Bilinear(largest) => positive("largest viscosity", largest),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MUD: Regularization = Regularization::Bilinear(2000.0);

    fn bingham(regularization: Regularization) -> Rheology {
        Rheology::Bingham {
            dynamic_viscosity: 2.0,
            yield_stress: 60.0,
            regularization,
        }
    }

    #[test]
    fn stress_beyond_yield_is_that_of_the_law() {
        for (law, expected) in [
            (bingham(MUD), 60.0 + 2.0 * 30.0),
            (
                bingham(Regularization::Papanastasiou(100.0)),
                60.0 + 2.0 * 30.0,
            ),
            (
                Rheology::HerschelBulkley {
                    consistency: 5.0,
                    exponent: 0.4,
                    yield_stress: 60.0,
                    regularization: MUD,
                },
                60.0 + 5.0 * 30.0_f64.powf(0.4),
            ),
        ] {
            let stress = law.apparent_viscosity(30.0) * 30.0;
            assert!((stress / expected - 1.0).abs() < 1e-12, "{law:?} {stress}");
            assert!(law.is_yielded(30.0) && !law.is_yielded(1e-4));
        }
    }

    #[test]
    fn viscosity_at_rest_is_finite_and_a_limit() {
        for (law, at_rest) in [
            (bingham(MUD), 2000.0),
            (bingham(Regularization::Papanastasiou(100.0)), 6002.0),
            // nothing to yield: 0/0 at rest
            (
                Rheology::Bingham {
                    dynamic_viscosity: 2.0,
                    yield_stress: 0.0,
                    regularization: Regularization::Papanastasiou(100.0),
                },
                2.0,
            ),
        ] {
            assert!((law.viscosity_at_rest() / at_rest - 1.0).abs() < 1e-12);
            let close = law.apparent_viscosity(1e-9) / at_rest;
            assert!((close - 1.0).abs() < 1e-6, "{close}");
        }
    }

    #[test]
    fn a_law_out_of_range_is_named() {
        let law = bingham(Regularization::Bilinear(0.0));
        assert!(
            matches!(law.check(), Err(FluidError::Setting { name, .. }) if name == "largest viscosity")
        );
    }
}
