//! Tiles that fill a shape: whole ones of a lattice, and those that its border cuts.

use super::Point;
use super::merge::merge;
use super::moments::Moments;
use super::piece::Trapezium;
use super::shape::Shape;

/// A part of a shape that one particle stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tile {
    /// Centroid [m].
    pub centre: [f64; 2],
    /// Area [m2].
    pub area: f64,
    /// Edges of the box of the same area that stands for it [m].
    pub size: [f64; 2],
}

/// The tiles of a lattice.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lattice {
    /// A corner of it [m].
    pub lower: Point,
    /// Edges of a cell of the grid [m].
    pub cell: [f64; 2],
    /// Tiles in a cell, in each direction.
    pub per_cell: [usize; 2],
}

/// What lies in a tile of the lattice, and what was merged into it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    /// Place in the lattice: y, then x.
    pub index: [i64; 2],
    /// Area and moments about the tile's centre.
    pub moments: Moments,
}

/// Share of a tile below which rounding is all that lies in it or is missing from it.
const ROUNDING: f64 = 1e-12;

impl Lattice {
    /// Edges of a tile [m].
    pub fn size(&self) -> [f64; 2] {
        [0, 1].map(|d| self.cell[d] / self.per_cell[d] as f64)
    }

    /// Place of the lower side of tile `i` in direction `d` [m].
    fn side(&self, d: usize, i: i64) -> f64 {
        self.lower[d] + i as f64 * self.cell[d] / self.per_cell[d] as f64
    }

    /// Centre of a tile [m].
    pub fn centre(&self, [row, column]: [i64; 2]) -> Point {
        [0, 1].map(|d| {
            let i = [column, row][d];
            self.lower[d] + (2 * i + 1) as f64 * self.cell[d] / (2 * self.per_cell[d]) as f64
        })
    }

    /// A tile's box.
    fn trapezium(&self, [row, column]: [i64; 2]) -> Trapezium {
        let corner = |k| [self.side(0, column + k), self.side(1, row + k)];
        Trapezium::upright(corner(0), corner(1))
    }

    /// First tile that reaches into `range` [m] and the first beyond, in direction `d`.
    fn reach(&self, d: usize, range: [f64; 2]) -> [i64; 2] {
        let [from, to] = range.map(|x| (x - self.lower[d]) / self.size()[d]);
        [from.floor() as i64, to.ceil() as i64]
    }
}

/// The tiles of a shape, in the order of y and then of x. Their areas add up to the shape's, and
/// area times centre to its first moments.
///
/// They are those of the lattice that `particles_per_cell` makes of the grid's cells of `cell_size`
/// [m] from `lower` [m], each cut by the shape: a cut tile stands at the centroid of what is left
/// of it, and its `size` has the lattice's proportions. What lies in one tile is one tile, even in
/// parts. Slivers are merged into neighbours, see [`merge`].
///
/// A shape that is a box, given as such, has its own lattice instead: as many equal tiles in each
/// direction as come nearest to `particles_per_cell`, one at least.
pub fn fill(
    shape: &Shape,
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

/// What of the shape lies in each tile of the lattice, column by column.
fn cut(shape: &Shape, lattice: &Lattice) -> Vec<Cut> {
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
