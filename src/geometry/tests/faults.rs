//! Invalid regions, and the key that each fault names.

use serde_json::{Value, json};

use super::super::{BoundedRegion, RegionFault};
use super::region;

fn fault(json: Value) -> RegionFault {
    BoundedRegion::new(&region(json)).expect_err("a fault")
}

#[test]
fn each_fault_tells_its_place_and_what_is_allowed() {
    let disk = json!({"disk": {"centre": [0.0, 0.0], "radius": 1.0}});
    let polygon = |vertices: Value| json!({"polygon": {"vertices": vertices}});
    let half = |normal: Value| json!({"half_plane": {"point": [0.0, 0.0], "normal": normal}});
    let turned = |of: &Value| json!({"rotation": {"angle": 5, "about": [0, 0], "of": of}});
    let zero = json!({"disk": {"centre": [0.0, 0.0], "radius": 0.0}});
    for (json, path, reason) in [
        (json!({"box": {"lower": [0, 0], "upper": [1, 0]}}), "box.upper[1]", "above 0.0"),
        (json!({"box": {"lower": [0, 0, 0], "upper": [1, 1, 1]}}), "box.lower", "3 numbers"),
        (zero.clone(), "disk.radius", "no length"),
        (json!({"disk": {"centre": [0], "radius": 1}}), "disk.centre", "allowed: two, x and y"),
        (json!({"disk": {"centre": [0, 1e70], "radius": 1}}), "disk.centre[1]", "out of range"),
        (json!({"ellipse": {"centre": [0, 0], "radii": [1, -1]}}), "ellipse.radii[1]", "no length"),
        (
            json!({"annulus": {"centre": [0, 0], "inner": 2, "outer": 2}}),
            "annulus.inner",
            "allowed: below annulus.outer = 2.0",
        ),
        (
            json!({"annulus": {"centre": [0, 0], "inner": 0, "outer": 2}}),
            "annulus.inner",
            "above 0",
        ),
        (polygon(json!([[0, 0], [1, 0]])), "polygon.vertices", "2 vertices; allowed: three"),
        (polygon(json!([[0, 0], [1, 0], [1]])), "polygon.vertices[2]", "1 numbers"),
        (polygon(json!([[0, 0], [1, 1], [2, 2], [3, 3]])), "polygon.vertices", "no area"),
        (
            polygon(json!([[0, 0], [1, 1], [1, 0], [0, 1]])),
            "polygon.vertices",
            "vertex [0] and from vertex [2]",
        ),
        (polygon(json!([[0, 0], [4, 0], [4, 4], [2, 0], [0, 4]])), "polygon.vertices", "touches"),
        (polygon(json!([[0, 0], [4, 0], [2, 0], [2, 2]])), "polygon.vertices", "touches"),
        (
            polygon(json!([[0, 0], [4, 0], [4, 4], [0, 0]])),
            "polygon.vertices",
            "[3] and [0] are one point",
        ),
        (half(json!([0, 0])), "half_plane.normal", "no direction"),
        (half(json!([1, 0])), "half_plane", "without end"),
        (half(json!([1, 1])), "half_plane", "without end"),
        (json!({"union": [disk, half(json!([0, 1]))]}), "union", "without end"),
        (
            json!({"intersection": [half(json!([1, 0])), half(json!([0, 1]))]}),
            "intersection",
            "without end",
        ),
        (json!({"difference": [half(json!([0, 1])), disk]}), "difference", "without end"),
        (json!({"union": []}), "union", "an empty list"),
        (json!({"difference": []}), "difference", "an empty list"),
        (json!({"union": [disk, {"intersection": []}]}), "union[1].intersection", "an empty list"),
        (json!({"union": [disk, turned(&zero)]}), "union[1].rotation.of.disk.radius", "no length"),
        (json!({"rotation": {"angle": 5, "about": [0], "of": disk}}), "rotation.about", "two"),
        (json!({"difference": [disk, disk]}), "difference", "nothing is left"),
        (json!({"difference": [disk, turned(&turned(&disk))]}), "difference", "nothing is left"),
        (
            json!({"intersection": [half(json!([0, 1])), half(json!([0, -1]))]}),
            "intersection",
            "nothing",
        ),
        (
            json!({"intersection": [disk, {"disk": {"centre": [2.0, 0.0], "radius": 1.0}}]}),
            "intersection",
            "nothing is left",
        ),
    ] {
        let fault = fault(json.clone());
        println!("{fault}");
        assert_eq!(fault.path, path, "{json}");
        assert!(fault.reason.contains(reason), "{json}: {}", fault.reason);
        assert!(fault.reason.contains("allowed: "), "{json}: {}", fault.reason);
    }
}

#[test]
fn numbers_that_are_none_are_reported() {
    let mut disk = region(json!({"disk": {"centre": [0.0, 0.0], "radius": 1.0}}));
    for value in [f64::NAN, f64::INFINITY] {
        if let crate::scene::Region::Disk(disk) = &mut disk {
            disk.radius = value;
        }
        let fault = BoundedRegion::new(&disk).expect_err("a fault");
        assert_eq!(fault.path, "disk.radius");
        assert!(fault.reason.starts_with("out of range; allowed: finite"), "{fault}");
    }
}

#[test]
fn a_fault_is_one_line() {
    let fault = fault(json!({"union": [{"disk": {"centre": [0.0, 0.0], "radius": -1.0}}]}));
    let text = "union[0].disk.radius = -1.0: no length; allowed: above 0, at least 1e-60";
    assert_eq!(fault.to_string(), text);
}
