//! A checked region, ready to be measured.

use super::Point;
use super::build::{self, RegionFault};
use super::moments::Moments;
use super::piece::{Piece, Trapezium};
use super::pieces::{NoPieces, pieces};
use super::region::Region;

/// A region that is bounded and has an area.
#[derive(Clone, Debug)]
pub struct Shape {
    pieces: Vec<Piece>,
    bounds: [Point; 2],
    own_box: Option<[Point; 2]>,
}

impl Shape {
    /// Checks a region and cuts it into pieces.
    ///
    /// # Errors
    ///
    /// The place inside of the region and what is wrong there.
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
        let own_box = match region {
            Region::Box(extent) => Some(build::corners(extent, "box")?),
            _ => None,
        };
        let bounds = own_box.unwrap_or_else(|| bounds(&pieces));
        Ok(Shape { pieces, bounds, own_box })
    }

    /// Whether a point [m] lies in it or, to rounding, on its border.
    pub fn contains(&self, [x, y]: [f64; 2]) -> bool {
        let start = self.pieces.partition_point(|p| p.x[1] < x);
        let mut pieces = self.pieces[start..].iter().take_while(|p| p.x[0] <= x);
        pieces.any(|p| p.lower.y(x) <= y && y <= p.upper.y(x))
    }

    /// Lower and upper corner [m] of the smallest box around it.
    pub fn bounds(&self) -> [[f64; 2]; 2] {
        self.bounds
    }

    /// The corners [m] of a region that is a box along the axes, given as such.
    pub fn own_box(&self) -> Option<[[f64; 2]; 2]> {
        self.own_box
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

    /// Area and first moments about the origin of coordinates of what lies in the box from
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

    /// The pieces that reach into an interval of x.
    pub(super) fn pieces_in(&self, [from, to]: [f64; 2]) -> &[Piece] {
        let start = self.pieces.partition_point(|p| p.x[1] <= from);
        let end = self.pieces.partition_point(|p| p.x[0] < to);
        &self.pieces[start..end.max(start)]
    }

    /// Area and moments about `origin` of what lies in a trapezium.
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
