//! Table of the peaks of gauges.

use crate::output::peaks::Peak;
use crate::picture::chart::page::{Anchor, INK, LEFT, Page, shortened};

/// Left edge of the names and right edges of the columns of numbers; px.
const COLUMNS: [f64; 5] = [LEFT, LEFT + 330.0, LEFT + 450.0, LEFT + 570.0, LEFT + 690.0];
const HEADINGS: [&str; 5] = ["gauge", "at the start", "largest", "at t", "first arrival"];
/// Distance of lines, and room above and below; px.
const STEP: f64 = 17.0;
const ABOVE: f64 = 22.0;
const BELOW: f64 = 20.0;
/// Characters of a name.
const LONGEST_NAME: usize = 32;
/// Most lines: the others are in the summary.
const MOST_LINES: usize = 30;

/// Draws a line per gauge from `y` down; returns the next vertical position.
pub(super) fn draw(page: &mut Page, y: f64, peaks: &[Peak]) -> f64 {
    if peaks.is_empty() {
        return y;
    }
    let top = y + ABOVE;
    line(
        page,
        top,
        "font-weight=\"bold\"",
        &HEADINGS.map(str::to_owned),
    );
    page.line(
        [COLUMNS[0], top + 5.0],
        [COLUMNS[4], top + 5.0],
        &format!("stroke=\"{INK}\" stroke-width=\"0.8\""),
    );
    let mut at = top + 3.0;
    for peak in peaks.iter().take(MOST_LINES) {
        at += STEP;
        let value = |value: Option<f64>| {
            value.map_or("dry".to_owned(), |value| {
                format!("{} {}", digits(value), peak.unit)
            })
        };
        let time =
            |time: Option<f64>| time.map_or("–".to_owned(), |time| format!("{} s", digits(time)));
        let cells = [
            shortened(&peak.name, LONGEST_NAME),
            value(peak.start),
            value(peak.largest),
            time(peak.time),
            time(peak.arrival),
        ];
        line(page, at, "", &cells);
    }
    if MOST_LINES < peaks.len() {
        at += STEP;
        let more = format!("and {} more, in summary.json", peaks.len() - MOST_LINES);
        page.text([COLUMNS[0], at], Anchor::Start, &more);
    }
    at + BELOW
}

fn line(page: &mut Page, y: f64, weight: &str, cells: &[String; 5]) {
    let style = format!("font-size=\"11.5\" fill=\"{INK}\" {weight}");
    for (k, (x, cell)) in COLUMNS.iter().zip(cells).enumerate() {
        let anchor = if k == 0 { Anchor::Start } else { Anchor::End };
        page.styled_text([*x, y], anchor, &style, cell);
    }
}

/// Four significant digits, with a minus sign as long as a plus.
fn digits(value: f64) -> String {
    let decimals = 3.0 - value.abs().log10().floor();
    let text = match value.abs() {
        0.0 => "0".to_owned(),
        1e-3..1e6 => format!("{value:.*}", decimals.clamp(0.0, 6.0) as usize),
        _ => format!("{value:.3e}"),
    };
    text.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits() {
        for (value, text) in [
            (0.0, "0"),
            (12.3456, "12.35"),
            (-0.012_345_6, "−0.01235"),
            (98765.4, "98765"),
            (1.5e7, "1.500e7"),
            (2e-5, "2.000e−5"),
        ] {
            assert_eq!(digits(value), text);
        }
    }

    #[test]
    fn a_gauge_has_a_line_and_a_missing_value_a_word() {
        let peak = Peak {
            name: "shore <1>".to_owned(),
            unit: "m".to_owned(),
            start: None,
            largest: Some(3.25),
            time: Some(41.0),
            arrival: None,
        };
        let mut page = Page::default();
        let end = draw(&mut page, 100.0, &[peak]);
        let text = page.finish("", end);
        for cell in [
            ">shore &lt;1&gt;<",
            ">dry<",
            ">3.250 m<",
            ">41.00 s<",
            ">–<",
        ] {
            assert!(text.contains(cell), "{cell} in {text}");
        }
        assert_eq!(draw(&mut Page::default(), 100.0, &[]), 100.0);
    }
}
