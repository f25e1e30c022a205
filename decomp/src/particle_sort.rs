//! Canonical order of the particles of a block: particles out of order are found, sorted and moved.

use std::ops::Range;

use crate::counting_sort::CountingSort;
use crate::particle_block::{Block, place};
use crate::{IndexBox, array};

/// Number of particles that are compared together, and up to which they are inserted one by one.
const CHUNK: usize = 64;

/// Number of misplaced particles of a larger range up to which they are inserted one by one too.
const FEW: usize = 8;

/// Greatest number of cells per particle of a range for which the particles of cells are counted.
const CELLS_PER_PARTICLE: usize = 4;

/// Least number of particles of a section for which a call of a copy is cheaper than single moves.
const LONG: usize = 3;

/// Range of particles that are out of order, and the greatest of their keys.
#[derive(Clone, Copy, Debug)]
struct Disorder {
    start: usize,
    end: usize,
    greatest: u128,
}

/// Buffers of a sort, kept from one block and step to the next.
#[derive(Clone, Debug)]
pub(crate) struct SortBuffers<const D: usize> {
    ranges: Vec<Disorder>,
    /// Particles of a range in their order.
    order: Vec<u32>,
    counting: CountingSort,
    moves: Moves,
    words: Vec<u64>,
    cells: Vec<[i32; D]>,
    numbers: Vec<f64>,
}

/// Moves of particles to their places.
#[derive(Clone, Debug, Default)]
struct Moves {
    /// Long sections that move towards the start, and towards the end. Their order among each other
    /// stays, so that they need no buffer. A section that comes from far behind makes all later ones
    /// of its range single moves.
    down: Vec<Section>,
    up: Vec<Section>,
    /// Old place of every other particle that moves, and its new place.
    from: Vec<u32>,
    to: Vec<u32>,
}

impl<const D: usize> Default for SortBuffers<D> {
    fn default() -> Self {
        SortBuffers {
            ranges: Vec::new(),
            order: Vec::new(),
            counting: CountingSort::default(),
            moves: Moves::default(),
            words: Vec::new(),
            cells: Vec::new(),
            numbers: Vec::new(),
        }
    }
}

/// Neighbouring particles that a sort moves together.
#[derive(Clone, Copy, Debug)]
struct Section {
    to: usize,
    from: usize,
    count: usize,
}

impl<const D: usize> Block<D> {
    /// Restores the canonical order of the own particles.
    pub fn sort_own(&mut self) {
        self.sort_own_from(0);
    }

    /// Restores the canonical order of the own particles from `first` on.
    pub fn sort_own_from(&mut self, first: usize) {
        self.sort(first, &mut SortBuffers::default());
    }

    /// The same with buffers of former sorts.
    pub(crate) fn sort(&mut self, first: usize, buffers: &mut SortBuffers<D>) {
        self.find_disorder(first..self.own(), &mut buffers.ranges);
        // most steps keep the order or move few particles
        if buffers.ranges.is_empty() {
            return;
        }
        self.find_moves(buffers);
        let SortBuffers { moves, words, cells, numbers, .. } = buffers;
        moves.apply(&mut self.ids, words);
        moves.apply(&mut self.cells, cells);
        for column in &mut self.columns {
            moves.apply(column, numbers);
        }
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
    fn find_moves(&self, buffers: &mut SortBuffers<D>) {
        let SortBuffers { ranges, order, counting, moves, .. } = buffers;
        moves.clear();
        for range in ranges {
            let particles = range.start..range.end;
            order.clear();
            order.extend(particles.start as u32..particles.end as u32);
            self.sort_few_or_many(order, counting);
            let mut to = particles.start;
            for section in order.chunk_by(|particle, next| particle + 1 == *next) {
                moves.push(Section { to, from: section[0] as usize, count: section.len() });
                to += section.len();
            }
        }
    }

    /// Sorts particles of a range by their keys.
    fn sort_few_or_many(&self, order: &mut [u32], counting: &mut CountingSort) {
        let key = |particle: u32| self.key(particle as usize);
        let misplaced = || order.windows(2).filter(|pair| key(pair[0]) > key(pair[1])).count();
        if order.len() > CHUNK && misplaced() > FEW {
            return self.sort_many(order, counting);
        }
        for k in 1..order.len() {
            let particle = order[k];
            if key(order[k - 1]) > key(particle) {
                let place = order[..k].partition_point(|&before| key(before) < key(particle));
                order[place..=k].rotate_right(1);
            }
        }
    }

    /// Sorts many particles of a range by their keys.
    fn sort_many(&self, order: &mut [u32], counting: &mut CountingSort) {
        let particles = order[0] as usize..order[0] as usize + order.len();
        let cells = &self.cells[particles.clone()];
        let lower = cells.iter().fold(cells[0], |l, c| array::from_fn(|a| l[a].min(c[a])));
        let upper = cells.iter().fold(cells[0], |u, c| array::from_fn(|a| u[a].max(c[a])));
        let all =
            IndexBox::new(array::map(&lower, i64::from), array::map(&upper, |u| i64::from(u) + 1));
        if all.count() > CELLS_PER_PARTICLE * order.len() {
            return order.sort_unstable_by_key(|&particle| self.key(particle as usize));
        }
        let first = order[0];
        let cell_numbers = cells.iter().map(|cell| all.flat(array::map(cell, i64::from)) as u32);
        counting.sort(all.count(), cell_numbers, self.ids[particles].iter().copied());
        order.iter_mut().zip(&counting.order).for_each(|(to, &number)| *to = first + number);
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
}

impl Moves {
    fn clear(&mut self) {
        let Moves { down, up, from, to } = self;
        down.clear();
        up.clear();
        from.clear();
        to.clear();
    }

    /// Adds a section behind the others, if it moves.
    fn push(&mut self, section: Section) {
        let Section { to, from, count } = section;
        let end = |sections: &[Section]| sections.last().map_or(0, |last| last.from + last.count);
        if to == from {
            return;
        }
        if count < LONG || from < end(&self.down).max(end(&self.up)) {
            self.from.extend(from as u32..(from + count) as u32);
            self.to.extend(to as u32..(to + count) as u32);
        } else if to < from {
            self.down.push(section);
        } else {
            self.up.push(section);
        }
    }

    /// Moves values; `buffer` is cleared first.
    fn apply<T: Copy>(&self, values: &mut [T], buffer: &mut Vec<T>) {
        buffer.clear();
        buffer.extend(self.from.iter().map(|&from| values[from as usize]));
        // in this order no section overwrites another that has not moved yet
        for &Section { to, from, count } in self.down.iter().chain(self.up.iter().rev()) {
            values.copy_within(from..from + count, to);
        }
        self.to.iter().zip(&*buffer).for_each(|(&to, value)| values[to as usize] = *value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ColumnSpec, Mirror};

    const SPECS: [ColumnSpec; 2] = [
        ColumnSpec { name: "a", unit: "m", ghost: true, state: true, mirror: Mirror::Same },
        ColumnSpec { name: "b", unit: "m", ghost: false, state: true, mirror: Mirror::Same },
    ];

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
            // dense and sparse cells
            check(&cells);
            check(&cells.iter().map(|cell| 50 * cell).collect::<Vec<_>>());
        }
    }

    /// Several particles per cell of a plane, with ids in any order within a cell.
    #[test]
    fn particles_of_a_plane_are_sorted_by_cell_and_id() {
        let mut block = Block::<2>::new(&SPECS);
        let mut seed = 7u64;
        for k in 0..400_u64 {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let cell = [(k / 4 % 10) as i32, (k / 40) as i32 + (seed >> 40) as i32 % 2];
            let id = (k * 77) % 400;
            block.push(id, cell, &[id as f64, f64::from(cell[1])]);
        }
        block.sort_own();
        assert!((1..400).all(|r| block.key(r - 1) < block.key(r)));
        for r in 0..400 {
            assert_eq!(block.columns[0][r], block.ids[r] as f64);
            assert_eq!(block.columns[1][r], f64::from(block.cells[r][1]));
        }
    }
}
