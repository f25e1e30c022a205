//! Moves whole patches from rank to rank.

use crate::ghost_exchange::with_sends;
use crate::{Block, Comm, Layout};

/// Amount of data that one rank gave away in a relocation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Moved {
    /// Number of patches.
    pub patches: u64,
    /// Number of particles in these patches.
    pub particles: u64,
}

/// Moves the patches of this rank from the assignment `old` to the assignment `new`; both layouts
/// cut the domain alike. `patches` are this rank's patches by `old`, in order; the result holds its
/// patches by `new`, in order. A patch that stays is unchanged; for a patch that arrives, `make`
/// builds it from its number and particles. Particles travel without ghosts and with their state
/// columns only; other columns arrive as zeros. Collective.
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
        moved.particles += block.own() as u64;
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
            let mut block = Block::new(specs);
            let rest = unpack_into(&mut block, rest);
            here.push((patch as usize, make(patch as usize, block)));
            words = rest;
        }
    }
    here.sort_by_key(|(patch, _)| *patch);
    (here.into_iter().map(|(_, content)| content).collect(), moved)
}

/// Packs a patch: number of the patch, number of particles, ids, cells, then each state column.
pub(crate) fn pack<const D: usize>(out: &mut Vec<u64>, patch: usize, block: &Block<D>) {
    let particles = block.own();
    out.extend([patch as u64, particles as u64]);
    out.extend(&block.ids[..particles]);
    for cell in &block.cells[..particles] {
        out.extend(cell.map(|c| i64::from(c) as u64));
    }
    for (_, column) in block.specs().iter().zip(&block.columns).filter(|(s, _)| s.state) {
        out.extend(column[..particles].iter().map(|v| v.to_bits()));
    }
}

/// Adds the particles of a packed patch, without its number, to `block`; returns the words after
/// them.
pub(crate) fn unpack_into<'a, const D: usize>(block: &mut Block<D>, words: &'a [u64]) -> &'a [u64] {
    let specs = block.specs().to_vec();
    let particles = words[0] as usize;
    let (ids, words) = words[1..].split_at(particles);
    let (cells, mut words) = words.split_at(particles * D);
    let mut columns: Vec<&[u64]> = Vec::new();
    for _ in specs.iter().filter(|s| s.state) {
        let (column, rest) = words.split_at(particles);
        columns.push(column);
        words = rest;
    }
    let mut particle = vec![0.0; specs.len()];
    for r in 0..particles {
        let state = specs.iter().zip(&mut particle).filter(|(s, _)| s.state);
        for ((_, value), column) in state.zip(&columns) {
            *value = f64::from_bits(column[r]);
        }
        let cell = std::array::from_fn(|a| cells[r * D + a] as i64 as i32);
        block.push(ids[r], cell, &particle);
    }
    words
}

/// Checksum of particles that reveals lost, duplicated or wrongly changed particles: the number of
/// particles, and the sum over particles of a hash of the id and of a value that never changes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Census {
    /// Number of particles.
    pub particles: u64,
    /// Sum of the hashes, modulo 2^64.
    pub marks: u64,
}

impl Census {
    /// Adds one particle.
    #[inline]
    pub fn add(&mut self, id: u64, value: f64) {
        self.particles += 1;
        self.marks = self.marks.wrapping_add(mix(mix(id) ^ value.to_bits()));
    }

    /// Adds the counts of `other`.
    pub fn join(&mut self, other: Census) {
        self.particles += other.particles;
        self.marks = self.marks.wrapping_add(other.marks);
    }

    /// The census over all ranks. Collective.
    pub fn over_ranks(self, comm: &dyn Comm) -> Census {
        // halves of 32 bits leave room for the sum over 2^31 ranks
        let halves = |w: u64| [i64::from(w as u32), (w >> 32) as i64];
        let ([a, b], [c, d]) = (halves(self.particles), halves(self.marks));
        let mut sums = [a, b, c, d];
        comm.sum(&mut sums);
        let whole = |low: i64, high: i64| (low as u64).wrapping_add((high as u64) << 32);
        Census { particles: whole(sums[0], sums[1]), marks: whole(sums[2], sums[3]) }
    }
}

/// The finalizer of SplitMix64 (Steele, Lea & Flood 2014).
#[inline]
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
        let mut out = Block::<2>::new(&SPECS);
        let rest = unpack_into(&mut out, &words[1..]);
        assert_eq!((&out.ids, &out.cells), (&block.ids, &block.cells));
        assert_eq!(out.columns[0], [7.0, 3.5]);
        assert_eq!(out.columns[1], [0.0, 0.0]);
        assert_eq!(out.columns[2][1].to_bits(), (-0.0f64).to_bits());
        let mut empty = Block::<2>::new(&SPECS);
        assert!(unpack_into(&mut empty, &rest[1..]).is_empty());
        assert_eq!(empty.own(), 0);
    }

    #[test]
    fn a_census_sees_particles_lost_doubled_and_changed() {
        let count = |particles: &[(u64, f64)]| {
            let mut census = Census::default();
            particles.iter().for_each(|r| census.add(r.0, r.1));
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
