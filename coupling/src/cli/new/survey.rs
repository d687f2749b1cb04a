//! Elevations on the map, for a scene that is yet to be written.

use std::path::{Path, PathBuf};

use super::{folder_of, name_beside};
use crate::scene::access::Access;
use crate::scene::geometry::terrain::sources::Source;

/// Points across a survey of triangles, which has no cells.
const POINTS_OF_SURVEY: f64 = 400.0;

/// Elevation files in map coordinates, the first with a value at a place counts there.
pub(super) struct Survey {
    /// Names as seen from the scene.
    pub names: Vec<String>,
    sources: Vec<Source>,
    /// Smallest and largest x and y of all; m.
    pub extent: [[f64; 2]; 2],
    /// Spacing of the points of the first raster; m.
    pub cell: f64,
}

impl Survey {
    /// Reads files that lie beside the scene.
    ///
    /// # Errors
    ///
    /// A message that names the file, the fault and the remedy.
    pub fn read(files: &[PathBuf], scene: &Path) -> Result<Self, String> {
        let access = Access::of(folder_of(scene));
        let (mut names, mut sources) = (Vec::new(), Vec::new());
        for file in files {
            let name = name_beside(file, scene)?;
            let source = Source::on_map(&name, &access);
            sources.push(source.map_err(|error| error.to_string())?);
            names.push(name);
        }
        let mut extent = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        for source in &sources {
            let [low, high] = source.extent();
            for axis in 0..2 {
                extent[0][axis] = extent[0][axis].min(low[axis]);
                extent[1][axis] = extent[1][axis].max(high[axis]);
            }
        }
        let longest = (0..2).map(|axis| extent[1][axis] - extent[0][axis]);
        let of_survey = longest.fold(0.0, f64::max) / POINTS_OF_SURVEY;
        let cell = sources.iter().find_map(Source::spacing);
        Ok(Self {
            names,
            sources,
            extent,
            cell: cell.unwrap_or(of_survey),
        })
    }

    /// Elevation at a place on the map; m.
    pub fn height(&self, place: [f64; 2]) -> Option<f64> {
        self.sources.iter().find_map(|source| source.height(place))
    }

    /// Lowest and highest elevation in a rectangle, and whether some are missing; m.
    pub fn range(&self, [low, high]: [[f64; 2]; 2]) -> (f64, f64, bool) {
        let (mut least, mut most, mut has_gaps) = (f64::INFINITY, f64::NEG_INFINITY, false);
        for y in places(low[1], high[1], self.cell) {
            for x in places(low[0], high[0], self.cell) {
                match self.height([x, y]) {
                    Some(z) => (least, most) = (least.min(z), most.max(z)),
                    None => has_gaps = true,
                }
            }
        }
        (least, most, has_gaps)
    }

    /// The entries of `terrain.sources`.
    pub fn sources(&self) -> String {
        let entries = self.names.iter().map(|name| format!("(file: {name:?})"));
        entries.collect::<Vec<_>>().join(", ")
    }
}

/// Places from one end to the other, both included, at most `step` apart.
pub(super) fn places(from: f64, to: f64, step: f64) -> impl Iterator<Item = f64> {
    let n = ((to - from) / step).ceil().max(1.0) as u32;
    (0..=n).map(move |k| from + (to - from) * f64::from(k) / f64::from(n))
}
