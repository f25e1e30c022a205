//! Phases on particles alone: their stress, and their state at the end of a step.

use std::ops::Range;

use decomp::IndexBox;
use smallvec::SmallVec;

use super::particle_domains::greatest;
use super::scheme::Scheme;
use super::tension_free;
use crate::material::constitutive::{ConstitutiveModel, MidStep, VolumeChange};
use crate::solver::artificial_viscosity::{Flow, Viscosity};
use crate::solver::clock::{timed, timed_if};
use crate::solver::effect::{Effects, Phase, StepContext};
use crate::solver::parts::StepPart;
use crate::solver::patch::{Fault, FaultPhase, Patch};

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
