//! Layering of the library: a module uses only those below it, and no two files use each other.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::imports::{Imports, ItemPath};

/// The modules from the top down; those on one line may use each other.
const ROOMS: [&[&str]; 16] = [
    &["study"],
    &["driver"],
    &["accuracy"],
    &["perf_model"],
    &["simulation"],
    &["effects"],
    &["solver"],
    &["scene"],
    &["geometry"],
    &["side"],
    &["contact"],
    &["exact"],
    &["shape"],
    &["transfer"],
    &["material"],
    &["plot"],
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

/// Modules whose files still use each other.
const OPEN: [&str; 3] = ["scene", "solver", "simulation"];

#[test]
fn no_two_files_use_each_other() {
    let imports = Imports::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
    let mut circles = imports.circles();
    let is_open = |file: &ItemPath| file.first().is_some_and(|room| OPEN.contains(&room.as_str()));
    circles.retain(|group| !group.iter().all(is_open));
    let ties: Vec<String> = circles.iter().map(|group| imports.ties(group).join("\n")).collect();
    assert!(ties.is_empty(), "files use each other:\n\n{}", ties.join("\n\n"));
}

/// Names of columns that a source declares: the first text after `scalar(`.
fn declared_scalars(text: &str) -> Vec<String> {
    let calls = text.split(".scalar(\"").skip(1);
    calls.filter_map(|rest| rest.split('"').next().map(String::from)).collect()
}

/// The solver runs effects without naming one: `src/solver` contains no module name of an effect
/// and no column that an effect declares.
#[test]
fn the_solver_names_no_effect() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let read = |path: &PathBuf| std::fs::read_to_string(path).unwrap();
    let effects = sources(&source.join("effects"));
    let columns: Vec<String> = effects.iter().flat_map(|f| declared_scalars(&read(f))).collect();
    assert!(columns.len() > 10, "{columns:?}");
    let list = read(&source.join("effects/mod.rs"));
    assert!(list.contains("$(mod $module;)*"));
    for file in &effects {
        let module = file.file_stem().unwrap().to_str().unwrap();
        // the list declares private modules
        let private = ["\nmod {};", "\n    {}::"]
            .iter()
            .any(|line| list.contains(&line.replace("{}", module)));
        assert!(private || module == "mod", "effects::{module} can be named from outside");
    }
    for file in sources(&source.join("solver")) {
        let text = read(&file);
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        for column in &columns {
            let named = format!("\"{column}\"");
            assert!(!code.contains(&named), "{}: names {named} of an effect", file.display());
        }
    }
}
