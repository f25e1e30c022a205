//! Contents of a scene on which the choice of a method depends, and what was measured with them.

use serde_json::{Map, Value};

use crate::scene::{Material, Transfer, VelocityField, default_courant};

/// Largest Courant number of viscosity in expansion on a line without a share of the lumped mass:
/// plane impacts oscillate with it at 0.8, and do not at 0.6.
pub(super) const LARGE_COURANT: f64 = 0.6;

/// Largest Courant number of viscosity in expansion with a share of the lumped mass, but for
/// `robust` with two or more particles per cell.
pub(super) const LARGE_MATCHED_COURANT: f64 = 0.8;

/// Largest Courant number of the scheme of `robust` with two or more particles per cell.
pub(super) const LARGE_ROBUST_COURANT: f64 = 1.0;

/// Contents of a scene on which the choice of a method depends.
#[derive(Default)]
pub(super) struct SceneContents {
    pub(super) plane: bool,
    /// In two dimensions, x is a radius.
    pub(super) axisymmetric: bool,
    /// A body force acts.
    pub(super) body_force: bool,
    pub(super) contact: bool,
    /// Bodies on a line touch each other without a contact law, and no side lets particles out.
    pub(super) joined: bool,
    /// The same of two plates that press on each other until the end of the run.
    pub(super) plates_in_contact: bool,
    /// Some body has one particle per cell, or particles from a file.
    pub(super) sparse_particles: bool,
    /// A material has a tension cutoff, or the scene gives a transfer, a stepping, a shape function, a
    /// flux limiter or a viscosity of its own, or no share of the lumped mass: viscosity in expansion
    /// was not measured with these.
    pub(super) untested_keys: bool,
    /// Keys of the scene exclude the flux limiter.
    pub(super) excludes_flux_limiter: bool,
    /// Courant number, the default if the scene gives none.
    pub(super) courant: f64,
    /// Some body is a fluid, or a solid whose pressure follows an equation of state of fluids.
    pub(super) fluid: bool,
    pub(super) strength: bool,
    pub(super) failure: bool,
    /// Some body is a gas or an explosive.
    pub(super) gas: bool,
    /// All bodies are gases, but not `sheared_gas`, one of them moves at the start, and the scene
    /// does not say whether their heat is mixed.
    pub(super) moving_gas: bool,
    /// All bodies are gases of one pressure in a plane without axial symmetry, contact or a body
    /// force, and the velocity field of one shears it.
    pub(super) sheared_gas: bool,
    /// The pressures of two bodies of gas differ at the start, or a gas is in a scene with an
    /// explosive.
    pub(super) gas_pressures_differ: bool,
    /// Some body is an explosive with a burn front.
    pub(super) burn: bool,
    pub(super) porous: bool,
}

impl SceneContents {
    /// Whether viscosity in expansion was measured with the contents of the scene and a Courant
    /// number up to `largest`.
    pub(super) fn allows_expansion(&self, largest: f64) -> bool {
        let untested = self.porous || self.burn || self.body_force || self.untested_keys;
        !(untested || (self.plane && self.gas)) && self.courant <= largest
    }

    /// Whether the scheme of `robust` for plane impacts was measured with the contents of the scene.
    pub(super) fn allows_robust(&self) -> bool {
        self.allows_expansion(match self.sparse_particles {
            true => LARGE_MATCHED_COURANT,
            false => LARGE_ROBUST_COURANT,
        })
    }

    /// Whether a share of the lumped mass was measured with the contents of the scene.
    pub(super) fn allows_lumping(&self) -> bool {
        self.fluid && self.allows_expansion(LARGE_MATCHED_COURANT)
    }

    /// Whether the presets limit fluxes in this scene. Impacts on a line have larger errors with it at
    /// Courant numbers below 0.3 and above 0.5, and oscillate with one particle per cell.
    pub(super) fn allows_flux_limiter(&self) -> bool {
        let without = self.contact || self.failure || self.gas || self.porous || self.plane;
        let inaccurate = self.sparse_particles || !(0.3..=0.5).contains(&self.courant);
        self.strength && !(without || inaccurate || self.excludes_flux_limiter)
    }

    /// Order of FMPM up to `most`; with one particle per cell at most that with which plane impacts
    /// do not oscillate at the Courant number of the scene.
    pub(super) fn order(&self, most: u32) -> u32 {
        let orders = [(0.4, 8), (0.5, 6), (0.6, 4)];
        let largest = orders.iter().find(|(courant, _)| self.courant <= *courant);
        if self.sparse_particles { most.min(largest.map_or(2, |(_, order)| *order)) } else { most }
    }

    /// Reads the contents of a scene whose library names are resolved and whose method has the keys
    /// `explicit` beside the preset. An invalid part counts as absent; the check of the scene
    /// reports it.
    pub(super) fn of(scene: &Map<String, Value>, explicit: &Map<String, Value>) -> Self {
        let domain = scene.get("domain").unwrap_or(&Value::Null);
        let dimension = domain["lower"].as_array().map_or(1, Vec::len);
        let bodies = scene.get("bodies").and_then(Value::as_array).into_iter().flatten();
        let used = bodies.filter_map(|body| {
            let json = scene.get("materials")?.get(body.get("material")?.as_str()?)?;
            let material = serde_json::from_value::<Material>(json.clone()).ok()?;
            Some((material, !json["eos"]["burn"].is_null(), body))
        });
        let used: Vec<(Material, bool, &Value)> = used.collect();
        let any =
            |such: fn(&Material, bool) -> bool| used.iter().any(|(m, burns, _)| such(m, *burns));
        let gases = || used.iter().filter(|(m, ..)| m.eos.is_gas()).map(|(.., body)| *body);
        // Gresho's vortex has a pressure of its own
        let pressures: Vec<f64> = gases()
            .filter(|body| body["velocity_field"]["gresho"].is_null())
            .map(|body| body["pressure"].as_f64().unwrap_or(0.0))
            .collect();
        let gas_pressures_differ = pressures.iter().any(|p| *p != pressures[0])
            || (!pressures.is_empty() && any(|_, burns| burns));
        let given = |key: &str| scene.get(key).is_some_and(|value| !value.is_null());
        let axisymmetric = domain["geometry"] == "axisymmetric";
        let courant = scene.get("time").and_then(|time| time["courant"].as_f64());
        let courant = courant.unwrap_or_else(default_courant);
        let all_gases = gases().count() == used.len();
        let sheared_gas = all_gases
            && gases().any(is_sheared)
            && dimension > 1
            && !(axisymmetric || gas_pressures_differ || given("contact") || given("body_force"));
        SceneContents {
            plane: dimension > 1,
            axisymmetric,
            body_force: given("body_force"),
            contact: given("contact"),
            joined: dimension == 1 && are_joined(scene),
            plates_in_contact: dimension == 1 && are_joined(scene) && stay_in_contact(scene),
            sparse_particles: used.iter().any(|(.., body)| has_sparse_particles(body)),
            untested_keys: ["transfer", "stepping", "shape"]
                .iter()
                .any(|key| explicit.contains_key(*key))
                || scene.contains_key("artificial_viscosity")
                || explicit.get("flux_limiter").is_some_and(|limiter| !limiter.is_null())
                || explicit.get("mass_lumping").is_some_and(Value::is_null)
                || scene.get("materials").is_some_and(has_tension_cutoff),
            excludes_flux_limiter: excludes_flux_limiter(explicit),
            courant,
            fluid: any(|m, _| !m.eos.is_solid()),
            strength: any(|m, _| m.strength.is_some()),
            failure: any(|m, _| m.failure.is_some()),
            gas: any(|m, burns| m.eos.is_gas() || burns),
            moving_gas: !scene.contains_key("heat_mixing")
                && all_gases
                && !sheared_gas
                && gases().any(moves),
            sheared_gas,
            gas_pressures_differ,
            burn: any(|m, burns| burns && m.eos.has_history()),
            porous: any(|m, burns| m.eos.has_history() && !burns),
        }
    }
}

/// Whether a body moves at the start.
fn moves(body: &Value) -> bool {
    let velocity = body["velocity"].as_array().into_iter().flatten();
    !body["velocity_field"].is_null() || velocity.filter_map(Value::as_f64).any(|v| v != 0.0)
}

/// Whether the initial velocity field of a body shears it.
fn is_sheared(body: &Value) -> bool {
    let field = serde_json::from_value::<VelocityField>(body["velocity_field"].clone());
    field.is_ok_and(|field| field.shears())
}

/// Whether one of the `materials` has a tension cutoff.
fn has_tension_cutoff(materials: &Value) -> bool {
    let mut materials = materials.as_object().into_iter().flat_map(Map::values);
    materials.any(|material| !material["eos"]["tension_cutoff"].is_null())
}

/// Whether a body has one particle per cell along some direction, or particles from a file.
fn has_sparse_particles(body: &Value) -> bool {
    let per_cell = body["particles_per_cell"].as_array().into_iter().flatten();
    !body["positions"].is_null() || per_cell.filter_map(Value::as_f64).any(|count| count < 2.0)
}

/// Whether the boxes of all bodies on a line form one piece, and the sides let no particle out.
fn are_joined(scene: &Map<String, Value>) -> bool {
    let end = |body: &Value, end: &str| body["box"][end][0].as_f64();
    let bodies = scene.get("bodies").and_then(Value::as_array).into_iter().flatten();
    let spans: Option<Vec<[f64; 2]>> =
        bodies.map(|body| Some([end(body, "lower")?, end(body, "upper")?])).collect();
    let Some(mut spans) = spans.filter(|spans| spans.len() > 1) else { return false };
    spans.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let touch = spans.windows(2).all(|pair| pair[0][1] == pair[1][0]);
    let open = scene.get("boundary").is_some_and(|sides| sides.to_string().contains("outflow"));
    let contact = scene.get("contact").is_some_and(|contact| !contact.is_null());
    touch && !open && !contact
}

/// Whether two plates of Mie-Grueneisen materials, which touch, press on each other until the end of
/// the run. The release from the free surface of the plate with the higher impedance leaves some
/// pressure at the interface; that of the other plate parts them. No wave is faster than c0 + 2 s v
/// in the initial coordinates, with the impact speed v.
fn stay_in_contact(scene: &Map<String, Value>) -> bool {
    let plate = |body: &Value| {
        let material = scene.get("materials")?.get(body["material"].as_str()?)?;
        let eos = &material["eos"];
        let [lower, upper] = ["lower", "upper"].map(|end| body["box"][end][0].as_f64());
        let velocity = body["velocity"].get(0).map_or(Some(0.0), Value::as_f64);
        (eos["type"] == "mie_gruneisen").then_some(())?;
        let [density, c0, s] =
            [&material["density"], &eos["c0"], &eos["s"]].map(|value| value.as_f64());
        Some(([lower?, upper?], velocity?, density? * c0?, c0?, s?))
    };
    let bodies = scene.get("bodies").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let plates: Option<Vec<_>> = bodies.iter().map(plate).collect();
    let Some(mut plates) = plates.filter(|plates| plates.len() == 2) else { return false };
    plates.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
    let speed = plates[0].1 - plates[1].1;
    let end = scene.get("time").and_then(|time| time["end"].as_f64()).unwrap_or(f64::INFINITY);
    let parts = |one: usize| {
        let ([lower, upper], _, impedance, c0, s) = plates[one];
        let back = 2.0 * (upper - lower) / (c0 + 2.0 * s * speed);
        impedance < plates[1 - one].2 && back < end
    };
    let free = scene.get("boundary").is_none_or(Value::is_null);
    free && speed > 0.0 && !parts(0) && !parts(1)
}

/// Whether the keys `explicit` of a method exclude the flux limiter.
fn excludes_flux_limiter(explicit: &Map<String, Value>) -> bool {
    let transfer = explicit.get("transfer").cloned();
    let transfer = transfer.and_then(|t| serde_json::from_value::<Transfer>(t).ok());
    transfer.is_some_and(|transfer| !transfer.plan().full_mass_matrix)
        || explicit.get("stepping").is_some_and(|stepping| stepping == "leapfrog")
        || explicit.get("flux_limiter").is_some_and(Value::is_null)
        || explicit.get("mass_lumping").is_some_and(|share| !share.is_null())
}
