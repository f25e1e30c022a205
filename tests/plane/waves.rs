//! Plane waves at an angle to the grid, and edge releases.

use flyer_mpm::accuracy::reference::ReferenceSolution;
use serde_json::{Value, json};

use crate::tools::{checked, impact, run};

/// Plates of finite width at an angle to the grid, struck along their normal.
fn plates(angle: f64) -> Value {
    let region = |lower: f64, upper: f64| {
        let extent = json!({"lower": [lower, -0.0012], "upper": [upper, 0.0012]});
        match angle {
            0.0 => json!({"box": extent}),
            _ => json!({"rotation": {"angle": angle, "about": [0.0, 0.0], "of": {"box": extent}}}),
        }
    };
    let (sin, cos) = angle.to_radians().sin_cos();
    let domain = [[-0.0024, -0.0024], [0.0024, 0.0024]];
    let regions = [region(-0.0003, 0.0), region(0.0, 0.0012)];
    let mut scene = impact(domain, regions, [1e3 * cos, 1e3 * sin]);
    scene["domain"]["cell_size"] = json!(4e-5);
    scene["time"]["end"] = json!(1.2e-7);
    let front = json!({"angle": angle, "about": [0.0, 0.0], "half_width": 4e-4});
    scene["reference"] =
        json!({"flyer_impact": {"flyer": "flyer", "target": "target", "front": front}});
    scene
}

#[test]
fn a_wave_at_an_angle_is_as_good_as_one_along_an_axis() {
    let [aligned, oblique] = [0.0, 30.0].map(|angle| {
        let scene = plates(angle);
        let outcome = run::<2>(&scene);
        assert!(outcome.energy_drift().abs() < 1e-12, "{:e}", outcome.energy_drift());
        let checked = checked(&scene);
        let reference = ReferenceSolution::new(&checked).unwrap().unwrap();
        let (raw, cells) = reference.score(&checked, 0, &outcome.table).unwrap();
        (raw.l1.unwrap(), cells.l1.unwrap())
    });
    assert!(aligned.0 < 0.08, "{aligned:?}");
    assert!(oblique.0 < 1.3 * aligned.0 && oblique.1 < 1.3 * aligned.1, "{oblique:?} {aligned:?}");
}

/// Norm of the density's error of Sod's tube at `angle` to cells of 0.02 m.
fn sod(angle: f64) -> f64 {
    let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs/sod_2d.json");
    let mut scene: Value = serde_json::from_slice(&std::fs::read(file).unwrap()).unwrap();
    let (sin, cos) = angle.to_radians().sin_cos();
    for (body, normal) in [(0, [cos, sin]), (1, [-cos, -sin])] {
        scene["bodies"][body]["intersection"][1]["half_plane"]["normal"] = json!(normal);
    }
    scene["reference"]["riemann"]["front"]["angle"] = json!(angle);
    scene["domain"]["cell_size"] = json!(0.02);
    let outcome = run::<2>(&scene);
    assert!(outcome.energy_drift().abs() < 1e-12, "{:e}", outcome.energy_drift());
    let checked = checked(&scene);
    let reference = ReferenceSolution::new(&checked).unwrap().unwrap();
    reference.score(&checked, 0, &outcome.table).unwrap().0.density_l1.unwrap()
}

#[test]
fn a_shock_tube_may_lie_at_any_angle() {
    let [along, oblique, diagonal] = [0.0, 30.0, 45.0].map(sod);
    assert!(along < 0.01, "{along}");
    assert!(oblique < 1.1 * along && diagonal < 1.1 * along, "{oblique} {diagonal} {along}");
}
