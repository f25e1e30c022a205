//! Options that the total-Lagrangian frame does not support, each rejected with an alternative.

use super::super::errors::SceneFault;
use crate::scene::CheckedScene;
use crate::scene::{FrameKind, SideProperties};

/// The alternative for most of them.
const UPDATED: &str = "method.frame \"updated_lagrangian\"";

pub(super) fn check(checked: &CheckedScene) -> Result<(), SceneFault> {
    let method = &checked.scene.method;
    if method.frame != FrameKind::TotalLagrangian {
        return Ok(());
    }
    let refuse = |path: &str, value: serde_json::Value, why: &str, allowed: &str| {
        let reason = format!(
            "cannot go with method.frame = \"total_lagrangian\", {why}; allowed: {allowed}{UPDATED}"
        );
        Err(SceneFault::new(path, value, reason))
    };
    let leave_out = "to leave it out, or ";
    if let Some(rate) = method.volume_relaxation {
        let why = "whose grid does not see what space there is";
        return refuse("method.volume_relaxation", rate.into(), why, leave_out);
    }
    if let Some(limit) = method.domain_limit {
        let why = "which takes the domains of the start";
        return refuse("method.domain_limit", limit.into(), why, leave_out);
    }
    if checked.velocity_fields() > 1 && checked.dimension > 1 {
        let why = "in which what slides keeps meeting what it met at the start";
        let contact = serde_json::json!(checked.scene.contact);
        let allowed = "{\"type\": \"stick\"}, to leave it out, or ";
        return refuse("contact", contact, why, allowed);
    }
    let names = ["boundary.x_lower", "boundary.x_upper", "boundary.y_lower", "boundary.y_upper"];
    for (path, side) in names.into_iter().zip(checked.sides::<2>().as_flattened()) {
        let SideProperties { lets_out, absorbs_waves, .. } = side.properties();
        if lets_out && !absorbs_waves {
            let why = "in which nothing leaves";
            return refuse(path, serde_json::json!(side), why, "\"free\", \"transmitting\", or ");
        }
    }
    check_apart(checked)
}

/// Checks that each body touches another one: bodies apart at the start would never meet.
fn check_apart(checked: &CheckedScene) -> Result<(), SceneFault> {
    let count = checked.bodies.len();
    let touches = |i: usize, k: usize| {
        let (one, other) = (&checked.bodies[i], &checked.bodies[k]);
        (0..checked.dimension).all(|a| {
            one.lower[a].max(other.lower[a]) - one.upper[a].min(other.upper[a])
                <= checked.tolerance(a)
        })
    };
    // bodies that are connected to the first one
    let mut joined = vec![false; count];
    let mut next = vec![0];
    while let Some(i) = next.pop() {
        joined[i] = true;
        next.extend((0..count).filter(|&k| !joined[k] && touches(i, k)));
    }
    match joined.iter().position(|&j| !j) {
        None => Ok(()),
        Some(i) => {
            let reason = format!(
                "the body stands apart from \"{}\" at the start, and in method.frame = \
                 \"total_lagrangian\" such bodies never meet; allowed: to let them touch, or \
                 {UPDATED}",
                checked.scene.bodies[0].name
            );
            Err(SceneFault::new(format!("bodies[{i}]"), &checked.scene.bodies[i].name, reason))
        }
    }
}
