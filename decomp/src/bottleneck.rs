//! A limit of the load of a rank under which sections of an order suffice, at most 1/4096 above the
//! smallest one.

/// The search ends when its limits differ by at most the fraction 2^-12 of the lower one.
const PRECISION: u32 = 12;

/// A limit of the sum of `weights` of a rank under which `ranks` ranks suffice: the smallest one, or
/// above it by at most 1/4096 of it. `total` is the sum of all weights, and `heaviest` the greatest one.
pub(crate) fn bottleneck_limit(weights: &[u64], total: u64, heaviest: u64, ranks: usize) -> u64 {
    let mean = total.div_ceil(ranks as u64);
    // with the upper limit, every section but the last holds more than the mean
    let (mut low, mut high) = (heaviest.max(mean), total.min(mean + heaviest));
    let mut guess = first_guess(weights, total, ranks, low);
    // numbers of sections at both limits, as far as they are known
    let mut sections = [None, None];
    let mut halve = false;
    for tries in 1.. {
        let (width, precision) = (high - low, low >> PRECISION);
        if width <= precision {
            break;
        }
        let limit = match sections {
            _ if halve => low + width / 2,
            // between known limits the number of sections falls evenly
            [Some(most), Some(least)] => {
                low + (width as f64 * (most - ranks as f64) / (most - least)) as u64
            }
            _ => guess,
        };
        let limit = limit.clamp(low, high - 1);
        // guesses go a little too far, so that the other side becomes known
        let beyond = |estimate: u64| estimate + estimate / 16 + precision / 2 + 1;
        match try_limit(weights, ranks, limit) {
            Ok((most, count)) => {
                let less = (total / ranks as u64).saturating_sub(total / count as u64);
                guess = limit.saturating_sub(beyond(less));
                (high, sections[1]) = (most, Some(count as f64 - 1.0));
            }
            Err((next, sum)) => {
                let more = (total - sum) / ranks as u64;
                guess = limit.saturating_add(beyond(more));
                let count = (ranks as f64 + 1.0) * total as f64 / sum as f64;
                (low, sections[0]) = (next, Some(count));
            }
        }
        // if a later guess has not halved the width, the middle is taken
        halve = !halve && tries > GUESSES && high.saturating_sub(low) > width / 2;
    }
    high
}

/// Number of tries after which guesses must halve the width.
const GUESSES: usize = 2;

/// A limit near the bottleneck, not below `least`: an equal share plus the mean unused part of a
/// section.
/// This is about half a weight, and is counted for some of the weights.
fn first_guess(weights: &[u64], total: u64, ranks: usize, least: u64) -> u64 {
    let share = total as f64 / ranks as f64;
    let limit = (share + 0.5 * total as f64 / weights.len() as f64).max(least as f64);
    let some = &weights[..weights.len().div_ceil(SAMPLED)];
    let sections = try_limit(some, usize::MAX, limit as u64).map_or(1, |(_, count)| count);
    let mean = some.iter().sum::<u64>() as f64 / sections as f64;
    (share + (limit - mean)) as u64
}

/// Number of weights of which one is examined for a first guess.
const SAMPLED: usize = 16;

/// Cuts sections that are as full as `limit` admits. Returns the largest sum of a section and the
/// number of sections if there are at most `ranks`; otherwise the least limit with another result, and
/// the sum of the weights in `ranks` sections.
fn try_limit(weights: &[u64], ranks: usize, limit: u64) -> Result<(u64, usize), (u64, u64)> {
    let (mut sections, mut load, mut most, mut next, mut before) = (1, 0, 0, u64::MAX, 0);
    for &w in weights {
        load += w;
        if load > limit {
            next = next.min(load);
            most = most.max(load - w);
            before += load - w;
            load = w;
            sections += 1;
            if sections > ranks {
                return Err((next, before));
            }
        }
    }
    Ok((most.max(load), sections))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The smallest bottleneck by bisection alone.
    fn bisected(weights: &[u64], ranks: usize) -> u64 {
        let (mut low, mut high) = (0, weights.iter().sum::<u64>());
        while low < high {
            let middle = low + (high - low) / 2;
            let fits = weights.iter().all(|&w| w <= middle)
                && try_limit(weights, usize::MAX, middle).is_ok_and(|(_, count)| count <= ranks);
            if fits { high = middle } else { low = middle + 1 }
        }
        low
    }

    proptest! {
        #[test]
        fn the_limit_is_at_most_a_4096th_above_the_smallest(
            (weights, heavy) in (prop::collection::vec(0u64..1000, 1..600), 1u64..5000),
            ranks in 1usize..200,
        ) {
            let mut weights = weights;
            weights[0] += heavy;
            let heaviest = *weights.iter().max().unwrap();
            let found = bottleneck_limit(&weights, weights.iter().sum(), heaviest, ranks);
            let least = bisected(&weights, ranks);
            prop_assert!((least..=least + least / 4096).contains(&found), "{found} for {least}");
        }
    }
}
