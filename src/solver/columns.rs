//! Particle columns: the index of each column in a block.
//!
//! Each column is declared once, by the motion ([`motion_columns`](super::motion_columns)) or by
//! the effect that needs it. Ghost exchange, migration, checkpoints, tables and the ledger follow
//! from the declarations.

use decomp::ColumnSpec;

/// Column in tables of results.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutputColumn {
    /// Name in tables.
    pub name: &'static str,
    /// SI unit.
    pub unit: &'static str,
    /// Name of the column.
    pub column: &'static str,
}

/// Columns of the spin of particles.
#[derive(Clone, Copy, Debug)]
pub struct SpinColumns {
    /// Angular momentum per unit mass, counter-clockwise, B [m2/s].
    pub angular_momentum: usize,
    /// Moment of inertia per unit mass at the time of the last forces, I [m2].
    pub inertia: usize,
}

/// Indices of the columns in a block. Vectors take D consecutive columns, tensors D^2, row by row;
/// their index is that of the first.
#[derive(Clone, Debug, Default)]
pub struct Columns {
    /// Declarations, in order.
    pub specs: Vec<ColumnSpec>,
    /// [Part](parts) of a step that each column belongs to; none: the motion itself.
    pub owners: Vec<Option<usize>>,
    /// Columns of effects in tables of results.
    pub outputs: Vec<OutputColumn>,
    /// Columns of effects that are zero for a particle at rest.
    pub zero_at_rest: Vec<usize>,
    /// External forces on particles [N], vectors.
    pub forces: Vec<usize>,
    /// Accumulated work of external forces [J].
    pub external_work: Option<usize>,
    /// Column of the history variable of each body's equation of state.
    pub history: Vec<Option<usize>>,
    /// Deviator of the Cauchy stress [Pa]: xx, and in a plane yy and xy; if a fluid has strength.
    pub deviator: Option<usize>,
    /// Specific internal energy for equations of state at the middle of the step [J/kg], if it
    /// differs from the energy at the start.
    pub energy_mid: Option<usize>,
    /// For each body a column; particles carry no tension after it has reached 1 [-].
    pub tension_free: Vec<Option<usize>>,
    /// Burnt fraction [-] and lighting time [s], if a body burns.
    pub burn: Option<[usize; 2]>,
    /// Equivalent plastic strain [-], with strength.
    pub plastic_strain: Option<usize>,
    /// Elastic energy that failure has released as heat [J], if a material can fail.
    pub released_energy: Option<usize>,
    /// Energy after a mid-point step with the work at the mean nodal velocity alone [J/kg], between
    /// the gather and [`Gathered`](super::effect::Phase::Gathered), if an effect needs it.
    pub mean_work_energy: Option<usize>,
    /// Temperature [K]; 0 in bodies without thermal properties.
    pub temperature: Option<usize>,
    /// Plastic work that is stored and does not heat [J/kg], if any.
    pub stored_work: Option<usize>,
    /// [Part](parts) of a step to which friction at sides belongs, if a side has friction.
    pub wall_friction_part: Option<usize>,
    /// Accumulated heat of friction [J/kg], with friction between bodies or at sides.
    pub friction_heat: Option<usize>,
    /// Position x [m], a vector.
    pub position: usize,
    /// Initial position X [m], a vector, if the frame or an effect needs it.
    pub initial_position: Option<usize>,
    /// Whether tables include the initial position.
    pub shows_initial_position: bool,
    /// Initial position in the total-Lagrangian frame.
    pub reference: Option<usize>,
    /// Inverse of the deformation gradient, which pushes gradients forward [-], a tensor, scratch,
    /// in the total-Lagrangian frame.
    pub inverse_deformation: Option<usize>,
    /// Velocity [m/s], a vector.
    pub velocity: usize,
    /// Mass [kg] (in 1-D per unit area, kg/m2; in a plane per unit depth, kg/m, or
    /// per radian).
    pub mass: usize,
    /// Volume at J = 1 [m3] (in 1-D per unit area, m; in a plane per unit depth, m2, or
    /// per radian).
    pub volume0: usize,
    /// Volume ratio J = V/V0 [-].
    pub jacobian: usize,
    /// Specific internal energy e [J/kg].
    pub energy: usize,
    /// Index of the body.
    pub body: usize,
    /// Divergence of the velocity D of the last step [1/s].
    pub divergence: usize,
    /// Sound speed c [m/s].
    pub sound_speed: usize,
    /// Pressure p without artificial viscosity [Pa].
    pub pressure: usize,
    /// Artificial viscosity q [Pa], if the scene has it.
    pub viscosity: Option<usize>,
    /// Limiter phi in [0, 1], by which the viscosity is reduced, if the scene has one.
    pub limiter: Option<usize>,
    /// Affine part of the velocity [1/s], a tensor, with APIC.
    pub affine: Option<usize>,
    /// Spin, in a plane with `method.spin`.
    pub spin: Option<SpinColumns>,
    /// Initial half lengths of the particle along each direction [m], a vector, in a plane for
    /// shape functions that depend on its domain.
    pub half_lengths: Option<usize>,
    /// Deformation gradient F [-], a tensor, in a plane if the domain deforms or a body is a solid.
    pub deformation: Option<usize>,
    /// Velocity gradient of the last step [1/s], a tensor, if there is a deformation gradient or in
    /// a plane a transmitting side.
    pub velocity_gradient: Option<usize>,
    /// Cauchy stress without artificial viscosity [Pa], positive in tension, if a body is a solid:
    /// xx, and in a plane yy and xy.
    pub stress: Option<usize>,
    /// Position in the cell [cells], a vector, scratch.
    pub fraction: usize,
    /// Length for the shape function, in a plane half edges of the domain [cells], scratch.
    pub domain: usize,
    /// Volume [cells], scratch, with an edge mask or contact; on a line the deformed length itself.
    pub fill_fraction: Option<usize>,
    /// Current volume for contact [cells], scratch; in the updated-Lagrangian frame
    /// `fill_fraction`.
    pub current_volume: Option<usize>,
    /// Displacement at the time of the forces [m], a vector, scratch, with contact in the
    /// total-Lagrangian frame.
    pub displacement: Option<usize>,
    /// Distance from the axis at the time of the forces [m], scratch, with axial symmetry in the
    /// total-Lagrangian frame; negative for images beyond the axis.
    pub radius: Option<usize>,
    /// Half edges of the deformed parallelogram [cells], two vectors, scratch, if domains deform or
    /// touch in a plane; the columns of the shape function, if it depends on them.
    pub half_edges: Option<usize>,
    /// (p + q) V [J], scratch. If a body is a solid, in a plane the tensor (q - sigma) V: xx, yy,
    /// xy, and with axial symmetry zz.
    pub stress_volume: usize,
    /// Number of components of `stress_volume`.
    pub stress_volumes: usize,
    /// Impulse of uninterrupted pressure on the particle, up to a maximum [Pa s], with contact.
    pub contact_impulse: Option<usize>,
    /// Faces of the body at a particle [-]: for each of up to two faces, its components in the
    /// coordinates along the half edges, in a plane for normals that use them; zeros: none.
    pub faces: Option<usize>,
    /// J at the middle of the step, scratch, with mid-point stepping.
    pub jacobian_mid: Option<usize>,
    /// Pressure at the middle of the step [Pa], scratch, with pressure relaxation.
    pub pressure_mid: Option<usize>,
    /// -dV/dp at the middle of the step [m3/Pa], scratch, with pressure relaxation.
    pub compliance: Option<usize>,
}

impl Columns {
    /// Whether a body may fail.
    pub fn may_fail(&self) -> bool {
        self.tension_free.iter().any(Option::is_some)
    }

    /// Index of the column `name`.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.specs.iter().position(|spec| spec.name == name)
    }

    /// Index of the column `name`, which an effect of the scene has declared.
    ///
    /// # Panics
    ///
    /// If there is no such column.
    pub fn get(&self, name: &str) -> usize {
        self.find(name).unwrap_or_else(|| panic!("no column {name} is declared"))
    }

    /// Quantities of the particles that fields may have, by dimension.
    pub fn quantities(&self, dimension: usize) -> Vec<&'static str> {
        let always = [
            "pressure",
            "velocity",
            "density",
            "specific_internal_energy",
            "artificial_viscosity",
            "mass",
        ];
        let some = [
            ("initial_position", self.shows_initial_position && self.initial_position.is_some()),
            ("stress", self.stress.is_some()),
            ("strain", dimension == 1 || self.deformation.is_some()),
            ("failed", self.tension_free.iter().any(Option::is_some)),
            ("volume", dimension > 1),
        ];
        let some = some.into_iter().filter(|(_, has)| *has).map(|(name, _)| name);
        let outputs = self.outputs.iter().map(|output| output.name);
        always.into_iter().chain(some).chain(outputs).collect()
    }

    /// Columns that are part of the state.
    pub fn state(&self) -> Vec<usize> {
        (0..self.specs.len()).filter(|&c| self.specs[c].state).collect()
    }

    /// Bytes of a particle's restorable state, by dimension.
    pub fn state_bytes(&self, dimension: usize) -> usize {
        8 + 4 * dimension + 8 * self.specs.iter().filter(|s| s.state).count()
    }
}
