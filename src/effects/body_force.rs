//! Body forces: m b of each particle, added to the nodes as f_i += sum m b N_i, with their work and
//! impulse.
//!
//! Each particle accumulates the work dt m b.(N w) and the impulse dt m b of every step. w is the
//! nodal velocity that also gives the change of kinetic energy, so that energy and momentum close
//! to rounding.

use decomp::Block;

use crate::exact::plane::Vortex;
use crate::scene::{self, CheckedScene};
use crate::shape::with_width;
use crate::solver::Scheme;
use crate::solver::declare::{Declare, Role};
use crate::solver::effect::{Account, Effect, Package, Phase, Setup, StepContext};
use crate::solver::patch::Patch;

/// Gravity, or the body force of a manufactured solution.
pub struct BodyForceEffect {
    acceleration: Acceleration,
    /// Force m b at the time of the forces [N], a vector.
    force: usize,
    /// Accumulated work [J].
    work: usize,
    /// Accumulated impulse [N s], a vector.
    impulse: usize,
    /// Initial position [m], a vector, if the force depends on it.
    initial_position: Option<usize>,
    /// Whether the grid accelerates: the work is then counted in the frame of the scene.
    grid_accelerates: bool,
}

enum Acceleration {
    /// Uniform gravity [m/s2].
    Gravity([f64; 2]),
    /// Body force of the generalized vortex, one per body.
    Vortex(Vec<Vortex>),
}

impl Acceleration {
    fn new(scene: &CheckedScene) -> Option<Self> {
        Some(match scene.scene.body_force.as_ref()? {
            scene::BodyForce::Gravity(g) => {
                Acceleration::Gravity(std::array::from_fn(|a| g.get(a).copied().unwrap_or(0.0)))
            }
            scene::BodyForce::Vortex(ring) => {
                let bodies = 0..scene.bodies.len();
                let of = |i| scene::motion::vortex_of(ring, scene.material_of(i));
                let all = bodies.map(of).collect::<Option<_>>();
                Acceleration::Vortex(all.expect("the check has seen"))
            }
        })
    }
}

impl Package for BodyForceEffect {
    const NAME: &'static str = "body force";

    fn is_active(scene: &CheckedScene) -> bool {
        scene.scene.body_force.is_some()
    }

    fn declare(scene: &CheckedScene, d: &mut Declare<'_>) {
        let names = ["body_force", "body_force_x", "body_force_y"];
        let force = d.vector(names, "N", Role::GhostScratch);
        d.external_force(force);
        d.zero_at_rest_vector(force);
        let work = d.scalar("body_force_work", "J", Role::State);
        d.external_work(work);
        let names = ["body_force_impulse", "body_force_impulse_x", "body_force_impulse_y"];
        d.vector(names, "N s", Role::State);
        if matches!(scene.scene.body_force, Some(scene::BodyForce::Vortex(_))) {
            d.initial_position();
        }
    }

    fn build<const D: usize>(setup: &mut Setup<'_, D>) -> Box<dyn Effect<D>> {
        let columns = setup.columns;
        let [force, impulse] = match D {
            1 => ["body_force", "body_force_impulse"],
            _ => ["body_force_x", "body_force_impulse_x"],
        };
        Box::new(BodyForceEffect {
            acceleration: Acceleration::new(setup.scene).expect("the effect is active"),
            force: columns.get(force),
            work: columns.get("body_force_work"),
            impulse: columns.get(impulse),
            initial_position: columns.initial_position,
            grid_accelerates: setup.scene.accelerates(),
        })
    }
}

impl<const D: usize> Effect<D> for BodyForceEffect {
    fn phases(&self) -> &'static [Phase] {
        &[Phase::ParticleForce, Phase::Gathered]
    }

    fn act(&self, phase: Phase, step: &StepContext<'_, D>, patch: &mut Patch<D>) {
        match phase {
            Phase::ParticleForce => self.find_force(step, patch),
            _ => self.accumulate(step, patch),
        }
    }

    fn totals(
        &self,
        block: &Block<D>,
        particles: std::ops::Range<usize>,
        grid: [f64; D],
        add: &mut dyn FnMut(Account, &[f64]),
    ) {
        let column = |k: usize| &block.columns[k][particles.clone()];
        let (work, impulse) = (column(self.work), |a: usize| column(self.impulse + a));
        // in the frame of the scene the travel of the grid does work too; in an accelerating grid
        // the column already contains it
        let travel = |a: usize, r: usize| match self.grid_accelerates {
            true => 0.0,
            false => impulse(a)[r] * grid[a],
        };
        let total = |r: usize| work[r] + (0..D).map(|a| travel(a, r)).sum::<f64>();
        let totals: smallvec::SmallVec<[f64; 128]> = (0..work.len()).map(total).collect();
        add(Account::ExternalWork, &totals);
        (0..D).for_each(|a| add(Account::ExternalImpulse(a), impulse(a)));
    }
}

impl BodyForceEffect {
    /// Force m b of the own particles.
    fn find_force<const D: usize>(&self, step: &StepContext<'_, D>, patch: &mut Patch<D>) {
        let c = &step.scheme.columns;
        let n = patch.block.own();
        let mut out: [Vec<f64>; D] =
            std::array::from_fn(|a| std::mem::take(&mut patch.block.columns[self.force + a]));
        out.iter_mut().for_each(|column| column.resize(n, 0.0));
        let column = |k: usize| &patch.block.columns[k][..n];
        let (mass, body) = (column(c.mass), column(c.body));
        match (&self.acceleration, self.initial_position) {
            (Acceleration::Vortex(vortices), Some(initial)) => {
                let (x, y) = (column(initial), column(initial + D - 1));
                for r in 0..n {
                    let b = vortices[body[r] as usize].body_force([x[r], y[r]], step.time);
                    (0..D).for_each(|a| out[a][r] = mass[r] * b[a]);
                }
            }
            (Acceleration::Gravity(g), _) => {
                for (out, g) in out.iter_mut().zip(g) {
                    (0..n).for_each(|r| out[r] = mass[r] * g);
                }
            }
            (Acceleration::Vortex(_), None) => unreachable!("the vortex has the column"),
        }
        for (a, out) in out.into_iter().enumerate() {
            patch.block.columns[self.force + a] = out;
        }
    }

    /// Adds the work and impulse of the step to the columns of the own particles.
    fn accumulate<const D: usize>(&self, step: &StepContext<'_, D>, patch: &mut Patch<D>) {
        fn go<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Scheme<D>,
            e: &BodyForceEffect,
            dt: f64,
        ) {
            let f = &s.fields;
            for a in 0..D {
                let (w, v) = (&patch.nodes.fields[f.work + a], &patch.nodes.fields[f.velocity + a]);
                let star = &patch.nodes.fields[f.velocity_star + a];
                let n = patch.block.own();
                let [force, work, impulse] =
                    patch.block.columns_mut([e.force + a, e.work, e.impulse + a]);
                for r in 0..n {
                    let weights = patch.stencils.particle::<K, D>(r);
                    let velocity = match s.compatible {
                        true => weights.dot(weights.values, w),
                        false => {
                            0.5 * (weights.dot(weights.values, v)
                                + weights.dot(weights.values, star))
                        }
                    };
                    work[r] += dt * force[r] * velocity;
                    impulse[r] += dt * force[r];
                }
            }
        }
        with_width!(patch.stencils.width, go(patch, step.scheme, self, step.dt));
    }
}

#[cfg(test)]
#[path = "tests/body_force.rs"]
mod tests;
