//! The columns of a particle row, declared once, and the filling of bodies.
//!
//! Which columns there are follows from what the scene names: an effect that it does not name
//! has none.

use decomp::{Block, ColumnSpec, IndexBox, Layout, Mirror};
use nalgebra::SVector;

use crate::scene::{CheckedScene, Stepping, Transfer};

/// Where each column stands in a block. Vectors take D columns.
#[derive(Clone, Debug)]
pub struct Columns {
    /// The declarations, in order.
    pub specs: Vec<ColumnSpec>,
    /// Position x [m].
    pub position: usize,
    /// Velocity [m/s].
    pub velocity: usize,
    /// Mass [kg] (in 1-D per unit area, kg/m2).
    pub mass: usize,
    /// Volume at J = 1 [m3] (in 1-D per unit area, m).
    pub volume0: usize,
    /// Volume ratio J = V/V0 [-].
    pub jacobian: usize,
    /// Specific internal energy e [J/kg].
    pub energy: usize,
    /// Number of the body.
    pub body: usize,
    /// Divergence of the velocity D of the last step [1/s].
    pub gradient: usize,
    /// Sound speed c [m/s].
    pub sound_speed: usize,
    /// Pressure p without artificial viscosity [Pa].
    pub pressure: usize,
    /// Artificial viscosity q [Pa], with viscosity.
    pub viscosity: Option<usize>,
    /// What the limiter takes away, phi in [0, 1], with a limiter.
    pub limiter: Option<usize>,
    /// Affine part of the velocity [1/s], with APIC.
    pub affine: Option<usize>,
    /// Place in the cell [cells], scratch.
    pub fraction: usize,
    /// Length for the shape function [cells], scratch.
    pub length: usize,
    /// (p + q) V [J], scratch.
    pub stress_volume: usize,
    /// J at the middle of the step, scratch, with mid-point stepping.
    pub jacobian_mid: Option<usize>,
    /// Pressure at the middle of the step [Pa], scratch, with pressure relaxation.
    pub pressure_mid: Option<usize>,
    /// -dV/dp at the middle of the step [m3/Pa], scratch, with pressure relaxation.
    pub compliance: Option<usize>,
}

impl Columns {
    /// The columns that `scene` calls for.
    pub fn new(scene: &CheckedScene) -> Self {
        let mut specs = Vec::new();
        let mut add = |name, unit, ghost, state, mirror| {
            specs.push(ColumnSpec { name, unit, ghost, state, mirror });
            specs.len() - 1
        };
        let method = &scene.scene.method;
        let midpoint = method.stepping == Stepping::Midpoint;
        let viscous = scene.scene.artificial_viscosity;
        let limited = viscous.is_some_and(|v| v.limiter.is_some());
        let relaxed = method.pressure_relaxation.is_some();
        let same = Mirror::Same;
        Columns {
            position: add("position", "m", false, true, same),
            velocity: add("velocity", "m/s", true, true, Mirror::Negate(0)),
            mass: add("mass", "kg", true, true, same),
            volume0: add("volume0", "m3", false, true, same),
            jacobian: add("jacobian", "", false, true, same),
            energy: add("specific_internal_energy", "J/kg", false, true, same),
            body: add("body", "", false, true, same),
            gradient: add("velocity_gradient", "1/s", false, true, same),
            sound_speed: add("sound_speed", "m/s", false, true, same),
            pressure: add("pressure", "Pa", false, true, same),
            viscosity: viscous.map(|_| add("artificial_viscosity", "Pa", false, true, same)),
            limiter: limited.then(|| add("viscosity_limiter", "", false, true, same)),
            affine: (method.transfer == Transfer::Apic)
                .then(|| add("affine_velocity", "1/s", true, true, same)),
            fraction: add("cell_fraction", "", true, false, Mirror::Complement(0)),
            length: add("cell_length", "", true, false, same),
            stress_volume: add("stress_volume", "J", true, false, same),
            jacobian_mid: midpoint.then(|| add("jacobian_mid", "", false, false, same)),
            pressure_mid: relaxed.then(|| add("pressure_mid", "Pa", true, false, same)),
            compliance: relaxed.then(|| add("compliance", "m3/Pa", true, false, same)),
            specs,
        }
    }

    /// The columns that are part of the state.
    pub fn state(&self) -> Vec<usize> {
        (0..self.specs.len()).filter(|&c| self.specs[c].state).collect()
    }
}

/// Centres of the equal boxes that `counts` of them in each direction cut a box into; the first
/// direction runs fastest.
fn lattice<const D: usize>(
    lower: SVector<f64, D>,
    upper: SVector<f64, D>,
    counts: [usize; D],
) -> impl Iterator<Item = SVector<f64, D>> {
    let size = upper - lower;
    IndexBox::new([0; D], counts.map(|n| n as i64)).iter().map(move |k| {
        let share = |a: usize| (2 * k[a] + 1) as f64 / (2 * counts[a]) as f64;
        lower + size.component_mul(&SVector::from_fn(|a, _| share(a)))
    })
}

/// Fills the bodies with particles, keeping those whose patch is on `rank`: a block a patch of
/// the rank. Ids number the particles of all bodies in order, whatever the layout. Velocities
/// are those seen from a grid that travels at `grid_velocity` [m/s].
///
/// A body's particles tile it: each has an equal share of its volume and mass to rounding.
pub fn fill(
    scene: &CheckedScene,
    columns: &Columns,
    layout: &Layout<1>,
    rank: usize,
    grid_velocity: f64,
    energies: &[f64],
) -> Vec<Block<1>> {
    let mine = layout.patches_of(rank);
    let mut blocks: Vec<Block<1>> = mine.iter().map(|_| Block::new(&columns.specs)).collect();
    let mut place = vec![None; layout.patches().len()];
    for (k, &p) in mine.iter().enumerate() {
        place[p] = Some(k);
    }
    let mut row = vec![0.0; columns.specs.len()];
    let mut id = 0u64;
    for (number, (body, checked)) in scene.scene.bodies.iter().zip(&scene.bodies).enumerate() {
        let material = &scene.scene.materials[&body.material];
        let lower = SVector::from([body.extent.lower[0]]);
        let upper = SVector::from([body.extent.upper[0]]);
        let counts = [checked.lattice[0]];
        let length = (upper - lower)[0] / counts[0] as f64;
        for centre in lattice(lower, upper, counts) {
            let x = centre[0];
            let cell = cell_of(scene, x);
            let patch = layout.wrap_cell([cell]).map(|c| layout.patch_of(c));
            if let Some(block) = patch.and_then(|p| place[p]) {
                row.fill(0.0);
                row[columns.position] = x;
                row[columns.velocity] = checked.velocity[0] - grid_velocity;
                row[columns.mass] = material.density * length;
                row[columns.volume0] = length;
                row[columns.jacobian] = 1.0;
                row[columns.energy] = energies[number];
                row[columns.body] = number as f64;
                blocks[block].push(id, [cell as i32], &row);
            }
            id += 1;
        }
    }
    for block in &mut blocks {
        block.sort_own();
    }
    blocks
}

/// The cell of a place.
pub fn cell_of(scene: &CheckedScene, x: f64) -> i64 {
    ((x - scene.scene.domain.lower[0]) * (1.0 / scene.cell_size[0])).floor() as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lattice_has_the_centres_of_its_boxes() {
        let lower = SVector::from([-1.0, 0.0]);
        let places: Vec<_> = lattice(lower, SVector::from([1.0, 3.0]), [2, 3]).collect();
        assert_eq!(places.len(), 6);
        assert_eq!(places[0], SVector::from([-0.5, 0.5]));
        assert_eq!(places[1], SVector::from([0.5, 0.5]));
        assert_eq!(places[5], SVector::from([0.5, 2.5]));
    }
}
