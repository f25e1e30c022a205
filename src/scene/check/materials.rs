//! Materials: constants that fit each other, and pressures that they bear.

use serde_json::json;

use super::super::errors::Fault;
use super::super::model::{Body, BurnFront, Eos, Material, Scene, Transfer};
use super::super::schema::{GREATEST, LEAST};
use super::super::validate::join;
use super::{check_length, check_printable};
use crate::material::constitutive::{equation, products};
use crate::material::{HistoryEos, Lame};

/// Share by which a burning front may differ from the detonation that sustains itself before the
/// scene is warned of.
const NEAR: f64 = 0.05;

/// Greatest order of FMPM with which a burning front is stable: measured over 1600 cells
/// of travel.
const STABLE_ORDER: u32 = 2;

pub(super) fn check(scene: &Scene, warnings: &mut Vec<String>) -> Result<(), Fault> {
    for (name, material) in &scene.materials {
        check_printable("materials", name)?;
        let path = join("materials", name);
        check_eos(&material.eos, material.density, &format!("{path}.eos"), scene)?;
        if let Eos::MieGruneisen { c0, .. } = material.eos
            // pressures are multiplied with each other
            && !(material.density * c0 * c0).powi(2).is_normal()
        {
            let reason = format!(
                "density * c0^2 with eos.c0 = {c0} is no finite stiffness; allowed: SI units, \
                 kg/m3 and m/s"
            );
            return Err(Fault::new(format!("{path}.density"), material.density, reason));
        }
        let made = equation(material)
            .map_err(|why| table_fault(&material.eos, &format!("{path}.eos"), &why))?;
        if let Some(eos) = made {
            check_stiffness(&*eos, material, &path)?;
        }
        if !(LEAST..=GREATEST).contains(&material.density) {
            let reason = format!("out of range; allowed: {LEAST:e} to {GREATEST:e} kg/m3");
            return Err(Fault::new(format!("{path}.density"), material.density, reason));
        }
        warn_of_front(material, &path, warnings);
        warn_of_filter(scene, material, &path, warnings);
    }
    Ok(())
}

/// Where the table stands that is wrong.
fn table_fault(eos: &Eos, path: &str, why: &str) -> Fault {
    let path = match eos {
        Eos::PAlpha { .. } => format!("{path}.solid.table"),
        _ => format!("{path}.table"),
    };
    Fault::missing(path, format!("{why}; allowed: a table that is sound"))
}

/// A sound speed at the start that is a number.
fn check_stiffness(eos: &dyn HistoryEos, material: &Material, path: &str) -> Result<(), Fault> {
    let history = eos.first_history().unwrap_or(0.0);
    let (point, _) = eos.at(1.0, eos.energy_at(0.0), history);
    // a gas without pressure has no stiffness, and is refused where it matters
    let gas = matches!(material.eos, Eos::IdealGas { .. });
    if point.sound_speed_squared.is_normal() && point.sound_speed_squared > 0.0 || gas {
        return Ok(());
    }
    let reason = format!(
        "a sound speed at rest of sqrt({:e}) m/s; allowed: constants in SI units that give one",
        point.sound_speed_squared
    );
    Err(Fault::new(format!("{path}.density"), material.density, reason))
}

/// Constants that fit each other.
fn check_eos(eos: &Eos, density: f64, path: &str, scene: &Scene) -> Result<(), Fault> {
    let key = |key: &str| format!("{path}.{key}");
    match eos {
        &Eos::LinearElastic { youngs_modulus, poissons_ratio }
        | &Eos::NeoHookean { youngs_modulus, poissons_ratio } => {
            let stiffness = Lame::new(youngs_modulus, poissons_ratio).longitudinal();
            if !(stiffness / density).is_normal() {
                let density = json!(density);
                let reason = format!(
                    "no finite stiffness over density = {density}; allowed: SI units, Pa and kg/m3"
                );
                return Err(Fault::new(key("youngs_modulus"), youngs_modulus, reason));
            }
        }
        &Eos::StiffenedGas { stiffness, tension_cutoff: Some(cutoff), .. }
            if cutoff >= stiffness =>
        {
            let reason =
                format!("allowed: below eos.stiffness = {}, where it breaks", json!(stiffness));
            return Err(Fault::new(key("tension_cutoff"), cutoff, reason));
        }
        &Eos::Tait { bulk_modulus, exponent, tension_cutoff: Some(cutoff) }
            if cutoff >= bulk_modulus / exponent =>
        {
            let most = bulk_modulus / exponent;
            let reason =
                format!("allowed: below bulk_modulus/exponent = {}, where it breaks", json!(most));
            return Err(Fault::new(key("tension_cutoff"), cutoff, reason));
        }
        &Eos::Tillotson { e_iv, e_cv, .. } if e_cv <= e_iv => {
            let reason = format!("allowed: above e_iv = {}", json!(e_iv));
            return Err(Fault::new(key("e_cv"), e_cv, reason));
        }
        Eos::Jwl { burn, .. } => {
            if let Some(front) = burn.front() {
                check_front(front, &key("burn"), scene.domain.lower.len())?;
            }
        }
        &Eos::PAlpha { ref solid, solid_density, elastic_pressure, compaction_pressure } => {
            if solid_density <= density {
                let density = json!(density);
                let reason = format!(
                    "allowed: above the material's density = {density}, which is that with pores"
                );
                return Err(Fault::new(key("solid_density"), solid_density, reason));
            }
            if compaction_pressure <= elastic_pressure {
                let reason =
                    format!("allowed: above elastic_pressure = {}", json!(elastic_pressure));
                return Err(Fault::new(key("compaction_pressure"), compaction_pressure, reason));
            }
            let solid_type = json!(solid)["type"].clone();
            if solid.is_solid() || matches!(**solid, Eos::Jwl { .. } | Eos::PAlpha { .. }) {
                let reason = "no solid that pores are in; allowed: \"mie_gruneisen\", \
                              \"tillotson\", \"tabular\" or another equation of state of one state";
                return Err(Fault::new(key("solid.type"), solid_type, reason));
            }
            if matches!(**solid, Eos::IdealGas { .. }) {
                let reason = "a gas has no pores; allowed: \"mie_gruneisen\", \"tillotson\", \
                              \"tabular\" or another equation of state that bears tension";
                return Err(Fault::new(key("solid.type"), solid_type, reason));
            }
            check_eos(solid, solid_density, &key("solid"), scene)?;
        }
        _ => {}
    }
    Ok(())
}

/// Where a burning front starts.
fn check_front(front: &BurnFront, path: &str, dimension: usize) -> Result<(), Fault> {
    match (&front.points, &front.plane) {
        (Some(points), None) => points.iter().enumerate().try_for_each(|(i, point)| {
            check_length(&format!("{path}.points[{i}]"), point, dimension)
        }),
        (None, Some(plane)) => {
            check_length(&format!("{path}.plane.point"), &plane.point, dimension)?;
            check_length(&format!("{path}.plane.normal"), &plane.normal, dimension)?;
            if plane.normal.iter().all(|n| *n == 0.0) {
                let reason = "has no direction; allowed: a vector that is not zero";
                return Err(Fault::new(format!("{path}.plane.normal"), &plane.normal, reason));
            }
            Ok(())
        }
        (Some(_), Some(_)) => {
            let reason = format!("beside {path}.points; allowed: one of them");
            Err(Fault::new(format!("{path}.plane"), true, reason))
        }
        (None, None) => {
            let reason = "missing key; allowed: where it starts, \"points\" or \"plane\"";
            Err(Fault::missing(format!("{path}.points"), reason))
        }
    }
}

/// A front that does not go at the speed which its products sustain.
fn warn_of_front(material: &Material, path: &str, warnings: &mut Vec<String>) {
    let Some(front) = material.eos.burn().and_then(|b| b.front()) else { return };
    let Some(products) = products(&material.eos, material.density) else { return };
    let sustained = products.detonation().speed;
    if (front.detonation_velocity / sustained - 1.0).abs() > NEAR {
        warnings.push(format!(
            "{path}.eos.burn.detonation_velocity = {}: these products sustain a detonation at \
             {sustained:.0} m/s (Chapman-Jouguet)",
            front.detonation_velocity
        ));
    }
}

/// A front that grows with the cells that it has travelled: FMPM of high order carries velocity
/// into the unburnt explosive, which has no stiffness to resist it, and what that compresses burns
/// at a higher pressure.
fn warn_of_filter(scene: &Scene, material: &Material, path: &str, warnings: &mut Vec<String>) {
    let front = material.eos.burn().and_then(|burn| burn.front());
    let Transfer::Fmpm(order) = scene.method.transfer else { return };
    if front.is_some() && order > STABLE_ORDER {
        warnings.push(format!(
            "{path}.eos.burn: with method.transfer of order {order} the pressure behind a burning \
             front grows with the number of cells that it has passed (1.15 times after 800 cells, \
             and the run ends after some 1200); with {{\"fmpm\": {STABLE_ORDER}}} or \"flip\" it \
             stays"
        ));
    }
}

/// A pressure that the material bears at its density.
pub(super) fn check_pressure(scene: &Scene, body: &Body, path: &str) -> Result<(), Fault> {
    let material = &scene.materials[&body.material];
    let pressure = body.pressure;
    let must_be_none = |why: &str| match pressure {
        0.0 => Ok(()),
        _ => Err(Fault::new(path, pressure, format!("{why}; allowed: 0"))),
    };
    let (least, why) = match material.eos {
        Eos::LinearElastic { .. } | Eos::NeoHookean { .. } => {
            return must_be_none("an elastic body starts without stress");
        }
        Eos::Tait { .. } => {
            return must_be_none("of Tait's equation the pressure at the density is 0");
        }
        Eos::Jwl { .. } => return must_be_none("an explosive starts with its own energy"),
        Eos::PAlpha { elastic_pressure, .. } if pressure > elastic_pressure => {
            let reason = format!(
                "a porous body starts uncrushed; allowed: at most eos.elastic_pressure = {}",
                json!(elastic_pressure)
            );
            return Err(Fault::new(path, pressure, reason));
        }
        Eos::MieGruneisen { c0, gamma0, tension_cutoff: None, .. } => (
            -material.density * c0 * c0 / (2.0 * gamma0),
            "the tension -density c0^2/(2 gamma0) that Mie-Grueneisen can bear",
        ),
        Eos::IdealGas { .. } => (0.0, "since an ideal gas bears no tension"),
        Eos::MieGruneisen { tension_cutoff: Some(cutoff), .. }
        | Eos::StiffenedGas { tension_cutoff: Some(cutoff), .. }
        | Eos::Tillotson { tension_cutoff: Some(cutoff), .. }
        | Eos::Tabular { tension_cutoff: Some(cutoff), .. } => {
            (-cutoff, "minus eos.tension_cutoff")
        }
        _ => (f64::NEG_INFINITY, ""),
    };
    if pressure < least {
        let reason = format!("allowed: at least {}, {why}", json!(least));
        return Err(Fault::new(path, pressure, reason));
    }
    let Ok(Some(eos)) = equation(material) else { return Ok(()) };
    let (history, e) = (eos.first_history().unwrap_or(0.0), eos.energy_at(pressure));
    let (point, _) = eos.at(1.0, e, history);
    let rounding = 1e-12 * material.density * point.sound_speed_squared.abs();
    let reached = (point.pressure - pressure).abs() <= 1e-9 * pressure.abs() + rounding;
    if e.is_finite() && reached && eos.fault(1.0, e, history, pressure).is_none() {
        return Ok(());
    }
    let reason = "no energy brings the material to it at its density; allowed: a pressure that the \
                  equation of state reaches";
    Err(Fault::new(path, pressure, reason))
}
