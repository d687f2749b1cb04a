//! Scales, ticks and their labels.

use super::page::{Anchor, Frame, INK, Page};

/// Scale of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scale {
    /// Equal distances for equal differences.
    Linear,
    /// Equal distances for equal ratios; values are > 0.
    Logarithmic,
}

/// A scale from values to pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axis {
    /// Scale.
    pub scale: Scale,
    /// Value at the start.
    pub min: f64,
    /// Value at the end.
    pub max: f64,
    /// Pixel of `min`.
    pub from: f64,
    /// Pixel of `max`.
    pub to: f64,
}

/// A mark on an axis.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tick {
    pub value: f64,
    pub label: String,
}

impl Axis {
    /// A logarithmic axis over the values that are > 0 with a margin on both sides, a twelfth of the range and at least a tenth of a
    /// decade; `None` without such values.
    pub fn over_decades(values: impl Iterator<Item = f64>, [from, to]: [f64; 2]) -> Option<Self> {
        let logs = values.filter(|x| x.is_finite() && 0.0 < *x).map(f64::log10);
        let (low, high) = logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        let margin = ((high - low) / 12.0).max(0.1);
        low.is_finite().then(|| Self {
            scale: Scale::Logarithmic,
            min: 10f64.powf(low - margin),
            max: 10f64.powf(high + margin),
            from,
            to,
        })
    }

    /// Pixel of `value`.
    pub fn at(self, value: f64) -> f64 {
        let share = match self.scale {
            Scale::Linear => (value - self.min) / (self.max - self.min),
            Scale::Logarithmic => (value / self.min).log10() / (self.max / self.min).log10(),
        };
        self.from + share * (self.to - self.from)
    }

    /// Whether a value has a place on the axis or beyond its ends.
    pub fn has_place_for(self, value: f64) -> bool {
        value.is_finite() && (self.scale == Scale::Linear || 0.0 < value)
    }

    /// Round values with a mark every `distance` pixels or a little more; labels count in `unit`s. On a logarithmic axis the number of
    /// decades decides.
    pub fn ticks(self, distance: f64, unit: f64) -> Vec<Tick> {
        if self.scale == Scale::Logarithmic {
            return self.decades(unit);
        }
        let (min, max) = (self.min / unit, self.max / unit);
        let wanted = (max - min) * distance / (self.to - self.from).abs();
        let step = nice_up(wanted);
        let decimals = (-step.log10() - 1e-9).ceil().clamp(0.0, 12.0) as usize;
        // 2.5 needs a digit more than its power of ten says.
        let decimals = decimals
            + usize::from(((step * 10f64.powi(decimals as i32)).fract() - 0.5).abs() < 0.1);
        let first = (min / step - 1e-6).ceil();
        (0..100)
            .map(|i| (first + f64::from(i)) * step)
            .take_while(|value| *value <= max + 1e-6 * step)
            .map(|value| Tick {
                value: value * unit,
                // Adding zero turns −0 into 0.
                label: format!("{:.decimals$}", value + 0.0).replace('-', "−"),
            })
            .collect()
    }
}

impl Axis {
    /// Round numbers: several per decade for a short range, powers of ten alone for a long one.
    fn decades(self, unit: f64) -> Vec<Tick> {
        let (low, high) = ((self.min / unit).log10(), (self.max / unit).log10());
        let factors: &[f64] = match high - low {
            decades if decades < 1.0 => &[1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0],
            decades if decades < 3.0 => &[1.0, 2.0, 5.0],
            _ => &[1.0],
        };
        let powers = low.floor() as i32..=high.ceil() as i32;
        // six tenths as they are written, which six times a tenth is not
        let round = |factor: &f64, power: i32| format!("{factor}e{power}").parse::<f64>().ok();
        let all = powers.flat_map(|power| factors.iter().filter_map(move |f| round(f, power)));
        all.filter(|value| (low..=high).contains(&value.log10()))
            .map(|value| Tick {
                value: value * unit,
                label: short(value),
            })
            .collect()
    }
}

/// A number with few digits.
fn short(value: f64) -> String {
    match (1e-3..1e5).contains(&value) {
        true => format!("{value}"),
        false => format!("{value:e}").replace('-', "−"),
    }
}

/// Smallest of 1, 2, 2.5, 5 times a power of ten that is not below `value`.
pub(crate) fn nice_up(value: f64) -> f64 {
    let power = 10f64.powf(value.log10().floor());
    let nice = [1.0, 2.0, 2.5, 5.0, 10.0]
        .into_iter()
        .find(|factor| factor * power >= value * (1.0 - 1e-9));
    nice.unwrap_or(10.0) * power
}

/// Interval shown for values between `min` and `max`: finite, and at least the fraction `least` of their size, so that
/// the digits of the labels fit.
pub(crate) fn open_range(min: f64, max: f64, least: f64) -> (f64, f64) {
    if !((max - min).is_finite() && min <= max) {
        return (0.0, 1.0);
    }
    let least = least * min.abs().max(max.abs());
    if max - min > least {
        (min, max)
    } else {
        let half = if min == 0.0 { 0.5 } else { 0.1 * min.abs() };
        (min - half, max + half)
    }
}

/// Power of a thousand that scales the labels of numbers up to `largest`, and its name before the unit.
pub(crate) fn thousands(largest: f64) -> (f64, String) {
    if (1e-2..1e4).contains(&largest) || !(1e-290..=f64::MAX).contains(&largest) {
        return (1.0, String::new());
    }
    let exponent = 3 * (largest.log10() / 3.0 + 1e-9).floor() as i32;
    let exponent_text = exponent.to_string();
    let raised = exponent_text.chars().map(|c| match c {
        '-' => '⁻',
        // Unicode has the first three in another block.
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit => digit
            .to_digit(10)
            .and_then(|d| char::from_u32(0x2070 + d))
            .unwrap_or(digit),
    });
    (
        10f64.powi(exponent),
        format!("10{} ", raised.collect::<String>()),
    )
}

/// Draws the marks and numbers below `frame`, and a grid inside it if wanted.
pub(crate) fn draw_horizontal(
    page: &mut Page,
    frame: Frame,
    ticks: &[Tick],
    axis: Axis,
    labels: Labels,
) {
    for Tick { value, label } in ticks {
        let x = axis.at(*value);
        page.line(
            [x, frame.bottom()],
            [x, frame.bottom() + 4.0],
            &format!("stroke=\"{INK}\""),
        );
        if labels == Labels::Shown {
            page.text([x, frame.bottom() + 16.0], Anchor::Middle, label);
        }
    }
}

/// Draws the marks and numbers left of `frame`.
pub(crate) fn draw_vertical(
    page: &mut Page,
    frame: Frame,
    ticks: &[Tick],
    axis: Axis,
    labels: Labels,
) {
    for Tick { value, label } in ticks {
        let y = axis.at(*value);
        page.line(
            [frame.left - 4.0, y],
            [frame.left, y],
            &format!("stroke=\"{INK}\""),
        );
        if labels == Labels::Shown {
            page.text([frame.left - 7.0, y + 4.0], Anchor::End, label);
        }
    }
}

/// Whether the marks of an axis carry numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Labels {
    Shown,
    Hidden,
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    fn labels(min: f64, max: f64, pixels: f64) -> Vec<String> {
        let axis = Axis {
            min,
            max,
            scale: Scale::Linear,
            from: 0.0,
            to: pixels,
        };
        axis.ticks(60.0, 1.0)
            .into_iter()
            .map(|tick| tick.label)
            .collect()
    }

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(labels(0.0, 10.0, 400.0), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(labels(0.0, 0.3, 300.0), ["0.0", "0.1", "0.2", "0.3"]);
        assert_eq!(labels(0.0, 3.0, 250.0), ["0", "1", "2", "3"]);
        assert_eq!(
            labels(-0.1, 0.13, 300.0),
            ["−0.10", "−0.05", "0.00", "0.05", "0.10"]
        );
        assert_eq!(
            labels(0.0, 1.0, 250.0),
            ["0.00", "0.25", "0.50", "0.75", "1.00"]
        );
        assert_eq!(
            labels(1.2e5, 1.3e5, 250.0),
            ["120000", "122500", "125000", "127500", "130000"]
        );
        assert_eq!(
            labels(3.1, 3.4, 40.0).len(),
            0,
            "no room, no tick: {:?}",
            labels(3.1, 3.4, 40.0)
        );
    }

    #[test]
    fn decades_have_round_marks() {
        let axis = |values: [f64; 2]| Axis::over_decades(values.into_iter(), [0.0, 300.0]);
        let told = |axis: Option<Axis>| -> Vec<String> {
            let ticks = axis.map(|axis| axis.ticks(60.0, 1.0)).unwrap_or_default();
            ticks.into_iter().map(|tick| tick.label).collect()
        };
        assert_eq!(
            told(axis([0.01, 0.5])),
            ["0.01", "0.02", "0.05", "0.1", "0.2", "0.5"]
        );
        assert_eq!(
            told(axis([1e-6, 1.0])).first().map(String::as_str),
            Some("1e−6")
        );
        let short_range = told(axis([0.55, 0.75]));
        assert_eq!(short_range, ["0.5", "0.6", "0.7", "0.8"]);
        assert!(axis([0.0, f64::NAN]).is_none());
        // equal ratios have equal distances
        let axis = axis([1.0, 100.0]).unwrap();
        let [a, b, c] = [1.0, 10.0, 100.0].map(|value| axis.at(value));
        // round-off
        assert!((b - a - (c - b)).abs() < 1e-9 && 0.0 < a && c < 300.0);
        assert!(!axis.has_place_for(0.0));
    }

    #[test]
    fn ranges_are_never_empty() {
        assert_eq!(open_range(0.0, 0.0, 1e-6), (-0.5, 0.5));
        assert_eq!(open_range(2.0, 2.0, 1e-6), (1.8, 2.2));
        assert_eq!(
            open_range(f64::INFINITY, f64::NEG_INFINITY, 1e-6),
            (0.0, 1.0)
        );
        assert_eq!(open_range(1.0, 3.0, 1e-6), (1.0, 3.0));
    }

    #[test]
    fn large_and_small_numbers_count_in_thousands() {
        let cases = [
            (10.0, ""),
            (12_000.0, "10³ "),
            (1e6, "10⁶ "),
            (0.009, "10⁻³ "),
            (2e-7, "10⁻⁹ "),
            (3e120, "10¹²⁰ "),
        ];
        for (largest, name) in cases {
            assert_eq!(thousands(largest).1, name);
        }
    }
}
