//! Units in the headers of tables, `x [mm]`, `x (cm)`, `x_mm`, and behind numbers of scenes, "25 mm".

mod expression;
pub mod table;

use expression::{Composed, readings};
use table::KINDS;

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

    /// Unit of its values.
    fn unit_of_values(self) -> &'static str {
        match self {
            Self::Length => "m",
            Self::Time => "s",
            Self::Angle => "degrees",
            Self::Acceleration => "m/s²",
            Self::Pressure => "Pa",
            Self::Force => "N",
            Self::Speed => "m/s",
        }
    }

    /// Size of a unit, `None` for one that is not known: m, s, degrees or m/s² per unit.
    pub fn unit(self, name: &str) -> Option<f64> {
        // older records write m s⁻² so
        let is_old = name.eq_ignore_ascii_case("ms-2");
        let name = if is_old { "m s-2" } else { name };
        converted("1", name, self.unit_of_values())
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

/// Fault of a quantity written with its unit; the message goes behind the name of the field.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct QuantityError {
    /// Text found and units allowed; lowercase.
    pub message: String,
}

/// Whether a text begins as a number and goes on as something else: a quantity, well or badly written.
pub fn is_quantity(text: &str) -> bool {
    let (number, unit) = parts(text);
    !unit.is_empty() && number.replace(['_', ','], "").parse::<f64>().is_ok()
}

/// Value of a quantity such as `25 mm` in the unit of a field; m, s, degrees and so on, as [`KINDS`] has them.
///
/// # Errors
///
/// [`QuantityError`] for a unit that is not known or is one of another dimension.
pub fn value(text: &str, unit: &str) -> Result<f64, QuantityError> {
    let refuse = |message: String| Err(QuantityError { message });
    let (number, found) = parts(text);
    let allowed = allowed(unit);
    if number.contains(',') || found.starts_with(',') {
        return refuse(format!(
            "found \"{text}\" with a comma; decimals follow a point, and nothing goes between thousands"
        ));
    }
    match converted(number, found, unit) {
        Some(value) if value.is_finite() => Ok(value),
        Some(_) => refuse(format!("found \"{text}\", more than a number can hold")),
        None if found.is_empty() => refuse(format!(
            "found \"{text}\" in quotes; write {number}, or a unit behind it: {allowed}"
        )),
        None if unit.ends_with('ⁿ') => refuse(format!(
            "found \"{text}\"; its unit depends on the exponent: write a plain number, in {unit}"
        )),
        None => match readings(found).first() {
            None => refuse(format!(
                "found \"{text}\", whose unit is not known; write {allowed}"
            )),
            Some(other) => refuse(format!(
                "found \"{text}\"{}; write {allowed}",
                meant(other, unit)
            )),
        },
    }
}

/// Units to choose from in a field, for messages: "a length in m, mm, ...".
pub fn allowed(unit: &str) -> String {
    match KINDS.iter().find(|kind| kind.unit == unit) {
        Some(kind) if kind.unit == "-" => "a plain number, or one in %".to_owned(),
        Some(kind) => format!("{} in {}", one(kind.name), kind.examples.join(", ")),
        None => format!("a number in {unit}"),
    }
}

/// What a quantity of another dimension is.
fn meant(found: &Composed, unit: &str) -> String {
    match name_of(found) {
        Some("stiffness per area") if unit == "kg/m³" => {
            ", which is a unit weight, to be divided by gravity".to_owned()
        }
        Some(name) => format!(", which is {}", one(name)),
        None => String::new(),
    }
}

/// A name with its article.
fn one(name: &str) -> String {
    let article = if name.starts_with(['a', 'e', 'i', 'o', 'u']) {
        "an"
    } else {
        "a"
    };
    format!("{article} {name}")
}

/// Name of the kind of quantity that has a dimension.
fn name_of(found: &Composed) -> Option<&'static str> {
    let of_kind = |unit: &str| readings(unit).first().map(|one| one.dimension);
    let kind = KINDS
        .iter()
        .find(|kind| of_kind(kind.unit) == Some(found.dimension))?;
    Some(kind.name)
}

/// The number at the start of a text, and what is behind it.
fn parts(text: &str) -> (&str, &str) {
    let text = text.trim();
    let of_number = |c: char| c.is_ascii_digit() || "+-._,".contains(c);
    let mut end = text.find(|c| !of_number(c)).unwrap_or(text.len());
    // an exponent is a letter and digits
    let rest = text.get(end..).unwrap_or_default();
    if let Some(power) = rest.strip_prefix(['e', 'E']) {
        let digits = power.strip_prefix(['+', '-']).unwrap_or(power);
        let n = digits.len()
            - digits
                .trim_start_matches(|c: char| c.is_ascii_digit())
                .len();
        if n > 0 {
            end += 1 + power.len() - digits.len() + n;
        }
    }
    let (number, unit) = text.split_at_checked(end).unwrap_or((text, ""));
    (number, unit.trim())
}

/// A decimal number times the size of `from` over that of `to`. Where both differ by a power of ten, that is one more digit of the
/// exponent and no rounding.
fn converted(number: &str, from: &str, to: &str) -> Option<f64> {
    if from.is_empty() {
        return None;
    }
    let to = if to == "-" {
        None
    } else {
        readings(to).first().copied()
    };
    let dimension = to.map(|to| to.dimension).unwrap_or_default();
    let found = readings(from);
    let from = found.iter().find(|one| one.dimension == dimension)?.size;
    let (above, below, decimals) = to.map_or((1.0, 1.0, 0), |to| {
        (to.size.numerator, to.size.denominator, to.size.decimals)
    });
    let (mantissa, power) = number.split_once(['e', 'E']).unwrap_or((number, "0"));
    let power: i32 = power.parse().ok()?;
    let power = power.checked_add(from.decimals - decimals)?;
    let scaled: f64 = format!("{}e{power}", mantissa.replace('_', ""))
        .parse()
        .ok()?;
    let (up, down) = (from.numerator * below, from.denominator * above);
    // the same irrational factor above and below, as of rad and rad/s, leaves no trace
    Some(if up.total_cmp(&down).is_eq() {
        scaled
    } else {
        scaled * up / down
    })
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

    /// To the bit, where the unit is a power of ten away.
    #[test]
    fn quantities_have_their_value() {
        for (text, unit, expected) in [
            ("25 mm", "m", 0.025),
            ("7mm", "m", 0.007),
            ("0.3 cm", "m", 0.003),
            ("1.5e1 km", "m", 15_000.0),
            ("30 deg", "degrees", 30.0),
            ("30°", "degrees", 30.0),
            ("2.65 t/m3", "kg/m³", 2650.0),
            ("2.65 g/cm3", "kg/m³", 2650.0),
            ("10 GPa", "Pa", 10e9),
            ("25 N/mm2", "Pa", 25e6),
            ("1 h", "s", 3600.0),
            ("5 kN", "N", 5000.0),
            ("36 km/h", "m/s", 10.0),
            ("-1 g", "m/s²", -9.806_65),
            ("0.1 MPa/mm", "Pa/m", 1e8),
            ("2 rad/s", "rad/s", 2.0),
            ("1.002 mPa s", "Pa s", 1.002e-3),
            ("12 %", "-", 0.12),
            ("600 l/s", "m³/s", 0.6),
            ("0.2 1/s", "1/s", 0.2),
            ("3 kN·s/m", "N s/m", 3000.0),
            ("4 kN m-1", "N/m", 4000.0),
        ] {
            assert_eq!(value(text, unit), Ok(expected), "{text}");
        }
        let turn =
            value("180 deg/s", "rad/s").map(|rate| (rate - std::f64::consts::PI).abs() < 1e-12);
        assert_eq!(turn, Ok(true));
        let right =
            value("1.5707963267948966 rad", "degrees").map(|angle| (angle - 90.0).abs() < 1e-12);
        assert_eq!(right, Ok(true));
        let pounds = value("165 lb/ft3", "kg/m³").map(|rho| (rho - 2643.049).abs() < 1e-2);
        assert_eq!(pounds, Ok(true));
    }

    #[test]
    fn other_dimensions_are_refused_by_name() {
        for (text, unit, words) in [
            (
                "25 mm",
                "s",
                "found \"25 mm\", which is a length; write a time in s, ms, min, h, d",
            ),
            (
                "25 parsec",
                "m",
                "found \"25 parsec\", whose unit is not known; write a length in m, mm",
            ),
            ("1,5 m", "m", "found \"1,5 m\" with a comma"),
            (
                "2650",
                "kg/m³",
                "found \"2650\" in quotes; write 2650, or a unit behind it: a density in",
            ),
            (
                "3 m",
                "-",
                "found \"3 m\", which is a length; write a plain number, or one in %",
            ),
            (
                "1e400 m",
                "m",
                "found \"1e400 m\", more than a number can hold",
            ),
            (
                "3 Pa",
                "Pa sⁿ",
                "found \"3 Pa\"; its unit depends on the exponent",
            ),
            ("1 /", "m", "found \"1 /\", whose unit is not known"),
            (
                "1 m^99999999999",
                "m",
                "found \"1 m^99999999999\", whose unit is not known",
            ),
        ] {
            let said = value(text, unit).map_err(|error| error.message);
            assert!(
                said.as_ref().is_err_and(|said| said.starts_with(words)),
                "{text}: {said:?}"
            );
        }
    }

    /// The table of kinds names units that are of the kind, and no unit has two sizes in one dimension.
    #[test]
    fn the_tables_agree() {
        for kind in table::KINDS {
            for example in kind.examples {
                assert!(
                    value(&format!("1 {example}"), kind.unit).is_ok(),
                    "{kind:?} {example}"
                );
            }
        }
        let names: Vec<_> = table::UNITS
            .iter()
            .flat_map(|unit| unit.names.iter().map(|n| (n, unit.dimension)))
            .collect();
        for (k, name) in names.iter().enumerate() {
            assert!(!names[..k].contains(name), "{name:?} twice");
        }
    }
}
