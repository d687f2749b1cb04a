//! Codes of errors and warnings: every one is explained, printed behind its message, and used.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use riprap::messages::{Code, guide};

use crate::support::{riprap, words};

fn shown(arguments: &[&str]) -> String {
    let output = riprap(arguments);
    assert!(output.status.success(), "{}", words(&output));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn every_code_has_one_entry_and_every_entry_a_code() {
    let codes: Vec<&str> = Code::ALL.iter().map(|code| code.as_str()).collect();
    let entries: Vec<&str> = guide::entries().collect();
    assert_eq!(codes, entries);
    let distinct: BTreeSet<&str> = codes.iter().copied().collect();
    assert_eq!(distinct.len(), codes.len());
    for code in codes {
        let is_kebab = code
            .split('-')
            .all(|word| !word.is_empty() && word.chars().all(|letter| letter.is_ascii_lowercase()));
        assert!(is_kebab && code.contains('-'), "{code}");
    }
}

/// Meaning, cause and remedy; a warning that may be ignored says when.
#[test]
fn every_entry_says_what_why_and_what_to_do() {
    for &code in Code::ALL {
        let paragraphs = guide::paragraphs(code);
        let starts: Vec<&str> = paragraphs
            .iter()
            .map(|text| text.split(' ').next().unwrap_or_default())
            .collect();
        let [_, "Why:", "Remedy:", rest @ ..] = &starts[..] else {
            panic!("{code}: {starts:?}")
        };
        assert!(matches!(rest, [] | ["Ignore"]), "{code}: {starts:?}");
        let summary = guide::summary(code);
        assert!(
            summary.ends_with('.') && summary.matches(". ").count() == 0,
            "{code}: {summary}"
        );
    }
}

/// Text of the sources of the program, by path, without their own tests.
fn sources(folder: &Path) -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    for entry in folder.read_dir().unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|end| end == "rs") {
            let text = fs::read_to_string(&path).unwrap();
            let text = text.split("\n#[cfg(test)]").next().unwrap_or_default();
            found.push((path.clone(), text.to_owned()));
        }
    }
    found
}

fn program() -> Vec<(PathBuf, String)> {
    sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"))
}

#[test]
fn every_code_is_of_some_message() {
    let named: BTreeSet<String> = program()
        .iter()
        .flat_map(|(_, text)| text.split("Code::").skip(1))
        .map(|rest| {
            let end = rest.find(|letter: char| !letter.is_alphanumeric());
            rest[..end.unwrap_or(rest.len())].to_owned()
        })
        .collect();
    let unused: Vec<String> = (Code::ALL.iter())
        .map(|code| format!("{code:?}"))
        .filter(|name| !named.contains(name))
        .collect();
    assert!(unused.is_empty(), "{unused:?}");
}

/// The constructors of problems take a code; lines of the program come from one place, which adds it.
#[test]
fn no_error_and_no_warning_is_printed_without_a_code() {
    let mut places = Vec::new();
    for (path, text) in program() {
        if path.ends_with("cli/told.rs") {
            continue;
        }
        for line in text
            .lines()
            .filter(|line| !line.trim_start().starts_with("//"))
        {
            let is_bare = line.contains("\"error: ") || line.contains("\"warning: ");
            let is_coded = line.contains("\"error: {}") || line.contains("\"warning: {}");
            if is_bare && !is_coded {
                places.push(format!("{}: {}", path.display(), line.trim()));
            }
        }
    }
    assert!(places.is_empty(), "{}", places.join("\n"));
}

const SCENE: &str = r#"(
    title: "two boxes",
    domain: (min: (-2, -2, -2), max: (4, 2, 4)),
    materials: [(name: "rock", density: 2600, friction_angle_deg: 30)],
    blocks: [
        (name: "floor", material: "rock", motion: Fixed, shape: Box(min: (-1, -1, -1), max: (3, 1, 0))),
        (name: "box", material: "rock", shape: Box(min: (0, 0, 0), max: (1, 1, 1))),
    ],
    fluid: (resolution: Spacing(0.25), regions: [(name: "pool", shape: Box(min: (1, -1, 0), max: (3, 1, 0.5)))]),
    time: (duration: 0.01),
)"#;

/// A message of each group of the guide carries its code, and the last line names the command that explains it.
#[test]
fn messages_are_printed_with_their_codes() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("s.ron");
    let file = file.to_str().unwrap();
    for (from, to, code) in [
        ("title: ", "titel: ", "unknown-field"),
        ("density: 2600", "density: -2600", "value-out-of-range"),
        ("2600, f", "2600 f", "scene-syntax"),
        (
            r#"material: "rock", shape"#,
            r#"material: "rok", shape"#,
            "unknown-name",
        ),
        ("min: (0, 0, 0)", "min: (0, 0, -0.5)", "overlapping-blocks"),
        (
            "Box(min: (1, -1, 0), max: (3, 1, 0.5))",
            "Below(level: 0.5, seed: (2, 0, 0.2))",
            "leaking-basin",
        ),
        ("Spacing(0.25)", "Spacing(1e-6)", "not-enough-memory"),
        ("density: 2600", "density: 2.6", "suspicious-units"),
    ] {
        assert!(SCENE.contains(from), "{from}");
        fs::write(file, SCENE.replacen(from, to, 1)).unwrap();
        let output = riprap(&["check", file]);
        let said = words(&output);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(&format!(" [{code}]\n")), "{code}: {said}");
        let last = said.lines().last().unwrap_or_default();
        let codes = last.strip_prefix("more on these: riprap explain ").unwrap();
        assert!(codes.split(' ').any(|found| found == code), "{last}");
        shown(&[&["explain"], &codes.split(' ').collect::<Vec<_>>()[..]].concat());
    }
    let none = folder.path().join("none");
    let said = words(&riprap(&["inspect", none.to_str().unwrap()]));
    assert!(said.contains(" [file-not-readable]\n"), "{said}");
}

#[test]
fn a_quiet_run_names_the_code_and_no_more() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("s.ron");
    fs::write(&file, SCENE.replacen("density: 2600", "density: -1", 1)).unwrap();
    let said = words(&riprap(&["run", "--quiet", file.to_str().unwrap()]));
    assert!(said.contains(" [value-out-of-range]\n"), "{said}");
    assert!(!said.contains("riprap explain"), "{said}");
}

#[test]
fn a_code_is_explained_in_lines_of_a_terminal() {
    let text = shown(&["explain", "overlapping-blocks", "[leaking-basin],"]);
    assert!(text.starts_with("overlapping-blocks\n\nTwo blocks overlap at the start.\n\nWhy: "));
    assert!(
        text.contains("\n\nleaking-basin\n\nWater below the level"),
        "{text}"
    );
    assert!(
        text.lines().all(|line| line.chars().count() <= 80),
        "{text}"
    );
    // the next entry and the next group stay out
    assert!(!text.contains("soft-contacts") && !text.contains("=\n") && !text.contains('#'));
    let all = shown(&["explain"]);
    for code in Code::ALL {
        let line = format!(
            "{code}\n    {}",
            guide::summary(*code).split(' ').next().unwrap()
        );
        assert!(all.contains(&line), "{code}");
    }
}

#[test]
fn a_misspelled_code_is_answered_with_the_closest() {
    let output = riprap(&["explain", "overlaping-block"]);
    assert_eq!(output.status.code(), Some(2));
    let said = words(&output);
    assert!(
        said.contains("did you mean `overlapping-blocks`?"),
        "{said}"
    );
}
