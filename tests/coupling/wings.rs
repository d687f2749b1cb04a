//! The order of the wings: who may import whom, in all three crates.
//!
//! A name that a module re-exports counts for that module and for the file that defines it.

mod imports;

use std::collections::{BTreeMap, BTreeSet};

use imports::{imports, modules, taken_whole};

/// Wings from the top to the ground; those of one row know nothing of each other.
///
/// Pictures stand above the output that they are drawn from. Files are formats that scenes read, too.
const COUPLING: &[&[&str]] = &[
    &["cli"],
    &["study"],
    &["run"],
    &["picture", "handoff"],
    &["output"],
    &["scene"],
    &["world"],
    &["joints"],
    &["grains"],
    &["walls", "openings"],
    &["files", "saved", "series", "waves", "build_info"],
    &["messages"],
];

/// Wings of the water.
///
/// The settings name what they choose among: planes of symmetry and periodic sides as the search knows them. Sums and
/// the stability of sound read the settings.
const SPH: &[&[&str]] = &[
    &["stepping"],
    &["boundary"],
    &["fluid"],
    &["terms", "stability"],
    &["settings"],
    &["neighbors"],
    &["preset"],
    &["particles", "scheme"],
    &["kernel"],
    &["simd"],
    &[
        "rheology",
        "state_equation",
        "chunks",
        "exact_sum",
        "repeated",
    ],
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

/// A glob would hide the names that it takes from the tests above.
#[test]
fn no_module_takes_all_names_of_another() {
    for crate_name in ["coupling", "sph", "dda"] {
        let modules = modules(crate_name);
        let shipped = modules
            .keys()
            .filter(|path| path.last().is_none_or(|name| name != "tests"));
        for module in shipped {
            let taken = taken_whole(&modules, module);
            assert!(taken.is_empty(), "{crate_name}: {module:?} takes {taken:?}");
        }
    }
}

#[test]
fn what_is_read_is_never_computed_with() {
    let may_name = |module: &[String]| {
        module.first().is_some_and(|wing| wing == "scene")
            || module.join("::").starts_with("output::run_folder")
    };
    let found: Vec<_> = modules("coupling")
        .into_iter()
        .filter(|(path, module)| {
            let named = ["SceneFile", "scene.file", "scene::file"];
            !may_name(path) && named.iter().any(|name| module.text.contains(name))
        })
        .map(|(path, _)| path.join("::"))
        .collect();
    assert!(
        found.is_empty(),
        "the schema of the scene is named in {}",
        found.join(", ")
    );
}
