//! Methods by name: a scene without `method`, or with one of the names of [`Preset`], gets a
//! complete method and artificial viscosity that suit its contents, and heat mixing if gases move.
//!
//! Each preset is a base method and a list of rules. A rule changes keys if the scene contains what
//! it names, and gives its reason. Explicit keys of the scene come last; an option of the preset
//! that they exclude is left out.

use json_patch::merge;
use serde_json::{Map, Value, json};

use super::errors::{SceneFault, suggest};
use crate::scene::{Material, MethodChoice, Preset, Transfer, VelocityField, default_courant};

/// Contents of a scene on which the choice of a method depends.
#[derive(Default)]
struct SceneContents {
    plane: bool,
    /// In two dimensions, x is a radius.
    axisymmetric: bool,
    /// A body force acts.
    body_force: bool,
    contact: bool,
    /// Bodies on a line touch each other without a contact law, and no side lets particles out.
    joined: bool,
    /// The same of two plates that press on each other until the end of the run.
    plates_in_contact: bool,
    /// Some body has one particle per cell, or particles from a file.
    sparse_particles: bool,
    /// A material has a tension cutoff, or the scene gives a transfer, a stepping, a shape function, a
    /// flux limiter or a viscosity of its own, or no share of the lumped mass: viscosity in expansion
    /// was not measured with these.
    untested_keys: bool,
    /// Keys of the scene exclude the flux limiter.
    excludes_flux_limiter: bool,
    /// Courant number, the default if the scene gives none.
    courant: f64,
    /// Some body is a fluid, or a solid whose pressure follows an equation of state of fluids.
    fluid: bool,
    strength: bool,
    failure: bool,
    /// Some body is a gas or an explosive.
    gas: bool,
    /// All bodies are gases, but not `sheared_gas`, one of them moves at the start, and the scene
    /// does not say whether their heat is mixed.
    moving_gas: bool,
    /// All bodies are gases of one pressure in a plane without axial symmetry, contact or a body
    /// force, and the velocity field of one shears it.
    sheared_gas: bool,
    /// The pressures of two bodies of gas differ at the start, or a gas is in a scene with an
    /// explosive.
    gas_pressures_differ: bool,
    /// Some body is an explosive with a burn front.
    burn: bool,
    porous: bool,
}

/// Largest Courant number of viscosity in expansion: without a share of the lumped mass plane
/// impacts on a line oscillate with it at 0.8, and do not at 0.6.
const LARGE_COURANT: f64 = 0.6;

/// The same with a share of the lumped mass.
const LARGE_MATCHED_COURANT: f64 = 0.8;

/// Share of the lumped mass, beyond that which compensates the time step, with which little tension
/// is left ahead of a shock.
const ADDED_LUMPING: f64 = 0.04;

struct Rule {
    applies: fn(&SceneContents) -> bool,
    /// Keys of the scene that change, as a merge patch (RFC 7396): `null` removes a key.
    changes: fn(&SceneContents) -> Value,
    reason: &'static str,
}

/// Rules of all presets, in the order in which they act.
const RULES: &[Rule] = &[
    Rule {
        applies: |c| {
            let unlumped = (c.contact || c.failure) && !c.allows_lumping();
            !c.plane && !c.strength && (c.gas || unlumped)
        },
        changes: |c| {
            let share = c.allows_lumping().then(|| lumping(c.courant, ADDED_LUMPING));
            json!({"method": {"transfer": {"fmpm": c.order(6)}, "edge_mask": 0.3,
                    "mass_lumping": share},
                "artificial_viscosity": moderate()})
        },
        reason: "a moderate viscosity, since surfaces may separate or gas may expand",
    },
    Rule {
        applies: |c| c.gas && !c.plane,
        changes: |_| json!({"method": {"domain_limit": 4.0}}),
        reason: "a domain limit, since gas may expand without bound",
    },
    Rule {
        applies: |c| {
            let unlumped = c.gas || !c.allows_lumping();
            c.strength && !c.plane && unlumped && !c.allows_flux_limiter()
        },
        changes: |c| {
            json!({"method": {"transfer": {"fmpm": c.order(6)}, "edge_mask": 0.3},
                "artificial_viscosity": {"linear": 0.2, "quadratic": 2.0, "growth": null}})
        },
        reason: "a stronger viscosity, since elastic precursors are more accurate with it",
    },
    Rule {
        applies: |c| {
            let tension_matters = c.failure || c.strength;
            tension_matters && !c.gas && c.allows_lumping() && !c.allows_flux_limiter()
        },
        changes: |c| {
            json!({"method": {"transfer": {"fmpm": c.order(18)}, "edge_mask": 0.3,
                    "mass_lumping": lumping(c.courant, ADDED_LUMPING)},
                "artificial_viscosity": {"linear": 0.08, "quadratic": 1.0, "expansion": 0.03,
                    "growth": {"rate": 6.0, "max": 2.0}}})
        },
        reason: "a larger share of the lumped mass, since tension ahead of a shock would make particles \
                 fail or weaken elastic precursors",
    },
    Rule {
        applies: SceneContents::allows_flux_limiter,
        changes: |_| {
            json!({"method": {"transfer": {"fmpm": 12}, "edge_mask": 0.4,
                    "flux_limiter": {"neighbours": 1}},
                "artificial_viscosity": {"linear": 0.03, "quadratic": 0.4,
                    "growth": {"rate": 6.0, "max": 2.0}}})
        },
        reason: "a flux limiter with a weak viscosity, since no wave separates bodies",
    },
    Rule {
        applies: |c| c.plane,
        changes: |_| {
            json!({"method": {"transfer": {"fmpm": 4}, "edge_mask": 0.3, "domain_limit": 1.0,
                    "heat_spreading": {"steps": 50},
                    "pressure_relaxation": {"rate": 0.2, "interval": 1}},
                "artificial_viscosity": {"linear": 0.1, "quadratic": 0.75, "growth": null}})
        },
        reason: "a lower transfer order, a domain limit and spreading of heat, since the scene has two \
                 dimensions",
    },
    Rule {
        applies: |c| c.plane && !(c.axisymmetric || c.gas || (c.body_force && !c.contact)),
        changes: |_| json!({"method": {"spin": true, "domain_limit": 0.7}}),
        reason: "spin, since bodies may turn, with a shorter domain limit",
    },
    Rule {
        applies: |c| c.plane && c.fluid && c.allows_expansion(LARGE_COURANT),
        changes: |c| {
            json!({"method": {"transfer": {"fmpm": c.order(6)},
                    "mass_lumping": lumping(c.courant, 0.0)},
                "artificial_viscosity": {"expansion": 0.1}})
        },
        reason: "a higher transfer order with a share of the lumped mass, and viscosity in expansion, \
                 since they reduce the errors of impacts",
    },
    Rule {
        applies: |c| c.plane && c.strength,
        changes: |_| {
            json!({"method": {"pressure_relaxation": {"rate": 0.4, "interval": 5}},
                "artificial_viscosity": moderate()})
        },
        reason: "relaxation every fifth step, since plastic flow needs little of it",
    },
    Rule {
        applies: |c| c.plane && c.gas && !c.burn && !c.sheared_gas,
        changes: |_| {
            json!({"method": {"transfer": {"fmpm": 2}, "heat_spreading": null},
                "artificial_viscosity": {"linear": 0.1, "quadratic": 0.5, "limited": "both"}})
        },
        reason: "a low transfer order without spreading of heat, since gas may flow towards a point or \
                 an axis",
    },
    Rule {
        applies: |c| c.moving_gas && !c.burn,
        changes: |_| json!({"heat_mixing": {"coefficient": 20.0}}),
        reason: "heat mixing, since a shock heats a moving gas too much at the wall where it starts",
    },
    Rule {
        applies: |c| c.moving_gas && c.plane && !c.burn,
        changes: |_| json!({"artificial_viscosity": {"linear": 0.05, "quadratic": 0.2}}),
        reason: "a weak viscosity, which suffices with heat mixing",
    },
    Rule {
        applies: |c| c.sheared_gas,
        changes: |_| {
            json!({"method": {"shape": "bspline_cubic", "spin": true, "volume_relaxation": 0.3,
                    "domain_limit": 0.7, "heat_spreading": null,
                    "pressure_relaxation": {"rate": 1.0, "interval": 1}},
                "artificial_viscosity": {"linear": 0.05, "quadratic": 0.2, "limited": "both"}})
        },
        reason: "cubic B-splines without particle domains, with spin and strong relaxation, since a \
                 velocity field shears gas",
    },
    Rule {
        applies: |c| c.plane && c.gas_pressures_differ,
        changes: |_| json!({"method": {"pressure_relaxation": {"rate": 0.02, "interval": 1}}}),
        reason: "slow relaxation, since it must not empty small particles beside gas of high pressure",
    },
    Rule {
        applies: |c| c.plane && c.burn,
        changes: |_| json!({"method": {"heat_spreading": null}, "artificial_viscosity": moderate()}),
        reason: "a moderate viscosity without spreading of heat, since a body is an explosive",
    },
    Rule {
        applies: |c| c.burn,
        changes: |_| json!({"method": {"transfer": {"fmpm": 2}}}),
        reason: "a low transfer order, since errors at burn fronts grow with the order",
    },
    Rule {
        applies: |c| c.porous && !c.plane && !c.burn,
        changes: |c| json!({"method": {"transfer": {"fmpm": c.order(6)}, "edge_mask": 0.3}}),
        reason: "a lower transfer order, since a body is porous",
    },
    Rule {
        applies: |c| c.porous,
        changes: |_| {
            let off = Value::Null;
            json!({"artificial_viscosity":
                {"linear": 0.5, "quadratic": 2.0, "growth": off, "limiter": off, "limited": off}})
        },
        reason: "the strongest viscosity, since oscillations ahead of a shock crush pores",
    },
    Rule {
        applies: |c| !c.fluid,
        changes: |_| json!({"method": {"heat_spreading": null, "pressure_relaxation": null}}),
        reason: "no pressure relaxation and no spreading of heat, since every body is elastic",
    },
];

/// Shape function of the presets, on domains that deform.
const DEFORMING: &str = "cpdi_bspline_quadratic";

/// Share of the lumped mass at a Courant number: 3/16 of its square, which compensates the error of
/// the time step, and `added`. `None` for a share of zero and for a Courant number that is not allowed.
fn lumping(courant: f64, added: f64) -> Option<f64> {
    let share = (1e4 * (3.0 / 16.0 * courant * courant + added)).round() / 1e4;
    ((0.0..=1.0).contains(&courant) && share > 0.0).then_some(share)
}

/// The viscosity for scenes in which a sharp front costs stability.
fn moderate() -> Value {
    json!({"linear": 0.1, "quadratic": 1.25, "growth": null})
}

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
            // oscillations of `sharpest` separate bodies; `robust` oscillates at large Courant numbers
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
                let method = json!({"transfer": {"fmpm": 6}, "edge_mask": 0.3});
                merge(&mut base, &json!({"method": method, "artificial_viscosity": moderate()}));
                "least error over all hard cases"
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

/// Rules that act on a scene with these contents.
fn acting(contents: &SceneContents) -> impl Iterator<Item = &'static Rule> {
    RULES.iter().filter(|rule| (rule.applies)(contents))
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

/// Whether the keys `explicit` of a method exclude the flux limiter.
fn excludes_flux_limiter(explicit: &Map<String, Value>) -> bool {
    let transfer = explicit.get("transfer").cloned();
    let transfer = transfer.and_then(|t| serde_json::from_value::<Transfer>(t).ok());
    transfer.is_some_and(|transfer| !transfer.plan().full_mass_matrix)
        || explicit.get("stepping").is_some_and(|stepping| stepping == "leapfrog")
        || explicit.get("flux_limiter").is_some_and(Value::is_null)
        || explicit.get("mass_lumping").is_some_and(|share| !share.is_null())
}

/// Whether the particle domains of a shape function deform.
fn deforms(shape: &Value) -> bool {
    use crate::shape::{DomainExtent, ShapeKind};
    let shape = serde_json::from_value::<ShapeKind>(shape.clone());
    shape.is_ok_and(|shape| shape.extent() == DomainExtent::Current)
}

impl SceneContents {
    /// Whether viscosity in expansion was measured with the contents of the scene and a Courant
    /// number up to `largest`.
    fn allows_expansion(&self, largest: f64) -> bool {
        let untested = self.porous || self.burn || self.body_force || self.untested_keys;
        let untested_in_plane =
            self.contact || self.failure || self.strength || self.gas || self.axisymmetric;
        !(untested || (self.plane && untested_in_plane)) && self.courant <= largest
    }

    /// Whether a share of the lumped mass was measured with the contents of the scene, on a line.
    fn allows_lumping(&self) -> bool {
        self.fluid && !self.plane && self.allows_expansion(LARGE_MATCHED_COURANT)
    }

    /// Whether the presets limit fluxes in this scene. Impacts on a line have larger errors with it at
    /// Courant numbers below 0.3 and above 0.5, and oscillate with one particle per cell.
    fn allows_flux_limiter(&self) -> bool {
        let without = self.contact || self.failure || self.gas || self.porous || self.plane;
        let inaccurate = self.sparse_particles || !(0.3..=0.5).contains(&self.courant);
        self.strength && !(without || inaccurate || self.excludes_flux_limiter)
    }

    /// Order of FMPM up to `most`; with one particle per cell at most that with which plane impacts
    /// do not oscillate at the Courant number of the scene.
    fn order(&self, most: u32) -> u32 {
        let orders = [(0.4, 8), (0.5, 6), (0.6, 4)];
        let largest = orders.iter().find(|(courant, _)| self.courant <= *courant);
        if self.sparse_particles { most.min(largest.map_or(2, |(_, order)| *order)) } else { most }
    }

    /// Reads the contents of a scene whose library names are resolved and whose method has the keys
    /// `explicit` beside the preset. An invalid part counts as absent; the check of the scene
    /// reports it.
    fn of(scene: &Map<String, Value>, explicit: &Map<String, Value>) -> Self {
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
        let courants = [0.2, 0.4, 0.6, 0.81];
        for c in courants.into_iter().flat_map(all) {
            let choices = Preset::ALL.map(|preset| choose(preset, &c).0);
            if c.contact && !c.plane {
                assert!(choices.iter().all(|choice| *choice == choices[0]), "{choices:?}");
            }
            for chosen in choices {
                options_fit_each_other(&chosen, &c);
            }
        }
    }

    /// Panics if options of the method of a scene with the contents `c` exclude each other.
    fn options_fit_each_other(chosen: &Value, c: &SceneContents) {
        let [method, viscosity] = ["method", "artificial_viscosity"].map(|key| &chosen[key]);
        let has = |value: &Value, key: &str| !value[key].is_null();
        assert!(!has(viscosity, "limited") || has(viscosity, "limiter"), "{viscosity}");
        let total = has(method, "frame");
        assert!(!total || !has(method, "domain_limit"), "{method}");
        let expands = has(viscosity, "expansion");
        assert!(!expands || has(viscosity, "limiter"), "{viscosity}");
        assert!(!expands || c.allows_expansion(LARGE_MATCHED_COURANT), "{viscosity}");
        assert!(!has(method, "spin") || (c.plane && !c.axisymmetric && !total), "{method}");
        let no_fluxes = c.plane || c.contact || c.failure || c.gas || c.porous;
        assert!(!has(method, "flux_limiter") || !no_fluxes, "{method}");
        let lumps = has(method, "mass_lumping");
        assert!(!lumps || c.allows_expansion(LARGE_MATCHED_COURANT), "{method}");
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
