//! Particles of all ranks outside the patches: shares of them for files, and their way back to the
//! patches of any layout.

use std::collections::BTreeMap;

use crate::patch_migration::{pack, unpack_into};
use crate::{Block, ColumnSpec, Comm, Layout, assign_patches};

/// Some particles, with the data that one step leaves to the next: those of one rank, or any other
/// share of all.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StoredParticles {
    /// Id of each particle.
    pub ids: Vec<u64>,
    /// Cell of each particle, one number per direction, particle after particle.
    pub cells: Vec<i32>,
    /// The columns declared as state, in order of declaration and in their declared units.
    pub columns: Vec<Vec<f64>>,
}

impl StoredParticles {
    /// The own particles of `blocks`, in their order.
    pub fn of<'a, const D: usize>(
        specs: &[ColumnSpec],
        blocks: impl Iterator<Item = &'a Block<D>> + Clone,
    ) -> StoredParticles {
        let state = (0..specs.len()).filter(|&c| specs[c].state);
        let count = blocks.clone().map(Block::own).sum();
        let column = |c: usize| {
            let mut values = Vec::with_capacity(count);
            blocks.clone().for_each(|b| values.extend_from_slice(&b.columns[c][..b.own()]));
            values
        };
        let cells = blocks.clone().flat_map(|b| b.cells[..b.own()].iter().flatten().copied());
        StoredParticles {
            ids: blocks.clone().flat_map(|b| b.ids[..b.own()].iter().copied()).collect(),
            cells: cells.collect(),
            columns: state.map(column).collect(),
        }
    }

    /// The particles of several shares, one share after the other.
    pub fn joined(shares: impl IntoIterator<Item = StoredParticles>) -> StoredParticles {
        let mut shares = shares.into_iter();
        let mut all = shares.next().unwrap_or_default();
        for share in shares {
            all.ids.extend(share.ids);
            all.cells.extend(share.cells);
            all.columns.resize_with(share.columns.len().max(all.columns.len()), Vec::new);
            all.columns.iter_mut().zip(share.columns).for_each(|(all, more)| all.extend(more));
        }
        all
    }

    /// The cell of particle `r`.
    fn cell<const D: usize>(&self, r: usize) -> [i64; D] {
        std::array::from_fn(|a| i64::from(self.cells[D * r + a]))
    }

    /// A block of the particles with indices `which`; columns that are not state are zero.
    fn block<const D: usize>(&self, specs: &[ColumnSpec], which: &[usize]) -> Block<D> {
        let mut block = Block::new(specs);
        let mut particle = vec![0.0; specs.len()];
        for &r in which {
            let state = specs.iter().zip(&mut particle).filter(|(s, _)| s.state);
            for ((_, value), column) in state.zip(&self.columns) {
                *value = column[r];
            }
            block.push(self.ids[r], self.cell::<D>(r).map(|c| c as i32), &particle);
        }
        block
    }
}

/// The own particles of all ranks, distributed over some of the ranks in order of a key and then of
/// the id.
///
/// Columns are fetched one by one, which limits the memory of each rank to little more than its
/// share of the columns that it keeps.
pub struct Shares<'a, const D: usize> {
    comm: &'a dyn Comm,
    blocks: Vec<&'a Block<D>>,
    /// For each rank, the block and the index of each particle that it gets from this rank.
    sent: Vec<Vec<(u32, u32)>>,
    /// Ranks from which this rank gets particles.
    from: Vec<usize>,
    /// Positions of the particles of this rank's share among those that have arrived.
    order: Vec<usize>,
    /// Key of each particle of this rank's share, ascending.
    pub keys: Vec<u64>,
    /// Id of each particle of this rank's share.
    pub ids: Vec<u64>,
}

impl<'a, const D: usize> Shares<'a, D> {
    /// Deals the own particles of `blocks` to the first `ranks` ranks by their id, which is their key
    /// and less than `end`. Each of these ranks holds one section of the ids, the same for any layout.
    /// Collective.
    ///
    /// # Panics
    ///
    /// If `ranks` is 0 or greater than the number of ranks.
    pub fn by_id(
        comm: &'a dyn Comm,
        blocks: impl Iterator<Item = &'a Block<D>>,
        end: u64,
        ranks: usize,
    ) -> Self {
        assert!((1..=comm.size()).contains(&ranks), "some of the ranks get shares");
        let blocks: Vec<&Block<D>> = blocks.collect();
        let section = end.div_ceil(ranks as u64).max(1);
        let mut sent = vec![Vec::new(); comm.size()];
        let mut heads = vec![Vec::new(); comm.size()];
        for (b, block) in blocks.iter().enumerate() {
            for (r, &id) in block.ids[..block.own()].iter().enumerate() {
                let to = ((id / section) as usize).min(ranks - 1);
                sent[to].push((b as u32, r as u32));
                heads[to].push(id);
            }
        }
        let rank = comm.rank();
        let others = |count: usize| (0..count).filter(move |&r| r != rank);
        let sends: Vec<(usize, &[u64])> = others(ranks).map(|to| (to, &heads[to][..])).collect();
        let from: Vec<usize> = if rank < ranks { others(comm.size()).collect() } else { vec![] };
        let mut received = Vec::new();
        comm.exchange(&sends, &from, &mut received, &mut || {});
        let arrived: Vec<u64> =
            heads[rank].iter().chain(received.iter().flatten()).copied().collect();
        let from = from.into_iter().zip(&received).filter(|(_, words)| !words.is_empty());
        let from = from.map(|(rank, _)| rank).collect();
        let order = by_id(&arrived, rank as u64 * section);
        let ids: Vec<u64> = order.iter().map(|&r| arrived[r]).collect();
        Shares { comm, blocks, sent, from, order, keys: ids.clone(), ids }
    }

    /// The own particles of `blocks` that have a key, as the share of their rank, in order of `key`;
    /// none of them travels.
    pub fn of_own(
        comm: &'a dyn Comm,
        blocks: impl Iterator<Item = &'a Block<D>>,
        key: impl Fn(&Block<D>, usize) -> Option<u64>,
    ) -> Self {
        let blocks: Vec<&Block<D>> = blocks.collect();
        let (mut own, mut heads) = (Vec::new(), Vec::new());
        for (b, block) in blocks.iter().enumerate() {
            for r in 0..block.own() {
                let Some(key) = key(block, r) else { continue };
                own.push((b as u32, r as u32));
                heads.push((key, block.ids[r]));
            }
        }
        let mut sent = vec![Vec::new(); comm.size()];
        sent[comm.rank()] = own;
        let mut order: Vec<usize> = (0..heads.len()).collect();
        order.sort_unstable_by_key(|&r| heads[r]);
        let (keys, ids) = order.iter().map(|&r| heads[r]).unzip();
        Shares { comm, blocks, sent, from: Vec::new(), order, keys, ids }
    }

    /// The words `of` the particles of this rank's share, in order. Collective.
    pub fn words(&self, of: impl Fn(&Block<D>, usize) -> u64) -> Vec<u64> {
        let words = |to: usize| -> Vec<u64> {
            let places = self.sent[to].iter();
            places.map(|&(b, r)| of(self.blocks[b as usize], r as usize)).collect()
        };
        let rank = self.comm.rank();
        let mut arrived = words(rank);
        let messages = (0..self.comm.size()).filter(|&to| to != rank && !self.sent[to].is_empty());
        let messages: Vec<(usize, Vec<u64>)> = messages.map(|to| (to, words(to))).collect();
        let sends: Vec<(usize, &[u64])> = messages.iter().map(|(to, w)| (*to, &w[..])).collect();
        if !sends.is_empty() || !self.from.is_empty() {
            let mut received = Vec::new();
            self.comm.exchange(&sends, &self.from, &mut received, &mut || {});
            arrived.extend(received.into_iter().flatten());
        }
        self.order.iter().map(|&r| arrived[r]).collect()
    }

    /// Column `c` of the particles of this rank's share, in order. Collective.
    pub fn column(&self, c: usize) -> Vec<f64> {
        if self.comm.size() == 1 {
            let place = |&r: &usize| {
                let (b, r) = self.sent[0][r];
                self.blocks[b as usize].columns[c][r as usize]
            };
            return self.order.iter().map(place).collect();
        }
        let words = self.words(|block, r| block.columns[c][r].to_bits());
        words.into_iter().map(f64::from_bits).collect()
    }
}

/// Positions of the particles in order of id; ids are unique and not below `first`.
fn by_id(ids: &[u64], first: u64) -> Vec<usize> {
    const NONE: usize = usize::MAX;
    // ids count from `first` and few are missing: direct placement takes a tenth of the time of a sort
    let most = ids.iter().copied().max().map_or(0, |id| id - first);
    if most / 2 > ids.len() as u64 {
        let mut order: Vec<usize> = (0..ids.len()).collect();
        order.sort_unstable_by_key(|&r| ids[r]);
        return order;
    }
    let mut order = vec![NONE; most as usize + 1];
    ids.iter().enumerate().for_each(|(r, &id)| order[(id - first) as usize] = r);
    order.retain(|&r| r != NONE);
    order
}

/// Deals the particles of all ranks, of which each rank gives the share `given`, to the patches of
/// `layout`. The patches are assigned to ranks along its order by their numbers of particles. Returns
/// the layout with these ranks, and the blocks of this rank. Collective.
///
/// # Panics
///
/// If a cell is outside the domain.
pub fn distribute_particles<const D: usize>(
    comm: &dyn Comm,
    layout: Layout<D>,
    specs: &[ColumnSpec],
    given: &StoredParticles,
) -> (Layout<D>, Vec<Block<D>>) {
    let mut of_patch: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for r in 0..given.ids.len() {
        of_patch.entry(layout.patch_of(given.cell(r))).or_default().push(r);
    }
    let order = layout.order();
    let mut counts = vec![0; layout.count()];
    for (&patch, particles) in &of_patch {
        counts[order.position(patch)] = particles.len() as i64;
    }
    comm.sum(&mut counts);
    let weights: Vec<u64> = counts.iter().map(|&n| n as u64).collect();
    let (rank, size) = (comm.rank(), comm.size());
    let layout = layout.with_ranks(order, &assign_patches(&weights, size));
    let mine = layout.patches_of(rank);
    let block = |which: &[usize]| given.block::<D>(specs, which);
    let mut blocks: Vec<Block<D>> =
        mine.iter().map(|patch| block(&of_patch.remove(patch).unwrap_or_default())).collect();
    let mut of_rank: BTreeMap<usize, Vec<(usize, Vec<usize>)>> = BTreeMap::new();
    for (patch, particles) in of_patch {
        of_rank.entry(layout.rank_of(patch)).or_default().push((patch, particles));
    }
    let mut received = Vec::new();
    // one rank after the other, to hold only one message at a time
    for far in 1..size {
        let (to, from) = ((rank + far) % size, (rank + size - far) % size);
        let mut words = Vec::new();
        for (patch, particles) in of_rank.remove(&to).into_iter().flatten() {
            pack(&mut words, patch, &block(&particles));
        }
        comm.exchange(&[(to, &words)], &[from], &mut received, &mut || {});
        let mut words = &received[0][..];
        while let Some((&patch, rest)) = words.split_first() {
            let place = mine.binary_search(&(patch as usize)).expect("a patch of this rank");
            words = unpack_into(&mut blocks[place], rest);
        }
    }
    blocks.iter_mut().for_each(Block::sort_own);
    (layout, blocks)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comm::local::run_ranks;
    use crate::{IndexBox, Mirror, SideKind};

    const SPECS: [ColumnSpec; 3] = [
        ColumnSpec { name: "a", unit: "m", ghost: true, state: true, mirror: Mirror::Same },
        ColumnSpec { name: "b", unit: "m", ghost: true, state: false, mirror: Mirror::Same },
        ColumnSpec { name: "c", unit: "m", ghost: false, state: true, mirror: Mirror::Same },
    ];

    fn particles(count: u64) -> StoredParticles {
        StoredParticles {
            // some particles have been removed
            ids: (0..count).map(|i| 3 * i + 1).collect(),
            cells: (0..count as i32).flat_map(|i| [(7 * i) % 12, (5 * i) % 9]).collect(),
            columns: vec![
                (0..count).map(|i| if i == 2 { -0.0 } else { 0.1 * i as f64 }).collect(),
                (0..count).map(|i| f64::from_bits(u64::MAX - i)).collect(),
            ],
        }
    }

    /// The particles with the indices `range`.
    fn section(all: &StoredParticles, range: std::ops::Range<usize>) -> StoredParticles {
        StoredParticles {
            ids: all.ids[range.clone()].to_vec(),
            cells: all.cells[2 * range.start..2 * range.end].to_vec(),
            columns: all.columns.iter().map(|c| c[range.clone()].to_vec()).collect(),
        }
    }

    #[test]
    fn particles_are_put_in_order_of_id() {
        // ids that count from some number with some missing, and ids far apart
        for (first, ids) in [
            (0, &[4u64, 0, 2, 5, 1][..]),
            (7, &[9, 7, 12]),
            (0, &[7, 1 << 60, 0, 12]),
            (3, &[3]),
            (0, &[]),
        ] {
            let order = by_id(ids, first);
            let sorted: Vec<u64> = order.iter().map(|&r| ids[r]).collect();
            assert_eq!(sorted.len(), ids.len());
            assert!(sorted.is_sorted_by(|a, b| a < b), "{sorted:?}");
        }
    }

    /// Deals particles of any shares to patches, and back to shares by id; orders those of a rank by cell.
    #[test]
    fn particles_come_back_from_any_layout() {
        for (ranks, parts) in [(1, [1, 1]), (1, [3, 2]), (3, [4, 3]), (4, [1, 2])] {
            for count in [0, 1, 40] {
                let all = particles(count);
                let layout =
                    Layout::new(IndexBox::new([0, 0], [12, 9]), [[SideKind::Open; 2]; 2], parts);
                let end = all.ids.last().map_or(0, |id| id + 1);
                let ends = run_ranks(ranks, |comm| {
                    let bound = |r: usize| r * all.ids.len() / ranks;
                    let given = section(&all, bound(comm.rank())..bound(comm.rank() + 1));
                    let (assigned, blocks) =
                        distribute_particles(comm, layout.clone(), &SPECS, &given);
                    let mine = assigned.patches_of(comm.rank());
                    assert_eq!(blocks.len(), mine.len());
                    for (block, patch) in blocks.iter().zip(mine) {
                        let home = assigned.patch(patch);
                        assert!(block.cells.iter().all(|c| home.contains(c.map(i64::from))));
                        assert!(block.columns[1].iter().all(|&v| v == 0.0));
                    }
                    let own = StoredParticles::of(&SPECS, blocks.iter());
                    let at_first = Shares::by_id(comm, blocks.iter(), end, 1);
                    let shares = Shares::by_id(comm, blocks.iter(), end, ranks);
                    let column = |s: &Shares<'_, 2>| -> Vec<u64> {
                        s.column(2).iter().map(|v| v.to_bits()).collect()
                    };
                    let by_cell = Shares::of_own(comm, blocks.iter(), |block, r| {
                        (block.ids[r] % 2 == 1).then_some(block.cells[r][0] as u64)
                    });
                    let cells = by_cell.words(|block, r| block.cells[r][0] as u64);
                    assert_eq!(cells, by_cell.keys);
                    let heads: Vec<_> = cells.iter().zip(&by_cell.ids).collect();
                    assert!(heads.is_sorted());
                    let mut found = by_cell.ids.clone();
                    found.sort_unstable();
                    let mut own_ids = own.ids.clone();
                    own_ids.retain(|id| id % 2 == 1);
                    own_ids.sort_unstable();
                    assert_eq!(found, own_ids);
                    [
                        (at_first.ids.clone(), column(&at_first)),
                        (shares.ids.clone(), column(&shares)),
                        (own.ids, Vec::new()),
                    ]
                });
                let joined = |k: usize| {
                    let ids: Vec<u64> = ends.iter().flat_map(|e| &e[k].0).copied().collect();
                    (ids, ends.iter().flat_map(|e| &e[k].1).copied().collect::<Vec<u64>>())
                };
                let bits: Vec<u64> = all.columns[1].iter().map(|v| v.to_bits()).collect();
                assert_eq!((&ends[0][0].0, &ends[0][0].1), (&all.ids, &bits));
                assert!(ends[1..].iter().all(|end| end[0].0.is_empty()));
                assert_eq!(joined(1), (all.ids.clone(), bits));
                let mut own = joined(2).0;
                own.sort_unstable();
                assert_eq!(own, all.ids);
            }
        }
    }
}
