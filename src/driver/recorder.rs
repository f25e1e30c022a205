//! Records of a run: histories, rows of the x-t diagram, profiles.

use std::path::Path;

use decomp::Comm;

use crate::accuracy::estimate::Arrivals;
use crate::accuracy::reference::PlaneReference;
use crate::driver::checkpoint::{Checkpoint, CheckpointContents, Due, StateColumn};
use crate::driver::fields::FieldSeries;
use crate::driver::figures::{DiagramQuantity, WaveRow};
use crate::driver::output::OutputError;
use crate::driver::output::histories::HistoryTable;
use crate::driver::output::origin::{Origin, RUN};
use crate::driver::probes::Probes;
use crate::scene::CheckedScene;
use crate::simulation::{BodyRow, ParticleTable, TableColumn, quantity_of};
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
    /// Fields, if the scene asks for them; on all ranks.
    pub fields: Option<FieldSeries<'a>>,
    /// Frames of the fields that the run had written before a restart.
    kept_frames: Option<u64>,
    /// Profiles and the digests of their states.
    pub tables: Vec<(ParticleTable, String)>,
    /// Profile at the start, if the error evaluation needs it.
    pub start: Option<ParticleTable>,
    /// Rows of the x-t diagrams.
    pub waves: Vec<WaveRow>,
    /// Quantities of the x-t diagrams besides the pressure.
    pub quantities: Vec<DiagramQuantity>,
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
    frames: u64,
}

impl<'a> Recorder<'a> {
    /// Creates the recorder of a run at its start. Collective.
    pub fn new<const D: usize>(scene: &'a CheckedScene, simulation: &Simulation<'_, D>) -> Self {
        let needs_start = PlaneReference::needs_start(scene);
        Recorder {
            scene,
            origin: Origin::new(RUN, Path::new(&scene.file)),
            probes: Probes::new(scene),
            fields: FieldSeries::new(scene),
            kept_frames: None,
            tables: Vec::new(),
            start: if needs_start {
                simulation.profile(most_particles(scene)).map(|(table, _)| table)
            } else {
                None
            },
            waves: Vec::new(),
            quantities: Vec::new(),
            bodies: Vec::new(),
            arrivals: Arrivals::default(),
            due_wave: 0,
            due_profile: 0,
        }
    }

    /// Continues at `time` [s] from a checkpoint.
    pub fn resume(&mut self, checkpoint: Checkpoint, time: f64) {
        self.origin = checkpoint.run_origin();
        let Checkpoint { due, record, .. } = checkpoint;
        let end = self.scene.scene.time.end;
        self.due_wave = if due.end == end { due.wave } else { wave_after(time, end) };
        self.due_profile = self.scene.profile_times.iter().filter(|&&t| t <= time).count();
        self.arrivals.resume(due.arrivals);
        self.kept_frames = Some(due.frames);
        (self.tables, self.waves, self.bodies) = (record.tables, record.waves, record.bodies);
        self.quantities = due.quantities;
        self.choose_quantities();
        if let Some(probes) = &mut self.probes {
            let same = due.history_interval == self.scene.history_interval;
            probes.resume(time, same.then_some(due.history), record.histories);
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
            let others = &self.scene.scene.output.diagrams;
            let wanted = |name: &str| {
                ["x", "pressure"].contains(&name) || others.iter().any(|q| q == quantity_of(name))
            };
            let columns = simulation.sample(stride, &wanted);
            let bodies = simulation.body_row(stride);
            if first {
                self.add_waves(time, columns);
                self.bodies.push(bodies);
            }
        }
        if self.scene.profile_times.get(self.due_profile) == Some(&time) {
            self.due_profile += 1;
            self.tables.extend(simulation.profile(most_particles(self.scene)));
        }
    }

    /// Adds a row of the x-t diagrams, of these columns. Called on rank 0.
    fn add_waves(&mut self, time: f64, mut columns: Vec<TableColumn>) {
        let mut taken = |quantity: &str| {
            // of a tensor the first component, which is that along x
            let found = columns.iter().position(|c| quantity_of(&c.name) == quantity);
            found.map(|k| columns.remove(k)).unwrap_or_default()
        };
        let mut row = WaveRow { time, x: taken("x").values, ..WaveRow::default() };
        row.pressure = taken("pressure").values;
        self.quantities.clear();
        for name in &self.scene.scene.output.diagrams {
            let column = taken(name);
            self.quantities.push(DiagramQuantity { name: name.clone(), unit: column.unit });
            row.others.push(column.values);
        }
        self.waves.push(row);
    }

    /// Puts the quantities of the rows of a checkpoint in the order of the scene, which may ask for
    /// others now.
    fn choose_quantities(&mut self) {
        let place = |name: &String| self.quantities.iter().position(|q| q.name == *name);
        let places: Vec<Option<usize>> =
            self.scene.scene.output.diagrams.iter().map(place).collect();
        for row in &mut self.waves {
            let values = |k: &Option<usize>| k.map_or(Vec::new(), |k| row.others[k].clone());
            row.others = places.iter().map(values).collect();
        }
        let unit = |k: Option<usize>| k.map_or(String::new(), |k| self.quantities[k].unit.clone());
        let names = self.scene.scene.output.diagrams.iter().cloned();
        let chosen = names.zip(places).map(|(name, k)| DiagramQuantity { name, unit: unit(k) });
        self.quantities = chosen.collect();
    }

    /// Opens the files of the fields in `folder`; `restarted` is the time of a restart [s]. Collective.
    ///
    /// # Errors
    ///
    /// If they cannot be written; all ranks return an error.
    pub fn open_fields(
        &mut self,
        comm: &dyn Comm,
        folder: &Path,
        restarted: Option<f64>,
    ) -> Result<(), OutputError> {
        let kept = self.kept_frames.zip(restarted);
        match &mut self.fields {
            Some(fields) => fields.open(comm, self.scene, folder, kept),
            None => Ok(()),
        }
    }

    /// Writes a frame of the fields into `folder` if one is due. Collective.
    ///
    /// # Errors
    ///
    /// If it cannot be written; all ranks return an error.
    pub fn record_fields<const D: usize>(
        &mut self,
        simulation: &Simulation<'_, D>,
        comm: &dyn Comm,
        folder: &Path,
    ) -> Result<(), OutputError> {
        match &mut self.fields {
            Some(fields) => fields.record(simulation, comm, self.scene, folder),
            None => Ok(()),
        }
    }

    /// Adds a profile of the present time, unless it has one. Collective.
    pub fn add_profile<const D: usize>(&mut self, simulation: &Simulation<'_, D>) {
        let time = simulation.time();
        // the same on all ranks
        let recorded =
            self.due_profile.checked_sub(1).and_then(|k| self.scene.profile_times.get(k));
        if recorded != Some(&time) {
            self.tables.extend(simulation.profile(most_particles(self.scene)));
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

    /// All probes and gauges, if the scene asks for histories.
    pub fn probes(&self) -> Option<&Probes> {
        self.probes.as_ref()
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
            frames: self.fields.as_ref().map_or(0, FieldSeries::written),
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
            frames: mark.frames,
            quantities: self.quantities.clone(),
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

/// Largest number of particles of which a profile holds each, on a line and in a plane.
const MOST_PARTICLES: [u64; 2] = [1_000_000, 200_000];

/// Largest number of particles of which a profile of the scene holds each.
pub fn most_particles(scene: &CheckedScene) -> u64 {
    let most = scene.scene.output.profiles.max_particles;
    most.unwrap_or(MOST_PARTICLES[scene.dimension - 1])
}

/// The number of the first row of the x-t diagram that is due after `time`.
fn wave_after(time: f64, end: f64) -> u64 {
    (time / end * WAVE_ROWS as f64) as u64 + 1
}
