//! From a file to a checked scene: read, parse, override, validate against the schema, check.
//!
//! Independent of MPI: one rank reads the bytes and sends them, and every rank parses them.
//! [`parse`] depends only on its arguments, so all ranks reach the same result.

use std::fmt;
use std::path::Path;

use serde::de::{self, Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};

use super::check::{BYTES_PER_BORDER_TILE, border_tiles, check as check_relations};
use super::comments::without_comments;
use super::errors::{LONGEST_VALUE, SceneError, SceneFault, one_line, shorten};
use super::faults::Faults;
use super::library::{inline_courses, inline_files, resolve};
use super::migrate::check_format;
use super::names;
use super::overrides::{apply, check_allowed};
use super::preset;
use super::readable::keep_readable;
use super::schema::full_schema;
use super::units;
use super::validate::conform;
use crate::geometry::read_points;
use crate::input::input_file::{self, InputFault};
use crate::scene::{CheckedScene, MethodChoice, Scene};

/// Maximum size of a scene file [bytes].
pub const LARGEST_FILE: u64 = input_file::LARGEST_JSON;

/// Reads the text of a scene, at most [`LARGEST_FILE`] bytes, without checking its contents.
///
/// # Errors
///
/// If the file cannot be read, is too large, or is a checkpoint.
pub fn read(path: &Path) -> Result<Vec<u8>, SceneError> {
    let fail = |reason: String| SceneError::File {
        file: one_line(&path.display().to_string()),
        reason: one_line(&reason),
    };
    if input_file::begins_with(path, input_file::CHECKPOINT_START) {
        return Err(fail(
            "is a checkpoint; allowed: a scene, one JSON file, or --restart to continue \
                         from a checkpoint"
                .into(),
        ));
    }
    let bytes = input_file::read(path, LARGEST_FILE).map_err(|fault| {
        fail(match fault {
            InputFault::Kind(kind) => format!("is {kind}; allowed: a scene, one JSON file"),
            other => other.to_string(),
        })
    })?;
    with_files(bytes, path)
}

/// The text of a scene with the contents of its files of positions, materials, tables, pressures
/// and velocities inserted, so that the text sent to the other ranks is complete.
fn with_files(bytes: Vec<u8>, path: &Path) -> Result<Vec<u8>, SceneError> {
    // errors of the text are reported when it is parsed
    let parse = |text: &str| serde_json::from_str::<Value>(&without_comments(text)).ok();
    let text = std::str::from_utf8(&bytes).ok();
    let text = text.map(|text| text.strip_prefix('\u{feff}').unwrap_or(text));
    let Some(mut scene) = text.and_then(parse) else { return Ok(bytes) };
    let plane =
        scene.pointer("/domain/lower").and_then(Value::as_array).is_some_and(|l| l.len() > 1);
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut found = inline_files(&mut scene, folder)?;
    found |= inline_courses(&mut scene, folder)?;
    for body in scene.get_mut("bodies").and_then(Value::as_array_mut).into_iter().flatten() {
        let Some(Value::String(name)) = body.get("positions") else { continue };
        let file = path.parent().unwrap_or(Path::new("")).join(name);
        let fail = |reason: String| SceneError::File {
            file: one_line(&file.display().to_string()),
            reason: one_line(&reason),
        };
        let text = input_file::read_text(&file, input_file::LARGEST_NUMBERS)
            .map_err(|fault| fail(fault.to_string()))?;
        let points = match plane {
            true => read_points::<2>(&text).map(|points| serde_json::json!(points)),
            false => read_points::<1>(&text).map(|points| serde_json::json!(points)),
        };
        body["positions"] = points.map_err(|fault| fail(fault.to_string()))?;
        found = true;
    }
    Ok(if found { serde_json::to_vec(&scene).unwrap_or(bytes) } else { bytes })
}

/// Parses the bytes of a file, applies the overrides `PATH=VALUE` in their order, and checks the
/// scene.
///
/// `file` is the name of the scene in messages.
///
/// # Errors
///
/// The first fault of the text or of an override, else all faults of keys and of the checks that read
/// none of these keys.
pub fn parse(bytes: &[u8], file: &str, sets: &[String]) -> Result<CheckedScene, SceneError> {
    let mut value = parse_json(bytes, file)?;
    if value.is_object() {
        for set in sets {
            apply(&mut value, set)?;
        }
    }
    judge(value, file).map_err(|faults| {
        let text = String::from_utf8_lossy(bytes);
        faults.into_error(file, text.strip_prefix('\u{feff}').unwrap_or(&text))
    })
}

/// Rejects a scene whose particles at the borders of bodies, which the check of the scene makes, need
/// more than `available` bytes. Other faults are left to [`parse`].
///
/// # Errors
///
/// If these particles need more than `available` bytes.
pub fn check_size(
    bytes: &[u8],
    file: &str,
    sets: &[String],
    available: Option<u64>,
) -> Result<(), SceneError> {
    let read = || -> Option<Scene> {
        let mut value = parse_json(bytes, file).ok()?;
        sets.iter().try_for_each(|set| apply(&mut value, set)).ok()?;
        let mut faults = Faults::default();
        complete(&mut value, &mut faults).ok()?;
        faults.is_empty().then_some(())?;
        serde_json::from_value(value).ok()
    };
    let particles = read().map_or(0, |scene| border_tiles(&scene));
    let needed = particles.saturating_mul(BYTES_PER_BORDER_TILE);
    match available {
        Some(available) if needed > available => {
            Err(SceneError::Memory { file: one_line(file), particles, cells: 0, needed, available })
        }
        _ => Ok(()),
    }
}

/// Parses and checks the scene of a checkpoint with overrides, which may change only keys in
/// `allowed` or below them.
///
/// # Errors
///
/// If an override changes another key, or as [`parse`].
pub fn parse_changed(
    bytes: &[u8],
    file: &str,
    sets: &[String],
    allowed: &[&str],
) -> Result<CheckedScene, SceneError> {
    sets.iter().try_for_each(|set| check_allowed(set, allowed))?;
    parse(bytes, file, sets)
}

/// Checks a scene that was not read from a file; `file` is its name in messages.
///
/// # Errors
///
/// As [`parse`].
pub fn check(scene: Scene, file: &str) -> Result<CheckedScene, SceneError> {
    // a number that is not finite becomes null here, and is rejected as such
    let value = serde_json::to_value(scene)
        .map_err(|e| SceneFault::missing("", e.to_string()).within(file))?;
    judge(value, file).map_err(|faults| faults.into_error(file, ""))
}

fn judge(mut value: Value, file: &str) -> Result<CheckedScene, Faults> {
    let mut faults = Faults::default();
    let choice = complete(&mut value, &mut faults)?;
    if !faults.is_empty() {
        let Some(unread) = keep_readable(&mut value) else { return Err(faults) };
        faults.read_in_part(unread);
    }
    let scene = serde_path_to_error::deserialize(value)
        .map_err(|e| SceneFault::missing(e.path().to_string(), e.inner().to_string()));
    let Some(scene) = faults.take(scene) else { return Err(faults) };
    let mut checked = check_relations(scene, file, faults)?;
    checked.method_choice = choice;
    Ok(checked)
}

/// Replaces library names, quantities and presets by what they stand for, and validates the keys.
fn complete(value: &mut Value, faults: &mut Faults) -> Result<Option<MethodChoice>, SceneFault> {
    faults.extend(resolve(value));
    // every key of a former format would be a fault
    check_format(value)?;
    faults.extend(units::convert(value, full_schema()));
    let choice = faults.take(preset::expand(value)).flatten();
    faults.extend(conform(value));
    faults.extend(names::check(value));
    Ok(choice)
}

/// Parses JSON text; a duplicate key is an error.
fn parse_json(bytes: &[u8], file: &str) -> Result<Value, SceneError> {
    let fail = |reason: &str| SceneError::File { file: one_line(file), reason: reason.to_string() };
    let text = std::str::from_utf8(bytes).map_err(|error| {
        fail(&format!("is not UTF-8 from byte {} on; allowed: JSON in UTF-8", error.valid_up_to()))
    })?;
    let text = without_comments(text.strip_prefix('\u{feff}').unwrap_or(text));
    let text = &text[..];
    if text.trim().is_empty() {
        return Err(fail("is empty; allowed: a scene, one JSON object"));
    }
    let mut reader = serde_json::Deserializer::from_str(text);
    let value = serde_path_to_error::deserialize::<_, Strict>(&mut reader)
        .map_err(|e| (e.path().to_string(), e.into_inner()))
        .and_then(|Strict(value)| match reader.end() {
            Ok(()) => Ok(value),
            Err(error) => Err((String::new(), error)),
        });
    let mut value = value.map_err(|(path, error)| SceneError::Syntax {
        file: one_line(file),
        line: error.line(),
        column: error.column(),
        path: one_line(&shorten(key_path(&path), LONGEST_VALUE)),
        reason: one_line(&syntax_reason(text, &error)),
    })?;
    // for editors alone
    if let Some(object) = value.as_object_mut() {
        object.remove("$schema");
    }
    Ok(value)
}

/// The known part of a path of serde_path_to_error, which ends in `?` between two keys.
fn key_path(path: &str) -> &str {
    path.trim_end_matches('?').trim_end_matches('.')
}

/// The message of serde_json in plain words, with the text at which it failed.
fn syntax_reason(text: &str, error: &serde_json::Error) -> String {
    let said = error.to_string();
    let said = said.split(" at line ").next().unwrap_or(&said);
    if said.starts_with("recursion limit") {
        return "nested too deep; allowed: at most 127 levels".to_string();
    }
    if error.is_eof() {
        return format!("not JSON, the text ends too early ({said})");
    }
    if error.is_data() {
        return said.to_string();
    }
    let token = token_at(text, error.line(), error.column());
    match said {
        "number out of range" => {
            format!("{token} is too large for a number; allowed: finite numbers, at most 1.7e308")
        }
        "expected value" | "expected ident" | "invalid number" if is_word(&token) => {
            format!(
                "{token} is not JSON; allowed: a finite number, a string in quotes, true, false, null, [...] or {{...}}"
            )
        }
        _ => format!("not JSON, {said}, found {token}"),
    }
}

fn is_word(token: &str) -> bool {
    token.chars().any(char::is_alphanumeric)
}

/// The word at a line and column, both from 1, the column in bytes.
fn token_at(text: &str, line: usize, column: usize) -> String {
    let line = text.split('\n').nth(line.saturating_sub(1)).unwrap_or("");
    let mut at = column.saturating_sub(1).min(line.len());
    while !line.is_char_boundary(at) {
        at -= 1;
    }
    let ends = |c: char| c.is_whitespace() || ",:[]{}\"".contains(c);
    let start = line[..at].rfind(ends).map_or(0, |i| i + 1);
    let end = line[at..].find(ends).map_or(line.len(), |i| at + i);
    let word = match line[start..end].trim() {
        "" => line[at..].chars().next().map_or("the end of the line".to_string(), String::from),
        word => word.to_string(),
    };
    shorten(&word, LONGEST_VALUE)
}

/// A JSON value without duplicate keys in its objects.
struct Strict(Value);

impl<'de> Deserialize<'de> for Strict {
    fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
        reader.deserialize_any(StrictVisitor).map(Strict)
    }
}

struct StrictVisitor;

impl<'de> Visitor<'de> for StrictVisitor {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E>(self, value: f64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<Value, A::Error> {
        let mut array = Vec::new();
        while let Some(Strict(entry)) = entries.next_element()? {
            array.push(entry);
        }
        Ok(array.into())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Value, A::Error> {
        let mut object = Map::new();
        while let Some(key) = entries.next_key::<String>()? {
            if object.contains_key(&key) {
                let key = Value::from(key);
                return Err(de::Error::custom(format!("key {key} stands twice; allowed: once")));
            }
            let Strict(value) = entries.next_value()?;
            object.insert(key, value);
        }
        Ok(object.into())
    }
}
