//! Instruments, scale and north on a plan.

use super::layout::Chart;
use super::{Mark, SECTION};
use crate::picture::chart::page::{Anchor, Frame, INK, Page, shortened};

/// Height of the letters of names, and the mean width of one; px.
const LETTERS: f64 = 10.5;
const LETTER_WIDTH: f64 = 5.7;
/// Characters of a name.
const LONGEST_NAME: usize = 24;
/// Radius of the mark of a point; px.
const RADIUS: f64 = 3.2;
/// Distance of names from lines, the sampling step of the lines, and the largest number of samples; px.
const LINE_RADIUS: f64 = 1.5;
const LINE_STEP: f64 = 3.0;
const MOST_STEPS: f64 = 1000.0;
/// Largest length of the scale bar over the width of a plan.
const SCALE_SHARE: f64 = 0.3;
/// Styles of letters and of the halo behind them, for legibility on any ground; drawn separately, since not all viewers
/// support `paint-order`.
const LETTERING: [&str; 2] = [
    "fill=\"none\" stroke=\"#fff\" stroke-width=\"2.6\" stroke-opacity=\"0.85\" stroke-linejoin=\"round\"",
    "fill=\"#1a1a1a\"",
];

fn letters(page: &mut Page, at: [f64; 2], anchor: Anchor, weight: &str, text: &str) {
    for style in LETTERING {
        let style = format!("font-size=\"{LETTERS}\" font-weight=\"{weight}\" {style}");
        page.styled_text(at, anchor, &style, text);
    }
}

/// Draws points and lines.
pub(super) fn draw(page: &mut Page, chart: Chart, marks: &[Mark]) {
    for mark in marks {
        match mark {
            Mark::Point { at, .. } => {
                let [x, y] = chart.pixel(*at);
                page.push(&format!(
                    "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{RADIUS}\" fill=\"#fff\" stroke=\"{INK}\" stroke-width=\"1.3\"/>"
                ));
            }
            Mark::Line { from, to, .. } => {
                let ends = (chart.pixel(*from), chart.pixel(*to));
                page.line(
                    ends.0,
                    ends.1,
                    "stroke=\"#fff\" stroke-width=\"3.4\" stroke-opacity=\"0.8\"",
                );
                page.line(
                    ends.0,
                    ends.1,
                    &format!("stroke=\"{INK}\" stroke-width=\"1.4\""),
                );
            }
            Mark::Section { from, to } => {
                page.line(chart.pixel(*from), chart.pixel(*to), SECTION);
            }
        }
    }
}

/// Writes the names where they overlap neither each other nor a point and stay in the frame, if possible.
pub(super) fn names(page: &mut Page, chart: Chart, marks: &[Mark]) {
    let mut taken: Vec<Frame> = marks.iter().flat_map(|mark| covered(chart, mark)).collect();
    for mark in marks {
        let (name, [x, y]) = match mark {
            Mark::Section { .. } => continue,
            Mark::Point { name, at } => (name, chart.pixel(*at)),
            Mark::Line { name, from, to } => {
                let middle = [0, 1].map(|axis| 0.5 * (from[axis] + to[axis]));
                (name, chart.pixel(middle))
            }
        };
        let name = shortened(name, LONGEST_NAME);
        let width = LETTER_WIDTH * name.chars().count() as f64;
        let (beside, above) = (RADIUS + 3.0, RADIUS + 2.5);
        let centered = x - 0.5 * width;
        let mut places = vec![
            [x + beside, y - 0.5 * LETTERS],
            [x - beside - width, y - 0.5 * LETTERS],
            [centered, y - above - LETTERS],
            [centered, y + above],
            [x + beside, y - above - LETTERS],
            [x + beside, y + above],
            [x - beside - width, y - above - LETTERS],
            [x - beside - width, y + above],
        ];
        if matches!(mark, Mark::Line { .. }) {
            // a name beside the middle of a line would be on it
            places.drain(..2);
        }
        let box_at = |[left, top]: [f64; 2]| Frame {
            left,
            top,
            width,
            height: LETTERS,
        };
        let is_free = |place: &Frame| {
            place.is_within(chart.frame) && !taken.iter().any(|other| place.overlaps(*other))
        };
        let boxes = places.into_iter().map(box_at);
        let place = boxes.clone().find(is_free);
        let Some(place) = place.or_else(|| boxes.clone().next()) else {
            continue;
        };
        taken.push(place);
        let baseline = [place.left, place.bottom() - 2.0];
        letters(page, baseline, Anchor::Start, "normal", &name);
    }
}

/// Area covered by a mark: a line is a row of small squares.
fn covered(chart: Chart, mark: &Mark) -> Vec<Frame> {
    let (from, to) = match mark {
        Mark::Point { at, .. } => return vec![Frame::around(chart.pixel(*at), RADIUS)],
        Mark::Line { from, to, .. } | Mark::Section { from, to } => {
            (chart.pixel(*from), chart.pixel(*to))
        }
    };
    let n = ((to[0] - from[0]).hypot(to[1] - from[1]) / LINE_STEP).ceil();
    // a line far longer than the plan is sampled only in part
    let n = n.clamp(1.0, MOST_STEPS);
    let at = |k: u32| {
        let share = f64::from(k) / n;
        [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis]))
    };
    (0..=n as u32)
        .map(|k| Frame::around(at(k), LINE_RADIUS))
        .collect()
}

/// Draws a bar of a round length in the lower left corner.
pub(super) fn scale_bar(page: &mut Page, chart: Chart) {
    let Frame { left, width, .. } = chart.frame;
    let length = nice_down(SCALE_SHARE * width / chart.scale());
    let [from, y] = [left + 10.0, chart.frame.bottom() - 9.0];
    let to = from + length * chart.scale();
    for (style, margin) in [
        (
            "stroke=\"#fff\" stroke-width=\"5\" stroke-opacity=\"0.85\"",
            1.5,
        ),
        ("stroke=\"#1a1a1a\" stroke-width=\"2\"", 0.0),
    ] {
        page.line([from - margin, y], [to + margin, y], style);
    }
    for x in [from, to] {
        page.line(
            [x, y - 4.0],
            [x, y + 1.0],
            "stroke=\"#1a1a1a\" stroke-width=\"1.2\"",
        );
    }
    let label = match length {
        1000.0.. => format!("{} km", length / 1000.0),
        ..1.0 => format!("{:.0} mm", 1000.0 * length),
        _ => format!("{length} m"),
    };
    let middle = [0.5 * (from + to), y - 6.0];
    letters(page, middle, Anchor::Middle, "normal", &label);
}

/// Draws a north arrow, along y, in the upper right corner.
pub(super) fn north(page: &mut Page, frame: Frame) {
    let [x, y] = [frame.right() - 14.0, frame.top + 18.0];
    for style in LETTERING {
        page.push(&format!(
            "<path d=\"M{x:.1} {y:.1}l4.5 13l-4.5 -3.2l-4.5 3.2z\" {style}/>"
        ));
    }
    letters(page, [x, y - 4.0], Anchor::Middle, "bold", "N");
}

/// Largest of 1, 2, 5 times a power of ten up to a value.
fn nice_down(value: f64) -> f64 {
    let power = 10f64.powf(value.log10().floor());
    let nice = [5.0, 2.0, 1.0]
        .into_iter()
        .find(|factor| factor * power <= value * (1.0 + 1e-9));
    nice.unwrap_or(1.0) * power
}

impl Frame {
    fn around([x, y]: [f64; 2], radius: f64) -> Self {
        Self {
            left: x - radius,
            top: y - radius,
            width: 2.0 * radius,
            height: 2.0 * radius,
        }
    }

    fn overlaps(self, other: Self) -> bool {
        self.left < other.right()
            && other.left < self.right()
            && self.top < other.bottom()
            && other.top < self.bottom()
    }

    fn is_within(self, other: Self) -> bool {
        other.left <= self.left
            && self.right() <= other.right()
            && other.top <= self.top
            && self.bottom() <= other.bottom()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CHART: Chart = Chart {
        frame: Frame {
            left: 100.0,
            top: 50.0,
            width: 400.0,
            height: 200.0,
        },
        min: [0.0, 0.0],
        max: [800.0, 400.0],
    };

    fn point(name: &str, at: [f64; 2]) -> Mark {
        Mark::Point {
            name: name.to_owned(),
            at,
        }
    }

    /// Text and position of the labels, without the halos behind them.
    fn written(marks: &[Mark]) -> Vec<(f64, f64, String)> {
        let mut page = Page::default();
        names(&mut page, CHART, marks);
        let text = page.finish("", 0.0);
        let number = |line: &str, key: &str| -> f64 {
            let rest = line.split(key).nth(1).unwrap_or_default();
            rest.split('"')
                .next()
                .unwrap_or_default()
                .parse()
                .unwrap_or(f64::NAN)
        };
        let of = |line: &str| {
            let name = line.rsplit('>').nth(1).unwrap_or_default();
            let name = name.trim_end_matches("</text").to_owned();
            (number(line, "x=\""), number(line, "y=\""), name)
        };
        text.lines()
            .filter(|line| line.starts_with("<text") && !line.contains("fill=\"none\""))
            .map(of)
            .collect()
    }

    #[test]
    fn names_stand_beside_their_points_and_are_escaped() {
        let found = written(&[point("a<b & \"c\"", [400.0, 200.0])]);
        // the point is at (300, 150) px
        assert_eq!(found.len(), 1);
        let (x, y, name) = &found[0];
        assert!((300.0..310.0).contains(x) && (145.0..160.0).contains(y));
        assert_eq!(name, "a&lt;b &amp; &quot;c&quot;");
    }

    #[test]
    fn names_keep_off_each_other_and_the_edge() {
        // at the right edge the name goes to the left, and of two close by one goes elsewhere
        let found = written(&[
            point("edge", [795.0, 200.0]),
            point("first", [200.0, 200.0]),
            point("second", [204.0, 196.0]),
        ]);
        assert!(found[0].0 < 497.0 - LETTER_WIDTH * 4.0);
        let away = (found[1].1 - found[2].1).abs() >= LETTERS
            || (found[1].0 - found[2].0).abs() >= LETTER_WIDTH * 5.0;
        assert!(away, "{found:?}");
    }

    #[test]
    fn names_keep_off_lines() {
        let line = Mark::Line {
            name: "line".to_owned(),
            from: [410.0, 200.0],
            to: [700.0, 200.0],
        };
        let found = written(&[point("point", [400.0, 200.0]), line]);
        // the line goes off from (305, 150) px: the name of the point at (300, 150) is not on it, and that of the line
        // is above it
        assert!(found[0].0 + 5.0 * LETTER_WIDTH < 300.0, "{found:?}");
        assert!(found[1].1 < 150.0, "{found:?}");
    }

    #[test]
    fn the_scale_is_round_and_as_long_as_it_says() {
        let mut page = Page::default();
        scale_bar(&mut page, CHART);
        let text = page.finish("", 0.0);
        // 0.3 of 800 m is 240 m
        assert!(text.contains(">200 m<"));
        assert!(text.contains("x1=\"110.0\" y1=\"241.0\" x2=\"210.0\" y2=\"241.0\""));
        for (value, expected) in [(0.3, 0.2), (999.0, 500.0), (1000.0, 1000.0), (23.0, 20.0)] {
            assert!((nice_down(value) / expected - 1.0).abs() < 1e-12, "{value}");
        }
    }
}
