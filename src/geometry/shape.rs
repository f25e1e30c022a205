//! A checked region, with its area, moments and overlaps.

use super::Point;
use super::build::{self, RegionFault};
use super::moments::Moments;
use super::piece::{Piece, Trapezium};
use super::pieces::{NoPieces, pieces};
use super::region::Region;

/// A region that is bounded and has an area.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundedRegion {
    pieces: Vec<Piece>,
    bounds: [Point; 2],
}

impl BoundedRegion {
    /// Checks a region and cuts it into pieces.
    ///
    /// # Errors
    ///
    /// A fault, with its path inside the region.
    pub fn new(region: &Region) -> Result<Self, RegionFault> {
        let solid = build::solid(region)?;
        let pieces = pieces(&solid).map_err(|why| {
            let reason = match why {
                NoPieces::Unbounded => {
                    "without end; allowed: a half_plane only where others bound what is left of it"
                }
                NoPieces::Empty => "nothing is left of it; allowed: a region with an area",
            };
            let key = build::key(region);
            let value = serde_json::to_value(region).unwrap_or_default();
            RegionFault::new(key, &value[key], reason)
        })?;
        let bounds = match region {
            Region::Box(extent) => build::corners(extent, "box")?,
            _ => bounds(&pieces),
        };
        Ok(BoundedRegion { pieces, bounds })
    }

    /// Whether a point [m] is in the region or, to rounding, on its border.
    pub fn contains(&self, [x, y]: [f64; 2]) -> bool {
        let start = self.pieces.partition_point(|p| p.x[1] < x);
        let mut pieces = self.pieces[start..].iter().take_while(|p| p.x[0] <= x);
        pieces.any(|p| p.lower.y(x) <= y && y <= p.upper.y(x))
    }

    /// Lower and upper corner [m] of the smallest box around the region.
    pub fn bounds(&self) -> [[f64; 2]; 2] {
        self.bounds
    }

    /// Area [m2].
    pub fn area(&self) -> f64 {
        self.moments().area
    }

    /// Centroid [m].
    pub fn centroid(&self) -> [f64; 2] {
        let (origin, from) = (self.middle(), self.moments().centroid());
        [0, 1].map(|d| origin[d] + from[d])
    }

    /// Area and first moments, about the origin of coordinates, of the part inside the box from
    /// `lower` to `upper` [m].
    pub fn moments_within(&self, lower: [f64; 2], upper: [f64; 2]) -> Moments {
        let centre = [0, 1].map(|d| 0.5 * (lower[d] + upper[d]));
        self.overlap(&Trapezium::upright(lower, upper), centre).shifted(centre)
    }

    fn middle(&self) -> Point {
        [0, 1].map(|d| 0.5 * (self.bounds[0][d] + self.bounds[1][d]))
    }

    /// Area and moments about the middle of the bounds.
    fn moments(&self) -> Moments {
        let origin = self.middle();
        self.pieces.iter().fold(Moments::default(), |sum, p| sum + p.moments(origin))
    }

    /// The pieces that overlap an interval of x.
    pub(super) fn pieces_in(&self, [from, to]: [f64; 2]) -> &[Piece] {
        let start = self.pieces.partition_point(|p| p.x[1] <= from);
        let end = self.pieces.partition_point(|p| p.x[0] < to);
        &self.pieces[start..end.max(start)]
    }

    /// Area and moments, about `origin`, of the part inside a trapezium.
    pub(super) fn overlap(&self, trapezium: &Trapezium, origin: Point) -> Moments {
        let pieces = self.pieces_in(trapezium.x).iter();
        pieces.fold(Moments::default(), |sum, p| sum + p.overlap(trapezium, origin))
    }
}

/// The smallest box around pieces.
fn bounds(pieces: &[Piece]) -> [Point; 2] {
    let mut bounds = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    for piece in pieces {
        for (d, range) in [piece.x, piece.range_y(piece.x)].into_iter().enumerate() {
            bounds[0][d] = bounds[0][d].min(range[0]);
            bounds[1][d] = bounds[1][d].max(range[1]);
        }
    }
    bounds
}
