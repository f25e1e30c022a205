//! Filling of a shape: whole tiles of a lattice, and tiles cut by the border of the shape.

use super::column::Column;
use super::intervals::{Interval, difference};
use super::lattice::{Cut, Lattice};
use super::merge::{merge, sliver_area};
use super::shape::BoundedRegion;
use super::tiling::{TileRun, Tiling};

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
    let (runs, singles, count) = number(&runs, &cuts);
    let singles = singles.into_iter().zip(&cuts).map(|(n, cut)| (n, lattice.tile(cut))).collect();
    Ok(Tiling::new(lattice, Some(shape), runs, singles, count))
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

/// Numbers tiles by row, then by column: runs without the tiles that are among `cuts`, the numbers of
/// the cuts, and the number of all. Runs and cuts are sorted.
fn number(whole: &[TileRun], cuts: &[Cut]) -> (Vec<TileRun>, Vec<u64>, u64) {
    let (mut runs, mut singles) = (Vec::with_capacity(whole.len()), Vec::with_capacity(cuts.len()));
    let mut next = 0;
    for run in whole {
        let [mut from, to] = run.columns;
        while let Some(cut) = cuts.get(singles.len()).filter(|cut| cut.index < [run.row, to]) {
            let column = cut.index[1];
            if cut.index[0] == run.row && from < column {
                runs.push(TileRun { row: run.row, columns: [from, column], first: next });
                next += (column - from) as u64;
            }
            if cut.index >= [run.row, from] {
                from = column + 1;
            }
            singles.push(next);
            next += 1;
        }
        if from < to {
            runs.push(TileRun { row: run.row, columns: [from, to], first: next });
            next += (to - from) as u64;
        }
    }
    while singles.len() < cuts.len() {
        singles.push(next);
        next += 1;
    }
    (runs, singles, next)
}
