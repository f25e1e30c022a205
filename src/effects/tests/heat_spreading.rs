//! Tests on one patch with few particles: see [`Fixture`].

use serde_json::{Value, json};

use crate::solver::effect::Phase;
use crate::solver::tests::fixture::{Fixture, close};

const DT: f64 = 0.01;

fn method(transfer: Value, spreading: bool) -> Value {
    json!({"shape": "cpdi_bspline_quadratic", "transfer": transfer, "stepping": "midpoint",
        "energy": "compatible", "filter_heat": transfer != json!("flip"),
        "heat_spreading": spreading.then(|| json!({"steps": 1}))})
}

/// Particles at 3.5 m and 4.5 m with linear shape functions: each has weights of 1/2 on its two nodes
/// and shares the node at 4 m with the other one.
#[test]
fn energies_follow_the_means_and_their_sum_stays() {
    let mut method = method(json!({"fmpm": 2}), true);
    method["shape"] = json!("linear");
    let mut f = Fixture::<1>::new(json!({"method": method}));
    f.set("mass", &[2.0, 6.0]).set("numerical_heat", &[10.0, 30.0]);
    f.solve(DT).set("specific_internal_energy", &[100.0, 200.0]);
    // means of the nodes at 3, 4 and 5 m: 10, (10 + 90)/(1 + 3) = 25 and 30 J/kg
    f.act(Phase::Gather, DT);
    close(&f.get("specific_internal_energy"), &[100.0 + 17.5 - 10.0, 200.0 + 27.5 - 30.0]);
}

#[test]
fn a_share_of_the_spread_heat_is_spread_again() {
    let mut method = method(json!({"fmpm": 2}), true);
    method["heat_spreading"]["steps"] = json!(4);
    let mut f = Fixture::<1>::new(json!({"method": method}));
    // before the phase the column has the energies without numerical heat
    let mut heat = |without: [f64; 2], spread: [f64; 2]| {
        f.set("numerical_heat", &without).set("specific_internal_energy", &[10.0, 20.0]);
        f.run(DT, |s, _, patch| {
            let column = s.columns.get("spread_heat");
            patch.block.columns[column] = spread.to_vec();
        });
        f.act(Phase::Gathered, DT).get("numerical_heat")
    };
    close(&heat([9.0, 18.0], [4.0, 8.0]), &[1.0 + 0.75 * 4.0, 2.0 + 0.75 * 8.0]);
    // a remainder far below the squares of the speeds of the scene ends
    assert_eq!(heat([10.0, 20.0], [1e-15, 0.0]), [0.0, 0.0]);
    assert!(heat([10.0, 20.0 - 1e-9], [0.0, 0.0])[1] > 0.0);
}

/// Six particles whose velocities the grid does not represent.
fn six(changes: Value) -> Fixture<2> {
    let body = json!({"name": "body", "material": "fluid", "particles_per_cell": [1, 1],
        "box": {"lower": [2.0, 3.0], "upper": [5.0, 5.0]}});
    let mut scene = json!({"bodies": [body]});
    scene.as_object_mut().unwrap().extend(changes.as_object().cloned().unwrap());
    let mut f = Fixture::new(scene);
    f.set("velocity_x", &[0.3, -1.0, 2.0, 0.7, 0.1, -0.4]);
    f.set("velocity_y", &[1.5, 0.2, -0.9, 0.8, -2.0, 0.6]);
    f.set("jacobian", &[0.9, 1.0, 0.95, 1.0, 0.8, 1.0]);
    f
}

/// Kinetic and internal energy of all particles [J].
fn energy(f: &Fixture<2>) -> f64 {
    let of = |name: &str| f.get(name);
    let [m, e, vx, vy] = ["mass", "specific_internal_energy", "velocity_x", "velocity_y"].map(of);
    let spin: Vec<f64> = match f.stepper.columns.spin {
        Some(_) => of("spin").iter().zip(of("spin_inertia")).map(|(b, i)| b * b / i).collect(),
        None => vec![0.0; m.len()],
    };
    (0..m.len()).map(|r| m[r] * (0.5 * (vx[r] * vx[r] + vy[r] * vy[r] + spin[r]) + e[r])).sum()
}

#[test]
fn the_heat_is_the_energy_beyond_the_work_at_the_mean_velocity() {
    for transfer in
        [json!("flip"), json!({"flip_pic": 0.9}), json!({"xpic": 2}), json!({"fmpm": 3})]
    {
        let mut f = six(json!({"method": method(transfer.clone(), true)}));
        let [jacobian, before] = ["jacobian", "specific_internal_energy"].map(|name| f.get(name));
        f.advance(DT);
        let [j, mid, e, heat] =
            ["jacobian", "jacobian_mid", "specific_internal_energy", "numerical_heat"]
                .map(|name| f.get(name));
        let (stress, mass) = (f.get("stress_volume"), f.get("mass"));
        let expected = |r: usize| {
            let work = stress[r] * (j[r] - jacobian[r]) / mid[r];
            e[r] - before[r] + work / mass[r]
        };
        close(&heat, &(0..6).map(expected).collect::<Vec<_>>());
        assert!(heat.iter().any(|heat| heat.abs() > 1e-3), "{transfer}: {heat:?}");
    }
}

/// The velocity gradient l of the step follows from the deformation gradient, F = (1 - dt/2 l)^-1
/// (1 + dt/2 l), and the radial velocity by FLIP from the positions.
#[test]
fn a_tensor_of_stress_works_in_shear_and_around_an_axis() {
    let strength = json!({"type": "von_mises", "shear_modulus": 30.0, "yield_stress": 6.0});
    let fluid = json!({"density": 2.0, "strength": strength,
        "eos": {"type": "tait", "bulk_modulus": 200.0, "exponent": 1.0}});
    for hoop in [false, true] {
        let mut changes =
            json!({"method": method(json!("flip"), true), "materials": {"fluid": fluid}});
        if hoop {
            changes["domain"] = json!({"geometry": "axisymmetric"});
            changes["boundary"] = json!({"x_lower": "symmetry"});
        }
        let mut f = six(changes);
        // the second step has a deviator
        f.advance(DT);
        let spread = f.get("numerical_heat");
        f.set("numerical_heat", &[0.0; 6]);
        let names = ["xx", "xy", "yx", "yy"].map(|name| format!("deformation_{name}"));
        let deformation = |f: &Fixture<2>| names.each_ref().map(|name| f.get(name));
        let first = deformation(&f);
        let [x, u, e] =
            ["position_x", "velocity_x", "specific_internal_energy"].map(|name| f.get(name));
        f.advance(DT);
        let (last, moved, mass) = (deformation(&f), f.get("position_x"), f.get("mass"));
        let stress = ["stress_volume_xx", "stress_volume_yy", "stress_volume_xy"].map(|n| f.get(n));
        let expected = |r: usize| {
            let l = rate(first.each_ref().map(|c| c[r]), last.each_ref().map(|c| c[r]));
            let mut work = stress[0][r] * l[0] + stress[1][r] * l[3] + stress[2][r] * (l[1] + l[2]);
            if hoop {
                let radius = x[r] + 0.5 * DT * u[r];
                work += f.get("stress_volume_zz")[r] * (moved[r] - x[r]) / DT / radius;
            }
            f.get("specific_internal_energy")[r] - e[r] + DT * work / mass[r]
        };
        for (r, heat) in f.get("numerical_heat").into_iter().enumerate() {
            let off = heat - expected(r);
            assert!(off.abs() < 1e-10, "{heat:e}, {off:e} off");
        }
        assert!(spread.iter().any(|heat| heat.abs() > 1e-3), "{spread:?}");
    }
}

/// l of a step from F = [xx, xy, yx, yy] before and after it [1/s].
fn rate(before: [f64; 4], after: [f64; 4]) -> [f64; 4] {
    let inverse = |[a, b, c, d]: [f64; 4]| [d, -b, -c, a].map(|v| v / (a * d - b * c));
    let product = |[a, b, c, d]: [f64; 4], [p, q, r, s]: [f64; 4]| {
        [a * p + b * r, a * q + b * s, c * p + d * r, c * q + d * s]
    };
    let [a, b, c, d] = product(after, inverse(before));
    let l = product([a - 1.0, b, c, d - 1.0], inverse([a + 1.0, b, c, d + 1.0]));
    l.map(|v| 2.0 / DT * v)
}

#[test]
fn energy_stays_and_the_heat_is_spread() {
    let strength = json!({"type": "von_mises", "shear_modulus": 30.0, "yield_stress": 6.0});
    let with = |key: &str, value: Value, spreading: bool| {
        let mut method = method(json!({"fmpm": 4}), spreading);
        method[key] = value;
        json!({"method": method})
    };
    let cases: [&dyn Fn(bool) -> Value; 4] = [
        &|on| with("spin", json!(true), on),
        &|on| with("edge_mask", json!(0.3), on),
        &|on| with("frame", json!("total_lagrangian"), on),
        &|on| {
            let mut scene = with("edge_mask", json!(0.3), on);
            scene["materials"] = json!({"fluid": {"density": 2.0, "strength": strength,
                "eos": {"type": "tait", "bulk_modulus": 200.0, "exponent": 1.0}}});
            scene
        },
    ];
    for (k, scene) in cases.iter().enumerate() {
        let [spread, kept] = [true, false].map(|on| {
            let mut f = six(scene(on));
            let before = energy(&f);
            f.advance(DT).advance(DT).advance(DT);
            let off = energy(&f) - before;
            assert!(off.abs() < 2e-13 * before.abs(), "case {k}: {off:e}");
            let e = f.get("specific_internal_energy");
            e.iter().copied().fold(f64::MIN, f64::max) - e.iter().copied().fold(f64::MAX, f64::min)
        });
        assert!(spread < 0.9 * kept, "case {k}: {spread} of {kept}");
    }
}
