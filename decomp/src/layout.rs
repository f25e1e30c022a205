//! The domain cut into patches, its sides, and the assignment of patches to ranks.

use crate::owners::Owners;
use crate::{IndexBox, PatchOrder};

/// Kind of a side of the domain, as far as it concerns copies of particles and nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SideKind {
    /// Open: nodes beyond it belong to the patch at the side.
    Open,
    /// A mirror: everything beyond it is an image of the inside.
    Mirror,
    /// Joined to the opposite side.
    Wrap,
}

/// Transformation of a patch's indices: a shift, or a reflection at a side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Image<const D: usize> {
    /// Whether the direction is mirrored.
    pub flip: [bool; D],
    /// Node i maps to i + shift, or to shift - i in a mirrored direction.
    pub shift: [i64; D],
}

impl<const D: usize> Image<D> {
    /// The patch itself.
    pub const IDENTITY: Self = Image { flip: [false; D], shift: [0; D] };

    /// Image of node `i`.
    pub fn node(&self, i: [i64; D]) -> [i64; D] {
        std::array::from_fn(
            |a| if self.flip[a] { self.shift[a] - i[a] } else { i[a] + self.shift[a] },
        )
    }

    /// Image of cell `c` (between nodes c and c + 1).
    pub fn cell(&self, c: [i64; D]) -> [i64; D] {
        std::array::from_fn(|a| {
            if self.flip[a] { self.shift[a] - 1 - c[a] } else { c[a] + self.shift[a] }
        })
    }

    /// The cells whose images lie in `b`.
    pub fn source_cells(&self, b: &IndexBox<D>) -> IndexBox<D> {
        IndexBox {
            lower: std::array::from_fn(|a| match self.flip[a] {
                true => self.shift[a] - b.upper[a],
                false => b.lower[a] - self.shift[a],
            }),
            upper: std::array::from_fn(|a| match self.flip[a] {
                true => self.shift[a] - b.lower[a],
                false => b.upper[a] - self.shift[a],
            }),
        }
    }

    /// The node whose image is `i`.
    pub fn source_node(&self, i: [i64; D]) -> [i64; D] {
        std::array::from_fn(
            |a| if self.flip[a] { self.shift[a] - i[a] } else { i[a] - self.shift[a] },
        )
    }

    /// Images of the cells of `b`.
    pub fn cells(&self, b: &IndexBox<D>) -> IndexBox<D> {
        self.boxed(b, 0)
    }

    /// Images of the nodes of `b`.
    pub fn nodes(&self, b: &IndexBox<D>) -> IndexBox<D> {
        self.boxed(b, 1)
    }

    fn boxed(&self, b: &IndexBox<D>, node: i64) -> IndexBox<D> {
        IndexBox {
            lower: std::array::from_fn(|a| {
                if self.flip[a] {
                    self.shift[a] - b.upper[a] + node
                } else {
                    b.lower[a] + self.shift[a]
                }
            }),
            upper: std::array::from_fn(|a| {
                if self.flip[a] {
                    self.shift[a] - b.lower[a] + node
                } else {
                    b.upper[a] + self.shift[a]
                }
            }),
        }
    }
}

/// The domain cut into patches, with the rank of each patch. Every rank holds the whole layout: the
/// cuts in each direction, and the ranks of runs of patches along an order. It holds nothing for
/// each patch.
#[derive(Clone, Debug)]
pub struct Layout<const D: usize> {
    domain: IndexBox<D>,
    sides: [[SideKind; 2]; D],
    cuts: [Vec<i64>; D],
    order: PatchOrder<D>,
    owners: Owners,
}

impl<const D: usize> Layout<D> {
    /// Cuts `domain` (a box of cells) into `parts` patches per direction, all on rank 0.
    /// `sides[axis]` holds the lower and the upper side.
    ///
    /// ```
    /// use decomp::{IndexBox, Layout, SideKind::Open};
    ///
    /// let cells = IndexBox::new([0, 0], [8, 4]);
    /// let layout = Layout::new(cells, [[Open; 2]; 2], [2, 2]);
    /// assert_eq!(layout.patch_of([5, 1]), 1);
    /// assert_eq!(layout.patch_of([5, 3]), 3);
    /// assert_eq!(layout.wrap_cell([8, 0]), None);
    /// ```
    pub fn new(domain: IndexBox<D>, sides: [[SideKind; 2]; D], parts: [usize; D]) -> Self {
        let cuts = std::array::from_fn(|a| {
            (0..=parts[a] as i64)
                .map(|k| domain.lower[a] + k * domain.extent(a) as i64 / parts[a] as i64)
                .collect()
        });
        Layout::with_cuts(domain, sides, cuts)
    }

    /// Cuts `domain` at the cells `cuts` in each direction, which include both ends; all patches
    /// are on rank 0.
    pub fn with_cuts(domain: IndexBox<D>, sides: [[SideKind; 2]; D], cuts: [Vec<i64>; D]) -> Self {
        let parts: [usize; D] = std::array::from_fn(|a| cuts[a].len() - 1);
        let owners = Owners::new(&vec![0; parts.iter().product()]);
        Layout { domain, sides, cuts, order: PatchOrder::hilbert(parts), owners }
    }

    /// The same patches, assigned to ranks along `order`; `ranks` holds the rank at each position.
    ///
    /// # Panics
    ///
    /// If the number of ranks differs from the number of patches.
    pub fn with_ranks(mut self, order: PatchOrder<D>, ranks: &[u32]) -> Self {
        assert_eq!(ranks.len(), self.count(), "one rank a patch");
        (self.order, self.owners) = (order, Owners::new(ranks));
        self
    }

    /// The box of all cells.
    pub fn domain(&self) -> &IndexBox<D> {
        &self.domain
    }

    /// Number of patches.
    pub fn count(&self) -> usize {
        self.parts().iter().product()
    }

    /// The cells of `patch`.
    pub fn patch(&self, patch: usize) -> IndexBox<D> {
        let (mut rest, mut cells) = (patch, self.domain);
        for (a, cuts) in self.cuts.iter().enumerate() {
            let k = rest % (cuts.len() - 1);
            rest /= cuts.len() - 1;
            (cells.lower[a], cells.upper[a]) = (cuts[k], cuts[k + 1]);
        }
        cells
    }

    /// Width of the narrowest patch [cells].
    pub fn narrowest(&self) -> usize {
        let widths = self.cuts.iter().flat_map(|cuts| cuts.windows(2).map(|w| w[1] - w[0]));
        widths.min().unwrap_or(0) as usize
    }

    /// The order of the patches along which they are assigned to ranks.
    pub fn order(&self) -> PatchOrder<D> {
        self.order
    }

    /// The rank of each patch, in the [`order`](Self::order).
    pub fn ranks(&self) -> Vec<u32> {
        self.owners.to_vec()
    }

    /// The rank of `patch`.
    pub fn rank_of(&self, patch: usize) -> usize {
        self.owners.rank(self.order.position(patch))
    }

    /// The patches of `rank`, ascending.
    pub fn patches_of(&self, rank: usize) -> Vec<usize> {
        let positions = self.owners.positions_of(rank);
        let mut patches: Vec<usize> = positions.map(|k| self.order.patch_at(k)).collect();
        patches.sort_unstable();
        patches
    }

    /// The lower and the upper side of the domain, per direction.
    pub fn sides(&self) -> &[[SideKind; 2]; D] {
        &self.sides
    }

    /// The cell `c`, moved into the domain across joined sides; `None` if it lies outside.
    #[inline]
    pub fn wrap_cell(&self, mut c: [i64; D]) -> Option<[i64; D]> {
        for (a, c) in c.iter_mut().enumerate() {
            if self.sides[a][0] == SideKind::Wrap {
                let lower = self.domain.lower[a];
                *c = (*c - lower).rem_euclid(self.domain.extent(a) as i64) + lower;
            }
        }
        self.domain.contains(c).then_some(c)
    }

    /// The patch that contains the cell `c`, which must lie in the domain.
    #[inline]
    pub fn patch_of(&self, c: [i64; D]) -> usize {
        let mut at = 0;
        for a in (0..D).rev() {
            let k = self.cuts[a].partition_point(|&cut| cut <= c[a]) - 1;
            at = at * (self.cuts[a].len() - 1) + k;
        }
        at
    }

    /// The cells whose particles a patch needs to sum up the nodes that it owns, if a particle
    /// reaches nodes up to `depth` cells away. Nodes lie at the lower corners of cells, so the halo
    /// is one cell thinner above the patch than below it. At an upper side of the domain it is not,
    /// because the patch also owns the nodes of that side.
    pub fn halo(&self, patch: usize, depth: i64) -> IndexBox<D> {
        let home = self.patch(patch);
        let mut halo = home.grow(depth);
        for a in 0..D {
            let at_side = home.upper[a] == self.domain.upper[a];
            if depth > 0 && (!at_side || self.sides[a][1] == SideKind::Wrap) {
                halo.upper[a] -= 1;
            }
        }
        halo
    }

    /// The patches that contain a cell of `b`, in order.
    pub fn patches_in(&self, b: &IndexBox<D>) -> impl Iterator<Item = usize> + use<D> {
        let b = b.intersect(&self.domain);
        let parts: [usize; D] = std::array::from_fn(|a| self.cuts[a].len() - 1);
        let first = |a: usize, c: i64| self.cuts[a].partition_point(|&cut| cut <= c) as i64 - 1;
        let range = match b.is_empty() {
            true => IndexBox::new([0; D], [0; D]),
            false => IndexBox::new(
                std::array::from_fn(|a| first(a, b.lower[a])),
                std::array::from_fn(|a| first(a, b.upper[a] - 1) + 1),
            ),
        };
        range.iter().map(move |k| (0..D).rev().fold(0, |at, a| at * parts[a] + k[a] as usize))
    }

    /// Number of patches in each direction.
    pub fn parts(&self) -> [usize; D] {
        std::array::from_fn(|a| self.cuts[a].len() - 1)
    }

    /// The nodes that `patch` owns: those at the lower corners of its cells, the last nodes at an
    /// upper side, and `depth` nodes more beyond an open side.
    pub fn owned_nodes(&self, patch: usize, depth: i64) -> IndexBox<D> {
        let mut nodes = self.patch(patch);
        for a in 0..D {
            if nodes.lower[a] == self.domain.lower[a] && self.sides[a][0] == SideKind::Open {
                nodes.lower[a] -= depth;
            }
            if nodes.upper[a] == self.domain.upper[a] {
                nodes.upper[a] += match self.sides[a][1] {
                    SideKind::Open => depth + 1,
                    SideKind::Mirror => 1,
                    SideKind::Wrap => 0,
                };
            }
        }
        nodes
    }

    /// All images of patches that appear within `depth` cells around the domain.
    pub fn images(&self, depth: i64) -> Vec<Image<D>> {
        let mut all = vec![Image::IDENTITY];
        for a in 0..D {
            let axis = self.axis_images(a, depth);
            all = all
                .iter()
                .flat_map(|base| {
                    axis.iter().map(move |&(flip, shift)| {
                        let mut image = *base;
                        image.flip[a] = flip;
                        image.shift[a] = shift;
                        image
                    })
                })
                .collect();
        }
        all
    }

    fn axis_images(&self, a: usize, depth: i64) -> Vec<(bool, i64)> {
        let (lower, upper) = (self.domain.lower[a], self.domain.upper[a]);
        let n = upper - lower;
        let turns = depth / n + 1;
        match self.sides[a] {
            [SideKind::Wrap, _] | [_, SideKind::Wrap] => {
                (-turns..=turns).map(|k| (false, k * n)).collect()
            }
            [SideKind::Mirror, SideKind::Mirror] => (-turns..=turns)
                .flat_map(|k| [(false, 2 * n * k), (true, 2 * lower + 2 * n * k)])
                .collect(),
            [SideKind::Mirror, SideKind::Open] => vec![(false, 0), (true, 2 * lower)],
            [SideKind::Open, SideKind::Mirror] => vec![(false, 0), (true, 2 * upper)],
            [SideKind::Open, SideKind::Open] => vec![(false, 0)],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(sides: [SideKind; 2], parts: usize) -> Layout<1> {
        Layout::new(IndexBox::new([0], [10]), [sides], [parts])
    }

    #[test]
    fn every_node_about_the_domain_has_one_owner_under_images() {
        for sides in [
            [SideKind::Open, SideKind::Open],
            [SideKind::Mirror, SideKind::Open],
            [SideKind::Open, SideKind::Mirror],
            [SideKind::Mirror, SideKind::Mirror],
            [SideKind::Wrap, SideKind::Wrap],
        ] {
            for parts in [1, 3, 10] {
                let layout = line(sides, parts);
                for node in -13..=23i64 {
                    let mut owners = 0;
                    for image in layout.images(13) {
                        for p in 0..parts {
                            let mut own = layout.owned_nodes(p, 13);
                            crate::nodes::leave_out_mirror(&layout, &image, &mut own);
                            owners += usize::from(image.nodes(&own).contains([node]));
                        }
                    }
                    assert_eq!(owners, 1, "node {node} of {sides:?} in {parts} patches");
                }
            }
        }
    }

    #[test]
    fn patch_of_agrees_with_the_boxes() {
        let layout = Layout::new(IndexBox::new([-3, 2], [8, 9]), [[SideKind::Open; 2]; 2], [3, 2]);
        for cell in layout.domain().iter() {
            assert!(layout.patch(layout.patch_of(cell)).contains(cell));
        }
    }

    #[test]
    fn patches_in_a_box_are_those_that_meet_it() {
        let layout = Layout::new(IndexBox::new([-3, 2], [8, 9]), [[SideKind::Open; 2]; 2], [3, 2]);
        for (lower, upper) in
            [([-9, -9], [20, 20]), ([0, 3], [5, 4]), ([4, 4], [4, 9]), ([-3, 8], [8, 9])]
        {
            let b = IndexBox::new(lower, upper);
            let met: Vec<usize> = layout.patches_in(&b).collect();
            let meets = |&p: &usize| !layout.patch(p).intersect(&b).is_empty();
            let expected: Vec<usize> = (0..layout.count()).filter(meets).collect();
            assert_eq!(met, expected, "{b:?}");
        }
    }

    #[test]
    fn an_image_of_a_box_is_the_box_of_the_images() {
        let image = Image { flip: [true, false], shift: [6, -4] };
        let b = IndexBox::new([1, 2], [4, 7]);
        for i in b.iter() {
            assert!(image.nodes(&b).contains(image.node(i)));
            assert!(image.cells(&b).contains(image.cell(i)));
            assert_eq!(image.source_node(image.node(i)), i);
        }
        assert_eq!(image.nodes(&b).count(), b.count());
        assert_eq!(image.source_cells(&image.cells(&b)), b);
    }
}
