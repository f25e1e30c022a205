//! The bounds of a scene.

use crate::scene::{
    BodyForce, Burn, CheckedScene, EnergyUpdate, Eos, Scene, ShapeKind, Side, Stepping, Transfer,
};

/// Growth of energy that ends a run of a scheme that keeps it to rounding [-].
const EXACT_GROWTH: f64 = 1e-3;

/// The same of a scheme that does not: stress first gains up to 0.15 and stays bounded, what is
/// unstable passes any bound soon.
const LOSSY_GROWTH: f64 = 0.5;

/// The same of hat functions at the particle's centre, which kick every particle that passes into
/// another cell: up to 3 was seen, bounded.
const KICKED_GROWTH: f64 = 10.0;

/// Least share of all energy that counts as what a common motion leaves [-].
const REST_OF_MOTION: f64 = 1e-6;

/// Sums over a run's particles that the watch looks at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energies {
    /// Kinetic energy [J].
    pub kinetic: f64,
    /// Internal energy [J].
    pub internal: f64,
    /// Kinetic energy of the common motion [J].
    pub common: f64,
}

impl Energies {
    /// Kinetic and internal energy [J].
    pub fn total(&self) -> f64 {
        self.kinetic + self.internal
    }
}

/// What a run of a scene is held to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Greatest speed of a particle [m/s].
    pub speed: f64,
    /// Greatest Courant number of a step, by the state at its end [-].
    pub courant: f64,
    /// Shortest time step that is stable at a Courant number of 1 [s].
    pub least_step: f64,
    /// Most particles in a cell.
    pub crowd: usize,
    /// Greatest growth of energy, over what there is of it [-].
    pub energy_growth: f64,
    /// Whether internal energy below none is a fault: the equations of state have their zero
    /// where the material is at rest.
    pub warm: bool,
    /// Whether nothing holds the bodies, so that their common motion drives nothing.
    pub free: bool,
}

impl Limits {
    /// The bounds of `scene`, of which `fastest` is the greatest speed of the start, of bodies or
    /// sound [m/s], and `cell` the shortest edge of a cell [m].
    pub fn new(scene: &CheckedScene, fastest: f64, cell: f64) -> Limits {
        let watch = &scene.scene.watch;
        let reference = fastest.max(driven_speed(scene, fastest));
        let most = scene.bodies.iter().map(|b| most_in_a_cell(scene, b)).fold(1.0, f64::max);
        let exact = keeps_energy(&scene.scene);
        Limits {
            speed: watch.speed * reference,
            courant: watch.courant,
            least_step: watch.least_step * cell / reference,
            crowd: (watch.crowding * most).min(1e15) as usize,
            energy_growth: watch.energy_growth.unwrap_or(match exact {
                true => EXACT_GROWTH,
                false if scene.scene.method.shape == ShapeKind::Linear => KICKED_GROWTH,
                false => LOSSY_GROWTH,
            }),
            warm: scene.scene.bodies.iter().all(|body| {
                let eos = &scene.scene.materials[&body.material].eos;
                body.pressure >= 0.0 && zero_at_rest(eos)
            }),
            free: is_free(scene),
        }
    }

    /// Growth of the energy since the `start`, less the `work` that came from outside, over what
    /// there is of it: what bodies bring beside their common motion, or the work [-].
    pub fn growth(&self, start: &Energies, now: &Energies, work: f64) -> f64 {
        let grown = now.total() - start.total() - work;
        if grown <= 0.0 { grown } else { grown / self.scale(start, work) }
    }

    /// Internal energy below none, over the same [-].
    pub fn cold(&self, start: &Energies, now: &Energies, work: f64) -> f64 {
        if now.internal >= 0.0 { 0.0 } else { -now.internal / self.scale(start, work) }
    }

    fn scale(&self, start: &Energies, work: f64) -> f64 {
        let common = if self.free { start.common } else { 0.0 };
        let own = start.total() - common;
        own.abs().max(REST_OF_MOTION * start.total().abs()) + work.abs()
    }
}

/// Whether the scheme keeps kinetic and internal energy to rounding.
pub fn keeps_energy(scene: &Scene) -> bool {
    let method = &scene.method;
    let filters = !matches!(method.transfer, Transfer::Flip);
    method.stepping == Stepping::Midpoint
        && method.energy == EnergyUpdate::Compatible
        && (method.filter_heat || !filters)
}

/// The speed that what drives a scene may bring a body to [m/s]: an ideal gas that runs out into
/// the void, the loads on sides, gravity over the whole run.
fn driven_speed(scene: &CheckedScene, fastest: f64) -> f64 {
    // a piston's speed, which may come only later
    let [least, greatest] = scene.frame::<2>().extremes();
    let mut most = least.iter().chain(&greatest).fold(0.0, |most: f64, v| most.max(v.abs()));
    for body in &scene.scene.bodies {
        let material = &scene.scene.materials[&body.material];
        if let Eos::IdealGas { gamma } | Eos::StiffenedGas { gamma, .. } = material.eos {
            // 2 c/(gamma - 1), the escape speed, of the hottest gas that a first shock makes
            most = most.max(2.0 * fastest / (gamma - 1.0));
        }
        // a detonation's products leave at about the speed of its front
        if let Some(Burn::Front(front)) = material.eos.burn() {
            most = most.max(2.0 * front.detonation_velocity);
        }
        let loads = scene.sides::<2>();
        for side in loads[..scene.dimension].as_flattened() {
            if let Side::Pressure(load) = side {
                // twice p/(rho c) at a free surface, and with c at least that of the bodies' own
                // motion for a load beyond the stiffness, sqrt(p/rho)
                most = most.max(2.0 * (load.range()[1].max(0.0) / material.density).sqrt());
            }
        }
    }
    if let Some(force) = &scene.scene.body_force {
        most += match force {
            BodyForce::Gravity(g) => {
                g.iter().map(|g| g * g).sum::<f64>().sqrt() * scene.scene.time.end
            }
            // the ring turns by the amplitude and back within the period
            BodyForce::Vortex(ring) => {
                std::f64::consts::PI * ring.amplitude.abs() * ring.outer / ring.period
            }
        };
    }
    most
}

/// Particles of a body that a cell holds at the start, at most.
fn most_in_a_cell(scene: &CheckedScene, body: &crate::scene::CheckedBody) -> f64 {
    let cells: f64 = (0..scene.dimension)
        .map(|a| ((body.upper[a] - body.lower[a]) / scene.cell_size[a]).max(1.0))
        .product();
    match &body.tiles {
        // they are uneven: a cell may have several times the mean
        Some(tiles) => 4.0 * (tiles.len() as f64 / cells).max(1.0),
        None => (body.particles as f64 / cells).max(1.0),
    }
}

/// Whether the energy of a material at rest is none, and that of any state above it.
fn zero_at_rest(eos: &Eos) -> bool {
    matches!(
        eos,
        Eos::MieGruneisen { .. }
            | Eos::IdealGas { .. }
            | Eos::LinearElastic { .. }
            | Eos::NeoHookean { .. }
    )
}

/// Whether no side holds or drives a body.
fn is_free(scene: &CheckedScene) -> bool {
    let sides = scene.sides::<2>();
    let open = |s: &Side| matches!(s, Side::Free | Side::Outflow | Side::Periodic);
    sides[..scene.dimension].as_flattened().iter().all(open) && scene.scene.body_force.is_none()
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: Limits = Limits {
        speed: 1.0,
        courant: 1.0,
        least_step: 1.0,
        crowd: 1,
        energy_growth: 0.1,
        warm: true,
        free: true,
    };

    #[test]
    fn growth_is_held_against_what_moves_apart() {
        let start = Energies { kinetic: 100.0, internal: 0.0, common: 99.0 };
        let now = Energies { kinetic: 100.0, internal: 0.5, common: 99.0 };
        assert_eq!(LIMITS.growth(&start, &now, 0.0), 0.5);
        assert_eq!(Limits { free: false, ..LIMITS }.growth(&start, &now, 0.0), 0.005);
        // what sides have given is no growth
        assert_eq!(LIMITS.growth(&start, &now, 0.5), 0.0);
        assert_eq!(LIMITS.growth(&start, &now, 0.75), -0.25);
        let cold = Energies { internal: -0.2, ..now };
        assert_eq!(LIMITS.cold(&start, &cold, 1.0), 0.1);
        assert_eq!(LIMITS.cold(&start, &now, 0.0), 0.0);
    }
}
