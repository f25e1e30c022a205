//! Thinning: draws a curve of very many points with fewer points, without a visible change.

/// Largest number of points drawn per series.
pub(super) const LIMIT: usize = 5000;

/// Indices of the points to draw: all, or at most `limit`.
///
/// The points are divided, in their order, into `(limit - 2) / 2` runs of equal length. Of each run the
/// smallest and the largest value are kept, so that no peak is lost. The first and the last point
/// are always kept. `values` must be finite.
pub(super) fn thin(values: &[f64], limit: usize) -> Vec<usize> {
    let count = values.len();
    if count <= limit {
        return (0..count).collect();
    }
    let runs = (limit.saturating_sub(2) / 2).max(1);
    let mut kept = vec![0];
    for run in 0..runs {
        let range = count * run / runs..count * (run + 1) / runs;
        let least = range.clone().min_by(|&a, &b| values[a].total_cmp(&values[b]));
        let greatest = range.max_by(|&a, &b| values[a].total_cmp(&values[b]));
        let mut pair: Vec<usize> = least.into_iter().chain(greatest).collect();
        pair.sort_unstable();
        kept.extend(pair);
    }
    kept.push(count - 1);
    kept.dedup();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_few_points_as_they_are() {
        assert_eq!(thin(&[3.0, 1.0, 2.0], 3), [0, 1, 2]);
        assert!(thin(&[], 10).is_empty());
    }

    #[test]
    fn keeps_peaks_and_ends() {
        let mut values: Vec<f64> = (0..100_000).map(|i| (i as f64 * 1e-3).sin()).collect();
        values[54_321] = 7.0;
        values[77_777] = -7.0;
        let kept = thin(&values, LIMIT);
        assert!(kept.len() <= LIMIT && kept.len() > LIMIT / 3);
        assert!(kept.contains(&54_321) && kept.contains(&77_777));
        assert_eq!((kept[0], kept[kept.len() - 1]), (0, 99_999));
        assert!(kept.windows(2).all(|pair| pair[0] < pair[1]));
    }
}
