//! Normals by the gradients of the filled volumes (Lemiale, Hurmane & Nairn 2010).

use super::body_pair::{BodyPair, BoundaryPoint, ContactPlanes, unit};

pub(super) const PLANE_ONLY: bool = false;

pub(super) const USES_FACES: bool = false;

pub(super) fn planes<const D: usize>(
    pair: &BodyPair<'_, D>,
    _: &mut Vec<BoundaryPoint<D>>,
) -> ContactPlanes<D> {
    let normal = volume_gradient(pair.volume, pair.gradient);
    normal.and_then(|normal| pair.plane(normal)).into_iter().collect()
}

/// Unit normal from the first of two bodies to the second, by the gradient of the first body's
/// fraction of the volume filled at a node,
///
/// ```text
/// n ~ V_b g_a - V_a g_b,   V = sum V_p N,   g = sum V_p G
/// ```
///
/// with a body's filled volume V [cells] and its gradient g, which points out of the body (after
/// Lemiale, Hurmane & Nairn 2010, but with volume gradients, as in Nairn 2013, which do not depend
/// on density). If the two bodies fill space, g_a = -g_b. If a body only just reaches the node, its
/// own edge determines the normal, not the uneven compression of the other body by a wave.
/// Antisymmetric in the bodies, bit by bit.
///
/// `None` if the gradients define no direction.
pub(super) fn volume_gradient<const D: usize>(
    volume: [f64; 2],
    [a, b]: [&[f64; D]; 2],
) -> Option<[f64; D]> {
    let square = |v: &[f64; D]| v.iter().map(|x| x * x).sum::<f64>();
    let (a, b) = (a.map(|x| volume[1] * x), b.map(|x| volume[0] * x));
    let difference = std::array::from_fn(|k| a[k] - b[k]);
    let scale = square(&a) + square(&b);
    (square(&difference) > 1e-12 * scale).then(|| unit(difference))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_normal_points_from_the_first_to_the_second() {
        assert_eq!(volume_gradient([0.5, 0.5], [&[2.0], &[-1.5]]), Some([1.0]));
        let axis = volume_gradient([0.5, 0.5], [&[0.0, -3.0], &[1e-14, 2.0]]);
        assert_eq!(axis, Some([0.0, -1.0]));
        assert_eq!(volume_gradient([0.5, 0.5], [&[0.0], &[0.0]]), None);
        let (a, b) = ([0.3, 1.7], [-0.2, -1.1]);
        let n = volume_gradient([0.4, 0.7], [&a, &b]).unwrap();
        assert_eq!(volume_gradient([0.7, 0.4], [&b, &a]).unwrap(), n.map(|x| -x));
    }

    #[test]
    fn where_a_body_only_reaches_the_node_its_edge_tells_the_normal() {
        // the other body fills the node, and a wave has compressed it unevenly
        assert_eq!(volume_gradient([1e-4, 1.0], [&[1e-3], &[0.02]]), Some([1.0]));
    }
}
