//! Imports of a crate, read from its text.
//!
//! Every path of a module outside of tests is followed as the compiler would: through the names that modules on its way
//! re-export, to the file that defines its end.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Names from the root of the crate, without `crate`; that of the root itself is empty.
pub type Names = Vec<String>;

/// A file of a crate.
pub struct Module {
    /// Without comments and tests.
    pub text: String,
    /// Names that `use` declares in it, with their paths.
    declared: BTreeMap<String, Names>,
}

/// Modules of a crate by their paths.
pub type Modules = BTreeMap<Names, Module>;

/// Reads all files of a crate but its `main.rs`.
pub fn modules(crate_name: &str) -> Modules {
    let texts = files(crate_name).into_iter();
    parsed(texts.map(|(path, text)| (path, code(&text))).collect())
}

/// Finds the names that each module declares.
fn parsed(texts: BTreeMap<Names, String>) -> Modules {
    let declared = |module: &Names, text: &str| {
        // the name of another crate is not declared by `use rayon;`
        let is_own = |(path, name): &(Names, String)| {
            let first = path.iter().find(|first| *first != "self");
            let child = [module.as_slice(), first.map_or(&[], std::slice::from_ref)].concat();
            first != Some(name) || texts.contains_key(&child)
        };
        let uses = use_paths(text).into_iter().filter(is_own);
        uses.map(|(path, name)| (name, from_root(module, path)))
            .collect()
    };
    let parse = |(path, text): (&Names, &String)| {
        let (text, declared) = (text.clone(), declared(path, text));
        (path.clone(), Module { text, declared })
    };
    texts.iter().map(parse).collect()
}

/// Texts of the files of a crate by the paths of their modules.
fn files(crate_name: &str) -> BTreeMap<Names, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("..")
        .join(crate_name)
        .join("src");
    let mut files = BTreeMap::new();
    let mut folders = vec![(root, Vec::new())];
    while let Some((folder, path)) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let entry = entry.unwrap().path();
            let name = entry.file_stem().unwrap().to_str().unwrap().to_owned();
            let mut module: Names = path.clone();
            if entry.is_dir() {
                module.push(name);
                folders.push((entry, module));
            } else if entry.extension().is_some_and(|e| e == "rs") && name != "main" {
                if name != "lib" {
                    module.push(name);
                }
                files.insert(module, std::fs::read_to_string(&entry).unwrap());
            }
        }
    }
    files
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

fn is_of_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Paths as written in the `use` declarations of a module, each with the name that it declares.
fn use_paths(text: &str) -> Vec<(Names, String)> {
    let mut found = Vec::new();
    for (at, keyword) in text.match_indices("use ") {
        let line = text[..at].rfind('\n').map_or(0, |end| end + 1);
        // indented ones declare names for a function only
        if line == at || text[line..at].starts_with("pub") {
            read_tree(&text[at + keyword.len()..], &mut Vec::new(), &mut found);
        }
    }
    found
}

/// Every path of two names or more, from the root of the crate.
///
/// A path that starts in another crate ends in the module where it stands.
fn paths(module: &[String], text: &str) -> Vec<Names> {
    let mut found = Vec::new();
    for (at, _) in text.match_indices("::") {
        let start = text[..at].rfind(|c| !is_of_name(c));
        let start = start.map_or(0, |before| {
            before + text[before..].chars().next().unwrap().len_utf8()
        });
        // a path is read from its first name
        if start < at && !text[..start].ends_with(':') {
            read_tree(&text[start..], &mut Vec::new(), &mut found);
        }
    }
    let absolute = found.into_iter().map(|(path, _)| from_root(module, path));
    absolute.collect()
}

/// A path from the root of the crate instead of from a module.
fn from_root(module: &[String], path: Names) -> Names {
    let n_up = path.iter().take_while(|name| *name == "super").count();
    let (base, n_skipped): (&[String], _) = match path[0].as_str() {
        "crate" => (&[], 1),
        "self" => (module, 1),
        _ => (&module[..module.len().saturating_sub(n_up)], n_up),
    };
    [base, &path[n_skipped..]].concat()
}

/// Reads `a::b::{c, d::e as f}` as paths, each with its last name or the one after `as`; returns the length.
fn read_tree(text: &str, path: &mut Names, found: &mut Vec<(Names, String)>) -> usize {
    let depth = path.len();
    let mut at = 0;
    loop {
        if text[at..].starts_with('{') {
            at += read_group(&text[at..], path, found);
            break;
        }
        let name = first_name(&text[at..]);
        at += name.len();
        // `a::{self}` and the generics of `a::<T>` end at `a`
        if !name.is_empty() && (name != "self" || path.is_empty()) {
            path.push(name.to_owned());
        }
        if !name.is_empty() && text[at..].starts_with("::") {
            at += "::".len();
            continue;
        }
        let Some(last) = path.last() else { break };
        let mut declared = last.clone();
        if let Some(renamed) = text[at..].strip_prefix(" as ") {
            declared = first_name(renamed).to_owned();
            at += " as ".len() + declared.len();
        }
        found.push((path.clone(), declared));
        break;
    }
    path.truncate(depth);
    at
}

fn first_name(text: &str) -> &str {
    let end = text.find(|c: char| !is_of_name(c) && c != '*');
    &text[..end.unwrap_or(text.len())]
}

/// Reads `{c, d::e}` behind a path; returns the length.
fn read_group(text: &str, path: &mut Names, found: &mut Vec<(Names, String)>) -> usize {
    let mut at = "{".len();
    loop {
        at += text[at..].len() - text[at..].trim_start_matches([' ', '\n', ',']).len();
        if text[at..].starts_with('}') {
            return at + "}".len();
        }
        let n_read = read_tree(&text[at..], path, found);
        if n_read == 0 {
            return at;
        }
        at += n_read;
    }
}

/// Modules that a path leads through by their re-exports, and the one that it ends in.
fn followed(modules: &Modules, mut path: Names) -> BTreeSet<Names> {
    let mut met = BTreeSet::new();
    let mut n_walked = 0;
    loop {
        let here = &path[..n_walked];
        let next = path.get(n_walked);
        let declared = next.and_then(|name| modules[here].declared.get(name));
        let is_file = next.is_some() && modules.contains_key(&path[..=n_walked]);
        let is_last = n_walked + 1 == path.len();
        // a module and a function may have the same name: only the end of a path can be the function
        if is_file && !(is_last && declared.is_some()) {
            n_walked += 1;
            continue;
        }
        met.insert(here.to_vec());
        let Some(declared) = declared else { return met };
        path = [declared, &path[n_walked + 1..]].concat();
        n_walked = 0;
    }
}

/// Modules that each module imports, but the root.
pub fn imports(modules: &Modules) -> BTreeMap<Names, BTreeSet<Names>> {
    let of = |(path, module): (&Names, &Module)| {
        let all = paths(path, &module.text).into_iter();
        let met = all.flat_map(|path| followed(modules, path));
        let others = met.filter(|to| to != path && !to.is_empty()).collect();
        (path.clone(), others)
    };
    modules.iter().map(of).collect()
}

/// Modules of the crate of which a module takes all names at once.
pub fn taken_whole(modules: &Modules, module: &Names) -> Vec<Names> {
    let all = paths(module, &modules[module].text).into_iter();
    let globs = all.filter_map(|path| Some(path.strip_suffix(&["*".to_owned()])?.to_vec()));
    globs.filter(|path| modules.contains_key(path)).collect()
}

fn names(path: &str) -> Names {
    path.split("::").map(str::to_owned).collect()
}

/// Modules that `high` imports in a crate of four files.
fn imports_of_high(root: &str, middle: &str, high: &str) -> Vec<String> {
    let files = [("middle", middle), ("middle::low", ""), ("high", high)];
    let mut texts: BTreeMap<_, _> = files
        .map(|(path, text)| (names(path), text.to_owned()))
        .into();
    texts.insert(Vec::new(), root.to_owned());
    let found = imports(&parsed(texts)).remove(&names("high")).unwrap();
    found.iter().map(|module| module.join("::")).collect()
}

#[test]
fn a_name_of_the_root_leads_to_its_file() {
    let root = "pub use middle::low::{Thing, other as another};";
    for high in [
        "use crate::Thing;",
        "use crate::{Vec3, another as third};",
        "fn f(_: &crate::Thing) {}",
    ] {
        assert_eq!(imports_of_high(root, "", high), ["middle::low"], "{high}");
    }
    assert!(imports_of_high(root, "", "use crate::Vec3;").is_empty());
}

#[test]
fn a_name_that_passes_several_modules_counts_for_each() {
    let (root, middle) = ("pub use middle::Thing;", "pub(crate) use low::Thing;");
    assert_eq!(
        imports_of_high(root, middle, "use crate::Thing;"),
        ["middle", "middle::low"]
    );
    let renamed = "pub(crate) use self::low as deep;";
    let high = "use crate::middle;\nfn f() { middle::deep::make::<f64>() }";
    assert_eq!(
        imports_of_high("", renamed, high),
        ["middle", "middle::low"]
    );
}

#[test]
fn a_function_named_like_its_module_is_found() {
    let middle = "pub use low::low;";
    assert_eq!(
        imports_of_high("", middle, "use crate::middle::low;"),
        ["middle", "middle::low"]
    );
}
