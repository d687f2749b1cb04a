//! Units as written: `kg/m3`, `N s/m`, `m/s²`, `m^3/h`, `kN m-2`.

use super::table::{Dimension, Size, UNITS, Unit};

/// A unit, simple or composed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Composed {
    pub(super) dimension: Dimension,
    pub(super) size: Size,
}

const ONE: Composed = Composed {
    dimension: Dimension {
        length: 0,
        mass: 0,
        time: 0,
        angle: 0,
    },
    size: Size {
        numerator: 1.0,
        denominator: 1.0,
        decimals: 0,
    },
};

/// Largest power of a symbol that is read.
const LARGEST_POWER: i32 = 9;

/// All readings of a unit: a symbol that stands alone may have two. Empty for one that is not known.
pub(super) fn readings(text: &str) -> Vec<Composed> {
    let text = text.trim();
    let alone: Vec<Composed> = spelled(text).map(|unit| of(unit, 1)).collect();
    if alone.is_empty() {
        composed(text).into_iter().collect()
    } else {
        alone
    }
}

/// Units spelled like this; in other capitals where only one spelling is meant.
fn spelled(symbol: &str) -> impl Iterator<Item = &'static Unit> + '_ {
    let mut names: Vec<&str> = UNITS
        .iter()
        .flat_map(|unit| unit.names.iter().copied())
        .collect();
    names.sort_unstable();
    names.dedup();
    let exact = names.iter().find(|name| **name == symbol).copied();
    let mut like = names
        .iter()
        .filter(|name| name.to_lowercase() == symbol.to_lowercase());
    let name = exact.or_else(|| like.next().copied().filter(|_| like.next().is_none()));
    UNITS
        .iter()
        .filter(move |unit| name.is_some_and(|name| unit.names.contains(&name)))
}

fn of(unit: &Unit, power: i32) -> Composed {
    times(
        ONE,
        &Composed {
            dimension: unit.dimension,
            size: unit.size,
        },
        power,
    )
}

fn times(left: Composed, right: &Composed, power: i32) -> Composed {
    let (a, b, size) = (left.dimension, right.dimension, right.size);
    let n = power.unsigned_abs() as i32;
    let (above, below) = match power < 0 {
        true => (size.denominator, size.numerator),
        false => (size.numerator, size.denominator),
    };
    Composed {
        dimension: Dimension {
            length: a.length + power * b.length,
            mass: a.mass + power * b.mass,
            time: a.time + power * b.time,
            angle: a.angle + power * b.angle,
        },
        size: Size {
            numerator: left.size.numerator * above.powi(n),
            denominator: left.size.denominator * below.powi(n),
            decimals: left.size.decimals + power * size.decimals,
        },
    }
}

/// Factors between spaces, `*` or `·`; those behind a `/` divide, up to the next one.
fn composed(text: &str) -> Option<Composed> {
    let mut product = ONE;
    for (part, factors) in text.split('/').enumerate() {
        let sign = if part == 0 { 1 } else { -1 };
        let mut n_factors = 0;
        for factor in factors.split([' ', '*', '·']).filter(|f| !f.is_empty()) {
            n_factors += 1;
            if factor == "1" && part == 0 {
                continue;
            }
            let (symbol, power) = power_of(factor)?;
            // in a product `g` is a gram
            let unit = spelled(symbol).next()?;
            product = times(product, &of(unit, 1), sign * power);
        }
        if n_factors == 0 {
            return None;
        }
    }
    Some(product)
}

/// `m3`, `m^3`, `m³`, `s-2`: a symbol and its power.
fn power_of(factor: &str) -> Option<(&str, i32)> {
    for (mark, power) in [("²", 2), ("³", 3)] {
        if let Some(symbol) = factor.strip_suffix(mark) {
            return Some((symbol, power));
        }
    }
    let symbol = factor.trim_end_matches(|c: char| c.is_ascii_digit() || c == '-');
    let digits = factor.get(symbol.len()..)?;
    let symbol = symbol.strip_suffix('^').unwrap_or(symbol);
    if digits.is_empty() {
        return Some((symbol, 1));
    }
    let power: i32 = digits.parse().ok()?;
    (power.abs() <= LARGEST_POWER).then_some((symbol, power))
}
