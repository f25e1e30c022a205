//! Rules that adapt the method of a preset to the contents of a scene.

use serde_json::{Value, json};

use super::contents::SceneContents;

/// Share of the lumped mass, beyond that which compensates the time step, with which little tension
/// is left ahead of a shock.
pub(super) const ADDED_LUMPING: f64 = 0.04;

pub(super) struct Rule {
    applies: fn(&SceneContents) -> bool,
    /// Keys of the scene that change, as a merge patch (RFC 7396): `null` removes a key.
    pub(super) changes: fn(&SceneContents) -> Value,
    pub(super) reason: &'static str,
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
            let without = c.plane || c.gas || c.allows_flux_limiter();
            tension_matters(c) && c.allows_lumping() && !without
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
        reason: "a lower transfer order than on a line, a domain limit and spreading of heat, since the \
                 scene has two dimensions",
    },
    Rule {
        applies: |c| c.plane && !(c.axisymmetric || c.gas || (c.body_force && !c.contact)),
        changes: |_| json!({"method": {"spin": true, "domain_limit": 0.7}}),
        reason: "spin, since bodies may turn, with a shorter domain limit",
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
        // order 2, for one particle per cell at large Courant numbers, was not measured
        applies: |c| c.plane && c.allows_lumping() && c.order(6) >= 4,
        changes: |c| {
            let added = if tension_matters(c) { ADDED_LUMPING } else { 0.0 };
            // a stronger viscosity in expansion would make bodies part later
            let expansion = if c.contact { 0.02 } else { 0.1 };
            json!({"method": {"transfer": {"fmpm": c.order(6)},
                    "mass_lumping": lumping(c.courant, added)},
                "artificial_viscosity": {"linear": 0.1, "quadratic": 0.75, "expansion": expansion}})
        },
        reason: "a share of the lumped mass and viscosity in expansion, since they reduce the errors of \
                 impacts",
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

/// Whether tension ahead of a shock would make particles fail or weaken elastic precursors.
fn tension_matters(contents: &SceneContents) -> bool {
    contents.failure || contents.strength
}

/// Share of the lumped mass at a Courant number: 3/16 of its square, which compensates the error of
/// the time step, and `added`. `None` for a share of zero and for a Courant number that is not allowed.
pub(super) fn lumping(courant: f64, added: f64) -> Option<f64> {
    let share = (1e4 * (3.0 / 16.0 * courant * courant + added)).round() / 1e4;
    ((0.0..=1.0).contains(&courant) && share > 0.0).then_some(share)
}

/// The viscosity for scenes in which a sharp front costs stability.
pub(super) fn moderate() -> Value {
    json!({"linear": 0.1, "quadratic": 1.25, "growth": null})
}

/// Rules that act on a scene with these contents.
pub(super) fn acting(contents: &SceneContents) -> impl Iterator<Item = &'static Rule> {
    RULES.iter().filter(|rule| (rule.applies)(contents))
}
