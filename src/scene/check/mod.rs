//! Checks of the relations between keys, all done before anything is built.
//!
//! The bounds of single numbers are part of the model and are checked on reading.

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
mod plausibility;
mod reference;

use serde::Serialize;

use super::errors::{SceneFault, one_line};
use super::model::{Course, Eos, Geometry, Material, Scene, Side, SideProperties};
use crate::material::parameter_error::wrong_length;
use crate::scene::moving_frame::Frame;
use crate::scene::preset::MethodChoice;

pub use bodies::CheckedBody;
pub use boundary::{Piston, Wall};
pub(super) use memory::tiles;
pub use memory::{BYTES_PER_CELL, BYTES_PER_PARTICLE, BYTES_PER_PATCH, available_memory};

/// A scene that passed every check, with the quantities that follow from it.
#[derive(Clone, Debug)]
pub struct CheckedScene {
    /// The scene as in its file, with overrides applied.
    pub scene: Scene,
    /// Name of the scene's file, for messages.
    pub file: String,
    /// Dimension D.
    pub dimension: usize,
    /// Edges of a cell in each direction [m]: as given in the scene, or the domain's edge over its
    /// number of cells if the difference is more than rounding.
    pub cell_size: Vec<f64>,
    /// Number of cells in each direction.
    pub cells: Vec<usize>,
    /// Number of particles of all bodies.
    pub particles: u64,
    /// Quantities that follow for each body, in the order of the scene.
    pub bodies: Vec<CheckedBody>,
    /// Times of the profiles [s], at least one.
    pub profile_times: Vec<f64>,
    /// Time between rows of the histories [s]; `None`: no histories.
    pub history_interval: Option<f64>,
    /// Warnings about settings that run but are known to be inaccurate, one line each.
    pub warnings: Vec<String>,
    /// Choice of the method; `None` if the scene gives it in full.
    pub method_choice: Option<MethodChoice>,
}

impl CheckedScene {
    pub(super) fn new(scene: Scene, file: &str) -> Result<Self, SceneFault> {
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
            method_choice: None,
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
        checked.warnings.extend(plausibility::warnings(&checked));
        for warning in &mut checked.warnings {
            *warning = one_line(warning);
        }
        Ok(checked)
    }

    /// Conditions at the two sides of each of the `D` directions.
    pub fn sides<const D: usize>(&self) -> [[Side; 2]; D] {
        let boundary = self.scene.boundary.clone().unwrap_or_default();
        let y = [boundary.y_lower, boundary.y_upper].map(Option::unwrap_or_default);
        let all = [[boundary.x_lower, boundary.x_upper], y];
        std::array::from_fn(|a| all[a].clone())
    }

    /// Properties of the two sides of each of the `D` directions.
    pub fn side_properties<const D: usize>(&self) -> [[SideProperties; 2]; D] {
        self.sides().map(|ends| ends.map(|side| side.properties()))
    }

    /// Whether any side satisfies `such`.
    pub fn has_side(&self, such: impl Fn(&SideProperties) -> bool) -> bool {
        self.side_properties::<2>()[..self.dimension].as_flattened().iter().any(such)
    }

    /// Frame of the grid, which moves with a piston.
    pub fn frame<const D: usize>(&self) -> Frame<D> {
        Frame::new(self)
    }

    /// Initial velocity of the grid, which moves with a piston [m/s], in the scene's coordinates.
    pub fn grid_velocity<const D: usize>(&self) -> [f64; D] {
        self.frame().velocity(0.0)
    }

    /// Whether the velocity of a piston, and hence of the grid, changes.
    pub fn accelerates(&self) -> bool {
        self.has_side(|side| side.rigid_velocity.as_ref().is_some_and(Course::changes))
    }

    /// Largest possible relative speed between bodies, with their initial velocities, and pistons
    /// [m/s].
    pub fn impact_speed<const D: usize>(&self) -> f64 {
        let moving = self.has_side(|side| side.moves_grid);
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

    /// Whether any side is transmitting.
    pub fn transmits(&self) -> bool {
        self.has_side(|side| side.absorbs_waves)
    }

    /// Whether any side applies a pressure.
    pub fn is_loaded(&self) -> bool {
        self.has_side(|side| side.pressure.is_some())
    }

    /// Whether particles of a body may be eroded.
    pub fn erodes(&self) -> bool {
        (0..self.bodies.len()).any(|i| self.material_of(i).erosion.is_some())
    }

    /// Whether only rigid sides without friction exchange energy with the particles, and none can
    /// leave.
    pub fn keeps_all(&self) -> bool {
        let gives = |s: &SideProperties| s.lets_out || s.pressure.is_some() || s.friction.is_some();
        !self.accelerates() && !self.erodes() && !self.has_side(gives)
    }

    /// Whether any side has friction.
    pub fn has_frictional_wall(&self) -> bool {
        self.has_side(|side| side.friction.is_some())
    }

    /// Whether the domain is axisymmetric, with x as the radius.
    pub fn axisymmetric(&self) -> bool {
        self.scene.domain.geometry == Geometry::Axisymmetric
    }

    /// Whether any body has shear strength, so that stress is a tensor.
    pub fn has_solids(&self) -> bool {
        (0..self.bodies.len()).any(|i| self.material_of(i).bears_shear())
    }

    /// Whether the equation of state of any body satisfies `such`.
    pub fn has_eos(&self, such: impl Fn(&Eos) -> bool) -> bool {
        (0..self.bodies.len()).any(|i| such(&self.material_of(i).eos))
    }

    /// Whether quiescent patches may be skipped. Not with heat conduction, with a side that applies
    /// a pressure, or on an accelerating grid, where nothing stays at rest.
    pub fn skips_quiet(&self) -> bool {
        let quiet = !self.conducts() && !self.is_loaded() && !self.accelerates();
        self.scene.decomposition.skip_quiescent && quiet
    }

    /// Whether a body conducts heat.
    pub fn conducts(&self) -> bool {
        let conducts = |i| self.material_of(i).thermal.is_some_and(|t| t.conductivity.is_some());
        (0..self.bodies.len()).any(conducts)
    }

    /// Fixed temperatures of the two sides [K] of each of the `D` directions.
    pub fn held_temperatures<const D: usize>(&self) -> [[Option<f64>; 2]; D] {
        let held = self.scene.boundary.as_ref().and_then(|b| b.temperature).unwrap_or_default();
        let all = [[held.x_lower, held.x_upper], [held.y_lower, held.y_upper]];
        std::array::from_fn(|a| all[a])
    }

    /// Whether any side has a fixed temperature.
    pub fn holds_temperature(&self) -> bool {
        self.held_temperatures::<2>().as_flattened().iter().any(Option::is_some)
    }

    /// Number of velocity fields: one for all bodies, or with contact one per body.
    pub fn velocity_fields(&self) -> usize {
        match self.scene.contact.and_then(|contact| contact.condition()) {
            None => 1,
            Some(_) => self.scene.bodies.len(),
        }
    }

    /// The material of body `i`.
    pub fn material_of(&self, i: usize) -> &Material {
        &self.scene.materials[&self.scene.bodies[i].material]
    }

    /// Length below which a distance counts as zero [m], per direction.
    fn tolerance(&self, direction: usize) -> f64 {
        bodies::TOUCHING * self.cell_size[direction]
    }
}

/// Maximum number of characters of a name or title.
const LONGEST_NAME: usize = 200;

/// Checks that a name or title is one printable line.
fn check_printable(path: &str, text: &str) -> Result<(), SceneFault> {
    if text.trim().is_empty() {
        return Err(SceneFault::new(
            path,
            text,
            "is empty; allowed: at least one printable character",
        ));
    }
    if text.chars().count() > LONGEST_NAME {
        let reason = format!("is too long; allowed: at most {LONGEST_NAME} characters");
        return Err(SceneFault::new(path, text, reason));
    }
    if text != one_line(text) {
        let reason = "has a control character; allowed: one line of printable characters";
        return Err(SceneFault::new(path, text, reason));
    }
    Ok(())
}

/// Checks that there is one entry per direction.
fn check_length<T: Serialize>(
    path: &str,
    values: &[T],
    dimension: usize,
) -> Result<(), SceneFault> {
    if values.len() == dimension {
        return Ok(());
    }
    Err(SceneFault::new(path, values, wrong_length(values.len(), dimension)))
}

/// Checks that the lower corner is below the upper one.
fn check_box(path: &str, lower: &[f64], upper: &[f64]) -> Result<(), SceneFault> {
    if lower.iter().zip(upper).all(|(l, u)| l < u) {
        return Ok(());
    }
    let lower = serde_json::json!(lower);
    let reason = format!("not above {path}.lower = {lower}; allowed: lower < upper");
    Err(SceneFault::new(format!("{path}.upper"), upper, reason))
}
