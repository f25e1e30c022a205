//! Places between knots: whole numbers, the rest beyond them, and the splines there.

use wide::f64x4;

/// 3 * 2^51: doubles of this size are integers, and the low half of their bits holds the added
/// number, rounded to the nearest integer.
const ROUNDING: f64 = (3u64 << 51) as f64;

/// Greatest integer not above `x`, for |x| < 2^51. The standard function is a call on processors
/// without a guaranteed rounding instruction, and a cast to an integer and back is not vectorized,
/// as casts saturate.
#[inline(always)]
pub fn floor(x: f64) -> f64 {
    let nearest = (x + ROUNDING) - ROUNDING;
    nearest - if nearest > x { 1.0 } else { 0.0 }
}

/// Converts an integral double to an integer, limited to +-2^30.
#[inline(always)]
pub fn integer(whole: f64) -> i32 {
    const MOST: f64 = (1u32 << 30) as f64;
    let within = whole.clamp(-MOST, MOST);
    (within + ROUNDING).to_bits() as i32
}

/// Four whole numbers in the low bits of doubles, to be read by [`from_low_bits`]: one addition instead
/// of a conversion of each. A negative number is read as one near 2^32.
#[inline(always)]
pub fn to_low_bits(whole: f64x4) -> f64x4 {
    whole + f64x4::splat(ROUNDING)
}

/// Whole number in the low bits of a double, see [`to_low_bits`].
#[inline(always)]
pub fn from_low_bits(double: f64) -> u32 {
    double.to_bits() as u32
}

/// Distance from a knot within which a point counts as on it [cells]; it exceeds the rounding error
/// between two points that should coincide. Otherwise weights of rounding size would make chains of
/// products underflow to denormal numbers, where bits are lost.
pub(super) const ON_KNOT: f64 = 1e-12;

/// Integer part of `x` and the remainder in [0, 1), 0 if `x` is on an integer; for |x| < 2^51.
#[inline(always)]
pub(super) fn split(x: f64) -> (f64, f64) {
    let nearest = (x + ROUNDING) - ROUNDING;
    let rest = x - nearest;
    let rest = if rest.abs() < ON_KNOT { 0.0 } else { rest };
    let below = if rest < 0.0 { 1.0 } else { 0.0 };
    (nearest - below, rest + below)
}

/// [`split`] of four numbers at a time.
#[inline(always)]
pub(super) fn split4(x: f64x4) -> (f64x4, f64x4) {
    let nearest = (x + f64x4::splat(ROUNDING)) - f64x4::splat(ROUNDING);
    let rest = x - nearest;
    // masks have all bits or none
    let rest = rest & !rest.abs().simd_lt(f64x4::splat(ON_KNOT));
    let below = f64x4::ONE & rest.simd_lt(f64x4::ZERO);
    (nearest - below, rest + below)
}

/// [`quadratic`] at four numbers at a time: the first nodes, and the values one spline after the
/// other.
#[inline(always)]
pub(super) fn quadratic4(x: f64x4) -> (f64x4, [f64x4; 3]) {
    let half = f64x4::HALF;
    let (first, t) = split4(x - half);
    let r = f64x4::ONE - t;
    (first, [half * r * r, half + t * r, half * t * t])
}

/// `values` moved up by `by` nodes in a line of `K` nodes, zero elsewhere; at most to its end, which
/// only a particle passes that is torn apart.
#[inline(always)]
pub(super) fn moved<const N: usize, const K: usize>(values: [f64; N], by: usize) -> [f64; K] {
    let mut line = [0.0; K];
    if K == N + 1 {
        // chosen, not stored and loaded again in another place
        for k in 0..K {
            let (at, before) = (values.get(k), k.checked_sub(1).and_then(|k| values.get(k)));
            let chosen = if by == 0 { at } else { before };
            line[k] = chosen.copied().unwrap_or(0.0);
        }
    } else {
        let by = by.min(K - N);
        line[by..by + N].copy_from_slice(&values);
    }
    line
}

/// Values of the three quadratic B-splines at `x`, with the first of their nodes and the distance
/// from the knot below. Their knots lie midway between nodes.
#[inline(always)]
pub(super) fn quadratic(x: f64) -> (i32, f64, [f64; 3]) {
    let (first, t) = split(x - 0.5);
    let r = 1.0 - t;
    (integer(first), t, [0.5 * r * r, 0.5 + t * r, 0.5 * t * t])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_off_a_knot_by_a_rounding_lies_on_it() {
        for (x, at) in [(2.0 - 1e-15, 2.0), (2.0 + 1e-15, 2.0), (-1e-17, 0.0), (1e-17, 0.0)] {
            assert_eq!(split(x), (at, 0.0), "{x}");
        }
        assert_eq!(split(1.75), (1.0, 0.75));
        assert!(split(f64::NAN).1.is_nan());
    }

    #[test]
    fn four_numbers_are_split_as_one() {
        let on = [2.0, -1.0].map(|x: f64| [x, x - 1e-15, x + 1e-15, x + 0.25]);
        for four in on.into_iter().chain([[0.4, -0.3, f64::NAN, 7.9]]) {
            let (whole, rest) = split4(f64x4::from(four));
            let (first, values) = quadratic4(f64x4::from(four));
            for (k, x) in four.into_iter().enumerate() {
                let bits = |(a, b): (f64, f64)| [a.to_bits(), b.to_bits()];
                let lane = (whole.to_array()[k], rest.to_array()[k]);
                assert_eq!(bits(lane), bits(split(x)), "{x}");
                let (node, _, one) = quadratic(x);
                assert_eq!(integer(first.to_array()[k]), node, "{x}");
                let lane = values.map(|v| v.to_array()[k].to_bits());
                assert_eq!(lane, one.map(f64::to_bits), "{x}");
            }
        }
    }

    #[test]
    fn values_move_within_their_line() {
        assert_eq!(moved::<2, 3>([1.0, 2.0], 0), [1.0, 2.0, 0.0]);
        assert_eq!(moved::<2, 3>([1.0, 2.0], 1), [0.0, 1.0, 2.0]);
        assert_eq!(moved::<2, 5>([1.0, 2.0], 2), [0.0, 0.0, 1.0, 2.0, 0.0]);
        assert_eq!(moved::<3, 3>([1.0, 2.0, 3.0], 0), [1.0, 2.0, 3.0]);
    }

    #[test]
    fn floor_is_the_librarys() {
        for x in [-3.5, -3.0, -0.2, -0.0, 0.0, 0.9, 1.0, 7.3, -1e-300, 2e9, -2e9] {
            assert_eq!(floor(x), x.floor(), "{x}");
        }
    }

    #[test]
    fn integers_are_those_of_a_cast_up_to_their_limit() {
        for x in [-3.0, -1.0, -0.0, 0.0, 7.0, 1e9, -1e9] {
            assert_eq!(integer(x), x as i32, "{x}");
        }
        for beyond in [2e9, 1e18, f64::INFINITY] {
            assert_eq!([integer(beyond), integer(-beyond)], [1 << 30, -(1 << 30)]);
        }
        assert_eq!(integer(f64::NAN), 0);
    }
}
