//! Checks of velocities that vary in space and of body forces: whether a body can have them.

use super::super::errors::SceneFault;
use super::super::paths::join;
use super::common::check_length;
use crate::scene::CheckedScene;
use crate::scene::motion::{Motion, vortex_of};
use crate::scene::{Body, BodyForce, Geometry, Scene, VelocityField};

/// Motion of the body's `velocity_field`, if given.
pub(super) fn check_field(
    scene: &Scene,
    body: &Body,
    path: &str,
    dimension: usize,
) -> Result<Option<Motion>, SceneFault> {
    let Some(field) = &body.velocity_field else { return Ok(None) };
    let path = join(path, "velocity_field");
    let fault = |reason: String| Err(SceneFault::new(&path, field, reason));
    if body.velocity.is_some() {
        return fault("velocity stands there too; allowed: one of the two".into());
    }
    let (name, place) = match field {
        VelocityField::Rotation(r) => ("rotation", Some(("about", &r.about))),
        VelocityField::ShearLayer(_) => ("shear_layer", None),
        VelocityField::Gresho(g) => ("gresho", Some(("centre", &g.centre))),
        VelocityField::Radial(r) => ("radial", Some(("about", &r.about))),
        VelocityField::Vortex(_) => ("vortex", None),
    };
    let below = join(&path, name);
    let anywhere = matches!(field, VelocityField::Radial(_));
    let plane = dimension == 2 && scene.domain.geometry == Geometry::PlaneStrain;
    if !plane && !anywhere {
        return Err(SceneFault::new(
            path,
            field,
            "needs two dimensions in plane strain; allowed: radial",
        ));
    }
    if let Some((key, place)) = place {
        check_length(&join(&below, key), place, dimension)?;
    }
    let about_axis = match field {
        VelocityField::Radial(r) => {
            scene.domain.geometry == Geometry::PlaneStrain || r.about[0] == 0.0
        }
        _ => true,
    };
    if !about_axis {
        return fault("is about no place on the axis; allowed: about[0] = 0".into());
    }
    let material = &scene.materials[&body.material];
    let motion = match Motion::new(field, material) {
        Ok(motion) => motion,
        Err(reason) => return fault(format!("{reason}; the body is of {}", body.material)),
    };
    if body.pressure != 0.0 && matches!(field, VelocityField::Gresho(_)) {
        let reason = "velocity_field.gresho has a pressure of its own; allowed: to leave it out";
        return Err(SceneFault::new(
            path.replace("velocity_field", "pressure"),
            body.pressure,
            reason,
        ));
    }
    Ok(Some(motion))
}

/// Checks the body force of a scene.
pub(super) fn check_body_force(checked: &CheckedScene) -> Result<(), SceneFault> {
    let Some(force) = &checked.scene.body_force else { return Ok(()) };
    let fault = |reason: String| Err(SceneFault::new("body_force", force, reason));
    let sides = checked.sides::<2>();
    let mut all = sides[..checked.dimension].as_flattened().iter();
    if let Some(side) = all.find(|side| side.properties().lets_out) {
        let side = serde_json::json!(side);
        return fault(format!(
            "its work on what leaves by a side {side} is not booked; allowed: any other side"
        ));
    }
    match force {
        BodyForce::Gravity(g) => {
            check_length("body_force.gravity", g, checked.dimension)?;
            if checked.axisymmetric() && g[0] != 0.0 {
                return fault("pulls along a radius; allowed: 0 along x".into());
            }
        }
        BodyForce::Vortex(ring) => {
            if checked.dimension != 2 || checked.axisymmetric() {
                return fault("vortex needs two dimensions in plane strain".into());
            }
            for (i, body) in checked.scene.bodies.iter().enumerate() {
                let Some(vortex) = vortex_of(ring, checked.material_of(i)) else {
                    return fault(format!(
                        "vortex holds a neo-Hookean solid on its course, which {} is not; \
                         allowed: bodies whose eos is \"neo_hookean\"",
                        join("bodies", &body.name)
                    ));
                };
                if let Err(error) = vortex.check() {
                    return fault(error.to_string());
                }
            }
        }
    }
    Ok(())
}
