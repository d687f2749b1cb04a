//! Plan views of the scene, x to the right and y up, and maps of wave impact.
//!
//! Shaded relief is overlaid in the order of a map: water, contour lines, blocks, instruments. The image of the land and
//! the lines are in the page once for all plans.

mod contour;
mod layout;
mod lines;
mod marks;
mod panels;
pub(in crate::picture) mod picture;
mod relief;
mod sheet;

use serde::{Deserialize, Serialize};

use crate::output::observe::maps::MapExtremes;
use crate::picture::chart::page::{Anchor, Frame, INK, LEFT, Page};
use crate::scene::terrain::grid::Grid;
use layout::{Chart, Layout};
use lines::Lines;
use relief::Relief;

/// Data of the plan views.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Lower left and upper right corner, x and y; m.
    pub view: ([f64; 2], [f64; 2]),
    /// The point of the map that is x = y = z = 0; m.
    pub origin: [f64; 3],
    /// Heights of the ground, NaN where there is none; m.
    pub ground: Grid,
    /// Still-water level, if there is water; m.
    pub still_level: Option<f64>,
    /// Sampling points of the surface in views, without elevations.
    pub water: Grid,
    /// Usually the start and the end.
    pub views: Vec<FromAbove>,
    /// Maps of extremes, if recorded.
    pub maps: Option<MapExtremes>,
    /// Instruments.
    pub marks: Vec<Mark>,
}

/// Water and blocks from above at one time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FromAbove {
    /// Simulated time; s.
    pub time: f64,
    /// Height of the surface at the points for water, NaN where it is dry; m.
    pub surface: Vec<f32>,
    /// Blocks that are not fixed, low to high.
    pub blocks: Vec<Footprint>,
}

/// Outline of a block in plan view.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Footprint {
    /// Corners of a convex outline, x and y; m.
    pub points: Vec<[f32; 2]>,
    /// Whether it is all under water.
    pub is_under_water: bool,
}

/// An instrument on the plan.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// At a point.
    Point {
        /// Name.
        name: String,
        /// x and y; m.
        at: [f64; 2],
    },
    /// Along a line.
    Line {
        /// Name.
        name: String,
        /// x and y; m.
        from: [f64; 2],
        /// x and y; m.
        to: [f64; 2],
    },
    /// Line of the side views.
    Section {
        /// x and y; m.
        from: [f64; 2],
        /// x and y; m.
        to: [f64; 2],
    },
}

/// Identifier of the land picture that all plans share.
const LAND: &str = "land";
const LINES: &str = "lines";

const SHORE: &str =
    "fill=\"none\" stroke=\"#0d2c54\" stroke-width=\"1.3\" stroke-linejoin=\"round\"";
const LAND_LINES: &str =
    "fill=\"none\" stroke=\"#6b5334\" stroke-width=\"0.6\" stroke-opacity=\"0.65\"";
const BED_LINES: &str =
    "fill=\"none\" stroke=\"#3d5a73\" stroke-width=\"0.5\" stroke-opacity=\"0.5\"";
/// Line of the side views.
const SECTION: &str =
    "fill=\"none\" stroke=\"#333\" stroke-width=\"0.8\" stroke-dasharray=\"7 3 1.5 3\"";
/// Blocks under water and others.
const ROCKS: [&str; 2] = [
    "fill=\"#a98a6b\" fill-opacity=\"0.45\" stroke=\"#4d3a28\" stroke-opacity=\"0.6\" stroke-width=\"0.25\" stroke-linejoin=\"round\"",
    "fill=\"#b3916d\" stroke=\"#4d3a28\" stroke-width=\"0.3\" stroke-linejoin=\"round\"",
];

/// Draws all plans from `y` down, with water of a particle spacing (m); returns the next vertical position.
pub(super) fn draw(page: &mut Page, y: f64, plan: &Plan, spacing: f64) -> f64 {
    let panels = panels::panels(plan, spacing);
    let layout = Layout::new(y, panels.len(), plan.view);
    let Some(&first) = layout.frames.first() else {
        return y;
    };
    let relief = Relief::new(&plan.ground, plan.still_level);
    let chart = |frame| Chart {
        frame,
        min: layout.min,
        max: layout.max,
    };
    // position in an otherwise empty page
    let alone = chart(Frame {
        left: 0.0,
        top: 0.0,
        ..first
    });
    let pictures = panels::pictures(alone, plan, &relief, &panels);
    let lines = Lines::new(alone, plan);
    define(page, alone.frame, pictures.land.as_deref(), &lines);
    let outlines = lines::outlines(alone, &panels);
    for (i, (panel, &frame)) in panels.iter().zip(&layout.frames).enumerate() {
        page.rectangle(frame, "fill=\"#fafafa\"");
        page.open_clipped_group(frame);
        page.push(&used(LAND, frame));
        if let Some(address) = pictures.sheets.get(i).and_then(Option::as_deref) {
            page.push(&image("", frame, address));
        }
        page.push(&used(LINES, frame));
        for (path, style) in outlines[i].iter().zip(ROCKS) {
            if !path.is_empty() {
                let Frame { left, top, .. } = frame;
                page.push(&format!(
                    "<path transform=\"translate({left:.1} {top:.1})\" d=\"{path}\" fill-rule=\"nonzero\" {style}/>"
                ));
            }
        }
        marks::draw(page, chart(frame), &plan.marks);
        if i == 0 {
            marks::names(page, chart(frame), &plan.marks);
            marks::north(page, frame);
        }
        marks::scale_bar(page, chart(frame));
        page.close_group();
        page.rectangle(frame, &format!("fill=\"none\" stroke=\"{INK}\""));
        layout.decorate(page, i, plan.origin);
        layout::title(page, frame, &panel.title);
        panels::bar(page, frame, panel, &relief, plan.origin[2]);
    }
    if layout.widening > 1.0 {
        let note = format!("y is drawn {} × as large as x", layout.widening);
        page.text([first.right(), first.top - 6.0], Anchor::End, &note);
    }
    legend(page, layout.bottom(y) + 8.0, plan, lines.step)
}

/// Adds the elements shared by all plans to the page.
fn define(page: &mut Page, frame: Frame, land: Option<&str>, lines: &Lines) {
    page.push("<defs>");
    if let Some(address) = land {
        page.push(&image(&format!("id=\"{LAND}\" "), frame, address));
    }
    page.push(&format!("<g id=\"{LINES}\">"));
    for (path, style) in [
        (&lines.bed, BED_LINES),
        (&lines.land, LAND_LINES),
        (&lines.shore, SHORE),
    ] {
        if !path.is_empty() {
            page.push(&format!("<path d=\"{path}\" {style}/>"));
        }
    }
    page.close_group();
    page.push("</defs>");
}

fn image(attributes: &str, frame: Frame, address: &str) -> String {
    let Frame {
        left,
        top,
        width,
        height,
    } = frame;
    // `xlink:href` too: programs from before SVG 2 know no other.
    format!(
        "<image {attributes}x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" \
         preserveAspectRatio=\"none\" xlink:href=\"{address}\"/>"
    )
}

fn used(id: &str, Frame { left, top, .. }: Frame) -> String {
    format!("<use xlink:href=\"#{id}\" x=\"{left:.1}\" y=\"{top:.1}\"/>")
}

/// Draws the legend of lines and colors; returns the next vertical position.
fn legend(page: &mut Page, y: f64, plan: &Plan, step: Option<f64>) -> f64 {
    let mut items: Vec<(&str, String)> = Vec::new();
    if let Some(level) = plan.still_level {
        let level = format!("{:.2}", level + plan.origin[2]);
        let level = level
            .trim_end_matches('0')
            .trim_end_matches('.')
            .replace('-', "−");
        items.push((SHORE, format!("shore at still water, {level} m")));
    }
    if let Some(step) = step {
        items.push((LAND_LINES, format!("heights every {step} m")));
    }
    if plan
        .marks
        .iter()
        .any(|mark| matches!(mark, Mark::Section { .. }))
    {
        items.push((SECTION, "side views".to_owned()));
    }
    let blocks = || plan.views.iter().flat_map(|view| &view.blocks);
    if blocks().any(|block| !block.is_under_water) {
        items.push((ROCKS[1], "blocks".to_owned()));
    }
    if blocks().any(|block| block.is_under_water) {
        items.push((ROCKS[0], "blocks under water".to_owned()));
    }
    let mut x = LEFT;
    for (style, text) in items {
        let sample = match [SHORE, LAND_LINES, SECTION].contains(&style) {
            true => format!("<path d=\"M{x:.1} {:.1}h20\" {style}/>", y - 4.0),
            false => format!("<path d=\"M{x:.1} {:.1}h20v9h-20z\" {style}/>", y - 8.5),
        };
        page.push(&sample);
        page.text([x + 26.0, y], Anchor::Start, &text);
        // approximate width of letters of 11 px
        x += 26.0 + 5.8 * text.chars().count() as f64 + 22.0;
    }
    y + 8.0
}
