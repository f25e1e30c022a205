//! Checks of the body and the positions of `error_estimate`: one dimension, with or without a
//! reference.

use super::super::errors::{SceneFault, suggest};
use super::super::model::Reference;
use super::CheckedScene;

impl CheckedScene {
    /// Index of the body of `error_estimate`: the named one, or the default of
    /// [`Self::default_estimated_body`]; `None` without the key.
    pub fn estimated_body(&self) -> Option<usize> {
        let asked = self.scene.error_estimate.as_ref()?;
        match &asked.body {
            Some(name) => self.body_named(name),
            None => self.default_estimated_body(),
        }
    }

    /// Index of the body whose errors are estimated if `error_estimate.body` is absent: the body
    /// that the reference scores, else the only body, else the only body at rest, which the others
    /// strike.
    pub fn default_estimated_body(&self) -> Option<usize> {
        let scored = match &self.scene.reference {
            Some(Reference::FlyerImpact(named)) => Some(&named.target),
            Some(Reference::WallImpact(named)) => Some(&named.body),
            Some(Reference::SimpleWave(named)) => Some(&named.body),
            Some(Reference::Noh(named)) => Some(&named.body),
            _ => None,
        };
        if let Some(name) = scored {
            return self.body_named(name);
        }
        if self.bodies.len() == 1 {
            return Some(0);
        }
        let mut at_rest = (0..self.bodies.len()).filter(|&b| self.bodies[b].top_speed == 0.0);
        at_rest.next().filter(|_| at_rest.next().is_none())
    }

    fn body_named(&self, name: &str) -> Option<usize> {
        self.scene.bodies.iter().position(|b| b.name == name)
    }
}

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
