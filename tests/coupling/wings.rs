//! The order of the wings: who may import whom, in all three crates.
//!
//! Read from the text: every `crate::` and `super::` path outside of tests, down to the file that it ends in.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Wings from the top to the ground; those of one row know nothing of each other.
///
/// Pictures stand above the output that they are drawn from. Files are formats that scenes read, too.
const COUPLING: &[&[&str]] = &[
    &["cli"],
    &["study"],
    &["run"],
    &["picture"],
    &["output"],
    &["scene"],
    &["world"],
    &["joints"],
    &["walls", "openings"],
    &["files", "saved", "series", "build_info"],
];

/// Wings of the water.
const SPH: &[&[&str]] = &[
    &["stepping"],
    &["boundary"],
    &["fluid"],
    &["terms"],
    &["settings"],
    &["neighbors"],
    &["stability", "preset"],
    &["particles", "scheme"],
    &["kernel"],
    &["simd"],
    &["rheology", "state_equation", "chunks"],
    &["error"],
    &["id"],
];

/// Wings of the blocks, whose state includes the history of their contacts.
const DDA: &[&[&str]] = &[
    &["step"],
    &["blocks"],
    &["contact"],
    &["motion", "rock_mass"],
    &["geometry"],
    &["material"],
    &["error"],
    &["ranges", "random", "chunks", "id"],
];

/// Modules of a crate by their path without `crate`; `[]` is the root.
type Modules = BTreeMap<Vec<String>, String>;

fn modules(crate_name: &str) -> Modules {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("..")
        .join(crate_name)
        .join("src");
    let mut modules = Modules::new();
    let mut folders = vec![(root, Vec::new())];
    while let Some((folder, path)) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let entry = entry.unwrap().path();
            let name = entry.file_stem().unwrap().to_str().unwrap().to_owned();
            let mut module: Vec<String> = path.clone();
            if entry.is_dir() {
                module.push(name);
                folders.push((entry, module));
            } else if entry.extension().is_some_and(|e| e == "rs") && name != "main" {
                if name != "lib" {
                    module.push(name);
                }
                modules.insert(module, code(&std::fs::read_to_string(&entry).unwrap()));
            }
        }
    }
    modules
}

/// Text without comments and without the tests, which stand last.
fn code(text: &str) -> String {
    let shipped = match text.find("\nmod tests {") {
        None => text,
        Some(at) => &text[..text[..at].rfind("#[cfg(test)]").unwrap_or(at)],
    };
    let lines = shipped.lines().map(|line| line.split("//").next().unwrap());
    lines.collect::<Vec<_>>().join("\n")
}

/// Every path that starts with `crate` or `super` in a module, from the root of the crate.
fn paths(module: &[String], text: &str) -> Vec<Vec<String>> {
    let mut found = Vec::new();
    for root in ["crate::", "super::"] {
        for (at, _) in text.match_indices(root) {
            let before = text[..at].chars().next_back();
            // the later ones of `super::super::` are read with the first
            if before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':') {
                continue;
            }
            read_tree(&text[at..], &mut Vec::new(), &mut found);
        }
    }
    let absolute = |path: Vec<String>| {
        let n_up = path.iter().take_while(|name| *name == "super").count();
        let base = if n_up == 0 {
            &[]
        } else {
            &module[..module.len().saturating_sub(n_up)]
        };
        let rest = &path[n_up.max(1)..];
        [base, rest].concat()
    };
    found.into_iter().map(absolute).collect()
}

/// Reads `a::b::{c, d::e}`; returns its length.
fn read_tree(text: &str, path: &mut Vec<String>, found: &mut Vec<Vec<String>>) -> usize {
    let depth = path.len();
    let mut at = 0;
    loop {
        let rest = &text[at..];
        if rest.starts_with('{') {
            at += 1;
            loop {
                at += text[at..].len() - text[at..].trim_start_matches([' ', '\n', ',']).len();
                if text[at..].starts_with('}') {
                    at += 1;
                    break;
                }
                let read = read_tree(&text[at..], path, found);
                if read == 0 {
                    break;
                }
                at += read;
            }
            break;
        }
        let n = rest
            .find(|c: char| !c.is_alphanumeric() && c != '_' && c != '*')
            .unwrap_or(rest.len());
        if n == 0 {
            break;
        }
        path.push(rest[..n].to_owned());
        at += n;
        if let Some(renamed) = text[at..].strip_prefix(" as ") {
            let n = renamed
                .find(|c: char| !c.is_alphanumeric() && c != '_')
                .unwrap_or(renamed.len());
            at += " as ".len() + n;
        }
        if !text[at..].starts_with("::") {
            found.push(path.clone());
            break;
        }
        at += "::".len();
    }
    path.truncate(depth);
    at
}

/// The module that a path ends in: the longest start of it that is a file.
fn target(modules: &Modules, path: &[String]) -> Vec<String> {
    (0..=path.len())
        .rev()
        .map(|n| path[..n].to_vec())
        .find(|start| modules.contains_key(start))
        .unwrap_or_default()
}

/// Modules that each module imports, but the root.
fn imports(modules: &Modules) -> BTreeMap<Vec<String>, BTreeSet<Vec<String>>> {
    let of = |(module, text): (&Vec<String>, &String)| {
        let targets = paths(module, text)
            .into_iter()
            .map(|path| target(modules, &path));
        let others = targets
            .filter(|to| to != module && !to.is_empty())
            .collect();
        (module.clone(), others)
    };
    modules.iter().map(of).collect()
}

/// Imports against the order, as sentences.
fn against(crate_name: &str, order: &[&[&str]]) -> Vec<String> {
    let floor = |wing: &str| order.iter().position(|row| row.contains(&wing));
    let modules = modules(crate_name);
    let mut faults = Vec::new();
    for (module, targets) in imports(&modules) {
        let Some(wing) = module.first() else { continue };
        let Some(from) = floor(wing) else {
            faults.push(format!(
                "{crate_name}/src/{wing} stands in no row of the order"
            ));
            continue;
        };
        for target in targets.iter().filter(|target| target[0] != *wing) {
            let is_below = floor(&target[0]).is_some_and(|to| from < to);
            if !is_below {
                faults.push(format!(
                    "{crate_name}: {} imports {}, which is not below it",
                    module.join("::"),
                    target.join("::")
                ));
            }
        }
    }
    faults
}

#[test]
fn imports_go_down() {
    for (crate_name, order) in [("coupling", COUPLING), ("sph", SPH), ("dda", DDA)] {
        let faults = against(crate_name, order);
        assert!(faults.is_empty(), "{}", faults.join("\n"));
    }
}

/// Files of a circle of imports, other than a module with its own children.
fn circles(crate_name: &str) -> Vec<String> {
    let imports = imports(&modules(crate_name));
    let mut reached = imports.clone();
    // the closure: as many rounds as the longest way
    loop {
        let longer: BTreeMap<_, BTreeSet<_>> = reached
            .iter()
            .map(|(from, to)| {
                let next = to.iter().flat_map(|via| &reached[via]);
                (from.clone(), to.iter().chain(next).cloned().collect())
            })
            .collect();
        if longer == reached {
            break;
        }
        reached = longer;
    }
    let mut seen = BTreeSet::new();
    let mut found = Vec::new();
    for (module, to) in &reached {
        let circle: Vec<_> = to
            .iter()
            .filter(|other| reached[*other].contains(module))
            .collect();
        let Some(parent) = circle.iter().min_by_key(|other| other.len()) else {
            continue;
        };
        let is_family = circle.iter().all(|other| other.starts_with(parent));
        if !is_family && seen.insert(circle.clone()) {
            let names: Vec<_> = circle.iter().map(|other| other.join("::")).collect();
            found.push(format!("{crate_name}: {}", names.join(", ")));
        }
    }
    found
}

#[test]
fn no_circle_of_imports_is_larger_than_a_module_with_its_children() {
    let all = ["coupling", "sph", "dda"].into_iter();
    let found: Vec<_> = all.flat_map(circles).collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn what_is_read_is_never_computed_with() {
    let may_name = |module: &[String]| {
        module.first().is_some_and(|wing| wing == "scene")
            || module.join("::").starts_with("output::run_folder")
    };
    let found: Vec<_> = modules("coupling")
        .into_iter()
        .filter(|(module, text)| {
            let named = ["SceneFile", "scene.file", "scene::file"];
            !may_name(module) && named.iter().any(|name| text.contains(name))
        })
        .map(|(module, _)| module.join("::"))
        .collect();
    assert!(
        found.is_empty(),
        "the schema of the scene is named in {}",
        found.join(", ")
    );
}
