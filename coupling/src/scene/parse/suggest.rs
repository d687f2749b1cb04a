//! Names that are not known, with those that are.

/// Longest list of valid names that is written out; characters.
const LONGEST_LIST: usize = 120;
/// Number of names of a longer list, the closest ones.
const CLOSEST: usize = 6;
/// Shortest beginning of a name that stands for it; bytes.
const SHORTEST_BEGINNING: usize = 4;

/// ", did you mean ...?", or the valid names.
pub fn suggestion(found: &str, expected: &[&str]) -> String {
    let nearest = expected
        .iter()
        .map(|name| (strsim::damerau_levenshtein(found, name), name))
        .min();
    match nearest {
        Some((distance, name)) if distance <= 2.max(found.len() / 3) => {
            format!(", did you mean `{name}`?")
        }
        _ if expected.is_empty() => String::new(),
        _ => match expected.iter().find(|name| begins(name, found)) {
            Some(name) => format!(", did you mean `{name}`?"),
            None => format!("; expected one of {}", listed(found, expected)),
        },
    }
}

fn begins(name: &str, found: &str) -> bool {
    found.len() >= SHORTEST_BEGINNING && name.starts_with(found)
}

/// Valid names, of a long list the closest.
fn listed(found: &str, expected: &[&str]) -> String {
    let all = expected.join(", ");
    if all.len() <= LONGEST_LIST {
        return all;
    }
    let mut names = expected.to_vec();
    names.sort_by_key(|name| strsim::damerau_levenshtein(found, name));
    names.truncate(CLOSEST);
    format!("{}, ... (docs/reference/scene)", names.join(", "))
}

/// Answer to a field that a group does not have.
pub(super) fn unknown_field(found: &str, outer: Option<&str>, expected: &[&str]) -> String {
    let hint = suggestion(found, expected);
    format!("unknown field `{found}`{}{hint}", of("in", outer))
}

/// Answer to a kind that there is not.
pub(super) fn unknown_variant(found: &str, outer: Option<&str>, expected: &[&str]) -> String {
    let hint = suggestion(found, expected);
    format!("unknown variant `{found}`{}{hint}", of("of", outer))
}

/// Answer to a field that a group lacks.
pub(super) fn missing_field(field: &str, outer: Option<&str>) -> String {
    format!("missing field `{field}`{}", of("in", outer))
}

fn of(word: &str, outer: Option<&str>) -> String {
    outer.map_or_else(String::new, |outer| format!(" {word} {outer}"))
}
