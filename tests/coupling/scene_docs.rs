//! `docs/reference/scene` documents every field of scenes, `benches/trade/README.md` of studies, `docs/reference/sweeps.md` of sweeps,
//! and nothing else.
//!
//! The pages of scenes are generated from the schema: `RIPRAP_UPDATE=1 cargo test --release --test coupling scene_docs` writes them.

mod examples;
mod pages;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Source of the schema: `scene/file.rs` and what is in the folder of that name.
fn schema_source() -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/scene/file");
    let mut parts: Vec<PathBuf> = std::fs::read_dir(&root)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    parts.sort();
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

/// Source of the schema of sweeps.
fn sweep_source() -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/study/sweep");
    std::fs::read_to_string(root.join("file.rs")).unwrap()
}

/// Fields of a schema as `Struct.field`, read from its source in its order: what the derive sees.
fn fields_in_order(source: &str) -> Vec<String> {
    let mut fields = Vec::new();
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
                fields.push(format!("{owner}.{name}"));
            } else if indent == 4 && text.chars().next().is_some_and(char::is_uppercase) {
                let name: String = text.chars().take_while(|c| c.is_alphanumeric()).collect();
                fields.push(format!("{owner}.{name}"));
                variant = text.ends_with('{').then_some(name);
            } else if let (Some(variant), 8) = (&variant, indent)
                && let Some((field, _)) = text.split_once(": ")
                && field.chars().all(|c| c.is_lowercase() || c == '_')
            {
                fields.push(format!("{owner}.{variant}.{field}"));
            }
        }
    }
    fields
}

/// A file or folder of the repository.
fn at(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

/// First cells of the tables, under headings that name the struct: "### `DomainFile` ..." or "# `DomainFile`".
fn documented_fields(text: &str) -> BTreeSet<String> {
    let mut fields = BTreeSet::new();
    let mut owner = String::new();
    for line in text.lines() {
        if let Some(heading) = line.strip_prefix("### ").or(line.strip_prefix("# ")) {
            owner = heading.split('`').nth(1).unwrap_or_default().to_owned();
        } else if let Some(cell) = line.strip_prefix("| `")
            && !owner.is_empty()
        {
            fields.insert(format!("{owner}.{}", cell.split('`').next().unwrap()));
        }
    }
    fields
}

/// The committed pages of scenes, one after the other.
fn pages_of_scenes() -> String {
    let entries = at("docs/reference/scene").read_dir().unwrap();
    entries
        .map(|entry| std::fs::read_to_string(entry.unwrap().path()).unwrap())
        .collect()
}

#[test]
fn the_tables_and_the_schemas_are_the_same() {
    if std::env::var_os("RIPRAP_UPDATE").is_some() {
        return;
    }
    let studies = std::fs::read_to_string(at("benches/trade/README.md")).unwrap();
    let sweeps = std::fs::read_to_string(at("docs/reference/sweeps.md")).unwrap();
    for (source, file, text, least) in [
        (
            schema_source(),
            "docs/reference/scene",
            pages_of_scenes(),
            80,
        ),
        (study_source(), "benches/trade/README.md", studies, 40),
        (sweep_source(), "docs/reference/sweeps.md", sweeps, 30),
    ] {
        let schema: BTreeSet<String> = fields_in_order(&source).into_iter().collect();
        let documented = documented_fields(&text);
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

/// The committed pages are what the schema says now; with `RIPRAP_UPDATE` they are written.
#[test]
fn the_pages_are_up_to_date() {
    let order = fields_in_order(&schema_source());
    let folder = at("docs/reference/scene");
    let pages = pages::of_scenes(&order);
    let units = at("docs/reference/units.md");
    if std::env::var_os("RIPRAP_UPDATE").is_some() {
        if folder.exists() {
            std::fs::remove_dir_all(&folder).unwrap();
        }
        std::fs::create_dir_all(&folder).unwrap();
        for (name, text) in &pages {
            std::fs::write(folder.join(name), text).unwrap();
        }
        std::fs::write(&units, pages::of_units()).unwrap();
        return;
    }
    let remedy = "run RIPRAP_UPDATE=1 cargo test --release --test coupling scene_docs";
    for (name, text) in &pages {
        let found = std::fs::read_to_string(folder.join(name)).unwrap_or_default();
        assert!(found == *text, "{name} is not up to date: {remedy}");
    }
    let n_found = folder.read_dir().unwrap().count();
    assert_eq!(
        n_found,
        pages.len(),
        "pages of types that are gone: {remedy}"
    );
    let found = std::fs::read_to_string(units).unwrap_or_default();
    assert!(
        found == pages::of_units(),
        "units.md is not up to date: {remedy}"
    );
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
