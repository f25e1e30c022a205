//! Orders of the patches along which they are assigned to ranks.

use crate::hilbert;

/// An order of the patches of a box with some number of patches per direction. Positions in it
/// follow from the numbers of the patches, and no table is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PatchOrder<const D: usize> {
    parts: [usize; D],
    path: Path,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Path {
    Hilbert,
    /// Stripe by stripe normal to this axis.
    Stripes(usize),
}

impl<const D: usize> PatchOrder<D> {
    /// The order of the Hilbert curve; on a line, that of the line.
    ///
    /// ```
    /// use decomp::PatchOrder;
    ///
    /// let order = PatchOrder::hilbert([2, 2]);
    /// assert_eq!(order.patches(), [0, 2, 3, 1]);
    /// assert_eq!((order.position(2), order.patch_at(3)), (1, 1));
    /// ```
    pub fn hilbert(parts: [usize; D]) -> Self {
        PatchOrder { parts, path: Path::Hilbert }
    }

    /// Stripe by stripe normal to `axis`; every second stripe runs backwards, so that neighbours in
    /// the order are neighbours in space.
    pub fn stripes(parts: [usize; D], axis: usize) -> Self {
        PatchOrder { parts, path: Path::Stripes(axis) }
    }

    /// Position of `patch` in this order.
    pub fn position(&self, patch: usize) -> usize {
        let mut rest = patch;
        let place = self.parts.map(|n| {
            let k = rest % n;
            rest /= n;
            k
        });
        match self.path {
            Path::Hilbert => hilbert::position(self.parts, place),
            Path::Stripes(axis) => {
                let within = self.across(axis).fold(0, |at, a| at * self.parts[a] + place[a]);
                self.turned(axis, place[axis], within)
            }
        }
    }

    /// The patch at `position` in this order.
    pub fn patch_at(&self, position: usize) -> usize {
        match self.path {
            Path::Hilbert => self.flat(hilbert::place_at(self.parts, position)),
            Path::Stripes(axis) => {
                let length: usize = self.across(axis).map(|a| self.parts[a]).product();
                let stripe = position / length;
                let mut within = self.turned(axis, stripe, position % length) % length;
                let mut place = [stripe; D];
                for a in self.across(axis).rev() {
                    place[a] = within % self.parts[a];
                    within /= self.parts[a];
                }
                self.flat(place)
            }
        }
    }

    /// All patches in this order.
    pub fn patches(&self) -> Vec<usize> {
        let count = self.parts.iter().product();
        match self.path {
            Path::Hilbert => {
                let mut all = Vec::with_capacity(count);
                hilbert::walk(self.parts, &mut |place| all.push(self.flat(place)));
                all
            }
            Path::Stripes(_) => (0..count).map(|position| self.patch_at(position)).collect(),
        }
    }

    /// The directions of a stripe.
    fn across(&self, axis: usize) -> impl DoubleEndedIterator<Item = usize> + use<D> {
        (0..D).filter(move |&a| a != axis)
    }

    /// Position of the patch `within` a stripe, which runs backwards if its number is odd.
    fn turned(&self, axis: usize, stripe: usize, within: usize) -> usize {
        let length: usize = self.across(axis).map(|a| self.parts[a]).product();
        stripe * length + if stripe % 2 == 1 { length - 1 - within } else { within }
    }

    fn flat(&self, place: [usize; D]) -> usize {
        (0..D).rev().fold(0, |at, a| at * self.parts[a] + place[a])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stripes_turn_at_their_ends() {
        assert_eq!(PatchOrder::stripes([3, 2], 1).patches(), [0, 1, 2, 5, 4, 3]);
        assert_eq!(PatchOrder::stripes([2, 3], 0).patches(), [0, 2, 4, 5, 3, 1]);
    }

    #[test]
    fn every_patch_has_one_position() {
        for parts in [[1, 1], [5, 3], [1, 9], [7, 7]] {
            let stripes = [0, 1].map(|axis| PatchOrder::stripes(parts, axis));
            for order in stripes.into_iter().chain([PatchOrder::hilbert(parts)]) {
                let patches = order.patches();
                assert_eq!(patches.len(), parts[0] * parts[1]);
                for (position, patch) in patches.into_iter().enumerate() {
                    assert_eq!(order.position(patch), position, "{order:?}");
                    assert_eq!(order.patch_at(position), patch, "{order:?}");
                }
            }
        }
    }
}
