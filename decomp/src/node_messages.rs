//! Nodal values between two ranks: a node that several patches of the other rank need travels once.

use std::collections::BTreeMap;

use crate::node_runs::{Run, runs};
use crate::{Image, IndexBox};

/// Nodes of one patch that patches of another rank copy in one image, in the order of a message.
#[derive(Clone, Debug)]
pub(crate) struct SharedNodes<const D: usize> {
    /// Signs of the image.
    pub flip: [bool; D],
    /// Number of values of a field.
    pub count: usize,
    /// At the giving rank: index of the patch in the rank's list, and the values in its arrays.
    pub given: Option<(usize, Vec<Run>)>,
    /// At the taking rank: indices of the patches, and which of the values go where in their arrays.
    pub taken: Vec<(usize, Vec<Run>)>,
}

/// Nodes that a patch of this rank, with its index in the rank's list, copies or gives, with the
/// nodes of its arrays.
#[derive(Clone, Debug)]
pub(crate) struct Party<const D: usize> {
    pub patch: usize,
    pub arrays: IndexBox<D>,
}

/// Nodes between this rank and one other, before they are put in order. A group is a giving patch and
/// an image, by their numbers, which both ranks know.
#[derive(Clone, Debug)]
pub(crate) struct Draft<const D: usize> {
    groups: BTreeMap<(usize, usize), DraftGroup<D>>,
}

#[derive(Clone, Debug)]
struct DraftGroup<const D: usize> {
    image: Image<D>,
    giver: Option<Party<D>>,
    /// Nodes in the image that a patch of the taking rank needs, and the patch if it is on this rank.
    takers: Vec<(IndexBox<D>, Option<Party<D>>)>,
}

impl<const D: usize> Default for Draft<D> {
    fn default() -> Self {
        Draft { groups: BTreeMap::new() }
    }
}

impl<const D: usize> Draft<D> {
    /// Adds the `nodes` of an image that one patch takes from another; `giver` or `taker` is on this
    /// rank. `number` holds the numbers of the giving patch and of the image.
    pub fn add(
        &mut self,
        number: (usize, usize),
        image: Image<D>,
        nodes: IndexBox<D>,
        giver: Option<Party<D>>,
        taker: Option<Party<D>>,
    ) {
        let group = self.groups.entry(number).or_insert_with(|| {
            let takers = Vec::new();
            DraftGroup { image, giver, takers }
        });
        group.takers.push((nodes, taker));
    }

    /// The groups in the order of a message, for arrays with `layers` values of a field per node.
    pub fn finish(self, layers: usize) -> Vec<SharedNodes<D>> {
        self.groups.into_values().map(|group| group.finish(layers)).collect()
    }
}

impl<const D: usize> DraftGroup<D> {
    fn finish(self, layers: usize) -> SharedNodes<D> {
        let DraftGroup { image, giver, takers } = self;
        // last direction first, as in arrays
        let key = |node: &[i64; D]| std::array::from_fn::<i64, D, _>(|a| node[D - 1 - a]);
        let mut nodes: Vec<[i64; D]> = takers.iter().flat_map(|(nodes, _)| nodes.iter()).collect();
        nodes.sort_unstable_by_key(key);
        nodes.dedup();
        let given = giver.map(|Party { patch, arrays }| {
            let pairs = (0..layers).flat_map(|layer| {
                let (source, place) = (layer * arrays.count(), layer * nodes.len());
                nodes.iter().enumerate().map(move |(k, node)| {
                    let node = image.source_node(*node);
                    ((source + arrays.flat(node)) as u32, (place + k) as u32)
                })
            });
            (patch, runs(pairs, image.flip[0]))
        });
        let taken = takers.into_iter().filter_map(|(own, taker)| {
            let Party { patch, arrays } = taker?;
            let (nodes, key) = (&nodes, &key);
            let pairs = (0..layers).flat_map(move |layer| {
                let (target, place) = (layer * arrays.count(), layer * nodes.len());
                own.iter().map(move |node| {
                    let k = nodes.partition_point(|other| key(other) < key(&node));
                    ((place + k) as u32, (target + arrays.flat(node)) as u32)
                })
            });
            Some((patch, runs(pairs, false)))
        });
        SharedNodes { flip: image.flip, given, taken: taken.collect(), count: layers * nodes.len() }
    }
}
