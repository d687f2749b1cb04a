//! Units in the headers of tables: `x [mm]`, `x (cm)`, `x_mm`.

/// Units of length and their size; m.
const LENGTHS: [(&str, f64); 13] = [
    ("m", 1.0),
    ("meter", 1.0),
    ("meters", 1.0),
    ("metre", 1.0),
    ("metres", 1.0),
    ("mm", 1e-3),
    ("cm", 1e-2),
    ("dm", 1e-1),
    ("km", 1e3),
    ("ft", 0.3048),
    ("in", 0.0254),
    ("inch", 0.0254),
    ("um", 1e-6),
];
/// Units of time; s.
const TIMES: [(&str, f64); 5] = [
    ("s", 1.0),
    ("sec", 1.0),
    ("seconds", 1.0),
    ("ms", 1e-3),
    ("min", 60.0),
];
/// Units of angles; degrees.
const ANGLES: [(&str, f64); 5] = [
    ("deg", 1.0),
    ("degrees", 1.0),
    ("°", 1.0),
    ("rad", 180.0 / std::f64::consts::PI),
    ("mrad", 0.18 / std::f64::consts::PI),
];
/// Standard gravity (CGPM 1901); m/s².
const STANDARD_GRAVITY: f64 = 9.806_65;
/// Units of acceleration; m/s².
const ACCELERATIONS: [(&str, f64); 8] = [
    ("m/s2", 1.0),
    ("m/s^2", 1.0),
    ("m/s²", 1.0),
    ("ms-2", 1.0),
    ("cm/s2", 1e-2),
    ("cm/s^2", 1e-2),
    ("gal", 1e-2),
    ("g", STANDARD_GRAVITY),
];

/// Units of pressure; Pa.
const PRESSURES: [(&str, f64); 9] = [
    ("pa", 1.0),
    ("hpa", 1e2),
    ("kpa", 1e3),
    ("mbar", 1e2),
    ("bar", 1e5),
    ("n/m2", 1.0),
    ("kn/m2", 1e3),
    ("n/mm2", 1e6),
    // of the yard and the pound: 4.448 221 615 260 5 N over (0.0254 m)²
    ("psi", 6_894.757_293_168),
];
/// Units of force; N.
const FORCES: [(&str, f64); 2] = [("n", 1.0), ("kn", 1e3)];
/// Units of speed; m/s.
const SPEEDS: [(&str, f64); 6] = [
    ("m/s", 1.0),
    ("cm/s", 1e-2),
    ("mm/s", 1e-3),
    ("km/h", 1.0 / 3.6),
    ("ft/s", 0.3048),
    ("ms-1", 1.0),
];

/// Quantity of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// m.
    Length,
    /// s.
    Time,
    /// Degrees.
    Angle,
    /// m/s².
    Acceleration,
    /// Pa.
    Pressure,
    /// N.
    Force,
    /// m/s.
    Speed,
}

impl Quantity {
    /// All quantities whose units are known.
    pub const ALL: [Self; 7] = [
        Self::Length,
        Self::Time,
        Self::Angle,
        Self::Acceleration,
        Self::Pressure,
        Self::Force,
        Self::Speed,
    ];

    /// The quantity of a unit.
    pub fn of(unit: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|q| q.unit(unit).is_some())
    }

    fn units(self) -> &'static [(&'static str, f64)] {
        match self {
            Self::Length => &LENGTHS,
            Self::Time => &TIMES,
            Self::Angle => &ANGLES,
            Self::Acceleration => &ACCELERATIONS,
            Self::Pressure => &PRESSURES,
            Self::Force => &FORCES,
            Self::Speed => &SPEEDS,
        }
    }

    /// Size of a unit, `None` for one that is not known: m, s, degrees or m/s² per unit.
    pub fn unit(self, name: &str) -> Option<f64> {
        let name = name.to_lowercase();
        let mut units = self.units().iter();
        units.find(|(unit, _)| *unit == name).map(|(_, size)| *size)
    }

    /// Units that are known, for messages.
    pub fn known(self) -> &'static str {
        match self {
            Self::Length => "m, mm, cm, dm, km, ft, in",
            Self::Time => "s, ms, min",
            Self::Angle => "deg, rad, mrad",
            Self::Acceleration => "m/s2, cm/s2, gal, g",
            Self::Pressure => "Pa, hPa, kPa, mbar, bar, psi",
            Self::Force => "N, kN",
            Self::Speed => "m/s, cm/s, mm/s, km/h, ft/s",
        }
    }
}

/// Name and unit of a header in brackets or parentheses; of `x_mm` only if `mm` is a unit of the quantity. The unit is
/// empty where there is none.
pub fn split(header: &str, quantity: Quantity) -> (&str, &str) {
    let header = header.trim();
    for (open, close) in [('[', ']'), ('(', ')')] {
        let inside = header.strip_suffix(close);
        if let Some((name, unit)) = inside.and_then(|rest| rest.rsplit_once(open)) {
            return (name.trim(), unit.trim());
        }
    }
    match header.rsplit_once(['_', ' ']) {
        Some((name, unit)) if quantity.unit(unit).is_some() => (name.trim(), unit),
        _ => (header, ""),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_split_off() {
        for (header, name, unit) in [
            ("x", "x", ""),
            ("x [mm]", "x", "mm"),
            ("x (cm)", "x", "cm"),
            ("x[ft]", "x", "ft"),
            ("x_mm", "x", "mm"),
            ("x mm", "x", "mm"),
            ("x_east", "x_east", ""),
            ("x [parsec]", "x", "parsec"),
        ] {
            assert_eq!(split(header, Quantity::Length), (name, unit), "{header}");
        }
    }

    #[test]
    fn units_have_their_size() {
        assert_eq!(Quantity::Length.unit("MM"), Some(1e-3));
        assert_eq!(Quantity::Length.unit("parsec"), None);
        assert_eq!(Quantity::Acceleration.unit("g"), Some(9.806_65));
        assert_eq!(Quantity::Time.unit("ms"), Some(1e-3));
        let half_turn = Quantity::Angle
            .unit("rad")
            .map(|size| size * std::f64::consts::PI);
        assert!(half_turn.is_some_and(|angle| (angle - 180.0).abs() < 1e-12));
    }
}
