//! Phases on particles alone: their cells, their stress, and their state at the end of a step.

use std::ops::Range;

use decomp::IndexBox;
use smallvec::SmallVec;

use super::particle_domains::greatest;
use super::scheme::Scheme;
use super::tension_free;
use crate::material::constitutive::{ConstitutiveModel, MidStep, VolumeChange};
use crate::shape::{floor, integer};
use crate::solver::artificial_viscosity::{Flow, Viscosity};
use crate::solver::clock::{timed, timed_if};
use crate::solver::effect::{Effects, Phase, StepContext};
use crate::solver::parts::StepPart;
use crate::solver::patch::{Fault, FaultPhase, Patch, RemovedParticle};

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

/// Number of values at the start of a column that equal `body`, many compared at a time.
fn leading(column: &[f64], body: f64) -> usize {
    let is_whole = |some: &&[f64; 16]| some.iter().fold(true, |all, b| all & (*b == body));
    let whole = 16 * column.as_chunks::<16>().0.iter().take_while(is_whole).count();
    whole + column[whole..].iter().take_while(|&&b| b == body).count()
}

/// Ranges of particles of the same body.
pub(crate) fn bodies(column: &[f64]) -> impl Iterator<Item = (usize, Range<usize>)> + '_ {
    let mut at = 0;
    std::iter::from_fn(move || {
        let body = *column.get(at)?;
        let start = at;
        at += leading(&column[at..], body);
        Some((body as usize, start..at))
    })
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

    /// Volume ratio at the middle of a step of `dt` [s], J_h = J (1 + dt/2 D) [-].
    pub(super) fn half_step_volume(&self, patch: &mut Patch<D>, dt: f64) {
        let c = &self.columns;
        let mid = c.jacobian_mid.expect("mid-point stepping has the column");
        let [j, d, j_mid] =
            patch.block.columns.get_disjoint_mut([c.jacobian, c.divergence, mid]).expect("differ");
        j_mid.resize(j.len(), 0.0);
        // slices of equal length, so that the loops have no bounds checks
        let n = j.len();
        let (j, d, out) = (&j[..n], &d[..n], &mut j_mid[..n]);
        for r in 0..n {
            out[r] = j[r] * (1.0 + 0.5 * dt * d[r]);
        }
        if D > 1 || !self.domains_deform() {
            return;
        }
        let volume0 = &patch.block.columns[c.volume0][..n];
        let j_mid = &patch.block.columns[mid][..n];
        let (limit, scale) = (patch.reach_length, self.inverse_cell[0]);
        let torn = |r: usize| self.domain_length(volume0[r] * j_mid[r] * scale) > limit;
        // no early exit from the loop, which would prevent vectorization
        let any = (0..n).fold(false, |any, r| any | torn(r));
        if let Some(particle) = any.then(|| (0..n).find(|&r| torn(r))).flatten() {
            self.fault(
                patch,
                FaultPhase::Start,
                particle,
                "it is torn apart within one step".into(),
            );
        }
    }

    /// Writes q of own particles, at the volume ratio in column `jacobian`, to its column.
    pub(super) fn find_viscosity(&self, patch: &mut Patch<D>, jacobian: usize) {
        if let (Some(viscosity), Some(q)) = (&self.viscosity, self.columns.viscosity) {
            timed(StepPart::Viscosity as usize, patch, |patch| {
                self.fill_viscosity(patch, viscosity, q, jacobian);
            });
        }
    }

    fn fill_viscosity(
        &self,
        patch: &mut Patch<D>,
        viscosity: &Viscosity,
        q: usize,
        jacobian: usize,
    ) {
        let c = &self.columns;
        let mut out = std::mem::take(&mut patch.block.columns[q]);
        let column = |k: usize| &patch.block.columns[k][..out.len()];
        let at = Flow {
            mass: column(c.mass),
            volume0: column(c.volume0),
            jacobian: column(jacobian),
            sound_speed: column(c.sound_speed),
            gradient: column(c.divergence),
        };
        let phi = c.limiter.map(column);
        if self.total_lagrangian && D > 1 {
            for r in 0..out.len() {
                let (limited, stretch) = (phi.map_or(0.0, |phi| phi[r]), self.stretch(patch, r));
                out[r] = viscosity.of(&at, r, limited, stretch);
            }
        } else {
            viscosity.fill(&mut out, &at, phi, self.total_lagrangian.then_some(at.jacobian));
        }
        patch.block.columns[q] = out;
    }

    /// Stress at the middle of the step, and compliance if the step relaxes the pressure.
    pub(super) fn mid_step_stress(&self, patch: &mut Patch<D>, relax: bool) {
        let c = &self.columns;
        let n = patch.block.own();
        let mid = c.jacobian_mid.expect("mid-point stepping has the column");
        // columns to write are taken out of the block while others are read
        let mut take = |k: usize| {
            let mut column = std::mem::take(&mut patch.block.columns[k]);
            column.resize(n, 0.0);
            column
        };
        let mut stress = take(c.stress_volume);
        let mut relaxed = c.pressure_mid.zip(c.compliance).map(|(p, w)| (take(p), take(w)));
        let (columns, watch) = (&patch.block.columns, &mut patch.stopwatch);
        let column = |k: usize| &columns[k];
        let energy = c.energy_mid.unwrap_or(c.energy);
        for (body, particles) in bodies(&column(c.body)[..n]) {
            let ConstitutiveModel::Fluid(model) = &self.models[body] else {
                // pressure relaxation does not apply to solids
                if let Some((p, w)) = &mut relaxed {
                    p[particles.clone()].fill(0.0);
                    w[particles.clone()].fill(0.0);
                }
                continue;
            };
            let mid_step = MidStep {
                mass: &column(c.mass)[particles.clone()],
                volume0: &column(c.volume0)[particles.clone()],
                jacobian: &column(c.jacobian)[particles.clone()],
                jacobian_mid: &column(mid)[particles.clone()],
                energy: &column(energy)[particles.clone()],
                gradient: &column(c.divergence)[particles.clone()],
                edge: self.edge,
                floor: self.least_stiffness(),
                q: c.viscosity.map(|q| &column(q)[particles.clone()]),
                history: self.history[body].map(|h| &column(h)[particles.clone()]),
                stress_volume: &mut stress[particles.clone()],
                compliance: relaxed
                    .as_mut()
                    .filter(|_| relax)
                    .map(|(p, w)| (&mut p[particles.clone()], &mut w[particles])),
            };
            timed_if(self.history_part(body), watch, || model.mid_step(mid_step));
        }
        patch.block.columns[c.stress_volume] = stress;
        if let (Some((p, w)), Some(pressure), Some(compliance)) =
            (relaxed, c.pressure_mid, c.compliance)
        {
            patch.block.columns[pressure] = p;
            patch.block.columns[compliance] = w;
        }
    }

    /// Finds the cells of the own particles that are not at rest, after their stress is known: a
    /// particle is at rest if velocity, its gradients and stress are zero, so that it exerts no
    /// force.
    pub(super) fn find_active(&self, patch: &mut Patch<D>, effects: &Effects<D>) {
        if !self.may_sleep {
            return;
        }
        let c = &self.columns;
        let n = patch.block.own();
        let column = |k: usize| &patch.block.columns[k][..n];
        let tensors = c.affine.into_iter().chain(c.velocity_gradient);
        let tensors = tensors.flat_map(|k| k..k + D * D);
        let vector = c.velocity..c.velocity + D;
        let stress = c.stress_volume..c.stress_volume + c.stress_volumes;
        let scalars = [c.divergence].into_iter().chain(stress).chain(c.pressure_mid);
        let of_effects = c.zero_at_rest.iter().copied();
        let watched: SmallVec<[&[f64]; 16]> =
            vector.chain(scalars).chain(tensors).chain(of_effects).map(column).collect();
        let acting = effects.iter().filter(|effect| effect.changes_particles_at_rest());
        let acting: SmallVec<[_; 4]> = acting.collect();
        let moves = |r: usize| {
            watched.iter().any(|column| column[r] != 0.0)
                || acting.iter().any(|effect| effect.may_act(patch, r))
        };
        // all particles between the first and the last moving one: most of them move
        let active = match (0..n).find(|&r| moves(r)) {
            None => IndexBox::new([0; D], [0; D]),
            Some(first) => {
                let last = (first..n).rev().find(|&r| moves(r)).unwrap_or(first);
                let (mut lower, mut upper) = ([i64::MAX; D], [i64::MIN; D]);
                for cell in &patch.block.cells[first..=last] {
                    for a in 0..D {
                        lower[a] = lower[a].min(i64::from(cell[a]));
                        upper[a] = upper[a].max(i64::from(cell[a]) + 1);
                    }
                }
                IndexBox::new(lower, upper)
            }
        };
        patch.block.active = active;
    }

    /// Writes (p + q) V, from the columns of pressure and viscosity, to its column.
    pub(super) fn current_stress(&self, patch: &mut Patch<D>) {
        let c = &self.columns;
        let n = patch.block.own();
        let mut stress = std::mem::take(&mut patch.block.columns[c.stress_volume]);
        stress.resize(n, 0.0);
        let column = |k: usize| &patch.block.columns[k][..n];
        let (p, volume0, j) = (column(c.pressure), column(c.volume0), column(c.jacobian));
        match c.viscosity.map(column) {
            Some(q) => (0..n).for_each(|r| stress[r] = (p[r] + q[r]) * volume0[r] * j[r]),
            None => (0..n).for_each(|r| stress[r] = p[r] * volume0[r] * j[r]),
        }
        patch.block.columns[c.stress_volume] = stress;
        self.find_solid_stress(patch, 0.0, c.jacobian, c.deviator);
    }

    /// Volume, viscosity, energy and pressure after `dt` at the divergence in its column.
    pub(super) fn update_stress(&self, patch: &mut Patch<D>, step: &StepContext<'_, D>) {
        let (c, dt) = (&self.columns, step.dt);
        let mut before = std::mem::take(&mut patch.kept);
        before.clear();
        before.extend_from_slice(&patch.block.columns[c.jacobian]);
        let [j, d] =
            patch.block.columns.get_disjoint_mut([c.jacobian, c.divergence]).expect("differ");
        let n = before.len();
        let (j, d) = (&mut j[..n], &d[..n]);
        for r in 0..n {
            j[r] = before[r] * (1.0 + dt * d[r]);
        }
        self.invert_deformation(patch, dt, c.jacobian);
        self.find_viscosity(patch, c.jacobian);
        let mut pressure = std::mem::take(&mut patch.block.columns[c.pressure]);
        let mut energy = std::mem::take(&mut patch.block.columns[c.energy]);
        let n = patch.block.own();
        let (columns, watch) = (&patch.block.columns, &mut patch.stopwatch);
        let column = |k: usize| &columns[k];
        for (body, particles) in bodies(&column(c.body)[..n]) {
            let ConstitutiveModel::Fluid(model) = &self.models[body] else { continue };
            let change = VolumeChange {
                mass: &column(c.mass)[particles.clone()],
                volume0: &column(c.volume0)[particles.clone()],
                before: &before[particles.clone()],
                after: &column(c.jacobian)[particles.clone()],
                q: c.viscosity.map(|q| &column(q)[particles.clone()]),
                history: self.history[body].map(|h| &column(h)[particles.clone()]),
                pressure: &mut pressure[particles.clone()],
                energy: &mut energy[particles],
            };
            timed_if(self.history_part(body), watch, || model.change_volume(change));
        }
        self.work_on_solids(patch, dt, &before, &mut energy);
        patch.block.columns[c.pressure] = pressure;
        patch.block.columns[c.energy] = energy;
        patch.kept = before;
        step.effects.act(Phase::PressureUpdate, step, patch);
        step.effects.act(Phase::StressUpdate, step, patch);
        self.deform_forward(patch, dt);
    }

    /// Ends a step: effects, then pressure, sound speed, and the report of the patch.
    pub(super) fn end_step(&self, patch: &mut Patch<D>, step: &StepContext<'_, D>) {
        step.effects.act(Phase::EndState, step, patch);
        self.refresh(patch, step);
        step.effects.act(Phase::End, step, patch);
    }

    /// Pressure, temperature, sound speed and stress, and the report of the patch: time step,
    /// longest particle, faults.
    pub(super) fn refresh(&self, patch: &mut Patch<D>, step: &StepContext<'_, D>) {
        let of_fluids = self.find_pressure(patch);
        step.effects.act(Phase::EndTemperature, step, patch);
        step.effects.act(Phase::EndSoundSpeed, step, patch);
        let of_solids = self.find_end_stress(patch);
        self.report(patch, of_fluids.into_iter().chain(of_solids).collect());
    }

    /// Pressure and sound speed of the own particles of fluids by their equations of state; returns
    /// the first fault.
    fn find_pressure(&self, patch: &mut Patch<D>) -> Option<(usize, String)> {
        let c = &self.columns;
        let mut pressure = std::mem::take(&mut patch.block.columns[c.pressure]);
        let mut speed = std::mem::take(&mut patch.block.columns[c.sound_speed]);
        let mut histories = self.take_histories(patch);
        let n = patch.block.own();
        let (columns, watch) = (&patch.block.columns, &mut patch.stopwatch);
        let column = |k: usize| &columns[k];
        let mut found = None;
        for (body, particles) in bodies(&column(c.body)[..n]) {
            let ConstitutiveModel::Fluid(model) = &self.models[body] else { continue };
            let history = histories.iter_mut().find(|(k, _)| self.history[body] == Some(*k));
            let history = history.map(|(_, h)| &mut h[particles.clone()]);
            let (j, e) =
                (&column(c.jacobian)[particles.clone()], &column(c.energy)[particles.clone()]);
            let (p, speed) = (&mut pressure[particles.clone()], &mut speed[particles.clone()]);
            let fault = timed_if(self.history_part(body), watch, || match c.tension_free[body] {
                Some(damage) => {
                    let damage = &column(damage)[particles.clone()];
                    let models = (model.as_ref(), self.gradual_failure(body), damage);
                    tension_free::refresh(models, (j, e), history, (p, speed))
                }
                None => model.refresh(j, e, history, p, speed),
            });
            if let (None, Some((particle, what))) = (&found, fault) {
                found = Some((particles.start + particle, what));
            }
        }
        for (k, history) in histories {
            patch.block.columns[k] = history;
        }
        patch.block.columns[c.pressure] = pressure;
        patch.block.columns[c.sound_speed] = speed;
        found
    }

    /// Takes the columns of history variables out of a patch's block, with their indices.
    fn take_histories(&self, patch: &mut Patch<D>) -> SmallVec<[(usize, Vec<f64>); 2]> {
        let mut taken: SmallVec<[(usize, Vec<f64>); 2]> = SmallVec::new();
        for &k in self.history.iter().flatten() {
            if taken.iter().all(|(known, _)| *known != k) {
                taken.push((k, std::mem::take(&mut patch.block.columns[k])));
            }
        }
        taken
    }

    /// Part of a step to which the equation of state of a body is accounted, if it belongs to an
    /// effect.
    fn history_part(&self, body: usize) -> Option<usize> {
        self.history[body].and_then(|column| self.columns.owners[column])
    }

    /// Stress of the own particles, and pressure and sound speed of solids; returns the first
    /// fault.
    fn find_end_stress(&self, patch: &mut Patch<D>) -> Option<(usize, String)> {
        let c = &self.columns;
        c.stress?;
        let mut found = None;
        timed(StepPart::StressTensor as usize, patch, |patch| {
            let mut pressure = std::mem::take(&mut patch.block.columns[c.pressure]);
            let mut speed = std::mem::take(&mut patch.block.columns[c.sound_speed]);
            found = self.refresh_solids(patch, &mut pressure, &mut speed);
            patch.block.columns[c.pressure] = pressure;
            patch.block.columns[c.sound_speed] = speed;
        });
        found
    }

    /// Writes the report of a patch at the end of a step, with the faults `found` so far: longest
    /// stable time step, longest particle, first fault.
    fn report(&self, patch: &mut Patch<D>, mut found: SmallVec<[(usize, String); 2]>) {
        let c = &self.columns;
        let mut total = std::mem::take(&mut patch.kept);
        let column = |k: usize| &patch.block.columns[k];
        let velocity: [&[f64]; D] = decomp::array::from_fn(|a| &column(c.velocity + a)[..]);
        let d = column(c.divergence);
        let speed = &column(c.sound_speed)[..patch.block.own()];
        // greatest number of cells that a signal or particle crosses along a direction per second
        // [1/s]
        let mut fastest = 0.0f64;
        let mut lost = false;
        // greatest ratio of the initial to the current length of a cell that moves with the
        // material
        let mut shortest = 1.0f64;
        let stretched = if self.total_lagrangian { speed.len() } else { 0 };
        for r in 0..stretched {
            let (rate, shorter) = self.signal_rate(&patch.block, r, speed[r]);
            fastest = fastest.max(rate);
            shortest = shortest.max(shorter);
            lost |= rate.is_nan() || !velocity.iter().all(|v| v[r].is_finite());
        }
        let viscosity = self.viscosity;
        total.resize(speed.len() - stretched, 0.0);
        for a in 0..if self.total_lagrangian { 0 } else { D } {
            // slices of equal length, so that the loops have no bounds checks
            let (total, d) = (&mut total[..], &d[..speed.len()]);
            let (speed, v) = (&speed[..total.len()], &velocity[a][..total.len()]);
            for r in 0..total.len() {
                let added = viscosity.map_or(0.0, |q| q.speed(speed[r], d[r], 1.0));
                total[r] = speed[r] + v[r].abs() + added;
            }
            // ignores NaN
            let most = greatest(total);
            fastest = fastest.max(if D == 1 { most } else { most * self.inverse_cell[a] });
            lost |= total.iter().fold(false, |lost, total| lost | total.is_nan());
        }
        patch.kept = total;
        let edge = if D == 1 { self.cell[0] } else { 1.0 };
        patch.report.time_step = if fastest > 0.0 { edge / fastest } else { f64::INFINITY };
        patch.report.time_step =
            patch.report.time_step.min(self.of_effects.diffusion_step / (shortest * shortest));
        let limit = self.longest_ever();
        patch.report.length = self.longest_own(&patch.block);
        if patch.report.length > limit && self.domains_deform() {
            found.extend(self.first_longer(&patch.block, limit).map(|(particle, cells)| {
                (particle, format!(
                    "it has been stretched over {cells:.1} cells, further than its shape function reaches"
                ))
            }));
        }
        if lost {
            let finite = |r: &usize| {
                velocity.iter().all(|v| v[*r].is_finite())
                    && d[*r].is_finite()
                    && !speed[*r].is_nan()
            };
            let particle = (0..d.len()).find(|r| !finite(r));
            found.push((particle.unwrap_or(0), "its velocity is not a number".into()));
        }
        // the first particle of all faults, so that the result does not depend on the patches
        let found = found.into_iter().min_by_key(|(particle, _)| *particle);
        if let Some((particle, what)) = found {
            self.fault(patch, FaultPhase::End, particle, what);
        }
    }

    /// Greatest number of cells that a signal crosses along a direction per second at an own
    /// particle, as in the time step [1/s].
    pub fn wave_rate(&self, block: &decomp::Block<D>, particle: usize) -> f64 {
        let column = |k: usize| block.columns[k][particle];
        let speed = column(self.columns.sound_speed);
        if self.total_lagrangian {
            let (rate, _) = self.signal_rate(block, particle, speed);
            return if D == 1 { rate * self.inverse_cell[0] } else { rate };
        }
        let gradient = column(self.columns.divergence);
        let added = self.viscosity.map_or(0.0, |q| q.speed(speed, gradient, 1.0));
        let along = |a: usize| {
            (speed + column(self.columns.velocity + a).abs() + added) * self.inverse_cell[a]
        };
        (0..D).map(along).fold(0.0, f64::max)
    }

    /// Volume of an own particle in cells [cells]; in initial cells if the grid moves with the
    /// material.
    pub fn filled_cells(&self, block: &decomp::Block<D>, particle: usize) -> f64 {
        let column = |k: usize| block.columns[k][particle];
        let c = &self.columns;
        let about = if self.axisymmetric { column(c.position) } else { 1.0 };
        let scale: f64 = self.inverse_cell.iter().product();
        let jacobian = if self.total_lagrangian { 1.0 } else { column(c.jacobian) };
        column(c.volume0) * jacobian * scale / about
    }

    /// Kinetic and internal energy of an own particle per unit mass [J/kg].
    pub fn specific_energy(&self, block: &decomp::Block<D>, particle: usize) -> f64 {
        let column = |k: usize| block.columns[k][particle];
        let v = |a: usize| column(self.columns.velocity + a);
        column(self.columns.energy) + 0.5 * (0..D).map(|a| v(a) * v(a)).sum::<f64>()
    }

    /// Records a fault, if it comes before the known ones.
    pub(crate) fn fault(
        &self,
        patch: &mut Patch<D>,
        phase: FaultPhase,
        particle: usize,
        what: String,
    ) {
        let block = &patch.block;
        let fault = Fault {
            phase,
            cell: block.cells[particle].map(i64::from),
            id: block.ids[particle],
            position: decomp::array::from_fn(|a| {
                block.columns[self.columns.position + a][particle]
            }),
            body: block.columns[self.columns.body][particle] as usize,
            what,
        };
        if patch.report.fault.as_ref().is_none_or(|known| fault.order() < known.order()) {
            patch.report.fault = Some(fault);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::bodies;

    #[test]
    fn bodies_are_the_longest_ranges_of_equal_numbers() {
        for lengths in [&[][..], &[1], &[16, 3], &[5, 40, 16, 1, 33]] {
            let (mut column, mut expected) = (Vec::new(), Vec::new());
            for (body, &length) in lengths.iter().enumerate() {
                expected.push((body, column.len()..column.len() + length));
                column.resize(column.len() + length, body as f64);
            }
            assert_eq!(bodies(&column).collect::<Vec<_>>(), expected);
        }
    }
}
