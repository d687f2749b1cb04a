//! Files for GeoClaw: topography, surface, discharges, and the code that reads them.

use std::path::Path;

use super::formats::{NO_DATA, Sheet, made};
use crate::files::vtk::replace_file;
use crate::output::observe::ObserveError;

/// Initial state from three files, in place of GeoClaw's own, which reads one quantity.
const QINIT: &str = include_str!("geoclaw/qinit.f90");
const MAKEFILE: &str = include_str!("geoclaw/Makefile");
/// With names in braces for what the raster says.
const SETRUN: &str = include_str!("geoclaw/setrun.py");
/// First step over the time in which a wave passes a cell of the deepest water.
const FIRST_STEP: f64 = 0.5;

impl Sheet<'_> {
    /// Topography, surface and discharges for GeoClaw, with `qinit.f90`, `setrun.py` and a `Makefile`.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] names the file.
    pub fn write_geoclaw(&self, folder: &Path) -> Result<(), ObserveError> {
        let folder = made(&folder.join("geoclaw"))?;
        let ([nx, ny], side) = (self.n(), self.columns.raster.side[0]);
        let head = format!(
            "{nx} ncols\n{ny} nrows\n{:.3} xllcenter\n{:.3} yllcenter\n{side} cellsize\n{NO_DATA} nodata_value\n",
            self.centers(0)[0],
            self.centers(1)[0]
        );
        let topography = head + &self.rows(&self.bed(), true);
        let discharge = |axis: usize| -> Vec<f64> {
            let cells = self.columns.depth.iter().zip(&self.columns.velocity);
            cells.map(|(h, v)| h * v[axis]).collect()
        };
        let files = [
            ("topo.tt3", topography),
            ("eta.xyz", self.triplets(&self.eta())),
            ("hu.xyz", self.triplets(&discharge(0))),
            ("hv.xyz", self.triplets(&discharge(1))),
            ("qinit.f90", QINIT.to_owned()),
            ("Makefile", MAKEFILE.to_owned()),
            ("setrun.py", self.setrun()),
        ];
        for (name, text) in files {
            replace_file(&folder.join(name), &[text.as_bytes()])?;
        }
        Ok(())
    }

    fn setrun(&self) -> String {
        let raster = &self.columns.raster;
        // topography is known between the centers of the raster's cells
        let low = [0, 1].map(|axis| self.centers(axis)[0]);
        let n = raster.n.map(|n| n.saturating_sub(1));
        let high = [0, 1].map(|axis| low[axis] + n[axis] as f64 * raster.side[axis]);
        let deepest = self.columns.depth.iter().copied().fold(0.0, f64::max);
        let step = FIRST_STEP * raster.side[0] / (self.gravity * deepest).sqrt();
        let title = self.title.replace(['\n', '"', '\\'], " ");
        let values = [
            ("{title}", title),
            ("{time}", self.time.to_string()),
            ("{west}", low[0].to_string()),
            ("{east}", high[0].to_string()),
            ("{south}", low[1].to_string()),
            ("{north}", high[1].to_string()),
            ("{nx}", n[0].to_string()),
            ("{ny}", n[1].to_string()),
            ("{step}", step.to_string()),
            ("{gravity}", self.gravity.to_string()),
            ("{middle_x}", (0.5 * (low[0] + high[0])).to_string()),
            ("{middle_y}", (0.5 * (low[1] + high[1])).to_string()),
        ];
        let fill = |text: String, (name, value): &(&str, String)| text.replace(name, value);
        values.iter().fold(SETRUN.to_owned(), fill)
    }
}
