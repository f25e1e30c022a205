//! Body forces: m b of each row onto the nodes, f_i += sum m b N_i, and what they give the rows.
//!
//! A row books the work dt m b.(N w) and the impulse dt m b of each step, w the nodal velocity
//! with which the change of kinetic energy is counted, so that energy and momentum can be held
//! against them to rounding.

use super::{MOST_NODES, Stepper, with_width};
use crate::exact::plane::Vortex;
use crate::scene::{BodyForce, CheckedScene};
use crate::solver::particles::BodyForceColumns;
use crate::solver::patch::Patch;

/// A scene's body force.
pub(super) enum Force {
    /// The same everywhere [m/s2].
    Gravity([f64; 2]),
    /// That of the generalized vortex, one a body.
    Vortex(Vec<Vortex>),
}

impl Force {
    /// What `scene` chose.
    pub(super) fn new(scene: &CheckedScene) -> Option<Self> {
        Some(match scene.scene.body_force.as_ref()? {
            BodyForce::Gravity(g) => {
                Force::Gravity(std::array::from_fn(|a| g.get(a).copied().unwrap_or(0.0)))
            }
            BodyForce::Vortex(ring) => {
                let bodies = 0..scene.bodies.len();
                let of = |i| crate::scene::motion::vortex_of(ring, scene.material_of(i));
                Force::Vortex(bodies.map(of).collect::<Option<_>>().expect("the check has seen"))
            }
        })
    }
}

impl<const D: usize> Stepper<D> {
    /// m b of the own rows at `time` [s], into its columns.
    pub(super) fn find_body_force(&self, patch: &mut Patch<D>, time: f64) {
        let (Some(force), Some(c)) = (&self.body_force, &self.columns.body_force) else { return };
        let n = patch.block.own();
        let mut out: [Vec<f64>; D] =
            std::array::from_fn(|a| std::mem::take(&mut patch.block.columns[c.force + a]));
        out.iter_mut().for_each(|column| column.resize(n, 0.0));
        let column = |k: usize| &patch.block.columns[k][..n];
        let (mass, body) = (column(self.columns.mass), column(self.columns.body));
        match (force, c.reference) {
            (Force::Vortex(vortices), Some(reference)) => {
                let (x, y) = (column(reference), column(reference + D - 1));
                for r in 0..n {
                    let b = vortices[body[r] as usize].body_force([x[r], y[r]], time);
                    (0..D).for_each(|a| out[a][r] = mass[r] * b[a]);
                }
            }
            (Force::Gravity(g), _) => {
                for (out, g) in out.iter_mut().zip(g) {
                    (0..n).for_each(|r| out[r] = mass[r] * g);
                }
            }
            (Force::Vortex(_), None) => unreachable!("the vortex has the column"),
        }
        for (a, out) in out.into_iter().enumerate() {
            patch.block.columns[c.force + a] = out;
        }
    }

    /// The force of all rows onto the nodes.
    pub(super) fn scatter_body_force(&self, patch: &mut Patch<D>) {
        if let Some(c) = &self.columns.body_force {
            self.scatter_force(patch, c.force);
        }
    }

    /// The force in the columns from `from` on of all rows onto the nodes.
    pub(super) fn scatter_force(&self, patch: &mut Patch<D>, from: usize) {
        fn go<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Stepper<D>, from: usize) {
            for a in 0..D {
                let field = s.fields.acceleration + a;
                let mut nodal = std::mem::take(&mut patch.nodes.fields[field]);
                let force = &patch.block.columns[from + a];
                for r in patch.runs.iter().cloned().flatten() {
                    let row = patch.stencils.row::<K, D>(r);
                    row.add(&mut nodal, row.values, |n| n * force[r]);
                }
                patch.nodes.fields[field] = nodal;
            }
        }
        with_width!(patch.stencils.width, go(patch, self, from));
    }

    /// Books the work and impulse of a step of `dt` for the own rows.
    pub(super) fn book_body_force(&self, patch: &mut Patch<D>, dt: f64) {
        fn go<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Stepper<D>,
            c: &BodyForceColumns,
            dt: f64,
        ) {
            let f = &s.fields;
            for a in 0..D {
                let (w, v) = (&patch.nodes.fields[f.work + a], &patch.nodes.fields[f.velocity + a]);
                let star = &patch.nodes.fields[f.velocity_star + a];
                let n = patch.block.own();
                let [force, work, impulse] =
                    patch.block.columns_mut([c.force + a, c.work, c.impulse + a]);
                for r in 0..n {
                    let row = patch.stencils.row::<K, D>(r);
                    let velocity = match s.compatible {
                        true => row.dot(row.values, w),
                        false => 0.5 * (row.dot(row.values, v) + row.dot(row.values, star)),
                    };
                    work[r] += dt * force[r] * velocity;
                    impulse[r] += dt * force[r];
                }
            }
        }
        if let Some(c) = &self.columns.body_force {
            with_width!(patch.stencils.width, go(patch, self, c, dt));
        }
    }
}
