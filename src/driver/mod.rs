//! A run with its files: steps, checkpoints, profiles, histories, errors, pictures, summary.
//!
//! All ranks compute; rank 0 gathers, evaluates errors and writes.

pub mod checkpoint;
pub mod default_folder;
pub mod fields;
pub mod figures;
mod measured;
pub mod output;
pub mod probes;
pub mod progress;
pub mod rank_statistics;
mod readings;
pub mod recorder;

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicU8;
use std::time::Instant;

use decomp::{Comm, StoredParticles};

use crate::accuracy::estimate::{self, Answer, Laws, coarse_runs};
use crate::accuracy::plan;
use crate::accuracy::reference::ReferenceSolution;
use crate::driver::checkpoint::schedule::Stop;
use crate::driver::checkpoint::{
    Checkpoint, CheckpointError, CheckpointSchedule, StateColumn, folder,
};
use crate::driver::output::OutputError;
use crate::driver::output::brief::brief;
use crate::driver::output::csv::{profile_names, write_profile};
use crate::driver::output::field_files::{FIELDS_FILE, FIELDS_FOLDER};
use crate::driver::output::folder::{OutputFolder, checkpoint_folder};
use crate::driver::output::gauges;
use crate::driver::output::histories::HISTORIES_FILE;
use crate::driver::output::origin::Maker;
use crate::driver::output::report::full;
use crate::driver::output::shared_file::agree;
use crate::driver::output::summary::{
    Energy, FailureSummary, Momentum, OutflowSummary, ProfileSummary, SUMMARY_FORMAT, Summary,
};
use crate::driver::output::trace::write_trace;
use crate::driver::output::unfinished::{self, unfinished_folder};
use crate::driver::output::vtkhdf::{RESULTS_FILE, RunInfo, write_vtkhdf};
use crate::driver::progress::{Progress, ProgressChoice};
use crate::driver::readings::{gauge_readings, report_readings};
use crate::driver::recorder::{Mark, Recorder, most_particles};
use crate::effects::ledger;
use crate::plot::PictureError;
use crate::scene::{CheckedScene, SideProperties};
use crate::simulation::{BoundaryWork, Removed, RunError, Simulation, Totals};
use crate::simulation::{Compiled, ParticleTable};
use crate::solver::Stepper;
use crate::solver::clock::{Activity, user_cpu_seconds};

/// Reason why a run has no result.
#[derive(Debug, thiserror::Error)]
pub enum RunFailure {
    /// Failure of the simulation.
    #[error(transparent)]
    Run(#[from] RunError),
    /// Failure of the simulation after which the last good state was written, if possible. All
    /// ranks know it.
    #[error("{error}; {next}")]
    Alarm {
        /// Reason for the end.
        error: Box<RunError>,
        /// Where to restart from.
        next: String,
    },
    /// Failure to write results.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// Failure to write pictures.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// Failure to read or write checkpoints.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// The run was stopped on request and can be restarted; this is no failure. All ranks know it.
    #[error("stopped at time {time:.6e} s, step {step}: {why}; {next}")]
    Stopped {
        /// Source of the request.
        why: String,
        /// Time [s].
        time: f64,
        /// Number of steps.
        step: u64,
        /// How to restart.
        next: String,
    },
}

/// Start of a run.
pub enum Beginning {
    /// The initial state of its scene.
    Scene,
    /// A checkpoint that fits the scene.
    Checkpoint(Box<Checkpoint>),
}

/// Options of a run.
#[derive(Clone, Debug)]
pub struct Options {
    /// Folder of the results.
    pub output: PathBuf,
    /// Whether an earlier result must not be replaced.
    pub keep: bool,
    /// Whether only errors are printed.
    pub quiet: bool,
    /// When rank 0 shows the progress; never if `quiet`.
    pub progress: ProgressChoice,
    /// Whether the report at the end has the errors of all profiles, the effects and the ranks.
    pub verbose: bool,
    /// Threads per rank.
    pub threads: usize,
    /// File of the timeline, and the range of its steps.
    pub trace: Option<(PathBuf, Range<u64>)>,
    /// Start time of the process.
    pub started: Instant,
    /// Number of a signal that requests an end; 0: none.
    pub signal: Arc<AtomicU8>,
}

/// Steps to the end time, recording and writing checkpoints. Returns the bytes that this rank has
/// received for these outputs. Collective.
fn step_to_end<const D: usize>(
    simulation: &mut Simulation<'_, D>,
    scene: &CheckedScene,
    comm: &dyn Comm,
    options: &Options,
    recorder: &mut Recorder<'_>,
    schedule: &mut CheckpointSchedule,
    unfinished: &Path,
) -> Result<u64, RunFailure>
where
    Stepper<D>: Compiled<D>,
{
    let end = scene.scene.time.end;
    let first = comm.rank() == 0;
    let shown = if first && !options.quiet { options.progress } else { ProgressChoice::Never };
    let mut progress = Progress::new([simulation.time(), end], shown);
    // the start and the restart state need no checkpoint
    let mut fresh = true;
    let mut mark = recorder.mark();
    let mut bytes_received = 0;
    loop {
        let time = simulation.time();
        let (start, before) = (Instant::now(), comm.traffic());
        // a checkpoint already contains the records of its own step
        let resumed = fresh && simulation.steps() > 0;
        if !resumed {
            recorder.record(simulation, first);
            recorder.record_fields(simulation, comm, unfinished)?;
        }
        if simulation.held_at().1 == simulation.steps() {
            mark = recorder.mark();
        }
        let asked = simulation.asked();
        if !fresh && schedule.is_due(time, simulation.steps(), asked) {
            write_checkpoint(simulation, comm, scene, options, recorder, schedule)?;
        }
        fresh = false;
        let traffic = comm.traffic();
        bytes_received += traffic.bytes_received - before.bytes_received;
        let waited = traffic.waited - before.waited;
        simulation.clock().add(Activity::Wait, waited);
        simulation.clock().add_since(Activity::Output, start, waited);
        if time >= end {
            break;
        }
        if let Some(stop) = CheckpointSchedule::stops(asked) {
            drop(progress);
            return Err(stopped(stop, time, simulation.steps(), options, schedule));
        }
        simulation.ask(schedule.asks(first));
        if let Err(error) = simulation.advance(recorder.next_profile()) {
            drop(progress);
            if !error.is_known_to_all() {
                return Err(error.into());
            }
            let next =
                save_last_good(simulation, comm, scene, options, (recorder, &mark), schedule);
            return Err(RunFailure::Alarm { error: Box::new(error), next });
        }
        progress.show(simulation.time(), simulation.steps());
    }
    Ok(bytes_received)
}

/// Writes the last state that has passed the monitor; returns how to restart from it. Collective.
fn save_last_good<const D: usize>(
    simulation: &Simulation<'_, D>,
    comm: &dyn Comm,
    scene: &CheckedScene,
    options: &Options,
    (recorder, mark): (&Recorder<'_>, &Mark),
    schedule: &CheckpointSchedule,
) -> String {
    let (time, step) = simulation.held_at();
    if step == 0 {
        return "no state but the start has passed the monitor".into();
    }
    if schedule.keep == 0 {
        return "no state was written, for output.checkpoint.keep is 0".into();
    }
    let saved = simulation.last_good();
    let text = serde_json::to_string(&scene.scene).expect("a scene is plain data");
    let columns = state_columns(simulation);
    let histories = recorder.histories_at(mark);
    let contents = recorder.contents_at(mark, histories.as_ref(), &text, &saved, &columns);
    let folder = checkpoints_of(comm, options).map_err(CheckpointError::from);
    match folder.and_then(|folder| folder::write(comm, &folder, schedule.keep, &contents)) {
        Ok(path) => format!(
            "the last good state, time {time:.6e} s, step {step}, is in {}: continue with --restart, \
             and --set time or monitor",
            path.display()
        ),
        Err(error) => format!("the last good state could not be written: {error}"),
    }
}

/// The columns of the particles in a checkpoint.
fn state_columns<const D: usize>(simulation: &Simulation<'_, D>) -> Vec<StateColumn> {
    let all = simulation.columns();
    let of = |k: &usize| StateColumn {
        name: all.specs[*k].name.into(),
        unit: all.specs[*k].unit.into(),
    };
    all.state().iter().map(of).collect()
}

/// Writes a checkpoint. Collective.
fn write_checkpoint<const D: usize>(
    simulation: &Simulation<'_, D>,
    comm: &dyn Comm,
    scene: &CheckedScene,
    options: &Options,
    recorder: &Recorder<'_>,
    schedule: &mut CheckpointSchedule,
) -> Result<(), RunFailure> {
    let start = Instant::now();
    let saved = simulation.save();
    let text = serde_json::to_string(&scene.scene).expect("a scene is plain data");
    let columns = state_columns(simulation);
    let contents = recorder.contents(&text, &saved, &columns);
    let folder = checkpoints_of(comm, options)?;
    folder::write(comm, &folder, schedule.keep, &contents)?;
    schedule.written(start.elapsed());
    Ok(())
}

/// The folder of the checkpoints, which rank 0 knows. Collective.
fn checkpoints_of(comm: &dyn Comm, options: &Options) -> Result<PathBuf, OutputError> {
    let first = comm.rank() == 0;
    agree(comm, if first { checkpoint_folder(&options.output) } else { Ok(PathBuf::new()) })
}

/// The failure that describes an early end.
fn stopped(
    stop: Stop,
    time: f64,
    step: u64,
    options: &Options,
    schedule: &CheckpointSchedule,
) -> RunFailure {
    let why = match stop {
        Stop::WallLimit => "time.wall_limit is over".to_string(),
        Stop::Signal(signal) => format!("signal {signal} came"),
    };
    let next = match checkpoint_folder(&options.output) {
        Ok(folder) if schedule.keep > 0 => format!("continue with --restart {}", folder.display()),
        _ => "no checkpoint was written, for output.checkpoint.keep is 0".to_string(),
    };
    RunFailure::Stopped { why, time, step, next }
}

/// Runs a scene and writes its results; returns the final table at rank 0. Collective.
///
/// # Errors
///
/// If the simulation fails, if a file cannot be read or written, or if the run is stopped.
pub fn run(
    comm: &dyn Comm,
    scene: &CheckedScene,
    options: &Options,
    beginning: Beginning,
) -> Result<Option<String>, RunFailure> {
    match scene.dimension {
        1 => run_in::<1>(comm, scene, options, beginning),
        _ => run_in::<2>(comm, scene, options, beginning),
    }
}

/// Runs a scene in `D` dimensions.
fn run_in<const D: usize>(
    comm: &dyn Comm,
    scene: &CheckedScene,
    options: &Options,
    beginning: Beginning,
) -> Result<Option<String>, RunFailure>
where
    Stepper<D>: Compiled<D>,
{
    // coarse runs, from which the errors of this run are estimated
    let estimated = scene.estimated_body();
    let companions = match estimated {
        Some(body) => Some(coarse_runs::run(comm, scene, body, options.threads)?),
        None => None,
    };
    let mut simulation = Simulation::<D>::new(scene, comm, options.threads)?;
    let start = simulation.totals();
    if let Some((_, steps)) = &options.trace {
        simulation.trace(steps.clone());
    }
    let mut recorder = Recorder::new(scene, &simulation);
    if let Some((body, companions)) = estimated.zip(companions.as_ref()) {
        recorder.arrivals = coarse_runs::arrivals(comm, scene, body, companions);
    }
    let continues = matches!(beginning, Beginning::Checkpoint(_));
    if let Beginning::Checkpoint(mut checkpoint) = beginning {
        agree(comm, checkpoint.fit_share(scene))?;
        simulation.restore(&checkpoint.saved)?;
        checkpoint.saved.particles = StoredParticles::default();
        recorder.resume(*checkpoint, simulation.time());
    }
    let unfinished = match recorder.fields.is_some() && comm.rank() == 0 {
        true => unfinished::begin(&options.output, &recorder.origin, continues),
        false => Ok(PathBuf::new()),
    };
    let unfinished = agree(comm, unfinished)?;
    recorder.open_fields(comm, &unfinished, continues.then_some(simulation.time()))?;
    let (now, signal) = (simulation.time(), options.signal.clone());
    let mut schedule = CheckpointSchedule::new(scene, now, options.started, signal);
    let before = comm.traffic();
    let (loop_start, loop_cpu) = (Instant::now(), user_cpu_seconds());
    let stepped = step_to_end(
        &mut simulation,
        scene,
        comm,
        options,
        &mut recorder,
        &mut schedule,
        &unfinished,
    );
    let output_bytes = match stepped {
        Ok(bytes) => bytes,
        Err(failure) => {
            let recorded = (&mut recorder, &simulation);
            return Err(leave_records(comm, scene, options, recorded, failure));
        }
    };
    let loop_wall_seconds = loop_start.elapsed().as_secs_f64();
    let loop_cpu = user_cpu_seconds() - loop_cpu;
    let (end, ways, given) = (simulation.totals(), simulation.ways(), simulation.given());
    let sharing = &scene.scene.decomposition;
    let decomposition = rank_statistics::decomposition(
        comm,
        &mut simulation,
        sharing,
        loop_wall_seconds,
        loop_cpu,
        output_bytes,
        before,
    );
    let shares = rank_statistics::step_shares(comm, &simulation);
    let (stretched, energy_change) = (simulation.stretched(), simulation.energy_change());
    if let Some((path, _)) = &options.trace {
        let events = rank_statistics::timeline(comm, &mut simulation);
        if comm.rank() == 0 {
            write_trace(path, &events)?;
        }
    }
    let spent = comm.gather(&[loop_cpu.to_bits(), user_cpu_seconds().to_bits()]);
    let Some(decomposition) = decomposition else { return Ok(None) };
    let seconds = |rank: &[u64], k: usize| f64::from_bits(rank[k]);
    let loop_cpu: f64 = spent.iter().map(|r| seconds(r, 0)).sum();
    // a run shorter than the clock's tick has no CPU time
    let loop_cpu = if loop_cpu > 0.0 { loop_cpu } else { loop_wall_seconds };
    let others_cpu: f64 = spent.iter().skip(1).map(|r| seconds(r, 1)).sum();

    // a run without an exact solution still writes its files
    let mut warnings = scene.warnings.clone();
    let reference = ReferenceSolution::new(scene).unwrap_or_else(|error| {
        warnings.push(format!("no exact solution: {error}"));
        None
    });
    if let Some(ReferenceSolution::Impact(all)) = &reference
        && let Some((time, why)) = &all.solution.stopped
    {
        warnings.push(format!("the exact solution ends at {time:.4e} s, before the run: {why}"));
    }
    // the other ranks wait for this rank at the end
    comm.heartbeat();
    let maker = Maker::with(recorder.origin.clone(), scene);
    let folder = OutputFolder::create(&options.output, options.keep, &maker)?;
    let profiles = write_profiles(comm, scene, reference.as_ref(), &recorder, folder.path())?;
    let as_run = serde_json::to_value(&scene.scene).expect("a scene is plain data");
    if scene.scene.output.hdf5 {
        let bodies: Vec<String> = scene.scene.bodies.iter().map(|b| b.name.clone()).collect();
        let tables: Vec<&ParticleTable> = recorder.tables.iter().map(|t| &t.0).collect();
        let info = RunInfo {
            title: &scene.scene.title,
            scene: &as_run,
            materials: tables.first().map_or(&[], |t| &t.materials),
            bodies: &bodies,
            axisymmetric: scene.axisymmetric(),
        };
        write_vtkhdf(&folder.file(RESULTS_FILE), &tables, &info)?;
        comm.heartbeat();
    }
    if let Some(histories) = recorder.histories() {
        histories.write(&folder.file(HISTORIES_FILE))?;
    }
    if scene.scene.output.pictures {
        draw(comm, scene, reference.as_ref(), &recorder, &profiles, folder.path())?;
    }
    let tables: Vec<&ParticleTable> = recorder.tables.iter().map(|t| &t.0).collect();
    let histories = recorder.histories();
    let measured = measured::quantities(scene, reference.as_ref(), &profiles, &tables, histories);
    let gauges = gauge_readings(scene, &recorder, &simulation);
    let error_estimate = estimated.zip(companions.as_ref()).map(|(body, companions)| {
        let tables = recorder.tables.iter().map(|t| &t.0).collect();
        let (arrivals, steps) = (&recorder.arrivals, simulation.steps());
        let reference = reference.as_ref();
        let answer = Answer { scene, body, tables, arrivals, steps, reference };
        let mut estimates = estimate::estimate(&answer, companions, &Laws::shipped());
        for (estimate, profile) in estimates.profiles.iter_mut().zip(&profiles) {
            estimate.l1.exact = profile.error("l1");
        }
        estimates
    });
    let plan = scene.scene.output.plan.as_ref().map(|planned| {
        let seconds = [loop_cpu, loop_wall_seconds];
        let exact_l1: Vec<f64> = profiles.iter().filter_map(|p| p.error("l1")).collect();
        plan::verdict(planned, &exact_l1, error_estimate.as_ref(), seconds)
    });
    let times = [0.0, simulation.time()];
    let left = ways.outflow.and(&ways.erosion);
    let rounding = simulation.rounding_energy();
    let (energy, momentum) = balance(scene, times, [&start, &end], &left, &given, rounding);
    let lets_out = scene.has_side(|side| side.lets_out);
    warnings.extend(inaccurate(energy_change, stretched, simulation.tally().redone_steps));
    warnings.extend(simulation.peaks().warnings());
    warnings.extend(simulation.profile_block(most_particles(scene)).map(|edge| {
        format!(
            "the profiles hold means over blocks of {edge} cells along each edge, for the scene has \
             more particles than output.profiles.max_particles"
        )
    }));
    let particle_steps = scene.particles as f64 * simulation.steps_made() as f64;
    let layout = simulation.layout();
    let summary = Summary {
        format: SUMMARY_FORMAT,
        title: scene.scene.title.clone(),
        version: env!("CARGO_PKG_VERSION").into(),
        origin: Some(folder.origin()),
        scene: as_run,
        method_choice: scene.method_choice.clone(),
        ranks: comm.size(),
        threads: options.threads,
        patches: layout.parts().to_vec(),
        particles: scene.particles,
        cells: scene.cell_count(),
        steps: simulation.steps(),
        wall_seconds: options.started.elapsed().as_secs_f64(),
        loop_wall_seconds,
        loop_cpu_seconds: loop_cpu,
        cpu_seconds: user_cpu_seconds() + others_cpu,
        particle_steps_per_cpu_second: particle_steps / loop_cpu,
        phase_seconds: decomposition.seconds(),
        decomposition,
        effects: ledger(scene, simulation.columns(), shares.as_deref()),
        energy,
        momentum,
        outflow: lets_out.then(|| gone(&ways.outflow)),
        erosion: scene.erodes().then(|| gone(&ways.erosion)),
        failure: simulation.columns().may_fail().then_some(FailureSummary {
            particles: end.failed,
            damaged: end.damaged,
            released_energy: end.released,
        }),
        measured,
        gauges,
        profiles,
        error_estimate,
        plan,
        warnings,
    };
    summary.write(folder.path())?;
    let unfinished = unfinished_folder(&options.output)?;
    unfinished::finish(&unfinished, folder.path(), &[FIELDS_FILE, FIELDS_FOLDER])?;
    let place = folder.commit()?;
    if schedule.passing {
        folder::clear(&checkpoint_folder(&options.output)?);
    }
    let text = if options.verbose { full } else { brief };
    let shown = report_readings(scene, &summary.gauges, options.verbose);
    Ok(Some(text(&summary, &place) + &gauges::report(&shown)))
}

/// Leaves the profiles and histories of a run that has failed or was stopped, with a picture of its
/// last profile, in the folder of the unfinished run; a run that was stopped adds its last state. The
/// failure names the folder. Collective.
fn leave_records<const D: usize>(
    comm: &dyn Comm,
    scene: &CheckedScene,
    options: &Options,
    (recorder, simulation): (&mut Recorder<'_>, &Simulation<'_, D>),
    failure: RunFailure,
) -> RunFailure
where
    Stepper<D>: Compiled<D>,
{
    match &failure {
        RunFailure::Stopped { .. } => recorder.add_profile(simulation),
        RunFailure::Alarm { .. } => {}
        _ => return failure,
    }
    if comm.rank() != 0 || recorder.tables.is_empty() {
        return failure;
    }
    let write = || -> Result<PathBuf, RunFailure> {
        let folder = unfinished::begin(&options.output, &recorder.origin, true)?;
        let profiles = write_profiles(comm, scene, None, recorder, &folder)?;
        if let Some(histories) = recorder.histories() {
            histories.write(&folder.join(HISTORIES_FILE))?;
        }
        if scene.scene.output.pictures {
            draw(comm, scene, None, recorder, &profiles, &folder)?;
        }
        Ok(folder)
    };
    let left = match write() {
        Ok(folder) => format!("; its records are in {}", folder.display()),
        Err(error) => format!("; its profiles could not be written: {error}"),
    };
    match failure {
        RunFailure::Stopped { why, time, step, next } => {
            RunFailure::Stopped { why, time, step, next: next + &left }
        }
        RunFailure::Alarm { error, next } => RunFailure::Alarm { error, next: next + &left },
        other => other,
    }
}

/// Drift of energy above which a run reports that it is inaccurate [-].
const DRIFT_TOLD: f64 = 0.01;

/// Warnings about the accuracy of a run that has ended normally, one line each.
fn inaccurate(energy_change: f64, stretched: u64, redone: u64) -> Vec<String> {
    let drift = (energy_change.abs() > DRIFT_TOLD).then(|| {
        format!(
            "energy has drifted by {:+.2} % of what the bodies bring: the scheme does not keep it, and shocks are wrong \
             with it; method.stepping \"midpoint\" with method.energy \"compatible\" and \
             method.filter_heat keep it to rounding",
            100.0 * energy_change
        )
    });
    let stretched = (stretched > 0).then(|| {
        format!(
            "{stretched} particles fill more than a cell each, further than the shape function \
             takes them to reach: gaps may have opened between them; more particles a cell, or \
             method.shape \"cpdi_bspline_quadratic\""
        )
    });
    let redone = (redone > 0).then(|| {
        format!(
            "{redone} times a step was redone half as long, as monitor.on_alarm = \"redo\" asks"
        )
    });
    drift.into_iter().chain(stretched).chain(redone).collect()
}

/// Writes each profile and evaluates its errors.
fn write_profiles(
    comm: &dyn Comm,
    scene: &CheckedScene,
    reference: Option<&ReferenceSolution>,
    recorded: &Recorder<'_>,
    folder: &Path,
) -> Result<Vec<ProfileSummary>, RunFailure> {
    let times: Vec<f64> = recorded.tables.iter().map(|(table, _)| table.time).collect();
    let names = match times.iter().all(|time| scene.profile_times.contains(time)) {
        // the same names whether or not the run has ended
        true => profile_names(&scene.profile_times),
        false => profile_names(&times),
    };
    let mut profiles = Vec::new();
    for (k, ((table, digest), file)) in recorded.tables.iter().zip(names).enumerate() {
        write_profile(&folder.join(&file), table)?;
        let as_json = |e| serde_json::to_value(e).expect("errors are plain data");
        let (errors, errors_cell_averaged) = match reference {
            Some(ReferenceSolution::Plane(plane)) => {
                (plane.score(scene, table, recorded.start.as_ref()), None)
            }
            _ => match reference.and_then(|r| r.score(scene, k, table)) {
                Some((raw, cell)) => (Some(as_json(raw)), Some(as_json(cell))),
                None => (None, None),
            },
        };
        profiles.push(ProfileSummary {
            time: table.time,
            file,
            state_sha256: digest.clone(),
            errors,
            errors_cell_averaged,
        });
        comm.heartbeat();
    }
    Ok(profiles)
}

/// Draws all pictures of a run.
fn draw(
    comm: &dyn Comm,
    scene: &CheckedScene,
    reference: Option<&ReferenceSolution>,
    recorded: &Recorder<'_>,
    profiles: &[ProfileSummary],
    folder: &Path,
) -> Result<(), PictureError> {
    if let (1, Some(ReferenceSolution::Impact(all))) = (scene.dimension, reference) {
        let bodies = [all.flyer, all.target];
        figures::draw_hugoniots(scene, bodies, &all.impact, &all.chain, folder)?;
    }
    for (k, ((table, _), profile)) in recorded.tables.iter().zip(profiles).enumerate() {
        let mut notes = Vec::new();
        if let Some(l1) = profile.error("l1") {
            notes.push(format!("L1 {:.2} % of the true solution", 100.0 * l1));
        }
        if let Some(plateau) = profile.error("plateau") {
            notes.push(format!("plateau {:+.3} %", 100.0 * plateau));
        }
        let stem = Path::new(&profile.file).with_extension("");
        if scene.dimension > 1 {
            let name = stem.to_string_lossy();
            figures::draw_fields(scene, table, &notes, &name, folder)?;
            if let Some(reference) = reference {
                let along = folder.join(name.replace("profile", "along"));
                figures::draw_along(scene, reference, k, table, notes, &along)?;
            }
            comm.heartbeat();
            continue;
        }
        let stem = stem.to_string_lossy();
        let place = (folder, stem.trim_start_matches("profile_"));
        figures::draw_profile(scene, reference, k, table, notes, place)?;
        comm.heartbeat();
    }
    if scene.dimension > 1 {
        return Ok(());
    }
    let stem = folder.join("x_t_diagram");
    let (rows, bodies) = (&recorded.waves, &recorded.bodies);
    figures::draw_run_waves(scene, rows, bodies, reference, &stem)?;
    comm.heartbeat();
    if let Some(histories) = recorded.histories() {
        figures::draw_histories(scene, histories, reference, &folder.join("histories"))?;
    }
    Ok(())
}

/// Energy and momentum at start and end, with the contributions of sides and outflows.
///
/// The impulse of a wall is the change of the particles' momentum, because no other external force
/// acts on them. The work of a piston is its velocity times its impulse; if the piston changes its
/// velocity, the work follows from the frame of the grid. Contributions of transmitting sides,
/// pressures and wall friction are summed during the run.
fn balance<const D: usize>(
    scene: &CheckedScene,
    times: [f64; 2],
    [start, end]: [&Totals<D>; 2],
    left: &Removed<D>,
    given: &BoundaryWork<D>,
    rounding: f64,
) -> (Energy, Momentum) {
    let sides = scene.side_properties::<D>();
    let rigid = |a: usize| sides[a].iter().any(SideProperties::is_rigid);
    let holds = scene.has_side(|side| side.no_slip);
    // along a radius, momentum is not a conserved sum
    let booked = |a: usize| rigid(a) || holds || (a == 0 && scene.axisymmetric());
    let walls: [f64; D] = std::array::from_fn(|a| match booked(a) {
        true => {
            let all = end.momentum[a] + left.momentum[a] - start.momentum[a];
            all - end.body_force_impulse[a]
        }
        false => given.impulse[a],
    });
    let impulse: [f64; D] = std::array::from_fn(|a| walls[a] - left.momentum[a]);
    let frame = scene.frame::<D>();
    let pistons = if frame.accelerates() {
        let ahead = |k: usize, t: &Totals<D>| frame.energy_ahead(times[k], t.mass, &t.momentum);
        ahead(1, end) - ahead(0, start)
    } else {
        let velocity = frame.velocity(0.0);
        (0..D).map(|a| velocity[a] * walls[a]).sum::<f64>()
    };
    let work = pistons + given.work + end.conducted - (left.kinetic + left.internal);
    let energy =
        Energy::new([start.kinetic, end.kinetic], [start.internal, end.internal], work, rounding);
    let momentum = Momentum::new(&start.momentum, &end.momentum, &impulse, start.absolute_momentum);
    match scene.scene.body_force {
        None => (energy, momentum),
        Some(_) => (
            energy.with_body_force(end.body_force_work, rounding),
            momentum.with_body_force(&end.body_force_impulse, start.absolute_momentum),
        ),
    }
}

/// Summary of the particles removed in one way.
fn gone<const D: usize>(left: &Removed<D>) -> OutflowSummary {
    OutflowSummary {
        particles: left.count,
        mass: left.mass,
        momentum: left.momentum.to_vec(),
        energy: left.kinetic + left.internal,
    }
}
