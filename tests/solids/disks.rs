//! Two elastic disks that collide, at half the resolution of the shipped scene.

use serde_json::{Value, json};

use crate::tools::{Outcome, at_most, run, shipped};

fn collide(contact: Value) -> Outcome<2> {
    let mut value = shipped("disks.json");
    value["domain"]["cell_size"] = json!(0.02);
    value["contact"] = contact;
    run::<2>(&value)
}

/// Rows of the disk below the diagonal, and of the other one in the order of its mirror image.
fn halves(outcome: &Outcome<2>) -> [Vec<usize>; 2] {
    let (x, y) = (outcome.column("x"), outcome.column("y"));
    let order = |body: u32, place: &dyn Fn(f64) -> f64| {
        let mut rows: Vec<_> = (0..x.len()).filter(|&r| outcome.last.body[r] == body).collect();
        let key = |at: f64| (1e7 * place(at)).round() as i64;
        rows.sort_by_key(|&r| (key(x[r]), key(y[r])));
        rows
    };
    [order(0, &|at| at), order(1, &|at| 1.0 - at)]
}

#[test]
fn disks_part_as_mirror_images() {
    for contact in [json!(null), json!({"type": "frictionless"})] {
        let outcome = collide(contact.clone());
        let what = contact.to_string();
        at_most(&what, outcome.energy_drift(), 1e-12);
        let [below, above] = halves(&outcome);
        assert_eq!(below.len(), above.len());
        for (name, sign, sum) in [
            ("x", -1.0, 1.0),
            ("y", -1.0, 1.0),
            ("velocity_x", -1.0, 0.0),
            ("velocity_y", -1.0, 0.0),
            ("stress_xx", 1.0, 0.0),
            ("stress_xy", 1.0, 0.0),
            ("density", 1.0, 0.0),
            ("specific_internal_energy", 1.0, 0.0),
        ] {
            let (values, scale) = (outcome.column(name), outcome.greatest(name));
            for (&a, &b) in below.iter().zip(&above) {
                let apart = values[a] - (sum + sign * values[b]);
                at_most(&format!("{what}: {name}"), apart / scale, 1e-9);
            }
        }
        // they fly back, most of their motion kept
        let u = outcome.column("velocity_x");
        let mean = below.iter().map(|&r| u[r]).sum::<f64>() / below.len() as f64;
        assert!((-0.1..-0.07).contains(&mean), "{what}: {mean}");
        // and there is no turning
        let (x, y, v) = (outcome.column("x"), outcome.column("y"), outcome.column("velocity_y"));
        let mass = |r: usize| outcome.column("density")[r] * outcome.column("volume")[r];
        let turn = |r: usize| mass(r) * ((x[r] - 0.5) * v[r] - (y[r] - 0.5) * u[r]);
        let scale = outcome.totals[0].absolute_momentum * 0.2;
        at_most(&what, (0..x.len()).map(turn).sum::<f64>() / scale, 1e-12);
        at_most(&what, outcome.momentum_drift(scale), 1e-12);
    }
}
