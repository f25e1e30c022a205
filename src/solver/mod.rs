//! One time step, written like the description of the method in a paper.
//!
//! [`Stepper`] holds the settings of a scene; [`Steps::advance`] runs the phases of [`midpoint`] or
//! [`leapfrog`]. [`World`] joins physics and messages: it runs a phase on every patch, and the
//! exchanges between phases.

pub mod artificial_viscosity;
pub mod clock;
pub mod columns;
mod contact;
pub mod declare;
pub mod effect;
pub mod exchange;
pub mod gather;
pub mod leapfrog;
mod material_state;
pub mod midpoint;
mod motion_columns;
pub mod nodal_fields;
mod particle_domains;
pub mod particle_update;
pub mod particle_weights;
pub mod particles;
pub mod parts;
pub mod patch;
mod reach;
pub mod relaxation;
pub mod scatter;
pub mod series;
pub mod shape_weights;
pub mod sides;
mod solid;
mod tension_free;
mod total_lagrangian;

pub use exchange::{Nodal, Sleep, World};
pub use reach::StencilRadius;

use crate::contact::ContactCondition;
use crate::material::constitutive::{
    self, ConstitutiveModel, CustomModel, FailureModel, StrengthModel, ThermalModel,
};
use crate::material::failure::RestState;
use crate::material::strength::MaterialState;
use crate::scene::{
    CheckedScene, EnergyUpdate, FrameKind, Material, PressureRelaxation, ShapeKind, SideProperties,
    Stepping, StressUpdate,
};
use crate::shape::{DomainExtent, Shape, most_nodes, with_shape, with_width};
use crate::solver::artificial_viscosity::Viscosity;
use crate::solver::columns::Columns;
use crate::solver::effect::{Effects, Registry, Setup, StepContext};
use crate::solver::nodal_fields::{Fields, Wanted};
use crate::solver::parts::StepPart;
use crate::solver::patch::Patch;
use crate::transfer::TransferPlan;

/// Settings of a scene, prepared for time stepping.
pub struct Stepper<const D: usize> {
    /// Indices of the columns.
    pub columns: Columns,
    /// Indices of the nodal fields.
    pub fields: Fields,
    /// Effects of the scene.
    pub effects: Effects<D>,
    /// External forces on particles, each with the part of a step that it belongs to.
    forces: Vec<(usize, usize)>,
    /// Part of a step that friction heat belongs to.
    friction_part: usize,
    transfer: TransferPlan,
    stepping: Stepping,
    stress_update: StressUpdate,
    /// Whether the work uses the velocity that conserves energy exactly.
    pub(crate) compatible: bool,
    filter_heat: bool,
    relaxation: Option<PressureRelaxation>,
    volume_relaxation: Option<f64>,
    edge_mask: Option<f64>,
    viscosity: Option<Viscosity>,
    /// Contact between bodies with separate velocity fields.
    contact: Option<ContactCondition>,
    /// Number of velocity fields, each in a layer of the nodal arrays: one for all bodies, or one
    /// per body.
    pub layers: usize,
    /// Initial rho c^2 of each body [Pa].
    stiffness: Vec<f64>,
    /// Initial acoustic impedance rho c of each body [Pa s/m].
    impedances: Vec<f64>,
    /// Shear wave speed in each body at rest [m/s]; 0 in fluids without strength.
    pub(crate) shear_speeds: Vec<f64>,
    /// Impact speed of the scene, maximum over its bodies [m/s].
    impact: f64,
    /// Greatest impulse that each body can return as adhesion under tension [Pa s].
    max_adhesion_impulse: Vec<f64>,
    /// Constitutive model of each body.
    pub(crate) models: Vec<ConstitutiveModel>,
    /// Strength of each body's material, in addition to its equation of state.
    pub(crate) strengths: Vec<Option<Box<dyn StrengthModel>>>,
    /// Failure model of each body's material.
    pub(crate) failures: Vec<Option<Box<dyn FailureModel>>>,
    /// Thermal model of each body.
    pub(crate) thermals: Vec<Option<ThermalModel>>,
    /// Column of the history variable of each body's equation of state.
    history: Vec<Option<usize>>,
    shape: ShapeKind,
    /// Whether shape functions are evaluated at the initial positions of the particles.
    pub(crate) total_lagrangian: bool,
    /// Edges of a cell [m] and their inverse.
    pub(crate) cell: [f64; D],
    inverse_cell: [f64; D],
    /// Edge of a square or line with the volume of a cell [m].
    edge: f64,
    /// Lower corner of the domain [m] and its number of cells.
    lower: [f64; D],
    pub(crate) cells: [i64; D],
    sides: [[SideProperties; 2]; D],
    /// Directions with a no-slip wall.
    no_slip: [bool; D],
    /// Whether x is a radius: radial motion then causes hoop strain.
    pub(crate) axisymmetric: bool,
    /// Longest half diagonal of a particle's domain [cells], if it is limited.
    domain_limit: Option<f64>,
    /// Longest step of diffusive effects at a Courant number of 1 [s].
    diffusion_step: f64,
    /// Whether quiescent patches are skipped.
    may_sleep: bool,
    /// Greatest initial speed, of bodies or sound [m/s].
    pub fastest: f64,
    /// Mass below which a node counts as empty [kg].
    pub(crate) empty_mass: f64,
    /// Nodal speed below which a node counts as at rest [m/s].
    quiescent_speed: f64,
    /// Acceleration that brings a node to that speed while the fastest wave crosses a cell [m/s2].
    still_acceleration: f64,
    /// Nodal pressure below which a node counts as free of stress [Pa].
    still_pressure: f64,
}

/// Fraction of the fastest speed of a scene below which nodal velocities count as zero; the limits
/// of acceleration and pressure follow from it. It applies to all patches, quiescent or not.
const STILL: f64 = 1.0 / (1u64 << 50) as f64;

/// Ratio by which a particle may be longer at the middle of a step than at its start.
const STRETCH: f64 = 1.25;

/// Wave speeds in a body at rest.
struct Waves {
    /// Shear wave speed [m/s]; 0 in a fluid without strength.
    shear: f64,
    /// Contribution of shear to the square of the sound speed, 4 G/(3 rho) of a material with
    /// strength [m2/s2].
    added: f64,
}

impl Waves {
    fn of(
        material: &Material,
        model: &ConstitutiveModel,
        strength: Option<&dyn StrengthModel>,
    ) -> Self {
        let rest = MaterialState {
            compression: 1.0,
            pressure: 0.0,
            temperature: material.thermal.map_or(f64::NAN, |t| t.reference_temperature),
        };
        match strength {
            None => Waves { shear: model.shear_speed(), added: 0.0 },
            Some(strength) => {
                let square = strength.shear_modulus(&rest) / material.density;
                Waves { shear: square.sqrt(), added: 4.0 / 3.0 * square }
            }
        }
    }

    /// Speed of the fastest wave, if the sound speed without strength is `sound` [m/s].
    fn fastest(&self, sound: f64) -> f64 {
        if self.added > 0.0 { (sound * sound + self.added).sqrt() } else { sound }
    }
}

impl<const D: usize> Stepper<D> {
    /// Stepper of `scene`, with the effects of `R`.
    pub fn new<R: Registry>(scene: &CheckedScene) -> Self {
        Self::with_models::<R>(scene, &|_| None).expect("there is nothing to replace")
    }

    /// Stepper of `scene`, with custom models from `outside` in place of the models of the scene;
    /// `outside` is called with the material name once per body.
    ///
    /// # Errors
    ///
    /// Name of the material, and the reason why it cannot use the custom model.
    pub fn with_models<R: Registry>(
        scene: &CheckedScene,
        outside: &dyn Fn(&str) -> Option<CustomModel>,
    ) -> Result<Self, (String, String)> {
        let method = &scene.scene.method;
        let viscosity = scene.scene.artificial_viscosity.as_ref();
        let bodies = &scene.scene.bodies;
        let materials = &scene.scene.materials;
        let cell: [f64; D] = std::array::from_fn(|a| scene.cell_size[a]);
        let volume: f64 = cell.iter().product();
        let smallest = cell.iter().copied().fold(f64::INFINITY, f64::min);
        let mut models: Vec<ConstitutiveModel> =
            bodies.iter().map(|b| constitutive::build(&materials[&b.material])).collect();
        let mut strengths: Vec<_> =
            bodies.iter().map(|b| constitutive::strength_model(&materials[&b.material])).collect();
        for (b, (model, strength)) in bodies.iter().zip(models.iter_mut().zip(&mut strengths)) {
            if let Some(own) = outside(&b.material) {
                own.replace(&materials[&b.material], model, strength)
                    .map_err(|reason| (b.material.clone(), reason))?;
            }
        }
        let thermals = (bodies.iter().zip(&models))
            .map(|(b, model)| constitutive::thermal_of(&materials[&b.material], model));
        let waves: Vec<Waves> = (bodies.iter().zip(models.iter().zip(&strengths)))
            .map(|(b, (model, strength))| {
                Waves::of(&materials[&b.material], model, strength.as_deref())
            })
            .collect();
        let fastest = (bodies.iter().zip(&waves).zip(models.iter().zip(&scene.bodies)))
            .map(|((b, w), (m, c))| {
                let pressure = c.motion.and_then(|m| m.top_pressure()).unwrap_or(b.pressure);
                w.fastest(m.sound_speed_at(pressure)).max(c.top_speed)
            })
            .fold(0.0, f64::max);
        let speeds = || {
            (bodies.iter().zip(&waves).zip(&models)).map(|((b, w), m)| {
                let density = materials[&b.material].density;
                (b, density, w.fastest(m.sound_speed_at(b.pressure)))
            })
        };
        // exact if all edges are equal
        let edge = match cell.iter().all(|&h| h == cell[0]) {
            true => cell[0],
            false => volume.powf(1.0 / D as f64),
        };
        let failures = (bodies.iter().zip(&waves).zip(&models)).map(|((b, w), model)| {
            let material = &materials[&b.material];
            let density = material.density;
            let bulk_modulus = density * model.sound_speed_at(0.0).powi(2);
            let shear_modulus = density * w.shear.powi(2);
            let rest = RestState { density, bulk_modulus, shear_modulus, cell: edge };
            constitutive::failure_model(material, &rest)
        });
        let failures = failures.collect();
        let stiffness = speeds().map(|(_, density, c)| density * c.powi(2)).collect();
        let impedances = speeds().map(|(_, density, c)| density * c).collect();
        let impact = scene.impact_speed::<D>();
        let speed =
            |pressure: f64, density: f64, c: f64| impact.max(pressure.abs() / (density * c));
        let max_adhesion_impulse = speeds()
            .map(|(b, density, c)| {
                contact::PULL * density * smallest * speed(b.pressure, density, c)
            })
            .collect();
        let impact =
            speeds().map(|(b, density, c)| speed(b.pressure, density, c)).fold(0.0, f64::max);
        let densest = bodies.iter().map(|b| materials[&b.material].density).fold(0.0, f64::max);
        // volume of a cell, with axial symmetry per radian at the outermost radius
        let around = match scene.axisymmetric() {
            true => scene.scene.domain.lower[0] + scene.cells[0] as f64 * cell[0],
            false => 1.0,
        };
        let transfer = method.transfer.plan();
        let series = transfer.series();
        let relaxed = method.pressure_relaxation.is_some();
        let contact = scene.scene.contact.and_then(|contact| contact.condition());
        let contact = contact.filter(|_| scene.velocity_fields() > 1);
        let has_friction = D > 1 && contact.is_some_and(|c| c.coefficient.is_some());
        let columns = Columns::new::<R>(scene);
        let friction_part = if has_friction { None } else { columns.friction_heat };
        let has_friction = has_friction || columns.friction_heat.is_some();
        let masked = method.edge_mask.is_some();
        let mut fields = Fields::new(D, Wanted { series, masked, relaxed, has_friction });
        let mut setup = Setup { scene, columns: &columns, fields: &mut fields, matrices: 0 };
        let effects = Effects::new(R::build(&mut setup));
        let owner = |column: usize| columns.owners[column].expect("a force is an effect's");
        let history = (columns.history.iter().zip(&models)).map(|(column, model)| match model {
            ConstitutiveModel::Fluid(model) => column.filter(|_| model.first_history().is_some()),
            ConstitutiveModel::Solid(_) => None,
        });
        Ok(Stepper {
            history: history.collect(),
            forces: columns.forces.iter().map(|&force| (force, owner(force))).collect(),
            friction_part: friction_part.unwrap_or(StepPart::Contact as usize),
            diffusion_step: effects
                .iter()
                .map(|e| e.diffusion_step())
                .fold(f64::INFINITY, f64::min),
            effects,
            columns,
            fields,
            transfer,
            stepping: method.stepping,
            stress_update: method.stress_update,
            compatible: method.energy == EnergyUpdate::Compatible,
            filter_heat: method.filter_heat,
            relaxation: method.pressure_relaxation,
            volume_relaxation: method.volume_relaxation,
            edge_mask: method.edge_mask,
            viscosity: viscosity.map(|v| Viscosity::new(v, edge)),
            contact,
            layers: scene.velocity_fields(),
            stiffness,
            impedances,
            impact,
            max_adhesion_impulse,
            shear_speeds: waves.iter().map(|w| w.shear).collect(),
            thermals: thermals.collect(),
            models,
            strengths,
            failures,
            shape: method.shape,
            total_lagrangian: method.frame == FrameKind::TotalLagrangian,
            cell,
            inverse_cell: cell.map(|h| 1.0 / h),
            edge,
            lower: std::array::from_fn(|a| scene.scene.domain.lower[a]),
            cells: std::array::from_fn(|a| scene.cells[a] as i64),
            no_slip: scene.side_properties().map(|ends| ends.iter().any(|side| side.no_slip)),
            sides: scene.side_properties(),
            axisymmetric: scene.axisymmetric(),
            domain_limit: method.domain_limit,
            may_sleep: scene.skips_quiet(),
            fastest,
            // the content of such a node is below the rounding of its neighbours
            empty_mass: densest * volume * around * 2f64.powi(-90),
            // far ahead of a wave, values would decay until they are denormal numbers; below this
            // fraction of the speeds of the scene they are below the rounding of the values behind
            // the wave
            quiescent_speed: fastest * STILL,
            still_acceleration: fastest * fastest * STILL / smallest,
            still_pressure: densest * fastest * fastest * STILL,
        })
    }

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

    /// Whether heat conduction acts on `body`.
    pub fn conducts_heat(&self, body: usize) -> bool {
        self.thermals[body].as_ref().is_some_and(|thermal| thermal.conductivity.is_some())
    }

    /// Initial contact impulse of `body` at the initial `pressure` [Pa s].
    pub fn starting_impulse(&self, body: usize, pressure: f64) -> f64 {
        if pressure > 0.0 { self.max_adhesion_impulse[body] } else { self.starting_pull(body) }
    }

    /// Greatest initial extent of particles along a direction [cells].
    pub fn longest_at_start(&self, scene: &CheckedScene) -> f64 {
        let bodies = scene.bodies.iter();
        bodies
            .map(|c| {
                let in_cells = |a: usize, length: f64| length / scene.cell_size[a];
                match &c.tiles {
                    Some(tiles) => tiles
                        .iter()
                        .flat_map(|t| (0..D).map(|a| in_cells(a, t.size[a])))
                        .fold(0.0, f64::max),
                    None => (0..D)
                        .map(|a| in_cells(a, (c.upper[a] - c.lower[a]) / c.lattice[a] as f64))
                        .fold(0.0, f64::max),
                }
            })
            .fold(0.0, f64::max)
    }

    /// Stencil radius of particles up to `length` long [cells], with room to stretch in a step;
    /// `None` if they are longer than any stencil.
    pub fn reach(&self, length: f64) -> Option<StencilRadius> {
        let length = if self.domains_deform() { length * STRETCH } else { length };
        let nodes = self.shape.nodes(length);
        (nodes <= most_nodes(D)).then_some(StencilRadius { nodes, products: self.products() })
    }

    /// Number of products with a matrix between sums over particles and the gather.
    fn products(&self) -> usize {
        let own = self.transfer.products(self.compatible);
        let relaxed = self.relaxation.map_or(0, |_| relaxation::ORDER - 1);
        let effects = self.effects.iter().map(|e| e.products()).max().unwrap_or(0);
        own.max(relaxed).max(effects) as usize
    }

    /// Distance from moving material within which a step may change a particle, for a stencil
    /// radius [cells]. The terms of the filters and of the pressure projection spread velocity and
    /// pressure in each pass of a step over the grid. The velocity that does the work spreads
    /// further, but it does no work on material without stress.
    pub fn influence_radius(&self, reach: StencilRadius) -> i64 {
        let order = self.transfer.order.max(self.relaxation.map_or(0, |_| relaxation::ORDER));
        let pass = reach.cells() + i64::from(order) * (reach.nodes as i64 - 1) + 2;
        match (self.stepping, self.stress_update) {
            (Stepping::Midpoint, _) | (_, StressUpdate::Last) => pass,
            _ => 2 * pass,
        }
    }

    /// Conditions for quiescent patches: everything that a step computes has been computed at rest,
    /// including pressure relaxation.
    pub fn sleep(&self) -> Sleep {
        let f = &self.fields;
        Sleep {
            needed: 1 + self.relaxation.map_or(0, |r| r.interval),
            kept: [f.mass, f.inverse, f.volume, f.relaxation[0], f.relaxation[1]],
        }
    }

    /// Longest particle [cells] for which `reach` is sufficient.
    pub fn longest_within(&self, reach: StencilRadius) -> f64 {
        (reach.nodes + 1 - self.shape.nodes(0.01)) as f64
    }

    /// Longest particle [cells] for which any stencil is sufficient, with room to stretch.
    fn longest_ever(&self) -> f64 {
        self.longest_within(StencilRadius { nodes: most_nodes(D), products: 0 }) / STRETCH
    }

    /// Shortest edge of a cell [m].
    pub fn shortest_edge(&self) -> f64 {
        self.cell.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Whether the domain of the shape function grows with the particle.
    pub fn grows(&self) -> bool {
        self.extent() == DomainExtent::Current
    }

    fn extent(&self) -> DomainExtent {
        self.shape.extent()
    }

    /// Whether the shape function depends on a deforming domain.
    fn domains_deform(&self) -> bool {
        self.extent() == DomainExtent::Current && !self.total_lagrangian
    }

    /// Whether step number `step` (from 1) relaxes the pressure.
    fn relaxes(&self, step: u64) -> Option<f64> {
        self.relaxation.filter(|r| step.is_multiple_of(r.interval as u64)).map(|r| r.rate)
    }

    /// Finds the weights of all particles of a patch, with windows as wide as its longest particle
    /// needs. Returns whether they have been recomputed, not kept.
    fn find_weights(&self, patch: &mut Patch<D>) -> bool {
        fn find<S: Shape, const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Stepper<D>) {
            let layer = (s.layers > 1).then_some(s.columns.body);
            patch.find_weights::<S, K>(s.columns.fraction, s.columns.domain, s.inverse_cell, layer)
        }
        fn push<const K: usize, const D: usize>(patch: &mut Patch<D>, push: usize) {
            patch.stencils.push_gradients::<K, D>(&patch.block, push);
        }
        let recomputed = !(self.total_lagrangian && patch.stencils.are_kept(&patch.block));
        if recomputed {
            let width = self.shape.nodes(self.longest(&patch.block));
            with_shape!(self.shape, width, find(patch, self));
        }
        if let Some(inverse) = self.columns.inverse_deformation {
            if recomputed {
                patch.stencils.keep(&patch.block);
            }
            with_width!(patch.stencils.width, push(patch, inverse));
        }
        recomputed
    }

    /// Greatest extent of the domains of all particles of a patch along a direction [cells].
    fn longest(&self, block: &decomp::Block<D>) -> f64 {
        let column = |k: usize| &block.columns[self.columns.domain + k][..];
        let greatest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        match (D, self.extent()) {
            (1, _) => greatest(column(0)),
            (_, DomainExtent::Point) => 0.0,
            (_, DomainExtent::Undeformed) => greatest(column(0)).max(greatest(column(1))),
            (_, DomainExtent::Current) => {
                let along = |a: usize| {
                    let edges = column(a).iter().zip(column(a + 2));
                    edges.fold(0.0f64, |l, (r1, r2)| l.max(2.0 * (r1.abs() + r2.abs())))
                };
                along(0).max(along(1))
            }
        }
    }
}

/// Complete steps, compiled once in this crate for each dimension: they call functions that are
/// generic over shape functions, widths and dimensions, which otherwise would be compiled again in
/// every program that uses them.
pub trait Steps<const D: usize> {
    /// Completes the initial state: pressure, sound speed and, if the scheme needs it, the gradient
    /// of the initial velocity. Collective.
    fn prime(&self, world: &mut World<'_, D>) -> Result<(), decomp::ParticleError>;

    /// Advances all patches from `time` by `dt` [s]; `step` numbers the steps from 1. Collective.
    fn advance(
        &self,
        world: &mut World<'_, D>,
        time: f64,
        dt: f64,
        step: u64,
    ) -> Result<(), decomp::ParticleError>;
}

macro_rules! compile_steps {
    ($($dimension:literal),*) => {$(
        impl Steps<$dimension> for Stepper<$dimension> {
            fn prime(&self, world: &mut World<'_, $dimension>) -> Result<(), decomp::ParticleError> {
                let jacobian = self.columns.jacobian;
                let step = StepContext { stepper: self, start: 0.0, time: 0.0, dt: 0.0, jacobian };
                world.each("refresh", |patch| self.refresh(patch, &step));
                if self.stepping == Stepping::Midpoint {
                    self.prime_gradient(world)?;
                    world.each("refresh", |patch| self.refresh(patch, &step));
                }
                Ok(())
            }

            fn advance(
                &self,
                world: &mut World<'_, $dimension>,
                time: f64,
                dt: f64,
                step: u64,
            ) -> Result<(), decomp::ParticleError> {
                match self.stepping {
                    Stepping::Midpoint => {
                        self.advance_midpoint(world, time, dt, self.relaxes(step))
                    }
                    Stepping::Leapfrog => self.advance_leapfrog(world, time, dt),
                }
            }
        }
    )*};
}
compile_steps!(1, 2);

/// Length of a vector; exact along an axis.
#[inline(always)]
fn norm(v: &[f64]) -> f64 {
    match v {
        [x] => x.abs(),
        _ => v.iter().map(|x| x * x).sum::<f64>().sqrt(),
    }
}
