//! Warnings about tension: more than a material is known to withstand, limits that are never reached,
//! and plates that would part.
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
//! rear. At the interface the rarefaction from the rear of a plate with Z < Z' leaves the tension
//!
//! ```text
//! P (Z' - Z)/(Z' + Z)
//! ```
//!
//! Shocks are stronger than acoustic waves, so that the estimates are low.

use crate::input::paths::join;
use crate::material::failure::PressureLimit;
use crate::scene::{CheckedScene, Material, Reference};

/// Tension that no solid or liquid withstands in a spall, over its bulk modulus [-]. Metals withstand
/// 0.5 to 3 % (Antoun et al. 2003, Spall fracture).
const MAX_TENSION_RATIO: f64 = 0.04;

/// Tension at an interface over the pressure of the impact above which a warning is given [-]: plates
/// of nearly the same impedance hardly pull on each other.
const LEAST_PULL: f64 = 0.01;

/// Warnings of a scene; `speeds` are the sound speeds of the bodies [m/s].
pub(super) fn warnings(checked: &CheckedScene, speeds: &[f64]) -> Vec<String> {
    let materials = checked.scene.materials.iter();
    let of_plates = [unlimited, parting].into_iter().filter_map(|warning| warning(checked, speeds));
    materials.filter_map(never_reached).chain(of_plates).collect()
}

/// A limit of the failure law beyond the cutoff of the equation of state.
fn never_reached((name, material): (&String, &Material)) -> Option<String> {
    let PressureLimit { key, tension } =
        material.failure?.pressure_limit(&material.strength_beside())?;
    let cutoff = material.tension_cutoff().filter(|cutoff| tension > *cutoff)?;
    let path = join("materials", name);
    Some(format!(
        "{path}.failure.{key} = {tension:e}: never acts, since {path}.eos.tension_cutoff = {cutoff:e} \
         lets no more tension arise"
    ))
}

/// Two plates that strike each other on a line.
struct Plates {
    /// Indices of the bodies: the lower and the upper one.
    bodies: [usize; 2],
    /// Impedances Z [kg/(m2 s)].
    impedances: [f64; 2],
    /// Times that sound takes to cross the plates [s].
    crossings: [f64; 2],
    /// Time of the impact [s].
    impact: f64,
    /// Pressure of the impact P [Pa].
    pressure: f64,
}

impl Plates {
    fn of(checked: &CheckedScene, speeds: &[f64]) -> Option<Plates> {
        if checked.dimension != 1 || checked.bodies.len() != 2 {
            return None;
        }
        let is_ordered = checked.bodies[0].lower[0] < checked.bodies[1].lower[0];
        let bodies = if is_ordered { [0, 1] } else { [1, 0] };
        let [a, b] = bodies.map(|k| &checked.bodies[k]);
        let speed = a.velocity[0] - b.velocity[0];
        let gap = (b.lower[0] - a.upper[0]).max(0.0);
        let impedances = bodies.map(|k| checked.material_of(k).density * speeds[k]);
        let [z, other] = impedances;
        let crossings =
            bodies.map(|k| (checked.bodies[k].upper[0] - checked.bodies[k].lower[0]) / speeds[k]);
        let pressure = speed * z * other / (z + other);
        let impact = gap / speed;
        (speed > 0.0).then_some(Plates { bodies, impedances, crossings, impact, pressure })
    }

    /// Whether the rear face of plate `k` is free.
    fn is_free(&self, checked: &CheckedScene, k: usize) -> bool {
        checked.face_is_free(self.bodies[k], k == 1)
    }

    /// Part of the pressure of the impact that remains behind the rarefaction from the rear of plate
    /// `k` at the interface [Pa]; negative for a tension.
    fn held_up(&self, k: usize) -> f64 {
        let (z, other) = (self.impedances[k], self.impedances[1 - k]);
        self.pressure * (z - other) / (z + other)
    }
}

/// A stress in a text.
fn stress(value: f64) -> String {
    match value < 1e8 {
        true => format!("{:.1} MPa", value * 1e-6),
        false => format!("{:.1} GPa", value * 1e-9),
    }
}

/// An impact of two plates whose tension nothing limits.
fn unlimited(checked: &CheckedScene, speeds: &[f64]) -> Option<String> {
    let plates = Plates::of(checked, speeds)?;
    let all_free = (0..2).all(|k| plates.is_free(checked, k));
    let [first, second] = plates.crossings;
    // not "<=": a gas at rest may have no sound speed
    let meets = plates.impact + first + second < checked.scene.time.end;
    if !all_free || !meets {
        return None;
    }
    let k = if first <= second { 1 } else { 0 };
    let own = plates.bodies[k];
    let material = checked.material_of(own);
    let eos = &material.eos;
    let unlimited = material.failure.is_none() && material.tension_cutoff().is_none();
    if eos.is_gas() || eos.is_solid() || eos.has_history() || !unlimited {
        return None;
    }
    let tension = plates.pressure - plates.held_up(1 - k).max(0.0);
    (tension > MAX_TENSION_RATIO * plates.impedances[k] * speeds[own]).then(|| {
        format!(
            "{}: {} would reach a tension of about {} where the rarefactions from the rear faces \
             meet, and no material withstands more than a few percent of its bulk modulus; give the \
             material a failure law or eos.tension_cutoff",
            join("bodies", &checked.scene.bodies[own].name),
            checked.scene.bodies[own].material,
            stress(tension)
        )
    })
}

/// An impact of two plates without contact that would part.
fn parting(checked: &CheckedScene, speeds: &[f64]) -> Option<String> {
    // the check of an impact's reference says so by the exact states
    let is_compared = matches!(checked.scene.reference, Some(Reference::FlyerImpact(_)));
    if checked.scene.contact.is_some() || is_compared {
        return None;
    }
    let plates = Plates::of(checked, speeds)?;
    let is_gas = |k: usize| checked.material_of(plates.bodies[k]).eos.is_gas();
    (0..2).filter(|&k| plates.is_free(checked, k) && !is_gas(k)).find_map(|k| {
        let (tension, time) = (-plates.held_up(k), plates.impact + 2.0 * plates.crossings[k]);
        let parts = tension > LEAST_PULL * plates.pressure && time < checked.scene.time.end;
        let [own, other] = [k, 1 - k].map(|k| &checked.scene.bodies[plates.bodies[k]].name);
        parts.then(|| {
            format!(
                "{}: the rarefaction from its rear reaches {other} after about {:.3} us, and {own} \
                 would part from {other}; without contact they stay joined, under a tension \
                 of about {}",
                join("bodies", own),
                1e6 * time,
                stress(tension)
            )
        })
    })
}
