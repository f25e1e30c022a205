//! Contact of two velocity fields at a node: the degrees of freedom that they share, and the
//! projection onto shared values.

use super::vectors::dot;

/// Contact of two velocity fields at a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactConstraint<const D: usize> {
    /// Indices of the node in the layers of both fields.
    pub at: [usize; 2],
    /// Lumped masses [kg].
    pub mass: [f64; 2],
    /// Unit normal from the first field to the second [-].
    pub normal: [f64; D],
    /// Whether filters leave out the tangential motion of the first or the second field, because
    /// its material fills too little of the node.
    pub low: [bool; 2],
    /// Share of the node's sums that this patch accounts for [-]: 0 for a node of another patch,
    /// 1/2 on a mirror, whose sums count each particle twice.
    pub share: f64,
    /// Momentum [kg m/s] and force [N] of the second field on the first from the projections.
    pub given: [[f64; D]; 2],
    /// Friction force of the second field on the first [N], along the contact plane.
    pub friction: [f64; D],
}

/// Account of the jump in a projection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConstraintJump {
    /// Jump of velocity, counted as momentum.
    Velocity,
    /// Jump of acceleration, counted as force.
    Force,
}

impl<const D: usize> ContactConstraint<D> {
    /// Impulse of the projections on the first field in a step of `dt` [s], of which particles adopt
    /// the share `moved` of a jump of velocity [N s].
    pub fn impulse(&self, moved: f64, dt: f64) -> [f64; D] {
        let [momentum, force] = &self.given;
        decomp::array::from_fn(|a| moved * momentum[a] + dt * force[a])
    }

    /// Both values after projection, in their common unit: shared components become their mean by
    /// mass.
    ///
    /// The normal components are removed and replaced, not corrected by their difference: a thin
    /// piece of material has accelerations so great that the difference would lose the digits of
    /// the other value.
    #[inline(always)]
    pub fn shared(&self, [a, b]: [[f64; D]; 2]) -> [[f64; D]; 2] {
        let [ma, mb] = self.mass;
        let inverse = 1.0 / (ma + mb);
        if D == 1 {
            let mean = decomp::array::from_fn(|k| (ma * a[k] + mb * b[k]) * inverse);
            return [mean, mean];
        }
        let n = &self.normal;
        let (an, bn) = (dot(&a, n), dot(&b, n));
        let mean = (ma * an + mb * bn) * inverse;
        let put =
            |v: [f64; D], vn: f64| decomp::array::from_fn(|k| (v[k] - vn * n[k]) + mean * n[k]);
        [put(a, an), put(b, bn)]
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Constraint of two fields at the nodes 1 and 4, with masses of 2 and 6 kg.
    pub fn constraint<const D: usize>(normal: [f64; D]) -> ContactConstraint<D> {
        let mass = [2.0, 6.0];
        let (low, given, friction) = ([false; 2], [[0.0; D]; 2], [0.0; D]);
        ContactConstraint { at: [1, 4], mass, normal, low, share: 1.0, given, friction }
    }

    #[test]
    fn what_is_shared_is_the_mean_by_mass_and_momentum_stays() {
        let n = [0.6, 0.8];
        let (a, b) = ([3.0, -1.0], [0.5, 2.0]);
        let constraint = constraint(n);
        let [x, y] = constraint.shared([a, b]);
        for k in 0..2 {
            let momentum = 2.0 * (x[k] - a[k]) + 6.0 * (y[k] - b[k]);
            assert!(momentum.abs() < 1e-14);
        }
        assert!((dot(&x, &n) - dot(&y, &n)).abs() < 1e-15);
        let along = |v: [f64; 2]| 0.8 * v[0] - 0.6 * v[1];
        assert!((along(x) - along(a)).abs() < 1e-15, "the plane's motion is its own");
        // applied twice it gives the same result
        assert!((dot(&constraint.shared([x, y])[0], &n) - dot(&x, &n)).abs() < 1e-15);
    }

    #[test]
    fn a_sliver_loses_no_digits() {
        let sliver = ContactConstraint { mass: [1e-12, 1.0], ..constraint([1.0]) };
        // its acceleration is huge, but the sum of momentum is kept
        let [a, b] = sliver.shared([[3e12], [5.0]]);
        assert!((a[0] - 8.0).abs() < 1e-11 && a == b);
    }
}
