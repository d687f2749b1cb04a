//! Plots of records over time or another variable.

use super::Record;
use super::axis::{self, Axis, Labels, open_range, thousands};
use super::page::{Anchor, Frame, INK, LABEL, LEFT, Page, RIGHT, plain, shortened};

const HEIGHT: f64 = 170.0;
const ABOVE: f64 = 14.0;
const BELOW: f64 = 44.0;
/// Distance of legend lines; px.
const LEGEND_STEP: f64 = 16.0;
/// A record with a smaller relative variation is shown as a constant; five digits fit the margin.
const LEAST_RANGE: f64 = 1e-4;
/// Characters of a name that fit beside the plot.
const LEGEND_CHARACTERS: usize = 17;

/// Colors distinguishable for color-blind readers (Okabe and Ito 2008), without yellow.
const COLORS: [&str; 7] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#333333",
];
/// Dash patterns for the second, third, ... cycle of colors.
const DASHES: [&str; 3] = [
    "",
    " stroke-dasharray=\"6 3\"",
    " stroke-dasharray=\"2 2.5\"",
];

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
        from: frame.left,
        to: frame.right(),
    };
    let vertical = Axis {
        min: low - margin,
        max: high + margin,
        from: frame.bottom(),
        to: frame.top,
    };

    let unit = records.first().map_or("", |record| record.unit.as_str());
    let prefix = decorate(page, frame, horizontal, vertical);
    let unit = if unit.is_empty() { "–" } else { unit };
    page.upright_text(
        [LABEL, frame.top + frame.height / 2.0],
        &format!("{} [{prefix}{unit}]", axes.vertical),
    );
    let is_shown = |time: &f64| (start..=end).contains(time);
    let has_theory = records.iter().any(|record| !record.theory.is_empty());
    let note = match (axes.marked.iter().any(is_shown), has_theory) {
        (true, true) => "; dotted: the views above, and theory in the color of each record",
        (true, false) => "; dotted: the views above",
        (false, true) => "; dotted: theory in the color of each record",
        (false, false) => "",
    };
    page.text(
        [frame.left + frame.width / 2.0, frame.bottom() + 32.0],
        Anchor::Middle,
        &format!("{}{note}", axes.horizontal),
    );
    for time in axes.marked.iter().copied().filter(is_shown) {
        let x = horizontal.at(time);
        let style = "stroke=\"#999\" stroke-width=\"0.8\" stroke-dasharray=\"1 3\"";
        page.line([x, frame.top], [x, frame.bottom()], style);
    }
    page.open_clipped_group(frame);
    for (i, record) in records.iter().enumerate() {
        let theory = curve((&record.time, &record.theory), horizontal, vertical);
        if !theory.is_empty() {
            let color = COLORS[i % COLORS.len()];
            page.push(&format!(
                "<path d=\"{theory}\" fill=\"none\" stroke=\"{color}\" {THEORY}/>"
            ));
        }
        let path = curve((&record.time, &record.value), horizontal, vertical);
        page.push(&format!("<path d=\"{path}\" fill=\"none\" {}/>", stroke(i)));
    }
    page.close_group();
    page.rectangle(frame, &format!("fill=\"none\" stroke=\"{INK}\""));
    for (i, record) in records.iter().enumerate() {
        legend_line(page, frame, i, &record.name);
    }
    frame.bottom() + BELOW
}

/// Draws grid, ticks and numbers; returns the power of ten of the vertical axis, as a prefix of the unit.
fn decorate(page: &mut Page, frame: Frame, horizontal: Axis, vertical: Axis) -> String {
    let (power, prefix) = thousands(vertical.min.abs().max(vertical.max.abs()));
    let (x_ticks, y_ticks) = (horizontal.ticks(70.0, 1.0), vertical.ticks(28.0, power));
    page.rectangle(frame, "fill=\"#fff\"");
    for tick in &x_ticks {
        let x = horizontal.at(tick.value);
        page.grid_line([x, frame.top], [x, frame.bottom()]);
    }
    for tick in &y_ticks {
        let y = vertical.at(tick.value);
        page.grid_line([frame.left, y], [frame.right(), y]);
    }
    axis::draw_horizontal(page, frame, &x_ticks, horizontal, Labels::Shown);
    axis::draw_vertical(page, frame, &y_ticks, vertical, Labels::Shown);
    prefix
}

fn stroke(i: usize) -> String {
    let color = COLORS[i % COLORS.len()];
    let dash = DASHES[i / COLORS.len() % DASHES.len()];
    format!(
        "stroke=\"{color}\" stroke-width=\"1.4\" stroke-linejoin=\"round\" stroke-linecap=\"round\"{dash}"
    )
}

fn legend_line(page: &mut Page, frame: Frame, i: usize, name: &str) {
    let (x, y) = (
        frame.right() + 12.0,
        frame.top + 10.0 + LEGEND_STEP * i as f64,
    );
    page.line([x, y], [x + 20.0, y], &stroke(i));
    page.push(&format!("<g><title>{}</title>", plain(name)));
    page.text(
        [x + 26.0, y + 4.0],
        Anchor::Start,
        &shortened(name, LEGEND_CHARACTERS),
    );
    page.close_group();
}

/// Smallest and largest number; a reversed interval if there is none.
fn extent<'a>(values: impl Iterator<Item = &'a f64>) -> (f64, f64) {
    let finite = values.copied().filter(|&value| is_number(value));
    finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), value| {
        (min.min(value), max.max(value))
    })
}

/// Whether a value can be drawn; sums and differences of values near the end of the number range would not be finite.
fn is_number(value: f64) -> bool {
    value.abs() < 1e300
}

/// Samples kept for one column of pixels: the lowest and the highest.
#[derive(Clone, Copy)]
struct Extremes {
    column: i64,
    low: [f64; 2],
    high: [f64; 2],
    is_low_last: bool,
}

impl Extremes {
    fn of([x, y]: [f64; 2]) -> Self {
        Self {
            column: x.floor() as i64,
            low: [x, y],
            high: [x, y],
            is_low_last: false,
        }
    }

    fn join(&mut self, point: [f64; 2]) {
        if point[1] < self.low[1] {
            self.low = point;
            self.is_low_last = true;
        }
        if point[1] > self.high[1] {
            self.high = point;
            self.is_low_last = false;
        }
    }

    /// In the order of time, each once.
    fn points(self) -> impl Iterator<Item = [f64; 2]> {
        let (first, second) = if self.is_low_last {
            (self.high, self.low)
        } else {
            (self.low, self.high)
        };
        std::iter::once(first).chain((first != second).then_some(second))
    }
}

/// Path of a record with as many points as the page resolves, all peaks, and a gap at every NaN.
fn curve((time, value): (&[f64], &[f64]), horizontal: Axis, vertical: Axis) -> String {
    let samples = time.iter().copied().zip(value.iter().copied());
    let point = |(t, v)| (is_number(t) && is_number(v)).then(|| [horizontal.at(t), vertical.at(v)]);
    let points: Vec<Option<[f64; 2]>> = samples.map(point).collect();
    let mut path = String::new();
    for piece in points.split(Option::is_none) {
        let mut kept: Vec<Extremes> = Vec::new();
        for &point in piece.iter().flatten() {
            match kept.last_mut() {
                Some(extremes) if extremes.column == point[0].floor() as i64 => {
                    extremes.join(point)
                }
                _ => kept.push(Extremes::of(point)),
            }
        }
        let mut command = 'M';
        for [x, y] in kept.into_iter().flat_map(Extremes::points) {
            path += &format!("{command}{x:.1} {y:.1}");
            command = 'L';
        }
        if piece.len() == 1 {
            // With round ends, a line of no length is a dot.
            path += "h0";
        }
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    const PIXELS: Axis = Axis {
        min: 0.0,
        max: 100.0,
        from: 0.0,
        to: 100.0,
    };

    fn path(value: impl Fn(usize) -> f64, n: usize) -> String {
        let record = Record {
            time: (0..n).map(|i| 100.0 * i as f64 / n as f64).collect(),
            value: (0..n).map(value).collect(),
            ..Record::default()
        };
        curve((&record.time, &record.value), PIXELS, PIXELS)
    }

    #[test]
    fn peaks_survive_and_points_are_few() {
        let text = path(|i| if i == 54_321 { 90.0 } else { 1.0 }, 100_000);
        assert!(text.contains("54.3 90.0"), "{text}");
        assert!(text.matches('L').count() <= 200, "{text}");
    }

    #[test]
    fn a_stair_goes_straight_up() {
        let stair = Record {
            time: vec![0.0, 40.0, 40.0, 90.0],
            value: vec![0.0, 0.0, 50.0, 50.0],
            ..Record::default()
        };
        assert_eq!(
            curve((&stair.time, &stair.value), PIXELS, PIXELS),
            "M0.0 0.0L40.0 0.0L40.0 50.0L90.0 50.0"
        );
    }

    #[test]
    fn gaps_break_the_line() {
        let text = path(|i| if i % 4 == 2 { f64::NAN } else { i as f64 }, 10);
        assert_eq!(
            text,
            "M0.0 0.0L10.0 1.0M30.0 3.0L40.0 4.0L50.0 5.0M70.0 7.0L80.0 8.0L90.0 9.0"
        );
        assert_eq!(
            path(|i| if i == 1 { 5.0 } else { f64::INFINITY }, 3),
            "M33.3 5.0h0"
        );
    }
}
