//! Separators of columns.

/// Separator of columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Separator {
    Comma,
    Semicolon,
    Tab,
    Space,
}

impl Separator {
    /// Separator of a table by its first two lines: one that gives both the same number of cells, the rarer character
    /// first, or else the rarest of the first line.
    pub(super) fn of(head: &str, next: &str) -> Self {
        let all = [Self::Semicolon, Self::Tab, Self::Comma, Self::Space];
        let mut present = all
            .into_iter()
            .filter(|separator| 1 < separator.n_cells(head));
        let rarest = present.clone().next();
        let fits = |separator: &Self| separator.n_cells(head) == separator.n_cells(next);
        match present.find(fits).or(rarest) {
            // a single column whose name has blanks: `wave height [m]`
            Some(Self::Space) if Self::Space.n_cells(next) == 1 && !starts_with_number(head) => {
                Self::Comma
            }
            Some(separator) => separator,
            None => Self::Space,
        }
    }

    /// Its character.
    pub(super) fn byte(self) -> u8 {
        match self {
            Self::Comma => b',',
            Self::Semicolon => b';',
            Self::Tab => b'\t',
            Self::Space => b' ',
        }
    }

    /// Number in a cell; beside semicolons and tabs it may have a decimal comma.
    pub fn number(self, cell: &str) -> Option<f64> {
        let number = match self {
            Self::Semicolon | Self::Tab if cell.contains(',') => cell.replace(',', ".").parse(),
            _ => cell.parse(),
        };
        number.ok()
    }

    /// Cells of a line; units and quoted texts are no cells of their own.
    fn n_cells(self, line: &str) -> usize {
        let outside = line.split('"').step_by(2);
        if self != Self::Space {
            let character = char::from(self.byte());
            return 1 + outside
                .map(|part| part.matches(character).count())
                .sum::<usize>();
        }
        let n_quoted = line.matches('"').count() / 2;
        let words = outside.flat_map(str::split_whitespace);
        n_quoted + words.filter(|word| !word.starts_with(['[', '('])).count()
    }
}

fn starts_with_number(line: &str) -> bool {
    let first = line.split_whitespace().next();
    first.is_some_and(|word| word.parse::<f64>().is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_lines_tell_the_separator() {
        for (head, next, expected) in [
            ("x,y", "1,2", Separator::Comma),
            ("x;y", "1,5;2", Separator::Semicolon),
            ("1,5\t2", "1,5\t3", Separator::Tab),
            ("x y z", "1 2 3", Separator::Space),
            ("time [s] g1 [m]", "0 1", Separator::Space),
            ("wave height [m]", "0.5", Separator::Comma),
            ("\"a; b\",c", "1,2", Separator::Comma),
            // a name with a semicolon in a table with commas
            ("time [s],a;b [m]", "0.0,1.0", Separator::Comma),
            // a wrong second line leaves the first one to decide
            ("x;y", "1,2", Separator::Semicolon),
            ("1 2 3", "4", Separator::Space),
            ("x,y", "", Separator::Comma),
        ] {
            assert_eq!(Separator::of(head, next), expected, "{head} / {next}");
        }
    }
}
