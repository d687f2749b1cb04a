//! Schema of the hand-off to solvers of the far field.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Hand-off to a solver of the far field: `handoff/` has the water in columns on a raster when the wave is on its way; `handoff_lines.csv`
/// the flow through lines. `riprap handoff` makes the same of any run afterwards.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HandoffFile {
    /// Instants.
    #[serde(default)]
    pub times: HandoffTimesFile,
    /// Side of a cell; two particle spacings when left out; m.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m", "exclusiveMinimum" = 0))]
    pub cell: Option<f64>,
    /// Level of rest; that of the highest water at the start when left out; m.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m"))]
    pub level: Option<f64>,
    /// Files to write. A section has `section.csv` alone.
    #[serde(default = "usual_formats")]
    pub formats: Vec<HandoffFormat>,
    /// Lines through which the flow is recorded.
    #[serde(default)]
    pub lines: Vec<HandoffLineFile>,
}

/// Instants of a hand-off.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum HandoffTimesFile {
    /// Once, at the first time at which the moving blocks give the water less than a hundredth of the largest power so far, or before the
    /// leading wave gets into an absorbing layer, whichever is first.
    #[default]
    Auto,
    /// At given times, each into a folder of its own; s.
    #[schemars(extend("x-unit" = "s"))]
    At(Vec<f64>),
    /// Never in the run: lines alone.
    Never,
}

/// Files of a hand-off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum HandoffFormat {
    /// NetCDF-3 with CF names.
    NetCdf,
    /// ESRI ASCII grids and GeoTIFF.
    Esri,
    /// FUNWAVE-TVD: depth, surface, velocities, `input.txt`.
    Funwave,
    /// GeoClaw: topography, surface, discharges, and the code that reads them.
    Geoclaw,
    /// SWASH: bottom, water level, current, series of the lines, `INPUT`.
    Swash,
}

/// Line in plan view through which the flow is recorded: surface, depth, discharge to its right, and velocities at ten levels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HandoffLineFile {
    /// Prefix of its column names and files.
    pub name: String,
    /// Start, in plan view; m.
    #[schemars(extend("x-unit" = "m"))]
    pub from: (f64, f64),
    /// End, in plan view; m.
    #[schemars(extend("x-unit" = "m"))]
    pub to: (f64, f64),
}

fn usual_formats() -> Vec<HandoffFormat> {
    vec![HandoffFormat::NetCdf, HandoffFormat::Esri]
}
