//! Ranges of the properties of materials and joints: one table, for blocks and for scenes.

use std::f64::consts::FRAC_PI_2;
use std::fmt::{self, Display, Formatter};

/// A number of a material, or of a joint between two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Property {
    /// Density.
    Density,
    /// Friction angle.
    FrictionAngle,
    /// Friction angle once a joint has slipped or broken.
    ResidualFrictionAngle,
    /// Normal stiffness of joints per area.
    JointStiffness,
    /// Cohesion until a joint breaks.
    Cohesion,
    /// Cohesion of a joint that has broken.
    ResidualCohesion,
    /// Tensile strength until a joint breaks.
    TensileStrength,
    /// Normal restitution.
    Restitution,
    /// Normal penalty stiffness of a whole contact.
    ContactStiffness,
    /// Shear over normal penalty stiffness.
    ShearStiffnessRatio,
    /// Damping ratio of the shear dashpots.
    ShearDampingRatio,
    /// Rolling resistance of spheres.
    RollingFriction,
    /// Twisting resistance of spheres.
    TwistingFriction,
    /// Young's modulus.
    YoungModulus,
    /// Viscosity of the strain rate.
    Viscosity,
    /// Poisson's ratio.
    PoissonRatio,
}

/// Range of a property, in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PropertyRange {
    /// The property.
    pub property: Property,
    /// Its name.
    pub name: &'static str,
    /// Its values.
    pub interval: Interval,
    /// Its unit; empty for a ratio.
    pub unit: &'static str,
}

/// Values that a property may have, all of them finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Interval {
    /// Above zero.
    Positive,
    /// Zero or above.
    NotNegative,
    /// From 0 to 1.
    Unit,
    /// From 0 to below a right angle; rad.
    Acute,
    /// From 0 to the peak value, which is the named property.
    UpTo(Property),
    /// Between two numbers, without them.
    Between(f64, f64),
}

impl PropertyRange {
    /// Ranges of all properties.
    pub const ALL: [Self; 16] = {
        use Interval::{Acute, Between, NotNegative, Positive, Unit, UpTo};
        use Property::*;
        [
            Self::new(Density, "density", Positive, "kg/m³"),
            Self::new(FrictionAngle, "friction_angle", Acute, "rad"),
            Self::new(
                ResidualFrictionAngle,
                "residual_friction_angle",
                UpTo(FrictionAngle),
                "rad",
            ),
            Self::new(JointStiffness, "joint_stiffness", Positive, "Pa/m"),
            Self::new(Cohesion, "cohesion", NotNegative, "Pa"),
            Self::new(ResidualCohesion, "residual_cohesion", UpTo(Cohesion), "Pa"),
            Self::new(TensileStrength, "tensile_strength", NotNegative, "Pa"),
            Self::new(Restitution, "restitution", Unit, ""),
            Self::new(ContactStiffness, "contact_stiffness", Positive, "N/m"),
            Self::new(
                ShearStiffnessRatio,
                "shear_stiffness_ratio",
                NotNegative,
                "",
            ),
            Self::new(ShearDampingRatio, "shear_damping_ratio", NotNegative, ""),
            Self::new(RollingFriction, "rolling_friction", NotNegative, ""),
            Self::new(TwistingFriction, "twisting_friction", NotNegative, ""),
            Self::new(YoungModulus, "young_modulus", Positive, "Pa"),
            Self::new(Viscosity, "viscosity", NotNegative, "Pa s"),
            Self::new(PoissonRatio, "poisson_ratio", Between(-1.0, 0.5), ""),
        ]
    };

    const fn new(
        property: Property,
        name: &'static str,
        interval: Interval,
        unit: &'static str,
    ) -> Self {
        Self {
            property,
            name,
            interval,
            unit,
        }
    }

    /// Properties out of their ranges, with their values; `value` gives them in SI units, `None` where there is none.
    pub fn violations(
        value: impl Fn(Property) -> Option<f64>,
    ) -> impl Iterator<Item = (Self, f64)> {
        Self::ALL.into_iter().filter_map(move |range| {
            let found = value(range.property)?;
            let peak = match range.interval {
                Interval::UpTo(peak) => value(peak).unwrap_or(f64::INFINITY),
                _ => f64::INFINITY,
            };
            (!range.interval.contains(found, peak)).then_some((range, found))
        })
    }
}

impl Interval {
    /// Whether a value is allowed where the peak value is `peak`.
    fn contains(self, value: f64, peak: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Positive => 0.0 < value,
                Self::NotNegative => 0.0 <= value,
                Self::Unit => (0.0..=1.0).contains(&value),
                Self::Acute => (0.0..FRAC_PI_2).contains(&value),
                Self::UpTo(_) => (0.0..=peak).contains(&value),
                Self::Between(low, high) => low < value && value < high,
            }
    }
}

impl Property {
    fn name(self) -> &'static str {
        let range = PropertyRange::ALL
            .iter()
            .find(|range| range.property == self);
        range.map_or("", |range| range.name)
    }
}

/// "must be > 0 kg/m³".
impl Display for PropertyRange {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        write!(f, "must be {}", self.interval)?;
        match self.unit {
            "" => Ok(()),
            unit => write!(f, " {unit}"),
        }
    }
}

impl Display for Interval {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        match self {
            Self::Positive => f.write_str("> 0"),
            Self::NotNegative => f.write_str(">= 0"),
            Self::Unit => f.write_str("in [0, 1]"),
            Self::Acute => f.write_str("in [0, π/2)"),
            Self::UpTo(peak) => write!(f, "in [0, {}]", peak.name()),
            Self::Between(low, high) => write!(f, "above {low} and below {high}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_stated_in_words() {
        let stated = PropertyRange::ALL.map(|range| format!("{}: {range}", range.name));
        assert_eq!(
            stated,
            [
                "density: must be > 0 kg/m³",
                "friction_angle: must be in [0, π/2) rad",
                "residual_friction_angle: must be in [0, friction_angle] rad",
                "joint_stiffness: must be > 0 Pa/m",
                "cohesion: must be >= 0 Pa",
                "residual_cohesion: must be in [0, cohesion] Pa",
                "tensile_strength: must be >= 0 Pa",
                "restitution: must be in [0, 1]",
                "contact_stiffness: must be > 0 N/m",
                "shear_stiffness_ratio: must be >= 0",
                "shear_damping_ratio: must be >= 0",
                "rolling_friction: must be >= 0",
                "twisting_friction: must be >= 0",
                "young_modulus: must be > 0 Pa",
                "viscosity: must be >= 0 Pa s",
                "poisson_ratio: must be above -1 and below 0.5",
            ]
        );
    }

    #[test]
    fn values_at_the_ends_of_a_range() {
        // a value, and whether each interval has it, where the peak value is 0.4
        let intervals = [
            Interval::Positive,
            Interval::NotNegative,
            Interval::Unit,
            Interval::Acute,
            Interval::UpTo(Property::Cohesion),
            Interval::Between(-1.0, 0.5),
        ];
        for (value, expected) in [
            (-1.0, [false, false, false, false, false, false]),
            (0.0, [false, true, true, true, true, true]),
            (0.4, [true, true, true, true, true, true]),
            (0.5, [true, true, true, true, false, false]),
            (1.0, [true, true, true, true, false, false]),
            (FRAC_PI_2, [true, true, false, false, false, false]),
            (f64::INFINITY, [false; 6]),
            (f64::NAN, [false; 6]),
        ] {
            let found = intervals.map(|interval| interval.contains(value, 0.4));
            assert_eq!(found, expected, "{value}");
        }
    }
}
