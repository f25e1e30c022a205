//! Pressure over position in one body.

use crate::scene::CheckedScene;
use crate::simulation::ParticleTable;

/// Pressures \[Pa\] over positions \[m\] in one body.
pub type Polyline = Vec<(f64, f64)>;

/// Pressure over position of the particles of one body.
///
/// # Panics
///
/// If the table has no column `x` or `pressure`.
pub fn line(table: &ParticleTable, body: usize) -> Polyline {
    let column = |name| table.column(name).expect("the table has its own columns");
    let (x, p) = (column("x"), column("pressure"));
    let own = (0..table.len()).filter(|&r| table.body[r] as usize == body);
    own.map(|r| (x[r], p[r])).collect()
}

/// Linear interpolation between points with increasing abscissas at `x`; `None` outside of them.
pub fn interpolate(points: &[(f64, f64)], x: f64) -> Option<f64> {
    let next = points.partition_point(|point| point.0 < x);
    let (x1, y1) = *points.get(next)?;
    if x1 == x {
        return Some(y1);
    }
    let (x0, y0) = points[next.checked_sub(1)?];
    Some(y0 + (y1 - y0) * (x - x0) / (x1 - x0))
}

/// Pressures up to this fraction of rho c^2 are rounding, not a wave \[-\].
pub(super) const ROUNDING: f64 = 1e-9;

/// Pressure of `body` up to which a change is rounding, not a wave \[Pa\]; `cell_time` \[s\] is the
/// sound transit time of a cell.
pub fn least_pressure(scene: &CheckedScene, body: usize, cell_time: f64) -> f64 {
    ROUNDING * scene.material_of(body).density * (scene.cell_size[0] / cell_time).powi(2)
}
