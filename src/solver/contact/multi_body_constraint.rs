//! Nodes at which several pairs of bodies are in contact at once.
//!
//! Each pair constrains the velocities at the node by (v_a - v_b).n = 0. The constraints are made orthogonal one after another (Gram-Schmidt in the
//! scalar product of 1/m) and projected out in turn, which together is the projection onto the
//! velocities that satisfy all of them. A constraint that follows from the others is left out.

use std::ops::Range;

use smallvec::{SmallVec, smallvec};

use super::contact_constraint::{ConstraintJump, ContactConstraint};
use super::vectors::dot;

/// Components of all velocities at a node.
type Values = SmallVec<[f64; 8]>;

/// Constraint c, made orthogonal to the previous ones.
#[derive(Clone, Debug)]
struct ConstraintRow<const D: usize> {
    /// Index of the constraint, relative to the first one of the node, and constrained direction.
    constraint: usize,
    direction: [f64; D],
    c: Values,
    /// 1/(c D^-1 c).
    inverse: f64,
    /// Coefficient of each previous row that was subtracted.
    taken: Values,
}

/// Node at which several pairs are in contact.
#[derive(Clone, Debug)]
pub struct MultiBodyConstraint<const D: usize> {
    constraints: Range<usize>,
    places: SmallVec<[usize; 4]>,
    masses: SmallVec<[f64; 4]>,
    rows: Vec<ConstraintRow<D>>,
}

/// Fraction of its length that a constraint must keep to count as independent.
const INDEPENDENT: f64 = 1e-6;

impl<const D: usize> MultiBodyConstraint<D> {
    /// Constraint of `constraints`, which start at index `first`.
    pub fn new(first: usize, constraints: &[ContactConstraint<D>]) -> Self {
        let mut group = MultiBodyConstraint {
            constraints: first..first + constraints.len(),
            places: SmallVec::new(),
            masses: SmallVec::new(),
            rows: Vec::new(),
        };
        for constraint in constraints {
            for (at, mass) in constraint.at.into_iter().zip(constraint.mass) {
                if !group.places.contains(&at) {
                    group.places.push(at);
                    group.masses.push(mass);
                }
            }
        }
        for (k, constraint) in constraints.iter().enumerate() {
            group.add(k, constraint, constraint.normal);
        }
        group
    }

    /// Indices of its constraints.
    pub fn constraints(&self) -> Range<usize> {
        self.constraints.clone()
    }

    /// Indices of the node in the layers of the constraints.
    pub fn places(&self) -> &[usize] {
        &self.places
    }

    fn product(&self, a: &[f64], b: &[f64]) -> f64 {
        let mass = |i: usize| self.masses[i / D];
        (0..a.len()).map(|i| a[i] * b[i] / mass(i)).sum()
    }

    fn add(&mut self, k: usize, constraint: &ContactConstraint<D>, direction: [f64; D]) {
        let mut c: Values = smallvec![0.0; D * self.places.len()];
        for (at, sign) in constraint.at.into_iter().zip([1.0, -1.0]) {
            let place = self.places.iter().position(|&p| p == at).expect("it was added");
            (0..D).for_each(|a| c[D * place + a] = sign * direction[a]);
        }
        let whole = self.product(&c, &c);
        let mut taken = Values::new();
        for row in &self.rows {
            let share = self.product(&c, &row.c) * row.inverse;
            c.iter_mut().zip(&row.c).for_each(|(c, other)| *c -= share * other);
            taken.push(share);
        }
        let left = self.product(&c, &c);
        if left > INDEPENDENT * INDEPENDENT * whole {
            self.rows.push(ConstraintRow {
                constraint: k,
                direction,
                c,
                inverse: 1.0 / left,
                taken,
            });
        }
    }

    /// Projects a vector with components in `fields` [m/s or m/s2], and adds the jumps of the
    /// constraints to their account.
    pub fn join(
        &self,
        fields: &mut [Vec<f64>],
        constraints: &mut [ContactConstraint<D>],
        jump_of: Option<ConstraintJump>,
    ) {
        let place = |i: usize| (i % D, self.places[i / D]);
        let mut values: Values = (0..D * self.places.len())
            .map(|i| {
                let (a, at) = place(i);
                fields[a][at]
            })
            .collect();
        let mut given = Values::new();
        for row in &self.rows {
            let jump = -row.inverse * row.c.iter().zip(&values).map(|(c, v)| c * v).sum::<f64>();
            for (i, value) in values.iter_mut().enumerate() {
                *value += jump * row.c[i] / self.masses[i / D];
            }
            given.push(jump);
        }
        for (i, value) in values.iter().enumerate() {
            let (a, at) = place(i);
            fields[a][at] = *value;
        }
        let Some(jump_of) = jump_of else { return };
        // from the orthogonal rows back to the original constraints
        for k in (0..self.rows.len()).rev() {
            let ConstraintRow { constraint, direction, taken, .. } = &self.rows[k];
            let share = given[k];
            taken.iter().zip(&mut given).for_each(|(t, g)| *g -= share * t);
            let sum = &mut constraints[*constraint].given[jump_of as usize];
            (0..D).for_each(|a| sum[a] += share * direction[a]);
        }
        debug_assert!(constraints.iter().all(|j| dot(&j.normal, &j.normal) > 0.5));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn constraint<const D: usize>(
        at: [usize; 2],
        mass: [f64; 2],
        normal: [f64; D],
    ) -> ContactConstraint<D> {
        let (low, given, friction) = ([false; 2], [[0.0; D]; 2], [0.0; D]);
        ContactConstraint { at, mass, normal, low, share: 1.0, given, friction }
    }

    #[test]
    fn three_bodies_in_a_row_become_one() {
        let mut constraints =
            [constraint([0, 1], [1.0, 2.0], [1.0]), constraint([1, 2], [2.0, 5.0], [1.0])];
        let group = MultiBodyConstraint::new(0, &constraints);
        let mut fields = vec![vec![8.0, 4.0, 0.0]];
        group.join(&mut fields, &mut constraints, Some(ConstraintJump::Velocity));
        assert!(fields[0].iter().all(|v| (v - 2.0).abs() < 1e-14), "{fields:?}");
        // the second body gives the first -6, the third gives the second -10
        assert!((constraints[0].given[0][0] + 6.0).abs() < 1e-13);
        assert!((constraints[1].given[0][0] + 10.0).abs() < 1e-13);
    }

    #[test]
    fn a_third_pair_that_says_no_more_is_left_out() {
        let mass = [1.0, 2.0, 4.0];
        let pair = |a: usize, b: usize| constraint([a, b], [mass[a], mass[b]], [1.0]);
        let group = MultiBodyConstraint::new(0, &[pair(0, 1), pair(1, 2), pair(0, 2)]);
        assert_eq!(group.rows.len(), 2);
    }

    #[test]
    fn each_normal_holds_its_pair_and_momentum_stays() {
        let normals = [[0.6, 0.8], [-0.8, 0.6]];
        let mut constraints = [
            constraint([0, 1], [1.0, 2.0], normals[0]),
            constraint([1, 2], [2.0, 4.0], normals[1]),
        ];
        let group = MultiBodyConstraint::new(0, &constraints);
        let mut fields = vec![vec![1.0, -2.0, 3.0], vec![0.5, 4.0, -1.0]];
        let momentum = |f: &[f64]| f[0] + 2.0 * f[1] + 4.0 * f[2];
        let before = [momentum(&fields[0]), momentum(&fields[1])];
        group.join(&mut fields, &mut constraints, None);
        let apart = |i: usize, j: usize, n: [f64; 2]| {
            n[0] * (fields[0][i] - fields[0][j]) + n[1] * (fields[1][i] - fields[1][j])
        };
        assert!(apart(0, 1, normals[0]).abs() < 1e-14);
        assert!(apart(1, 2, normals[1]).abs() < 1e-14);
        assert!(apart(0, 1, [-0.8, 0.6]).abs() > 0.1, "they slide");
        for a in 0..2 {
            assert!((momentum(&fields[a]) - before[a]).abs() < 1e-14);
        }
    }
}
