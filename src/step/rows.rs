//! Phases that look at rows alone: where they are, their stress, the state they end in.

use std::ops::Range;

use decomp::IndexBox;

use super::Stepper;
use crate::constitutive::{MidStep, VolumeChange};
use crate::patch::{Departed, Fault, Patch, Phase};
use crate::scene::Side;
use crate::shape::{Extent, floor};

/// Ranges of rows of one body.
fn bodies(column: &[f64]) -> impl Iterator<Item = (usize, Range<usize>)> + '_ {
    let mut at = 0;
    std::iter::from_fn(move || {
        let body = *column.get(at)?;
        let start = at;
        at += column[at..].iter().take_while(|&&b| b == body).count();
        Some((body as usize, start..at))
    })
}

impl Stepper {
    /// Finds the cell of each own row at x + `ahead` v, its place in it, and its length for the
    /// shape function at volume ratio `jacobian` (a column). Rows beyond an open side leave.
    pub(super) fn locate(&self, patch: &mut Patch<1>, ahead: f64, jacobian: usize) {
        patch.block.drop_ghosts();
        let c = &self.columns;
        let n = patch.block.own();
        let mut outside = false;
        {
            let cells = &mut patch.block.cells;
            let [x, v, fraction] = patch
                .block
                .columns
                .get_disjoint_mut([c.position, c.velocity, c.fraction])
                .expect("columns differ");
            fraction.resize(n, 0.0);
            for r in 0..n {
                let place = (x[r] + ahead * v[r] - self.lower) * self.inverse_cell;
                let cell = floor(place);
                fraction[r] = place - cell;
                outside |= !(cell >= 0.0 && cell < self.cells as f64);
                cells[r] = [cell as i32];
            }
        }
        let scale = self.inverse_cell;
        let [volume0, j, length] =
            patch.block.columns.get_disjoint_mut([c.volume0, jacobian, c.length]).expect("differ");
        length.resize(n, 0.0);
        match self.extent() {
            Extent::Current => (0..n).for_each(|r| length[r] = volume0[r] * j[r] * scale),
            Extent::Undeformed => (0..n).for_each(|r| length[r] = volume0[r] * scale),
            Extent::Point => {}
        }
        if outside {
            self.leave(patch);
        }
    }

    /// Wraps rows across joined sides, books those that leave by an outflow, faults the others.
    fn leave(&self, patch: &mut Patch<1>) {
        let mut keep = vec![true; patch.block.own()];
        for (row, keep) in keep.iter_mut().enumerate() {
            let cell = patch.block.cells[row][0] as i64;
            if (0..self.cells).contains(&cell) {
                continue;
            }
            let side = if cell < 0 { 0 } else { 1 };
            match self.sides[side] {
                Side::Periodic => {
                    patch.block.cells[row] = [cell.rem_euclid(self.cells) as i32];
                }
                Side::Outflow => *keep = false,
                _ => {
                    let name = ["lower", "upper"][side];
                    self.fault(
                        patch,
                        Phase::Locate,
                        row,
                        format!("it leaves the domain by its {name} side"),
                    );
                    // it stays within the arrays until the run ends
                    patch.block.cells[row] = [cell.clamp(0, self.cells - 1) as i32];
                    patch.block.columns[self.columns.fraction][row] = 0.5;
                }
            }
        }
        if keep.contains(&false) {
            let c = &self.columns;
            let gone: Vec<usize> = (0..keep.len()).filter(|&r| !keep[r]).collect();
            for &row in &gone {
                let column = |k: usize| patch.block.columns[k][row];
                patch.departed.push(Departed {
                    id: patch.block.ids[row],
                    mass: column(c.mass),
                    velocity: column(c.velocity),
                    energy: column(c.energy),
                });
            }
            patch.block.remove(&gone);
        }
    }

    /// Volume ratio at the middle of the step, J_h = J (1 + dt/2 D).
    pub(super) fn half_step_volume(&self, patch: &mut Patch<1>, dt: f64) {
        let c = &self.columns;
        let mid = c.jacobian_mid.expect("mid-point stepping has the column");
        let [j, d, j_mid] =
            patch.block.columns.get_disjoint_mut([c.jacobian, c.gradient, mid]).expect("differ");
        j_mid.resize(j.len(), 0.0);
        for r in 0..j.len() {
            j_mid[r] = j[r] * (1.0 + 0.5 * dt * d[r]);
        }
        let volume0 = &patch.block.columns[c.volume0];
        let j_mid = &patch.block.columns[mid];
        let limit = patch.reach_length * self.cell;
        let torn = self.extent() == Extent::Current
            && (0..j_mid.len()).any(|r| volume0[r] * j_mid[r] > limit);
        if torn {
            let row = (0..j_mid.len()).find(|&r| volume0[r] * j_mid[r] > limit).unwrap_or(0);
            self.fault(patch, Phase::Start, row, "it is torn apart within one step".into());
        }
    }

    /// q of own rows at volume ratio `jacobian` (a column), into its column.
    pub(super) fn find_viscosity(&self, patch: &mut Patch<1>, jacobian: usize) {
        let (Some(viscosity), Some(q)) = (&self.viscosity, self.columns.viscosity) else { return };
        let c = &self.columns;
        let mut out = std::mem::take(&mut patch.block.columns[q]);
        let column = |k: usize| &patch.block.columns[k][..out.len()];
        let (mass, volume0, j) = (column(c.mass), column(c.volume0), column(jacobian));
        let (speed, d) = (column(c.sound_speed), column(c.gradient));
        match c.limiter.map(column) {
            Some(phi) => {
                for r in 0..out.len() {
                    let density = mass[r] / (volume0[r] * j[r]);
                    out[r] = viscosity.q(density, speed[r], d[r], phi[r]);
                }
            }
            None => {
                for r in 0..out.len() {
                    let density = mass[r] / (volume0[r] * j[r]);
                    out[r] = viscosity.q(density, speed[r], d[r], 0.0);
                }
            }
        }
        patch.block.columns[q] = out;
    }

    /// Stress at the middle of the step, and compliance if the step relaxes the pressure.
    pub(super) fn mid_step_stress(&self, patch: &mut Patch<1>, relax: bool) {
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
        for (body, rows) in bodies(column(c.body)) {
            self.models[body].mid_step(MidStep {
                mass: &column(c.mass)[rows.clone()],
                volume0: &column(c.volume0)[rows.clone()],
                jacobian: &column(c.jacobian)[rows.clone()],
                jacobian_mid: &column(mid)[rows.clone()],
                energy: &column(c.energy)[rows.clone()],
                q: c.viscosity.map(|q| &column(q)[rows.clone()]),
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
    pub(super) fn find_active(&self, patch: &mut Patch<1>) {
        if !self.may_sleep {
            return;
        }
        let c = &self.columns;
        let n = patch.block.own();
        let column = |k: usize| &patch.block.columns[k][..n];
        let (v, d, s) = (column(c.velocity), column(c.gradient), column(c.stress_volume));
        let (affine, pressure) = (c.affine.map(column), c.pressure_mid.map(column));
        let moves = |r: usize| {
            v[r] != 0.0
                || d[r] != 0.0
                || s[r] != 0.0
                || affine.is_some_and(|a| a[r] != 0.0)
                || pressure.is_some_and(|p| p[r] != 0.0)
        };
        // rows from the first to the last that moves: those between mostly do
        patch.block.active = match (0..n).find(|&r| moves(r)) {
            None => IndexBox::new([0], [0]),
            Some(first) => {
                let last = (first..n).rev().find(|&r| moves(r)).unwrap_or(first);
                let cells = patch.block.cells[first..=last].iter().map(|c| i64::from(c[0]));
                let (lower, upper) =
                    cells.fold((i64::MAX, i64::MIN), |(l, u), c| (l.min(c), u.max(c)));
                IndexBox::new([lower], [upper + 1])
            }
        };
    }

    /// (p + q) V from the columns of pressure and viscosity, into its own.
    pub(super) fn current_stress(&self, patch: &mut Patch<1>) {
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
    }

    /// Volume, viscosity, energy and pressure after `dt` at the divergence in its column.
    pub(super) fn update_stress(&self, patch: &mut Patch<1>, dt: f64) {
        let c = &self.columns;
        let mut before = std::mem::take(&mut patch.kept);
        before.clear();
        before.extend_from_slice(&patch.block.columns[c.jacobian]);
        let [j, d] =
            patch.block.columns.get_disjoint_mut([c.jacobian, c.gradient]).expect("differ");
        for r in 0..before.len() {
            j[r] = before[r] * (1.0 + dt * d[r]);
        }
        self.find_viscosity(patch, c.jacobian);
        let mut pressure = std::mem::take(&mut patch.block.columns[c.pressure]);
        let mut energy = std::mem::take(&mut patch.block.columns[c.energy]);
        let column = |k: usize| &patch.block.columns[k];
        for (body, rows) in bodies(column(c.body)) {
            self.models[body].change_volume(VolumeChange {
                mass: &column(c.mass)[rows.clone()],
                volume0: &column(c.volume0)[rows.clone()],
                before: &before[rows.clone()],
                after: &column(c.jacobian)[rows.clone()],
                q: c.viscosity.map(|q| &column(q)[rows.clone()]),
                pressure: &mut pressure[rows.clone()],
                energy: &mut energy[rows],
            });
        }
        patch.block.columns[c.pressure] = pressure;
        patch.block.columns[c.energy] = energy;
        patch.kept = before;
    }

    /// Pressure, sound speed, and what the patch tells: time step, longest particle, faults.
    pub(super) fn refresh(&self, patch: &mut Patch<1>) {
        let c = &self.columns;
        let mut pressure = std::mem::take(&mut patch.block.columns[c.pressure]);
        let mut speed = std::mem::take(&mut patch.block.columns[c.sound_speed]);
        let column = |k: usize| &patch.block.columns[k];
        let mut found = None;
        for (body, rows) in bodies(column(c.body)) {
            let told = self.models[body].refresh(
                &column(c.jacobian)[rows.clone()],
                &column(c.energy)[rows.clone()],
                &mut pressure[rows.clone()],
                &mut speed[rows.clone()],
            );
            if let (None, Some((row, what))) = (&found, told) {
                found = Some((rows.start + row, what));
            }
        }
        let (v, d) = (column(c.velocity), column(c.gradient));
        let mut fastest = 0.0f64;
        let mut lost = false;
        for r in 0..speed.len() {
            let added = self.viscosity.map_or(0.0, |q| q.speed(speed[r], d[r]));
            let total = speed[r] + v[r].abs() + added;
            fastest = fastest.max(total);
            // max() passes over NaN
            lost |= total.is_nan();
        }
        let (volume0, j) = (column(c.volume0), column(c.jacobian));
        let longest = match self.extent() {
            Extent::Current => (0..j.len()).fold(0.0f64, |l, r| l.max(volume0[r] * j[r])),
            _ => volume0.iter().copied().fold(0.0, f64::max),
        };
        patch.told.time_step = if fastest > 0.0 { self.cell / fastest } else { f64::INFINITY };
        patch.told.length = longest * self.inverse_cell;
        let limit = self.longest_ever() * self.cell;
        if found.is_none() && longest > limit && self.extent() == Extent::Current {
            let row = (0..j.len()).find(|&r| volume0[r] * j[r] > limit).unwrap_or(0);
            let cells = longest * self.inverse_cell;
            found = Some((
                row,
                format!(
                    "it has been stretched over {cells:.1} cells, further than its shape function reaches; more particles a cell stretch less"
                ),
            ));
        }
        if found.is_none() && lost {
            let row = v.iter().zip(d).position(|(v, d)| !v.is_finite() || !d.is_finite());
            found = Some((row.unwrap_or(0), "its velocity is not a number".into()));
        }
        patch.block.columns[c.pressure] = pressure;
        patch.block.columns[c.sound_speed] = speed;
        if let Some((row, what)) = found {
            self.fault(patch, Phase::End, row, what);
        }
    }

    /// Notes a fault, if it comes before those that are known.
    fn fault(&self, patch: &mut Patch<1>, phase: Phase, row: usize, what: String) {
        let block = &patch.block;
        let fault = Fault {
            phase,
            cell: i64::from(block.cells[row][0]),
            id: block.ids[row],
            position: block.columns[self.columns.position][row],
            body: block.columns[self.columns.body][row] as usize,
            what,
        };
        if patch.told.fault.as_ref().is_none_or(|known| fault.order() < known.order()) {
            patch.told.fault = Some(fault);
        }
    }
}
