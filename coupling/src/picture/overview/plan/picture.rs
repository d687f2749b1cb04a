//! Maps as pictures of their own, without a page around them.

use super::layout::Chart;
use super::lines::path_of_level;
use super::relief::Relief;
use super::sheet::{self, N_SHADES, Scale, Sheet};
use crate::picture::chart::axis::{self, Axis, Tick};
use crate::picture::chart::page::Frame;
use crate::picture::color::ColorMap;
use crate::picture::overview::raster::{self, Window};
use crate::scene::terrain::grid::Grid;

/// Longer side of a picture; units of its drawing.
const LONGER: f64 = 520.0;
/// Shorter side at least: a long strip is drawn wider than it is.
const SHORTER: f64 = 110.0;
/// Pixels per unit, finest first; the first within the budget is used.
const RESOLUTIONS: [f64; 4] = [1.5, 1.0, 0.7, 0.5];
/// Tolerance of the shore; units of the drawing.
const TOLERANCE: f64 = 0.3;
/// Distance of the numbers of a color bar of unit length.
const BETWEEN_NUMBERS: f64 = 0.22;
/// Room for the number at an end of it.
const BESIDE_AN_END: f64 = 0.13;

/// Quantity of a map, which chooses its colors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::picture) enum Mapped {
    /// Highest elevation of the water.
    Highest,
    /// Time of its arrival.
    Arrival,
    /// Depth on land.
    Depth,
}

/// Ground and highest water of maps.
pub(in crate::picture) struct Mapping<'a> {
    /// Heights of the ground, NaN where there is none; m.
    pub ground: &'a Grid,
    /// Highest water, NaN where all was dry; m.
    pub highest: &'a Grid,
    /// Level of still water; m.
    pub still_level: Option<f64>,
    /// Colors of the maps.
    pub color_map: ColorMap,
}

/// Pictures of the land, which all maps share, and of the maps.
pub(in crate::picture) struct MapPictures {
    /// Width and height; units of the drawing.
    pub size: [f64; 2],
    /// Units of the drawing per m along x.
    pub scale: f64,
    /// `data:` address.
    pub land: String,
    /// Shore at still water, as a path; empty without.
    pub shore: String,
    /// One for each map.
    pub maps: Vec<MapPicture>,
}

/// Picture of a map, to be laid over the land.
pub(in crate::picture) struct MapPicture {
    /// `data:` address.
    pub address: String,
    /// Colors of the bar, from its start.
    pub shades: Vec<[u8; 3]>,
    /// Places on the bar from 0 to 1, and their numbers.
    pub numbers: Vec<(f64, String)>,
}

impl MapPictures {
    /// Draws maps with their values at the points of the ground, in about `budget` bytes of text; `None` where the encoder fails.
    pub fn draw(mapping: &Mapping<'_>, maps: &[(Mapped, Vec<f64>)], budget: usize) -> Option<Self> {
        let chart = chart(mapping.ground);
        let relief = Relief::new(mapping.ground, mapping.still_level);
        let sheets: Vec<Sheet> = (maps.iter())
            .map(|(quantity, values)| sheet_of(mapping, *quantity, values))
            .collect();
        let mut drawn = None;
        for resolution in RESOLUTIONS {
            let size = |length: f64| (length * resolution).round().max(1.0) as usize;
            let window = Window {
                min: chart.min,
                max: chart.max,
                width: size(chart.frame.width),
                height: size(chart.frame.height),
            };
            let address = |pixels: &[u8], (colors, opacity)| {
                raster::png_address(pixels, window, colors, opacity)
            };
            let land = sheet::pixels(window, |place| relief.color_at(place));
            let land = address(&land, relief.palette())?;
            let of = |sheet: &Sheet| {
                let pixels = sheet::pixels(window, |place| sheet.color_at(place, mapping.ground));
                address(&pixels, sheet.scale.palette())
            };
            let pictures: Vec<String> = sheets.iter().map(of).collect::<Option<_>>()?;
            let n_bytes = land.len() + pictures.iter().map(String::len).sum::<usize>();
            drawn = Some((land, pictures));
            if n_bytes <= budget {
                break;
            }
        }
        let (land, pictures) = drawn?;
        let shore = |level| path_of_level(chart, mapping.ground, level, TOLERANCE);
        let maps = sheets.iter().zip(pictures);
        Some(Self {
            size: [chart.frame.width, chart.frame.height],
            scale: chart.scale(),
            land,
            shore: mapping.still_level.map(shore).unwrap_or_default(),
            maps: maps
                .map(|(sheet, address)| MapPicture {
                    address,
                    shades: sheet.scale.shown(),
                    numbers: numbers(&sheet.scale),
                })
                .collect(),
        })
    }
}

/// The picture around the squares of a grid.
fn chart(ground: &Grid) -> Chart {
    let half = 0.5 * ground.spacing;
    let (min, max) = (ground.corner, ground.far_corner());
    let (min, max) = (min.map(|x| x - half), max.map(|x| x + half));
    let lengths = [0, 1].map(|axis| max[axis] - min[axis]);
    let scale = LONGER / lengths[0].max(lengths[1]);
    let [width, height] = lengths.map(|length| (scale * length).max(SHORTER));
    Chart {
        frame: Frame {
            left: 0.0,
            top: 0.0,
            width,
            height,
        },
        min,
        max,
    }
}

fn sheet_of(mapping: &Mapping<'_>, quantity: Mapped, values: &[f64]) -> Sheet {
    let finite: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    let scale = match quantity {
        Mapped::Highest => Scale::of_highest(&finite),
        Mapped::Arrival => Scale::of_arrivals(&finite),
        Mapped::Depth => Scale::of_depths(&finite),
    };
    let scale = match mapping.color_map.published(N_SHADES) {
        Some(shades) => scale.with(shades),
        None => scale,
    };
    Sheet {
        values: Grid {
            heights: values.to_vec(),
            ..mapping.ground.clone()
        },
        surface: mapping.highest.clone(),
        scale,
    }
}

/// Round numbers along a color bar.
fn numbers(scale: &Scale) -> Vec<(f64, String)> {
    let ((min, max), is_exceeded) = scale.ends();
    let axis = Axis {
        min,
        max,
        scale: axis::Scale::Linear,
        from: 0.0,
        to: 1.0,
    };
    // the ends always have their numbers, and room for them
    let is_inside = |place: f64| BESIDE_AN_END < place && place < 1.0 - BESIDE_AN_END;
    let end = |place: f64, value: f64, sign: &str| {
        // a whole number of tenths, but for round-off
        let number = (value * 1e9).round() / 1e9;
        (place, format!("{sign}{number}").replace('-', "−"))
    };
    let ticks = axis.ticks(BETWEEN_NUMBERS, 1.0).into_iter();
    let ticks = ticks.map(|Tick { value, label }| (axis.at(value), label));
    let mut told = vec![end(0.0, min, if is_exceeded.0 { "≤ " } else { "" })];
    told.extend(ticks.filter(|(place, _)| is_inside(*place)));
    told.push(end(1.0, max, if is_exceeded.1 { "≥ " } else { "" }));
    told
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    #[test]
    fn a_map_has_its_land_its_shore_and_round_numbers() {
        let mut ground = Grid {
            n: [40, 20],
            corner: [0.0, 0.0],
            spacing: 5.0,
            heights: Vec::new(),
        };
        ground.heights = (ground.points())
            .map(|p| ground.place(p)[0] - 100.0)
            .collect();
        let wet = |z: &f64| if *z < 0.0 { 2.0 } else { f64::NAN };
        let highest = Grid {
            heights: ground.heights.iter().map(wet).collect(),
            ..ground.clone()
        };
        let mapping = Mapping {
            ground: &ground,
            highest: &highest,
            still_level: Some(0.0),
            color_map: ColorMap::Viridis,
        };
        let arrival: Vec<f64> = ground.heights.iter().map(|z| -0.2 * z).collect();
        let drawn = MapPictures::draw(&mapping, &[(Mapped::Arrival, arrival)], 1 << 20).unwrap();
        assert_eq!(drawn.maps[0].shades.len(), N_SHADES);
        assert_eq!(drawn.size, [520.0, 260.0]);
        assert_eq!(drawn.scale, 520.0 / 200.0);
        assert!(drawn.land.starts_with("data:image/png;base64,"));
        // the shore is at x = 100 of 200 m, whose first square starts 2.5 m before x = 0
        assert!(drawn.shore.starts_with("M266.5 "), "{}", drawn.shore);
        let numbers = &drawn.maps[0].numbers;
        assert!(1 < numbers.len() && numbers.windows(2).all(|pair| pair[0].0 < pair[1].0));
    }
}
