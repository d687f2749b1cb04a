//! The JSON schema of scenes and studies: valid scenes are valid, wrong ones are not, and every number has its unit.

pub(crate) mod validator;

use std::path::Path;
use std::process::Command;

use riprap::files::units;
use riprap::scene::parse;
use riprap::scene::schema;
use riprap::trade::file::StudyFile;
use serde_json::{Value, json};

use crate::languages::{JSON, cases};
use crate::support::{riprap, words};
use validator::faults;

fn as_json(path: &Path) -> Value {
    let text = std::fs::read_to_string(path).unwrap();
    serde_json::to_value(parse::read(&text).unwrap()).unwrap()
}

#[test]
fn every_case_is_valid() {
    let schema = schema::of_scenes();
    for path in cases() {
        let found = faults(&schema, &as_json(&path));
        assert!(found.is_empty(), "{path:?}: {found:#?}");
    }
    let found = faults(&schema, &serde_json::from_str(JSON).unwrap());
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn wrong_scenes_are_not_valid() {
    let schema = schema::of_scenes();
    let right: Value = serde_json::from_str(JSON).unwrap();
    for (path, value, is_right) in [
        ("/materials/0/density", json!("2.65 t/m3"), true),
        ("/materials/0/cohesion", json!(1e6), true),
        ("/domain/max/2", json!("2 m"), true),
        ("/fluid/resolution", json!({"Spacing": "10 cm"}), true),
        ("/interface", json!({"slip": {"Friction": "20 deg"}}), true),
        ("/interface", json!({"slip": {"Rough": "2 mm"}}), true),
        ("/camera", json!(null), true),
        ("/materials/0/densty", json!(2650), false),
        ("/materials/0/density", json!(true), false),
        ("/materials/0/density", json!(-2650), false),
        ("/materials/0/density", json!("heavy"), false),
        ("/materials/0/density", json!(null), false),
        ("/materials/0/friction_angle_deg", json!(90), false),
        ("/blocks/0/motion", json!("Fixd"), false),
        ("/blocks/0/shape", json!({"Box": {"min": [0, 0, 0]}}), false),
        (
            "/blocks/0/shape",
            json!({"Box": {"min": [0, 0, 0], "max": [1, 1]}}),
            false,
        ),
        ("/fluid/resolution", json!(0.1), false),
        (
            "/fluid/resolution",
            json!({"Spacing": 0.1, "Count": 9}),
            false,
        ),
        ("/fluid/resolution", json!({"Count": 9.5}), false),
        ("/time", json!({}), false),
        ("/time", json!({"duration": 0}), false),
        ("/title", json!(7), false),
        ("/durations", json!(7), false),
    ] {
        let (parent, field) = path.rsplit_once('/').unwrap();
        let mut scene = right.clone();
        match scene.pointer_mut(parent).unwrap() {
            Value::Object(fields) => drop(fields.insert(field.to_owned(), value.clone())),
            Value::Array(items) => items[field.parse::<usize>().unwrap()] = value.clone(),
            other => panic!("{other}"),
        }
        let found = faults(&schema, &scene);
        assert_eq!(found.is_empty(), is_right, "{path} {value}: {found:?}");
    }
}

/// The same question to an implementation by other hands, where Python has one; RIPRAP_REQUIRE_JSONSCHEMA=1 makes its absence
/// a failure.
#[test]
fn another_validator_agrees() {
    let has = Command::new("python3")
        .args(["-c", "import jsonschema"])
        .output();
    if !has.is_ok_and(|output| output.status.success()) {
        let is_required =
            std::env::var("RIPRAP_REQUIRE_JSONSCHEMA").is_ok_and(|value| value == "1");
        assert!(
            !is_required,
            "no jsonschema, and RIPRAP_REQUIRE_JSONSCHEMA=1"
        );
        println!("python3 has no jsonschema: not asked");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("schema.json"), schema::of_scenes().to_string()).unwrap();
    let scenes: Vec<Value> = cases().iter().map(|path| as_json(path)).collect();
    std::fs::write(at("scenes.json"), Value::from(scenes).to_string()).unwrap();
    let program = "import json\n\
        from jsonschema import Draft202012Validator as V\n\
        s = json.load(open('schema.json')); V.check_schema(s); v = V(s)\n\
        scenes = json.load(open('scenes.json'))\n\
        for scene in scenes:\n    v.validate(scene)\n\
        scenes[0]['densty'] = 1\n\
        assert not v.is_valid(scenes[0])\n\
        print(len(scenes), 'valid')\n";
    let output = Command::new("python3")
        .args(["-c", program])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", words(&output));
}

/// Fields with numbers, their unit and their description: those of structures, and kinds with a number alone.
fn numbers(schema: &Value) -> Vec<(String, Option<String>, String)> {
    let mut found = Vec::new();
    collect("SceneFile", schema, schema, &mut found);
    for (name, of_type) in schema["$defs"].as_object().unwrap() {
        collect(name, of_type, of_type, &mut found);
    }
    found
}

fn collect(
    path: &str,
    schema: &Value,
    described: &Value,
    found: &mut Vec<(String, Option<String>, String)>,
) {
    let fields = schema["properties"].as_object().into_iter().flatten();
    for (name, field) in fields {
        let path = format!("{path}.{name}");
        if field.get("properties").is_some() {
            collect(&path, field, field, found);
            continue;
        }
        // the unit of `Friction(30)` stands with its kind
        let of = if field.get("description").is_some() {
            field
        } else {
            described
        };
        if has_double(field) {
            let unit = of["x-unit"].as_str().map(str::to_owned);
            let description = of["description"].as_str().unwrap_or_default();
            let description = description.split_whitespace().collect::<Vec<_>>().join(" ");
            found.push((path, unit, description));
        }
    }
    for variant in schema["oneOf"].as_array().into_iter().flatten() {
        collect(path, variant, variant, found);
    }
}

fn has_double(schema: &Value) -> bool {
    match schema {
        Value::Object(entries) => {
            schema["format"] == "double"
                || entries
                    .iter()
                    .any(|(name, entry)| name != "default" && has_double(entry))
        }
        Value::Array(items) => items.iter().any(has_double),
        _ => false,
    }
}

/// Every number has a unit that texts can be converted to, and its description ends with it.
#[test]
fn every_number_states_its_unit() {
    let found = numbers(&schema::of_scenes());
    assert!(found.len() > 190, "{}", found.len());
    for (path, unit, description) in found {
        let unit = unit.unwrap_or_else(|| panic!("{path} states no unit"));
        let is_known = |one: &str| {
            // of a power that another field gives
            one == "Pa sⁿ" || units::table::KINDS.iter().any(|kind| kind.unit == one)
        };
        assert!(unit.split(", ").all(is_known), "{path}: {unit}");
        let states = |unit: &str| {
            let ends = [".", ",", ""].map(|end| format!("; {unit}{end}"));
            description.contains(&ends[0])
                || description.contains(&ends[1])
                || description.ends_with(&ends[2])
        };
        if unit == "-" {
            let others = units::table::KINDS.iter().filter(|kind| kind.unit != "-");
            let stated: Vec<_> = others.filter(|kind| states(kind.unit)).collect();
            assert!(
                stated.is_empty(),
                "{path} is described with {stated:?}: {description}"
            );
        } else {
            assert!(
                states(&unit),
                "{path} is not described in {unit}: {description}"
            );
        }
    }
}

#[test]
fn the_program_prints_both_schemas() {
    let output = riprap(&["schema"]);
    assert!(output.status.success(), "{}", words(&output));
    let scenes: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(scenes, schema::of_scenes());
    assert_eq!(
        scenes["$schema"],
        "https://json-schema.org/draft/2020-12/schema"
    );
    let output = riprap(&["schema", "--studies"]);
    let studies: Value = serde_json::from_slice(&output.stdout).unwrap();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../benches/trade");
    let mut n_studies = 0;
    for entry in folder.read_dir().unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "ron") {
            let text = std::fs::read_to_string(&path).unwrap();
            let study: StudyFile = parse::read_as(&text).unwrap();
            let found = faults(&studies, &serde_json::to_value(study).unwrap());
            assert!(found.is_empty(), "{path:?}: {found:#?}");
            n_studies += 1;
        }
    }
    assert!(n_studies > 5, "{n_studies}");
    assert!(!faults(&studies, &json!({"title": "none"})).is_empty());
}
