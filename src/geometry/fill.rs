//! Tiles that fill a shape: whole tiles of a lattice, and tiles cut by the border of the shape.

use super::Point;
use super::lattice::{Cut, Lattice};
use super::merge::merge;
use super::moments::Moments;
use super::shape::BoundedRegion;

/// The part of a shape that one particle represents.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tile {
    /// Centroid [m].
    pub centre: [f64; 2],
    /// Area [m2].
    pub area: f64,
    /// Edges of the box with the same area that represents the tile [m].
    pub size: [f64; 2],
}

/// Fraction of a tile below which its content, or the missing part, is only rounding.
const ROUNDING: f64 = 1e-12;

/// The tiles of a shape, in the order of y, then x. The sum of their areas is the area of the
/// shape, and the sum of area times centre its first moments.
///
/// `particles_per_cell` divides the grid's cells of `cell_size` [m], which start at `lower` [m],
/// into a lattice of tiles. The shape cuts each tile; the centre of a cut tile is the centroid of
/// its remaining part, and its `size` has the proportions of the lattice. The content of one
/// lattice tile is one tile, even if it consists of several parts. Slivers are merged into
/// neighbours, see [`merge`].
///
/// A shape that is given as a box has its own lattice instead. The equal tiles in each direction
/// are as many as come closest to `particles_per_cell`, at least one.
pub fn fill(
    shape: &BoundedRegion,
    lower: [f64; 2],
    cell_size: [f64; 2],
    particles_per_cell: [usize; 2],
) -> Vec<Tile> {
    if let Some(corners) = shape.own_box() {
        return fill_box(corners, cell_size, particles_per_cell);
    }
    let lattice = Lattice { lower, cell: cell_size, per_cell: particles_per_cell };
    let mut cuts = cut(shape, &lattice);
    cuts.sort_unstable_by_key(|cut| cut.index);
    let size = lattice.size();
    let whole = size[0] * size[1];
    merge(shape, &lattice, &mut cuts);
    let tile = |cut: Cut| {
        let (centre, from) = (lattice.centre(cut.index), cut.moments.centroid());
        let scale = (cut.moments.area / whole).sqrt();
        Tile {
            centre: [0, 1].map(|d| centre[d] + from[d]),
            area: cut.moments.area,
            size: size.map(|s| s * scale),
        }
    };
    cuts.into_iter().map(tile).collect()
}

/// The equal tiles of a box.
fn fill_box([lower, upper]: [Point; 2], cell: [f64; 2], per_cell: [usize; 2]) -> Vec<Tile> {
    let length = [0, 1].map(|d| upper[d] - lower[d]);
    let counts = [0, 1].map(|d| (length[d] / cell[d] * per_cell[d] as f64).round().max(1.0) as u64);
    let size = [0, 1].map(|d| length[d] / counts[d] as f64);
    let place =
        |d: usize, k: u64| lower[d] + length[d] * ((2 * k + 1) as f64 / (2 * counts[d]) as f64);
    let area = size[0] * size[1];
    let row = |j| (0..counts[0]).map(move |i| [i, j]);
    let tile = |[i, j]: [u64; 2]| Tile { centre: [place(0, i), place(1, j)], area, size };
    (0..counts[1]).flat_map(row).map(tile).collect()
}

/// The part of the shape in each tile of the lattice, column by column.
fn cut(shape: &BoundedRegion, lattice: &Lattice) -> Vec<Cut> {
    let [size_x, size_y] = lattice.size();
    let whole = size_x * size_y;
    let [lower, upper] = shape.bounds();
    let [first, last] = lattice.reach(0, [lower[0], upper[0]]);
    let mut cuts = Vec::new();
    for column in first..last {
        let x = [lattice.side(0, column), lattice.side(0, column + 1)];
        let pieces = shape.pieces_in(x);
        if pieces.is_empty() {
            continue;
        }
        let rows_of = |piece: &super::piece::Piece| {
            let x = [x[0].max(piece.x[0]), x[1].min(piece.x[1])];
            lattice.reach(1, piece.range_y(x))
        };
        let [mut bottom, mut top] = [i64::MAX, i64::MIN];
        for [from, to] in pieces.iter().map(rows_of) {
            (bottom, top) = (bottom.min(from), top.max(to));
        }
        let mut rows = vec![Moments::default(); (top - bottom) as usize];
        for piece in pieces {
            let [from, to] = rows_of(piece);
            for row in from..to {
                let index = [row, column];
                let overlap = piece.overlap(&lattice.trapezium(index), lattice.centre(index));
                rows[(row - bottom) as usize] += overlap;
            }
        }
        for (row, mut moments) in (bottom..).zip(rows) {
            if (moments.area - whole).abs() <= ROUNDING * whole {
                moments = Moments { area: whole, first: [0.0; 2] };
            }
            if moments.area > ROUNDING * whole {
                cuts.push(Cut { index: [row, column], moments });
            }
        }
    }
    cuts
}
