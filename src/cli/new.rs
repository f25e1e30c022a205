//! `flyer-mpm new`: short scenes that run as they are, to start from.

use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use flyer_mpm::input;

use crate::{Outcome, bad};

macro_rules! templates {
    ($($name:literal),* $(,)?) => {
        /// Name and text of each template.
        const TEMPLATES: &[(&str, &str)] = &[
            $(($name, include_str!(concat!("../../inputs/templates/", $name, ".json")))),*
        ];
    };
}

templates![
    "plate_impact",
    "window",
    "sphere",
    "oblique_plate",
    "taylor_bar",
    "spall",
    "driven_plate",
    "shock_tube",
    "empty",
];

/// Names and titles of all templates.
pub fn list() -> String {
    let line = |(name, text): &(&str, &str)| {
        let checked = input::parse(text.as_bytes(), name, &[]).expect("a template is a scene");
        format!("{name:<14} {}\n", checked.scene.title)
    };
    TEMPLATES.iter().map(line).collect::<String>() + "`flyer-mpm new NAME` writes NAME.json\n"
}

/// Writes a template to `output`, or to NAME.json in the working folder; returns what to do next.
///
/// # Errors
///
/// If there is no such template, or the file exists or cannot be written.
pub fn write(name: &str, output: Option<&Path>) -> Outcome<String> {
    let Some((_, text)) = TEMPLATES.iter().find(|(known, _)| *known == name) else {
        let known: Vec<&str> = TEMPLATES.iter().map(|(known, _)| *known).collect();
        let near = known.iter().map(|known| (strsim::damerau_levenshtein(name, known), known));
        let near = near.filter(|(distance, known)| *distance <= known.len() / 3).min();
        let meant = near.map_or(";".into(), |(_, near)| format!("; did you mean {near}?"));
        return Err(bad(format!("{name}: no such template{meant} allowed: {}", known.join(", "))));
    };
    let file = output.map_or_else(|| PathBuf::from(format!("{name}.json")), Path::to_path_buf);
    let fail = |e: std::io::Error| match e.kind() {
        ErrorKind::AlreadyExists => {
            bad(format!("{}: exists already; allowed: --output ANOTHER.json", file.display()))
        }
        _ => bad(format!("{}: cannot write the file: {e}", file.display())),
    };
    let mut made = OpenOptions::new().write(true).create_new(true).open(&file).map_err(fail)?;
    made.write_all(text.as_bytes()).map_err(fail)?;
    Ok(format!("{0} is written; run it with `flyer-mpm {0}`\n", file.display()))
}
