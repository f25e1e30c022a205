//! Flux limiter: whole steps of a row of particles with a jump in velocity and pressure.

use serde_json::{Value, json};

use super::fixture::Fixture;

/// Eight particles in six cells that run into two at rest under pressure.
fn row(changes: Value) -> Fixture<1> {
    let body = json!({"name": "body", "material": "fluid", "particles_per_cell": [2],
        "box": {"lower": [0.0], "upper": [16.0]}});
    let mut method = json!({"shape": "cpdi_bspline_quadratic", "transfer": {"fmpm": 5},
        "stepping": "midpoint", "energy": "compatible", "filter_heat": true, "edge_mask": 0.3});
    method.as_object_mut().unwrap().extend(changes.as_object().cloned().unwrap_or_default());
    let mut f = Fixture::new(json!({"method": method, "bodies": [body],
        "domain": {"lower": [-2.0], "upper": [18.0], "cell_size": 1.0}}));
    let at = |of: fn(f64) -> f64| (0..32).map(|r| of(0.25 + 0.5 * r as f64)).collect::<Vec<_>>();
    f.set("velocity", &at(|x| if x < 8.0 { 2.0 } else { 0.0 }));
    f.set("jacobian", &at(|x| if x < 8.0 { 0.8 } else { 1.0 }));
    f
}

/// Momentum and energy.
fn kept(f: &Fixture<1>) -> [f64; 2] {
    let [m, v, e] = ["mass", "velocity", "specific_internal_energy"].map(|name| f.get(name));
    let sum = |term: &dyn Fn(usize) -> f64| (0..m.len()).map(|r| m[r] * term(r)).sum();
    [sum(&|r| v[r]), sum(&|r| 0.5 * v[r] * v[r] + e[r])]
}

#[test]
fn momentum_and_energy_stay() {
    for limiter in [json!({"neighbours": 1}), json!({"neighbours": 2})] {
        for order in [2, 5] {
            let mut f = row(json!({"flux_limiter": limiter, "transfer": {"fmpm": order}}));
            let before = kept(&f);
            for _ in 0..4 {
                f.advance(0.02);
            }
            for (before, after) in before.into_iter().zip(kept(&f)) {
                assert!((after - before).abs() < 1e-13 * before.abs(), "{order}: {before} {after}");
            }
        }
    }
}

/// Velocity ahead of the jump, where the unlimited series turns against it.
#[test]
fn nothing_is_drawn_towards_a_front() {
    let least = |changes: Value| {
        let mut f = row(changes);
        f.advance(0.02);
        f.get("velocity")[16..].iter().copied().fold(f64::INFINITY, f64::min)
    };
    let (free, limited) = (least(json!({})), least(json!({"flux_limiter": {"neighbours": 1}})));
    assert!(free < -0.01 && limited > 0.1 * free, "{free} {limited}");
}
