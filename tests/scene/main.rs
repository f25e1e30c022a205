//! Scenes: those shipped, overrides, and every bad one with its message.

mod extremes;
mod faults;
mod keys;
mod plausibility;
mod presets;
mod random;
mod refused;
mod shipped;

use std::path::{Path, PathBuf};

use flyer_mpm::input;
use flyer_mpm::input::parse;
use flyer_mpm::scene::CheckedScene;
use serde_json::Value;

fn inputs() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs");
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<_> =
        entries.filter(|path| path.extension().is_some_and(|e| e == "json")).collect();
    files.sort();
    files
}

fn shipped(name: &str) -> Vec<u8> {
    input::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs").join(name)).unwrap()
}

fn with(name: &str, sets: &[&str]) -> Result<CheckedScene, String> {
    let sets: Vec<_> = sets.iter().map(ToString::to_string).collect();
    parse(&shipped(name), name, &sets).map_err(|error| error.to_string())
}

/// Whether a message is one line, or a number of faults and then that many lines or the longest list.
fn is_clear(message: &str) -> bool {
    let mut lines = message.lines();
    let (Some(first), rest) = (lines.next(), lines.collect::<Vec<_>>()) else { return false };
    if rest.is_empty() {
        return true;
    }
    let count =
        first.strip_suffix(" faults").and_then(|text| text.rsplit(' ').next()?.parse().ok());
    let expected = count.map(|count: usize| if count > 20 { 21 } else { count });
    expected == Some(rest.len()) && rest.iter().all(|line| line.starts_with("  "))
}

/// The message holds every fragment in a list of several faults.
#[track_caller]
fn mentions_all(message: &str, fragments: &[&str]) {
    assert!(message.lines().count() > 2 && is_clear(message), "{message}");
    for fragment in fragments {
        assert!(message.contains(fragment), "no `{fragment}` in: {message}");
    }
}

/// The message is one line that holds every fragment.
#[track_caller]
fn mentions(message: &str, fragments: &[&str]) {
    assert_eq!(message.lines().count(), 1, "{message}");
    assert!(message.len() < 2000, "{message}");
    for fragment in fragments {
        assert!(message.contains(fragment), "no `{fragment}` in: {message}");
    }
}

#[track_caller]
fn refused(name: &str, sets: &[&str], fragments: &[&str]) {
    match with(name, sets) {
        Ok(_) => panic!("{sets:?} passed"),
        Err(message) => mentions(&message, fragments),
    }
}

#[track_caller]
fn refused_text(text: &str, fragments: &[&str]) {
    match parse(text.as_bytes(), "bad.json", &[]) {
        Ok(_) => panic!("{text:.200} passed"),
        Err(error) => mentions(&error.to_string(), fragments),
    }
}

/// `flyer.json` with one edit of its JSON.
#[track_caller]
fn refused_edit(edit: impl FnOnce(&mut Value), fragments: &[&str]) {
    let mut value: Value = serde_json::from_slice(&shipped("flyer.json")).unwrap();
    edit(&mut value);
    refused_text(&value.to_string(), fragments);
}
