//! Order in which patches are dealt to ranks: the one that gives ranks short borders.

use crate::{IndexBox, Layout, assign_patches, curve_order};

/// An order of the patches of `layout`, and their assignment to `ranks` ranks in sections of it by
/// `weights`, see [`assign_patches`].
///
/// Sections of a Hilbert curve are compact, but for few ranks and uneven weights their borders are
/// ragged, and stripes of whole columns or rows of patches have shorter ones. Of these orders the one
/// with the shortest border between ranks is taken; patches without weight have no border.
#[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
pub fn short_border_order<const D: usize>(
    layout: &Layout<D>,
    weights: &[u64],
    ranks: usize,
) -> (Vec<usize>, Vec<usize>) {
    let parts = layout.parts();
    let hilbert = std::iter::once(curve_order(parts));
    // on a line all orders are one
    let stripes = (0..D).filter(|_| D > 1 && ranks > 1).map(|axis| striped_order(parts, axis));
    let dealt = |order: Vec<usize>| {
        let of = assign_patches(weights, &order, ranks);
        (border(layout, weights, &of), order, of)
    };
    let shortest = hilbert.chain(stripes).map(dealt).min_by_key(|(border, ..)| *border);
    let (_, order, of) = shortest.expect("there is one order at least");
    (order, of)
}

/// Flat indices of a box with `parts` entries per direction, stripe by stripe normal to `axis`; every
/// second stripe runs backwards, so that neighbours in the order are neighbours in space.
fn striped_order<const D: usize>(parts: [usize; D], axis: usize) -> Vec<usize> {
    let upper = parts.map(|n| n as i64);
    let all = IndexBox::new([0; D], upper);
    let mut places: Vec<([i64; D], usize)> = all.iter().zip(0..).collect();
    places.sort_by_key(|(place, _)| {
        let stripe = place[axis];
        let mut key = *place;
        key[axis] = 0;
        if stripe % 2 == 1 {
            (0..D).for_each(|a| key[a] = -key[a]);
        }
        (stripe, key)
    });
    places.into_iter().map(|(_, flat)| flat).collect()
}

/// Number of faces of cells between patches of different ranks, of which at least one has a weight.
fn border<const D: usize>(layout: &Layout<D>, weights: &[u64], of: &[usize]) -> u64 {
    let (parts, boxes) = (layout.parts(), layout.patches());
    let mut faces = 0;
    for (patch, cells) in boxes.iter().enumerate() {
        let (mut at, mut stride) = (patch, 1);
        for (a, n) in parts.iter().enumerate() {
            let next = patch + stride;
            let is_last = at % n + 1 == *n;
            if !is_last && of[patch] != of[next] && weights[patch].max(weights[next]) > 0 {
                faces += (cells.count() / cells.extent(a).max(1)) as u64;
            }
            at /= n;
            stride *= n;
        }
    }
    faces
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SideKind;

    fn square(patches: usize) -> Layout<2> {
        let cells = IndexBox::new([0, 0], [96, 96]);
        Layout::new(cells, [[SideKind::Open; 2]; 2], [patches; 2])
    }

    fn chosen(layout: &Layout<2>, weights: &[u64], ranks: usize) -> u64 {
        let (order, of) = short_border_order(layout, weights, ranks);
        let mut all = order.clone();
        all.sort_unstable();
        assert!(all.into_iter().eq(0..weights.len()), "every patch once");
        assert_eq!(of, assign_patches(weights, &order, ranks));
        border(layout, weights, &of)
    }

    #[test]
    fn few_ranks_get_stripes_and_many_get_squares() {
        let layout = square(12);
        let even = vec![1; 144];
        // two cuts through the square
        assert_eq!(chosen(&layout, &even, 3), 2 * 96);
        let layout = square(16);
        let even = vec![1; 256];
        // four quadrants, sixteen squares
        assert_eq!(chosen(&layout, &even, 4), 2 * 96);
        assert_eq!(chosen(&layout, &even, 16), 6 * 96);
    }

    #[test]
    fn empty_patches_have_no_border() {
        let layout = square(4);
        let lower_rows = (0..16).map(|k| u64::from(k < 8)).collect::<Vec<_>>();
        // the cut crosses two of four rows, or one patch more
        assert!(chosen(&layout, &lower_rows, 2) <= 48 + 24);
        assert_eq!(border(&layout, &lower_rows, &[vec![0; 12], vec![1; 4]].concat()), 0);
    }

    #[test]
    fn stripes_turn_at_their_ends() {
        assert_eq!(striped_order([3, 2], 1), [0, 1, 2, 5, 4, 3]);
        assert_eq!(striped_order([2, 3], 0), [0, 2, 4, 5, 3, 1]);
    }
}
