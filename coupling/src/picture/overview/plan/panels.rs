//! Content and pictures of each plan view.

use super::layout::Chart;
use super::relief::Relief;
use super::sheet::{self, Scale, Sheet};
use super::{Footprint, Plan};
use crate::output::observe::maps::MapExtremes;
use crate::picture::chart::page::{Frame, Page};
use crate::picture::overview::bar::Bar;
use crate::picture::overview::raster::{self, Window};
use crate::picture::overview::view::RESOLUTIONS;
use crate::scene::terrain::grid::Grid;

/// Budget of the images of all plans, so that the page stays below 500 kB; bytes of text.
const PICTURE_BUDGET: usize = 130_000;

/// One of the plans.
pub(super) struct Panel<'a> {
    pub title: String,
    sheet: Option<Sheet>,
    pub blocks: &'a [Footprint],
    key: Key,
}

/// Quantity of the color bar beside a plan view.
#[derive(Clone, Copy, Debug)]
enum Key {
    Land,
    /// Quantity drawn over the land, with unit.
    Sheet(&'static str),
}

/// `data:` addresses of the images.
pub(super) struct Pictures {
    pub land: Option<String>,
    /// One per plan with a color layer.
    pub sheets: Vec<Option<String>>,
}

/// Plans of the views, then of the maps, with water of a particle spacing (m).
pub(super) fn panels(plan: &Plan, spacing: f64) -> Vec<Panel<'_>> {
    let mut panels = Vec::new();
    let level = plan.still_level.unwrap_or(0.0);
    let surfaces = plan.views.iter().map(|view| {
        let heights: Vec<f64> = view.surface.iter().map(|&z| f64::from(z)).collect();
        let is_whole = heights.len() == plan.water.n[0] * plan.water.n[1];
        is_whole.then(|| with(&plan.water, heights))
    });
    let surfaces: Vec<Option<Grid>> = surfaces.collect();
    let at_start = surfaces.iter().flatten().next().cloned();
    let risen = |surface: &Grid| {
        let at_start = at_start.as_ref().unwrap_or(surface);
        with(surface, over_rest(surface, at_start, level, spacing))
    };
    let all: Vec<f64> = surfaces
        .iter()
        .flatten()
        .flat_map(|s| risen(s).heights)
        .collect();
    let all = finite(&all);
    let scale = Scale::of_elevations(&all);
    let last = plan.views.len().saturating_sub(1);
    for (i, (view, surface)) in plan.views.iter().zip(&surfaces).enumerate() {
        let sheet = surface.as_ref().filter(|_| !all.is_empty());
        let sheet = sheet.map(|surface| Sheet {
            values: risen(surface),
            surface: surface.clone(),
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
    if let Some(maps) = &plan.maps {
        panels.extend(of_maps(maps, level, spacing));
    }
    panels
}

/// Plans of the maps that are not empty.
fn of_maps(maps: &MapExtremes, level: f64, spacing: f64) -> Vec<Panel<'static>> {
    let MapExtremes {
        at_start,
        highest,
        arrival,
    } = maps;
    let risen = over_rest(highest, at_start, level, spacing);
    let map = |title: &str, unit, values: &[f64], scale: fn(&[f64]) -> Scale| {
        let shown = finite(values);
        (!shown.is_empty()).then(|| Panel {
            title: title.to_owned(),
            sheet: Some(Sheet {
                values: with(highest, values.to_vec()),
                surface: highest.clone(),
                scale: scale(&shown),
            }),
            blocks: &[],
            key: Key::Sheet(unit),
        })
    };
    let maps = [
        map(
            "highest surface over still water",
            "[m]",
            &risen,
            Scale::of_highest,
        ),
        map("first arrival", "[s]", &arrival.heights, Scale::of_arrivals),
    ];
    maps.into_iter().flatten().collect()
}

/// Heights of a surface over that at rest at a level (m); m.
///
/// Where the surface is within a particle spacing (m) of the level at the start, the accuracy of a particle surface, it is
/// assumed at rest, and elevations are relative to it: near a shore the computed surface of still water is off by up to half
/// a spacing, which would otherwise look like a wave.
fn over_rest(surface: &Grid, at_start: &Grid, level: f64, spacing: f64) -> Vec<f64> {
    let heights = surface.heights.iter().zip(&at_start.heights);
    heights
        .map(|(now, before)| match (before - level).abs() <= spacing {
            true => now - before,
            // dry at the start, or never at rest
            false => now - level,
        })
        .collect()
}

/// The images, as fine as the budget allows.
pub(super) fn pictures(
    chart: Chart,
    plan: &Plan,
    relief: &Relief<'_>,
    panels: &[Panel<'_>],
) -> Pictures {
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

/// Draws the color bar beside a plan; heights of land are those of the scene and `raise` (m).
pub(super) fn bar(
    page: &mut Page,
    frame: Frame,
    panel: &Panel<'_>,
    relief: &Relief<'_>,
    raise: f64,
) {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn water_at_rest_is_the_reference_where_there_was_some() {
        let grid = |heights: [f64; 4]| Grid {
            n: [2, 2],
            corner: [0.0; 2],
            spacing: 1.0,
            heights: heights.to_vec(),
        };
        // computed 0.4 m too high, dry, a wave from the start on, and dry again
        let at_start = grid([10.4, f64::NAN, 13.0, 10.0]);
        let now = grid([12.4, 12.0, 12.0, f64::NAN]);
        let found = over_rest(&now, &at_start, 10.0, 0.5);
        assert_eq!(found[..3], [2.0, 2.0, 2.0]);
        assert!(found[3].is_nan());
    }
}
