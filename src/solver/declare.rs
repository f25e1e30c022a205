//! Declaration of columns: name, unit, role and mirror rule.

use decomp::{ColumnSpec, Mirror};

use super::columns::{Columns, OutputColumn};
use crate::scene::CheckedScene;

/// Role of the values of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Part of the state, for own particles only.
    State,
    /// Part of the state, also sent to ghosts.
    GhostState,
    /// Computed in each step, for own particles only.
    Scratch,
    /// Computed in each step, also sent to ghosts.
    GhostScratch,
}

/// Name of a vector on a line, then of its components in a plane.
pub type VectorNames = [&'static str; 3];

/// Names of the components of a tensor: xx, xy, yx, yy; on a line the first.
pub type TensorNames = [&'static str; 4];

/// Names of the components of a symmetric tensor: xx, yy, xy; on a line the first.
pub type SymmetricNames = [&'static str; 3];

/// Declares columns in the order of the calls.
pub struct Declare<'a> {
    pub(super) scene: &'a CheckedScene,
    /// The columns declared so far.
    pub(super) columns: Columns,
    owner: Option<usize>,
    pub(super) ghost_bodies: bool,
    pub(super) velocity_gradient: bool,
}

impl<'a> Declare<'a> {
    pub(super) fn new(scene: &'a CheckedScene) -> Self {
        let none = vec![None; scene.bodies.len()];
        let columns = Columns { history: none.clone(), tension_free: none, ..Columns::default() };
        Declare { scene, columns, owner: None, ghost_bodies: false, velocity_gradient: false }
    }

    /// Sets the part of a step that the following columns belong to.
    pub fn set_owner(&mut self, part: Option<usize>) {
        self.owner = part;
    }

    pub(super) fn plane(&self) -> bool {
        self.scene.dimension > 1
    }

    /// Adds consecutive columns, with the mirror rule of each.
    pub(super) fn add(
        &mut self,
        names: &[&'static str],
        unit: &'static str,
        role: Role,
        mirror: impl Fn(usize) -> Mirror,
    ) -> usize {
        let first = self.columns.specs.len();
        for (k, &name) in names.iter().enumerate() {
            self.columns.specs.push(ColumnSpec {
                name,
                unit,
                ghost: matches!(role, Role::GhostState | Role::GhostScratch),
                state: matches!(role, Role::State | Role::GhostState),
                mirror: mirror(k),
            });
            self.columns.owners.push(self.owner);
        }
        first
    }

    /// Declares a scalar with an SI unit.
    pub fn scalar(&mut self, name: &'static str, unit: &'static str, role: Role) -> usize {
        self.add(&[name], unit, role, |_| Mirror::Same)
    }

    /// Declares a vector; a mirror changes the sign of its normal component.
    pub fn vector(&mut self, names: VectorNames, unit: &'static str, role: Role) -> usize {
        let names = if self.plane() { &names[1..] } else { &names[..1] };
        self.add(names, unit, role, Mirror::Negate)
    }

    /// Declares a position or another vector that mirrors do not change.
    pub fn place(&mut self, names: VectorNames, unit: &'static str, role: Role) -> usize {
        let names = if self.plane() { &names[1..] } else { &names[..1] };
        self.add(names, unit, role, |_| Mirror::Same)
    }

    /// Declares a tensor.
    pub fn tensor(&mut self, names: TensorNames, unit: &'static str, role: Role) -> usize {
        let names = if self.plane() { &names[..] } else { &names[..1] };
        let mirror =
            |k: usize| if k.is_multiple_of(3) { Mirror::Same } else { Mirror::NegatePair(0, 1) };
        self.add(names, unit, role, mirror)
    }

    /// Declares a symmetric tensor.
    pub fn symmetric(&mut self, names: SymmetricNames, unit: &'static str, role: Role) -> usize {
        let names = if self.plane() { &names[..] } else { &names[..1] };
        self.add(names, unit, role, symmetric_mirror)
    }

    /// Adds a column to tables of results.
    pub fn output(&mut self, name: &'static str, unit: &'static str, column: &'static str) {
        self.columns.outputs.push(OutputColumn { name, unit, column });
    }

    /// Declares that a column is zero for a particle at rest.
    pub fn zero_at_rest(&mut self, column: usize) {
        self.columns.zero_at_rest.push(column);
    }

    /// Declares that a tensor is zero for a particle at rest.
    pub fn zero_at_rest_tensor(&mut self, first: usize) {
        let count = if self.plane() { 4 } else { 1 };
        self.columns.zero_at_rest.extend(first..first + count);
    }

    /// Declares that a vector is zero for a particle at rest.
    pub fn zero_at_rest_vector(&mut self, first: usize) {
        let count = if self.plane() { 2 } else { 1 };
        self.columns.zero_at_rest.extend(first..first + count);
    }

    /// Declares that the vector in a column is added to the forces on nodes, as an external force
    /// [N].
    pub fn external_force(&mut self, column: usize) {
        self.columns.forces.push(column);
    }

    /// Sets [`Columns::external_work`].
    pub fn external_work(&mut self, column: usize) {
        self.columns.external_work = Some(column);
    }

    /// Sets the history variable of the equation of state of a body.
    pub fn history(&mut self, body: usize, column: usize) {
        self.columns.history[body] = Some(column);
    }

    /// Sets [`Columns::deviator`].
    pub fn deviator(&mut self, column: usize) {
        self.columns.deviator = Some(column);
    }

    /// Sets [`Columns::energy_mid`].
    pub fn energy_mid(&mut self, column: usize) {
        self.columns.energy_mid = Some(column);
    }

    /// Sets [`Columns::tension_free`] of a body.
    pub fn tension_free(&mut self, body: usize, column: usize) {
        self.columns.tension_free[body] = Some(column);
    }

    /// Sets [`Columns::burn`].
    pub fn burn(&mut self, fraction: usize, lighting_time: usize) {
        self.columns.burn = Some([fraction, lighting_time]);
    }

    /// Sets [`Columns::plastic_strain`].
    pub fn plastic_strain(&mut self, column: usize) {
        self.columns.plastic_strain = Some(column);
    }

    /// Sets [`Columns::released_energy`].
    pub fn released_energy(&mut self, column: usize) {
        self.columns.released_energy = Some(column);
    }

    /// Sets [`Columns::mean_work_energy`].
    pub fn mean_work_energy(&mut self, column: usize) {
        self.columns.mean_work_energy = Some(column);
    }

    /// Sets [`Columns::temperature`].
    pub fn temperature(&mut self, column: usize) {
        self.columns.temperature = Some(column);
    }

    /// Sets [`Columns::stored_work`].
    pub fn stored_work(&mut self, column: usize) {
        self.columns.stored_work = Some(column);
    }

    /// Requests the heat of friction at sides.
    pub fn wall_friction_heat(&mut self) {
        self.columns.wall_friction_part = self.owner;
    }

    /// Requests the body index of ghosts.
    pub fn ghost_bodies(&mut self) {
        self.ghost_bodies = true;
    }

    /// Requests the initial position.
    pub fn initial_position(&mut self) {
        self.columns.shows_initial_position = true;
    }

    /// Requests the velocity gradient as a tensor in a plane.
    pub fn velocity_gradient(&mut self) {
        self.velocity_gradient = true;
    }
}

/// Mirror rule of the component xx, yy, xy or zz of a symmetric tensor.
pub(super) fn symmetric_mirror(component: usize) -> Mirror {
    if component == 2 { Mirror::NegatePair(0, 1) } else { Mirror::Same }
}
