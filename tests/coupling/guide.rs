//! The guide in `docs/`: its scenes run, its commands and options are those of the program, the files that it names exist.

mod commands;
mod pages;
mod words;

use std::path::Path;

use riprap::run::build;
use riprap::scene::access::Access;
use riprap::scene::load_text;
use riprap::scene::parse::Override;

use riprap::world::ledger::Energy;

use crate::support::{case, killed, run};
use pages::{Page, docs, pages};

/// Steps of each scene.
const STEPS: usize = 3;

/// Overrides in the commands of a page, each list with the scene of the page that it is meant for: the last one before it.
fn variants(page: &Page) -> Vec<(String, Vec<Override>)> {
    let mut scene = None;
    let mut found = Vec::new();
    for block in &page.blocks {
        if block.is_scene() {
            scene = Some(block.text.clone());
            found.push((block.text.clone(), Vec::new()));
        } else if let ("sh", Some(scene)) = (block.language.as_str(), &scene) {
            for line in block.text.lines() {
                let overrides = commands::overrides(line);
                if !overrides.is_empty() && commands::runs_a_file_of_the_reader(line) {
                    found.push((scene.clone(), overrides));
                }
            }
        }
    }
    found
}

/// Every complete scene passes its check without a warning and steps, as it stands and as the commands below it change it. Files
/// that it names are those of `cases/`.
#[test]
fn its_scenes_run() {
    let mut n_scenes = 0;
    let cases = case("");
    for page in pages().iter().filter(|page| !page.is_generated()) {
        for (text, overrides) in variants(page) {
            let name = page.name.as_str();
            let access = Access::of(&cases);
            let (scene, warnings) = load_text(name, &text, &overrides, &access)
                .unwrap_or_else(|e| panic!("{name}: {e}"));
            assert!(warnings.located().is_empty(), "{name}: {warnings}");
            let mut world = build(&scene).unwrap();
            for _ in 0..STEPS {
                let step = world.next_step(scene.duration).unwrap();
                world.step(step).unwrap_or_else(|e| panic!("{name}: {e}"));
            }
            n_scenes += 1;
        }
    }
    assert!(
        n_scenes >= 6,
        "{n_scenes} scenes: the reader of the pages lost its way"
    );
}

/// A piece of a scene shown on a page with the complete one is part of it, line by line, so that the two cannot drift apart.
#[test]
fn its_pieces_are_those_of_its_scenes() {
    for page in pages()
        .iter()
        .filter(|page| page.name.starts_with("tutorials/"))
    {
        let scenes: Vec<&str> = page
            .blocks
            .iter()
            .filter(|block| block.is_scene())
            .map(|block| block.text.as_str())
            .collect();
        if scenes.is_empty() {
            continue;
        }
        let lines: Vec<&str> = scenes
            .iter()
            .flat_map(|scene| scene.lines())
            .map(str::trim)
            .collect();
        for block in page
            .blocks
            .iter()
            .filter(|block| block.language == "ron" && !block.is_scene())
        {
            for line in block
                .text
                .lines()
                .map(str::trim)
                .filter(|line| !line.is_empty())
            {
                assert!(
                    lines.contains(&line),
                    "{}: `{line}` is in no scene of the page",
                    page.name
                );
            }
        }
    }
}

/// A file or folder of the repository that a page names in back ticks is there.
#[test]
fn files_that_it_names_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut n_paths = 0;
    for page in pages() {
        for span in page.code_spans() {
            let is_path = [
                "cases/",
                "benches/",
                "dda/",
                "sph/",
                "coupling/",
                "tests/",
                "packaging/",
                "render/",
                "docs/",
            ]
            .iter()
            .any(|folder| span.starts_with(folder));
            if is_path
                && !span.contains(['*', ' ', '{'])
                && span
                    .chars()
                    .all(|c| !c.is_uppercase() || span.contains('.'))
            {
                n_paths += 1;
                assert!(
                    root.join(&span).exists(),
                    "{}: there is no `{span}`",
                    page.name
                );
            }
        }
    }
    assert!(
        n_paths > 20,
        "{n_paths} paths: the reader of the pages lost its way"
    );
}

/// Text of a page.
fn page(name: &str) -> String {
    std::fs::read_to_string(docs().join(name)).unwrap()
}

/// Every column of `energy.csv` has its line.
#[test]
fn columns_of_the_account_of_energy_are_explained() {
    let text = page("concepts/verdict.md");
    for term in Energy::TERMS {
        assert!(text.contains(&format!("`{term}`")), "{term}");
    }
}

/// Every file of a run that writes nearly all of them is listed; the first of numbered ones stands for the others.
#[test]
fn files_of_a_run_are_listed() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("tank.ron");
    std::fs::write(&scene, killed::TANK).unwrap();
    let out = folder.path().join("run");
    run(
        &scene,
        &out,
        &["--until", "0.01", "--set", "time.settle=0.01"],
    );
    let text = page("reference/files.md");
    let mut n_files = 0;
    for entry in std::fs::read_dir(&out).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let is_numbered = name.contains("_0000");
        n_files += 1;
        assert!(
            is_numbered || text.contains(&format!("`{name}`")),
            "{name} is not listed"
        );
    }
    assert!(n_files > 15, "{n_files} files");
}
