//! Nodes at which velocity fields share degrees of freedom, and the projection onto shared values.

use super::contact_nodes::Meetings;
use super::multi_body_constraint::Knot;
use crate::contact::BoundaryPoint;

/// Contact of two velocity fields at a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint<const D: usize> {
    /// Indices of the node in the layers of both fields.
    pub at: [usize; 2],
    /// Lumped masses [kg].
    pub mass: [f64; 2],
    /// Unit normal from the first field to the second.
    pub normal: [f64; D],
    /// Whether the whole velocity is shared, not only the normal component.
    pub whole: bool,
    /// Whether filters leave out the tangential motion of the first or the second field, because
    /// its material fills too little of the node.
    pub low: [bool; 2],
    /// Share of the node's sums that this patch accounts for [-]: 0 for a node of another patch,
    /// 1/2 on a mirror, whose sums count each particle twice.
    pub share: f64,
    /// Momentum [kg m/s] and force [N] of the second field on the first from the projections.
    pub given: [[f64; D]; 2],
    /// Friction force of the second field on the first [N].
    pub friction: [f64; D],
}

/// Account of the jump in a projection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Booked {
    /// Jump of velocity, counted as momentum.
    Velocity,
    /// Jump of acceleration, counted as force.
    Force,
}

/// Scalar product a.b.
#[inline(always)]
pub(super) fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (1..D).fold(a[0] * b[0], |sum, k| sum + a[k] * b[k])
}

impl<const D: usize> Joint<D> {
    /// Both values after projection: shared components become their mean by mass.
    ///
    /// The normal components are removed and replaced, not corrected by their difference: a thin
    /// piece of material has accelerations so great that the difference would lose the digits of
    /// the other value.
    #[inline(always)]
    pub fn shared(&self, [a, b]: [[f64; D]; 2]) -> [[f64; D]; 2] {
        let [ma, mb] = self.mass;
        let inverse = 1.0 / (ma + mb);
        if D == 1 || self.whole {
            let mean = std::array::from_fn(|k| (ma * a[k] + mb * b[k]) * inverse);
            return [mean, mean];
        }
        let n = &self.normal;
        let (an, bn) = (dot(&a, n), dot(&b, n));
        let mean = (ma * an + mb * bn) * inverse;
        let put = |v: [f64; D], vn: f64| std::array::from_fn(|k| (v[k] - vn * n[k]) + mean * n[k]);
        [put(a, an), put(b, bn)]
    }
}

/// Contact data of a patch in one step; buffers are reused.
#[derive(Clone, Debug, Default)]
pub struct ContactNodes<const D: usize> {
    /// Nodes with particles of several bodies.
    pub meetings: Meetings<D>,
    /// Pairs of fields in contact.
    pub joints: Vec<Joint<D>>,
    /// Nodes with more than one pair in contact; their joints are consecutive.
    pub knots: Vec<Knot<D>>,
    /// Corners of particles, for normals by regression.
    pub points: Vec<BoundaryPoint<D>>,
    /// Normal and tangential force of each of the patch's own joints [N]: the normal force is
    /// positive in compression, the tangential one a magnitude.
    pub told: Vec<[f64; 2]>,
}

impl<const D: usize> ContactNodes<D> {
    /// Discards the data of the last step.
    pub fn clear(&mut self) {
        self.joints.clear();
        self.knots.clear();
        self.told.clear();
    }

    /// Projects a vector with components in `fields`, and adds the jump to its account.
    pub fn join(&mut self, fields: &mut [Vec<f64>], booked: Option<Booked>) {
        let mut knots = self.knots.iter().peekable();
        let mut k = 0;
        while k < self.joints.len() {
            if let Some(knot) = knots.next_if(|knot| knot.joints().start == k) {
                let joints = &mut self.joints[knot.joints()];
                knot.join(fields, joints, booked);
                k = knot.joints().end;
                continue;
            }
            let joint = &mut self.joints[k];
            let values = joint.at.map(|at| std::array::from_fn(|a| fields[a][at]));
            let shared = joint.shared(values);
            for (at, value) in joint.at.into_iter().zip(shared) {
                (0..D).for_each(|a| fields[a][at] = value[a]);
            }
            if let Some(booked) = booked {
                let given = &mut joint.given[booked as usize];
                for a in 0..D {
                    given[a] += joint.mass[0] * (shared[0][a] - values[0][a]);
                }
            }
            k += 1;
        }
    }

    /// Replaces a scalar by its mean, weighted by `weight`, at nodes in contact.
    pub fn join_scalar(&self, weight: &[f64], field: &mut [f64]) {
        let mean = |places: &[usize], field: &mut [f64]| {
            let sum: f64 = places.iter().map(|&i| weight[i]).sum();
            if sum > 0.0 {
                let mean = places.iter().map(|&i| weight[i] * field[i]).sum::<f64>() / sum;
                places.iter().for_each(|&i| field[i] = mean);
            }
        };
        let mut knots = self.knots.iter().peekable();
        let mut k = 0;
        while k < self.joints.len() {
            if let Some(knot) = knots.next_if(|knot| knot.joints().start == k) {
                mean(knot.places(), field);
                k = knot.joints().end;
                continue;
            }
            mean(&self.joints[k].at, field);
            k += 1;
        }
    }

    /// Removes the tangential motion from `fields` where filters leave it out, or replaces it by
    /// that of `first`.
    pub fn mask(&self, fields: &mut [Vec<f64>], first: Option<usize>, sum: usize) {
        if D == 1 {
            return;
        }
        for joint in self.joints.iter().filter(|j| !j.whole) {
            for (at, low) in joint.at.into_iter().zip(joint.low) {
                if !low {
                    continue;
                }
                let read =
                    |field: usize| -> [f64; D] { std::array::from_fn(|a| fields[field + a][at]) };
                let kept = first.map_or([0.0; D], read);
                let value = read(sum);
                let n = &joint.normal;
                let along = dot(&std::array::from_fn(|k| value[k] - kept[k]), n);
                (0..D).for_each(|a| fields[sum + a][at] = kept[a] + along * n[a]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn joint<const D: usize>(normal: [f64; D], whole: bool) -> Joint<D> {
        let mass = [2.0, 6.0];
        let (low, given, friction) = ([false; 2], [[0.0; D]; 2], [0.0; D]);
        Joint { at: [1, 4], mass, normal, whole, low, share: 1.0, given, friction }
    }

    #[test]
    fn what_is_shared_is_the_mean_by_mass_and_momentum_stays() {
        let n = [0.6, 0.8];
        let (a, b) = ([3.0, -1.0], [0.5, 2.0]);
        for whole in [false, true] {
            let joint = joint(n, whole);
            let [x, y] = joint.shared([a, b]);
            for k in 0..2 {
                let momentum = 2.0 * (x[k] - a[k]) + 6.0 * (y[k] - b[k]);
                assert!(momentum.abs() < 1e-14);
            }
            assert!((dot(&x, &n) - dot(&y, &n)).abs() < 1e-15);
            let along = |v: [f64; 2]| 0.8 * v[0] - 0.6 * v[1];
            if whole {
                assert!((along(x) - along(y)).abs() < 1e-15);
            } else {
                assert!((along(x) - along(a)).abs() < 1e-15, "the plane's motion is its own");
            }
            // applied twice it gives the same result
            assert!((dot(&joint.shared([x, y])[0], &n) - dot(&x, &n)).abs() < 1e-15);
        }
    }

    #[test]
    fn a_sliver_loses_no_digits() {
        let sliver = Joint { mass: [1e-12, 1.0], ..joint([1.0], false) };
        // its acceleration is huge, but the sum of momentum is kept
        let [a, b] = sliver.shared([[3e12], [5.0]]);
        assert!((a[0] - 8.0).abs() < 1e-11 && a == b);
    }

    #[test]
    fn the_jump_is_booked_once_asked_for() {
        let mut nodes = ContactNodes { joints: vec![joint([1.0], false)], ..Default::default() };
        let mut fields = vec![vec![0.0, 4.0, 0.0, 0.0, 0.0]];
        nodes.join(&mut fields, None);
        assert_eq!((fields[0][1], fields[0][4]), (1.0, 1.0));
        assert_eq!(nodes.joints[0].given, [[0.0]; 2]);
        fields[0][4] = 5.0;
        nodes.join(&mut fields, Some(Booked::Force));
        assert_eq!(nodes.joints[0].given, [[0.0], [6.0]]);
    }
}
