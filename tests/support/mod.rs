//! Running the program and reading its output.

pub mod killed;
pub mod scene;
pub mod synthetic_run;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A case of the repository.
pub fn case(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../cases")
        .join(name)
}

/// The program with arguments.
pub fn riprap(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_riprap"))
        .args(arguments)
        .output()
        .unwrap()
}

/// Runs a scene into a folder; its summary. Fails with the program's words.
pub fn run(case: &Path, folder: &Path, extra: &[&str]) -> serde_json::Value {
    let mut arguments = vec![
        "run",
        case.to_str().unwrap(),
        "-o",
        folder.to_str().unwrap(),
        "--quiet",
    ];
    arguments.extend(extra);
    let output = riprap(&arguments);
    assert!(output.status.success(), "{}", words(&output));
    summary(folder)
}

/// The summary of a run folder.
pub fn summary(folder: &Path) -> serde_json::Value {
    serde_json::from_str(&std::fs::read_to_string(folder.join("summary.json")).unwrap()).unwrap()
}

/// Standard error of the program.
pub fn words(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Numbers of a table without its heading. Names, which come last, are left out.
pub fn table(path: &Path) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(path).unwrap();
    let is_text = |header: &&str| matches!(*header, "name" | "partner_name");
    let heading = text.lines().next().unwrap_or_default();
    let n = heading
        .split(',')
        .take_while(|header| !is_text(header))
        .count();
    let numbers = |line: &str| -> Vec<f64> {
        (line.split(',').take(n))
            .map(|x| x.parse().unwrap())
            .collect()
    };
    text.lines().skip(1).map(numbers).collect()
}
