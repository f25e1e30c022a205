//! Cells of particles, and what happens at the sides of the domain: particles are wrapped, removed,
//! returned to walls, or end the run.

use std::ops::Range;

use super::scheme::Scheme;
use crate::shape::{floor, integer};
use crate::solver::patch::{FaultPhase, Patch, RemovedParticle};

/// Number of particles whose cells along a direction are kept at a time.
const BLOCK: usize = 128;

/// Distance beyond a rigid side within which a particle is returned to it [cells]; the velocity of
/// particles and the tilt of their domains carry them by some 0.001 cells beyond.
const WALL_TOLERANCE: f64 = 0.02;

/// Cells of particles at x + `drift` v along a direction of a grid (lower end, inverse edge, number
/// of cells), and the positions of the particles in them; returns whether any is outside the grid.
// inlining would prevent vectorization
#[inline(never)]
fn find_cells(
    [x, v]: [&[f64]; 2],
    drift: f64,
    (lower, inverse, count): (f64, f64, f64),
    fraction: &mut [f64],
    cells: &mut [i32; BLOCK],
) -> bool {
    let n = fraction.len();
    let (x, v, cells) = (&x[..n], &v[..n], &mut cells[..n]);
    let mut outside = false;
    for r in 0..n {
        let place = (x[r] + drift * v[r] - lower) * inverse;
        let cell = floor(place);
        fraction[r] = place - cell;
        outside |= !(cell >= 0.0 && cell < count);
        cells[r] = integer(cell);
    }
    outside
}

impl<const D: usize> Scheme<D> {
    /// Finds the cell of each own particle at x + `ahead` v, with `ahead` [s], its position in the
    /// cell, and its domain for the shape function at the volume ratio in column `jacobian`.
    /// Particles beyond an open side are removed. A particle that passes a whole cell is a fault: no
    /// stable step is that long, and ghosts are exchanged for moves to the next cell. In the
    /// total-Lagrangian frame cell and domain are the initial ones.
    pub(super) fn find_cells(&self, patch: &mut Patch<D>, ahead: f64, jacobian: usize) {
        patch.block.drop_ghosts();
        let c = &self.columns;
        let n = patch.block.own();
        let mut outside = false;
        let (position, drift) = match c.reference {
            Some(first) => (first, 0.0),
            None => (c.position, ahead),
        };
        for a in 0..D {
            patch.block.columns[c.fraction + a].resize(n, 0.0);
        }
        for start in (0..n).step_by(BLOCK) {
            let particles = start..n.min(start + BLOCK);
            let mut cells = [[0; BLOCK]; D];
            for (a, cells) in cells.iter_mut().enumerate() {
                let [x, v, fraction] = patch
                    .block
                    .columns
                    .get_disjoint_mut([position + a, c.velocity + a, c.fraction + a])
                    .expect("columns differ");
                let grid = (self.lower[a], self.inverse_cell[a], self.cells[a] as f64);
                let from = [&x[particles.clone()], &v[particles.clone()]];
                outside |= find_cells(from, drift, grid, &mut fraction[particles.clone()], cells);
            }
            let mut far = false;
            for (r, cell) in patch.block.cells[particles.clone()].iter().enumerate() {
                far |= (0..D).fold(false, |far, a| far | (cells[a][r].abs_diff(cell[a]) > 1));
            }
            if far {
                self.stop_far_moves(patch, particles.clone(), &mut cells);
            }
            for (r, cell) in patch.block.cells[particles].iter_mut().enumerate() {
                *cell = decomp::array::from_fn(|a| cells[a][r]);
            }
        }
        if self.total_lagrangian {
            self.find_first_domains(patch);
            self.find_shift(patch, ahead, jacobian);
            self.fault_beyond_walls(patch);
        } else {
            self.find_domains(patch, ahead, jacobian);
        }
        if outside {
            self.handle_exit(patch);
        }
    }

    /// Reports a fault for each of `particles` whose new cell in `cells` is neither its present one nor
    /// next to it. Its cell stays the present one until the run ends or the step is repeated.
    /// [`handle_exit`](Self::handle_exit) decides about those that leave the domain and are not
    /// returned to a wall.
    fn stop_far_moves(
        &self,
        patch: &mut Patch<D>,
        particles: Range<usize>,
        cells: &mut [[i32; BLOCK]; D],
    ) {
        for (r, particle) in particles.enumerate() {
            let was = patch.block.cells[particle];
            let leaves = |a: usize| {
                let cell = i64::from(cells[a][r]);
                !self.sides[a][0].is_periodic()
                    && !(0..self.cells[a]).contains(&cell)
                    && !self.is_at_wall(patch, particle, a, cell)
            };
            if (0..D).any(leaves) {
                continue;
            }
            // by the shorter way: cells are wrapped across periodic sides, positions are not
            let cells_passed = |a: usize| {
                let by = (i64::from(cells[a][r]) - i64::from(was[a])).abs();
                if by <= 1 || !self.sides[a][0].is_periodic() {
                    return by;
                }
                let by = by % self.cells[a];
                by.min(self.cells[a] - by)
            };
            let most = (0..D).map(cells_passed).fold(0, i64::max);
            if most > 1 {
                let what = format!("it moves by {most} cells in one step, allowed: 1");
                self.fault(patch, FaultPhase::Locate, particle, what);
                for a in 0..D {
                    cells[a][r] = was[a];
                    patch.block.columns[self.columns.fraction + a][particle] = 0.5;
                }
            }
        }
    }

    /// Wraps particles across periodic sides, removes particles at outflow sides, returns those that
    /// pass a rigid side by little, and reports a fault for others.
    fn handle_exit(&self, patch: &mut Patch<D>) {
        const NAMES: [[&str; 2]; 2] = [["lower", "upper"], ["lower y", "upper y"]];
        let mut keep = vec![true; patch.block.own()];
        for (particle, keep) in keep.iter_mut().enumerate() {
            for a in 0..D {
                let cell = i64::from(patch.block.cells[particle][a]);
                if (0..self.cells[a]).contains(&cell) {
                    continue;
                }
                let end = usize::from(cell >= 0);
                let side = &self.sides[a][end];
                if side.is_periodic() {
                    patch.block.cells[particle][a] = cell.rem_euclid(self.cells[a]) as i32;
                    continue;
                }
                if self.is_at_wall(patch, particle, a, cell) {
                    self.return_to_wall(patch, particle, a, end);
                    continue;
                }
                if side.lets_out {
                    *keep = false;
                } else {
                    let what = format!("it leaves the domain by its {} side", NAMES[a][end]);
                    self.fault(patch, FaultPhase::Locate, particle, what);
                }
                // it stays within the arrays until it is removed or the run ends
                patch.block.cells[particle][a] = cell.clamp(0, self.cells[a] - 1) as i32;
                patch.block.columns[self.columns.fraction + a][particle] = 0.5;
            }
        }
        if keep.contains(&false) {
            let gone: Vec<usize> = (0..keep.len()).filter(|&r| !keep[r]).collect();
            self.remove_particles(patch, &gone, false);
        }
    }

    /// Whether a particle whose new cell along `a` is `cell`, outside of the domain, passes a rigid
    /// side by at most [`WALL_TOLERANCE`]. Not at the axis of an axisymmetric domain, where radii
    /// must stay positive.
    fn is_at_wall(&self, patch: &Patch<D>, particle: usize, a: usize, cell: i64) -> bool {
        let end = usize::from(cell >= 0);
        let is_axis = self.axisymmetric && (a, end) == (0, 0) && self.lower[0] == 0.0;
        let fraction = patch.block.columns[self.columns.fraction + a][particle];
        let (next, beyond) =
            if end == 0 { (-1, 1.0 - fraction) } else { (self.cells[a], fraction) };
        self.sides[a][end].is_rigid() && !is_axis && cell == next && beyond <= WALL_TOLERANCE
    }

    /// Locates a particle that passes a rigid side by little on the side, and mirrors its position
    /// if that is beyond it. The nodal velocity is along the side there, but neither the particle's
    /// own velocity, which gives its position at the middle of a step, nor the mean over a
    /// parallelogram that is oblique to the side.
    fn return_to_wall(&self, patch: &mut Patch<D>, particle: usize, a: usize, end: usize) {
        let c = &self.columns;
        let block = &mut patch.block;
        let wall = self.lower[a] + if end == 0 { 0.0 } else { self.cells[a] as f64 * self.cell[a] };
        let x = &mut block.columns[c.position + a][particle];
        let is_beyond = if end == 0 { *x < wall } else { *x > wall };
        if is_beyond {
            *x = 2.0 * wall - *x;
        }
        block.cells[particle][a] = if end == 0 { 0 } else { self.cells[a] as i32 - 1 };
        block.columns[c.fraction + a][particle] = if end == 0 { 0.0 } else { 1.0f64.next_down() };
    }

    /// Removes and records the own particles in `gone`, in ascending order. There must be no
    /// ghosts.
    pub(crate) fn remove_particles(&self, patch: &mut Patch<D>, gone: &[usize], eroded: bool) {
        let c = &self.columns;
        for &particle in gone {
            let column = |k: usize| patch.block.columns[k][particle];
            patch.removed.push(RemovedParticle {
                id: patch.block.ids[particle],
                mass: column(c.mass),
                velocity: decomp::array::from_fn(|a| column(c.velocity + a)),
                energy: column(c.energy) + self.spin_energy(&patch.block.columns, particle),
                eroded,
            });
        }
        patch.block.remove(gone);
    }
}
