//! Inertia in a grid that accelerates with a piston: -m a of each row onto the nodes, a the mean
//! acceleration of the frame over the step.
//!
//! A uniform force, given to the nodes as a body force is. What it takes of the energy seen from the
//! grid is booked row by row, with the nodal velocity with which the change of kinetic energy is
//! counted, so that the books of the scene ([`crate::scene::moving_frame`]) close to rounding.
//!
//! Before the piston inertia stands against the gradient of the pressure that moves the material,
//! dp/dx = -rho a, and where a changes the velocity bends, d2u/dx2 = (da/dt)/c^2. Images in the
//! piston have the same pressure and the opposite inertia and velocity: bends that a cell does not
//! resolve. They leave an error of first order in the few cells beside the piston, some hundredths
//! of rho a h, and of order 1.5 in L2; away from it order is second.

use super::{MOST_NODES, Stepper, with_width};
use crate::scene::Stepping;
use crate::solver::patch::{Given, Patch};

impl<const D: usize> Stepper<D> {
    /// -m a of the own rows in a step of `dt` from `time` [s], into its columns.
    pub(super) fn find_inertia(&self, patch: &mut Patch<D>, time: f64, dt: f64) {
        let (Some(frame), Some(force)) = (&self.frame, self.columns.frame_force) else { return };
        let acceleration = frame.acceleration(time, dt);
        let n = patch.block.own();
        for (a, acceleration) in acceleration.into_iter().enumerate() {
            let mut out = std::mem::take(&mut patch.block.columns[force + a]);
            let mass = &patch.block.columns[self.columns.mass][..n];
            out.clear();
            out.extend(mass.iter().map(|m| -m * acceleration));
            patch.block.columns[force + a] = out;
        }
    }

    /// Adds it to the nodes.
    pub(super) fn scatter_inertia(&self, patch: &mut Patch<D>) {
        if let Some(force) = self.columns.frame_force {
            self.scatter_force(patch, force);
        }
    }

    /// Books the work of a step of `dt` from `time` of the own rows. With a body force beside it,
    /// that one's work as the grid travels goes from these books to its own.
    pub(super) fn book_inertia(&self, patch: &mut Patch<D>, time: f64, dt: f64) {
        fn go<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Stepper<D>,
            force: usize,
            grid: [f64; D],
            dt: f64,
        ) {
            let f = &s.fields;
            let fields = &patch.nodes.fields;
            for r in 0..patch.block.own() {
                let row = patch.stencils.row::<K, D>(r);
                let mut work = 0.0;
                for a in 0..D {
                    let of = |field: usize| row.dot(row.values, &fields[field + a]);
                    let velocity = match s.compatible {
                        true => of(f.work),
                        false => 0.5 * (of(f.velocity) + of(f.velocity_star)),
                    };
                    work += dt * patch.block.columns[force + a][r] * velocity;
                }
                if let Some(c) = &s.columns.body_force {
                    let pull = |a: usize| patch.block.columns[c.force + a][r] * grid[a];
                    let travel = dt * (0..D).map(pull).sum::<f64>();
                    patch.block.columns[c.work][r] += travel;
                    work -= travel;
                }
                patch.given.push(Given { work, impulse: [0.0; D] });
            }
        }
        let (Some(frame), Some(force)) = (&self.frame, self.columns.frame_force) else { return };
        let (from, to) = (frame.velocity(time), frame.velocity(time + dt));
        let grid = std::array::from_fn(|a| 0.5 * (from[a] + to[a]));
        with_width!(patch.stencils.width, go(patch, self, force, grid, dt));
    }

    /// The middle of a step of `dt` whose forces are those at `time` [s].
    fn middle(&self, time: f64, dt: f64) -> f64 {
        match self.stepping {
            Stepping::Midpoint => time,
            Stepping::Leapfrog => time + 0.5 * dt,
        }
    }

    /// The velocity that the grid has gained from the start to the middle of a step of `dt` [m/s],
    /// whose forces are those at `time`.
    pub(super) fn gained_velocity(&self, time: f64, dt: f64) -> [f64; D] {
        let Some(frame) = &self.frame else { return [0.0; D] };
        let (now, start) = (frame.velocity(self.middle(time, dt)), frame.velocity(0.0));
        std::array::from_fn(|a| now[a] - start[a])
    }
}
