//! Areas and centroids, of whole regions and in boxes, against closed forms.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::super::Moments;
use super::{close, shape};

/// Regions with their area and centroid.
fn known() -> Vec<(&'static str, Value, f64, [f64; 2])> {
    let disk = |x: f64, y: f64, r: f64| json!({"disk": {"centre": [x, y], "radius": r}});
    let lens = 2.0 * PI / 3.0 - 0.75_f64.sqrt();
    let quarter = PI / 4.0;
    let annulus = json!({"annulus": {"centre": [1.0, 2.0], "inner": 1.5, "outer": 2.5}});
    let square = json!({"polygon": {"vertices": [[0.5, 1.5], [1.5, 1.5], [1.5, 2.5], [0.5, 2.5]]}});
    let bite =
        json!({"polygon": {"vertices": [[1.0, -9.0], [9.0, -9.0], [9.0, 13.0], [1.0, 13.0]]}});
    let half = |normal: [f64; 2]| json!({"half_plane": {"point": [0.0, 0.0], "normal": normal}});
    let turned = |angle: f64, of: Value| json!({"rotation": {"angle": angle, "about": [0.0, 0.0], "of": of}});
    let upright = json!({"box": {"lower": [1.0, 2.0], "upper": [4.0, 3.0]}});
    let (sin, cos) = 30.0_f64.to_radians().sin_cos();
    let ellipse = json!({"ellipse": {"centre": [3.0, -1.0], "radii": [2.0, 0.5]}});
    vec![
        ("box", upright.clone(), 3.0, [2.5, 2.5]),
        ("disk", disk(0.3, -0.7, 1.3), PI * 1.69, [0.3, -0.7]),
        ("ellipse", ellipse.clone(), PI, [3.0, -1.0]),
        (
            "triangle",
            json!({"polygon": {"vertices": [[0, 0], [3, 1], [1, 4]]}}),
            5.5,
            [4.0 / 3.0, 5.0 / 3.0],
        ),
        ("annulus", annulus.clone(), 4.0 * PI, [1.0, 2.0]),
        ("annulus less its hole", json!({"difference": [annulus, square]}), 4.0 * PI, [1.0, 2.0]),
        (
            "left half of an annulus",
            json!({"difference": [annulus, bite]}),
            2.0 * PI,
            // (2/3) (R^3 - r^3) 2 / area
            [1.0 - 2.0 / 3.0 * (2.5_f64.powi(3) - 1.5_f64.powi(3)) * 2.0 / (4.0 * PI), 2.0],
        ),
        (
            "lens",
            json!({"intersection": [disk(0.0, 0.0, 1.0), disk(1.0, 0.0, 1.0)]}),
            lens,
            [0.5, 0.0],
        ),
        (
            "lens upright",
            json!({"intersection": [disk(0.0, 0.0, 1.0), disk(0.0, 1.0, 1.0)]}),
            lens,
            [0.0, 0.5],
        ),
        (
            "two disks",
            json!({"union": [disk(0.0, 0.0, 1.0), disk(1.0, 0.0, 1.0)]}),
            2.0 * PI - lens,
            [0.5, 0.0],
        ),
        (
            "touching disks",
            json!({"union": [disk(0.0, 0.0, 1.0), disk(2.0, 0.0, 1.0)]}),
            2.0 * PI,
            [1.0, 0.0],
        ),
        (
            "quarter of a disk",
            json!({"intersection": [disk(0.0, 0.0, 1.0), half([-1.0, 0.0]), half([0.0, -3.0])]}),
            quarter,
            [4.0 / (3.0 * PI); 2],
        ),
        (
            "half-planes alone",
            json!({"intersection": [half([-1.0, 0.0]), half([0.0, -1.0]),
            {"half_plane": {"point": [1.0, 1.0], "normal": [2.0, 1.0]}}]}),
            2.25,
            [0.5, 1.0],
        ),
        (
            "turned box",
            turned(30.0, upright.clone()),
            3.0,
            [2.5 * cos - 2.5 * sin, 2.5 * sin + 2.5 * cos],
        ),
        (
            "box turned twice",
            turned(10.0, turned(20.0, upright)),
            3.0,
            [2.5 * cos - 2.5 * sin, 2.5 * sin + 2.5 * cos],
        ),
        ("turned ellipse", turned(30.0, ellipse), PI, [3.0 * cos + sin, 3.0 * sin - cos]),
        (
            "equal boxes on each other",
            json!({"union": [
            {"box": {"lower": [0.0, 0.0], "upper": [1.0, 1.0]}},
            {"box": {"lower": [0.0, 0.0], "upper": [1.0, 1.0]}},
            {"box": {"lower": [1.0, 0.0], "upper": [2.0, 1.0]}}]}),
            2.0,
            [1.0, 0.5],
        ),
    ]
}

#[test]
fn areas_and_centroids_are_those_of_closed_forms() {
    for (name, json, area, centroid) in known() {
        println!("{name}");
        let shape = shape(json);
        close(shape.area(), area, 1e-13, area);
        for (found, exact) in shape.centroid().into_iter().zip(centroid) {
            close(found, exact, 1e-13, area.sqrt());
        }
    }
}

#[test]
fn boxes_share_a_shape_among_them_whatever_their_size() {
    for (name, json, area, centroid) in known() {
        let shape = shape(json);
        let [lower, upper] = shape.bounds();
        for (size, offset) in [(0.37, 0.1), (0.05, 0.023), (0.011, 0.0)] {
            println!("{name} by {size}");
            let start = lower.map(|x| x - size - offset);
            let counts = [0, 1].map(|d| ((upper[d] - start[d]) / size).ceil() as usize);
            let at = |d: usize, i: usize| start[d] + i as f64 * size;
            let mut sum = Moments::default();
            for (i, j) in (0..counts[0]).flat_map(|i| (0..counts[1]).map(move |j| (i, j))) {
                sum += shape.moments_within([at(0, i), at(1, j)], [at(0, i + 1), at(1, j + 1)]);
            }
            close(sum.area, area, 1e-12, area);
            for (found, exact) in sum.centroid().into_iter().zip(centroid) {
                close(found, exact, 1e-12, area.sqrt());
            }
        }
    }
}

#[test]
fn a_box_on_the_border_holds_what_closed_forms_say() {
    // under y = sqrt(1 - x^2): F(x) = (x y + asin x)/2
    let disk = shape(json!({"disk": {"centre": [0.0, 0.0], "radius": 1.0}}));
    let under = |x: f64| 0.5 * (x * (1.0 - x * x).sqrt() + x.asin());
    let found = disk.moments_within([0.2, 0.5], [0.4, 2.0]).area;
    close(found, under(0.4) - under(0.2) - 0.1, 1e-14, 0.1);
    // a cap of a thousandth of the radius, without differences of nearly equal numbers
    let height = 1.0_f64 - 0.999;
    let chord = (height * 1.999).sqrt();
    let cap = chord.atan2(0.999) - 0.999 * chord;
    close(disk.moments_within([-1.0, 0.999], [1.0, 3.0]).area, cap, 1e-12, cap);
    close(disk.moments_within([-3.0, -3.0], [3.0, 3.0]).area, PI, 1e-14, PI);
    assert_eq!(disk.moments_within([0.8, 0.8], [0.9, 0.9]).area, 0.0);
    assert_eq!(disk.moments_within([1.5, -1.0], [2.0, 1.0]).area, 0.0);
}

#[test]
fn a_small_box_of_a_large_body_is_as_exact() {
    // 1e-4 of the radius, at a point of the border at 40 degrees
    let disk = shape(json!({"disk": {"centre": [0.0, 0.0], "radius": 1.0}}));
    let (y, x) = 40.0_f64.to_radians().sin_cos();
    let (x, y, size) = (x - 3e-5, y - 2e-5, 1e-4);
    let found = disk.moments_within([x, y], [x + size, y + size]).area / (size * size);
    // the same by the midpoint rule, whose error comes from the curvature
    let steps = 100_000;
    let height = |k: usize| {
        let dx = size * (k as f64 + 0.5) / steps as f64;
        // sqrt(1 - (x + dx)^2) - y without a difference of large numbers
        let top = 1.0 - x * x - y * y - dx * (2.0 * x + dx);
        (top / ((1.0 - (x + dx) * (x + dx)).sqrt() + y)).clamp(0.0, size)
    };
    let exact = (0..steps).map(height).sum::<f64>() / (steps as f64 * size);
    close(found, exact, 1e-9, 1.0);
    // its four quarters add up to it
    let half = 0.5 * size;
    let quarter = |i: f64, j: f64| {
        let corner = [x + i * half, y + j * half];
        disk.moments_within(corner, [x + (i + 1.0) * half, y + (j + 1.0) * half]).area
    };
    let sum = quarter(0.0, 0.0) + quarter(0.0, 1.0) + quarter(1.0, 0.0) + quarter(1.0, 1.0);
    close(sum / (size * size), found, 1e-11, 1.0);
}

#[test]
fn bounds_are_tight() {
    let lens = shape(json!({"intersection": [
        {"disk": {"centre": [0.0, 0.0], "radius": 1.0}},
        {"disk": {"centre": [1.0, 0.0], "radius": 1.0}}]}));
    let exact = [[0.0, -0.75_f64.sqrt()], [1.0, 0.75_f64.sqrt()]];
    let turned = shape(json!({"rotation": {"angle": 30, "about": [5.0, 5.0], "of":
        {"ellipse": {"centre": [5.0, 5.0], "radii": [2.0, 1.0]}}}}));
    let (x, y) = (3.25_f64.sqrt(), 1.75_f64.sqrt());
    let ellipse = [[5.0 - x, 5.0 - y], [5.0 + x, 5.0 + y]];
    for (found, exact) in [(lens.bounds(), exact), (turned.bounds(), ellipse)] {
        for (k, d) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            close(found[k][d], exact[k][d], 1e-14, 1.0);
        }
    }
}

#[test]
fn quarter_turns_are_exact() {
    let of = json!({"box": {"lower": [0.1, 0.2], "upper": [0.4, 0.3]}});
    for angle in [90.0, -270.0, 450.0] {
        let turned = json!({"rotation": {"angle": angle, "about": [0.0, 0.0], "of": of}});
        assert_eq!(shape(turned).bounds(), [[-0.3, 0.1], [-0.2, 0.4]]);
    }
}

#[test]
fn points_are_inside_or_not() {
    let ring = shape(json!({"difference": [
        {"annulus": {"centre": [0.0, 0.0], "inner": 1.0, "outer": 2.0}},
        {"rotation": {"angle": 45, "about": [1.5, 0.0],
                      "of": {"box": {"lower": [1.4, -0.1], "upper": [1.6, 0.1]}}}},
        {"half_plane": {"point": [0.0, -1.5], "normal": [0.0, 1.0]}}]}));
    for inside in [[0.0, 1.5], [1.5, 0.15], [1.59, 0.09], [-1.9, 0.0], [0.0, -1.4]] {
        assert!(ring.contains(inside), "{inside:?}");
    }
    for outside in [[0.0, 0.0], [0.9, 0.0], [1.5, 0.13], [1.5, 0.0], [2.1, 0.0], [0.0, -1.6]] {
        assert!(!ring.contains(outside), "{outside:?}");
    }
}
