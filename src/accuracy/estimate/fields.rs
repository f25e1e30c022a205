//! Error estimates of fields: quantities of all particles at the times of the profiles. The values of
//! a coarse run are interpolated to the particles of the run ([`super::interpolation`]).

use serde::{Deserialize, Serialize};

use super::bounded::Bounded;
use super::companions::Companions;
use super::differences::Differences;
use super::interpolation::{at_particles, by_body};
use super::range::EstimateBasis;
use crate::simulation::{ParticleTable, TableColumn, quantity_of, with_suffix};

/// Error estimate of a field.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FieldEstimate {
    /// Time \[s\].
    pub time: f64,
    /// Name of the quantity.
    pub quantity: String,
    /// Always a guess, from the differences to the coarse runs.
    pub basis: EstimateBasis,
    /// Integral of the magnitude of the error over the volume of all bodies, over that of the
    /// quantity \[-\]: the value is 0 (no error), the half-width is the bound.
    pub l1: Bounded,
}

/// Error estimate of the field of `quantity` in profile number `k`, which is `table`, with a
/// half-width `widened` by a factor \[-\]; `None` if the field is zero, or without a coarse run.
pub(super) fn of_field(
    table: &ParticleTable,
    quantity: &str,
    k: usize,
    companions: &Companions,
    Conditions { axisymmetric, least_pressure, widened }: Conditions,
) -> Option<FieldEstimate> {
    let is_rounding = |column: &TableColumn| {
        column.unit == "Pa" && column.values.iter().all(|p| p.abs() <= least_pressure)
    };
    if columns_of(table, quantity).all(is_rounding) {
        return None;
    }
    let differences = Differences::new(companions.done.iter().filter_map(|companion| {
        let coarse = companion.tables.get(k)?;
        Some((companion.factor, difference(table, coarse, quantity, axisymmetric)?))
    }))?;
    Some(FieldEstimate {
        time: table.time,
        quantity: quantity.into(),
        basis: EstimateBasis::Guess,
        l1: differences.l1(widened),
    })
}

/// Conditions of the estimate of a field.
#[derive(Clone, Copy, Debug)]
pub(super) struct Conditions {
    /// Whether the scene has axial symmetry.
    pub axisymmetric: bool,
    /// Pressure up to which a wave is rounding \[Pa\].
    pub least_pressure: f64,
    /// Factor on the half-width \[-\].
    pub widened: f64,
}

/// Relative L1 difference of a quantity \[-\]: the integral of |a - b| over the volume, over that of
/// |a|, with the values b of `other` at the particles of `own`; `None` if a is zero.
pub fn difference(
    own: &ParticleTable,
    other: &ParticleTable,
    quantity: &str,
    axisymmetric: bool,
) -> Option<f64> {
    let columns: Vec<&TableColumn> = columns_of(own, quantity).collect();
    let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
    let theirs = at_particles(other, &names, own);
    let (mut apart, mut whole) = (0.0, 0.0);
    for (row, volume) in volumes(own, axisymmetric).into_iter().enumerate() {
        let size = columns.iter().map(|c| c.values[row].powi(2)).sum::<f64>().sqrt();
        let distance = columns.iter().zip(&theirs).map(|(c, v)| (c.values[row] - v[row]).powi(2));
        let distance = distance.sum::<f64>().sqrt();
        // a body that the other run has lost
        apart += volume * if distance.is_nan() { size } else { distance };
        whole += volume * size;
    }
    (whole > 0.0).then_some(apart / whole)
}

/// The differences of a table from the table of a coarse run, one column per column of these
/// quantities, in the same unit.
pub fn difference_columns(
    own: &ParticleTable,
    other: &ParticleTable,
    quantities: &[String],
) -> Vec<TableColumn> {
    let columns = quantities.iter().flat_map(|quantity| columns_of(own, quantity));
    let columns: Vec<&TableColumn> = columns.collect();
    let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
    let theirs = at_particles(other, &names, own);
    let column = |(column, theirs): (&&TableColumn, &Vec<f64>)| TableColumn {
        name: with_suffix(&column.name, "_difference"),
        unit: column.unit.clone(),
        values: column.values.iter().zip(theirs).map(|(a, b)| a - b).collect(),
    };
    columns.iter().zip(&theirs).map(column).collect()
}

/// The columns of a quantity.
fn columns_of<'a>(
    table: &'a ParticleTable,
    quantity: &'a str,
) -> impl Iterator<Item = &'a TableColumn> + 'a {
    table.columns[table.dimension..].iter().filter(move |c| quantity_of(&c.name) == quantity)
}

/// Volume of each particle, on a line per area, in a plane per depth, about an axis per radian: the
/// distance of its neighbours on a line, the area of its parallelogram in a plane.
fn volumes(table: &ParticleTable, axisymmetric: bool) -> Vec<f64> {
    let x = &table.columns[0].values;
    if table.dimension > 1 {
        let area = |[a, b]: &[[f64; 2]; 2]| 4.0 * (a[0] * b[1] - a[1] * b[0]).abs();
        let radius = |row: usize| if axisymmetric { x[row].abs() } else { 1.0 };
        return table.half_edges.iter().enumerate().map(|(r, e)| area(e) * radius(r)).collect();
    }
    let mut all = vec![0.0; table.len()];
    for (_, rows) in by_body(table) {
        for k in 0..rows.len() {
            let [before, after] = [k.saturating_sub(1), (k + 1).min(rows.len() - 1)];
            let between = (after - before).max(1) as f64;
            all[rows[k]] = (x[rows[after]] - x[rows[before]]) / between;
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Particles of two bodies at `places`, each with the pressure 1 + x + 2 y, and half edges of
    /// `half`.
    fn table(places: &[[f64; 2]], dimension: usize, half: f64) -> ParticleTable {
        let column = |name: &str, of: &dyn Fn(&[f64; 2]) -> f64| TableColumn {
            name: name.into(),
            unit: "Pa".into(),
            values: places.iter().map(of).collect(),
        };
        let mut columns = vec![column("x", &|p| p[0])];
        if dimension > 1 {
            columns.push(column("y", &|p| p[1]));
        }
        columns.push(column("pressure", &|p| 1.0 + p[0] + 2.0 * p[1]));
        ParticleTable {
            time: 1.0,
            dimension,
            ids: (0..places.len() as u64).collect(),
            material: vec![0; places.len()],
            materials: vec!["copper".into()],
            body: vec![0; places.len()],
            columns,
            half_edges: vec![[[half, 0.0], [0.0, half]]; places.len()],
        }
    }

    fn square(count: usize, dimension: usize) -> ParticleTable {
        let rows = if dimension > 1 { count } else { 1 };
        let at = |k: usize| (k as f64 + 0.5) / count as f64;
        let places = (0..count).flat_map(|i| (0..rows).map(move |j| [at(i), at(j)]));
        let places: Vec<[f64; 2]> = places.collect();
        let places: Vec<[f64; 2]> =
            places.iter().map(|p| if dimension > 1 { *p } else { [p[0], 0.0] }).collect();
        table(&places, dimension, 0.5 / count as f64)
    }

    #[test]
    fn a_linear_field_differs_at_the_surface_alone() {
        for dimension in [1, 2] {
            let (own, coarse) = (square(8, dimension), square(4, dimension));
            let columns = difference_columns(&own, &coarse, &["pressure".into()]);
            assert_eq!(columns[0].name, "pressure_difference");
            for (row, difference) in columns[0].values.iter().enumerate() {
                let inside = |axis: usize| (0.125..=0.875).contains(&own.columns[axis].values[row]);
                let is_inside = (0..dimension).all(inside);
                assert_eq!(difference.abs() < 1e-12, is_inside, "{dimension} {row} {difference}");
            }
        }
    }

    #[test]
    fn differences_are_integrals_over_the_volume() {
        for dimension in [1, 2] {
            let own = square(8, dimension);
            let mut other = own.clone();
            other.columns[dimension].values.iter_mut().for_each(|p| *p *= 1.25);
            let found = difference(&own, &other, "pressure", false).unwrap();
            assert!((found - 0.25).abs() < 1e-12, "{dimension}: {found}");
        }
        // 1 at radius 0.25, 3 at 0.75; the difference is 1 at 0.75
        let mut own = table(&[[0.25, 0.0], [0.75, 0.0]], 2, 0.25);
        own.columns[2].values = vec![1.0, 3.0];
        let mut other = own.clone();
        other.columns[2].values = vec![1.0, 2.0];
        let found = difference(&own, &other, "pressure", true).unwrap();
        assert!((found - 0.75 / (0.25 + 2.25)).abs() < 1e-12, "{found}");
        own.columns[2].values = vec![0.0, 0.0];
        assert_eq!(difference(&own, &other, "pressure", true), None);
    }

    #[test]
    fn a_body_that_the_coarse_run_has_lost_counts_whole() {
        let own = square(4, 2);
        let mut other = own.clone();
        other.body.fill(1);
        assert_eq!(difference(&own, &other, "pressure", false), Some(1.0));
    }
}
