//! The program: arguments, scene, run, report.
//!
//! Rank 0 reads, checks and speaks; all ranks leave with the same verdict. A failure that one
//! rank alone knows of ends all by MPI_Abort.

mod cli;
mod describe;
mod forecast;
mod sheet;

use std::io::Write;
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use clap::Parser;
use cli::{Cli, Command, RunArgs, SceneArgs};
use decomp::{Comm, Serial};
use flyer_mpm::output::compare::compare;
use flyer_mpm::output::folder::{check_writable, default_folder};
use flyer_mpm::run::{Failure, Options, run};
use flyer_mpm::scene::{self, CheckedScene};
use flyer_mpm::simulation::RunError;

/// The command line or the scene is wrong.
const BAD_INPUT: u8 = 2;
/// The run failed.
const FAILED: u8 = 3;

fn main() -> ExitCode {
    let started = Instant::now();
    #[cfg(feature = "mpi")]
    if decomp::comm::mpi::Mpi::is_launched()
        && let Some(ranks) = decomp::comm::mpi::Mpi::start()
    {
        return act(&ranks, started);
    }
    act(&Serial, started)
}

/// Does what the command line says. Collective.
fn act<C: Comm>(comm: &C, started: Instant) -> ExitCode {
    let first = comm.rank() == 0;
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // help and version come here too
            if first {
                let _ = error.print();
            }
            return ExitCode::from(if error.use_stderr() { BAD_INPUT } else { 0 });
        }
    };
    let outcome = match (cli.command, cli.run) {
        (None, Some(args)) => run_scene(comm, &args, started),
        (Some(Command::Calibrate { scene, set, output, seconds, samples }), _) => {
            let order = forecast::Order { scene, set, output, seconds, samples };
            forecast::calibrate(comm, &order)
        }
        // the rest is done by one rank
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

/// Prints to standard output; a reader that has gone, as `head` does, is no fault.
fn say(text: &str) {
    let _ = std::io::stdout().write_all(text.as_bytes());
}

/// An exit code and one line; an empty line where another rank speaks.
type Outcome<T> = Result<T, (u8, String)>;

fn bad(error: impl ToString) -> (u8, String) {
    (BAD_INPUT, error.to_string())
}

/// Reads and checks a scene on this rank.
fn read_scene(args: &SceneArgs) -> Outcome<(Vec<u8>, CheckedScene)> {
    let bytes = scene::read(&args.scene).map_err(bad)?;
    let checked =
        scene::parse(&bytes, &args.scene.display().to_string(), &args.set).map_err(bad)?;
    Ok((bytes, checked))
}

/// Whether a file can be written, found out before a run that would end with it.
fn check_file(path: &Path) -> Outcome<()> {
    let opened = std::fs::OpenOptions::new().create(true).append(true).open(path);
    opened
        .map(|_| ())
        .map_err(|e| (BAD_INPUT, format!("{}: cannot write the file: {e}", path.display())))
}

fn run_scene<C: Comm>(comm: &C, args: &RunArgs, started: Instant) -> Outcome<()> {
    comm.set_stall_timeout(Duration::from_secs_f64(args.stall_timeout));
    let output = args.output.clone().unwrap_or_else(|| default_folder(&args.scene));
    // rank 0 looks at everything that a run could fail on before it sends the scene on
    let mine = match comm.rank() {
        0 => read_scene(&args.scene()).and_then(|(bytes, checked)| {
            checked.check_memory(scene::available_memory()).map_err(bad)?;
            check_writable(&output, args.keep).map_err(bad)?;
            if let Some(file) = &args.trace {
                check_file(file)?;
            }
            Ok((bytes, checked))
        }),
        _ => Err((BAD_INPUT, String::new())),
    };
    let (bytes, verdict) = match mine {
        Ok((bytes, checked)) => (bytes, Ok(checked)),
        Err(error) => (Vec::new(), Err(error)),
    };
    let bytes = comm.broadcast(bytes);
    let checked = match verdict {
        Err(error) if bytes.is_empty() => return Err(error),
        Ok(checked) => checked,
        Err(_) => {
            scene::parse(&bytes, &args.scene.display().to_string(), &args.set).map_err(bad)?
        }
    };
    let threads = args.threads.unwrap_or(checked.scene.decomposition.threads);
    if comm.rank() == 0 && !args.quiet {
        announce(comm, &checked, threads);
    }
    let options = Options {
        output,
        keep: args.keep,
        quiet: args.quiet,
        threads,
        trace: args.trace.clone().map(|file| (file, args.trace_steps.clone())),
        started,
    };
    match run(comm, &checked, &options) {
        Ok(Some(report)) if !args.quiet => {
            say(&report);
            Ok(())
        }
        Ok(_) => Ok(()),
        Err(Failure::Run(RunError::Elsewhere)) => Err((FAILED, String::new())),
        // all ranks know of a particle's fault, and rank 0 tells it
        Err(
            error @ Failure::Run(
                RunError::Particle { .. }
                | RunError::TimeStep { .. }
                | RunError::TooLong { .. }
                | RunError::Lost { .. },
            ),
        ) => Err((FAILED, if comm.rank() == 0 { error.to_string() } else { String::new() })),
        Err(error) => {
            eprintln!("error: {error}");
            comm.abort(i32::from(FAILED))
        }
    }
}

/// One line on what is about to run, and the warnings.
fn announce<C: Comm>(comm: &C, scene: &CheckedScene, threads: usize) {
    for warning in &scene.warnings {
        eprintln!("warning: {warning}");
    }
    let patches = flyer_mpm::simulation::patch_counts(scene, comm.size(), threads);
    let chosen = if scene.scene.domain.patches.is_some() { "" } else { " (chosen)" };
    eprintln!(
        "{}: {} particles, {} cells, patches {patches:?}{chosen}, ranks {}, threads {threads}",
        scene.scene.title,
        scene.particles,
        scene.cell_count(),
        comm.size(),
    );
}

fn side_command(command: Command) -> Outcome<()> {
    match command {
        Command::Schema => {
            let text = serde_json::to_string_pretty(&scene::schema()).map_err(bad)?;
            say(&(text + "\n"));
            Ok(())
        }
        Command::Check { scene } => {
            let (_, checked) = read_scene(&scene)?;
            checked.check_memory(scene::available_memory()).map_err(bad)?;
            say(&describe::check(&checked).map_err(|e| (FAILED, e.to_string()))?);
            Ok(())
        }
        Command::Hugoniot { scene, output } => {
            let (_, checked) = read_scene(&scene)?;
            let stem = scene.scene.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let output =
                output.unwrap_or_else(|| Path::new("output").join(format!("{stem}_hugoniot")));
            say(&describe::hugoniot(&checked, &output)?);
            Ok(())
        }
        Command::Material { scene, name, set, output } => {
            let stem = scene.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let (_, checked) = read_scene(&SceneArgs { scene, set })?;
            let output =
                output.unwrap_or_else(|| Path::new("output").join(format!("{stem}_{name}")));
            say(&sheet::material(&checked, &name, &output)?);
            Ok(())
        }
        Command::Predict(args) => {
            say(&forecast::predict(&args)?);
            Ok(())
        }
        Command::Calibrate { .. } => unreachable!("all ranks calibrate"),
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
