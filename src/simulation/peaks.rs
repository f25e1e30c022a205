//! Greatest values of a rank's particles against what the scene explains; see [`Peaks`].

use decomp::Block;

use super::Simulation;
use crate::material::constitutive;
use crate::scene::{CheckedScene, Eos, Side};
use crate::simulation::monitor::Peaks;
use crate::solver::Stepper;

/// Times that a front takes to pass a place, after which a particle is no longer at the front.
const FRONT_TIMES: f64 = 3.0;

/// What a body may come to.
#[derive(Clone, Debug)]
pub(super) struct Expected<const D: usize> {
    /// Specific internal energy of the start [J/kg].
    energy: f64,
    /// Energy that the strongest impact gives by one shock [J/kg]; infinite where gases,
    /// explosives or forces drive the bodies.
    heat: f64,
    front: Option<Front>,
    /// Velocity of the start [m/s].
    velocity: [f64; D],
}

/// What a burning front of a body brings.
#[derive(Clone, Copy, Debug)]
struct Front {
    /// Chapman-Jouguet pressure [Pa].
    pressure: f64,
    /// Chapman-Jouguet velocity of the products [m/s].
    velocity: f64,
    /// Time in which the front passes a place [s].
    duration: f64,
}

impl<const D: usize> Expected<D> {
    /// That of each body of a scene.
    pub(super) fn of(scene: &CheckedScene, stepper: &Stepper<D>) -> Vec<Expected<D>> {
        let bodies = scene.scene.bodies.iter().enumerate();
        bodies
            .map(|(i, body)| Expected {
                energy: stepper.starting_energy(i, body.pressure, body.temperature),
                heat: shock_heat(scene, stepper, i),
                front: front(scene, i),
                velocity: std::array::from_fn(|a| scene.bodies[i].velocity[a]),
            })
            .collect()
    }
}

/// Energy that one shock of the strongest impact on body `i` gives, up^2/2 [J/kg], with up from
/// the acoustic impedances at rest.
fn shock_heat<const D: usize>(scene: &CheckedScene, stepper: &Stepper<D>, i: usize) -> f64 {
    let driven = |eos: &Eos| {
        matches!(eos, Eos::IdealGas { .. } | Eos::StiffenedGas { .. } | Eos::Jwl { .. })
    };
    let count = scene.bodies.len();
    let moved = scene.bodies.iter().any(|b| b.motion.is_some());
    if moved
        || scene.scene.body_force.is_some()
        || (0..count).any(|k| driven(&scene.material_of(k).eos))
    {
        return f64::INFINITY;
    }
    let velocity = |k: usize| -> [f64; D] { std::array::from_fn(|a| scene.bodies[k].velocity[a]) };
    let apart = |a: [f64; D], b: [f64; D]| {
        (0..D).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum::<f64>().sqrt()
    };
    let others = (0..count).filter(|k| *k != i).map(|k| {
        let [own, other] = [stepper.impedance(i), stepper.impedance(k)];
        apart(velocity(i), velocity(k)) * other / (own + other)
    });
    let sides = scene.sides::<D>();
    let extremes = scene.frame::<D>().extremes();
    // a wall stops what moves across it alone
    let rigid = (0..D).filter(|&a| sides[a].iter().any(|s| s.rigid_velocity().is_some()));
    let walls = rigid.flat_map(|a| extremes.map(|wall| (velocity(i)[a] - wall[a]).abs()));
    let loads = sides.as_flattened().iter().filter_map(|side| match side {
        Side::Pressure(load) => Some(load.range()[1].max(0.0) / stepper.impedance(i)),
        _ => None,
    });
    let up = others.chain(walls).chain(loads).fold(0.0, f64::max);
    // bodies at rest without an impact explain no heat, and none is expected
    if up > 0.0 { 0.5 * up * up } else { f64::INFINITY }
}

fn front(scene: &CheckedScene, i: usize) -> Option<Front> {
    let material = scene.material_of(i);
    let named = material.eos.burn()?.front()?;
    let detonation = constitutive::products(&material.eos, material.density)?.detonation();
    Some(Front {
        pressure: detonation.pressure,
        velocity: (1.0 - detonation.jacobian) * detonation.speed,
        duration: named.width / named.detonation_velocity,
    })
}

impl<const D: usize> Simulation<'_, D> {
    /// Takes note of the greatest values of all particles. Collective.
    pub(super) fn note_peaks(&mut self) {
        let mut peaks = Peaks::default();
        for block in self.patches.iter().map(|p| &p.block) {
            for r in 0..block.own() {
                peaks = peaks.max(&self.peaks_of(block, r));
            }
        }
        let mut values = peaks.values().map(|value| -value);
        self.comm.min(&mut values);
        self.peaks = self.peaks.max(&Peaks::of(values.map(|value| -value)));
    }

    fn peaks_of(&self, block: &Block<D>, r: usize) -> Peaks {
        let c = &self.stepper.columns;
        let column = |k: usize| block.columns[k][r];
        let expected = &self.expected[column(c.body) as usize];
        let energy = column(c.energy) - expected.energy;
        let mut peaks = Peaks {
            heat: energy / expected.heat,
            energy: if expected.heat.is_finite() { energy } else { 0.0 },
            ..Peaks::default()
        };
        if let (Some(front), Some(burn)) = (expected.front, c.burn) {
            let since = self.time - column(burn.lighting_time);
            let grid = self.frame.velocity(self.time);
            if column(burn.fraction) == 0.0 {
                let v = |a: usize| column(c.velocity + a) + grid[a] - expected.velocity[a];
                let speed = (0..D).map(|a| v(a) * v(a)).sum::<f64>().sqrt();
                peaks.ahead = speed / front.velocity;
            } else if (0.0..FRONT_TIMES * front.duration).contains(&since) {
                peaks.front = column(c.pressure) / front.pressure;
            }
        }
        if let Some(thermal) = c.thermal {
            peaks.frozen = -column(thermal.temperature);
        }
        peaks
    }

    /// Greatest values so far; alike on all ranks.
    pub fn peaks(&self) -> &Peaks {
        &self.peaks
    }
}
