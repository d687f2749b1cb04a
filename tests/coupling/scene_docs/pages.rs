//! Pages of the scene reference, one a type, from the schema.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use riprap::files::units::table::KINDS;
use riprap::scene::schema;
use serde_json::Value;

use super::examples::EXAMPLES;

const HEAD: &str = "<!-- Generated from the schema of scenes; edit the comments of coupling/src/scene/file instead. -->\n\n";

/// Name of the page of a type.
fn page(of_type: &str) -> String {
    let name = of_type.strip_suffix("File").unwrap_or(of_type);
    let mut page = String::new();
    for c in name.chars() {
        if c.is_uppercase() && !page.is_empty() {
            page.push('-');
        }
        page.extend(c.to_lowercase());
    }
    page + ".md"
}

/// Names and texts of all pages; `order` is that of the fields in the source.
pub fn of_scenes(order: &[String]) -> BTreeMap<String, String> {
    let schema = schema::of_scenes();
    let mut types = vec!["SceneFile"];
    for field in order {
        let owner = field.split('.').next().unwrap();
        if !types.contains(&owner) {
            types.push(owner);
        }
    }
    let defined = schema["$defs"].as_object().unwrap();
    assert_eq!(
        types.len(),
        defined.len() + 1,
        "a type of the source is not in the schema"
    );
    let mut pages: BTreeMap<String, String> = types
        .iter()
        .map(|name| {
            let of_type = defined.get(*name).unwrap_or(&schema);
            (
                page(name),
                Page {
                    schema: &schema,
                    order,
                    name,
                }
                .text(of_type),
            )
        })
        .collect();
    pages.insert("index.md".to_owned(), index(&schema, &types));
    pages
}

fn index(schema: &Value, types: &[&str]) -> String {
    let mut text = format!(
        "{HEAD}(scene-reference)=\n# Scene reference\n\n\
         A scene is one file in RON, JSON or YAML. Its outermost type is [`SceneFile`](scene.md). Numbers are in the unit of their \
         field; a number with a unit is written as a text, `\"25 mm\"`, see [units](../units.md). Unknown fields are rejected. \
         `riprap schema` prints all of this as a JSON schema, with which editors complete and check scenes: `riprap schema > scene.schema.json`, \
         then `\"$schema\": \"scene.schema.json\"` in a scene in JSON, or `# yaml-language-server: $schema=scene.schema.json` above one in YAML.\n\n\
         In JSON and YAML a kind with a value or fields is an object of one entry: `Spacing(0.1)` is `{{\"Spacing\": 0.1}}`, \
         `Box(min: (0, 0, 0), max: (1, 1, 1))` is `{{\"Box\": {{\"min\": [0, 0, 0], \"max\": [1, 1, 1]}}}}`, `Fixed` is `\"Fixed\"`.\n\n\
         | type | content |\n|---|---|\n"
    );
    for name in types {
        let of_type = schema["$defs"].get(*name).unwrap_or(schema);
        let said = described(of_type);
        let first = said.split(". ").next().unwrap().trim_end_matches('.');
        writeln!(text, "| [`{name}`]({}) | {} |", page(name), cell(first)).unwrap();
    }
    text + "\n```{toctree}\n:hidden:\n:glob:\n\n*\n```\n"
}

struct Page<'a> {
    schema: &'a Value,
    order: &'a [String],
    name: &'a str,
}

impl Page<'_> {
    fn text(&self, of_type: &Value) -> String {
        let name = self.name;
        let said = match name {
            "SceneFile" => "A complete scene.".to_owned(),
            _ => described(of_type),
        };
        assert!(!said.is_empty(), "{name} is not described");
        let mut text = format!("{HEAD}(scene-{name})=\n# `{name}`\n\n{said}\n\n");
        let users = self.users();
        if !users.is_empty() {
            writeln!(text, "Of {}.\n", users.join(", ")).unwrap();
        }
        match of_type.get("properties") {
            Some(_) => self.fields(&mut text, "", of_type),
            None => self.kinds(&mut text, of_type),
        }
        let example = EXAMPLES.iter().find(|(of, ..)| *of == name);
        let (_, example, _) = example.unwrap_or_else(|| panic!("no example of {name}"));
        writeln!(text, "\n## Example\n\n```ron\n{}\n```", example.trim()).unwrap();
        text
    }

    /// Types with fields of this one, as links.
    fn users(&self) -> Vec<String> {
        let target = format!("\"#/$defs/{}\"", self.name);
        let defined = self.schema["$defs"].as_object().unwrap();
        let scene = self.schema["properties"].to_string().contains(&target);
        let of = |name: &str| format!("[`{name}`]({})", page(name));
        let others = defined
            .iter()
            .filter(|(name, of_type)| *name != self.name && of_type.to_string().contains(&target));
        let scene = scene.then(|| of("SceneFile"));
        scene
            .into_iter()
            .chain(others.map(|(name, _)| of(name)))
            .collect()
    }

    /// The table of fields of a structure or of a kind, whose names begin with `prefix`.
    fn fields(&self, text: &mut String, prefix: &str, of_type: &Value) {
        writeln!(
            text,
            "| field | type | unit | default | allowed | meaning |"
        )
        .unwrap();
        writeln!(text, "|---|---|---|---|---|---|").unwrap();
        self.rows(text, prefix, of_type);
    }

    fn rows(&self, text: &mut String, prefix: &str, of_type: &Value) {
        let fields = of_type["properties"].as_object().unwrap();
        let rank = |field: &str| {
            let path = format!("{}.{prefix}{field}", self.name);
            let found = self.order.iter().position(|one| *one == path);
            found.unwrap_or_else(|| panic!("{path} is not in the source"))
        };
        // `$schema` is for editors
        let mut names: Vec<&String> = fields
            .keys()
            .filter(|name| !name.starts_with('$'))
            .collect();
        names.sort_by_key(|name| rank(name));
        let required = of_type["required"].as_array().cloned().unwrap_or_default();
        for name in names {
            let field = &fields[name];
            let said = described(field);
            assert!(
                !said.is_empty(),
                "{}.{prefix}{name} is not described",
                self.name
            );
            let default = match field.get("default") {
                _ if required.contains(&Value::from(name.as_str())) => "required".to_owned(),
                None | Some(Value::Null) => "left out".to_owned(),
                Some(value) => format!("`{}`", as_ron(value)),
            };
            writeln!(
                text,
                "| `{prefix}{name}` | {} | {} | {default} | {} | {} |",
                type_of(field),
                unit_of(field),
                range_of(field),
                cell(&said)
            )
            .unwrap();
        }
    }

    fn kinds(&self, text: &mut String, of_type: &Value) {
        writeln!(
            text,
            "| kind or field | type | unit | default | allowed | meaning |"
        )
        .unwrap();
        writeln!(text, "|---|---|---|---|---|---|").unwrap();
        let mut variants: Vec<(String, &Value)> = Vec::new();
        let one_of = of_type["oneOf"].as_array();
        for variant in one_of.unwrap_or_else(|| panic!("{} has no kinds", self.name)) {
            match variant["properties"].as_object() {
                Some(kinds) => variants.extend(kinds.keys().map(|kind| (kind.clone(), variant))),
                None => {
                    let name = variant["const"].as_str();
                    let name = name.unwrap_or_else(|| panic!("{} {variant}", self.name));
                    variants.push((name.to_owned(), variant));
                }
            }
        }
        let rank = |kind: &str| {
            let path = format!("{}.{kind}", self.name);
            let found = self.order.iter().position(|one| *one == path);
            found.unwrap_or_else(|| panic!("{path} is not in the source"))
        };
        variants.sort_by_key(|(kind, _)| rank(kind));
        for (kind, variant) in variants {
            let said = described(variant);
            assert!(!said.is_empty(), "{}.{kind} is not described", self.name);
            let value = &variant["properties"][&kind];
            let of = match value {
                Value::Null => "word".to_owned(),
                _ if value.get("properties").is_some() => "fields".to_owned(),
                _ => type_of(value),
            };
            writeln!(
                text,
                "| `{kind}` | {of} | {} | | | {} |",
                unit_of(variant),
                cell(&said)
            )
            .unwrap();
            if value.get("properties").is_some() {
                self.rows(text, &format!("{kind}."), value);
            }
        }
    }
}

/// The description on one line.
fn described(schema: &Value) -> String {
    let text = schema["description"].as_str().unwrap_or_default();
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

fn unit_of(schema: &Value) -> String {
    match schema["x-unit"].as_str() {
        Some("-") | None => "–".to_owned(),
        Some(unit) => unit.to_owned(),
    }
}

fn range_of(schema: &Value) -> String {
    let limit = |name: &str| schema.get(name).map(ToString::to_string);
    let low = limit("minimum").map(|low| format!("≥ {low}"));
    let low = low.or(limit("exclusiveMinimum").map(|low| format!("> {low}")));
    let high = limit("maximum").map(|high| format!("≤ {high}"));
    let high = high.or(limit("exclusiveMaximum").map(|high| format!("< {high}")));
    let both: Vec<String> = low.into_iter().chain(high).collect();
    both.join(", ")
}

fn type_of(schema: &Value) -> String {
    if let Some(target) = schema["$ref"].as_str() {
        let name = target.rsplit('/').next().unwrap();
        return format!("[`{name}`]({})", page(name));
    }
    for choice in ["anyOf", "oneOf", "allOf"] {
        if let Some(branches) = schema[choice].as_array() {
            let branches = branches.iter().filter(|branch| branch["type"] != "null");
            return branches.map(type_of).collect::<Vec<_>>().join(" or ");
        }
    }
    let types = match &schema["type"] {
        Value::Array(types) => types.clone(),
        one => vec![one.clone()],
    };
    let has = |name: &str| types.iter().any(|one| one == name);
    if let Some(items) = schema["prefixItems"].as_array() {
        let all: Vec<String> = items.iter().map(type_of).collect();
        return format!("({})", all.join(", "));
    }
    if has("array") {
        return format!("list of {}", type_of(&schema["items"]));
    }
    let name = [
        ("number", "number"),
        ("integer", "whole number"),
        ("boolean", "true or false"),
        ("string", "text"),
    ];
    let found = name.iter().find(|(one, _)| has(one));
    found
        .unwrap_or_else(|| panic!("no type: {schema}"))
        .1
        .to_owned()
}

/// A default as it is written in RON.
fn as_ron(value: &Value) -> String {
    match value {
        Value::Array(items) if items.iter().all(Value::is_number) && !items.is_empty() => {
            format!(
                "({})",
                items.iter().map(as_ron).collect::<Vec<_>>().join(", ")
            )
        }
        Value::Array(items) => {
            format!(
                "[{}]",
                items.iter().map(as_ron).collect::<Vec<_>>().join(", ")
            )
        }
        Value::Number(number) => {
            let number = number.to_string();
            number.strip_suffix(".0").unwrap_or(&number).to_owned()
        }
        Value::String(word) if word.starts_with(|c: char| c.is_uppercase()) => word.clone(),
        Value::Object(fields) => match fields.iter().next() {
            Some((kind, value)) if fields.len() == 1 && kind.starts_with(char::is_uppercase) => {
                format!("{kind}({})", as_ron(value))
            }
            _ => "()".to_owned(),
        },
        other => other.to_string(),
    }
}

/// The page of units.
pub fn of_units() -> String {
    let mut text = "<!-- Generated from coupling/src/files/units/table.rs. -->\n\n\
        (units)=\n# Units\n\n\
        A plain number is in the unit of its field, as the scene reference states it. A text with a number and a unit is converted: \
        `density: \"2.65 t/m3\"`, `spacing: \"25 mm\"`, `time: (duration: \"1 h\")`, in YAML without the quotes. In `--set` quotes may \
        be left out, too: `--set time.duration=\"1 h\"`. Where a unit is a power of ten away, the number is the same to the bit: \
        `\"25 mm\"` is 0.025.\n\n\
        | quantity | unit of plain numbers | units to choose from |\n|---|---|---|\n"
        .to_owned();
    for kind in KINDS {
        let unit = if kind.unit == "-" { "–" } else { kind.unit };
        let examples: Vec<String> = kind.examples.iter().map(|one| format!("`{one}`")).collect();
        writeln!(text, "| {} | {unit} | {} |", kind.name, examples.join(", ")).unwrap();
    }
    text + "\nAny other combination of the right dimension is read as well, such as `kg/dm3`, `kN s/mm` or `m s-2`: factors between \
        spaces, `*` or `·`, powers as `m3`, `m^3` or `m³`, and `/` for what follows up to the next one. A unit of another dimension \
        is rejected with what it is and what would be right.\n"
}
