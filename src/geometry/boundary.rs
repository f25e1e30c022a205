//! The boundary of a region, and its faces near a point.
//!
//! A border of an outline bounds the region only where the region is on one side of it alone:
//! borders inside a union, or outside an intersection, do not count.

use smallvec::SmallVec;

use super::Point;
use super::build;
use super::region::Region;
use super::solid::{Edge, Outline, Solid};

/// Boundary of a region.
pub struct BodyBoundary {
    solid: Solid,
}

/// Tangent of a boundary at its point nearest to another point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundaryFace {
    /// Outward unit normal [-].
    pub normal: [f64; 2],
    /// Distance from the point [m].
    pub distance: f64,
}

/// Offset to both sides of a border at which the region is probed, as a fraction of the greatest
/// distance.
const PROBE: f64 = 1e-4;

/// Least distance of a face, as a fraction of the greatest one.
const LEAST: f64 = 1e-3;

/// Cosine of the least angle between the two faces of a point, if there are more than two.
const DISTINCT: f64 = 0.9;

impl BodyBoundary {
    /// BodyBoundary of a region; `None` if the region is invalid.
    pub fn new(region: &Region) -> Option<Self> {
        build::solid(region).ok().map(|solid| BodyBoundary { solid })
    }

    /// Up to two faces of the boundary within `near` [m] of a point of the region, the nearest
    /// first. The second is the nearest one in another direction, if there is one. Only faces count
    /// whose point nearest to `at` fulfils `accepts`.
    pub fn faces(
        &self,
        at: [f64; 2],
        near: f64,
        accepts: impl Fn([f64; 2]) -> bool,
    ) -> SmallVec<[BoundaryFace; 2]> {
        let mut outlines = Vec::new();
        self.solid.outlines(&mut outlines);
        let mut feet: SmallVec<[Foot; 4]> = SmallVec::new();
        outlines.iter().for_each(|outline| feet_on(outline, at, near, &mut feet));
        let mut faces: SmallVec<[BoundaryFace; 4]> = SmallVec::new();
        for Foot { point, normal } in feet {
            let probe = |side: f64| {
                self.contains([0, 1].map(|a| point[a] + side * PROBE * near * normal[a]))
            };
            let normal = match (probe(1.0), probe(-1.0)) {
                (false, true) => normal,
                (true, false) => normal.map(|n| -n),
                _ => continue,
            };
            let distance: f64 = (0..2).map(|a| normal[a] * (point[a] - at[a])).sum();
            if distance > LEAST * near && distance <= near && accepts(point) {
                faces.push(BoundaryFace { normal, distance });
            }
        }
        faces.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        let Some(&first) = faces.first() else { return SmallVec::new() };
        let cosine =
            |f: &BoundaryFace| f.normal[0] * first.normal[0] + f.normal[1] * first.normal[1];
        let second = faces.iter().skip(1).find(|face| cosine(face) < DISTINCT);
        std::iter::once(first).chain(second.copied()).collect()
    }

    /// Whether a point is in the region.
    fn contains(&self, [x, y]: Point) -> bool {
        let passages = self.solid.section(x);
        passages.iter().filter(|passage| passage.y < y).count() % 2 == 1
    }
}

/// Point of a border nearest to another point, and a unit normal of the border there.
struct Foot {
    point: Point,
    normal: [f64; 2],
}

/// Feet of a point on the borders of an outline, within `near`.
fn feet_on(outline: &Outline, at: Point, near: f64, feet: &mut SmallVec<[Foot; 4]>) {
    match outline {
        Outline::Polygon(edges) => {
            feet.extend(edges.iter().filter_map(|edge| foot_on_edge(edge, at, near)));
        }
        Outline::Ellipse(ellipse) => {
            let (point, normal) = ellipse.nearest(at);
            if (point[0] - at[0]).hypot(point[1] - at[1]) <= near {
                feet.push(Foot { point, normal });
            }
        }
        Outline::HalfPlane { point, normal, .. } => {
            let away: f64 = (0..2).map(|a| normal[a] * (point[a] - at[a])).sum();
            if away.abs() <= near {
                let point = [0, 1].map(|a| at[a] + away * normal[a]);
                feet.push(Foot { point, normal: *normal });
            }
        }
    }
}

/// Foot of a point on an edge; `None` if it lies beyond the ends of the edge.
fn foot_on_edge(edge: &Edge, at: Point, near: f64) -> Option<Foot> {
    let along = [0, 1].map(|a| edge.to[a] - edge.from[a]);
    let length = along[0].hypot(along[1]);
    let offset = [0, 1].map(|a| at[a] - edge.from[a]);
    let normal = [along[1] / length, -along[0] / length];
    let away = offset[0] * normal[0] + offset[1] * normal[1];
    let share = (offset[0] * along[0] + offset[1] * along[1]) / (length * length);
    let is_on = away.abs() <= near && (0.0..=1.0).contains(&share);
    is_on.then(|| Foot { point: [0, 1].map(|a| at[a] - away * normal[a]), normal })
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;

    fn faces(region: Value, at: [f64; 2], near: f64) -> Vec<([f64; 2], f64)> {
        let region: Region = serde_json::from_value(region).unwrap();
        let boundary = BodyBoundary::new(&region).unwrap();
        let found = boundary.faces(at, near, |_| true);
        found.iter().map(|face| (face.normal, face.distance)).collect()
    }

    fn square(lower: [f64; 2], upper: [f64; 2]) -> Value {
        json!({"box": {"lower": lower, "upper": upper}})
    }

    #[test]
    fn a_corner_has_two_faces() {
        let unit = square([0.0, 0.0], [1.0, 1.0]);
        assert_eq!(faces(unit.clone(), [0.5, 0.5], 0.2), []);
        assert_eq!(faces(unit.clone(), [0.5, 0.875], 0.25), [([0.0, 1.0], 0.125)]);
        let corner = faces(unit, [0.875, 0.25], 0.25);
        assert_eq!(corner, [([1.0, 0.0], 0.125), ([0.0, -1.0], 0.25)]);
    }

    #[test]
    fn borders_within_a_union_are_no_faces() {
        let union =
            json!({"union": [square([0.0, 0.0], [1.0, 1.0]), square([1.0, 0.0], [2.0, 1.0])]});
        assert_eq!(faces(union, [0.875, 0.5], 0.25), []);
        let hole =
            json!({"difference": [square([0.0, 0.0], [4.0, 4.0]), square([1.0, 1.0], [2.0, 2.0])]});
        assert_eq!(faces(hole, [0.875, 1.5], 0.25), [([1.0, 0.0], 0.125)]);
    }

    #[test]
    fn curved_faces_have_the_normal_of_the_nearest_point() {
        let disk = json!({"disk": {"centre": [1.0, 2.0], "radius": 2.0}});
        let [(normal, distance)] = faces(disk, [1.0 + 0.6 * 1.9, 2.0 + 0.8 * 1.9], 0.25)[..] else {
            panic!("one face")
        };
        assert!((normal[0] - 0.6).abs() + (normal[1] - 0.8).abs() < 1e-14);
        assert!((distance - 0.1).abs() < 1e-14);
        let ellipse = json!({"rotation": {"angle": 30.0, "about": [0.0, 0.0],
            "of": {"ellipse": {"centre": [0.0, 0.0], "radii": [3.0, 1.0]}}}});
        // on the short half axis
        let [(normal, distance)] = faces(ellipse, [-0.45, 0.45 * 3f64.sqrt()], 0.25)[..] else {
            panic!("one face")
        };
        assert!((normal[0] + 0.5).abs() < 1e-12 && (distance - 0.1).abs() < 1e-12);
    }
}
