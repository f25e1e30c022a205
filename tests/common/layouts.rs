//! Layouts: distributions of the work of a scene. No layout may change a bit of the results.

use std::fmt;

use serde_json::{Value, json};

use super::covering::{pairwise, product};

/// Distribution of the work of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layout {
    /// Number of ranks.
    pub ranks: usize,
    /// Number of patches.
    pub patches: usize,
    /// Threads per rank.
    pub threads: usize,
    /// Steps between load measurements.
    pub every: u64,
    /// Measure of a patch's load.
    pub cost: &'static str,
    /// Whether quiescent patches are skipped.
    pub skip_quiescent: bool,
    /// Whether inner patches are computed while messages are in transit.
    pub overlap: bool,
    /// Ghost data for filters; `None`: chosen by the program.
    pub filter_halo: Option<&'static str>,
}

const RANKS: [usize; 5] = [1, 2, 3, 4, 7];
const PATCHES: [usize; 5] = [1, 2, 7, 16, 61];
const THREADS: [usize; 2] = [1, 2];
const EVERY: [u64; 2] = [0, 7];
const SWITCH: [bool; 2] = [false, true];

/// Measures of a patch's load.
pub const COSTS: [&str; 2] = ["time", "particles"];

/// Choices of ghost data for filters.
pub const HALOS: [Option<&str>; 3] = [None, Some("exchange"), Some("redundant")];

/// Number of values of each factor: ranks, patches, threads, balance, skipping, overlap, cost and
/// filter.
const LEVELS: [usize; 8] = [5, 5, 2, 2, 2, 2, 2, 3];

impl Layout {
    /// The simplest layout, with which all others are compared.
    pub const WHOLE: Layout = Layout {
        ranks: 1,
        patches: 1,
        threads: 1,
        every: 0,
        cost: "time",
        skip_quiescent: false,
        overlap: false,
        filter_halo: Some("exchange"),
    };

    fn of(values: &[usize]) -> Layout {
        let &[ranks, patches, threads, every, skip, overlap, cost, halo] = values else {
            panic!("{} factors, not {}", LEVELS.len(), values.len());
        };
        Layout {
            ranks: RANKS[ranks],
            patches: PATCHES[patches],
            threads: THREADS[threads],
            every: EVERY[every],
            cost: COSTS[cost],
            skip_quiescent: SWITCH[skip],
            overlap: SWITCH[overlap],
            filter_halo: HALOS[halo],
        }
    }

    /// About thirty layouts in which every pair of values of any two factors occurs.
    pub fn covering() -> Vec<Layout> {
        pairwise(&LEVELS).iter().map(|values| Layout::of(values)).collect()
    }

    /// All 400 layouts of ranks, patches, threads, balance, skipping and overlap; costs and filters
    /// alternate.
    pub fn product() -> Vec<Layout> {
        let alternating = |values: &Vec<usize>| {
            let sum: usize = values.iter().sum();
            Layout::of(&[&values[..], &[sum % COSTS.len(), sum % HALOS.len()]].concat())
        };
        product(&LEVELS[..6]).iter().map(alternating).collect()
    }

    /// The keys of a scene for this layout; ranks and threads are set elsewhere.
    pub fn keys(&self) -> Value {
        let mut decomposition = json!({
            "balance": {"every": self.every, "cost": self.cost},
            "skip_quiescent": self.skip_quiescent,
            "overlap": self.overlap,
        });
        if let Some(halo) = self.filter_halo {
            decomposition["filter_halo"] = json!(halo);
        }
        json!({"decomposition": decomposition, "domain": {"patches": [self.patches]}})
    }
}

impl fmt::Display for Layout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Layout { ranks, patches, threads, .. } = self;
        write!(f, "{ranks} ranks x {patches} patches x {threads} threads")?;
        if self.every > 0 {
            write!(f, ", balanced every {} by {}", self.every, self.cost)?;
        }
        for (is, what) in [(self.skip_quiescent, "skipping"), (self.overlap, "overlap")] {
            if is {
                write!(f, ", {what}")?;
            }
        }
        write!(f, ", halo {}", self.filter_halo.unwrap_or("chosen"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_covering_has_the_extremes() {
        let covering = Layout::covering();
        assert!(covering.len() <= 28, "{}", covering.len());
        // ranks that own nothing, and every option that moves patches
        assert!(covering.iter().any(|l| l.ranks == 7 && l.patches == 1));
        let moving =
            |l: &&Layout| l.every > 0 && l.skip_quiescent && l.ranks > 1 && l.patches >= 16;
        assert!(covering.iter().any(|l| moving(&l)));
    }

    #[test]
    fn the_product_is_whole_and_balances_by_either_cost() {
        let all = Layout::product();
        assert_eq!(all.len(), 400);
        assert!(all.iter().enumerate().all(|(i, a)| !all[..i].contains(a)));
        let by_time = all.iter().filter(|l| l.cost == "time" && l.every > 0).count();
        assert_eq!(by_time, 100);
    }

    #[test]
    fn a_layout_is_reported_in_words() {
        let text = Layout { every: 7, skip_quiescent: true, ..Layout::WHOLE }.to_string();
        let words = "1 ranks x 1 patches x 1 threads, balanced every 7 by time, skipping, ";
        assert_eq!(text, format!("{words}halo exchange"));
    }
}
