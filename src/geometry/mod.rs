//! Plane geometry of bodies: the part of a region inside a box, and the tiles that fill a region.
//!
//! A [`BoundedRegion`] is a checked region of the scene. Vertical lines cut it into *pieces*, each between
//! two curves that are graphs over x: straight lines or arcs of ellipses. The area and the first
//! moments of the region in any box or cell are therefore integrals under single curves. They are
//! evaluated in closed form, or by a Gauss rule that is exact to rounding; no border is
//! approximated by chords. [`fill`] cuts a shape by a lattice, [`voronoi`] by the cells of given
//! points.
//!
//! This module knows no particles, no grid and no MPI.

mod boundary;
mod build;
mod column;
mod curve;
mod ellipse;
mod fill;
mod intervals;
mod lattice;
mod line;
mod merge;
mod moments;
mod piece;
mod pieces;
mod points;
pub mod region;
mod shape;
mod solid;
#[cfg(test)]
mod tests;
mod tiling;
mod voronoi;

pub use boundary::{BodyBoundary, BoundaryFace};
pub use build::RegionFault;
pub use fill::{TooManyTiles, fill};
pub use lattice::{CellBox, Tile};
pub use moments::Moments;
pub use points::{PointsFault, read_points};
pub use shape::BoundedRegion;
pub use tiling::Tiling;
pub use voronoi::{PointFault, voronoi, voronoi_line};

/// A point or a vector in the plane [m].
type Point = [f64; 2];
