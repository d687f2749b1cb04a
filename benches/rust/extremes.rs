//! Limits of the engine: every extreme is swept until it fails.
//!
//! `cargo bench -p riprap --bench extremes` runs all of them, prints a row for each and writes `benches/extremes.csv` and its
//! page: the swept parameter, its limit, the behavior beyond, and theory. With words after `--` it runs the rows with one of them in their
//! name or subject, and only prints, `-- X04 friction`; with `write` among them it updates these rows of the table. `-- long` runs
//! the long ones at full length.
#![expect(clippy::print_stdout, reason = "a benchmark reports")]

#[path = "extremes/contact.rs"]
mod contact;
#[path = "extremes/coupled.rs"]
mod coupled;
#[path = "extremes/input.rs"]
mod input;
#[path = "../../tests/support/killed.rs"]
#[expect(clippy::unwrap_used, reason = "shared with a test")]
mod killed;
#[path = "extremes/masses.rs"]
mod masses;
#[path = "extremes/restart.rs"]
mod restart;
#[path = "extremes/rock.rs"]
mod rock;
#[path = "extremes/row.rs"]
mod row;
#[path = "extremes/shapes.rs"]
mod shapes;
#[path = "extremes/stacks.rs"]
mod stacks;
#[path = "extremes/steps.rs"]
mod steps;
#[path = "extremes/tank.rs"]
mod tank;
#[path = "extremes/water.rs"]
mod water;

use std::path::Path;
use std::time::Instant;

use row::{Failure, Length, Row, Trial, merged, page, table};

/// Every trial, in the order of the table.
fn trials() -> Vec<Trial> {
    [
        contact::TRIALS,
        masses::TRIALS,
        shapes::TRIALS,
        stacks::TRIALS,
        steps::TRIALS,
        water::TRIALS,
        coupled::TRIALS,
        restart::TRIALS,
        input::TRIALS,
    ]
    .concat()
}

fn main() -> Result<(), Failure> {
    let mut words: Vec<String> = std::env::args()
        .skip(1)
        .filter(|word| word != "--bench")
        .collect();
    let is_long = words.iter().any(|word| word == "long");
    words.retain(|word| word != "long");
    let writes = words.iter().any(|word| word == "write");
    words.retain(|word| word != "write");
    let length = if is_long { Length::Full } else { Length::Short };
    let mut trials = trials();
    trials.sort_by_key(|trial| (!trial.id.starts_with('X'), trial.id));
    let mut rows: Vec<Row> = Vec::new();
    let start = Instant::now();
    for trial in &trials {
        let is_wanted = |word: &String| trial.id == word || trial.subject.contains(word.as_str());
        if !words.is_empty() && !words.iter().any(is_wanted) {
            continue;
        }
        let begun = Instant::now();
        let found = (trial.run)(length)
            .unwrap_or_else(|failure| vec![Row::broken(trial.subject, failure.to_string())]);
        for mut row in found {
            row.id = trial.id;
            println!("{row}");
            rows.push(row);
        }
        println!("  ({:.1} s)", begun.elapsed().as_secs_f64());
    }
    let seconds = start.elapsed().as_secs_f64();
    let missed = rows.iter().filter(|row| row.missed.is_some()).count();
    println!("{} rows, {missed} missed, {seconds:.0} s", rows.len());
    if writes || words.is_empty() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../benches");
        let path = folder.join("extremes.csv");
        let before = if words.is_empty() {
            String::new()
        } else {
            std::fs::read_to_string(&path).unwrap_or_default()
        };
        let rows = merged(&before, &rows)?;
        std::fs::write(&path, table(&rows)?)?;
        std::fs::write(folder.join("EXTREMES.md"), page(&rows))?;
        println!("wrote {}", path.display());
    }
    Ok(())
}
