//! Mean states ahead of and behind a shock in one body.

use crate::simulation::ParticleTable;

/// State of a material.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct ShockState {
    /// Density \[kg/m3\].
    pub density: f64,
    /// Velocity \[m/s\].
    pub velocity: f64,
    /// Pressure \[Pa\].
    pub pressure: f64,
}

impl ShockState {
    /// Mean over the particles of `body` that are at most `reach` from `centre` \[m\]; `None` if
    /// there are none.
    pub fn behind(table: &ParticleTable, body: usize, centre: f64, reach: f64) -> Option<Self> {
        let x = table.column("x")?;
        let near = |r: &usize| (x[*r] - centre).abs() <= reach;
        Self::mean(table, rows(table, body).filter(near))
    }

    /// State of the particle of `body` whose pressure is nearest to `start` \[Pa\], which no wave
    /// has reached.
    pub fn ahead(table: &ParticleTable, body: usize, start: f64) -> Option<Self> {
        let pressure = table.column("pressure")?;
        let change = |r: &usize| (pressure[*r] - start).abs();
        let still = rows(table, body).min_by(|a, b| change(a).total_cmp(&change(b)))?;
        Self::mean(table, std::iter::once(still))
    }

    fn mean(table: &ParticleTable, rows: impl Iterator<Item = usize>) -> Option<Self> {
        let names = ["density", "velocity", "pressure"];
        let columns = names.map(|name| table.column(name));
        let (mut count, mut sums) = (0.0, [0.0; 3]);
        for r in rows {
            count += 1.0;
            for (sum, column) in sums.iter_mut().zip(columns) {
                *sum += column?[r];
            }
        }
        let [density, velocity, pressure] = sums.map(|sum| sum / count);
        (count > 0.0).then_some(ShockState { density, velocity, pressure })
    }
}

/// Rows of a body.
fn rows(table: &ParticleTable, body: usize) -> impl Iterator<Item = usize> + '_ {
    (0..table.len()).filter(move |&r| table.body[r] as usize == body)
}
