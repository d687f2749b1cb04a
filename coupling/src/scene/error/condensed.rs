//! Many problems of one kind as few: the first ones, and one that counts the others.

use std::collections::BTreeMap;

use super::{Problem, Severity};

/// Problems of a kind that are told one by one.
const TOLD: usize = 5;

/// The problems with at most a few of each kind. After them one more has the number of the others and the largest of them, by the
/// first number in its message. Kinds are told apart by [`kind`].
pub(super) fn condensed(problems: Vec<Problem>) -> Vec<Problem> {
    let mut seen = BTreeMap::<(bool, String), Kind>::new();
    let mut told: Vec<(usize, Problem)> = Vec::new();
    for (place, problem) in problems.into_iter().enumerate() {
        let is_error = problem.severity == Severity::Error;
        let kind = seen.entry((is_error, kind(&problem.message))).or_default();
        kind.n += 1;
        if kind.n <= TOLD {
            kind.last_place = place;
            told.push((place, problem));
        } else if kind
            .largest
            .as_ref()
            .is_none_or(|other| size(other) < size(&problem))
        {
            kind.largest = Some(problem);
        }
    }
    for kind in seen.into_values() {
        if let Some(largest) = kind.largest {
            told.push((kind.last_place, counted(kind.n - TOLD, largest)));
        }
    }
    // after the last one of its kind that is told; the sort is stable
    told.sort_by_key(|(place, _)| *place);
    told.into_iter().map(|(_, problem)| problem).collect()
}

/// Problems of a kind.
#[derive(Default)]
struct Kind {
    n: usize,
    /// Place of the last one that is told.
    last_place: usize,
    /// Largest of the others.
    largest: Option<Problem>,
}

/// The problem that stands for others of its kind.
fn counted(n: usize, largest: Problem) -> Problem {
    let message = match (n, first_number(&largest.message)) {
        (1, _) => format!("1 more of this kind: {}", largest.message),
        (_, Some(_)) => format!("{n} more of this kind, the largest: {}", largest.message),
        (_, None) => format!("{n} more of this kind, such as: {}", largest.message),
    };
    Problem { message, ..largest }
}

/// Shape of a message: quoted names and numbers stand for any.
fn kind(message: &str) -> String {
    let mut kind = String::new();
    for (k, piece) in message.split('`').enumerate() {
        if k % 2 == 1 {
            kind += "`";
            continue;
        }
        let mut is_in_number = false;
        for c in piece.chars() {
            let is_digit =
                c.is_ascii_digit() || (is_in_number && matches!(c, '.' | 'e' | '-' | '+'));
            if !is_digit {
                kind.push(c);
            } else if !is_in_number {
                kind.push('#');
            }
            is_in_number = is_digit;
        }
    }
    // a sign belongs to its number
    kind.replace("-#", "#")
}

/// First number outside of quoted names.
fn first_number(message: &str) -> Option<f64> {
    let plain = message.split('`').step_by(2);
    let words =
        plain.flat_map(|piece| piece.split(|c: char| c.is_whitespace() || "(),;".contains(c)));
    words.into_iter().find_map(|word| word.parse().ok())
}

/// What problems of a kind are compared by.
fn size(problem: &Problem) -> f64 {
    first_number(&problem.message).map_or(0.0, f64::abs)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn overlap(a: usize, depth: f64) -> Problem {
        let what = format!(
            "block `beads_{a:04}` overlaps block `gravel_0001` by {depth:.3e} m, near (-0.1, 2.5, 3)"
        );
        Problem::error(format!("blocks[{a}].placement"), what)
    }

    #[test]
    fn the_sixth_of_a_kind_counts_the_others_with_their_largest() {
        let mut many: Vec<Problem> = (0..857)
            .map(|k| overlap(k, if k == 500 { 0.5 } else { 1e-3 * (k % 7) as f64 }))
            .collect();
        many.insert(3, Problem::warning("fluid", "the water has 3 particles"));
        many.push(Problem::error("time.duration", "must be > 0, found -1"));
        let told = condensed(many);
        assert_eq!(told.len(), 5 + 1 + 2);
        assert_eq!(told[3].path, "fluid");
        assert!(
            told[6]
                .message
                .starts_with("852 more of this kind, the largest: block `beads_0500`"),
            "{}",
            told[6].message
        );
        assert_eq!(told[6].path, "blocks[500].placement");
        assert_eq!(told[7].path, "time.duration");
    }

    #[test]
    fn kinds_differ_by_their_words_and_severity() {
        let words = |what: &'static str, n: usize| (0..n).map(move |_| Problem::error("a", what));
        let (five, six) = (5, 6);
        let all = words("must be > 0, found -1", five).chain(words("must be > 0, found 2e-7", 1));
        assert_eq!(condensed(all.collect()).len(), 6);
        let all = words("too long: 3 m", five).chain(words("too short: 3 m", five));
        assert_eq!(condensed(all.collect()).len(), 10);
        let told = condensed(words("`a` is not known", six).collect());
        assert_eq!(told[5].message, "1 more of this kind: `a` is not known");
    }
}
