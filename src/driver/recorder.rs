//! Records of a run: histories, rows of the x-t diagram, profiles.

use std::path::Path;

use decomp::Comm;

use crate::accuracy::estimate::Arrivals;
use crate::accuracy::reference::PlaneReference;
use crate::driver::checkpoint::{Checkpoint, CheckpointContents, Due, Record, StateColumn};
use crate::driver::figures::PressureRow;
use crate::driver::output::histories::HistoryTable;
use crate::driver::output::origin::{Origin, RUN};
use crate::driver::probes::Probes;
use crate::scene::CheckedScene;
use crate::simulation::{BodyRow, ParticleTable};
use crate::simulation::{Saved, Simulation};

/// Number of rows of the x-t diagram.
const WAVE_ROWS: u64 = 120;

/// Largest number of particles in a row of the x-t diagram.
const WAVE_POINTS: u64 = 2000;

/// Records of a run. Rank 0 holds all of them; the other ranks know what is due.
pub struct Recorder<'a> {
    scene: &'a CheckedScene,
    /// The command and the file of the original run, before any restart.
    pub origin: Origin,
    probes: Option<Probes>,
    /// Profiles and the digests of their states.
    pub tables: Vec<(ParticleTable, String)>,
    /// Particles at the start, if the error evaluation needs them.
    pub start: Option<ParticleTable>,
    /// Rows of the x-t diagram.
    pub waves: Vec<PressureRow>,
    /// Surfaces and failed parts of the bodies, at the times of `waves`.
    pub bodies: Vec<BodyRow>,
    /// Wave arrivals; empty unless the scene asks for them.
    pub arrivals: Arrivals,
    due_wave: u64,
    due_profile: usize,
}

/// Numbers of records at some time.
#[derive(Clone, Copy, Debug)]
pub struct Mark {
    tables: usize,
    waves: usize,
    histories: usize,
    due_history: u64,
    due_wave: u64,
}

impl<'a> Recorder<'a> {
    /// Creates the recorder of a run at its start. Collective.
    pub fn new<const D: usize>(scene: &'a CheckedScene, simulation: &Simulation<'_, D>) -> Self {
        let needs_start = PlaneReference::needs_start(scene);
        Recorder {
            scene,
            origin: Origin::new(RUN, Path::new(&scene.file)),
            probes: Probes::new(scene),
            tables: Vec::new(),
            start: if needs_start { simulation.gather().map(|(table, _)| table) } else { None },
            waves: Vec::new(),
            bodies: Vec::new(),
            arrivals: Arrivals::default(),
            due_wave: 0,
            due_profile: 0,
        }
    }

    /// Continues at `time` [s] from the checkpoint that rank 0 holds. Collective.
    #[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
    pub fn resume(&mut self, comm: &dyn Comm, checkpoint: Option<Checkpoint>, time: f64) {
        let sent = checkpoint
            .as_ref()
            .map_or(Vec::new(), |c| serde_json::to_vec(&c.due).expect("what is due is plain data"));
        let due: Due =
            serde_json::from_slice(&comm.broadcast(sent)).expect("rank 0 sends valid JSON");
        let end = self.scene.scene.time.end;
        self.due_wave = if due.end == end { due.wave } else { wave_after(time, end) };
        self.due_profile = self.scene.profile_times.iter().filter(|&&t| t <= time).count();
        self.arrivals.resume(due.arrivals);
        if let Some(checkpoint) = &checkpoint {
            self.origin = checkpoint.run_origin();
        }
        let Record { tables, waves, bodies, histories } =
            checkpoint.map_or_else(Record::default, |c| c.record);
        (self.tables, self.waves, self.bodies) = (tables, waves, bodies);
        if let Some(probes) = &mut self.probes {
            let same = due.history_interval == self.scene.history_interval;
            probes.resume(time, same.then_some(due.history), histories);
        }
    }

    /// Records everything that is due at this time. Collective.
    pub fn record<const D: usize>(&mut self, simulation: &Simulation<'_, D>, first: bool) {
        let (time, end) = (simulation.time(), self.scene.scene.time.end);
        if let Some(probes) = &mut self.probes {
            probes.sample(simulation);
        }
        self.arrivals.look(simulation);
        let draws = self.scene.scene.output.pictures && D == 1;
        if draws && time >= self.due_wave as f64 * end / WAVE_ROWS as f64 {
            self.due_wave = wave_after(time, end);
            let stride = self.scene.particles.div_ceil(WAVE_POINTS).max(1);
            let points = simulation.sample_pressure(stride);
            let bodies = simulation.body_row(stride);
            if first {
                self.waves.push(PressureRow { time, points });
                self.bodies.push(bodies);
            }
        }
        if self.scene.profile_times.get(self.due_profile) == Some(&time) {
            self.due_profile += 1;
            self.tables.extend(simulation.gather());
        }
    }

    /// Time of the next profile [s]; a step must end at it.
    pub fn next_profile(&self) -> f64 {
        self.scene.profile_times.get(self.due_profile).copied().unwrap_or(self.scene.scene.time.end)
    }

    /// The histories so far, if the scene asks for them.
    pub fn histories(&self) -> Option<&HistoryTable> {
        self.probes.as_ref().map(Probes::histories)
    }

    /// The contents of a checkpoint of the present state.
    pub fn contents<'b>(
        &'b self,
        scene: &'b str,
        saved: &'b Saved,
        columns: &'b [StateColumn],
    ) -> CheckpointContents<'b> {
        self.contents_at(&self.mark(), self.histories(), scene, saved, columns)
    }

    /// The present numbers of records.
    pub fn mark(&self) -> Mark {
        Mark {
            tables: self.tables.len(),
            waves: self.waves.len(),
            histories: self.histories().map_or(0, HistoryTable::len),
            due_history: self.probes.as_ref().map_or(0, Probes::due),
            due_wave: self.due_wave,
        }
    }

    /// The histories up to a mark, if the scene asks for them.
    pub fn histories_at(&self, mark: &Mark) -> Option<HistoryTable> {
        self.histories().map(|all| all.first(mark.histories))
    }

    /// The contents of a checkpoint of the state at a mark, with the `histories` up to it.
    pub fn contents_at<'b>(
        &'b self,
        mark: &Mark,
        histories: Option<&'b HistoryTable>,
        scene: &'b str,
        saved: &'b Saved,
        columns: &'b [StateColumn],
    ) -> CheckpointContents<'b> {
        let due = Due {
            history: mark.due_history,
            history_interval: self.scene.history_interval,
            wave: mark.due_wave,
            end: self.scene.scene.time.end,
            arrivals: self.arrivals.state(),
        };
        CheckpointContents {
            origin: Some(&self.origin),
            method_choice: self.scene.method_choice.as_ref(),
            scene,
            dimension: self.scene.dimension,
            saved,
            columns,
            due,
            tables: &self.tables[..mark.tables],
            waves: &self.waves[..mark.waves],
            bodies: &self.bodies[..mark.waves],
            histories,
        }
    }
}

/// The number of the first row of the x-t diagram that is due after `time`.
fn wave_after(time: f64, end: f64) -> u64 {
    (time / end * WAVE_ROWS as f64) as u64 + 1
}
