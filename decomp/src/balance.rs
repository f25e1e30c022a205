//! Which rank has which patch, and how many patches to cut.

/// Deals patches to ranks in order, so that each rank's share of `weights` is as even as whole
/// patches allow. A rank may get none.
pub fn assign_patches(weights: &[u64], ranks: usize) -> Vec<usize> {
    let total: u128 = weights.iter().map(|&w| w as u128).sum();
    let even = total == 0;
    let total = if even { weights.len() as u128 } else { total };
    let mut before = 0u128;
    weights
        .iter()
        .map(|&w| {
            let w = if even { 1 } else { w as u128 };
            // by the middle of the patch's stretch of the whole
            let rank = (2 * before + w) * ranks as u128 / (2 * total);
            before += w;
            (rank as usize).min(ranks - 1)
        })
        .collect()
}

/// A number of patches in each direction with at least one for each of `workers`, none narrower
/// than `least` cells if that can be; the longest direction is cut first.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_follow_the_weights() {
        assert_eq!(assign_patches(&[1, 1, 1, 1], 2), [0, 0, 1, 1]);
        assert_eq!(assign_patches(&[0, 0, 9, 9, 0], 2), [0, 0, 0, 1, 1]);
        assert_eq!(assign_patches(&[0, 0], 2), [0, 1]);
        assert_eq!(assign_patches(&[5], 3), [1]);
    }

    #[test]
    fn cuts_give_each_worker_a_patch_unless_too_narrow() {
        assert_eq!(choose_cuts([1000], 4, 8), [4]);
        assert_eq!(choose_cuts([20], 4, 8), [2]);
        assert_eq!(choose_cuts([100, 50], 4, 8), [2, 2]);
    }
}
