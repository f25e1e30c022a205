//! All faults of a scene in one message, in the order of its file.

use jsonc_parser::ParseOptions;
use jsonc_parser::cst::{CstNode, CstRootNode};

use super::errors::{SceneError, SceneFault, is_within, one_line};
use super::overrides::split;

/// Maximum number of faults in a message.
const MAX_FAULTS: usize = 20;

/// Faults in the order in which they were found, without those that others explain.
#[derive(Debug, Default)]
pub(super) struct Faults {
    found: Vec<SceneFault>,
    /// Paths of the parts of the scene that no check may read.
    unread: Vec<String>,
    /// Whether keys of the scene are not valid, so that it is only known in part.
    in_part: bool,
}

impl Faults {
    pub(super) fn is_empty(&self) -> bool {
        self.found.is_empty()
    }

    pub(super) fn add(&mut self, fault: SceneFault) {
        if !self.found.iter().any(|known| known.explains(&fault)) {
            self.found.push(fault);
        }
    }

    pub(super) fn extend(&mut self, faults: impl IntoIterator<Item = SceneFault>) {
        faults.into_iter().for_each(|fault| self.add(fault));
    }

    /// The scene is only known without these parts, since its keys are not valid.
    pub(super) fn read_in_part(&mut self, unread: Vec<String>) {
        self.unread.extend(unread);
        self.in_part = true;
    }

    /// Whether all keys of the scene are valid.
    pub(super) fn keys_are_valid(&self) -> bool {
        !self.in_part
    }

    /// Leaves out all further checks that read the part at `path`.
    pub(super) fn leave_out(&mut self, path: String) {
        self.unread.push(path);
    }

    /// Whether nothing is known about the part at `path`, or about a part of it.
    pub(super) fn concern(&self, path: &str) -> bool {
        let beside = |other: &str| is_within(other, path) || is_within(path, other);
        let invalidated = self.found.iter().map(SceneFault::invalidated);
        self.unread.iter().map(String::as_str).chain(invalidated).any(beside)
    }

    /// The value of a check that reads the parts at `reads`. `None` if it found a fault, or if a
    /// fault is known in one of these parts, of which another one might be a consequence.
    pub(super) fn judge<T, E: Into<Faults>>(
        &mut self,
        reads: &[&str],
        check: impl FnOnce() -> Result<T, E>,
    ) -> Option<T> {
        if reads.iter().any(|path| self.concern(path)) { None } else { self.take(check()) }
    }

    /// The value of a check, or `None` if it found a fault.
    pub(super) fn take<T, E: Into<Faults>>(&mut self, result: Result<T, E>) -> Option<T> {
        result.map_err(|faults| self.extend(faults.into().found)).ok()
    }

    /// `value` if there is no fault.
    pub(super) fn ok_or_faults<T>(self, value: T) -> Result<T, Faults> {
        if self.is_empty() { Ok(value) } else { Err(self) }
    }

    /// The error, in the order of `text` as far as it has the keys. There is at least one fault.
    pub(super) fn into_error(mut self, file: &str, text: &str) -> SceneError {
        if self.found.len() == 1 {
            return self.found.remove(0).within(file);
        }
        if let Ok(root) = CstRootNode::parse(text, &ParseOptions::default()) {
            self.found.sort_by_cached_key(|fault| place(&root, fault.path()));
        }
        let more = self.found.len().saturating_sub(MAX_FAULTS);
        let lines =
            self.found.into_iter().take(MAX_FAULTS).map(|fault| fault.within("").to_string());
        let faults = lines.map(|line| line.trim_start_matches(": ").to_string()).collect();
        SceneError::Several { file: one_line(file), faults, more }
    }
}

impl From<SceneFault> for Faults {
    fn from(fault: SceneFault) -> Self {
        Faults { found: vec![fault], ..Faults::default() }
    }
}

/// Place of a key in a text: its number among the keys of each object on its path. A key that is not
/// there comes after those that are.
fn place(root: &CstRootNode, path: &str) -> Vec<usize> {
    let keys = split(&format!("{path}=")).map(|(keys, _)| keys).unwrap_or_default();
    let mut node = root.value();
    let mut place = Vec::new();
    for key in keys {
        let found = node.as_ref().and_then(|node| enter(node, &key));
        place.push(found.as_ref().map_or(usize::MAX, |(number, _)| *number));
        node = found.and_then(|(_, value)| value);
    }
    place
}

/// Number and value of `key` in an object, or of the entry of an array with this name or number.
fn enter(node: &CstNode, key: &str) -> Option<(usize, Option<CstNode>)> {
    if let Some(object) = node.as_object() {
        let is = |property: &jsonc_parser::cst::CstObjectProp| {
            let name = property.name().and_then(|name| name.decoded_value().ok());
            name.as_deref() == Some(key)
        };
        let (number, found) =
            object.properties().into_iter().enumerate().find(|(_, property)| is(property))?;
        return Some((number, found.value()));
    }
    let entries = node.as_array()?.elements();
    let named = |entry: &CstNode| {
        let name =
            entry.as_object()?.get("name")?.value()?.as_string_lit()?.decoded_value().ok()?;
        Some(name == key)
    };
    let by_name = entries.iter().position(|entry| named(entry) == Some(true));
    let number = by_name.or(key.parse().ok())?;
    Some((number, entries.get(number).cloned()))
}
