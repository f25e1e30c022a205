//! Phases that look at rows alone: where they are, their stress, the state they end in.

use std::ops::Range;

use decomp::IndexBox;

use super::particle_domains::greatest;
use super::{Stepper, failure};
use crate::effects::Effect;
use crate::effects::artificial_viscosity::Flow;
use crate::material::constitutive::{Matter, MidStep, VolumeChange};
use crate::scene::Side;
use crate::solver::clock::spend;
use crate::solver::patch::{Departed, Fault, Patch, Phase};
use crate::solver::shape::{floor, integer};

/// Stiffness that pressure relaxation takes a gas to have at least, over the pressure that counts
/// as none: 2^-30 of the scene's. What rounding leaves of pressure then moves no volume.
const COLD: f64 = (1u64 << 20) as f64;

/// Rows whose cells along a direction are kept at a time.
const BLOCK: usize = 128;

/// Cells of rows at x + `drift` v along a direction of the grid, which has a lower end, an inverse
/// edge and a count of cells, and the rows' places in them; whether any lies outside the grid.
// inlined it is no longer computed for some rows at a time
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

/// Ranges of rows of one body.
pub(super) fn bodies(column: &[f64]) -> impl Iterator<Item = (usize, Range<usize>)> + '_ {
    let mut at = 0;
    std::iter::from_fn(move || {
        let body = *column.get(at)?;
        let start = at;
        at += column[at..].iter().take_while(|&&b| b == body).count();
        Some((body as usize, start..at))
    })
}

impl<const D: usize> Stepper<D> {
    /// Finds the cell of each own row at x + `ahead` v, its place in it, and its domain for the
    /// shape function at volume ratio `jacobian` (a column). Rows beyond an open side leave. In the
    /// total-Lagrangian frame both are those of the start.
    pub(super) fn locate(&self, patch: &mut Patch<D>, ahead: f64, jacobian: usize) {
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
            let rows = start..n.min(start + BLOCK);
            let mut cells = [[0; BLOCK]; D];
            for (a, cells) in cells.iter_mut().enumerate() {
                let [x, v, fraction] = patch
                    .block
                    .columns
                    .get_disjoint_mut([position + a, c.velocity + a, c.fraction + a])
                    .expect("columns differ");
                let grid = (self.lower[a], self.inverse_cell[a], self.cells[a] as f64);
                let from = [&x[rows.clone()], &v[rows.clone()]];
                outside |= find_cells(from, drift, grid, &mut fraction[rows.clone()], cells);
            }
            for (r, cell) in patch.block.cells[rows].iter_mut().enumerate() {
                *cell = std::array::from_fn(|a| cells[a][r]);
            }
        }
        if self.total {
            self.find_first_domains(patch);
            self.find_shift(patch, ahead, jacobian);
            self.fault_beyond_walls(patch);
        } else {
            self.find_domains(patch, ahead, jacobian);
        }
        if outside {
            self.leave(patch);
        }
    }

    /// Wraps rows across joined sides, books those that leave by an outflow, faults the others.
    fn leave(&self, patch: &mut Patch<D>) {
        const NAMES: [[&str; 2]; 2] = [["lower", "upper"], ["lower y", "upper y"]];
        let mut keep = vec![true; patch.block.own()];
        for (row, keep) in keep.iter_mut().enumerate() {
            for a in 0..D {
                let cell = i64::from(patch.block.cells[row][a]);
                if (0..self.cells[a]).contains(&cell) {
                    continue;
                }
                let side = usize::from(cell >= 0);
                match &self.sides[a][side] {
                    Side::Periodic => {
                        patch.block.cells[row][a] = cell.rem_euclid(self.cells[a]) as i32;
                        continue;
                    }
                    side if side.lets_out() => *keep = false,
                    _ => {
                        let name = NAMES[a][side];
                        let what = format!("it leaves the domain by its {name} side");
                        self.fault(patch, Phase::Locate, row, what);
                    }
                }
                // it stays within the arrays until it is taken out or the run ends
                patch.block.cells[row][a] = cell.clamp(0, self.cells[a] - 1) as i32;
                patch.block.columns[self.columns.fraction + a][row] = 0.5;
            }
        }
        if keep.contains(&false) {
            let gone: Vec<usize> = (0..keep.len()).filter(|&r| !keep[r]).collect();
            self.depart(patch, &gone, false);
        }
    }

    /// Takes out and books the own rows of `gone`, which ascend. There must be no ghosts.
    pub(super) fn depart(&self, patch: &mut Patch<D>, gone: &[usize], eroded: bool) {
        let c = &self.columns;
        for &row in gone {
            let column = |k: usize| patch.block.columns[k][row];
            patch.departed.push(Departed {
                id: patch.block.ids[row],
                mass: column(c.mass),
                velocity: std::array::from_fn(|a| column(c.velocity + a)),
                energy: column(c.energy),
                eroded,
            });
        }
        patch.block.remove(gone);
    }

    /// Volume ratio at the middle of the step, J_h = J (1 + dt/2 D).
    pub(super) fn half_step_volume(&self, patch: &mut Patch<D>, dt: f64) {
        let c = &self.columns;
        let mid = c.jacobian_mid.expect("mid-point stepping has the column");
        let [j, d, j_mid] =
            patch.block.columns.get_disjoint_mut([c.jacobian, c.gradient, mid]).expect("differ");
        j_mid.resize(j.len(), 0.0);
        for r in 0..j.len() {
            j_mid[r] = j[r] * (1.0 + 0.5 * dt * d[r]);
        }
        if D > 1 || !self.domains_deform() {
            return;
        }
        let volume0 = &patch.block.columns[c.volume0];
        let j_mid = &patch.block.columns[mid];
        let (limit, scale) = (patch.reach_length, self.inverse_cell[0]);
        let torn = |r: &usize| self.domain_length(volume0[*r] * j_mid[*r] * scale) > limit;
        if let Some(row) = (0..j_mid.len()).find(torn) {
            self.fault(patch, Phase::Start, row, "it is torn apart within one step".into());
        }
    }

    /// q of own rows at volume ratio `jacobian` (a column), into its column.
    pub(super) fn find_viscosity(&self, patch: &mut Patch<D>, jacobian: usize) {
        let (Some(viscosity), Some(q)) = (&self.viscosity, self.columns.viscosity) else { return };
        let c = &self.columns;
        let mut out = std::mem::take(&mut patch.block.columns[q]);
        let column = |k: usize| &patch.block.columns[k][..out.len()];
        let at = Flow {
            mass: column(c.mass),
            volume0: column(c.volume0),
            jacobian: column(jacobian),
            sound_speed: column(c.sound_speed),
            gradient: column(c.gradient),
        };
        let phi = c.limiter.map(column);
        if self.total && D > 1 {
            for r in 0..out.len() {
                let (limited, stretch) = (phi.map_or(0.0, |phi| phi[r]), self.stretch(patch, r));
                out[r] = viscosity.of(&at, r, limited, stretch);
            }
        } else {
            viscosity.fill(&mut out, &at, phi, self.total.then_some(at.jacobian));
        }
        patch.block.columns[q] = out;
    }

    /// Stress at the middle of the step, and compliance if the step relaxes the pressure.
    pub(super) fn mid_step_stress(&self, patch: &mut Patch<D>, relax: bool) {
        let c = &self.columns;
        let n = patch.block.own();
        let mid = c.jacobian_mid.expect("mid-point stepping has the column");
        // columns that are written leave the block while the others are read
        let mut take = |k: usize| {
            let mut column = std::mem::take(&mut patch.block.columns[k]);
            column.resize(n, 0.0);
            column
        };
        let mut stress = take(c.stress_volume);
        let mut relaxed = c.pressure_mid.zip(c.compliance).map(|(p, w)| (take(p), take(w)));
        let column = |k: usize| &patch.block.columns[k];
        let energy = c.strength.map_or(c.energy, |c| c.energy_mid);
        for (body, rows) in bodies(&column(c.body)[..patch.block.own()]) {
            let Matter::Fluid(model) = &self.models[body] else {
                // pressure relaxation leaves solids alone
                if let Some((p, w)) = &mut relaxed {
                    p[rows.clone()].fill(0.0);
                    w[rows.clone()].fill(0.0);
                }
                continue;
            };
            model.mid_step(MidStep {
                mass: &column(c.mass)[rows.clone()],
                volume0: &column(c.volume0)[rows.clone()],
                jacobian: &column(c.jacobian)[rows.clone()],
                jacobian_mid: &column(mid)[rows.clone()],
                energy: &column(energy)[rows.clone()],
                gradient: &column(c.gradient)[rows.clone()],
                edge: self.edge,
                floor: COLD * self.still_pressure,
                q: c.viscosity.map(|q| &column(q)[rows.clone()]),
                history: self.history[body].map(|h| &column(h)[rows.clone()]),
                stress_volume: &mut stress[rows.clone()],
                compliance: relaxed
                    .as_mut()
                    .filter(|_| relax)
                    .map(|(p, w)| (&mut p[rows.clone()], &mut w[rows])),
            });
        }
        patch.block.columns[c.stress_volume] = stress;
        if let (Some((p, w)), Some(pressure), Some(compliance)) =
            (relaxed, c.pressure_mid, c.compliance)
        {
            patch.block.columns[pressure] = p;
            patch.block.columns[compliance] = w;
        }
    }

    /// The cells of the own rows that are not at rest, once their stress is known: a row is at
    /// rest where velocity, its gradients and stress are zero, so that it pushes nothing.
    pub(super) fn find_active(&self, patch: &mut Patch<D>) {
        if !self.may_sleep {
            return;
        }
        let c = &self.columns;
        let n = patch.block.own();
        let column = |k: usize| &patch.block.columns[k][..n];
        let foretold = c.side.map(|side| side.gradient);
        let tensors = c.affine.into_iter().chain(c.velocity_gradient).chain(foretold);
        let tensors = tensors.flat_map(|k| k..k + D * D);
        let vector = c.velocity..c.velocity + D;
        let stress = c.stress_volume..c.stress_volume + c.stress_volumes;
        let pulled = c.body_force.map(|c| c.force..c.force + D).into_iter().flatten();
        let scalars = [c.gradient].into_iter().chain(pulled).chain(stress).chain(c.pressure_mid);
        let watched: smallvec::SmallVec<[&[f64]; 16]> =
            vector.chain(scalars).chain(tensors).map(column).collect();
        let burns = c.burn.map(|c| (column(c.lighting_time), column(c.fraction)));
        // what waits to be lit moves by itself
        let waits = |r: usize| burns.is_some_and(|(lit, f)| lit[r] >= 0.0 && f[r] < 1.0);
        let moves = |r: usize| watched.iter().any(|column| column[r] != 0.0) || waits(r);
        // rows from the first to the last that moves: those between mostly do
        patch.block.active = match (0..n).find(|&r| moves(r)) {
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
    }

    /// (p + q) V from the columns of pressure and viscosity, into its own.
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
        self.find_solid_stress(patch, 0.0, c.jacobian, c.strength.map(|c| c.deviator));
    }

    /// Volume, viscosity, energy and pressure after `dt` at the divergence in its column.
    pub(super) fn update_stress(&self, patch: &mut Patch<D>, dt: f64) {
        let c = &self.columns;
        let mut before = std::mem::take(&mut patch.kept);
        before.clear();
        before.extend_from_slice(&patch.block.columns[c.jacobian]);
        let [j, d] =
            patch.block.columns.get_disjoint_mut([c.jacobian, c.gradient]).expect("differ");
        for r in 0..before.len() {
            j[r] = before[r] * (1.0 + dt * d[r]);
        }
        self.find_push(patch, dt, c.jacobian);
        spend(Effect::Viscosity, patch, |patch| self.find_viscosity(patch, c.jacobian));
        let mut pressure = std::mem::take(&mut patch.block.columns[c.pressure]);
        let mut energy = std::mem::take(&mut patch.block.columns[c.energy]);
        let column = |k: usize| &patch.block.columns[k];
        for (body, rows) in bodies(&column(c.body)[..patch.block.own()]) {
            let Matter::Fluid(model) = &self.models[body] else { continue };
            model.change_volume(VolumeChange {
                mass: &column(c.mass)[rows.clone()],
                volume0: &column(c.volume0)[rows.clone()],
                before: &before[rows.clone()],
                after: &column(c.jacobian)[rows.clone()],
                q: c.viscosity.map(|q| &column(q)[rows.clone()]),
                history: self.history[body].map(|h| &column(h)[rows.clone()]),
                pressure: &mut pressure[rows.clone()],
                energy: &mut energy[rows],
            });
        }
        self.work_on_solids(patch, dt, &before, &mut energy);
        self.release_tension(patch, &before, &mut pressure, &mut energy);
        patch.block.columns[c.pressure] = pressure;
        patch.block.columns[c.energy] = energy;
        if c.strength.is_some() {
            spend(Effect::Strength, patch, |patch| self.shear_and_heat(patch, &before, dt));
        }
        patch.kept = before;
        self.deform_forward(patch, dt);
    }

    /// Pressure, sound speed, and what the patch tells: time step, longest particle, faults.
    pub(super) fn refresh(&self, patch: &mut Patch<D>) {
        let c = &self.columns;
        let mut pressure = std::mem::take(&mut patch.block.columns[c.pressure]);
        let mut speed = std::mem::take(&mut patch.block.columns[c.sound_speed]);
        let mut histories = self.take_histories(patch);
        let column = |k: usize| &patch.block.columns[k];
        let mut found = None;
        for (body, rows) in bodies(&column(c.body)[..patch.block.own()]) {
            let Matter::Fluid(model) = &self.models[body] else { continue };
            let history = histories.iter_mut().find(|(k, _)| self.history[body] == Some(*k));
            let history = history.map(|(_, h)| &mut h[rows.clone()]);
            let (j, e) = (&column(c.jacobian)[rows.clone()], &column(c.energy)[rows.clone()]);
            let (p, speed) = (&mut pressure[rows.clone()], &mut speed[rows.clone()]);
            let told = match c.failure.filter(|_| self.criteria[body].is_some()) {
                Some(failure) => {
                    let damage = &column(failure.damage)[rows.clone()];
                    failure::refresh((model.as_ref(), damage), (j, e), history, (p, speed))
                }
                None => model.refresh(j, e, history, p, speed),
            };
            if let (None, Some((row, what))) = (&found, told) {
                found = Some((rows.start + row, what));
            }
        }
        for (k, history) in histories {
            patch.block.columns[k] = history;
        }
        if c.thermal.is_some() {
            spend(Effect::Temperature, patch, |patch| self.refresh_temperature(patch, &pressure));
        }
        if c.strength.is_some() {
            spend(Effect::Strength, patch, |patch| self.stiffen(patch, &pressure, &mut speed));
        }
        let mut of_solids = None;
        if c.stress.is_some() {
            spend(Effect::Stress, patch, |patch| {
                of_solids = self.refresh_solids(patch, &mut pressure, &mut speed);
            });
        }
        let mut found: Vec<(usize, String)> = found.into_iter().chain(of_solids).collect();
        let column = |k: usize| &patch.block.columns[k];
        let velocity: [&[f64]; D] = std::array::from_fn(|a| &column(c.velocity + a)[..]);
        let d = column(c.gradient);
        // the most cells that a signal or particle passes along a direction in a second [1/s]
        let mut fastest = 0.0f64;
        let mut lost = false;
        // how much shorter than at the start a cell that moves with the material is
        let mut shortest = 1.0f64;
        let stretched = if self.total { speed.len() } else { 0 };
        for r in 0..stretched {
            let (rate, shorter) = self.signal_rate(&patch.block, r, speed[r]);
            fastest = fastest.max(rate);
            shortest = shortest.max(shorter);
            lost |= rate.is_nan() || !velocity.iter().all(|v| v[r].is_finite());
        }
        let viscosity = self.viscosity;
        let mut total = std::mem::take(&mut patch.kept);
        total.resize(speed.len() - stretched, 0.0);
        for a in 0..if self.total { 0 } else { D } {
            // slices of one length, so that the loops have no checks within
            let (total, d) = (&mut total[..], &d[..speed.len()]);
            let (speed, v) = (&speed[..total.len()], &velocity[a][..total.len()]);
            for r in 0..total.len() {
                let added = viscosity.map_or(0.0, |q| q.speed(speed[r], d[r], 1.0));
                total[r] = speed[r] + v[r].abs() + added;
            }
            // which passes over NaN
            let most = greatest(total);
            fastest = fastest.max(if D == 1 { most } else { most * self.inverse_cell[a] });
            lost |= total.iter().fold(false, |lost, total| lost | total.is_nan());
        }
        patch.kept = total;
        let edge = if D == 1 { self.cell[0] } else { 1.0 };
        patch.told.time_step = if fastest > 0.0 { edge / fastest } else { f64::INFINITY };
        if let Some(conduction) = &self.conduction {
            patch.told.time_step =
                patch.told.time_step.min(conduction.step / (shortest * shortest));
        }
        let limit = self.longest_ever();
        patch.told.length = self.longest_own(&patch.block);
        if patch.told.length > limit && self.domains_deform() {
            found.extend(self.first_longer(&patch.block, limit).map(|(row, cells)| {
                (row, format!(
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
            let row = (0..d.len()).find(|r| !finite(r));
            found.push((row.unwrap_or(0), "its velocity is not a number".into()));
        }
        // the first row of all, for a patch that begins elsewhere has others before and after it
        let found = found.into_iter().min_by_key(|(row, _)| *row);
        patch.block.columns[c.pressure] = pressure;
        patch.block.columns[c.sound_speed] = speed;
        if let Some((row, what)) = found {
            self.fault(patch, Phase::End, row, what);
        }
    }

    /// The most cells that a signal passes along a direction in a second at an own row, as the time
    /// step has it [1/s].
    pub fn wave_rate(&self, block: &decomp::Block<D>, row: usize) -> f64 {
        let column = |k: usize| block.columns[k][row];
        let speed = column(self.columns.sound_speed);
        if self.total {
            let (rate, _) = self.signal_rate(block, row, speed);
            return if D == 1 { rate * self.inverse_cell[0] } else { rate };
        }
        let gradient = column(self.columns.gradient);
        let added = self.viscosity.map_or(0.0, |q| q.speed(speed, gradient, 1.0));
        let along = |a: usize| {
            (speed + column(self.columns.velocity + a).abs() + added) * self.inverse_cell[a]
        };
        (0..D).map(along).fold(0.0, f64::max)
    }

    /// The cells that an own row fills; of a grid that moves with the material, those of the start.
    pub fn filled_cells(&self, block: &decomp::Block<D>, row: usize) -> f64 {
        let column = |k: usize| block.columns[k][row];
        let c = &self.columns;
        let about = if self.axisymmetric { column(c.position) } else { 1.0 };
        let scale: f64 = self.inverse_cell.iter().product();
        let jacobian = if self.total { 1.0 } else { column(c.jacobian) };
        column(c.volume0) * jacobian * scale / about
    }

    /// Kinetic and internal energy of an own row over its mass [J/kg].
    pub fn specific_energy(&self, block: &decomp::Block<D>, row: usize) -> f64 {
        let column = |k: usize| block.columns[k][row];
        let v = |a: usize| column(self.columns.velocity + a);
        column(self.columns.energy) + 0.5 * (0..D).map(|a| v(a) * v(a)).sum::<f64>()
    }

    /// Notes a fault, if it comes before those that are known.
    pub(super) fn fault(&self, patch: &mut Patch<D>, phase: Phase, row: usize, what: String) {
        let block = &patch.block;
        let fault = Fault {
            phase,
            cell: block.cells[row].map(i64::from),
            id: block.ids[row],
            position: std::array::from_fn(|a| block.columns[self.columns.position + a][row]),
            body: block.columns[self.columns.body][row] as usize,
            what,
        };
        if patch.told.fault.as_ref().is_none_or(|known| fault.order() < known.order()) {
            patch.told.fault = Some(fault);
        }
    }
}
