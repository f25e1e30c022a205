//! Ghost rows and migration, in one message a neighbouring rank.

use crate::{Block, Comm, Image, Layout};

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

/// A way in which rows of one patch appear at another.
#[derive(Clone, Debug)]
struct Route<const D: usize> {
    to: usize,
    /// Of the taker's list of messages, or `None` on this rank.
    message: Option<usize>,
    images: Vec<Image<D>>,
}

/// Who gives rows to whom, for ghosts up to a given number of cells away.
///
/// One exchange does both: it hands over own rows whose cell now belongs to another patch, and
/// copies rows to every patch within reach of them. Copies beyond a mirror or a joined side are
/// images: their cell is the image's, their columns change as declared.
#[derive(Clone, Debug)]
pub struct RowExchange<const D: usize> {
    layout: Layout<D>,
    depth: i64,
    /// For each patch of this rank, who may need its rows.
    routes: Vec<Vec<Route<D>>>,
    send_ranks: Vec<usize>,
    receive_ranks: Vec<usize>,
    patches: Vec<usize>,
    messages: Vec<Vec<u64>>,
    received: Vec<Vec<u64>>,
    local: Vec<u64>,
    row: Vec<f64>,
}

impl<const D: usize> RowExchange<D> {
    /// The exchange on `rank` with ghosts from `depth` cells about each patch. Between two calls
    /// of `run` a row may move by up to `travel` cells.
    pub fn new(layout: &Layout<D>, rank: usize, depth: i64, travel: i64) -> Self {
        let count = layout.patches().len();
        let images = layout.images(depth + travel);
        let mut exchange = RowExchange {
            layout: layout.clone(),
            depth,
            routes: Vec::new(),
            send_ranks: Vec::new(),
            receive_ranks: Vec::new(),
            patches: layout.patches_of(rank),
            messages: Vec::new(),
            received: Vec::new(),
            local: Vec::new(),
            row: Vec::new(),
        };
        for from in 0..count {
            let giver = layout.rank_of(from);
            let reachable = layout.patches()[from].grow(travel);
            let mut routes = Vec::new();
            for to in 0..count {
                let taker = layout.rank_of(to);
                if giver != rank && taker != rank {
                    continue;
                }
                let halo = layout.patches()[to].grow(depth);
                if !images.iter().any(|t| !t.cells(&reachable).intersect(&halo).is_empty()) {
                    continue;
                }
                if giver == rank && taker != rank && !exchange.send_ranks.contains(&taker) {
                    exchange.send_ranks.push(taker);
                }
                if taker == rank && giver != rank && !exchange.receive_ranks.contains(&giver) {
                    exchange.receive_ranks.push(giver);
                }
                let images = images
                    .iter()
                    .filter(|t| !t.cells(layout.domain()).intersect(&halo).is_empty())
                    .copied()
                    .collect();
                routes.push(Route { to, message: None, images });
            }
            if giver == rank {
                exchange.routes.push(routes);
            }
        }
        exchange.send_ranks.sort_unstable();
        exchange.receive_ranks.sort_unstable();
        for route in exchange.routes.iter_mut().flatten() {
            let taker = layout.rank_of(route.to);
            route.message = exchange.send_ranks.iter().position(|&r| r == taker);
        }
        exchange.messages = vec![Vec::new(); exchange.send_ranks.len()];
        exchange
    }

    /// Hands over the rows that have moved and renews all ghosts. `blocks` are this rank's, in
    /// order; their rows carry their new cells, within the domain. Afterwards each block is in
    /// canonical order. Collective between neighbours.
    pub fn run<'a, C: Comm + ?Sized>(
        &mut self,
        comm: &C,
        blocks: &mut [impl AsMut<Block<D>> + 'a],
    ) -> Result<(), RowError> {
        for message in &mut self.messages {
            message.clear();
        }
        self.local.clear();
        for (k, block) in blocks.iter_mut().enumerate() {
            let block = block.as_mut();
            block.drop_ghosts();
            self.give(k, block)?;
        }
        let sends: Vec<(usize, &[u64])> =
            self.send_ranks.iter().zip(&self.messages).map(|(&r, m)| (r, &m[..])).collect();
        comm_exchange(comm, &sends, &self.receive_ranks, &mut self.received);
        // own rows first, then ghosts: a block keeps them apart
        for ghosts in [false, true] {
            for words in std::iter::once(&self.local).chain(&self.received) {
                take(&self.patches, words, blocks, ghosts, &mut self.row);
            }
            for block in blocks.iter_mut() {
                let block = block.as_mut();
                if ghosts { block.sort_ghosts() } else { block.sort_own() }
            }
        }
        Ok(())
    }

    /// Packs what others need of `block` and takes out what is no longer its own.
    fn give(&mut self, k: usize, block: &mut Block<D>) -> Result<(), RowError> {
        let patch = self.patches[k];
        let home = self.layout.patches()[patch];
        // cells that nobody else can see
        let inner = home.grow(-self.depth);
        let mut gone = 0;
        let mut keep = Vec::new();
        for row in 0..block.own() {
            let cell = block.cells[row].map(i64::from);
            if inner.contains(cell) {
                continue;
            }
            let stays = home.contains(cell);
            let mut owned = stays;
            for route in &self.routes[k] {
                let box_of_taker = self.layout.patches()[route.to];
                let halo = box_of_taker.grow(self.depth);
                for image in &route.images {
                    let at = image.cell(cell);
                    if !halo.contains(at) {
                        continue;
                    }
                    let original = *image == Image::IDENTITY;
                    let own = original && box_of_taker.contains(at);
                    if original && route.to == patch && own {
                        continue;
                    }
                    owned |= own;
                    let out = match route.message {
                        Some(m) => &mut self.messages[m],
                        None => &mut self.local,
                    };
                    pack(out, block, row, route.to, at, own, image);
                }
            }
            if !owned {
                return Err(RowError::MovedTooFar {
                    id: block.ids[row],
                    patch,
                    cell: cell.to_vec(),
                });
            }
            if !stays {
                keep.resize(block.own(), true);
                keep[row] = false;
                gone += 1;
            }
        }
        if gone > 0 {
            block.retain(&keep);
        }
        Ok(())
    }
}

fn comm_exchange<C: Comm + ?Sized>(
    comm: &C,
    sends: &[(usize, &[u64])],
    from: &[usize],
    received: &mut Vec<Vec<u64>>,
) {
    if sends.is_empty() && from.is_empty() {
        received.clear();
    } else {
        comm.exchange(sends, from, received, &mut || {});
    }
}

/// A row in a message: patch and kind, id, cell, then its columns.
fn pack<const D: usize>(
    out: &mut Vec<u64>,
    block: &Block<D>,
    row: usize,
    to: usize,
    cell: [i64; D],
    own: bool,
    image: &Image<D>,
) {
    out.push((to as u64) << 1 | u64::from(own));
    out.push(block.ids[row]);
    out.extend(cell.map(|c| c as u64));
    for (spec, column) in block.specs().iter().zip(&block.columns) {
        if own || spec.ghost {
            out.push(spec.image(column[row], &image.flip).to_bits());
        }
    }
}

/// Adds the rows of a message to their blocks: ghosts, or those that moved.
fn take<'a, const D: usize>(
    patches: &[usize],
    words: &[u64],
    blocks: &mut [impl AsMut<Block<D>> + 'a],
    ghosts: bool,
    row: &mut Vec<f64>,
) {
    let mut at = 0;
    while at < words.len() {
        let (to, own) = ((words[at] >> 1) as usize, words[at] & 1 == 1);
        let place = patches.iter().position(|&p| p == to).expect("a patch of this rank");
        let block = blocks[place].as_mut();
        let columns = block.specs().iter().filter(|s| own || s.ghost).count();
        let start = at + 2 + D;
        if own != ghosts {
            let id = words[at + 1];
            let cell = std::array::from_fn(|a| words[at + 2 + a] as i64 as i32);
            row.clear();
            row.extend(words[start..start + columns].iter().map(|&w| f64::from_bits(w)));
            if own { block.push(id, cell, row) } else { block.push_ghost(id, cell, row) }
        }
        at = start + columns;
    }
}

/// The own rows of all ranks at rank 0, by id: `(id, values of the columns in `which`)` flattened
/// into one vector of ids and one vector a column; empty elsewhere. Collective.
pub fn gather_rows<'a, const D: usize, C: Comm + ?Sized>(
    comm: &C,
    blocks: impl Iterator<Item = &'a Block<D>>,
    which: &[usize],
) -> (Vec<u64>, Vec<Vec<f64>>) {
    let mut words = Vec::new();
    for block in blocks {
        for row in 0..block.own() {
            words.push(block.ids[row]);
            words.extend(which.iter().map(|&c| block.columns[c][row].to_bits()));
        }
    }
    let width = 1 + which.len();
    let all = comm.gather(&words);
    let mut rows: Vec<&[u64]> = all.iter().flat_map(|w| w.chunks(width)).collect();
    rows.sort_unstable_by_key(|r| r[0]);
    let ids = rows.iter().map(|r| r[0]).collect();
    let columns = (1..width).map(|c| rows.iter().map(|r| f64::from_bits(r[c])).collect()).collect();
    (ids, columns)
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
        let mut exchange = RowExchange::new(layout, 0, depth, 1);
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
            exchange.run(&Serial, &mut blocks).unwrap();
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
        for (patch, got) in cut.patches().iter().zip(seen(&cut, rows, depth)) {
            let halo = patch.grow(depth);
            let expected: Vec<_> = all.iter().filter(|r| halo.contains(r.0)).copied().collect();
            assert_eq!(got, expected, "{patch:?}");
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
        let error = RowExchange::new(&layout, 0, 2, 1).run(&Serial, &mut blocks).unwrap_err();
        assert!(error.to_string().contains("particle 5"), "{error}");
    }
}
