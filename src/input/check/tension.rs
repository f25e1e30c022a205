//! Warnings about tension: more than a material is known to withstand, and limits that are never reached.
//!
//! Where two plates with free rear faces strike each other, the rarefactions from these faces meet in
//! the plate that waves take longer to cross, and leave it in tension. With the impedances Z = rho0 c0
//! of this plate and Z' of the other, the impact speed v and P = v Z Z'/(Z + Z'), acoustic waves give
//! the tension
//!
//! ```text
//! P - max(0, P (Z' - Z)/(Z' + Z))
//! ```
//!
//! The second term is the pressure that the other plate keeps up behind the rarefaction from its
//! rear. Shocks are stronger than acoustic waves, so that the estimate is low.

use serde_json::json;

use crate::input::paths::join;
use crate::material::failure::PressureLimit;
use crate::scene::{CheckedScene, Material};

/// Tension that no solid or liquid withstands in a spall, over its bulk modulus [-]. Metals withstand
/// 0.5 to 3 % (Antoun et al. 2003, Spall fracture).
const MAX_TENSION_RATIO: f64 = 0.04;

/// Warnings of a scene; `speeds` are the sound speeds of the bodies [m/s].
pub(super) fn warnings(checked: &CheckedScene, speeds: &[f64]) -> Vec<String> {
    let materials = checked.scene.materials.iter();
    materials.filter_map(never_reached).chain(unlimited(checked, speeds)).collect()
}

/// Tension at which the equation of state is cut off [Pa].
fn cutoff(material: &Material) -> Option<f64> {
    let eos = json!(material.eos);
    eos["tension_cutoff"].as_f64().or(eos["solid"]["tension_cutoff"].as_f64())
}

/// A limit of the failure law beyond the cutoff of the equation of state.
fn never_reached((name, material): (&String, &Material)) -> Option<String> {
    let PressureLimit { key, tension } =
        material.failure?.pressure_limit(&material.strength_beside())?;
    let cutoff = cutoff(material).filter(|cutoff| tension > *cutoff)?;
    let path = join("materials", name);
    Some(format!(
        "{path}.failure.{key} = {tension:e}: never acts, since {path}.eos.tension_cutoff = {cutoff:e} \
         lets no more tension arise"
    ))
}

/// An impact of two plates whose tension nothing limits.
fn unlimited(checked: &CheckedScene, speeds: &[f64]) -> Option<String> {
    if checked.dimension != 1 || checked.bodies.len() != 2 {
        return None;
    }
    let (a, b) =
        if checked.bodies[0].lower[0] < checked.bodies[1].lower[0] { (0, 1) } else { (1, 0) };
    if !checked.face_is_free(a, false) || !checked.face_is_free(b, true) {
        return None;
    }
    let body = |i: usize| &checked.bodies[i];
    let speed = body(a).velocity[0] - body(b).velocity[0];
    let gap = (body(b).lower[0] - body(a).upper[0]).max(0.0);
    let crossing = |i: usize| (body(i).upper[0] - body(i).lower[0]) / speeds[i];
    // not "<=": a gas at rest may have no sound speed
    let meets = speed > 0.0 && gap / speed + crossing(a) + crossing(b) < checked.scene.time.end;
    if !meets {
        return None;
    }
    let (own, other) = if crossing(a) <= crossing(b) { (b, a) } else { (a, b) };
    let material = checked.material_of(own);
    let eos = &material.eos;
    let unlimited = material.failure.is_none() && cutoff(material).is_none();
    if eos.is_gas() || eos.is_solid() || eos.has_history() || !unlimited {
        return None;
    }
    let impedance = |i: usize| checked.material_of(i).density * speeds[i];
    let (z, behind) = (impedance(own), impedance(other));
    let pressure = speed * z * behind / (z + behind);
    let tension = pressure - (pressure * (behind - z) / (behind + z)).max(0.0);
    (tension > MAX_TENSION_RATIO * z * speeds[own]).then(|| {
        format!(
            "{}: {} would reach a tension of about {} where the rarefactions from the rear faces \
             meet, and no material withstands more than a few percent of its bulk modulus; give the \
             material a failure law or eos.tension_cutoff",
            join("bodies", &checked.scene.bodies[own].name),
            checked.scene.bodies[own].material,
            match tension < 1e8 {
                true => format!("{:.1} MPa", tension * 1e-6),
                false => format!("{:.1} GPa", tension * 1e-9),
            }
        )
    })
}
