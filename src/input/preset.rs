//! Methods by name: a scene without `method`, or with one of the names of [`Preset`], gets a
//! complete method and artificial viscosity that suit its contents, and heat mixing if gases move.
//!
//! Each preset is a base method and a list of rules. A rule changes keys if the scene contains what
//! it names, and gives its reason. Explicit keys of the scene come last; an option of the preset
//! that they exclude is left out.

use json_patch::merge;
use serde_json::{Map, Value, json};

use contents::{LARGE_COURANT, LARGE_MATCHED_COURANT, SceneContents};
use rules::{ADDED_LUMPING, acting, lumping, moderate};

use super::errors::{SceneFault, suggest};
use crate::scene::{MethodChoice, Preset, Transfer};

mod contents;
mod rules;

/// Shape function of the presets, on domains that deform.
const DEFORMING: &str = "cpdi_bspline_quadratic";

impl Preset {
    /// The preset that `value` names.
    fn of(value: &Value, path: &str) -> Result<Preset, SceneFault> {
        let name = value.as_str().unwrap_or("");
        Preset::ALL.into_iter().find(|preset| preset.name() == name).ok_or_else(|| {
            let known = Preset::ALL.iter().map(|preset| preset.name());
            let or = if path == "method" { ", or an object with method.shape" } else { "" };
            SceneFault::new(path, value, format!("unknown name{}{or}", suggest(name, known)))
        })
    }

    /// Keys of the scene before the rules, and their reason.
    fn base(self, contents: &SceneContents) -> (Value, &'static str) {
        let method = json!({
            "shape": DEFORMING,
            "transfer": {"fmpm": 8},
            "stepping": "midpoint",
            "energy": "compatible",
            "filter_heat": true,
            "pressure_relaxation": {"rate": 0.1, "interval": 1},
            "edge_mask": 0.4
        });
        let viscosity = json!({
            "linear": 0.05,
            "quadratic": 0.5,
            "growth": {"rate": 6.0, "max": 2.0},
            "limiter": "christensen",
            "limited": "linear"
        });
        let mut base = json!({"method": method, "artificial_viscosity": viscosity});
        if contents.contact && !contents.plane && self != Preset::Default {
            // oscillations of `sharpest` separate bodies, and the viscosity in expansion of `robust`
            // makes them part later
            return (
                Preset::Default.base(contents).0,
                "the method of default, which suits contact best",
            );
        }
        let reason = match self {
            Preset::Default => {
                let is_impact = acting(contents).next().is_none();
                let changes = if is_impact && contents.allows_expansion(LARGE_MATCHED_COURANT) {
                    json!({"method": {"transfer": {"fmpm": contents.order(14)},
                            "mass_lumping": lumping(contents.courant, 0.0)},
                        "artificial_viscosity":
                            {"linear": 0.055, "quadratic": 0.85, "expansion": 0.02}})
                } else {
                    json!({"method": {"transfer": {"fmpm": contents.order(8)}},
                        "artificial_viscosity": {"linear": 0.15}})
                };
                merge(&mut base, &changes);
                if is_impact && contents.plates_in_contact {
                    merge(&mut base, &json!({"method": {"frame": "total_lagrangian"}}));
                    "small error of plane impacts whose peak pressure is within 0.5 %; \
                     total-Lagrangian, for plates that stay in contact"
                } else {
                    "small error of plane impacts whose peak pressure is within 0.5 %"
                }
            }
            Preset::Robust => {
                let transfer = json!({"fmpm": contents.order(6)});
                let method = json!({"transfer": transfer, "edge_mask": 0.3});
                merge(&mut base, &json!({"method": method, "artificial_viscosity": moderate()}));
                if acting(contents).next().is_none() && contents.allows_robust() {
                    let share = lumping(contents.courant, ADDED_LUMPING);
                    let method =
                        json!({"transfer": {"fmpm": contents.order(14)}, "mass_lumping": share});
                    let viscosity = json!({"linear": 0.12, "expansion": 0.05});
                    let changes = json!({"method": method, "artificial_viscosity": viscosity});
                    merge(&mut base, &changes);
                    "little oscillation of plane impacts"
                } else {
                    "a moderate transfer order and viscosity"
                }
            }
            Preset::Sharpest => {
                let changes = json!({"method": {"transfer": {"fmpm": 14}},
                    "artificial_viscosity": {"linear": 0.035, "quadratic": 0.0}});
                merge(&mut base, &changes);
                let is_impact = acting(contents).next().is_none();
                if is_impact
                    && contents.allows_expansion(LARGE_COURANT)
                    && !contents.sparse_particles
                {
                    let viscosity = json!({"linear": 0.03, "expansion": 0.035});
                    merge(&mut base, &json!({"artificial_viscosity": viscosity}));
                }
                if is_impact && contents.joined {
                    let relaxation = json!({"rate": 0.05, "interval": 1});
                    let method = json!({"frame": "total_lagrangian", "edge_mask": 0.3,
                        "pressure_relaxation": relaxation});
                    merge(&mut base, &json!({"method": method}));
                    "least mean E1 of plane impacts; total-Lagrangian, for bodies that stay in contact"
                } else {
                    "least mean E1 of plane impacts"
                }
            }
        };
        (base, reason)
    }
}

/// Replaces the preset of a scene by its method and viscosity. Returns the choice; `None` if the
/// scene gives its method in full.
pub(super) fn expand(scene: &mut Value) -> Result<Option<MethodChoice>, SceneFault> {
    let Some(keys) = scene.as_object_mut() else { return Ok(None) };
    let (preset, explicit) = match keys.get("method") {
        None | Some(Value::Null) => (Preset::Default, Map::new()),
        Some(Value::Object(method)) => match method.get("preset") {
            None => return Ok(None),
            Some(name) => {
                let mut explicit = method.clone();
                explicit.remove("preset");
                // what the preset would give is not missing
                let preset = Preset::of(name, "method.preset");
                (preset.map_err(|fault| fault.invalidates("method"))?, explicit)
            }
        },
        Some(name @ Value::String(_)) => (Preset::of(name, "method")?, Map::new()),
        // reported by the check against the schema
        Some(_) => return Ok(None),
    };
    let contents = SceneContents::of(keys, &explicit);
    let (mut chosen, reason) = choose(preset, &contents);
    let mut method = chosen["method"].take();
    let mut reasons: Vec<String> = acting(&contents).map(|rule| rule.reason.to_string()).collect();
    if reasons.is_empty() {
        reasons.push(reason.to_string());
    }
    if let Some(excluded) = method.as_object_mut().map(|m| override_keys(m, explicit)) {
        reasons.extend(excluded);
    }
    if keys.contains_key("artificial_viscosity") {
        reasons.push("the viscosity is that of the scene".into());
    } else {
        keys.insert("artificial_viscosity".into(), chosen["artificial_viscosity"].take());
    }
    if let Some(mixing) = chosen.get_mut("heat_mixing") {
        keys.insert("heat_mixing".into(), mixing.take());
    }
    reasons.insert(0, in_short(&method, &keys["artificial_viscosity"]));
    keys.insert("method".into(), method);
    Ok(Some(MethodChoice { preset, reasons }))
}

/// Transfer and viscosity in short, such as `FMPM(14) (mass lumping 0.03), viscosity 0.055/0.85 (0.02
/// in expansion)`.
fn in_short(method: &Value, viscosity: &Value) -> String {
    let transfer = &method["transfer"];
    let only = transfer.as_object().and_then(|object| object.iter().next());
    let transfer = match only {
        Some((name, number)) => format!("{}({number})", name.to_uppercase()),
        None => transfer.as_str().unwrap_or("").to_uppercase(),
    };
    let lumping = &method["mass_lumping"];
    let transfer = match lumping.is_null() {
        true => transfer,
        false => format!("{transfer} (mass lumping {lumping})"),
    };
    if viscosity.is_null() {
        return format!("{transfer}, no viscosity");
    }
    let [linear, quadratic, expansion] =
        ["linear", "quadratic", "expansion"].map(|key| &viscosity[key]);
    let short = format!("{transfer}, viscosity {linear}/{quadratic}");
    match expansion.is_null() {
        true => short,
        false => format!("{short} ({expansion} in expansion)"),
    }
}

/// Keys that a preset gives a scene with these contents, and the reason if no rule acts.
fn choose(preset: Preset, contents: &SceneContents) -> (Value, &'static str) {
    let (mut chosen, reason) = preset.base(contents);
    for rule in acting(contents) {
        merge(&mut chosen, &(rule.changes)(contents));
    }
    (chosen, reason)
}

/// Overrides keys of a preset's method. Returns, in words, the options of the preset that these
/// keys exclude and that are therefore left out.
fn override_keys(method: &mut Map<String, Value>, explicit: Map<String, Value>) -> Vec<String> {
    let is = |key: &str, name: &str| explicit.get(key).is_some_and(|value| value == name);
    let plan = explicit.get("transfer");
    let plan = plan.and_then(|t| serde_json::from_value::<Transfer>(t.clone()).ok());
    let plan = plan.map(|transfer| transfer.plan());
    let mut excluded: Vec<&str> = Vec::new();
    if is("stepping", "leapfrog") {
        excluded.extend([
            "energy",
            "filter_heat",
            "heat_spreading",
            "pressure_relaxation",
            "edge_mask",
            "spin",
            "flux_limiter",
        ]);
    }
    if let Some(plan) = plan {
        excluded.extend((!plan.filters).then_some("filter_heat"));
        if !plan.full_mass_matrix {
            excluded.extend(["edge_mask", "spin", "flux_limiter"]);
        }
        excluded.extend(plan.is_affine().then_some("energy"));
    }
    // without compatible energy and heat of the filter there is no numerical heat
    let is_off = |key: &str| {
        let off = [Value::Null, Value::Bool(false), json!("textbook")];
        excluded.contains(&key) || explicit.get(key).is_some_and(|value| off.contains(value))
    };
    if is_off("energy") && is_off("filter_heat") {
        excluded.push("heat_spreading");
    }
    if explicit.get("mass_lumping").is_some_and(|share| !share.is_null()) {
        excluded.push("flux_limiter");
    }
    if is("frame", "total_lagrangian") || is("shape", "linear") {
        excluded.push("spin");
    }
    if is("frame", "total_lagrangian") || explicit.get("shape").is_some_and(|s| !deforms(s)) {
        excluded.push("domain_limit");
    }
    let has_no_mask =
        excluded.contains(&"edge_mask") || explicit.get("edge_mask").is_some_and(Value::is_null);
    if has_no_mask || is("frame", "total_lagrangian") {
        excluded.push("volume_relaxation");
    }
    if !explicit.contains_key("shape") && !method.get("shape").is_some_and(deforms) {
        // domains that do not deform need no limit; a scene that gives one wants them to deform
        method.remove("domain_limit");
        if explicit.get("domain_limit").is_some_and(|limit| !limit.is_null()) {
            method.insert("shape".into(), json!(DEFORMING));
        }
    }
    // options of the updated-Lagrangian frame
    if ["domain_limit", "volume_relaxation"].iter().any(|key| explicit.contains_key(*key)) {
        excluded.push("frame");
    }
    let excluded: Vec<&str> =
        excluded.into_iter().filter(|key| method.remove(*key).is_some()).collect();
    let mut reasons = Vec::new();
    if !explicit.is_empty() {
        let names: Vec<&str> = explicit.keys().map(String::as_str).collect();
        reasons.push(format!("from the scene: {}", names.join(", ")));
    }
    if !excluded.is_empty() {
        reasons
            .push(format!("left out, since the scene's keys exclude it: {}", excluded.join(", ")));
    }
    for (key, value) in explicit {
        match value {
            Value::Null => method.remove(&key),
            value => method.insert(key, value),
        };
    }
    reasons
}

/// Whether the particle domains of a shape function deform.
fn deforms(shape: &Value) -> bool {
    use crate::shape::{DomainExtent, ShapeKind};
    let shape = serde_json::from_value::<ShapeKind>(shape.clone());
    shape.is_ok_and(|shape| shape.extent() == DomainExtent::Current)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Combinations of contents, without those that repeat others or cannot occur.
    fn all(courant: f64) -> impl Iterator<Item = SceneContents> {
        let occurs = |bits: &u32| {
            let has = |k: u32| bits >> k & 1 == 1;
            let lines = has(2) || has(9);
            let gases = [7, 12, 13].into_iter().any(has);
            !(lines && has(0)) && (has(2) || !has(9)) && (has(0) || !has(10)) && (has(6) || !gases)
        };
        (0..1 << 18_u32).filter(occurs).map(move |bits| {
            let has = |k: u32| bits >> k & 1 == 1;
            SceneContents {
                plane: has(0),
                contact: has(1),
                joined: has(2),
                fluid: has(3),
                strength: has(4),
                failure: has(5),
                gas: has(6),
                burn: has(7),
                porous: has(8),
                plates_in_contact: has(9),
                sparse_particles: has(15),
                untested_keys: has(16),
                excludes_flux_limiter: has(17),
                courant,
                axisymmetric: has(10),
                body_force: has(11),
                moving_gas: has(6) && has(12),
                gas_pressures_differ: has(6) && has(13),
                sheared_gas: has(14)
                    && [0, 6].into_iter().all(has)
                    && ![1, 4, 5, 7, 8, 10, 11, 12, 13].into_iter().any(has),
            }
        })
    }

    #[test]
    fn options_of_every_choice_fit_each_other() {
        let courants = [0.2, 0.4, 0.6, 0.81, 1.0];
        for c in courants.into_iter().flat_map(all) {
            let choices = Preset::ALL.map(|preset| choose(preset, &c).0);
            if c.contact && !c.plane {
                assert!(choices.iter().all(|choice| *choice == choices[0]), "{choices:?}");
            }
            for (chosen, preset) in choices.iter().zip(Preset::ALL) {
                options_fit_each_other(chosen, preset, &c);
            }
        }
    }

    /// Panics if options of the method of a scene with the contents `c` exclude each other.
    fn options_fit_each_other(chosen: &Value, preset: Preset, c: &SceneContents) {
        let [method, viscosity] = ["method", "artificial_viscosity"].map(|key| &chosen[key]);
        let has = |value: &Value, key: &str| !value[key].is_null();
        assert!(!has(viscosity, "limited") || has(viscosity, "limiter"), "{viscosity}");
        let total = has(method, "frame");
        assert!(!total || !has(method, "domain_limit"), "{method}");
        let expands = has(viscosity, "expansion");
        assert!(!expands || has(viscosity, "limiter"), "{viscosity}");
        let measured = match preset {
            Preset::Robust => c.allows_robust(),
            _ => c.allows_expansion(LARGE_MATCHED_COURANT),
        };
        assert!(!expands || measured, "{viscosity}");
        assert!(!has(method, "spin") || (c.plane && !c.axisymmetric && !total), "{method}");
        let no_fluxes = c.plane || c.contact || c.failure || c.gas || c.porous;
        assert!(!has(method, "flux_limiter") || !no_fluxes, "{method}");
        let lumps = has(method, "mass_lumping");
        assert!(!lumps || measured, "{method}");
        assert!(!lumps || !has(method, "flux_limiter"), "{method}");
        let order = method["transfer"]["fmpm"].as_u64().unwrap();
        assert!(c.plane || order <= u64::from(c.order(18)) || !c.contact, "{method}");
        assert_eq!(has(method, "pressure_relaxation"), c.fluid);
        if c.porous {
            assert_eq!([&viscosity["linear"], &viscosity["quadratic"]], [0.5, 2.0]);
        }
        assert_eq!(has(chosen, "heat_mixing"), c.moving_gas && !c.burn);
        if c.burn {
            assert_eq!(method["transfer"], json!({"fmpm": 2}));
        }
        let cubic = c.sheared_gas;
        assert_eq!(method["shape"] == "bspline_cubic", cubic, "{method}");
        if c.plane && c.fluid && !c.strength && !c.gas_pressures_differ {
            assert_eq!(method["pressure_relaxation"]["rate"], if cubic { 1.0 } else { 0.2 });
        }
        let growth = viscosity["growth"]["max"].as_f64().unwrap_or(f64::INFINITY);
        assert!(growth > viscosity["quadratic"].as_f64().unwrap(), "{viscosity}");
    }
}
