//! Table of particles at one time, for outputs.

/// One named column of a [`ParticleTable`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TableColumn {
    /// Name as in output files, such as `pressure`.
    pub name: String,
    /// SI unit, such as `Pa`.
    pub unit: String,
    /// One value per particle, in the unit of the column.
    pub values: Vec<f64>,
}

/// All particles of the run at one time, sorted by x (ties by id).
#[derive(Clone, Debug, PartialEq)]
pub struct ParticleTable {
    /// Time [s].
    pub time: f64,
    /// Dimension of the scene; the first columns are the D coordinates.
    pub dimension: usize,
    /// Id of each particle.
    pub ids: Vec<u64>,
    /// Material of each particle, an index into `materials`.
    pub material: Vec<u32>,
    /// Names of the materials.
    pub materials: Vec<String>,
    /// Body of each particle, an index into the scene's bodies.
    pub body: Vec<u32>,
    /// Columns in the order of the files: x, pressure, velocity, density, specific_internal_energy,
    /// artificial_viscosity, then those of effects.
    pub columns: Vec<TableColumn>,
    /// In a plane the half edges of the parallelogram of each particle [m]; empty on a line.
    pub half_edges: Vec<[[f64; 2]; 2]>,
}

impl ParticleTable {
    /// Number of particles.
    pub fn len(&self) -> usize {
        self.ids.len()
    }

    /// Whether there are no particles.
    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }

    /// Values of the column `name` in its unit, one per particle; `None` if there is no such
    /// column.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.columns.iter().find(|c| c.name == name).map(|c| c.values.as_slice())
    }
}
