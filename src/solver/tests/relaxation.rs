//! Relaxation of pressure and volume.

use serde_json::json;

use super::fixture::{Fixture, close};

/// Particles at 3.25 and 3.75 m with pressures 30 and 10 Pa, volume ratios `ratios` at the middle of
/// the step and compliances over them of 1/2, in a frame.
fn pair_in(frame: &str, ratios: [f64; 2]) -> Fixture<1> {
    let method = json!({"stepping": "midpoint", "frame": frame,
        "pressure_relaxation": {"rate": 0.2, "interval": 1}});
    let mut f = Fixture::new(json!({"method": method}));
    f.set("position", &[3.25, 3.75]).set("pressure_mid", &[30.0, 10.0]);
    f.set("jacobian", &ratios).set("jacobian_mid", &ratios);
    f.set("compliance", &ratios.map(|j| 0.5 * j)).solve(0.1);
    f
}

/// Such particles in the updated-Lagrangian frame without compression.
fn pair() -> Fixture<1> {
    pair_in("updated_lagrangian", [1.0; 2])
}

/// exp(x) to third order.
fn growth(x: f64) -> f64 {
    (1.0 + 0.5 * x) / (1.0 - 0.5 * x)
}

/// On the antisymmetric part of a nodal field, (u, -u), the weighted mean is u/4 and K is 3/4: the
/// sum of four terms and the last one.
const SUM: f64 = 4.0 * (1.0 - 0.31640625);
const LAST: f64 = 0.421875;

#[test]
fn the_nodal_pressure_is_a_series_of_four_terms() {
    let f = pair();
    // first terms 3/4 30 + 1/4 10 = 25 and 15 Pa
    close(&f.line("pressure", 3..=4), &[20.0 + 5.0 * SUM, 20.0 - 5.0 * SUM]);
    close(&f.line("pressure_residual", 3..=4), &[5.0 * LAST, -5.0 * LAST]);
    close(&f.line("compliance", 3..=4), &[0.5, 0.5]);
}

#[test]
fn what_the_grid_cannot_represent_is_removed_without_a_change_of_volume_or_energy() {
    let mut f = pair();
    f.set("mass", &[2.0, 4.0]);
    f.run(0.1, |s, _, patch| s.relax(patch, Some(0.2)));
    // N P = 20 +- 5 SUM/2: dV = r w (p - N P)
    let dv = 0.2 * 0.5 * (10.0 - 2.5 * SUM);
    close(&f.get("jacobian"), &[growth(dv), growth(-dv)]);
    // -Pbar dV + r w (N(u P) - (N u) Pbar) with u = +-5 LAST
    let (u, high, low) = (5.0 * LAST, 20.0 + 5.0 * SUM, 20.0 - 5.0 * SUM);
    let mean = [20.0 + 2.5 * SUM, 20.0 - 2.5 * SUM];
    let first = 0.1 * (0.75 * u * high - 0.25 * u * low - 0.5 * u * mean[0]) - mean[0] * dv;
    let second = 0.1 * (0.25 * u * high - 0.75 * u * low + 0.5 * u * mean[1]) + mean[1] * dv;
    close(&f.get("specific_internal_energy"), &[first / 2.0, second / 4.0]);
    close(&[first], &[-second]);
}

#[test]
fn a_relaxation_keeps_the_sum_of_volumes_after_further_compression() {
    // both particles will be compressed to the same ratio, whatever theirs is now
    let ratios = [0.9, 0.6];
    let mut f = pair_in("updated_lagrangian", ratios);
    f.set("mass", &[2.0, 2.0]);
    f.run(0.1, |s, _, patch| s.relax(patch, Some(0.2)));
    let j = f.get("jacobian");
    let changes: Vec<f64> = (0..2).map(|r| (j[r] / ratios[r]).ln()).collect();
    assert!(changes[0] > 0.01 && (changes[0] + changes[1]).abs() < 1e-13, "{changes:?}");
    let e = f.get("specific_internal_energy");
    assert!(e[0].abs() > 0.1 && (e[0] + e[1]).abs() < 1e-13, "{e:?}");
    // the weights 1/2 are as in the other tests: dln J = r w/s (p - N P), here times the ratio
    let change = 0.2 * 0.5 * (10.0 - 2.5 * SUM);
    close(&j, &[0.9 * growth(change), 0.6 * growth(-change)]);
}

#[test]
fn volumes_are_relaxed_to_the_space_inside_a_body() {
    let method = json!({"transfer": {"fmpm": 2}, "stepping": "midpoint", "edge_mask": 0.3,
        "volume_relaxation": 0.5});
    let mut f = Fixture::<1>::new(json!({"method": method}));
    f.set("position", &[3.25, 4.5]).set("velocity_gradient", &[1.0, 1.0]);
    f.scatter(0.1);
    f.set_node("volume", [3], 0.9).set_node("volume", [4], 1.1).set_node("volume", [5], 1.3);
    let mut edge = f.run(0.1, |_, _, patch| patch.clone());
    f.run(0.1, |s, _, patch| s.relax(patch, None));
    // filled by 0.95 and 1.2
    close(&f.get("jacobian"), &[1.0 + 0.5 * (1.0 / 0.95 - 1.0), 1.0 + 0.5 * (1.0 / 1.2 - 1.0)]);
    // not at an edge of the body, where a node is filled by less than 0.8
    std::mem::swap(&mut f.patch, &mut edge);
    f.set_node("volume", [5], 0.7);
    f.run(0.1, |s, _, patch| s.relax(patch, None));
    close(&f.get("jacobian"), &[1.0 + 0.5 * (1.0 / 0.95 - 1.0), 1.0]);
}
