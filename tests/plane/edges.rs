//! Bodies with edges that slide on each other, with and without friction.

use decomp::Serial;
use flyer_mpm::simulation::Simulation;
use serde_json::{Value, json};

use crate::tools::{Outcome, at_most, checked, run, same_bits};

/// Edge of a cell [m].
const CELL: f64 = 0.01;

/// Rubber of 1 MPa.
fn rubber() -> Value {
    json!({"density": 1000.0,
        "eos": {"type": "neo_hookean", "youngs_modulus": 1e6, "poissons_ratio": 0.3}})
}

/// Speed of pressure waves in it [m/s].
const SOUND: f64 = 36.69;

fn boxed(lower: [f64; 2], upper: [f64; 2]) -> Value {
    json!({"box": {"lower": lower, "upper": upper}})
}

/// Two bodies with the given regions and velocities.
fn pair(regions: [Value; 2], velocities: [[f64; 2]; 2], contact: Value) -> Value {
    let mut bodies = Vec::new();
    for ((name, region), velocity) in ["first", "second"].iter().zip(regions).zip(velocities) {
        let mut body = region;
        body["name"] = json!(name);
        body["material"] = json!("rubber");
        body["velocity"] = json!(velocity);
        body["particles_per_cell"] = json!([2, 2]);
        bodies.push(body);
    }
    json!({
        "title": "edges",
        "domain": {"lower": [-0.1, -0.1], "upper": [0.4, 0.3], "cell_size": CELL},
        "time": {"end": 0.1},
        "method": {
            "shape": "cpdi_bspline_quadratic", "transfer": {"fmpm": 4}, "stepping": "midpoint",
            "energy": "compatible", "filter_heat": true, "edge_mask": 0.3
        },
        "artificial_viscosity": {"linear": 0.1, "quadratic": 1.25, "limiter": "christensen"},
        "materials": {"rubber": rubber()},
        "bodies": bodies,
        "contact": contact
    })
}

/// A vector turned by an angle.
fn turned([x, y]: [f64; 2], degrees: f64) -> [f64; 2] {
    let (sin, cos) = degrees.to_radians().sin_cos();
    [cos * x - sin * y, sin * x + cos * y]
}

fn rotated(region: Value, degrees: f64) -> Value {
    json!({"rotation": {"angle": degrees, "about": [0.0, 0.0], "of": region}})
}

/// Mean velocity of each body [m/s].
fn velocities(outcome: &Outcome<2>) -> [[f64; 2]; 2] {
    let [rho, volume, x, y] =
        ["density", "volume", "velocity_x", "velocity_y"].map(|n| outcome.column(n));
    let mut sums = [[0.0; 3]; 2];
    for (r, &body) in outcome.table.body.iter().enumerate() {
        let mass = rho[r] * volume[r];
        for (sum, value) in sums[body as usize].iter_mut().zip([mass, mass * x[r], mass * y[r]]) {
            *sum += value;
        }
    }
    sums.map(|[mass, x, y]| [x / mass, y / mass])
}

fn greatest_pressure(outcome: &Outcome<2>) -> f64 {
    outcome.column("pressure").iter().fold(0.0, |most: f64, p| most.max(p.abs()))
}

/// A block of 8 by 4 cells that slides at 1 m/s over the end of a base.
fn slide(degrees: f64, contact: Value) -> Value {
    let block = boxed([0.02, 0.0], [0.1, 0.04]);
    let base = boxed([-0.03, -0.04], [0.17, 0.0]);
    let velocity = turned([1.0, 0.0], degrees);
    pair([rotated(block, degrees), rotated(base, degrees)], [velocity, [0.0; 2]], contact)
}

#[test]
fn corners_do_not_hold_a_block_that_slides_without_friction() {
    for degrees in [0.0, 17.0, 45.0] {
        let outcome = run::<2>(&slide(degrees, json!({"type": "frictionless"})));
        let along = turned(velocities(&outcome)[0], -degrees)[0];
        at_most(&format!("{degrees}: speed lost"), 1.0 - along, 1e-6);
        let pressure = greatest_pressure(&outcome) / (1000.0 * SOUND);
        at_most(&format!("{degrees}: pressure"), pressure, 1e-6);
    }
}

#[test]
fn blocks_that_pass_each_other_at_a_corner_do_not_touch() {
    for degrees in [0.0, 17.0] {
        let upper = boxed([0.0, 0.5 * CELL], [0.06, 0.06 + 0.5 * CELL]);
        let lower = boxed([0.075, -0.06], [0.135, 0.0]);
        let speed = turned([20.0, 0.0], degrees);
        let regions = [upper, lower].map(|region| rotated(region, degrees));
        let mut scene = pair(regions, [speed, [0.0; 2]], json!({"type": "frictionless"}));
        scene["time"]["end"] = json!(7.5e-3);
        let outcome = run::<2>(&scene);
        let pressure = greatest_pressure(&outcome) / (1000.0 * SOUND * 20.0);
        at_most(&format!("{degrees}: pressure"), pressure, 1e-6);
    }
}

/// A block of 10 by 4 cells under gravity on a base that a wall holds.
fn on_base(transfer: &Value, gravity: [f64; 2], speed: f64) -> Value {
    let regions = [boxed([0.02, 0.0], [0.12, 0.04]), boxed([-0.1, -0.04], [0.4, 0.0])];
    let contact = json!({"type": "friction", "coefficient": 0.3});
    let mut scene = pair(regions, [[speed, 0.0], [0.0; 2]], contact);
    scene["domain"] = json!({"lower": [-0.1, -0.04], "upper": [0.4, 0.1], "cell_size": CELL});
    scene["boundary"] = json!({"y_lower": "no_slip", "x_lower": "wall", "x_upper": "wall"});
    scene["body_force"] = json!({"gravity": gravity});
    scene["method"]["transfer"] = transfer.clone();
    scene["method"]["filter_heat"] = json!(transfer != "flip");
    if transfer.get("fmpm").is_none() {
        scene["method"]["edge_mask"] = Value::Null;
    }
    scene["time"]["end"] = json!(0.03);
    scene
}

#[test]
fn friction_is_that_of_the_normal_impulse_in_every_step() {
    for transfer in [json!("pic"), json!("flip"), json!({"xpic": 2}), json!({"fmpm": 4})] {
        let scene = checked(&on_base(&transfer, [0.0, -10.0], 1.0));
        let mut simulation = Simulation::<2>::new(&scene, &Serial, 1).unwrap();
        let weight = 1000.0 * 0.1 * 0.04 * 10.0;
        while simulation.time() < scene.scene.time.end {
            simulation.advance(scene.scene.time.end).unwrap();
            let [normal, friction] = simulation.contact_force();
            if normal > 0.1 * weight {
                let ratio = friction / (0.3 * normal);
                assert!((ratio - 1.0).abs() < 0.02, "{transfer}: {ratio} mu N");
            }
        }
    }
}

/// A transfer that takes the bouncing of a block that has been dropped on the base.
#[test]
fn a_block_on_an_incline_slides_or_sticks_by_coulombs_law() {
    // a slope of 0.25 below the coefficient of 0.3, and one of 0.4 above it
    for (slope, moves) in [(0.25f64, 0.0), (0.4, 1.0)] {
        let angle = slope.atan();
        let [along, down] = [10.0 * angle.sin(), 10.0 * angle.cos()];
        let mut scene = on_base(&json!("pic"), [along, -down], 0.0);
        scene["time"]["end"] = json!(0.1);
        let outcome = run::<2>(&scene);
        let exact = moves * (along - 0.3 * down) * 0.1;
        let off = velocities(&outcome)[0][0] - exact;
        at_most(&format!("{slope}"), off.abs() / (along * 0.1), 0.02);
    }
}

#[test]
fn edges_in_contact_keep_the_bits_on_any_layout() {
    let mut scene = slide(17.0, json!({"type": "friction", "coefficient": 0.3}));
    scene["body_force"] = json!({"gravity": [3.0, -10.0]});
    scene["time"]["end"] = json!(5e-3);
    same_bits(&scene);
}
