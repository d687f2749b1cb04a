//! JSON schema of scenes, made from the types that read them.
//!
//! Doc comments are its descriptions. `x-unit` is the unit of a number, `-` of one without, and `s, m` of rows of two; a number with
//! a unit may also be a text such as "25 mm".

mod units;

use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde_json::{Map, Value, json};

use super::file::SceneFile;
pub(crate) use units::Units;

/// Name of the entry that holds the unit of a number.
pub const UNIT: &str = "x-unit";

/// Schema of scenes.
pub fn of_scenes() -> Value {
    let mut schema = generated::<SceneFile>();
    with_quantities(&mut schema, "");
    if let Some(Value::Object(fields)) = schema.get_mut("properties") {
        let said = "Place of this schema, for editors; a scene in JSON alone has it.";
        let for_editors = json!({"type": "string", "description": said});
        fields.insert("$schema".to_owned(), for_editors);
    }
    titled(schema, "riprap scene")
}

/// Schema of another file of the same dialect, whose numbers are numbers only.
pub fn of<T: JsonSchema>(title: &str) -> Value {
    titled(generated::<T>(), title)
}

/// The schema as the types state it.
fn generated<T: JsonSchema>() -> Value {
    let generator = SchemaSettings::draft2020_12().into_generator();
    generator.into_root_schema_for::<T>().to_value()
}

fn titled(mut schema: Value, title: &str) -> Value {
    if let Value::Object(entries) = &mut schema {
        let title = format!("{title}, version {}", env!("CARGO_PKG_VERSION"));
        entries.insert("title".to_owned(), title.into());
    }
    schema
}

/// Numbers with a unit may also be texts; `unit` is that of the field around them.
fn with_quantities(schema: &mut Value, unit: &str) {
    match schema {
        Value::Object(entries) => {
            let own = entries.get(UNIT).and_then(Value::as_str).map(str::to_owned);
            let unit = own.unwrap_or_else(|| unit.to_owned());
            for (name, entry) in entries.iter_mut() {
                if name != "default" {
                    with_quantities(entry, &unit);
                }
            }
            if !unit.is_empty() && entries.get("format").is_some_and(|f| f == "double") {
                or_text(entries);
            }
        }
        Value::Array(items) => {
            for item in items {
                with_quantities(item, unit);
            }
        }
        _ => {}
    }
}

/// A number, or a text that begins with one and goes on with a unit.
fn or_text(number: &mut Map<String, Value>) {
    let types = match number.get("type") {
        Some(Value::Array(types)) => types.clone(),
        Some(one) => vec![one.clone()],
        None => return,
    };
    let types: Vec<Value> = types.into_iter().chain([json!("string")]).collect();
    number.insert("type".to_owned(), types.into());
    let pattern = r"^\s*[+-]?[0-9._]+([eE][+-]?[0-9]+)?(\s+1/|\s*[^\s0-9.,_+-]).*$";
    number.insert("pattern".to_owned(), pattern.into());
}
