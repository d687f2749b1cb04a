//! Summary of a run on one page, `overview.svg`, without external programs.
//!
//! Side views (x to the right, z up, seen from −y; where rock slides, along its way) with the water colored by speed, plans of scenes with terrain, then
//! charts, and the gauges and the energies, one plot per unit. Input is plain data, so that a page can be made from files as
//! well as from a running world.
//!
//! Particles are drawn as a raster image inside the page, everything else as vector graphics. The page stays below 500 kB:
//! images reduce their resolution, curves keep two points (lowest and highest) per column of pixels.

mod bar;
pub mod plan;
mod plot;
mod raster;
mod table;
mod view;

use crate::output::peaks::Peak;
use crate::picture::chart::page::{Anchor, Page, WIDTH};
use plan::Plan;
use plot::Axes;
use serde::{Deserialize, Serialize};
pub(in crate::picture) use view::keep_seen;

/// Scene at one time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    /// Simulated time; s.
    pub time: f64,
    /// Particle positions, of those that the picture shows; m.
    pub positions: Vec<[f32; 3]>,
    /// Speed of each particle; m/s.
    pub speeds: Vec<f32>,
    /// Silhouettes of the blocks, drawn in this order.
    pub outlines: Vec<Outline>,
}

/// Silhouette of a block in the side view.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Outline {
    /// Corners, x and z; m. Omit bodies between the viewer and the water, such as a front wall.
    pub points: Vec<[f32; 2]>,
    /// Whether the block never moves; drawn in gray, behind the water.
    pub is_fixed: bool,
}

/// A quantity over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// Name for the legend.
    pub name: String,
    /// Unit; records of one unit share a plot.
    pub unit: String,
    /// Times, ascending; s.
    pub time: Vec<f64>,
    /// A value per time; NaN in a gap.
    pub value: Vec<f64>,
    /// The same in theory, drawn dotted; empty without one.
    pub theory: Vec<f64>,
}

/// Curves over a variable other than time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chart {
    /// Label of the vertical axis.
    pub label: String,
    /// Label of the horizontal axis, with unit.
    pub along: String,
    /// The curves, of one unit; `time` holds the abscissa.
    pub curves: Vec<Record>,
}

/// Content of the page.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overview {
    /// Headline.
    pub title: String,
    /// Key figures; wrapped as needed, line breaks are kept.
    pub subtitle: String,
    /// Size of a particle; m.
    pub particle_spacing: f64,
    /// Usually the start, the middle and the end.
    pub snapshots: Vec<Snapshot>,
    /// Drawn between the views and the gauges.
    pub charts: Vec<Chart>,
    /// Gauge records.
    pub gauges: Vec<Record>,
    /// Energy ledger, as changes since the start.
    pub energy: Vec<Record>,
    /// Largest values of the gauges, drawn as a table below their records.
    pub peaks: Vec<Peak>,
    /// Lower left and upper right corner of the side view, x and z; m.
    pub view: ([f64; 2], [f64; 2]),
    /// Label of the horizontal axis of the side view; x when empty.
    pub along: String,
    /// Drawn below the side views, for scenes with terrain.
    pub plan: Option<Plan>,
}

/// Pictures and outlines of the side views, so that the page stays below 500 kB with its curves; bytes of text.
const VIEW_BUDGET: usize = 250_000;
/// Budget of the side views if there are plans, too.
const VIEW_BUDGET_BESIDE_PLANS: usize = 110_000;

/// Draws the page.
pub fn svg(overview: &Overview) -> String {
    let Overview {
        title,
        subtitle,
        particle_spacing,
        snapshots,
        charts,
        gauges,
        energy,
        peaks,
        view,
        along,
        plan,
    } = overview;
    let mut page = Page::default();
    let mut y = heading(&mut page, title, subtitle);
    if !snapshots.is_empty() {
        let budget = match plan {
            None => VIEW_BUDGET,
            Some(_) => VIEW_BUDGET_BESIDE_PLANS,
        };
        let image = view::Image {
            spacing: *particle_spacing,
            budget,
        };
        let along = if along.is_empty() { "x [m]" } else { along };
        y = view::draw(&mut page, y, snapshots, (*view, along), image);
    }
    if let Some(plan) = plan {
        y = plan::draw(&mut page, y, plan, *particle_spacing);
    }
    for chart in charts {
        let curves: Vec<&Record> = chart.curves.iter().collect();
        let axes = Axes {
            vertical: &chart.label,
            horizontal: &chart.along,
            marked: &[],
        };
        y = plot::draw(&mut page, y, axes, &curves);
    }
    let times: Vec<f64> = snapshots.iter().map(|snapshot| snapshot.time).collect();
    let plots = |page: &mut Page, mut y: f64, label, records| {
        for records in by_unit(records) {
            let axes = Axes {
                vertical: label,
                horizontal: "t [s]",
                marked: &times,
            };
            y = plot::draw(page, y, axes, &records);
        }
        y
    };
    y = plots(&mut page, y, "gauges", gauges);
    y = table::draw(&mut page, y, peaks);
    y = plots(&mut page, y, "change of energy", energy);
    page.finish(title, y)
}

/// Draws headline and key figures; returns the next vertical position.
fn heading(page: &mut Page, title: &str, subtitle: &str) -> f64 {
    let mut y = 34.0;
    page.styled_text(
        [24.0, y],
        Anchor::Start,
        "font-size=\"20\" font-weight=\"bold\" fill=\"#1a1a1a\"",
        title,
    );
    y += 4.0;
    // 12 px of a common sans serif fit about this often.
    for line in wrapped(subtitle, ((WIDTH - 48.0) / 6.4) as usize) {
        y += 18.0;
        page.styled_text(
            [24.0, y],
            Anchor::Start,
            "font-size=\"12\" fill=\"#555\"",
            &line,
        );
    }
    y + 14.0
}

/// Lines of at most `n` characters, broken between words.
fn wrapped(text: &str, n: usize) -> Vec<String> {
    let mut lines = Vec::new();
    for paragraph in text.lines() {
        let mut line = String::new();
        for word in paragraph.split_whitespace() {
            if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > n {
                lines.push(std::mem::take(&mut line));
            }
            if !line.is_empty() {
                line.push(' ');
            }
            line += word;
        }
        lines.push(line);
    }
    lines
}

/// Groups of records with a common unit, in the order of their first record.
fn by_unit(records: &[Record]) -> Vec<Vec<&Record>> {
    let mut groups: Vec<Vec<&Record>> = Vec::new();
    for record in records {
        match groups
            .iter_mut()
            .find(|group| group.iter().all(|other| other.unit == record.unit))
        {
            Some(group) => group.push(record),
            None => groups.push(vec![record]),
        }
    }
    groups
}
