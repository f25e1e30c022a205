//! The run: its patches, its clock and its steps.

use std::ops::Range;

use decomp::{Census, Comm, Layout};

use super::accounts::{CENSUS_EVERY, Counters, RemovedSums, SideBooks};
use super::error::RunError;
use super::exchange_plan::{ExchangePlan, halo_depths};
use super::expected_peaks::ExpectedPeaks;
use super::good_state::{LastGoodState, Start};
use super::patches::assign_domain;
use crate::effects::EffectRegistry;
use crate::material::constitutive::CustomModel;
use crate::scene::moving_frame::Frame;
use crate::scene::{CheckedScene, FilterHalo};
use crate::simulation::monitor::{Alarm, Limits, Peaks, SelfContactEvent};
use crate::simulation::threads::make_pool;
use crate::solver::clock::{Activity, Clock, Event};
use crate::solver::columns::Columns;
use crate::solver::particles;
use crate::solver::patch::Patch;
use crate::solver::{Sleep, StencilRadius, Stepper, World};

/// A run in memory.
pub struct Simulation<'a, const D: usize> {
    pub(super) comm: &'a dyn Comm,
    pub(super) scene: &'a CheckedScene,
    pub(super) stepper: Stepper<D>,
    pub(super) layout: Layout<D>,
    pub(super) patches: Vec<Patch<D>>,
    /// Known once the lengths of the particles are known.
    pub(super) reach: Option<StencilRadius>,
    pub(super) plan: ExchangePlan<D>,
    pub(super) sleep: Sleep,
    pub(super) threads: usize,
    pub(super) pool: Option<rayon::ThreadPool>,
    pub(super) clock: Clock,
    /// Events of patches that have moved to other ranks.
    pub(super) given_events: Vec<(usize, Event)>,
    /// Contact forces of the last step from such patches.
    pub(super) given_contact: Vec<[f64; 2]>,
    /// Steps with a recorded timeline.
    pub(super) traced: Range<u64>,
    pub(super) tally: Counters,
    /// Gain that a better distribution of the patches would have brought since they last moved; the
    /// same on all ranks [cost].
    pub(super) imbalance_debt: f64,
    /// All particles at the start.
    pub(super) census: Census,
    pub(super) outflow: RemovedSums<D>,
    pub(super) side_books: SideBooks<D>,
    /// Bounds of the monitor.
    pub(super) limits: Limits,
    /// Least admissible specific internal energy of each body's particles [J/kg].
    pub(super) least_energies: Vec<f64>,
    pub(super) expected: Vec<ExpectedPeaks<D>>,
    pub(super) peaks: Peaks,
    pub(super) self_contact: Option<SelfContactEvent>,
    pub(super) start: Start<D>,
    pub(super) held: LastGoodState,
    pub(super) frame: Frame<D>,
    /// Longest step if the frame accelerates [s].
    pub(super) longest_step: f64,
    pub(super) time: f64,
    pub(super) step: u64,
    /// Step at which this run started; 0 without a restart.
    pub(super) first_step: u64,
    /// Longest stable next step at a Courant number of 1 [s].
    pub(super) stable: f64,
    /// Greatest extent of a particle along a direction [cells].
    pub(super) longest: f64,
    /// Length of the next step [s].
    pub(super) dt: f64,
    /// Request of this rank, then the most urgent request of all ranks.
    pub(super) stop_request: u8,
    pub(super) asked: u8,
}

/// Kind of a side of the scene for the decomposition.
/// Interval in steps between samples of the effects' shares; coprime to common intervals.
const EFFECTS_EVERY: u64 = 61;

/// Number of steps that no run completes.
const MOST_STEPS: f64 = 1e12;

/// Longest step at a Courant number of 1 for a grid that accelerates [s]: material at rest is
/// faster relative to the grid in the next step than in this one.
fn longest_step<const D: usize>(scene: &CheckedScene, frame: &Frame<D>) -> f64 {
    match frame.greatest_change() {
        0.0 => f64::INFINITY,
        change => scene.cell_size.iter().copied().fold(f64::INFINITY, f64::min) / change,
    }
}

impl<'a, const D: usize> Simulation<'a, D>
where
    Stepper<D>: Compiled<D>,
{
    /// Creates the particles of `scene`, to be run by `threads` threads on each rank. Collective.
    ///
    /// # Errors
    ///
    /// If a check of the initial state fails.
    pub fn new(
        scene: &'a CheckedScene,
        comm: &'a dyn Comm,
        threads: usize,
    ) -> Result<Self, RunError> {
        Self::with_models(scene, comm, threads, &|_| None)
    }

    /// Like [`Simulation::new`], with custom models from `outside` in place of the models of the
    /// scene; `outside` is called with the material name once per body. Collective.
    ///
    /// # Errors
    ///
    /// As [`Simulation::new`], and if the scene cannot use a custom model.
    pub fn with_models(
        scene: &'a CheckedScene,
        comm: &'a dyn Comm,
        threads: usize,
        outside: &dyn Fn(&str) -> Option<CustomModel>,
    ) -> Result<Self, RunError> {
        <Stepper<D> as Compiled<D>>::create(scene, comm, threads, outside)
    }

    /// Frees the particles and the nodes of this rank at the end of a run; counters and peaks remain.
    pub fn release_particles(&mut self) {
        (self.patches, self.held) = (Vec::new(), LastGoodState::default());
    }

    /// Advances by one step. The last step before `until` [s] is shortened to end there exactly;
    /// the next step has its usual length again. If a check of the monitor fails, the step is an
    /// error, or is repeated with half the length if the scene asks for that. Collective.
    ///
    /// # Errors
    ///
    /// If a check of the state fails, if particles are lost, or if the run needs too many steps.
    pub fn advance(&mut self, until: f64) -> Result<(), RunError> {
        <Stepper<D> as Compiled<D>>::advance_run(self, until)
    }
}

impl<'a, const D: usize> Simulation<'a, D> {
    pub(super) fn create(
        scene: &'a CheckedScene,
        comm: &'a dyn Comm,
        threads: usize,
        outside: &dyn Fn(&str) -> Option<CustomModel>,
    ) -> Result<Self, RunError> {
        let stepper = Stepper::with_models::<EffectRegistry>(scene, outside)
            .map_err(|(material, reason)| RunError::Model { material, reason })?;
        let layout = assign_domain(scene, comm.size(), threads);
        let frame = scene.frame();
        let blocks = particles::fill(scene, &stepper, &layout, comm.rank(), frame.velocity(0.0));
        let longest = stepper.longest_at_start(scene);
        let reach = stepper.reach(longest).expect("a longer particle is a fault");
        let depths = halo_depths(scene, &layout, reach, comm.size() * threads);
        let pool = (threads > 1 && layout.count() > 1).then(|| make_pool(threads));
        let patches = layout.patches_of(comm.rank()).into_iter().zip(blocks);
        let mut simulation = Simulation {
            comm,
            scene,
            patches: patches.map(|(p, block)| Patch::new(&layout, p, block)).collect(),
            plan: ExchangePlan::new(scene, &stepper, &layout, reach, comm.rank(), depths),
            sleep: stepper.sleep(),
            outflow: RemovedSums::new(scene),
            side_books: SideBooks::new(scene, stepper.fastest),
            limits: Limits::new(scene, stepper.fastest, stepper.shortest_edge()),
            least_energies: stepper.least_energies(scene),
            expected: ExpectedPeaks::of(scene, &stepper),
            peaks: Peaks::default(),
            self_contact: None,
            start: Start::NONE,
            held: LastGoodState::default(),
            stepper,
            layout,
            reach: None,
            threads,
            pool,
            clock: Clock::new(),
            given_events: Vec::new(),
            given_contact: Vec::new(),
            traced: 0..0,
            tally: Counters::default(),
            imbalance_debt: 0.0,
            census: Census::default(),
            longest_step: longest_step(scene, &frame),
            frame,
            time: 0.0,
            step: 0,
            first_step: 0,
            stable: 0.0,
            longest,
            dt: 0.0,
            stop_request: 0,
            asked: 0,
        };
        simulation.set_arrays(reach);
        simulation.follow_reach(longest);
        simulation.census = simulation.count();
        simulation.with_world(|stepper, world| stepper.prime(world))?;
        simulation.agree(0.0)?;
        simulation.note_start();
        // all ranks start their clocks at the same time
        simulation.clock = Clock::new();
        Ok(simulation)
    }

    pub(super) fn advance_by_step(&mut self, until: f64) -> Result<(), RunError> {
        let left = until - self.time;
        let stable = self.dt;
        // a remainder below the rounding of the time is merged into this step
        let mut meets = stable * (1.0 + 1e-9) >= left;
        let mut dt = if meets { left } else { stable };
        let (end, step) = (self.scene.scene.time.end, self.step);
        if dt * MOST_STEPS < end && !meets {
            return Err(match step {
                0 => RunError::TooLong { end, dt, steps: MOST_STEPS },
                _ => RunError::TimeStep { time: self.time, step, dt },
            });
        }
        let mut redos = 0;
        loop {
            let passed = self.step_by(dt, meets.then_some(until)).and_then(|()| self.pass(end));
            match passed {
                Ok(()) => break,
                Err(RunError::Exchange(error)) => return Err(error.into()),
                Err(error) if !self.redoes() || redos == self.scene.scene.monitor.max_retries => {
                    return Err(error);
                }
                Err(_) => {}
            }
            self.go_back();
            redos += 1;
            self.tally.redone_steps += 1;
            (dt, meets) = (0.5 * dt, false);
        }
        if self.step.is_multiple_of(CENSUS_EVERY) || self.time >= end {
            self.check_census()?;
        }
        self.balance();
        if self.redoes() {
            // after patches have moved, the state for a repeated step must move with them
            self.keep_good_state();
        }
        Ok(())
    }

    /// One step of `dt` [s], with the checks of every step; it ends at the time `meets` [s], if
    /// given. Collective.
    fn step_by(&mut self, dt: f64, meets: Option<f64>) -> Result<(), RunError> {
        self.step += 1;
        self.given_contact.clear();
        let (step, time, stable) = (self.step, self.time, self.stable);
        let ends = meets.is_some_and(|time| time >= self.scene.scene.time.end);
        self.set_self_contact_search(self.is_monitored(step) || ends);
        let sampled = self.samples(step);
        let timed = sampled || (step % EFFECTS_EVERY == 1 && !self.clock.is_stopped());
        self.clock.start_step(step, self.traced.contains(&step), timed);
        self.with_world(|stepper, world| stepper.advance(world, time, dt, stable, step))?;
        if sampled {
            self.patches.iter_mut().for_each(|p| p.stopwatch.end_step());
        } else if timed {
            self.patches.iter_mut().for_each(|p| p.stopwatch.forget_step());
        }
        self.time = meets.unwrap_or(self.time + dt);
        if self.frame.accelerates() {
            self.side_books.take_leave(&self.patches, &self.frame, self.time);
        }
        self.outflow.take(&mut self.patches, self.frame.velocity(self.time));
        self.side_books.take(&mut self.patches);
        self.agree(dt)
    }

    /// If the step is due for it, checks all particles and stores the state that has passed; the
    /// run ends at `end` [s]. Collective.
    fn pass(&mut self, end: f64) -> Result<(), RunError> {
        let due = self.is_monitored(self.step);
        if due || self.redoes() || self.time >= end {
            self.check_state()?;
            self.note_peaks();
            self.note_self_contact();
            if !self.redoes() {
                self.keep_good_state();
            }
        }
        Ok(())
    }
}

impl<const D: usize> Simulation<'_, D> {
    /// Whether the monitor checks the state of all particles after a step.
    fn is_monitored(&self, step: u64) -> bool {
        step.is_multiple_of(self.scene.scene.monitor.interval)
    }

    fn with_world<R>(&mut self, call: impl FnOnce(&Stepper<D>, &mut World<'_, D>) -> R) -> R {
        let mut world = World {
            comm: self.comm,
            layout: &self.layout,
            patches: &mut self.patches,
            particles: &mut self.plan.particles,
            nodes: &mut self.plan.nodes,
            inner_particles: &self.plan.inner_particles,
            inner_nodes: &self.plan.inner_nodes,
            filter: self.plan.filter,
            overlap: self.scene.scene.decomposition.overlap,
            sleep: Some(self.sleep),
            pool: self.pool.as_ref(),
            clock: &mut self.clock,
        };
        call(&self.stepper, &mut world)
    }

    /// Time [s].
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Number of steps, including those before a restart.
    pub fn steps(&self) -> u64 {
        self.step
    }

    /// Steps since the start or the restart of this run.
    pub fn steps_made(&self) -> u64 {
        self.step - self.first_step
    }

    /// Sets the request of this rank: at the end of a step, [`asked`](Self::asked) returns the
    /// greatest request of all ranks. It needs no message of its own.
    pub fn ask(&mut self, what: u8) {
        self.stop_request = what;
    }

    /// Greatest request of all ranks in the last step.
    pub fn asked(&self) -> u8 {
        self.asked
    }

    /// Length of the next step, unless an output shortens it [s].
    pub fn time_step(&self) -> f64 {
        self.dt
    }

    /// Greatest extent of a particle along a direction [cells].
    pub fn longest(&self) -> f64 {
        self.longest
    }

    /// Patches and the ranks that own them.
    pub fn layout(&self) -> &Layout<D> {
        &self.layout
    }

    /// Records a timeline of the steps in `steps`, numbered from 1.
    pub fn trace(&mut self, steps: Range<u64>) {
        self.traced = steps;
    }

    /// Computing, exchange and waiting times of this rank.
    pub fn clock(&mut self) -> &mut Clock {
        &mut self.clock
    }

    /// How filters obtain values beyond a patch.
    pub fn filter_halo(&self) -> FilterHalo {
        self.plan.filter
    }

    /// Computing time of patches in the sampled steps [s], and its share in each
    /// [part](crate::solver::parts) of a step [s]; trailing parts without time may be missing.
    pub fn part_seconds(&self) -> (f64, Vec<f64>) {
        let watches = || self.patches.iter().map(|p| &p.stopwatch);
        let count = watches().map(|watch| watch.parts.len()).max().unwrap_or(0);
        let seconds = |k: usize| watches().filter_map(|watch| watch.parts.get(k)).sum();
        (watches().map(|watch| watch.computed).sum(), (0..count).map(seconds).collect())
    }

    /// Particle columns.
    pub fn columns(&self) -> &Columns {
        &self.stepper.columns
    }

    /// Reduces over all ranks the longest stable step, faults, the particles of the busiest rank
    /// and requests, and checks the step of `dt` [s]. Collective.
    fn agree(&mut self, dt: f64) -> Result<(), RunError> {
        let start = self.clock.now();
        let faulty = self.patches.iter().any(|p| p.report.fault.is_some());
        let shortest =
            self.patches.iter().map(|p| p.report.time_step).fold(f64::INFINITY, f64::min);
        let longest = self.patches.iter().map(|p| p.report.length).fold(0.0, f64::max);
        let computed = self.count_step();
        let fault = if faulty { -1.0 } else { 0.0 };
        let mut reduced =
            [shortest, -longest, fault, -(computed as f64), -f64::from(self.stop_request)];
        let waited = self.comm.traffic().waited;
        self.comm.min(&mut reduced);
        let waited = self.comm.traffic().waited - waited;
        self.clock.event("agree", start);
        self.clock.add(Activity::Wait, waited);
        self.clock.add_since(Activity::Exchange, start, waited);
        self.tally.busiest_particle_steps += -reduced[3] as u64;
        if reduced[2] < 0.0 {
            return Err(self.gather_fault());
        }
        self.check_step(reduced[0], dt)?;
        (self.stable, self.longest, self.asked) =
            (reduced[0].min(self.longest_step), -reduced[1], -reduced[4] as u8);
        self.dt = self.scene.scene.time.courant * self.stable;
        self.follow_reach(self.longest);
        Ok(())
    }

    /// Makes ghost layers and halos as deep as the longest particle needs. The same on all ranks.
    pub(super) fn follow_reach(&mut self, longest: f64) {
        let reach = self.stepper.reach(longest).expect("a longer particle is a fault");
        if self.reach != Some(reach) {
            self.make_plan(reach);
            self.set_arrays(reach);
        }
        let limit = self.stepper.longest_within(reach);
        self.patches.iter_mut().for_each(|p| p.reach_length = limit);
    }

    /// Allocates the nodal arrays of all patches for the stencil radius of the plan.
    fn set_arrays(&mut self, reach: StencilRadius) {
        self.reach = Some(reach);
        let (fields, layers) = (self.stepper.fields.count, self.stepper.layers);
        let mine = self.layout.patches_of(self.comm.rank());
        let (depth, deeper) = (reach.depth(self.plan.ghosts), self.plan.deeper);
        for (patch, index) in self.patches.iter_mut().zip(mine) {
            patch.set_arrays(&self.layout, index, depth, deeper, fields, layers);
        }
    }

    /// Rebuilds the exchange plan.
    pub(super) fn make_plan(&mut self, reach: StencilRadius) {
        self.tally.migrated += self.plan.particles.take_migrated();
        let (rank, workers) = (self.comm.rank(), self.comm.size() * self.threads);
        let depths = halo_depths(self.scene, &self.layout, reach, workers);
        self.plan = ExchangePlan::new(self.scene, &self.stepper, &self.layout, reach, rank, depths);
    }

    /// First fault of the step, the same for any layout, at rank 0. Collective.
    fn gather_fault(&self) -> RunError {
        const KEYS: usize = 4;
        let faults = self.patches.iter().filter_map(|p| p.report.fault.as_ref());
        let mut words = Vec::new();
        if let Some(fault) = faults.min_by_key(|f| f.order()) {
            words.extend::<[u64; KEYS]>(fault.order());
            words.push(fault.body as u64);
            words.extend(fault.position.map(f64::to_bits));
            words.extend(fault.what.bytes().map(u64::from));
        }
        let all = self.comm.gather(&words);
        let Some(w) = all.iter().filter(|w| !w.is_empty()).min_by_key(|w| &w[..KEYS]) else {
            return RunError::Elsewhere;
        };
        let (place, what) = w[KEYS + 1..].split_at(D);
        let place = std::array::from_fn(|a| f64::from_bits(place[a]));
        let cell = std::array::from_fn(|a| w[2 - a] as i64 + i64::from(i32::MIN));
        let what = what.iter().map(|&b| b as u8).collect::<Vec<_>>();
        let what = String::from_utf8_lossy(&what).into_owned();
        self.particle_error(Alarm::State, w[KEYS - 1], w[KEYS] as usize, cell, place, what)
    }
}

/// Set-up and step of a run, compiled once in this crate for each dimension: both call most of the
/// solver and of the effects, which every program that uses the library would compile again.
pub trait Compiled<const D: usize> {
    /// Compiled form of [`Simulation::with_models`]. Collective.
    ///
    /// # Errors
    ///
    /// As [`Simulation::with_models`].
    fn create<'a>(
        scene: &'a CheckedScene,
        comm: &'a dyn Comm,
        threads: usize,
        outside: &dyn Fn(&str) -> Option<CustomModel>,
    ) -> Result<Simulation<'a, D>, RunError>;

    /// Compiled form of [`Simulation::advance`]. Collective.
    ///
    /// # Errors
    ///
    /// As [`Simulation::advance`].
    fn advance_run(run: &mut Simulation<'_, D>, until: f64) -> Result<(), RunError>;
}

macro_rules! compile_runs {
    ($($dimension:literal),*) => {$(
        impl Compiled<$dimension> for Stepper<$dimension> {
            fn create<'a>(
                scene: &'a CheckedScene,
                comm: &'a dyn Comm,
                threads: usize,
                outside: &dyn Fn(&str) -> Option<CustomModel>,
            ) -> Result<Simulation<'a, $dimension>, RunError> {
                Simulation::create(scene, comm, threads, outside)
            }

            fn advance_run(
                run: &mut Simulation<'_, $dimension>,
                until: f64,
            ) -> Result<(), RunError> {
                run.advance_by_step(until)
            }
        }
    )*};
}

compile_runs!(1, 2);
