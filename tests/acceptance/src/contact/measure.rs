//! Runs in this process, step by step, and the motion of each body.

use decomp::Serial;
use flyer_mpm::input;
use flyer_mpm::simulation::Simulation;
use serde_json::Value;

/// Motion of a body.
#[derive(Clone, Copy, Debug, Default)]
pub struct Motion {
    /// Mass per depth [kg/m].
    pub mass: f64,
    /// Mean velocity [m/s].
    pub velocity: [f64; 2],
    /// Angular momentum about its centre per depth, with the spin of its particles [kg m/s].
    pub spin: f64,
}

/// Result of a run.
pub struct Measured {
    /// Motion of each body at the end.
    pub bodies: Vec<Motion>,
    /// Greatest magnitude of the pressure at the end [Pa].
    pub pressure: f64,
    /// Change of the total momentum without the impulse of sides and gravity, over the sum of the
    /// particles' magnitudes.
    pub momentum_drift: f64,
    /// Relative change of the total energy, without the work of sides and gravity.
    pub energy_drift: f64,
    /// Length of each step [s], normal and tangential contact force [N/m] in it.
    pub forces: Vec<[f64; 3]>,
}

/// Runs a scene in a plane.
///
/// # Errors
///
/// The message of a refused scene or of a failed run.
pub fn run(scene: &Value) -> Result<Measured, String> {
    let scene = input::parse(scene.to_string().as_bytes(), "scene.json", &[])
        .map_err(|error| error.to_string())?;
    let failed = |error: &dyn std::fmt::Display| error.to_string();
    let mut simulation = Simulation::<2>::new(&scene, &Serial, 1).map_err(|e| failed(&e))?;
    let start = simulation.totals();
    let mut forces = Vec::new();
    while simulation.time() < scene.scene.time.end {
        let before = simulation.time();
        simulation.advance(scene.scene.time.end).map_err(|e| failed(&e))?;
        let [normal, friction] = simulation.contact_force();
        forces.push([simulation.time() - before, normal, friction]);
    }
    let (end, given) = (simulation.totals(), simulation.given());
    let (table, _) = simulation.gather().ok_or("rank 0 gathers")?;
    let column = |name: &str| table.column(name).ok_or(format!("no column {name}"));
    let [density, volume] = [column("density")?, column("volume")?];
    let place = [column("x")?, column("y")?];
    let velocity = [column("velocity_x")?, column("velocity_y")?];
    let spin = table.column("spin");
    let mut bodies = vec![Motion::default(); scene.bodies.len()];
    let mut centres = vec![[0.0; 2]; scene.bodies.len()];
    let mass = |r: usize| density[r] * volume[r];
    for (r, &body) in table.body.iter().enumerate() {
        let (motion, centre) = (&mut bodies[body as usize], &mut centres[body as usize]);
        motion.mass += mass(r);
        for a in 0..2 {
            motion.velocity[a] += mass(r) * velocity[a][r];
            centre[a] += mass(r) * place[a][r];
        }
    }
    for (motion, centre) in bodies.iter_mut().zip(&mut centres) {
        for a in 0..2 {
            motion.velocity[a] /= motion.mass;
            centre[a] /= motion.mass;
        }
    }
    for (r, &body) in table.body.iter().enumerate() {
        let (motion, centre) = (&mut bodies[body as usize], &centres[body as usize]);
        let x = [0, 1].map(|a| place[a][r] - centre[a]);
        let v = [0, 1].map(|a| velocity[a][r] - motion.velocity[a]);
        let own = spin.map_or(0.0, |spin| spin[r]);
        motion.spin += mass(r) * (x[0] * v[1] - x[1] * v[0] + own);
    }
    let drift = |a: usize| {
        let booked = given.impulse[a] + end.body_force_impulse[a];
        let scale = start.absolute_momentum.max(end.absolute_momentum);
        ((end.momentum[a] - start.momentum[a] - booked) / scale).abs()
    };
    let [before, after] = [&start, &end].map(|totals| totals.kinetic + totals.internal);
    let energy = after - before - given.work - end.body_force_work;
    let pressure = column("pressure")?.iter().fold(0.0, |most: f64, p| most.max(p.abs()));
    Ok(Measured {
        bodies,
        pressure,
        momentum_drift: drift(0).max(drift(1)),
        energy_drift: energy / before.max(after),
        forces,
    })
}
