//! Error estimates of fields: quantities of all particles at the times of the profiles. The values of
//! a coarse run are interpolated to the particles of the run ([`super::interpolation`]).

use serde::{Deserialize, Serialize};

use super::bounded::Bounded;
use super::coarse_results::{CoarseRun, CoarseRuns};
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

/// Error estimates of the fields of these quantities in profile number `k`, which is `table`, with
/// half-widths times `factor` \[-\]; and the differences of the table from the run with cells twice as
/// large, one column per column of the quantities. Fields that are zero, and pressures up to
/// `least_pressure` \[Pa\], have no estimate.
pub fn compare(
    table: &ParticleTable,
    k: usize,
    quantities: &[&str],
    coarse_runs: &CoarseRuns,
    factor: f64,
    least_pressure: f64,
) -> (Vec<FieldEstimate>, Vec<TableColumn>) {
    let of_run = |coarse: &CoarseRun| {
        let values = coarse.tables.get(k).map(|other| ComparedTable::new(table, other, quantities));
        (coarse.factor, values)
    };
    let compared: Vec<(f64, Option<ComparedTable>)> = coarse_runs.done.iter().map(of_run).collect();
    let values_of = |factor: f64| compared.iter().find(|c| c.0 == factor)?.1.as_ref();
    let is_rounding = |column: &&TableColumn| {
        column.unit == "Pa" && column.values.iter().all(|p| p.abs() <= least_pressure)
    };
    let estimate = |quantity: &&str| {
        if columns_of(table, quantity).all(|column| is_rounding(&column)) {
            return None;
        }
        let differences =
            Differences::new(coarse_runs, |coarse| values_of(coarse.factor)?.difference(quantity))?;
        Some(FieldEstimate {
            time: table.time,
            quantity: (*quantity).into(),
            basis: EstimateBasis::Guess,
            l1: differences.l1(factor),
        })
    };
    let estimates = quantities.iter().filter_map(estimate).collect();
    (estimates, values_of(2.0).map_or(Vec::new(), ComparedTable::columns))
}

/// Relative L1 difference of a quantity \[-\]: the integral of |a - b| over the volume, over that of
/// |a|, with the values b of `other` at the particles of `own`; `None` if a is zero.
pub fn difference(own: &ParticleTable, other: &ParticleTable, quantity: &str) -> Option<f64> {
    ComparedTable::new(own, other, &[quantity]).difference(quantity)
}

/// A table, and values of another one at its particles.
struct ComparedTable<'a> {
    own: &'a ParticleTable,
    /// Columns of the quantities.
    columns: Vec<&'a TableColumn>,
    /// Values of the other table, one list per column.
    others: Vec<Vec<f64>>,
}

impl<'a> ComparedTable<'a> {
    fn new(own: &'a ParticleTable, other: &ParticleTable, quantities: &[&'a str]) -> Self {
        let columns: Vec<&TableColumn> =
            quantities.iter().flat_map(|quantity| columns_of(own, quantity)).collect();
        let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
        ComparedTable { own, others: at_particles(other, &names, own), columns }
    }

    /// Relative L1 difference of a quantity \[-\]; `None` if the quantity is zero.
    fn difference(&self, quantity: &str) -> Option<f64> {
        let pairs = self.columns.iter().zip(&self.others);
        let pairs: Vec<_> = pairs.filter(|(c, _)| quantity_of(&c.name) == quantity).collect();
        let (mut difference, mut magnitude) = (0.0, 0.0);
        for (row, volume) in volumes(self.own).into_iter().enumerate() {
            let size = pairs.iter().map(|(c, _)| c.values[row].powi(2)).sum::<f64>().sqrt();
            let apart = pairs.iter().map(|(c, other)| (c.values[row] - other[row]).powi(2));
            let apart = apart.sum::<f64>().sqrt();
            // a body that the other run has lost
            difference += volume * if apart.is_nan() { size } else { apart };
            magnitude += volume * size;
        }
        (magnitude > 0.0).then_some(difference / magnitude)
    }

    /// The differences, one column per column of the quantities.
    fn columns(&self) -> Vec<TableColumn> {
        let column = |(column, other): (&&TableColumn, &Vec<f64>)| TableColumn {
            name: with_suffix(&column.name, "_difference"),
            unit: column.unit.clone(),
            values: column.values.iter().zip(other).map(|(a, b)| a - b).collect(),
        };
        self.columns.iter().zip(&self.others).map(column).collect()
    }
}

/// The columns of a quantity.
fn columns_of<'a>(
    table: &'a ParticleTable,
    quantity: &'a str,
) -> impl Iterator<Item = &'a TableColumn> + 'a {
    table.columns[table.dimension..].iter().filter(move |c| quantity_of(&c.name) == quantity)
}

/// Volume of each particle, in a plane per depth, about an axis per radian. On a line, per area, the
/// distance between its neighbours over two, but at most twice the median of its body: a gap has no
/// material.
fn volumes(table: &ParticleTable) -> Vec<f64> {
    if let Some(volumes) = table.column("volume") {
        return volumes.to_vec();
    }
    let x = &table.columns[0].values;
    let mut all = vec![0.0; table.len()];
    for (_, rows) in by_body(table) {
        let length = |k: usize| {
            let [before, after] = [k.saturating_sub(1), (k + 1).min(rows.len() - 1)];
            (x[rows[after]] - x[rows[before]]) / (after - before).max(1) as f64
        };
        let lengths: Vec<f64> = (0..rows.len()).map(length).collect();
        let mut sorted = lengths.clone();
        sorted.sort_by(f64::total_cmp);
        let most = 2.0 * sorted[sorted.len() / 2];
        for (&row, length) in rows.iter().zip(lengths) {
            all[row] = length.min(most);
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Particles at `places`, each with the pressure 1 + x + 2 y, and in a plane with these volumes.
    fn table(places: &[[f64; 2]], dimension: usize, volumes: &[f64]) -> ParticleTable {
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
        if dimension > 1 {
            let values = volumes.to_vec();
            columns.push(TableColumn { name: "volume".into(), unit: "m2".into(), values });
        }
        ParticleTable {
            time: 1.0,
            dimension,
            ids: (0..places.len() as u64).collect(),
            material: vec![0; places.len()],
            materials: vec!["copper".into()],
            body: vec![0; places.len()],
            columns,
            half_edges: Vec::new(),
        }
    }

    fn square(count: usize, dimension: usize) -> ParticleTable {
        let rows = if dimension > 1 { count } else { 1 };
        let at = |k: usize| (k as f64 + 0.5) / count as f64;
        let places = (0..count).flat_map(|i| (0..rows).map(move |j| [at(i), at(j)]));
        let places: Vec<[f64; 2]> = places.collect();
        let places: Vec<[f64; 2]> =
            places.iter().map(|p| if dimension > 1 { *p } else { [p[0], 0.0] }).collect();
        let volumes = vec![1.0; places.len()];
        table(&places, dimension, &volumes)
    }

    #[test]
    fn a_linear_field_differs_at_the_surface_alone() {
        for dimension in [1, 2] {
            let (own, coarse) = (square(8, dimension), square(4, dimension));
            let run =
                CoarseRun { factor: 2.0, ratio: 2.0, tables: vec![coarse], ..Default::default() };
            let runs = CoarseRuns { done: vec![run], ..CoarseRuns::default() };
            let (estimates, columns) = compare(&own, 0, &["pressure"], &runs, 1.0, 0.1);
            assert!(estimates[0].l1.half_width.is_some_and(|w| w > 0.0));
            assert_eq!(columns[0].name, "pressure_difference");
            for (row, difference) in columns[0].values.iter().enumerate() {
                let inside = |axis: usize| (0.125..=0.875).contains(&own.columns[axis].values[row]);
                let is_inside = (0..dimension).all(inside);
                assert_eq!(difference.abs() < 1e-12, is_inside, "{dimension} {row} {difference}");
            }
            // a pressure of rounding has no estimate
            assert!(compare(&own, 0, &["pressure"], &runs, 1.0, 10.0).0.is_empty());
        }
    }

    #[test]
    fn differences_are_integrals_over_the_volume() {
        // on a line volumes 1, 1.5, 2 from the distances; the difference is at the last particle
        let line = table(&[[0.0, 0.0], [1.0, 0.0], [3.0, 0.0]], 1, &[]);
        let mut other = line.clone();
        other.columns[1].values[2] += 1.0;
        let magnitude = 1.0 * 1.0 + 1.5 * 2.0 + 2.0 * 4.0;
        let found = difference(&line, &other, "pressure").unwrap();
        assert!((found - 2.0 / magnitude).abs() < 1e-12, "{found}");
        // in a plane the volumes are given
        let plane = table(&[[0.25, 0.0], [0.75, 0.0]], 2, &[1.0, 3.0]);
        let mut other = plane.clone();
        other.columns[2].values[1] -= 0.5;
        let found = difference(&plane, &other, "pressure").unwrap();
        assert!((found - 3.0 * 0.5 / (1.25 + 3.0 * 1.75)).abs() < 1e-12, "{found}");
        let mut rest = plane.clone();
        rest.columns[2].values.fill(0.0);
        assert_eq!(difference(&rest, &other, "pressure"), None);
    }

    #[test]
    fn a_gap_has_no_material() {
        // the distances are 1, except for a gap of 100
        let places: Vec<[f64; 2]> =
            (0..8).map(|k| [k as f64 + if k > 3 { 99.0 } else { 0.0 }, 0.0]).collect();
        let mut table = table(&places, 1, &[]);
        assert_eq!(volumes(&table), [1.0, 1.0, 1.0, 2.0, 2.0, 1.0, 1.0, 1.0]);
        // the two sides of the gap are two bodies
        table.body = vec![0, 0, 0, 0, 1, 1, 1, 1];
        assert_eq!(volumes(&table), [1.0; 8]);
    }

    #[test]
    fn a_body_that_the_coarse_run_has_lost_counts_whole() {
        let own = square(4, 2);
        let mut other = own.clone();
        other.body.fill(1);
        assert_eq!(difference(&own, &other, "pressure"), Some(1.0));
    }

    #[test]
    fn particles_on_one_line_in_a_plane_have_the_values_of_the_nearest() {
        let own = table(&[[0.2, 0.5], [0.8, 0.5]], 2, &[1.0, 1.0]);
        let other = table(&[[0.25, 0.0], [0.75, 0.0]], 2, &[1.0, 1.0]);
        let values = at_particles(&other, &["pressure"], &own);
        assert_eq!(values[0], [1.25, 1.75]);
    }
}
