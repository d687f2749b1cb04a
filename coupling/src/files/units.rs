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
}

impl Quantity {
    fn units(self) -> &'static [(&'static str, f64)] {
        match self {
            Self::Length => &LENGTHS,
            Self::Time => &TIMES,
            Self::Angle => &ANGLES,
            Self::Acceleration => &ACCELERATIONS,
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
