//! Units of fields, from the schema.

use std::collections::BTreeMap;

use serde_json::Value;

use super::{UNIT, generated};
use crate::scene::file::SceneFile;

/// Units of the numbers of scenes by the path of their field in the types: `MaterialFile.density`, `ShapeFile.Box.min`,
/// `SlipFile.Friction`.
pub(crate) struct Units(BTreeMap<String, String>);

impl Units {
    pub(crate) fn of_scenes() -> Self {
        let schema = generated::<SceneFile>();
        let mut units = BTreeMap::new();
        collect("SceneFile", &schema, &mut units);
        let types = schema.get("$defs").and_then(Value::as_object);
        for (name, of_type) in types.into_iter().flatten() {
            collect(name, of_type, &mut units);
        }
        Self(units)
    }

    /// Unit of a field; `item` counts the numbers of a row, which may have different ones.
    pub(crate) fn get(&self, field: &str, item: usize) -> Option<&str> {
        let unit = self.0.get(field)?;
        match unit.contains(',') {
            true => unit.split(", ").nth(item),
            false => Some(unit),
        }
    }
}

/// Units of the fields of a type, and of the variants of an enumeration.
fn collect(owner: &str, schema: &Value, units: &mut BTreeMap<String, String>) {
    let fields = schema.get("properties").and_then(Value::as_object);
    for (field, of_field) in fields.into_iter().flatten() {
        let path = format!("{owner}.{field}");
        // the unit of `Friction(30)` stands beside the one property of its variant
        let unit = of_field.get(UNIT).or_else(|| schema.get(UNIT));
        if let Some(unit) = unit.and_then(Value::as_str) {
            units.insert(path.clone(), unit.to_owned());
        }
        collect(&path, of_field, units);
    }
    let variants = schema.get("oneOf").and_then(Value::as_array);
    for variant in variants.into_iter().flatten() {
        collect(owner, variant, units);
    }
}
