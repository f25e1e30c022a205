//! Normals of the contact plane.

/// The unit normal from the first of two bodies to the second by their volume gradients: the
/// difference of the two gradients g = sum V G of the filled volume at the node, each of which
/// points out of its body (after Lemiale, Hurmane & Nairn 2010, with the gradients of volume, as
/// Nairn 2013 has them, that do not depend on density). Where the two bodies fill space g_b = -g_a,
/// so the difference takes each as it is known. Antisymmetric in the bodies, bit by bit.
///
/// None where the gradients tell of no direction.
pub fn volume_gradient<const D: usize>(a: &[f64; D], b: &[f64; D]) -> Option<[f64; D]> {
    let square = |v: &[f64; D]| v.iter().map(|x| x * x).sum::<f64>();
    let difference = std::array::from_fn(|k| a[k] - b[k]);
    let scale = square(a) + square(b);
    (square(&difference) > 1e-12 * scale).then(|| unit(difference))
}

/// Components smaller than this are rounding's.
const AXIS: f64 = 1e-10;

/// A vector of length 1 along `v`; along an axis if it is so to rounding.
pub(super) fn unit<const D: usize>(v: [f64; D]) -> [f64; D] {
    let length = |v: &[f64; D]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let first = length(&v);
    let v = v.map(|x| if x.abs() < AXIS * first { 0.0 } else { x });
    let length = length(&v);
    v.map(|x| x / length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_normal_points_from_the_first_to_the_second() {
        assert_eq!(volume_gradient(&[2.0], &[-1.5]), Some([1.0]));
        assert_eq!(volume_gradient(&[0.0, -3.0], &[1e-14, 2.0]), Some([0.0, -1.0]));
        assert_eq!(volume_gradient(&[0.0], &[0.0]), None);
        let (a, b) = ([0.3, 1.7], [-0.2, -1.1]);
        let n = volume_gradient(&a, &b).unwrap();
        assert_eq!(volume_gradient(&b, &a).unwrap(), n.map(|x| -x));
    }
}
