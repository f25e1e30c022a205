//! Layering of the library: a module uses only those below it, and no two files use each other.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::imports::Imports;

/// The modules from the top down; those on one line may use each other.
const ROOMS: [&[&str]; 17] = [
    &["study"],
    &["driver"],
    &["accuracy"],
    &["perf_model"],
    &["simulation"],
    &["input"],
    &["effects"],
    &["solver"],
    &["scene"],
    &["geometry"],
    &["side"],
    &["balance"],
    &["contact"],
    &["exact"],
    &["shape"],
    &["transfer"],
    &["material"],
];

fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let (folders, files): (Vec<_>, Vec<_>) = entries.partition(|path| path.is_dir());
    let files = files.into_iter().filter(|path| path.extension().is_some_and(|e| e == "rs"));
    files.chain(folders.iter().flat_map(|folder| sources(folder))).collect()
}

/// Modules that a source names in paths from the crate's root, outside its tests and comments.
fn rooms_named(text: &str) -> BTreeSet<String> {
    let code = text.split("#[cfg(test)]").next().unwrap_or_default();
    let lines = code.lines().map(|line| line.split("//").next().unwrap_or_default());
    let lines: Vec<&str> = lines.collect();
    let paths = lines.iter().flat_map(|line| line.split("crate::").skip(1));
    let paths =
        paths.inspect(|path| assert!(!path.starts_with('{'), "crate::{path}: one use each"));
    let name = |path: &str| path.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    paths.map(name).collect()
}

fn level(room: &str) -> Option<usize> {
    ROOMS.iter().position(|rooms| rooms.contains(&room))
}

#[test]
fn rooms_use_those_below_them_alone() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut seen = BTreeSet::new();
    for file in sources(&source) {
        let inner = file.strip_prefix(&source).unwrap();
        let room = inner.iter().next().unwrap().to_str().unwrap();
        // the program and its commands are above all modules
        if ["lib.rs", "main.rs", "cli"].contains(&room) {
            continue;
        }
        let own = level(room).unwrap_or_else(|| panic!("{room} has no place among the rooms"));
        seen.insert(room.to_string());
        // test modules have separate files
        if inner.iter().any(|part| part.to_str().unwrap().contains("tests")) {
            continue;
        }
        for named in rooms_named(&std::fs::read_to_string(&file).unwrap()) {
            if let Some(other) = level(&named) {
                assert!(
                    own <= other,
                    "{}: {room} uses {named}, which is above it",
                    inner.display()
                );
            }
        }
    }
    assert_eq!(seen.len(), ROOMS.iter().map(|rooms| rooms.len()).sum::<usize>());
}

#[test]
fn no_two_files_use_each_other() {
    for folder in ["src", "crates/plot/src", "decomp/src"] {
        let imports = Imports::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder));
        let circles = imports.circles();
        let ties: Vec<String> =
            circles.iter().map(|group| imports.ties(group).join("\n")).collect();
        assert!(ties.is_empty(), "files of {folder} use each other:\n\n{}", ties.join("\n\n"));
    }
}

/// Functions of a formatted source: name and number of lines. A function ends with the first brace at
/// its own indent.
fn functions(text: &str) -> Vec<(String, usize)> {
    let lines: Vec<&str> = text.lines().collect();
    let words = ["pub ", "pub(super) ", "pub(crate) ", "const ", "unsafe "];
    let mut found = Vec::new();
    for (first, line) in lines.iter().enumerate() {
        let mut rest = line.trim_start();
        while let Some(word) = words.iter().find(|word| rest.starts_with(**word)) {
            rest = &rest[word.len()..];
        }
        let Some(rest) = rest.strip_prefix("fn ") else { continue };
        let name = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
        let indent = &line[..line.len() - line.trim_start().len()];
        let ends = |line: &&str| {
            line.strip_prefix(indent).is_some_and(|line| {
                line == "}" || (!line.starts_with(' ') && line.ends_with([';', '}']))
            })
        };
        let count = lines[first..].iter().position(ends).unwrap_or(lines.len() - first);
        found.push((name, count + 1));
    }
    found
}

/// Greatest number of lines of a function in `src/solver` and `src/effects`.
const LONGEST_FUNCTION: usize = 80;

#[test]
fn functions_of_the_step_are_short() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut count = 0;
    for file in ["solver", "effects"].iter().flat_map(|room| sources(&source.join(room))) {
        for (name, lines) in functions(&std::fs::read_to_string(&file).unwrap()) {
            assert!(lines <= LONGEST_FUNCTION, "{}: {name} has {lines} lines", file.display());
            count += 1;
        }
    }
    assert!(count > 300, "{count} functions found");
}

/// Types that a source defines outside its tests.
fn types(text: &str) -> Vec<String> {
    let code = text.split("#[cfg(test)]").next().unwrap_or_default();
    let kinds = ["struct ", "enum ", "trait "];
    let lines = code.lines().filter(|line| !line.starts_with(' '));
    let words = lines.filter_map(|line| {
        let line = ["pub(crate) ", "pub(super) ", "pub "]
            .iter()
            .find_map(|word| line.strip_prefix(word))
            .unwrap_or(line);
        kinds.iter().find_map(|kind| line.strip_prefix(kind))
    });
    let name = |rest: &str| rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    words.map(name).collect()
}

#[test]
fn no_type_name_is_defined_twice() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut places: BTreeMap<String, Vec<PathBuf>> = BTreeMap::new();
    for file in sources(&source) {
        if file.components().any(|part| part.as_os_str().to_str().unwrap().contains("tests")) {
            continue;
        }
        for name in types(&std::fs::read_to_string(&file).unwrap()) {
            places.entry(name).or_default().push(file.clone());
        }
    }
    assert!(places.len() > 300, "{} types found", places.len());
    places.retain(|_, files| files.len() > 1);
    assert!(places.is_empty(), "{places:#?}");
}

/// Names of columns that a source declares: the first text after `scalar(`.
fn declared_scalars(text: &str) -> Vec<String> {
    let calls = text.split(".scalar(\"").skip(1);
    calls.filter_map(|rest| rest.split('"').next().map(String::from)).collect()
}

/// A run uses effects without naming one: the rooms below contain no column that an effect
/// declares, and the module of an effect cannot be named from outside.
#[test]
fn a_run_names_no_effect() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let read = |path: &PathBuf| std::fs::read_to_string(path).unwrap();
    let effects = sources(&source.join("effects"));
    let columns: Vec<String> = effects.iter().flat_map(|f| declared_scalars(&read(f))).collect();
    assert!(columns.len() > 10, "{columns:?}");
    let list = read(&source.join("effects/mod.rs"));
    assert!(list.contains("$(mod $module;)*"));
    for file in &effects {
        let module = file.file_stem().unwrap().to_str().unwrap();
        let public = ["pub mod", "pub(crate) mod", "pub use", "pub(crate) use"]
            .iter()
            .any(|word| list.contains(&format!("{word} {module}")));
        assert!(!public || module == "ledger", "effects::{module} can be named from outside");
    }
    let rooms = ["solver", "simulation", "driver", "perf_model"];
    for file in rooms.iter().flat_map(|room| sources(&source.join(room))) {
        let text = read(&file);
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        for column in &columns {
            let named = format!("\"{column}\"");
            assert!(!code.contains(&named), "{}: names {named} of an effect", file.display());
        }
    }
}

/// The faults that the tests are measured with are written for the present sources.
#[test]
fn every_mutant_has_its_place_in_the_sources() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(root.join("tests/data/mutants.json")).unwrap();
    let mutants: Vec<serde_json::Value> = serde_json::from_str(&text).unwrap();
    for mutant in &mutants {
        let [file, find] = ["file", "find"].map(|key| mutant[key].as_str().unwrap());
        let source = std::fs::read_to_string(root.join(file)).unwrap_or_default();
        let places = source.matches(&find.replace(['«', '»'], "")).count();
        assert_eq!(places, 1, "{file}: {find}");
    }
}
