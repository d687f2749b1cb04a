//! `sweep.svg`: for each output its exceedance curve with the band, the effect of every input, and the runs over each input.

use super::collected::{Collected, Effect, draws, effects, pairs};
use super::plan::Sweep;
use super::statistics::{Estimated, exceedance};
use crate::picture::chart::axis::{Axis, Scale, open_range};
use crate::picture::chart::page::{Anchor, Frame, LEFT, Page, shortened};
use crate::picture::chart::plot::{BELOW, Plot, color};

/// Height of a plot; px.
const HEIGHT: f64 = 250.0;
/// Width of the exceedance plot; px.
const WIDTH: f64 = 440.0;
/// Left edge of the bars, right of the names of inputs; px.
const BARS: f64 = 720.0;
/// Right edge of all; px.
const RIGHT: f64 = 960.0;
/// Plots of inputs in a row.
const IN_A_ROW: usize = 3;
/// Height of a plot of an input; px.
const SMALL: f64 = 170.0;
/// Room left of a plot for its numbers; px.
const NUMBERS: f64 = 62.0;
/// Room between plots; px.
const BETWEEN: f64 = 16.0;
/// Inputs drawn as bars, at most.
const MOST_BARS: usize = 10;

/// Draws the page.
pub fn svg(sweep: &Sweep, all: &[Collected]) -> String {
    let mut page = Page::default();
    let title = &sweep.file.title;
    let style = "font-size=\"16\" fill=\"#333\"";
    page.styled_text([LEFT, 26.0], Anchor::Start, style, title);
    let mut y = 44.0;
    for (k, output) in sweep.file.outputs.iter().enumerate() {
        let values = draws(sweep, all, k);
        if values.is_empty() {
            let words = format!("{}: no run has a value", output.name);
            page.text([LEFT, y + 16.0], Anchor::Start, &words);
            y += 40.0;
            continue;
        }
        curve(&mut page, y, &output.name, &values);
        bars(&mut page, y, sweep, &effects(sweep, all, k));
        y += HEIGHT + BELOW + BETWEEN;
        y = clouds(&mut page, y, sweep, all, k);
    }
    page.finish(title, y)
}

/// Linear axis around values.
fn axis(values: impl Iterator<Item = f64>, [from, to]: [f64; 2]) -> Axis {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
        (low.min(x), high.max(x))
    });
    let margin = 0.04 * (high - low);
    let (min, max) = open_range(low - margin, high + margin, 1e-6);
    Axis {
        scale: Scale::Linear,
        min,
        max,
        from,
        to,
    }
}

/// Exceedance curve and its band, as steps.
fn curve(page: &mut Page, top: f64, name: &str, values: &[f64]) {
    let frame = Frame {
        left: LEFT,
        top,
        width: WIDTH,
        height: HEIGHT,
    };
    let points = exceedance(values);
    let plot = Plot {
        frame,
        x: axis(points.iter().map(|p| p.value), [frame.left, frame.right()]),
        y: Axis {
            scale: Scale::Linear,
            min: 0.0,
            max: 1.0,
            from: frame.bottom(),
            to: frame.top,
        },
    };
    let up = format!("share of {} runs that reach it", values.len());
    plot.open(page, 1.0).name(page, [name, &up]);
    // a value is reached by all runs up to it: the curve falls behind each
    let stair = |share: &dyn Fn(Estimated) -> f64| -> Vec<(f64, f64)> {
        let mut from = plot.x.min;
        let mut stair = Vec::new();
        for point in &points {
            let share = share(point.share);
            stair.extend([(from, share), (point.value, share)]);
            from = point.value;
        }
        stair
    };
    let mut band = stair(&|share| share.high);
    band.extend(stair(&|share| share.low).into_iter().rev());
    plot.line(
        page,
        band.into_iter(),
        "style=\"fill:#0072b2;fill-opacity:0.18;stroke:none\"",
    );
    let style = "stroke=\"#0072b2\" stroke-width=\"1.6\"";
    plot.line(page, stair(&|share| share.value).into_iter(), style);
    plot.close(page);
    let note = "band: 95 % for each value (Wilson)";
    page.text([frame.right() - 6.0, top + 16.0], Anchor::End, note);
}

/// Effects of inputs with their intervals, the largest first.
fn bars(page: &mut Page, top: f64, sweep: &Sweep, effects: &[Effect]) {
    let named = sweep.file.inputs.iter().zip(effects);
    let has_indices = effects.iter().any(|effect| effect.indices.is_some());
    let mut shown: Vec<(&str, Estimated)> = named
        .filter_map(|(input, effect)| {
            let estimated = match effect.indices {
                Some(indices) => indices.total,
                None => effect.rank?,
            };
            Some((input.name.as_str(), estimated))
        })
        .collect();
    if shown.is_empty() {
        return;
    }
    shown.sort_by(|a, b| b.1.value.abs().total_cmp(&a.1.value.abs()));
    shown.truncate(MOST_BARS);
    let step = 22.0;
    let frame = Frame {
        left: BARS,
        top,
        width: RIGHT - BARS,
        height: step * shown.len() as f64 + 8.0,
    };
    let (min, name) = match has_indices {
        true => (0.0, "total Sobol index"),
        false => (-1.0, "rank correlation"),
    };
    let x = Axis {
        scale: Scale::Linear,
        min,
        max: 1.0,
        from: frame.left,
        to: frame.right(),
    };
    let y = Axis {
        scale: Scale::Linear,
        min: 0.0,
        max: 0.01,
        from: frame.bottom(),
        to: frame.top,
    };
    let plot = Plot { frame, x, y };
    page.rectangle(frame, "fill=\"#fff\"");
    for (k, (input, effect)) in shown.iter().enumerate() {
        let middle = top + 4.0 + step * (k as f64 + 0.5);
        let (zero, end) = (x.at(0.0), x.at(effect.value.clamp(min, 1.0)));
        let bar = Frame {
            left: zero.min(end),
            top: middle - 7.0,
            width: (end - zero).abs(),
            height: 14.0,
        };
        let hue = if effect.value < 0.0 {
            color(1)
        } else {
            color(0)
        };
        page.rectangle(bar, &format!("fill=\"{hue}\" fill-opacity=\"0.7\""));
        let [low, high] = [effect.low, effect.high].map(|end| x.at(end.clamp(min, 1.0)));
        page.line(
            [low, middle],
            [high, middle],
            "stroke=\"#333\" stroke-width=\"1.2\"",
        );
        page.text(
            [BARS - 8.0, middle + 4.0],
            Anchor::End,
            &shortened(input, 24),
        );
    }
    let ends = [min, 0.5 * (min + 1.0), 1.0];
    for value in ends {
        let label = format!("{value}").replace('-', "−");
        page.text([x.at(value), frame.bottom() + 16.0], Anchor::Middle, &label);
    }
    let zero = x.at(0.0);
    page.line([zero, top], [zero, frame.bottom()], "stroke=\"#333\"");
    let below = [frame.left + 0.5 * frame.width, frame.bottom() + 32.0];
    page.text(below, Anchor::Middle, name);
    plot.close(page);
}

/// Runs over each numerical input; returns where the next part begins.
fn clouds(page: &mut Page, top: f64, sweep: &Sweep, all: &[Collected], output: usize) -> f64 {
    let numerical: Vec<(usize, Vec<(f64, f64)>)> = (0..sweep.file.inputs.len())
        .map(|input| (input, pairs(all, input, output)))
        .filter(|(_, pairs)| 1 < pairs.len())
        .collect();
    let width = (RIGHT - LEFT - NUMBERS * (IN_A_ROW - 1) as f64) / IN_A_ROW as f64;
    let step = SMALL + BELOW + BETWEEN;
    for (place, (input, pairs)) in numerical.iter().enumerate() {
        let (row, column) = (place / IN_A_ROW, place % IN_A_ROW);
        let frame = Frame {
            left: LEFT + column as f64 * (width + NUMBERS),
            top: top + row as f64 * step,
            width,
            height: SMALL,
        };
        let plot = Plot {
            frame,
            x: axis(pairs.iter().map(|p| p.0), [frame.left, frame.right()]),
            y: axis(pairs.iter().map(|p| p.1), [frame.bottom(), frame.top]),
        };
        plot.open(page, 1.0);
        let name = &sweep.file.inputs[*input].name;
        let below = [frame.left + 0.5 * width, frame.bottom() + 32.0];
        page.text(below, Anchor::Middle, name);
        if column == 0 {
            let beside = [18.0, frame.top + 0.5 * SMALL];
            page.upright_text(beside, &shortened(&sweep.file.outputs[output].name, 28));
        }
        for &(x, y) in pairs {
            let style = "r=\"2.6\" fill=\"#0072b2\" fill-opacity=\"0.55\"";
            plot.dot(page, (x, y), style, &format!("{x} {y}"));
        }
        plot.close(page);
    }
    top + numerical.len().div_ceil(IN_A_ROW) as f64 * step
}
