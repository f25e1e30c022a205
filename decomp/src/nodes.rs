//! Nodal arrays, and the exchange of finished values from the patch that owns a node.

use std::collections::BTreeMap;

use crate::ghost_exchange::with_sends;
use crate::node_messages::{Draft, Party, SharedNodes};
use crate::node_runs::{Run, runs};
use crate::{Comm, Image, IndexBox, Layout, SideKind};

/// Symmetry of a nodal field at a mirror.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parity {
    /// Equal on both sides.
    Even,
    /// Opposite sign beyond a mirror normal to this axis and zero on it: a vector component.
    Odd(usize),
}

/// Arrays over the nodes of one patch: its own nodes and a halo around them.
///
/// A node may hold several values of each field, one per layer. The layers of an array follow one
/// another; each covers all nodes.
#[derive(Clone, Debug)]
pub struct NodeArrays<const D: usize> {
    /// All nodes of the arrays.
    pub nodes: IndexBox<D>,
    /// The nodes that the patch owns.
    pub owned: IndexBox<D>,
    /// Number of values of a field per node.
    pub layers: usize,
    /// One array per field, over `nodes`, layer after layer; each in the unit of its field.
    pub fields: Vec<Vec<f64>>,
}

impl<const D: usize> NodeArrays<D> {
    /// Creates `fields` arrays of zeros for `patch`, with a halo of `depth` nodes around its cells.
    pub fn new(layout: &Layout<D>, patch: usize, depth: i64, fields: usize) -> Self {
        NodeArrays::layered(layout, patch, depth, fields, 1)
    }

    /// As `new`, with `layers` values of each field per node.
    pub fn layered(
        layout: &Layout<D>,
        patch: usize,
        depth: i64,
        fields: usize,
        layers: usize,
    ) -> Self {
        let mut nodes = layout.patch(patch).grow(depth);
        nodes.upper = nodes.upper.map(|u| u + 1);
        let owned = layout.owned_nodes(patch, depth);
        let fields = vec![vec![0.0; layers * nodes.count()]; fields];
        NodeArrays { nodes, owned, layers, fields }
    }

    /// Mutable access to several arrays at once; the indices `which` must differ.
    ///
    /// # Panics
    ///
    /// If an index is out of range or occurs twice.
    pub fn fields_mut<const N: usize>(&mut self, which: [usize; N]) -> [&mut [f64]; N] {
        self.fields
            .get_disjoint_mut(which)
            .expect("fields are declared and differ")
            .map(|f| f.as_mut_slice())
    }
}

/// Removes nodes on a mirror from `owned`, because each of them is its own image.
pub(crate) fn leave_out_mirror<const D: usize>(
    layout: &Layout<D>,
    image: &Image<D>,
    owned: &mut IndexBox<D>,
) {
    for a in 0..D {
        if image.flip[a] {
            // the node that this reflection maps to itself, if any
            let fixed = image.shift[a];
            let (lower, upper) = (layout.domain().lower[a], layout.domain().upper[a]);
            if fixed == 2 * lower {
                owned.lower[a] = owned.lower[a].max(lower + 1);
            } else if fixed == 2 * upper {
                owned.upper[a] = owned.upper[a].min(upper);
            } else if fixed < 2 * lower {
                // an image of an image: the node it shares with that image has already been given
                owned.lower[a] = owned.lower[a].max(lower + 1);
            } else {
                owned.upper[a] = owned.upper[a].min(upper);
            }
        } else if image.shift[a] != 0 && layout.sides()[a] == [SideKind::Mirror; 2] {
            if image.shift[a] > 0 {
                owned.lower[a] = owned.lower[a].max(layout.domain().lower[a] + 1);
            } else {
                owned.upper[a] = owned.upper[a].min(layout.domain().upper[a]);
            }
        }
    }
}

/// Nodes that one patch copies from another of this rank (or from itself, across a side).
#[derive(Clone, Debug)]
struct Copy<const D: usize> {
    /// Indices of the patches in the rank's list.
    from: usize,
    to: usize,
    flip: [bool; D],
    runs: Vec<Run>,
}

/// A run between two patches of this rank, copied without change of sign.
#[derive(Clone, Copy, Debug)]
struct PlainRun {
    /// Indices of the patches in the rank's list.
    from: u32,
    to: u32,
    run: Run,
}

/// Plan of the exchange of nodal values: which patch copies which nodes from which patch.
#[derive(Clone, Debug)]
pub struct NodeExchange<const D: usize> {
    domain: IndexBox<D>,
    sides: [[SideKind; 2]; D],
    /// Copies between patches of this rank without change of sign.
    plain: Vec<PlainRun>,
    /// All other copies between patches of this rank, or within one.
    local: Vec<Copy<D>>,
    /// Nodes sent to each rank of `send_ranks`.
    sends: Vec<Vec<SharedNodes<D>>>,
    send_ranks: Vec<usize>,
    /// Nodes received from each rank of `receive_ranks`.
    receives: Vec<Vec<SharedNodes<D>>>,
    receive_ranks: Vec<usize>,
    /// For each patch of this rank, whether it receives nothing from other ranks.
    inner: Vec<bool>,
    messages: Vec<Vec<u64>>,
    received: Vec<Vec<u64>>,
}

impl<const D: usize> NodeExchange<D> {
    /// Plans the exchange on `rank` for halos of `halo` nodes, in arrays with `depth` nodes around
    /// each patch's cells.
    pub fn new(layout: &Layout<D>, rank: usize, halo: i64, depth: i64) -> Self {
        NodeExchange::layered(layout, rank, halo, depth, 1)
    }

    /// As `new`, for arrays with `layers` values of each field per node.
    #[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
    pub fn layered(layout: &Layout<D>, rank: usize, halo: i64, depth: i64, layers: usize) -> Self {
        let patches = layout.patches_of(rank);
        let place = |patch| patches.binary_search(&patch).expect("a patch of this rank");
        let rank_of = |patch| match patches.binary_search(&patch) {
            Ok(_) => rank,
            Err(_) => layout.rank_of(patch),
        };
        let mut plan = NodeExchange {
            domain: *layout.domain(),
            sides: *layout.sides(),
            plain: Vec::new(),
            local: Vec::new(),
            sends: Vec::new(),
            send_ranks: Vec::new(),
            receives: Vec::new(),
            receive_ranks: Vec::new(),
            inner: vec![true; patches.len()],
            messages: Vec::new(),
            received: Vec::new(),
        };
        let images = layout.images(halo);
        let halo_of = |patch: usize| with_corners(layout.patch(patch).grow(halo));
        let arrays_of = |patch: usize| with_corners(layout.patch(patch).grow(depth));
        // a patch that owns a node of the halo has a cell within `halo` + 1 cells
        let mut pairs: Vec<(usize, usize)> = Vec::new();
        for &mine in &patches {
            let near = layout.patch(mine).grow(halo + 1);
            for image in &images {
                let givers = layout.patches_in(&image.source_cells(&near).grow(halo));
                pairs.extend(givers.map(|giver| (mine, giver)));
                let takers = layout.patches_in(&image.cells(&near).grow(halo));
                pairs.extend(takers.map(|taker| (taker, mine)));
            }
        }
        // the same order on both ranks
        pairs.sort_unstable();
        pairs.dedup();
        let [mut given, mut taken]: [BTreeMap<usize, Draft<D>>; 2] = Default::default();
        for (to, from) in pairs {
            let (taker, giver) = (rank_of(to), rank_of(from));
            for (number, image) in images.iter().enumerate() {
                if from == to && *image == Image::IDENTITY {
                    continue;
                }
                let mut owned = layout.owned_nodes(from, halo);
                leave_out_mirror(layout, image, &mut owned);
                let nodes = image.nodes(&owned).intersect(&halo_of(to));
                if owned.is_empty() || nodes.is_empty() {
                    continue;
                }
                let (giving, taking) = (arrays_of(from), arrays_of(to));
                if taker != giver {
                    let party = |patch: usize, arrays| Party { patch: place(patch), arrays };
                    let (draft, here, there) = match giver == rank {
                        true => (given.entry(taker), Some(party(from, giving)), None),
                        false => (taken.entry(giver), None, Some(party(to, taking))),
                    };
                    if there.is_some() {
                        plan.inner[place(to)] = false;
                    }
                    draft.or_default().add((from, number), *image, nodes, here, there);
                    continue;
                }
                let nodes = (0..layers).flat_map(|layer| {
                    let (from, to) = (layer * giving.count(), layer * taking.count());
                    let place = move |n| {
                        let source = from + giving.flat(image.source_node(n));
                        (source as u32, (to + taking.flat(n)) as u32)
                    };
                    nodes.iter().map(place)
                });
                let copy = Copy {
                    from: place(from),
                    to: place(to),
                    flip: image.flip,
                    runs: runs(nodes, image.flip[0]),
                };
                if from != to && !image.flip.contains(&true) {
                    let (from, to) = (copy.from as u32, copy.to as u32);
                    plan.plain.extend(copy.runs.iter().map(|&run| PlainRun { from, to, run }));
                } else {
                    plan.local.push(copy);
                }
            }
        }
        // any order is valid within a rank; equal lengths in a row are faster
        plan.plain.sort_by_key(|p| p.run.length);
        let finished = |drafts: BTreeMap<usize, Draft<D>>| {
            drafts.into_iter().map(|(rank, draft)| (rank, draft.finish(layers))).unzip()
        };
        (plan.send_ranks, plan.sends) = finished(given);
        (plan.receive_ranks, plan.receives) = finished(taken);
        plan.messages = vec![Vec::new(); plan.sends.len()];
        plan.received = vec![Vec::new(); plan.receives.len()];
        plan
    }

    /// For each patch of this rank, whether it receives nothing from other ranks.
    pub fn inner(&self) -> &[bool] {
        &self.inner
    }

    /// Ranks that get a message from this rank in each exchange.
    pub fn send_ranks(&self) -> &[usize] {
        &self.send_ranks
    }

    /// Number of values of a field in these messages together.
    pub fn values_sent(&self) -> usize {
        self.sends.iter().flatten().map(|shared| shared.count).sum()
    }

    /// Fills the halos of `fields` with the owners' values, and sets odd fields to zero on their
    /// mirrors. `patches` are the patches of this rank, in order.
    ///
    /// `meanwhile` is called once, with all patches, while messages are on their way. By then the
    /// halos of [`inner`](Self::inner) patches are filled, and `meanwhile` may change these
    /// patches. Collective between neighbours.
    pub fn refresh<P: AsMut<NodeArrays<D>>>(
        &mut self,
        comm: &dyn Comm,
        patches: &mut [P],
        fields: &[(usize, Parity)],
        meanwhile: &mut dyn FnMut(&mut [P]),
    ) {
        for &(field, parity) in fields {
            if let Parity::Odd(axis) = parity
                && self.sides[axis].contains(&SideKind::Mirror)
            {
                for arrays in patches.iter_mut() {
                    zero_on_mirrors(&self.domain, &self.sides, arrays.as_mut(), field, axis);
                }
            }
        }
        for (shared, message) in self.sends.iter().zip(&mut self.messages) {
            message.clear();
            for SharedNodes { flip, given, .. } in shared {
                let Some((from, runs)) = given else { continue };
                let arrays = patches[*from].as_mut();
                for &(field, parity) in fields {
                    let (values, sign) = (&arrays.fields[field], sign(parity, flip));
                    let sources = runs.iter().flat_map(|r| r.sources());
                    message.extend(sources.map(|n| (sign * values[n]).to_bits()));
                }
            }
        }
        let (plain, local) = (&self.plain, &self.local);
        let mut on_this_rank = || {
            copy_plain(patches, plain, fields);
            for copy in local {
                copy_fields(patches, copy, fields);
            }
            meanwhile(patches);
        };
        if self.sends.is_empty() && self.receives.is_empty() {
            on_this_rank();
        } else {
            with_sends(&self.send_ranks, &self.messages, |sends| {
                comm.exchange(sends, &self.receive_ranks, &mut self.received, &mut on_this_rank)
            });
        }
        for (shared, message) in self.receives.iter().zip(&self.received) {
            let mut words = &message[..];
            for SharedNodes { count, taken, .. } in shared {
                for &(field, _) in fields {
                    let (these, rest) = words.split_at(*count);
                    words = rest;
                    for (to, runs) in taken {
                        let values = &mut patches[*to].as_mut().fields[field];
                        for run in runs {
                            let words = &these[run.from as usize..][..run.length as usize];
                            for (value, word) in values[run.targets()].iter_mut().zip(words) {
                                *value = f64::from_bits(*word);
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Copies runs that are sorted by length. In one dimension a run is a few nodes, and a call of
/// memcpy per run would cost more than the copy.
fn copy_plain<const D: usize>(
    patches: &mut [impl AsMut<NodeArrays<D>>],
    runs: &[PlainRun],
    fields: &[(usize, Parity)],
) {
    for alike in runs.chunk_by(|a, b| a.run.length == b.run.length) {
        match alike[0].run.length {
            1 => copy_alike::<D, 1>(patches, alike, fields),
            2 => copy_alike::<D, 2>(patches, alike, fields),
            3 => copy_alike::<D, 3>(patches, alike, fields),
            4 => copy_alike::<D, 4>(patches, alike, fields),
            5 => copy_alike::<D, 5>(patches, alike, fields),
            6 => copy_alike::<D, 6>(patches, alike, fields),
            _ => copy_alike::<D, 0>(patches, alike, fields),
        }
    }
}

/// Copies runs of `N` nodes, or of any length if `N` is 0.
fn copy_alike<const D: usize, const N: usize>(
    patches: &mut [impl AsMut<NodeArrays<D>>],
    runs: &[PlainRun],
    fields: &[(usize, Parity)],
) {
    for &PlainRun { from, to, run } in runs {
        let [giver, taker] =
            patches.get_disjoint_mut([from as usize, to as usize]).expect("they differ");
        let (giver, taker) = (giver.as_mut(), taker.as_mut());
        let length = if N == 0 { run.length as usize } else { N };
        for &(field, _) in fields {
            let given = &giver.fields[field][run.from as usize..][..length];
            taker.fields[field][run.to as usize..][..length].copy_from_slice(given);
        }
    }
}

/// The nodes at the corners of a box of cells.
fn with_corners<const D: usize>(mut cells: IndexBox<D>) -> IndexBox<D> {
    cells.upper = cells.upper.map(|u| u + 1);
    cells
}

/// Copies between two patches of this rank, or within one.
fn copy_fields<const D: usize>(
    patches: &mut [impl AsMut<NodeArrays<D>>],
    copy: &Copy<D>,
    fields: &[(usize, Parity)],
) {
    if copy.from == copy.to {
        let arrays = patches[copy.to].as_mut();
        for &(field, parity) in fields {
            let (values, sign) = (&mut arrays.fields[field], sign(parity, &copy.flip));
            for run in &copy.runs {
                for (from, to) in run.sources().zip(run.targets()) {
                    values[to] = sign * values[from];
                }
            }
        }
        return;
    }
    let [giver, taker] = patches.get_disjoint_mut([copy.from, copy.to]).expect("they differ");
    let (giver, taker) = (giver.as_mut(), taker.as_mut());
    for &(field, parity) in fields {
        let sign = sign(parity, &copy.flip);
        let (from, to) = (&giver.fields[field], &mut taker.fields[field]);
        for run in &copy.runs {
            to[run.targets()].iter_mut().zip(run.sources()).for_each(|(t, f)| *t = sign * from[f]);
        }
    }
}

/// Factor of a field with this parity in an image. The product is exact; like a negation, it turns
/// 0 into -0 in a mirror.
fn sign<const D: usize>(parity: Parity, flip: &[bool; D]) -> f64 {
    match parity {
        Parity::Odd(axis) if flip[axis] => -1.0,
        _ => 1.0,
    }
}

/// Fills the nodes of one patch beyond the mirrors of the domain from its own nodes inside: the
/// part of [`NodeExchange::refresh`] for a patch that holds all nodes it needs.
pub fn fold_mirrors<const D: usize>(
    layout: &Layout<D>,
    arrays: &mut NodeArrays<D>,
    fields: &[(usize, Parity)],
) {
    for axis in 0..D {
        let domain = layout.domain();
        // between two mirrors, an image may need another image first
        let turns = arrays.nodes.extent(axis) / domain.extent(axis).max(1) + 1;
        let sides = (0..turns).flat_map(|_| layout.sides()[axis].iter().enumerate());
        for (end, side) in sides {
            if *side != SideKind::Mirror {
                continue;
            }
            let mut beyond = arrays.nodes;
            let at = match end {
                0 => {
                    beyond.upper[axis] = beyond.upper[axis].min(domain.lower[axis]);
                    domain.lower[axis]
                }
                _ => {
                    beyond.lower[axis] = beyond.lower[axis].max(domain.upper[axis] + 1);
                    domain.upper[axis]
                }
            };
            if beyond.is_empty() {
                continue;
            }
            let mut image = Image::IDENTITY;
            (image.flip[axis], image.shift[axis]) = (true, 2 * at);
            for &(field, parity) in fields {
                for node in beyond.iter() {
                    let source = image.source_node(node);
                    if arrays.nodes.contains(source) {
                        let (from, to) = (arrays.nodes.flat(source), arrays.nodes.flat(node));
                        for layer in 0..arrays.layers {
                            let first = layer * arrays.nodes.count();
                            let value = arrays.fields[field][first + from];
                            arrays.fields[field][first + to] = sign(parity, &image.flip) * value;
                        }
                    }
                }
            }
        }
    }
    for &(field, parity) in fields {
        if let Parity::Odd(axis) = parity {
            zero_on_mirrors(layout.domain(), layout.sides(), arrays, field, axis);
        }
    }
}

/// Sets a field that is odd in `axis` to zero on the mirrors of that axis.
fn zero_on_mirrors<const D: usize>(
    domain: &IndexBox<D>,
    sides: &[[SideKind; 2]; D],
    arrays: &mut NodeArrays<D>,
    field: usize,
    axis: usize,
) {
    for (end, side) in sides[axis].iter().enumerate() {
        if *side != SideKind::Mirror {
            continue;
        }
        let at = if end == 0 { domain.lower[axis] } else { domain.upper[axis] };
        let mut plane = arrays.nodes;
        plane.lower[axis] = plane.lower[axis].max(at);
        plane.upper[axis] = plane.upper[axis].min(at + 1);
        if !plane.is_empty() {
            for node in plane.iter() {
                let k = arrays.nodes.flat(node);
                for layer in 0..arrays.layers {
                    arrays.fields[field][k + layer * arrays.nodes.count()] = 0.0;
                }
            }
        }
    }
}

impl<const D: usize> AsMut<NodeArrays<D>> for NodeArrays<D> {
    fn as_mut(&mut self) -> &mut NodeArrays<D> {
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Serial;

    fn check(sides: [SideKind; 2], parts: usize, exact: impl Fn(i64) -> f64, parity: Parity) {
        let layout = Layout::new(IndexBox::new([0], [10]), [sides], [parts]);
        let mut exchange = NodeExchange::new(&layout, 0, 4, 4);
        let mut patches: Vec<_> = (0..parts).map(|p| NodeArrays::new(&layout, p, 4, 1)).collect();
        for arrays in &mut patches {
            for node in arrays.owned.iter() {
                let at = arrays.nodes.flat(node);
                arrays.fields[0][at] = exact(node[0]);
            }
        }
        exchange.refresh(&Serial, &mut patches, &[(0, parity)], &mut |_| {});
        for arrays in &patches {
            for node in arrays.nodes.iter() {
                let got = arrays.fields[0][arrays.nodes.flat(node)];
                assert_eq!(got, exact(node[0]), "node {node:?} of {parts} patches");
            }
        }
    }

    #[test]
    fn each_layer_has_its_own_values() {
        let layout =
            Layout::new(IndexBox::new([0], [10]), [[SideKind::Mirror, SideKind::Open]], [3]);
        let mut exchange = NodeExchange::layered(&layout, 0, 4, 4, 2);
        let mut patches: Vec<_> =
            (0..3).map(|p| NodeArrays::layered(&layout, p, 4, 1, 2)).collect();
        let place = |arrays: &NodeArrays<1>, node: [i64; 1], layer: usize| {
            arrays.nodes.flat(node) + layer * arrays.nodes.count()
        };
        for arrays in &mut patches {
            for (node, layer) in arrays.owned.iter().flat_map(|n| [(n, 0), (n, 1)]) {
                let at = place(arrays, node, layer);
                arrays.fields[0][at] = (node[0] * (1 + 10 * layer as i64)) as f64 + layer as f64;
            }
        }
        exchange.refresh(&Serial, &mut patches, &[(0, Parity::Odd(0))], &mut |_| {});
        for arrays in &patches {
            for (node, layer) in arrays.nodes.iter().flat_map(|n| [(n, 0), (n, 1)]) {
                let l = layer as i64;
                let exact = node[0].signum() * (node[0].abs() * (1 + 10 * l) + l);
                let got = arrays.fields[0][place(arrays, node, layer)];
                assert_eq!(got, exact as f64, "node {node:?}, layer {layer}");
            }
        }
    }

    #[test]
    fn halos_hold_the_owners_values() {
        for parts in [1, 2, 3, 7, 10] {
            check([SideKind::Open; 2], parts, |i| 1.0 + i as f64, Parity::Even);
            check([SideKind::Wrap; 2], parts, |i| i.rem_euclid(10) as f64, Parity::Even);
            check([SideKind::Mirror, SideKind::Open], parts, |i| i as f64, Parity::Odd(0));
            check(
                [SideKind::Open, SideKind::Mirror],
                parts,
                |i| (i - 10).abs() as f64,
                Parity::Even,
            );
            let both =
                |i: i64| (std::f64::consts::PI * i as f64 / 10.0).cos().mul_add(1e3, 0.0).round();
            check([SideKind::Mirror; 2], parts, both, Parity::Even);
        }
    }
}
