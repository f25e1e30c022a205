//! Tests on one patch with two particles: see [`Fixture`].

use serde_json::{Value, json};

use super::*;
use crate::scene::{Burn, BurnPlane};
use crate::solver::tests::fixture::{Fixture, close};

/// TNT in the cells 3 and 4, lit at 3 m after 0.2 ms by a front of 1000 m/s and a width of 2 m:
/// each point burns in 2 ms.
fn explosive(compression: bool, stepping: &str) -> Fixture<1> {
    let front = json!({"plane": {"point": [3.0], "normal": [1.0]}, "start": 2e-4, "width": 2.0,
        "detonation_velocity": 1000.0, "compression": compression});
    Fixture::new(json!({
        "method": {"stepping": stepping},
        "materials": {"fluid": Value::Null, "tnt": {"library": "tnt", "eos": {"burn": front}}},
        "bodies": [{"name": "body", "material": "tnt", "particles_per_cell": [1],
            "box": {"lower": [3.0], "upper": [5.0]}}],
    }))
}

#[test]
fn the_front_lights_and_burns_at_its_speed() {
    let mut f = explosive(false, "leapfrog");
    close(&f.get("lighting_time"), &[7e-4, 1.7e-3]);
    // at the end of the step, 1.7 ms
    f.time = 1.5e-3;
    f.act(Phase::EndState, 2e-4);
    close(&f.get("burn_fraction"), &[0.5, 0.0]);
    f.time = 2.6e-3;
    f.act(Phase::EndState, 1e-4);
    close(&f.get("burn_fraction"), &[1.0, 0.5]);
    // it never decreases
    f.time = 0.0;
    f.act(Phase::EndState, 1e-4);
    close(&f.get("burn_fraction"), &[1.0, 0.5]);
}

#[test]
fn the_fraction_scales_the_pressure_of_the_products() {
    let mut f = explosive(false, "leapfrog");
    let mut pressure = |fraction: f64| {
        f.set("burn_fraction", &[fraction, 0.0]);
        f.refresh();
        f.get("pressure")
    };
    let (half, whole) = (pressure(0.5), pressure(1.0));
    assert!(whole[0] > 1e9);
    close(&[half[0], half[1]], &[0.5 * whole[0], 0.0]);
}

#[test]
fn at_the_middle_of_the_step_it_has_burnt_for_half_of_it() {
    let mut f = explosive(false, "midpoint");
    f.time = 1.5e-3;
    f.act(Phase::MidState, 2e-4);
    close(&f.get("burn_fraction"), &[0.45, 0.0]);
}

#[test]
fn compression_burns_too() {
    // 1 - V_CJ = p/(rho D^2) of the handbook: 21 GPa, 1630 kg/m3, 6930 m/s
    let consumed = 21e9 / (1630.0 * 6930.0 * 6930.0);
    let mut f = explosive(true, "leapfrog");
    f.set("jacobian", &[1.0 - 0.5 * consumed, 1.0]).act(Phase::EndState, 0.0);
    let fraction = f.get("burn_fraction");
    assert!((fraction[0] - 0.5).abs() < 0.01 && fraction[1] == 0.0, "{fraction:?}");
}

fn front(points: Option<Vec<Vec<f64>>>, plane: Option<BurnPlane>) -> BurnFront {
    BurnFront {
        points,
        plane,
        detonation_velocity: 5000.0,
        width: 1e-3,
        start: 1e-6,
        compression: false,
    }
}

#[test]
fn the_nearest_point_lights() {
    let front = front(Some(vec![vec![0.0, 0.0], vec![1.0, 0.0]]), None);
    let time = |x: f64, y: f64| FrontTimes(&front).lighting_time(&[x, y]);
    assert!((time(0.3, 0.4) - (1e-6 + 0.5 / 5000.0)).abs() < 1e-18);
    assert!((time(0.9, 0.0) - (1e-6 + 0.1 / 5000.0)).abs() < 1e-18);
}

#[test]
fn a_plane_lights_to_both_sides() {
    let plane = BurnPlane { point: vec![0.0, 1.0], normal: vec![0.0, -2.0] };
    let front = Burn::Front(front(None, Some(plane)));
    let time = |y: f64| FrontTimes(front.front().unwrap()).lighting_time(&[7.0, y]);
    assert!((time(1.5) - (1e-6 + 1e-4)).abs() < 1e-18 && time(0.5) == time(1.5));
}

#[test]
fn it_burns_over_the_width() {
    assert_eq!(
        [burnt(0.9, 1.0, 0.5), burnt(1.25, 1.0, 0.5), burnt(2.0, 1.0, 0.5)],
        [0.0, 0.5, 1.0]
    );
}

#[test]
fn an_explosive_that_is_not_burnt_is_active() {
    let mut f = explosive(false, "leapfrog");
    assert_eq!(f.active_cells(), 2);
    f.set("burn_fraction", &[1.0, 0.5]);
    assert_eq!(f.active_cells(), 1);
    f.set("burn_fraction", &[1.0, 1.0]);
    assert_eq!(f.active_cells(), 0);
}
