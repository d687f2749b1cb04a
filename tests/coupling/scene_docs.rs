//! `cases/README.md` documents every field of scenes, `benches/trade/README.md` every field of studies, and nothing else.

use std::collections::BTreeSet;
use std::path::Path;

/// Source of the schema: `scene/file.rs` and what is in the folder of that name.
fn schema_source() -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/scene/file");
    let parts = std::fs::read_dir(&root)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    std::iter::once(root.with_extension("rs"))
        .chain(parts)
        .map(|path| std::fs::read_to_string(path).unwrap())
        .collect()
}

/// Source of the schema of studies.
fn study_source() -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/study/trade");
    ["file.rs", "quantity.rs"]
        .map(|name| std::fs::read_to_string(root.join(name)).unwrap())
        .concat()
}

/// Fields of a schema as `Struct.field`, read from its source: what the derive sees.
fn schema_fields(source: &str) -> BTreeSet<String> {
    let mut fields = BTreeSet::new();
    let (mut owner, mut variant) = (None::<String>, None::<String>);
    for line in source.lines() {
        let text = line.trim();
        let indent = line.len() - line.trim_start().len();
        if let Some(name) = text
            .strip_prefix("pub struct ")
            .or(text.strip_prefix("pub enum "))
        {
            owner = Some(name.trim_end_matches(" {").to_owned());
            variant = None;
        } else if line == "}" {
            owner = None;
        } else if let Some(owner) = &owner {
            if let Some(field) = text
                .strip_prefix("pub ")
                .and_then(|rest| rest.split_once(": "))
            {
                // a field with the name of a word of Rust
                let name = field.0.trim_start_matches("r#");
                fields.insert(format!("{owner}.{name}"));
            } else if indent == 4 && text.chars().next().is_some_and(char::is_uppercase) {
                let name: String = text.chars().take_while(|c| c.is_alphanumeric()).collect();
                fields.insert(format!("{owner}.{name}"));
                variant = text.ends_with('{').then_some(name);
            } else if let (Some(variant), 8) = (&variant, indent)
                && let Some((field, _)) = text.split_once(": ")
                && field.chars().all(|c| c.is_lowercase() || c == '_')
            {
                fields.insert(format!("{owner}.{variant}.{field}"));
            }
        }
    }
    fields
}

/// First cells of the tables, under headings that name the struct: "### `DomainFile` ...".
fn documented_fields(file: &str) -> BTreeSet<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(file);
    let text = std::fs::read_to_string(path).unwrap();
    let mut fields = BTreeSet::new();
    let mut owner = String::new();
    for line in text.lines() {
        if let Some(heading) = line.strip_prefix("### ") {
            owner = heading.split('`').nth(1).unwrap_or_default().to_owned();
        } else if let Some(cell) = line.strip_prefix("| `")
            && !owner.is_empty()
        {
            fields.insert(format!("{owner}.{}", cell.split('`').next().unwrap()));
        }
    }
    fields
}

#[test]
fn the_tables_and_the_schemas_are_the_same() {
    for (source, file, least) in [
        (schema_source(), "cases/README.md", 80),
        (study_source(), "benches/trade/README.md", 40),
    ] {
        let (schema, documented) = (schema_fields(&source), documented_fields(file));
        assert!(
            schema.len() > least,
            "the reader of the schema lost its way: {schema:?}"
        );
        let missing: Vec<_> = schema.difference(&documented).collect();
        let invented: Vec<_> = documented.difference(&schema).collect();
        assert!(missing.is_empty(), "{file} lacks {missing:#?}");
        assert!(
            invented.is_empty(),
            "{file} has what the schema lacks: {invented:#?}"
        );
    }
}

#[test]
fn a_scene_written_out_reads_back_the_same() {
    for name in ["sliding_wedge", "impacting_block", "wavemaker"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../cases/{name}.ron"));
        let scene = riprap::scene::parse::read(&std::fs::read_to_string(path).unwrap()).unwrap();
        let text = riprap::scene::parse::write(&scene).unwrap();
        assert_eq!(riprap::scene::parse::read(&text).unwrap(), scene);
    }
}

#[test]
fn a_renamed_variant_is_read_under_both_names() {
    use riprap::scene::file::OutOfDomainFile::{self, Fail, Remove};
    for (name, variant) in [
        ("Removed", Remove),
        ("Remove", Remove),
        ("Error", Fail),
        ("Fail", Fail),
    ] {
        assert_eq!(ron::from_str::<OutOfDomainFile>(name), Ok(variant));
    }
}
