//! Assignment of patches to ranks, and the choice of cuts.

use std::ops::Range;

use crate::bottleneck::bottleneck_limit;

/// Assigns patches to ranks in sections of an order. `weights` holds the weight of each patch in this
/// order; their sum is below 2^63. The largest sum of weights per rank exceeds the smallest possible one
/// for whole patches in this order by at most 1/4096 of it. A rank may get none. Returns the rank of
/// each patch, in the order.
///
/// A limit close to the smallest bottleneck is found by probes between limits that sums of
/// weights attain (chains on chains: Pinar & Aykanat 2004). Within it, sections end as near to
/// equal shares as possible, so that small changes of the weights move few patches.
pub fn assign_patches(weights: &[u64], ranks: usize) -> Vec<u32> {
    let (total, heaviest) =
        weights.iter().fold((0, 0), |(sum, most): (u64, u64), &w| (sum + w, most.max(w)));
    if total == 0 && !weights.is_empty() {
        // patches count equally
        return assign_patches(&vec![1; weights.len()], ranks);
    }
    let limit = bottleneck_limit(weights, total, heaviest, ranks);
    let sufficient = sufficient_from(weights, limit, ranks);
    let mut of = Vec::with_capacity(weights.len());
    let (mut rank, mut load, mut before) = (0, 0, 0);
    let mut shares = EqualShares::new(2 * total, ranks as u64);
    for (k, &w) in weights.iter().enumerate() {
        // by equal shares, the middle of the patch's part of the total belongs to a later rank
        let later = 2 * before + w >= shares.end;
        let later_ranks_suffice = k >= sufficient[ranks - 1 - rank as usize];
        if load + w > limit || (later && later_ranks_suffice) {
            (rank, load) = (rank + 1, 0);
            shares.advance();
        }
        of.push(rank);
        load += w;
        before += w;
    }
    of
}

/// Ends of equal shares of a total, rounded up, one after the other.
struct EqualShares {
    end: u64,
    /// Numerator of what `end` exceeds the exact end by.
    excess: u64,
    ranks: u64,
    quotient: u64,
    remainder: u64,
}

impl EqualShares {
    /// At the end of the first share.
    fn new(total: u64, ranks: u64) -> Self {
        let (quotient, remainder) = (total / ranks, total % ranks);
        let mut shares = EqualShares { end: 0, excess: 0, ranks, quotient, remainder };
        shares.advance();
        shares
    }

    fn advance(&mut self) {
        self.end += self.quotient;
        if self.remainder > self.excess {
            self.end += 1;
            self.excess += self.ranks;
        }
        self.excess -= self.remainder;
    }
}

/// Work and size of the patches in a new assignment, in the order along which they are assigned.
#[derive(Clone, Copy, Debug)]
pub struct PatchLoads<'a> {
    /// Cost of a step of each patch; 0 for a quiescent patch.
    pub work: &'a [u64],
    /// Number of particles of each patch.
    pub particles: &'a [u64],
}

impl PatchLoads<'_> {
    /// New assignment of patches to ranks. `owners` is the present rank of each patch. `most` is the
    /// limit of the particles of a rank, relative to the mean of all ranks [-].
    ///
    /// Active patches (work > 0) and empty patches are assigned in sections of the order with equal
    /// work. A quiescent patch (work 0) keeps its rank if the rank then holds at most `most` times the
    /// mean number of particles. Otherwise it moves to a rank with fewer particles, in order.
    ///
    /// The number of particles of a rank exceeds this limit by at most one patch, unless its active
    /// patches alone exceed it.
    pub fn reassign(&self, owners: &[u32], ranks: usize, most: f64) -> Vec<u32> {
        let PatchLoads { work, particles } = *self;
        let runs = self.runs();
        let active = || runs.iter().filter(|run| run.is_active).map(|run| run.range.clone());
        let weights: Vec<&[u64]> = active().map(|run| &work[run]).collect();
        let weights = weights.concat();
        let is_at_rest = weights.iter().all(|&work| work == 0);
        let assigned = if is_at_rest { Vec::new() } else { assign_patches(&weights, ranks) };
        let (mut of, mut assigned) = (Vec::with_capacity(work.len()), &assigned[..]);
        for run in &runs {
            if run.is_active && !is_at_rest {
                let (these, rest) = assigned.split_at(run.range.len());
                of.extend_from_slice(these);
                assigned = rest;
            } else {
                of.extend_from_slice(&owners[run.range.clone()]);
            }
        }
        let mut held = vec![0; ranks];
        for (rank, section) in active().flat_map(|run| sections(&of, run)) {
            held[rank] += particles[section].iter().sum::<u64>();
        }
        let mean = runs.iter().map(|run| run.particles).sum::<u64>() as f64 / ranks as f64;
        let limit = (most * mean).ceil() as u64;
        let mut moving = Vec::new();
        let quiescent = runs.iter().filter(|run| !run.is_active).map(|run| run.range.clone());
        for (rank, section) in quiescent.flat_map(|run| sections(&of, run)) {
            let mut load = held[rank];
            for k in section {
                if load + particles[k] <= limit { load += particles[k] } else { moving.push(k) }
            }
            held[rank] = load;
        }
        let mut free = FreeRanks { limit: mean.ceil() as u64, held, rank: 0 };
        for k in moving {
            of[k] = free.place(particles[k]) as u32;
        }
        of
    }

    /// The runs of active or empty patches and of quiescent ones, in order.
    fn runs(&self) -> Vec<PatchRun> {
        let mut runs: Vec<PatchRun> = Vec::new();
        let mut start = 0;
        for (work, particles) in self.work.chunks(CHUNK).zip(self.particles.chunks(CHUNK)) {
            let is_active = |k: usize| (work[k] > 0) | (particles[k] == 0);
            let count = (0..work.len()).map(|k| usize::from(is_active(k))).sum::<usize>();
            // most chunks are of one kind, which is found without branches
            let lengths = if count.is_multiple_of(work.len()) { work.len() } else { 1 };
            for k in (0..work.len()).step_by(lengths) {
                let (range, is_active) = (start + k..start + k + lengths, is_active(k));
                let particles = particles[k..k + lengths].iter().sum();
                match runs.last_mut() {
                    Some(run) if run.is_active == is_active => {
                        run.range.end = range.end;
                        run.particles += particles;
                    }
                    _ => runs.push(PatchRun { range, is_active, particles }),
                }
            }
            start += work.len();
        }
        runs
    }
}

/// The longest parts of `run` whose patches have the same rank: this rank, and the patches.
fn sections(of: &[u32], run: Range<usize>) -> impl Iterator<Item = (usize, Range<usize>)> {
    let mut start = run.start;
    of[run].chunk_by(|a, b| a == b).map(move |section| {
        start += section.len();
        (section[0] as usize, start - section.len()..start)
    })
}

/// Number of patches that are examined together.
const CHUNK: usize = 64;

/// Patches next to each other in the order, all active or all quiescent.
struct PatchRun {
    range: Range<usize>,
    is_active: bool,
    particles: u64,
}

/// Ranks that have room for particles, filled one after the other.
struct FreeRanks {
    /// Particles up to which a rank is filled.
    limit: u64,
    held: Vec<u64>,
    rank: usize,
}

impl FreeRanks {
    /// The rank for a patch of `particles`.
    fn place(&mut self, particles: u64) -> usize {
        while self.rank + 1 < self.held.len() && self.held[self.rank] >= self.limit {
            self.rank += 1;
        }
        // all are full: the one with the fewest
        let full = self.held[self.rank] >= self.limit;
        let rank = match full {
            true => (0..self.held.len()).min_by_key(|&r| self.held[r]).expect("a rank"),
            false => self.rank,
        };
        self.held[rank] += particles;
        rank
    }
}

/// Entry n is the first position from which on n ranks can hold all weights, each at most `limit`.
/// `ranks` ranks must suffice for all weights.
fn sufficient_from(weights: &[u64], limit: u64, ranks: usize) -> Vec<usize> {
    let mut from = vec![0; ranks + 1];
    from[0] = weights.len();
    let (mut count, mut load) = (1, 0);
    for (k, &w) in weights.iter().enumerate().rev() {
        load += w;
        if load > limit {
            from[count] = k + 1;
            (count, load) = (count + 1, w);
        }
    }
    from
}

/// The largest sum of `weights` over the patches of one rank.
pub fn busiest_share(weights: &[u64], ranks_of: &[u32], ranks: usize) -> u64 {
    let mut loads = vec![0; ranks];
    for (&w, &rank) in weights.iter().zip(ranks_of) {
        loads[rank as usize] += w;
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
    use crate::PatchOrder;
    use proptest::prelude::*;

    #[test]
    fn shares_follow_the_weights() {
        assert_eq!(assign_patches(&[1, 1, 1, 1], 2), [0, 0, 1, 1]);
        assert_eq!(assign_patches(&[0, 0, 9, 9, 0], 2), [0, 0, 0, 1, 1]);
        assert_eq!(assign_patches(&[0, 0], 2), [0, 1]);
        assert_eq!(assign_patches(&[5], 3).len(), 1);
        // the middle of the heavy patch lies before the middle of the total
        assert_eq!(assign_patches(&[5, 3, 3, 3], 2), [0, 0, 1, 1]);
        assert_eq!(assign_patches(&[1, 1, 5, 5], 3), [0, 0, 1, 2]);
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
            let of = assign_patches(&weights, ranks);
            prop_assert!(of.windows(2).all(|w| w[0] <= w[1]) && of.iter().all(|&r| (r as usize) < ranks));
            if weights.iter().any(|&w| w > 0) {
                prop_assert_eq!(busiest_share(&weights, &of, ranks), best(&weights, ranks));
            }
        }
    }

    proptest! {
        #[test]
        fn equal_shares_end_at_the_rounded_multiples(total in 0u64..1 << 63, ranks in 1u64..300) {
            let mut shares = EqualShares::new(total, ranks);
            for share in 1..=ranks {
                let exact = u128::from(total) * u128::from(share);
                prop_assert_eq!(u128::from(shares.end), exact.div_ceil(u128::from(ranks)));
                shares.advance();
            }
        }
    }

    #[test]
    fn runs_of_patches_follow_each_other() {
        let work: Vec<u64> = (0..300).map(|k| u64::from(k < 130 || k == 200)).collect();
        let loads = PatchLoads { work: &work, particles: &[7; 300] };
        let runs = loads.runs().into_iter().map(|run| (run.range, run.is_active, run.particles));
        let runs: Vec<_> = runs.collect();
        let expected = [
            (0..130, true, 7 * 130),
            (130..200, false, 7 * 70),
            (200..201, true, 7),
            (201..300, false, 7 * 99),
        ];
        assert_eq!(runs, expected);
    }

    /// A tenth of 320 x 320 patches has work: a disk about the middle. 1000 ranks.
    #[test]
    fn patches_without_work_do_not_pile_up() {
        let (n, ranks) = (320, 1000);
        let order = PatchOrder::hilbert([n, n]).patches();
        let away = |p: usize| {
            let offset = |k: usize| (k as f64 - 0.5 * (n as f64 - 1.0)) / n as f64;
            offset(p % n).hypot(offset(p / n))
        };
        let radius = (0.1 / std::f64::consts::PI).sqrt();
        let particles = vec![64; n * n];
        let mut owners = assign_patches(&particles, ranks);
        // the disk grows to this size, as a wave does
        for growth in [0.2, 0.4, 0.6, 0.8, 1.0] {
            let work: Vec<u64> =
                order.iter().map(|&p| if away(p) < growth * radius { 64 } else { 0 }).collect();
            let loads = PatchLoads { work: &work, particles: &particles };
            owners = loads.reassign(&owners, ranks, 1.25);
            let mean = |all: &[u64]| all.iter().sum::<u64>() as f64 / ranks as f64;
            let most = |all: &[u64]| busiest_share(all, &owners, ranks) as f64 / mean(all);
            assert!(most(&particles) <= 1.5, "{growth}: {}", most(&particles));
            // whole patches: a rank has 10 or 11 of them where the mean is 10.2
            assert!(growth < 1.0 || most(&work) <= 1.1, "{}", most(&work));
        }
    }

    proptest! {
        #[test]
        fn no_rank_holds_more_than_the_limit_and_a_patch(
            loads in prop::collection::vec((0u64..9, 0u64..30), 1..40),
            ranks in 1usize..6,
        ) {
            let (work, particles): (Vec<u64>, Vec<u64>) =
                loads.iter().map(|&(w, n)| (if n > 0 { w } else { 0 }, n)).unzip();
            let owners = vec![0; work.len()];
            let loads = PatchLoads { work: &work, particles: &particles };
            let of = loads.reassign(&owners, ranks, 1.25);
            prop_assert!(of.iter().all(|&rank| (rank as usize) < ranks));
            let with_work: Vec<u64> =
                (0..work.len()).map(|p| if work[p] > 0 { particles[p] } else { 0 }).collect();
            let mean = particles.iter().sum::<u64>().div_ceil(ranks as u64);
            let widest = particles.iter().copied().max().unwrap_or(0);
            let most = busiest_share(&with_work, &of, ranks).max((5 * mean).div_ceil(4) + widest);
            prop_assert!(busiest_share(&particles, &of, ranks) <= most);
        }
    }

    #[test]
    fn patches_without_work_stay_where_they_are_while_there_is_room() {
        let loads = PatchLoads { work: &[0, 0, 8, 8], particles: &[5, 5, 5, 5] };
        assert_eq!(loads.reassign(&[1, 0, 0, 1], 2, 1.25), [1, 0, 0, 1]);
        // rank 0 has room for one of its three
        assert_eq!(loads.reassign(&[0, 0, 0, 0], 2, 1.0), [0, 1, 0, 1]);
        // nothing has work
        let loads = PatchLoads { work: &[0, 0], particles: &[5, 5] };
        assert_eq!(loads.reassign(&[1, 0], 2, 1.25), [1, 0]);
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
