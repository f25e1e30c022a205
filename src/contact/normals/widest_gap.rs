//! Normals by a choice among directions: the one along which the gap between the particles is
//! widest.
//!
//! If two convex bodies do not overlap, a line separates them, and along its normal their gap is
//! not negative. At a corner, means of gradients point between the normals of two faces, and along
//! them the bodies seem to overlap; the gradient of one body alone often is the normal of the
//! face in contact.

use super::body_pair::{BodyPair, BoundaryPoint, ContactPlane, ContactPlanes, axes, direction};
use super::volume_gradient::volume_gradient;

pub(super) const PLANE_ONLY: bool = false;

pub(super) const USES_FACES: bool = false;

/// Excess of the gap along a direction over that along a previous one for which it is chosen
/// [cells]: rounding and the unevenness of particles choose no direction.
const MARGIN: f64 = 0.01;

pub(super) fn planes<const D: usize>(
    pair: &BodyPair<'_, D>,
    _: &mut Vec<BoundaryPoint<D>>,
) -> ContactPlanes<D> {
    plane(pair).into_iter().collect()
}

fn plane<const D: usize>(pair: &BodyPair<'_, D>) -> Option<ContactPlane<D>> {
    let difference = volume_gradient(pair.volume, pair.gradient);
    if D == 1 {
        return pair.plane(difference?);
    }
    let outward = pair.gradient.map(|g| direction(*g));
    let mean = mean(outward);
    let candidates = [mean, outward[0], outward[1].map(|g| g.map(|x| -x)), difference];
    let mut plane = widest(candidates.into_iter().flatten(), |normal| pair.gap(normal))?;
    for axis in axes(&plane.normal) {
        plane.gap = plane.gap.max(pair.gap(&axis)?);
    }
    Some(plane)
}

/// Unit vector between the normal of the first body and the reverse of that of the second.
pub(super) fn mean<const D: usize>(outward: [Option<[f64; D]>; 2]) -> Option<[f64; D]> {
    let [a, b] = outward;
    let (a, b) = (a?, b?);
    direction(std::array::from_fn(|k| a[k] - b[k]))
}

/// Plane with the first of the `candidates` whose gap no later one exceeds by [`MARGIN`], and the
/// widest gap along any of them.
pub(super) fn widest<const D: usize>(
    candidates: impl Iterator<Item = [f64; D]>,
    gap_along: impl Fn(&[f64; D]) -> Option<f64>,
) -> Option<ContactPlane<D>> {
    let mut chosen: Option<ContactPlane<D>> = None;
    let mut widest = f64::NEG_INFINITY;
    for normal in candidates {
        let Some(gap) = gap_along(&normal) else { continue };
        widest = widest.max(gap);
        if chosen.is_none_or(|plane| gap > plane.gap + MARGIN) {
            chosen = Some(ContactPlane { normal, gap });
        }
    }
    chosen.map(|plane| ContactPlane { gap: widest, ..plane })
}
