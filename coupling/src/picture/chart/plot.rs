//! Plots: axes with their grid, curves, points and legends.

use super::axis::{self, Axis, Labels};
use super::page::{Anchor, Frame, INK, LABEL, Page, plain, shortened};

/// Distance of legend lines; px.
pub(crate) const LEGEND_STEP: f64 = 16.0;
/// Room below a plot for its numbers and the name of its axis; px.
pub(crate) const BELOW: f64 = 44.0;

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

/// Color of the `i`th thing that a plot tells apart.
pub(crate) fn color(i: usize) -> &'static str {
    COLORS[i % COLORS.len()]
}

/// Style of the `i`th curve of a plot.
pub(crate) fn stroke(i: usize) -> String {
    let dash = DASHES[i / COLORS.len() % DASHES.len()];
    format!(
        "stroke=\"{}\" stroke-width=\"1.4\" stroke-linejoin=\"round\" stroke-linecap=\"round\"{dash}",
        color(i)
    )
}

/// A plot with both axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plot {
    pub frame: Frame,
    pub x: Axis,
    pub y: Axis,
}

impl Plot {
    /// Draws the background with grid, marks and numbers; those of the vertical axis count in `unit`s.
    pub fn open(self, page: &mut Page, unit: f64) -> Self {
        let Self { frame, x, y } = self;
        let (x_ticks, y_ticks) = (x.ticks(70.0, 1.0), y.ticks(28.0, unit));
        page.rectangle(frame, "fill=\"#fff\"");
        for tick in &x_ticks {
            let x = x.at(tick.value);
            page.grid_line([x, frame.top], [x, frame.bottom()]);
        }
        for tick in &y_ticks {
            let y = y.at(tick.value);
            page.grid_line([frame.left, y], [frame.right(), y]);
        }
        axis::draw_horizontal(page, frame, &x_ticks, x, Labels::Shown);
        axis::draw_vertical(page, frame, &y_ticks, y, Labels::Shown);
        self
    }

    /// Writes the names of the axes.
    pub fn name(self, page: &mut Page, [along, up]: [&str; 2]) {
        let Frame {
            left,
            top,
            width,
            height,
        } = self.frame;
        page.upright_text([LABEL, top + height / 2.0], up);
        let below = [left + width / 2.0, self.frame.bottom() + 32.0];
        page.text(below, Anchor::Middle, along);
    }

    /// Draws the frame, over the ends of curves.
    pub fn close(self, page: &mut Page) {
        page.rectangle(self.frame, &format!("fill=\"none\" stroke=\"{INK}\""));
    }

    /// Draws a line through values that are few.
    pub fn line(self, page: &mut Page, points: impl Iterator<Item = (f64, f64)>, style: &str) {
        let shown = points.filter(|point| self.has_place_for(*point));
        let ends = shown.map(|(x, y)| format!("{:.1} {:.1}", self.x.at(x), self.y.at(y)));
        let path = ends.collect::<Vec<_>>().join("L");
        if !path.is_empty() {
            page.push(&format!("<path d=\"M{path}\" fill=\"none\" {style}/>"));
        }
    }

    /// Draws a point with its name, which is shown when the pointer is on it.
    pub fn dot(self, page: &mut Page, point: (f64, f64), style: &str, name: &str) {
        if self.has_place_for(point) {
            let [x, y] = [self.x.at(point.0), self.y.at(point.1)];
            let dot = format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" {style}/>");
            page.titled(&dot, name);
        }
    }

    /// Writes the name of a curve beside the plot, on a line counted from 0, cut after `n` characters.
    pub fn legend_of_curve(self, page: &mut Page, line: usize, name: &str, n: usize) {
        let [x, y] = self.legend_at(line);
        page.line([x, y], [x + 20.0, y], &stroke(line));
        page.push(&format!("<g><title>{}</title>", plain(name)));
        page.text([x + 26.0, y + 4.0], Anchor::Start, &shortened(name, n));
        page.close_group();
    }

    /// Writes the name of points of a color beside the plot, on a line counted from 0.
    pub fn legend_of_points(self, page: &mut Page, line: usize, color: &str, name: &str) {
        let [x, y] = self.legend_at(line);
        let x = x + 4.0;
        page.push(&format!(
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"{color}\"/>"
        ));
        page.text([x + 10.0, y + 4.0], Anchor::Start, name);
    }

    fn legend_at(self, line: usize) -> [f64; 2] {
        let Frame { top, .. } = self.frame;
        [
            self.frame.right() + 12.0,
            top + 10.0 + LEGEND_STEP * line as f64,
        ]
    }

    fn has_place_for(self, (x, y): (f64, f64)) -> bool {
        self.x.has_place_for(x) && self.y.has_place_for(y)
    }
}

/// Whether a value can be drawn; sums and differences of values near the end of the number range would not be finite.
pub(crate) fn is_number(value: f64) -> bool {
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
pub(crate) fn curve((time, value): (&[f64], &[f64]), horizontal: Axis, vertical: Axis) -> String {
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
    use crate::picture::chart::axis::Scale;

    const PIXELS: Axis = Axis {
        min: 0.0,
        max: 100.0,
        scale: Scale::Linear,
        from: 0.0,
        to: 100.0,
    };

    fn path(value: impl Fn(usize) -> f64, n: usize) -> String {
        let time: Vec<f64> = (0..n).map(|i| 100.0 * i as f64 / n as f64).collect();
        let value: Vec<f64> = (0..n).map(value).collect();
        curve((&time, &value), PIXELS, PIXELS)
    }

    #[test]
    fn peaks_survive_and_points_are_few() {
        let text = path(|i| if i == 54_321 { 90.0 } else { 1.0 }, 100_000);
        assert!(text.contains("54.3 90.0"), "{text}");
        assert!(text.matches('L').count() <= 200, "{text}");
    }

    #[test]
    fn a_stair_goes_straight_up() {
        let (time, value) = ([0.0, 40.0, 40.0, 90.0], [0.0, 0.0, 50.0, 50.0]);
        assert_eq!(
            curve((&time, &value), PIXELS, PIXELS),
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
