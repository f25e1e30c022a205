//! Rows of particles: ids, cells, and declared columns of `f64`.

/// What becomes of a column's value in a mirror.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mirror {
    /// It stays.
    Same,
    /// It changes sign in a mirror across this axis: a component of a vector.
    Negate(usize),
    /// v becomes 1 - v in a mirror across this axis: a place within a cell, in cells.
    Complement(usize),
}

/// A column, declared once; migration, ghosts, sorting and output walk the list of these.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ColumnSpec {
    /// Name, in files too.
    pub name: &'static str,
    /// SI unit.
    pub unit: &'static str,
    /// Whether ghosts need it.
    pub ghost: bool,
    /// Whether it must be kept from one step to the next: it migrates and is part of the state.
    pub state: bool,
    /// What a mirror does to it.
    pub mirror: Mirror,
}

impl ColumnSpec {
    /// The value in an image that is mirrored across the axes of `flip`.
    pub fn image(&self, value: f64, flip: &[bool]) -> f64 {
        match self.mirror {
            Mirror::Negate(a) if flip[a] => -value,
            Mirror::Complement(a) if flip[a] => 1.0 - value,
            _ => value,
        }
    }
}

/// The rows of one patch: its own, then copies of others' ("ghosts").
///
/// Own rows stand in canonical order, by cell (last direction slowest) and then by id; so do the
/// ghosts behind them. A column without ghosts is as long as the own rows.
#[derive(Clone, Debug)]
pub struct Block<const D: usize> {
    /// Id of each row, the same for the whole run.
    pub ids: Vec<u64>,
    /// Cell of each row; beyond the domain for images.
    pub cells: Vec<[i32; D]>,
    /// The columns, as declared.
    pub columns: Vec<Vec<f64>>,
    specs: Vec<ColumnSpec>,
    own: usize,
}

impl<const D: usize> Block<D> {
    /// A block without rows.
    pub fn new(specs: &[ColumnSpec]) -> Self {
        Block {
            ids: Vec::new(),
            cells: Vec::new(),
            columns: specs.iter().map(|_| Vec::new()).collect(),
            specs: specs.to_vec(),
            own: 0,
        }
    }

    /// The declarations of the columns.
    pub fn specs(&self) -> &[ColumnSpec] {
        &self.specs
    }

    /// Number of own rows.
    pub fn own(&self) -> usize {
        self.own
    }

    /// Number of rows, ghosts included.
    pub fn rows(&self) -> usize {
        self.ids.len()
    }

    /// The columns at `which`, all at once. They must differ.
    pub fn columns_mut<const N: usize>(&mut self, which: [usize; N]) -> [&mut [f64]; N] {
        self.columns
            .get_disjoint_mut(which)
            .expect("columns are declared and differ")
            .map(|c| c.as_mut_slice())
    }

    /// Adds an own row; `values` gives its columns in order. Order is restored by `sort`.
    pub fn push(&mut self, id: u64, cell: [i32; D], values: &[f64]) {
        debug_assert_eq!(self.rows(), self.own, "own rows go before ghosts");
        self.ids.push(id);
        self.cells.push(cell);
        for (column, value) in self.columns.iter_mut().zip(values) {
            column.push(*value);
        }
        self.own += 1;
    }

    /// Leaves the ghosts out.
    pub fn drop_ghosts(&mut self) {
        let own = self.own;
        self.ids.truncate(own);
        self.cells.truncate(own);
        for column in &mut self.columns {
            column.truncate(own);
        }
    }

    /// Adds a ghost row; `values` gives the ghost columns in order.
    pub(crate) fn push_ghost(&mut self, id: u64, cell: [i32; D], values: &[f64]) {
        self.ids.push(id);
        self.cells.push(cell);
        let ghosts = self.specs.iter().zip(&mut self.columns).filter(|(s, _)| s.ghost);
        for ((_, column), value) in ghosts.zip(values) {
            column.push(*value);
        }
    }

    /// Keeps the own rows for which `keep` says so. There must be no ghosts.
    pub fn retain(&mut self, keep: &[bool]) {
        debug_assert_eq!(self.rows(), self.own);
        let mut at = 0;
        self.ids.retain(|_| {
            at += 1;
            keep[at - 1]
        });
        at = 0;
        self.cells.retain(|_| {
            at += 1;
            keep[at - 1]
        });
        for column in &mut self.columns {
            at = 0;
            column.retain(|_| {
                at += 1;
                keep[at - 1]
            });
        }
        self.own = self.ids.len();
    }

    /// Restores the canonical order of the own rows.
    pub fn sort_own(&mut self) {
        self.sort(0, self.own);
    }

    /// Restores the canonical order of the ghosts.
    pub(crate) fn sort_ghosts(&mut self) {
        self.sort(self.own, self.rows());
    }

    fn key(&self, row: usize) -> ([i32; D], u64) {
        let mut cell = self.cells[row];
        cell.reverse();
        (cell, self.ids[row])
    }

    fn sort(&mut self, from: usize, to: usize) {
        // most steps leave the order as it was
        if (from + 1..to).all(|r| self.key(r - 1) <= self.key(r)) {
            return;
        }
        let mut order: Vec<usize> = (from..to).collect();
        order.sort_unstable_by_key(|&r| self.key(r));
        permute(&mut self.ids, from, &order);
        permute(&mut self.cells, from, &order);
        for column in &mut self.columns {
            if column.len() >= to {
                permute(column, from, &order);
            }
        }
    }

    /// Ranges of rows in canonical order, own and ghosts together: a cell is wholly the one or
    /// the other, so they follow each other in runs. `runs` is cleared first.
    pub fn runs(&self, runs: &mut Vec<std::ops::Range<usize>>) {
        runs.clear();
        let (mut own, mut ghost) = (0, self.own);
        while own < self.own || ghost < self.rows() {
            let take_own =
                ghost == self.rows() || (own < self.own && self.key(own) < self.key(ghost));
            let (start, end, other, other_end) = if take_own {
                (own, self.own, ghost, self.rows())
            } else {
                (ghost, self.rows(), own, self.own)
            };
            let stop = if other == other_end {
                end
            } else {
                let limit = self.key(other);
                start + partition_point(start, end, |r| self.key(r) < limit)
            };
            if take_own {
                own = stop
            } else {
                ghost = stop
            }
            runs.push(start..stop);
        }
    }
}

impl<const D: usize> AsMut<Block<D>> for Block<D> {
    fn as_mut(&mut self) -> &mut Block<D> {
        self
    }
}

fn partition_point(from: usize, to: usize, below: impl Fn(usize) -> bool) -> usize {
    let (mut lo, mut hi) = (from, to);
    while lo < hi {
        let mid = lo + (hi - lo) / 2;
        if below(mid) { lo = mid + 1 } else { hi = mid }
    }
    lo - from
}

fn permute<T: Copy>(values: &mut [T], from: usize, order: &[usize]) {
    let sorted: Vec<T> = order.iter().map(|&r| values[r]).collect();
    values[from..from + sorted.len()].copy_from_slice(&sorted);
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPECS: [ColumnSpec; 2] = [
        ColumnSpec { name: "a", unit: "m", ghost: true, state: true, mirror: Mirror::Same },
        ColumnSpec { name: "b", unit: "m", ghost: false, state: true, mirror: Mirror::Same },
    ];

    #[test]
    fn sorting_moves_whole_rows() {
        let mut block = Block::<2>::new(&SPECS);
        block.push(7, [1, 0], &[7.0, 70.0]);
        block.push(3, [1, 0], &[3.0, 30.0]);
        block.push(9, [0, 1], &[9.0, 90.0]);
        block.push(8, [0, 0], &[8.0, 80.0]);
        block.sort_own();
        assert_eq!(block.ids, [8, 3, 7, 9]);
        assert_eq!(block.columns[0], [8.0, 3.0, 7.0, 9.0]);
        assert_eq!(block.columns[1], [80.0, 30.0, 70.0, 90.0]);
    }

    #[test]
    fn runs_interleave_own_rows_and_ghosts_by_cell() {
        let mut block = Block::<2>::new(&SPECS);
        for (id, x, y) in [(1, 2, 0), (2, 3, 0), (3, 2, 1), (4, 3, 1)] {
            block.push(id, [x, y], &[0.0, 0.0]);
        }
        for (id, x, y) in [(5, 1, 0), (6, 4, 0), (7, 1, 1)] {
            block.push_ghost(id, [x, y], &[0.0]);
        }
        let mut runs = Vec::new();
        block.runs(&mut runs);
        let ids: Vec<u64> = runs.iter().cloned().flatten().map(|r| block.ids[r]).collect();
        assert_eq!(ids, [5, 1, 2, 6, 7, 3, 4]);
    }
}
