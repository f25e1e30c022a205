//! What a statement of errors needs: a line, a body filled evenly, places in it.

use super::super::errors::{Fault, suggest};
use super::super::model::Reference;
use super::CheckedScene;

impl CheckedScene {
    /// The body that `error_estimate` is about; none without that key.
    pub fn estimated_body(&self) -> Option<usize> {
        let asked = self.scene.error_estimate.as_ref()?;
        let name = asked.body.as_deref().or(match self.scene.reference.as_ref()? {
            Reference::FlyerImpact(named) => Some(named.target.as_str()),
            Reference::WallImpact(named) => Some(named.body.as_str()),
            _ => None,
        })?;
        self.scene.bodies.iter().position(|b| b.name == name)
    }
}

/// Refuses a statement of errors that cannot be made.
pub(super) fn check(checked: &CheckedScene) -> Result<(), Fault> {
    let Some(asked) = &checked.scene.error_estimate else { return Ok(()) };
    let names = || checked.scene.bodies.iter().map(|b| b.name.as_str());
    if checked.dimension != 1 {
        return Err(Fault::missing("error_estimate", "in a plane; allowed: scenes on a line"));
    }
    let Some(body) = checked.estimated_body() else {
        return Err(match &asked.body {
            Some(name) => {
                let reason = format!("no such body{}", suggest(name, names()));
                Fault::new("error_estimate.body", name, reason)
            }
            None => Fault::missing(
                "error_estimate.body",
                format!(
                    "missing key, for the reference scores no one body; allowed: {}",
                    names().collect::<Vec<_>>().join(", ")
                ),
            ),
        });
    };
    if let Some(own) = checked.scene.bodies.iter().find(|b| b.particles_per_cell.is_none()) {
        let reason = "has positions of its own, which no larger cells go with; allowed: bodies \
                      with particles_per_cell";
        return Err(Fault::new("error_estimate", &own.name, reason));
    }
    let bounds = &checked.bodies[body];
    for (k, &at) in asked.arrivals.iter().enumerate() {
        if !(bounds.lower[0]..=bounds.upper[0]).contains(&at) {
            let reason =
                format!("outside of its body; allowed: {} to {}", bounds.lower[0], bounds.upper[0]);
            return Err(Fault::new(format!("error_estimate.arrivals[{k}]"), at, reason));
        }
    }
    Ok(())
}
