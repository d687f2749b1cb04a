//! Points, lines and polygons of files that the scene names, in its coordinates.

use std::io::ErrorKind;
use std::path::Path;

use super::crs::{Content, Crs};
use crate::files::features::{Feature, Form, features_from};
use crate::scene::access::Access;
use crate::scene::access::fault::{Fault, MeshError};
use crate::scene::file::Triple;

/// Content of a file in the coordinates of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct MapFeatures {
    /// Points, lines and polygons; m.
    pub list: Vec<Feature>,
    /// Reference system of the file, if known.
    pub crs: Option<Crs>,
}

/// Reads a file in map coordinates; `origin` is that of the scene in them.
///
/// # Errors
///
/// [`MeshError`], which names the file, the place in it and the remedy.
pub fn read(access: &Access, file: &str, origin: Triple) -> Result<MapFeatures, MeshError> {
    let refuse = |fault| MeshError {
        file: file.to_owned(),
        fault,
    };
    let content = access.read(file).map_err(refuse)?;
    let attributes = attributes(access, file).map_err(refuse)?;
    let found = features_from(file, &content, attributes.as_deref())
        .map_err(|fault| refuse(Fault::Format(fault.to_string())))?;
    let crs = match &found.system {
        Some(name) => {
            let crs: Result<Crs, _> = name.parse();
            Some(crs.map_err(|error| refuse(Fault::Format(error.to_string())))?)
        }
        None if is_shapefile(file) => Crs::beside(access, file)?,
        None => None,
    };
    let mut list = found.list;
    let middle = middle(&list).ok_or_else(|| {
        refuse(Fault::Format(
            "has no points, lines or polygons; export the layer that has them".into(),
        ))
    })?;
    match &crs {
        Some(crs) => crs.in_meters(Content::Features, middle).map_err(refuse)?,
        None if !is_on_earth([origin.0, origin.1]) && list.iter().all(is_in_degrees) => {
            return Err(refuse(Content::Features.in_degrees(None, middle)));
        }
        None => {}
    }
    for feature in &mut list {
        shift(&mut feature.form, origin);
    }
    Ok(MapFeatures { list, crs })
}

fn is_shapefile(file: &str) -> bool {
    Path::new(file)
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("shp"))
}

/// Content of the `.dbf` beside a shapefile, if there is one.
fn attributes(access: &Access, file: &str) -> Result<Option<Vec<u8>>, Fault> {
    if !is_shapefile(file) {
        return Ok(None);
    }
    let beside = Path::new(file).with_extension("dbf");
    match access.read(&beside.to_string_lossy()) {
        Ok(content) => Ok(Some(content)),
        Err(Fault::Unreadable(error)) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(fault) => Err(fault),
    }
}

/// Mean of all points in plan view; `None` without any.
fn middle(list: &[Feature]) -> Option<[f64; 2]> {
    let points = || list.iter().flat_map(|feature| feature.form.points());
    let n = points().count();
    let mean = |axis: usize| points().map(|point| point[axis]).sum::<f64>() / n as f64;
    (n > 0).then(|| [mean(0), mean(1)])
}

/// True within the range of longitude and latitude.
fn is_on_earth([x, y]: [f64; 2]) -> bool {
    x.abs() <= 360.0 && y.abs() <= 90.0
}

fn is_in_degrees(feature: &Feature) -> bool {
    let mut points = feature.form.points().iter();
    points.all(|&[x, y, _]| is_on_earth([x, y]))
}

fn shift(form: &mut Form, (x, y, z): Triple) {
    let points = match form {
        Form::Point(point) => std::slice::from_mut(point),
        Form::Line(points) | Form::Polygon(points) => points,
    };
    for point in points {
        *point = [point[0] - x, point[1] - y, point[2] - z];
    }
}
