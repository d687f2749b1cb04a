//! Runs that are killed and go on.

use std::path::Path;
use std::time::{Duration, Instant};

use riprap::checkpoint::{self, Checkpoint};

use crate::killed::{TANK, difference, random, results, spawn};
use crate::row::{Failure, Length, Row, Trial};

pub const TRIALS: &[Trial] = &[Trial {
    id: "X22",
    subject: "restart",
    run: restart,
}];

/// Runs that are killed, one moment each.
const KILLS: u32 = 20;

/// The newest checkpoint of a run folder that is whole.
fn newest(folder: &Path) -> Option<Checkpoint> {
    let text = std::fs::read_to_string(folder.join("case.ron")).ok()?;
    let found = checkpoint::newest(folder, &checkpoint::scene_hash(&text)).ok()?;
    found.map(|(checkpoint, _)| checkpoint)
}

/// Files that were being written.
fn half_written(folder: &Path) -> Vec<String> {
    let entries = folder.read_dir().into_iter().flatten().flatten();
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    names.filter(|name| name.ends_with(".partial")).collect()
}

fn restart(_: Length) -> Result<Vec<Row>, Failure> {
    let folder = tempfile::tempdir()?;
    let case = folder.path().join("tank.ron");
    std::fs::write(&case, TANK)?;
    let whole = folder.path().join("whole");
    let start = Instant::now();
    spawn(&case, &whole, &[]).wait()?;
    let duration = start.elapsed();
    let expected = results(&whole);
    let (mut seed, mut rows, mut n_same) = (22, Vec::new(), 0);
    for kill in 1..=KILLS {
        let out = folder.path().join(format!("killed{kill}"));
        let mut child = spawn(&case, &out, &[]);
        // spread over the run, at random within each part of it
        let share = (f64::from(kill - 1) + random(&mut seed)) / f64::from(KILLS);
        let after = duration.mul_f64(share).max(Duration::from_millis(1));
        std::thread::sleep(after);
        let was_over = child.try_wait()?.is_some();
        child.kill()?;
        child.wait()?;
        let from = newest(&out);
        let half = half_written(&out);
        let rows_then = std::fs::read_to_string(out.join("energy.csv")).unwrap_or_default();
        let went_on = spawn(&case, &out, &["--resume"]).wait()?.success();
        let differs = difference(&results(&out), &expected);
        let is_same = went_on && differs.is_none();
        n_same += u32::from(is_same);
        rows.push(Row {
            pushed: format!(
                "`kill -9` {kill} of {KILLS}, a block falls into a tank that has settled"
            ),
            swept: format!(
                "after {:.0} of {:.0} ms",
                1e3 * after.as_secs_f64(),
                1e3 * duration.as_secs_f64()
            ),
            holds: match from {
                _ if was_over => "the run was over".to_owned(),
                None => "before the first checkpoint: begun anew".to_owned(),
                Some(Checkpoint { header, .. }) => format!(
                    "went on from {}t = {:.4} s, step {}",
                    if header.is_settling { "settling, " } else { "" },
                    header.time,
                    header.steps
                ),
            },
            past: match half.as_slice() {
                [] => format!(
                    "{} rows of energy.csv were there",
                    rows_then.lines().count().saturating_sub(1)
                ),
                names => format!("while it wrote {}", names.join(", ")),
            },
            theory: "no file differs from those of a run that was not killed".to_owned(),
            measured: match &differs {
                None => format!("{} files, all the same bytes", expected.len()),
                Some(name) => format!("{name} differs"),
            },
            missed: (!is_same).then(|| "it did not go on to the same files".to_owned()),
            ..Row::default()
        });
    }
    rows.insert(
        0,
        Row {
            pushed: "killed, and gone on with `--resume`".to_owned(),
            swept: format!("{KILLS} moments, all phases, a checkpoint of every state that is kept"),
            holds: "all of the range".to_owned(),
            past: "not reached".to_owned(),
            theory: "the same bits".to_owned(),
            measured: format!("{n_same} of {KILLS} runs ended with the same files to the byte"),
            missed: (n_same < KILLS).then(|| format!("{} did not", KILLS - n_same)),
            ..Row::default()
        },
    );
    Ok(rows)
}
