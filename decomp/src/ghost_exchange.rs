//! Ghost rows and migration, in one message a neighbouring rank.

use crate::packing::{put_rows, put_stir, take};
use crate::{Block, Comm, Image, IndexBox, Layout};

/// A row that cannot be handed on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RowError {
    /// It has moved further in one step than its patch's neighbours.
    #[error(
        "particle {id} moved from patch {patch} to cell {cell:?} in one step, past its neighbours"
    )]
    MovedTooFar {
        /// Its id.
        id: u64,
        /// The patch it was in.
        patch: usize,
        /// The cell it is in now.
        cell: Vec<i64>,
    },
}

/// How far rows are seen and move, in cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RowReach {
    /// Ghosts come from this far about a patch, see [`Layout::halo`].
    pub depth: i64,
    /// Most that a row moves between two exchanges.
    pub travel: i64,
    /// A patch is stirred by active cells this far about it; `None`: always.
    pub notice: Option<i64>,
}

/// A way in which rows of one patch appear at another.
#[derive(Clone, Debug)]
struct Route<const D: usize> {
    to: usize,
    taker: Taker,
    /// The taker's cells, those with ghosts about them, and those whose activity stirs it.
    home: IndexBox<D>,
    halo: IndexBox<D>,
    near: IndexBox<D>,
    /// Each with the rows to give as ghosts and those to hand over.
    images: Vec<(Image<D>, [Vec<u32>; 2])>,
}

/// Where a route's words go.
#[derive(Clone, Copy, Debug)]
enum Taker {
    /// To a message, by its place in the list of messages.
    Message(usize),
    /// To a patch of this rank that hears of no other rank.
    Inner,
    /// To a patch of this rank that does.
    Border,
}

/// Who gives rows to whom, for ghosts up to a given number of cells away.
///
/// One exchange does three things: it hands over own rows whose cell now belongs to another
/// patch, copies rows to every patch within reach of them, and tells patches near active cells
/// that they are stirred. Copies beyond a mirror or a joined side are images: their cell is the
/// image's, their columns change as declared.
#[derive(Clone, Debug)]
pub struct RowExchange<const D: usize> {
    reach: RowReach,
    patches: Vec<usize>,
    homes: Vec<IndexBox<D>>,
    /// For each patch of this rank, who may need its rows.
    routes: Vec<Vec<Route<D>>>,
    /// For each patch of this rank, whether it hears of no other rank.
    inner: Vec<bool>,
    /// Place of each patch in this rank's list.
    place: Vec<usize>,
    send_ranks: Vec<usize>,
    receive_ranks: Vec<usize>,
    messages: Vec<Vec<u64>>,
    received: Vec<Vec<u64>>,
    to_inner: Vec<u64>,
    to_border: Vec<u64>,
    gone: Vec<usize>,
    migrated: u64,
}

impl<const D: usize> RowExchange<D> {
    /// The exchange on `rank`.
    pub fn new(layout: &Layout<D>, rank: usize, reach: RowReach) -> Self {
        let RowReach { depth, travel, notice } = reach;
        let seen = depth.max(notice.unwrap_or(0));
        let images = layout.images(seen + travel);
        let patches = layout.patches_of(rank);
        let mut place = vec![usize::MAX; layout.patches().len()];
        patches.iter().enumerate().for_each(|(k, &p)| place[p] = k);
        let boxes = layout.patches();

        // a patch is inner if no patch of another rank has a way to it
        let mut receive_ranks = Vec::new();
        let mut inner = vec![true; patches.len()];
        for (k, &to) in patches.iter().enumerate() {
            let halo = boxes[to].grow(seen);
            for image in &images {
                for from in layout.patches_in(&image.source_cells(&halo).grow(travel)) {
                    let giver = layout.rank_of(from);
                    if giver != rank {
                        inner[k] = false;
                        receive_ranks.push(giver);
                    }
                }
            }
        }
        let mut routes = Vec::new();
        let mut send_ranks = Vec::new();
        for &from in &patches {
            let reachable = boxes[from].grow(travel);
            let mut takers: Vec<usize> = images
                .iter()
                .flat_map(|image| layout.patches_in(&image.cells(&reachable).grow(seen)))
                .collect();
            takers.sort_unstable();
            takers.dedup();
            let route = |to: usize| {
                let halo = layout.halo(to, depth);
                let near = boxes[to].grow(notice.unwrap_or(-1));
                let sees = boxes[to].grow(seen);
                let taker = match place[to] {
                    usize::MAX => Taker::Message(layout.rank_of(to)),
                    k if inner[k] => Taker::Inner,
                    _ => Taker::Border,
                };
                // a row that has crossed a joined side carries a cell at the other end already
                let meets = |t: &&Image<D>| !t.cells(layout.domain()).intersect(&sees).is_empty();
                let images = images.iter().filter(meets).map(|&t| (t, Default::default()));
                Route { to, taker, home: boxes[to], halo, near, images: images.collect() }
            };
            let from_here: Vec<Route<D>> = takers.into_iter().map(route).collect();
            send_ranks.extend(from_here.iter().filter_map(|r| match r.taker {
                Taker::Message(rank) => Some(rank),
                _ => None,
            }));
            routes.push(from_here);
        }
        for ranks in [&mut send_ranks, &mut receive_ranks] {
            ranks.sort_unstable();
            ranks.dedup();
        }
        for route in routes.iter_mut().flatten() {
            if let Taker::Message(rank) = &mut route.taker {
                *rank = send_ranks.binary_search(rank).expect("a rank with a route");
            }
        }
        RowExchange {
            reach,
            homes: patches.iter().map(|&p| boxes[p]).collect(),
            patches,
            routes,
            inner,
            place,
            messages: vec![Vec::new(); send_ranks.len()],
            received: vec![Vec::new(); receive_ranks.len()],
            send_ranks,
            receive_ranks,
            to_inner: Vec::new(),
            to_border: Vec::new(),
            gone: Vec::new(),
            migrated: 0,
        }
    }

    /// Rows that this rank's patches have handed over since the last call.
    pub fn take_migrated(&mut self) -> u64 {
        std::mem::take(&mut self.migrated)
    }

    /// For each patch of this rank, whether it hears of no other rank.
    pub fn inner(&self) -> &[bool] {
        &self.inner
    }

    /// Hands over the rows that have moved and renews all ghosts. `patches` are this rank's, in
    /// order; their rows carry their new cells, within the domain. Afterwards each block is in
    /// canonical order.
    ///
    /// `meanwhile` is called once, with all patches, while messages are on their way: those that
    /// are [`inner`](Self::inner) are whole by then. Collective between neighbours.
    pub fn run<P: AsMut<Block<D>>>(
        &mut self,
        comm: &dyn Comm,
        patches: &mut [P],
        meanwhile: &mut dyn FnMut(&mut [P]),
    ) -> Result<(), RowError> {
        self.messages.iter_mut().for_each(Vec::clear);
        self.to_inner.clear();
        self.to_border.clear();
        for (k, patch) in patches.iter_mut().enumerate() {
            let block = patch.as_mut();
            block.drop_ghosts();
            block.stirred = self.reach.notice.is_none() || !block.active.is_empty();
            self.give(k, block)?;
        }
        let RowExchange { place, inner, received, .. } = self;
        let mut on_this_rank = || {
            let words = std::slice::from_ref(&self.to_inner);
            settle(place, words, patches, inner, true);
            meanwhile(patches);
        };
        if self.send_ranks.is_empty() && self.receive_ranks.is_empty() {
            on_this_rank();
        } else {
            with_sends(&self.send_ranks, &self.messages, |sends| {
                comm.exchange(sends, &self.receive_ranks, received, &mut on_this_rank)
            });
        }
        // this rank's own words stand with those of the others
        received.push(std::mem::take(&mut self.to_border));
        settle(place, received, patches, inner, false);
        self.to_border = received.pop().expect("it was pushed");
        Ok(())
    }

    /// Packs what others need of `block` and takes out what is no longer its own.
    fn give(&mut self, k: usize, block: &mut Block<D>) -> Result<(), RowError> {
        let home = self.homes[k];
        // cells that nobody else can see
        let inner = home.grow(-self.reach.depth);
        self.gone.clear();
        let RowExchange { routes, messages, to_inner, to_border, .. } = self;
        let (routes, patch) = (&mut routes[k], self.patches[k]);
        for row in 0..block.own() {
            let cell = block.cells[row].map(i64::from);
            if inner.contains(cell) {
                continue;
            }
            let stays = home.contains(cell);
            let mut owned = stays;
            for route in routes.iter_mut() {
                for (image, [ghosts, movers]) in &mut route.images {
                    let at = image.cell(cell);
                    if !route.halo.contains(at) {
                        continue;
                    }
                    // a row that stays needs no word; one that leaves may come back as a ghost
                    let original = *image == Image::IDENTITY;
                    if stays && original && route.to == patch {
                        continue;
                    }
                    let own = original && route.home.contains(at);
                    owned |= own;
                    if own { movers.push(row as u32) } else { ghosts.push(row as u32) }
                }
            }
            if !owned {
                let id = block.ids[row];
                return Err(RowError::MovedTooFar { id, patch, cell: cell.to_vec() });
            }
            if !stays {
                self.gone.push(row);
            }
        }
        let stirs = self.reach.notice.is_some() && !block.active.is_empty();
        for route in routes.iter_mut() {
            let out = match route.taker {
                Taker::Message(m) => &mut messages[m],
                Taker::Inner => &mut *to_inner,
                Taker::Border => &mut *to_border,
            };
            let near = |t: &Image<D>| !t.cells(&block.active).intersect(&route.near).is_empty();
            if stirs && route.to != patch && route.images.iter().any(|(t, _)| near(t)) {
                put_stir(out, route.to);
            }
            for (image, [ghosts, movers]) in &mut route.images {
                put_rows(out, block, movers, route.to, true, image);
                put_rows(out, block, ghosts, route.to, false, image);
                movers.clear();
                ghosts.clear();
            }
        }
        if !self.gone.is_empty() {
            self.migrated += self.gone.len() as u64;
            block.remove(&self.gone);
        }
        Ok(())
    }
}

/// Most neighbouring ranks whose list of messages is made without allocating.
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

/// Adds the rows of messages to their blocks and brings the blocks that are (or are not) inner
/// into canonical order: own rows first, then ghosts, for a block keeps them apart.
fn settle<const D: usize>(
    place: &[usize],
    messages: &[Vec<u64>],
    patches: &mut [impl AsMut<Block<D>>],
    inner: &[bool],
    which: bool,
) {
    for ghosts in [false, true] {
        for words in messages {
            take(place, words, patches, ghosts);
        }
        for (patch, _) in patches.iter_mut().zip(inner).filter(|(_, i)| **i == which) {
            let block = patch.as_mut();
            if ghosts { block.sort_ghosts() } else { block.sort_own() }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ColumnSpec, IndexBox, Mirror, Serial, Side};
    use proptest::prelude::*;

    const SPECS: [ColumnSpec; 2] = [
        ColumnSpec { name: "v", unit: "m/s", ghost: true, state: true, mirror: Mirror::Negate(0) },
        ColumnSpec { name: "e", unit: "J/kg", ghost: false, state: true, mirror: Mirror::Same },
    ];

    /// A row's cell, id and `v`, as a patch sees it.
    type Seen<const D: usize> = ([i64; D], u64, f64);

    /// Rows at cells, moved by moves and exchanged; then each patch's rows in canonical order.
    fn seen<const D: usize>(
        layout: &Layout<D>,
        rows: &[([i64; D], [i64; D])],
        depth: i64,
    ) -> Vec<Vec<Seen<D>>> {
        let count = layout.patches().len();
        let mut blocks: Vec<Block<D>> = (0..count).map(|_| Block::new(&SPECS)).collect();
        for (id, (cell, _)) in rows.iter().enumerate() {
            let p = layout.patch_of(*cell);
            blocks[p].push(id as u64, cell.map(|c| c as i32), &[id as f64 + 1.0, 0.5]);
        }
        let reach = RowReach { depth, travel: 1, notice: None };
        let mut exchange = RowExchange::new(layout, 0, reach);
        for round in 0..2 {
            for block in &mut blocks {
                block.drop_ghosts();
                for row in 0..block.own() {
                    let by =
                        rows[block.ids[row] as usize].1.map(|m| if round == 0 { 0 } else { m });
                    let from = block.cells[row].map(i64::from);
                    let to = layout.wrap_cell(std::array::from_fn(|a| from[a] + by[a])).unwrap();
                    block.cells[row] = to.map(|c| c as i32);
                }
            }
            exchange.run(&Serial, &mut blocks, &mut |_| {}).unwrap();
        }
        blocks
            .iter()
            .map(|b| {
                let mut runs = Vec::new();
                b.runs(&mut runs);
                let row = |r: usize| (b.cells[r].map(i64::from), b.ids[r], b.columns[0][r]);
                runs.into_iter().flatten().map(row).collect()
            })
            .collect()
    }

    const KINDS: [[Side; 2]; 4] = [
        [Side::Open, Side::Open],
        [Side::Mirror, Side::Open],
        [Side::Wrap, Side::Wrap],
        [Side::Mirror, Side::Mirror],
    ];

    /// A patch of a cut domain sees the rows that the whole domain sees there, in order.
    fn check<const D: usize>(
        domain: IndexBox<D>,
        sides: [[Side; 2]; D],
        parts: [usize; D],
        rows: &[([i64; D], [i64; D])],
        depth: i64,
    ) {
        let cut = Layout::new(domain, sides, parts);
        let all = &seen(&Layout::new(domain, sides, [1; D]), rows, depth)[0];
        for (patch, got) in seen(&cut, rows, depth).into_iter().enumerate() {
            let halo = cut.halo(patch, depth);
            let expected: Vec<_> = all.iter().filter(|r| halo.contains(r.0)).copied().collect();
            assert_eq!(got, expected, "patch {patch}");
        }
    }

    proptest! {
        #[test]
        fn a_cut_line_sees_what_the_whole_sees(
            rows in prop::collection::vec((1i64..23, -1i64..=1), 1..30),
            parts in 1usize..13,
            depth in 1i64..5,
            kind in 0usize..4,
        ) {
            let rows: Vec<_> = rows.iter().map(|r| ([r.0], [r.1])).collect();
            check(IndexBox::new([0], [24]), [KINDS[kind]], [parts], &rows, depth);
        }

        #[test]
        fn a_cut_plane_sees_what_the_whole_sees(
            rows in prop::collection::vec(((1i64..11, 1i64..8), (-1i64..=1, -1i64..=1)), 1..30),
            parts in (1usize..6, 1usize..5),
            depth in 1i64..4,
            kinds in (0usize..4, 0usize..4),
        ) {
            let rows: Vec<_> =
                rows.iter().map(|r| ([r.0.0, r.0.1], [r.1.0, r.1.1])).collect();
            let sides = [KINDS[kinds.0], KINDS[kinds.1]];
            check(IndexBox::new([0, 0], [12, 9]), sides, [parts.0, parts.1], &rows, depth);
        }
    }

    #[test]
    fn a_row_that_jumps_over_its_neighbours_is_named() {
        let layout = Layout::new(IndexBox::new([0], [40]), [[Side::Open; 2]], [10]);
        let mut blocks: Vec<Block<1>> = (0..10).map(|_| Block::new(&SPECS)).collect();
        blocks[0].push(5, [30], &[0.0, 0.0]);
        let reach = RowReach { depth: 2, travel: 1, notice: None };
        let mut exchange = RowExchange::new(&layout, 0, reach);
        let error = exchange.run(&Serial, &mut blocks, &mut |_| {}).unwrap_err();
        assert!(error.to_string().contains("particle 5"), "{error}");
    }
}
