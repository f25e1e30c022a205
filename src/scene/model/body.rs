//! Bodies.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::VelocityField;
use crate::geometry::region::{
    Annulus, BoxShape, Disk, Ellipse, HalfPlane, Polygon, Region, Rotation,
};

/// A body: a region of one material, filled with particles. Exactly one of the keys `box`, `disk`,
/// `ellipse`, `polygon`, `annulus`, `half_plane`, `union`, `difference`, `intersection` and
/// `rotation` gives the region; in one dimension it must be `box`.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// Name of the body; no other body may have it.
    pub name: String,
    /// Name of the material of the body, a key of `materials`.
    pub material: String,
    /// An axis-aligned box, at its initial position.
    #[serde(rename = "box", default, skip_serializing_if = "Option::is_none")]
    pub extent: Option<BoxShape>,
    /// A disk, given by centre and radius; in an axisymmetric domain a torus, or a ball if its
    /// centre is on the axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disk: Option<Disk>,
    /// An ellipse with its axes along x and y, given by centre and half axes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ellipse: Option<Ellipse>,
    /// A polygon, given by its vertices.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub polygon: Option<Polygon>,
    /// The region between two circles with the same centre, in a plane.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub annulus: Option<Annulus>,
    /// One side of a straight line. It is unbounded, so it is usable only together with regions
    /// that bound it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub half_plane: Option<HalfPlane>,
    /// All points that are in at least one of the regions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1))]
    pub union: Option<Vec<Region>>,
    /// All points of the first region that are in none of the others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1))]
    pub difference: Option<Vec<Region>>,
    /// All points that are in each of the regions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1))]
    pub intersection: Option<Vec<Region>>,
    /// A region that is rotated about a point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation: Option<Rotation>,
    /// Initial velocity of the whole body [m/s], one number per direction; absent: the body is at
    /// rest, unless `velocity_field` is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity: Option<Vec<f64>>,
    /// Initial velocity as a function of position, instead of `velocity`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity_field: Option<VelocityField>,
    /// Initial pressure [Pa], default 0. The density is that of the material; the internal energy
    /// is set to give this pressure.
    #[serde(default)]
    pub pressure: f64,
    /// Initial temperature [K], for a material with `thermal`; absent: the reference temperature of
    /// the material.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub temperature: Option<f64>,
    /// Number of particles per cell in each direction, not allowed with `positions`; absent: 2 in each
    /// direction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = 1)))]
    pub particles_per_cell: Option<Vec<usize>>,
    /// Initial particle positions, instead of a lattice. Each particle gets the part of the body
    /// that is nearest to its position (its Voronoi cell) and is placed at the centroid of that
    /// cell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub positions: Option<Positions>,
}

/// Positions of particles.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Positions {
    /// Name of a CSV file with the columns x and, in a plane, y, relative to the folder of the
    /// scene file.
    File(String),
    /// The coordinates of each particle [m].
    Points(Vec<Vec<f64>>),
}

/// Number of particles per cell in each direction if a body gives none. With the default method, 1
/// has 18 % more E1 over 60 impacts on a line and 14 % more error in a plane; 3 and 4 differ from 2 by
/// at most 1.6 %.
const PARTICLES_PER_CELL: usize = 2;

impl Body {
    /// Number of particles per cell in each direction, for bodies without `positions`.
    pub fn particles_per_cell(&self, dimension: usize) -> Vec<usize> {
        self.particles_per_cell.clone().unwrap_or_else(|| vec![PARTICLES_PER_CELL; dimension])
    }

    /// The body's regions, each with its key; a valid body has exactly one.
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
