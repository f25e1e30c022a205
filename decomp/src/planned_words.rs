//! Sizes of the messages of a planned exchange of particles, from counts of particles in boxes of
//! cells: no particle is needed.

use std::collections::BTreeMap;

use crate::IndexBox;

/// Indices of the bits that are set.
pub(crate) fn bits(mut set: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = (set != 0).then(|| set.trailing_zeros() as usize)?;
        set &= set - 1;
        Some(bit)
    })
}

/// Words of one group of ghosts, besides the ghosts: patch and kind, number of ghosts, other patches.
fn head_words(receivers: u64) -> u64 {
    1 + u64::from(receivers.count_ones())
}

/// Words of the particles of the cells `home` that are packed for receivers, of which each sees the
/// cells of one of `seen`. `count` gives the number of particles in a box, and `words` is the size of
/// a particle \[words of 8 bytes\]. A particle is packed once, however many receivers see it.
pub(crate) fn packed_words<const D: usize>(
    home: &IndexBox<D>,
    seen: &[IndexBox<D>],
    words: u64,
    count: &dyn Fn(&IndexBox<D>) -> u64,
) -> u64 {
    let seen: Vec<IndexBox<D>> = seen.iter().map(|b| b.intersect(home)).collect();
    // between the edges of all boxes, each part of the home is seen by one set of receivers
    let cuts: [Vec<i64>; D] = std::array::from_fn(|a| {
        let edges = seen.iter().filter(|b| !b.is_empty()).flat_map(|b| [b.lower[a], b.upper[a]]);
        let mut cuts: Vec<i64> = edges.collect();
        cuts.sort_unstable();
        cuts.dedup();
        cuts
    });
    let parts = IndexBox::new([0; D], cuts.each_ref().map(|cuts| cuts.len() as i64 - 1));
    let mut of_sets: BTreeMap<u64, u64> = BTreeMap::new();
    for k in parts.iter() {
        let corner = |more: usize| std::array::from_fn(|a| cuts[a][k[a] as usize + more]);
        let part = IndexBox::new(corner(0), corner(1));
        let sees = |b: &IndexBox<D>| b.contains(part.lower);
        let set = seen.iter().enumerate().fold(0, |set, (k, b)| set | u64::from(sees(b)) << k);
        if set != 0 {
            *of_sets.entry(set).or_default() += count(&part);
        }
    }
    let filled = of_sets.iter().filter(|(_, particles)| **particles > 0);
    filled.map(|(&set, particles)| head_words(set) + particles * words).sum()
}

/// The receivers of `set` among `seen`; the others see nothing.
pub(crate) fn only<const D: usize>(
    set: u64,
    seen: impl Iterator<Item = IndexBox<D>>,
) -> Vec<IndexBox<D>> {
    let mut boxes: Vec<IndexBox<D>> = seen.collect();
    let mut kept = vec![false; boxes.len()];
    bits(set).for_each(|k| kept[k] = true);
    let nothing = IndexBox::new([0; D], [0; D]);
    boxes.iter_mut().zip(kept).filter(|(_, kept)| !kept).for_each(|(b, _)| *b = nothing);
    boxes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comm::local::run_ranks;
    use crate::{
        Block, ColumnSpec, Comm, GhostExchange, GhostReach, Layout, Mirror, SideKind,
        assign_patches,
    };

    const SPECS: [ColumnSpec; 2] = [
        ColumnSpec { name: "v", unit: "m/s", ghost: true, state: true, mirror: Mirror::Negate(0) },
        ColumnSpec { name: "e", unit: "J/kg", ghost: false, state: true, mirror: Mirror::Same },
    ];

    /// Words that each rank sends, counted and planned, for a particle in every third cell.
    fn sent_and_planned(sides: [SideKind; 2], depth: i64, ranks: usize) -> Vec<[u64; 2]> {
        let filled = |cell: [i64; 2]| (cell[0] + 2 * cell[1]).rem_euclid(3) == 0;
        let layout = Layout::new(IndexBox::new([0, 0], [21, 12]), [sides; 2], [5, 3]);
        let order = layout.order();
        let layout = layout.with_ranks(order, &assign_patches(&[1; 15], ranks));
        run_ranks(ranks, |comm| {
            let block = |patch: usize| {
                let mut block: Block<2> = Block::new(&SPECS);
                for cell in layout.patch(patch).iter().filter(|&cell| filled(cell)) {
                    let id = (cell[0] + 100 * cell[1]) as u64;
                    block.push(id, cell.map(|c| c as i32), &[1.0, 2.0]);
                }
                block
            };
            let patches = layout.patches_of(comm.rank());
            let mut blocks: Vec<Block<2>> = patches.into_iter().map(block).collect();
            let reach = GhostReach { depth, travel: 1, notice: None };
            let mut exchange = GhostExchange::new(&layout, comm.rank(), reach);
            let count = |b: &IndexBox<2>| b.iter().filter(|&cell| filled(cell)).count() as u64;
            let planned = exchange.ghost_words(1, &count);
            exchange.run(comm, &mut blocks, None, &mut |_| {}).unwrap();
            assert_eq!(comm.traffic().messages as usize, exchange.send_ranks().len());
            [comm.traffic().bytes / 8, planned]
        })
    }

    #[test]
    fn planned_words_are_those_that_are_sent() {
        use SideKind::{Mirror, Open, Wrap};
        for sides in [[Open, Open], [Mirror, Open], [Mirror, Mirror], [Wrap, Wrap]] {
            for (depth, ranks) in [(2, 2), (3, 4), (6, 5)] {
                for [sent, planned] in sent_and_planned(sides, depth, ranks) {
                    assert!(sent > 0);
                    assert_eq!(sent, planned, "{sides:?}, {depth} cells, {ranks} ranks");
                }
            }
        }
    }

    #[test]
    fn a_particle_for_two_receivers_is_packed_once() {
        let home = IndexBox::new([0, 0], [8, 8]);
        let count = |b: &IndexBox<2>| b.count() as u64;
        let right = IndexBox::new([6, -2], [12, 12]);
        let corner = IndexBox::new([6, 6], [12, 12]);
        // two columns of eight cells, ten words each, and a head of two words
        assert_eq!(packed_words(&home, &[right], 10, &count), 160 + 2);
        // the corner has a group of its own, with both receivers in its head
        assert_eq!(packed_words(&home, &[right, corner], 10, &count), 160 + 2 + 3);
        assert_eq!(packed_words(&home, &[home.grow(3)], 1, &|_| 0), 0);
        assert_eq!(packed_words(&home, &[], 1, &count), 0);
    }
}
