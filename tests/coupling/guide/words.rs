//! Words of the guide: plain, and none of our own.

use super::pages::pages;

/// Names that only the sources know: wall methods and rows of benches by their numbers.
fn is_internal(word: &str) -> bool {
    let mut letters = word.chars();
    let first = letters.next();
    let rest = letters.as_str();
    let is_number = !rest.is_empty() && rest.chars().all(|c| c.is_ascii_digit());
    match first {
        Some('W') => matches!(rest, "1" | "2" | "3"),
        Some('C' | 'D' | 'G' | 'S' | 'T' | 'X') => is_number && rest.len() == 2,
        _ => false,
    }
}

#[test]
fn no_page_uses_internal_names() {
    for page in pages() {
        for (number, line) in page.prose() {
            let words = line.split(|c: char| !c.is_alphanumeric() && c != '_');
            let found: Vec<&str> = words.filter(|word| is_internal(word)).collect();
            assert!(
                found.is_empty(),
                "{}:{number}: {found:?} is a name of the sources",
                page.name
            );
        }
    }
}

/// British spellings that slip in.
#[test]
fn spelling_is_american() {
    const BRITISH: [&str; 12] = [
        "colour",
        "behaviour",
        "modelled",
        "modelling",
        "metre",
        "centre",
        "armour",
        "neighbour",
        "grey",
        "catalogue",
        "travelled",
        "labelled",
    ];
    for page in pages() {
        for (number, line) in page.prose() {
            let prose: String = line
                .split('`')
                .step_by(2)
                .collect::<Vec<_>>()
                .join(" ")
                .to_lowercase();
            let found: Vec<_> = BRITISH
                .iter()
                .filter(|word| prose.contains(**word))
                .collect();
            assert!(found.is_empty(), "{}:{number}: {found:?}", page.name);
        }
    }
}
