//! Checks of `error_estimate`: its body and positions on a line, and its quantities.

use super::super::errors::{SceneFault, suggest};
use super::common::check_quantities;
use crate::effects;
use crate::scene::CheckedScene;

/// Rejects an estimate on a line without a body or at positions outside its body, and bodies and
/// positions in a plane.
pub(super) fn check(checked: &CheckedScene) -> Result<(), SceneFault> {
    let Some(asked) = &checked.scene.error_estimate else { return Ok(()) };
    let names = || checked.scene.bodies.iter().map(|b| b.name.as_str());
    if checked.dimension != 1 {
        let keys = [("body", asked.body.is_some()), ("arrivals", !asked.arrivals.is_empty())];
        return match keys.iter().find(|(_, is)| *is) {
            Some((key, _)) => Err(SceneFault::missing(
                format!("error_estimate.{key}"),
                "not available in a plane; allowed: error_estimate.fields, and gauges in \
                 output.histories",
            )),
            None => Ok(()),
        };
    }
    let Some(body) = checked.estimated_body() else {
        // gauges and fields need no body
        let others = asked.fields.is_some() || checked.scene.output.histories.is_some();
        if others && asked.body.is_none() && asked.arrivals.is_empty() {
            return Ok(());
        }
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

/// Rejects quantities that the scene does not have, and repeated ones.
pub(super) fn check_fields(checked: &CheckedScene) -> Result<(), SceneFault> {
    let mut known = effects::columns(checked).quantities(checked.dimension);
    // profiles have no such columns, or the values depend on the size of the particles
    known.retain(|name| !["mass", "volume", "strain", "failed", "spin_inertia"].contains(name));
    let mut fields = checked.scene.error_estimate.iter().flat_map(|estimate| &estimate.fields);
    fields.try_for_each(|names| check_quantities("error_estimate.fields", names, &known))
}
