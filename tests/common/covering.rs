//! Pairwise covering: a small set of combinations of many factors in which every pair of values
//! occurs.

/// Combinations, each with one value per factor, such that every pair of values of any two factors
/// occurs in at least one of them. Factor `k` has the values 0 to `levels[k]` - 1.
///
/// Greedy: a combination starts from a missing pair, and each further factor takes the value that
/// adds the most missing pairs. Every factor must have at least one value.
pub fn pairwise(levels: &[usize]) -> Vec<Vec<usize>> {
    let mut missing = Missing::all(levels);
    let mut combinations = Vec::new();
    while let Some(pair) = missing.first() {
        let mut chosen: Vec<Option<usize>> = vec![None; levels.len()];
        for (factor, value) in pair {
            chosen[factor] = Some(value);
        }
        for factor in 0..levels.len() {
            if chosen[factor].is_none() {
                // values that are equally good alternate, otherwise some would hardly occur
                let turns = (0..levels[factor]).map(|v| (v + combinations.len()) % levels[factor]);
                chosen[factor] = turns.max_by_key(|&v| missing.brought_in(factor, v, &chosen));
            }
        }
        let combination: Vec<usize> = chosen.into_iter().flatten().collect();
        missing.strike(&combination);
        combinations.push(combination);
    }
    combinations
}

/// All combinations.
pub fn product(levels: &[usize]) -> Vec<Vec<usize>> {
    let mut all = vec![Vec::new()];
    for &values in levels {
        let longer = |c: &Vec<usize>| (0..values).map(|v| [&c[..], &[v]].concat()).collect();
        all = all.iter().flat_map(|c| -> Vec<Vec<usize>> { longer(c) }).collect();
    }
    all
}

/// Pairs of values that do not occur in any combination yet; a pair is two of (factor, value), the
/// lower factor first.
struct Missing(std::collections::BTreeSet<[(usize, usize); 2]>);

impl Missing {
    fn all(levels: &[usize]) -> Self {
        let values = |k: usize| (0..levels[k]).map(move |v| (k, v));
        let factors = (0..levels.len()).flat_map(|j| (j + 1..levels.len()).map(move |k| (j, k)));
        let pairs =
            factors.flat_map(|(j, k)| values(j).flat_map(move |a| values(k).map(move |b| [a, b])));
        Missing(pairs.collect())
    }

    fn first(&self) -> Option<[(usize, usize); 2]> {
        self.0.first().copied()
    }

    /// Number of missing pairs of a value with those chosen so far.
    fn brought_in(&self, factor: usize, value: usize, chosen: &[Option<usize>]) -> usize {
        let others = chosen.iter().enumerate().filter_map(|(k, v)| Some((k, (*v)?)));
        others.filter(|&other| self.0.contains(&ordered(other, (factor, value)))).count()
    }

    fn strike(&mut self, combination: &[usize]) {
        for a in combination.iter().copied().enumerate() {
            for b in combination.iter().copied().enumerate() {
                self.0.remove(&ordered(a, b));
            }
        }
    }
}

fn ordered(a: (usize, usize), b: (usize, usize)) -> [(usize, usize); 2] {
    if a < b { [a, b] } else { [b, a] }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEVELS: [&[usize]; 5] =
        [&[5, 5, 2, 2, 2, 2, 2, 3], &[2, 2], &[1, 4, 1], &[3], &[2, 7, 2, 3, 4]];

    #[test]
    fn every_pair_of_values_of_any_two_factors_occurs() {
        for levels in LEVELS {
            let chosen = pairwise(levels);
            for (j, k) in product(&[levels.len(), levels.len()]).iter().map(|p| (p[0], p[1])) {
                for (a, b) in product(&[levels[j], levels[k]]).iter().map(|p| (p[0], p[1])) {
                    let occurs = chosen.iter().any(|c| c[j] == a && c[k] == b);
                    assert!(
                        occurs || (j == k && a != b) || levels.len() == 1,
                        "{j}: {a}, {k}: {b}"
                    );
                }
            }
        }
    }

    #[test]
    fn combinations_are_within_their_levels_and_few() {
        for levels in LEVELS {
            let chosen = pairwise(levels);
            assert!(chosen.iter().all(|c| c.len() == levels.len()));
            assert!(chosen.iter().flat_map(|c| c.iter().zip(levels)).all(|(v, n)| v < n));
        }
        // at least the 25 pairs of the first two factors
        let count = pairwise(LEVELS[0]).len();
        assert!((25..=28).contains(&count), "{count}");
    }

    #[test]
    fn a_product_has_all() {
        assert_eq!(product(&[2, 1, 3]).len(), 6);
        assert_eq!(product(&[1, 2]), [[0, 0], [0, 1]]);
        assert_eq!(product(&[5, 5, 2, 2, 2, 2]).len(), 400);
    }
}
