//! Inertial force in a grid that accelerates with a piston: -m a per particle, added to the nodes;
//! a is the mean acceleration of the frame over the step.
//!
//! The force is uniform and is applied like a body force. Its work in the frame of the grid is
//! summed per particle with the same nodal velocity as the change of kinetic energy, so that the
//! energy in the frame of the scene ([`crate::scene::moving_frame`]) closes to rounding.
//!
//! In front of the piston, inertia balances the pressure gradient that accelerates the material,
//! dp/dx = -rho a. Where a changes in time, the velocity profile is curved, d2u/dx2 = (da/dt)/c^2.
//! Image particles in the piston have the same pressure but the opposite inertia and velocity, so
//! both profiles have a kink at the piston that a cell does not resolve. The kinks leave a
//! first-order error in the few cells next to the piston, some hundredths of rho a h, and an error
//! of order 1.5 in L2; away from the piston the order is 2.

use crate::scene::CheckedScene;
use crate::scene::moving_frame::Frame;
use crate::shape::with_width;
use crate::solver::Scheme;
use crate::solver::declare::{Declare, Role};
use crate::solver::effect::{Effect, Package, Phase, Setup, StepContext};
use crate::solver::patch::{BoundaryWork, Patch};

/// Inertia of a grid that accelerates.
pub struct AcceleratedGrid<const D: usize> {
    frame: Frame<D>,
    /// Inertial force [N], a vector.
    force: usize,
    /// Column of the other external forces [N] and column of their work [J]. The second one also
    /// receives the work of these forces over the travel of the grid.
    others: Option<(usize, usize)>,
}

/// Builder of [`AcceleratedGrid`] in the effect registry.
pub struct Inertia;

impl Package for Inertia {
    const NAME: &'static str = "accelerated grid";

    fn is_active(scene: &CheckedScene) -> bool {
        scene.accelerates()
    }

    fn declare(_: &CheckedScene, d: &mut Declare<'_>) {
        let names = ["frame_force", "frame_force_x", "frame_force_y"];
        let force = d.vector(names, "N", Role::GhostScratch);
        d.external_force(force);
    }

    fn build<const D: usize>(setup: &mut Setup<'_, D>) -> Box<dyn Effect<D>> {
        let columns = setup.columns;
        let force = columns.get(if D == 1 { "frame_force" } else { "frame_force_x" });
        let other = columns.forces.iter().copied().find(|&other| other != force);
        Box::new(AcceleratedGrid::<D> {
            frame: setup.scene.frame(),
            force,
            others: other.zip(columns.external_work),
        })
    }
}

impl<const D: usize> Effect<D> for AcceleratedGrid<D> {
    fn phases(&self) -> &'static [Phase] {
        &[Phase::ParticleForce, Phase::Gathered]
    }

    fn act(&self, phase: Phase, step: &StepContext<'_, D>, patch: &mut Patch<D>) {
        match phase {
            Phase::ParticleForce => self.find_force(step, patch),
            _ => self.accumulate(step, patch),
        }
    }
}

impl<const D: usize> AcceleratedGrid<D> {
    /// Inertial force -m a of the own particles.
    fn find_force(&self, step: &StepContext<'_, D>, patch: &mut Patch<D>) {
        let n = patch.block.own();
        let acceleration = self.frame.acceleration(step.start, step.dt);
        for (a, acceleration) in acceleration.into_iter().enumerate() {
            let mut out = std::mem::take(&mut patch.block.columns[self.force + a]);
            let mass = &patch.block.columns[step.scheme.columns.mass][..n];
            out.clear();
            out.extend(mass.iter().map(|m| -m * acceleration));
            patch.block.columns[self.force + a] = out;
        }
    }

    /// Work of the step on the own particles. With another external force, the work of that force
    /// over the travel of the grid moves from this account to the account of that force.
    fn accumulate(&self, step: &StepContext<'_, D>, patch: &mut Patch<D>) {
        fn go<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Scheme<D>,
            e: &AcceleratedGrid<D>,
            grid: [f64; D],
            dt: f64,
        ) {
            let f = &s.fields;
            let fields = &patch.nodes.fields;
            for r in 0..patch.block.own() {
                let weights = patch.stencils.particle::<K, D>(r);
                let mut work = 0.0;
                for a in 0..D {
                    let of = |field: usize| weights.dot(weights.values, &fields[field + a]);
                    let velocity = match s.compatible {
                        true => of(f.work),
                        false => 0.5 * (of(f.velocity) + of(f.velocity_star)),
                    };
                    work += dt * patch.block.columns[e.force + a][r] * velocity;
                }
                if let Some((other, account)) = e.others {
                    let pull = |a: usize| patch.block.columns[other + a][r] * grid[a];
                    let travel = dt * (0..D).map(pull).sum::<f64>();
                    patch.block.columns[account][r] += travel;
                    work -= travel;
                }
                patch.boundary_work.push(BoundaryWork { work, impulse: [0.0; D] });
            }
        }
        let (from, to) =
            (self.frame.velocity(step.start), self.frame.velocity(step.start + step.dt));
        let grid = std::array::from_fn(|a| 0.5 * (from[a] + to[a]));
        with_width!(patch.stencils.width, go(patch, step.scheme, self, grid, step.dt));
    }
}

#[cfg(test)]
#[path = "tests/accelerated_grid.rs"]
mod tests;
