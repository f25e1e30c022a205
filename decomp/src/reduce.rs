//! Sums that do not depend on the order of their terms.

use crate::Comm;

/// Bits below the largest term that a sum keeps: 2^40 terms still fit into an `i128`.
const KEPT: i32 = 80;

/// Bits of the lower half of a term, and the value of one unit of its upper half.
const HALF_BITS: i32 = KEPT / 2;
const HALF: f64 = (1u64 << HALF_BITS) as f64;

/// Number of terms whose halves a double sums without error, and number of sums that run side by
/// side.
const MOST_TERMS: usize = 1 << (f64::MANTISSA_DIGITS as i32 - HALF_BITS - 1);
const LANES: usize = 8;

/// Sum over all ranks that does not depend on the order of its terms.
#[derive(Clone, Debug)]
pub struct ExactSum {
    quantum: f64,
    inverse: f64,
    total: i128,
}

impl ExactSum {
    /// Creates an empty sum of terms that are at most `largest` in magnitude, in the unit of the
    /// terms. All parts of one sum must use the same `largest`.
    pub fn new(largest: f64) -> Self {
        let bits = largest.log2().ceil() as i32;
        let exponent = if largest > 0.0 { bits.saturating_add(1) } else { 0 };
        // a quantum that is too small for a double affects no result that a double can represent
        let scale = (exponent - KEPT).max(-1000);
        ExactSum { quantum: 2f64.powi(scale), inverse: 2f64.powi(-scale), total: 0 }
    }

    /// Adds a term.
    #[inline]
    pub fn add(&mut self, term: f64) {
        let [high, low] = self.halves(term);
        self.add_halves(high, low);
    }

    /// Adds several terms.
    pub fn add_all(&mut self, terms: &[f64]) {
        for terms in terms.chunks(MOST_TERMS) {
            let (mut highs, mut lows) = ([0.0; LANES], [0.0; LANES]);
            let (several, rest) = terms.as_chunks::<LANES>();
            for terms in several {
                for lane in 0..LANES {
                    let [high, low] = self.halves(terms[lane]);
                    highs[lane] += high;
                    lows[lane] += low;
                }
            }
            let (high, low) = (highs.iter().sum::<f64>(), lows.iter().sum::<f64>());
            match high.is_nan() {
                false => self.add_halves(high, low),
                // a NaN counts as zero and does not affect the other terms
                true => several.as_flattened().iter().for_each(|&term| self.add(term)),
            }
            rest.iter().for_each(|&term| self.add(term));
        }
    }

    /// Splits a term's multiple of the quantum into two whole numbers, without error. One unit of
    /// the upper number is 2^40.
    #[inline(always)]
    fn halves(&self, term: f64) -> [f64; 2] {
        let multiple = (term * self.inverse).round_ties_even();
        let high = (multiple / HALF).floor();
        [high, multiple - high * HALF]
    }

    #[inline(always)]
    fn add_halves(&mut self, high: f64, low: f64) {
        self.total += (i128::from(high as i64) << HALF_BITS) + i128::from(low as i64);
    }

    /// Replaces each of `sums` by its sum over all ranks. Collective.
    pub fn over_ranks(comm: &dyn Comm, sums: &mut [ExactSum]) {
        // limbs of 32 bits leave room for 2^31 ranks
        let mut limbs: smallvec::SmallVec<[i64; 64]> = sums
            .iter()
            .flat_map(|s| {
                let t = s.total;
                [
                    t as u32 as i64,
                    (t >> 32) as u32 as i64,
                    (t >> 64) as u32 as i64,
                    (t >> 96) as i64,
                ]
            })
            .collect();
        comm.sum(&mut limbs);
        for (sum, limb) in sums.iter_mut().zip(limbs.chunks(4)) {
            sum.total = limb.iter().rev().fold(0, |high, &l| (high << 32) + l as i128);
        }
    }

    /// The sum so far, in whole multiples of its quantum. Another sum with the same `largest` can
    /// continue from it with [`ExactSum::carry_on`].
    pub fn total(&self) -> i128 {
        self.total
    }

    /// Continues from the total of an earlier sum.
    pub fn carry_on(&mut self, total: i128) {
        self.total = total;
    }

    /// The sum so far, in the unit of its terms.
    pub fn value(&self) -> f64 {
        self.total as f64 * self.quantum
    }
}

/// Sums of `N` quantities over the terms of all ranks, bitwise the same for any distribution of
/// terms to ranks. `terms` is called twice; it calls its argument with the number of a quantity and
/// some terms of it. Collective.
pub fn exact_sums<const N: usize>(
    comm: &dyn Comm,
    terms: impl Fn(&mut dyn FnMut(usize, &[f64])),
) -> [f64; N] {
    let mut largest = [0.0f64; N];
    terms(&mut |k, terms| largest[k] = largest[k].max(greatest(terms)));
    largest = largest.map(|l| -l);
    comm.min(&mut largest);
    let mut sums = largest.map(|l| ExactSum::new(-l));
    terms(&mut |k, terms| sums[k].add_all(terms));
    ExactSum::over_ranks(comm, &mut sums);
    sums.map(|s| s.value())
}

/// The largest magnitude of the terms; NaN is ignored.
fn greatest(terms: &[f64]) -> f64 {
    let mut lanes = [0.0f64; LANES];
    let (several, rest) = terms.as_chunks::<LANES>();
    for terms in several {
        for lane in 0..LANES {
            lanes[lane] = lanes[lane].max(terms[lane].abs());
        }
    }
    lanes.iter().chain(rest).fold(0.0, |most, term| most.max(term.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Serial;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn order_does_not_matter(mut terms in prop::collection::vec(-1e20f64..1e20, 1..60)) {
            let sum = |t: &[f64]| exact_sums::<1>(&Serial, |add| add(0, t))[0];
            let forward = sum(&terms);
            terms.reverse();
            prop_assert_eq!(forward.to_bits(), sum(&terms).to_bits());
            terms.sort_by(f64::total_cmp);
            prop_assert_eq!(forward.to_bits(), sum(&terms).to_bits());
        }
    }

    proptest! {
        #[test]
        fn halves_make_the_whole(term in -1.0f64..1.0, down in 0..90i32) {
            let mut sum = ExactSum::new(1.0);
            let term = term * 2f64.powi(-down);
            sum.add(term);
            prop_assert_eq!(sum.total(), (term * 2f64.powi(79)).round_ties_even() as i128);
        }
    }

    proptest! {
        #[test]
        fn many_terms_at_a_time_are_one_after_the_other(
            mut terms in prop::collection::vec(-1.0f64..1.0, 0..60),
            repeated in 1..400usize,
            broken in 0..90usize,
        ) {
            // a NaN counts as zero
            if let Some(term) = terms.get_mut(broken) {
                *term = f64::NAN;
            }
            let terms = terms.repeat(repeated);
            let (mut one, mut all) = (ExactSum::new(1.0), ExactSum::new(1.0));
            terms.iter().for_each(|&term| one.add(term));
            all.add_all(&terms);
            prop_assert_eq!(one.total(), all.total());
            let most = terms.iter().fold(0.0f64, |most, term| most.max(term.abs()));
            prop_assert_eq!(greatest(&terms), most);
        }
    }

    #[test]
    fn cancellation_is_exact() {
        let terms = [1e10, 1.0, -1e10, 3e-9];
        let [sum] = exact_sums(&Serial, |add| add(0, &terms));
        assert!((sum - (1.0 + 3e-9)).abs() < 1e-13);
        let [tiny, none] = exact_sums(&Serial, |add| add(0, &[5e-200]));
        assert_eq!((tiny, none), (5e-200, 0.0));
    }
}
