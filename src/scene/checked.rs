//! A scene that passed every check, with the quantities that follow from it.

use super::checked_body::CheckedBody;
use super::method_choice::MethodChoice;
use super::model::{Course, Eos, Geometry, Material, Scene, Side, SideProperties};
use super::moving_frame::Frame;

/// Largest gap between touching bodies; they may also overlap by this length [cells].
pub const TOUCHING: f64 = 1e-9;

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
        Frame::new(self.side_properties())
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

    /// Speed towards the axis, uniform along it, of body `i` in an axisymmetric scene [m/s].
    pub fn speed_to_axis(&self, i: usize) -> Option<f64> {
        let body = &self.bodies[i];
        match (self.axisymmetric(), &body.motion, &body.velocity[..]) {
            (true, None, &[radial, axial]) if radial < 0.0 && axial == 0.0 => Some(-radial),
            _ => None,
        }
    }

    /// Number of cells of the domain.
    pub fn cell_count(&self) -> u64 {
        self.cells.iter().map(|&n| n as u64).product()
    }

    /// The material of body `i`.
    pub fn material_of(&self, i: usize) -> &Material {
        &self.scene.materials[&self.scene.bodies[i].material]
    }

    /// Length below which a distance counts as zero [m], per direction.
    pub(crate) fn tolerance(&self, direction: usize) -> f64 {
        TOUCHING * self.cell_size[direction]
    }
}
