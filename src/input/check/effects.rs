//! Checks of strength, failure and temperature of the materials, and their requirements on each
//! other.

use super::super::errors::SceneFault;
use super::super::faults::Faults;
use super::super::paths::join;
use crate::material::ParameterError;
use crate::scene::{Body, HeatSource, Material, Scene};

pub(super) fn check(scene: &Scene, faults: &mut Faults) {
    for (name, material) in &scene.materials {
        let path = join("materials", name);
        if faults.concern(&path) {
            continue;
        }
        faults.take(check_strength(&path, material));
        faults.take(check_failure(&path, material));
        faults.take(check_thermal(&path, material));
        faults.judge(&["body_force", "boundary"], || check_erosion(&path, material, scene));
    }
    faults.judge(&["boundary", "materials"], || check_sides(scene));
    for body in &scene.bodies {
        let path = join("bodies", &body.name);
        let reads = [&join(&path, "temperature"), &join(&path, "pressure")];
        faults.judge(&[reads[0], reads[1], &join("materials", &body.material)], || {
            check_body(scene, body, reads[0].clone())
        });
    }
}

/// Checks that side temperatures have a material with heat conduction and a rigid side.
fn check_sides(scene: &Scene) -> Result<(), SceneFault> {
    let Some(boundary) = &scene.boundary else { return Ok(()) };
    let Some(held) = boundary.temperature else { return Ok(()) };
    let conducts = |m: &Material| m.thermal.is_some_and(|t| t.conductivity.is_some());
    for (key, temperature, side) in [
        ("x_lower", held.x_lower, Some(&boundary.x_lower)),
        ("x_upper", held.x_upper, Some(&boundary.x_upper)),
        ("y_lower", held.y_lower, boundary.y_lower.as_ref()),
        ("y_upper", held.y_upper, boundary.y_upper.as_ref()),
    ] {
        let Some(temperature) = temperature else { continue };
        let path = format!("boundary.temperature.{key}");
        if !scene.materials.values().any(conducts) {
            let reason = "no material conducts heat; allowed: to leave it out, or \
                          thermal.conductivity of a material";
            return Err(SceneFault::new(path, temperature, reason));
        }
        if !side.is_some_and(|side| side.properties().is_rigid()) {
            let reason = format!(
                "needs a rigid side; allowed: to leave it out, or boundary.{key} \"wall\" or \
                 another rigid one"
            );
            return Err(SceneFault::new(path, temperature, reason));
        }
    }
    Ok(())
}

fn check_body(scene: &Scene, body: &Body, path: String) -> Result<(), SceneFault> {
    let Some(temperature) = body.temperature else { return Ok(()) };
    let Some(material) = scene.materials.get(&body.material) else { return Ok(()) };
    let Some(thermal) = material.thermal else {
        let key = join("materials", &body.material);
        let reason = format!("{key} has no thermal; allowed: to leave it out, or {key}.thermal");
        return Err(SceneFault::new(path, temperature, reason));
    };
    if thermal.source == HeatSource::Energy && body.pressure != 0.0 {
        let reason = format!(
            "beside pressure = {}, which sets the energy too; allowed: one of the two",
            body.pressure
        );
        return Err(SceneFault::new(path, temperature, reason));
    }
    Ok(())
}

fn check_strength(path: &str, material: &Material) -> Result<(), SceneFault> {
    let Some(strength) = material.strength else { return Ok(()) };
    if material.eos.is_solid() {
        let reason = "beside an eos that supports shear by itself; allowed: to leave it out, or the \
                      eos of a fluid, such as \"mie_gruneisen\"";
        return Err(SceneFault::new(format!("{path}.strength"), strength, reason));
    }
    let of_strength = |error| SceneFault::of_parameter(error, &format!("{path}.strength"));
    if let (Some(key), None) = (strength.needs_temperature(), material.thermal) {
        let reason =
            format!("needs a temperature; allowed: to leave it out, or {path}.thermal beside it");
        return Err(of_strength(ParameterError::new(key, true, reason)));
    }
    strength.check().map_err(of_strength)
}

fn check_failure(path: &str, material: &Material) -> Result<(), SceneFault> {
    let Some(failure) = material.failure else { return Ok(()) };
    let path = format!("{path}.failure");
    if material.eos.is_solid() {
        let reason = "an elastic solid does not fail; allowed: to leave it out, or the eos of a \
                      fluid, such as \"mie_gruneisen\", with strength";
        return Err(SceneFault::new(path, failure, reason));
    }
    failure.check(&material.strength_beside()).map_err(|e| SceneFault::of_parameter(e, &path))
}

fn check_erosion(path: &str, material: &Material, scene: &Scene) -> Result<(), SceneFault> {
    let Some(erosion) = material.erosion else { return Ok(()) };
    let path = format!("{path}.erosion");
    let refuse = |why: &str, allowed: &str| {
        Err(SceneFault::new(
            &path,
            erosion,
            format!("{why}; allowed: to leave it out, or {allowed}"),
        ))
    };
    if material.eos.is_solid() {
        let allowed = "the eos of a fluid, such as \"mie_gruneisen\", with strength";
        return refuse("an elastic solid does not erode", allowed);
    }
    if erosion.plastic_strain.is_none() && erosion.volume_ratio.is_none() {
        return refuse("has no limit", "plastic_strain, volume_ratio or both");
    }
    if let (Some(limit), None) = (erosion.plastic_strain, material.strength) {
        let reason = "needs plastic strain; allowed: volume_ratio, or strength beside it";
        return Err(SceneFault::new(format!("{path}.plastic_strain"), limit, reason));
    }
    if scene.body_force.is_some() {
        return refuse("the work of a body force on what goes is not booked", "no body_force");
    }
    if scene.boundary.as_ref().is_some_and(|b| b.temperature.is_some()) {
        let why = "the heat that sides have given what goes is not booked";
        return refuse(why, "no boundary.temperature");
    }
    Ok(())
}

fn check_thermal(path: &str, material: &Material) -> Result<(), SceneFault> {
    let Some(thermal) = material.thermal else { return Ok(()) };
    let path = format!("{path}.thermal");
    if material.eos.is_solid() {
        let reason = "an elastic solid has no thermal part; allowed: to leave it out, or the eos \
                      of a fluid with strength";
        return Err(SceneFault::new(path, thermal, reason));
    }
    if material.eos.has_history() && thermal.source == HeatSource::Energy {
        let reason = "pores and burning explosives have no one isentrope; allowed: to leave it \
                      out, or thermal.source \"plastic_work\" with strength";
        return Err(SceneFault::new(path, thermal, reason));
    }
    if material.strength.is_none() {
        if thermal.source == HeatSource::PlasticWork {
            let reason = "without strength there is none; allowed: \"energy\", or strength";
            return Err(SceneFault::new(format!("{path}.source"), thermal.source, reason));
        }
        if thermal.taylor_quinney != 1.0 {
            let reason =
                "says nothing without strength; allowed: to leave it out, or strength beside it";
            return Err(SceneFault::new(
                format!("{path}.taylor_quinney"),
                thermal.taylor_quinney,
                reason,
            ));
        }
    }
    Ok(())
}
