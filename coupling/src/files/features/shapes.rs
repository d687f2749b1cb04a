//! Shapefiles (ESRI 1998), with the names in their attributes.

use std::io::Cursor;

use shapefile::dbase::{self, FieldValue};
use shapefile::record::traits::{HasXY, HasZ};
use shapefile::{PolygonRing, Shape, ShapeReader};

use super::{Feature, FeatureFault, Features, Form};

/// Fields that name a shape, in lower case.
const NAMES: [&str; 5] = ["name", "id", "label", "gauge", "station"];

/// Content of a `.shp`, named by a `.dbf`.
pub(super) fn features(
    content: &[u8],
    attributes: Option<&[u8]>,
) -> Result<Features, FeatureFault> {
    let refuse = |error: &dyn std::fmt::Display| {
        FeatureFault::new(format!("is not a readable shapefile: {error}"))
    };
    let reader = ShapeReader::new(Cursor::new(content)).map_err(|error| refuse(&error))?;
    let shapes = reader.read().map_err(|error| refuse(&error))?;
    let names = attributes.map_or_else(Vec::new, |content| names(content, shapes.len()));
    let mut names = names.into_iter();
    let mut list = Vec::new();
    for (k, shape) in shapes.iter().enumerate() {
        let name = names.next().flatten();
        let forms =
            forms(shape).map_err(|what| FeatureFault::new(format!("shape {}: {what}", k + 1)))?;
        list.extend(forms.into_iter().map(|form| Feature {
            name: name.clone(),
            form,
        }));
    }
    Ok(Features { list, system: None })
}

/// Name of each of `n` records; none where the attributes cannot be read.
fn names(content: &[u8], n: usize) -> Vec<Option<String>> {
    let Ok(mut reader) = dbase::Reader::new(Cursor::new(content)) else {
        return Vec::new();
    };
    let name = |record: Result<dbase::Record, dbase::Error>| {
        let fields = record.ok()?;
        let mut named = fields.into_iter().filter_map(|(field, value)| {
            let rank = NAMES
                .iter()
                .position(|name| *name == field.to_lowercase())?;
            Some((rank, written(&value)?))
        });
        let first = named.next()?;
        let best = named.fold(first, |a, b| if b.0 < a.0 { b } else { a });
        Some(best.1)
    };
    // a damaged header may promise any number of records
    reader.iter_records().take(n).map(name).collect()
}

fn written(value: &FieldValue) -> Option<String> {
    match value {
        FieldValue::Character(text) => text.clone(),
        FieldValue::Numeric(number) => number.map(|number| number.to_string()),
        FieldValue::Integer(number) => Some(number.to_string()),
        _ => None,
    }
    .map(|text| text.trim().to_owned())
    .filter(|text| !text.is_empty())
}

fn flat<P: HasXY>(point: &P) -> [f64; 3] {
    [point.x(), point.y(), f64::NAN]
}

fn high<P: HasXY + HasZ>(point: &P) -> [f64; 3] {
    [point.x(), point.y(), point.z()]
}

fn forms(shape: &Shape) -> Result<Vec<Form>, String> {
    fn lines<P>(parts: &[Vec<P>], place: fn(&P) -> [f64; 3]) -> Vec<Form> {
        let part = |part: &Vec<P>| Form::Line(part.iter().map(place).collect());
        parts.iter().map(part).collect()
    }
    fn points<P>(points: &[P], place: fn(&P) -> [f64; 3]) -> Vec<Form> {
        points.iter().map(|p| Form::Point(place(p))).collect()
    }
    Ok(match shape {
        Shape::NullShape => Vec::new(),
        Shape::Point(point) => vec![Form::Point(flat(point))],
        Shape::PointM(point) => vec![Form::Point(flat(point))],
        Shape::PointZ(point) => vec![Form::Point(high(point))],
        Shape::Multipoint(shape) => points(shape.points(), flat),
        Shape::MultipointM(shape) => points(shape.points(), flat),
        Shape::MultipointZ(shape) => points(shape.points(), high),
        Shape::Polyline(line) => lines(line.parts(), flat),
        Shape::PolylineM(line) => lines(line.parts(), flat),
        Shape::PolylineZ(line) => lines(line.parts(), high),
        Shape::Polygon(shape) => polygons(shape.rings(), flat)?,
        Shape::PolygonM(shape) => polygons(shape.rings(), flat)?,
        Shape::PolygonZ(shape) => polygons(shape.rings(), high)?,
        Shape::Multipatch(_) => {
            return Err("is a multipatch; needed is a point, a line or a polygon".into());
        }
    })
}

fn polygons<P>(rings: &[PolygonRing<P>], place: fn(&P) -> [f64; 3]) -> Result<Vec<Form>, String> {
    let ring = |ring: &PolygonRing<P>| match ring {
        PolygonRing::Outer(points) => Ok(Form::Polygon(points.iter().map(place).collect())),
        PolygonRing::Inner(_) => Err("has a polygon with a hole; one without is needed".to_owned()),
    };
    rings.iter().map(ring).collect()
}
