//! Each equation of state driven at one point along a given path, against an integration of its
//! own: the formulas are written again here, the energy goes by the Runge-Kutta rule.

use flyer_mpm::material::constitutive::{ConstitutiveModel, VolumeChange, build};
use flyer_mpm::scene::Material;

use crate::bounds::effects as bounds;
use crate::table::Table;

/// Volume ratio along the path, t from 0 to 1: down by `depth`, and back to a little more than 1.
fn path(depth: f64, t: f64) -> f64 {
    1.0 - depth * (std::f64::consts::PI * t).sin() + 0.01 * t
}

/// Steps of the model, as many as a shock's rise and release take.
const STEPS: usize = 400;

/// Largest difference of pressure along the path, of the greatest pressure.
fn apart(
    material: &str,
    depth: f64,
    history: f64,
    p: &dyn Fn(f64, f64, &mut f64) -> f64,
) -> Option<f64> {
    let material: Material = serde_json::from_str(material).ok()?;
    let ConstitutiveModel::Fluid(model) = build(&material) else { return None };
    let rho0 = material.density;
    let e0 = model.energy_at(0.0);
    let (mut energy, mut pressure, mut z) = ([e0], [0.0], [history]);
    let mut speed = [0.0];
    let has_history = model.first_history().is_some();
    model.refresh(&[1.0], &energy, has_history.then_some(&mut z[..]), &mut pressure, &mut speed);
    let (mut e, mut own) = (e0, history);
    let (mut most, mut greatest) = (0.0f64, 0.0f64);
    for k in 0..STEPS {
        let at = |k: f64| path(depth, k / STEPS as f64);
        let (from, to) = (at(k as f64), at(k as f64 + 1.0));
        let before = z;
        model.change_volume(VolumeChange {
            mass: &[rho0],
            volume0: &[1.0],
            before: &[from],
            after: &[to],
            q: None,
            history: has_history.then_some(&before[..]),
            pressure: &mut pressure,
            energy: &mut energy,
        });
        let history = has_history.then_some(&mut z[..]);
        if model.refresh(&[to], &energy, history, &mut pressure, &mut speed).is_some() {
            return None;
        }
        // ten steps of the Runge-Kutta rule for each of the model's
        for s in 0..10 {
            let j = |part: f64| at(k as f64 + (f64::from(s) + part) / 10.0);
            let slope = |part: f64, e: f64, own: f64| -p(j(part), e, &mut own.clone()) / rho0;
            let (first, half, last) = (j(0.0), j(0.5), j(1.0));
            let h = last - first;
            let a = slope(0.0, e, own);
            let b = slope(0.5, e + (half - first) * a, own);
            let c = slope(0.5, e + (half - first) * b, own);
            let d = slope(1.0, e + h * c, own);
            e += h / 6.0 * (a + 2.0 * (b + c) + d);
            p(last, e, &mut own);
        }
        let exact = p(to, e, &mut own.clone());
        most = most.max((pressure[0] - exact).abs());
        greatest = greatest.max(exact.abs());
    }
    Some(most / greatest)
}

/// Mie-Grueneisen copper about its own Hugoniot.
fn copper(j: f64, e: f64) -> f64 {
    let chi = 1.0 - j;
    let stiffness = 8930.0 * 3940.0 * 3940.0;
    if chi <= 0.0 {
        return stiffness * chi + 1.96 * 8930.0 * e;
    }
    let ph = stiffness * chi / (1.0 - 1.489 * chi).powi(2);
    ph + 1.96 * 8930.0 * (e - ph * chi / (2.0 * 8930.0))
}

/// The distension by halving, and the pressure.
fn crushed(j: f64, e: f64, alpha: &mut f64) -> f64 {
    let p = |a: f64| copper(j * 1.25 / a, e) / a;
    let curve = |a: f64| 1.6e9 - 1.5e9 * ((a - 1.0) / 0.25).sqrt();
    if p(*alpha) > curve(*alpha) {
        let (mut low, mut high) = (1.0, *alpha);
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if p(middle) > curve(middle) { high = middle } else { low = middle }
        }
        *alpha = if p(1.0) >= 1.6e9 { 1.0 } else { high };
    }
    p(*alpha)
}

/// Mie-Grueneisen with a curved Us-up line, by Newton's rule for up, and Gamma constant.
fn curved(j: f64, e: f64) -> f64 {
    let (rho0, c0, s, s2, gamma0) = (2785.0, 5386.0, 1.339, 3e-5, 2.1);
    let chi = 1.0 - j;
    if chi <= 0.0 {
        return rho0 * c0 * c0 * chi + gamma0 * rho0 / j * e;
    }
    let mut up = chi * c0;
    for _ in 0..60 {
        up = chi * (c0 + s * up + s2 * up * up);
    }
    let ph = rho0 * up * up / chi;
    ph + gamma0 * rho0 / j * (e - 0.5 * up * up)
}

fn tillotson(j: f64, e: f64) -> f64 {
    let (a, b, big_a, big_b) = (0.5, 1.63, 75.2e9, 65e9);
    let (rho, eta) = (2700.0 / j, 1.0 / j);
    let mu = eta - 1.0;
    let w = e / (5e6 * eta * eta) + 1.0;
    let cold = (a + b / w) * rho * e + big_a * mu + big_b * mu * mu;
    if eta >= 1.0 || e <= 3e6 {
        return cold;
    }
    let z = 1.0 / eta - 1.0;
    let hot =
        a * rho * e + (b * rho * e / w + big_a * mu * (-5.0 * z).exp()) * (-5.0 * z * z).exp();
    if e >= 13.9e6 { hot } else { ((e - 3e6) * hot + (13.9e6 - e) * cold) / 10.9e6 }
}

fn jwl(v: f64, e: f64) -> f64 {
    let (a, b, r1, r2, w) = (371.2e9, 3.231e9, 4.15, 0.95, 0.3);
    a * (1.0 - w / (r1 * v)) * (-r1 * v).exp()
        + b * (1.0 - w / (r2 * v)) * (-r2 * v).exp()
        + w * 1630.0 * e / v
}

/// Tillotson's equation without vapour, smooth in density and energy.
fn cold(j: f64, e: f64) -> f64 {
    let (rho, eta) = (2700.0 / j, 1.0 / j);
    let (w, mu) = (e / (5e6 * eta * eta) + 1.0, eta - 1.0);
    (0.5 + 1.63 / w) * rho * e + 75.2e9 * mu + 65e9 * mu * mu
}

/// The scene's material of that equation's table, at 41 densities and 31 energies; what lies between
/// them is for the material to find.
fn table_of_tillotson() -> String {
    let between = |count: usize, from: f64, to: f64| -> Vec<f64> {
        (0..=count).map(|k| from + (to - from) * k as f64 / count as f64).collect()
    };
    let (density, energy) = (between(40, 2500.0, 4900.0), between(30, -1e5, 8e6));
    let pressure: Vec<Vec<f64>> =
        density.iter().map(|rho| energy.iter().map(|e| cold(2700.0 / rho, *e)).collect()).collect();
    serde_json::json!({
        "density": 2700.0,
        "eos": {"type": "tabular", "table": {
            "density": density, "specific_internal_energy": energy, "pressure": pressure}}
    })
    .to_string()
}

/// All of them.
pub fn check(table: &mut Table) {
    mie_gruneisen(table);
    liquids(table);
    others(table);
    table_and_pores(table);
}

fn row(table: &mut Table, name: &str, material: &str, depth: f64, p: &dyn Fn(f64, f64) -> f64) {
    let value = apart(material, depth, 0.0, &|j, e, _| p(j, e));
    table.check(&format!("{name} along a path"), value, bounds::paths::PRESSURE);
}

fn mie_gruneisen(table: &mut Table) {
    row(
        table,
        "mie_gruneisen",
        r#"{"density": 8930.0, "eos": {"type": "mie_gruneisen", "c0": 3940.0, "s": 1.489, "gamma0": 1.96}}"#,
        0.25,
        &copper,
    );
    row(
        table,
        "mie_gruneisen, s2 and Gamma constant",
        r#"{"density": 2785.0, "eos": {"type": "mie_gruneisen", "c0": 5386.0, "s": 1.339, "s2": 3e-5, "gamma0": 2.1, "gruneisen": "gamma_constant"}}"#,
        0.25,
        &curved,
    );
    row(
        table,
        "mie_gruneisen with a cutoff",
        r#"{"density": 8930.0, "eos": {"type": "mie_gruneisen", "c0": 3940.0, "s": 1.489, "gamma0": 1.96, "tension_cutoff": 2e8}}"#,
        -0.1,
        &|j, e| copper(j, e).max(-2e8),
    );
}

fn liquids(table: &mut Table) {
    row(
        table,
        "stiffened_gas",
        r#"{"density": 1000.0, "eos": {"type": "stiffened_gas", "gamma": 4.4, "p_inf": 6e8}}"#,
        0.3,
        &|j, e| {
            // its own energy, from the vacuum's end
            3.4 * 1000.0 / j * (e + 4.4 * 6e8 / (3.4 * 1000.0)) - 4.4 * 6e8
        },
    );
    row(
        table,
        "tait",
        r#"{"density": 1000.0, "eos": {"type": "tait", "bulk_modulus": 2.1e9, "exponent": 7.0}}"#,
        0.2,
        &|j, _| 3e8 * (j.powi(-7) - 1.0),
    );
    row(
        table,
        "noble_abel_stiffened_gas",
        r#"{"density": 1057.0, "eos": {"type": "noble_abel_stiffened_gas", "gamma": 1.19, "p_inf": 7028e5, "covolume": 6.61e-4}}"#,
        0.1,
        &|j, e| {
            let (v0, b) = (1.0 / 1057.0, 6.61e-4);
            0.19 * (e + 1.19 * 7028e5 * (v0 - b) / 0.19) / (j * v0 - b) - 1.19 * 7028e5
        },
    );
}

fn others(table: &mut Table) {
    row(
        table,
        "vinet",
        r#"{"density": 8930.0, "eos": {"type": "vinet", "bulk_modulus": 138.6e9, "bulk_modulus_derivative": 4.96, "gamma0": 1.96}}"#,
        0.3,
        &|j, e| {
            let (eta, z) = (5.94, 1.0 - j.cbrt());
            let growth = (eta * z).exp();
            let cold = 3.0 * 138.6e9 * z / j.powf(2.0 / 3.0) * growth;
            let stored = 9.0 * 138.6e9 / (eta * eta) * (1.0 + (eta * z - 1.0) * growth);
            cold + 1.96 * (8930.0 * e - stored)
        },
    );
    row(
        table,
        "davis_reactants",
        r#"{"density": 1895.0, "eos": {"type": "davis_reactants", "a": 1800.0, "b": 4.6, "c": 0.34, "gamma0": 0.56, "z": 0.3}}"#,
        0.3,
        &|j, e| {
            let (y, k) = (1.0 - j, 18.4);
            let scale = 1895.0 * 1800.0f64.powi(2) / k;
            let u: f64 = k * y;
            let p =
                u + u * u / 2.0 + u.powi(3) / 6.0 + 0.34 * u.powi(4) / 24.0 + (y / j / j).powi(2);
            let stored =
                (u * u / 2.0 + u.powi(3) / 6.0 + u.powi(4) / 24.0 + 0.34 * u.powi(5) / 120.0) / k
                    + (y / j).powi(3) / 3.0;
            scale * p + (0.56 + 0.3 * y) / j * (1895.0 * e - scale * stored)
        },
    );
    row(
        table,
        "tillotson",
        r#"{"density": 2700.0, "eos": {"type": "tillotson", "a": 0.5, "b": 1.63, "bulk_modulus": 75.2e9, "second_modulus": 65e9, "alpha": 5.0, "beta": 5.0, "e0": 5e6, "e_iv": 3e6, "e_cv": 13.9e6}}"#,
        0.4,
        &tillotson,
    );
    row(
        table,
        "jwl",
        r#"{"density": 1630.0, "eos": {"type": "jwl", "a": 371.2e9, "b": 3.231e9, "r1": 4.15, "r2": 0.95, "omega": 0.3, "energy": 7e9, "burn": "complete"}}"#,
        -3.0,
        &jwl,
    );
}

fn table_and_pores(table: &mut Table) {
    let value = apart(&table_of_tillotson(), 0.4, 0.0, &|j, e, _| cold(j, e));
    table.check("tabular along a path", value, bounds::paths::PRESSURE);
    let porous = r#"{"density": 7144.0, "eos": {"type": "p_alpha", "solid": {"type": "mie_gruneisen", "c0": 3940.0, "s": 1.489, "gamma0": 1.96}, "solid_density": 8930.0, "elastic_pressure": 1e8, "full_compaction_pressure": 1.6e9}}"#;
    for (name, depth) in [("p_alpha, half crushed", 0.12), ("p_alpha, crushed whole", 0.3)] {
        let value = apart(porous, depth, 1.25, &crushed);
        table.check(&format!("{name}, along a path"), value, bounds::paths::PRESSURE);
    }
}
