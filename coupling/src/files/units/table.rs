//! Units, their dimensions and their sizes: the one table behind headers of files, quantities of scenes and the guide.

use std::f64::consts::PI;

/// Powers of length, mass, time and angle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dimension {
    /// Of m.
    pub length: i32,
    /// Of kg.
    pub mass: i32,
    /// Of s.
    pub time: i32,
    /// Of degrees.
    pub angle: i32,
}

/// Size of a unit in m, kg, s and degrees: `numerator/denominator · 10^decimals`. The power of ten is apart, so that
/// "25 mm" is 0.025 to the bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// Above the bar.
    pub numerator: f64,
    /// Below the bar.
    pub denominator: f64,
    /// Power of ten.
    pub decimals: i32,
}

/// A unit with a symbol of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Its spellings, the customary one first.
    pub names: &'static [&'static str],
    /// Its dimension.
    pub dimension: Dimension,
    /// Its size.
    pub size: Size,
}

/// A kind of quantity in scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    /// Name in messages and in the guide.
    pub name: &'static str,
    /// The unit of plain numbers.
    pub unit: &'static str,
    /// Units to choose from, for messages and the guide; any other of the dimension is accepted, too.
    pub examples: &'static [&'static str],
}

const fn dimension(length: i32, mass: i32, time: i32, angle: i32) -> Dimension {
    Dimension {
        length,
        mass,
        time,
        angle,
    }
}

const NONE: Dimension = dimension(0, 0, 0, 0);
const LENGTH: Dimension = dimension(1, 0, 0, 0);
const MASS: Dimension = dimension(0, 1, 0, 0);
const TIME: Dimension = dimension(0, 0, 1, 0);
const ANGLE: Dimension = dimension(0, 0, 0, 1);
const FORCE: Dimension = dimension(1, 1, -2, 0);
const PRESSURE: Dimension = dimension(-1, 1, -2, 0);
const ACCELERATION: Dimension = dimension(1, 0, -2, 0);

const fn unit(
    names: &'static [&'static str],
    dimension: Dimension,
    (numerator, decimals): (f64, i32),
) -> Unit {
    let size = Size {
        numerator,
        denominator: 1.0,
        decimals,
    };
    Unit {
        names,
        dimension,
        size,
    }
}

const fn radian(names: &'static [&'static str], decimals: i32) -> Unit {
    let size = Size {
        numerator: 180.0,
        denominator: PI,
        decimals,
    };
    Unit {
        names,
        dimension: ANGLE,
        size,
    }
}

/// Standard gravity (CGPM 1901); m/s².
const STANDARD_GRAVITY: f64 = 9.806_65;
/// Pound, by definition (1959); kg.
const POUND: f64 = 0.453_592_37;
/// Weight of a pound; N.
const POUND_FORCE: f64 = POUND * STANDARD_GRAVITY;
/// Square inches in a square meter, inverted; m².
const SQUARE_INCH: f64 = 0.0254 * 0.0254;

/// Every unit. `g` is in it twice: gravity where an acceleration is meant, else grams.
pub const UNITS: &[Unit] = &[
    unit(
        &["m", "meter", "meters", "metre", "metres"],
        LENGTH,
        (1.0, 0),
    ),
    unit(&["um", "µm", "μm"], LENGTH, (1.0, -6)),
    unit(&["mm"], LENGTH, (1.0, -3)),
    unit(&["cm"], LENGTH, (1.0, -2)),
    unit(&["dm"], LENGTH, (1.0, -1)),
    unit(&["km"], LENGTH, (1.0, 3)),
    unit(&["ft"], LENGTH, (0.3048, 0)),
    unit(&["in", "inch"], LENGTH, (0.0254, 0)),
    unit(&["l", "L"], dimension(3, 0, 0, 0), (1.0, -3)),
    unit(&["s", "sec", "seconds"], TIME, (1.0, 0)),
    unit(&["ms"], TIME, (1.0, -3)),
    unit(&["min"], TIME, (60.0, 0)),
    unit(&["h"], TIME, (3600.0, 0)),
    unit(&["d"], TIME, (86_400.0, 0)),
    unit(&["Hz"], dimension(0, 0, -1, 0), (1.0, 0)),
    unit(&["deg", "degrees", "degree", "°"], ANGLE, (1.0, 0)),
    radian(&["rad"], 0),
    radian(&["mrad"], -3),
    unit(&["rpm"], dimension(0, 0, -1, 1), (6.0, 0)),
    unit(&["kg"], MASS, (1.0, 0)),
    unit(&["g"], MASS, (1.0, -3)),
    unit(&["t"], MASS, (1.0, 3)),
    unit(&["lb"], MASS, (POUND, 0)),
    unit(&["g"], ACCELERATION, (STANDARD_GRAVITY, 0)),
    unit(&["gal"], ACCELERATION, (1.0, -2)),
    unit(&["N"], FORCE, (1.0, 0)),
    unit(&["kN"], FORCE, (1.0, 3)),
    unit(&["MN"], FORCE, (1.0, 6)),
    unit(&["GN"], FORCE, (1.0, 9)),
    unit(&["lbf"], FORCE, (POUND_FORCE, 0)),
    unit(&["Pa"], PRESSURE, (1.0, 0)),
    unit(&["mPa"], PRESSURE, (1.0, -3)),
    unit(&["hPa", "mbar"], PRESSURE, (1.0, 2)),
    unit(&["kPa"], PRESSURE, (1.0, 3)),
    unit(&["bar"], PRESSURE, (1.0, 5)),
    unit(&["MPa"], PRESSURE, (1.0, 6)),
    unit(&["GPa"], PRESSURE, (1.0, 9)),
    unit(&["psi"], PRESSURE, (POUND_FORCE / SQUARE_INCH, 0)),
    unit(&["cP"], dimension(-1, 1, -1, 0), (1.0, -3)),
    unit(&["%"], NONE, (1.0, -2)),
];

const fn kind(name: &'static str, unit: &'static str, examples: &'static [&'static str]) -> Kind {
    Kind {
        name,
        unit,
        examples,
    }
}

/// Kinds of quantities, each with its unit in scenes.
#[rustfmt::skip] // one row a line
pub const KINDS: &[Kind] = &[
    kind("length", "m", &["m", "mm", "cm", "dm", "km", "ft", "in"]),
    kind("volume", "m³", &["m3", "l", "cm3", "dm3", "km3", "ft3"]),
    kind("time", "s", &["s", "ms", "min", "h", "d"]),
    kind("rate", "1/s", &["1/s", "1/min", "1/h", "Hz"]),
    kind("speed", "m/s", &["m/s", "cm/s", "mm/s", "km/h", "ft/s"]),
    kind("acceleration", "m/s²", &["m/s2", "cm/s2", "gal", "g"]),
    kind("discharge", "m³/s", &["m3/s", "l/s", "m3/h"]),
    kind("angle", "degrees", &["deg", "rad", "mrad"]),
    kind("angular velocity", "rad/s", &["rad/s", "deg/s", "rpm"]),
    kind("density", "kg/m³", &["kg/m3", "g/cm3", "t/m3", "lb/ft3"]),
    kind("force", "N", &["N", "kN", "MN", "lbf"]),
    kind("pressure", "Pa", &["Pa", "kPa", "MPa", "GPa", "bar", "N/mm2", "psi"]),
    kind("stiffness", "N/m", &["N/m", "kN/m", "MN/m", "N/mm"]),
    kind("stiffness per area", "Pa/m", &["Pa/m", "MPa/m", "GPa/m", "MPa/mm"]),
    kind("damping", "N s/m", &["N s/m", "kN s/m"]),
    kind("viscosity", "Pa s", &["Pa s", "mPa s", "cP"]),
    kind("number", "-", &["%"]),
];
