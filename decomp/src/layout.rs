//! The domain cut into patches, what stands at its sides, and which rank has which patch.

use crate::IndexBox;

/// What stands at a side of the domain, as far as copies go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Nothing: nodes beyond it belong to the patch at the side.
    Open,
    /// A mirror: what lies beyond is the image of what lies before.
    Mirror,
    /// Joined to the opposite side.
    Wrap,
}

/// How a patch's indices appear elsewhere: shifted around, or mirrored at a side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Image<const D: usize> {
    /// Whether the direction is mirrored.
    pub flip: [bool; D],
    /// Node i appears at i + shift, or at shift - i where mirrored.
    pub shift: [i64; D],
}

impl<const D: usize> Image<D> {
    /// The patch itself.
    pub const IDENTITY: Self = Image { flip: [false; D], shift: [0; D] };

    /// Where node `i` appears.
    pub fn node(&self, i: [i64; D]) -> [i64; D] {
        std::array::from_fn(
            |a| if self.flip[a] { self.shift[a] - i[a] } else { i[a] + self.shift[a] },
        )
    }

    /// Where cell `c` (between nodes c and c + 1) appears.
    pub fn cell(&self, c: [i64; D]) -> [i64; D] {
        std::array::from_fn(|a| {
            if self.flip[a] { self.shift[a] - 1 - c[a] } else { c[a] + self.shift[a] }
        })
    }

    /// The cells that appear in `b`.
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

    /// The node that appears at `i`.
    pub fn source_node(&self, i: [i64; D]) -> [i64; D] {
        std::array::from_fn(
            |a| if self.flip[a] { self.shift[a] - i[a] } else { i[a] - self.shift[a] },
        )
    }

    /// Where the cells of `b` appear.
    pub fn cells(&self, b: &IndexBox<D>) -> IndexBox<D> {
        self.boxed(b, 0)
    }

    /// Where the nodes of `b` appear.
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

/// The domain cut into patches, dealt to ranks. Every rank holds the whole of it.
#[derive(Clone, Debug)]
pub struct Layout<const D: usize> {
    domain: IndexBox<D>,
    sides: [[Side; 2]; D],
    patches: Vec<IndexBox<D>>,
    ranks: Vec<usize>,
    cuts: [Vec<i64>; D],
}

impl<const D: usize> Layout<D> {
    /// Cuts `domain` (a box of cells) into `parts` patches in each direction, all on rank 0.
    /// `sides[axis]` are the lower and the upper side.
    pub fn new(domain: IndexBox<D>, sides: [[Side; 2]; D], parts: [usize; D]) -> Self {
        let cuts = std::array::from_fn(|a| {
            (0..=parts[a] as i64)
                .map(|k| domain.lower[a] + k * domain.extent(a) as i64 / parts[a] as i64)
                .collect()
        });
        Layout::with_cuts(domain, sides, cuts)
    }

    /// Cuts `domain` at the cells `cuts` in each direction, its ends among them, all on rank 0.
    pub fn with_cuts(domain: IndexBox<D>, sides: [[Side; 2]; D], cuts: [Vec<i64>; D]) -> Self {
        let parts = IndexBox::new([0; D], std::array::from_fn(|a| cuts[a].len() as i64 - 1));
        let corner =
            |k: [i64; D], more: i64| std::array::from_fn(|a| cuts[a][(k[a] + more) as usize]);
        let patches: Vec<_> =
            parts.iter().map(|k| IndexBox::new(corner(k, 0), corner(k, 1))).collect();
        let ranks = vec![0; patches.len()];
        Layout { domain, sides, patches, ranks, cuts }
    }

    /// The same patches with patch k on rank `ranks[k]`.
    pub fn with_ranks(mut self, ranks: Vec<usize>) -> Self {
        assert_eq!(ranks.len(), self.patches.len(), "one rank a patch");
        self.ranks = ranks;
        self
    }

    /// The box of all cells.
    pub fn domain(&self) -> &IndexBox<D> {
        &self.domain
    }

    /// The cells of each patch.
    pub fn patches(&self) -> &[IndexBox<D>] {
        &self.patches
    }

    /// The rank that has `patch`.
    pub fn rank_of(&self, patch: usize) -> usize {
        self.ranks[patch]
    }

    /// The patches of `rank`, in order.
    pub fn patches_of(&self, rank: usize) -> Vec<usize> {
        (0..self.patches.len()).filter(|&p| self.ranks[p] == rank).collect()
    }

    /// The sides of the domain.
    pub fn sides(&self) -> &[[Side; 2]; D] {
        &self.sides
    }

    /// The cell `c` brought into the domain across joined sides, or `None` if it lies outside.
    pub fn wrap_cell(&self, mut c: [i64; D]) -> Option<[i64; D]> {
        for (a, c) in c.iter_mut().enumerate() {
            if self.sides[a][0] == Side::Wrap {
                let lower = self.domain.lower[a];
                *c = (*c - lower).rem_euclid(self.domain.extent(a) as i64) + lower;
            }
        }
        self.domain.contains(c).then_some(c)
    }

    /// The patch that holds the cell `c`, which lies in the domain.
    pub fn patch_of(&self, c: [i64; D]) -> usize {
        let mut at = 0;
        for a in (0..D).rev() {
            let k = self.cuts[a].partition_point(|&cut| cut <= c[a]) - 1;
            at = at * (self.cuts[a].len() - 1) + k;
        }
        at
    }

    /// The cells whose rows a patch needs to sum up the nodes that it owns, where rows reach as
    /// far as `depth` cells: nodes stand at lower corners of cells, so that above the patch one
    /// cell less is needed than below it, unless the side of the domain is there, whose nodes it
    /// owns too.
    pub fn halo(&self, patch: usize, depth: i64) -> IndexBox<D> {
        let home = &self.patches[patch];
        let mut halo = home.grow(depth);
        for a in 0..D {
            let at_side = home.upper[a] == self.domain.upper[a];
            if depth > 0 && (!at_side || self.sides[a][1] == Side::Wrap) {
                halo.upper[a] -= 1;
            }
        }
        halo
    }

    /// The patches that hold a cell of `b`, in order.
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

    /// The rank of each patch.
    pub fn ranks(&self) -> &[usize] {
        &self.ranks
    }

    /// The nodes that `patch` owns: those at its cells' lower corners, at an upper side the last
    /// ones too, and at an open side `depth` more beyond it.
    pub fn owned_nodes(&self, patch: usize, depth: i64) -> IndexBox<D> {
        let mut nodes = self.patches[patch];
        for a in 0..D {
            if nodes.lower[a] == self.domain.lower[a] && self.sides[a][0] == Side::Open {
                nodes.lower[a] -= depth;
            }
            if nodes.upper[a] == self.domain.upper[a] {
                nodes.upper[a] += match self.sides[a][1] {
                    Side::Open => depth + 1,
                    Side::Mirror => 1,
                    Side::Wrap => 0,
                };
            }
        }
        nodes
    }

    /// All ways in which patches appear within `depth` cells about the domain.
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
            [Side::Wrap, _] | [_, Side::Wrap] => (-turns..=turns).map(|k| (false, k * n)).collect(),
            [Side::Mirror, Side::Mirror] => (-turns..=turns)
                .flat_map(|k| [(false, 2 * n * k), (true, 2 * lower + 2 * n * k)])
                .collect(),
            [Side::Mirror, Side::Open] => vec![(false, 0), (true, 2 * lower)],
            [Side::Open, Side::Mirror] => vec![(false, 0), (true, 2 * upper)],
            [Side::Open, Side::Open] => vec![(false, 0)],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(sides: [Side; 2], parts: usize) -> Layout<1> {
        Layout::new(IndexBox::new([0], [10]), [sides], [parts])
    }

    #[test]
    fn every_node_about_the_domain_has_one_owner_under_images() {
        for sides in [
            [Side::Open, Side::Open],
            [Side::Mirror, Side::Open],
            [Side::Open, Side::Mirror],
            [Side::Mirror, Side::Mirror],
            [Side::Wrap, Side::Wrap],
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
        let layout = Layout::new(IndexBox::new([-3, 2], [8, 9]), [[Side::Open; 2]; 2], [3, 2]);
        for cell in layout.domain().iter() {
            assert!(layout.patches()[layout.patch_of(cell)].contains(cell));
        }
    }

    #[test]
    fn patches_in_a_box_are_those_that_meet_it() {
        let layout = Layout::new(IndexBox::new([-3, 2], [8, 9]), [[Side::Open; 2]; 2], [3, 2]);
        for (lower, upper) in
            [([-9, -9], [20, 20]), ([0, 3], [5, 4]), ([4, 4], [4, 9]), ([-3, 8], [8, 9])]
        {
            let b = IndexBox::new(lower, upper);
            let met: Vec<usize> = layout.patches_in(&b).collect();
            let all = layout.patches().iter().enumerate();
            let expected: Vec<usize> =
                all.filter(|(_, p)| !p.intersect(&b).is_empty()).map(|(k, _)| k).collect();
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
