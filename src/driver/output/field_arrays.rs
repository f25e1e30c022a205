//! Arrays of fields: the columns of a table of particles, joined to vectors and symmetric tensors.

use crate::simulation::{ParticleTable, part_of};

/// Values of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Numbers of the columns of the table.
    Number,
    /// Ids of the particles.
    Id,
    /// Materials, as indices.
    Material,
    /// Bodies, as indices.
    Body,
}

/// Components of a scalar, a vector, and a symmetric tensor in VTK's order xx, yy, zz, xy, yz, xz.
const WIDTHS: [usize; 3] = [1, 3, 6];

/// An array of fields.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldArray {
    /// Name, that of the quantity.
    pub name: String,
    /// SI unit.
    pub unit: String,
    /// Values.
    pub kind: Kind,
    /// Index into [`WIDTHS`].
    rank: usize,
    /// For each component its column in the table; none: zero.
    columns: [Option<usize>; 6],
}

impl FieldArray {
    /// The arrays of a table, without its coordinates.
    #[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
    pub fn of(table: &ParticleTable) -> Vec<FieldArray> {
        let mut arrays: Vec<FieldArray> = Vec::new();
        for (k, column) in table.columns.iter().enumerate().skip(table.dimension) {
            let (name, rank, component) = part_of(&column.name);
            let array = match arrays.iter_mut().find(|array| array.name == name) {
                Some(array) => array,
                None => {
                    let (name, unit) = (name.to_string(), column.unit.clone());
                    let columns = [None; 6];
                    arrays.push(FieldArray { name, unit, kind: Kind::Number, rank, columns });
                    arrays.last_mut().expect("one was added")
                }
            };
            array.columns[component] = Some(k);
        }
        for array in arrays.iter_mut().filter(|a| a.rank == 2 && table.dimension == 1) {
            // on a line the two directions across it are alike
            array.columns[1] = array.columns[2];
        }
        let index = |name: &str, kind| FieldArray {
            name: name.into(),
            unit: "-".into(),
            kind,
            rank: 0,
            columns: [None; 6],
        };
        arrays.push(index("particle_id", Kind::Id));
        arrays.push(index("material", Kind::Material));
        arrays.push(index("body", Kind::Body));
        arrays
    }

    /// Number of components.
    pub fn width(&self) -> usize {
        WIDTHS[self.rank]
    }

    /// The values of an array of numbers, component after component of each particle.
    pub fn numbers<'a>(&'a self, table: &'a ParticleTable) -> impl Iterator<Item = f64> + 'a {
        let columns: Vec<Option<&[f64]>> = self.columns[..self.width()]
            .iter()
            .map(|column| column.map(|k| &table.columns[k].values[..]))
            .collect();
        (0..table.len() * self.width()).map(move |at| {
            let (row, component) = (at / columns.len(), at % columns.len());
            columns[component].map_or(0.0, |values| values[row])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::TableColumn;

    fn table(dimension: usize, names: &[&str]) -> ParticleTable {
        let column = |(k, name): (usize, &&str)| TableColumn {
            name: (*name).into(),
            unit: "Pa".into(),
            values: vec![k as f64, 10.0 * k as f64],
        };
        ParticleTable {
            time: 0.0,
            dimension,
            ids: vec![0, 1],
            material: vec![0; 2],
            materials: vec!["copper".into()],
            body: vec![0; 2],
            columns: names.iter().enumerate().map(column).collect(),
            half_edges: Vec::new(),
        }
    }

    #[test]
    fn columns_become_vectors_and_tensors() {
        let names = [
            "x",
            "y",
            "velocity_x",
            "velocity_y",
            "stress_xx",
            "stress_yy",
            "stress_xy",
            "stress_zz",
            "damage",
        ];
        let plane = table(2, &names);
        let arrays = FieldArray::of(&plane);
        let widths: Vec<(&str, usize)> = arrays.iter().map(|a| (&a.name[..], a.width())).collect();
        assert_eq!(
            widths,
            [
                ("velocity", 3),
                ("stress", 6),
                ("damage", 1),
                ("particle_id", 1),
                ("material", 1),
                ("body", 1)
            ]
        );
        let values = |k: usize| arrays[k].numbers(&plane).collect::<Vec<f64>>();
        assert_eq!(values(0), [2.0, 3.0, 0.0, 20.0, 30.0, 0.0]);
        assert_eq!(values(1)[..6], [4.0, 5.0, 7.0, 6.0, 0.0, 0.0]);
        assert_eq!(values(2), [8.0, 80.0]);
        let line = table(1, &["x", "velocity", "stress_xx", "stress_zz"]);
        let arrays = FieldArray::of(&line);
        let values = |k: usize| arrays[k].numbers(&line).collect::<Vec<f64>>();
        assert_eq!(values(0), [1.0, 0.0, 0.0, 10.0, 0.0, 0.0]);
        assert_eq!(values(1)[..6], [2.0, 3.0, 3.0, 0.0, 0.0, 0.0]);
        assert_eq!(part_of("reference_x").0, "initial_position");
    }
}
