//! Table of particles at one time, for outputs, and the names of its columns.

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

/// Quantity of a column of a table, by name; in a vector or tensor also the rank and the component.
pub fn part_of(column: &str) -> (&str, usize, usize) {
    const PARTS: [(&str, usize, usize); 6] =
        [("_x", 1, 0), ("_y", 1, 1), ("_xx", 2, 0), ("_yy", 2, 1), ("_zz", 2, 2), ("_xy", 2, 3)];
    let part = PARTS
        .iter()
        .find_map(|&(end, rank, component)| Some((column.strip_suffix(end)?, rank, component)));
    match (column, part) {
        // on a line
        ("velocity", _) => ("velocity", 1, 0),
        (_, Some(("reference", rank, component))) => ("initial_position", rank, component),
        (_, Some(part)) => part,
        (_, None) => (column, 0, 0),
    }
}

/// Quantity of a column of a table: `stress` for `stress_xx`, `velocity` for `velocity_y`, and so on.
pub fn quantity_of(column: &str) -> &str {
    part_of(column).0
}

/// Name of a column that holds, for each component of the quantity of `column`, what `suffix` says:
/// `velocity_difference_x` for `velocity_x` and `_difference`.
pub fn with_suffix(column: &str, suffix: &str) -> String {
    let component = column.strip_prefix(quantity_of(column)).unwrap_or_default();
    format!("{}{suffix}{component}", column.strip_suffix(component).unwrap_or(column))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_suffix_stands_before_the_component() {
        for (column, expected) in [
            ("pressure", "pressure_difference"),
            ("velocity", "velocity_difference"),
            ("velocity_y", "velocity_difference_y"),
            ("stress_xx", "stress_difference_xx"),
            ("reference_x", "reference_x_difference"),
        ] {
            assert_eq!(with_suffix(column, "_difference"), expected);
        }
    }
}
