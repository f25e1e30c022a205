//! Products of lines of nodes, four nodes at a time.

use wide::f64x4;

/// Entries 4 `four` to 4 `four` + 3 of a line, with zeros beyond its end. Explicit vectors, as
/// compilers split sums over arrays into scalars.
#[inline(always)]
pub fn fours<const K: usize>(line: &[f64; K], four: usize) -> f64x4 {
    let at = |k: usize| if k < K { line[k] } else { 0.0 };
    f64x4::new(std::array::from_fn(|k| at(4 * four + k)))
}

/// Adds `factor` times a line of values to the entries of `sums` from `first` on.
///
/// # Panics
///
/// If `sums` has fewer than `first + K` entries.
#[inline(always)]
pub fn add_product<const K: usize>(sums: &mut [f64], first: usize, factor: f64, values: &[f64; K]) {
    let sums: &mut [f64; K] = (&mut sums[first..first + K]).try_into().expect("K numbers");
    for four in 0..const { K.div_ceil(4) } {
        let four_sums = fours(sums, four) + f64x4::splat(factor) * fours(values, four);
        for (k, sum) in (4 * four..K).zip(four_sums.to_array()) {
            sums[k] = sum;
        }
    }
}
