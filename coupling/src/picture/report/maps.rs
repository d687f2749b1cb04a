//! The maps of a run as pictures over the land, with their legends.

use std::fmt::Write as _;
use std::path::Path;

use crate::files::vtk::{self, PolyData, Values};
use crate::output::run_folder;
use crate::picture::color::{self, ColorMap};
use crate::picture::overview::plan::picture::{MapPicture, MapPictures, Mapped, Mapping};
use crate::scene::terrain::grid::Grid;

/// Pictures, at most; bytes of text.
const BUDGET: usize = 600_000;
/// Share of that and of the whole file that is theirs at most; –.
const SHARE: f64 = 0.25;
/// Length of the scale bar, over the width of a map, at most.
const LONGEST_BAR: f64 = 0.3;

/// A map of a run.
struct Kind {
    quantity: Mapped,
    /// Array in `maps.vtp`.
    array: &'static str,
    title: &'static str,
    unit: &'static str,
    file: &'static str,
}

const KINDS: [Kind; 3] = [
    Kind {
        quantity: Mapped::Highest,
        array: "MaximumElevation",
        title: "Highest water",
        unit: "elevation, m",
        file: run_folder::MAXIMUM_ELEVATION,
    },
    Kind {
        quantity: Mapped::Arrival,
        array: "FirstArrival",
        title: "First arrival of the wave",
        unit: "after the start, s",
        file: run_folder::FIRST_ARRIVAL,
    },
    Kind {
        quantity: Mapped::Depth,
        array: "InundationDepth",
        title: "Inundation depth",
        unit: "where it was dry, m",
        file: run_folder::INUNDATION_DEPTH,
    },
];

/// Maps of a run in the page.
#[derive(Default)]
pub(super) struct Maps {
    /// Empty without.
    pub html: String,
    /// What is shown, for a summary; empty without.
    pub said: String,
}

/// Maps of a run folder whose heights are `raise` m higher in the map than in the scene, with a size of the whole file (bytes)
/// and a map of colors.
///
/// A run without maps has none, and one with a file that cannot be read, too: a report of the rest is better than none at all.
pub(super) fn maps(folder: &Path, raise: f64, looks: (u64, ColorMap)) -> Maps {
    let data = vtk::read(&folder.join(run_folder::MAPS)).ok();
    let drawn = data.and_then(|data| {
        let ground = grid(&data)?;
        drawn(&data, &ground, raise, looks)
    });
    drawn.unwrap_or_default()
}

fn drawn(
    data: &PolyData,
    ground: &Grid,
    raise: f64,
    (limit, color_map): (u64, ColorMap),
) -> Option<Maps> {
    let values = |kind: &Kind| array(data, kind.array, ground);
    let [highest, arrival, depth] = KINDS.each_ref().map(values);
    let (highest, depth) = (highest?, depth?);
    let level = still_level(&highest, &[arrival?, depth]);
    let is_told = |values: &Vec<f64>| values.iter().any(|value| value.is_finite());
    let told: Vec<(&Kind, Vec<f64>)> = (KINDS.iter())
        .filter_map(|kind| Some((kind, values(kind).filter(is_told)?)))
        .collect();
    let raised = |(kind, values): &(&Kind, Vec<f64>)| {
        let by = if kind.quantity == Mapped::Highest {
            raise
        } else {
            0.0
        };
        (
            kind.quantity,
            values.iter().map(|value| value + by).collect(),
        )
    };
    let maps: Vec<(Mapped, Vec<f64>)> = told.iter().map(raised).collect();
    let mapping = Mapping {
        ground,
        highest: &Grid {
            heights: highest,
            ..ground.clone()
        },
        still_level: level,
        color_map,
    };
    let budget = BUDGET.min((SHARE * limit as f64) as usize);
    let pictures = MapPictures::draw(&mapping, &maps, budget)?;
    let kinds: Vec<&Kind> = told.into_iter().map(|(kind, _)| kind).collect();
    let names: Vec<String> = kinds.iter().map(|kind| kind.title.to_lowercase()).collect();
    Some(Maps {
        html: html(&pictures, &kinds),
        said: format!("maps of {}", names.join(", ")),
    })
}

/// The ground of `maps.vtp`, whose points are those of a grid, row by row.
fn grid(data: &PolyData) -> Option<Grid> {
    let [first, second, ..] = data.points[..] else {
        return None;
    };
    let columns = data.points.iter().take_while(|x| x[1] == first[1]).count();
    let rows = data.points.len() / columns;
    let spacing = f64::from(second[0] - first[0]);
    let is_grid = 2 <= columns.min(rows) && columns * rows == data.points.len() && 0.0 < spacing;
    is_grid.then(|| Grid {
        n: [columns, rows],
        corner: [first[0], first[1]].map(f64::from),
        spacing,
        heights: data.points.iter().map(|x| f64::from(x[2])).collect(),
    })
}

fn array(data: &PolyData, name: &str, ground: &Grid) -> Option<Vec<f64>> {
    let found = data.point_data.iter().find(|array| array.name == name)?;
    let Values::F32(values) = &found.values else {
        return None;
    };
    let is_whole = values.len() == ground.heights.len();
    is_whole.then(|| values.iter().map(|&value| f64::from(value)).collect())
}

/// Level of the water at rest: the middle of the highest water where no wave came and none was before, or else its lowest
/// tenth, where a wave has passed everywhere; m.
fn still_level(highest: &[f64], changed: &[Vec<f64>; 2]) -> Option<f64> {
    let wet = || (0..highest.len()).filter(|&k| highest[k].is_finite());
    let calm = wet().filter(|&k| changed.iter().all(|map| map[k].is_nan()));
    let sorted = |places: &mut dyn Iterator<Item = usize>| {
        let mut found: Vec<f64> = places.map(|k| highest[k]).collect();
        found.sort_by(f64::total_cmp);
        found
    };
    let (calm, all) = (sorted(&mut calm.into_iter()), sorted(&mut wet()));
    match 20 * calm.len() < all.len() {
        true => all.get(all.len() / 10).copied(),
        false => calm.get(calm.len() / 2).copied(),
    }
}

fn html(pictures: &MapPictures, kinds: &[&Kind]) -> String {
    let [width, height] = pictures.size;
    let mut text = format!(
        "<section id=\"maps\"><h2>Maps</h2>\n<svg class=\"shared\" aria-hidden=\"true\"><defs><image id=\"map-land\" \
         width=\"{width:.1}\" height=\"{height:.1}\" preserveAspectRatio=\"none\" href=\"{}\"/><path id=\"map-shore\" d=\"{}\"/>\
         </defs></svg>\n<div class=\"maps\">\n",
        pictures.land, pictures.shore
    );
    for (kind, picture) in kinds.iter().zip(&pictures.maps) {
        text += &figure(pictures, kind, picture);
    }
    text += "</div>\n";
    if kinds.iter().all(|kind| kind.quantity != Mapped::Depth) {
        text += "<p class=\"soft\">No water came to land that was dry at the start.</p>\n";
    }
    text += "<p class=\"soft\">North is up where the terrain is a map. Dark line: shore at still water.</p></section>\n";
    text
}

fn figure(pictures: &MapPictures, kind: &Kind, picture: &MapPicture) -> String {
    let [width, height] = pictures.size;
    let Kind {
        title, unit, file, ..
    } = kind;
    let file = file.trim_end_matches(".asc");
    let (share, length) = scale_bar(pictures);
    let colors: Vec<String> = (picture.shades.iter().step_by(7))
        .chain(picture.shades.last())
        .map(|&shade| color::hex(shade))
        .collect();
    let mut numbers = String::new();
    for (place, number) in &picture.numbers {
        // writing to a string does not fail
        let _ = write!(
            numbers,
            "<span style=\"left:{:.1}%\">{number}</span>",
            100.0 * place
        );
    }
    format!(
        "<figure><figcaption><b>{title}</b> <span class=\"soft\">{unit}</span></figcaption>\n\
         <svg viewBox=\"0 0 {width:.1} {height:.1}\" role=\"img\" aria-label=\"map: {title}\"><use href=\"#map-land\"/>\
         <image width=\"{width:.1}\" height=\"{height:.1}\" preserveAspectRatio=\"none\" href=\"{}\"/><use href=\"#map-shore\"/></svg>\n\
         <div class=\"scale\"><i style=\"width:{:.1}%\"></i>{length}</div>\n\
         <div class=\"key\"><div style=\"background:linear-gradient(90deg,{})\"></div>{numbers}</div>\n\
         <div class=\"soft files\">{file}.tif, {file}.asc</div></figure>\n",
        picture.address,
        100.0 * share,
        colors.join(",")
    )
}

/// Length of the scale bar over the width of a map, and its name.
fn scale_bar(pictures: &MapPictures) -> (f64, String) {
    let whole = pictures.size[0] / pictures.scale;
    let longest = LONGEST_BAR * whole;
    let power = 10f64.powf(longest.log10().floor());
    let round = [5.0, 2.0]
        .into_iter()
        .find(|factor| factor * power <= longest);
    let length = round.unwrap_or(1.0) * power;
    let name = match 1000.0 <= length {
        true => format!("{} km", length / 1000.0),
        false => format!("{length} m"),
    };
    (length / whole, name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_level_at_rest_is_that_of_calm_water() {
        let mut highest = vec![5.0; 50];
        highest.extend([9.0; 50]);
        highest.push(f64::NAN);
        let arrival = |from: usize| {
            (0..101)
                .map(|k| if k < from { f64::NAN } else { 3.0 })
                .collect::<Vec<f64>>()
        };
        let dry = vec![f64::NAN; 101];
        assert_eq!(
            still_level(&highest, &[arrival(50), dry.clone()]),
            Some(5.0)
        );
        // a wave everywhere
        assert_eq!(still_level(&highest, &[arrival(0), dry.clone()]), Some(5.0));
        assert_eq!(still_level(&[f64::NAN], &[vec![1.0], vec![1.0]]), None);
    }
}
