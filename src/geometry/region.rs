//! Regions of the plane that bodies fill: shapes and their combinations.
//!
//! Points are arrays of two numbers. [`crate::geometry::BoundedRegion::new`] checks that they have two, and
//! that a region has an area; it can name the position of a fault inside the region.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A region of the plane: an object with one key.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Region {
    /// A box with edges along x and y.
    Box(BoxShape),
    /// A disk.
    Disk(Disk),
    /// An ellipse with its axes along x and y; a rotation tilts it.
    Ellipse(Ellipse),
    /// A polygon.
    Polygon(Polygon),
    /// The area between two circles with the same centre.
    Annulus(Annulus),
    /// One side of a straight line; unbounded unless combined with other regions.
    HalfPlane(HalfPlane),
    /// All points that are in any of the regions.
    Union(#[schemars(length(min = 1))] Vec<Region>),
    /// All points that are in the first region and in none of the others.
    Difference(#[schemars(length(min = 1))] Vec<Region>),
    /// All points that are in each of the regions.
    Intersection(#[schemars(length(min = 1))] Vec<Region>),
    /// A region rotated about a point.
    Rotation(Rotation),
}

/// A disk.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Disk {
    /// Coordinates of the centre [m].
    pub centre: Vec<f64>,
    /// Radius of the disk [m].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub radius: f64,
}

/// An ellipse with its axes along x and y.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ellipse {
    /// Coordinates of the centre [m].
    pub centre: Vec<f64>,
    /// Half axes along x and y [m].
    #[schemars(extend("items" = {"type": "number", "exclusiveMinimum": 0.0}))]
    pub radii: Vec<f64>,
}

/// A polygon whose edges meet only at its vertices.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Polygon {
    /// Vertices [m] in order, clockwise or counter-clockwise; the last is joined to the first.
    #[schemars(length(min = 1))]
    pub vertices: Vec<Vec<f64>>,
}

/// The area between two circles with the same centre.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Annulus {
    /// Coordinates of the common centre of both circles [m].
    pub centre: Vec<f64>,
    /// Radius of the inner circle [m].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub inner: f64,
    /// Radius of the outer circle [m].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub outer: f64,
}

/// The side of a line that the normal points away from.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HalfPlane {
    /// Coordinates of any point on the line [m].
    pub point: Vec<f64>,
    /// Normal that points out of the half-plane, of any length [-].
    pub normal: Vec<f64>,
}

/// A region rotated about a point.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rotation {
    /// Angle of rotation, counter-clockwise [degrees].
    pub angle: f64,
    /// Coordinates of the point about which the region is rotated [m].
    pub about: Vec<f64>,
    /// The region that is rotated.
    pub of: Box<Region>,
}

/// A box.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxShape {
    /// Coordinates of the lower corner, one number per direction [m].
    pub lower: Vec<f64>,
    /// Coordinates of the upper corner, one number per direction, each above that of the lower
    /// corner [m].
    pub upper: Vec<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    fn examples() -> Vec<Value> {
        let disk = json!({"disk": {"centre": [0.0, 0.0], "radius": 1.0}});
        vec![
            json!({"box": {"lower": [0.0, 0.0], "upper": [1.0, 2.0]}}),
            json!({"ellipse": {"centre": [0.0, 0.0], "radii": [1.0, 2.0]}}),
            json!({"polygon": {"vertices": [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]}}),
            json!({"annulus": {"centre": [0.0, 0.0], "inner": 1.0, "outer": 2.0}}),
            json!({"half_plane": {"point": [0.0, 0.0], "normal": [1.0, 0.0]}}),
            json!({"union": [disk, {"intersection": [disk, disk]}]}),
            json!({"difference": [disk, disk, disk]}),
            json!({"rotation": {"angle": 30.0, "about": [0.0, 0.0], "of": disk}}),
            disk,
        ]
    }

    #[test]
    fn regions_are_read_and_written_as_they_stand() {
        for json in examples() {
            let region: Region = serde_json::from_value(json.clone()).unwrap();
            assert_eq!(serde_json::to_value(&region).unwrap(), json);
        }
    }

    #[test]
    fn the_schema_allows_them_and_no_others() {
        let schema = schemars::schema_for!(Region).to_value();
        let validator = jsonschema::validator_for(&schema).unwrap();
        for json in examples() {
            assert!(validator.is_valid(&json), "{json}");
        }
        for json in [
            json!({"sphere": {"centre": [0.0, 0.0], "radius": 1.0}}),
            json!({"disk": {"centre": [0.0, 0.0], "radius": 0.0}}),
            json!({"disk": {"centre": [0.0, 0.0], "radius": 1.0, "height": 1.0}}),
            json!({"union": []}),
            json!({"union": [{"difference": []}]}),
            json!({"rotation": {"angle": 1.0, "about": [0.0, 0.0]}}),
            json!({"disk": {"centre": [0.0, 0.0], "radius": 1.0}, "union": []}),
        ] {
            assert!(!validator.is_valid(&json), "{json}");
            let read = serde_json::from_value::<Region>(json.clone());
            let by_value = ["radius\":0.0", "[]"].iter().any(|v| json.to_string().contains(v));
            assert!(by_value || read.is_err(), "{json}");
        }
    }
}
