//! Filling of a shape: whole tiles of a lattice, and tiles cut by the border of the shape.

use super::column::Column;
use super::intervals::{Interval, difference};
use super::lattice::{Cut, Lattice, Tile};
use super::merge::{merge, sliver_area};
use super::shape::BoundedRegion;
use super::tiling::{TileRun, Tiling, longest};

/// The border of a shape is longer than the number of tiles that can be kept one by one.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("more than {MOST_SINGLE:e} tiles lie at the border of the shape")]
pub struct TooManyTiles;

/// Greatest number of tiles at the border of a shape, and of rows and columns of its lattice.
const MOST_SINGLE: usize = 20_000_000;

/// The tiles of a shape, numbered in the order of y, then x. The sum of their areas is the area of
/// the shape, and the sum of area times centre its first moments.
///
/// `particles_per_cell` divides the grid's cells of `cell_size` [m], which start at `lower` [m],
/// into a lattice of tiles. The shape cuts each tile; the centre of a cut tile is the centroid of
/// its remaining part, and its `size` has the proportions of the lattice. The content of one
/// lattice tile is one tile, even if it consists of several parts. Slivers are merged into
/// neighbours, see [`merge`].
///
/// # Errors
///
/// If too many tiles lie at the border of the shape, which are all kept.
pub fn fill(
    shape: BoundedRegion,
    lower: [f64; 2],
    cell_size: [f64; 2],
    particles_per_cell: [usize; 2],
) -> Result<Tiling, TooManyTiles> {
    let lattice = Lattice { lower, cell: cell_size, per_cell: particles_per_cell };
    let (mut cuts, mut runs) = cut(&shape, &lattice)?;
    runs.sort_unstable_by_key(|run| (run.row, run.columns[0]));
    add_neighbours(&shape, &lattice, &runs, &mut cuts);
    merge(&shape, &lattice, &mut cuts);
    let whole = runs.iter().map(|_| lattice.size());
    let longest = longest(cuts.iter().map(|cut| lattice.tile(cut).size).chain(whole));
    let mut numbered =
        Numbered { lattice: &lattice, runs: Vec::new(), singles: Vec::new(), next: 0 };
    numbered.add_all(&runs, &cuts);
    let Numbered { mut runs, singles, next, .. } = numbered;
    runs.shrink_to_fit();
    Ok(Tiling::new(lattice, Some(shape), runs, singles, (next, longest)))
}

/// The tiles at the border of the shape, and the runs of those inside, not numbered and in any
/// order. Column by column, so that only the rows in which columns differ take time.
fn cut(shape: &BoundedRegion, lattice: &Lattice) -> Result<(Vec<Cut>, Vec<TileRun>), TooManyTiles> {
    let [lower, upper] = shape.bounds();
    let [first, last] = lattice.reach(0, [lower[0], upper[0]]);
    let [bottom, top] = lattice.reach(1, [lower[1], upper[1]]);
    let most = MOST_SINGLE as i64;
    if last - first > most || top - bottom > most {
        return Err(TooManyTiles);
    }
    let (mut cuts, mut runs) = (Vec::new(), Vec::new());
    // for each row that lies inside, the column from which on it does
    let mut since = vec![0; (top - bottom).max(0) as usize];
    let mut before: Vec<Interval> = Vec::new();
    for column in first..=last {
        let whole = match column == last {
            true => Vec::new(),
            false => {
                let pieces = Column::new(shape, lattice, column);
                let whole = pieces.whole();
                cuts.extend(pieces.border(&whole));
                whole
            }
        };
        for [from, to] in difference(&before, &whole) {
            let columns = |row: i64| [since[(row - bottom) as usize], column];
            runs.extend((from..to).map(|row| TileRun { row, columns: columns(row), first: 0 }));
        }
        for [from, to] in difference(&whole, &before) {
            since[(from - bottom) as usize..(to - bottom) as usize].fill(column);
        }
        before = whole;
        if cuts.len() + runs.len() > MOST_SINGLE {
            return Err(TooManyTiles);
        }
    }
    Ok((cuts, runs))
}

/// Adds the whole tiles next to slivers, which may receive them, to `cuts`, and sorts these.
fn add_neighbours(shape: &BoundedRegion, lattice: &Lattice, runs: &[TileRun], cuts: &mut Vec<Cut>) {
    let least = sliver_area(lattice);
    let slivers = cuts.iter().filter(|cut| cut.moments.area < least);
    let mut near: Vec<[i64; 2]> = slivers
        .flat_map(|cut| {
            let [row, column] = cut.index;
            (-1..=1).flat_map(move |i| (-1..=1).map(move |j| [column + j, row + i]))
        })
        .collect();
    near.sort_unstable();
    near.dedup();
    let is_whole = |[column, row]: [i64; 2]| {
        let after = runs.partition_point(|run| (run.row, run.columns[0]) <= (row, column));
        let run = after.checked_sub(1).map(|k| &runs[k]);
        run.is_some_and(|run| run.row == row && column < run.columns[1])
    };
    near.retain(|index| is_whole(*index));
    for alike in near.chunk_by(|a, b| a[0] == b[0]) {
        let column = Column::new(shape, lattice, alike[0][0]);
        cuts.extend(alike.iter().map(|index| column.cut(index[1])));
    }
    cuts.sort_unstable_by_key(|cut| cut.index);
}

/// Tiles that have their numbers: by row, then by column.
struct Numbered<'a> {
    lattice: &'a Lattice,
    /// Tiles that the shape alone defines.
    runs: Vec<TileRun>,
    /// Tiles with parts of others, and slivers.
    singles: Vec<(u64, Tile)>,
    /// Number of the next tile.
    next: u64,
}

impl Numbered<'_> {
    /// Adds the runs of `whole` tiles and the tiles of `cuts`, some of which lie within these runs; both
    /// are sorted.
    fn add_all(&mut self, whole: &[TileRun], cuts: &[Cut]) {
        let mut cuts = cuts.iter().peekable();
        for run in whole {
            let [mut from, to] = run.columns;
            while let Some(cut) = cuts.next_if(|cut| cut.index < [run.row, to]) {
                let column = cut.index[1];
                if cut.index[0] == run.row && from < column {
                    self.add_run(run.row, [from, column]);
                }
                if cut.index >= [run.row, from] {
                    from = column + 1;
                }
                self.add_cut(cut);
            }
            if from < to {
                self.add_run(run.row, [from, to]);
            }
        }
        cuts.for_each(|cut| self.add_cut(cut));
    }

    /// Adds the tiles of a row in some columns, to the last run if they are next to it.
    fn add_run(&mut self, row: i64, columns: [i64; 2]) {
        match self.runs.last_mut().filter(|run| run.row == row && run.columns[1] == columns[0]) {
            Some(run) => run.columns[1] = columns[1],
            None => self.runs.push(TileRun { row, columns, first: self.next }),
        }
        self.next += (columns[1] - columns[0]) as u64;
    }

    fn add_cut(&mut self, cut: &Cut) {
        let [row, column] = cut.index;
        // the centroid of a sliver may be rounded into the next cell
        if !cut.merged && cut.moments.area >= sliver_area(self.lattice) {
            return self.add_run(row, [column, column + 1]);
        }
        self.singles.push((self.next, self.lattice.tile(cut)));
        self.next += 1;
    }
}
