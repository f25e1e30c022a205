//! One time step, written as the method reads in a paper.
//!
//! [`Stepper`] holds what a scene chose; [`Steps::advance`] runs the list of phases of
//! [`midpoint`] or [`leapfrog`]. Physics and messages meet in [`World`], which calls a phase on
//! every patch and the exchanges between phases.

mod body_force;
mod burn;
pub mod clock;
mod conduction;
mod contact;
mod erosion;
mod exchange;
mod failure;
pub mod gather;
mod inertial_force;
pub mod leapfrog;
pub mod midpoint;
pub mod nodal_fields;
mod particle_domains;
mod particle_update;
pub mod particles;
pub mod patch;
mod pressure_load;
mod reach;
pub mod relaxation;
pub mod scatter;
pub mod series;
pub mod shape;
pub mod shape_weights;
mod sides;
mod solid;
mod strength;
mod thermal;
mod total_lagrangian;
pub mod transfer;

pub use exchange::{Nodal, Sleep, World};
pub use reach::Reach;

use self::shape::{Extent, Shape};
use crate::effects::artificial_viscosity::Viscosity;
use crate::effects::contact::Contact;
use crate::material::constitutive::{self, Criterion, Erosion, Flow, Matter, Outside, Thermal};
use crate::material::strength::Condition;
use crate::scene::moving_frame::Frame;
use crate::scene::{
    CheckedScene, EnergyUpdate, FrameKind, Material, PressureRelaxation, ShapeKind, Side, Stepping,
    StressUpdate,
};
use crate::solver::nodal_fields::{Fields, Wanted};
use crate::solver::particles::Columns;
use crate::solver::patch::Patch;
use crate::solver::transfer::{MOST_NODES, Scheme};

/// What a scene chose, made ready for stepping.
pub struct Stepper<const D: usize> {
    /// Where the columns stand.
    pub columns: Columns,
    /// Where the nodal fields stand.
    pub fields: Fields,
    scheme: Scheme,
    stepping: Stepping,
    stress_update: StressUpdate,
    compatible: bool,
    filter_heat: bool,
    relaxation: Option<PressureRelaxation>,
    volume_relaxation: Option<f64>,
    edge_mask: Option<f64>,
    viscosity: Option<Viscosity>,
    body_force: Option<body_force::Force>,
    /// The grid's, if it accelerates.
    frame: Option<Frame<D>>,
    /// Contact between velocity fields of the bodies' own.
    contact: Option<Contact>,
    /// Velocity fields, each in a layer of the nodal arrays: one for all bodies, or one a body.
    pub layers: usize,
    /// rho c^2 of each body as it starts [Pa].
    stiffness: Vec<f64>,
    /// Acoustic impedance rho c of each body as it starts [Pa s/m].
    impedances: Vec<f64>,
    /// The speed of the scene's impacts, the most of all its bodies [m/s].
    impact: f64,
    /// The most impulse that each body may give back where it is pulled on [Pa s].
    most_pull: Vec<f64>,
    /// The state in which each body starts.
    rest: Vec<sides::Rest<D>>,
    /// One a body.
    models: Vec<Matter>,
    /// What each body's material bears of shear beside its equation of state.
    flows: Vec<Option<Box<dyn Flow>>>,
    /// When each body's material fails.
    criteria: Vec<Option<Criterion>>,
    /// When each body's particles are taken out, if those of any are.
    erosion: Option<Vec<Option<Erosion>>>,
    /// How each body's temperature follows.
    thermals: Vec<Option<Thermal>>,
    /// How heat is conducted.
    conduction: Option<conduction::Conduction<D>>,
    /// The column of its material's history, one a body.
    history: Vec<Option<usize>>,
    /// How it burns, one a body, if any does.
    burns: Option<Vec<Option<burn::Burns>>>,
    shape: ShapeKind,
    /// Whether the shape functions are taken at the particles' first places.
    total: bool,
    /// Edges of a cell [m] and their inverse.
    cell: [f64; D],
    inverse_cell: [f64; D],
    /// Edge of a square or line of a cell's volume [m].
    edge: f64,
    /// Lower corner of the domain [m] and its number of cells.
    lower: [f64; D],
    cells: [i64; D],
    sides: [[Side; 2]; D],
    /// Directions with a wall without slip.
    no_slip: [bool; D],
    /// Whether x is a radius: what moves outward is strained about the axis.
    axisymmetric: bool,
    /// Longest half diagonal of a particle's domain [cells], with a limit.
    domain_limit: Option<f64>,
    /// Whether patches at rest are left out.
    may_sleep: bool,
    /// The fastest speed of the start, of bodies or sound [m/s].
    pub fastest: f64,
    /// Mass below which a node counts as empty [kg].
    empty_mass: f64,
    /// Nodal speed below which a node counts as at rest [m/s].
    still_speed: f64,
    /// Acceleration that brings a node to that speed while the fastest wave passes a cell [m/s2].
    still_acceleration: f64,
    /// Nodal pressure below which a node counts as free of stress [Pa].
    still_pressure: f64,
}

/// Share of a scene's fastest speed at which a nodal velocity counts as none; accelerations and
/// pressures go with it. Alike everywhere, whatever sleeps.
const STILL: f64 = 1.0 / (1u64 << 50) as f64;

/// Calls `$call` with the type of a shape function, a number of nodes known at compile time, at
/// least `$nodes`, and the dimension. One line a shape function.
macro_rules! with_shape {
    ($kind:expr, $nodes:expr, $call:ident ( $($arg:expr),* )) => {
        match $kind {
            ShapeKind::Linear => $call::<shape::Linear, 2, D>($($arg),*),
            ShapeKind::Gimp => with_shape!(@wide $call, shape::Gimp, $nodes, $($arg),*),
            ShapeKind::Cpdi => with_shape!(@wide $call, shape::Cpdi, $nodes, $($arg),*),
            ShapeKind::BsplineQuadratic => $call::<shape::BsplineQuadratic, 3, D>($($arg),*),
            ShapeKind::BsplineCubic => $call::<shape::BsplineCubic, 4, D>($($arg),*),
            ShapeKind::CpdiBsplineQuadratic => {
                with_shape!(@wide $call, shape::CpdiBsplineQuadratic, $nodes, $($arg),*)
            }
        }
    };
    (@wide $call:ident, $shape:ty, $nodes:expr, $($arg:expr),*) => {
        match $nodes {
            0..=3 => $call::<$shape, 3, D>($($arg),*),
            4 => $call::<$shape, 4, D>($($arg),*),
            5..=6 => $call::<$shape, 6, D>($($arg),*),
            _ if D > 1 || $nodes <= 10 => $call::<$shape, 10, D>($($arg),*),
            _ => $call::<$shape, MOST_NODES, D>($($arg),*),
        }
    };
}

/// Calls `$call` with the width of a patch's stencils known at compile time, and the dimension.
macro_rules! with_width {
    ($width:expr, $call:ident ( $($arg:expr),* )) => {
        match $width {
            0..=2 => $call::<2, D>($($arg),*),
            3 => $call::<3, D>($($arg),*),
            4 => $call::<4, D>($($arg),*),
            6 => $call::<6, D>($($arg),*),
            _ if D > 1 || $width <= 10 => $call::<10, D>($($arg),*),
            _ => $call::<MOST_NODES, D>($($arg),*),
        }
    };
}
use with_width;

/// Most nodes along one direction that a particle may touch, in a plane.
const MOST_NODES_IN_PLANE: usize = 10;

/// Most nodes along one direction that a particle may touch.
const fn most_nodes(dimension: usize) -> usize {
    if dimension == 1 { MOST_NODES } else { MOST_NODES_IN_PLANE }
}

/// How much longer a particle may be at the middle of a step than at its start.
const STRETCH: f64 = 1.25;

/// Waves in a body at rest.
struct Waves {
    /// Speed of shear waves [m/s]; none in a fluid without strength.
    shear: f64,
    /// What shear adds to the square of the sound speed, 4 G/(3 rho) of a material with strength
    /// [m2/s2].
    added: f64,
}

impl Waves {
    fn of(material: &Material, model: &Matter, flow: Option<&dyn Flow>) -> Self {
        let rest = Condition {
            compression: 1.0,
            pressure: 0.0,
            temperature: material.thermal.map_or(f64::NAN, |t| t.reference_temperature),
        };
        match flow {
            None => Waves { shear: model.shear_speed(), added: 0.0 },
            Some(flow) => {
                let square = flow.shear_modulus(&rest) / material.density;
                Waves { shear: square.sqrt(), added: 4.0 / 3.0 * square }
            }
        }
    }

    /// Speed of the fastest wave where the sound speed without strength is `sound` [m/s].
    fn fastest(&self, sound: f64) -> f64 {
        if self.added > 0.0 { (sound * sound + self.added).sqrt() } else { sound }
    }
}

impl<const D: usize> Stepper<D> {
    /// What `scene` chose.
    pub fn new(scene: &CheckedScene) -> Self {
        Self::with_models(scene, &|_| None).expect("there is nothing to replace")
    }

    /// What `scene` chose, with the models of `outside` in place of those of materials; it is
    /// asked by name, once a body.
    ///
    /// # Errors
    ///
    /// The material's name, and why it has no place for them.
    pub fn with_models(
        scene: &CheckedScene,
        outside: &dyn Fn(&str) -> Option<Outside>,
    ) -> Result<Self, (String, String)> {
        let method = &scene.scene.method;
        let viscosity = scene.scene.artificial_viscosity.as_ref();
        let bodies = &scene.scene.bodies;
        let materials = &scene.scene.materials;
        let cell: [f64; D] = std::array::from_fn(|a| scene.cell_size[a]);
        let volume: f64 = cell.iter().product();
        let smallest = cell.iter().copied().fold(f64::INFINITY, f64::min);
        let mut models: Vec<Matter> =
            bodies.iter().map(|b| constitutive::build(&materials[&b.material])).collect();
        let mut flows: Vec<_> =
            bodies.iter().map(|b| constitutive::flow_of(&materials[&b.material])).collect();
        for (b, (model, flow)) in bodies.iter().zip(models.iter_mut().zip(&mut flows)) {
            if let Some(own) = outside(&b.material) {
                own.replace(&materials[&b.material], model, flow)
                    .map_err(|reason| (b.material.clone(), reason))?;
            }
        }
        let criteria = bodies.iter().map(|b| constitutive::criterion_of(&materials[&b.material]));
        let erosion = scene.erodes().then(|| {
            bodies.iter().map(|b| constitutive::erosion_of(&materials[&b.material])).collect()
        });
        let thermals = (bodies.iter().zip(&models))
            .map(|(b, model)| constitutive::thermal_of(&materials[&b.material], model));
        let waves: Vec<Waves> = (bodies.iter().zip(models.iter().zip(&flows)))
            .map(|(b, (model, flow))| Waves::of(&materials[&b.material], model, flow.as_deref()))
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
        let stiffness = speeds().map(|(_, density, c)| density * c.powi(2)).collect();
        let impedances = speeds().map(|(_, density, c)| density * c).collect();
        let impact = scene.impact_speed::<D>();
        let speed =
            |pressure: f64, density: f64, c: f64| impact.max(pressure.abs() / (density * c));
        let most_pull = speeds()
            .map(|(b, density, c)| {
                contact::PULL * density * smallest * speed(b.pressure, density, c)
            })
            .collect();
        let impact =
            speeds().map(|(b, density, c)| speed(b.pressure, density, c)).fold(0.0, f64::max);
        let densest = bodies.iter().map(|b| materials[&b.material].density).fold(0.0, f64::max);
        // of a cell, and of a radian about an axis: that of the outermost
        let around = match scene.axisymmetric() {
            true => scene.scene.domain.lower[0] + scene.cells[0] as f64 * cell[0],
            false => 1.0,
        };
        // exact where all are the same
        let edge = match cell.iter().all(|&h| h == cell[0]) {
            true => cell[0],
            false => volume.powf(1.0 / D as f64),
        };
        let scheme: Scheme = method.transfer.into();
        let series = match scheme {
            Scheme::Series { force, .. } => 1 + usize::from(force),
            Scheme::Blend(_) | Scheme::Affine => 0,
        };
        let relaxed = method.pressure_relaxation.is_some();
        let contact = scene.scene.contact.as_ref().and_then(Contact::new);
        let contact = contact.filter(|_| scene.velocity_fields() > 1);
        let rubs = D > 1 && contact.is_some_and(|c| c.coefficient.is_some());
        let rubs = rubs || scene.has_frictional_wall();
        let columns = Columns::new(scene);
        let history = burn::histories(&columns, &models, scene);
        let (masked, sides) = (method.edge_mask.is_some(), Self::side_sums(scene));
        Ok(Stepper {
            burns: burn::Burns::of(scene),
            history,
            columns,
            fields: Fields::new(
                D,
                Wanted { series, masked, relaxed, rubs, conducts: scene.conducts(), sides },
            ),
            conduction: conduction::Conduction::new(scene),
            scheme,
            stepping: method.stepping,
            stress_update: method.stress_update,
            compatible: method.energy == EnergyUpdate::Compatible,
            filter_heat: method.filter_heat,
            relaxation: method.pressure_relaxation,
            volume_relaxation: method.volume_relaxation,
            edge_mask: method.edge_mask,
            viscosity: viscosity.map(|v| Viscosity::new(v, edge)),
            body_force: body_force::Force::new(scene),
            frame: scene.accelerates().then(|| scene.frame()),
            contact,
            layers: scene.velocity_fields(),
            stiffness,
            impedances,
            impact,
            most_pull,
            rest: sides::Rest::of(scene, &models, &waves),
            criteria: criteria.collect(),
            erosion,
            thermals: thermals.collect(),
            models,
            flows,
            shape: method.shape,
            total: method.frame == FrameKind::TotalLagrangian,
            cell,
            inverse_cell: cell.map(|h| 1.0 / h),
            edge,
            lower: std::array::from_fn(|a| scene.scene.domain.lower[a]),
            cells: std::array::from_fn(|a| scene.cells[a] as i64),
            no_slip: scene.sides().map(|ends| ends.contains(&Side::NoSlip)),
            sides: scene.sides(),
            axisymmetric: scene.axisymmetric(),
            domain_limit: method.domain_limit,
            may_sleep: scene.skips_quiet(),
            fastest,
            // what such a node holds is below rounding of its neighbours
            empty_mass: densest * volume * around * 2f64.powi(-90),
            // far ahead of a wave values would fall and fall, until they are denormal; at this
            // share of the scene's speeds they are below rounding of what is behind it
            still_speed: fastest * STILL,
            still_acceleration: fastest * fastest * STILL / smallest,
            still_pressure: densest * fastest * fastest * STILL,
        })
    }

    /// The specific internal energy at which `body` starts at `pressure` [J/kg].
    /// With a `temperature` of its own [K], the energy is what that one takes.
    pub fn starting_energy(&self, body: usize, pressure: f64, temperature: Option<f64>) -> f64 {
        match (temperature, &self.thermals[body]) {
            (Some(t), Some(thermal)) if thermal.isentrope.is_some() => thermal.energy_at(t),
            _ => self.models[body].energy_at(pressure),
        }
    }

    /// The least specific internal energy that the particles of each body may have [J/kg]: what
    /// adiabatic flow leaves of the energy of the start, or where heat is conducted absolute zero.
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

    /// Acoustic impedance rho c of `body` as it starts [Pa s/m].
    pub fn impedance(&self, body: usize) -> f64 {
        self.impedances[body]
    }

    /// Whether conduction moves heat into and out of `body`.
    pub fn conducts_heat(&self, body: usize) -> bool {
        self.thermals[body].as_ref().is_some_and(|thermal| thermal.conductivity.is_some())
    }

    /// What `body` has been pressed with where it starts at `pressure` [Pa s].
    pub fn starting_impulse(&self, body: usize, pressure: f64) -> f64 {
        if pressure > 0.0 { self.most_pull[body] } else { self.starting_pull(body) }
    }

    /// The greatest extent along a direction of the particles that `scene` starts with [cells].
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

    /// The reach of particles up to `length` long [cells], with room to stretch in a step; `None`
    /// if they are longer than any stencil.
    pub fn reach(&self, length: f64) -> Option<Reach> {
        fn nodes<S: Shape, const K: usize, const D: usize>(length: f64) -> usize {
            S::nodes(length)
        }
        let length = if self.domains_deform() { length * STRETCH } else { length };
        let nodes = with_shape!(self.shape, 4usize, nodes(length));
        (nodes <= most_nodes(D)).then_some(Reach { nodes, products: self.products() })
    }

    /// Products with a matrix that lie between the particles' sums and what they take back.
    fn products(&self) -> usize {
        let own = match self.scheme {
            Scheme::Series { order, force } => {
                let work = if force { order } else { 1 };
                order - 1 + if self.compatible { work } else { 0 }
            }
            Scheme::Blend(_) if self.compatible => 1,
            Scheme::Blend(_) | Scheme::Affine => 0,
        };
        let relaxed = self.relaxation.map_or(0, |_| relaxation::ORDER - 1);
        own.max(relaxed).max(self.conduction.as_ref().map_or(0, |_| conduction::ORDER)) as usize
    }

    /// How far about moving material a step may change a row by `reach` [cells]: the filters' and
    /// the pressure projection's terms spread velocity and pressure, in each of a step's passes
    /// over the grid. What does the work spreads further, but on material without stress it does
    /// none.
    pub fn notice(&self, reach: Reach) -> i64 {
        let order = match self.scheme {
            Scheme::Series { order, .. } => order,
            Scheme::Blend(_) | Scheme::Affine => 1,
        };
        let order = order.max(self.relaxation.map_or(0, |_| relaxation::ORDER));
        let pass = reach.cells() + i64::from(order) * (reach.nodes as i64 - 1) + 2;
        match (self.stepping, self.stress_update) {
            (Stepping::Midpoint, _) | (_, StressUpdate::Last) => pass,
            _ => 2 * pass,
        }
    }

    /// When patches may sleep: once everything that a step computes has been computed at rest,
    /// pressure relaxation included.
    pub fn sleep(&self) -> Sleep {
        let f = &self.fields;
        Sleep {
            needed: 1 + self.relaxation.map_or(0, |r| r.interval),
            kept: [f.mass, f.inverse, f.volume, f.relaxation[0], f.relaxation[1]],
        }
    }

    /// The longest particle [cells] that `reach` is deep enough for.
    pub fn longest_within(&self, reach: Reach) -> f64 {
        fn nodes<S: Shape, const K: usize, const D: usize>() -> usize {
            S::nodes(0.01)
        }
        (reach.nodes + 1 - with_shape!(self.shape, 4usize, nodes())) as f64
    }

    /// The longest particle [cells] that any reach is deep enough for, with room to stretch.
    fn longest_ever(&self) -> f64 {
        self.longest_within(Reach { nodes: most_nodes(D), products: 0 }) / STRETCH
    }

    /// The shortest edge of a cell [m].
    pub fn shortest_edge(&self) -> f64 {
        self.cell.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Whether the shape function grows with the particle.
    pub fn grows(&self) -> bool {
        self.extent() == Extent::Current
    }

    fn extent(&self) -> Extent {
        Extent::of(self.shape)
    }

    /// Whether the shape function looks at a domain that deforms.
    fn domains_deform(&self) -> bool {
        self.extent() == Extent::Current && !self.total
    }

    /// Whether step number `step` (from 1) relaxes the pressure.
    fn relaxes(&self, step: u64) -> Option<f64> {
        self.relaxation.filter(|r| step.is_multiple_of(r.interval as u64)).map(|r| r.rate)
    }

    /// Weights of all rows of a patch, as wide as its longest row needs. Tells whether they have
    /// been found anew, not kept.
    fn find_weights(&self, patch: &mut Patch<D>) -> bool {
        fn find<S: Shape, const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Stepper<D>) {
            let layer = (s.layers > 1).then_some(s.columns.body);
            patch.find_weights::<S, K>(s.columns.fraction, s.columns.domain, s.inverse_cell, layer)
        }
        fn nodes<S: Shape, const K: usize, const D: usize>(length: f64) -> usize {
            S::nodes(length)
        }
        fn push<const K: usize, const D: usize>(patch: &mut Patch<D>, push: usize) {
            patch.stencils.push_gradients::<K, D>(&patch.block, push);
        }
        let anew = !(self.total && patch.stencils.are_kept(&patch.block));
        if anew {
            let width = with_shape!(self.shape, 4usize, nodes(self.longest(&patch.block)));
            with_shape!(self.shape, width, find(patch, self));
        }
        if let Some(inverse) = self.columns.push {
            if anew {
                patch.stencils.keep(&patch.block);
            }
            with_width!(patch.stencils.width, push(patch, inverse));
        }
        anew
    }

    /// The greatest extent along a direction of the domains of all rows of a patch [cells].
    fn longest(&self, block: &decomp::Block<D>) -> f64 {
        let column = |k: usize| &block.columns[self.columns.domain + k][..];
        let greatest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        match (D, self.extent()) {
            (1, _) => greatest(column(0)),
            (_, Extent::Point) => 0.0,
            (_, Extent::Undeformed) => greatest(column(0)).max(greatest(column(1))),
            (_, Extent::Current) => {
                let along = |a: usize| {
                    let edges = column(a).iter().zip(column(a + 2));
                    edges.fold(0.0f64, |l, (r1, r2)| l.max(2.0 * (r1.abs() + r2.abs())))
                };
                along(0).max(along(1))
            }
        }
    }
}

/// Whole steps, compiled once in this crate for each dimension: what they call is generic over
/// shape functions, widths and dimensions, and every program that used them as generic functions
/// would compile all of it again.
pub trait Steps<const D: usize> {
    /// Makes the starting state whole: pressure, sound speed and, where the scheme needs it, the
    /// gradient of the starting velocity. Collective.
    fn prime(&self, world: &mut World<'_, D>) -> Result<(), decomp::RowError>;

    /// Advances all patches from `time` by `dt` [s]; `step` numbers the steps from 1. Collective.
    fn advance(
        &self,
        world: &mut World<'_, D>,
        time: f64,
        dt: f64,
        step: u64,
    ) -> Result<(), decomp::RowError>;
}

macro_rules! compile_steps {
    ($($dimension:literal),*) => {$(
        impl Steps<$dimension> for Stepper<$dimension> {
            fn prime(&self, world: &mut World<'_, $dimension>) -> Result<(), decomp::RowError> {
                world.each("refresh", |patch| self.refresh(patch));
                if self.stepping == Stepping::Midpoint {
                    self.prime_gradient(world)?;
                    world.each("refresh", |patch| self.refresh(patch));
                }
                Ok(())
            }

            fn advance(
                &self,
                world: &mut World<'_, $dimension>,
                time: f64,
                dt: f64,
                step: u64,
            ) -> Result<(), decomp::RowError> {
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
