//! Whole patches from rank to rank.

use crate::ghost_exchange::with_sends;
use crate::{Block, Comm, Layout};

/// What a relocation moved, as seen by one rank.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Moved {
    /// Patches that this rank gave away.
    pub patches: u64,
    /// Rows in them.
    pub rows: u64,
}

/// Brings the patches of a rank from the assignment of `old` to that of `new`, which cut the
/// domain alike. `patches` are this rank's by `old`, in order; returned are those by `new`, in
/// order: a patch that stays is left as it is, one that arrives is made by `make` from its number
/// and rows. Rows travel without ghosts and with the columns that are declared as state, the
/// others arrive as zeros. Collective.
pub fn relocate<const D: usize, P: AsMut<Block<D>>>(
    comm: &dyn Comm,
    old: &Layout<D>,
    new: &Layout<D>,
    patches: Vec<P>,
    specs: &[crate::ColumnSpec],
    mut make: impl FnMut(usize, Block<D>) -> P,
) -> (Vec<P>, Moved) {
    let rank = comm.rank();
    let mut moved = Moved::default();
    let mut here: Vec<(usize, P)> = Vec::new();
    let mut send_ranks: Vec<usize> = Vec::new();
    let mut messages: Vec<Vec<u64>> = Vec::new();
    for (patch, mut content) in old.patches_of(rank).into_iter().zip(patches) {
        let to = new.rank_of(patch);
        if to == rank {
            here.push((patch, content));
            continue;
        }
        let at = send_ranks.iter().position(|&r| r == to).unwrap_or_else(|| {
            send_ranks.push(to);
            messages.push(Vec::new());
            messages.len() - 1
        });
        let block = content.as_mut();
        block.drop_ghosts();
        moved.patches += 1;
        moved.rows += block.own() as u64;
        pack(&mut messages[at], patch, block);
    }
    let arriving = new.patches_of(rank).into_iter().map(|p| old.rank_of(p)).filter(|&r| r != rank);
    let mut receive_ranks: Vec<usize> = arriving.collect();
    receive_ranks.sort_unstable();
    receive_ranks.dedup();
    let mut received = Vec::new();
    if !send_ranks.is_empty() || !receive_ranks.is_empty() {
        with_sends(&send_ranks, &messages, |sends| {
            comm.exchange(sends, &receive_ranks, &mut received, &mut || {})
        });
    }
    for words in received {
        let mut words = &words[..];
        while let Some((&patch, rest)) = words.split_first() {
            let (block, rest) = unpack(specs, rest);
            here.push((patch as usize, make(patch as usize, block)));
            words = rest;
        }
    }
    here.sort_by_key(|(patch, _)| *patch);
    (here.into_iter().map(|(_, content)| content).collect(), moved)
}

/// Number of the patch, number of rows, ids, cells, then each state column.
pub(crate) fn pack<const D: usize>(out: &mut Vec<u64>, patch: usize, block: &Block<D>) {
    let rows = block.own();
    out.extend([patch as u64, rows as u64]);
    out.extend(&block.ids[..rows]);
    for cell in &block.cells[..rows] {
        out.extend(cell.map(|c| i64::from(c) as u64));
    }
    for (_, column) in block.specs().iter().zip(&block.columns).filter(|(s, _)| s.state) {
        out.extend(column[..rows].iter().map(|v| v.to_bits()));
    }
}

pub(crate) fn unpack<'a, const D: usize>(
    specs: &[crate::ColumnSpec],
    words: &'a [u64],
) -> (Block<D>, &'a [u64]) {
    let rows = words[0] as usize;
    let (ids, words) = words[1..].split_at(rows);
    let (cells, mut words) = words.split_at(rows * D);
    let mut columns: Vec<&[u64]> = Vec::new();
    for _ in specs.iter().filter(|s| s.state) {
        let (column, rest) = words.split_at(rows);
        columns.push(column);
        words = rest;
    }
    let mut block = Block::new(specs);
    let mut row = vec![0.0; specs.len()];
    for r in 0..rows {
        let state = specs.iter().zip(&mut row).filter(|(s, _)| s.state);
        for ((_, value), column) in state.zip(&columns) {
            *value = f64::from_bits(column[r]);
        }
        let cell = std::array::from_fn(|a| cells[r * D + a] as i64 as i32);
        block.push(ids[r], cell, &row);
    }
    (block, words)
}

/// Marks of rows that show whether any was lost, doubled or changed where it must not: the
/// number of rows, and a sum over rows of a hash of id and of some values that never change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Census {
    /// Number of rows.
    pub rows: u64,
    /// Sum of the marks, modulo 2^64.
    pub marks: u64,
}

impl Census {
    /// Counts a row.
    pub fn add(&mut self, id: u64, value: f64) {
        self.rows += 1;
        self.marks = self.marks.wrapping_add(mix(mix(id) ^ value.to_bits()));
    }

    /// Takes in what another has counted.
    pub fn join(&mut self, other: Census) {
        self.rows += other.rows;
        self.marks = self.marks.wrapping_add(other.marks);
    }

    /// What all ranks together have counted. Collective.
    pub fn over_ranks(self, comm: &dyn Comm) -> Census {
        // halves leave room for the sum over 2^31 ranks
        let halves = |w: u64| [i64::from(w as u32), (w >> 32) as i64];
        let ([a, b], [c, d]) = (halves(self.rows), halves(self.marks));
        let mut sums = [a, b, c, d];
        comm.sum(&mut sums);
        let whole = |low: i64, high: i64| (low as u64).wrapping_add((high as u64) << 32);
        Census { rows: whole(sums[0], sums[1]), marks: whole(sums[2], sums[3]) }
    }
}

/// The finalizer of SplitMix64 (Steele, Lea & Flood 2014).
fn mix(mut z: u64) -> u64 {
    z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ColumnSpec, Mirror};

    const SPECS: [ColumnSpec; 3] = [
        ColumnSpec { name: "a", unit: "m", ghost: true, state: true, mirror: Mirror::Same },
        ColumnSpec { name: "b", unit: "m", ghost: true, state: false, mirror: Mirror::Same },
        ColumnSpec { name: "c", unit: "m", ghost: false, state: true, mirror: Mirror::Same },
    ];

    #[test]
    fn a_packed_patch_comes_out_with_its_state() {
        let mut block = Block::<2>::new(&SPECS);
        block.push(7, [1, -2], &[7.0, 8.0, 9.0]);
        block.push(3, [1, 5], &[3.5, 1.0, -0.0]);
        let mut words = Vec::new();
        pack(&mut words, 4, &block);
        pack(&mut words, 5, &Block::<2>::new(&SPECS));
        let (out, rest) = unpack::<2>(&SPECS, &words[1..]);
        assert_eq!((&out.ids, &out.cells), (&block.ids, &block.cells));
        assert_eq!(out.columns[0], [7.0, 3.5]);
        assert_eq!(out.columns[1], [0.0, 0.0]);
        assert_eq!(out.columns[2][1].to_bits(), (-0.0f64).to_bits());
        assert_eq!(unpack::<2>(&SPECS, &rest[1..]).0.own(), 0);
    }

    #[test]
    fn a_census_sees_rows_lost_doubled_and_changed() {
        let count = |rows: &[(u64, f64)]| {
            let mut census = Census::default();
            rows.iter().for_each(|r| census.add(r.0, r.1));
            census
        };
        let whole = count(&[(1, 0.5), (2, 0.5), (3, 0.25)]);
        assert_eq!(whole, count(&[(3, 0.25), (1, 0.5), (2, 0.5)]));
        for other in [
            &[(1, 0.5), (2, 0.5)][..],
            &[(1, 0.5), (2, 0.5), (2, 0.5)],
            &[(1, 0.5), (2, 0.25), (3, 0.5)],
        ] {
            assert_ne!(whole, count(other));
        }
    }
}
