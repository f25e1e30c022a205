//! Nodal values, and finished values from the patch that owns a node.

use crate::{Comm, Image, IndexBox, Layout, Side};

/// How a nodal field behaves in a mirror.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parity {
    /// The same on both sides.
    Even,
    /// The opposite beyond a mirror across this axis, and zero on it: a component of a vector.
    Odd(usize),
}

/// Arrays over the nodes of one patch: those it owns and a halo about them.
#[derive(Clone, Debug)]
pub struct NodeArrays<const D: usize> {
    /// All nodes that are held.
    pub nodes: IndexBox<D>,
    /// The nodes that the patch owns.
    pub owned: IndexBox<D>,
    /// One array a field, over `nodes`.
    pub fields: Vec<Vec<f64>>,
}

impl<const D: usize> NodeArrays<D> {
    /// `fields` arrays of zeros for `patch`, with a halo of `depth` nodes about its cells.
    pub fn new(layout: &Layout<D>, patch: usize, depth: i64, fields: usize) -> Self {
        let mut nodes = layout.patches()[patch].grow(depth);
        nodes.upper = nodes.upper.map(|u| u + 1);
        let owned = layout.owned_nodes(patch, depth);
        NodeArrays { nodes, owned, fields: vec![vec![0.0; nodes.count()]; fields] }
    }

    /// The arrays at `which`, all at once. They must differ.
    pub fn fields_mut<const N: usize>(&mut self, which: [usize; N]) -> [&mut [f64]; N] {
        self.fields
            .get_disjoint_mut(which)
            .expect("fields are declared and differ")
            .map(|f| f.as_mut_slice())
    }
}

/// Takes the nodes of a mirror out of `owned`: they are their own image.
pub(crate) fn leave_out_mirror<const D: usize>(
    layout: &Layout<D>,
    image: &Image<D>,
    owned: &mut IndexBox<D>,
) {
    for a in 0..D {
        if image.flip[a] {
            // the node that this mirroring leaves in place, if any
            let fixed = image.shift[a];
            let (lower, upper) = (layout.domain().lower[a], layout.domain().upper[a]);
            if fixed == 2 * lower {
                owned.lower[a] = owned.lower[a].max(lower + 1);
            } else if fixed == 2 * upper {
                owned.upper[a] = owned.upper[a].min(upper);
            } else if fixed < 2 * lower {
                // an image of an image: the node it shares with that one has been given already
                owned.lower[a] = owned.lower[a].max(lower + 1);
            } else {
                owned.upper[a] = owned.upper[a].min(upper);
            }
        } else if image.shift[a] != 0 && layout.sides()[a] == [Side::Mirror; 2] {
            if image.shift[a] > 0 {
                owned.lower[a] = owned.lower[a].max(layout.domain().lower[a] + 1);
            } else {
                owned.upper[a] = owned.upper[a].min(layout.domain().upper[a]);
            }
        }
    }
}

/// One stretch of nodes that one patch takes from another (or from itself, across a side).
#[derive(Clone, Debug)]
struct Copy<const D: usize> {
    from: usize,
    to: usize,
    /// At the taker.
    nodes: IndexBox<D>,
    image: Image<D>,
}

/// Who takes which nodes from whom.
#[derive(Clone, Debug)]
pub struct NodeExchange<const D: usize> {
    layout: Layout<D>,
    /// Between patches of this rank.
    local: Vec<Copy<D>>,
    /// To each rank, by rank.
    sends: Vec<(usize, Vec<Copy<D>>)>,
    /// From each rank, by rank.
    receives: Vec<(usize, Vec<Copy<D>>)>,
    /// Place of each patch in this rank's list.
    place: Vec<Option<usize>>,
    messages: Vec<Vec<u64>>,
    received: Vec<Vec<u64>>,
}

impl<const D: usize> NodeExchange<D> {
    /// The exchange for halos of `depth` nodes, on `rank`.
    pub fn new(layout: &Layout<D>, rank: usize, depth: i64) -> Self {
        let mut plan = NodeExchange {
            layout: layout.clone(),
            local: Vec::new(),
            sends: Vec::new(),
            receives: Vec::new(),
            place: vec![None; layout.patches().len()],
            messages: Vec::new(),
            received: Vec::new(),
        };
        for (k, p) in layout.patches_of(rank).into_iter().enumerate() {
            plan.place[p] = Some(k);
        }
        let images = layout.images(depth);
        let count = layout.patches().len();
        for to in 0..count {
            let taker = layout.rank_of(to);
            let mut halo = layout.patches()[to].grow(depth);
            halo.upper = halo.upper.map(|u| u + 1);
            for from in 0..count {
                let giver = layout.rank_of(from);
                if taker != rank && giver != rank {
                    continue;
                }
                for image in &images {
                    if from == to && *image == Image::IDENTITY {
                        continue;
                    }
                    let mut owned = layout.owned_nodes(from, depth);
                    leave_out_mirror(layout, image, &mut owned);
                    let nodes = image.nodes(&owned).intersect(&halo);
                    if owned.is_empty() || nodes.is_empty() {
                        continue;
                    }
                    let copy = Copy { from, to, nodes, image: *image };
                    if taker == giver {
                        plan.local.push(copy);
                    } else if giver == rank {
                        add(&mut plan.sends, taker, copy);
                    } else {
                        add(&mut plan.receives, giver, copy);
                    }
                }
            }
        }
        plan.sends.sort_by_key(|s| s.0);
        plan.receives.sort_by_key(|r| r.0);
        plan.messages = vec![Vec::new(); plan.sends.len()];
        plan
    }

    /// Fills the halos of `fields` with the owners' values, and sets fields that are odd in a
    /// mirror to zero on it. `patches` are this rank's, in order. Collective between neighbours.
    pub fn refresh<'a, C: Comm + ?Sized>(
        &mut self,
        comm: &C,
        patches: &mut [impl AsMut<NodeArrays<D>> + 'a],
        fields: &[(usize, Parity)],
    ) {
        for &(field, parity) in fields {
            if let Parity::Odd(axis) = parity {
                for arrays in patches.iter_mut() {
                    zero_on_mirrors(&self.layout, arrays.as_mut(), field, axis);
                }
            }
        }
        for ((_, copies), message) in self.sends.iter().zip(&mut self.messages) {
            message.clear();
            for copy in copies {
                let from = self.place[copy.from].expect("a patch of this rank");
                let arrays = patches[from].as_mut();
                for &(field, parity) in fields {
                    let values = &arrays.fields[field];
                    for node in copy.nodes.iter() {
                        let value = values[arrays.nodes.flat(copy.image.source_node(node))];
                        message.push(sign(value, parity, &copy.image).to_bits());
                    }
                }
            }
        }
        for copy in &self.local {
            let from = self.place[copy.from].expect("a patch of this rank");
            let to = self.place[copy.to].expect("a patch of this rank");
            for &(field, parity) in fields {
                for node in copy.nodes.iter() {
                    let giver = patches[from].as_mut();
                    let at = giver.nodes.flat(copy.image.source_node(node));
                    let value = sign(giver.fields[field][at], parity, &copy.image);
                    let taker = patches[to].as_mut();
                    let at = taker.nodes.flat(node);
                    taker.fields[field][at] = value;
                }
            }
        }
        if !self.sends.is_empty() || !self.receives.is_empty() {
            let sends: Vec<(usize, &[u64])> =
                self.sends.iter().zip(&self.messages).map(|(s, m)| (s.0, &m[..])).collect();
            let from: Vec<usize> = self.receives.iter().map(|r| r.0).collect();
            comm.exchange(&sends, &from, &mut self.received, &mut || {});
        }
        for ((_, copies), message) in self.receives.iter().zip(&self.received) {
            let mut words = message.iter();
            for copy in copies {
                let to = self.place[copy.to].expect("a patch of this rank");
                let arrays = patches[to].as_mut();
                for &(field, _) in fields {
                    for node in copy.nodes.iter() {
                        let word = words.next().expect("the giver sends what the taker expects");
                        let at = arrays.nodes.flat(node);
                        arrays.fields[field][at] = f64::from_bits(*word);
                    }
                }
            }
        }
    }
}

fn add<const D: usize>(list: &mut Vec<(usize, Vec<Copy<D>>)>, rank: usize, copy: Copy<D>) {
    match list.iter_mut().find(|(r, _)| *r == rank) {
        Some((_, copies)) => copies.push(copy),
        None => list.push((rank, vec![copy])),
    }
}

fn sign<const D: usize>(value: f64, parity: Parity, image: &Image<D>) -> f64 {
    match parity {
        Parity::Odd(axis) if image.flip[axis] => -value,
        _ => value,
    }
}

/// Fills the nodes of one patch beyond the mirrors of the domain from its own nodes before them:
/// what [`NodeExchange::refresh`] does there, for a patch that holds all it needs.
pub fn fold_mirrors<const D: usize>(
    layout: &Layout<D>,
    arrays: &mut NodeArrays<D>,
    fields: &[(usize, Parity)],
) {
    for axis in 0..D {
        let domain = layout.domain();
        // between two mirrors an image may need another image first
        let turns = arrays.nodes.extent(axis) / domain.extent(axis).max(1) + 1;
        let sides = (0..turns).flat_map(|_| layout.sides()[axis].iter().enumerate());
        for (end, side) in sides {
            if *side != Side::Mirror {
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
                        let value = arrays.fields[field][arrays.nodes.flat(source)];
                        arrays.fields[field][arrays.nodes.flat(node)] = sign(value, parity, &image);
                    }
                }
            }
        }
    }
    for &(field, parity) in fields {
        if let Parity::Odd(axis) = parity {
            zero_on_mirrors(layout, arrays, field, axis);
        }
    }
}

/// Sets a field that is odd across `axis` to zero on the mirrors of that axis.
fn zero_on_mirrors<const D: usize>(
    layout: &Layout<D>,
    arrays: &mut NodeArrays<D>,
    field: usize,
    axis: usize,
) {
    for (end, side) in layout.sides()[axis].iter().enumerate() {
        if *side != Side::Mirror {
            continue;
        }
        let at = if end == 0 { layout.domain().lower[axis] } else { layout.domain().upper[axis] };
        let mut plane = arrays.nodes;
        plane.lower[axis] = plane.lower[axis].max(at);
        plane.upper[axis] = plane.upper[axis].min(at + 1);
        if !plane.is_empty() {
            for node in plane.iter() {
                let k = arrays.nodes.flat(node);
                arrays.fields[field][k] = 0.0;
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

    fn check(sides: [Side; 2], parts: usize, exact: impl Fn(i64) -> f64, parity: Parity) {
        let layout = Layout::new(IndexBox::new([0], [10]), [sides], [parts]);
        let mut exchange = NodeExchange::new(&layout, 0, 4);
        let mut patches: Vec<_> = (0..parts).map(|p| NodeArrays::new(&layout, p, 4, 1)).collect();
        for arrays in &mut patches {
            for node in arrays.owned.iter() {
                let at = arrays.nodes.flat(node);
                arrays.fields[0][at] = exact(node[0]);
            }
        }
        exchange.refresh(&Serial, &mut patches, &[(0, parity)]);
        for arrays in &patches {
            for node in arrays.nodes.iter() {
                let got = arrays.fields[0][arrays.nodes.flat(node)];
                assert_eq!(got, exact(node[0]), "node {node:?} of {parts} patches");
            }
        }
    }

    #[test]
    fn halos_hold_the_owners_values() {
        for parts in [1, 2, 3, 7, 10] {
            check([Side::Open; 2], parts, |i| 1.0 + i as f64, Parity::Even);
            check([Side::Wrap; 2], parts, |i| i.rem_euclid(10) as f64, Parity::Even);
            check([Side::Mirror, Side::Open], parts, |i| i as f64, Parity::Odd(0));
            check([Side::Open, Side::Mirror], parts, |i| (i - 10).abs() as f64, Parity::Even);
            let both =
                |i: i64| (std::f64::consts::PI * i as f64 / 10.0).cos().mul_add(1e3, 0.0).round();
            check([Side::Mirror; 2], parts, both, Parity::Even);
        }
    }
}
