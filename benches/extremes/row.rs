//! A row of the margin table, and how the table is written.

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

impl Row {
    /// Its first two cells, which identify it, and all of them.
    fn line(&self) -> (String, String) {
        let verdict = match &self.missed {
            None => "holds".to_owned(),
            Some(why) => format!("**MISSED**: {why}"),
        };
        let cell = |text: &str| format!("| {} ", text.replace('|', "\\|").replace('\n', " "));
        let name = cell(self.id) + &cell(&self.pushed);
        let others = [
            &self.swept,
            &self.holds,
            &self.past,
            &self.theory,
            &self.measured,
            &verdict,
        ];
        let cells: String = others.iter().map(|text| cell(text)).collect();
        (name.clone(), format!("{name}{cells}|\n"))
    }
}

/// The table, in which new rows replace those of the same name: all, or those that were rerun.
pub fn table(before: &str, rows: &[Row]) -> String {
    let mut lines: Vec<String> = before
        .lines()
        .skip_while(|line| !line.starts_with("|---"))
        .skip(1)
        .map(|line| format!("{line}\n"))
        .collect();
    for row in rows {
        let (name, line) = row.line();
        match lines.iter_mut().find(|line| line.starts_with(&name)) {
            Some(old) => *old = line,
            None => lines.push(line),
        }
    }
    // X01 to X23, then the others, each in the order they came
    lines.sort_by_key(|line| {
        let id = line
            .trim_start_matches("| ")
            .split(' ')
            .next()
            .unwrap_or("");
        (!id.starts_with('X'), id.to_owned())
    });
    let missed = lines
        .iter()
        .filter(|line| line.contains("**MISSED**"))
        .count();
    format!(
        "# Extremes\n\n\
         Every quantity is swept until something fails: its limit, the behavior beyond, and theory. Written by\n\
         `cargo bench -p riprap --bench extremes`, single rows by `-- X04 write`, longer ones by `-- long X13 write`.\n\
         {} rows, {missed} missed.\n\n\
         | | parameter | range | holds to | beyond | theory | measured | verdict |\n\
         |---|---|---|---|---|---|---|---|\n{}",
        lines.len(),
        lines.concat()
    )
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
