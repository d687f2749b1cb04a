//! As much of JSON Schema 2020-12 as the schemas use, by the standard alone. A keyword that is not known here is an error.

use serde_json::{Map, Value};

/// Keywords that say nothing about validity.
const ANNOTATIONS: &[&str] = &[
    "$schema",
    "$defs",
    "title",
    "description",
    "default",
    "format",
    "x-unit",
];

/// Faults of a value, each with its path.
pub fn faults(root: &Value, value: &Value) -> Vec<String> {
    let mut faults = Vec::new();
    check(root, root, value, "", &mut faults);
    faults
}

/// Faults of a value of one of the types that a schema defines.
pub fn faults_of(root: &Value, of_type: &str, value: &Value) -> Vec<String> {
    let mut faults = Vec::new();
    let schema = root.pointer(&format!("/$defs/{of_type}"));
    let schema = schema.unwrap_or_else(|| panic!("no type {of_type}"));
    check(root, schema, value, "", &mut faults);
    faults
}

fn check(root: &Value, schema: &Value, value: &Value, path: &str, faults: &mut Vec<String>) {
    let entries = match schema {
        Value::Bool(true) => return,
        Value::Object(entries) => entries,
        _ => return faults.push(format!("{path}: nothing is allowed here")),
    };
    for (keyword, entry) in entries {
        let valid = match keyword.as_str() {
            "$ref" => {
                let pointer = entry.as_str().unwrap().trim_start_matches('#');
                let target = root
                    .pointer(pointer)
                    .unwrap_or_else(|| panic!("no {pointer}"));
                check(root, target, value, path, faults);
                true
            }
            "oneOf" | "anyOf" => {
                let branches = entry.as_array().unwrap().iter();
                let n_valid = branches.filter(|one| is_valid(root, one, value)).count();
                n_valid == 1 || keyword == "anyOf" && n_valid > 1
            }
            "allOf" => entry
                .as_array()
                .unwrap()
                .iter()
                .all(|one| is_valid(root, one, value)),
            "type" => match entry {
                Value::Array(types) => types.iter().any(|one| is_of_type(one, value)),
                one => is_of_type(one, value),
            },
            "const" => entry == value,
            "enum" => entry.as_array().unwrap().contains(value),
            "minimum" | "maximum" | "exclusiveMinimum" | "exclusiveMaximum" => {
                is_in_range(keyword, entry.as_f64().unwrap(), value)
            }
            "pattern" => value.as_str().is_none_or(begins_with_a_number),
            "minItems" => value
                .as_array()
                .is_none_or(|v| entry.as_u64() <= Some(v.len() as u64)),
            "maxItems" => value
                .as_array()
                .is_none_or(|v| Some(v.len() as u64) <= entry.as_u64()),
            "required" => value.as_object().is_none_or(|fields| {
                let names = entry.as_array().unwrap().iter();
                names
                    .map(|name| name.as_str().unwrap())
                    .all(|name| fields.contains_key(name))
            }),
            "properties" | "additionalProperties" | "items" | "prefixItems" => true,
            known => {
                assert!(ANNOTATIONS.contains(&known), "keyword {known}");
                true
            }
        };
        if !valid {
            faults.push(format!("{path}: {value} is not as {keyword} says: {entry}"));
        }
    }
    children(root, entries, value, path, faults);
}

fn children(
    root: &Value,
    entries: &Map<String, Value>,
    value: &Value,
    path: &str,
    faults: &mut Vec<String>,
) {
    if let Value::Object(fields) = value {
        let known = entries.get("properties");
        for (name, field) in fields {
            let schema = known.and_then(|known| known.get(name));
            let others = entries.get("additionalProperties");
            if let Some(schema) = schema.or(others) {
                check(root, schema, field, &format!("{path}.{name}"), faults);
            }
        }
    }
    if let Value::Array(items) = value {
        let first = entries.get("prefixItems").and_then(Value::as_array);
        for (k, item) in items.iter().enumerate() {
            let schema = first
                .and_then(|first| first.get(k))
                .or(entries.get("items"));
            if let Some(schema) = schema {
                check(root, schema, item, &format!("{path}[{k}]"), faults);
            }
        }
    }
}

fn is_valid(root: &Value, schema: &Value, value: &Value) -> bool {
    let mut faults = Vec::new();
    check(root, schema, value, "", &mut faults);
    faults.is_empty()
}

fn is_of_type(name: &Value, value: &Value) -> bool {
    match name.as_str().unwrap() {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.as_f64().is_some_and(|number| number.fract() == 0.0),
        "string" => value.is_string(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        other => panic!("type {other}"),
    }
}

fn is_in_range(keyword: &str, limit: f64, value: &Value) -> bool {
    value.as_f64().is_none_or(|number| match keyword {
        "minimum" => limit <= number,
        "maximum" => number <= limit,
        "exclusiveMinimum" => limit < number,
        _ => number < limit,
    })
}

/// The only pattern of the schemas: a number and a unit behind it.
fn begins_with_a_number(text: &str) -> bool {
    let text = text.trim_start();
    let number = text.trim_start_matches(|c: char| c.is_ascii_digit() || "+-._eE".contains(c));
    let unit = number.trim_start();
    number.len() < text.len()
        && (unit.starts_with("1/") || unit.starts_with(|c: char| !c.is_ascii_digit() && c != ','))
}
