//! Sides that waves pass, and walls that hold what slides along them.

use flyer_mpm::input;
use flyer_mpm::simulation::Compiled;
use flyer_mpm::solver::Stepper;
use serde_json::{Value, json};

use crate::tools::{Outcome, at_most, default_method, metals, run};

/// A flyer on a target of aluminium that ends at `length` [m]; there is what `side` says, or more
/// of the target.
fn plates(flyer: &str, length: f64, speed: f64, side: Option<&str>) -> Value {
    let end = if side.is_some() { length } else { 2.0 * length };
    let body = |name: &str, material: &str, lower: f64, upper: f64, speed: f64| {
        json!({
            "name": name, "material": material, "velocity": [speed], "particles_per_cell": [2],
            "box": {"lower": [lower], "upper": [upper]}
        })
    };
    let mut method = default_method();
    method.as_object_mut().unwrap().remove("domain_limit");
    method["transfer"] = json!({"fmpm": 6});
    let thick = if speed > 100.0 { 5e-4 } else { 2e-4 };
    json!({
        "title": "a wave that leaves",
        "domain": {"lower": [-1e-3], "upper": [end], "cell_size": 1e-5},
        "time": {"end": 1.0},
        "method": method,
        "materials": metals(),
        "bodies": [
            body("flyer", flyer, -thick, 0.0, speed), body("target", "aluminium", 0.0, end, 0.0)
        ],
        "artificial_viscosity": {
            "linear": 0.1, "quadratic": 1.25, "limiter": "christensen", "limited": "linear"
        },
        "boundary": {"x_upper": side.unwrap_or("free")}
    })
}

/// Makes a shock's front two cells thinner.
fn sharpen(scene: &mut Value) {
    scene["method"]["transfer"] = json!({"fmpm": 8});
    scene["method"]["edge_mask"] = json!(0.4);
    scene["artificial_viscosity"]["linear"] = json!(0.05);
    scene["artificial_viscosity"]["quadratic"] = json!(0.5);
    scene["artificial_viscosity"]["growth"] = json!({"rate": 6.0, "max": 2.0});
}

/// Greatest difference of pressure from that of a target that goes on, up to ten cells from the
/// side.
fn comes_back(flyer: &str, speed: f64, times: [f64; 2], side: &str, sharp: bool) -> f64 {
    const LENGTH: f64 = 1e-3;
    let mut most = 0.0f64;
    for time in times {
        let [cut, whole] = [Some(side), None].map(|side| {
            let mut scene = plates(flyer, LENGTH, speed, side);
            if sharp {
                sharpen(&mut scene);
            }
            scene["time"]["end"] = json!(time);
            run::<1>(&scene)
        });
        if side == "transmitting" {
            at_most("energy", cut.unbooked_energy(), 1e-12);
            at_most("momentum", cut.unbooked_momentum(0) / cut.totals[0].momentum[0], 2e-12);
        }
        let other = whole.column("x").iter().zip(whole.column("pressure"));
        let other: Vec<(f64, f64)> = other.map(|(x, p)| (*x, *p)).collect();
        for (x, p) in cut.column("x").iter().zip(cut.column("pressure")) {
            let at = other.partition_point(|o| o.0 < *x).clamp(1, other.len() - 1);
            let ((x0, p0), (x1, p1)) = (other[at - 1], other[at]);
            if *x < LENGTH - 1e-4 {
                most = most.max((p - (p0 + (p1 - p0) * (x - x0) / (x1 - x0))).abs());
            }
        }
    }
    most
}

/// A pulse of 1 m/s and 40 cells with steep ends, and the shock of the standard problem.
#[test]
fn waves_do_not_come_back_from_a_transmitting_side() {
    let pulse = |side| comes_back("aluminium", 2.0, [2.1e-7, 2.4e-7], side, false) / 15.0e6;
    let shock =
        |side, sharp| comes_back("copper", 1000.0, [1.85e-7, 2.1e-7], side, sharp) / 12.144e9;
    at_most("of the pulse", pulse("transmitting"), 0.02);
    at_most("of the shock", shock("transmitting", false), 0.02);
    // by the gradient of the last step instead of that at the middle of this one: 0.0174
    at_most("of a sharp shock", shock("transmitting", true), 0.014);
    // all of it does from an end that is free
    assert!(pulse("outflow") > 0.9 && shock("outflow", false) > 0.9);
}

/// What leaves a line leaves a column in the plane, whatever the shape function looks at.
#[test]
fn waves_leave_a_column_as_they_leave_a_line() {
    const HEIGHT: f64 = 2e-5;
    for shape in ["gimp", "cpdi", "bspline_quadratic", "bspline_cubic", "cpdi_bspline_quadratic"] {
        let mut line = plates("copper", 2e-4, 1000.0, Some("transmitting"));
        line["method"]["shape"] = json!(shape);
        line["time"]["end"] = json!(6e-8);
        let mut column = line.clone();
        let widen = |vector: &mut Value, y: f64| vector.as_array_mut().unwrap().push(json!(y));
        widen(&mut column["domain"]["lower"], 0.0);
        widen(&mut column["domain"]["upper"], HEIGHT);
        for body in column["bodies"].as_array_mut().unwrap() {
            widen(&mut body["box"]["lower"], 0.0);
            widen(&mut body["box"]["upper"], HEIGHT);
            widen(&mut body["velocity"], 0.0);
            body["particles_per_cell"] = json!([2, 2]);
        }
        column["boundary"]["y_lower"] = json!("symmetry");
        column["boundary"]["y_upper"] = json!("symmetry");
        let (line, column) = (run::<1>(&line), run::<2>(&column));
        let place = line.column("x").iter().zip(line.column("pressure"));
        let place: Vec<(f64, f64)> = place.map(|(x, p)| (*x, *p)).collect();
        for (x, p) in column.column("x").iter().zip(column.column("pressure")) {
            let at = place.partition_point(|o| o.0 < x - 1e-9);
            at_most(&format!("{shape} at {x}"), (place[at].0 - x) / 1e-5, 1e-9);
            at_most(&format!("{shape} at {x}"), (place[at].1 - p) / 12.144e9, 1e-9);
        }
    }
}

/// A shear wave in a solid leaves as well as one of compression.
#[test]
fn shear_waves_leave_too() {
    let tail = |side: &str| {
        let mut scene = column(0.005, default_solid(), side, [0.0, 0.0]);
        scene["domain"]["upper"][1] = json!(0.44);
        let mut upper = scene["bodies"][0].clone();
        scene["bodies"][0]["box"]["upper"][1] = json!(0.3);
        upper["name"] = json!("upper");
        upper["box"]["lower"][1] = json!(0.3);
        upper["box"]["upper"][1] = json!(0.4);
        upper["velocity"] = json!([0.01, -0.01]);
        scene["bodies"].as_array_mut().unwrap().push(upper);
        scene["time"]["end"] = json!(0.65 / SHEAR_SPEED);
        let outcome = run::<2>(&scene);
        at_most("energy", outcome.unbooked_energy(), 1e-12);
        let most = |name: &str| outcome.column(name).iter().fold(0.0f64, |m, v| m.max(v.abs()));
        [most("velocity_x"), most("velocity_y")].map(|v| v / 0.005)
    };
    let [across, along] = tail("transmitting");
    at_most("shear", across, 0.02);
    at_most("compression", along, 0.02);
    assert!(tail("free")[0] > 0.9);
}

/// Material that flows out under pressure feels neither the side nor that particles leave.
#[test]
fn a_uniform_flow_stays_as_it_is() {
    fn check<const D: usize>(method: Value)
    where
        Stepper<D>: Compiled<D>,
    {
        let both = |x: f64, y: f64| if D == 2 { json!([x, y]) } else { json!([x]) };
        let what = method.to_string();
        let mut scene = json!({
            "title": "a flow",
            "domain": {"lower": both(-2e-4, 0.0), "upper": both(4e-3, 8e-5), "cell_size": 2e-5},
            "time": {"end": 3e-7},
            "method": method,
            "materials": metals(),
            "bodies": [{
                "name": "flow", "material": "aluminium", "pressure": 1e9,
                "velocity": both(500.0, 0.0), "particles_per_cell": vec![2; D],
                "box": {"lower": both(0.0, 0.0), "upper": both(4e-3, 8e-5)}
            }],
            "boundary": {"x_upper": "transmitting"}
        });
        if D == 2 {
            scene["boundary"]["y_lower"] = json!("symmetry");
            scene["boundary"]["y_upper"] = json!("symmetry");
        }
        let outcome = run::<D>(&scene);
        assert!(outcome.left.count >= 14, "{} have left", outcome.left.count);
        let velocity = if D == 2 { "velocity_x" } else { "velocity" };
        let rows = outcome.column("x").iter().zip(outcome.column("pressure"));
        // the other end's release has come to x = 1.8 mm
        for ((x, p), v) in rows.zip(outcome.column(velocity)).filter(|((x, _), _)| **x > 3.2e-3) {
            at_most(&format!("{what} at {x}"), p / 1e9 - 1.0, 1e-11);
            at_most(&what, v / 500.0 - 1.0, 1e-11);
        }
    }
    let mut method = default_method();
    method.as_object_mut().unwrap().remove("domain_limit");
    check::<1>(method);
    check::<1>(json!({"shape": "cpdi", "transfer": "flip"}));
    check::<2>(json!({"shape": "cpdi_bspline_quadratic", "transfer": "apic"}));
}

/// Speed of shear waves in the solid [m/s].
const SHEAR_SPEED: f64 = 19.611_613_513_818_4;

/// A method that keeps the energy of solids to rounding.
fn default_solid() -> Value {
    let mut method = default_method();
    method.as_object_mut().unwrap().remove("pressure_relaxation");
    method
}

/// A column of a soft solid, 0.1 m high, on `side`, between joined sides.
fn column(cell: f64, method: Value, side: impl Into<Value>, gravity: [f64; 2]) -> Value {
    let mut scene = json!({
        "title": "a layer on a wall",
        "domain": {
            "lower": [0.0, 0.0], "upper": [4.0 * cell, 0.1 + 4.0 * cell], "cell_size": cell
        },
        "time": {"end": 0.1},
        "method": method,
        "materials": {"rubber": {"density": 1000.0, "eos":
            {"type": "neo_hookean", "youngs_modulus": 1e6, "poissons_ratio": 0.3}}},
        "bodies": [{
            "name": "layer", "material": "rubber", "velocity": [0.0, 0.0],
            "particles_per_cell": [2, 2],
            "box": {"lower": [0.0, 0.0], "upper": [4.0 * cell, 0.1]}
        }],
        "boundary": {"x_lower": "periodic", "x_upper": "periodic", "y_lower": side.into()}
    });
    if gravity != [0.0; 2] {
        scene["body_force"] = json!({"gravity": gravity});
    }
    scene
}

/// Velocity at height `y` and `time` of an elastic layer of height `h` on a wall that it sticks
/// to, pulled along it by `g` from rest: the sum of its modes.
fn sheared(h: f64, g: f64, y: f64, time: f64) -> f64 {
    let mode = |n: i32| {
        let k = f64::from(2 * n + 1) * std::f64::consts::FRAC_PI_2 / h;
        let load = 2.0 * g / (k * h);
        load / (k * SHEAR_SPEED) * (k * y).sin() * (k * SHEAR_SPEED * time).sin()
    };
    (0..200).map(mode).sum()
}

/// Relative L1 of the velocity in a sheared layer.
fn shear_error(cell: f64, method: Value, side: &str) -> f64 {
    let mut scene = column(cell, method, side, [0.1, 0.0]);
    let time = 1.2 * 0.1 / SHEAR_SPEED;
    scene["time"]["end"] = json!(time);
    let outcome = run::<2>(&scene);
    let rows = outcome.column("y").iter().zip(outcome.column("velocity_x"));
    let pairs: Vec<(f64, f64)> = rows.map(|(y, v)| (*v, sheared(0.1, 0.1, *y, time))).collect();
    pairs.iter().map(|(v, x)| (v - x).abs()).sum::<f64>()
        / pairs.iter().map(|(_, x)| x.abs()).sum::<f64>()
}

#[test]
fn a_layer_on_a_wall_without_slip_is_sheared() {
    let [coarse, fine] = [0.01, 0.005].map(|cell| shear_error(cell, default_solid(), "no_slip"));
    at_most("fine", fine, 0.004);
    assert!((coarse / fine).log2() > 1.5, "{coarse} {fine}");
    for (shape, transfer, bound) in [("gimp", "flip", 0.04), ("cpdi", "apic", 0.02)] {
        let method = json!({"shape": shape, "transfer": transfer});
        at_most(transfer, shear_error(0.01, method, "no_slip"), bound);
    }
    assert!(shear_error(0.01, default_solid(), "wall") > 1.0);
}

/// A block on a wall that slopes, for a time that Coulomb's law is exact for: means of position
/// and velocity along the wall.
fn block(method: Value, gravity: [f64; 2], speed: f64) -> Outcome<2> {
    let mut scene = column(0.01, method, json!({"friction": 0.3}), gravity);
    scene["domain"]["upper"] = json!([0.8, 0.08]);
    scene["bodies"][0]["box"] = json!({"lower": [0.1, 0.0], "upper": [0.3, 0.04]});
    scene["bodies"][0]["velocity"] = json!([speed, 0.0]);
    scene["boundary"] = json!({"y_lower": {"friction": 0.3}});
    run::<2>(&scene)
}

fn on_slope(tangent: f64) -> [f64; 2] {
    let angle = f64::atan(tangent);
    [10.0 * angle.sin(), -10.0 * angle.cos()]
}

/// A transfer that takes the bouncing of a body that has been dropped on the wall.
#[test]
fn a_block_slides_and_sticks_by_coulombs_law() {
    let damped = || json!({"shape": "gimp", "transfer": "pic"});
    let slides = block(damped(), [0.0, -10.0], 1.0).mean("velocity_x");
    at_most("mu g", (1.0 - slides) / (0.3 * 10.0 * 0.1) - 1.0, 0.002);
    let rests = block(damped(), on_slope(0.25), 0.0);
    at_most("at rest", rests.mean("velocity_x"), 1e-6);
    let [along, down] = on_slope(0.4);
    let exact = (along + 0.3 * down) * 0.1;
    at_most("down", block(damped(), on_slope(0.4), 0.0).mean("velocity_x") / exact - 1.0, 0.02);
}

#[test]
fn friction_on_a_wall_keeps_energy_and_momentum() {
    for method in [
        default_solid(),
        json!({
            "shape": "cpdi_bspline_quadratic", "transfer": "flip", "stepping": "midpoint",
            "energy": "compatible"
        }),
        json!({
            "shape": "bspline_quadratic", "transfer": {"flip_pic": 0.9}, "stepping": "midpoint",
            "energy": "compatible", "filter_heat": true
        }),
    ] {
        let what = method["transfer"].to_string();
        let mut scene = column(0.01, method, json!({"friction": 0.3}), [0.0, -10.0]);
        scene["bodies"][0]["velocity"] = json!([1.0, 0.0]);
        let outcome = run::<2>(&scene);
        at_most(&what, outcome.unbooked_energy(), 1e-12);
        let momentum = outcome.totals[0].momentum[0];
        at_most(&what, outcome.unbooked_momentum(0) / momentum, 1e-12);
        // a layer neither rocks nor lifts, so that all of it presses
        let slowed = 1.0 - outcome.mean("velocity_x");
        at_most(&what, slowed / (0.3 * 10.0 * 0.1) - 1.0, 0.02);
        // what it lost is heat: of motion along the wall, more than of strain
        assert!(outcome.totals[1].internal > 0.9 * (0.5 - 0.5 * 0.49) * outcome.totals[0].mass);
    }
}

/// All sides serve alike: a run is turned by a quarter, and by half.
#[test]
fn every_side_serves_alike() {
    for side in [json!("no_slip"), json!({"friction": 0.3}), json!("transmitting")] {
        let turned = |quarters: usize| {
            let vector = |x: f64, y: f64| match quarters {
                0 => [x, y],
                1 => [0.4 - y, x],
                2 => [0.4 - x, 0.4 - y],
                _ => [y, 0.4 - x],
            };
            let part = |lower: f64, upper: f64| {
                let corners = [vector(0.06, lower), vector(0.26, upper)];
                let end = |f: fn(f64, f64) -> f64| -> Vec<f64> {
                    (0..2).map(|a| f(corners[0][a], corners[1][a])).collect()
                };
                json!({"lower": end(f64::min), "upper": end(f64::max)})
            };
            let velocity = [(1.0, -0.5), (0.5, 1.0), (-1.0, 0.5), (-0.5, -1.0)][quarters];
            let mut scene = column(0.01, default_solid(), "free", [0.0; 2]);
            scene["domain"]["upper"] = json!([0.4, 0.4]);
            // a part at rest, and one that pushes it
            scene["bodies"][0]["box"] = part(0.0, 0.05);
            let mut other = scene["bodies"][0].clone();
            other["name"] = json!("other");
            other["box"] = part(0.05, 0.1);
            other["velocity"] = json!([velocity.0, velocity.1]);
            scene["bodies"].as_array_mut().unwrap().push(other);
            let name = ["y_lower", "x_upper", "y_upper", "x_lower"][quarters];
            scene["boundary"] = json!({name: side});
            scene["time"]["end"] = json!(5e-3);
            let outcome = run::<2>(&scene);
            let rows = outcome.column("x").iter().zip(outcome.column("y"));
            let pressure = rows.zip(outcome.column("pressure")).map(|((x, y), p)| {
                let [x, y] = match quarters {
                    0 => [*x, *y],
                    1 => [*y, 0.4 - *x],
                    2 => [0.4 - *x, 0.4 - *y],
                    _ => [0.4 - *y, *x],
                };
                [x, y, *p]
            });
            let mut pressure: Vec<[f64; 3]> = pressure.collect();
            let cell = |x: f64| (x / 1e-3) as i64;
            pressure.sort_by_key(|[x, y, _]| (cell(*x), cell(*y)));
            pressure
        };
        let first = turned(0);
        let scale = first.iter().fold(0.0f64, |m, r| m.max(r[2].abs()));
        for quarters in 1..4 {
            for (a, b) in first.iter().zip(turned(quarters)) {
                at_most(&side.to_string(), a[0] - b[0], 1e-9);
                at_most(&side.to_string(), (a[2] - b[2]) / scale, 1e-7);
            }
        }
    }
}

/// A block thrown at a wall slantwise loses along it the coefficient times what it loses across
/// it, as long as all of it slides: to rounding for transfers of lumped masses. With a filter some
/// nodes of the wall pull in the first steps, and have no friction.
#[test]
fn a_block_thrown_at_a_wall_is_slowed_by_coulombs_law() {
    for (shape, transfer, stepping, lumping) in [
        ("bspline_cubic", json!("pic"), "leapfrog", None),
        ("bspline_cubic", json!("flip"), "midpoint", None),
        ("cpdi_bspline_quadratic", json!("flip"), "leapfrog", None),
        ("cpdi_bspline_quadratic", json!("apic"), "leapfrog", None),
        ("bspline_cubic", json!("apic"), "midpoint", None),
        ("cpdi_bspline_quadratic", json!({"xpic": 2}), "leapfrog", None),
        ("bspline_quadratic", json!({"fmpm": 2}), "midpoint", None),
        ("cpdi_bspline_quadratic", json!({"fmpm": 4}), "midpoint", None),
        ("cpdi_bspline_quadratic", json!({"fmpm": 4}), "midpoint", Some(0.3)),
    ] {
        let what = format!("{shape} {transfer} {stepping} {lumping:?}");
        let method = json!({"shape": shape, "transfer": &transfer, "stepping": stepping,
            "mass_lumping": lumping});
        let mut scene = column(0.01, method, json!({"friction": 0.3}), [0.0; 2]);
        scene["domain"]["upper"] = json!([0.8, 0.2]);
        scene["bodies"][0]["box"] = json!({"lower": [0.1, 0.0], "upper": [0.3, 0.04]});
        scene["bodies"][0]["velocity"] = json!([10.0, -3.0]);
        scene["boundary"] = json!({"y_lower": {"friction": 0.3}});
        scene["time"]["end"] = json!(4e-4);
        let [start, end] = run::<2>(&scene).totals.map(|t| t.momentum);
        let [along, across] = [0, 1].map(|a| end[a] - start[a]);
        assert!(across > 0.1 * start[1].abs(), "{what}: {across}");
        let filters = transfer.is_object();
        at_most(&what, along / (0.3 * across) + 1.0, if filters { 1e-5 } else { 1e-9 });
    }
}

/// A gas at rest within a round wall: what drives it is what the particles' sum misses of the
/// integrals over their cells, of second order in their size.
#[test]
fn a_gas_within_a_round_wall_stays_at_rest() {
    for shape in ["bspline_cubic", "cpdi_bspline_quadratic"] {
        let [coarse, fine] = [4, 8].map(|count| {
            let corner = |x: f64| json!([x, 0.02]);
            let outcome = run::<2>(&json!({
                "title": "a gas at rest",
                "domain": {
                    "lower": [0.1, 0.0], "upper": corner(0.2), "cell_size": 0.01,
                    "geometry": "axisymmetric"
                },
                "time": {"end": 3e-5},
                "method": {"shape": shape, "transfer": "flip"},
                "materials": {"gas": {"density": 1.0, "eos": {"type": "ideal_gas", "gamma": 1.4}}},
                "bodies": [{
                    "name": "gas", "material": "gas", "velocity": [0.0, 0.0], "pressure": 1e5,
                    "particles_per_cell": [count, 2],
                    "box": {"lower": [0.1, 0.0], "upper": corner(0.2)}
                }],
                "boundary": {
                    "x_lower": "wall", "x_upper": "wall", "y_lower": "symmetry",
                    "y_upper": "symmetry"
                }
            }));
            let speed = outcome.column("velocity_x").iter().zip(outcome.column("x"));
            // by the speed of sound, in the outer half
            speed.filter(|(_, x)| **x > 0.15).fold(0.0f64, |m, (v, _)| m.max(v.abs())) / 374.2
        });
        at_most(shape, fine, 1e-4);
        assert!(fine < 0.3 * coarse, "{shape}: {fine:e} of {coarse:e}");
    }
}

#[test]
fn sides_that_are_refused() {
    let message = |scene: &Value, fragments: &[&str]| {
        let text = scene.to_string();
        let error = input::parse(text.as_bytes(), "s", &[]).unwrap_err().to_string();
        for fragment in fragments {
            assert!(error.contains(fragment), "{error}\nhas no {fragment}");
        }
    };
    // at 0.45 a shear wave leaves a disturbance that grows
    let mut plane = column(0.01, default_solid(), "transmitting", [0.0; 2]);
    plane["time"]["courant"] = json!(0.45);
    message(&plane, &["time.courant = 0.45", "above 0.4"]);
    let mut line = plates("copper", 1e-3, 1000.0, None);
    for side in [json!("no_slip"), json!({"friction": 0.3})] {
        line["boundary"]["x_upper"] = side;
        message(&line, &["boundary.x_upper = ", "1 number", "allowed: \"wall\""]);
    }
    line["boundary"] = json!({"x_lower": "transmitting"});
    message(&line, &["boundary.x_lower = \"transmitting\"", "no body does", "\"outflow\""]);
    let plane = |side: Value| column(0.01, default_solid(), side, [0.0, -10.0]);
    message(&plane(json!({"friction": -0.1})), &["y_lower.friction = -0.1", "at least 0"]);
    message(&plane(json!({"friction": "rough"})), &["y_lower.friction = \"rough\"", "a number"]);
    message(&plane(json!("no-slip")), &["y_lower = \"no-slip\"", "did you mean \"no_slip\"?"]);
    message(&plane(json!("transmitting")), &["body_force", "\"transmitting\" is not booked"]);
    let mut axis = plane(json!("wall"));
    axis["domain"]["geometry"] = json!("axisymmetric");
    for side in [json!("no_slip"), json!({"friction": 0.3}), json!("transmitting")] {
        axis["boundary"] = json!({"x_lower": side});
        message(&axis, &["boundary.x_lower = ", "axis", "allowed: \"symmetry\""]);
    }
}
