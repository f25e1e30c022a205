//! Assignment of patches to ranks, and the choice of cuts.

/// Assigns patches to ranks in sections of `order` (patches along a curve). The largest sum of
/// `weights` per rank is as small as possible for whole patches in this order. A rank may get none.
/// Returns the rank of each patch.
///
/// The smallest bottleneck is found by bisection (chains on chains: Pinar & Aykanat 2004). Within
/// it, sections end as near to equal shares as possible, so that small changes of the weights move
/// few patches.
pub fn assign_patches(weights: &[u64], order: &[usize], ranks: usize) -> Vec<usize> {
    debug_assert_eq!(weights.len(), order.len(), "one place a patch");
    // if all weights are zero, patches count equally
    let even = weights.iter().all(|&w| w == 0);
    let weights: Vec<u128> =
        order.iter().map(|&p| if even { 1 } else { u128::from(weights[p]) }).collect();
    let total: u128 = weights.iter().sum();
    let heaviest = weights.iter().copied().max().unwrap_or(0);
    let (mut low, mut high) = (heaviest.max(total.div_ceil(ranks as u128)), total);
    while low < high {
        let middle = low + (high - low) / 2;
        if ranks_from(&weights, middle)[0] <= ranks { high = middle } else { low = middle + 1 }
    }
    let needed = ranks_from(&weights, low);
    let mut of = vec![0; weights.len()];
    let (mut rank, mut load, mut before) = (0, 0, 0);
    for (k, &p) in order.iter().enumerate() {
        let w = weights[k];
        // the rank by equal shares, from the middle of the patch's part of the total
        let wanted = ((2 * before + w) * ranks as u128 / (2 * total)) as usize;
        let later_ranks_suffice = needed[k] < ranks - rank;
        if load + w > low || (wanted > rank && later_ranks_suffice) {
            (rank, load) = (rank + 1, 0);
        }
        of[p] = rank;
        load += w;
        before += w;
    }
    of
}

/// For each position, the number of ranks that the weights from there on need under `limit`.
fn ranks_from(weights: &[u128], limit: u128) -> Vec<usize> {
    let mut needed = vec![0; weights.len() + 1];
    let (mut end, mut load) = (weights.len(), 0);
    for k in (0..weights.len()).rev() {
        load += weights[k];
        while load > limit {
            end -= 1;
            load -= weights[end];
        }
        needed[k] = 1 + needed[end];
    }
    needed
}

/// The largest sum of `weights` over the patches of one rank.
pub fn busiest_share(weights: &[u64], ranks_of: &[usize], ranks: usize) -> u64 {
    let mut loads = vec![0; ranks];
    for (&w, &rank) in weights.iter().zip(ranks_of) {
        loads[rank] += w;
    }
    loads.into_iter().max().unwrap_or(0)
}

/// Number of patches per direction, with at least one patch per worker and, if possible, no patch
/// narrower than `least` cells. The longest direction is cut first.
///
/// # Panics
///
/// If `D` is 0.
pub fn choose_cuts<const D: usize>(cells: [usize; D], workers: usize, least: usize) -> [usize; D] {
    let mut cuts = [1; D];
    while cuts.iter().product::<usize>() < workers {
        let longest = (0..D).max_by_key(|&a| cells[a] / cuts[a]).expect("a direction");
        if cells[longest] / (cuts[longest] + 1) < least.max(1) {
            break;
        }
        cuts[longest] += 1;
    }
    cuts
}

/// Cuts a line of cells into `parts` sections of about equal weight, if possible none narrower than
/// `least` cells. Returns the first cell of each section and one past the last cell. `weights`
/// holds the weight of each cell.
pub fn even_cuts(weights: &[u64], parts: usize, least: usize) -> Vec<i64> {
    let cells = weights.len();
    let least = least.min(cells / parts);
    let total: u128 = weights.iter().map(|&w| u128::from(w)).sum();
    let (mut cuts, mut cell, mut before) = (vec![0], 0, 0u128);
    for k in 1..parts {
        let (first, wanted) = (cuts[k - 1] as usize + least, total * k as u128);
        let last = cells - (parts - k) * least;
        while cell < last
            && (cell < first
                // the cell that contains the cut goes to the side that holds less of it
                || (2 * before + u128::from(weights[cell])) * parts as u128 <= 2 * wanted)
        {
            before += u128::from(weights[cell]);
            cell += 1;
        }
        cuts.push(cell as i64);
    }
    cuts.push(cells as i64);
    cuts
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn line(weights: &[u64], ranks: usize) -> Vec<usize> {
        let order: Vec<usize> = (0..weights.len()).collect();
        assign_patches(weights, &order, ranks)
    }

    #[test]
    fn shares_follow_the_weights() {
        assert_eq!(line(&[1, 1, 1, 1], 2), [0, 0, 1, 1]);
        assert_eq!(line(&[0, 0, 9, 9, 0], 2), [0, 0, 0, 1, 1]);
        assert_eq!(line(&[0, 0], 2), [0, 1]);
        assert_eq!(line(&[5], 3).len(), 1);
        // the middle of the heavy patch lies before the middle of the total
        assert_eq!(line(&[5, 3, 3, 3], 2), [0, 0, 1, 1]);
        assert_eq!(assign_patches(&[1, 5, 1, 5], &[0, 2, 1, 3], 3), [0, 1, 0, 2]);
    }

    /// The smallest bottleneck, by trying all cuts.
    fn best(weights: &[u64], ranks: usize) -> u64 {
        if ranks == 1 {
            return weights.iter().sum();
        }
        (0..=weights.len())
            .map(|k| weights[..k].iter().sum::<u64>().max(best(&weights[k..], ranks - 1)))
            .min()
            .unwrap()
    }

    proptest! {
        #[test]
        fn no_other_cuts_are_better(
            weights in prop::collection::vec(0u64..30, 1..9),
            ranks in 1usize..5,
        ) {
            let of = line(&weights, ranks);
            prop_assert!(of.windows(2).all(|w| w[0] <= w[1]) && of.iter().all(|&r| r < ranks));
            if weights.iter().any(|&w| w > 0) {
                prop_assert_eq!(busiest_share(&weights, &of, ranks), best(&weights, ranks));
            }
        }
    }

    #[test]
    fn even_cuts_halve_the_weight_and_keep_the_width() {
        assert_eq!(even_cuts(&[1; 12], 3, 2), [0, 4, 8, 12]);
        assert_eq!(even_cuts(&[0, 0, 0, 0, 2, 2, 2, 2], 2, 1), [0, 6, 8]);
        assert_eq!(even_cuts(&[0, 0, 0, 0, 2, 2, 2, 2], 4, 2), [0, 2, 4, 6, 8]);
        assert_eq!(even_cuts(&[9, 0, 0, 0], 2, 1), [0, 1, 4]);
        assert_eq!(even_cuts(&[5, 5], 4, 3), [0, 1, 1, 2, 2]);
    }

    proptest! {
        #[test]
        fn even_cuts_ascend_and_respect_the_width(
            weights in prop::collection::vec(0u64..9, 1..60),
            parts in 1usize..8,
            least in 0usize..9,
        ) {
            let cuts = even_cuts(&weights, parts, least);
            prop_assert_eq!((cuts.len(), cuts[0]), (parts + 1, 0));
            prop_assert_eq!(cuts[parts], weights.len() as i64);
            let least = least.min(weights.len() / parts) as i64;
            prop_assert!(cuts.windows(2).all(|w| w[1] - w[0] >= least));
        }
    }

    #[test]
    fn cuts_give_each_worker_a_patch_unless_too_narrow() {
        assert_eq!(choose_cuts([1000], 4, 8), [4]);
        assert_eq!(choose_cuts([20], 4, 8), [2]);
        assert_eq!(choose_cuts([100, 50], 4, 8), [2, 2]);
    }
}
