//! Scenes in RON, JSON and YAML: the same values, checks and messages, each in its own text.

mod faults;
mod quantities;

use std::fmt::Write as _;
use std::path::PathBuf;

use proptest::prelude::*;
use riprap::scene::access::Access;
use riprap::scene::error::{Located, Severity};
use riprap::scene::file::SceneFile;
use riprap::scene::load_text;
use riprap::scene::locate::Syntax;
use riprap::scene::parse::{self, Override};
use serde_json::Value;

use crate::support::{riprap, words};

/// Paths of all scenes of `cases`.
pub(crate) fn cases() -> Vec<PathBuf> {
    let folder = crate::support::case("");
    let entries = folder.read_dir().unwrap();
    let mut cases: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    cases.retain(|path| path.extension().is_some_and(|extension| extension == "ron"));
    cases.sort();
    assert!(cases.len() > 20, "{}", cases.len());
    cases
}

/// A value as YAML in blocks, texts without quotes where YAML allows it.
fn yaml(value: &Value, indent: usize, text: &mut String) {
    let margin = " ".repeat(indent);
    match value {
        Value::Object(fields) if !fields.is_empty() => {
            for (name, value) in fields {
                write!(text, "\n{margin}{name}:").unwrap();
                yaml(value, indent + 2, text);
            }
        }
        Value::Array(items) if items.iter().any(|item| item.is_object() || item.is_array()) => {
            for item in items {
                write!(text, "\n{margin}-").unwrap();
                yaml(item, indent + 2, text);
            }
        }
        Value::String(word) if word.chars().all(char::is_alphabetic) && !word.is_empty() => {
            write!(text, " {word}").unwrap();
        }
        Value::Null => {}
        other => write!(text, " {other}").unwrap(),
    }
}

/// Every case says the same in the three languages.
#[test]
fn cases_read_alike_in_every_language() {
    for path in cases() {
        let scene = parse::read(&std::fs::read_to_string(&path).unwrap()).unwrap();
        let json = serde_json::to_value(&scene).unwrap();
        let pretty = serde_json::to_string_pretty(&json).unwrap();
        let mut blocks = String::from("# a comment");
        yaml(&json, 0, &mut blocks);
        for (text, syntax) in [
            (&pretty, Syntax::Json),
            (&json.to_string(), Syntax::Json),
            (&pretty, Syntax::Yaml),
            (&blocks, Syntax::Yaml),
        ] {
            let read = parse::read_in(text, syntax);
            assert_eq!(read.as_ref(), Ok(&scene), "{path:?} {syntax:?}\n{text}");
        }
    }
}

proptest! {
    /// Whatever is typed into a scene, it is read or refused at a place inside of it.
    #[test]
    fn a_damaged_scene_is_refused_at_its_place(
        place in 0.0..1.0f64,
        length in 0..6usize,
        typed in "[-:{}\\[\\],\"'&*!|>%@#~ \\n\\t0-9a-zé]{0,4}",
        language in 0..3usize,
    ) {
        let wedge = std::fs::read_to_string(crate::support::case("sliding_wedge.ron")).unwrap();
        let languages = [(Syntax::Json, JSON), (Syntax::Yaml, YAML), (Syntax::Ron, &wedge)];
        let (syntax, whole) = languages[language];
        let letters: Vec<char> = whole.chars().collect();
        let from = (letters.len() as f64 * place) as usize;
        let rest = letters.iter().skip(from + length);
        let text: String = letters[..from].iter().chain(&typed.chars().collect::<Vec<_>>()).chain(rest).collect();
        if let Err(error) = parse::read_in(&text, syntax) {
            prop_assert!(!error.message.is_empty());
            prop_assert!(error.span.start <= error.span.end && error.span.end <= text.len(), "{:?} of {}", error.span, text.len());
            prop_assert!(text.is_char_boundary(error.span.start) && text.is_char_boundary(error.span.end));
        }
    }
}

pub(crate) const JSON: &str = r#"{
  "title": "tank",
  "domain": {"min": [0, 0, 0], "max": [4, 1, 2]},
  "materials": [
    {"name": "rock", "density": 2650, "friction_angle_deg": 31},
    {"name": "wall", "density": 2400, "friction_angle_deg": 35}
  ],
  "blocks": [
    {"name": "floor", "material": "wall", "motion": "Fixed", "shape": {"Box": {"min": [-1, -1, -0.5], "max": [5, 2, 0]}}},
    {"name": "cube", "material": "rock", "shape": {"Box": {"min": [3, 0.3, 0], "max": [3.5, 0.8, 0.5]}}}
  ],
  "fluid": {
    "resolution": {"Spacing": 0.1},
    "regions": [{"name": "column", "shape": {"Box": {"min": [0, 0, 0], "max": [1, 1, 1]}}}]
  },
  "time": {"duration": 1}
}"#;

pub(crate) const YAML: &str = "\
title: tank  # a comment
domain: {min: [0, 0, 0], max: [4, 1, 2]}
materials:
  - name: rock
    density: 2650
    friction_angle_deg: 31
  - name: wall
    density: 2400
    friction_angle_deg: 35
blocks:
  - name: floor
    material: wall
    motion: Fixed
    shape:
      Box: {min: [-1, -1, -0.5], max: [5, 2, 0]}
  - name: cube
    material: rock
    shape:
      Box:
        min: [3, 0.3, 0]
        max: [3.5, 0.8, 0.5]
fluid:
  resolution: {Spacing: 0.1}
  regions:
    - name: column
      shape:
        Box:
          min: [0, 0, 0]
          max: [1, 1, 1]
time:
  duration: 1
";

/// The tank in both languages.
pub(crate) const TANKS: [(&str, &str); 2] = [("scene.json", JSON), ("scene.yaml", YAML)];

/// Answers to a scene of this name.
pub(crate) fn answers(name: &str, text: &str, set: &[(&str, &str)]) -> Vec<Located> {
    let folder = tempfile::tempdir().unwrap();
    let set: Vec<Override> = set
        .iter()
        .map(|(path, value)| Override {
            path: (*path).to_owned(),
            value: (*value).to_owned(),
        })
        .collect();
    let found = load_text(name, text, &set, &Access::of(folder.path()));
    let (Ok((_, error)) | Err(error)) = found;
    error.located().to_vec()
}

#[test]
fn right_scenes_pass_without_a_word() {
    let for_editors = JSON.replacen('{', "{\"$schema\": \"scene.schema.json\",", 1);
    assert_eq!(answers("scene.json", &for_editors, &[]), []);
    for (name, text) in TANKS {
        assert_eq!(answers(name, text, &[]), [], "{name}");
        // as editors of Windows save it
        let marked = format!("\u{feff}{}", text.replace('\n', "\r\n"));
        assert_eq!(answers(name, &marked, &[]), [], "{name}");
    }
}

/// Values of `--set` are RON for every language.
#[test]
fn fields_are_set_in_every_language() {
    for (name, text) in TANKS {
        let syntax = Syntax::of(name);
        let set = |path: &str, value: &str| {
            let change = Override {
                path: path.to_owned(),
                value: value.to_owned(),
            };
            let text = parse::overridden(text, syntax, &[change]);
            let text = text.unwrap_or_else(|problem| panic!("{path}: {}", problem.message));
            parse::read_in(&text, syntax)
                .unwrap_or_else(|error| panic!("{name} {path}: {}\n{text}", error.message))
        };
        let right = parse::read_in(text, syntax).unwrap();
        let changed = |edit: &dyn Fn(&mut SceneFile)| {
            let mut scene = right.clone();
            edit(&mut scene);
            scene
        };
        assert_eq!(
            set("time.duration", "2.5"),
            changed(&|s| s.time.duration = 2.5)
        );
        assert_eq!(
            set("time.duration", "1 h"),
            changed(&|s| s.time.duration = 3600.0)
        );
        assert_eq!(set("time.settle", "0.5"), changed(&|s| s.time.settle = 0.5));
        assert_eq!(
            set("materials.rock.density", "\"2.7 t/m3\""),
            changed(&|s| s.materials[0].density = 2700.0)
        );
        assert_eq!(
            set("blocks[1].shape.max", "(3.6, 0.8, 1_0e-1)"),
            changed(
                &|s| s.blocks[1].shape = riprap::scene::file::ShapeFile::Box {
                    min: (3.0, 0.3, 0.0),
                    max: (3.6, 0.8, 1.0),
                }
            )
        );
        assert_eq!(
            set("fluid.resolution", "Count(4000)"),
            changed(&|s| {
                let fluid = s.fluid.as_mut().unwrap();
                fluid.resolution = riprap::scene::file::ResolutionFile::Count(4000);
            })
        );
        assert_eq!(
            set("interface.slip", "None"),
            changed(&|s| s.interface.slip = riprap::scene::file::SlipFile::None)
        );
        assert_eq!(
            set(
                "gauges",
                "[Pressure(name: \"p\", position: (0.5, 0.5, 0.2))]"
            ),
            changed(
                &|s| s.gauges = vec![riprap::scene::file::GaugeFile::Pressure {
                    name: "p".to_owned(),
                    position: (0.5, 0.5, 0.2),
                    diameter: 0.0,
                    averaging_time: 0.0,
                }]
            )
        );
        assert_eq!(set("camera", "None"), right);
        let wrong = answers(name, text, &[("time.durations", "2")]);
        assert!(
            wrong[0].message.contains("did you mean `duration`?"),
            "{wrong:?}"
        );
        let wrong = answers(name, text, &[("blocks[7].name", "2")]);
        assert!(
            wrong[0].message.starts_with("--set blocks[7].name"),
            "{wrong:?}"
        );
    }
}

/// The program reads them by the ending of their names, and answers in their lines.
#[test]
fn the_program_checks_json_and_yaml() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in TANKS {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        let right = riprap(&["check", path.to_str().unwrap()]);
        assert!(right.status.success(), "{}", words(&right));
        std::fs::write(&path, text.replacen("2650", "-2650", 1)).unwrap();
        let wrong = riprap(&["check", path.to_str().unwrap()]);
        assert_eq!(wrong.status.code(), Some(2));
        let place = if name == "scene.json" { "5:33" } else { "5:14" };
        let line = format!("{name}:{place}: error: material `rock`: density must be");
        assert!(words(&wrong).contains(&line), "{}", words(&wrong));
    }
}

/// The messages of values are those of RON, in the place of the value; lines may end as in Windows, and letters take several
/// bytes.
#[test]
fn values_are_answered_in_their_place() {
    for (name, text) in TANKS {
        for text in [
            text.to_owned(),
            text.replace('\n', "\r\n"),
            format!("\u{feff}{}", text.replace("tank", "Überströmung – 水")),
        ] {
            let text = text.replacen("31", "-31", 1);
            let found = answers(name, &text, &[]);
            let error = found.iter().find(|one| one.severity == Severity::Error);
            let error = error.unwrap_or_else(|| panic!("{name}: {found:?}"));
            let words = "material `rock`: friction angle must be in [0, 90) degrees, found -31";
            assert_eq!(error.message, words, "{name}");
            assert_eq!(&text[error.span.clone()], "-31", "{name}");
        }
    }
}
