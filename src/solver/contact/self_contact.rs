//! A place where a body touches itself.

use std::cmp::Ordering;

/// Contact of a body with itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SelfContact<const D: usize> {
    /// Width of the gap [cells].
    pub gap: f64,
    /// Ids of the two particles, the lower one first.
    pub ids: [u64; 2],
    /// Their body.
    pub body: usize,
    /// Position of the first one [m], in the frame of the grid.
    pub place: [f64; D],
}

impl<const D: usize> SelfContact<D> {
    /// Order that does not depend on the layout: of several places the narrowest gap comes first.
    pub fn compare(&self, other: &Self) -> Ordering {
        self.gap.total_cmp(&other.gap).then(self.ids.cmp(&other.ids))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_narrowest_gap_comes_first_and_ids_decide_among_equals() {
        let at = |gap: f64, ids: [u64; 2]| SelfContact { gap, ids, body: 0, place: [0.0; 2] };
        assert!(at(-0.5, [7, 8]).compare(&at(0.5, [1, 2])).is_lt());
        assert!(at(0.5, [1, 9]).compare(&at(0.5, [2, 3])).is_lt());
        assert!(at(0.5, [1, 9]).compare(&at(0.5, [1, 3])).is_gt());
    }
}
