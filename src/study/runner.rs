//! Runs the cases of a study, each in a process of its own, and stores their results.

use std::fs;
use std::io::{IsTerminal, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use sha2::{Digest, Sha256};
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use signal_hook::low_level::emulate_default_handler;

use super::cases::{Case, cases, fits};
use super::convergence::compare;
use super::histories::CaseHistories;
use super::record::StudyRecord;
use super::spec::{Convergence, Study};
use super::{StudyError, StudyRow};
use crate::driver::output::summary::Summary;
use crate::input;

/// Runs the program and stores its results.
#[derive(Clone, Debug)]
pub struct StudyRunner {
    /// Path of the program.
    pub program: PathBuf,
    /// Folder for the results of the study.
    pub folder: PathBuf,
    /// Suppresses progress messages.
    pub quiet: bool,
}

/// Interval between checks of a running case.
const LOOK: Duration = Duration::from_millis(2);

/// A case with its scene and its record.
struct Job {
    case: Case,
    /// The resolved scene and the key of the record. The error is the message of the scene check.
    scene: Result<(String, String), String>,
    /// Particles times cells, to which the run time is proportional.
    weight: f64,
    record: StudyRecord,
}

impl Job {
    fn is_done(&self, repeats: usize) -> bool {
        self.record.failure.is_some() || self.record.seconds.len() >= repeats
    }
}

impl StudyRunner {
    /// Runs the missing cases; returns rows in the order of the cases.
    ///
    /// # Errors
    ///
    /// If the study is not valid, if a program cannot be started, or if a file cannot be written.
    pub fn run(&self, study: &Study) -> Result<Vec<StudyRow>, StudyError> {
        let records = self.folder.join("runs");
        fs::create_dir_all(&records).map_err(StudyError::io("cannot be made", &records))?;
        let mut jobs = self.jobs(study, &records)?;
        if let Some(Convergence { against, .. }) = &study.convergence
            && !jobs.iter().any(|job| fits(&job.case.labels, against))
        {
            return Err(StudyError::Study {
                file: study.title.clone(),
                reason: "convergence.against: no case has these labels".into(),
            });
        }
        let left = |jobs: &[Job], from: usize| -> f64 {
            let missing = |j: &Job| match j.is_done(study.repeats) {
                true => 0.0,
                false => j.weight * (study.repeats - j.record.seconds.len().max(from)) as f64,
            };
            jobs.iter().map(missing).sum()
        };
        let mut progress = StudyProgress::new(left(&jobs, 0), !self.quiet);
        // repeat the whole sweep, so that a slow period of the machine affects all cases alike
        for repeat in 0..study.repeats {
            for k in 0..jobs.len() {
                let job = &mut jobs[k];
                if job.is_done(study.repeats) || job.record.seconds.len() > repeat {
                    continue;
                }
                let Ok((scene, key)) = job.scene.clone() else { continue };
                match self.once(&job.case, &scene, &key, study)? {
                    Ended::Well(summary, histories) => job.record.add(&summary, histories),
                    Ended::Badly { reason, .. } => job.record.failure = Some(reason.clone()),
                }
                job.record.write(&records, &key)?;
                let name = job.case.labels.values().cloned().collect::<Vec<_>>().join(", ");
                progress.report(left(&jobs, 0), &name);
            }
        }
        progress.finish();
        let row = |job: Job| StudyRow {
            labels: job.case.labels,
            ranks: job.case.ranks,
            threads: job.case.threads,
            record: job.record,
            histories: None,
        };
        let mut rows: Vec<StudyRow> = jobs.into_iter().map(row).collect();
        if let Some(convergence) = &study.convergence {
            compare(convergence, &mut rows);
        }
        Ok(rows)
    }

    /// The cases with their stored records.
    fn jobs(&self, study: &Study, records: &Path) -> Result<Vec<Job>, StudyError> {
        let refused =
            |reason: String| StudyError::Study { file: study.scene.display().to_string(), reason };
        let bytes = input::read(&study.scene).map_err(|e| refused(e.to_string()))?;
        let version = self.version()?;
        let file = study.scene.display().to_string();
        let job = |case: Case| {
            let checked = case.scene(&bytes, &file);
            let weight =
                checked.as_ref().map_or(0.0, |c| c.particles as f64 * c.cell_count() as f64);
            let scene = checked.map(|c| {
                let text = serde_json::to_string_pretty(&c.scene).expect("a scene is plain data");
                (text, case.key(&c, &version))
            });
            let record = match &scene {
                Ok((_, key)) => StudyRecord::read(records, key)
                    .filter(|record| record.has_histories(study.convergence.as_ref()))
                    .unwrap_or_default(),
                Err(reason) => StudyRecord {
                    failure: Some(format!("refused: {reason}")),
                    ..StudyRecord::default()
                },
            };
            Job { case, scene, weight, record }
        };
        Ok(cases(study).into_iter().map(job).collect())
    }

    /// Version of the program: its number and a hash of its file, because results depend on the
    /// code.
    fn version(&self) -> Result<String, StudyError> {
        let bytes = fs::read(&self.program)
            .map_err(StudyError::io("the program cannot be read", &self.program))?;
        let digest: String =
            Sha256::digest(&bytes).iter().take(8).map(|b| format!("{b:02x}")).collect();
        Ok(format!("{} {digest}", env!("CARGO_PKG_VERSION")))
    }

    /// Runs a case once. A run that fails, also one that a signal ends, is recorded as failed.
    fn once(
        &self,
        case: &Case,
        scene: &str,
        key: &str,
        study: &Study,
    ) -> Result<Ended, StudyError> {
        let place = self.folder.join("running");
        fs::create_dir_all(&place).map_err(StudyError::io("cannot be made", &place))?;
        let (file, results) = (place.join(format!("{key}.json")), place.join(key));
        fs::write(&file, scene).map_err(StudyError::io("cannot be written", &file))?;
        let ended = self.wait(&mut self.command(case, &file, &results), study.limit_seconds);
        let outcome = match ended? {
            None => match Summary::read(&results) {
                Ok(summary) => match &study.convergence {
                    None => Ended::Well(Box::new(summary), None),
                    Some(convergence) => {
                        match CaseHistories::read(&results, &convergence.columns) {
                            Ok(histories) => Ended::Well(Box::new(summary), Some(histories)),
                            Err(reason) => Ended::Badly { reason },
                        }
                    }
                },
                Err(error) => Ended::Badly { reason: error.to_string() },
            },
            Some(reason) => Ended::Badly { reason },
        };
        let _ = fs::remove_dir_all(&place);
        Ok(outcome)
    }

    /// Command that runs a case.
    fn command(&self, case: &Case, file: &Path, results: &Path) -> Command {
        let mut command = match case.ranks {
            1 => Command::new(&self.program),
            ranks => {
                let mut mpirun = Command::new("mpirun");
                mpirun.args(["--oversubscribe", "--bind-to", "none"]);
                let cores = std::thread::available_parallelism().map_or(1, usize::from);
                if ranks * case.threads >= cores {
                    mpirun.args(["--mca", "mpi_yield_when_idle", "1"]);
                }
                mpirun.args(["-n", &ranks.to_string()]).arg(&self.program);
                mpirun
            }
        };
        command.arg(file).arg("--quiet").arg("--output").arg(results);
        command.args(["--threads", &case.threads.to_string()]);
        command
    }

    /// Waits for the end of a run; returns the reason if it failed.
    fn wait(&self, command: &mut Command, limit: f64) -> Result<Option<String>, StudyError> {
        let program = command.get_program().to_string_lossy().into_owned();
        let start = |source| StudyError::Start { program: program.clone(), source };
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
        let request = EndRequest::watch();
        let mut child = command.spawn().map_err(start)?;
        let started = Instant::now();
        let ended = loop {
            request.obey(&mut child);
            let status = child.try_wait().map_err(start)?;
            match status {
                Some(status) if status.success() => break None,
                Some(status) => {
                    let said = said(&mut child);
                    let line =
                        said.lines().find(|l| !l.trim().is_empty() && !l.starts_with("warning"));
                    let line = line.unwrap_or("no message").trim_start_matches("error: ");
                    break Some(format!("{status}: {line}"));
                }
                None if started.elapsed().as_secs_f64() > limit => {
                    let _ = child.kill();
                    let _ = child.wait();
                    break Some(format!("longer than limit_seconds = {limit}"));
                }
                None => std::thread::sleep(LOOK),
            }
        };
        request.idle.store(true, Ordering::SeqCst);
        Ok(ended)
    }
}

/// A request to end this process, while it waits for a run.
struct EndRequest {
    /// Number of the signal; 0: none.
    signal: Arc<AtomicUsize>,
    /// Whether a signal ends the process at once, as without a handler.
    idle: Arc<AtomicBool>,
}

impl EndRequest {
    /// The request of this process, for which signals are watched from now on.
    fn watch() -> &'static EndRequest {
        static REQUEST: OnceLock<EndRequest> = OnceLock::new();
        let request = REQUEST.get_or_init(|| {
            let request = EndRequest { signal: Arc::default(), idle: Arc::default() };
            for signal in [SIGTERM, SIGINT] {
                // without a handler, the signal ends the process as usual
                let _ = flag::register_conditional_default(signal, request.idle.clone());
                let _ = flag::register_usize(signal, request.signal.clone(), signal as usize);
            }
            request
        });
        request.idle.store(false, Ordering::SeqCst);
        request
    }

    /// Kills the run and ends this process, if a signal has come: the run would go on alone.
    fn obey(&self, child: &mut Child) {
        let signal = self.signal.load(Ordering::SeqCst);
        if signal != 0 {
            let _ = child.kill();
            let _ = child.wait();
            let _ = emulate_default_handler(signal as i32);
        }
    }
}

/// Error output of a finished run.
fn said(child: &mut Child) -> String {
    let mut text = String::new();
    if let Some(stderr) = &mut child.stderr {
        let _ = stderr.read_to_string(&mut text);
    }
    text
}

/// Outcome of a run.
enum Ended {
    Well(Box<Summary>, Option<CaseHistories>),
    Badly { reason: String },
}

/// Progress of a study: a bar on a terminal, else a line every ten seconds.
struct StudyProgress {
    bar: Option<ProgressBar>,
    whole: f64,
    started: Instant,
    reported: Instant,
    speaks: bool,
}

impl StudyProgress {
    fn new(whole: f64, speaks: bool) -> StudyProgress {
        let bar = (speaks && std::io::stderr().is_terminal()).then(|| {
            let bar = ProgressBar::new(1000);
            let style = "{bar:40} {percent:>3} %  {msg}";
            bar.set_style(ProgressStyle::with_template(style).expect("the template is sound"));
            bar
        });
        StudyProgress { bar, whole, started: Instant::now(), reported: Instant::now(), speaks }
    }

    /// Reports progress; `left` is the remaining part of the total weight.
    fn report(&mut self, left: f64, name: &str) {
        let share = if self.whole > 0.0 { 1.0 - left / self.whole } else { 1.0 };
        let seconds = self.started.elapsed().as_secs_f64() * (1.0 / share.max(1e-9) - 1.0);
        if let Some(bar) = &self.bar {
            bar.set_position((1000.0 * share) as u64);
            bar.set_message(format!("{seconds:.0} s left  {name}"));
        } else if self.speaks && self.reported.elapsed() > Duration::from_secs(10) {
            self.reported = Instant::now();
            eprintln!("{:5.1} %  {seconds:.0} s left  {name}", 100.0 * share);
        }
    }

    fn finish(self) {
        if let Some(bar) = self.bar {
            bar.finish_and_clear();
        }
    }
}
