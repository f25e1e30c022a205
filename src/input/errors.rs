//! Errors of a scene, each with a message of one line; several faults are a list.

use std::fmt::Write;

use serde::Serialize;
use serde_json::Value;

use crate::material::ParameterError;

/// Maximum number of characters of a value or a path in a message.
pub(super) const LONGEST_VALUE: usize = 120;

/// Maximum number of characters of the reason in a message.
pub(super) const LONGEST_REASON: usize = 1000;

/// Reason why a scene cannot be run; the message is one line, or one for each of several faults.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// The file cannot be read.
    #[error("{file}: {reason}")]
    File {
        /// Path of the scene.
        file: String,
        /// Reason.
        reason: String,
    },
    /// The text is not JSON.
    #[error("{file}: line {line} column {column}{}: {reason}", at_key(path))]
    Syntax {
        /// Path of the scene.
        file: String,
        /// Line of the error, from 1.
        line: usize,
        /// Column of the error in bytes, from 1.
        column: usize,
        /// Path of the key at this place, or of the nearest one above it; empty at the top level.
        path: String,
        /// What was found, and what is allowed.
        reason: String,
    },
    /// An override on the command line cannot be applied.
    #[error("--set {set}: {reason}")]
    Set {
        /// The override, `PATH=VALUE`.
        set: String,
        /// Reason, and what is allowed.
        reason: String,
    },
    /// The value of a key is invalid, by itself or in combination with another key.
    #[error("{file}: {path}{}: {reason}", equals(value))]
    Key {
        /// Path of the scene.
        file: String,
        /// Path of the key, in the syntax of `--set`.
        path: String,
        /// Value of the key as JSON; empty if the key is missing.
        value: String,
        /// Reason, and what is allowed.
        reason: String,
    },
    /// Several keys are invalid.
    #[error("{file}: {} faults{}", faults.len() + more, listed(faults, *more))]
    Several {
        /// Path of the scene.
        file: String,
        /// The first faults, in the order of the file: path and value of the key, what is wrong, and
        /// what is allowed.
        faults: Vec<String>,
        /// Number of further faults.
        more: usize,
    },
    /// The run needs more memory than is available.
    #[error(
        "{file}: {particles} particles{} need about {} of memory; allowed: {}, what \
         this machine has left; coarsen domain.cell_size, lower bodies' particles_per_cell, or start it \
         all the same with --ignore-memory",
        in_cells(*cells), readable(*needed), readable(*available)
    )]
    Memory {
        /// Path of the scene.
        file: String,
        /// Number of particles of all bodies, or of those that the check of the scene makes.
        particles: u64,
        /// Number of cells of the domain; 0: particles are those at the borders of bodies alone.
        cells: u64,
        /// Estimated memory of the run [bytes].
        needed: u64,
        /// Memory available on the machine [bytes].
        available: u64,
    },
}

/// An invalid key, without the name of its file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SceneFault {
    path: String,
    value: String,
    reason: String,
    /// Path of the part that cannot be judged any further; empty: there is none.
    invalidated: String,
}

impl SceneFault {
    /// Fault of a key and its value; `reason` says what is wrong and what is allowed.
    pub(super) fn new(
        path: impl Into<String>,
        value: impl Serialize,
        reason: impl Into<String>,
    ) -> Self {
        let value = serde_json::to_value(value).unwrap_or(Value::Null);
        let value = shorten(&value.to_string(), LONGEST_VALUE);
        SceneFault { value, ..SceneFault::missing(path, reason) }
    }

    /// Fault of a parameter of the model at `path`.
    pub(super) fn of_parameter(error: ParameterError, path: &str) -> Self {
        let path = format!("{path}.{}", error.key);
        match error.value {
            Some(value) => SceneFault::new(path, value, error.reason),
            None => SceneFault::missing(path, error.reason),
        }
    }

    /// Fault of a missing key.
    pub(super) fn missing(path: impl Into<String>, reason: impl Into<String>) -> Self {
        let path = path.into();
        SceneFault { invalidated: path.clone(), path, value: String::new(), reason: reason.into() }
    }

    /// The same fault, after which nothing at `path` or below can be judged.
    pub(super) fn invalidates(self, path: impl Into<String>) -> Self {
        SceneFault { invalidated: path.into(), ..self }
    }

    /// Path of the key.
    pub(super) fn path(&self) -> &str {
        &self.path
    }

    /// Path of the part that cannot be judged any further; empty: there is none.
    pub(super) fn invalidated(&self) -> &str {
        &self.invalidated
    }

    /// Whether `other` may be no more than a consequence of this fault.
    pub(super) fn explains(&self, other: &SceneFault) -> bool {
        is_within(&other.path, &self.invalidated)
    }

    /// The same fault with `parent` prepended to its path.
    pub(super) fn below(mut self, parent: &str) -> Self {
        let has_invalidated = !self.invalidated.is_empty() || self.path.is_empty();
        let invalidated = has_invalidated.then_some(&mut self.invalidated);
        for path in [Some(&mut self.path), invalidated].into_iter().flatten() {
            let dot = if path.is_empty() || path.starts_with('[') { "" } else { "." };
            *path = format!("{parent}{dot}{path}");
        }
        self
    }

    /// The error, with the name of the file.
    pub(super) fn within(self, file: &str) -> SceneError {
        let path = if self.path.is_empty() { "the scene" } else { &self.path };
        SceneError::Key {
            file: one_line(file),
            path: one_line(&shorten(path, LONGEST_VALUE)),
            value: one_line(&self.value),
            reason: one_line(&shorten(&self.reason, LONGEST_REASON)),
        }
    }
}

/// Whether `path` is `parent` or below it.
pub(super) fn is_within(path: &str, parent: &str) -> bool {
    let rest = path.strip_prefix(parent);
    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
}

/// `text` with control characters escaped, so that a message stays one line.
pub(super) fn one_line(text: &str) -> String {
    let mut line = String::with_capacity(text.len());
    for c in text.chars() {
        if c.is_control() || matches!(c, '\u{2028}' | '\u{2029}') {
            let _ = write!(line, "{}", c.escape_default());
        } else {
            line.push(c);
        }
    }
    line
}

/// The first `most` characters of `text`.
pub(super) fn shorten(text: &str, most: usize) -> String {
    match text.char_indices().nth(most) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_string(),
    }
}

/// The known name that is most similar to `name`, if any is similar.
pub(super) fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    const LONGEST: usize = 60;
    let name = name.to_lowercase();
    known
        .into_iter()
        .filter(|k| name.len().max(k.len()) <= LONGEST)
        .map(|k| (strsim::damerau_levenshtein(&name, &k.to_lowercase()), k))
        .filter(|&(distance, k)| distance <= (k.len().max(name.len()) / 3).max(1))
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, k)| k)
}

/// `; did you mean ...?` if a known name is similar, then the list of all.
pub(super) fn suggest<'a>(name: &str, known: impl IntoIterator<Item = &'a str> + Clone) -> String {
    let mut text = String::new();
    if let Some(near) = nearest(name, known.clone()) {
        let _ = write!(text, "; did you mean {near}?");
    }
    let _ = write!(text, "{} allowed: {}", if text.is_empty() { ";" } else { "" }, list(known));
    text
}

/// Names separated by commas; of a long list, only the first ones.
pub(super) fn list<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    const MOST: usize = 20;
    let names: Vec<_> = names.into_iter().collect();
    match names.len() {
        0 => "none".to_string(),
        count if count <= MOST => names.join(", "),
        count => format!("{} and {} more", names[..MOST].join(", "), count - MOST),
    }
}

/// Faults, one a line, and the number of further ones.
fn listed(faults: &[String], more: usize) -> String {
    let mut text = faults.iter().map(|fault| format!("\n  {fault}")).collect::<String>();
    if more > 0 {
        let _ = write!(text, "\n  ... and {more} more");
    }
    text
}

fn at_key(path: &str) -> String {
    if path.is_empty() { String::new() } else { format!(", at {path}") }
}

fn equals(value: &str) -> String {
    if value.is_empty() { String::new() } else { format!(" = {value}") }
}

fn in_cells(cells: u64) -> String {
    if cells == 0 { String::new() } else { format!(" in {cells} cells") }
}

/// A number of bytes in readable units.
fn readable(count: u64) -> String {
    const UNITS: [&str; 7] = ["B", "KiB", "MiB", "GiB", "TiB", "PiB", "EiB"];
    let mut size = count as f64;
    let mut unit = 0;
    while size >= 1024.0 && unit + 1 < UNITS.len() {
        size /= 1024.0;
        unit += 1;
    }
    if unit == 0 { format!("{count} B") } else { format!("{size:.1} {}", UNITS[unit]) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_names_are_found_and_far_ones_are_not() {
        let known = ["lower", "upper", "cell_size", "patches"];
        assert_eq!(nearest("cel_size", known), Some("cell_size"));
        assert_eq!(nearest("Lower", known), Some("lower"));
        assert_eq!(nearest("viscosity", known), None);
        assert_eq!(suggest("x", []), "; allowed: none");
    }

    #[test]
    fn messages_stay_on_one_line() {
        let fault = SceneFault::new("bodies.a\nb", "x\ny", "wrong\r\nhere");
        let text = fault.within("a\tb.json").to_string();
        assert_eq!(text.lines().count(), 1, "{text}");
        assert_eq!(text, r#"a\tb.json: bodies.a\nb = "x\ny": wrong\r\nhere"#);
    }

    #[test]
    fn bytes_are_readable() {
        assert_eq!(readable(512), "512 B");
        assert_eq!(readable(3 << 29), "1.5 GiB");
        assert_eq!(readable(u64::MAX), "16.0 EiB");
    }
}
