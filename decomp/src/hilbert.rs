//! Hilbert curve over a box of patches. Neighbours on the curve are neighbours in space, so
//! sections of the curve are compact groups of patches.

/// Flat indices of a box with `parts` entries per direction (first direction fastest), in the order
/// of the Hilbert curve. In one dimension the order is unchanged.
///
/// The curve index uses the transposed form of J. Skilling (2004), "Programming the Hilbert curve",
/// on the smallest cube with a power-of-two edge that contains the box.
pub fn curve_order<const D: usize>(parts: [usize; D]) -> Vec<usize> {
    let count: usize = parts.iter().product();
    let mut order: Vec<usize> = (0..count).collect();
    if D == 1 {
        return order;
    }
    let longest = parts.iter().copied().max().unwrap_or(1);
    let bits = usize::BITS - longest.saturating_sub(1).leading_zeros();
    order.sort_by_cached_key(|&place| {
        let mut at = place;
        let corner = parts.map(|n| {
            let i = at % n;
            at /= n;
            i as u64
        });
        hilbert_index(corner, bits)
    });
    order
}

/// Position on the curve through a cube of 2^`bits` in each direction.
fn hilbert_index<const D: usize>(mut x: [u64; D], bits: u32) -> u128 {
    // undo the excess work of the inverse transform (Skilling's AxestoTranspose)
    let mut q = 1u64 << bits.saturating_sub(1);
    while q > 1 {
        let p = q - 1;
        for i in 0..D {
            if x[i] & q != 0 {
                x[0] ^= p;
            } else {
                let t = (x[0] ^ x[i]) & p;
                x[0] ^= t;
                x[i] ^= t;
            }
        }
        q >>= 1;
    }
    // Gray code
    for i in 1..D {
        x[i] ^= x[i - 1];
    }
    let mut t = 0;
    let mut q = 1u64 << bits.saturating_sub(1);
    while q > 1 {
        if x[D - 1] & q != 0 {
            t ^= q - 1;
        }
        q >>= 1;
    }
    x.iter_mut().for_each(|x| *x ^= t);
    // interleave the bits of all directions, the highest first
    (0..bits).rev().flat_map(|b| x.map(|x| x >> b & 1)).fold(0, |h, bit| h << 1 | u128::from(bit))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distance(a: usize, b: usize, width: usize) -> usize {
        (a % width).abs_diff(b % width) + (a / width).abs_diff(b / width)
    }

    #[test]
    fn neighbours_on_the_curve_are_neighbours_in_the_square() {
        for n in [2, 4, 8, 16] {
            let order = curve_order([n, n]);
            assert!(order.windows(2).all(|w| distance(w[0], w[1], n) == 1), "{n}: {order:?}");
        }
    }

    #[test]
    fn every_place_comes_once() {
        for parts in [[1, 1], [5, 3], [1, 9], [7, 7]] {
            let mut order = curve_order(parts);
            order.sort_unstable();
            assert!(order.into_iter().eq(0..parts[0] * parts[1]));
        }
        assert_eq!(curve_order([4]), [0, 1, 2, 3]);
    }
}
