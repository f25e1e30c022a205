//! A run in memory: the scene's particles on their patches, advanced step by step.
//!
//! A value, without globals: several can live in one process. Files and pictures are made
//! elsewhere from what it tells.

mod observe;

pub use observe::{Followed, Totals};

use decomp::{
    Comm, IndexBox, Layout, NodeArrays, NodeExchange, RowError, RowExchange, assign_patches,
    choose_cuts,
};

use crate::particles::{self, Columns};
use crate::patch::Patch;
use crate::scene::{CheckedScene, FilterHalo, Side};
use crate::step::{PhaseTimes, Reach, Stepper, World};

/// Why a run ended before its time.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// A particle's state is none that the run could go on from.
    #[error(
        "particle {id} of body `{body}` at x = {position:.6e} m, time {time:.6e} s, step {step}: {what}"
    )]
    Particle {
        /// Its id.
        id: u64,
        /// Name of its body.
        body: String,
        /// Its position [m].
        position: f64,
        /// Time [s].
        time: f64,
        /// Number of the step.
        step: u64,
        /// What is wrong.
        what: String,
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
    /// A row was lost by the decomposition.
    #[error(transparent)]
    Row(#[from] RowError),
    /// Another rank tells.
    #[error("another rank has failed")]
    Elsewhere,
}

/// A run in memory.
pub struct Simulation<'a, C: Comm> {
    comm: &'a C,
    scene: &'a CheckedScene,
    stepper: Stepper,
    layout: Layout<1>,
    patches: Vec<Patch<1>>,
    /// Known once the particles' lengths are.
    reach: Option<Reach>,
    filter: FilterHalo,
    threads: usize,
    rows: RowExchange<1>,
    nodes: NodeExchange<1>,
    pool: Option<rayon::ThreadPool>,
    times: PhaseTimes,
    grid_velocity: f64,
    time: f64,
    step: u64,
    dt: f64,
}

/// What the side of a scene is to the decomposition.
fn decomp_side(side: Side) -> decomp::Side {
    match side {
        Side::Free | Side::Outflow => decomp::Side::Open,
        Side::Symmetry | Side::Wall | Side::Velocity(_) => decomp::Side::Mirror,
        Side::Periodic => decomp::Side::Wrap,
    }
}

/// The sides of a scene.
pub fn sides(scene: &CheckedScene) -> [Side; 2] {
    scene.scene.boundary.as_ref().map_or([Side::Free; 2], |b| [b.x_lower, b.x_upper])
}

/// The velocity at which the grid travels with a piston [m/s].
fn grid_velocity(scene: &CheckedScene) -> f64 {
    sides(scene)
        .iter()
        .find_map(|s| if let Side::Velocity(v) = s { Some(*v) } else { None })
        .unwrap_or(0.0)
}

/// Steps that no run comes to the end of.
const MOST_STEPS: f64 = 1e12;

/// Patches narrower than this only cost.
const LEAST_CELLS: usize = 16;

/// The number of patches for a scene on so many ranks and threads: the scene's own, or one for
/// each thread of each rank unless they would be too narrow.
pub fn patch_counts(scene: &CheckedScene, ranks: usize, threads: usize) -> Vec<usize> {
    match &scene.scene.domain.patches {
        Some(patches) => patches.clone(),
        None => choose_cuts([scene.cells[0]], ranks * threads, LEAST_CELLS).to_vec(),
    }
}

/// Particles in each patch, counted without making them.
fn count_particles(scene: &CheckedScene, layout: &Layout<1>) -> Vec<u64> {
    let mut counts = vec![0u64; layout.patches().len()];
    for (body, checked) in scene.scene.bodies.iter().zip(&scene.bodies) {
        let (lower, upper) = (body.extent.lower[0], body.extent.upper[0]);
        for (count, patch) in counts.iter_mut().zip(layout.patches()) {
            let x = |cell: i64| scene.scene.domain.lower[0] + cell as f64 * scene.cell_size[0];
            let inside = (upper.min(x(patch.upper[0])) - lower.max(x(patch.lower[0]))).max(0.0);
            *count += (inside / (upper - lower) * checked.lattice[0] as f64).round() as u64;
        }
    }
    counts
}

impl<'a, C: Comm> Simulation<'a, C> {
    /// Makes the particles of `scene`. Collective.
    pub fn new(scene: &'a CheckedScene, comm: &'a C, threads: usize) -> Result<Self, RunError> {
        let stepper = Stepper::new(scene);
        let cuts = patch_counts(scene, comm.size(), threads);
        let domain = IndexBox::new([0], [scene.cells[0] as i64]);
        let layout = Layout::new(domain, [sides(scene).map(decomp_side)], [cuts[0]]);
        let weights = count_particles(scene, &layout);
        let layout = layout.with_ranks(assign_patches(&weights, comm.size()));
        let grid_velocity = grid_velocity(scene);
        let energies = stepper.starting_energies(scene);
        let blocks = particles::fill(
            scene,
            &stepper.columns,
            &layout,
            comm.rank(),
            grid_velocity,
            &energies,
        );
        let longest = (scene.scene.bodies.iter().zip(&scene.bodies))
            .map(|(b, c)| (b.extent.upper[0] - b.extent.lower[0]) / c.lattice[0] as f64)
            .fold(0.0, f64::max)
            / scene.cell_size[0];
        let busy = threads.min(blocks.len());
        let patches = layout
            .patches_of(comm.rank())
            .into_iter()
            .zip(blocks)
            .map(|(p, block)| Patch::new(&layout, p, block));
        let pool = (busy > 1).then(|| {
            rayon::ThreadPoolBuilder::new()
                .num_threads(busy)
                .build()
                .expect("the system gives threads")
        });
        let mut simulation = Simulation {
            comm,
            scene,
            patches: patches.collect(),
            rows: RowExchange::new(&layout, comm.rank(), 1, 1),
            nodes: NodeExchange::new(&layout, comm.rank(), 1),
            stepper,
            layout,
            reach: None,
            filter: FilterHalo::Exchange,
            threads,
            pool,
            times: PhaseTimes::default(),
            grid_velocity,
            time: 0.0,
            step: 0,
            dt: 0.0,
        };
        simulation.follow_reach(longest);
        simulation.with_world(|stepper, world| stepper.prime(world))?;
        simulation.agree()?;
        Ok(simulation)
    }

    fn with_world<R>(&mut self, call: impl FnOnce(&Stepper, &mut World<'_>) -> R) -> R {
        let mut world = World {
            comm: self.comm,
            layout: &self.layout,
            patches: &mut self.patches,
            rows: &mut self.rows,
            nodes: &mut self.nodes,
            filter: self.filter,
            pool: self.pool.as_ref(),
            times: &mut self.times,
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

    /// Length of the next step, unless an output shortens it [s].
    pub fn time_step(&self) -> f64 {
        self.dt
    }

    /// The patches and who has them.
    pub fn layout(&self) -> &Layout<1> {
        &self.layout
    }

    /// Seconds spent in each phase on this rank.
    pub fn phase_seconds(&self) -> &PhaseTimes {
        &self.times
    }

    /// The columns of a particle.
    pub fn columns(&self) -> &Columns {
        &self.stepper.columns
    }

    /// The longest stable step over all ranks, and the verdict on all ranks' faults. Collective.
    fn agree(&mut self) -> Result<(), RunError> {
        let faulty = self.patches.iter().any(|p| p.told.fault.is_some());
        let shortest = self.patches.iter().map(|p| p.told.time_step).fold(f64::INFINITY, f64::min);
        let longest = self.patches.iter().map(|p| p.told.length).fold(0.0, f64::max);
        let mut told = [shortest, -longest, if faulty { -1.0 } else { 0.0 }];
        self.comm.min(&mut told);
        if told[2] < 0.0 {
            return Err(self.gather_fault());
        }
        self.dt = self.scene.scene.time.courant * told[0];
        self.follow_reach(-told[1]);
        Ok(())
    }

    /// Makes ghosts and halos as deep as the longest particle needs. Alike on all ranks.
    fn follow_reach(&mut self, longest: f64) {
        let reach = self.stepper.reach(longest).expect("a longer particle is a fault");
        if self.reach != Some(reach) {
            self.reach = Some(reach);
            let narrowest = self.layout.patches().iter().map(|p| p.extent(0)).min().unwrap_or(0);
            let workers = self.comm.size() * self.threads;
            let wanted = self.scene.scene.decomposition.as_ref().and_then(|d| d.filter_halo);
            self.filter = wanted.unwrap_or_else(|| FilterHalo::choose(reach, narrowest, workers));
            let deeper = match self.filter {
                FilterHalo::Exchange => 0,
                FilterHalo::Deep => reach.deeper(),
            };
            let (rank, ghosts) = (self.comm.rank(), reach.cells() + deeper);
            self.rows = RowExchange::new(&self.layout, rank, ghosts, 1);
            self.nodes = NodeExchange::new(&self.layout, rank, reach.halo());
            let mine = self.layout.patches_of(rank);
            for (patch, index) in self.patches.iter_mut().zip(mine) {
                let (depth, fields) = (reach.depth(ghosts), self.stepper.fields.count);
                patch.nodes = NodeArrays::new(&self.layout, index, depth, fields);
                patch.deeper = deeper;
            }
        }
        let limit = self.stepper.longest_within(reach);
        self.patches.iter_mut().for_each(|p| p.reach_length = limit);
    }

    /// The step's first fault, the same for any layout, at rank 0. Collective.
    fn gather_fault(&self) -> RunError {
        let faults = self.patches.iter().filter_map(|p| p.told.fault.as_ref());
        let mut words = Vec::new();
        if let Some(fault) = faults.min_by_key(|f| f.order()) {
            words.extend(fault.order());
            words.extend([fault.position.to_bits(), fault.body as u64]);
            words.extend(fault.what.bytes().map(u64::from));
        }
        let all = self.comm.gather(&words);
        match all.iter().filter(|w| !w.is_empty()).min_by_key(|w| &w[..3]) {
            Some(w) => RunError::Particle {
                id: w[2],
                body: self.scene.scene.bodies[w[4] as usize].name.clone(),
                position: f64::from_bits(w[3]) + self.grid_velocity * self.time,
                time: self.time,
                step: self.step,
                what: String::from_utf8_lossy(&w[5..].iter().map(|&b| b as u8).collect::<Vec<_>>())
                    .into_owned(),
            },
            None => RunError::Elsewhere,
        }
    }

    /// One step, the last one before `until` [s] shortened to meet it exactly; the step after is
    /// as long as if it had not been. Collective.
    pub fn advance(&mut self, until: f64) -> Result<(), RunError> {
        let left = until - self.time;
        let stable = self.dt;
        // a remainder below rounding of the time is no step of its own
        let meets = stable * (1.0 + 1e-9) >= left;
        let dt = if meets { left } else { stable };
        let (end, step) = (self.scene.scene.time.end, self.step);
        if dt * MOST_STEPS < end && !meets {
            return Err(match step {
                0 => RunError::TooLong { end, dt, steps: MOST_STEPS },
                _ => RunError::TimeStep { time: self.time, step, dt },
            });
        }
        self.step += 1;
        let step = self.step;
        self.with_world(|stepper, world| stepper.advance(world, dt, step))?;
        self.time = if meets { until } else { self.time + dt };
        self.agree()
    }
}
