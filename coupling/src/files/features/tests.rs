//! Files written by hand: GeoJSON of RFC 7946, shapefiles of ESRI's description of July 1998.
#![expect(clippy::unwrap_used, reason = "a test may fail")]

use super::*;

fn of(file: &str, text: &str) -> Result<Features, String> {
    features_from(file, text.as_bytes(), None).map_err(|fault| fault.to_string())
}

fn flat(points: &[[f64; 2]]) -> Vec<[f64; 3]> {
    points.iter().map(|&[x, y]| [x, y, f64::NAN]).collect()
}

/// Equality in which no elevation equals no elevation.
fn same(found: &Form, expected: &Form) -> bool {
    format!("{found:?}") == format!("{expected:?}")
}

#[test]
fn geojson_has_points_lines_and_polygons() {
    let text = r#"{"type": "FeatureCollection", "name": "layer",
        "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::25832"}},
        "features": [
            {"type": "Feature", "properties": {"name": "quay"}, "geometry": {"type": "Point", "coordinates": [1, 2.5, 3]}},
            {"type": "Feature", "id": 7, "properties": null, "geometry": {"type": "MultiLineString", "coordinates": [[[0, 0], [1, 1]], [[2, 2], [3, 3]]]}},
            {"type": "Feature", "properties": {}, "geometry": null},
            {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [0, 1], [0, 0]]]}}]}"#;
    let found = of("a.geojson", text).unwrap();
    assert_eq!(found.system.as_deref(), Some("EPSG:25832"));
    let names: Vec<_> = found.list.iter().map(|f| f.name.as_deref()).collect();
    assert_eq!(names, [Some("quay"), Some("7"), Some("7"), None]);
    let expected = [
        Form::Point([1.0, 2.5, 3.0]),
        Form::Line(flat(&[[0.0, 0.0], [1.0, 1.0]])),
        Form::Line(flat(&[[2.0, 2.0], [3.0, 3.0]])),
        Form::Polygon(flat(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]])),
    ];
    for (feature, form) in found.list.iter().zip(&expected) {
        assert!(same(&feature.form, form), "{feature:?}");
    }
    // a bare geometry
    let bare = of("a.json", r#"{"type": "Point", "coordinates": [1, 2]}"#).unwrap();
    assert!(same(&bare.list[0].form, &Form::Point([1.0, 2.0, f64::NAN])));
}

#[test]
fn wrong_files_answer_with_their_place() {
    let feature = |geometry: &str| {
        format!(
            r#"{{"type": "FeatureCollection", "features": [{{"type": "Feature", "geometry": {geometry}}}]}}"#
        )
    };
    for (file, text, expected) in [
        (
            "a.geojson",
            "{\n\"type\": ,}".to_owned(),
            "is not JSON: expected value at line 2 column 9",
        ),
        (
            "a.geojson",
            "{}".to_owned(),
            "is no GeoJSON, found no \"type\"; needed is a FeatureCollection",
        ),
        (
            "a.geojson",
            feature(r#"{"type": "Point", "coordinates": ["1", 2]}"#),
            "feature 1: needed is a position [x, y] or [x, y, z], found [\"1\",2]",
        ),
        (
            "a.geojson",
            feature(r#"{"type": "Polygon", "coordinates": [[[0, 0]], [[1, 1]]]}"#),
            "feature 1: has a polygon of 2 rings; one without holes is needed",
        ),
        (
            "a.geojson",
            feature(r#"{"type": "Curve", "coordinates": []}"#),
            "feature 1: geometry `Curve` is not known; needed is a Point, LineString or Polygon",
        ),
        (
            "a.dbf",
            String::new(),
            "belongs to a shapefile; name its .shp",
        ),
        (
            "a.gpkg",
            String::new(),
            "is not read; export GeoJSON in the system of the terrain: ogr2ogr -t_srs EPSG:... out.geojson",
        ),
        (
            "a.csv",
            "x,y\n1,b\n".to_owned(),
            "line 2: y is `b`, needed is a number",
        ),
    ] {
        assert_eq!(of(file, &text).unwrap_err(), expected);
    }
    let refused = features_from("a.shp", b"PK\x03\x04", None).unwrap_err();
    assert!(
        refused
            .to_string()
            .starts_with("is not a readable shapefile")
    );
}

/// A shapefile of one type from the contents of its records.
fn shapefile(kind: i32, records: &[Vec<u8>]) -> Vec<u8> {
    let length = 100 + records.iter().map(|r| 8 + r.len()).sum::<usize>();
    let mut file = 9994_i32.to_be_bytes().to_vec();
    file.extend([0; 20]);
    // lengths are in words of two bytes
    file.extend((length as i32 / 2).to_be_bytes());
    file.extend(1000_i32.to_le_bytes());
    file.extend(kind.to_le_bytes());
    file.extend([0.0_f64; 8].iter().flat_map(|x| x.to_le_bytes()));
    for (number, content) in (1_i32..).zip(records) {
        file.extend(number.to_be_bytes());
        file.extend((content.len() as i32 / 2).to_be_bytes());
        file.extend(content);
    }
    file
}

fn point(x: f64, y: f64) -> Vec<u8> {
    [1_i32.to_le_bytes().to_vec(), numbers(&[x, y])].concat()
}

fn numbers(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// A polyline (3) or polygon (5) of parts.
fn parts(kind: i32, parts: &[&[[f64; 2]]]) -> Vec<u8> {
    let n: usize = parts.iter().map(|part| part.len()).sum();
    let mut content = kind.to_le_bytes().to_vec();
    content.extend(numbers(&[0.0; 4]));
    content.extend((parts.len() as i32).to_le_bytes());
    content.extend((n as i32).to_le_bytes());
    let mut first = 0;
    for part in parts {
        content.extend((first as i32).to_le_bytes());
        first += part.len();
    }
    content.extend(numbers(parts.concat().as_flattened()));
    content
}

/// dBase III with one text field of eight characters.
fn attributes(field: &str, values: &[&str]) -> Vec<u8> {
    let mut file = vec![3, 126, 11, 24];
    file.extend((values.len() as u32).to_le_bytes());
    file.extend((32_u16 + 32 + 1).to_le_bytes());
    file.extend(9_u16.to_le_bytes());
    file.extend([0; 20]);
    let mut name = field.as_bytes().to_vec();
    name.resize(11, 0);
    file.extend(name);
    file.extend(b"C\0\0\0\0\x08\0");
    file.extend([0; 14]);
    file.push(b'\r');
    for value in values {
        file.extend(format!(" {value:8}").as_bytes());
    }
    file.push(0x1a);
    file
}

#[test]
fn shapefiles_have_points_with_names() {
    let shapes = shapefile(1, &[point(1.0, 2.0), point(412_100.5, 6_904_200.25)]);
    let names = attributes("NAME", &["quay", "pier"]);
    let found = features_from("a.shp", &shapes, Some(&names)).unwrap();
    let list: Vec<_> = found.list.iter().map(|f| f.name.as_deref()).collect();
    assert_eq!(list, [Some("quay"), Some("pier")]);
    let expected = Form::Point([412_100.5, 6_904_200.25, f64::NAN]);
    assert!(same(&found.list[1].form, &expected));
    let unnamed = features_from("a.shp", &shapes, None).unwrap();
    assert_eq!(unnamed.list[0].name, None);
}

#[test]
fn shapefiles_have_lines_and_polygons() {
    // outer rings are clockwise
    let ring = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
    let polygon = shapefile(5, &[parts(5, &[&ring])]);
    let found = features_from("a.shp", &polygon, None).unwrap();
    assert!(same(&found.list[0].form, &Form::Polygon(flat(&ring))));
    let hole = [[0.2, 0.2], [0.8, 0.2], [0.8, 0.8], [0.2, 0.2]];
    let holed = shapefile(5, &[parts(5, &[&ring, &hole])]);
    let refused = features_from("a.shp", &holed, None)
        .unwrap_err()
        .to_string();
    assert_eq!(
        refused,
        "shape 1: has a polygon with a hole; one without is needed"
    );
    let lines = shapefile(3, &[parts(3, &[&ring[..2], &ring[2..4]])]);
    let found = features_from("a.shp", &lines, None).unwrap();
    assert!(same(&found.list[1].form, &Form::Line(flat(&ring[2..4]))));
}

/// A file that is cut off or corrupted is refused or read in part, without a panic.
#[test]
fn damaged_shapefiles_do_no_harm() {
    let ring = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.0, 0.0]];
    let whole = shapefile(5, &[parts(5, &[&ring]), parts(5, &[&ring])]);
    let names = attributes("id", &["a", "b"]);
    for k in 0..whole.len() {
        let _ = features_from("a.shp", &whole[..k], Some(&names));
        let mut flipped = whole.clone();
        flipped[k] ^= 0xff;
        let _ = features_from("a.shp", &flipped, Some(&names[..k % names.len()]));
    }
    for k in 0..names.len() {
        let mut flipped = names.clone();
        flipped[k] ^= 0xff;
        let _ = features_from("a.shp", &whole, Some(&flipped));
    }
}
