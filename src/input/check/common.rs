//! Checks that several parts of a scene share.

use serde::Serialize;

use super::super::errors::{SceneFault, one_line, suggest};
use crate::material::parameter_error::wrong_length;
use crate::scene::CheckedScene;

/// Maximum number of cells or of particles of any scene.
pub(super) const MOST: f64 = 1e15;

/// Maximum number of characters of a name or title.
const LONGEST_NAME: usize = 200;

/// Checks that a name or title is one printable line.
pub(in super::super) fn check_printable(path: &str, text: &str) -> Result<(), SceneFault> {
    if text.trim().is_empty() {
        return Err(SceneFault::new(
            path,
            text,
            "is empty; allowed: at least one printable character",
        ));
    }
    if text.chars().count() > LONGEST_NAME {
        let reason = format!("is too long; allowed: at most {LONGEST_NAME} characters");
        return Err(SceneFault::new(path, text, reason));
    }
    if text != one_line(text) {
        let reason = "has a control character; allowed: one line of printable characters";
        return Err(SceneFault::new(path, text, reason));
    }
    Ok(())
}

/// Checks that there is one entry per direction.
pub(super) fn check_length<T: Serialize>(
    path: &str,
    values: &[T],
    dimension: usize,
) -> Result<(), SceneFault> {
    if values.len() == dimension {
        return Ok(());
    }
    Err(SceneFault::new(path, values, wrong_length(values.len(), dimension)))
}

/// Checks that each quantity is one of `known` and named once.
pub(super) fn check_quantities(
    path: &str,
    names: &[String],
    known: &[&str],
) -> Result<(), SceneFault> {
    for (k, name) in names.iter().enumerate() {
        let reason = if names[..k].contains(name) {
            "named twice; allowed: each quantity once".to_string()
        } else if !known.contains(&name.as_str()) {
            format!("cannot be chosen in this scene; allowed: {}", known.join(", "))
        } else {
            continue;
        };
        return Err(SceneFault::new(format!("{path}[{k}]"), name, reason));
    }
    Ok(())
}

/// Checks that the lower corner is below the upper one.
pub(super) fn check_box(path: &str, lower: &[f64], upper: &[f64]) -> Result<(), SceneFault> {
    if lower.iter().zip(upper).all(|(l, u)| l < u) {
        return Ok(());
    }
    let lower = serde_json::json!(lower);
    let reason = format!("not above {path}.lower = {lower}; allowed: lower < upper");
    Err(SceneFault::new(format!("{path}.upper"), upper, reason))
}

/// Index of the body with this name.
pub(super) fn find_body(
    checked: &CheckedScene,
    path: &str,
    name: &str,
) -> Result<usize, SceneFault> {
    let names: Vec<_> = checked.scene.bodies.iter().map(|body| body.name.as_str()).collect();
    names.iter().position(|&known| known == name).ok_or_else(|| {
        SceneFault::new(path, name, format!("no such body{}", suggest(name, names.iter().copied())))
    })
}
