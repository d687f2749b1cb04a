//! Mistakes and hostile input in JSON and YAML: refused in their place, never a panic.

use std::time::Instant;

use riprap::scene::locate::Syntax;
use riprap::scene::parse;

use super::{JSON, YAML, answers};

/// An edit, text and replacement; the text that the answer points at; first words of the answer.
type Row = (&'static str, &'static str, &'static str, &'static str);

#[rustfmt::skip] // one row a line
const IN_JSON: &[Row] = &[
    ("\"density\": 2650", "\"densty\": 2650", "densty", "unknown field `densty` in MaterialFile, did you mean `density`?"),
    ("\"Fixed\"", "\"Fixd\"", "\"Fixd\"", "unknown variant `Fixd` of MotionFile, did you mean `Fixed`?"),
    ("{\"Spacing\": 0.1}", "{\"spacing\": 0.1}", "{", "`resolution` takes one kind, found a group of fields; write {\"KIND\": ...}, with one of Spacing, Count"),
    ("{\"Spacing\": 0.1}", "{\"Spacin\": 0.1}", "Spacin", "unknown variant `Spacin` of ResolutionFile, did you mean `Spacing`?"),
    ("{\"Spacing\": 0.1}", "0.1", "0.1", "`resolution` does not say what 0.1 is; write {\"Spacing\": 0.1}"),
    ("{\"Spacing\": 0.1}", "\"Spacing\"", "\"Spacing\"", "`Spacing` takes a value or fields, found none"),
    ("{\"Spacing\": 0.1}", "{\"Spacing\": \"0.1\"}", "\"0.1\"", "`Spacing` takes a number, found \"0.1\" in quotes; write 0.1"),
    ("{\"Spacing\": 0.1}", "{\"Count\": 1000.5}", "1000.5", "`Count` takes a whole number from 0, found `1000.5`"),
    ("\"Fixed\"", "{\"Fixed\": {}}", "Fixed", "`Fixed` takes no value; write \"Fixed\""),
    ("2650", "\"2650\"", "\"2650\"", "`density` takes a number, found \"2650\" in quotes; write 2650"),
    ("2650", "true", "true", "`density` takes a number, found `true`"),
    ("2650", "null", "null", "`density` takes a number, found `null`"),
    ("2650", "2650.", ",", "invalid number, found `,`"),
    ("2650", "1e999", "1e999", "`density` is 1e999; a number must be finite"),
    ("2650", "NaN", "NaN", "expected a value, found `NaN`"),
    ("2650", "2650, \"density\": 2600", "density", "`density` is written twice; keep one"),
    ("[4, 1, 2]", "[4, 1]", "[4, 1]", "found 2 values in `[4, 1]`, one or more are missing"),
    ("[4, 1, 2]", "[4, 1, 2, 3]", "[4, 1, 2, 3]", "found 4 values in `[4, 1, 2, 3]`, one or more are too many"),
    ("[4, 1, 2]", "4", "4", "`max` takes 3 values, [..., ..., ...], found `4`"),
    ("[4, 1, 2]", "{\"x\": 4}", "{", "`max` takes 3 values, [..., ..., ...], found a group of fields"),
    ("{\"duration\": 1}", "1", "1", "`time` takes fields, {\"name\": value, ...}, found `1`"),
    ("{\"duration\": 1}", "{}", "{}", "missing field `duration` in TimeFile"),
    ("{\"duration\": 1}", "{\"duration\": 1},", "}", "trailing comma, found `}`"),
    ("{\"duration\": 1}", "{\"duration\": 1} // s", "/", "expected `,` or `}`; JSON has no comments"),
    ("\"title\": \"tank\"", "title: \"tank\"", "t", "key must be a string, found `t`"),
    ("\"title\": \"tank\"", "\"title\": tank", "tank", "expected a value, found `tank`; a text stands in double quotes"),
    ("\"title\": \"tank\"", "\"title\": 7", "7", "`title` takes a text, found `7`"),
    ("\"title\": \"tank\"", "\"title\": \"tank", "", "control character"),
    ("\"name\": \"rock\"", "\"name\": [\"rock\"]", "[", "`name` takes a text, found a list"),
    ("\"materials\": [", "\"materials\": {\"a\": [", "}", "end of the text while parsing an object"),
    ("{\"Box\": {\"min\": [3, 0.3, 0], \"max\": [3.5, 0.8, 0.5]}}", "{\"Box\": {}, \"Sphere\": {}}", "{", "`shape` takes one kind, found a group of fields"),
    ("{\"Box\": {\"min\": [3, 0.3, 0], \"max\": [3.5, 0.8, 0.5]}}", "{\"Box\": {\"min\": [3, 0.3, 0]}}", "Box", "missing field `max` in ShapeFile"),
];

#[rustfmt::skip] // one row a line
const IN_YAML: &[Row] = &[
    ("density: 2650", "densty: 2650", "densty", "unknown field `densty` in MaterialFile, did you mean `density`?"),
    ("motion: Fixed", "motion: Fixd", "Fixd", "unknown variant `Fixd` of MotionFile, did you mean `Fixed`?"),
    ("motion: Fixed", "motion: fixed", "fixed", "unknown variant `fixed` of MotionFile, did you mean `Fixed`?"),
    ("{Spacing: 0.1}", "0.1", "0.1", "`resolution` does not say what 0.1 is"),
    ("density: 2650", "density: '2650'", "'2650'", "`density` takes a number, found \"2650\" in quotes; write 2650"),
    ("density: 2650", "density: 2,650", "2,650", "`density` takes a number, found `2,650`"),
    ("density: 2650", "density: .inf", ".inf", "`density` is .inf; a number must be finite"),
    ("density: 2650", "density: NaN", "NaN", "`density` is NaN; a number must be finite"),
    ("density: 2650", "density: 1e999", "1e999", "`density` is 1e999; a number must be finite"),
    ("density: 2650", "density:", "", "`density` takes a number, found nothing"),
    ("density: 2650", "density: ~", "~", "`density` takes a number, found `~`"),
    ("density: 2650", "density: 2650\n    density: 2600", "density", "`density` is written twice; keep one"),
    ("density: 2650", "density: &rho 2650", "", "anchors and aliases are not read; write the value out"),
    ("density: 2650", "density: *rho", "", "while parsing node, found unknown anchor"),
    ("density: 2650", "density: !!float 2650", "", "tags are not read"),
    ("    density: 2650", "\tdensity: 2650", "", "YAML is indented with spaces, found a tab"),
    ("    density: 2650", "   density: 2650", "", ""),
    ("[4, 1, 2]", "[4, 1]", "[4, 1]", "found 2 values in `[4, 1]`, one or more are missing"),
    ("[4, 1, 2]", "[4, 1, 2", "", ""),
    ("title: tank", "title: [tank]", "[", "`title` takes a text, found a list"),
    ("title: tank", "title: \"tank", "", ""),
    ("duration: 1", "duration: 1\n---\ntitle: two", "---", "a scene is one document"),
    ("duration: 1", "? [a, b]\n  : 1", "", "the name of a field is a word, found a group"),
    ("duration: 1", "<<: 1", "<<", "unknown field `<<` in TimeFile"),
];

fn missed(name: &str, right: &str, rows: &[Row]) -> Vec<String> {
    let mut missed = Vec::new();
    for &(from, to, at, words) in rows {
        assert!(right.contains(from), "{from}");
        let text = right.replacen(from, to, 1);
        let found = answers(name, &text, &[]);
        let is_answered = matches!(found.as_slice(), [one] if one.message.starts_with(words)
            && text[one.span.clone()].starts_with(at));
        if !is_answered {
            let said: Vec<_> = found
                .iter()
                .map(|one| format!("{} at `{}`", one.message, &text[one.span.clone()]))
                .collect();
            missed.push(format!(
                "{to}\n  expected {words} at `{at}`\n  found {said:#?}"
            ));
        }
    }
    missed
}

#[test]
fn mistakes_are_answered_in_their_place() {
    let json = missed("scene.json", JSON, IN_JSON);
    let yaml = missed("scene.yml", YAML, IN_YAML);
    let all = [json, yaml].concat();
    assert!(all.is_empty(), "{} missed:\n{}", all.len(), all.join("\n"));
}

/// Whatever the text, there is an answer, and soon.
#[test]
fn hostile_texts_are_refused() {
    let laughs = (1..30).fold("a: &a0 [lol]\n".to_owned(), |text, k| {
        let last = format!("*a{}, ", k - 1).repeat(9);
        format!("{text}b{k}: &a{k} [{last}]\n")
    });
    let deep = |open: &str, n: usize| open.repeat(n);
    for (syntax, text) in [
        (Syntax::Json, deep("[", 200_000)),
        (Syntax::Json, deep("{\"a\":", 200_000)),
        (
            Syntax::Json,
            format!("{}{}", deep("[", 100), deep("]", 100)),
        ),
        (
            Syntax::Json,
            format!("{}1{}", deep("{\"A\":", 5000), deep("}", 5000)),
        ),
        (Syntax::Json, String::new()),
        (Syntax::Json, "\u{feff}".to_owned()),
        (Syntax::Json, "\"\\ud800\"".to_owned()),
        (Syntax::Json, "{\"\\u0000\": 1}".to_owned()),
        (Syntax::Json, "null".to_owned()),
        (Syntax::Yaml, deep("[", 200_000)),
        (Syntax::Yaml, deep("- ", 20_000)),
        (Syntax::Yaml, deep("{a: ", 200)),
        (Syntax::Yaml, deep("? ", 20_000)),
        (Syntax::Yaml, laughs),
        (Syntax::Yaml, String::new()),
        (Syntax::Yaml, "\u{feff}".to_owned()),
        (Syntax::Yaml, "%YAML 9.9\n--- |\n".to_owned()),
        (Syntax::Yaml, "\0".to_owned()),
        (Syntax::Yaml, "- \u{85}\u{2028}: é ñ: [ü".to_owned()),
        (Syntax::Yaml, "~".to_owned()),
    ] {
        let start = Instant::now();
        let error = parse::read_in(&text, syntax).unwrap_err();
        let head: String = text.chars().take(40).collect();
        assert!(!error.message.is_empty(), "{head}");
        assert!(text.get(error.span.clone()).is_some(), "{head} {error:?}");
        assert!(start.elapsed().as_secs_f64() < 10.0, "{head}");
    }
}

/// Every beginning of a right scene, and every scene that lacks a byte, has an answer.
#[test]
fn torn_texts_are_refused_or_read() {
    for (syntax, text) in [(Syntax::Json, JSON), (Syntax::Yaml, YAML)] {
        for at in (0..text.len()).step_by(3) {
            let _ = parse::read_in(&text[..at], syntax);
            let without = format!("{}{}", &text[..at], &text[at + 1..]);
            let _ = parse::read_in(&without, syntax);
        }
    }
}
