//! Mistakes of writing in the words of a scene: the field, the text found, the text to write.
//!
//! RON tells the token that it expected where reading failed. The cause is most often a habit of other formats: a decimal
//! comma, a unit behind a number, quotes around a quantity, a number where one of several kinds must be named.

mod here;

use std::ops::Range;

use crate::scene::locate::tree::Tree;
use here::{Here, is_number, is_of_word};

/// Fields that take one of several kinds, and the kind meant by a bare number.
const KIND_OF_NUMBER: &[(&str, &str)] = &[
    ("resolution", "Spacing"),
    ("slip", "Friction"),
    ("gaps", "Filled"),
    ("density_diffusion", "Fourtakas"),
    ("viscosity", "Artificial"),
    ("shifting", "Fickian"),
    ("static_damping", "Local"),
    ("regularization", "Papanastasiou"),
];

/// Fields that take one of several kinds, and a common kind with fields.
const KIND_WITH_FIELDS: &[(&str, &str)] = &[
    ("shape", "Box(min: (0, 0, 0), max: (1, 1, 1))"),
    ("boundary", "Box(min: (0, 0, 0), max: (1, 1, 1))"),
    ("region", "Box(min: (0, 0, 0), max: (1, 1, 1))"),
    (
        "failure_surface",
        "Plane(point: (0, 0, 0), dip_deg: 30, dip_direction_deg: 90)",
    ),
    ("motion", "Table(file: \"motion.csv\")"),
    ("outline", "Corners([(0, 0), (9, 0), (9, 9)])"),
    ("gauges", "Pressure(name: \"p\", position: (0, 0, 0))"),
    (
        "attachments",
        "PointLoad(block: \"a\", point: (0, 0, 0), force: (0, 0, 1))",
    ),
];

/// Kind that a bare number means in a field that takes several.
pub(super) fn kind_of_number(field: &str) -> Option<&'static str> {
    let kind = KIND_OF_NUMBER.iter().find(|(name, _)| *name == field);
    kind.map(|(_, kind)| *kind)
}

/// Message and location of a common mistake where RON stopped with `error` at the byte `at`; `None` for any other.
pub(super) fn mistake(text: &str, error: &ron::Error, at: usize) -> Option<(String, Range<usize>)> {
    let here = Here::new(text, at);
    match error {
        ron::Error::SuggestRawIdentifier(_) | ron::Error::InvalidIdentifier(_) => here
            .decimal_comma()
            .or_else(|| here.bare_number())
            .or_else(|| here.sign_of_another_format()),
        ron::Error::ExpectedIdentifier => here
            .quoted()
            .or_else(|| here.without_kind())
            .or_else(|| here.bare_number())
            .or_else(|| here.sign_of_another_format()),
        ron::Error::ExpectedFloat | ron::Error::ExpectedInteger => {
            Some(here.quoted().unwrap_or_else(|| here.no_number()))
        }
        ron::Error::ExpectedComma => here
            .behind_a_number()
            .or_else(|| here.sign_of_another_format())
            .or_else(|| Some(here.no_comma())),
        ron::Error::ExpectedStructLikeEnd => here
            .comma_in_parentheses()
            .or_else(|| here.fraction())
            .or_else(|| here.behind_a_number()),
        ron::Error::ExpectedMapColon => here.sign_of_another_format(),
        ron::Error::ExpectedString => Some(here.no_quotes()),
        ron::Error::ExpectedStructLike => here.unclosed().or_else(|| Some(here.no_parentheses())),
        ron::Error::ExpectedNamedStructLike(_) => {
            here.unclosed().or_else(|| Some(here.no_fields()))
        }
        ron::Error::InvalidValueForType { .. } | ron::Error::ExpectedDifferentStructName { .. } => {
            Some(here.no_fields())
        }
        ron::Error::ExpectedArray => here.unclosed().or_else(|| Some(here.no_list())),
        ron::Error::ExpectedDifferentLength { found, .. } => here.number_missing(*found),
        ron::Error::UnexpectedChar(_) => here.behind_a_number(),
        ron::Error::DuplicateStructField { field, .. } => Some((
            format!("`{field}` is written twice; keep one"),
            here.word_span(),
        )),
        _ => here.unclosed(),
    }
}

impl Here<'_> {
    /// `0,6` in place of 0.6.
    fn decimal_comma(&self) -> Option<(String, Range<usize>)> {
        let decimals = self.word();
        let whole = self.before().strip_suffix(',')?;
        let whole = whole.rsplit(|c| !is_of_word(c)).next()?;
        let is_comma = is_number(whole)
            && !whole.contains('.')
            && decimals.chars().all(|c| c.is_ascii_digit())
            && !decimals.is_empty();
        is_comma.then(|| {
            let start = self.at - 1 - whole.len();
            let or = if decimals.len() == 3 {
                format!(", or {whole}{decimals}")
            } else {
                String::new()
            };
            (
                format!("`{whole},{decimals}` has a comma; write {whole}.{decimals}{or}"),
                start..self.at + decimals.len(),
            )
        })
    }

    /// `Spacing(0,1)` or `(0,5, 1, 2)`: a decimal comma, or a number too many.
    fn comma_in_parentheses(&self) -> Option<(String, Range<usize>)> {
        let open = self.before().rfind('(')?;
        let inside = self.text.get(open + 1..)?.split(')').next()?;
        if !inside.chars().all(|c| is_of_word(c) || ", ".contains(c)) {
            return None;
        }
        let numbers: Vec<&str> = inside.split(',').map(str::trim).collect();
        if numbers.len() < 2 || !numbers.iter().all(|number| is_number(number)) {
            return None;
        }
        let is_attached = |k: &usize| {
            inside
                .get(k + 1..)
                .is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()))
        };
        let attached: Vec<usize> = inside
            .match_indices(',')
            .map(|(k, _)| k)
            .filter(is_attached)
            .collect();
        let n_wanted = numbers.len() - attached.len();
        let is_mixed =
            !attached.is_empty() && (n_wanted == 1 || attached.len() + 1 < numbers.len());
        if is_mixed {
            let start = open + 1 + attached[0];
            let decimals = Here {
                text: self.text,
                at: start + 1,
            };
            return decimals.decimal_comma();
        }
        let span = open..open + inside.len() + 2;
        let message = format!(
            "found {} numbers in `({inside})`, one or more too many; decimals follow a point, not a comma",
            numbers.len()
        );
        Some((message, span))
    }

    /// `Count(1000.5)`: a fraction in place of a whole number.
    fn fraction(&self) -> Option<(String, Range<usize>)> {
        let word = self.word();
        let is_fraction = is_number(word) && word.contains(['.', 'e', 'E']);
        is_fraction.then(|| {
            let owner = self.owner();
            (
                format!("`{owner}` takes a whole number, found {word}"),
                self.word_span(),
            )
        })
    }

    /// `resolution: 40`: one of several kinds is not named.
    fn bare_number(&self) -> Option<(String, Range<usize>)> {
        let (field, word) = (self.field()?, self.word());
        if !is_number(word) {
            return None;
        }
        let kind = KIND_OF_NUMBER.iter().find(|(name, _)| *name == field);
        let right = kind.map_or_else(
            || "write one of the words in docs/reference/scene".to_owned(),
            |(_, kind)| format!("write {kind}({word})"),
        );
        Some((
            format!("`{field}` does not say what {word} is; {right}"),
            self.word_span(),
        ))
    }

    /// A quantity, a kind or the name of a field in quotes.
    fn quoted(&self) -> Option<(String, Range<usize>)> {
        let inside = self.text_in_quotes()?;
        let span = self.at..self.at + inside.len() + 2;
        let Some(field) = self.field() else {
            let owner = self.owner();
            let message = if is_number(inside) {
                format!("`{owner}` takes a number, found \"{inside}\" in quotes; write {inside}")
            } else {
                format!(
                    "expected the name of a field, found \"{inside}\" in quotes; write {inside}"
                )
            };
            return Some((message, span));
        };
        let kind = KIND_OF_NUMBER.iter().find(|(name, _)| *name == field);
        let right = match kind {
            Some((_, kind)) if is_number(inside) => format!("{kind}({inside})"),
            _ => inside.to_owned(),
        };
        let what = if is_number(inside) {
            "a number"
        } else {
            "a word"
        };
        let first = inside.split_whitespace().next().unwrap_or_default();
        let message = if let (Some((_, kind)), true) =
            (kind, is_number(first) && !is_number(inside))
        {
            format!("`{field}` does not say what \"{inside}\" is; write {kind}(\"{inside}\")")
        } else if kind.is_none() && !is_number(inside) && is_number(first) {
            format!(
                "`{field}` takes a number without a unit, found \"{inside}\" in quotes; write {first}"
            )
        } else {
            format!("`{field}` takes {what}, found \"{inside}\" in quotes; write {right}")
        };
        Some((message, span))
    }

    /// `shape: (min: ...)`: a parenthesis without its kind.
    fn without_kind(&self) -> Option<(String, Range<usize>)> {
        if !self.rest().starts_with(['(', '[']) {
            return None;
        }
        let Some(field) = self.field().or_else(|| self.list()) else {
            return Some(self.without_names());
        };
        let inside = self.rest().get(1..)?.split(')').next()?.trim();
        let number = KIND_OF_NUMBER.iter().find(|(name, _)| *name == field);
        let fields = KIND_WITH_FIELDS.iter().find(|(name, _)| *name == field);
        let right = match (number, fields) {
            (Some((_, kind)), _) if is_number(inside) => format!("write {kind}({inside})"),
            (_, Some((_, example))) => format!("such as {example}"),
            _ => "see docs/reference/scene".to_owned(),
        };
        Some((
            format!(
                "`{field}` does not say which kind it is before `{}`; {right}",
                self.found()
            ),
            self.found_span(),
        ))
    }

    /// `Box((0, 0, 0), (1, 1, 1))`: fields without their names.
    fn without_names(&self) -> (String, Range<usize>) {
        let owner = self.owner();
        (
            format!("`{owner}` takes its fields by name, {owner}(name: value, ...), found `(`"),
            self.found_span(),
        )
    }

    /// A comment, an assignment or a separator of another format.
    fn sign_of_another_format(&self) -> Option<(String, Range<usize>)> {
        let message = match self.rest().chars().next()? {
            '#' => "a comment begins with `//`, found `#`".to_owned(),
            ';' => "values are separated by commas, found `;`".to_owned(),
            '=' => "a field and its value are separated by a colon, found `=`".to_owned(),
            '(' => {
                let kind = self.before().rsplit(|c| !is_of_word(c)).next()?;
                if kind.is_empty() || is_number(kind) {
                    return None;
                }
                format!("`{kind}` takes no parentheses; write {kind}")
            }
            _ => return None,
        };
        Some((message, self.found_span()))
    }

    /// A value that should be a number.
    fn no_number(&self) -> (String, Range<usize>) {
        let (owner, found) = (self.owner(), self.found());
        let message = match found {
            "," | ")" | "]" | "}" => format!("`{owner}` has no value; write a number after it"),
            _ if found.starts_with(|c: char| c.is_ascii_digit()) && found.contains('.') => {
                format!("`{owner}` takes a number, found `{found}`; write digits with one point")
            }
            _ if self
                .rest()
                .split(['(', ')', ','])
                .next()
                .is_some_and(|word| word.contains(':') && !word.contains('"')) =>
            {
                format!("a point is three numbers without names, (x, y, z), found `{found}:`")
            }
            _ => format!("`{owner}` takes a number, found `{found}`"),
        };
        (message, self.found_span())
    }

    /// A number followed by something on the same line: a unit, more digits, an operator.
    fn behind_a_number(&self) -> Option<(String, Range<usize>)> {
        let line = self.before().rsplit('\n').next()?.trim_end();
        let line = line.strip_suffix(['/', '*']).map_or(line, str::trim_end);
        let word = line.rsplit(|c| !is_of_word(c)).next()?;
        let here = self.word();
        // reading may have stopped within a word such as `1s`
        let all = if word.is_empty() { here } else { word };
        let n = all
            .find(|c: char| !(c.is_ascii_digit() || ".+-".contains(c)))
            .unwrap_or(all.len());
        let (number, attached) = all.split_at_checked(n)?;
        if !is_number(number) {
            return None;
        }
        let behind = if word.is_empty() {
            attached
        } else {
            self.found()
        };
        let operator = self
            .before()
            .trim_end()
            .chars()
            .last()
            .filter(|c| "/*".contains(*c));
        let first = operator.or_else(|| behind.chars().next())?;
        let message = match first {
            '/' | '*' => {
                format!("a number is not computed, found `{number}{first}`; write the result")
            }
            '\'' | '0'..='9' => {
                let behind = self.rest().split([',', ')', '\n']).next()?;
                let gap = if first == '\'' { "" } else { " " };
                format!(
                    "found `{number}{gap}{behind}`; a comma goes between numbers, nothing between thousands"
                )
            }
            _ if first.is_alphabetic() || "°%".contains(first) => format!(
                "`{number}` is followed by `{behind}`; write {number} alone, or number and unit in quotes, \"{number} {behind}\""
            ),
            _ => return None,
        };
        Some((message, self.found_span()))
    }

    fn no_comma(&self) -> (String, Range<usize>) {
        let end = self.before().trim_end().len();
        let found = self.found();
        (
            format!("expected a comma after this, before `{found}`"),
            end.saturating_sub(1)..end,
        )
    }

    /// A name without its quotes.
    fn no_quotes(&self) -> (String, Range<usize>) {
        let (owner, found) = (self.owner(), self.found());
        let inside = self.text_in_quotes();
        let (found, right) = match inside {
            Some(inside) => (format!("'{inside}'"), inside),
            None => (found.to_owned(), found),
        };
        (
            format!("`{owner}` takes a text in double quotes, found `{found}`; write \"{right}\""),
            self.at..self.at + found.len(),
        )
    }

    /// A point or the value of a kind without parentheses.
    fn no_parentheses(&self) -> (String, Range<usize>) {
        let found = self.found();
        let message = match self.field() {
            Some(field) if found == "[" => {
                format!("`{field}` takes numbers in parentheses, found `[`; write ( and )")
            }
            Some(field) => {
                format!("`{field}` takes several numbers, such as (x, y, z), found `{found}`")
            }
            None if found == "[" => "numbers of a point stand in parentheses, found `[`".to_owned(),
            None => {
                let kind = self.before().trim_end().rsplit(|c| !is_of_word(c)).next();
                let kind = kind.filter(|kind| !kind.is_empty()).unwrap_or("a kind");
                format!(
                    "`{kind}` takes its value in parentheses, such as {kind}(1), found `{found}`"
                )
            }
        };
        (message, self.found_span())
    }

    /// A group of fields without parentheses.
    fn no_fields(&self) -> (String, Range<usize>) {
        let (found, span) = (self.found(), self.found_span());
        let message = match self.field().or_else(|| self.list()) {
            Some(field) if found == "true" => {
                format!(
                    "`{field}` takes its fields in parentheses, found `true`; write {field}: ()"
                )
            }
            Some(field) => format!(
                "`{field}` takes fields in parentheses, (name: value, ...), found `{found}`"
            ),
            None => format!("a scene stands in parentheses, (title: ..., ...), found `{found}`"),
        };
        (message, span)
    }

    fn no_list(&self) -> (String, Range<usize>) {
        let (owner, found) = (self.owner(), self.found());
        (
            format!("`{owner}` takes a list in brackets, [...], found `{found}`"),
            self.found_span(),
        )
    }

    fn number_missing(&self, n_found: usize) -> Option<(String, Range<usize>)> {
        let open = self.before().rfind('(')?;
        let inside = self.text.get(open..)?.split(')').next()?;
        Some((
            format!("found {n_found} numbers in `{inside})`, one or more are missing"),
            open..open + inside.len() + 1,
        ))
    }

    /// A parenthesis or bracket that is not closed, where the text ends or another closes.
    fn unclosed(&self) -> Option<(String, Range<usize>)> {
        if !(self.rest().is_empty() || self.rest().starts_with([')', ']', '}'])) {
            return None;
        }
        let flaw = Tree::new(self.text).flaw?;
        Some((flaw.message, flaw.span))
    }
}
