//! Files that solvers of the far field read.
//!
//! | file | rows | heights |
//! |---|---|---|
//! | `handoff.nc` | south to north, cell centers in map coordinates | of the map |
//! | `*.asc`, `*.tif` | north to south | of the map |
//! | `funwave/*.txt` | south to north | over the level of rest; depth positive down |
//! | `swash/*.txt` | south to north | over the level of rest; bottom positive down |
//! | `geoclaw/topo.tt3` | north to south | over the level of rest |
//! | `geoclaw/*.xyz` | x y value from the north-west corner, row by row | over the level of rest |
//! | `section.csv` | along x | of the scene |

use std::fmt::Write as _;
use std::io;
use std::path::Path;

use super::columns::Columns;
use super::netcdf::{self, Data, Variable};
use crate::files::vtk::replace_file;
use crate::output::observe::ObserveError;
use crate::output::observe::maps::rasters;
use crate::scene::crs::Crs;
use crate::scene::terrain::grid::{Grid, MapGrid};

/// Missing value in files of text.
pub(super) const NO_DATA: f64 = -9999.0;

/// Columns with their place on the map and in time.
#[derive(Clone, Copy, Debug)]
pub struct Sheet<'a> {
    /// The columns.
    pub columns: &'a Columns,
    /// Title of the scene.
    pub title: &'a str,
    /// Map coordinates of the scene's origin; m.
    pub origin: (f64, f64, f64),
    /// Reference system of the map, if known.
    pub crs: Option<&'a Crs>,
    /// Level of rest; m.
    pub level: f64,
    /// s.
    pub time: f64,
    /// m/s².
    pub gravity: f64,
    /// Whether the center of each cell is in an absorbing layer.
    pub is_absorbing: &'a [bool],
}

impl Sheet<'_> {
    pub(super) fn n(&self) -> [usize; 2] {
        self.columns.raster.n
    }

    /// Centers of cells along an axis in map coordinates; m.
    pub(super) fn centers(&self, axis: usize) -> Vec<f64> {
        let raster = &self.columns.raster;
        let origin = [self.origin.0, self.origin.1][axis];
        let at = |k: usize| origin + raster.corner[axis] + (k as f64 + 0.5) * raster.side[axis];
        (0..raster.n[axis]).map(at).collect()
    }

    fn component(&self, of: &[[f64; 2]], axis: usize) -> Vec<f64> {
        of.iter().map(|v| v[axis]).collect()
    }

    /// Rows of text from the south or the north.
    pub(super) fn rows(&self, values: &[f64], from_north: bool) -> String {
        let rows: Vec<&[f64]> = values.chunks(self.n()[0]).collect();
        let line = |row: &&[f64]| {
            let words: Vec<String> = row.iter().map(|&x| number(x)).collect();
            words.join(" ") + "\n"
        };
        match from_north {
            true => rows.iter().rev().map(line).collect(),
            false => rows.iter().map(line).collect(),
        }
    }

    /// Lines `x y value` from the north-west corner.
    pub(super) fn triplets(&self, values: &[f64]) -> String {
        let (x, y) = (self.centers(0), self.centers(1));
        let mut text = String::new();
        for (y, row) in y.iter().zip(values.chunks(self.n()[0])).rev() {
            for (x, value) in x.iter().zip(row) {
                let _ = writeln!(text, "{x:.3} {y:.3} {}", number(*value));
            }
        }
        text
    }

    /// Ground over the level of rest, high where there is none; m.
    pub(super) fn bed(&self) -> Vec<f64> {
        let ground = self.columns.ground.iter();
        ground
            .map(|z| {
                if z.is_finite() {
                    z - self.level
                } else {
                    NO_DATA.abs()
                }
            })
            .collect()
    }

    /// Surface over the level of rest, the ground where that is higher and dry; m.
    pub(super) fn eta(&self) -> Vec<f64> {
        let cells = self.columns.surface.iter().zip(self.bed());
        cells
            .map(|(z, bed)| if z.is_finite() { z - self.level } else { bed })
            .collect()
    }

    /// `handoff.nc`, NetCDF-3 by the CF conventions.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] names the file.
    pub fn write_netcdf(&self, folder: &Path) -> Result<(), ObserveError> {
        let [nx, ny] = self.n();
        let attributes = |pairs: &[(&'static str, &str)]| {
            pairs
                .iter()
                .map(|(name, text)| (*name, (*text).to_owned()))
                .collect::<Vec<_>>()
        };
        let axis = |name, standard, k| Variable {
            name,
            dimensions: vec![1 - k as u32],
            attributes: attributes(&[("standard_name", standard), ("units", "m")]),
            data: Data::Double(self.centers(k)),
        };
        let raised = |values: &[f64]| {
            values
                .iter()
                .map(|z| z + self.origin.2)
                .collect::<Vec<f64>>()
        };
        let field = |name, standard: &str, long: &str, units: &str, values: &[f64]| {
            let mut all = attributes(&[("long_name", long), ("units", units)]);
            if !standard.is_empty() {
                all.insert(0, ("standard_name", standard.to_owned()));
            }
            Variable {
                name,
                dimensions: vec![0, 1],
                attributes: all,
                data: Data::Float(values.iter().map(|&x| x as f32).collect()),
            }
        };
        let columns = self.columns;
        let [u, v] = [0, 1].map(|axis| self.component(&columns.velocity, axis));
        let [u_alpha, v_alpha] = [0, 1].map(|axis| self.component(&columns.velocity_alpha, axis));
        let absorbing: Vec<f64> = (self.is_absorbing.iter())
            .map(|&is| f64::from(u8::from(is)))
            .collect();
        let system = self.crs.map_or("unknown", |crs| crs.wkt.as_str());
        let file = netcdf::File {
            dimensions: vec![("y", ny), ("x", nx)],
            attributes: vec![
                ("Conventions", "CF-1.10".to_owned()),
                ("title", self.title.to_owned()),
                ("time", format!("{} s", self.time)),
                (
                    "still_water_level",
                    format!("{} m", self.level + self.origin.2),
                ),
                ("spatial_ref", system.to_owned()),
            ],
            variables: vec![
                axis("y", "projection_y_coordinate", 1),
                axis("x", "projection_x_coordinate", 0),
                field(
                    "eta",
                    "water_surface_height_above_reference_datum",
                    "water surface, the ground where dry",
                    "m",
                    &raised(&columns.surface),
                ),
                field(
                    "ground",
                    "",
                    "ground with the blocks on it",
                    "m",
                    &raised(&columns.ground),
                ),
                field("depth", "", "depth of the water", "m", &columns.depth),
                field(
                    "absorbing",
                    "",
                    "1 in layers that absorb waves, whose water is not to be handed over",
                    "1",
                    &absorbing,
                ),
                field(
                    "u",
                    "sea_water_x_velocity",
                    "mean over the depth",
                    "m s-1",
                    &u,
                ),
                field(
                    "v",
                    "sea_water_y_velocity",
                    "mean over the depth",
                    "m s-1",
                    &v,
                ),
                field(
                    "u_alpha",
                    "",
                    "velocity along x at 0.531 of the depth below the surface",
                    "m s-1",
                    &u_alpha,
                ),
                field(
                    "v_alpha",
                    "",
                    "velocity along y at 0.531 of the depth below the surface",
                    "m s-1",
                    &v_alpha,
                ),
            ],
        };
        let path = folder.join("handoff.nc");
        let too_large = || ObserveError::Write {
            path: path.display().to_string(),
            source: io::Error::other("too large for NetCDF-3: take larger cells"),
        };
        replace_file(&path, &[&netcdf::bytes(&file).ok_or_else(too_large)?])?;
        Ok(())
    }

    /// ESRI grids and GeoTIFF of surface, ground, depth and velocities. Cells are squares.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] names the file.
    pub fn write_esri(&self, folder: &Path) -> Result<(), ObserveError> {
        let columns = self.columns;
        let lifted = |values: &[f64]| values.iter().map(|z| z + self.origin.2).collect();
        let fields: [(&str, Vec<f64>); 5] = [
            ("eta.asc", lifted(&columns.surface)),
            ("ground.asc", lifted(&columns.ground)),
            ("depth.asc", columns.depth.clone()),
            ("u.asc", self.component(&columns.velocity, 0)),
            ("v.asc", self.component(&columns.velocity, 1)),
        ];
        for (name, heights) in fields {
            let grid = Grid {
                n: self.n(),
                corner: [self.centers(0)[0], self.centers(1)[0]],
                spacing: columns.raster.side[0],
                heights,
            };
            let crs = self.crs.cloned();
            rasters::write(&folder.join(name), &MapGrid { grid, crs })?;
        }
        Ok(())
    }

    /// Depth, surface and velocities for FUNWAVE-TVD, with an input that names them.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] names the file.
    pub fn write_funwave(&self, folder: &Path) -> Result<(), ObserveError> {
        let folder = made(&folder.join("funwave"))?;
        let depth: Vec<f64> = self.bed().iter().map(|z| -z).collect();
        let [u, v] = [0, 1].map(|axis| self.component(&self.columns.velocity_alpha, axis));
        for (name, values) in [
            ("depth.txt", depth),
            ("eta.txt", self.eta()),
            ("u.txt", u),
            ("v.txt", v),
        ] {
            replace_file(&folder.join(name), &[self.rows(&values, false).as_bytes()])?;
        }
        let ([nx, ny], [dx, dy]) = (self.n(), self.columns.raster.side);
        let input = format!(
            "! {title}, handed over at {time} s. Velocities are those at 0.531 of the depth below the surface.\n\
             TITLE = handoff\nMglob = {nx}\nNglob = {ny}\nDX = {dx}\nDY = {dy}\n\
             DEPTH_TYPE = DATA\nDEPTH_FILE = depth.txt\nWaterLevel = 0.0\n\
             INI_UVZ = T\nETA_FILE = eta.txt\nU_FILE = u.txt\nV_FILE = v.txt\n\
             ! to be chosen: times, processors, sponges, fields of output\n\
             TOTAL_TIME = 600.0\nPLOT_INTV = 10.0\nPX = 1\nPY = 1\nETA = T\nU = T\nV = T\n",
            title = self.title.replace('\n', " "),
            time = self.time,
        );
        replace_file(&folder.join("input.txt"), &[input.as_bytes()])?;
        Ok(())
    }

    /// `section.csv`, for a section.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] names the file.
    pub fn write_section(&self, folder: &Path) -> Result<(), ObserveError> {
        let columns = self.columns;
        let mut text =
            "x [m],ground [m],surface [m],depth [m],u [m/s],u_alpha [m/s],stretch [-]\n".to_owned();
        for cell in 0..columns.raster.n_cells() {
            let _ = writeln!(
                text,
                "{},{},{},{},{},{},{}",
                columns.raster.center(cell)[0],
                columns.ground[cell],
                columns.surface[cell],
                columns.depth[cell],
                columns.velocity[cell][0],
                columns.velocity_alpha[cell][0],
                columns.stretch[cell]
            );
        }
        replace_file(&folder.join("section.csv"), &[text.as_bytes()])?;
        Ok(())
    }
}

fn number(value: f64) -> String {
    format!("{:.6}", if value.is_finite() { value } else { NO_DATA })
}

/// A folder, made.
pub(super) fn made(folder: &Path) -> Result<std::path::PathBuf, ObserveError> {
    std::fs::create_dir_all(folder).map_err(|source| ObserveError::Write {
        path: folder.display().to_string(),
        source,
    })?;
    Ok(folder.to_owned())
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::handoff::columns::Raster;

    /// Two rows of three cells; numbers say which.
    fn columns() -> Columns {
        let raster = Raster {
            n: [3, 2],
            corner: [10.0, 20.0],
            side: [2.0, 2.0],
        };
        Columns {
            raster,
            volume: vec![4.0; 6],
            mass: vec![4000.0; 6],
            momentum: vec![[0.0; 2]; 6],
            ground: vec![-1.0, -2.0, -3.0, -4.0, -5.0, f64::NAN],
            depth: vec![1.1, 2.2, 3.3, 4.4, 5.5, 0.0],
            surface: vec![0.1, 0.2, 0.3, 0.4, 0.5, f64::NAN],
            velocity: vec![
                [1.0, -1.0],
                [2.0, 0.0],
                [3.0, 0.0],
                [4.0, 0.0],
                [5.0, 0.0],
                [0.0, 0.0],
            ],
            velocity_alpha: vec![[1.5, 0.0]; 6],
            bed_pressure: vec![f64::NAN; 6],
            stretch: vec![1.0; 6],
        }
    }

    fn read(folder: &Path, name: &str) -> String {
        std::fs::read_to_string(folder.join(name)).unwrap()
    }

    #[test]
    fn every_format_has_its_own_order_and_signs() {
        let (columns, folder) = (columns(), tempfile::tempdir().unwrap());
        let sheet = Sheet {
            columns: &columns,
            title: "a test",
            origin: (100.0, 200.0, 7.0),
            crs: None,
            level: 0.05,
            time: 12.5,
            gravity: 9.81,
            is_absorbing: &[false; 6],
        };
        let at = folder.path();
        sheet.write_funwave(at).unwrap();
        // depth positive down, from the south; no ground is high land
        let depth = read(at, "funwave/depth.txt");
        assert!(
            depth.starts_with("1.050000 2.050000 3.050000\n4.050000 5.050000 -9999"),
            "{depth}"
        );
        assert!(read(at, "funwave/eta.txt").starts_with("0.050000 0.150000 0.250000\n"));
        assert!(read(at, "funwave/u.txt").starts_with("1.500000 "));
        let input = read(at, "funwave/input.txt");
        assert!(
            input.contains("Mglob = 3\nNglob = 2\nDX = 2\n") && input.contains("INI_UVZ = T\n")
        );
        sheet.write_geoclaw(at).unwrap();
        // from the north, up positive
        let topography = read(at, "geoclaw/topo.tt3");
        assert!(
            topography.starts_with(
                "3 ncols\n2 nrows\n111.000 xllcenter\n221.000 yllcenter\n2 cellsize\n"
            ),
            "{topography}"
        );
        assert!(
            topography.contains("nodata_value\n-4.050000 -5.050000 9999.000000\n-1.050000 "),
            "{topography}"
        );
        let eta = read(at, "geoclaw/eta.xyz");
        assert!(
            eta.starts_with("111.000 223.000 0.350000\n113.000 223.000 0.450000\n"),
            "{eta}"
        );
        let hu = read(at, "geoclaw/hu.xyz");
        assert!(
            hu.ends_with("113.000 221.000 4.400000\n115.000 221.000 9.900000\n"),
            "{hu}"
        );
        sheet.write_esri(at).unwrap();
        let eta = read(at, "eta.asc");
        assert!(
            eta.contains("xllcenter 111.0\n") && eta.contains("\n7.400 7.500 -9999.000\n7.100 "),
            "{eta}"
        );
        sheet.write_netcdf(at).unwrap();
        let bytes = std::fs::read(at.join("handoff.nc")).unwrap();
        // doubles of y first, after the header, from the south
        let double = |at: usize| f64::from_be_bytes(bytes[at..at + 8].try_into().unwrap());
        let data = bytes.len() - (2 + 3) * 8 - 8 * 6 * 4;
        assert!((double(data) - 221.0).abs() < 1e-12 && (double(data + 8) - 223.0).abs() < 1e-12);
        assert!((double(data + 16) - 111.0).abs() < 1e-12);
        let first = data + 5 * 8;
        let float = f32::from_be_bytes(bytes[first..first + 4].try_into().unwrap());
        assert!((float - 7.1).abs() < 1e-6, "the surface at the south-west");
        assert_eq!(&bytes[..8], b"CDF\x01\0\0\0\0");
    }
}
