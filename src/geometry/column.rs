//! One column of the lattice over a shape: the rows that lie wholly inside, and the part of the shape
//! in any row.

use super::intervals::{Interval, difference, intersection, union};
use super::lattice::{Cut, Lattice};
use super::moments::Moments;
use super::piece::Piece;
use super::shape::BoundedRegion;

/// Fraction of a tile below which its content, or the missing part, is only rounding.
const ROUNDING: f64 = 1e-12;

/// The pieces of a shape in one column of the lattice.
pub(super) struct Column<'a> {
    lattice: &'a Lattice,
    column: i64,
    /// Each piece with the rows that it overlaps.
    pieces: Vec<(&'a Piece, Interval)>,
}

impl<'a> Column<'a> {
    /// The column with index `column`.
    pub fn new(shape: &'a BoundedRegion, lattice: &'a Lattice, column: i64) -> Self {
        let x = [lattice.side(0, column), lattice.side(0, column + 1)];
        let overlapped =
            |piece: &'a Piece| (piece, lattice.reach(1, piece.range_y(within(piece, x))));
        let pieces = shape.pieces_in(x).iter().map(overlapped).collect();
        Column { lattice, column, pieces }
    }

    /// Rows that the shape overlaps or touches.
    pub fn rows(&self) -> Vec<Interval> {
        union(self.pieces.iter().map(|(_, rows)| *rows).collect())
    }

    /// Rows whose tiles lie inside of the shape, except for rounding.
    pub fn whole(&self) -> Vec<Interval> {
        let x = [0, 1].map(|k| self.lattice.side(0, self.column + k));
        let mut covered = x[0];
        let mut whole: Option<Vec<Interval>> = None;
        // pieces of a strip of the region lie above each other
        for strip in self.pieces.chunk_by(|(a, _), (b, _)| a.x == b.x) {
            let part = within(strip[0].0, x);
            if part[0] > covered {
                return Vec::new();
            }
            covered = part[1];
            let inner = strip.iter().map(|(piece, _)| self.inner_rows(piece, part)).collect();
            let inner = union(inner);
            whole = Some(whole.map_or_else(|| inner.clone(), |rows| intersection(&rows, &inner)));
        }
        whole.filter(|_| covered >= x[1]).unwrap_or_default()
    }

    /// Rows between the curves of a piece over the interval `x` [m].
    fn inner_rows(&self, piece: &Piece, x: [f64; 2]) -> Interval {
        let (lower, size) = (self.lattice.lower[1], self.lattice.size()[1]);
        let [floor, ceiling] = piece.inner_range_y(x).map(|y| (y - lower) / size);
        [floor.ceil() as i64, ceiling.floor() as i64]
    }

    /// The part of the shape in the tile of a row. A tile that is full except for rounding is whole.
    pub fn cut(&self, row: i64) -> Cut {
        let index = [row, self.column];
        let (trapezium, centre) = (self.lattice.trapezium(index), self.lattice.centre(index));
        let mut moments = Moments::default();
        for (piece, rows) in &self.pieces {
            if (rows[0]..rows[1]).contains(&row) {
                moments += piece.overlap(&trapezium, centre);
            }
        }
        Cut { index, moments: rounded(moments, self.lattice.area()), merged: false }
    }

    /// Tiles in which the border of the shape may lie: all that are not `whole`, without those in
    /// which there is nothing.
    pub fn border(&self, whole: &[Interval]) -> impl Iterator<Item = Cut> {
        let rows = difference(&self.rows(), whole).into_iter().flat_map(|[from, to]| from..to);
        let least = ROUNDING * self.lattice.area();
        rows.map(|row| self.cut(row)).filter(move |cut| cut.moments.area > least)
    }
}

/// The moments, or those of the whole tile about its centre if they are equal except for rounding.
// a call of its own: inlined, the area may be moved in a form that valgrind does not know
#[inline(never)]
fn rounded(moments: Moments, whole: f64) -> Moments {
    match (moments.area - whole).abs() <= ROUNDING * whole {
        true => Moments { area: whole, first: [0.0; 2] },
        false => moments,
    }
}

/// The part of the interval of a piece that is within `x` [m].
fn within(piece: &Piece, x: [f64; 2]) -> [f64; 2] {
    [x[0].max(piece.x[0]), x[1].min(piece.x[1])]
}
