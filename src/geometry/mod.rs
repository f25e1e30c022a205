//! Plane geometry of bodies: how much of a region lies in a box, and the tiles that fill it.
//!
//! A [`Shape`] is a region of the scene, checked, and cut by vertical lines into *pieces*, each
//! between two curves that are graphs over x: straight lines and arcs of ellipses. So the area
//! and the first moments of the region in any box or cell are integrals under single curves, all
//! of them in closed form or by a Gauss rule that is exact to rounding; no border is replaced by
//! chords. [`fill`] cuts a shape by a lattice, [`voronoi`] by the cells of given points.
//!
//! Knows no particles, no grid, no MPI.

mod build;
mod curve;
mod ellipse;
mod fill;
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
mod voronoi;

pub use build::RegionFault;
pub use fill::{Tile, fill};
pub use moments::Moments;
pub use points::{PointsFault, read_points};
pub use shape::Shape;
pub use voronoi::{PointFault, voronoi, voronoi_line};

/// A point or a vector of the plane [m].
type Point = [f64; 2];
