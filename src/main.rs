//! The program: arguments, scene, run, report.
//!
//! Rank 0 reads and checks the input and prints messages; all ranks end with the same verdict. A
//! failure that only one rank knows ends all ranks by MPI_Abort.

mod cli;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::time::{Duration, Instant};

use clap::Parser;
use clap::error::ErrorKind;
use cli::{Cli, Command, PerfCommand, RunArgs, SceneArgs};
use decomp::{Comm, Serial};
use flyer_mpm::driver::checkpoint::fit::CHANGEABLE;
use flyer_mpm::driver::checkpoint::{Checkpoint, folder};
use flyer_mpm::driver::default_folder::default_folder;
use flyer_mpm::driver::memory::check_memory;
use flyer_mpm::driver::output::OutputError;
use flyer_mpm::driver::output::compare::compare;
use flyer_mpm::driver::output::folder::check_writable;
use flyer_mpm::driver::output::lock::Lock;
use flyer_mpm::driver::output::origin::{Maker, Origin, RUN, check_target};
use flyer_mpm::driver::output::trace::TRACE_START;
use flyer_mpm::driver::output::wrap::{warning, wrapped};
use flyer_mpm::driver::{Beginning, Options, RunFailure, run};
use flyer_mpm::input;
use flyer_mpm::input::input_file;
use flyer_mpm::scene::CheckedScene;
use flyer_mpm::simulation::RunError;
use signal_hook::consts::{SIGINT, SIGTERM, SIGUSR1};
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;

/// Commit of the sources, if the build set it, as `scripts/run.sh` and `scripts/release.sh` do.
const COMMIT: Option<&str> = option_env!("FLYER_MPM_COMMIT");

/// The command line or the scene is wrong.
const BAD_INPUT: u8 = 2;
/// The run failed.
const FAILED: u8 = 3;
/// The run was stopped on request and can be restarted.
const STOPPED: u8 = 4;

/// Smallest allocation that gets pages of its own \[B\]: the largest value that every version of
/// glibc accepts with addresses of 64 bits.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const OWN_PAGES: i32 = 32 << 20;

/// Places the columns of particles and the nodal fields one after the other on the heap. With pages
/// of their own, all of them start at the same place of a page, so that the same particle of all
/// columns competes for the same few lines of the cache.
fn place_arrays() {
    // SAFETY: the call changes a parameter of the allocator, and no other thread runs yet
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    unsafe {
        nix::libc::mallopt(nix::libc::M_MMAP_THRESHOLD, OWN_PAGES);
    }
}

fn main() -> ExitCode {
    place_arrays();
    let started = Instant::now();
    let cli = Cli::try_parse();
    #[cfg(feature = "mpi")]
    if decomp::comm::mpi::Mpi::is_launched()
        && let Some(ranks) = decomp::comm::mpi::Mpi::start_within(stall_timeout(&cli))
    {
        return act(&ranks, started, cli);
    }
    act(&Serial, started, cli)
}

/// Time for which ranks wait for a rank that gives no sign of life.
#[cfg(feature = "mpi")]
fn stall_timeout(cli: &Result<Cli, clap::Error>) -> Duration {
    let seconds = cli.as_ref().ok().and_then(|cli| match (&cli.command, &cli.run) {
        (Some(Command::Perf(PerfCommand::Calibrate { stall_timeout, .. })), _) => {
            Some(*stall_timeout)
        }
        (_, run) => run.as_ref().map(|run| run.stall_timeout),
    });
    seconds.map_or(decomp::comm::STALL_TIMEOUT, Duration::from_secs_f64)
}

/// Executes the command line. Collective.
fn act(comm: &dyn Comm, started: Instant, cli: Result<Cli, clap::Error>) -> ExitCode {
    let first = comm.rank() == 0;
    if let Some(message) = mistyped() {
        if first {
            eprintln!("error: {message}");
        }
        return ExitCode::from(BAD_INPUT);
    }
    let cli = match cli {
        Ok(cli) => cli,
        Err(error) => {
            // clap reports help and version as errors too
            let asked = !error.use_stderr()
                || error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand;
            match asked {
                _ if !first => {}
                true => drop(error.print()),
                false => eprintln!("{}", in_one_line(&error)),
            }
            return ExitCode::from(if error.use_stderr() { BAD_INPUT } else { 0 });
        }
    };
    let outcome = match (cli.command, cli.run) {
        (None, Some(args)) => run_scene(comm, &args, started),
        (
            Some(Command::Perf(PerfCommand::Calibrate {
                scene,
                set,
                output,
                seconds,
                samples,
                stall_timeout,
            })),
            _,
        ) => {
            comm.set_stall_timeout(Duration::from_secs_f64(stall_timeout));
            let order = cli::predict::Order { scene, set, output, seconds, samples };
            cli::predict::calibrate(comm, &order)
        }
        // rank 0 alone executes the other commands
        _ if !first => Ok(()),
        (Some(command), _) => side_command(command),
        (None, None) => Err((BAD_INPUT, "a scene is needed; see --help".into())),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err((code, message)) => {
            if !message.is_empty() {
                eprintln!("error: {message}");
            }
            ExitCode::from(code)
        }
    }
}

/// Message for a first argument that is neither a file nor a command but resembles a command.
fn mistyped() -> Option<String> {
    let name = std::env::args_os().nth(1)?.into_string().ok()?;
    let known = cli::meant(&name)?;
    if name == known || Path::new(&name).exists() {
        return None;
    }
    Some(format!("{name}: no such scene or command; did you mean {known}?"))
}

/// The fault of a command line and its remedy, without the usage.
fn in_one_line(error: &clap::Error) -> String {
    let text = error.render().to_string();
    let text = text.split("\n\nUsage:").next().unwrap_or_default();
    let text = text.split("\n\nFor more").next().unwrap_or_default();
    // one of the tips is no remedy for a mistyped option
    let text = text.split("\n\n  tip: to pass ").next().unwrap_or_default();
    let words: Vec<&str> = text.split_whitespace().collect();
    format!("{}; see --help", words.join(" ").replace(" tip: ", "; "))
}

/// Prints to standard output; ignores a reader that has closed it, as `head` does.
fn say(text: &str) {
    let _ = std::io::stdout().write_all(text.as_bytes());
}

/// Result, or an exit code and one line of text; the line is empty if another rank prints it.
type Outcome<T> = Result<T, (u8, String)>;

fn bad(error: impl ToString) -> (u8, String) {
    (BAD_INPUT, error.to_string())
}

/// Reads and checks a scene on this rank. A scene whose check takes too much memory is refused before,
/// unless `ignore_memory` is set.
fn read_scene(args: &SceneArgs, ignore_memory: bool) -> Outcome<(Vec<u8>, CheckedScene)> {
    let bytes = input::read(&args.scene).map_err(bad)?;
    let name = args.scene.display().to_string();
    let available = input::available_memory().filter(|_| !ignore_memory);
    input::check_size(&bytes, &name, &args.set, available).map_err(bad)?;
    let checked = input::parse(&bytes, &name, &args.set).map_err(bad)?;
    Ok((bytes, checked))
}

/// Checks, before a run that ends with writing it, that a regular file can be written.
fn check_file(path: &Path) -> Outcome<()> {
    // opening a FIFO would wait for its reader
    input_file::check_kind(path).map_err(|fault| bad(format!("{}: {fault}", path.display())))?;
    let opened = std::fs::OpenOptions::new().create(true).append(true).open(path);
    opened
        .map(|_| ())
        .map_err(|e| (BAD_INPUT, format!("{}: cannot write the file: {e}", path.display())))
}

/// Start of a run, found and checked by rank 0.
struct Begun {
    /// Text of the scene, for the other ranks.
    bytes: Vec<u8>,
    checked: CheckedScene,
    beginning: Beginning,
    output: PathBuf,
    /// Held until the run has ended.
    lock: Lock,
}

/// Name of the input in messages.
fn input(args: &RunArgs) -> String {
    let path = args.restart.as_ref().or(args.scene.as_ref());
    path.map_or(String::new(), |path| path.display().to_string())
}

/// A checkpoint with its path, and lines about damaged ones.
type Found = (Checkpoint, PathBuf, Vec<String>);

/// Checks all inputs and targets that could make a run fail, before the scene is sent to the other
/// ranks.
fn begin(args: &RunArgs, found: Option<Found>, reading: &AtomicBool) -> Outcome<Begun> {
    let (bytes, checked, beginning, restarted, origin) = match (found, &args.scene) {
        (Some((mut checkpoint, file, notes)), _) => {
            notes.iter().for_each(|note| {
                eprintln!("{}", warning(&format!("{note}; taking the one before")))
            });
            let bytes = checkpoint.scene.clone().into_bytes();
            let name = file.display().to_string();
            let mut checked =
                input::parse_changed(&bytes, &name, &args.set, &CHANGEABLE).map_err(bad)?;
            checkpoint.fit(&checked, &file).map_err(bad)?;
            checked.method_choice = checkpoint.method_choice.clone();
            tell_restart(args, &checkpoint, &name);
            let output = folder::results_of(&file)
                .unwrap_or_else(|| Path::new("output").join(file.file_stem().unwrap_or_default()));
            let origin = checkpoint.run_origin();
            let beginning = Beginning::Checkpoint(Box::new(checkpoint));
            (bytes, checked, beginning, Some(output), origin)
        }
        (None, Some(path)) => {
            let scene = SceneArgs { scene: path.clone(), set: args.set.clone() };
            let (bytes, checked) = read_scene(&scene, args.ignore_memory)?;
            (bytes, checked, Beginning::Scene, None, Origin::new(RUN, path))
        }
        (None, None) => return Err((BAD_INPUT, "a scene is needed; see --help".into())),
    };
    let maker = Maker::with(origin, &checked);
    reading.store(false, Ordering::Relaxed);
    let (output, lock) = match args.output.clone().or(restarted) {
        Some(output) => {
            let lock = Lock::take_for(&output, &maker.origin).map_err(bad)?;
            (output, lock)
        }
        None => results_folder(args.scene.as_deref(), &maker).map_err(bad)?,
    };
    check_writable(&output, args.keep, &maker).map_err(bad)?;
    folder::check_owner(&output, &maker).map_err(bad)?;
    if let Some(file) = &args.trace {
        check_target(file, "a timeline", |text| text.starts_with(TRACE_START)).map_err(bad)?;
        check_file(file)?;
    }
    Ok(Begun { bytes, checked, beginning, output, lock })
}

/// The folder of the results of a scene without `--output`, locked; prints why it has a number.
fn results_folder(scene: Option<&Path>, maker: &Maker) -> Result<(PathBuf, Lock), OutputError> {
    let found = default_folder(scene.unwrap_or(Path::new("")), maker)?;
    if let Some((avoided, reason)) = found.avoided {
        // a quiet run too: a script would read the results of the other scene
        let [path, avoided] = [&found.path, &avoided].map(|path| path.display());
        let text = format!("results go to {path} instead of {avoided}, because {reason}");
        eprintln!("{}", wrapped(&text, 2));
    }
    Ok((found.path, found.lock))
}

/// Prints the checkpoint from which a run restarts.
fn tell_restart(args: &RunArgs, checkpoint: &Checkpoint, file: &str) {
    let ours = env!("CARGO_PKG_VERSION");
    if checkpoint.version != ours {
        let theirs = &checkpoint.version;
        let text = format!("{file}: written by version {theirs}, this is {ours}: bits may differ");
        eprintln!("{}", warning(&text));
    }
    if !args.quiet {
        let saved = &checkpoint.saved;
        eprintln!("continues from {file}: time {:.6e} s, step {}", saved.time, saved.step);
    }
}

/// Records the first signal that requests an end. The second signal ends the process at once, and
/// so does the first while files are read.
fn watch_signals(reading: Arc<AtomicBool>) -> Arc<AtomicU8> {
    /// A launcher and its batch system may send one signal each within this time.
    const TOGETHER: Duration = Duration::from_millis(300);
    let came = Arc::new(AtomicU8::new(0));
    let noted = came.clone();
    // without a handler, a signal ends the process as usual
    if let Ok(mut signals) = Signals::new([SIGTERM, SIGINT, SIGUSR1]) {
        std::thread::spawn(move || {
            let mut first: Option<Instant> = None;
            for signal in signals.forever() {
                let again = first.get_or_insert_with(Instant::now).elapsed() > TOGETHER;
                if again || reading.load(Ordering::Relaxed) {
                    let _ = emulate_default_handler(signal);
                }
                noted.store(signal as u8, Ordering::Relaxed);
            }
        });
    }
    came
}

fn run_scene(comm: &dyn Comm, args: &RunArgs, started: Instant) -> Outcome<()> {
    comm.set_stall_timeout(Duration::from_secs_f64(args.stall_timeout));
    // until its files have been read, a run has no state that is worth saving
    let reading = Arc::new(AtomicBool::new(true));
    let signal = watch_signals(reading.clone());
    let first = comm.rank() == 0;
    let by_first = |text: String| if first { text } else { String::new() };
    let opened = args.restart.as_ref().map(|path| folder::open(comm, path)).transpose();
    let mut found = opened.map_err(|error| (BAD_INPUT, by_first(error.to_string())))?;
    let mine = match first {
        true => begin(args, found.take(), &reading),
        false => Err((BAD_INPUT, String::new())),
    };
    let text = mine.as_ref().map_or(Vec::new(), |begun| begun.bytes.clone());
    let text = comm.broadcast(text);
    reading.store(false, Ordering::Relaxed);
    let (checked, beginning, output, lock) = match mine {
        Ok(begun) => (begun.checked, begun.beginning, begun.output, Some(begun.lock)),
        Err(error) if text.is_empty() => return Err(error),
        Err(_) => {
            let checked = input::parse(&text, &input(args), &args.set).map_err(bad)?;
            let beginning = found.map_or(Beginning::Scene, |(checkpoint, ..)| {
                Beginning::Checkpoint(Box::new(checkpoint))
            });
            // only rank 0 writes
            (checked, beginning, PathBuf::new(), None)
        }
    };
    let threads = args.threads.unwrap_or(checked.scene.decomposition.threads);
    if !args.ignore_memory {
        check_memory(comm, &checked, threads).map_err(|e| (BAD_INPUT, by_first(e.to_string())))?;
    }
    if comm.rank() == 0 && !args.quiet {
        announce(comm, &checked, threads);
    }
    let options = Options {
        output,
        keep: args.keep,
        quiet: args.quiet,
        verbose: args.verbose,
        progress: args.progress.into(),
        threads,
        trace: args.trace.clone().map(|file| (file, args.trace_steps.clone())),
        started,
        signal,
        commit: COMMIT,
    };
    // all ranks know the error, and rank 0 prints it
    match run(comm, &checked, &options, beginning) {
        Ok(ended) => {
            if let Some(text) = ended.filter(|_| !args.quiet) {
                say(&text);
            }
            match &lock {
                Some(_) if args.report => cli::report::report(&options.output, None).map(|_| ()),
                _ => Ok(()),
            }
        }
        Err(RunFailure::Run(RunError::Elsewhere) | RunFailure::Output(OutputError::Elsewhere)) => {
            Err((FAILED, String::new()))
        }
        Err(stopped @ RunFailure::Stopped { .. }) => {
            if comm.rank() == 0 {
                eprintln!("{stopped}");
            }
            Err((STOPPED, String::new()))
        }
        Err(error @ (RunFailure::Alarm { .. } | RunFailure::Checkpoint(_))) => {
            Err((FAILED, by_first(error.to_string())))
        }
        Err(
            error @ RunFailure::Run(
                RunError::Particle { .. }
                | RunError::TimeStep { .. }
                | RunError::TooLong { .. }
                | RunError::Foreign
                | RunError::Lost { .. },
            ),
        ) => Err((FAILED, by_first(error.to_string()))),
        Err(error) => {
            eprintln!("error: {error}");
            drop(lock);
            comm.abort(i32::from(FAILED))
        }
    }
}

/// Prints one line about the run, and the warnings.
fn announce(comm: &dyn Comm, scene: &CheckedScene, threads: usize) {
    for text in &scene.warnings {
        eprintln!("{}", warning(text));
    }
    let cores = std::thread::available_parallelism().map_or(threads, usize::from);
    if threads > cores {
        let text =
            format!("{threads} threads per rank, but this process may use only {cores} cores");
        eprintln!("{}", warning(&text));
    }
    let patches = flyer_mpm::simulation::patch_counts(scene, comm.size(), threads);
    let idle = comm.size().saturating_sub(patches.iter().product());
    if idle > 0 {
        let ranks = comm.size();
        let text = format!(
            "{idle} of {ranks} ranks have no patch: use fewer ranks, or more domain.patches"
        );
        eprintln!("{}", warning(&text));
    }
    let chosen = match &scene.scene.domain.patches {
        Some(given) if *given == patches => "",
        _ => " (chosen)",
    };
    // without spaces, so that a line does not end within it
    let patches = patches.iter().map(usize::to_string).collect::<Vec<_>>().join(",");
    let size = format!(
        "{} particles, {} cells, patches [{patches}]{chosen}, ranks {}, threads {threads}",
        scene.particles,
        scene.cell_count(),
        comm.size(),
    );
    eprintln!("{}", wrapped(&size, 2));
    if let Some(choice) = &scene.method_choice {
        eprintln!("{}", wrapped(&format!("method {choice}"), 2));
    }
}

fn side_command(command: Command) -> Outcome<()> {
    match command {
        Command::Schema { markdown: true } => {
            say(&cli::reference::markdown(&input::schema()));
            Ok(())
        }
        Command::Schema { markdown: false } => {
            let text = serde_json::to_string_pretty(&input::schema()).map_err(bad)?;
            say(&(text + "\n"));
            Ok(())
        }
        Command::Check { scene } => {
            let (_, checked) = read_scene(&scene, false)?;
            say(&cli::check::check(&checked).map_err(|e| (FAILED, e.to_string()))?);
            Ok(())
        }
        Command::Hugoniot { scene, output } => {
            let (_, checked) = read_scene(&scene, false)?;
            let stem = scene.scene.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let output =
                output.unwrap_or_else(|| Path::new("output").join(format!("{stem}.hugoniot")));
            say(&cli::check::hugoniot(&checked, &output)?);
            Ok(())
        }
        Command::New { name: None, .. } => {
            say(&cli::new::list());
            Ok(())
        }
        Command::New { name: Some(name), output } => {
            cli::new::write(&name, output.as_deref()).map(|text| say(&text))
        }
        Command::Materials => {
            say(&cli::materials::list());
            Ok(())
        }
        Command::Material { source, name, set, output } => {
            let plain = |c: char| if c.is_alphanumeric() || "-_".contains(c) { c } else { '_' };
            let folder =
                |name: &str| format!("material.{}", name.chars().map(plain).collect::<String>());
            let (checked, name, folder) = match name {
                Some(name) => {
                    let stem =
                        source.file_stem().unwrap_or_default().to_string_lossy().into_owned();
                    let folder = format!("{stem}.{}", folder(&name));
                    (read_scene(&SceneArgs { scene: source, set }, false)?.1, name, folder)
                }
                None => {
                    let name = source.display().to_string();
                    let folder = folder(&name);
                    (cli::materials::scene_of(&name)?, name, folder)
                }
            };
            let output = output.unwrap_or_else(|| Path::new("output").join(folder));
            say(&cli::material::material(&checked, &name, &output)?);
            Ok(())
        }
        Command::Perf(PerfCommand::Predict(args)) => {
            say(&cli::predict::predict(&args)?);
            Ok(())
        }
        Command::Perf(PerfCommand::Study(args)) => {
            say(&cli::scaling::scaling(&args)?);
            Ok(())
        }
        Command::Study { study, output, quiet } => {
            cli::study::study(&study, output.as_deref(), quiet).map(|text| say(&text))
        }
        Command::Completions { shell } => {
            say(&cli::manual::completions(shell));
            Ok(())
        }
        Command::Man { output } => cli::manual::man(output.as_deref()).map(|text| say(&text)),
        Command::Migrate { scene, output } => {
            cli::migrate::migrate(&scene, output.as_deref()).map(|text| say(&text))
        }
        Command::Plan(args) => cli::plan::plan(&args).map(|text| say(&text)),
        Command::Perf(PerfCommand::Calibrate { .. }) => unreachable!("all ranks calibrate"),
        Command::Report { folder, output } => {
            let page = cli::report::report(&folder, output.as_deref())?;
            say(&format!("{}\n", page.display()));
            Ok(())
        }
        Command::Compare { first, second } => {
            let comparison = compare(&first, &second).map_err(bad)?;
            say(&format!("{comparison}\n"));
            match comparison.same_bits() {
                true => Ok(()),
                false => Err((1, String::new())),
            }
        }
    }
}
