//! `sweep.html`: the plots of a sweep, its effects as numbers, and who failed and why, in one file without a network.

use std::fmt::Write as _;

use super::collected::{Collected, Effect, State, count, draws, effects};
use super::plan::Sweep;
use super::statistics::{Estimated, wilson};
use crate::files::vtk::escape;

const STYLE: &str = "body{font:15px/1.5 Helvetica,Arial,sans-serif;color:#222;max-width:1040px;margin:2em auto;padding:0 1em}\
table{border-collapse:collapse;margin:1em 0}td,th{border:1px solid #ddd;padding:3px 10px;text-align:left}\
td.n{text-align:right;font-variant-numeric:tabular-nums}svg{max-width:100%;height:auto}";

/// The page; `svg` is the drawing of [`super::plot`].
pub fn html(sweep: &Sweep, all: &[Collected], svg: &str) -> String {
    let title = escape(&sweep.file.title);
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<title>{title}</title>\n<style>{STYLE}</style>\n<h1>{title}</h1>\n\
         <p>{}</p>\n{svg}\n",
        escape(&summary(all))
    );
    for (k, output) in sweep.file.outputs.iter().enumerate() {
        let effects = effects(sweep, all, k);
        let _ = write!(
            page,
            "<h2>{}</h2>\n{}",
            escape(&output.name),
            quantiles(&draws(sweep, all, k))
        );
        if effects
            .iter()
            .any(|effect| effect.rank.is_some() || effect.indices.is_some())
        {
            page += &table_of(sweep, &effects);
        }
    }
    page += &told(all, "Runs that failed", |found| &found.message);
    page += &told(all, "Runs to look at", |found| &found.doubts);
    page += "</html>\n";
    page
}

/// Numbers of runs by their end.
pub fn summary(all: &[Collected]) -> String {
    let n = all.len();
    let completed = wilson(count(all, State::Completed), n);
    let mut words = format!(
        "{n} rows: {} completed ({:.0} %, 95 % confidence {:.0} to {:.0})",
        count(all, State::Completed),
        100.0 * completed.value,
        100.0 * completed.low,
        100.0 * completed.high
    );
    let others = [
        (State::Failed, "failed"),
        (State::Refused, "refused by the scene"),
        (State::Unfinished, "not finished"),
    ];
    for (state, word) in others {
        let k = count(all, state);
        if 0 < k {
            let _ = write!(words, ", {k} {word}");
        }
    }
    words
}

/// Median and the values that a tenth and a hundredth of the runs reach.
fn quantiles(values: &[f64]) -> String {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let Some(last) = sorted.len().checked_sub(1) else {
        return "<p>No run has a value.</p>\n".to_owned();
    };
    let at = |share: f64| sorted[(share * last as f64).round() as usize];
    format!(
        "<p>{} values: smallest {:.4}, median {:.4}, reached by one in ten {:.4}, largest {:.4}.</p>\n",
        sorted.len(),
        sorted[0],
        at(0.5),
        at(0.9),
        sorted[last]
    )
}

fn table_of(sweep: &Sweep, effects: &[Effect]) -> String {
    let mut table =
        "<table>\n<tr><th>input</th><th>rank correlation</th><th>first Sobol index</th><th>total Sobol index</th></tr>\n"
            .to_owned();
    let cell = |estimated: Option<Estimated>| match estimated {
        Some(Estimated { value, low, high }) => format!("{value:.3} ({low:.3} to {high:.3})"),
        None => "–".to_owned(),
    };
    for (input, effect) in sweep.file.inputs.iter().zip(effects) {
        let estimates = [
            effect.rank,
            effect.indices.map(|of| of.first),
            effect.indices.map(|of| of.total),
        ];
        let cells: String = (estimates.into_iter())
            .map(|one| format!("<td class=\"n\">{}</td>", cell(one)))
            .collect();
        let _ = writeln!(table, "<tr><td>{}</td>{cells}</tr>", escape(&input.name));
    }
    table + "</table>\n"
}

/// Rows of which something is to be said.
fn told(all: &[Collected], title: &str, of: fn(&Collected) -> &str) -> String {
    let rows: Vec<&Collected> = all.iter().filter(|found| !of(found).is_empty()).collect();
    if rows.is_empty() {
        return String::new();
    }
    let mut table = format!(
        "<h2>{title}: {}</h2>\n<table>\n<tr><th>row</th><th>inputs</th><th>why</th></tr>\n",
        rows.len()
    );
    for found in rows {
        let _ = writeln!(
            table,
            "<tr><td class=\"n\">{}</td><td>{}</td><td>{}</td></tr>",
            found.row.number,
            escape(&found.row.inputs.join(", ")),
            escape(of(found))
        );
    }
    table + "</table>\n"
}
