//! Notes the commit that the program is built from, for `summary.json`.

use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=../.git/HEAD");
    println!("cargo::rerun-if-changed=../.git/logs/HEAD");
    let commit = Command::new("git")
        .args(["rev-parse", "--short=12", "HEAD"])
        .output()
        .ok()
        .filter(|output| output.status.success())
        .and_then(|output| String::from_utf8(output.stdout).ok());
    // a source archive has no commit: the program then says "unknown"
    if let Some(commit) = commit {
        println!("cargo::rustc-env=RIPRAP_COMMIT={}", commit.trim());
    }
}
