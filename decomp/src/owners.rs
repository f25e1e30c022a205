//! Ranks of all patches, held as runs of neighbours in an order.

/// Positions that share the high part of their number.
const PAGE: usize = 1 << 16;

/// The rank at each position of an order of the patches, as runs of equal ranks.
///
/// A run takes 6 bytes, and ranks that own sections of the order take one run each. Nothing else
/// grows with the numbers of patches and ranks, except for 4 bytes per 65 536 patches.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Owners {
    /// Number of positions.
    count: usize,
    /// First position of each run in its page.
    starts: Vec<u16>,
    /// Rank of each run.
    ranks: Vec<u32>,
    /// First run that starts in each page, and the number of runs.
    pages: Vec<u32>,
}

impl Owners {
    /// `ranks` holds the rank at each position.
    pub fn new(ranks: &[u32]) -> Self {
        let runs = || ranks.chunk_by(|a, b| a == b);
        let count = runs().count();
        let mut owners = Owners {
            count: ranks.len(),
            starts: Vec::with_capacity(count),
            ranks: Vec::with_capacity(count),
            pages: Vec::with_capacity(ranks.len() / PAGE + 2),
        };
        let mut start = 0;
        for run in runs() {
            owners.open_pages(start / PAGE);
            owners.starts.push((start % PAGE) as u16);
            owners.ranks.push(run[0]);
            start += run.len();
        }
        owners.open_pages(start / PAGE + 1);
        owners
    }

    /// Opens the pages up to `page`: the next run starts there or later.
    fn open_pages(&mut self, page: usize) {
        self.pages.resize(self.pages.len().max(page + 1), self.starts.len() as u32);
    }

    /// The rank at `position`.
    pub fn rank(&self, position: usize) -> usize {
        debug_assert!(position < self.count, "no position {position}");
        let runs = [0, 1].map(|more| self.pages[position / PAGE + more] as usize);
        let within = (position % PAGE) as u16;
        let before = self.starts[runs[0]..runs[1]].partition_point(|&start| start <= within);
        self.ranks[runs[0] + before - 1] as usize
    }

    /// First position of `run`; for the number of runs, the number of positions.
    fn start(&self, run: usize) -> usize {
        let Some(&within) = self.starts.get(run) else { return self.count };
        let page = self.pages.partition_point(|&first| first as usize <= run) - 1;
        page * PAGE + usize::from(within)
    }

    /// Positions of the patches of `rank`, ascending.
    pub fn positions_of(&self, rank: usize) -> impl Iterator<Item = usize> {
        let runs = self.ranks.iter().enumerate().filter(move |(_, of)| **of as usize == rank);
        runs.flat_map(|(run, _)| self.start(run)..self.start(run + 1))
    }

    /// The rank at each position.
    pub fn to_vec(&self) -> Vec<u32> {
        let runs = self.ranks.iter().enumerate();
        runs.flat_map(|(run, &rank)| {
            std::iter::repeat_n(rank, self.start(run + 1) - self.start(run))
        })
        .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn runs_hold_the_rank_of_every_position(
            runs in prop::collection::vec((0u32..5, prop_oneof![1usize..4, 30_000usize..70_000]), 1..12),
        ) {
            let ranks: Vec<u32> = runs
                .iter()
                .flat_map(|&(rank, count)| std::iter::repeat_n(rank, count))
                .collect();
            let owners = Owners::new(&ranks);
            prop_assert_eq!(&owners.to_vec(), &ranks);
            for rank in 0..5 {
                let expected = (0..ranks.len()).filter(|&k| ranks[k] == rank);
                prop_assert!(owners.positions_of(rank as usize).eq(expected));
            }
            let mut start = 0;
            for &(rank, count) in &runs {
                prop_assert_eq!(owners.rank(start), rank as usize);
                start += count;
                prop_assert_eq!(owners.rank(start - 1), rank as usize);
            }
        }
    }
}
