//! Tests of the module against closed forms, and self-consistency where there are none.

mod areas;
mod faults;
mod random;
mod tiles;
mod tiling;
mod voronoi;

use serde_json::Value;

use super::{BoundedRegion, Moments, Tile};
use crate::scene::Region;

fn region(json: Value) -> Region {
    serde_json::from_value(json).unwrap()
}

fn shape(json: Value) -> BoundedRegion {
    BoundedRegion::new(&region(json)).unwrap()
}

/// The tiles of a shape, in the order of their numbers.
fn fill(
    shape: &BoundedRegion,
    lower: [f64; 2],
    cell_size: [f64; 2],
    per_cell: [usize; 2],
) -> Vec<Tile> {
    super::fill(shape.clone(), lower, cell_size, per_cell).unwrap().all()
}

/// Asserts that `found` is `exact` to `tolerance` times `scale`.
#[track_caller]
fn close(found: f64, exact: f64, tolerance: f64, scale: f64) {
    let error = (found - exact).abs() / scale;
    assert!(error <= tolerance, "{found} is not {exact}, by {error:e} of {scale}");
}

/// Area and moments of tiles, about the origin of coordinates.
fn sum(tiles: &[Tile]) -> Moments {
    tiles.iter().fold(Moments::default(), |sum, tile| {
        sum + Moments { area: tile.area, first: [0.0; 2] }.shifted(tile.centre)
    })
}
