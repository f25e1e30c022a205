//! What frames of the fields cost: time.

use std::fs;
use std::path::Path;

use serde_json::Value;

use super::runs::{folder, good, scene, with};
use crate::bounds::{Unit, reliability as bounds};
use crate::table::Table;

/// Frames after the one at the start.
const FRAMES: f64 = 100.0;

/// Numbers that a frame holds per particle: position and velocity with three components each, and
/// pressure, density, energy, material, body, id.
const VALUES: f64 = 3.0 + 3.0 + 6.0;

/// Wall time of the loop of a run [s] and its particles.
fn loop_seconds(folder: &Path) -> Option<[f64; 2]> {
    let text = fs::read_to_string(folder.join("summary.json")).ok()?;
    let summary: Value = serde_json::from_str(&text).ok()?;
    let number = |key: &str| summary[key].as_f64();
    Some([number("loop_wall_seconds")?, number("particles")?])
}

/// The whole run of a plane on two ranks, without and with frames.
pub fn check(table: &mut Table) {
    let home = folder("frames");
    let every = "output.fields={\"every\":1e-8,\"quantities\":[\"velocity\",\"pressure\",\"density\",\
                 \"specific_internal_energy\"]}";
    let run = |name: &str, sets: &[&str]| {
        let to = home.join(name);
        let args = scene("flyer_2d", sets);
        good(2, &with(&args, &["--output", &to.display().to_string()])).map(|()| loop_seconds(&to))
    };
    let runs = run("plain", &[]).and_then(|plain| Ok((plain, run("frames", &[every])?)));
    let Some((Some([plain, particles]), Some([framed, _]))) = table.take("runs", runs) else {
        return;
    };
    let share = framed / plain - 1.0;
    table.check("of the run time", Some(share), bounds::frames::SHARE_OF_RUN_TIME);
    let values = (FRAMES + 1.0) * particles * VALUES;
    table.beside("a value, both ranks", Some(2.0 * (framed - plain) / values), "", Unit::Seconds);
}
