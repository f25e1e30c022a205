//! The tiles of a body, numbered in a fixed order, and found by the grid's cells.
//!
//! Tiles are kept as runs along the rows of the lattice, and made when they are asked for; those with
//! merged slivers are kept one by one. The tiling of a disk of n tiles thus takes memory and time of
//! the order of sqrt(n), so that every rank has the tilings of all bodies and makes the tiles of its
//! own patches alone.

use std::cmp::Ordering;

use super::column::Column;
use super::lattice::{CellBox, Lattice, Tile};
use super::shape::BoundedRegion;

/// Tiles next to each other in a row of the lattice, each the part of the shape in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TileRun {
    pub row: i64,
    /// The first column, and the first one beyond the run.
    pub columns: [i64; 2],
    /// Number of the first tile.
    pub first: u64,
}

/// A tile that is kept by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Single {
    /// Cell of the grid that has the tile's centre.
    cell: [i64; 2],
    number: u64,
    tile: Tile,
}

/// The tiles of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Tiling {
    lattice: Lattice,
    /// The shape that cuts the lattice; `None` if all tiles are kept one by one.
    shape: Option<BoundedRegion>,
    /// Sorted by row, then by column.
    runs: Vec<TileRun>,
    /// Sorted by cell, y first, then by number.
    singles: Vec<Single>,
    tiles: u64,
    /// Greatest edges of a tile [m].
    longest: [f64; 2],
}

impl Tiling {
    /// Tiles that are given one by one, in the order of their numbers, on a grid with cells of
    /// `cell_size` [m] that starts at `lower` [m].
    pub fn of_tiles(tiles: Vec<Tile>, lower: [f64; 2], cell_size: [f64; 2]) -> Self {
        let lattice = Lattice { lower, cell: cell_size, per_cell: [1, 1] };
        let count = tiles.len() as u64;
        let longest = longest(tiles.iter().map(|tile| tile.size));
        Tiling::new(lattice, None, Vec::new(), (0..).zip(tiles).collect(), (count, longest))
    }

    /// Sorted runs of tiles of a shape, its other tiles with their numbers, the number of all tiles, and
    /// their greatest edges [m].
    pub(super) fn new(
        lattice: Lattice,
        shape: Option<BoundedRegion>,
        runs: Vec<TileRun>,
        singles: Vec<(u64, Tile)>,
        (tiles, longest): (u64, [f64; 2]),
    ) -> Self {
        let single = |(number, tile): (u64, Tile)| Single {
            cell: lattice.cell_of(tile.centre),
            number,
            tile,
        };
        let mut singles: Vec<Single> = singles.into_iter().map(single).collect();
        singles.sort_unstable_by_key(|s| (s.cell[1], s.cell[0], s.number));
        Tiling { lattice, shape, runs, singles, tiles, longest }
    }

    /// Number of tiles.
    pub fn count(&self) -> u64 {
        self.tiles
    }

    /// Number of tiles whose centres lie in `cells`, without making them.
    pub fn count_in(&self, cells: CellBox) -> u64 {
        let [_, columns] = self.lattice.tiles_of(cells);
        let runs = self.runs_in(cells).iter().map(|run| {
            let [from, to] = clip(run.columns, columns);
            (to - from).max(0) as u64
        });
        runs.sum::<u64>() + self.singles_in(cells).map(|row| row.len() as u64).sum::<u64>()
    }

    /// Number of tiles in each of `cells` slices of cells normal to `axis`, without making them;
    /// centres beyond the grid count in its last slice.
    pub fn slices(&self, axis: usize, cells: usize) -> Vec<u64> {
        let last = cells as i64 - 1;
        let slice = |cell: i64| cell.clamp(0, last) as usize;
        let mut counts = vec![0; cells];
        for single in &self.singles {
            counts[slice(single.cell[axis])] += 1;
        }
        let per_cell = self.lattice.per_cell[axis] as i64;
        if axis == 1 {
            for run in &self.runs {
                let tiles = run.columns[1] - run.columns[0];
                counts[slice(run.row.div_euclid(per_cell))] += tiles as u64;
            }
            return counts;
        }
        // tiles that begin in a column less those that have ended, summed over columns
        let mut ends: Vec<(i64, i64)> =
            self.runs.iter().flat_map(|run| [(run.columns[0], 1), (run.columns[1], -1)]).collect();
        ends.sort_unstable();
        let mut open = 0;
        for pair in ends.windows(2) {
            open += pair[0].1;
            let mut column = pair[0].0;
            while open > 0 && column < pair[1].0 {
                let cell = column.div_euclid(per_cell);
                let next = ((cell + 1) * per_cell).min(pair[1].0);
                counts[slice(cell)] += (open * (next - column)) as u64;
                column = next;
            }
        }
        counts
    }

    /// Calls `take` with each tile whose centre lies in `cells`, and its number.
    pub fn each_in(&self, cells: CellBox, take: &mut dyn FnMut(u64, Tile)) {
        for row in self.singles_in(cells) {
            row.iter().for_each(|single| take(single.number, single.tile));
        }
        let (Some(shape), [_, [first, last]]) = (&self.shape, self.lattice.tiles_of(cells)) else {
            return;
        };
        let runs = self.runs_in(cells);
        // only columns of these runs are needed
        let reach = runs.iter().map(|run| clip(run.columns, [first, last]));
        let reach = reach.filter(|[from, to]| from < to);
        let [first, last] =
            reach.fold([last, first], |all, run| [all[0].min(run[0]), all[1].max(run[1])]);
        let columns: Vec<Column<'_>> =
            (first..last).map(|column| Column::new(shape, &self.lattice, column)).collect();
        for run in runs {
            let [from, to] = clip(run.columns, [first, last]);
            for column in from..to {
                let cut = columns[(column - first) as usize].cut(run.row);
                let number = run.first + (column - run.columns[0]) as u64;
                take(number, self.lattice.tile(&cut));
            }
        }
    }

    /// Greatest edges of a tile [m].
    pub fn longest(&self) -> [f64; 2] {
        self.longest
    }

    /// Number of the tile whose centre is nearest to `at` [m], the least of several; 0 without tiles.
    pub fn nearest(&self, at: &[f64]) -> u64 {
        type Found = (f64, u64);
        let found = |(number, tile): (u64, Tile)| -> Found {
            let along = at.iter().zip(tile.centre);
            (along.map(|(x, centre)| (x - centre) * (x - centre)).sum(), number)
        };
        let nearer = |a: Found, b: Found| match a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)) {
            Ordering::Greater => b,
            _ => a,
        };
        let [x, y] = [0, 1].map(|d| at.get(d).copied().unwrap_or(0.0));
        let column_of = |x: f64| self.lattice.index(0, x);
        let singles = self.singles.iter().map(|s| found((s.number, s.tile)));
        // one tile of each run limits the distance
        let in_runs = self.runs.iter().map(|run| {
            found(self.tile_of(run, column_of(x).clamp(run.columns[0], run.columns[1] - 1)))
        });
        let mut nearest = singles.chain(in_runs).fold((f64::INFINITY, 0), nearer);
        for run in &self.runs {
            // the centre of a tile lies within it
            let sides = [0, 1].map(|k| self.lattice.side(1, run.row + k));
            let gap = (sides[0] - y).max(y - sides[1]).max(0.0);
            if gap * gap > nearest.0 {
                continue;
            }
            let reach = (nearest.0 - gap * gap).sqrt();
            let near = [column_of(x - reach) - 1, column_of(x + reach) + 2];
            let [from, to] = clip(run.columns, near);
            nearest = (from..to).map(|c| found(self.tile_of(run, c))).fold(nearest, nearer);
        }
        nearest.1
    }

    /// All tiles in the order of their numbers.
    pub fn all(&self) -> Vec<Tile> {
        let mut tiles: Vec<(u64, Tile)> = self.singles.iter().map(|s| (s.number, s.tile)).collect();
        for run in &self.runs {
            tiles.extend((run.columns[0]..run.columns[1]).map(|c| self.tile_of(run, c)));
        }
        tiles.sort_unstable_by_key(|(number, _)| *number);
        tiles.into_iter().map(|(_, tile)| tile).collect()
    }

    /// The tile of a run in `column`, with its number.
    fn tile_of(&self, run: &TileRun, column: i64) -> (u64, Tile) {
        let shape = self.shape.as_ref().expect("runs are those of a shape");
        let cut = Column::new(shape, &self.lattice, column).cut(run.row);
        (run.first + (column - run.columns[0]) as u64, self.lattice.tile(&cut))
    }

    /// Runs in the rows of `cells`.
    fn runs_in(&self, cells: CellBox) -> &[TileRun] {
        let [[first, last], _] = self.lattice.tiles_of(cells);
        let start = self.runs.partition_point(|run| run.row < first);
        let end = self.runs.partition_point(|run| run.row < last);
        &self.runs[start..end.max(start)]
    }

    /// Single tiles in `cells`, a slice for each row of cells.
    fn singles_in(&self, [lower, upper]: CellBox) -> impl Iterator<Item = &[Single]> {
        let place =
            |y: i64, x: i64| self.singles.partition_point(move |s| (s.cell[1], s.cell[0]) < (y, x));
        let (start, end) = (place(lower[1], lower[0]), place(upper[1] - 1, upper[0]));
        let mut rest = &self.singles[start..end.max(start)];
        std::iter::from_fn(move || {
            let y = rest.first()?.cell[1];
            let row = rest.partition_point(|s| s.cell[1] == y);
            let (this, after) = rest.split_at(row);
            rest = after;
            let from = this.partition_point(|s| s.cell[0] < lower[0]);
            let to = this.partition_point(|s| s.cell[0] < upper[0]);
            Some(&this[from..to.max(from)])
        })
    }
}

/// The greatest edges among `sizes` [m].
pub(super) fn longest(sizes: impl Iterator<Item = [f64; 2]>) -> [f64; 2] {
    sizes.fold([0.0; 2], |most, size| [0, 1].map(|d| f64::max(most[d], size[d])))
}

/// The part of an interval within another; possibly empty.
fn clip(interval: [i64; 2], within: [i64; 2]) -> [i64; 2] {
    [interval[0].max(within[0]), interval[1].min(within[1])]
}
