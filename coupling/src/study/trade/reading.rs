//! Quantities by name, for runs without a study: `crest_at_g1`, `mean_of_p_floor`.

use super::file::OutputFile;
use super::quantity::Take;
use crate::output::run_folder;
use crate::scene::parse::suggestion;
use crate::scene::resolve::Scene;
use crate::scene::resolved::recording::Quantity;

/// Evaluation denoted by a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Evaluation in the table.
    pub output: OutputFile,
    /// Origin that relative errors exclude: the still-water level for surface elevations, otherwise 0; in the column's unit.
    pub zero: f64,
}

/// Evaluations, by prefix of the name.
const WAYS: [&str; 5] = ["crest_at_", "trough_at_", "max_of_", "min_of_", "mean_of_"];

/// Gauges with one column, and whether they record the surface elevation.
fn gauges(scene: &Scene) -> impl Iterator<Item = (&str, bool)> {
    scene.gauges.iter().filter_map(|gauge| {
        let is_surface = match gauge.quantity {
            Quantity::SurfaceElevation { .. } | Quantity::RunUp(_) => true,
            Quantity::Pressure(_) | Quantity::Front(_) => false,
            _ => return None,
        };
        Some((gauge.name.as_str(), is_surface))
    })
}

/// The quantity with a name; by default the crest at the first surface gauge. Windows are the whole run.
///
/// # Errors
///
/// A message with the available names.
pub fn reading(name: Option<&str>, scene: &Scene) -> Result<Reading, String> {
    let first = || gauges(scene).find(|(_, is_surface)| *is_surface);
    let default = || {
        let (gauge, _) = first().ok_or(
            "the scene has no surface gauge: choose the quantity with --of, such as --of max_of_p1",
        )?;
        Ok::<String, String>(format!("crest_at_{gauge}"))
    };
    let name = name.map_or_else(default, |name| Ok(name.to_owned()))?;
    let all: Vec<String> = gauges(scene)
        .flat_map(|(gauge, _)| WAYS.map(|way| format!("{way}{gauge}")))
        .collect();
    let names: Vec<&str> = all.iter().map(String::as_str).collect();
    let unknown = || {
        let hint = suggestion(&name, &names);
        let ways = WAYS.map(|way| format!("{way}GAUGE")).join(", ");
        format!(
            "`{name}` is neither a study of this case nor {ways} with a gauge of one column of the scene{hint}"
        )
    };
    let (way, gauge, is_surface) = WAYS
        .iter()
        .find_map(|way| {
            let gauge = name.strip_prefix(way)?;
            let (_, is_surface) = gauges(scene).find(|(other, _)| *other == gauge)?;
            Some((*way, gauge.to_owned(), is_surface))
        })
        .ok_or_else(unknown)?;
    let (from, to) = (0.0, scene.duration);
    let take = match way {
        "crest_at_" | "max_of_" => Take::Maximum { from, to },
        "mean_of_" => Take::Mean { from, to },
        _ => Take::Minimum { from, to },
    };
    let level = scene.fluid.as_ref().map(|f| f.lattice.still_water_level);
    Ok(Reading {
        output: OutputFile {
            name,
            file: run_folder::GAUGES.to_owned(),
            column: gauge,
            block: None,
            take: Some(take),
        },
        zero: level.filter(|_| is_surface).unwrap_or(0.0),
    })
}
