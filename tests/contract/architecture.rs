//! The order of the rooms of the library: a room uses those below it alone.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The rooms from the top down; those of one line may use each other.
const ROOMS: [&[&str]; 11] = [
    &["study"],
    &["driver"],
    &["accuracy"],
    &["perf_model"],
    &["simulation"],
    &["effects", "solver"],
    &["scene"],
    &["geometry"],
    &["exact"],
    &["material"],
    &["plot"],
];

fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let (folders, files): (Vec<_>, Vec<_>) = entries.partition(|path| path.is_dir());
    let files = files.into_iter().filter(|path| path.extension().is_some_and(|e| e == "rs"));
    files.chain(folders.iter().flat_map(|folder| sources(folder))).collect()
}

/// Rooms that a source names in paths from the crate's root, its tests and comments apart.
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
        // the program and its commands stand above all rooms
        if ["lib.rs", "main.rs", "cli"].contains(&room) {
            continue;
        }
        let own = level(room).unwrap_or_else(|| panic!("{room} has no place among the rooms"));
        seen.insert(room.to_string());
        // modules of tests have files of their own
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
