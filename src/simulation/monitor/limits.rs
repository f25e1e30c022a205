//! Bounds of the monitor for a scene.

use crate::scene::{
    Body, BodyForce, Burn, CheckedScene, EnergyUpdate, Scene, SideProperties, Stepping,
};

/// Relative growth of energy that stops a run, for a scheme that conserves energy to rounding [-].
const EXACT_GROWTH: f64 = 1e-3;

/// The same for a scheme that does not conserve energy: the stress first adds up to 0.15 and stays
/// bounded; an unstable run soon exceeds any bound.
const LOSSY_GROWTH: f64 = 0.5;

/// The same for hat functions at the particle centre, which disturb every particle that crosses
/// into another cell: up to 3 was observed, bounded.
const KICKED_GROWTH: f64 = 10.0;

/// Relative loss of energy that stops a run of such a scheme [-]: filters and explicit stress may
/// dissipate all the energy, but not more.
const LOSSY_LOSS: f64 = 1.02;

/// Smallest energy deficit below the admissible minimum that counts [-]: elastic energy of tension
/// and rounding stay below it.
const COLD: f64 = 0.02;

/// Smallest fraction of the total energy that counts as the energy beside the common motion [-].
const REST_OF_MOTION: f64 = 1e-6;

/// Energy that rounding may create in a run, over m c^2 and, with conduction, over the heat above
/// absolute zero [-]: the smallest scale of energy, also if nothing moves.
const ROUNDING: f64 = 1e-12;

/// Sums over all particles that the monitor checks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energies {
    /// Kinetic energy [J].
    pub kinetic: f64,
    /// Internal energy [J].
    pub internal: f64,
    /// Kinetic energy of the common motion (of the centre of mass) [J].
    pub common: f64,
    /// Internal energy that adiabatic flow can convert into motion, or the internal energy if that
    /// is greater [J].
    pub available: f64,
    /// Internal energy above the admissible minimum of each particle [J].
    pub above_least: f64,
    /// Thermal energy deficit of particles below absolute zero [J].
    pub below_zero_kelvin: f64,
}

impl Energies {
    /// Sum of kinetic and internal energy [J].
    pub fn total(&self) -> f64 {
        self.kinetic + self.internal
    }
}

/// Bounds of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Greatest speed of a particle [m/s].
    pub speed: f64,
    /// Greatest Courant number of a step, from the state at its end [-].
    pub courant: f64,
    /// Shortest time step that is stable at a Courant number of 1 [s].
    pub min_time_step: f64,
    /// Largest number of particles in a cell.
    pub crowd: usize,
    /// Greatest growth of energy, over the energy at the start [-].
    pub energy_growth: f64,
    /// Greatest loss of energy, over the energy at the start [-].
    pub energy_loss: f64,
    /// Greatest deficit of internal energy below the admissible minimum, over the energy at the
    /// start [-].
    pub energy_lack: f64,
    /// Energy per unit mass that rounding may create [J/kg]: the smallest scale of energy.
    pub rounding: f64,
    /// Whether no side holds the bodies, so that their common motion drives nothing.
    pub free: bool,
}

impl Limits {
    /// Bounds of `scene`; `fastest` is the greatest initial speed of bodies or sound [m/s], `cell`
    /// the shortest edge of a cell [m].
    pub fn new(scene: &CheckedScene, fastest: f64, cell: f64) -> Limits {
        let monitor = &scene.scene.monitor;
        let reference = fastest.max(driven_speed(scene, fastest));
        let most = scene.bodies.iter().map(|b| most_in_a_cell(scene, b)).fold(1.0, f64::max);
        let exact = keeps_energy(&scene.scene);
        let energy_growth = monitor.energy_growth.unwrap_or(match exact {
            true => EXACT_GROWTH,
            false if scene.scene.method.shape.has_jumps() => KICKED_GROWTH,
            false => LOSSY_GROWTH,
        });
        Limits {
            speed: monitor.speed * reference,
            courant: monitor.courant,
            min_time_step: monitor.min_time_step_ratio * cell / reference,
            crowd: (monitor.max_particles_per_cell_ratio * most).min(1e15) as usize,
            energy_growth,
            energy_loss: if exact { energy_growth } else { LOSSY_LOSS },
            energy_lack: energy_growth.max(COLD),
            rounding: ROUNDING * (fastest * fastest + heat_of_conductors(scene)),
            free: is_free(scene),
        }
    }

    /// Change of the energy since the `start`, minus the external `work`, over the energy of bodies
    /// of total `mass` [kg] without their common motion, plus the work [-].
    pub fn change(&self, start: &Energies, now: &Energies, work: f64, mass: f64) -> f64 {
        (now.total() - start.total() - work) / self.scale(start, work, mass)
    }

    /// Deficit of internal energy below the admissible minimum, minus that at the `start`, over the
    /// same energy [-].
    pub fn lack(&self, start: &Energies, now: &Energies, work: f64, mass: f64) -> f64 {
        let lack = |e: &Energies| (-e.above_least).max(e.below_zero_kelvin).max(0.0);
        // max() ignores NaN
        if now.above_least.is_nan() || now.below_zero_kelvin.is_nan() {
            return f64::NAN;
        }
        (lack(now) - lack(start)).max(0.0) / self.scale(start, work, mass)
    }

    fn scale(&self, start: &Energies, work: f64, mass: f64) -> f64 {
        let common = if self.free { start.common } else { 0.0 };
        let all = start.kinetic + start.available;
        (all - common).max(REST_OF_MOTION * all) + work.abs() + self.rounding * mass
    }
}

/// Whether the scheme keeps kinetic and internal energy to rounding.
pub fn keeps_energy(scene: &Scene) -> bool {
    let method = &scene.method;
    let filters = method.transfer.plan().filters;
    method.stepping == Stepping::Midpoint
        && method.energy == EnergyUpdate::Compatible
        && (method.filter_heat || !filters)
}

/// Speed that a body may reach by the driving forces of a scene [m/s]: expansion of an ideal gas
/// into vacuum, loads on sides, gravity over the whole run.
fn driven_speed(scene: &CheckedScene, fastest: f64) -> f64 {
    // the speed of a piston, which may start to move later
    let [least, greatest] = scene.frame::<2>().extremes();
    let mut most = least.iter().chain(&greatest).fold(0.0, |most: f64, v| most.max(v.abs()));
    for body in &scene.scene.bodies {
        let material = &scene.scene.materials[&body.material];
        if let Some(gamma) = material.eos.gas_gamma() {
            // 2 c/(gamma - 1), the escape speed, of the hottest gas behind a first shock
            most = most.max(2.0 * fastest / (gamma - 1.0));
        }
        // detonation products leave at about the speed of the front
        if let Some(Burn::Front(front)) = material.eos.burn() {
            most = most.max(2.0 * front.detonation_velocity);
        }
        let sides = scene.side_properties::<2>();
        for load in sides.as_flattened().iter().filter_map(|side| side.pressure.as_ref()) {
            // twice p/(rho c) at a free surface, and with c at least that of the bodies' own
            // motion for a load beyond the stiffness, sqrt(p/rho)
            most = most.max(2.0 * (load.range()[1].max(0.0) / material.density).sqrt());
        }
    }
    if let Some(force) = &scene.scene.body_force {
        most += match force {
            BodyForce::Gravity(g) => {
                g.iter().map(|g| g * g).sum::<f64>().sqrt() * scene.scene.time.end
            }
            // the ring turns by the amplitude and back within one period
            BodyForce::Vortex(ring) => {
                std::f64::consts::PI * ring.amplitude.abs() * ring.outer / ring.period
            }
        };
    }
    most
}

/// Largest initial number of particles of a body in a cell.
fn most_in_a_cell(scene: &CheckedScene, body: &crate::scene::CheckedBody) -> f64 {
    let cells: f64 = (0..scene.dimension)
        .map(|a| ((body.upper[a] - body.lower[a]) / scene.cell_size[a]).max(1.0))
        .product();
    match &body.tiling {
        // tilings are uneven: a cell may hold several times the mean
        Some(tiling) => 4.0 * (tiling.count() as f64 / cells).max(1.0),
        None => (body.particles as f64 / cells).max(1.0),
    }
}

/// Heat of the conducting bodies above absolute zero, maximum over bodies [J/kg], as conduction
/// rounds differences of it. Zero without conduction.
fn heat_of_conductors(scene: &CheckedScene) -> f64 {
    let held = scene.held_temperatures::<2>();
    let held = held.as_flattened().iter().flatten().copied().fold(0.0, f64::max);
    let heat = |body: &Body| {
        let thermal = scene.scene.materials[&body.material].thermal?;
        thermal.conductivity?;
        let own = body.temperature.unwrap_or(thermal.reference_temperature);
        Some(thermal.specific_heat * own.max(held))
    };
    scene.scene.bodies.iter().filter_map(heat).fold(0.0, f64::max)
}

/// Whether no side holds or drives a body.
fn is_free(scene: &CheckedScene) -> bool {
    let drives = |side: &SideProperties| side.acts_on_material() && !side.is_periodic();
    !scene.has_side(drives) && scene.scene.body_force.is_none()
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: Limits = Limits {
        speed: 1.0,
        courant: 1.0,
        min_time_step: 1.0,
        crowd: 1,
        energy_growth: 0.1,
        energy_loss: 0.1,
        energy_lack: 0.1,
        rounding: 0.0,
        free: true,
    };

    fn energies(kinetic: f64, internal: f64, common: f64) -> Energies {
        let (available, above_least) = (internal.max(0.0), internal);
        Energies { kinetic, internal, common, available, above_least, below_zero_kelvin: 0.0 }
    }

    #[test]
    fn change_of_energy_is_relative_to_motion_against_each_other() {
        let start = energies(100.0, 0.0, 99.0);
        let now = energies(100.0, 0.5, 99.0);
        assert_eq!(LIMITS.change(&start, &now, 0.0, 1.0), 0.5);
        assert_eq!(Limits { free: false, ..LIMITS }.change(&start, &now, 0.0, 1.0), 0.005);
        // work of the sides does not count as growth
        assert_eq!(LIMITS.change(&start, &now, 0.5, 1.0), 0.0);
        assert_eq!(LIMITS.change(&start, &now, 1.0, 1.0), -0.25);
        let cold = Energies { internal: -0.2, above_least: -0.2, ..now };
        assert_eq!(LIMITS.lack(&start, &cold, 1.0, 1.0), 0.1);
        assert_eq!(LIMITS.lack(&start, &now, 0.0, 1.0), 0.0);
        assert!(LIMITS.lack(&start, &Energies { above_least: f64::NAN, ..now }, 0.0, 1.0).is_nan());
    }

    #[test]
    fn a_body_colder_than_its_reference_lacks_nothing_at_the_start() {
        let start = Energies { internal: -86.0, ..energies(1.0, 0.0, 0.0) };
        let now = Energies { internal: -85.5, ..energies(0.5, 0.0, 0.0) };
        assert_eq!(LIMITS.change(&start, &now, 0.0, 1.0), 0.0);
        assert_eq!(LIMITS.lack(&start, &now, 0.0, 1.0), 0.0);
        let frozen = Energies { below_zero_kelvin: 0.25, ..now };
        assert_eq!(LIMITS.lack(&start, &frozen, 0.0, 1.0), 0.25);
    }

    #[test]
    fn a_scene_at_rest_has_a_scale() {
        let limits = Limits { rounding: 1e-6, ..LIMITS };
        let rest = Energies::default();
        let now = energies(0.0, 1e-9, 0.0);
        assert!((limits.change(&rest, &now, 0.0, 2.0) - 5e-4).abs() < 1e-18);
    }
}
