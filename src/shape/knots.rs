//! Places between knots: whole numbers, the rest beyond them, and the splines there.

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

/// Distance from a knot within which a point counts as on it [cells]; it exceeds the rounding error
/// between two points that should coincide. Otherwise weights of rounding size would make chains of
/// products underflow to denormal numbers, where bits are lost.
pub(super) const ON_KNOT: f64 = 1e-12;

/// Integer part of `x` and the remainder in [0, 1), 0 if `x` is on an integer.
#[inline(always)]
pub(super) fn split(x: f64) -> (f64, f64) {
    let whole = floor(x);
    let rest = x - whole;
    if rest < ON_KNOT {
        (whole, 0.0)
    } else if rest > 1.0 - ON_KNOT {
        (whole + 1.0, 0.0)
    } else {
        (whole, rest)
    }
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
