//! Bodies.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::VelocityField;
use crate::geometry::region::{
    Annulus, BoxShape, Disk, Ellipse, HalfPlane, Polygon, Region, Rotation,
};

/// A body: a region of one material, filled with particles. Its region is one of the keys `box`,
/// `disk`, `ellipse`, `polygon`, `annulus`, `half_plane`, `union`, `difference`, `intersection`
/// and `rotation`; on a line it is a `box`.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// Name, unlike that of any other body.
    pub name: String,
    /// Name of its material.
    pub material: String,
    /// A box along the axes, where it lies at the start.
    #[serde(rename = "box", default, skip_serializing_if = "Option::is_none")]
    pub extent: Option<BoxShape>,
    /// A disk.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disk: Option<Disk>,
    /// An ellipse with its axes along x and y.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ellipse: Option<Ellipse>,
    /// A polygon.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub polygon: Option<Polygon>,
    /// What lies between two circles about one centre.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub annulus: Option<Annulus>,
    /// One side of a straight line; alone it has no end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub half_plane: Option<HalfPlane>,
    /// What lies in any of several regions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1))]
    pub union: Option<Vec<Region>>,
    /// What lies in the first of several regions and in none of the others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1))]
    pub difference: Option<Vec<Region>>,
    /// What lies in each of several regions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1))]
    pub intersection: Option<Vec<Region>>,
    /// A region turned about a point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation: Option<Rotation>,
    /// Velocity at the start [m/s]; absent: at rest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity: Option<Vec<f64>>,
    /// Velocity at the start as a function of place, instead of `velocity`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity_field: Option<VelocityField>,
    /// Pressure at the start [Pa], reached at the material's density by its internal energy.
    #[serde(default)]
    pub pressure: f64,
    /// Temperature at the start [K], of a material that has one; absent: that at rest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub temperature: Option<f64>,
    /// Particles a cell in each direction; absent only where `positions` are given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = 1)))]
    pub particles_per_cell: Option<Vec<usize>>,
    /// Where the particles are at the start, instead of a lattice: each gets what of the body is
    /// nearest to it (its Voronoi cell), and stands at that cell's centroid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub positions: Option<Positions>,
}

/// Positions of particles.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Positions {
    /// A CSV file of columns x and y, beside the scene's file.
    File(String),
    /// The positions themselves [m].
    Points(Vec<Vec<f64>>),
}

impl Body {
    /// The body's regions, each with its key; a body that is sound has one.
    pub fn regions(&self) -> Vec<(&'static str, Region)> {
        let all = [
            ("box", self.extent.clone().map(Region::Box)),
            ("disk", self.disk.clone().map(Region::Disk)),
            ("ellipse", self.ellipse.clone().map(Region::Ellipse)),
            ("polygon", self.polygon.clone().map(Region::Polygon)),
            ("annulus", self.annulus.clone().map(Region::Annulus)),
            ("half_plane", self.half_plane.clone().map(Region::HalfPlane)),
            ("union", self.union.clone().map(Region::Union)),
            ("difference", self.difference.clone().map(Region::Difference)),
            ("intersection", self.intersection.clone().map(Region::Intersection)),
            ("rotation", self.rotation.clone().map(Region::Rotation)),
        ];
        all.into_iter().filter_map(|(key, region)| Some((key, region?))).collect()
    }
}
