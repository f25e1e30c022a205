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

impl ColumnSpec {
    /// The value in an image that is mirrored in the directions of `flip`, in the unit of the
    /// column.
    pub fn image(&self, value: f64, flip: &[bool]) -> f64 {
        match self.mirror {
            Mirror::Negate(a) if flip[a] => -value,
            Mirror::NegatePair(a, b) if flip[a] != flip[b] => -value,
            Mirror::Complement(a) if flip[a] => 1.0 - value,
            _ => value,
        }
    }
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
    ghost_columns: Vec<usize>,
    own: usize,
    moves: Moves<D>,
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
            moves: Moves::default(),
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

    /// Adds ghosts; `columns` holds one section of words per ghost column.
    pub(crate) fn extend_ghosts(
        &mut self,
        ids: &[u64],
        cells: impl Iterator<Item = [i32; D]>,
        columns: &[u64],
    ) {
        self.ids.extend_from_slice(ids);
        self.cells.extend(cells);
        for (&c, words) in self.ghost_columns.iter().zip(columns.chunks_exact(ids.len())) {
            self.columns[c].extend(words.iter().map(|&w| f64::from_bits(w)));
        }
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

    /// Restores the canonical order of the own particles.
    pub fn sort_own(&mut self) {
        self.sort(0, self.own);
    }

    /// Restores the canonical order of the ghosts.
    pub(crate) fn sort_ghosts(&mut self) {
        self.sort(self.own, self.particles());
    }

    /// Key of the canonical order: cell, the last direction first, then id. It is one number, so
    /// that comparisons need no branch.
    fn key(&self, particle: usize) -> u128 {
        let cell = place(&self.cells[particle]) as u64 ^ (1 << 63);
        (u128::from(cell) << 64) | u128::from(self.ids[particle])
    }

    fn sort(&mut self, from: usize, to: usize) {
        let mut moves = std::mem::take(&mut self.moves);
        self.find_disorder(from..to, &mut moves.ranges);
        // most steps keep the order or move few particles
        if !moves.ranges.is_empty() {
            self.find_moves(&mut moves);
            permute(&mut self.ids, &moves.moved, &mut moves.words);
            permute(&mut self.cells, &moves.moved, &mut moves.places);
            for column in &mut self.columns {
                if column.len() >= to {
                    permute(column, &moves.moved, &mut moves.numbers);
                }
            }
        }
        self.moves = moves;
    }

    /// Finds the ranges of `particles` that are in order once each of them is sorted. Disorder is
    /// local: a particle that enters the next cell passes the others of one or two cells, or of a
    /// line of cells.
    fn find_disorder(&self, particles: Range<usize>, ranges: &mut Vec<Disorder>) {
        ranges.clear();
        let (from, to) = (particles.start, particles.end);
        let mut at = from + 1;
        while at < to {
            let next = to.min(at + CHUNK);
            if self.misplaced(at - 1..next) == 0 {
                at = next;
                continue;
            }
            while self.key(at - 1) <= self.key(at) {
                at += 1;
            }
            let greatest = self.key(at - 1);
            let (mut least, mut start, mut end) = (self.key(at), at - 1, at + 1);
            while end < to && self.key(end) < greatest {
                least = least.min(self.key(end));
                end += 1;
            }
            while start > from {
                match ranges.last() {
                    Some(last) if last.end == start && last.greatest < least => break,
                    Some(last) if last.end == start => {
                        start = last.start;
                        ranges.pop();
                    }
                    _ if self.key(start - 1) < least => break,
                    _ => start -= 1,
                }
            }
            ranges.push(Disorder { start, end, greatest });
            at = end;
        }
    }

    /// Finds the moves that sort each of the ranges.
    fn find_moves(&self, moves: &mut Moves<D>) {
        let Moves { ranges, order, moved, .. } = moves;
        moved.clear();
        for range in ranges {
            order.clear();
            order.extend(range.start as u32..range.end as u32);
            self.sort_few_or_many(order);
            for (to, &particle) in (range.start..range.end).zip(&*order) {
                let particle = particle as usize;
                match moved.last_mut().filter(|last| last.follow([to, particle])) {
                    Some(last) => last.count += 1,
                    None if to == particle => {}
                    None => moved.push(Moved { to, from: particle, count: 1 }),
                }
            }
        }
    }

    /// Sorts particles by their keys.
    fn sort_few_or_many(&self, order: &mut [u32]) {
        let key = |particle: u32| self.key(particle as usize);
        let misplaced = || order.windows(2).filter(|pair| key(pair[0]) > key(pair[1])).count();
        if order.len() > CHUNK && misplaced() > FEW {
            // most are still in order among themselves: the others are sorted and merged in
            return dmsort::sort_by(order, |&a, &b| key(a).cmp(&key(b)));
        }
        for k in 1..order.len() {
            let particle = order[k];
            if key(order[k - 1]) > key(particle) {
                let place = order[..k].partition_point(|&before| key(before) < key(particle));
                order[place..=k].rotate_right(1);
            }
        }
    }

    /// Number of particles that stand behind one of a later place.
    fn misplaced(&self, particles: Range<usize>) -> usize {
        let (cells, ids) = (&self.cells[particles.clone()], &self.ids[particles]);
        let Some(last) = ids.len().checked_sub(1) else { return 0 };
        let before = cells[..last].iter().zip(&ids[..last]);
        let after = cells[1..].iter().zip(&ids[1..]);
        // no branch per particle, so that several are compared at a time
        let misplaced = before.zip(after).map(|((cell, id), (next, next_id))| {
            let (cell, next) = (place(cell), place(next));
            usize::from((cell > next) | ((cell == next) & (id > next_id)))
        });
        misplaced.sum()
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

/// Number of particles that are compared together, and up to which they are inserted one by one, which
/// asks for no memory.
const CHUNK: usize = 64;

/// Number of misplaced particles of a larger range up to which they are inserted one by one too.
const FEW: usize = 8;

/// Range of particles that are out of order, and the greatest of their keys.
#[derive(Clone, Copy, Debug)]
struct Disorder {
    start: usize,
    end: usize,
    greatest: u128,
}

/// Buffers of a sort.
#[derive(Clone, Debug)]
struct Moves<const D: usize> {
    ranges: Vec<Disorder>,
    /// Particles of a range in their order.
    order: Vec<u32>,
    moved: Vec<Moved>,
    words: Vec<u64>,
    places: Vec<[i32; D]>,
    numbers: Vec<f64>,
}

impl<const D: usize> Default for Moves<D> {
    fn default() -> Self {
        Moves {
            ranges: Vec::new(),
            order: Vec::new(),
            moved: Vec::new(),
            words: Vec::new(),
            places: Vec::new(),
            numbers: Vec::new(),
        }
    }
}

/// Place of a cell in the canonical order, the last direction first.
fn place<const D: usize>(cell: &[i32; D]) -> i64 {
    const { assert!(0 < D && D <= 2, "at most two cell numbers fill the place") }
    // the low half as an unsigned number in the same order
    let low = i64::from(cell[0] as u32 ^ (1 << 31));
    (if D == 1 { 0 } else { i64::from(cell[D - 1]) << 32 }) | low
}

/// Neighbouring particles that a sort moves together.
#[derive(Clone, Copy, Debug)]
struct Moved {
    to: usize,
    from: usize,
    count: usize,
}

impl Moved {
    /// Whether the next particle, moved to `to` from `from`, moves together with these.
    fn follow(&self, [to, from]: [usize; 2]) -> bool {
        [self.to + self.count, self.from + self.count] == [to, from]
    }
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

/// Moves values; those outside of `moved` are not touched, `buffer` is cleared first.
fn permute<T: Copy>(values: &mut [T], moved: &[Moved], buffer: &mut Vec<T>) {
    buffer.clear();
    for &Moved { from, count, .. } in moved {
        match count {
            // mostly; cheaper than a call
            1 => buffer.push(values[from]),
            _ => buffer.extend_from_slice(&values[from..from + count]),
        }
    }
    let mut sorted = &buffer[..];
    for &Moved { to, count, .. } in moved {
        let (these, rest) = sorted.split_at(count);
        match these {
            [value] => values[to] = *value,
            _ => values[to..to + count].copy_from_slice(these),
        }
        sorted = rest;
    }
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
        let of = |mirror, flip: [bool; 2]| ColumnSpec { mirror, ..SPECS[0] }.image(0.25, &flip);
        let sides = [[false, false], [true, false], [false, true], [true, true]];
        for (mirror, wanted) in [
            (Mirror::Same, [0.25, 0.25, 0.25, 0.25]),
            (Mirror::Negate(0), [0.25, -0.25, 0.25, -0.25]),
            // two reflections in a corner restore the sign
            (Mirror::NegatePair(0, 1), [0.25, -0.25, -0.25, 0.25]),
            (Mirror::Complement(1), [0.25, 0.25, 0.75, 0.75]),
        ] {
            assert_eq!(sides.map(|flip| of(mirror, flip)), wanted, "{mirror:?}");
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
    fn particles_out_of_place_come_back_few_or_many() {
        for moved in [1, 3, 40] {
            let mut block = Block::<1>::new(&SPECS);
            for id in 0..100 {
                let cell = if id % (100 / moved) == 7 % (100 / moved) {
                    100 - id as i32
                } else {
                    id as i32
                };
                block.push(id, [cell], &[id as f64, cell as f64]);
            }
            block.sort_own();
            for r in 0..100 {
                assert!(r == 0 || block.key(r - 1) < block.key(r));
                assert_eq!(block.columns[0][r], block.ids[r] as f64);
                assert_eq!(block.columns[1][r], block.cells[r][0] as f64);
            }
        }
    }

    /// Particles that pass one, some, or a whole line of others, in several places at once, with
    /// ranges of disorder that touch or enclose each other.
    #[test]
    fn any_disorder_is_sorted() {
        let check = |cells: &[i32]| {
            let mut block = Block::<1>::new(&SPECS);
            for (id, &cell) in cells.iter().enumerate() {
                block.push(id as u64, [cell], &[id as f64, f64::from(cell)]);
            }
            block.sort_own();
            let mut expected: Vec<(i32, u64)> = cells.iter().copied().zip(0..).collect();
            expected.sort_unstable();
            let sorted: Vec<_> = block.cells.iter().map(|c| c[0]).zip(block.ids.clone()).collect();
            assert_eq!(sorted, expected, "{cells:?}");
            assert!(block.columns[0].iter().zip(&block.ids).all(|(c, id)| *c == *id as f64));
            assert!(
                block.columns[1].iter().zip(&block.cells).all(|(c, at)| *c == f64::from(at[0]))
            );
        };
        for cells in [
            &[2, 1][..],
            &[1, 3, 2, 5, 4, 6],
            // the third range encloses the first two
            &[1, 3, 2, 5, 4, 9, 0],
            &[5, 1, 2, 3, 4, 6, 7],
            &[9, 1, 8, 2, 7, 3],
        ] {
            check(cells);
        }
        let mut seed = 1u64;
        let mut random = |below: u64| {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 33) % below
        };
        for round in 0..200 {
            let mut cells: Vec<i32> = (0..300).map(|k| k / 3).collect();
            for _ in 0..round % 40 {
                let (at, by) = (random(300) as usize, [1, -1, 7, -60][random(4) as usize]);
                cells[at] += by;
            }
            check(&cells);
        }
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
        for (id, x, y) in [(1, 2, 0), (2, 3, 0), (3, 2, 1), (4, 3, 1)] {
            block.push(id, [x, y], &[0.0, 0.0]);
        }
        let cells = [[1, 0], [4, 0], [1, 1]].into_iter();
        block.extend_ghosts(&[5, 6, 7], cells, &[0; 3]);
        let mut runs = Vec::new();
        block.runs(&mut runs);
        let ids: Vec<u64> = runs.iter().cloned().flatten().map(|r| block.ids[r]).collect();
        assert_eq!(ids, [5, 1, 2, 6, 7, 3, 4]);
    }
}
