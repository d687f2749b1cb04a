//! Verification of the shipped studies: error budgets are met by settings hidden from the choice, and no preset
//! is dominated. The tables are those in `benches/trade/results`; nothing is run here.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use riprap::trade::budget::{choose, expect};
use riprap::trade::file::StudyFile;
use riprap::trade::outcome::Outcome;
use riprap::trade::plan;
use riprap::trade::results::read;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../benches/trade")
}

/// Studies with what was measured of them, by name.
fn studies() -> Vec<(String, StudyFile, Vec<Outcome>)> {
    let mut all: Vec<_> = std::fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|end| end == "ron"))
        .map(|path| {
            let (file, _) = plan::read(&path).unwrap();
            let name = path.file_stem().unwrap().to_string_lossy().into_owned();
            let table = folder().join("results").join(&name).join("trade.csv");
            let found = read(&file, &table).unwrap();
            (name, file, found)
        })
        .collect();
    all.sort_by(|a, b| a.0.cmp(&b.0));
    assert!(
        11 <= all.len(),
        "studies are missing: {:?}",
        all.iter().map(|s| &s.0).collect::<Vec<_>>()
    );
    all
}

fn error_of(found: &Outcome) -> Option<f64> {
    found.error.filter(|_| found.is_stable)
}

/// The fold in which all runs are hidden that turn more than one knob.
const COMBINATIONS: usize = 5;

#[test]
fn budgets_are_kept_with_runs_hidden() {
    let budgets = [0.2, 0.1, 0.05, 0.03, 0.02, 0.015, 0.01, 0.007, 0.005];
    let (mut n, mut kept, mut cheap) = (0, 0, 0);
    let (mut n_hidden, mut kept_hidden, mut refused, mut could) = (0, 0, 0, 0);
    println!(
        "study                 choices  within  hidden  within  refused  could have  work over least"
    );
    for (name, file, all) in studies() {
        let candidates: Vec<Vec<usize>> = all.iter().map(|found| found.choice.clone()).collect();
        let mut row = [0; 6];
        let mut ratios = Vec::new();
        for (fold, budget) in (0..6).flat_map(|fold| budgets.map(|budget| (fold, budget))) {
            // the first is what all others are compared with
            let n_turned = |k: usize| all[k].choice.iter().filter(|&&value| value != 0).count();
            let is_hidden = |k: usize| match fold {
                COMBINATIONS => 1 < n_turned(k),
                fold => 0 < k && k % 5 == fold,
            };
            let seen: Vec<Outcome> = (0..all.len())
                .filter(|&k| !is_hidden(k))
                .map(|k| all[k].clone())
                .collect();
            // what was never run in any combination, such as a kernel, nobody can foretell
            let meeting = all
                .iter()
                .filter(|found| error_of(found).is_some_and(|error| error <= budget))
                .filter(|found| expect(&file, &seen, &found.choice).is_some());
            let least = meeting
                .map(|found| found.cost.work())
                .fold(f64::INFINITY, f64::min);
            match choose(&file, &seen, &candidates, budget) {
                Ok(expected) => {
                    let k = all
                        .iter()
                        .position(|found| found.choice == expected.choice)
                        .unwrap();
                    let is_kept = error_of(&all[k]).is_some_and(|error| error <= budget);
                    row[0] += 1;
                    row[1] += usize::from(is_kept);
                    row[2] += usize::from(!expected.is_measured);
                    row[3] += usize::from(!expected.is_measured && is_kept);
                    ratios.push(all[k].cost.work() / least);
                }
                Err(_) => {
                    row[4] += 1;
                    row[5] += usize::from(least.is_finite());
                }
            }
        }
        ratios.sort_by(f64::total_cmp);
        let median = ratios.get(ratios.len() / 2).copied().unwrap_or(f64::NAN);
        println!(
            "{name:<22}{:>6}{:>8}{:>8}{:>8}{:>9}{:>12}{median:>17.2}",
            row[0], row[1], row[2], row[3], row[4], row[5]
        );
        n += row[0];
        kept += row[1];
        n_hidden += row[2];
        kept_hidden += row[3];
        refused += row[4];
        could += row[5];
        cheap += ratios.iter().filter(|&&ratio| ratio <= 1.5).count();
    }
    println!(
        "{kept} of {n} within budget, {kept_hidden} of {n_hidden} of those never seen; {cheap} of {n} within 1.5 of the least \
         work; {refused} said to be out of reach, of which {could} were not"
    );
    // asked
    assert!(9 * n <= 10 * kept, "{kept} of {n}");
    assert!(9 * n <= 10 * cheap, "{cheap} of {n}");
    assert!(
        20 <= n_hidden,
        "the hidden runs are hardly ever chosen: {n_hidden}"
    );
}

/// Errors below it are those of the truths: linear theory, limits extrapolated from three spacings.
const LEAST_ERROR: f64 = 0.005;
/// By which work and error must both be less for a clear margin.
const CLEAR: f64 = 0.8;
/// Studies in which a setting must have been measured to speak of it.
const LEAST_STUDIES: usize = 5;

/// Work and error of each setting of one knob, `knob value`, over those of the first settings; by study.
fn settings() -> BTreeMap<String, BTreeMap<String, [f64; 2]>> {
    let mut all: BTreeMap<String, BTreeMap<String, [f64; 2]>> = BTreeMap::new();
    for (name, file, found) in studies() {
        let has_presets = file.knobs.iter().any(|knob| knob.name == "preset");
        let base = found.iter().find(|f| f.choice.iter().all(|&v| v == 0));
        let Some((base, error)) = base
            .and_then(|b| Some((b, error_of(b)?)))
            .filter(|_| has_presets)
        else {
            continue;
        };
        for one in &found {
            let turned: Vec<usize> = (0..one.choice.len())
                .filter(|&k| one.choice[k] != 0)
                .collect();
            let label = match turned[..] {
                [] => "preset Standard".to_owned(),
                // sound speeds differ from scene to scene by what they are over the fastest flow
                [k] if file.knobs[k].name == "sound speed [m/s]" => {
                    let at = |v: usize| file.knobs[k].values[v].at.unwrap();
                    let ratio = 7.0 * at(one.choice[k]) / at(0);
                    format!("sound speed {:.0}", ratio)
                }
                [k] => format!(
                    "{} {}",
                    file.knobs[k].name, file.knobs[k].values[one.choice[k]].name
                ),
                _ => continue,
            };
            let Some(its) = error_of(one) else { continue };
            let ratio = [
                one.cost.work() / base.cost.work(),
                its.max(LEAST_ERROR) / error.max(LEAST_ERROR),
            ];
            all.entry(label).or_default().insert(name.clone(), ratio);
        }
    }
    all
}

/// Geometric means of work and error of one setting over another, in the studies that have both.
fn over(a: &BTreeMap<String, [f64; 2]>, b: &BTreeMap<String, [f64; 2]>) -> Option<[f64; 2]> {
    let both: Vec<[f64; 2]> = a
        .iter()
        .filter_map(|(study, x)| b.get(study).map(|y| [x[0] / y[0], x[1] / y[1]]))
        .collect();
    let mean = |k: usize| (both.iter().map(|r| r[k].ln()).sum::<f64>() / both.len() as f64).exp();
    (LEAST_STUDIES <= both.len()).then(|| [mean(0), mean(1)])
}

#[test]
fn no_preset_is_dominated() {
    let all = settings();
    for preset in ["Preview", "Standard", "Reference"].map(|name| format!("preset {name}")) {
        let mine = &all[&preset];
        println!("{preset}: {mine:.2?}");
        assert!(
            LEAST_STUDIES <= mine.len(),
            "{preset} was measured in {} studies",
            mine.len()
        );
        for (label, its) in all.iter().filter(|(label, _)| **label != preset) {
            let Some([work, error]) = over(its, mine) else {
                continue;
            };
            println!("  {label:<40} work x {work:.2}, error x {error:.2}");
            assert!(
                CLEAR < work || CLEAR < error,
                "{preset} is dominated by {label}: work x {work:.2}, error x {error:.2}"
            );
        }
    }
    // dearer ones are dearer and better, or they are not worth a name
    let [work, error] = over(&all["preset Preview"], &all["preset Standard"]).unwrap();
    assert!(work < CLEAR, "Preview saves nothing: {work}, {error}");
    // these studies are plane, where `Standard` has the wide kernel of `Reference`; in space it has the narrow one
    let narrow = &all["smoothing length over spacing 1.3"];
    let [_, error] = over(&all["preset Reference"], narrow).unwrap();
    assert!(
        error < CLEAR,
        "Reference is no more accurate than the kernel of Standard in space: {error}"
    );
}

/// The same of errors in a plane, where both have the same kernel.
#[test]
fn reference_is_more_accurate_than_standard_in_a_plane() {
    let all = settings();
    let [_, error] = over(&all["preset Reference"], &all["preset Standard"]).unwrap();
    assert!(
        error < 1.0,
        "Reference is no more accurate than Standard: {error}"
    );
}
