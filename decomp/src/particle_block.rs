//! Particles of a patch: ids, cells, and declared columns of `f64`.

use std::ops::Range;

use crate::IndexBox;

/// Transformation of a column's value in a mirror.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mirror {
    /// Unchanged.
    Same,
    /// Changes sign in a mirror normal to this axis: a vector component.
    Negate(usize),
    /// Changes sign in a mirror normal to either axis, and twice in both: a shear component.
    NegatePair(usize, usize),
    /// v becomes 1 - v in a mirror normal to this axis: a position within a cell, in cells.
    Complement(usize),
}

impl Mirror {
    /// Change of a value in an image that is mirrored in the directions of `flip`.
    pub(crate) fn in_image(self, flip: &[bool]) -> MirrorChange {
        match self {
            Mirror::Negate(a) if flip[a] => MirrorChange::Negate,
            Mirror::NegatePair(a, b) if flip[a] != flip[b] => MirrorChange::Negate,
            Mirror::Complement(a) if flip[a] => MirrorChange::Complement,
            _ => MirrorChange::None,
        }
    }
}

/// Change of a column's value in a mirrored image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MirrorChange {
    None,
    /// v becomes -v.
    Negate,
    /// v becomes 1 - v.
    Complement,
}

/// Declaration of a column; migration, ghosts, sorting and output use the list of these.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ColumnSpec {
    /// Name, also used in files.
    pub name: &'static str,
    /// SI unit.
    pub unit: &'static str,
    /// Whether ghosts carry it.
    pub ghost: bool,
    /// Whether it is part of the state: kept from one step to the next, and migrated.
    pub state: bool,
    /// Transformation in a mirror.
    pub mirror: Mirror,
}

/// The particles of one patch: its own particles, followed by copies of others ("ghosts").
///
/// Own particles are in canonical order, by cell (last direction slowest) and then by id; so are
/// the ghosts after them. A column without ghosts is as long as the number of own particles.
#[derive(Clone, Debug)]
pub struct Block<const D: usize> {
    /// Id of each particle, the same for the whole run.
    pub ids: Vec<u64>,
    /// Cell of each particle; outside the domain for images.
    pub cells: Vec<[i32; D]>,
    /// Values of each declared column, in the unit of its [`ColumnSpec`].
    pub columns: Vec<Vec<f64>>,
    /// The cells whose particles may change in this step; the particle exchange notifies the
    /// patches nearby.
    pub active: IndexBox<D>,
    /// Whether active cells of any patch are near enough to change a particle of this block.
    pub stirred: bool,
    specs: Vec<ColumnSpec>,
    /// Indices of the columns that ghosts carry.
    pub(crate) ghost_columns: Vec<usize>,
    own: usize,
}

impl<const D: usize> Block<D> {
    /// Creates a block without particles.
    pub fn new(specs: &[ColumnSpec]) -> Self {
        Block {
            ids: Vec::new(),
            cells: Vec::new(),
            columns: specs.iter().map(|_| Vec::new()).collect(),
            active: IndexBox::new([0; D], [0; D]),
            stirred: true,
            specs: specs.to_vec(),
            ghost_columns: (0..specs.len()).filter(|&c| specs[c].ghost).collect(),
            own: 0,
        }
    }

    /// The declarations of the columns.
    pub fn specs(&self) -> &[ColumnSpec] {
        &self.specs
    }

    /// Indices of the columns that ghosts carry.
    pub(crate) fn ghost_columns(&self) -> &[usize] {
        &self.ghost_columns
    }

    /// Number of own particles.
    pub fn own(&self) -> usize {
        self.own
    }

    /// Number of particles, ghosts included.
    pub fn particles(&self) -> usize {
        self.ids.len()
    }

    /// Mutable access to several columns at once; the indices `which` must differ.
    ///
    /// # Panics
    ///
    /// If an index is out of range or occurs twice.
    pub fn columns_mut<const N: usize>(&mut self, which: [usize; N]) -> [&mut [f64]; N] {
        self.columns
            .get_disjoint_mut(which)
            .expect("columns are declared and differ")
            .map(|c| c.as_mut_slice())
    }

    /// Reserves memory for `more` own particles, and no more.
    pub fn reserve(&mut self, more: usize) {
        self.ids.reserve_exact(more);
        self.cells.reserve_exact(more);
        self.columns.iter_mut().for_each(|column| column.reserve_exact(more));
    }

    /// Adds an own particle; `values` holds its columns in order, in their units. Sort afterwards.
    pub fn push(&mut self, id: u64, cell: [i32; D], values: &[f64]) {
        debug_assert_eq!(self.particles(), self.own, "own particles go before ghosts");
        self.ids.push(id);
        self.cells.push(cell);
        for (column, value) in self.columns.iter_mut().zip(values) {
            column.push(*value);
        }
        self.own += 1;
    }

    /// Removes the ghosts.
    pub fn drop_ghosts(&mut self) {
        let own = self.own;
        self.ids.truncate(own);
        self.cells.truncate(own);
        for column in &mut self.columns {
            column.truncate(own);
        }
    }

    /// Adds own particles; `columns` holds one section of words per column. Sort afterwards.
    pub(crate) fn extend_own(
        &mut self,
        ids: &[u64],
        cells: impl Iterator<Item = [i32; D]>,
        columns: &[u64],
    ) {
        debug_assert_eq!(self.particles(), self.own, "own particles go before ghosts");
        self.ids.extend_from_slice(ids);
        self.cells.extend(cells);
        for (column, words) in self.columns.iter_mut().zip(columns.chunks_exact(ids.len())) {
            column.extend(words.iter().map(|&w| f64::from_bits(w)));
        }
        self.own += ids.len();
    }

    /// Removes the own particles with the ascending indices `gone`. There must be no ghosts.
    pub fn remove(&mut self, gone: &[usize]) {
        debug_assert_eq!(self.particles(), self.own);
        take_out(&mut self.ids, gone);
        take_out(&mut self.cells, gone);
        for column in &mut self.columns {
            take_out(column, gone);
        }
        self.own = self.ids.len();
    }

    /// Key of the canonical order: cell, the last direction first, then id. It is one number, so
    /// that comparisons need no branch.
    pub(crate) fn key(&self, particle: usize) -> u128 {
        let cell = place(&self.cells[particle]) as u64 ^ (1 << 63);
        (u128::from(cell) << 64) | u128::from(self.ids[particle])
    }

    /// Ranges of particles in canonical order, own particles and ghosts together. A cell contains
    /// either own particles or ghosts, so they follow each other in runs. `runs` is cleared first.
    pub fn runs(&self, runs: &mut Vec<Range<usize>>) {
        runs.clear();
        let (mut own, mut ghost) = (0, self.own);
        while own < self.own || ghost < self.particles() {
            let take_own =
                ghost == self.particles() || (own < self.own && self.key(own) < self.key(ghost));
            let (start, end, other, other_end) = if take_own {
                (own, self.own, ghost, self.particles())
            } else {
                (ghost, self.particles(), own, self.own)
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

/// Place of a cell in the canonical order, the last direction first.
pub(crate) fn place<const D: usize>(cell: &[i32; D]) -> i64 {
    const { assert!(0 < D && D <= 2, "at most two cell numbers fill the place") }
    // the low half as an unsigned number in the same order
    let low = i64::from(cell[0] as u32 ^ (1 << 31));
    (if D == 1 { 0 } else { i64::from(cell[D - 1]) << 32 }) | low
}

/// Removes the elements at the ascending indices `gone`, except for indices past the end.
fn take_out<T: Copy>(values: &mut Vec<T>, gone: &[usize]) {
    let Some(&first) = gone.first().filter(|&&g| g < values.len()) else { return };
    let mut to = first;
    for (k, &g) in gone.iter().enumerate() {
        let next = gone.get(k + 1).copied().unwrap_or(values.len()).min(values.len());
        values.copy_within(g + 1..next, to);
        to += next - (g + 1);
    }
    values.truncate(to);
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPECS: [ColumnSpec; 2] = [
        ColumnSpec { name: "a", unit: "m", ghost: true, state: true, mirror: Mirror::Same },
        ColumnSpec { name: "b", unit: "m", ghost: false, state: true, mirror: Mirror::Same },
    ];

    #[test]
    fn images_turn_vectors_and_shear() {
        let sides = [[false, false], [true, false], [false, true], [true, true]];
        let (none, negate, complement) =
            (MirrorChange::None, MirrorChange::Negate, MirrorChange::Complement);
        for (mirror, wanted) in [
            (Mirror::Same, [none, none, none, none]),
            (Mirror::Negate(0), [none, negate, none, negate]),
            // two reflections in a corner restore the sign
            (Mirror::NegatePair(0, 1), [none, negate, negate, none]),
            (Mirror::Complement(1), [none, none, complement, complement]),
        ] {
            assert_eq!(sides.map(|flip| mirror.in_image(&flip)), wanted, "{mirror:?}");
        }
    }

    #[test]
    fn sorting_moves_whole_particles() {
        let mut block = Block::<2>::new(&SPECS);
        block.push(7, [1, 0], &[7.0, 70.0]);
        block.push(3, [1, 0], &[3.0, 30.0]);
        block.push(9, [0, 1], &[9.0, 90.0]);
        block.push(8, [0, 0], &[8.0, 80.0]);
        // images lie before the first cell
        block.push(4, [-1, 0], &[4.0, 40.0]);
        block.sort_own();
        assert_eq!(block.ids, [4, 8, 3, 7, 9]);
        assert_eq!(block.columns[0], [4.0, 8.0, 3.0, 7.0, 9.0]);
        assert_eq!(block.columns[1], [40.0, 80.0, 30.0, 70.0, 90.0]);
    }

    #[test]
    fn particles_are_taken_out() {
        for gone in [&[][..], &[0], &[4], &[0, 1, 4], &[1, 2, 3], &[0, 1, 2, 3, 4]] {
            let mut block = Block::<1>::new(&SPECS);
            (0..5).for_each(|id| block.push(id, [id as i32], &[id as f64, 0.5]));
            block.remove(gone);
            let left: Vec<u64> = (0..5).filter(|i| !gone.contains(&(*i as usize))).collect();
            assert_eq!((block.own(), &block.ids), (left.len(), &left));
            assert!(block.columns[0].iter().zip(&left).all(|(c, i)| *c == *i as f64));
        }
    }

    #[test]
    fn runs_interleave_own_particles_and_ghosts_by_cell() {
        let mut block = Block::<2>::new(&SPECS);
        let own = [(1, 2, 0), (2, 3, 0), (3, 2, 1), (4, 3, 1)];
        for (id, x, y) in own.into_iter().chain([(5, 1, 0), (6, 4, 0), (7, 1, 1)]) {
            block.push(id, [x, y], &[0.0, 0.0]);
        }
        block.own = own.len();
        let mut runs = Vec::new();
        block.runs(&mut runs);
        let ids: Vec<u64> = runs.iter().cloned().flatten().map(|r| block.ids[r]).collect();
        assert_eq!(ids, [5, 1, 2, 6, 7, 3, 4]);
    }
}
