//! Checks of exact solutions that require a certain initial motion of a body.

use serde::Serialize;

use super::super::errors::SceneFault;
use super::super::paths::join;
use super::common::find_body;
use crate::scene::CheckedScene;
use crate::scene::motion::Motion;
use crate::scene::{BodyForce, NamedBody, NamedNoh, NohSymmetry};

/// Fault of the reference `name`.
fn fault(name: &str, value: impl Serialize, reason: String) -> Result<(), SceneFault> {
    Err(SceneFault::new(join("reference", name), value, reason))
}

/// Index of the body, and its initial motion.
fn motion_of<'a>(
    checked: &'a CheckedScene,
    name: &str,
    body: &str,
) -> Result<(usize, Option<&'a Motion>), SceneFault> {
    let i = find_body(checked, &format!("reference.{name}.body"), body)?;
    Ok((i, checked.bodies[i].motion.as_ref()))
}

/// Fault of the reference `name` if the body lacks `what`, which the exact solution requires.
fn needs(checked: &CheckedScene, name: &str, body: usize, what: &str) -> Result<(), SceneFault> {
    let body = &checked.scene.bodies[body].name;
    let path = join("bodies", body);
    fault(name, body, format!("{path} has no {what}, which the exact solution begins with"))
}

pub(super) fn check_vortex(checked: &CheckedScene, named: &NamedBody) -> Result<(), SceneFault> {
    const NAME: &str = "vortex";
    let (body, motion) = motion_of(checked, NAME, &named.body)?;
    let Some(Motion::Vortex(vortex)) = motion else {
        return needs(checked, NAME, body, "velocity_field.vortex");
    };
    match &checked.scene.body_force {
        Some(BodyForce::Vortex(ring))
            if [ring.amplitude, ring.period, ring.inner, ring.outer]
                == [vortex.amplitude, vortex.period, vortex.inner, vortex.outer] =>
        {
            Ok(())
        }
        other => {
            let reason = "does not hold the body on its course; allowed: body_force.vortex with \
                          the numbers of its velocity_field.vortex";
            Err(SceneFault::new("body_force", other, reason))
        }
    }
}

pub(super) fn check_rotation(checked: &CheckedScene, named: &NamedBody) -> Result<(), SceneFault> {
    const NAME: &str = "rotation";
    let (body, motion) = motion_of(checked, NAME, &named.body)?;
    match motion {
        Some(Motion::Rotation(..)) => Ok(()),
        _ => needs(checked, NAME, body, "velocity_field.rotation"),
    }
}

pub(super) fn check_shear_layer(
    checked: &CheckedScene,
    named: &NamedBody,
) -> Result<(), SceneFault> {
    const NAME: &str = "shear_layer";
    let (body, motion) = motion_of(checked, NAME, &named.body)?;
    match motion {
        Some(Motion::ShearLayer(_)) => Ok(()),
        _ => needs(checked, NAME, body, "velocity_field.shear_layer"),
    }
}

pub(super) fn check_gresho(checked: &CheckedScene, named: &NamedBody) -> Result<(), SceneFault> {
    const NAME: &str = "gresho";
    let (body, motion) = motion_of(checked, NAME, &named.body)?;
    match motion {
        Some(Motion::Gresho(_)) => Ok(()),
        _ => needs(checked, NAME, body, "velocity_field.gresho"),
    }
}

pub(super) fn check_noh(checked: &CheckedScene, named: &NamedNoh) -> Result<(), SceneFault> {
    const NAME: &str = "noh";
    let (body, motion) = motion_of(checked, NAME, &named.body)?;
    let axisymmetric = checked.axisymmetric();
    let radial = match motion {
        Some(Motion::Radial(_, speed)) => *speed < 0.0,
        _ => false,
    };
    let to_axis = checked.speed_to_axis(body).is_some();
    let fits = match (checked.dimension, axisymmetric) {
        (1, _) if radial => NohSymmetry::Planar,
        (2, false) if radial => NohSymmetry::Cylindrical,
        (2, true) if to_axis => NohSymmetry::Cylindrical,
        (2, true) if radial => NohSymmetry::Spherical,
        (_, true) => {
            let what = "velocity_field.radial with a speed below 0, nor a velocity along x \
                        towards the axis";
            return needs(checked, NAME, body, what);
        }
        _ => return needs(checked, NAME, body, "velocity_field.radial with a speed below 0"),
    };
    if named.symmetry != fits {
        let allowed = serde_json::json!(fits);
        let reason = format!("is not what this domain has; allowed: {allowed}");
        return Err(SceneFault::new("reference.noh.symmetry", named.symmetry, reason));
    }
    let cold = checked.material_of(body).eos.is_gas() && checked.scene.bodies[body].pressure == 0.0;
    if !cold {
        let reason =
            "is of no cold gas; allowed: a body without pressure whose eos is \"ideal_gas\"";
        return fault(NAME, &named.body, reason.into());
    }
    if let [from, to] = named.between[..]
        && from >= 0.0
        && from < to
    {
        return Ok(());
    }
    let reason = "no distances; allowed: two numbers of at least 0, the first below the second";
    Err(SceneFault::new("reference.noh.between", &named.between, reason))
}
