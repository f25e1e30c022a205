//! Checks of the body and the positions of `error_estimate`: one dimension, with or without a
//! reference.

use super::super::errors::{SceneFault, suggest};
use crate::scene::CheckedScene;

/// Rejects an estimate in a plane, without a body, or at positions outside its body.
pub(super) fn check(checked: &CheckedScene) -> Result<(), SceneFault> {
    let Some(asked) = &checked.scene.error_estimate else { return Ok(()) };
    let names = || checked.scene.bodies.iter().map(|b| b.name.as_str());
    if checked.dimension != 1 {
        return Err(SceneFault::missing("error_estimate", "in a plane; allowed: scenes on a line"));
    }
    let Some(body) = checked.estimated_body() else {
        return Err(match &asked.body {
            Some(name) => {
                let reason = format!("no such body{}", suggest(name, names()));
                SceneFault::new("error_estimate.body", name, reason)
            }
            None => SceneFault::missing(
                "error_estimate.body",
                format!(
                    "missing key, for no reference scores one body and not just one is at rest; \
                     allowed: {}",
                    names().collect::<Vec<_>>().join(", ")
                ),
            ),
        });
    };
    let bounds = &checked.bodies[body];
    for (k, &at) in asked.arrivals.iter().enumerate() {
        if !(bounds.lower[0]..=bounds.upper[0]).contains(&at) {
            let reason =
                format!("outside of its body; allowed: {} to {}", bounds.lower[0], bounds.upper[0]);
            return Err(SceneFault::new(format!("error_estimate.arrivals[{k}]"), at, reason));
        }
    }
    Ok(())
}
