//! Place of the pixels of a GeoTIFF on the map.

use tiff::tags::Tag;

use super::keys::Keys;
use super::{File, refuse};
use crate::scene::access::fault::Fault;

/// Tolerance of square pixels and of north, relative.
const SQUARE: f64 = 1e-6;

/// The map coordinates of a pixel's center: `x = first.0 + column · step.0`, `y = first.1 + row · step.1`.
pub(super) struct Georeference {
    /// Center of the first pixel.
    first: [f64; 2],
    /// Between columns and between rows; the second is negative where rows run from north to south.
    step: [f64; 2],
}

impl Georeference {
    /// From a scale and a tie point, or from a matrix.
    ///
    /// # Errors
    ///
    /// [`Fault::Format`], with the remedy.
    pub(super) fn read(file: &mut File, keys: &Keys) -> Result<Self, Fault> {
        let scale = file.get_tag_f64_vec(Tag::ModelPixelScaleTag).ok();
        let tie = file.get_tag_f64_vec(Tag::ModelTiepointTag).ok();
        let matrix = file.get_tag_f64_vec(Tag::ModelTransformationTag).ok();
        let (corner, step) = match (scale.as_deref(), tie.as_deref(), matrix.as_deref()) {
            (Some(&[width, height, ..]), Some(&[column, row, _, x, y, ..]), _) => {
                let step = [width, -height];
                ([x - column * step[0], y - row * step[1]], step)
            }
            (_, _, Some(&[a, b, _, x, c, d, _, y, ..])) => {
                if b.abs() > SQUARE * a.abs() || c.abs() > SQUARE * d.abs() {
                    return Err(refuse(
                        "is rotated against the map; turn it north up: gdalwarp in.tif out.tif",
                    ));
                }
                ([x, y], [a, d])
            }
            _ => {
                return Err(refuse(
                    "has no place on the map (pixel scale and tie point); export it as GeoTIFF, or with its world file: \
                     gdal_translate in.tif out.tif",
                ));
            }
        };
        // a tie to an area is one to the corner of a pixel
        let half = if keys.is_point() { 0.0 } else { 0.5 };
        let first = [0, 1].map(|axis| corner[axis] + half * step[axis]);
        if !first.iter().chain(&step).all(|value| value.is_finite()) || step[0] <= 0.0 {
            return Err(refuse(format!(
                "has pixels of {} x {} at ({}, {}); export it again, north up",
                step[0], step[1], first[0], first[1]
            )));
        }
        Ok(Self { first, step })
    }

    pub(super) fn is_north_up(&self) -> bool {
        self.step[1] < 0.0
    }

    /// Middle of an image of some columns and rows.
    pub(super) fn middle(&self, n: [usize; 2]) -> [f64; 2] {
        [0, 1].map(|axis| self.first[axis] + 0.5 * (n[axis] - 1) as f64 * self.step[axis])
    }

    /// Southwestern point and spacing of a square grid; m.
    ///
    /// # Errors
    ///
    /// [`Fault::Format`] for pixels that are not square.
    pub(super) fn square_grid(&self, n: [usize; 2]) -> Result<([f64; 2], f64), Fault> {
        let [width, height] = self.step.map(f64::abs);
        if (width - height).abs() > SQUARE * width {
            return Err(refuse(format!(
                "has pixels of {width} x {height} m; resample it to square ones: gdalwarp -tr {width} {width} in.tif out.tif"
            )));
        }
        let south = if self.is_north_up() {
            self.first[1] - (n[1] - 1) as f64 * width
        } else {
            self.first[1]
        };
        Ok(([self.first[0], south], width))
    }
}
