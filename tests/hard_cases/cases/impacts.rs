//! Viscosity, speeds, impedances, separation and Courant numbers of impacts.

use decomp::Serial;
use flyer_mpm::exact::{Accuracy, Impact, ImpactBody, Separation};
use flyer_mpm::simulation::Simulation;
use serde_json::{Value, json};

use super::scenes::{shipped, with};
use super::tools::{
    checked, failed, flyer, greatest, hard, run, scored, short, until, with_flyers_scheme,
};
use super::{Figure, figure};

/// Energy of a scheme that keeps it [-].
const KEPT: f64 = 1e-10;

/// Pressure behind the standard problem's shocks [Pa].
const P2: f64 = 12.144294e9;

/// No artificial viscosity, a tenth of any sensible one, and far too much.
pub fn viscosity() -> Vec<Figure> {
    let mut figures = Vec::new();
    let few = json!({"linear": 0.01, "quadratic": 0.125});
    let most = json!({"linear": 4.0, "quadratic": 40.0, "growth": null});
    for (what, viscosity) in [("none", json!(null)), ("a tenth", few), ("40 times", most)] {
        let value = with(&short(0.3e-6), &json!({"artificial_viscosity": viscosity}));
        match run(&value) {
            Ok(ended) => {
                let most = greatest(ended.column("pressure")) / P2;
                figures.push(figure(
                    format!("viscosity {what}: greatest pressure over P2"),
                    most,
                    2.0,
                ));
                figures.push(figure(
                    format!("viscosity {what}: energy"),
                    ended.energy_drift(),
                    KEPT,
                ));
            }
            Err(e) => figures.push(figure(what, failed(what, &e), 0.0)),
        }
    }
    figures
}

/// The flyer at a speed, in a domain with room for it.
fn at_speed(speed: f64, times: &[f64]) -> Value {
    let mut value = until(&shipped("flyer.json"), times);
    value["bodies"][0]["velocity"] = json!([speed]);
    value["domain"]["upper"] = json!([0.012]);
    value
}

/// 3, 5, 10 and 30 km/s.
pub fn speeds() -> Vec<Figure> {
    let mut figures = Vec::new();
    for (speed, times) in
        [(3e3, [0.2e-6, 0.6e-6]), (5e3, [0.2e-6, 0.6e-6]), (1e4, [0.1e-6, 0.3e-6])]
    {
        let what = format!("{} km/s", speed * 1e-3);
        match scored(&at_speed(speed, &times)) {
            Ok((ended, errors)) => {
                let e1 = errors.iter().map(|e| e.e1_cells.unwrap_or(f64::NAN)).fold(0.0, f64::max);
                figures.push(figure(format!("{what}: E1 in cells"), e1, 2.5));
                // later the fan has caught up
                let early = errors.first().expect("two profiles");
                for (name, value) in [("plateau", early.plateau), ("noise", early.noise)] {
                    let value = value.unwrap_or(f64::NAN);
                    figures.push(figure(format!("{what}: {name}"), value, 2e-3));
                }
                figures.push(figure(format!("{what}: energy"), ended.energy_drift(), KEPT));
            }
            Err(e) => figures.push(figure(&what, failed(&what, &e), 0.0)),
        }
    }
    // three quarters of the way to the equation of state's limit
    let mut value = at_speed(3e4, &[0.05e-6]);
    value["domain"]["upper"] = json!([0.02]);
    value.as_object_mut().expect("a scene").remove("reference");
    let energy = run(&value).map_or_else(|e| failed("30 km/s", &e), |ended| ended.energy_drift());
    figures.push(figure("30 km/s: energy", energy, KEPT));
    figures
}

/// Ratios of impedance from 0.01 to 52.
pub fn impedances() -> Vec<Figure> {
    let mut figures = Vec::new();
    for (what, name) in [
        ("foam on tungsten", "foam_on_tungsten.json"),
        ("tungsten on water", "tungsten_on_water.json"),
    ] {
        match scored(&hard(name)) {
            Ok((ended, errors)) => {
                let plateau = errors[0].plateau.unwrap_or(f64::NAN);
                figures.push(figure(format!("{what}: plateau"), plateau, 0.01));
                figures.push(figure(format!("{what}: energy"), ended.energy_drift(), KEPT));
            }
            Err(e) => figures.push(figure(what, failed(what, &e), 0.0)),
        }
    }
    figures
}

/// The impact of a scene's two bodies.
fn impact(value: &Value) -> Option<Impact> {
    let scene = checked(value).ok()?;
    let body = |i: usize| {
        let (material, extent) = (scene.material_of(i), &value["bodies"][i]["box"]);
        Some(ImpactBody {
            material: material.eos.straight(material.density)?,
            lower: extent["lower"][0].as_f64()?,
            upper: extent["upper"][0].as_f64()?,
            velocity: scene.bodies[i].velocity[0],
        })
    };
    Impact::new(body(0)?, body(1)?).ok()
}

/// A light flyer that parts, and a gap that closes.
pub fn separation() -> Vec<Figure> {
    let mut value = until(&with_flyers_scheme(shipped("soft_flyer.json")), &[0.3e-6]);
    value["domain"]["upper"] = json!([0.0034]);
    value["bodies"][1]["box"]["upper"] = json!([0.003]);
    let exact = impact(&value)
        .and_then(|i| Separation::new(&i, 0.3e-6, Accuracy::default()).ok())
        .flatten()
        .expect("they part");
    let last = last_pressed(&value, 0.01 * exact.peak_pressure);
    let last = last.unwrap_or_else(|e| failed("separation", &e));
    let due = exact.falls_to(0.01);
    let bound = (0.01 * due).max(2.0 * 1e-5 / 5386.0);
    let mut figures = vec![figure("separation, late by [s]", last - due, bound)];
    let mut gap = value.clone();
    gap["bodies"][0]["box"] = json!({"lower": [-0.00065], "upper": [-0.00015]});
    let first = first_pressed(&gap).unwrap_or_else(|e| failed("gap", &e));
    figures.push(figure("a gap of 15 cells closes, late by [s]", first - 1e-7, 2e-9));
    figures
}

fn forces(value: &Value) -> Result<Vec<(f64, f64)>, String> {
    let scene = checked(value)?;
    let mut simulation = Simulation::<1>::new(&scene, &Serial, 1).map_err(|e| e.to_string())?;
    let mut forces = Vec::new();
    while simulation.time() < scene.scene.time.end {
        simulation.advance(scene.scene.time.end).map_err(|e| e.to_string())?;
        forces.push((simulation.time(), simulation.contact_force()[0]));
    }
    Ok(forces)
}

fn last_pressed(value: &Value, level: f64) -> Result<f64, String> {
    Ok(forces(value)?.iter().filter(|f| f.1 > level).map(|f| f.0).fold(0.0, f64::max))
}

fn first_pressed(value: &Value) -> Result<f64, String> {
    Ok(forces(value)?.iter().find(|f| f.1 != 0.0).map_or(f64::NAN, |f| f.0))
}

/// Courant numbers from the greatest that the scheme may have down to 0.02.
pub fn courant() -> Vec<Figure> {
    let at = |courant: f64| {
        let mut value = flyer();
        value["time"]["courant"] = json!(courant);
        scored(&value)
            .map(|(ended, errors)| (errors[1].l1.unwrap_or(f64::NAN), ended.energy_drift()))
    };
    let usual = at(0.4).map_or_else(|e| failed("courant 0.4", &e), |(l1, _)| l1);
    let limit = checked(&flyer()).map_or(f64::NAN, |scene| scene.courant_limit());
    let mut figures = Vec::new();
    // near the limit it is stable, not accurate: 3.2 was measured at 0.9; and as pressure is relaxed
    // once a step, ever more of it in ever shorter steps smears what it smooths: 1.3 at 0.02
    for (courant, bound) in
        [(limit.min(0.9), 4.0), (0.6, 1.2), (0.2, 1.2), (0.1, 1.2), (0.05, 1.2), (0.02, 1.4)]
    {
        let what = format!("courant {courant}");
        let (l1, energy) = at(courant).unwrap_or_else(|e| (failed(&what, &e), f64::NAN));
        figures.push(figure(format!("{what}: L1 over that at 0.4"), l1 / usual, bound));
        figures.push(figure(format!("{what}: energy"), energy, KEPT));
    }
    figures
}

/// A plate that is two bodies of one material is one, with and without contact.
pub fn two_as_one() -> Vec<Figure> {
    let whole = short(0.2e-6);
    let mut two = whole.clone();
    let target = two["bodies"][1].clone();
    let (mut near, mut far) = (target.clone(), target);
    near["box"]["upper"] = json!([0.0005]);
    far["box"]["lower"] = json!([0.0005]);
    far["name"] = json!("rest of the target");
    two["bodies"][1] = near;
    two["bodies"].as_array_mut().expect("bodies").push(far);
    two.as_object_mut().expect("a scene").remove("reference");
    let apart = |contact: Value| -> Result<f64, String> {
        let mut whole = whole.clone();
        whole.as_object_mut().expect("a scene").remove("reference");
        // the flyer is welded on in both: what is looked at is the cut
        let two = with(&two, &json!({"contact": contact}));
        let whole = with(&whole, &json!({"contact": contact}));
        let (a, b) = (run(&two)?, run(&whole)?);
        let pairs = a.column("pressure").iter().zip(b.column("pressure"));
        Ok(pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / P2)
    };
    [("one field", json!(null)), ("contact", json!({"type": "frictionless"}))]
        .into_iter()
        .map(|(what, contact)| {
            let value = apart(contact).unwrap_or_else(|e| failed(what, &e));
            figure(format!("a plate cut in two, {what}: pressure, of P2"), value, 1e-3)
        })
        .collect()
}
