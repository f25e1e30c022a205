//! Hat functions interpolated from the corners of the deforming particle (convected particle
//! domain interpolation: Sadeghirad, Brannon & Burghardt 2011). In one dimension the corners are
//! the particle's ends, a deformed length apart.

use super::{Extent, Shape, Weights, split};

/// Hat functions from the ends of the deforming particle.
#[derive(Clone, Copy, Debug)]
pub struct Cpdi;

impl Shape for Cpdi {
    const EXTENT: Extent = Extent::Current;

    fn nodes(length: f64) -> usize {
        length.ceil() as usize + 2
    }

    #[inline(always)]
    fn weights<const K: usize>(fraction: f64, length: f64) -> Weights<K> {
        let (first, a) = split(fraction - 0.5 * length);
        let (last, b) = split(fraction + 0.5 * length);
        let inverse = 1.0 / length;
        let mut w = Weights::none(first as i32);
        // nodes of the upper end, from the first node of the lower end
        let apart = last - first;
        for k in 0..K {
            let at = k as f64;
            let from_lower = if k == 0 {
                1.0 - a
            } else if k == 1 {
                a
            } else {
                0.0
            };
            let from_upper = if at == apart {
                1.0 - b
            } else if at == apart + 1.0 {
                b
            } else {
                0.0
            };
            w.values[k] = 0.5 * (from_lower + from_upper);
            w.gradients[k] = (from_upper - from_lower) * inverse;
        }
        w
    }
}
