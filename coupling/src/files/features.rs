//! Points, lines and polygons of maps: GeoJSON, shapefiles, lists of points.

mod geojson;
mod shapes;

use std::path::Path;

use super::points::points_from;

/// Content of a map.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Features {
    /// In the order of the file.
    pub list: Vec<Feature>,
    /// Reference system that the file names: `EPSG:25833`.
    pub system: Option<String>,
}

/// A point, a line or a polygon.
#[derive(Clone, Debug, PartialEq)]
pub struct Feature {
    /// Its name, if it has one.
    pub name: Option<String>,
    /// Its geometry.
    pub form: Form,
}

/// Geometry in map coordinates, z NaN where there is none; m.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// A point.
    Point([f64; 3]),
    /// A line through points.
    Line(Vec<[f64; 3]>),
    /// A ring of corners, closed by its first or open.
    Polygon(Vec<[f64; 3]>),
}

impl Form {
    /// Its points.
    pub fn points(&self) -> &[[f64; 3]] {
        match self {
            Self::Point(point) => std::slice::from_ref(point),
            Self::Line(points) | Self::Polygon(points) => points,
        }
    }
}

/// A file that is no map, with what would be right.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct FeatureFault(String);

impl FeatureFault {
    fn new(what: impl Into<String>) -> Self {
        Self(what.into())
    }
}

/// Content of a file by its extension: `.geojson`, `.json`, `.shp`, and text for others. `attributes` are the content of
/// the `.dbf` beside a shapefile, which has the names.
///
/// # Errors
///
/// [`FeatureFault`].
pub fn features_from(
    file: &str,
    content: &[u8],
    attributes: Option<&[u8]>,
) -> Result<Features, FeatureFault> {
    let extension = Path::new(file).extension().unwrap_or_default();
    match extension.to_string_lossy().to_lowercase().as_str() {
        "geojson" | "json" => geojson::features(content),
        "shp" => shapes::features(content, attributes),
        "shx" | "dbf" | "prj" | "cpg" => {
            Err(FeatureFault::new("belongs to a shapefile; name its .shp"))
        }
        "gpkg" | "kml" | "kmz" | "dxf" => Err(FeatureFault::new(
            "is not read; export GeoJSON in the system of the terrain: ogr2ogr -t_srs EPSG:... out.geojson",
        )),
        _ => listed(content),
    }
}

/// Points of a text.
fn listed(content: &[u8]) -> Result<Features, FeatureFault> {
    let text = std::str::from_utf8(content).map_err(|_| {
        FeatureFault::new(
            "is not text; known are .geojson, .shp, and columns x and y in .csv or .txt",
        )
    })?;
    let points = points_from(text).map_err(|fault| FeatureFault::new(fault.to_string()))?;
    let mut names = points.names.into_iter();
    let list = points.positions.into_iter().map(|position| Feature {
        name: names.next().filter(|name| !name.is_empty()),
        form: Form::Point(position),
    });
    Ok(Features {
        list: list.collect(),
        system: None,
    })
}

#[cfg(test)]
mod tests;
