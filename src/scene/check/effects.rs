//! Strength, failure and temperature of the materials: what each needs of the others.

use super::super::errors::Fault;
use super::super::model::{Eos, Failure, HeatSource, Material, Scene, Strength};
use super::super::validate::join;

pub(super) fn check(scene: &Scene) -> Result<(), Fault> {
    check_sides(scene)?;
    check_bodies(scene)?;
    for (name, material) in &scene.materials {
        let path = join("materials", name);
        check_strength(&path, material)?;
        check_failure(&path, material)?;
        check_erosion(&path, material, scene)?;
        check_thermal(&path, material)?;
    }
    Ok(())
}

/// Temperatures of sides need heat that is conducted, and a side that has images.
fn check_sides(scene: &Scene) -> Result<(), Fault> {
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
            return Err(Fault::new(path, temperature, reason));
        }
        if side.and_then(|side| side.rigid_velocity()).is_none() {
            let reason = format!(
                "needs a rigid side; allowed: to leave it out, or boundary.{key} \"wall\" or \
                 another rigid one"
            );
            return Err(Fault::new(path, temperature, reason));
        }
    }
    Ok(())
}

fn check_bodies(scene: &Scene) -> Result<(), Fault> {
    for body in &scene.bodies {
        let Some(temperature) = body.temperature else { continue };
        let path = format!("{}.temperature", join("bodies", &body.name));
        let Some(material) = scene.materials.get(&body.material) else { continue };
        let Some(thermal) = material.thermal else {
            let key = join("materials", &body.material);
            let reason =
                format!("{key} has no thermal; allowed: to leave it out, or {key}.thermal");
            return Err(Fault::new(path, temperature, reason));
        };
        if thermal.source == HeatSource::Energy && body.pressure != 0.0 {
            let reason = format!(
                "beside pressure = {}, which sets the energy too; allowed: one of the two",
                body.pressure
            );
            return Err(Fault::new(path, temperature, reason));
        }
    }
    Ok(())
}

fn check_strength(path: &str, material: &Material) -> Result<(), Fault> {
    let Some(strength) = material.strength else { return Ok(()) };
    let below = |key: &str| format!("{path}.strength.{key}");
    if material.eos.is_solid() {
        let reason = "beside an eos that bears shear by itself; allowed: to leave it out, or the \
                      eos of a fluid, such as \"mie_gruneisen\"";
        return Err(Fault::new(format!("{path}.strength"), strength, reason));
    }
    let needs_thermal = |key: &str| {
        let reason =
            format!("needs a temperature; allowed: to leave it out, or {path}.thermal beside it");
        Fault::new(below(key), true, reason)
    };
    match strength {
        Strength::VonMises { .. } => {}
        Strength::JohnsonCook { softening: Some(softening), .. } => {
            if material.thermal.is_none() {
                return Err(needs_thermal("softening"));
            }
            if softening.melt_temperature <= softening.reference_temperature {
                let reason = format!(
                    "not above reference_temperature = {}; allowed: a higher temperature",
                    softening.reference_temperature
                );
                let key = below("softening.melt_temperature");
                return Err(Fault::new(key, softening.melt_temperature, reason));
            }
        }
        Strength::JohnsonCook { softening: None, .. } => {}
        Strength::SteinbergGuinan {
            temperature_softening, yield_stress, max_yield_stress, ..
        } => {
            if temperature_softening.is_some() && material.thermal.is_none() {
                return Err(needs_thermal("temperature_softening"));
            }
            if max_yield_stress < yield_stress {
                let reason =
                    format!("below yield_stress = {yield_stress}; allowed: at least as much");
                return Err(Fault::new(below("max_yield_stress"), max_yield_stress, reason));
            }
        }
    }
    Ok(())
}

fn check_failure(path: &str, material: &Material) -> Result<(), Fault> {
    let Some(failure) = material.failure else { return Ok(()) };
    let path = format!("{path}.failure");
    if material.eos.is_solid() {
        let reason = "an elastic solid does not fail; allowed: to leave it out, or the eos of a \
                      fluid, such as \"mie_gruneisen\", with strength";
        return Err(Fault::new(path, failure, reason));
    }
    let Failure::JohnsonCook { d1, d2, d5, .. } = failure else { return Ok(()) };
    if material.strength.is_none() {
        let reason = "needs plastic strain; allowed: \"tension_limit\", or strength beside it";
        return Err(Fault::new(format!("{path}.type"), "johnson_cook", reason));
    }
    if d1 + d2.max(0.0) <= 0.0 {
        let reason = format!(
            "with d2 = {d2} the material breaks at no strain at all; allowed: d1 + d2 above 0"
        );
        return Err(Fault::new(format!("{path}.d1"), d1, reason));
    }
    let softens =
        matches!(material.strength, Some(Strength::JohnsonCook { softening: Some(_), .. }));
    if d5 != 0.0 && !softens {
        let reason = "needs the temperatures of strength.softening of \"johnson_cook\"; allowed: \
                      0, or those";
        return Err(Fault::new(format!("{path}.d5"), d5, reason));
    }
    Ok(())
}

fn check_erosion(path: &str, material: &Material, scene: &Scene) -> Result<(), Fault> {
    let Some(erosion) = material.erosion else { return Ok(()) };
    let path = format!("{path}.erosion");
    let refuse = |why: &str, allowed: &str| {
        Err(Fault::new(&path, erosion, format!("{why}; allowed: to leave it out, or {allowed}")))
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
        return Err(Fault::new(format!("{path}.plastic_strain"), limit, reason));
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

fn check_thermal(path: &str, material: &Material) -> Result<(), Fault> {
    let Some(thermal) = material.thermal else { return Ok(()) };
    let path = format!("{path}.thermal");
    if material.eos.is_solid() {
        let reason = "an elastic solid has no thermal part; allowed: to leave it out, or the eos \
                      of a fluid with strength";
        return Err(Fault::new(path, thermal, reason));
    }
    let has_history = matches!(material.eos, Eos::PAlpha { .. })
        || material.eos.burn().is_some_and(|burn| burn.front().is_some());
    if has_history && thermal.source == HeatSource::Energy {
        let reason = "pores and burning explosives have no one isentrope; allowed: to leave it \
                      out, or thermal.source \"plastic_work\" with strength";
        return Err(Fault::new(path, thermal, reason));
    }
    if material.strength.is_none() {
        if thermal.source == HeatSource::PlasticWork {
            let reason = "without strength there is none; allowed: \"energy\", or strength";
            return Err(Fault::new(format!("{path}.source"), thermal.source, reason));
        }
        if thermal.taylor_quinney != 1.0 {
            let reason =
                "says nothing without strength; allowed: to leave it out, or strength beside it";
            return Err(Fault::new(
                format!("{path}.taylor_quinney"),
                thermal.taylor_quinney,
                reason,
            ));
        }
    }
    Ok(())
}
