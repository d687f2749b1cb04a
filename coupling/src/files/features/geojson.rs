//! GeoJSON (RFC 7946, and the member `crs` of 2008).

use serde_json::Value;

use super::{Feature, FeatureFault, Features, Form};

/// Members of `properties` that name a feature.
const NAMES: [&str; 7] = ["name", "Name", "NAME", "id", "ID", "label", "fid"];
/// Deepest nesting of geometries.
const DEEPEST: usize = 8;

/// Content of a file.
pub(super) fn features(content: &[u8]) -> Result<Features, FeatureFault> {
    let content = content.strip_prefix(b"\xef\xbb\xbf").unwrap_or(content);
    let root: Value = serde_json::from_slice(content)
        .map_err(|error| FeatureFault::new(format!("is not JSON: {error}")))?;
    let mut list = Vec::new();
    match root.get("features").and_then(Value::as_array) {
        Some(features) => {
            for (k, feature) in features.iter().enumerate() {
                let add = add(feature, &mut list);
                add.map_err(|what| FeatureFault::new(format!("feature {}: {what}", k + 1)))?;
            }
        }
        None => add(&root, &mut list).map_err(FeatureFault::new)?,
    }
    Ok(Features {
        list,
        system: system(&root),
    })
}

/// `EPSG:25833` of `urn:ogc:def:crs:EPSG::25833`; that of degrees for CRS84.
fn system(root: &Value) -> Option<String> {
    let name = root.pointer("/crs/properties/name")?.as_str()?;
    if name.ends_with("CRS84") {
        return Some("EPSG:4326".to_owned());
    }
    let (_, code) = name.rsplit_once(':')?;
    name.contains("EPSG").then(|| format!("EPSG:{code}"))
}

fn add(feature: &Value, list: &mut Vec<Feature>) -> Result<(), String> {
    let geometry = match feature.get("type").and_then(Value::as_str) {
        Some("Feature") => feature.get("geometry").unwrap_or(&Value::Null),
        Some(_) => feature,
        None => {
            return Err("is no GeoJSON, found no \"type\"; needed is a FeatureCollection".into());
        }
    };
    let property = |name: &&str| feature.get("properties")?.get(name);
    let named = NAMES.iter().find_map(property).or(feature.get("id"));
    let name = named.and_then(|name| match name {
        Value::String(text) => Some(text.clone()),
        Value::Number(number) => Some(number.to_string()),
        _ => None,
    });
    for form in forms(geometry, 0)? {
        list.push(Feature {
            name: name.clone(),
            form,
        });
    }
    Ok(())
}

/// Parts of a geometry; none of `null`.
fn forms(geometry: &Value, depth: usize) -> Result<Vec<Form>, String> {
    if geometry.is_null() {
        return Ok(Vec::new());
    }
    let kind = geometry.get("type").and_then(Value::as_str);
    let coordinates = geometry.get("coordinates").unwrap_or(&Value::Null);
    let each = |read: fn(&Value) -> Result<Form, String>| -> Result<Vec<Form>, String> {
        items(coordinates)?.iter().map(read).collect()
    };
    match kind {
        Some("Point") => Ok(vec![point(coordinates)?]),
        Some("MultiPoint") => each(point),
        Some("LineString") => Ok(vec![line(coordinates)?]),
        Some("MultiLineString") => each(line),
        Some("Polygon") => Ok(vec![polygon(coordinates)?]),
        Some("MultiPolygon") => each(polygon),
        Some("GeometryCollection") if depth < DEEPEST => {
            let parts = items(geometry.get("geometries").unwrap_or(&Value::Null))?;
            let parts = parts.iter().map(|part| forms(part, depth + 1));
            Ok(parts.collect::<Result<Vec<_>, _>>()?.concat())
        }
        other => Err(format!(
            "geometry `{}` is not known; needed is a Point, LineString or Polygon",
            other.unwrap_or("null")
        )),
    }
}

fn items(value: &Value) -> Result<&Vec<Value>, String> {
    value.as_array().ok_or_else(|| {
        let found: String = value.to_string().chars().take(40).collect();
        format!("needed is a list of coordinates, found {found}")
    })
}

fn point(value: &Value) -> Result<Form, String> {
    position(value).map(Form::Point)
}

fn line(value: &Value) -> Result<Form, String> {
    positions(value).map(Form::Line)
}

fn polygon(value: &Value) -> Result<Form, String> {
    match items(value)?.as_slice() {
        [ring] => positions(ring).map(Form::Polygon),
        rings => Err(format!(
            "has a polygon of {} rings; one without holes is needed",
            rings.len()
        )),
    }
}

fn positions(value: &Value) -> Result<Vec<[f64; 3]>, String> {
    items(value)?.iter().map(position).collect()
}

fn position(value: &Value) -> Result<[f64; 3], String> {
    let numbers: Option<Vec<f64>> = items(value)?.iter().map(Value::as_f64).collect();
    match numbers.as_deref() {
        Some(&[x, y]) => Ok([x, y, f64::NAN]),
        Some(&[x, y, z, ..]) => Ok([x, y, z]),
        _ => Err(format!(
            "needed is a position [x, y] or [x, y, z], found {value}"
        )),
    }
}
