//! What can be wrong with a scene, told in one line.

use std::fmt::Write;

use serde::Serialize;
use serde_json::Value;

/// Characters of a value or a path that a message shows.
pub(super) const LONGEST_VALUE: usize = 120;

/// Characters of what is wrong and what is allowed.
pub(super) const LONGEST_REASON: usize = 1000;

/// Why a scene cannot be run; the text is one line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// The file cannot be read.
    #[error("{file}: {reason}")]
    File {
        /// Path of the scene.
        file: String,
        /// Why.
        reason: String,
    },
    /// The text is not JSON.
    #[error("{file}: line {line} column {column}{}: {reason}", at_key(path))]
    Syntax {
        /// Path of the scene.
        file: String,
        /// Line of the fault, from 1.
        line: usize,
        /// Column of the fault in bytes, from 1.
        column: usize,
        /// Key that stands there, or the nearest above it; empty at the top.
        path: String,
        /// What was found, and what is allowed.
        reason: String,
    },
    /// An override on the command line cannot be applied.
    #[error("--set {set}: {reason}")]
    Set {
        /// The override, `PATH=VALUE`.
        set: String,
        /// Why, and what is allowed.
        reason: String,
    },
    /// A key is wrong, alone or beside another.
    #[error("{file}: {path}{}: {reason}", equals(value))]
    Key {
        /// Path of the scene.
        file: String,
        /// Path of the key, as `--set` takes it.
        path: String,
        /// Its value as JSON; empty where it is missing.
        value: String,
        /// What is wrong, and what is allowed.
        reason: String,
    },
    /// The run needs more memory than there is.
    #[error(
        "{file}: {particles} particles{} need about {} of memory; allowed: {}, what \
         this machine has left; coarsen domain.cell_size, lower bodies' particles_per_cell, or start it \
         all the same with --ignore-memory",
        in_cells(*cells), readable(*needed), readable(*available)
    )]
    Memory {
        /// Path of the scene.
        file: String,
        /// Particles of all bodies.
        particles: u64,
        /// Cells of the domain; 0: not counted yet.
        cells: u64,
        /// Estimate of what the run needs [bytes].
        needed: u64,
        /// What the machine has left [bytes].
        available: u64,
    },
}

/// A wrong key, before the file that it stands in is named.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fault {
    path: String,
    value: String,
    reason: String,
}

impl Fault {
    /// A key and its value, with what is wrong and what is allowed.
    pub(super) fn new(
        path: impl Into<String>,
        value: impl Serialize,
        reason: impl Into<String>,
    ) -> Self {
        let value = serde_json::to_value(value).unwrap_or(Value::Null);
        Fault {
            path: path.into(),
            value: shorten(&value.to_string(), LONGEST_VALUE),
            reason: reason.into(),
        }
    }

    /// A key that is not there.
    pub(super) fn missing(path: impl Into<String>, reason: impl Into<String>) -> Self {
        Fault { path: path.into(), value: String::new(), reason: reason.into() }
    }

    /// The same fault, told from above: its path now begins with `parent`.
    pub(super) fn below(mut self, parent: &str) -> Self {
        let dot = if self.path.is_empty() || self.path.starts_with('[') { "" } else { "." };
        self.path = format!("{parent}{dot}{}", self.path);
        self
    }

    /// The error, with the file named.
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

/// At most `most` characters of `text`.
pub(super) fn shorten(text: &str, most: usize) -> String {
    match text.char_indices().nth(most) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_string(),
    }
}

/// The known name that `name` was perhaps meant to be.
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

/// `; did you mean ...?` where a known name is near, then the list of all.
pub(super) fn suggest<'a>(name: &str, known: impl IntoIterator<Item = &'a str> + Clone) -> String {
    let mut text = String::new();
    if let Some(near) = nearest(name, known.clone()) {
        let _ = write!(text, "; did you mean {near}?");
    }
    let _ = write!(text, "{} allowed: {}", if text.is_empty() { ";" } else { "" }, list(known));
    text
}

/// Names with commas between them; of many, the first alone.
pub(super) fn list<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    const MOST: usize = 20;
    let names: Vec<_> = names.into_iter().collect();
    match names.len() {
        0 => "none".to_string(),
        count if count <= MOST => names.join(", "),
        count => format!("{} and {} more", names[..MOST].join(", "), count - MOST),
    }
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

/// A number of bytes as people read it.
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
        let fault = Fault::new("bodies.a\nb", "x\ny", "wrong\r\nhere");
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
