//! Programmed burn: arrival time of the detonation front and burnt fraction of the explosive.
//!
//! ```text
//! t_l = start + (distance from the nearest point, or from the plane)/D
//! F = (t - t_l) D/width, within 0 and 1
//! ```
//!
//! Source: Wilkins (1999), Computer Simulation of Dynamic Phenomena, section 5. Distances are taken
//! between initial positions; the front travels in straight lines, through any material in between.
//! F is the history variable of the equation of state.

use crate::scene::{BurnFront, CheckedScene, Eos};
use crate::solver::declare::{Declare, Role};
use crate::solver::effect::{Effect, NewParticle, Package, Phase, Setup, StepContext};
use crate::solver::particle_update::bodies;
use crate::solver::patch::Patch;

/// Burn of explosives by a detonation front.
pub struct ProgrammedBurn {
    /// Burn parameters of each body; none if it does not burn.
    bodies: Vec<Option<Explosive>>,
    /// Arrival time of the front at the particle [s]; -1 if the particle does not burn.
    lighting_time: usize,
    /// Burnt fraction F [-].
    fraction: usize,
}

/// Burn parameters of a body.
struct Explosive {
    /// Time in which the front passes a point [s].
    duration: f64,
    /// 1/(1 - V_CJ), if compression burns the explosive too.
    by_compression: Option<f64>,
}

fn burns(scene: &CheckedScene, body: usize) -> bool {
    FrontTimes::of(&scene.material_of(body).eos).is_some()
}

impl Package for ProgrammedBurn {
    const NAME: &'static str = "burn";

    fn is_active(scene: &CheckedScene) -> bool {
        (0..scene.bodies.len()).any(|body| burns(scene, body))
    }

    fn declare(scene: &CheckedScene, d: &mut Declare<'_>) {
        let lighting_time = d.scalar("lighting_time", "s", Role::State);
        let fraction = d.scalar("burn_fraction", "", Role::State);
        for body in (0..scene.bodies.len()).filter(|&body| burns(scene, body)) {
            d.history(body, fraction);
        }
        d.burn(fraction, lighting_time);
        d.output("burn_fraction", "-", "burn_fraction");
    }

    fn build<const D: usize>(setup: &mut Setup<'_, D>) -> Box<dyn Effect<D>> {
        let of = |body: usize| {
            let material = setup.scene.material_of(body);
            let front = material.eos.burn()?.front()?;
            let products = material.eos.products(material.density)?;
            let compression = || 1.0 / (1.0 - products.detonation().jacobian);
            Some(Explosive {
                duration: front.width / front.detonation_velocity,
                by_compression: front.compression.then(compression),
            })
        };
        Box::new(ProgrammedBurn {
            bodies: (0..setup.scene.bodies.len()).map(of).collect(),
            lighting_time: setup.columns.get("lighting_time"),
            fraction: setup.columns.get("burn_fraction"),
        })
    }
}

impl<const D: usize> Effect<D> for ProgrammedBurn {
    fn phases(&self) -> &'static [Phase] {
        &[Phase::MidState, Phase::EndState]
    }

    fn act(&self, phase: Phase, step: &StepContext<'_, D>, patch: &mut Patch<D>) {
        match phase {
            Phase::MidState => self.burn(step, patch, step.time, step.jacobian),
            _ => {
                let jacobian = step.scheme.columns.jacobian;
                self.burn(step, patch, step.start + step.dt, jacobian);
            }
        }
    }

    fn initialize(&self, particle: &NewParticle<'_, D>, values: &mut [f64]) {
        let front = FrontTimes::of(&particle.scene.material_of(particle.body).eos);
        values[self.lighting_time] = front.map_or(-1.0, |f| f.lighting_time(&particle.centre));
    }

    fn changes_particles_at_rest(&self) -> bool {
        true
    }

    fn may_act(&self, patch: &Patch<D>, r: usize) -> bool {
        let column = |k: usize| patch.block.columns[k][r];
        column(self.lighting_time) >= 0.0 && column(self.fraction) < 1.0
    }
}

impl ProgrammedBurn {
    /// Burnt fraction of the own particles at `time` [s] and at the volume ratio in column
    /// `jacobian`; it never decreases.
    fn burn<const D: usize>(
        &self,
        step: &StepContext<'_, D>,
        patch: &mut Patch<D>,
        time: f64,
        jacobian: usize,
    ) {
        let n = patch.block.own();
        let mut fraction = std::mem::take(&mut patch.block.columns[self.fraction]);
        let column = |k: usize| &patch.block.columns[k][..n];
        let (lit, j) = (column(self.lighting_time), column(jacobian));
        for (body, particles) in bodies(column(step.scheme.columns.body)) {
            let Some(explosive) = &self.bodies[body] else { continue };
            for r in particles {
                let mut now = burnt(time, lit[r], explosive.duration);
                if let Some(scale) = explosive.by_compression {
                    now = now.max(((1.0 - j[r]) * scale).min(1.0));
                }
                fraction[r] = fraction[r].max(now);
            }
        }
        patch.block.columns[self.fraction] = fraction;
    }
}

/// Arrival times of a detonation front.
#[derive(Clone, Debug)]
struct FrontTimes<'a>(&'a BurnFront);

impl<'a> FrontTimes<'a> {
    /// Front of an explosive; none for other materials, or if all of it is burnt at the start.
    fn of(eos: &'a Eos) -> Option<Self> {
        eos.burn()?.front().map(FrontTimes)
    }

    /// Arrival time of the front at the position `x` [s].
    fn lighting_time(&self, x: &[f64]) -> f64 {
        let norm = |v: &mut dyn Iterator<Item = f64>| v.map(|d| d * d).sum::<f64>().sqrt();
        let apart = |p: &[f64]| norm(&mut x.iter().zip(p).map(|(x, p)| x - p));
        let distance = match (&self.0.plane, &self.0.points) {
            (Some(plane), _) => {
                let along = x.iter().zip(&plane.point).zip(&plane.normal);
                let along: f64 = along.map(|((x, p), n)| (x - p) * n).sum();
                along.abs() / norm(&mut plane.normal.iter().copied())
            }
            (None, points) => {
                let points = points.iter().flatten();
                points.map(|p| apart(p)).fold(f64::INFINITY, f64::min)
            }
        };
        self.0.start + distance / self.0.detonation_velocity
    }
}

/// Burnt fraction at `time` after lighting at `lighting_time` [s]; the front passes a point in
/// `duration` [s].
#[inline(always)]
fn burnt(time: f64, lighting_time: f64, duration: f64) -> f64 {
    ((time - lighting_time) / duration).clamp(0.0, 1.0)
}

#[cfg(test)]
#[path = "tests/burn.rs"]
mod tests;
