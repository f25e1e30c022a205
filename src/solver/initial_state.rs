//! Initial state of bodies: energy, impedance and contact impulse.

use super::scheme::Scheme;
use crate::material::constitutive;
use crate::scene::CheckedScene;

impl<const D: usize> Scheme<D> {
    /// Initial specific internal energy of `body` at `pressure` [J/kg]. If a `temperature` [K] is
    /// given, the energy follows from the temperature.
    pub fn starting_energy(&self, body: usize, pressure: f64, temperature: Option<f64>) -> f64 {
        match (temperature, &self.thermals[body]) {
            (Some(t), Some(thermal)) if thermal.isentrope.is_some() => thermal.energy_at(t),
            _ => self.models[body].energy_at(pressure),
        }
    }

    /// Lowest admissible specific internal energy for particles of each body [J/kg]: the part of
    /// the initial energy that adiabatic flow cannot convert, or the energy at absolute zero if the
    /// body conducts heat.
    pub fn least_energies(&self, scene: &CheckedScene) -> Vec<f64> {
        let bodies = scene.scene.bodies.iter().zip(&self.models).enumerate();
        bodies
            .map(|(i, (body, model))| {
                let density = scene.scene.materials[&body.material].density;
                let start = self.starting_energy(i, body.pressure, body.temperature);
                let least = constitutive::least_energy(model, density, start);
                match &self.thermals[i] {
                    Some(thermal) if self.conducts_heat(i) => least.min(thermal.energy_at(0.0)),
                    _ => least,
                }
            })
            .collect()
    }

    /// Initial acoustic impedance rho c of `body` [Pa s/m].
    pub fn impedance(&self, body: usize) -> f64 {
        self.impedances[body]
    }

    /// Initial speed of the fastest waves in `body` [m/s].
    pub fn sound_speed_at_start(&self, scene: &CheckedScene, body: usize) -> f64 {
        self.impedances[body] / scene.material_of(body).density
    }

    /// Longest stable step of `body` in its initial state at a Courant number of 1 [s], on a grid that
    /// moves at `grid_velocity` [m/s]. The velocity gradient where bodies meet is left out: with
    /// artificial viscosity it shortens the first step.
    pub fn starting_step(&self, scene: &CheckedScene, body: usize, grid_velocity: [f64; D]) -> f64 {
        let checked = &scene.bodies[body];
        let speed = self.sound_speed_at_start(scene, body);
        let added = self.viscosity.map_or(0.0, |q| q.speed(speed, 0.0, 1.0));
        let rate = |a: usize| {
            let velocity = match checked.motion {
                Some(_) => checked.top_speed + grid_velocity[a].abs(),
                None => (checked.velocity[a] - grid_velocity[a]).abs(),
            };
            (speed + velocity + added) / self.cell[a]
        };
        let fastest = (0..D).map(rate).fold(0.0, f64::max);
        self.of_effects.diffusion_step.min(1.0 / fastest)
    }

    /// Whether heat conduction acts on `body`.
    pub fn conducts_heat(&self, body: usize) -> bool {
        self.thermals[body].as_ref().is_some_and(|thermal| thermal.conductivity.is_some())
    }

    /// Initial contact impulse of `body` at the initial `pressure` [Pa s].
    pub fn starting_impulse(&self, body: usize, pressure: f64) -> f64 {
        if pressure > 0.0 { self.max_adhesion_impulse[body] } else { self.starting_pull(body) }
    }
}
