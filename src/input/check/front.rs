//! Checks of the direction of plane waves at an angle.

use serde_json::json;

use super::super::errors::SceneFault;
use super::common::check_length;
use crate::scene::CheckedScene;

/// Checks that a front has a line in the plane of its scene.
pub(super) fn check(checked: &CheckedScene, path: &str) -> Result<(), SceneFault> {
    let Some(front) = checked.front() else { return Ok(()) };
    let path = format!("{path}.front");
    if checked.dimension == 1 {
        let reason = "a line in a plane, but domain.lower has 1 number; allowed: to leave it out";
        return Err(SceneFault::new(path, json!(front), reason));
    }
    check_length(&format!("{path}.about"), &front.about, checked.dimension)?;
    if let Some([from, to]) = front.range
        && from >= to
    {
        let reason = "ends before it begins; allowed: two numbers that ascend";
        return Err(SceneFault::new(format!("{path}.range"), [from, to], reason));
    }
    Ok(())
}
