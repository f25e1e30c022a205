//! Ghost particles and migration, in one message per neighbouring rank. A particle that several
//! patches of a rank need travels once.

use rayon::ThreadPool;

use crate::ghost_bundle::{Bundle, GhostReach, MOST_RECEIVERS, Taker};
use crate::ghost_merge::{self, ArrivalBuffers, Ring};
use crate::packing::{Group, PackedColumns};
use crate::threads::for_each_pair;
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
///
/// Each patch packs its particles, and each receives its own: both on all threads. In between, this
/// thread lists the packed groups of each patch and exchanges messages.
#[derive(Clone, Debug)]
pub struct GhostExchange<const D: usize> {
    reach: GhostReach,
    /// Numbers of the patches of this rank, ascending.
    patches: Vec<usize>,
    departures: Vec<Departure<D>>,
    arrivals: Vec<Arrival<D>>,
    /// For each patch of this rank, whether it receives nothing from other ranks.
    inner: Vec<bool>,
    send_ranks: Vec<usize>,
    receive_ranks: Vec<usize>,
    messages: Vec<Vec<u64>>,
    received: Vec<Vec<u64>>,
    /// Indices of the particles that leave a patch.
    gone: Vec<usize>,
    buffers: ArrivalBuffers<D>,
    migrated: u64,
}

/// What one patch sends.
#[derive(Clone, Debug)]
struct Departure<const D: usize> {
    patch: usize,
    home: IndexBox<D>,
    /// The patches that may need its particles, by destination.
    bundles: Vec<Bundle<D>>,
    /// Number of particles that left the patch in the last exchange.
    migrated: u64,
    fault: Option<ParticleError>,
}

/// What one patch receives.
#[derive(Clone, Debug)]
struct Arrival<const D: usize> {
    ring: Ring<D>,
    groups: Vec<GroupPlace>,
}

/// Place of a packed group of particles.
#[derive(Clone, Copy, Debug)]
struct GroupPlace {
    source: Source,
    /// Index of its first word.
    at: usize,
}

/// Words that hold packed groups.
#[derive(Clone, Copy, Debug)]
enum Source {
    /// Those of a patch of this rank, and of one of its bundles.
    Here(usize, usize),
    /// A message of another rank.
    Message(usize),
}

/// The packed groups of an exchange.
struct PackedGroups<'a, const D: usize> {
    /// Those of the patches of this rank.
    departures: &'a [Departure<D>],
    /// Those of other ranks.
    received: &'a [Vec<u64>],
    columns: PackedColumns,
}

impl<'a, const D: usize> PackedGroups<'a, D> {
    fn group(&self, place: &GroupPlace) -> Group<'a, D> {
        let words = match place.source {
            Source::Here(k, b) => &self.departures[k].bundles[b].words,
            Source::Message(m) => &self.received[m],
        };
        Group::split_first(&words[place.at..], self.columns).expect("a listed group").0
    }

    /// Adds the groups of `arrival` to `block`.
    fn receive(&self, arrival: &Arrival<D>, block: &mut Block<D>, buffers: &mut ArrivalBuffers<D>) {
        let groups = arrival.groups.iter().map(|place| self.group(place));
        ghost_merge::receive(block, &arrival.ring, groups, buffers);
    }
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
        let mut departures = Vec::new();
        let mut send_ranks = Vec::new();
        for &from in &patches {
            let reachable = layout.patch(from).grow(travel);
            let mut takers: Vec<(Taker, usize)> = images
                .iter()
                .flat_map(|image| layout.patches_in(&image.cells(&reachable).grow(seen)))
                .map(|to| match patches.binary_search(&to) {
                    Err(_) => (Taker::Message(layout.rank_of(to)), to),
                    Ok(_) => (Taker::Here, to),
                })
                .collect();
            takers.sort_unstable();
            takers.dedup();
            let alike = takers.chunk_by(|a, b| a.0 == b.0);
            let bundles: Vec<Bundle<D>> = alike
                .flat_map(|alike| alike.chunks(MOST_RECEIVERS))
                .map(|takers| Bundle::new(layout, reach, &images, takers))
                .collect();
            send_ranks.extend(bundles.iter().filter_map(|bundle| bundle.taker.rank()));
            let home = layout.patch(from);
            departures.push(Departure { patch: from, home, bundles, migrated: 0, fault: None });
        }
        for ranks in [&mut send_ranks, &mut receive_ranks] {
            ranks.sort_unstable();
            ranks.dedup();
        }
        let arrival = |&patch: &usize| {
            let ring = Ring { home: layout.patch(patch), halo: layout.halo(patch, depth) };
            Arrival { ring, groups: Vec::new() }
        };
        GhostExchange {
            reach,
            arrivals: patches.iter().map(arrival).collect(),
            patches,
            departures,
            inner,
            messages: vec![Vec::new(); send_ranks.len()],
            received: vec![Vec::new(); receive_ranks.len()],
            send_ranks,
            receive_ranks,
            gone: Vec::new(),
            buffers: ArrivalBuffers::default(),
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
        let of_patch = |from: &Departure<D>| {
            let sent = from.bundles.iter().filter(|bundle| bundle.taker != Taker::Here);
            sent.map(|bundle| bundle.ghost_words((from.patch, &from.home), words, count))
                .sum::<u64>()
        };
        self.departures.iter().map(of_patch).sum()
    }

    /// Hands over the particles that have moved and renews all ghosts. `patches` are the patches of
    /// this rank, in order; their particles carry their new cells, within the domain. Afterwards
    /// each block is in canonical order. The threads of `pool` share the work on the patches.
    ///
    /// `meanwhile` is called once, with all patches, while messages are on their way;
    /// [`inner`](Self::inner) patches are complete by then. Collective between neighbours.
    ///
    /// # Errors
    ///
    /// If a particle has moved past the neighbours of its patch.
    pub fn run<P: AsMut<Block<D>> + Send>(
        &mut self,
        comm: &dyn Comm,
        patches: &mut [P],
        pool: Option<&ThreadPool>,
        meanwhile: &mut dyn FnMut(&mut [P]),
    ) -> Result<(), ParticleError> {
        self.pack(patches, pool)?;
        let Some(columns) = patches.first_mut().map(|patch| PackedColumns::of(patch.as_mut()))
        else {
            meanwhile(patches);
            return Ok(());
        };
        self.gather_messages();
        self.list_own_groups(columns);
        let GhostExchange { received, departures, arrivals, buffers, inner, .. } = self;
        let mut receive = |which, arrivals: &mut [_], received: &[_], patches: &mut [P]| {
            let packed = PackedGroups { departures, received, columns };
            for_each_pair(pool, arrivals, patches, buffers, |buffers, k, arrival, patch| {
                if inner[k] == which {
                    packed.receive(arrival, patch.as_mut(), buffers);
                }
            });
        };
        let mut on_this_rank = || {
            receive(true, arrivals, &[], patches);
            meanwhile(patches);
        };
        if self.send_ranks.is_empty() && self.receive_ranks.is_empty() {
            on_this_rank();
        } else {
            with_sends(&self.send_ranks, &self.messages, |sends| {
                comm.exchange(sends, &self.receive_ranks, received, &mut on_this_rank)
            });
        }
        for (m, words) in received.iter().enumerate() {
            list_groups(&self.patches, arrivals, words, Source::Message(m), columns);
        }
        receive(false, arrivals, received, patches);
        Ok(())
    }

    /// Packs the particles that other patches need and removes those that left their patch.
    fn pack<P: AsMut<Block<D>> + Send>(
        &mut self,
        patches: &mut [P],
        pool: Option<&ThreadPool>,
    ) -> Result<(), ParticleError> {
        let GhostExchange { reach, departures, gone, migrated, .. } = self;
        for_each_pair(pool, departures, patches, gone, |gone, _, departure, patch| {
            let block = patch.as_mut();
            block.drop_ghosts();
            block.stirred = reach.notice.is_none() || !block.active.is_empty();
            departure.pack(block, *reach, gone);
        });
        for departure in departures {
            if let Some(fault) = departure.fault.take() {
                return Err(fault);
            }
            *migrated += departure.migrated;
        }
        Ok(())
    }

    /// Lists the packed groups of this rank's patches for each other.
    fn list_own_groups(&mut self, columns: PackedColumns) {
        let GhostExchange { patches, arrivals, departures, .. } = self;
        arrivals.iter_mut().for_each(|arrival| arrival.groups.clear());
        for (k, departure) in departures.iter().enumerate() {
            for (b, bundle) in departure.bundles.iter().enumerate() {
                if bundle.taker == Taker::Here {
                    list_groups(patches, arrivals, &bundle.words, Source::Here(k, b), columns);
                }
            }
        }
    }

    /// Joins the packed groups for other ranks to one message for each.
    fn gather_messages(&mut self) {
        self.messages.iter_mut().for_each(Vec::clear);
        for bundle in self.departures.iter().flat_map(|departure| &departure.bundles) {
            if let Some(rank) = bundle.taker.rank() {
                let at = self.send_ranks.binary_search(&rank).expect("a rank with a bundle");
                self.messages[at].extend_from_slice(&bundle.words);
            }
        }
    }
}

/// Lists the groups in `words` at the patches that they are for. `numbers` are the numbers of the
/// patches.
fn list_groups<const D: usize>(
    numbers: &[usize],
    arrivals: &mut [Arrival<D>],
    words: &[u64],
    source: Source,
    columns: PackedColumns,
) {
    let mut rest = words;
    let mut at = 0;
    while let Some((group, after)) = Group::<D>::split_first(rest, columns) {
        for patch in group.patches() {
            let k = numbers.binary_search(&patch).expect("a patch of this rank");
            arrivals[k].groups.push(GroupPlace { source, at });
        }
        at += rest.len() - after.len();
        rest = after;
    }
}

impl<const D: usize> Departure<D> {
    /// Packs the particles of `block` that other patches need and removes those that left it, which
    /// are in `gone` afterwards, ascending.
    fn pack(&mut self, block: &mut Block<D>, reach: GhostReach, gone: &mut Vec<usize>) {
        let Departure { patch, home, bundles, migrated, fault } = self;
        // cells that no other patch sees
        let inner = home.grow(-reach.depth);
        gone.clear();
        for particle in outside(&block.cells[..block.own()], inner) {
            let cell = block.cells[particle].map(i64::from);
            let stays = home.contains(cell);
            let mut owned = stays;
            for bundle in bundles.iter_mut() {
                owned |= bundle.sort_in(particle as u32, cell, stays, *patch);
            }
            if !owned {
                let (id, cell) = (block.ids[particle], cell.to_vec());
                *fault = Some(ParticleError::MovedTooFar { id, patch: *patch, cell });
                return;
            }
            if !stays {
                gone.push(particle);
            }
        }
        let stirs = reach.notice.is_some() && !block.active.is_empty();
        for bundle in bundles {
            bundle.words.clear();
            if stirs {
                bundle.put_stirs(block, *patch);
            }
            bundle.put_particles(block);
        }
        *migrated = gone.len() as u64;
        if !gone.is_empty() {
            block.remove(gone);
        }
    }
}

/// Number of cells that are compared together.
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
            exchange.run(&Serial, &mut blocks, None, &mut |_| {}).unwrap();
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
        let error = exchange.run(&Serial, &mut blocks, None, &mut |_| {}).unwrap_err();
        assert!(error.to_string().contains("particle 5"), "{error}");
    }
}
