//! Contact data of a patch: nodes at which velocity fields share degrees of freedom.

use super::contact_constraint::{ConstraintJump, ContactConstraint};
use super::contact_nodes::ContactNodes;
use super::multi_body_constraint::MultiBodyConstraint;
use super::self_contact::SelfContact;
use super::vectors::dot;
use crate::contact::{BoundaryPoint, ContactParticle};

/// Contact data of a patch in one step; buffers are reused.
#[derive(Clone, Debug, Default)]
pub struct PatchContact<const D: usize> {
    /// Nodes with particles of several bodies.
    pub nodes: ContactNodes<D>,
    /// Pairs of fields in contact.
    pub constraints: Vec<ContactConstraint<D>>,
    /// Nodes with more than one pair in contact; their constraints are consecutive.
    pub multi_body: Vec<MultiBodyConstraint<D>>,
    /// Particles of each body at a node.
    pub particles: Vec<Vec<ContactParticle<D>>>,
    /// Corners of particles, for normals by regression.
    pub corners: Vec<BoundaryPoint<D>>,
    /// Normal and tangential force of each of the patch's own constraints [N]: the normal force is
    /// positive in compression, the tangential one a magnitude.
    pub forces: Vec<[f64; 2]>,
    /// Whether this step looks for bodies that touch themselves.
    pub searches_self_contact: bool,
    /// Narrowest gap of a body to itself in such a step.
    pub self_contact: Option<SelfContact<D>>,
}

impl<const D: usize> PatchContact<D> {
    /// Discards the data of the last step.
    pub fn clear(&mut self) {
        self.constraints.clear();
        self.multi_body.clear();
        self.forces.clear();
        self.self_contact = None;
    }

    /// Projects a vector with components in `fields` [m/s or m/s2], and adds the jump to its
    /// account.
    pub fn join(&mut self, fields: &mut [Vec<f64>], jump_of: Option<ConstraintJump>) {
        let mut multi_body = self.multi_body.iter().peekable();
        let mut k = 0;
        while k < self.constraints.len() {
            if let Some(group) = multi_body.next_if(|group| group.constraints().start == k) {
                let constraints = &mut self.constraints[group.constraints()];
                group.join(fields, constraints, jump_of);
                k = group.constraints().end;
                continue;
            }
            let constraint = &mut self.constraints[k];
            let values = constraint.at.map(|at| decomp::array::from_fn(|a| fields[a][at]));
            let shared = constraint.shared(values);
            for (at, value) in constraint.at.into_iter().zip(shared) {
                (0..D).for_each(|a| fields[a][at] = value[a]);
            }
            if let Some(jump_of) = jump_of {
                let given = &mut constraint.given[jump_of as usize];
                for a in 0..D {
                    given[a] += constraint.mass[0] * (shared[0][a] - values[0][a]);
                }
            }
            k += 1;
        }
    }

    /// Replaces the scalar `field` by its mean, weighted by `weight`, at nodes in contact; both
    /// have any unit.
    pub fn join_scalar(&self, weight: &[f64], field: &mut [f64]) {
        let mean = |places: &[usize], field: &mut [f64]| {
            let sum: f64 = places.iter().map(|&i| weight[i]).sum();
            if sum > 0.0 {
                let mean = places.iter().map(|&i| weight[i] * field[i]).sum::<f64>() / sum;
                places.iter().for_each(|&i| field[i] = mean);
            }
        };
        let mut multi_body = self.multi_body.iter().peekable();
        let mut k = 0;
        while k < self.constraints.len() {
            if let Some(group) = multi_body.next_if(|group| group.constraints().start == k) {
                mean(group.places(), field);
                k = group.constraints().end;
                continue;
            }
            mean(&self.constraints[k].at, field);
            k += 1;
        }
    }

    /// Removes the tangential motion from `fields` where filters leave it out, or replaces it by
    /// that of `first`.
    pub fn mask(&self, fields: &mut [Vec<f64>], first: Option<usize>, sum: usize) {
        if D == 1 {
            return;
        }
        for constraint in &self.constraints {
            for (at, low) in constraint.at.into_iter().zip(constraint.low) {
                if !low {
                    continue;
                }
                let read = |field: usize| -> [f64; D] {
                    decomp::array::from_fn(|a| fields[field + a][at])
                };
                let kept = first.map_or([0.0; D], read);
                let value = read(sum);
                let n = &constraint.normal;
                let along = dot(&decomp::array::from_fn(|k| value[k] - kept[k]), n);
                (0..D).for_each(|a| fields[sum + a][at] = kept[a] + along * n[a]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::contact_constraint::tests::constraint;
    use super::*;

    #[test]
    fn the_jump_is_recorded_on_request() {
        let mut patch = PatchContact { constraints: vec![constraint([1.0])], ..Default::default() };
        let mut fields = vec![vec![0.0, 4.0, 0.0, 0.0, 0.0]];
        patch.join(&mut fields, None);
        assert_eq!((fields[0][1], fields[0][4]), (1.0, 1.0));
        assert_eq!(patch.constraints[0].given, [[0.0]; 2]);
        fields[0][4] = 5.0;
        patch.join(&mut fields, Some(ConstraintJump::Force));
        assert_eq!(patch.constraints[0].given, [[0.0], [6.0]]);
    }
}
