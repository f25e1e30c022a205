//! Gathers all particles at rank 0, for a file, and distributes them to the patches of any layout.

use crate::patch_migration::{pack, unpack};
use crate::{Block, ColumnSpec, Comm, Layout, assign_patches};

/// The own particles of all ranks, by id, with the data that one step leaves to the next.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StoredParticles {
    /// Id of each particle, ascending.
    pub ids: Vec<u64>,
    /// Cell of each particle, one number per direction, particle after particle.
    pub cells: Vec<i32>,
    /// The columns declared as state, in order of declaration.
    pub columns: Vec<Vec<f64>>,
}

impl StoredParticles {
    /// Gathers the particles of `blocks` at rank 0; the result is empty on other ranks. Columns are
    /// gathered one by one, to limit the memory of each rank to little more than the particles.
    /// Collective.
    pub fn gather<'a, const D: usize>(
        comm: &dyn Comm,
        specs: &[ColumnSpec],
        blocks: impl Iterator<Item = &'a Block<D>> + Clone,
    ) -> StoredParticles {
        let gathered = Gathered::ids(comm, blocks.clone());
        let mut cells = Vec::with_capacity(D * gathered.order.len());
        let found = together(comm, blocks.clone(), |block, words| {
            words.extend(block.cells[..block.own()].iter().flatten().map(|&c| i64::from(c) as u64));
        });
        let of = |&r: &usize| &found[D * r..D * (r + 1)];
        cells.extend(gathered.order.iter().flat_map(of).map(|&c| c as i32));
        let state = (0..specs.len()).filter(|&c| specs[c].state);
        let columns = state.map(|c| gathered.column(comm, blocks.clone(), c)).collect();
        StoredParticles { columns, ids: gathered.ids, cells }
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

/// Ids and the columns `which` of the own particles of all ranks, by id, at rank 0; empty on other
/// ranks. Collective.
pub fn gather_particles<'a, const D: usize>(
    comm: &dyn Comm,
    blocks: impl Iterator<Item = &'a Block<D>> + Clone,
    which: &[usize],
) -> (Vec<u64>, Vec<Vec<f64>>) {
    let gathered = Gathered::ids(comm, blocks.clone());
    let columns = which.iter().map(|&c| gathered.column(comm, blocks.clone(), c)).collect();
    (gathered.ids, columns)
}

/// Order of the particles of all ranks at rank 0. They arrive by rank, patch and particle, and are
/// then ordered by id. Columns are gathered one by one, which limits the memory of each rank and
/// lets columns reuse the same allocation.
struct Gathered {
    /// Ids, ascending; empty except at rank 0.
    ids: Vec<u64>,
    /// Position of the particle of each id among the gathered particles.
    order: Vec<usize>,
}

impl Gathered {
    /// Determines the order of the particles. Collective.
    fn ids<'a, const D: usize>(
        comm: &dyn Comm,
        blocks: impl Iterator<Item = &'a Block<D>>,
    ) -> Gathered {
        let ids = together(comm, blocks, |block, words| words.extend(&block.ids[..block.own()]));
        let order = by_id(&ids);
        Gathered { ids: order.iter().map(|&r| ids[r]).collect(), order }
    }

    /// Column number `c`, by id; empty except at rank 0. Collective.
    fn column<'a, const D: usize>(
        &self,
        comm: &dyn Comm,
        blocks: impl Iterator<Item = &'a Block<D>>,
        c: usize,
    ) -> Vec<f64> {
        let values = together(comm, blocks, |block, words| {
            words.extend(block.columns[c][..block.own()].iter().map(|v| v.to_bits()));
        });
        self.order.iter().map(|&r| f64::from_bits(values[r])).collect()
    }
}

/// Words that `of` adds for the blocks of all ranks, at rank 0; empty on other ranks. Collective.
fn together<'a, const D: usize>(
    comm: &dyn Comm,
    blocks: impl Iterator<Item = &'a Block<D>>,
    of: impl Fn(&Block<D>, &mut Vec<u64>),
) -> Vec<u64> {
    let mut words = Vec::new();
    blocks.for_each(|block| of(block, &mut words));
    if comm.size() == 1 {
        return words;
    }
    comm.gather(&words).concat()
}

/// Positions of the particles in order of id; ids are unique.
fn by_id(ids: &[u64]) -> Vec<usize> {
    const NONE: usize = usize::MAX;
    // ids count from 0 and few are missing: direct placement takes a tenth of the time of a sort
    let most = ids.iter().copied().max().unwrap_or(0);
    if most / 2 > ids.len() as u64 {
        let mut order: Vec<usize> = (0..ids.len()).collect();
        order.sort_unstable_by_key(|&r| ids[r]);
        return order;
    }
    let mut order = vec![NONE; most as usize + 1];
    ids.iter().enumerate().for_each(|(r, &id)| order[id as usize] = r);
    order.retain(|&r| r != NONE);
    order
}

/// Distributes the particles of rank 0 (`None` on other ranks) to the patches of `layout`. The
/// patches are assigned to ranks along `order` by their numbers of particles. Returns the layout
/// with these ranks, and the blocks of this rank. Cells must be within the domain. Collective.
pub fn deal_particles<const D: usize>(
    comm: &dyn Comm,
    layout: Layout<D>,
    order: &[usize],
    specs: &[ColumnSpec],
    particles: Option<&StoredParticles>,
) -> (Layout<D>, Vec<Block<D>>) {
    let mut of_patch: Vec<Vec<usize>> = vec![Vec::new(); layout.patches().len()];
    if let Some(particles) = particles {
        for r in 0..particles.ids.len() {
            of_patch[layout.patch_of(particles.cell(r))].push(r);
        }
    }
    let mut counts: Vec<i64> = of_patch.iter().map(|particles| particles.len() as i64).collect();
    comm.sum(&mut counts);
    let weights: Vec<u64> = counts.iter().map(|&n| n as u64).collect();
    let ranks = assign_patches(&weights, order, comm.size());
    let layout = layout.with_ranks(ranks);
    let mine = layout.patches_of(comm.rank());
    let mut received = Vec::new();
    let Some(particles) = particles else {
        comm.exchange(&[], &[0], &mut received, &mut || {});
        let mut words = &received[0][..];
        let mut blocks = Vec::new();
        while let Some((_, rest)) = words.split_first() {
            let (block, rest) = unpack(specs, rest);
            blocks.push(block);
            words = rest;
        }
        blocks.iter_mut().for_each(Block::sort_own);
        return (layout, blocks);
    };
    // one rank after the other, to hold only one message at a time
    for rank in 1..comm.size() {
        let mut words = Vec::new();
        for patch in layout.patches_of(rank) {
            pack(&mut words, patch, &particles.block::<D>(specs, &of_patch[patch]));
        }
        comm.exchange(&[(rank, &words)], &[], &mut received, &mut || {});
    }
    let mut blocks: Vec<Block<D>> =
        mine.into_iter().map(|patch| particles.block(specs, &of_patch[patch])).collect();
    blocks.iter_mut().for_each(Block::sort_own);
    (layout, blocks)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comm::local::run_ranks;
    use crate::{IndexBox, Mirror, SideKind, curve_order};

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

    #[test]
    fn particles_are_put_in_order_of_id() {
        // ids that count from 0 with some missing, and ids far apart
        for ids in [&[4u64, 0, 2, 5, 1][..], &[7, 1 << 60, 0, 12], &[3], &[]] {
            let order = by_id(ids);
            let sorted: Vec<u64> = order.iter().map(|&r| ids[r]).collect();
            assert_eq!(sorted.len(), ids.len());
            assert!(sorted.is_sorted_by(|a, b| a < b), "{sorted:?}");
        }
    }

    #[test]
    fn particles_come_back_from_any_layout() {
        for (ranks, parts) in [(1, [1, 1]), (1, [3, 2]), (3, [4, 3]), (4, [1, 2])] {
            for count in [0, 1, 40] {
                let all = particles(count);
                let layout =
                    Layout::new(IndexBox::new([0, 0], [12, 9]), [[SideKind::Open; 2]; 2], parts);
                let order = curve_order(layout.parts());
                let ends = run_ranks(ranks, |comm| {
                    let given = (comm.rank() == 0).then_some(&all);
                    let (dealt, blocks) =
                        deal_particles(comm, layout.clone(), &order, &SPECS, given);
                    let mine = dealt.patches_of(comm.rank());
                    assert_eq!(blocks.len(), mine.len());
                    for (block, patch) in blocks.iter().zip(mine) {
                        let home = dealt.patches()[patch];
                        assert!(block.cells.iter().all(|c| home.contains(c.map(i64::from))));
                        assert!(block.columns[1].iter().all(|&v| v == 0.0));
                    }
                    StoredParticles::gather(comm, &SPECS, blocks.iter())
                });
                let bits = |particles: &StoredParticles| -> Vec<u64> {
                    particles.columns.iter().flatten().map(|v| v.to_bits()).collect()
                };
                assert_eq!((&ends[0].ids, &ends[0].cells), (&all.ids, &all.cells));
                assert_eq!(bits(&ends[0]), bits(&all));
                assert!(ends[1..].iter().all(|particles| particles.ids.is_empty()));
            }
        }
    }
}
