//! Monitor: checks at the end of a step, and the last good state.
//!
//! Quantities that a step computes anyway are checked in every step; energy and particles per cell
//! are checked periodically. The state is copied when these checks pass, so that the last good
//! state can be written if the run fails later. All ranks reach the same verdict, for any layout.

use decomp::{Block, exact_sums};

use super::accounts::Removed;
use super::diagnostics::Totals;
use super::error::RunError;
use super::good_state::Start;
use super::run::Simulation;
use super::snapshot::{Moment, Saved};
use crate::scene::OnAlarm;
use crate::simulation::monitor::{Alarm, Energies, likely_cause};
use crate::solver::Stepper;
use crate::solver::patch::{BoundaryWork, Patch};

impl<const D: usize> Simulation<'_, D> {
    /// Energies and momentum of all particles, work of body forces and conducted heat (without the
    /// sides) [J], and impulse of body forces [N s]. Collective.
    fn sums(&self) -> (Start<D>, f64, [f64; D]) {
        let all = self.totals();
        let Totals { mass, momentum, kinetic, internal, .. } = all;
        let squared = momentum.iter().map(|p| p * p).sum::<f64>();
        let common = if mass > 0.0 { 0.5 * squared / mass } else { 0.0 };
        let [available, above_least, below_zero_kelvin] = self.admissible_energies(internal);
        let energies =
            Energies { kinetic, internal, common, available, above_least, below_zero_kelvin };
        let given = all.body_force_work + all.conducted;
        (Start { energies, momentum, mass }, given, all.body_force_impulse)
    }

    /// Sums of [`Energies::available`], [`Energies::above_least`] and
    /// [`Energies::below_zero_kelvin`] over all particles; `internal` is their internal energy [J].
    /// Collective.
    fn admissible_energies(&self, internal: f64) -> [f64; 3] {
        let c = &self.stepper.columns;
        // bodies that start without pressure and temperature, the usual case, need no loop
        if c.temperature.is_none() && self.least_energies.iter().all(|least| *least == 0.0) {
            return [internal.max(0.0), internal, 0.0];
        }
        exact_sums(self.comm, |add: &mut dyn FnMut(usize, &[f64])| {
            for block in self.patches.iter().map(|p| &p.block) {
                for r in 0..block.own() {
                    let (m, e) = (block.columns[c.mass][r], block.columns[c.energy][r]);
                    let body = block.columns[c.body][r] as usize;
                    let above = e - self.least_energies[body];
                    // for a conductor this excess is just its heat, which drives no motion and does
                    // not compensate a deficit elsewhere
                    let [free, above] = match self.stepper.conducts_heat(body) {
                        true => [e, above.min(0.0)],
                        false => [above.max(e), above],
                    };
                    add(0, &[m * free.max(0.0)]);
                    add(1, &[m * above]);
                    if let Some(lack) = self.stepper.heat_below_zero_kelvin(block, r) {
                        add(2, &[m * lack]);
                    }
                }
            }
        })
    }

    /// Stores the initial sums and the first good state. Collective.
    pub(super) fn note_start(&mut self) {
        self.start = self.sums().0;
        // conduction may need shorter steps than any wave
        let own = self.scene.scene.monitor.min_time_step_ratio * self.stable;
        self.limits.min_time_step = self.limits.min_time_step.min(own);
        self.keep_good_state();
    }

    /// Checks the energy of all particles and the number of particles per cell. Collective.
    pub(super) fn check_state(&self) -> Result<(), RunError> {
        let (now, work) = self.sums_and_work();
        let (start, limits) = (&self.start.energies, &self.limits);
        let change = limits.change(start, &now.energies, work, self.start.mass);
        if change.is_nan() || change > limits.energy_growth || change < -limits.energy_loss {
            let (verb, bound) = match change < 0.0 {
                true => ("fallen", limits.energy_loss),
                false => ("grown", limits.energy_growth),
            };
            let what = format!(
                "total energy has {verb} by {:.3e} of the energy of the start and of the work \
                 done, allowed: {bound:.1e}; this particle has the most energy per mass",
                change.abs()
            );
            return Err(self.alarm(Alarm::Energy, what, |s, b, r| s.specific_energy(b, r)));
        }
        let lack = limits.lack(start, &now.energies, work, self.start.mass);
        if lack.is_nan() || lack > limits.energy_lack {
            let what = format!(
                "internal energy has fallen below the least that the materials admit by \
                 {lack:.3e} of the energy of the start, allowed: {:.1e}; this particle is the \
                 furthest below",
                limits.energy_lack
            );
            let c = &self.stepper.columns;
            return Err(self.alarm(Alarm::Cold, what, |_, b, r| {
                self.least_energies[b.columns[c.body][r] as usize] - b.columns[c.energy][r]
            }));
        }
        let mut crowd =
            [-(self.patches.iter().map(|p| max_particles_per_cell(&p.block).0).max().unwrap_or(0)
                as f64)];
        self.comm.min(&mut crowd);
        if -crowd[0] > self.limits.crowd as f64 {
            let what =
                format!("{} particles are in its cell, allowed: {}", -crowd[0], self.limits.crowd);
            let cell = |block: &Block<D>, r: usize| {
                block.cells[..block.own()].iter().filter(|c| **c == block.cells[r]).count() as f64
            };
            return Err(self.alarm(Alarm::Crowding, what, |_, b, r| cell(b, r)));
        }
        Ok(())
    }

    /// Change of energy since the start, minus all work, over the energy of the bodies [-].
    /// Collective.
    pub fn energy_change(&self) -> f64 {
        let (now, work) = self.sums_and_work();
        self.limits.change(&self.start.energies, &now.energies, work, self.start.mass)
    }

    /// Energy that rounding alone may create in the particles of the scene [J].
    pub fn rounding_energy(&self) -> f64 {
        self.limits.rounding * self.start.mass
    }

    /// Sums over all particles, and work of sides, forces and heat [J]. Collective.
    fn sums_and_work(&self) -> (Start<D>, f64) {
        let (now, forces, impulse) = self.sums();
        // these sides neither do work nor remove particles: their sums are zero
        let (left, given) = match self.scene.keeps_all() {
            true => (Removed::NONE, BoundaryWork { work: 0.0, impulse: [0.0; D] }),
            false => (self.left(), self.given()),
        };
        let work = self.side_work(&now, &impulse, &left, &given) + forces;
        (now, work)
    }

    /// Accumulated work of the sides, minus the energy of removed particles [J]; see the energy
    /// balance in [`crate::driver`].
    fn side_work(
        &self,
        now: &Start<D>,
        impulse: &[f64; D],
        left: &Removed<D>,
        given: &BoundaryWork<D>,
    ) -> f64 {
        let frame = &self.frame;
        let pistons = if frame.accelerates() {
            frame.energy_ahead(self.time, now.mass, &now.momentum)
                - frame.energy_ahead(0.0, self.start.mass, &self.start.momentum)
        } else {
            let velocity = frame.velocity(0.0);
            let walls =
                |a: usize| now.momentum[a] + left.momentum[a] - self.start.momentum[a] - impulse[a];
            (0..D).filter(|&a| velocity[a] != 0.0).map(|a| velocity[a] * walls(a)).sum::<f64>()
        };
        pistons + given.work - (left.kinetic + left.internal)
    }

    /// Checks the step of `dt` [s] by the longest stable next step `stable` [s] at a Courant number
    /// of 1. The same on all ranks; collective if it raises an alarm.
    pub(super) fn check_step(&self, stable: f64, dt: f64) -> Result<(), RunError> {
        let courant = dt / stable;
        if courant > self.limits.courant {
            let what = format!(
                "the step of {dt:.3e} s has turned out to have a Courant number of {courant:.3}, \
                 allowed: {}",
                self.limits.courant
            );
            return Err(self.alarm(Alarm::Courant, what, |s, b, r| s.wave_rate(b, r)));
        }
        if dt > 0.0 && stable < self.limits.min_time_step {
            let what = format!(
                "the stable time step has fallen to {stable:.3e} s, allowed: {:.1e} s",
                self.limits.min_time_step
            );
            return Err(self.alarm(Alarm::TimeStep, what, |s, b, r| s.wave_rate(b, r)));
        }
        // with so long a stable step no particle can be too fast
        if self.stepper.shortest_edge() < self.limits.speed * stable {
            return Ok(());
        }
        let speed = |block: &Block<D>, r: usize| {
            let v = |a: usize| block.columns[self.stepper.columns.velocity + a][r];
            (0..D).map(|a| v(a) * v(a)).sum::<f64>().sqrt()
        };
        let mine = self.patches.iter().flat_map(|p| (0..p.block.own()).map(|r| speed(&p.block, r)));
        let mut fastest = [-mine.fold(0.0, f64::max)];
        self.comm.min(&mut fastest);
        match -fastest[0] > self.limits.speed {
            false => Ok(()),
            true => {
                let what = format!(
                    "its speed is {:.4e} m/s, faster than any wave could make it: {:.1e} m/s",
                    -fastest[0], self.limits.speed
                );
                Err(self.alarm(Alarm::Speed, what, |_, b, r| speed(b, r)))
            }
        }
    }

    /// Error of an alarm, with the particle for which `key` is greatest; among equals the first in
    /// canonical order. Complete at rank 0. Collective.
    fn alarm(
        &self,
        alarm: Alarm,
        what: String,
        key: impl Fn(&Stepper<D>, &Block<D>, usize) -> f64,
    ) -> RunError {
        let c = &self.stepper.columns;
        let mut worst: Option<(f64, Vec<u64>)> = None;
        for block in self.patches.iter().map(|p| &p.block) {
            for r in 0..block.own() {
                let value = key(&self.stepper, block, r);
                let value = if value.is_nan() { f64::INFINITY } else { value };
                let cell = block.cells[r].map(i64::from);
                let place = || -> Vec<u64> {
                    let order = cell.iter().rev().map(|&c| (c - i64::from(i32::MIN)) as u64);
                    order.chain([block.ids[r]]).collect()
                };
                let better = match &worst {
                    None => true,
                    Some((most, words)) => {
                        value > *most || (value == *most && place()[..] < words[..=D])
                    }
                };
                if better {
                    let x = (0..D).map(|a| block.columns[c.position + a][r].to_bits());
                    let body = block.columns[c.body][r] as u64;
                    worst = Some((value, place().into_iter().chain([body]).chain(x).collect()));
                }
            }
        }
        let mut words = Vec::new();
        if let Some((value, rest)) = worst {
            words.push(value.to_bits());
            words.extend(rest);
        }
        let all = self.comm.gather(&words);
        if self.comm.rank() != 0 {
            return RunError::Elsewhere;
        }
        let value = |w: &[u64]| f64::from_bits(w[0]);
        let greatest = all
            .iter()
            .filter(|w| !w.is_empty())
            .min_by(|a, b| value(b).total_cmp(&value(a)).then(a[1..=D + 1].cmp(&b[1..=D + 1])));
        let Some(w) = greatest else {
            return RunError::TimeStep { time: self.time, step: self.step, dt: self.dt };
        };
        let cell: [i64; D] = std::array::from_fn(|a| w[D - a] as i64 + i64::from(i32::MIN));
        let place: [f64; D] = std::array::from_fn(|a| f64::from_bits(w[3 + D + a]));
        self.particle_error(alarm, w[D + 1], w[D + 2] as usize, cell, place, what)
    }

    /// Error that names a particle. At rank 0.
    pub(super) fn particle_error(
        &self,
        alarm: Alarm,
        id: u64,
        body: usize,
        cell: [i64; D],
        place: [f64; D],
        what: String,
    ) -> RunError {
        let names = ["x", "y"];
        let travel = self.frame.travel(self.time);
        let x = |a: usize| place[a] + travel[a];
        let position: Vec<String> =
            (0..D).map(|a| format!("{} = {:.6e} m", names[a], x(a))).collect();
        RunError::Particle {
            id,
            body: self.scene.scene.bodies[body].name.clone(),
            position: format!("{}, cell {cell:?}", position.join(", ")),
            time: self.time,
            step: self.step,
            alarm,
            cause: likely_cause(self.scene, alarm, &what).into(),
            what,
        }
    }

    /// Number of particles larger than one cell, for a shape function whose domains do not grow
    /// with the particles. Collective.
    pub fn stretched(&self) -> u64 {
        let mut count = [0];
        if !self.stepper.grows() {
            let blocks = self.patches.iter().map(|p| &p.block);
            let filled = |block: &Block<D>| {
                (0..block.own())
                    .filter(|&r| self.stepper.filled_cells(block, r) > STRETCHED)
                    .count()
            };
            count[0] = blocks.map(|b| filled(b) as i64).sum();
        }
        self.comm.sum(&mut count);
        count[0] as u64
    }

    /// Stores the state that has passed the checks.
    pub(super) fn keep_good_state(&mut self) {
        let held = &mut self.held;
        let specs = &self.stepper.columns.specs;
        let count = specs.iter().filter(|s| s.state).count();
        let stored = &mut held.particles;
        stored.columns.resize_with(count, Vec::new);
        stored.ids.clear();
        stored.cells.clear();
        stored.columns.iter_mut().for_each(Vec::clear);
        let particles: usize = self.patches.iter().map(|p| p.block.own()).sum();
        for patch in &self.patches {
            let block = &patch.block;
            let n = block.own();
            extend(&mut stored.ids, &block.ids[..n], particles);
            extend(&mut stored.cells, block.cells[..n].as_flattened(), D * particles);
            let state = specs.iter().zip(&block.columns).filter(|(s, _)| s.state);
            for ((_, from), to) in state.zip(&mut stored.columns) {
                extend(to, &from[..n], particles);
            }
        }
        held.sums.clear();
        held.sums.extend(self.outflow.sums.iter().chain(&self.side_books.sums).cloned());
        held.left = self.outflow.census;
        (held.time, held.step) = (self.time, self.step);
        (held.stable, held.longest) = (self.stable, self.longest);
    }

    /// Time [s] and step of the last good state.
    pub fn held_at(&self) -> (f64, u64) {
        (self.held.time, self.held.step)
    }

    /// Whether a failed step is repeated.
    pub(super) fn redoes(&self) -> bool {
        self.scene.scene.monitor.on_alarm == OnAlarm::Redo
    }

    /// The last good state, with the particles of this rank. Collective.
    pub fn last_good(&self) -> Saved {
        let held = &self.held;
        let moment = Moment { time: held.time, step: held.step, stable: held.stable };
        self.saved(moment, held.longest, held.left, held.sums.clone(), held.particles.clone())
    }

    fn push_held(&self, block: &mut Block<D>, r: usize) {
        let held = &self.held.particles;
        let mut state = held.columns.iter();
        let specs = self.stepper.columns.specs.iter();
        let value = |spec: &decomp::ColumnSpec| match spec.state {
            true => state.next().expect("a column of state")[r],
            false => 0.0,
        };
        let particle: Vec<f64> = specs.map(value).collect();
        block.push(held.ids[r], self.held_cell(r), &particle);
    }

    fn held_cell(&self, r: usize) -> [i32; D] {
        std::array::from_fn(|a| self.held.particles.cells[D * r + a])
    }

    /// Restores the last good state, on the same layout.
    pub(super) fn go_back(&mut self) {
        let mine = self.layout.patches_of(self.comm.rank());
        let specs = &self.stepper.columns.specs;
        let mut blocks: Vec<Block<D>> = mine.iter().map(|_| Block::new(specs)).collect();
        for r in 0..self.held.particles.ids.len() {
            let patch = self.layout.patch_of(self.held_cell(r).map(i64::from));
            let k = mine.iter().position(|&p| p == patch).expect("a patch of this rank");
            self.push_held(&mut blocks[k], r);
        }
        blocks.iter_mut().for_each(Block::sort_own);
        let reach = self.reach.expect("known since the start");
        let (fields, layers) = (self.stepper.fields.count, self.stepper.layers);
        let (depth, deeper) = (reach.depth(self.plan.ghosts), self.plan.deeper);
        let limit = self.stepper.longest_within(reach);
        for ((patch, &index), block) in self.patches.iter_mut().zip(&mine).zip(blocks) {
            let watch = std::mem::take(&mut patch.stopwatch);
            *patch = Patch::new(&self.layout, index, block);
            patch.set_arrays(&self.layout, index, depth, deeper, fields, layers);
            (patch.reach_length, patch.stopwatch) = (limit, watch);
        }
        let books = self.outflow.sums.iter_mut().chain(&mut self.side_books.sums);
        books.zip(&self.held.sums).for_each(|(sum, held)| *sum = held.clone());
        self.outflow.census = self.held.left;
        (self.time, self.step) = (self.held.time, self.held.step);
        (self.stable, self.longest) = (self.held.stable, self.held.longest);
    }
}

/// Cells that a particle fills before it counts as stretched, with room for rounding.
const STRETCHED: f64 = 1.0 + 1e-6;

/// Appends `from` to `to`; a reallocation reserves memory for all `particles` and a margin at once.
fn extend<T: Copy>(to: &mut Vec<T>, from: &[T], particles: usize) {
    if to.capacity() < particles {
        to.reserve(particles + particles / 4 - to.len());
    }
    to.extend_from_slice(from);
}

/// Largest number of own particles of a block in one cell, and the first of them.
fn max_particles_per_cell<const D: usize>(block: &Block<D>) -> (usize, usize) {
    let (mut most, mut start) = ((0, 0), 0);
    let cells = &block.cells[..block.own()];
    for r in 0..cells.len() {
        if cells[r] != cells[start] {
            start = r;
        }
        if r + 1 - start > most.0 {
            most = (r + 1 - start, start);
        }
    }
    most
}
