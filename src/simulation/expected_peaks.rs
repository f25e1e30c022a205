//! Values that the scene explains: energy, velocity and pressure that particles of a body may reach.

use std::sync::Arc;

use super::arrival::FirstArrival;
use crate::material::constitutive::RestIsentrope;
use crate::scene::{CheckedScene, Eos, SideProperties};
use crate::solver::Stepper;

/// A particle counts as at the front for this many times the time in which the front passes it [-].
pub(super) const FRONT_TIMES: f64 = 3.0;

/// Change of velocity of a material that fails, over that in the shock of the impact [-]. A failure
/// releases a tension of at most rho c up, which changes the velocity by up once more.
const RELEASED: f64 = 2.0;

/// Values that the particles of a body may reach.
#[derive(Clone, Debug)]
pub(super) struct ExpectedPeaks<const D: usize> {
    /// Initial specific internal energy [J/kg].
    pub(super) energy: f64,
    /// Isentrope of the body's material, if it has one and the heat is checked.
    pub(super) isentrope: Option<Arc<RestIsentrope>>,
    /// Energy from one shock in the body that the impacts heat most [J/kg], four times this where the
    /// material can fail; infinite where gases, explosives or forces drive the bodies.
    pub(super) heat: f64,
    pub(super) front: Option<PeakFront>,
    /// Initial velocity [m/s].
    pub(super) velocity: [f64; D],
    pub(super) ahead: Option<Ahead<D>>,
}

/// State ahead of the first wave of a body, and strength of that wave.
#[derive(Clone, Debug)]
pub(super) struct Ahead<const D: usize> {
    pub(super) arrival: FirstArrival<D>,
    /// Particle velocity up behind the strongest shock [m/s].
    pub(super) velocity: f64,
    /// Pressure rho c up of that shock [Pa].
    pub(super) pressure: f64,
}

/// Values behind the detonation front of a body.
#[derive(Clone, Copy, Debug)]
pub(super) struct PeakFront {
    /// Chapman-Jouguet pressure [Pa].
    pub(super) pressure: f64,
    /// Chapman-Jouguet velocity of the products [m/s].
    pub(super) velocity: f64,
    /// Time in which the front passes a point [s].
    pub(super) duration: f64,
}

impl<const D: usize> ExpectedPeaks<D> {
    /// Expected peaks of each body of a scene.
    pub(super) fn of(scene: &CheckedScene, stepper: &Stepper<D>) -> Vec<ExpectedPeaks<D>> {
        let bodies = scene.scene.bodies.iter().enumerate();
        let heat: Vec<f64> =
            (0..scene.bodies.len()).map(|i| shock_heat(scene, stepper, i)).collect();
        let up: Vec<f64> = heat.iter().map(|heat| (2.0 * heat).sqrt()).collect();
        let ahead = |i: usize| {
            let driven = up[i].is_infinite();
            let arrival = if driven { None } else { FirstArrival::of(scene, stepper, i, &up) };
            arrival.map(|arrival| Ahead {
                arrival,
                velocity: up[i],
                pressure: stepper.impedance(i) * up[i],
            })
        };
        // a particle at an interface shares nodes, and so heat, with those of the other body
        let strongest = heat.iter().copied().fold(0.0, f64::max);
        let mut isentropes = vec![None; scene.scene.materials.len()];
        let mut isentrope = |i: usize| -> Option<Arc<RestIsentrope>> {
            let of = |i| stepper.isentrope(scene, i).filter(|_| strongest.is_finite());
            let material = &mut isentropes[scene.bodies[i].material];
            material.get_or_insert_with(|| of(i).map(Arc::new)).clone()
        };
        let can_fail = |i: usize| scene.material_of(i).failure.is_some();
        bodies
            .map(|(i, body)| ExpectedPeaks {
                energy: stepper.starting_energy(i, body.pressure, body.temperature),
                isentrope: isentrope(i),
                heat: strongest * if can_fail(i) { RELEASED * RELEASED } else { 1.0 },
                front: front(scene, i),
                velocity: std::array::from_fn(|a| scene.bodies[i].velocity[a]),
                ahead: ahead(i),
            })
            .collect()
    }
}

/// Energy from one shock of the strongest impact on body `i`, up^2/2 [J/kg], with up from the
/// acoustic impedances of the initial state.
fn shock_heat<const D: usize>(scene: &CheckedScene, stepper: &Stepper<D>, i: usize) -> f64 {
    let driven = |eos: &Eos| eos.gas_gamma().is_some() || eos.burn().is_some();
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
    let sides = scene.side_properties::<D>();
    let extremes = scene.frame::<D>().extremes();
    // a wall stops only motion normal to it
    let rigid = (0..D).filter(|&a| sides[a].iter().any(SideProperties::is_rigid));
    let walls = rigid.flat_map(|a| extremes.map(|wall| (velocity(i)[a] - wall[a]).abs()));
    let loads = sides.as_flattened().iter().filter_map(|side| side.pressure.as_ref());
    let loads = loads.map(|load| load.range()[1].max(0.0) / stepper.impedance(i));
    let up = others.chain(walls).chain(loads).fold(0.0, f64::max);
    // without motion or impact there is no expected heat, and heat is not checked
    if up > 0.0 { 0.5 * up * up } else { f64::INFINITY }
}

fn front(scene: &CheckedScene, i: usize) -> Option<PeakFront> {
    let material = scene.material_of(i);
    let named = material.eos.burn()?.front()?;
    let detonation = material.eos.products(material.density)?.detonation();
    Some(PeakFront {
        pressure: detonation.pressure,
        velocity: (1.0 - detonation.jacobian) * detonation.speed,
        duration: named.width / named.detonation_velocity,
    })
}
