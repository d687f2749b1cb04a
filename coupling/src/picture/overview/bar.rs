//! Color bars, and the round ends of their ranges.

use crate::picture::chart::axis::{Axis, Scale, Tick, nice_up, open_range};
use crate::picture::chart::page::{Anchor, Frame, INK, Page};
use crate::picture::color;

/// Fraction of the values below the top of a color bar: a few drops must not darken all others.
const BELOW_TOP: f64 = 0.995;
/// Ends of a color bar, times a power of ten; finer than the steps of an axis, to use the full range of colors.
const TOPS: [f64; 10] = [1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];

/// Color bar.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bar<'a> {
    /// Label above the bar.
    pub label: &'a str,
    /// From below.
    pub shades: &'a [[u8; 3]],
    /// Values of the first and the last shade.
    pub range: (f64, f64),
    /// Whether there are values below and above the range.
    pub is_exceeded: (bool, bool),
}

impl Bar<'_> {
    pub fn draw(self, page: &mut Page, frame: Frame) {
        let Self {
            label,
            shades,
            range: (min, max),
            is_exceeded,
        } = self;
        page.text([frame.left, frame.top - 10.0], Anchor::Start, label);
        let step = frame.height / shades.len() as f64;
        for (i, &shade) in shades.iter().enumerate() {
            let strip = Frame {
                top: frame.bottom() - (i + 1) as f64 * step,
                // Strips overlap, or the background shines through between them.
                height: step + if i == 0 { 0.0 } else { 0.6 },
                ..frame
            };
            page.rectangle(strip, &format!("fill=\"{}\"", color::hex(shade)));
        }
        page.rectangle(
            frame,
            &format!("fill=\"none\" stroke=\"{INK}\" stroke-width=\"0.6\""),
        );
        let axis = Axis {
            min,
            max,
            scale: Scale::Linear,
            from: frame.bottom(),
            to: frame.top,
        };
        let mut ticks = axis.ticks(32.0, 1.0);
        // The top always has its number, and room for it.
        ticks.retain(|tick| axis.at(tick.value) > frame.top + 14.0);
        let end = |value: f64, sign: &str| {
            // a whole number of tenths, but for round-off
            let number = (value * 1e9).round() / 1e9;
            Tick {
                value,
                label: format!("{sign}{number}").replace('-', "−"),
            }
        };
        if is_exceeded.0 {
            ticks.retain(|tick| axis.at(tick.value) < frame.bottom() - 14.0);
            ticks.push(end(min, "≤ "));
        }
        ticks.push(end(max, if is_exceeded.1 { "≥ " } else { "" }));
        for Tick { value, label } in ticks {
            let y = axis.at(value);
            page.line(
                [frame.right(), y],
                [frame.right() + 4.0, y],
                &format!("stroke=\"{INK}\""),
            );
            page.text([frame.right() + 7.0, y + 4.0], Anchor::Start, &label);
        }
    }
}

/// Top of a bar that starts at 0: round, and above nearly all values.
pub(super) fn round_top(mut values: Vec<f64>) -> f64 {
    let index = (BELOW_TOP * values.len() as f64) as usize;
    if index >= values.len() {
        return 1.0;
    }
    let (_, &mut top, _) = values.select_nth_unstable_by(index, f64::total_cmp);
    // Water at rest within rounding is at rest.
    if top < 1e-9 {
        return 1.0;
    }
    let power = 10f64.powf(top.log10().floor());
    // The last one, in case rounding misses the right one.
    TOPS.into_iter()
        .map(|factor| factor * power)
        .find(|&round| round >= top)
        .unwrap_or(10.0 * power)
}

/// Round ends with nearly all values between them; distinct even for a single value.
pub(super) fn round_range(mut values: Vec<f64>) -> (f64, f64) {
    values.sort_by(f64::total_cmp);
    let last = values.len().saturating_sub(1);
    let top = (BELOW_TOP * last as f64) as usize;
    let Some((&low, &high)) = values.get(last - top).zip(values.get(top)) else {
        return (0.0, 1.0);
    };
    let (low, high) = open_range(low, high, 1e-6);
    let step = nice_up((high - low) / 10.0);
    // a step within rounding does not count as another step
    let (low, high) = (low / step + 1e-6, high / step - 1e-6);
    (low.floor() * step, high.ceil() * step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_round_and_hold_nearly_all() {
        let values = |n: u32| {
            (0..n)
                .map(|i| 0.1 + f64::from(i) * 0.01)
                .collect::<Vec<_>>()
        };
        assert_eq!(round_range(values(100)), (0.1, 1.1));
        assert_eq!(round_top(values(100)), 1.5);
        assert_eq!(round_range(vec![2.0; 5]), (1.8, 2.2));
        assert_eq!(round_range(Vec::new()), (0.0, 1.0));
        // one in a thousand
        let mut drops = vec![0.0; 500];
        drops.extend(vec![3.0; 500]);
        drops.push(1e6);
        assert_eq!(round_range(drops), (0.0, 3.0));
    }
}
