//! Scores against exact solutions that follow from the initial motion of a body.

use serde_json::{Value, json};

use super::bodies::body_named;
use crate::exact::plane::{
    Displaced, Gresho, MassPoint, Noh, ShearLayer, Symmetry, Vector, Vortex, rotation,
};
use crate::material::IdealGasParameters;
use crate::scene::motion::Motion;
use crate::scene::{self, CheckedScene, Eos, NohSymmetry};
use crate::simulation::ParticleTable;

/// An exact solution and the body that is compared with it.
pub struct PlaneReference {
    /// Index of the body.
    pub body: usize,
    /// The solution.
    pub solution: PlaneSolution,
}

/// An exact solution that follows from the initial motion of a body.
pub enum PlaneSolution {
    /// Generalized vortex.
    Vortex(Vortex),
    /// Rotating free body.
    Rotation,
    /// Shear layer.
    ShearLayer(ShearLayer),
    /// Gresho vortex.
    Gresho(Gresho),
    /// Noh problem about a point [m] or the axis; density averaged between two distances [m].
    Noh(Noh, Option<Vector>, [f64; 2]),
}

/// Particle state for a score.
struct ReferenceParticle {
    x: Vector,
    v: Vector,
    /// Current volume [m3].
    volume: f64,
    density: f64,
    p: f64,
    e: f64,
    /// Angular momentum of the spin [m2/s] and its energy [J/kg], per unit mass.
    spin: [f64; 2],
    /// Initial position, if known.
    reference: Vector,
}

impl PlaneReference {
    /// The solution named by a scene, if it is one of these.
    pub fn new(scene: &CheckedScene) -> Option<PlaneReference> {
        let of = |name: &str| {
            let body = body_named(scene, name);
            (body, scene.bodies[body].motion.as_ref())
        };
        let named = scene.scene.reference.as_ref()?;
        let (body, solution) = match named {
            scene::Reference::Vortex(named) => match of(&named.body) {
                (body, Some(Motion::Vortex(vortex))) => (body, PlaneSolution::Vortex(*vortex)),
                _ => return None,
            },
            scene::Reference::Rotation(named) => (of(&named.body).0, PlaneSolution::Rotation),
            scene::Reference::ShearLayer(named) => match of(&named.body) {
                (body, Some(Motion::ShearLayer(layer))) => {
                    (body, PlaneSolution::ShearLayer(*layer))
                }
                _ => return None,
            },
            scene::Reference::Gresho(named) => match of(&named.body) {
                (body, Some(Motion::Gresho(vortex))) => (body, PlaneSolution::Gresho(*vortex)),
                _ => return None,
            },
            scene::Reference::Noh(named) => {
                let (body, motion) = of(&named.body);
                let (about, speed) = match motion {
                    Some(Motion::Radial(about, speed)) => (Some(*about), -speed),
                    _ => (None, scene.speed_to_axis(body)?),
                };
                let material = scene.material_of(body);
                let Eos::IdealGas(IdealGasParameters { gamma }) = material.eos else { return None };
                let symmetry = match named.symmetry {
                    NohSymmetry::Planar => Symmetry::Planar,
                    NohSymmetry::Cylindrical => Symmetry::Cylindrical,
                    NohSymmetry::Spherical => Symmetry::Spherical,
                };
                let noh = Noh::new(symmetry, gamma, material.density, speed).ok()?;
                (body, PlaneSolution::Noh(noh, about, [named.between[0], named.between[1]]))
            }
            _ => return None,
        };
        Some(PlaneReference { body, solution })
    }

    /// Whether the score needs the profile at time 0.
    pub fn needs_start(scene: &CheckedScene) -> bool {
        matches!(scene.scene.reference, Some(scene::Reference::Rotation(_)))
    }

    /// The score of a profile, an object of numbers by name; `start` is the profile at time 0, if
    /// needed. `None` if no exact solution holds.
    pub fn score(
        &self,
        scene: &CheckedScene,
        table: &ParticleTable,
        start: Option<&ParticleTable>,
    ) -> Option<Value> {
        let t = table.time;
        let all = self.particles(scene, table);
        match &self.solution {
            PlaneSolution::Vortex(vortex) => {
                let displaced = |q: &ReferenceParticle| Displaced {
                    reference: q.reference,
                    position: q.x,
                    volume: q.volume * q.density / vortex.density,
                };
                let points: Vec<_> = all.iter().map(displaced).collect();
                Some(json!({"displacement_l2": vortex.l2_error(&points, t)?}))
            }
            PlaneSolution::Rotation => {
                let kept = |particles: &[ReferenceParticle]| {
                    let point = |q: &ReferenceParticle| MassPoint {
                        mass: q.mass(),
                        x: q.x,
                        v: q.v,
                        spin: q.spin,
                    };
                    let points: Vec<_> = particles.iter().map(point).collect();
                    let centre = rotation::centre_of_mass(&points);
                    let internal: f64 = particles.iter().map(|q| q.mass() * q.e).sum();
                    let kinetic = rotation::kinetic_energy(&points);
                    [rotation::angular_momentum(&points, centre), kinetic + internal, kinetic]
                };
                let (first, now) = (kept(&self.particles(scene, start?)), kept(&all));
                let loss = |k: usize| rotation::loss(first[k], now[k]);
                Some(json!({
                    "angular_momentum_loss": loss(0),
                    "energy_loss": loss(1),
                    "kinetic_energy_loss": loss(2),
                }))
            }
            PlaneSolution::ShearLayer(layer) => {
                let rms = layer.velocity_error(all.iter().map(|q| (q.x[1], q.v, q.volume)))?;
                Some(json!({"velocity_rms": rms}))
            }
            PlaneSolution::Gresho(vortex) => Some(score_gresho(vortex, &all)?),
            PlaneSolution::Noh(noh, about, between) => score_noh(noh, *about, *between, &all, t),
        }
    }

    fn particles(&self, scene: &CheckedScene, table: &ParticleTable) -> Vec<ReferenceParticle> {
        let column = |name: &str| table.column(name);
        let value = |name: &str, r: usize| column(name).map_or(0.0, |c| c[r]);
        let velocity = if scene.dimension == 1 { "velocity" } else { "velocity_x" };
        // on a line, tables have no particle volume, and all particles have the same mass
        let volume = |r: usize| match column("volume") {
            Some(volume) => volume[r],
            None => 1.0 / value("density", r),
        };
        let spin = |r: usize| match column("spin_inertia") {
            Some(inertia) => {
                let moment = value("spin", r);
                [moment, 0.5 * moment * moment / inertia[r]]
            }
            None => [0.0; 2],
        };
        (0..table.len())
            .filter(|&r| table.body[r] as usize == self.body)
            .map(|r| ReferenceParticle {
                x: [value("x", r), value("y", r)],
                v: [value(velocity, r), value("velocity_y", r)],
                volume: volume(r),
                density: value("density", r),
                p: value("pressure", r),
                e: value("specific_internal_energy", r),
                spin: spin(r),
                reference: [value("reference_x", r), value("reference_y", r)],
            })
            .collect()
    }
}

impl ReferenceParticle {
    fn mass(&self) -> f64 {
        self.density * self.volume
    }
}

/// Errors of velocity, pressure, and pressure up to a constant (heating of the gas shifts it).
fn score_gresho(vortex: &Gresho, all: &[ReferenceParticle]) -> Option<Value> {
    let velocity = vortex.velocity_error(all.iter().map(|q| (q.x, q.v, q.volume)))?;
    let pressure = |off: f64| vortex.pressure_error(all.iter().map(|q| (q.x, q.p - off, q.volume)));
    let distance = |q: &ReferenceParticle| {
        let [dx, dy] = [q.x[0] - vortex.centre[0], q.x[1] - vortex.centre[1]];
        dx.hypot(dy)
    };
    let (mut sum, mut total) = (0.0, 0.0);
    for q in all.iter().filter(|q| distance(q) < 2.0 * vortex.radius) {
        sum += q.volume * (q.p - vortex.pressure(distance(q)));
        total += q.volume;
    }
    Some(json!({
        "velocity_rms": velocity,
        "pressure_rms": pressure(0.0)?,
        "pressure_form_rms": pressure(sum / total)?,
    }))
}

/// Mean density between two distances, and its L1 error within twice the shock radius.
fn score_noh(
    noh: &Noh,
    about: Option<Vector>,
    [from, to]: [f64; 2],
    all: &[ReferenceParticle],
    t: f64,
) -> Option<Value> {
    let distance = |q: &ReferenceParticle| match about {
        Some([x, y]) => (q.x[0] - x).hypot(q.x[1] - y),
        None => q.x[0],
    };
    let (mut mass, mut volume, mut error, mut exact) = (0.0, 0.0, 0.0, 0.0);
    for q in all {
        let r = distance(q);
        if (from..to).contains(&r) {
            mass += q.mass();
            volume += q.volume;
        }
        if r < 2.0 * noh.shock_position(t) {
            let rho = noh.at(r, t).rho;
            error += q.volume * (q.density - rho).abs();
            exact += q.volume * rho;
        }
    }
    if volume == 0.0 || exact == 0.0 {
        return None;
    }
    let mean = mass / volume;
    Some(json!({
        "mean_density": mean,
        "mean_density_error": mean / noh.mean_density(from, to, t) - 1.0,
        "density_l1": error / exact,
    }))
}
