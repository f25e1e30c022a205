//! Products of lines of nodes, four nodes at a time.

use wide::f64x4;

/// Entries 4 `four` to 4 `four` + 3 of a line, with zeros beyond its end. Explicit vectors, as
/// compilers split sums over arrays into scalars.
#[inline(always)]
pub fn fours<const K: usize>(line: &[f64; K], four: usize) -> f64x4 {
    let at = |k: usize| if k < K { line[k] } else { 0.0 };
    let k = 4 * four;
    f64x4::new([at(k), at(k + 1), at(k + 2), at(k + 3)])
}

/// Four numbers as a vector, by one load: compilers take overlapping lines apart.
#[inline(always)]
pub fn vector(numbers: &[f64; 4]) -> f64x4 {
    // SAFETY: a vector is four numbers, and any bits are numbers
    unsafe { std::mem::transmute_copy(numbers) }
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
        let four_sums = four_sums.to_array();
        for k in 4 * four..K.min(4 * four + 4) {
            sums[k] = four_sums[k - 4 * four];
        }
    }
}
