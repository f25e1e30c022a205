//! Checks of times of profiles and histories, and of tracers.

use std::collections::{HashMap, HashSet};

use super::super::errors::{SceneFault, suggest};
use super::super::paths::join;
use super::common::check_length;
use crate::scene::CheckedScene;
use crate::scene::Scene;

/// Number of rows of the histories if the scene gives no interval.
const ROWS: f64 = 200.0;

/// Times of the profiles, checked to be strictly increasing and not beyond the end.
pub(super) fn profile_times(scene: &Scene) -> Result<Vec<f64>, SceneFault> {
    let times = &scene.output.profiles.times;
    let end = scene.time.end;
    check_times("output.profiles.times", times, end)?;
    Ok(if times.is_empty() { vec![end] } else { times.clone() })
}

/// Checks that times are strictly increasing and not beyond the end.
fn check_times(path: &str, times: &[f64], end: f64) -> Result<(), SceneFault> {
    for (i, &time) in times.iter().enumerate() {
        let path = || format!("{path}[{i}]");
        if time > end {
            let reason = format!("beyond time.end = {end:e}; allowed: above 0 and at most {end:e}");
            return Err(SceneFault::new(path(), time, reason));
        }
        if i > 0 && time <= times[i - 1] {
            let before = times[i - 1];
            let reason = format!(
                "not above the time before it, {before:e}; allowed: increasing times, above 0 and \
                 at most time.end = {end:e}"
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

pub(super) fn check_tracers(checked: &CheckedScene) -> Result<(), SceneFault> {
    let Some(histories) = &checked.scene.output.histories else { return Ok(()) };
    let names = checked.scene.bodies.iter().map(|body| body.name.as_str());
    let bodies: HashMap<_, _> = names.zip(0..).collect();
    let mut names = HashSet::new();
    for (i, tracer) in histories.tracers.iter().enumerate() {
        let path = format!("output.histories.tracers[{i}].name");
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        if tracer.name.is_empty() || !tracer.name.chars().all(plain) {
            let reason = "no name of a column; allowed: letters, digits, _ and -";
            return Err(SceneFault::new(path, &tracer.name, reason));
        }
        if !names.insert(tracer.name.as_str()) {
            let reason = "another tracer has this name; allowed: a name of its own";
            return Err(SceneFault::new(path, &tracer.name, reason));
        }
        let path = join("output.histories.tracers", &tracer.name);
        let Some(&number) = bodies.get(tracer.body.as_str()) else {
            let known = checked.scene.bodies.iter().map(|body| body.name.as_str());
            let reason = format!("no such body{}", suggest(&tracer.body, known));
            return Err(SceneFault::new(join(&path, "body"), &tracer.body, reason));
        };
        let path = join(&path, "at");
        check_length(&path, &tracer.at, checked.dimension)?;
        for (d, at) in tracer.at.iter().enumerate() {
            let tolerance = checked.tolerance(d);
            let bounds = &checked.bodies[number];
            let (lower, upper) = (bounds.lower[d], bounds.upper[d]);
            if *at < lower - tolerance || *at > upper + tolerance {
                let reason = format!(
                    "outside of its body; allowed: {lower} to {upper} ({})",
                    join("bodies", &tracer.body)
                );
                return Err(SceneFault::new(path, &tracer.at, reason));
            }
        }
    }
    Ok(())
}
