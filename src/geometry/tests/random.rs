//! Random regions: areas against a count of points, and areas of combinations against each other.

use proptest::prelude::*;
use serde_json::{Value, json};

use super::super::BoundedRegion;
use super::{close, fill, region, sum};
use crate::scene::Region;

/// Boxes, disks, ellipses and triangles near the origin, rotated.
pub(super) fn part() -> impl Strategy<Value = Value> {
    // multiples of 1/8 make borders coincide
    let place = || prop_oneof![(-8..=8).prop_map(|k| f64::from(k) / 8.0), -1.0..1.0];
    let radius = || prop_oneof![(1..=8).prop_map(|k| f64::from(k) / 8.0), 0.05..1.0];
    let angle = prop_oneof![Just(0.0), Just(90.0), Just(45.0), -180.0..180.0];
    (0..4, place(), place(), radius(), radius(), angle).prop_map(|(kind, x, y, a, b, angle)| {
        let of = match kind {
            0 => json!({"box": {"lower": [x - a, y - b], "upper": [x + a, y + b]}}),
            1 => json!({"disk": {"centre": [x, y], "radius": a}}),
            2 => json!({"ellipse": {"centre": [x, y], "radii": [a, b]}}),
            _ => json!({"polygon": {"vertices": [[x, y], [x + a, y], [x, y + b]]}}),
        };
        json!({"rotation": {"angle": angle, "about": [0.25, -0.125], "of": of}})
    })
}

fn area(json: &Value) -> f64 {
    match BoundedRegion::new(&region(json.clone())) {
        Ok(shape) => shape.area(),
        Err(fault) => {
            assert!(fault.reason.starts_with("nothing is left"), "{fault}");
            0.0
        }
    }
}

/// Whether a point is in a region, from the definitions alone.
fn inside(region: &Region, [x, y]: [f64; 2]) -> bool {
    let circle = |centre: &[f64], a: f64, b: f64| {
        ((x - centre[0]) / a).powi(2) + ((y - centre[1]) / b).powi(2) <= 1.0
    };
    match region {
        Region::Box(b) => {
            let within = |d: usize, x: f64| b.lower[d] <= x && x <= b.upper[d];
            within(0, x) && within(1, y)
        }
        Region::Disk(d) => circle(&d.centre, d.radius, d.radius),
        Region::Ellipse(e) => circle(&e.centre, e.radii[0], e.radii[1]),
        Region::Polygon(p) => {
            // convex and counter-clockwise
            let next = p.vertices.iter().cycle().skip(1);
            p.vertices
                .iter()
                .zip(next)
                .all(|(a, b)| (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]) >= 0.0)
        }
        Region::Annulus(a) => {
            circle(&a.centre, a.outer, a.outer) && !circle(&a.centre, a.inner, a.inner)
        }
        Region::HalfPlane(h) => {
            (x - h.point[0]) * h.normal[0] + (y - h.point[1]) * h.normal[1] <= 0.0
        }
        Region::Union(parts) => parts.iter().any(|part| inside(part, [x, y])),
        Region::Intersection(parts) => parts.iter().all(|part| inside(part, [x, y])),
        Region::Difference(parts) => {
            inside(&parts[0], [x, y]) && !parts[1..].iter().any(|part| inside(part, [x, y]))
        }
        Region::Rotation(turn) => {
            let (sin, cos) = (-turn.angle).to_radians().sin_cos();
            let (dx, dy) = (x - turn.about[0], y - turn.about[1]);
            let back = [cos * dx - sin * dy, sin * dx + cos * dy];
            inside(&turn.of, [back[0] + turn.about[0], back[1] + turn.about[1]])
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn areas_of_sets_add_up(a in part(), b in part()) {
        let union = area(&json!({"union": [a, b]}));
        let both = area(&json!({"intersection": [a, b]}));
        let (left, right) =
            (area(&json!({"difference": [a, b]})), area(&json!({"difference": [b, a]})));
        let total = area(&a) + area(&b);
        close(union + both, total, 1e-12, total);
        close(left + both, area(&a), 1e-12, total);
        close(left + both + right, union, 1e-12, total);
    }

    #[test]
    fn areas_of_three_sets_add_up(a in part(), b in part(), c in part()) {
        let of = |op: &str, parts: &[&Value]| json!({op: parts});
        let bc = of("union", &[&b, &c]);
        let union = area(&of("union", &[&a, &bc]));
        let both = area(&of("intersection", &[&a, &bc]));
        let total = area(&a) + area(&b) + area(&c);
        close(union + both, area(&a) + area(&bc), 1e-12, total);
        close(area(&of("difference", &[&a, &b, &c])) + both, area(&a), 1e-12, total);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn areas_are_those_of_counted_points(a in part(), b in part(), c in part()) {
        let json = json!({"difference": [{"union": [a, b]}, c]});
        let region = region(json);
        // the range covers all parts; the points avoid the borders at multiples of 1/8, where
        // either answer would be right
        const LOWER: f64 = -4.0007;
        const UPPER: f64 = 4.0;
        const N: u32 = 500;
        let at = |k: u32| LOWER + (UPPER - LOWER) * (f64::from(k) + 0.5) / f64::from(N);
        let shape = BoundedRegion::new(&region).ok();
        let points = (0..N).flat_map(|i| (0..N).map(move |j| [at(i), at(j)]));
        let (mut counted, mut different) = (0, 0);
        for point in points {
            let inside = inside(&region, point);
            counted += u32::from(inside);
            let contained = shape.as_ref().is_some_and(|shape| shape.contains(point));
            different += u32::from(inside != contained);
        }
        // on a border the two may differ
        prop_assert!(different <= 5, "{different} points");
        let full = (UPPER - LOWER) * (UPPER - LOWER);
        let counted = full * f64::from(counted) / f64::from(N * N);
        close(shape.map_or(0.0, |shape| shape.area()), counted, 0.001, full);
    }

    #[test]
    fn tiles_of_random_regions_are_whole(
        a in part(), b in part(), c in part(), size in 0.05..0.4, x in -0.5..0.5, y in -0.5..0.5
    ) {
        let json = json!({"difference": [{"union": [a, b]}, c]});
        let Ok(shape) = BoundedRegion::new(&region(json)) else { return Ok(()) };
        let tiles = fill(&shape, [x, y], [size, 0.7 * size], [2, 1]);
        let (sum, exact) = (sum(&tiles), shape.area());
        close(sum.area, exact, 1e-10, exact);
        close(sum.first[0], exact * shape.centroid()[0], 1e-10, exact);
        close(sum.first[1], exact * shape.centroid()[1], 1e-10, exact);
    }
}
