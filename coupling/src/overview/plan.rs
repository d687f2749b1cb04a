//! Plans: the scene from above, x to the right and y up, and maps of what the water did.
//!
//! Land is shaded from its heights, and what lies over it comes in the order of a map: water, lines of equal height, blocks,
//! instruments. The picture of the land and the lines are in the page once, however many plans there are.

mod contour;
mod marks;
mod relief;
mod sheet;

use std::collections::BTreeSet;
use std::fmt::Write as _;

use serde::{Deserialize, Serialize};

use super::axis::{self, Axis, Labels, nice_up, open_range};
use super::bar::Bar;
use super::page::{Anchor, Frame, INK, LABEL, LEFT, Page, RIGHT, WIDTH, shortened};
use super::raster::{self, Window};
use super::view::RESOLUTIONS;
use crate::scene::terrain::grid::Grid;
use relief::Relief;
use sheet::{Scale, Sheet};

/// What plans show.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Lower left and upper right corner, x and y; m.
    pub view: ([f64; 2], [f64; 2]),
    /// The point of the map that is x = y = z = 0; m.
    pub origin: [f64; 3],
    /// Heights of the ground, NaN where there is none; m.
    pub ground: Grid,
    /// Height of the water at rest; none without water; m.
    pub still_level: Option<f64>,
    /// Points at which views have the surface; it has no heights itself.
    pub water: Grid,
    /// Usually the start and the end.
    pub views: Vec<FromAbove>,
    /// Highest surface, NaN where it was always dry, where there is a map of it; m.
    pub highest: Option<Grid>,
    /// When water came, NaN where it did not, at the points of `highest`; s.
    pub arrival: Option<Grid>,
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

/// What a block covers of the plan.
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
        /// What it is called.
        name: String,
        /// x and y; m.
        at: [f64; 2],
    },
    /// Along a line.
    Line {
        /// What it is called.
        name: String,
        /// x and y; m.
        from: [f64; 2],
        /// x and y; m.
        to: [f64; 2],
    },
}

/// Pictures of all plans together; bytes of text.
const PICTURE_BUDGET: usize = 130_000;
/// Lines of equal height, and outlines of blocks; bytes of text.
const LINE_BUDGET: usize = 45_000;
const OUTLINE_BUDGET: usize = 45_000;
/// Plans wider than this many times their height are shown below each other, others side by side.
const WIDE: f64 = 2.2;
/// Plans side by side are not taller than this; px.
const MAX_HEIGHT: f64 = 480.0;
/// A long strip is widened until its plans are this tall; px.
const MIN_HEIGHT: f64 = 60.0;
/// Room above a plan for its title, beside it for its colour bar and below it for its axis; px.
const ABOVE: f64 = 24.0;
const BESIDE: f64 = 76.0;
const BELOW: f64 = 44.0;
/// About so many lines of equal height from the lowest to the highest ground.
const N_CONTOURS: f64 = 12.0;
/// How far a line may be from where it is, so that it takes less text; px.
const LINE_TOLERANCES: [f64; 4] = [0.2, 0.4, 0.8, 1.5];
/// Lines that extend less are left out; px.
const LEAST_LINE: f64 = 4.0;
/// Corners of outlines are at whole multiples of these, finest first; tenths of px.
const LATTICES: [i32; 5] = [1, 5, 10, 20, 40];
/// What all plans have in common, by its name in the page.
const LAND: &str = "land";
const LINES: &str = "lines";

const SHORE: &str =
    "fill=\"none\" stroke=\"#0d2c54\" stroke-width=\"1.3\" stroke-linejoin=\"round\"";
const LAND_LINES: &str =
    "fill=\"none\" stroke=\"#6b5334\" stroke-width=\"0.5\" stroke-opacity=\"0.7\"";
const BED_LINES: &str =
    "fill=\"none\" stroke=\"#3d5a73\" stroke-width=\"0.5\" stroke-opacity=\"0.5\"";
/// Blocks under water and others.
const ROCKS: [&str; 2] = [
    "fill=\"#a98a6b\" fill-opacity=\"0.45\" stroke=\"#4d3a28\" stroke-opacity=\"0.6\" stroke-width=\"0.35\" stroke-linejoin=\"round\"",
    "fill=\"#a98a6b\" stroke=\"#4d3a28\" stroke-width=\"0.45\" stroke-linejoin=\"round\"",
];

/// Where in the page a part of the plan is.
#[derive(Clone, Copy, Debug)]
struct Chart {
    frame: Frame,
    /// m.
    min: [f64; 2],
    /// m.
    max: [f64; 2],
}

impl Chart {
    fn axes(self) -> [Axis; 2] {
        let Self { frame, min, max } = self;
        let axis = |k: usize, from, to| Axis {
            min: min[k],
            max: max[k],
            from,
            to,
        };
        [
            axis(0, frame.left, frame.right()),
            axis(1, frame.bottom(), frame.top),
        ]
    }

    /// Of a place of the plan; px.
    fn pixel(self, place: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.axes();
        [x.at(place[0]), y.at(place[1])]
    }

    /// Along x; px/m.
    fn scale(self) -> f64 {
        self.frame.width / (self.max[0] - self.min[0])
    }
}

/// One of the plans.
struct Panel<'a> {
    title: String,
    sheet: Option<Sheet>,
    blocks: &'a [Footprint],
    key: Key,
}

/// What the colour bar beside a plan is of.
#[derive(Clone, Copy, Debug)]
enum Key {
    Land,
    /// What is over the land, with its unit.
    Sheet(&'static str),
}

/// Draws all plans from `y` down; where the next thing may start.
pub(super) fn draw(page: &mut Page, y: f64, plan: &Plan) -> f64 {
    let panels = panels(plan);
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
    // of a page with nothing else
    let alone = chart(Frame {
        left: 0.0,
        top: 0.0,
        ..first
    });
    let pictures = pictures(alone, plan, &relief, &panels);
    let lines = Lines::new(alone, plan);
    define(page, alone.frame, pictures.land.as_deref(), &lines);
    let outlines = outlines(alone, &panels);
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
        title(page, frame, &panel.title);
        bar(page, frame, panel, (&relief, plan.origin[2]));
    }
    if layout.widening > 1.0 {
        let note = format!("y is drawn {} × as large as x", layout.widening);
        page.text([first.right(), first.top - 6.0], Anchor::End, &note);
    }
    let bottom = layout.frames.last().map_or(y, |frame| frame.bottom());
    legend(page, bottom + BELOW + 8.0, plan, lines.step)
}

/// Plans of the views, then of the maps.
fn panels(plan: &Plan) -> Vec<Panel<'_>> {
    let mut panels = Vec::new();
    let level = plan.still_level.unwrap_or(0.0);
    let surfaces = plan.views.iter().map(|view| {
        let heights: Vec<f64> = view.surface.iter().map(|&z| f64::from(z)).collect();
        let is_whole = heights.len() == plan.water.n[0] * plan.water.n[1];
        is_whole.then(|| with(&plan.water, heights))
    });
    let surfaces: Vec<Option<Grid>> = surfaces.collect();
    let over_rest =
        |surface: &Grid| -> Vec<f64> { surface.heights.iter().map(|z| z - level).collect() };
    let all: Vec<f64> = surfaces.iter().flatten().flat_map(over_rest).collect();
    let all = finite(&all);
    let scale = Scale::of_elevations(&all);
    let last = plan.views.len().saturating_sub(1);
    for (i, (view, surface)) in plan.views.iter().zip(surfaces).enumerate() {
        let sheet = surface.filter(|_| !all.is_empty()).map(|surface| Sheet {
            values: with(&surface, over_rest(&surface)),
            surface,
            scale: scale.clone(),
        });
        let key = match i == last && sheet.is_some() {
            true => Key::Sheet("[m]"),
            false => Key::Land,
        };
        let what = match &sheet {
            Some(_) => ": surface over still water",
            None => "",
        };
        panels.push(Panel {
            title: format!("t = {:.3} s{what}", view.time),
            sheet,
            blocks: &view.blocks,
            key,
        });
    }
    let Some(highest) = &plan.highest else {
        return panels;
    };
    let raised: Vec<f64> = highest.heights.iter().map(|z| z + plan.origin[2]).collect();
    let mut map =
        |(title, unit): (&str, _), values: Option<&Vec<f64>>, scale: fn(&[f64]) -> Scale| {
            let shown = values.map(|values| finite(values)).unwrap_or_default();
            if let Some(values) = values.filter(|_| !shown.is_empty()) {
                panels.push(Panel {
                    title: title.to_owned(),
                    sheet: Some(Sheet {
                        values: with(highest, values.clone()),
                        surface: highest.clone(),
                        scale: scale(&shown),
                    }),
                    blocks: &[],
                    key: Key::Sheet(unit),
                });
            }
        };
    map(
        ("maximum elevation of the surface", "[m]"),
        Some(&raised),
        Scale::of_highest,
    );
    let arrival = plan.arrival.as_ref().map(|arrival| &arrival.heights);
    map(("first arrival", "[s]"), arrival, Scale::of_arrivals);
    panels
}

/// Other values at the points of a grid.
fn with(grid: &Grid, heights: Vec<f64>) -> Grid {
    Grid {
        n: grid.n,
        corner: grid.corner,
        spacing: grid.spacing,
        heights,
    }
}

fn finite(values: &[f64]) -> Vec<f64> {
    values.iter().copied().filter(|v| v.is_finite()).collect()
}

/// Where the plans stand.
struct Layout {
    frames: Vec<Frame>,
    columns: usize,
    /// How much larger y is drawn than x.
    widening: f64,
    min: [f64; 2],
    max: [f64; 2],
}

impl Layout {
    fn new(y: f64, n: usize, view: ([f64; 2], [f64; 2])) -> Self {
        let ranges = [0, 1].map(|axis| open_range(view.0[axis], view.1[axis], 1e-9));
        let [(min_x, max_x), (min_y, max_y)] = ranges;
        let aspect = (max_y - min_y) / (max_x - min_x);
        let columns = if aspect * WIDE < 1.0 || n < 2 { 1 } else { 2 };
        let room = match columns {
            1 => RIGHT - LEFT,
            _ => 0.5 * (WIDTH - 24.0 - LEFT) - BESIDE,
        };
        let width = room.min(MAX_HEIGHT / aspect);
        let widening = match width * aspect < MIN_HEIGHT {
            true => nice_up(MIN_HEIGHT / (width * aspect)),
            false => 1.0,
        };
        let height = width * aspect * widening;
        let frame = |i: usize| Frame {
            left: LEFT + (i % columns) as f64 * (width + BESIDE),
            top: y + ABOVE + (i / columns) as f64 * (height + ABOVE + 26.0),
            width,
            height,
        };
        Self {
            frames: (0..n).map(frame).collect(),
            columns,
            widening,
            min: [min_x, min_y],
            max: [max_x, max_y],
        }
    }

    /// Marks and numbers, in coordinates of the map; those that stand at a plan before are left out.
    fn decorate(&self, page: &mut Page, i: usize, origin: [f64; 3]) {
        let frame = self.frames[i];
        let on_map = Chart {
            frame,
            min: [0, 1].map(|k| self.min[k] + origin[k]),
            max: [0, 1].map(|k| self.max[k] + origin[k]),
        };
        let [x, y] = on_map.axes();
        axis::draw_horizontal(page, frame, &x.ticks(70.0, 1.0), x, Labels::Shown);
        let is_first = i.is_multiple_of(self.columns);
        let y_labels = if is_first {
            Labels::Shown
        } else {
            Labels::Hidden
        };
        axis::draw_vertical(page, frame, &y.ticks(34.0, 1.0), y, y_labels);
        if is_first {
            page.upright_text([LABEL, frame.top + frame.height / 2.0], "y [m]");
        }
        if self.frames.len() <= i + self.columns {
            let below = [frame.left + frame.width / 2.0, frame.bottom() + 32.0];
            page.text(below, Anchor::Middle, "x [m]");
        }
    }
}

fn title(page: &mut Page, frame: Frame, title: &str) {
    // bold letters of 12 px are about so wide
    let title = shortened(title, ((frame.width + 12.0) / 6.6) as usize);
    let style = format!("font-size=\"12\" font-weight=\"bold\" fill=\"{INK}\"");
    page.styled_text([frame.left, frame.top - 6.0], Anchor::Start, &style, &title);
}

fn bar(page: &mut Page, frame: Frame, panel: &Panel<'_>, (relief, raise): (&Relief<'_>, f64)) {
    let place = Frame {
        left: frame.right() + 12.0,
        top: frame.top + 14.0,
        width: 13.0,
        height: (frame.height - 14.0).clamp(40.0, 240.0),
    };
    match (panel.key, &panel.sheet) {
        (Key::Sheet(unit), Some(sheet)) => {
            let shown = sheet.scale.shown();
            sheet.scale.bar(unit, &shown).draw(page, place);
        }
        _ => {
            let ((low, high), shades) = relief.land();
            let land = Bar {
                label: "land [m]",
                shades: &shades,
                range: (low + raise, high + raise),
                is_exceeded: (false, false),
            };
            land.draw(page, place);
        }
    }
}

/// Addresses of the pictures.
struct Pictures {
    land: Option<String>,
    /// One per plan, where it has a sheet.
    sheets: Vec<Option<String>>,
}

/// The pictures, as fine as the budget allows.
fn pictures(chart: Chart, plan: &Plan, relief: &Relief<'_>, panels: &[Panel<'_>]) -> Pictures {
    let mut pictures = Pictures {
        land: None,
        sheets: Vec::new(),
    };
    for resolution in RESOLUTIONS {
        let size = |pixels: f64| (pixels * resolution).round().max(1.0) as usize;
        let window = Window {
            min: chart.min,
            max: chart.max,
            width: size(chart.frame.width),
            height: size(chart.frame.height),
        };
        let address =
            |pixels: &[u8], (colors, opacity)| raster::png_address(pixels, window, colors, opacity);
        let land = sheet::pixels(window, |place| relief.color_at(place));
        let sheets = panels.iter().map(|panel| {
            let sheet = panel.sheet.as_ref()?;
            let pixels = sheet::pixels(window, |place| sheet.color_at(place, &plan.ground));
            address(&pixels, sheet.scale.palette())
        });
        pictures = Pictures {
            sheets: sheets.collect(),
            land: address(&land, relief.palette()),
        };
        let all = pictures.sheets.iter().chain([&pictures.land]).flatten();
        if all.map(String::len).sum::<usize>() <= PICTURE_BUDGET {
            break;
        }
    }
    pictures
}

/// Lines of equal height; text of paths.
#[derive(Debug, Default)]
struct Lines {
    land: String,
    bed: String,
    shore: String,
    /// From one to the next, none where they would be too many; m.
    step: Option<f64>,
}

impl Lines {
    fn new(chart: Chart, plan: &Plan) -> Self {
        let (low, high) = plan.ground.range();
        let shore = |tolerance| {
            let level = plan.still_level?;
            Some(path_of_level(chart, &plan.ground, level, tolerance))
        };
        let mut step = nice_up((high - low) / N_CONTOURS);
        if !(step.is_finite() && 0.0 < step) {
            return Self::default();
        }
        // rough ground has long lines: fewer and simpler ones, until they fit
        for tolerance in LINE_TOLERANCES {
            let mut lines = Self {
                shore: shore(tolerance).unwrap_or_default(),
                step: Some(step),
                ..Self::default()
            };
            let raise = plan.origin[2];
            let first = ((low + raise) / step).ceil();
            let levels = (0..).map(|k| (first + f64::from(k)) * step - raise);
            for level in levels.take_while(|&level| level < high) {
                let over_rest = level - plan.still_level.unwrap_or(f64::NEG_INFINITY);
                // that of water at rest is the shore
                if over_rest.abs() < 1e-6 * step {
                    continue;
                }
                let path = path_of_level(chart, &plan.ground, level, tolerance);
                match 0.0 < over_rest {
                    true => lines.land += &path,
                    false => lines.bed += &path,
                }
            }
            if lines.land.len() + lines.bed.len() + lines.shore.len() <= LINE_BUDGET {
                return lines;
            }
            step = nice_up(1.5 * step);
        }
        let [.., coarsest] = LINE_TOLERANCES;
        let shore = shore(coarsest).filter(|path| path.len() <= LINE_BUDGET);
        Self {
            shore: shore.unwrap_or_default(),
            ..Self::default()
        }
    }
}

/// Path of a level (m), off by no more than a tolerance (px); what is smaller than a few pixels is left out.
fn path_of_level(chart: Chart, ground: &Grid, level: f64, tolerance: f64) -> String {
    let mut path = String::new();
    for line in contour::lines(ground, level) {
        let line: Vec<[f64; 2]> = line.into_iter().map(|place| chart.pixel(place)).collect();
        let extent = |axis: usize| {
            let along = line.iter().map(|p| p[axis]);
            along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
        };
        if LEAST_LINE <= extent(0).max(extent(1)) {
            let points = contour::simplified(&line, tolerance);
            push_path(
                &mut path,
                &points
                    .into_iter()
                    .map(|p| p.map(|c| tenths(c, 1)))
                    .collect::<Vec<_>>(),
            );
        }
    }
    path
}

/// Whole tenths of a pixel, a multiple of some; what is far off the page stays where a renderer can hold it.
fn tenths(pixel: f64, multiple: i32) -> i32 {
    let n = 10.0 * pixel.clamp(-1e4, 1e4) / f64::from(multiple);
    n.round() as i32 * multiple
}

/// Appends a line through points in tenths of a pixel, each relative to that before, which takes half the text.
fn push_path(path: &mut String, points: &[[i32; 2]]) {
    let mut before: Option<[i32; 2]> = None;
    for &[x, y] in points {
        let (command, [from_x, from_y]) = match before {
            None => ('M', [0, 0]),
            Some(before) => ('l', before),
        };
        let [dx, dy] = [x - from_x, y - from_y].map(|n| f64::from(n) / 10.0);
        // writing to a string does not fail
        let _ = write!(path, "{command}{dx} {dy}");
        before = Some([x, y]);
    }
}

/// Outlines of the blocks of each plan, under water and not, as fine as the budget allows; text of paths.
fn outlines(chart: Chart, panels: &[Panel<'_>]) -> Vec<[String; 2]> {
    let mut outlines = Vec::new();
    for lattice in LATTICES {
        let of = |panel: &Panel<'_>| {
            [true, false].map(|is_under_water| {
                let blocks = panel.blocks.iter();
                let chosen = blocks.filter(|block| block.is_under_water == is_under_water);
                path_of_blocks(chart, chosen, lattice)
            })
        };
        outlines = panels.iter().map(of).collect();
        if outlines.iter().flatten().map(String::len).sum::<usize>() <= OUTLINE_BUDGET {
            break;
        }
    }
    outlines
}

/// Path of blocks with corners on a lattice (tenths of a pixel); of those that look alike there, one is enough.
fn path_of_blocks<'a>(
    chart: Chart,
    blocks: impl Iterator<Item = &'a Footprint>,
    lattice: i32,
) -> String {
    let mut path = String::new();
    let mut drawn = BTreeSet::new();
    for block in blocks {
        let known = block
            .points
            .iter()
            .filter(|p| p.iter().all(|c| c.is_finite()));
        let mut corners: Vec<[i32; 2]> = known
            .map(|p| chart.pixel(p.map(f64::from)).map(|c| tenths(c, lattice)))
            .collect();
        corners.dedup();
        if !corners.is_empty() && drawn.insert(corners.clone()) {
            push_path(&mut path, &corners);
            path.push('z');
        }
    }
    path
}

/// Puts what all plans have in common into the page, once.
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

/// Says what lines and colours are; where the next thing may start.
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
    let blocks = || plan.views.iter().flat_map(|view| &view.blocks);
    if blocks().any(|block| !block.is_under_water) {
        items.push((ROCKS[1], "blocks".to_owned()));
    }
    if blocks().any(|block| block.is_under_water) {
        items.push((ROCKS[0], "blocks under water".to_owned()));
    }
    let mut x = LEFT;
    for (style, text) in items {
        let sample = match style == SHORE || style == LAND_LINES {
            true => format!("<path d=\"M{x:.1} {:.1}h20\" {style}/>", y - 4.0),
            false => format!("<path d=\"M{x:.1} {:.1}h20v9h-20z\" {style}/>", y - 8.5),
        };
        page.push(&sample);
        page.text([x + 26.0, y], Anchor::Start, &text);
        // letters of 11 px are about so wide
        x += 26.0 + 5.8 * text.chars().count() as f64 + 22.0;
    }
    y + 8.0
}
