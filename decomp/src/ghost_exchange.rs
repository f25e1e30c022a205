//! Ghost particles and migration, in one message per neighbouring rank. A particle that several
//! patches of a rank need travels once.

use crate::ghost_bundle::{Bundle, GhostReach, MOST_RECEIVERS, Taker};
use crate::packing::take;
use crate::particle_sort::SortBuffers;
use crate::{Block, Comm, IndexBox, Layout};

/// Error of the migration of a particle.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ParticleError {
    /// The particle has moved past the neighbours of its patch in one step.
    #[error(
        "particle {id} moved from patch {patch} to cell {cell:?} in one step, past its neighbours"
    )]
    MovedTooFar {
        /// Id of the particle.
        id: u64,
        /// Patch that held the particle.
        patch: usize,
        /// New cell of the particle.
        cell: Vec<i64>,
    },
}

/// Exchange of ghosts and migrating particles between patches.
///
/// One exchange does three things: it hands over own particles whose cell now belongs to another
/// patch, copies particles to every patch within their reach, and informs patches near active cells
/// that they are stirred. Copies beyond a mirror or a joined side are images: they carry the cell
/// of the image, and their columns change as declared.
#[derive(Clone, Debug)]
pub struct GhostExchange<const D: usize> {
    reach: GhostReach,
    patches: Vec<usize>,
    homes: Vec<IndexBox<D>>,
    /// For each patch of this rank, the patches that may need its particles, by destination.
    bundles: Vec<Vec<Bundle<D>>>,
    /// For each patch of this rank, whether it receives nothing from other ranks.
    inner: Vec<bool>,
    send_ranks: Vec<usize>,
    receive_ranks: Vec<usize>,
    messages: Vec<Vec<u64>>,
    received: Vec<Vec<u64>>,
    to_inner: Vec<u64>,
    to_border: Vec<u64>,
    gone: Vec<usize>,
    sorting: SortBuffers<D>,
    migrated: u64,
}

impl<const D: usize> GhostExchange<D> {
    /// Plans the exchange on `rank`.
    pub fn new(layout: &Layout<D>, rank: usize, reach: GhostReach) -> Self {
        let GhostReach { depth, travel, notice } = reach;
        let seen = depth.max(notice.unwrap_or(0));
        let images = layout.images(seen + travel);
        let patches = layout.patches_of(rank);

        // a patch is inner if no patch of another rank has a route to it
        let mut receive_ranks = Vec::new();
        let mut inner = vec![true; patches.len()];
        for (k, &to) in patches.iter().enumerate() {
            let halo = layout.patch(to).grow(seen);
            for image in &images {
                for from in layout.patches_in(&image.source_cells(&halo).grow(travel)) {
                    if patches.binary_search(&from).is_err() {
                        inner[k] = false;
                        receive_ranks.push(layout.rank_of(from));
                    }
                }
            }
        }
        let mut bundles = Vec::new();
        let mut send_ranks = Vec::new();
        for &from in &patches {
            let reachable = layout.patch(from).grow(travel);
            let mut takers: Vec<(Taker, usize)> = images
                .iter()
                .flat_map(|image| layout.patches_in(&image.cells(&reachable).grow(seen)))
                .map(|to| match patches.binary_search(&to) {
                    Err(_) => (Taker::Message(layout.rank_of(to)), to),
                    Ok(k) if inner[k] => (Taker::Inner, to),
                    Ok(_) => (Taker::Border, to),
                })
                .collect();
            takers.sort_unstable();
            takers.dedup();
            let alike = takers.chunk_by(|a, b| a.0 == b.0);
            let from_here: Vec<Bundle<D>> = alike
                .flat_map(|alike| alike.chunks(MOST_RECEIVERS))
                .map(|takers| Bundle::new(layout, reach, &images, takers))
                .collect();
            send_ranks.extend(from_here.iter().filter_map(|b| match b.taker {
                Taker::Message(rank) => Some(rank),
                _ => None,
            }));
            bundles.push(from_here);
        }
        for ranks in [&mut send_ranks, &mut receive_ranks] {
            ranks.sort_unstable();
            ranks.dedup();
        }
        GhostExchange {
            reach,
            homes: patches.iter().map(|&p| layout.patch(p)).collect(),
            patches,
            bundles,
            inner,
            messages: vec![Vec::new(); send_ranks.len()],
            received: vec![Vec::new(); receive_ranks.len()],
            send_ranks,
            receive_ranks,
            to_inner: Vec::new(),
            to_border: Vec::new(),
            gone: Vec::new(),
            sorting: SortBuffers::default(),
            migrated: 0,
        }
    }

    /// Number of particles that this rank's patches have handed over since the last call.
    pub fn take_migrated(&mut self) -> u64 {
        std::mem::take(&mut self.migrated)
    }

    /// For each patch of this rank, whether it receives nothing from other ranks.
    pub fn inner(&self) -> &[bool] {
        &self.inner
    }

    /// Ranks that get a message from this rank in each exchange.
    pub fn send_ranks(&self) -> &[usize] {
        &self.send_ranks
    }

    /// Size of these messages together \[words of 8 bytes\], with `columns` columns of a ghost, while
    /// no particle changes its patch. `count` gives the number of particles in a box of cells.
    pub fn ghost_words(&self, columns: usize, count: &dyn Fn(&IndexBox<D>) -> u64) -> u64 {
        // id, cell and columns
        let words = (1 + D + columns) as u64;
        let from = self.patches.iter().copied().zip(&self.homes).zip(&self.bundles);
        let sent = from.flat_map(|(from, bundles)| bundles.iter().map(move |b| (from, b)));
        let sent = sent.filter(|(_, bundle)| matches!(bundle.taker, Taker::Message(_)));
        sent.map(|(from, bundle)| bundle.ghost_words(from, words, count)).sum()
    }

    /// Hands over the particles that have moved and renews all ghosts. `patches` are the patches of
    /// this rank, in order; their particles carry their new cells, within the domain. Afterwards
    /// each block is in canonical order.
    ///
    /// `meanwhile` is called once, with all patches, while messages are on their way;
    /// [`inner`](Self::inner) patches are complete by then. Collective between neighbours.
    ///
    /// # Errors
    ///
    /// If a particle has moved past the neighbours of its patch.
    #[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
    pub fn run<P: AsMut<Block<D>>>(
        &mut self,
        comm: &dyn Comm,
        patches: &mut [P],
        meanwhile: &mut dyn FnMut(&mut [P]),
    ) -> Result<(), ParticleError> {
        self.messages.iter_mut().for_each(Vec::clear);
        self.to_inner.clear();
        self.to_border.clear();
        for (k, patch) in patches.iter_mut().enumerate() {
            let block = patch.as_mut();
            block.drop_ghosts();
            block.stirred = self.reach.notice.is_none() || !block.active.is_empty();
            self.give(k, block)?;
        }
        let GhostExchange { patches: numbers, inner, received, sorting, .. } = self;
        let mut on_this_rank = || {
            let words = std::slice::from_ref(&self.to_inner);
            settle(numbers, words, patches, (inner, true), sorting);
            meanwhile(patches);
        };
        if self.send_ranks.is_empty() && self.receive_ranks.is_empty() {
            on_this_rank();
        } else {
            with_sends(&self.send_ranks, &self.messages, |sends| {
                comm.exchange(sends, &self.receive_ranks, received, &mut on_this_rank)
            });
        }
        // this rank's own words are processed together with the messages of other ranks
        received.push(std::mem::take(&mut self.to_border));
        settle(numbers, received, patches, (inner, false), sorting);
        self.to_border = received.pop().expect("it was pushed");
        Ok(())
    }

    /// Packs the particles of `block` that other patches need and removes those that left it.
    fn give(&mut self, k: usize, block: &mut Block<D>) -> Result<(), ParticleError> {
        let home = self.homes[k];
        // cells that no other patch sees
        let inner = home.grow(-self.reach.depth);
        self.gone.clear();
        let GhostExchange { bundles, messages, send_ranks, to_inner, to_border, .. } = self;
        let (bundles, patch) = (&mut bundles[k], self.patches[k]);
        for particle in outside(&block.cells[..block.own()], inner) {
            let cell = block.cells[particle].map(i64::from);
            let stays = home.contains(cell);
            let mut owned = stays;
            for bundle in bundles.iter_mut() {
                owned |= bundle.sort_in(particle as u32, cell, stays, patch);
            }
            if !owned {
                let id = block.ids[particle];
                return Err(ParticleError::MovedTooFar { id, patch, cell: cell.to_vec() });
            }
            if !stays {
                self.gone.push(particle);
            }
        }
        let stirs = self.reach.notice.is_some() && !block.active.is_empty();
        for bundle in bundles.iter_mut() {
            let out = match bundle.taker {
                Taker::Message(rank) => {
                    &mut messages[send_ranks.binary_search(&rank).expect("a rank with a bundle")]
                }
                Taker::Inner => &mut *to_inner,
                Taker::Border => &mut *to_border,
            };
            if stirs {
                bundle.put_stirs(out, block, patch);
            }
            bundle.put_particles(out, block);
        }
        if !self.gone.is_empty() {
            self.migrated += self.gone.len() as u64;
            block.remove(&self.gone);
        }
        Ok(())
    }
}

/// Number of cells that are looked at together.
const TOGETHER: usize = 16;

/// Indices of the `cells` that lie outside of `inner`.
fn outside<const D: usize>(
    cells: &[[i32; D]],
    inner: IndexBox<D>,
) -> impl Iterator<Item = usize> + '_ {
    let limit = |x: i64| x.clamp(i32::MIN.into(), i32::MAX.into()) as i32;
    let (lower, upper) = (inner.lower.map(limit), inner.upper.map(limit));
    // no branch per cell or direction, so that several are compared at a time
    let is_inside = move |cell: &[i32; D]| {
        (0..D).fold(true, |all, a| all & (lower[a] <= cell[a]) & (cell[a] < upper[a]))
    };
    let chunks = cells.chunks(TOGETHER).zip((0..).step_by(TOGETHER));
    let some =
        chunks.filter(move |(chunk, _)| !chunk.iter().fold(true, |all, c| all & is_inside(c)));
    some.flat_map(move |(chunk, from)| {
        let places = chunk.iter().zip(from..);
        places.filter(move |(cell, _)| !is_inside(cell)).map(|(_, place)| place)
    })
}

/// Number of neighbouring ranks whose list of messages needs no heap allocation.
const NEIGHBOURS: usize = 16;

/// Calls `exchange` with each rank and its message.
pub(crate) fn with_sends(
    ranks: &[usize],
    messages: &[Vec<u64>],
    exchange: impl FnOnce(&[(usize, &[u64])]),
) {
    let pairs = ranks.iter().zip(messages).map(|(&r, m)| (r, &m[..]));
    let sends: smallvec::SmallVec<[(usize, &[u64]); NEIGHBOURS]> = pairs.collect();
    exchange(&sends);
}

/// Adds the particles of the messages to their blocks and sorts the blocks whose `inner` equals
/// `which`: first own particles, then ghosts, because a block keeps them apart. `numbers` are the
/// numbers of the patches.
fn settle<const D: usize>(
    numbers: &[usize],
    messages: &[Vec<u64>],
    patches: &mut [impl AsMut<Block<D>>],
    (inner, which): (&[bool], bool),
    sorting: &mut SortBuffers<D>,
) {
    for ghosts in [false, true] {
        for words in messages {
            take(numbers, words, patches, ghosts);
        }
        for (patch, _) in patches.iter_mut().zip(inner).filter(|(_, i)| **i == which) {
            let block = patch.as_mut();
            let (own, all) = (block.own(), block.particles());
            block.sort(if ghosts { own..all } else { 0..own }, sorting);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ColumnSpec, IndexBox, Mirror, Serial, SideKind};
    use proptest::prelude::*;

    const SPECS: [ColumnSpec; 2] = [
        ColumnSpec { name: "v", unit: "m/s", ghost: true, state: true, mirror: Mirror::Negate(0) },
        ColumnSpec { name: "e", unit: "J/kg", ghost: false, state: true, mirror: Mirror::Same },
    ];

    /// Cell, id and `v` of a particle, as seen by a patch.
    type Seen<const D: usize> = ([i64; D], u64, f64);

    /// Moves and exchanges (cell, move) particles; returns those of each patch in canonical order.
    fn seen<const D: usize>(
        layout: &Layout<D>,
        particles: &[([i64; D], [i64; D])],
        depth: i64,
    ) -> Vec<Vec<Seen<D>>> {
        let count = layout.count();
        let mut blocks: Vec<Block<D>> = (0..count).map(|_| Block::new(&SPECS)).collect();
        for (id, (cell, _)) in particles.iter().enumerate() {
            let p = layout.patch_of(*cell);
            blocks[p].push(id as u64, cell.map(|c| c as i32), &[id as f64 + 1.0, 0.5]);
        }
        let reach = GhostReach { depth, travel: 1, notice: None };
        let mut exchange = GhostExchange::new(layout, 0, reach);
        for round in 0..2 {
            for block in &mut blocks {
                block.drop_ghosts();
                for particle in 0..block.own() {
                    let by = particles[block.ids[particle] as usize]
                        .1
                        .map(|m| if round == 0 { 0 } else { m });
                    let from = block.cells[particle].map(i64::from);
                    let to = layout.wrap_cell(std::array::from_fn(|a| from[a] + by[a])).unwrap();
                    block.cells[particle] = to.map(|c| c as i32);
                }
            }
            exchange.run(&Serial, &mut blocks, &mut |_| {}).unwrap();
        }
        blocks
            .iter()
            .map(|b| {
                let mut runs = Vec::new();
                b.runs(&mut runs);
                let particle = |r: usize| (b.cells[r].map(i64::from), b.ids[r], b.columns[0][r]);
                runs.into_iter().flatten().map(particle).collect()
            })
            .collect()
    }

    const KINDS: [[SideKind; 2]; 4] = [
        [SideKind::Open, SideKind::Open],
        [SideKind::Mirror, SideKind::Open],
        [SideKind::Wrap, SideKind::Wrap],
        [SideKind::Mirror, SideKind::Mirror],
    ];

    /// Checks that a patch of a cut domain sees the same particles as the uncut domain, in order.
    fn check<const D: usize>(
        domain: IndexBox<D>,
        sides: [[SideKind; 2]; D],
        parts: [usize; D],
        particles: &[([i64; D], [i64; D])],
        depth: i64,
    ) {
        let cut = Layout::new(domain, sides, parts);
        let all = &seen(&Layout::new(domain, sides, [1; D]), particles, depth)[0];
        for (patch, got) in seen(&cut, particles, depth).into_iter().enumerate() {
            let halo = cut.halo(patch, depth);
            let expected: Vec<_> = all.iter().filter(|r| halo.contains(r.0)).copied().collect();
            assert_eq!(got, expected, "patch {patch}");
        }
    }

    proptest! {
        #[test]
        fn a_cut_line_sees_what_the_whole_sees(
            particles in prop::collection::vec((1i64..23, -1i64..=1), 1..30),
            parts in 1usize..13,
            depth in 1i64..5,
            kind in 0usize..4,
        ) {
            let particles: Vec<_> = particles.iter().map(|r| ([r.0], [r.1])).collect();
            check(IndexBox::new([0], [24]), [KINDS[kind]], [parts], &particles, depth);
        }

        #[test]
        fn a_cut_plane_sees_what_the_whole_sees(
            particles in prop::collection::vec(((1i64..11, 1i64..8), (-1i64..=1, -1i64..=1)), 1..30),
            parts in (1usize..6, 1usize..5),
            depth in 1i64..4,
            kinds in (0usize..4, 0usize..4),
        ) {
            let particles: Vec<_> =
                particles.iter().map(|r| ([r.0.0, r.0.1], [r.1.0, r.1.1])).collect();
            let sides = [KINDS[kinds.0], KINDS[kinds.1]];
            check(IndexBox::new([0, 0], [12, 9]), sides, [parts.0, parts.1], &particles, depth);
        }
    }

    #[test]
    fn a_particle_that_jumps_over_its_neighbours_is_named() {
        let layout = Layout::new(IndexBox::new([0], [40]), [[SideKind::Open; 2]], [10]);
        let mut blocks: Vec<Block<1>> = (0..10).map(|_| Block::new(&SPECS)).collect();
        blocks[0].push(5, [30], &[0.0, 0.0]);
        let reach = GhostReach { depth: 2, travel: 1, notice: None };
        let mut exchange = GhostExchange::new(&layout, 0, reach);
        let error = exchange.run(&Serial, &mut blocks, &mut |_| {}).unwrap_err();
        assert!(error.to_string().contains("particle 5"), "{error}");
    }
}
