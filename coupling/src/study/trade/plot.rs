//! `trade.svg`: error against cost with the Pareto front, the effect of each knob, and convergence; all axes logarithmic.

use super::file::KnobFile;
use super::front::{Point, PowerLaw, front};
use super::outcome::{Cost, CostOf, Outcome, point};
use super::plan::Study;
use super::results::{along, bought_along};
use crate::picture::chart::axis::Axis;
use crate::picture::chart::page::{Anchor, Frame, LEFT, Page};
use crate::picture::chart::plot::{BELOW, Plot, color};

const HEIGHT: f64 = 260.0;
/// Room between two plots beyond that for numbers and names; px.
const BETWEEN: f64 = 14.0;
const RIGHT: f64 = 700.0;

/// Opens a plot from `top` down with logarithmic axes around points; `None` without any.
fn open(
    page: &mut Page,
    top: f64,
    names: [&str; 2],
    points: impl Iterator<Item = (f64, f64)> + Clone,
) -> Option<Plot> {
    let frame = Frame {
        left: LEFT,
        top,
        width: RIGHT - LEFT,
        height: HEIGHT,
    };
    let shown = points.filter(|(x, y)| [x, y].iter().all(|v| v.is_finite() && 0.0 < **v));
    let plot = Plot {
        frame,
        x: Axis::over_decades(shown.clone().map(|p| p.0), [frame.left, frame.right()])?,
        y: Axis::over_decades(shown.map(|p| p.1), [frame.bottom(), frame.top])?,
    };
    plot.open(page, 1.0).name(page, names);
    Some(plot)
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
    let Some(plot) = open(page, top, labels, pairs) else {
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
        let hue = match (turned.next(), turned.next()) {
            (Some(k), None) => color(k),
            _ => "#333333",
        };
        let names = study.file.knobs.iter().zip(&found.choice);
        let title: Vec<String> = names
            .map(|(knob, &value)| format!("{} {}", knob.name, knob.values[value].name))
            .collect();
        let style = format!("r=\"4\" fill=\"{hue}\" fill-opacity=\"0.85\"");
        plot.dot(page, (p.cost, p.error), &style, &title.join(", "));
    }
    for (k, knob) in study.file.knobs.iter().enumerate() {
        let mine: Vec<Point> = along(all, k).map(|found| point(found, cost)).collect();
        let bought = match bought_along(all, k, cost) {
            Some(factor) => format!("x {factor:.2} a doubling"),
            None => "cost changes by less than half".to_owned(),
        };
        let hue = color(k);
        plot.legend_of_points(page, k, hue, &format!("{}: {bought}", knob.name));
        let mut path: Vec<(f64, f64)> = mine.iter().map(|p| (p.cost, p.error)).collect();
        path.sort_by(|a, b| a.0.total_cmp(&b.0));
        let style = format!("stroke=\"{hue}\" stroke-width=\"1\" stroke-opacity=\"0.6\"");
        plot.line(page, path.into_iter(), &style);
    }
    plot.legend_of_points(page, study.file.knobs.len(), "#333333", "dashed: the front");
    plot.close(page);
    plot.frame.bottom() + BELOW + BETWEEN
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
    let Some(plot) = open(page, top, [&knob.name, error], pairs.iter().copied()) else {
        return top;
    };
    for &pair in &pairs {
        plot.dot(page, pair, "r=\"4\" fill=\"#0072b2\"", "");
    }
    let ends = [plot.x.min, plot.x.max];
    page.open_clipped_group(plot.frame);
    let style = "stroke=\"#333\" stroke-width=\"1\" stroke-dasharray=\"5 3\"";
    plot.line(page, ends.into_iter().map(|x| (x, law.at(x))), style);
    page.close_group();
    plot.legend_of_points(page, 0, "#333333", &format!("order {:.2}", law.exponent));
    plot.close(page);
    plot.frame.bottom() + BELOW + BETWEEN
}
