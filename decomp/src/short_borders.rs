//! Choice of the order in which patches are assigned to ranks: the one that gives ranks short
//! borders.

use crate::{Layout, PatchOrder, assign_patches};

/// The patches of `layout`, assigned to `ranks` ranks in sections of an order by `weights`, the
/// weight of each patch; see [`assign_patches`].
///
/// Sections of a Hilbert curve are compact, but for few ranks and uneven weights their borders are
/// ragged, and stripes of whole columns or rows of patches have shorter ones. Of these orders the one
/// with the shortest border between ranks is taken; patches without weight have no border.
#[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
pub fn assign_with_short_borders<const D: usize>(
    layout: Layout<D>,
    weights: &[u64],
    ranks: usize,
) -> Layout<D> {
    let parts = layout.parts();
    // on a line all orders are one
    let stripes = (0..D).filter(|_| D > 1 && ranks > 1);
    let orders = std::iter::once(PatchOrder::hilbert(parts))
        .chain(stripes.map(|axis| PatchOrder::stripes(parts, axis)));
    let assigned = |order: PatchOrder<D>| {
        let patches = order.patches();
        let along: Vec<u64> = patches.iter().map(|&patch| weights[patch]).collect();
        let ranks = assign_patches(&along, ranks);
        let mut of = vec![0; patches.len()];
        patches.iter().zip(&ranks).for_each(|(&patch, &rank)| of[patch] = rank);
        (border(&layout, weights, &of), order, ranks)
    };
    let shortest = orders.map(assigned).min_by_key(|(border, ..)| *border);
    let (_, order, ranks) = shortest.expect("there is one order at least");
    layout.with_ranks(order, &ranks)
}

/// Number of faces of cells between patches of different ranks, of which at least one has a weight.
/// `weights` and `of` hold the weight and the rank of each patch.
fn border<const D: usize>(layout: &Layout<D>, weights: &[u64], of: &[u32]) -> u64 {
    let parts = layout.parts();
    let mut faces = 0;
    for patch in 0..layout.count() {
        let cells = layout.patch(patch);
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
    use crate::{IndexBox, SideKind};

    fn square(patches: usize) -> Layout<2> {
        let cells = IndexBox::new([0, 0], [96, 96]);
        Layout::new(cells, [[SideKind::Open; 2]; 2], [patches; 2])
    }

    fn chosen(layout: &Layout<2>, weights: &[u64], ranks: usize) -> u64 {
        let assigned = assign_with_short_borders(layout.clone(), weights, ranks);
        let along: Vec<u64> = assigned.order().patches().iter().map(|&p| weights[p]).collect();
        assert_eq!(assigned.ranks(), assign_patches(&along, ranks));
        let of: Vec<u32> = (0..assigned.count()).map(|p| assigned.rank_of(p) as u32).collect();
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
}
