//! A run in memory: the scene's particles on their patches, advanced step by step.
//!
//! A value, without globals: several can live in one process. Files and pictures are made
//! elsewhere from what it tells.

mod balance;
mod conservation;
mod diagnostics;
mod look;
pub mod monitor;
mod particle_table;
mod peaks;
mod snapshot;
pub mod threads;

pub use crate::solver::patch::Given;
pub use conservation::{Left, Tally, Ways};
pub use diagnostics::{Followed, Totals};
pub use particle_table::{ParticleTable, TableColumn};
pub use snapshot::{Saved, saved_sums};

use std::ops::Range;
use std::time::Instant;

use decomp::{
    Census, Comm, IndexBox, Layout, NodeExchange, RowError, RowExchange, RowReach, assign_patches,
    choose_cuts, curve_order, even_cuts,
};

use crate::effects::Effect;
use crate::geometry::Tile;
use crate::material::constitutive::Outside;
use crate::scene::moving_frame::Frame;
use crate::scene::{CheckedBody, CheckedScene, FilterHalo, Side};
use crate::simulation::monitor::{Alarm, Limits, Peaks};
use crate::simulation::threads::make_pool;
use crate::solver::clock::{Activity, Clock, Event};
use crate::solver::particles::{self, Columns};
use crate::solver::patch::Patch;
use crate::solver::{Reach, Sleep, Stepper, Steps, World};

use conservation::{CENSUS_EVERY, Outflow, SideBooks};
use look::{Held, Start};
use peaks::Expected;

/// Why a run ended before its time.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// A particle's state is none that the run could go on from.
    #[error(
        "particle {id} of body `{body}` at {position}, time {time:.6e} s, step {step}: {what}; likely cause: {cause}"
    )]
    Particle {
        /// Its id.
        id: u64,
        /// Name of its body.
        body: String,
        /// Its position and cell, in words.
        position: String,
        /// Time [s].
        time: f64,
        /// Number of the step.
        step: u64,
        /// What has found it.
        alarm: Alarm,
        /// What is wrong.
        what: String,
        /// What is likely behind it, and what to try.
        cause: Box<str>,
    },
    /// The time step has become too short to end.
    #[error(
        "time {time:.6e} s, step {step}: the stable time step has fallen to {dt:.3e} s; the run is unstable or the scene too stiff"
    )]
    TimeStep {
        /// Time [s].
        time: f64,
        /// Number of the step.
        step: u64,
        /// The step [s].
        dt: f64,
    },
    /// The run would never end.
    #[error(
        "time.end = {end:?}: beyond {steps:.0e} steps of {dt:.3e} s; allowed: a shorter time.end or a larger time.courant"
    )]
    TooLong {
        /// End of the run [s].
        end: f64,
        /// The first step [s].
        dt: f64,
        /// Most steps.
        steps: f64,
    },
    /// A model from outside of this library has no place in the scene.
    #[error("materials.{material}: {reason}")]
    Model {
        /// Name of the material.
        material: String,
        /// Why.
        reason: String,
    },
    /// A row was lost by the decomposition.
    #[error(transparent)]
    Row(#[from] RowError),
    /// Particles were lost or doubled between patches: a fault of this program.
    #[error(
        "time {time:.6e} s, step {step}: {now} particles where {before} should be, or others than those; please report this scene and its layout"
    )]
    Lost {
        /// Time [s].
        time: f64,
        /// Number of the step.
        step: u64,
        /// Number of particles that there should be.
        before: u64,
        /// Number that there are.
        now: u64,
    },
    /// What a run was to go on from is not of its scene.
    #[error("the particles of the checkpoint are not those that its scene starts with")]
    Foreign,
    /// Another rank tells.
    #[error("another rank has failed")]
    Elsewhere,
}

impl RunError {
    /// Whether all ranks know of it, so that they can do something together.
    pub fn is_known_to_all(&self) -> bool {
        use RunError::{Elsewhere, Lost, Particle, TimeStep};
        matches!(self, Particle { .. } | TimeStep { .. } | Lost { .. } | Elsewhere)
    }
}

/// A run in memory.
pub struct Simulation<'a, const D: usize> {
    comm: &'a dyn Comm,
    scene: &'a CheckedScene,
    stepper: Stepper<D>,
    layout: Layout<D>,
    /// Patches along the curve by which they are dealt.
    order: Vec<usize>,
    patches: Vec<Patch<D>>,
    /// Known once the particles' lengths are.
    reach: Option<Reach>,
    plan: Plan<D>,
    sleep: Sleep,
    threads: usize,
    pool: Option<rayon::ThreadPool>,
    clock: Clock,
    /// Events of patches that other ranks have now.
    given_events: Vec<(usize, Event)>,
    /// Forces of contact of the last step that such patches have told.
    given_contact: Vec<[f64; 2]>,
    /// Steps of which a timeline is kept.
    traced: Range<u64>,
    tally: Tally,
    /// What a better share of the patches would have gained since they last moved, alike on all
    /// ranks [cost].
    forgone: f64,
    /// All particles at the start.
    census: Census,
    outflow: Outflow<D>,
    side_books: SideBooks<D>,
    /// What the watch holds the run to, the sums that it started with, and the last good state.
    limits: Limits,
    /// Least admissible specific internal energy of each body's particles [J/kg].
    least_energies: Vec<f64>,
    expected: Vec<Expected<D>>,
    peaks: Peaks,
    start: Start<D>,
    held: Held<D>,
    frame: Frame<D>,
    /// No step is longer, where the frame accelerates [s].
    longest_step: f64,
    time: f64,
    step: u64,
    /// The step from which this run goes on; 0: the start.
    first_step: u64,
    /// Longest stable next step at a Courant number of 1 [s].
    stable: f64,
    /// Greatest extent of a particle along a direction [cells].
    longest: f64,
    /// Length of the next step [s].
    dt: f64,
    /// What this rank asks of all, and what the most urgent of all ranks asks.
    asks: u8,
    asked: u8,
}

/// Who exchanges what with whom, for one reach and one assignment of patches.
struct Plan<const D: usize> {
    rows: RowExchange<D>,
    nodes: NodeExchange<D>,
    inner_rows: Vec<bool>,
    inner_nodes: Vec<bool>,
    filter: FilterHalo,
    /// Depth of ghosts about a patch [cells].
    ghosts: i64,
    /// How far beyond its own nodes a patch computes.
    deeper: i64,
}

/// What the side of a scene is to the decomposition.
pub(crate) fn decomp_side(side: Side) -> decomp::Side {
    match side {
        Side::Free | Side::Outflow | Side::Transmitting | Side::Pressure(_) => decomp::Side::Open,
        Side::Symmetry | Side::Wall | Side::NoSlip | Side::Friction(_) | Side::Velocity(_) => {
            decomp::Side::Mirror
        }
        Side::Periodic => decomp::Side::Wrap,
    }
}

/// Steps from one of which the effects' shares are sampled to the next: no multiple of anything.
const EFFECTS_EVERY: u64 = 61;

/// Steps that no run comes to the end of.
const MOST_STEPS: f64 = 1e12;

/// Patches narrower than this only cost.
pub(crate) const LEAST_CELLS: usize = 16;

/// Patches of about this many cells along a direction sleep and wake with little lost at their
/// ends, for one worker: on a line and in a plane, ...
const SLEEPING_CELLS: [usize; 2] = [64, 32];

/// Patches for each of several workers that sleep and wake, or move, ...
const PATCHES_A_WORKER: usize = 8;

/// ... as long as they are at least this wide: with others comes more work at their ends.
const SHARED_CELLS: [usize; 2] = [256, 64];

/// The number of patches for a scene on so many ranks and threads: the scene's own, or at least
/// one for each thread of each rank unless they would be too narrow, and several where patches
/// may sleep or a plane is shared.
pub fn patch_counts(scene: &CheckedScene, ranks: usize, threads: usize) -> Vec<usize> {
    match scene.dimension {
        1 => patch_parts::<1>(scene, ranks, threads).to_vec(),
        _ => patch_parts::<2>(scene, ranks, threads).to_vec(),
    }
}

fn patch_parts<const D: usize>(scene: &CheckedScene, ranks: usize, threads: usize) -> [usize; D] {
    if let Some(patches) = &scene.scene.domain.patches {
        return std::array::from_fn(|a| patches[a]);
    }
    let cells: [usize; D] = std::array::from_fn(|a| scene.cells[a]);
    let workers = ranks * threads;
    let of_edge = |edge: [usize; 2]| cells.iter().map(|n| (n / edge[D - 1]).max(1)).product();
    let parts = |wanted: usize| choose_cuts(cells, wanted, LEAST_CELLS);
    match workers {
        1 if may_sleep::<D>(scene) => parts(of_edge(SLEEPING_CELLS)),
        _ if may_sleep::<D>(scene) => {
            let several: usize = of_edge(SHARED_CELLS);
            parts(several.clamp(workers, PATCHES_A_WORKER * workers))
        }
        1 => [1; D],
        _ => {
            // in a plane four for each: a long particle widens the windows of fewer others, and what
            // lies inside is computed while messages travel
            let parts = parts(workers);
            let halves = D > 1 && (0..D).all(|a| cells[a] / parts[a] >= 2 * SHARED_CELLS[D - 1]);
            if halves { parts.map(|n| 2 * n) } else { parts }
        }
    }
}

/// Whether a body is at rest and free of stress, so that patches can sleep.
fn may_sleep<const D: usize>(scene: &CheckedScene) -> bool {
    let mut bodies = scene.scene.bodies.iter().zip(&scene.bodies);
    let velocity = scene.grid_velocity::<D>();
    scene.skips_quiet()
        && scene.scene.body_force.is_none()
        && bodies.any(|(b, c)| c.motion.is_none() && c.velocity == velocity && b.pressure == 0.0)
}

/// The longest step, at a Courant number of 1, for a grid that accelerates [s]: material at rest
/// is faster in the next step than it is in this one.
fn longest_step<const D: usize>(scene: &CheckedScene, frame: &Frame<D>) -> f64 {
    match frame.greatest_change() {
        0.0 => f64::INFINITY,
        change => scene.cell_size.iter().copied().fold(f64::INFINITY, f64::min) / change,
    }
}

/// Particles in the cells of `cells`, counted without making them.
fn count_particles<const D: usize>(scene: &CheckedScene, cells: &IndexBox<D>) -> u64 {
    let x = |a: usize, cell: i64| scene.scene.domain.lower[a] + cell as f64 * scene.cell_size[a];
    let inside = |tile: &Tile| {
        let at = (0..D).map(|a| (x(a, cells.lower[a]), tile.centre[a], x(a, cells.upper[a])));
        at.into_iter().all(|(lower, at, upper)| lower <= at && at < upper)
    };
    let count = |body: &CheckedBody| match &body.tiles {
        Some(tiles) => tiles.iter().filter(|tile| inside(tile)).count() as f64,
        None => (0..D)
            .map(|a| {
                let (lower, upper) = (body.lower[a], body.upper[a]);
                let inside = upper.min(x(a, cells.upper[a])) - lower.max(x(a, cells.lower[a]));
                inside.max(0.0) / (upper - lower) * body.lattice[a] as f64
            })
            .product::<f64>()
            .round(),
    };
    scene.bodies.iter().map(|body| count(body) as u64).sum()
}

/// How much more a particle weighs than an empty cell as the domain is cut.
const PARTICLE_WEIGHT: u64 = 4;

/// The domain cut into patches: of equal width where the scene gives their number, else with
/// about the same number of particles at the start in each row and column of patches.
fn cut_domain<const D: usize>(scene: &CheckedScene, ranks: usize, threads: usize) -> Layout<D> {
    let parts = patch_parts::<D>(scene, ranks, threads);
    let domain = IndexBox::new([0; D], std::array::from_fn(|a| scene.cells[a] as i64));
    let sides = scene.sides::<D>().map(|ends| ends.map(decomp_side));
    if scene.scene.domain.patches.is_some() || parts == [1; D] {
        return Layout::new(domain, sides, parts);
    }
    let cuts = std::array::from_fn(|a| {
        let across = domain.count() as u64 / scene.cells[a] as u64;
        let weights: Vec<u64> = particles::slices(scene, a)
            .into_iter()
            .map(|particles| across + PARTICLE_WEIGHT * particles)
            .collect();
        even_cuts(&weights, parts[a], LEAST_CELLS)
    });
    Layout::with_cuts(domain, sides, cuts)
}

impl<const D: usize> Plan<D> {
    fn new(
        scene: &CheckedScene,
        stepper: &Stepper<D>,
        layout: &Layout<D>,
        reach: Reach,
        rank: usize,
        workers: usize,
    ) -> Self {
        let options = &scene.scene.decomposition;
        let extents = layout.patches().iter().flat_map(|p| (0..D).map(|a| p.extent(a)));
        let narrowest = extents.min().unwrap_or(0);
        let choose = || FilterHalo::choose(reach, narrowest, workers);
        let filter = options.filter_halo.unwrap_or_else(choose);
        let deeper = match filter {
            FilterHalo::Exchange => 0,
            FilterHalo::Deep => reach.deeper(),
        };
        let ghosts = reach.cells() + deeper;
        let notice = scene.skips_quiet().then(|| stepper.notice(reach));
        let rows = RowExchange::new(layout, rank, RowReach { depth: ghosts, travel: 1, notice });
        let nodes =
            NodeExchange::layered(layout, rank, reach.halo(), reach.depth(ghosts), stepper.layers);
        Plan {
            inner_rows: rows.inner().to_vec(),
            inner_nodes: nodes.inner().to_vec(),
            rows,
            nodes,
            filter,
            ghosts,
            deeper,
        }
    }
}

impl<'a, const D: usize> Simulation<'a, D>
where
    Stepper<D>: Steps<D>,
{
    /// Seconds that patches have computed in the steps that were sampled, and of them those of each
    /// effect, in the order of [`Effect::ALL`].
    pub fn effect_seconds(&self) -> (f64, [f64; Effect::COUNT]) {
        let mut sum = (0.0, [0.0; Effect::COUNT]);
        for watch in self.patches.iter().map(|p| &p.watch) {
            sum.0 += watch.computed;
            (0..Effect::COUNT).for_each(|k| sum.1[k] += watch.effects[k]);
        }
        sum
    }

    /// Makes the particles of `scene`, to be run by `threads` threads on each rank. Collective.
    pub fn new(
        scene: &'a CheckedScene,
        comm: &'a dyn Comm,
        threads: usize,
    ) -> Result<Self, RunError> {
        Self::with_models(scene, comm, threads, &|_| None)
    }

    /// The same with models from outside of this library in place of those of the materials for
    /// which `outside` has some; it is asked by name, once a body. Collective.
    ///
    /// # Errors
    ///
    /// As [`Simulation::new`], and where the scene has no place for them.
    pub fn with_models(
        scene: &'a CheckedScene,
        comm: &'a dyn Comm,
        threads: usize,
        outside: &dyn Fn(&str) -> Option<Outside>,
    ) -> Result<Self, RunError> {
        let stepper = Stepper::with_models(scene, outside)
            .map_err(|(material, reason)| RunError::Model { material, reason })?;
        let layout = cut_domain(scene, comm.size(), threads);
        let order = curve_order(layout.parts());
        let weights: Vec<u64> =
            layout.patches().iter().map(|p| count_particles(scene, p)).collect();
        let layout = layout.with_ranks(assign_patches(&weights, &order, comm.size()));
        let frame = scene.frame();
        let blocks = particles::fill(
            scene,
            &stepper.columns,
            &layout,
            comm.rank(),
            frame.velocity(0.0),
            &|body, pressure| {
                stepper.starting_energy(body, pressure, scene.scene.bodies[body].temperature)
            },
            &|body, pressure| stepper.starting_impulse(body, pressure),
        );
        let longest = stepper.longest_at_start(scene);
        let reach = stepper.reach(longest).expect("a longer particle is a fault");
        let workers = comm.size() * threads;
        let pool = (threads > 1 && layout.patches().len() > 1).then(|| make_pool(threads));
        let patches = layout.patches_of(comm.rank()).into_iter().zip(blocks);
        let mut simulation = Simulation {
            comm,
            scene,
            patches: patches.map(|(p, block)| Patch::new(&layout, p, block)).collect(),
            plan: Plan::new(scene, &stepper, &layout, reach, comm.rank(), workers),
            sleep: stepper.sleep(),
            outflow: Outflow::new(scene),
            side_books: SideBooks::new(scene, stepper.fastest),
            limits: Limits::new(scene, stepper.fastest, stepper.shortest_edge()),
            least_energies: stepper.least_energies(scene),
            expected: Expected::of(scene, &stepper),
            peaks: Peaks::default(),
            start: Start::NONE,
            held: Held::default(),
            stepper,
            layout,
            order,
            reach: None,
            threads,
            pool,
            clock: Clock::new(),
            given_events: Vec::new(),
            given_contact: Vec::new(),
            traced: 0..0,
            tally: Tally::default(),
            forgone: 0.0,
            census: Census::default(),
            longest_step: longest_step(scene, &frame),
            frame,
            time: 0.0,
            step: 0,
            first_step: 0,
            stable: 0.0,
            longest,
            dt: 0.0,
            asks: 0,
            asked: 0,
        };
        simulation.follow_reach(longest);
        simulation.census = simulation.count();
        simulation.with_world(|stepper, world| stepper.prime(world))?;
        simulation.agree(0.0)?;
        simulation.note_start();
        // all ranks start their clocks together
        simulation.clock = Clock::new();
        Ok(simulation)
    }

    /// One step, the last one before `until` [s] shortened to meet it exactly; the step after is
    /// as long as if it had not been. One that the watch does not let pass is an error, or is
    /// redone half as long if the scene says so. Collective.
    pub fn advance(&mut self, until: f64) -> Result<(), RunError> {
        let left = until - self.time;
        let stable = self.dt;
        // a remainder below rounding of the time is no step of its own
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
                Err(RunError::Row(error)) => return Err(error.into()),
                Err(error) if !self.redoes() || redos == self.scene.scene.watch.most_redos => {
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
            // where patches go, what they are redone from goes with them
            self.hold();
        }
        Ok(())
    }

    /// One step of `dt` [s], which meets a time if that is given, and what every step is looked at
    /// for. Collective.
    fn step_by(&mut self, dt: f64, meets: Option<f64>) -> Result<(), RunError> {
        self.step += 1;
        self.given_contact.clear();
        let (step, time) = (self.step, self.time);
        let sampled = self.samples(step);
        let timed = sampled || step % EFFECTS_EVERY == 1;
        self.clock.start_step(step, self.traced.contains(&step), timed);
        self.with_world(|stepper, world| stepper.advance(world, time, dt, step))?;
        if sampled {
            self.patches.iter_mut().for_each(|p| p.watch.end_step());
        } else if timed {
            self.patches.iter_mut().for_each(|p| p.watch.forget_step());
        }
        self.time = meets.unwrap_or(self.time + dt);
        if self.frame.accelerates() {
            self.side_books.take_leave(&self.patches, &self.frame, self.time);
        }
        self.outflow.take(&mut self.patches, self.frame.velocity(self.time));
        self.side_books.take(&mut self.patches);
        self.agree(dt)
    }

    /// Looks at all particles if the step is one to do so at, and holds the state that has passed;
    /// the run ends at `end` [s]. Collective.
    fn pass(&mut self, end: f64) -> Result<(), RunError> {
        let due = self.step.is_multiple_of(self.scene.scene.watch.interval);
        if due || self.redoes() || self.time >= end {
            self.look()?;
            self.note_peaks();
            if !self.redoes() {
                self.hold();
            }
        }
        Ok(())
    }
}

impl<const D: usize> Simulation<'_, D> {
    fn with_world<R>(&mut self, call: impl FnOnce(&Stepper<D>, &mut World<'_, D>) -> R) -> R {
        let mut world = World {
            comm: self.comm,
            layout: &self.layout,
            patches: &mut self.patches,
            rows: &mut self.plan.rows,
            nodes: &mut self.plan.nodes,
            inner_rows: &self.plan.inner_rows,
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

    /// Steps made.
    pub fn steps(&self) -> u64 {
        self.step
    }

    /// Steps that this run has made itself: those since what it went on from.
    pub fn steps_made(&self) -> u64 {
        self.step - self.first_step
    }

    /// Asks something of all ranks: the greatest number of all is what [`asked`](Self::asked) tells
    /// them all at the end of a step. It costs no message of its own.
    pub fn ask(&mut self, what: u8) {
        self.asks = what;
    }

    /// The greatest number that a rank has asked for in the last step.
    pub fn asked(&self) -> u8 {
        self.asked
    }

    /// Length of the next step, unless an output shortens it [s].
    pub fn time_step(&self) -> f64 {
        self.dt
    }

    /// The patches and who has them.
    pub fn layout(&self) -> &Layout<D> {
        &self.layout
    }

    /// Keeps a timeline of the steps in `steps`, numbered from 1.
    pub fn trace(&mut self, steps: Range<u64>) {
        self.traced = steps;
    }

    /// Where the time of this rank went.
    pub fn clock(&mut self) -> &mut Clock {
        &mut self.clock
    }

    /// How filters get what lies beyond a patch.
    pub fn filter_halo(&self) -> FilterHalo {
        self.plan.filter
    }

    /// The columns of a particle.
    pub fn columns(&self) -> &Columns {
        &self.stepper.columns
    }

    /// The longest stable step over all ranks, the verdict on all ranks' faults and on the step of
    /// `dt` [s] that has led here, what the busiest rank computed, and what ranks ask for.
    /// Collective.
    fn agree(&mut self, dt: f64) -> Result<(), RunError> {
        let start = Instant::now();
        let faulty = self.patches.iter().any(|p| p.told.fault.is_some());
        let shortest = self.patches.iter().map(|p| p.told.time_step).fold(f64::INFINITY, f64::min);
        let longest = self.patches.iter().map(|p| p.told.length).fold(0.0, f64::max);
        let computed = self.count_step();
        let fault = if faulty { -1.0 } else { 0.0 };
        let mut told = [shortest, -longest, fault, -(computed as f64), -f64::from(self.asks)];
        let waited = self.comm.traffic().waited;
        self.comm.min(&mut told);
        let waited = self.comm.traffic().waited - waited;
        self.clock.event("agree", start);
        self.clock.add(Activity::Wait, waited);
        self.clock.add_since(Activity::Exchange, start, waited);
        self.tally.busiest_particle_steps += -told[3] as u64;
        if told[2] < 0.0 {
            return Err(self.gather_fault());
        }
        self.look_at_step(told[0], dt)?;
        (self.stable, self.longest, self.asked) =
            (told[0].min(self.longest_step), -told[1], -told[4] as u8);
        self.dt = self.scene.scene.time.courant * self.stable;
        self.follow_reach(self.longest);
        Ok(())
    }

    /// Makes ghosts and halos as deep as the longest particle needs. Alike on all ranks.
    fn follow_reach(&mut self, longest: f64) {
        let reach = self.stepper.reach(longest).expect("a longer particle is a fault");
        if self.reach != Some(reach) {
            self.reach = Some(reach);
            self.make_plan(reach);
            let (fields, layers) = (self.stepper.fields.count, self.stepper.layers);
            let mine = self.layout.patches_of(self.comm.rank());
            let (depth, deeper) = (reach.depth(self.plan.ghosts), self.plan.deeper);
            for (patch, index) in self.patches.iter_mut().zip(mine) {
                patch.set_arrays(&self.layout, index, depth, deeper, fields, layers);
            }
        }
        let limit = self.stepper.longest_within(reach);
        self.patches.iter_mut().for_each(|p| p.reach_length = limit);
    }

    /// Finds anew who exchanges what with whom.
    fn make_plan(&mut self, reach: Reach) {
        self.tally.migrated += self.plan.rows.take_migrated();
        let (rank, workers) = (self.comm.rank(), self.comm.size() * self.threads);
        self.plan = Plan::new(self.scene, &self.stepper, &self.layout, reach, rank, workers);
    }

    /// The step's first fault, the same for any layout, at rank 0. Collective.
    fn gather_fault(&self) -> RunError {
        const KEYS: usize = 4;
        let faults = self.patches.iter().filter_map(|p| p.told.fault.as_ref());
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
