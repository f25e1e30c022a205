//! Canonical order of the particles of a block: particles out of order are found, sorted and moved.

use std::ops::Range;

use crate::particle_block::{Block, place};

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

/// Buffers of a sort, kept from one block and step to the next.
#[derive(Clone, Debug)]
pub(crate) struct SortBuffers<const D: usize> {
    ranges: Vec<Disorder>,
    /// Particles of a range in their order.
    order: Vec<u32>,
    moved: Vec<Section>,
    words: Vec<u64>,
    cells: Vec<[i32; D]>,
    numbers: Vec<f64>,
}

impl<const D: usize> Default for SortBuffers<D> {
    fn default() -> Self {
        SortBuffers {
            ranges: Vec::new(),
            order: Vec::new(),
            moved: Vec::new(),
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

impl Section {
    /// Whether the next particle, moved to `to` from `from`, moves together with these.
    fn follow(&self, [to, from]: [usize; 2]) -> bool {
        [self.to + self.count, self.from + self.count] == [to, from]
    }
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
        let SortBuffers { moved, words, cells, numbers, .. } = buffers;
        permute(&mut self.ids, moved, words);
        permute(&mut self.cells, moved, cells);
        for column in &mut self.columns {
            permute(column, moved, numbers);
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
        let SortBuffers { ranges, order, moved, .. } = buffers;
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
                    None => moved.push(Section { to, from: particle, count: 1 }),
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
}

/// Moves values; those outside of `moved` are not touched, `buffer` is cleared first.
fn permute<T: Copy>(values: &mut [T], moved: &[Section], buffer: &mut Vec<T>) {
    buffer.clear();
    for &Section { from, count, .. } in moved {
        match count {
            // mostly; cheaper than a call
            1 => buffer.push(values[from]),
            _ => buffer.extend_from_slice(&values[from..from + count]),
        }
    }
    let mut sorted = &buffer[..];
    for &Section { to, count, .. } in moved {
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
            check(&cells);
        }
    }
}
