//! The body and the fields whose errors are estimated.

use super::checked::CheckedScene;
use super::model::Reference;

impl CheckedScene {
    /// Index of the body of `error_estimate`: the named one, or the default of
    /// [`Self::default_estimated_body`]; `None` without the key, and in a plane.
    pub fn estimated_body(&self) -> Option<usize> {
        let asked = self.scene.error_estimate.as_ref().filter(|_| self.dimension == 1)?;
        match &asked.body {
            Some(name) => self.body_named(name),
            None => self.default_estimated_body(),
        }
    }

    /// Quantities of the particles whose errors are estimated in each profile.
    pub fn estimated_fields(&self) -> Vec<&str> {
        let Some(asked) = &self.scene.error_estimate else { return Vec::new() };
        match &asked.fields {
            Some(fields) => fields.iter().map(String::as_str).collect(),
            None if self.dimension == 1 => Vec::new(),
            None => vec!["pressure"],
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
