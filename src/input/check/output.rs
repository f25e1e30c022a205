//! Checks of times of profiles and histories, and of tracers.

use std::collections::{HashMap, HashSet};

use super::super::errors::SceneFault;
use super::super::faults::Faults;
use super::super::paths::join;
use super::common::{check_length, check_quantities};
use crate::effects;
use crate::scene::CheckedScene;
use crate::scene::GaugeAxis;
use crate::scene::Scene;

/// Number of rows of the histories if the scene gives no interval.
const ROWS: f64 = 200.0;

/// Times of the profiles [s], checked to be strictly increasing and not beyond the end.
pub(super) fn profile_times(scene: &Scene) -> Result<Vec<f64>, SceneFault> {
    let times = &scene.output.profiles.times;
    let end = scene.time.end;
    check_times("output.profiles.times", times, end)?;
    let Some(every) = scene.output.profiles.every else {
        return Ok(if times.is_empty() { vec![end] } else { times.clone() });
    };
    let path = "output.profiles.every";
    if !times.is_empty() {
        let reason = "output.profiles.times is given as well; allowed: one of both";
        return Err(SceneFault::new(path, every, reason));
    }
    check_count(path, every, end, MOST_PROFILES)?;
    // a multiple next to the end is the end
    let multiples = (0..).map(|k| decimal(f64::from(k) * every));
    let multiples = multiples.take_while(|&t| t < end * (1.0 - 1e-9));
    Ok(multiples.chain([end]).collect())
}

/// The double nearest to `x` rounded to 15 digits: 3 times 3e-8 is 9e-8.
fn decimal(x: f64) -> f64 {
    format!("{x:.14e}").parse().expect("a number")
}

/// Largest number of profiles, which a run holds until its end.
const MOST_PROFILES: f64 = 1e4;

/// Largest number of frames.
const MOST_FRAMES: f64 = 1e6;

/// Checks that an interval does not ask for more than `most` outputs.
fn check_count(path: &str, every: f64, end: f64, most: f64) -> Result<(), SceneFault> {
    if every * most >= end {
        return Ok(());
    }
    let least = end / most;
    let reason = format!("more than {most:e} until time.end; allowed: at least {least:e}");
    Err(SceneFault::new(path, every, reason))
}

/// Checks times and quantities of the fields.
pub(super) fn check_fields(checked: &CheckedScene) -> Result<(), SceneFault> {
    let Some(fields) = &checked.scene.output.fields else { return Ok(()) };
    let (path, end) = ("output.fields", checked.scene.time.end);
    match (fields.every, &fields.times[..]) {
        (None, []) => return Err(SceneFault::missing(path, "every or times")),
        (Some(every), []) => check_count("output.fields.every", every, end, MOST_FRAMES)?,
        (None, times) => check_times("output.fields.times", times, end)?,
        (Some(every), _) => {
            let reason = "output.fields.times is given as well; allowed: one of both";
            return Err(SceneFault::new("output.fields.every", every, reason));
        }
    }
    let known = effects::columns(checked).quantities(checked.dimension);
    let names = fields.quantities.as_deref().unwrap_or_default();
    check_quantities("output.fields.quantities", names, &known)
}

/// Checks the quantities of the x-t diagrams.
pub(super) fn check_diagrams(checked: &CheckedScene) -> Result<(), SceneFault> {
    let diagrams = &checked.scene.output.diagrams;
    if let Some(name) = diagrams.first().filter(|_| checked.dimension > 1) {
        let reason = "x-t diagrams need a scene on a line; allowed: none in a plane";
        return Err(SceneFault::new("output.diagrams[0]", name, reason));
    }
    let mut known = effects::columns(checked).quantities(checked.dimension);
    // the pressure always has one
    known.retain(|name| *name != "pressure");
    check_quantities("output.diagrams", diagrams, &known)
}

/// Checks that times are strictly increasing and not beyond the end.
fn check_times(path: &str, times: &[f64], end: f64) -> Result<(), SceneFault> {
    for (i, &time) in times.iter().enumerate() {
        let path = || format!("{path}[{i}]");
        if time > end {
            let reason = format!("beyond time.end = {end:e}; allowed: at most {end:e}");
            return Err(SceneFault::new(path(), time, reason));
        }
        if i > 0 && time <= times[i - 1] {
            let before = times[i - 1];
            let reason = format!(
                "not above the time before it, {before:e}; allowed: increasing times up to \
                 time.end = {end:e}"
            );
            return Err(SceneFault::new(path(), time, reason));
        }
    }
    Ok(())
}

/// Checks that times of checkpoints are increasing and not beyond the end.
pub(super) fn check_checkpoints(scene: &Scene) -> Result<(), SceneFault> {
    let Some(checkpoints) = &scene.output.checkpoint else { return Ok(()) };
    check_times("output.checkpoint.at_times", &checkpoints.at_times, scene.time.end)
}

pub(super) fn history_interval(scene: &Scene) -> Option<f64> {
    let histories = scene.output.histories.as_ref()?;
    Some(histories.interval.unwrap_or(scene.time.end / ROWS))
}

/// Checks names and places of probes and gauges.
pub(super) fn check_tracers(checked: &CheckedScene) -> Result<(), Faults> {
    let Some(histories) = &checked.scene.output.histories else { return Ok(()) };
    let mut faults = Faults::default();
    let names = checked.scene.bodies.iter().map(|body| body.name.as_str());
    let bodies: HashMap<_, _> = names.zip(0..).collect();
    let mut names = HashSet::new();
    let tracers = histories.tracers.iter().map(|t| ("tracers", &t.name, &t.body, &t.at));
    let meters = histories.velocimeters.iter().map(|t| ("velocimeters", &t.name, &t.body, &t.at));
    let points = tracers.enumerate().chain(meters.enumerate());
    for (i, (list, name, body, at)) in points {
        let Some(path) = faults.take(check_name(list, i, name, &mut names)) else { continue };
        // the name of the body is known, else this check is left out
        let Some(&number) = bodies.get(body.as_str()) else { continue };
        faults.take(check_place(checked, &join(&path, "at"), at, number));
    }
    for (i, station) in histories.stations.iter().enumerate() {
        let named = faults.take(check_name("stations", i, &station.name, &mut names));
        let Some(path) = named else { continue };
        faults.take(check_length(&join(&path, "at"), &station.at, checked.dimension));
    }
    for (i, plane) in histories.planes.iter().enumerate() {
        let named = faults.take(check_name("planes", i, &plane.name, &mut names));
        let Some(path) = named else { continue };
        if plane.axis == GaugeAxis::Y && checked.dimension == 1 {
            let reason = "a line has no y axis; allowed: \"x\"";
            faults.add(SceneFault::new(join(&path, "axis"), "y", reason));
        }
    }
    faults.ok_or_faults(())
}

/// Checks that a place is in the body with this number.
fn check_place(
    checked: &CheckedScene,
    path: &str,
    at: &[f64],
    number: usize,
) -> Result<(), SceneFault> {
    check_length(path, at, checked.dimension)?;
    let bounds = &checked.bodies[number];
    for (d, x) in at.iter().enumerate() {
        let tolerance = checked.tolerance(d);
        let (lower, upper) = (bounds.lower[d], bounds.upper[d]);
        if *x < lower - tolerance || *x > upper + tolerance {
            let body = join("bodies", &checked.scene.bodies[number].name);
            let reason = format!("outside of its body; allowed: {lower} to {upper} ({body})");
            return Err(SceneFault::new(path, at, reason));
        }
    }
    Ok(())
}

/// Checks the name of number `i` of a list of probes or gauges, which becomes part of the names of
/// columns; returns its path.
fn check_name<'a>(
    list: &str,
    i: usize,
    name: &'a str,
    names: &mut HashSet<&'a str>,
) -> Result<String, SceneFault> {
    let path = format!("output.histories.{list}[{i}].name");
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if name.is_empty() || !name.chars().all(plain) {
        let reason = "no name of a column; allowed: letters, digits, _ and -";
        return Err(SceneFault::new(path, name, reason));
    }
    if !names.insert(name) {
        let what = list.trim_end_matches('s');
        let reason = format!("another {what} has this name; allowed: a name of its own");
        return Err(SceneFault::new(path, name, reason));
    }
    Ok(join(&format!("output.histories.{list}"), name))
}
