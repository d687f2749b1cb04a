//! A row of the margin table, the table and its page.

use std::fmt::{self, Display};

/// Failure of a trial.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;

/// How long the long trials are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Length {
    /// So that all of them take minutes.
    Short,
    /// As asked, where that is hours.
    Full,
}

impl Length {
    /// One or the other.
    pub fn choose<T>(self, short: T, full: T) -> T {
        match self {
            Self::Short => short,
            Self::Full => full,
        }
    }
}

/// One or more rows.
#[derive(Clone, Copy)]
pub struct Trial {
    /// X01 and on, or a word.
    pub id: &'static str,
    /// Name for filters.
    pub subject: &'static str,
    pub run: fn(Length) -> Result<Vec<Row>, Failure>,
}

/// Result of a sweep.
#[derive(Clone, Debug, Default)]
pub struct Row {
    pub id: &'static str,
    /// Swept parameter and setup.
    pub pushed: String,
    /// From where to where.
    pub swept: String,
    /// The last that holds and the first that does not.
    pub holds: String,
    /// Behavior beyond the limit.
    pub past: String,
    pub theory: String,
    /// The invariant with its figure, and what was asked.
    pub measured: String,
    /// Why it is a miss, where it is one.
    pub missed: Option<String>,
}

impl Row {
    /// A trial that could not even be set up.
    pub fn broken(subject: &str, why: String) -> Self {
        Self {
            pushed: subject.to_owned(),
            past: why.clone(),
            missed: Some(format!("the trial ended early: {why}")),
            ..Self::default()
        }
    }
}

impl Display for Row {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = match &self.missed {
            None => "holds".to_owned(),
            Some(why) => format!("MISSED: {why}"),
        };
        writeln!(out, "{} {}", self.id, self.pushed)?;
        for (name, text) in [
            ("range", &self.swept),
            ("holds to", &self.holds),
            ("beyond", &self.past),
            ("theory", &self.theory),
            ("measured", &self.measured),
            ("verdict", &verdict),
        ] {
            writeln!(out, "    {name:<9} {text}")?;
        }
        Ok(())
    }
}

/// Columns of the table.
const COLUMNS: [&str; 8] = [
    "row",
    "parameter",
    "range",
    "holds to",
    "beyond",
    "theory",
    "measured",
    "missed because",
];

impl Row {
    fn cells(&self) -> [String; 8] {
        [
            self.id,
            &self.pushed,
            &self.swept,
            &self.holds,
            &self.past,
            &self.theory,
            &self.measured,
            self.missed.as_deref().unwrap_or_default(),
        ]
        .map(|cell| cell.replace('\n', " "))
    }
}

/// Rows of an earlier table and new ones, which replace those of the same name.
pub fn merged(before: &str, rows: &[Row]) -> Result<Vec<[String; 8]>, Failure> {
    let mut all: Vec<[String; 8]> = csv::Reader::from_reader(before.as_bytes())
        .deserialize()
        .collect::<Result<_, _>>()?;
    for row in rows {
        let cells = row.cells();
        match all.iter_mut().find(|old| old[..2] == cells[..2]) {
            Some(old) => *old = cells,
            None => all.push(cells),
        }
    }
    // X01 to X23, then the others, each in the order they came
    all.sort_by_key(|cells| (!cells[0].starts_with('X'), cells[0].clone()));
    Ok(all)
}

/// The table as CSV.
pub fn table(rows: &[[String; 8]]) -> Result<Vec<u8>, Failure> {
    let mut out = csv::Writer::from_writer(Vec::new());
    out.write_record(COLUMNS)?;
    for row in rows {
        out.write_record(row)?;
    }
    Ok(out.into_inner().map_err(|error| error.to_string())?)
}

/// The page of the table: limits and misses.
pub fn page(rows: &[[String; 8]]) -> String {
    let missed: Vec<_> = rows.iter().filter(|row| !row[7].is_empty()).collect();
    let mut text = format!(
        "# Extremes\n\n\
         Every quantity is swept until something fails. Written by `cargo bench -p riprap --bench extremes`, single rows by\n\
         `-- X04 write`, longer ones by `-- long X13 write`. `extremes.csv` holds the whole table: range, limit, behavior beyond,\n\
         theory, measured values.\n\n\
         {} rows, {} missed:\n\n",
        rows.len(),
        missed.len()
    );
    for row in missed {
        text += &format!("- {}, {}: {}\n", row[0], row[1], row[7]);
    }
    text += "\n| | parameter | holds to |\n|---|---|---|\n";
    for [id, pushed, _, holds, ..] in rows {
        let cell = |text: &str| text.replace('|', "\\|");
        text += &format!("| {id} | {} | {} |\n", cell(pushed), cell(holds));
    }
    text
}

/// How far a sweep held.
#[derive(Clone, Debug)]
pub struct Margin {
    pub last_good: Option<f64>,
    pub first_bad: Option<f64>,
    /// Finding at the first value that fails.
    pub past: String,
}

impl Margin {
    /// In words.
    pub fn holds(&self, unit: &str) -> String {
        match (self.last_good, self.first_bad) {
            (Some(good), None) => format!("all of the range, to {good:.3e} {unit}"),
            (Some(good), Some(bad)) => format!("{good:.3e} {unit}; not {bad:.3e} {unit}"),
            (None, Some(bad)) => format!("not even {bad:.3e} {unit}"),
            (None, None) => "nothing was tried".to_owned(),
        }
    }

    /// In words, what happens past it.
    pub fn past(&self) -> String {
        match self.first_bad {
            None => "not reached".to_owned(),
            Some(_) => self.past.clone(),
        }
    }
}

/// Tries values in order up to the first that fails, then halves the gap in the logarithm `n_halvings` times. A trial
/// answers with what is wrong.
pub fn sweep(
    values: &[f64],
    n_halvings: u32,
    mut trial: impl FnMut(f64) -> Result<(), String>,
) -> Margin {
    let mut margin = Margin {
        last_good: None,
        first_bad: None,
        past: String::new(),
    };
    for &value in values {
        match trial(value) {
            Ok(()) => margin.last_good = Some(value),
            Err(why) => {
                margin.first_bad = Some(value);
                margin.past = why;
                break;
            }
        }
    }
    for _ in 0..n_halvings {
        let (Some(good), Some(bad)) = (margin.last_good, margin.first_bad) else {
            break;
        };
        let middle = if good > 0.0 && bad > 0.0 {
            (good * bad).sqrt()
        } else {
            0.5 * (good + bad)
        };
        match trial(middle) {
            Ok(()) => margin.last_good = Some(middle),
            Err(why) => {
                margin.first_bad = Some(middle);
                margin.past = why;
            }
        }
    }
    margin
}

/// Values from `first` on, each `factor` times the one before, up to `last`.
pub fn decades(first: f64, last: f64, factor: f64) -> Vec<f64> {
    std::iter::successors(Some(first), |x| Some(x * factor))
        .take_while(|x| *x <= last * (1.0 + 1e-9))
        .collect()
}
