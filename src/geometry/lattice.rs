//! The lattice of tiles over a shape, and the part of the shape in one tile.

use super::Point;
use super::moments::Moments;
use super::piece::Trapezium;

/// The part of a shape that one particle represents.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tile {
    /// Centroid [m].
    pub centre: [f64; 2],
    /// Area [m2]; on a line the length [m].
    pub area: f64,
    /// Edges of the box with the same area that represents the tile [m].
    pub size: [f64; 2],
}

/// A box of the grid's cells: the first cell, and the first beyond it, in each direction.
pub type CellBox = [[i64; 2]; 2];

/// A lattice of tiles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lattice {
    /// A corner of the lattice [m].
    pub lower: Point,
    /// Edges of a grid cell [m].
    pub cell: [f64; 2],
    /// Number of tiles per cell in each direction.
    pub per_cell: [usize; 2],
}

/// The part of a shape in one tile of the lattice, including parts merged into it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    /// Index in the lattice: y, then x.
    pub index: [i64; 2],
    /// Area and moments about the tile's centre.
    pub moments: Moments,
    /// Whether parts of other tiles were merged into it.
    pub merged: bool,
}

impl Lattice {
    /// Edges of a tile [m].
    pub fn size(&self) -> [f64; 2] {
        [0, 1].map(|d| self.cell[d] / self.per_cell[d] as f64)
    }

    /// Area of a tile [m2].
    pub fn area(&self) -> f64 {
        let [x, y] = self.size();
        x * y
    }

    /// Cell of the grid that contains `x` [m].
    pub fn cell_of(&self, x: Point) -> [i64; 2] {
        [0, 1].map(|d| ((x[d] - self.lower[d]) * (1.0 / self.cell[d])).floor() as i64)
    }

    /// Index of the tile that contains the coordinate `x` [m] in direction `d`.
    pub fn index(&self, d: usize, x: f64) -> i64 {
        ((x - self.lower[d]) / self.size()[d]).floor() as i64
    }

    /// Rows and columns of the tiles in a box of cells: the first one, and the first one beyond.
    pub fn tiles_of(&self, [lower, upper]: CellBox) -> [[i64; 2]; 2] {
        [1, 0].map(|d| [lower[d], upper[d]].map(|cell| cell * self.per_cell[d] as i64))
    }

    /// The tile that stands for a cut. Its centre is the centroid of the cut, its edges have the
    /// proportions of the lattice.
    pub fn tile(&self, cut: &Cut) -> Tile {
        let (centre, from) = (self.centre(cut.index), cut.moments.centroid());
        let scale = (cut.moments.area / self.area()).sqrt();
        Tile {
            centre: [0, 1].map(|d| centre[d] + from[d]),
            area: cut.moments.area,
            size: self.size().map(|s| s * scale),
        }
    }

    /// Position of the lower side of tile `i` in direction `d` [m].
    pub fn side(&self, d: usize, i: i64) -> f64 {
        self.lower[d] + i as f64 * self.cell[d] / self.per_cell[d] as f64
    }

    /// Centre of a tile [m].
    pub fn centre(&self, [row, column]: [i64; 2]) -> Point {
        [0, 1].map(|d| {
            let i = [column, row][d];
            self.lower[d] + (2 * i + 1) as f64 * self.cell[d] / (2 * self.per_cell[d]) as f64
        })
    }

    /// The box of a tile.
    pub fn trapezium(&self, [row, column]: [i64; 2]) -> Trapezium {
        let corner = |k| [self.side(0, column + k), self.side(1, row + k)];
        Trapezium::upright(corner(0), corner(1))
    }

    /// Index of the first tile that overlaps `range` [m], and of the first beyond it, in direction
    /// `d`.
    pub fn reach(&self, d: usize, range: [f64; 2]) -> [i64; 2] {
        let [from, to] = range.map(|x| (x - self.lower[d]) / self.size()[d]);
        [from.floor() as i64, to.ceil() as i64]
    }
}
