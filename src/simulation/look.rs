//! The watch at work: looks at a step's end, and the state that is held.
//!
//! What a step tells anyway is looked at in every step; energy and crowding now and then, and with
//! them the state is copied, so that where a run goes wrong the last good one can be written. The
//! verdicts are the same on all ranks, whatever the layout.

use decomp::{Block, Census, ExactSum, StoredRows, exact_sums};

use super::{Given, Left, RunError, Saved, Simulation, Totals};
use crate::scene::OnAlarm;
use crate::simulation::monitor::{Alarm, Energies, likely_cause};
use crate::solver::Stepper;
use crate::solver::patch::Patch;

/// The state after a step that has passed, of this rank's rows: what is state of their columns.
/// Its memory is kept from step to step.
#[derive(Debug, Default)]
pub(super) struct Held<const D: usize> {
    ids: Vec<u64>,
    cells: Vec<[i32; D]>,
    columns: Vec<Vec<f64>>,
    sums: Vec<ExactSum>,
    left: Census,
    time: f64,
    step: u64,
    stable: f64,
    longest: f64,
}

/// Sums of the start that growth is counted from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start<const D: usize> {
    energies: Energies,
    momentum: [f64; D],
    /// Mass [kg].
    mass: f64,
}

impl<const D: usize> Start<D> {
    /// Before anything is there.
    pub(super) const NONE: Self = Start {
        energies: Energies {
            kinetic: 0.0,
            internal: 0.0,
            common: 0.0,
            available: 0.0,
            above_least: 0.0,
            below_zero_kelvin: 0.0,
        },
        momentum: [0.0; D],
        mass: 0.0,
    };
}

impl<const D: usize> Simulation<'_, D> {
    /// Energies and momentum of all particles, and what forces and heat have given them but for
    /// the sides [J]. Collective.
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
    /// [`Energies::below_zero_kelvin`] over all particles, whose internal energy is `internal` [J].
    /// Collective.
    fn admissible_energies(&self, internal: f64) -> [f64; 3] {
        let c = &self.stepper.columns;
        // the usual case, bodies that start without pressure and temperature, needs no pass
        if c.thermal.is_none() && self.least_energies.iter().all(|least| *least == 0.0) {
            return [internal.max(0.0), internal, 0.0];
        }
        exact_sums(self.comm, |add: &mut dyn FnMut(usize, &[f64])| {
            for block in self.patches.iter().map(|p| &p.block) {
                for r in 0..block.own() {
                    let (m, e) = (block.columns[c.mass][r], block.columns[c.energy][r]);
                    let body = block.columns[c.body][r] as usize;
                    let above = e - self.least_energies[body];
                    // of a conductor that is all of its heat, which drives no motion and makes up
                    // for no lack elsewhere
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

    /// Takes note of the start. Collective.
    pub(super) fn note_start(&mut self) {
        self.start = self.sums().0;
        // conduction may ask for shorter steps than any wave
        let own = self.scene.scene.watch.least_step * self.stable;
        self.limits.least_step = self.limits.least_step.min(own);
        self.hold();
    }

    /// Looks at the energy of all particles, and at how they crowd. Collective.
    pub(super) fn look(&self) -> Result<(), RunError> {
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
            [-(self.patches.iter().map(|p| crowd(&p.block).0).max().unwrap_or(0) as f64)];
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

    /// Change of energy since the start, less all work, over the energy that the bodies bring [-].
    /// Collective.
    pub fn energy_change(&self) -> f64 {
        let (now, work) = self.sums_and_work();
        self.limits.change(&self.start.energies, &now.energies, work, self.start.mass)
    }

    /// Energy that rounding alone may make of the scene's particles [J].
    pub fn rounding_energy(&self) -> f64 {
        self.limits.rounding * self.start.mass
    }

    /// Sums over all particles, and the work of sides, forces and heat. Collective.
    fn sums_and_work(&self) -> (Start<D>, f64) {
        let (now, forces, impulse) = self.sums();
        // sides that give or let nothing out have nothing booked
        let (left, given) = match self.scene.keeps_all() {
            true => (Left::NONE, Given { work: 0.0, impulse: [0.0; D] }),
            false => (self.left(), self.given()),
        };
        let work = self.side_work(&now, &impulse, &left, &given) + forces;
        (now, work)
    }

    /// Work of the sides so far, less what has left [J]; see [`crate::driver`]'s account of it.
    fn side_work(
        &self,
        now: &Start<D>,
        impulse: &[f64; D],
        left: &Left<D>,
        given: &Given<D>,
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

    /// What the longest stable next step, `stable` [s] at a Courant number of 1, says of the step
    /// of `dt` [s] that has led here. Alike on all ranks; collective where it is an alarm.
    pub(super) fn look_at_step(&self, stable: f64, dt: f64) -> Result<(), RunError> {
        let courant = dt / stable;
        if courant > self.limits.courant {
            let what = format!(
                "the step of {dt:.3e} s has turned out to have a Courant number of {courant:.3}, \
                 allowed: {}",
                self.limits.courant
            );
            return Err(self.alarm(Alarm::Courant, what, |s, b, r| s.wave_rate(b, r)));
        }
        if dt > 0.0 && stable < self.limits.least_step {
            let what = format!(
                "the stable time step has fallen to {stable:.3e} s, allowed: {:.1e} s",
                self.limits.least_step
            );
            return Err(self.alarm(Alarm::TimeStep, what, |s, b, r| s.wave_rate(b, r)));
        }
        // a step that long leaves no room for a particle that fast
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

    /// The alarm's error, with the particle for which `key` is greatest; the first in canonical
    /// order of those. Told at rank 0. Collective.
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

    /// The error that names a particle. At rank 0.
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

    /// Particles that fill more than a cell each, of a shape function that does not grow with them.
    /// Collective.
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

    /// Holds the state, which has passed.
    pub(super) fn hold(&mut self) {
        let held = &mut self.held;
        let specs = &self.stepper.columns.specs;
        let count = specs.iter().filter(|s| s.state).count();
        held.columns.resize_with(count, Vec::new);
        held.ids.clear();
        held.cells.clear();
        held.columns.iter_mut().for_each(Vec::clear);
        let rows: usize = self.patches.iter().map(|p| p.block.own()).sum();
        for patch in &self.patches {
            let block = &patch.block;
            let n = block.own();
            extend(&mut held.ids, &block.ids[..n], rows);
            extend(&mut held.cells, &block.cells[..n], rows);
            let state = specs.iter().zip(&block.columns).filter(|(s, _)| s.state);
            for ((_, from), to) in state.zip(&mut held.columns) {
                extend(to, &from[..n], rows);
            }
        }
        held.sums.clear();
        held.sums.extend(self.outflow.sums.iter().chain(&self.side_books.sums).cloned());
        held.left = self.outflow.census;
        (held.time, held.step) = (self.time, self.step);
        (held.stable, held.longest) = (self.stable, self.longest);
    }

    /// Time and step of the state that is held [s].
    pub fn held_at(&self) -> (f64, u64) {
        (self.held.time, self.held.step)
    }

    /// Whether a step that fails is redone.
    pub(super) fn redoes(&self) -> bool {
        self.scene.scene.watch.on_alarm == OnAlarm::Redo
    }

    /// The state that is held, at rank 0; nothing elsewhere. Collective.
    pub fn last_good(&self) -> Option<Saved> {
        let held = &self.held;
        let mut sums = held.sums.clone();
        ExactSum::over_ranks(self.comm, &mut sums);
        let left = held.left.over_ranks(self.comm);
        let specs = &self.stepper.columns.specs;
        let mut block = Block::new(specs);
        (0..held.ids.len()).for_each(|r| self.push_held(&mut block, r));
        let rows = StoredRows::gather(self.comm, specs, std::iter::once(&block));
        (self.comm.rank() == 0).then(|| Saved {
            time: held.time,
            step: held.step,
            stable: held.stable,
            longest: held.longest,
            redone_steps: self.tally.redone_steps,
            left,
            sums: sums.iter().map(ExactSum::total).collect(),
            peaks: self.peaks,
            rows,
        })
    }

    fn push_held(&self, block: &mut Block<D>, r: usize) {
        let mut state = self.held.columns.iter();
        let specs = self.stepper.columns.specs.iter();
        let value = |spec: &decomp::ColumnSpec| match spec.state {
            true => state.next().expect("a column of state")[r],
            false => 0.0,
        };
        let row: Vec<f64> = specs.map(value).collect();
        block.push(self.held.ids[r], self.held.cells[r], &row);
    }

    /// Goes back to the state that is held, on the same layout.
    pub(super) fn go_back(&mut self) {
        let mine = self.layout.patches_of(self.comm.rank());
        let specs = &self.stepper.columns.specs;
        let mut blocks: Vec<Block<D>> = mine.iter().map(|_| Block::new(specs)).collect();
        for r in 0..self.held.ids.len() {
            let patch = self.layout.patch_of(self.held.cells[r].map(i64::from));
            let k = mine.iter().position(|&p| p == patch).expect("a patch of this rank");
            self.push_held(&mut blocks[k], r);
        }
        blocks.iter_mut().for_each(Block::sort_own);
        let reach = self.reach.expect("known since the start");
        let (fields, layers) = (self.stepper.fields.count, self.stepper.layers);
        let (depth, deeper) = (reach.depth(self.plan.ghosts), self.plan.deeper);
        let limit = self.stepper.longest_within(reach);
        for ((patch, &index), block) in self.patches.iter_mut().zip(&mine).zip(blocks) {
            let watch = std::mem::take(&mut patch.watch);
            *patch = Patch::new(&self.layout, index, block);
            patch.set_arrays(&self.layout, index, depth, deeper, fields, layers);
            (patch.reach_length, patch.watch) = (limit, watch);
        }
        let books = self.outflow.sums.iter_mut().chain(&mut self.side_books.sums);
        books.zip(&self.held.sums).for_each(|(sum, held)| *sum = held.clone());
        self.outflow.census = self.held.left;
        (self.time, self.step) = (self.held.time, self.held.step);
        (self.stable, self.longest) = (self.held.stable, self.held.longest);
    }
}

/// Cells that a particle fills where it is told to be stretched, with room for rounding.
const STRETCHED: f64 = 1.0 + 1e-6;

/// Appends `from` to `to`, which asks for memory for all `rows` and some at once.
fn extend<T: Copy>(to: &mut Vec<T>, from: &[T], rows: usize) {
    if to.capacity() < rows {
        to.reserve(rows + rows / 4 - to.len());
    }
    to.extend_from_slice(from);
}

/// Most own rows of a block in one cell, and the first of them.
fn crowd<const D: usize>(block: &Block<D>) -> (usize, usize) {
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
