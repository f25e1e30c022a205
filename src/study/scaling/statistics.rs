//! Medians, and shares of time.

use std::collections::BTreeMap;

/// Activities of a rank, with the names of `summary.json`, in the order of the table.
pub const PARTS: [&str; 7] =
    ["compute", "exchange", "migrate", "balance", "wait", "output", "rest"];

/// The median: the middle value, or the mean of the two in the middle; `None` without values.
pub fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut sorted: Vec<f64> = values.into_iter().collect();
    sorted.sort_by(f64::total_cmp);
    let half = sorted.len() / 2;
    match sorted.len() {
        0 => None,
        n if n % 2 == 1 => Some(sorted[half]),
        _ => Some(0.5 * (sorted[half - 1] + sorted[half])),
    }
}

/// The shares of [`PARTS`] in the time of all ranks of all runs \[-\]; `None` if no time is
/// counted. Time of an activity with another name counts as rest.
pub fn shares<'a>(
    ranks: impl IntoIterator<Item = &'a BTreeMap<String, f64>>,
) -> Option<[f64; PARTS.len()]> {
    let mut sums = [0.0; PARTS.len()];
    for (name, seconds) in ranks.into_iter().flatten() {
        let part = PARTS.iter().position(|part| part == name);
        sums[part.unwrap_or(PARTS.len() - 1)] += seconds;
    }
    let all: f64 = sums.iter().sum();
    (all > 0.0).then(|| sums.map(|sum| sum / all))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_are_in_the_middle() {
        assert_eq!(median([3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median([4.0, 1.0, 2.0, 3.0]), Some(2.5));
        assert_eq!(median([7.0]), Some(7.0));
        assert_eq!(median([]), None);
    }

    #[test]
    fn shares_are_of_all_ranks_and_add_up_to_one() {
        let rank = |parts: &[(&str, f64)]| {
            parts.iter().map(|(name, s)| (name.to_string(), *s)).collect::<BTreeMap<_, _>>()
        };
        let ranks = [
            rank(&[("compute", 3.0), ("wait", 1.0)]),
            rank(&[("compute", 1.0), ("rest", 1.0), ("novelty", 2.0)]),
        ];
        assert_eq!(shares(&ranks), Some([0.5, 0.0, 0.0, 0.0, 0.125, 0.0, 0.375]));
        assert_eq!(shares(&[rank(&[("compute", 0.0)])]), None);
        assert_eq!(shares(&[]), None);
    }
}
