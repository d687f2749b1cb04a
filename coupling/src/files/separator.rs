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
    /// Separator of a line, the rarer character first.
    pub(crate) fn of(line: &str) -> Self {
        [
            (';', Self::Semicolon),
            ('\t', Self::Tab),
            (',', Self::Comma),
        ]
        .into_iter()
        .find(|(character, _)| line.contains(*character))
        .map_or(Self::Space, |(_, separator)| separator)
    }

    /// Cells of a line, without quotes around them.
    pub(crate) fn cells(self, line: &str) -> impl Iterator<Item = &str> {
        let is_space = self == Self::Space;
        let by = move |c: char| match self {
            Self::Comma => c == ',',
            Self::Semicolon => c == ';',
            Self::Tab => c == '\t',
            Self::Space => c.is_whitespace(),
        };
        let cells = line.trim().split(by);
        cells
            .map(|cell| cell.trim().trim_matches('"').trim())
            .filter(move |cell| !(is_space && cell.is_empty()))
    }

    /// Number in a cell; beside semicolons and tabs it may have a decimal comma.
    pub(crate) fn number(self, cell: &str) -> Option<f64> {
        let number = match self {
            Self::Semicolon | Self::Tab if cell.contains(',') => cell.replace(',', ".").parse(),
            _ => cell.parse(),
        };
        number.ok()
    }
}
