//! Bodies of any shape: their mass, and what is refused.

use std::f64::consts::PI;

use flyer_mpm::input;
use serde_json::{Value, json};

use crate::tools::{checked, impact, run};

fn with_flyer(region: Value) -> Value {
    let target = json!({"box": {"lower": [0.0, 0.0], "upper": [0.0004, 0.0004]}});
    let mut scene = impact([[-0.0006, -0.0002], [0.0006, 0.0006]], [region, target], [0.0, 0.0]);
    scene["time"]["end"] = json!(1e-12);
    scene
}

/// Mass of both bodies at the start.
fn mass(scene: &Value) -> f64 {
    run::<2>(scene).totals[0].mass
}

#[test]
fn a_body_has_the_mass_of_its_shape() {
    let target = 2785.0 * 4e-4 * 4e-4;
    let (centre, r) = ([-0.0003, 0.0002], 1.7e-4);
    let annulus = json!({"centre": centre, "inner": 5e-5, "outer": r});
    let disk = json!({"disk": {"centre": centre, "radius": r}});
    let hole = json!({"disk": {"centre": centre, "radius": 5e-5}});
    for (region, area) in [
        (disk.clone(), PI * r * r),
        (json!({"annulus": annulus}), PI * (r * r - 25e-10)),
        (json!({"difference": [disk, hole]}), PI * (r * r - 25e-10)),
        (json!({"ellipse": {"centre": centre, "radii": [r, 1e-4]}}), PI * r * 1e-4),
    ] {
        let exact = target + 8930.0 * area;
        let mass = mass(&with_flyer(region.clone()));
        assert!((mass / exact - 1.0).abs() < 1e-10, "{region}: {mass:e} {exact:e}");
    }
}

#[test]
fn about_an_axis_masses_are_those_of_rings() {
    let mut scene = with_flyer(json!({"disk": {"centre": [0.0002, -0.0001], "radius": 7e-5}}));
    scene["domain"]["lower"] = json!([0.0, -0.0002]);
    scene["domain"]["geometry"] = json!("axisymmetric");
    scene["boundary"] = json!({"x_lower": "symmetry"});
    let exact = 8930.0 * PI * 49e-10 * 2e-4 + 2785.0 * 16e-8 * 2e-4;
    assert!((mass(&scene) / exact - 1.0).abs() < 1e-10);
}

/// With the flyer about the axis, and nothing else.
fn about_the_axis(region: Value) -> Value {
    let mut scene = with_flyer(region);
    scene["domain"]["lower"] = json!([0.0, -0.0002]);
    scene["domain"]["geometry"] = json!("axisymmetric");
    scene["boundary"] = json!({"x_lower": "symmetry"});
    scene.as_object_mut().unwrap().remove("contact");
    scene["bodies"].as_array_mut().unwrap().truncate(1);
    scene
}

/// Masses are per radian: of a ball 2/3 rho r^3, of a cone rho h r^2 / 6.
#[test]
fn a_body_across_the_axis_is_clipped() {
    let r = 1.3e-4;
    let (inner, disk) = (0.7e-4, json!({"disk": {"centre": [0.0, 1e-5], "radius": r}}));
    let of_sphere = |r: f64| 2.0 / 3.0 * r.powi(3);
    let shell = json!({"centre": [0.0, 1e-5], "inner": inner, "outer": r});
    let spheroid = json!({"centre": [0.0, 0.0], "radii": [r, 1.7e-4]});
    let cone = json!({"vertices": [[-r, 0.0], [r, 0.0], [0.0, 1.5e-4]]});
    let rod = json!({"lower": [-1.25e-4, -1e-4], "upper": [1.25e-4, 1e-4]});
    for (region, volume) in [
        (disk.clone(), of_sphere(r)),
        (json!({"annulus": shell}), of_sphere(r) - of_sphere(inner)),
        (json!({"ellipse": spheroid}), 2.0 / 3.0 * r * r * 1.7e-4),
        (json!({"polygon": cone}), 1.5e-4 * r * r / 6.0),
        (json!({"box": rod}), 2e-4 * 1.25e-4 * 1.25e-4 / 2.0),
        (json!({"rotation": {"angle": 30.0, "about": [0.0, 1e-5], "of": disk}}), of_sphere(r)),
    ] {
        let (mass, exact) = (mass(&about_the_axis(region.clone())), 8930.0 * volume);
        assert!((mass / exact - 1.0).abs() < 1e-10, "{region}: {mass:e} {exact:e}");
    }
    // with its centre off the axis, the part at r > 0 is left
    let off = json!({"disk": {"centre": [3e-5, 0.0], "radius": 1e-4}});
    let scene = checked(&about_the_axis(off));
    assert_eq!(scene.bodies[0].lower[0], 0.0);
    assert!((scene.bodies[0].upper[0] / 1.3e-4 - 1.0).abs() < 1e-12);
}

#[test]
fn a_body_across_planes_of_symmetry_is_clipped() {
    let r = 1.3e-4;
    let mut scene = with_flyer(json!({"disk": {"centre": [0.0, -2e-4], "radius": r}}));
    scene["bodies"].as_array_mut().unwrap().truncate(1);
    scene["domain"]["lower"] = json!([0.0, -0.0002]);
    scene["boundary"] = json!({"x_lower": "symmetry", "y_lower": "symmetry"});
    let exact = 8930.0 * PI * r * r / 4.0;
    assert!((mass(&scene) / exact - 1.0).abs() < 1e-10);
    // a wall is no plane of symmetry
    scene["boundary"]["y_lower"] = json!("wall");
    let error = input::parse(scene.to_string().as_bytes(), "scene.json", &[]).unwrap_err();
    let message = error.to_string();
    assert!(message.contains("outside of the domain: it reaches from -0.00033 to"), "{message}");
    // nor has a body beyond the plane a part inside
    scene["boundary"]["y_lower"] = json!("symmetry");
    scene["bodies"][0]["disk"]["centre"] = json!([0.0, -5e-4]);
    let error = input::parse(scene.to_string().as_bytes(), "scene.json", &[]).unwrap_err();
    assert!(error.to_string().contains("outside of the domain"), "{error}");
}

#[test]
fn positions_become_tiles() {
    let mut scene = with_flyer(json!({"box": {"lower": [-0.0002, 0.0], "upper": [0.0, 0.0002]}}));
    let flyer = &mut scene["bodies"][0];
    flyer["particles_per_cell"] = Value::Null;
    let points: Vec<[f64; 2]> = (0..50)
        .map(|k| [-0.0002 * ((k * 37 % 50) as f64 + 0.5) / 50.0, 4e-6 * (k as f64 + 0.5)])
        .collect();
    flyer["positions"] = json!(points);
    assert_eq!(checked(&scene).bodies[0].particles, 50);
    let exact = 8930.0 * 4e-8 + 2785.0 * 16e-8;
    assert!((mass(&scene) / exact - 1.0).abs() < 1e-10);
}

#[test]
fn what_makes_no_body_is_refused() {
    let crossing = json!({"polygon": {"vertices": [[-3e-4, 0.0], [-1e-4, 2e-4], [-1e-4, 0.0], [-3e-4, 2e-4]]}});
    let outside = json!({"disk": {"centre": [-0.0005, 0.0], "radius": 2e-4}});
    let overlapping = json!({"disk": {"centre": [-1e-4, 2e-4], "radius": 1.5e-4}});
    let two = json!({"disk": {"centre": [-3e-4, 2e-4], "radius": 1e-4},
                     "box": {"lower": [-2e-4, 0.0], "upper": [0.0, 1e-4]}});
    for (region, words) in [
        (crossing, &["bodies.flyer.polygon.vertices", "allowed"][..]),
        (
            outside,
            &[
                "bodies.flyer.disk = {\"centre\":[-0.0005,0.0],\"radius\":0.0002}",
                "outside of the domain: it reaches from -0.0007 to -0.0003",
                "along x",
                "allowed: -0.0006 to 0.0006",
            ],
        ),
        (overlapping, &["overlaps bodies.", "touch at most"]),
        (
            json!({"half_plane": {"point": [0.0, 0.0], "normal": [1.0, 0.0]}}),
            &["half_plane", "allowed"],
        ),
        (json!({"union": []}), &["bodies.flyer.union", "not empty"]),
        (json!({"union": 5}), &["bodies.flyer.union = 5", "an array"]),
        (json!({}), &["bodies.flyer.box", "missing key", "\"disk\""]),
        (two, &["bodies.flyer.disk", "one region a body"]),
    ] {
        let scene = with_flyer(region);
        let error = input::parse(scene.to_string().as_bytes(), "scene.json", &[]).unwrap_err();
        let text = error.to_string();
        assert!(words.iter().all(|word| text.contains(word)), "{text}");
    }
    let mut scene = with_flyer(json!({"box": {"lower": [-2e-4, 0.0], "upper": [0.0, 1e-4]}}));
    for (path, value, words) in [
        ("/bodies/0/velocity", json!([1.0]), &["bodies.flyer.velocity", "2 numbers"][..]),
        ("/bodies/0/particles_per_cell", json!([2]), &["particles_per_cell", "2 numbers"]),
        ("/domain/geometry", json!("axisymmetric"), &["domain.lower", "crosses the axis"]),
        ("/domain/geometry", json!("spherical"), &["domain.geometry", "plane_strain"]),
    ] {
        let before = scene.pointer(path).cloned();
        match scene.pointer_mut(path) {
            Some(place) => *place = value,
            None => scene["domain"]["geometry"] = value,
        }
        let error = input::parse(scene.to_string().as_bytes(), "scene.json", &[]).unwrap_err();
        assert!(words.iter().all(|word| error.to_string().contains(word)), "{error}");
        match before {
            Some(before) => *scene.pointer_mut(path).unwrap() = before,
            None => {
                scene["domain"].as_object_mut().unwrap().remove("geometry");
            }
        }
    }
}
