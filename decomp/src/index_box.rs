//! An n-dimensional range of indices. All index arithmetic is here.

/// The indices `lower <= i < upper` in each of `D` directions; the first direction runs fastest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct IndexBox<const D: usize> {
    /// First index in each direction.
    pub lower: [i64; D],
    /// One past the last index in each direction.
    pub upper: [i64; D],
}

impl<const D: usize> IndexBox<D> {
    /// The box from `lower` up to, not including, `upper`.
    pub fn new(lower: [i64; D], upper: [i64; D]) -> Self {
        IndexBox { lower, upper }
    }

    /// Number of indices along `axis`; 0 if the box is empty there.
    #[inline]
    pub fn extent(&self, axis: usize) -> usize {
        (self.upper[axis] - self.lower[axis]).max(0) as usize
    }

    /// Total number of indices.
    #[inline]
    pub fn count(&self) -> usize {
        (0..D).map(|a| self.extent(a)).product()
    }

    /// Whether no index is inside.
    pub fn is_empty(&self) -> bool {
        (0..D).any(|a| self.upper[a] <= self.lower[a])
    }

    /// Whether `index` is inside.
    #[inline]
    pub fn contains(&self, index: [i64; D]) -> bool {
        (0..D).all(|a| self.lower[a] <= index[a] && index[a] < self.upper[a])
    }

    /// The indices that lie in both boxes; possibly empty.
    pub fn intersect(&self, other: &Self) -> Self {
        IndexBox {
            lower: std::array::from_fn(|a| self.lower[a].max(other.lower[a])),
            upper: std::array::from_fn(|a| self.upper[a].min(other.upper[a])),
        }
    }

    /// The smallest box that contains this one and `other`, which are not empty.
    pub fn hull(&self, other: &Self) -> Self {
        IndexBox {
            lower: std::array::from_fn(|a| self.lower[a].min(other.lower[a])),
            upper: std::array::from_fn(|a| self.upper[a].max(other.upper[a])),
        }
    }

    /// The box grown by `depth` at every side.
    pub fn grow(&self, depth: i64) -> Self {
        IndexBox { lower: self.lower.map(|l| l - depth), upper: self.upper.map(|u| u + depth) }
    }

    /// Cuts the box into `parts` boxes per direction, as equal as whole indices allow. The first
    /// direction runs fastest in the list.
    pub fn tile(&self, parts: [usize; D]) -> Vec<Self> {
        let all = IndexBox::new([0; D], parts.map(|p| p as i64));
        let cut = |axis: usize, k: i64| {
            self.lower[axis] + k * self.extent(axis) as i64 / parts[axis] as i64
        };
        all.iter()
            .map(|k| IndexBox {
                lower: std::array::from_fn(|a| cut(a, k[a])),
                upper: std::array::from_fn(|a| cut(a, k[a] + 1)),
            })
            .collect()
    }

    /// Flat index of `index` in an array over this box. `index` must be inside.
    #[inline]
    pub fn flat(&self, index: [i64; D]) -> usize {
        debug_assert!(self.contains(index), "{index:?} is not in {self:?}");
        let mut at = 0;
        for a in (0..D).rev() {
            at = at * self.extent(a) + (index[a] - self.lower[a]) as usize;
        }
        at
    }

    /// Number of the indices of this box before `index`, which may be outside, in canonical order.
    #[inline]
    pub fn count_before(&self, index: [i64; D]) -> usize {
        let mut before = 0;
        for a in (0..D).rev() {
            let extent = self.extent(a) as i64;
            let passed = (index[a] - self.lower[a]).clamp(0, extent);
            let others: usize = (0..a).map(|b| self.extent(b)).product();
            before += passed as usize * others;
            if index[a] - self.lower[a] != passed || passed == extent {
                break;
            }
        }
        before
    }

    /// Flat indices of this box in an array over `whole`, which must contain it: one range per line
    /// along the first direction.
    pub fn lines_in(&self, whole: &Self) -> impl Iterator<Item = std::ops::Range<usize>> + use<D> {
        let (this, whole) = (*self, *whole);
        let length = this.extent(0);
        let lines = if length == 0 { 0 } else { (1..D).map(|a| this.extent(a)).product() };
        (0..lines).map(move |mut k| {
            let mut start = this.lower;
            for (a, start) in start.iter_mut().enumerate().skip(1) {
                *start += (k % this.extent(a)) as i64;
                k /= this.extent(a);
            }
            let at = whole.flat(start);
            at..at + length
        })
    }

    /// All indices, in the order of an array over this box.
    pub fn iter(&self) -> impl Iterator<Item = [i64; D]> + use<D> {
        let b = *self;
        (0..b.count()).map(move |mut k| {
            std::array::from_fn(|a| {
                let n = b.extent(a);
                let i = b.lower[a] + (k % n) as i64;
                k /= n;
                i
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn boxes() -> impl Strategy<Value = IndexBox<2>> {
        ((-9i64..9, -9i64..9), (0i64..12, 0i64..12))
            .prop_map(|((x, y), (w, h))| IndexBox::new([x, y], [x + w, y + h]))
    }

    proptest! {
        #[test]
        fn intersection_holds_what_both_hold(a in boxes(), b in boxes()) {
            let both = a.intersect(&b);
            for i in a.grow(1).iter() {
                prop_assert_eq!(both.contains(i), a.contains(i) && b.contains(i));
            }
        }

        #[test]
        fn tiles_hold_each_index_once(a in boxes(), p in 1usize..5, q in 1usize..5) {
            let tiles = a.tile([p, q]);
            prop_assert_eq!(tiles.len(), p * q);
            for i in a.grow(1).iter() {
                let holders = tiles.iter().filter(|t| t.contains(i)).count();
                prop_assert_eq!(holders, usize::from(a.contains(i)));
            }
        }

        #[test]
        fn lines_hold_the_places_of_a_box(a in boxes(), b in boxes()) {
            let inner = a.intersect(&b);
            let places: Vec<usize> = inner.lines_in(&a).flatten().collect();
            let expected: Vec<usize> = inner.iter().map(|i| a.flat(i)).collect();
            prop_assert_eq!(places, expected);
        }

        #[test]
        fn places_before_an_index_are_counted(a in boxes()) {
            for index in a.grow(2).iter() {
                let before = a.iter().filter(|i| [i[1], i[0]] < [index[1], index[0]]).count();
                prop_assert_eq!(a.count_before(index), before, "{:?}", index);
            }
        }

        #[test]
        fn flat_is_the_place_in_iteration(a in boxes()) {
            for (k, i) in a.iter().enumerate() {
                prop_assert_eq!(a.flat(i), k);
            }
            prop_assert_eq!(a.iter().count(), a.count());
        }
    }
}
