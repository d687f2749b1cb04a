//! `trade.svg`: error against cost with the Pareto front, the effect of each knob, and convergence; all axes logarithmic.

use std::fmt::Write as _;

use super::file::KnobFile;
use super::front::{Point, PowerLaw, front};
use super::outcome::{Cost, CostOf, Outcome, point};
use super::plan::Study;
use super::results::{along, bought_along};
use crate::picture::overview::page::{Anchor, Frame, INK, LEFT, Page};

const HEIGHT: f64 = 260.0;
const BELOW: f64 = 56.0;
const RIGHT: f64 = 700.0;
/// Okabe and Ito (2008), without yellow.
const COLORS: [&str; 7] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#333333",
];

/// A logarithmic scale from values to pixels.
#[derive(Clone, Copy, Debug)]
struct LogAxis {
    /// Decimal logarithms of the ends.
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl LogAxis {
    /// Margin of the range on both sides: a twelfth of it, at least a tenth of a decade.
    fn over(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Option<Self> {
        let logs = values.filter(|x| x.is_finite() && 0.0 < *x).map(f64::log10);
        let (low, high) = logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        let margin = ((high - low) / 12.0).max(0.1);
        low.is_finite().then_some(Self {
            low: low - margin,
            high: high + margin,
            from,
            to,
        })
    }

    fn at(&self, value: f64) -> f64 {
        self.from + (value.log10() - self.low) / (self.high - self.low) * (self.to - self.from)
    }

    /// Round numbers: several per decade for a short range, powers of ten alone for a
    /// long one.
    fn ticks(&self) -> Vec<f64> {
        let factors: &[f64] = match self.high - self.low {
            decades if decades < 1.0 => &[1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0],
            decades if decades < 3.0 => &[1.0, 2.0, 5.0],
            _ => &[1.0],
        };
        let powers = self.low.floor() as i32..=self.high.ceil() as i32;
        let all = powers.flat_map(|power| factors.iter().map(move |f| f * 10f64.powi(power)));
        let is_shown = |x: &f64| (self.low..=self.high).contains(&x.log10());
        all.filter(is_shown).collect()
    }
}

/// A plot with both axes and their grid.
struct Plot {
    frame: Frame,
    x: LogAxis,
    y: LogAxis,
}

impl Plot {
    fn open(
        page: &mut Page,
        top: f64,
        [along, up]: [&str; 2],
        points: impl Iterator<Item = (f64, f64)> + Clone,
    ) -> Option<Self> {
        let frame = Frame {
            left: LEFT,
            top,
            width: RIGHT - LEFT,
            height: HEIGHT,
        };
        let shown = points.filter(|(x, y)| [x, y].iter().all(|v| v.is_finite() && 0.0 < **v));
        let x = LogAxis::over(shown.clone().map(|p| p.0), frame.left, frame.right())?;
        let y = LogAxis::over(shown.map(|p| p.1), frame.bottom(), frame.top)?;
        page.rectangle(frame, "fill=\"#fff\"");
        for tick in x.ticks() {
            let at = x.at(tick);
            page.grid_line([at, frame.top], [at, frame.bottom()]);
            page.text([at, frame.bottom() + 16.0], Anchor::Middle, &short(tick));
        }
        for tick in y.ticks() {
            let at = y.at(tick);
            page.grid_line([frame.left, at], [frame.right(), at]);
            page.text([frame.left - 7.0, at + 4.0], Anchor::End, &short(tick));
        }
        let middle = frame.left + frame.width / 2.0;
        page.text([middle, frame.bottom() + 36.0], Anchor::Middle, along);
        page.upright_text([18.0, frame.top + frame.height / 2.0], up);
        page.rectangle(frame, &format!("fill=\"none\" stroke=\"{INK}\""));
        Some(Self { frame, x, y })
    }

    fn dot(&self, page: &mut Page, (x, y): (f64, f64), style: &str, title: &str) {
        if [x, y].iter().all(|v| v.is_finite() && 0.0 < *v) {
            page.titled(
                &format!(
                    "<circle cx=\"{:.1}\" cy=\"{:.1}\" {style}/>",
                    self.x.at(x),
                    self.y.at(y)
                ),
                title,
            );
        }
    }

    fn line(&self, page: &mut Page, points: impl Iterator<Item = (f64, f64)>, style: &str) {
        let mut path = String::new();
        for (x, y) in points.filter(|(x, y)| [x, y].iter().all(|v| v.is_finite() && 0.0 < **v)) {
            let command = if path.is_empty() { 'M' } else { 'L' };
            let _ = write!(path, "{command}{:.1} {:.1}", self.x.at(x), self.y.at(y));
        }
        page.push(&format!("<path d=\"{path}\" fill=\"none\" {style}/>"));
    }

    fn legend(&self, page: &mut Page, line: usize, color: &str, text: &str) {
        let (x, y) = (
            self.frame.right() + 14.0,
            self.frame.top + 12.0 + 17.0 * line as f64,
        );
        page.push(&format!(
            "<circle cx=\"{x:.1}\" cy=\"{:.1}\" r=\"4\" fill=\"{color}\"/>",
            y - 4.0
        ));
        page.text([x + 10.0, y], Anchor::Start, text);
    }
}

/// A number with few digits.
fn short(x: f64) -> String {
    if (1e-3..1e5).contains(&x) {
        format!("{x}")
    } else {
        format!("{x:e}")
    }
}

/// Draws the page.
pub fn svg(study: &Study, all: &[Outcome]) -> String {
    let mut page = Page::default();
    let title = &study.file.title;
    page.styled_text(
        [LEFT, 26.0],
        Anchor::Start,
        "font-size=\"16\" fill=\"#333\"",
        title,
    );
    let mut y = 50.0;
    let error = format!("error of {}", study.file.output.name);
    let costs: [(&str, CostOf); 2] = [
        ("wall time on one thread [s]", |cost| cost.wall_time),
        (
            "work: pair interactions, a contact as 1000 of them",
            Cost::work,
        ),
    ];
    for (label, cost) in costs {
        y = scatter(&mut page, y, study, all, [label, &error], cost);
    }
    for (k, knob) in study.file.knobs.iter().enumerate() {
        y = convergence(&mut page, y, knob, along(all, k), &error);
    }
    page.finish(title, y)
}

fn scatter(
    page: &mut Page,
    top: f64,
    study: &Study,
    all: &[Outcome],
    labels: [&str; 2],
    cost: CostOf,
) -> f64 {
    let points: Vec<Point> = all.iter().map(|found| point(found, cost)).collect();
    let pairs = points.iter().map(|p| (p.cost, p.error));
    let Some(plot) = Plot::open(page, top, labels, pairs) else {
        return top;
    };
    let on_front = front(&points);
    let steps = on_front.iter().map(|&k| (points[k].cost, points[k].error));
    plot.line(
        page,
        steps,
        "stroke=\"#333\" stroke-width=\"1.2\" stroke-dasharray=\"5 3\"",
    );
    for (found, p) in all.iter().zip(&points) {
        // the varied knob, if it is a single one
        let mut turned = (0..found.choice.len()).filter(|&k| found.choice[k] != 0);
        let color = match (turned.next(), turned.next()) {
            (Some(k), None) => COLORS[k % COLORS.len()],
            _ => "#333333",
        };
        let names = study.file.knobs.iter().zip(&found.choice);
        let title: Vec<String> = names
            .map(|(knob, &value)| format!("{} {}", knob.name, knob.values[value].name))
            .collect();
        let style = format!("r=\"4\" fill=\"{color}\" fill-opacity=\"0.85\"");
        plot.dot(page, (p.cost, p.error), &style, &title.join(", "));
    }
    for (k, knob) in study.file.knobs.iter().enumerate() {
        let mine: Vec<Point> = along(all, k).map(|found| point(found, cost)).collect();
        let bought = match bought_along(all, k, cost) {
            Some(factor) => format!("x {factor:.2} a doubling"),
            None => "cost changes by less than half".to_owned(),
        };
        let color = COLORS[k % COLORS.len()];
        plot.legend(page, k, color, &format!("{}: {bought}", knob.name));
        let mut path: Vec<(f64, f64)> = mine.iter().map(|p| (p.cost, p.error)).collect();
        path.sort_by(|a, b| a.0.total_cmp(&b.0));
        let style = format!("stroke=\"{color}\" stroke-width=\"1\" stroke-opacity=\"0.6\"");
        plot.line(page, path.into_iter(), &style);
    }
    plot.legend(page, study.file.knobs.len(), "#333333", "dashed: the front");
    plot.frame.bottom() + BELOW
}

/// Error against the numerical values of a knob, with a power-law fit.
fn convergence<'a>(
    page: &mut Page,
    top: f64,
    knob: &KnobFile,
    runs: impl Iterator<Item = &'a Outcome> + Clone,
    error: &str,
) -> f64 {
    let at = |found: &Outcome| {
        let mut values = found.choice.iter().copied().filter(|&value| value != 0);
        knob.values[values.next().unwrap_or(0)].at
    };
    let pairs: Vec<(f64, f64)> = runs
        .filter_map(|found| Some((at(found)?, found.error.filter(|_| found.is_stable)?)))
        .collect();
    let Some(law) = PowerLaw::fit(pairs.iter().copied()).filter(|_| 2 < pairs.len()) else {
        return top;
    };
    let Some(plot) = Plot::open(page, top, [&knob.name, error], pairs.iter().copied()) else {
        return top;
    };
    for &pair in &pairs {
        plot.dot(page, pair, "r=\"4\" fill=\"#0072b2\"", "");
    }
    let ends = [plot.x.low, plot.x.high].map(|log| 10f64.powf(log));
    page.open_clipped_group(plot.frame);
    let style = "stroke=\"#333\" stroke-width=\"1\" stroke-dasharray=\"5 3\"";
    plot.line(page, ends.into_iter().map(|x| (x, law.at(x))), style);
    page.close_group();
    plot.legend(page, 0, "#333333", &format!("order {:.2}", law.exponent));
    plot.frame.bottom() + BELOW
}
