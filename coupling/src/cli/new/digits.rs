//! Rounding of numbers that people will read and edit.

/// A value rounded to some decimals, to tens and hundreds with negative ones.
pub(super) fn rounded(value: f64, decimals: i32) -> f64 {
    let step = 10f64.powi(decimals.abs());
    // a division by a power of ten prints as the decimal it is meant to be
    if decimals < 0 {
        (value / step).round() * step
    } else {
        (value * step).round() / step
    }
}

/// A value rounded to some significant digits.
pub(super) fn significant(value: f64, digits: i32) -> f64 {
    if value == 0.0 {
        return 0.0;
    }
    rounded(value, digits - 1 - value.abs().log10().floor() as i32)
}

/// Next multiple of a step upward.
pub(super) fn up_to(value: f64, step: f64) -> f64 {
    (value / step - 1e-9).ceil() * step
}

/// Next multiple of a step downward.
pub(super) fn down_to(value: f64, step: f64) -> f64 {
    (value / step + 1e-9).floor() * step
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_print_as_decimals() {
        for (found, expected) in [
            (rounded(0.1 + 0.2, 2), "0.3"),
            (rounded(412_345.6, -2), "412300"),
            (significant(19.97, 2), "20"),
            (significant(0.068_421, 2), "0.068"),
            (significant(-1234.5, 3), "-1230"),
            (up_to(41.0, 5.0), "45"),
            (up_to(40.0, 5.0), "40"),
            (down_to(-121.0, 10.0), "-130"),
        ] {
            assert_eq!(found.to_string(), expected);
        }
    }
}
