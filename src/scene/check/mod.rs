//! What the keys of a scene say of each other, checked whole before anything is built.
//!
//! The bounds of single numbers stand in the model and were checked on reading.

mod bodies;
mod boundary;
mod courant;
mod domain;
mod effects;
mod estimate;
mod faces;
mod frame;
mod front;
mod impact;
mod materials;
mod memory;
mod method;
mod motion;
mod output;
mod plane_reference;
mod reference;

use serde::Serialize;

use super::errors::{Fault, one_line};
use super::model::{Contact, Eos, Geometry, Material, Scene, Side};
use crate::scene::moving_frame::Frame;

pub use bodies::CheckedBody;
pub use boundary::{Piston, Wall};
pub(super) use memory::tiles;
pub use memory::{BYTES_PER_CELL, BYTES_PER_PARTICLE, BYTES_PER_PATCH, available_memory};

/// A scene that passed every check, and the numbers that follow from it.
#[derive(Clone, Debug)]
pub struct CheckedScene {
    /// The scene as it stands in the file, overrides put in.
    pub scene: Scene,
    /// Name of the scene's file in messages.
    pub file: String,
    /// Dimension D.
    pub dimension: usize,
    /// Edges of a cell [m], in each direction: as the scene has them, or the domain's edge over its
    /// cells where that is more than rounding away.
    pub cell_size: Vec<f64>,
    /// Cells in each direction.
    pub cells: Vec<usize>,
    /// Particles of all bodies.
    pub particles: u64,
    /// What follows for each body, in the order of the scene's.
    pub bodies: Vec<CheckedBody>,
    /// Times of the profiles [s], at least one.
    pub profile_times: Vec<f64>,
    /// Time from one row of the histories to the next [s]; none: no histories.
    pub history_interval: Option<f64>,
    /// What will run but is known to be inaccurate, one line each.
    pub warnings: Vec<String>,
}

impl CheckedScene {
    pub(super) fn new(scene: Scene, file: &str) -> Result<Self, Fault> {
        let mut warnings = Vec::new();
        check_printable("title", &scene.title)?;
        let domain::Grid { dimension, cell_size, cells } = domain::check(&scene.domain)?;
        method::check(&scene, &mut warnings)?;
        boundary::check(&scene)?;
        effects::check(&scene)?;
        let bodies = bodies::check(&scene, &cell_size, &mut warnings)?;
        let mut checked = CheckedScene {
            dimension,
            cell_size,
            cells,
            particles: bodies.iter().fold(0, |sum, body| sum.saturating_add(body.particles)),
            bodies,
            profile_times: output::profile_times(&scene)?,
            history_interval: output::history_interval(&scene),
            warnings,
            file: file.to_string(),
            scene,
        };
        memory::check_counts(&checked)?;
        method::check_bodies(&checked)?;
        method::check_positions(&checked)?;
        frame::check(&checked)?;
        boundary::check_transmitting(&mut checked)?;
        boundary::check_loads(&mut checked)?;
        courant::check(&mut checked)?;
        motion::check_body_force(&checked)?;
        output::check_tracers(&checked)?;
        output::check_checkpoints(&checked.scene)?;
        reference::check(&mut checked)?;
        estimate::check(&checked)?;
        if dimension == 1 {
            impact::check(&mut checked)?;
        }
        for warning in &mut checked.warnings {
            *warning = one_line(warning);
        }
        Ok(checked)
    }

    /// What stands at the sides, along each of `D` directions.
    pub fn sides<const D: usize>(&self) -> [[Side; 2]; D] {
        let boundary = self.scene.boundary.clone().unwrap_or_default();
        let y = [boundary.y_lower, boundary.y_upper].map(Option::unwrap_or_default);
        let all = [[boundary.x_lower, boundary.x_upper], y];
        std::array::from_fn(|a| all[a].clone())
    }

    /// The frame of the grid, which travels with a piston.
    pub fn frame<const D: usize>(&self) -> Frame<D> {
        Frame::new(self)
    }

    /// The velocity at which the grid travels with a piston at the start [m/s], in the scene's
    /// directions.
    pub fn grid_velocity<const D: usize>(&self) -> [f64; D] {
        self.frame().velocity(0.0)
    }

    /// Whether a piston's velocity changes, and the grid's with it.
    pub fn accelerates(&self) -> bool {
        self.sides::<2>()[..self.dimension]
            .as_flattened()
            .iter()
            .any(|side| matches!(side, Side::Velocity(course) if course.changes()))
    }

    /// The greatest speed with which bodies, as they start, and pistons can meet [m/s].
    pub fn impact_speed<const D: usize>(&self) -> f64 {
        let pistons = self.sides::<D>();
        let moving = pistons.iter().flatten().any(|s| matches!(s, Side::Velocity(_)));
        let piston = moving.then(|| self.frame::<D>().extremes()).into_iter().flatten();
        let bodies = self.bodies.iter().map(|b| std::array::from_fn(|a| b.velocity[a]));
        let all: Vec<[f64; D]> = bodies.chain(piston).collect();
        let apart = |a: &[f64; D], b: &[f64; D]| {
            a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
        };
        let pairs = all.iter().flat_map(|a| all.iter().map(move |b| apart(a, b)));
        let moved = self.bodies.iter().filter(|b| b.motion.is_some()).map(|b| b.top_speed);
        pairs.chain(moved).fold(0.0, f64::max)
    }

    /// Whether waves pass one of the sides.
    pub fn transmits(&self) -> bool {
        self.sides::<2>()[..self.dimension].as_flattened().contains(&Side::Transmitting)
    }

    /// Whether a pressure loads one of the sides.
    pub fn is_loaded(&self) -> bool {
        let sides = self.sides::<2>();
        let mut all = sides[..self.dimension].as_flattened().iter();
        all.any(|side| matches!(side, Side::Pressure(_)))
    }

    /// Whether particles of a body may be taken out of the run.
    pub fn erodes(&self) -> bool {
        (0..self.bodies.len()).any(|i| self.material_of(i).erosion.is_some())
    }

    /// Whether nothing gives the particles energy or lets them out but rigid sides.
    pub fn keeps_all(&self) -> bool {
        let sides = self.sides::<2>();
        let mut all = sides[..self.dimension].as_flattened().iter();
        let gives = |s: &Side| s.lets_out() || matches!(s, Side::Pressure(_) | Side::Friction(_));
        !self.accelerates() && !self.erodes() && !all.any(gives)
    }

    /// Whether one of the sides rubs.
    pub fn has_frictional_wall(&self) -> bool {
        let sides = self.sides::<2>();
        let mut all = sides[..self.dimension].as_flattened().iter();
        all.any(|side| matches!(side, Side::Friction(_)))
    }

    /// Whether x is a radius.
    pub fn axisymmetric(&self) -> bool {
        self.scene.domain.geometry == Geometry::Axisymmetric
    }

    /// Whether a body bears shear, so that stress is a tensor.
    pub fn has_solids(&self) -> bool {
        (0..self.bodies.len()).any(|i| self.material_of(i).bears_shear())
    }

    /// Whether a body's equation of state is such.
    pub fn has_eos(&self, such: impl Fn(&Eos) -> bool) -> bool {
        (0..self.bodies.len()).any(|i| such(&self.material_of(i).eos))
    }

    /// Whether patches at rest may be left out: where heat flows nothing is at rest, what a side
    /// is going to press on does not stay so, and seen from a grid that accelerates all falls.
    pub fn skips_quiet(&self) -> bool {
        let quiet = !self.conducts() && !self.is_loaded() && !self.accelerates();
        self.scene.decomposition.skip_quiet && quiet
    }

    /// Whether a body conducts heat.
    pub fn conducts(&self) -> bool {
        let conducts = |i| self.material_of(i).thermal.is_some_and(|t| t.conductivity.is_some());
        (0..self.bodies.len()).any(conducts)
    }

    /// Temperatures that the sides are held at [K], along each of `D` directions.
    pub fn held_temperatures<const D: usize>(&self) -> [[Option<f64>; 2]; D] {
        let held = self.scene.boundary.as_ref().and_then(|b| b.temperature).unwrap_or_default();
        let all = [[held.x_lower, held.x_upper], [held.y_lower, held.y_upper]];
        std::array::from_fn(|a| all[a])
    }

    /// Whether a side is held at a temperature.
    pub fn holds_temperature(&self) -> bool {
        self.held_temperatures::<2>().as_flattened().iter().any(Option::is_some)
    }

    /// Velocity fields: one for all bodies, or with contact one a body.
    pub fn velocity_fields(&self) -> usize {
        match self.scene.contact {
            None | Some(Contact::Stick {}) => 1,
            Some(Contact::Frictionless { .. } | Contact::Friction { .. }) => {
                self.scene.bodies.len()
            }
        }
    }

    /// The material of body `i`.
    pub fn material_of(&self, i: usize) -> &Material {
        &self.scene.materials[&self.scene.bodies[i].material]
    }

    /// Lengths below this are none [m], in each direction.
    fn tolerance(&self, direction: usize) -> f64 {
        bodies::TOUCHING * self.cell_size[direction]
    }
}

/// Characters of a name or title.
const LONGEST_NAME: usize = 200;

/// A name or title that is told in one line.
fn check_printable(path: &str, text: &str) -> Result<(), Fault> {
    if text.trim().is_empty() {
        return Err(Fault::new(path, text, "is empty; allowed: at least one printable character"));
    }
    if text.chars().count() > LONGEST_NAME {
        let reason = format!("is too long; allowed: at most {LONGEST_NAME} characters");
        return Err(Fault::new(path, text, reason));
    }
    if text != one_line(text) {
        let reason = "has a control character; allowed: one line of printable characters";
        return Err(Fault::new(path, text, reason));
    }
    Ok(())
}

/// One entry a direction.
fn check_length<T: Serialize>(path: &str, values: &[T], dimension: usize) -> Result<(), Fault> {
    if values.len() == dimension {
        return Ok(());
    }
    let plural = if dimension == 1 { "" } else { "s" };
    let reason = format!(
        "{} numbers, but domain.lower has {dimension}, which is the dimension of the scene; \
         allowed: {dimension} number{plural}",
        values.len()
    );
    Err(Fault::new(path, values, reason))
}

/// The lower corner below the upper one.
fn check_box(path: &str, lower: &[f64], upper: &[f64]) -> Result<(), Fault> {
    if lower.iter().zip(upper).all(|(l, u)| l < u) {
        return Ok(());
    }
    let lower = serde_json::json!(lower);
    let reason = format!("not above {path}.lower = {lower}; allowed: lower < upper");
    Err(Fault::new(format!("{path}.upper"), upper, reason))
}
