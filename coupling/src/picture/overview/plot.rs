//! Plots of records over time or another variable.

use super::Record;
use crate::picture::chart::axis::{Axis, Scale, open_range, thousands};
use crate::picture::chart::page::{Frame, LEFT, Page, RIGHT};
use crate::picture::chart::plot::{BELOW, LEGEND_STEP, Plot, color, curve, is_number, stroke};

const HEIGHT: f64 = 170.0;
const ABOVE: f64 = 14.0;
/// A record with a smaller relative variation is shown as a constant; five digits fit the margin.
const LEAST_RANGE: f64 = 1e-4;
/// Characters of a name that fit beside the plot.
const LEGEND_CHARACTERS: usize = 17;

/// Style of a record in theory.
const THEORY: &str = "stroke-width=\"1.2\" stroke-dasharray=\"1.2 2.4\"";

/// Axis labels of a plot.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axes<'a> {
    /// Of the vertical axis, without its unit.
    pub vertical: &'a str,
    /// Of the horizontal axis, with its unit.
    pub horizontal: &'a str,
    /// Times of the views, marked by dotted lines; s.
    pub marked: &'a [f64],
}

/// Draws records of one unit from `y` down; returns the next vertical position.
pub(super) fn draw(page: &mut Page, y: f64, axes: Axes, records: &[&Record]) -> f64 {
    let legend = 8.0 + LEGEND_STEP * records.len() as f64;
    let frame = Frame {
        left: LEFT,
        top: y + ABOVE,
        width: RIGHT - LEFT,
        height: HEIGHT.max(legend),
    };
    let (start, end) = extent(records.iter().flat_map(|record| &record.time));
    let (low, high) =
        extent((records.iter()).flat_map(|record| record.value.iter().chain(&record.theory)));
    let (start, end) = open_range(start, end, 1e-9);
    let (low, high) = open_range(low, high, LEAST_RANGE);
    let margin = 0.05 * (high - low);
    let horizontal = Axis {
        min: start,
        max: end,
        scale: Scale::Linear,
        from: frame.left,
        to: frame.right(),
    };
    let vertical = Axis {
        min: low - margin,
        max: high + margin,
        scale: Scale::Linear,
        from: frame.bottom(),
        to: frame.top,
    };

    let unit = records.first().map_or("", |record| record.unit.as_str());
    let (power, prefix) = thousands(vertical.min.abs().max(vertical.max.abs()));
    let plot = Plot {
        frame,
        x: horizontal,
        y: vertical,
    };
    plot.open(page, power);
    let unit = if unit.is_empty() { "–" } else { unit };
    let up = format!("{} [{prefix}{unit}]", axes.vertical);
    let is_shown = |time: &f64| (start..=end).contains(time);
    let has_theory = records.iter().any(|record| !record.theory.is_empty());
    let note = match (axes.marked.iter().any(is_shown), has_theory) {
        (true, true) => "; dotted: the views above, and theory in the color of each record",
        (true, false) => "; dotted: the views above",
        (false, true) => "; dotted: theory in the color of each record",
        (false, false) => "",
    };
    plot.name(page, [&format!("{}{note}", axes.horizontal), &up]);
    for time in axes.marked.iter().copied().filter(is_shown) {
        let x = horizontal.at(time);
        let style = "stroke=\"#999\" stroke-width=\"0.8\" stroke-dasharray=\"1 3\"";
        page.line([x, frame.top], [x, frame.bottom()], style);
    }
    page.open_clipped_group(frame);
    for (i, record) in records.iter().enumerate() {
        let theory = curve((&record.time, &record.theory), horizontal, vertical);
        if !theory.is_empty() {
            let color = color(i);
            page.push(&format!(
                "<path d=\"{theory}\" fill=\"none\" stroke=\"{color}\" {THEORY}/>"
            ));
        }
        let path = curve((&record.time, &record.value), horizontal, vertical);
        page.push(&format!("<path d=\"{path}\" fill=\"none\" {}/>", stroke(i)));
    }
    page.close_group();
    plot.close(page);
    for (i, record) in records.iter().enumerate() {
        plot.legend_of_curve(page, i, &record.name, LEGEND_CHARACTERS);
    }
    frame.bottom() + BELOW
}

/// Smallest and largest number; a reversed interval if there is none.
fn extent<'a>(values: impl Iterator<Item = &'a f64>) -> (f64, f64) {
    let finite = values.copied().filter(|&value| is_number(value));
    finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), value| {
        (min.min(value), max.max(value))
    })
}
