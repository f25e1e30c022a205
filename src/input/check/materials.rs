//! Checks of materials: consistent constants and admissible pressures.

use super::super::errors::SceneFault;
use super::super::faults::Faults;
use super::super::paths::join;
use super::super::schema::{GREATEST, LEAST};
use super::common::check_printable;
use crate::material::constitutive::equation;
use crate::material::{EosContext, HistoryEos};
use crate::scene::{Body, Material, Scene};

/// Relative difference between the speed of a burning front and that of a self-sustaining
/// detonation above which a warning is given [-].
const NEAR: f64 = 0.05;

/// Largest order of FMPM at which a burning front is stable; measured over a distance of 1600
/// cells.
const STABLE_ORDER: u32 = 2;

pub(super) fn check(scene: &Scene, faults: &mut Faults, warnings: &mut Vec<String>) {
    for (name, material) in &scene.materials {
        let path = join("materials", name);
        let eos = join(&path, "eos");
        let reads = [&join(&path, "density")[..], &eos[..]];
        if faults.judge(&reads, || check_one(scene, name, material, &path)).is_some() {
            warn_of_front(material, &path, warnings);
            warn_of_filter(scene, material, &path, warnings);
        }
    }
}

fn check_one(scene: &Scene, name: &str, material: &Material, path: &str) -> Result<(), SceneFault> {
    check_printable("materials", name)?;
    let at = EosContext { density: material.density, dimension: scene.domain.lower.len() };
    let of_eos = |error| SceneFault::of_parameter(error, &format!("{path}.eos"));
    material.eos.check(&at).map_err(of_eos)?;
    if let Ok(Some(eos)) = equation(material) {
        check_stiffness(&*eos, material, path)?;
    }
    if (LEAST..=GREATEST).contains(&material.density) {
        return Ok(());
    }
    let reason = format!("out of range; allowed: {LEAST:e} to {GREATEST:e} kg/m3");
    Err(SceneFault::new(format!("{path}.density"), material.density, reason))
}

/// Checks that the initial sound speed is a finite number.
fn check_stiffness(
    eos: &dyn HistoryEos,
    material: &Material,
    path: &str,
) -> Result<(), SceneFault> {
    let history = eos.first_history().unwrap_or(0.0);
    let (point, _) = eos.at(1.0, eos.energy_at(0.0), history);
    let square = point.sound_speed_squared;
    // pressures are multiplied with each other
    let stiff = square > 0.0 && (material.density * square).powi(2).is_normal();
    // a gas without pressure has no stiffness; it is rejected where this matters
    if stiff && square.is_normal() || material.eos.is_gas() {
        return Ok(());
    }
    let reason = format!(
        "with a sound speed at rest of sqrt({square:e}) m/s there is no finite stiffness; allowed: \
         constants in SI units that give one"
    );
    Err(SceneFault::new(format!("{path}.density"), material.density, reason))
}

/// Warns of a front whose speed differs from the detonation speed of its products.
fn warn_of_front(material: &Material, path: &str, warnings: &mut Vec<String>) {
    let Some(front) = material.eos.burn().and_then(|b| b.front()) else { return };
    let Some(products) = material.eos.products(material.density) else { return };
    let sustained = products.detonation().speed;
    if (front.detonation_velocity / sustained - 1.0).abs() > NEAR {
        warnings.push(format!(
            "{path}.eos.burn.detonation_velocity = {}: these products sustain a detonation at \
             {sustained:.0} m/s (Chapman-Jouguet)",
            front.detonation_velocity
        ));
    }
}

/// Warns of a front whose pressure grows with the number of cells that it has passed: FMPM of high
/// order carries velocity into the unburnt explosive, which has no stiffness to resist it; the
/// explosive compressed in this way burns at a higher pressure.
fn warn_of_filter(scene: &Scene, material: &Material, path: &str, warnings: &mut Vec<String>) {
    let front = material.eos.burn().and_then(|burn| burn.front());
    let plan = scene.method.transfer.plan();
    let order = plan.order;
    if front.is_some() && plan.full_mass_matrix && order > STABLE_ORDER {
        warnings.push(format!(
            "{path}.eos.burn: with method.transfer of order {order} the pressure behind a burning \
             front grows with the number of cells that it has passed (1.15 times after 800 cells, \
             and the run ends after some 1200); with {{\"fmpm\": {STABLE_ORDER}}} or \"flip\" it \
             stays"
        ));
    }
}

/// Checks that the material can have its initial pressure at its density.
pub(super) fn check_pressure(scene: &Scene, body: &Body, path: &str) -> Result<(), SceneFault> {
    let material = &scene.materials[&body.material];
    let pressure = body.pressure;
    if let Some(why) = material.eos.no_initial_pressure() {
        return match pressure {
            0.0 => Ok(()),
            _ => Err(SceneFault::new(path, pressure, format!("{why}; allowed: 0"))),
        };
    }
    material
        .eos
        .check_initial_pressure(material.density, pressure)
        .map_err(|reason| SceneFault::new(path, pressure, reason))?;
    let Ok(Some(eos)) = equation(material) else { return Ok(()) };
    let (history, e) = (eos.first_history().unwrap_or(0.0), eos.energy_at(pressure));
    let (point, _) = eos.at(1.0, e, history);
    let rounding = 1e-12 * material.density * point.sound_speed_squared.abs();
    let reached = (point.pressure - pressure).abs() <= 1e-9 * pressure.abs() + rounding;
    if e.is_finite() && reached && eos.check_validity(1.0, e, history, pressure).is_none() {
        return Ok(());
    }
    let reason = "no energy brings the material to it at its density; allowed: a pressure that the \
                  equation of state reaches";
    Err(SceneFault::new(path, pressure, reason))
}
