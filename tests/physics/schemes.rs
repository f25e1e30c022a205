//! Every shape function with every transfer and order of stress update: what is inaccurate but
//! bounded runs.

use serde_json::{Value, json};

use crate::tools::{at_most, checked, column, run, run_scene, short, transfers, with};

const END: f64 = 0.3e-6;

/// Runs a scheme; what is wrong with it, or nothing. Its energy may grow by the fraction `gain`.
fn fault(base: &Value, method: &Value, gain: f64) -> Option<String> {
    let scene = checked(&with(base, &json!({"method": method})));
    let outcome = match run_scene(&scene, 1) {
        Ok(outcome) => outcome,
        Err(error) => return Some(error),
    };
    let table = outcome.last();
    for name in ["x", "pressure", "velocity", "density", "specific_internal_energy"] {
        if !column(table, name).iter().all(|value| value.is_finite()) {
            return Some(format!("{name} is not finite"));
        }
    }
    if let Some(v) = column(table, "velocity").iter().find(|v| v.abs() > 3000.0) {
        return Some(format!("velocity {v}"));
    }
    for (rho, &body) in column(table, "density").iter().zip(&table.body) {
        let ratio = rho / scene.material_of(body as usize).density;
        if !(0.5..2.0).contains(&ratio) {
            return Some(format!("density {ratio} of that at rest"));
        }
    }
    // all sides are free
    if outcome.momentum_drift().abs() > 1e-12 {
        return Some(format!("momentum drift {}", outcome.momentum_drift()));
    }
    (outcome.energy_drift() > gain).then(|| format!("energy drift {}", outcome.energy_drift()))
}

fn leapfrog(shape: &str) {
    let mut base = short("flyer_uintah.json", END);
    if let Ok(c) = std::env::var("COURANT") {
        base["time"]["courant"] = json!(c.parse::<f64>().unwrap());
    }
    let mut faults = Vec::new();
    for transfer in transfers() {
        for update in ["last", "first", "modified_last"] {
            let method = json!({"shape": shape, "transfer": transfer, "stress_update": update});
            let gain = match (shape, update) {
                // every particle that passes into another cell is kicked
                ("linear", _) => 3.0,
                // explicit in time: it gains what stress last loses, in proportion to the step
                (_, "first") => 0.15,
                _ => 0.01,
            };
            let fault = fault(&base, &method, gain);
            faults.extend(fault.map(|f| format!("{transfer} {update}: {f}")));
        }
    }
    assert!(faults.is_empty(), "{shape}:\n{}", faults.join("\n"));
}

/// Mid-point steps with all that each transfer allows; energy is exact where its work is
/// compatible and the filter's loss is given back.
fn midpoint(shape: &str) {
    let mut base = short("flyer.json", END);
    // the default's own is less than hat functions bear
    base["artificial_viscosity"] =
        json!({"linear": 0.1, "quadratic": 1.25, "limiter": "christensen"});
    let mut faults = Vec::new();
    for transfer in transfers() {
        let (fmpm, flip) = (transfer.get("fmpm").is_some(), transfer == "flip");
        let exact = transfer != "apic";
        let relaxation = if fmpm { json!({"rate": 0.1, "interval": 1}) } else { Value::Null };
        let method = json!({
            "shape": shape,
            "transfer": transfer,
            "energy": if exact { "compatible" } else { "textbook" },
            "filter_heat": exact && !flip,
            "edge_mask": if fmpm { json!(0.3) } else { Value::Null },
            "pressure_relaxation": relaxation,
        });
        // an edit that is an object adds to the old one
        let mut base = base.clone();
        base["method"] = json!({"shape": shape, "transfer": null, "stepping": "midpoint"});
        if let Some(f) = fault(&base, &method, 0.01) {
            faults.push(format!("{transfer}: {f}"));
            continue;
        }
        let outcome = run_scene(&checked(&with(&base, &json!({"method": method}))), 1).unwrap();
        at_most(&format!("{shape} {transfer} momentum"), outcome.momentum_drift(), 1e-12);
        if exact {
            at_most(&format!("{shape} {transfer} energy"), outcome.energy_drift(), 1e-12);
        }
    }
    assert!(faults.is_empty(), "{shape}:\n{}", faults.join("\n"));
}

/// Stress first gains energy and stress last loses it, both in proportion to the time step.
#[test]
fn energy_errors_of_leapfrog_fall_with_the_step() {
    let drift = |update: &str, courant: f64| {
        let mut scene = short("flyer_uintah.json", END);
        scene["method"]["stress_update"] = json!(update);
        scene["time"]["courant"] = json!(courant);
        run(&scene).energy_drift()
    };
    let (coarse, fine) = (drift("first", 0.4), drift("first", 0.1));
    assert!(fine > 0.0 && coarse > 3.0 * fine, "stress first {coarse}, {fine}");
    let (coarse, fine) = (drift("last", 0.4), drift("last", 0.1));
    assert!(coarse < fine && fine < 0.0, "stress last {coarse}, {fine}");
    at_most("modified last", drift("modified_last", 0.4), 0.002);
}

macro_rules! each_shape {
    ($($name:ident),*) => {
        mod leapfrog_is_bounded {
            $(#[test] fn $name() { super::leapfrog(stringify!($name)) })*
        }
        mod midpoint_is_bounded_and_exact {
            $(#[test] fn $name() { super::midpoint(stringify!($name)) })*
        }
    };
}
each_shape!(linear, gimp, cpdi, bspline_quadratic, bspline_cubic, cpdi_bspline_quadratic);
