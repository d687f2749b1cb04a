//! The guide to messages: its entries, as plain text.

use super::Code;

/// The guide, in Markdown for the manual.
const GUIDE: &str = include_str!("../../../docs/troubleshooting.md");

/// Columns of a terminal.
const WIDTH: usize = 80;

/// Codes of the entries of the guide, in its order.
pub fn entries() -> impl Iterator<Item = &'static str> {
    GUIDE.lines().filter_map(anchor)
}

/// The code in an anchor.
fn anchor(line: &str) -> Option<&str> {
    line.strip_prefix('(')?.strip_suffix(")=")
}

/// Paragraphs of the entry of a code.
pub fn paragraphs(code: Code) -> Vec<String> {
    let text = GUIDE.split_once(&format!("\n({code})=\n### {code}\n"));
    let entry = text.map_or("", |(_, rest)| rest);
    // the next entry begins with its anchor, the next group with its heading
    let lines = entry
        .lines()
        .take_while(|line| anchor(line).is_none() && !line.starts_with('#'));
    let lines: Vec<&str> = lines.collect();
    lines
        .split(|line| line.is_empty())
        .filter(|lines| !lines.is_empty())
        .map(|lines| lines.join(" "))
        .collect()
}

/// The first sentence of the entry of a code.
pub fn summary(code: Code) -> String {
    paragraphs(code).into_iter().next().unwrap_or_default()
}

/// The entry of a code for a terminal.
pub fn entry(code: Code) -> String {
    let wrapped: Vec<String> = paragraphs(code)
        .iter()
        .map(|paragraph| wrapped(paragraph, ""))
        .collect();
    format!("{code}\n\n{}", wrapped.join("\n\n"))
}

/// All codes with what they mean, a paragraph each.
pub fn index() -> String {
    let of = |code: &Code| format!("{code}\n{}", wrapped(&summary(*code), "    "));
    Code::ALL.iter().map(of).collect::<Vec<_>>().join("\n")
}

/// A paragraph in lines of a terminal.
fn wrapped(paragraph: &str, indent: &str) -> String {
    let mut lines = vec![indent.to_owned()];
    for word in paragraph.split_whitespace() {
        let line = lines.last_mut();
        match line {
            Some(line) if line.len() == indent.len() => line.push_str(word),
            Some(line) if line.chars().count() + 1 + word.chars().count() <= WIDTH => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(format!("{indent}{word}")),
        }
    }
    lines.join("\n")
}
