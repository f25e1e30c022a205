//! The command line: arguments and subcommands, one file each.

pub mod check;
pub mod material;
pub mod plan;
pub mod predict;
pub mod study;

use std::path::PathBuf;

use clap::{Args, CommandFactory, Parser, Subcommand};
use flyer_mpm::scene::PlannedQuantity;

/// Impact and shock waves by the material point method, held against exact solutions.
///
/// Runs a scene on all ranks that it is started with:
///
///   mpirun -n 2 flyer-mpm inputs/flyer.json
///   flyer-mpm inputs/flyer.json --set domain.cell_size=5e-6 --output output/fine
///
/// Results go to output/<name of the scene>/: summary.json (errors against the exact solution,
/// energy, times), one CSV a profile time, histories.csv, results.hdf5 (ParaView opens it) and
/// pictures. A rerun of the same scene replaces them once it is complete; a run that fails leaves
/// them as they were, and a run of another scene into the same folder is refused.
///
/// Checkpoints go to output/<name of the scene>.checkpoints/ (output.checkpoint of the scene; every
/// ten minutes unless said). SIGTERM, SIGINT, SIGUSR1 and time.wall_limit write one and end the run
/// with code 4; flyer-mpm --restart output/<name of the scene>.checkpoints goes on to the same bits.
///
/// Exit codes: 0 done; 1 `compare` found a difference; 2 the command line, scene or folder is wrong;
/// 3 the run failed; 4 it was stopped and can go on; 7 a rank hangs.
#[derive(Debug, Parser)]
#[command(
    version,
    verbatim_doc_comment,
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    arg_required_else_help = true,
    max_term_width = 100
)]
pub struct Cli {
    /// What else than a run.
    #[command(subcommand)]
    pub command: Option<Command>,

    /// The run.
    #[command(flatten)]
    pub run: Option<RunArgs>,
}

/// A scene and its overrides.
#[derive(Clone, Debug, Args)]
pub struct SceneArgs {
    /// The scene: a JSON file (`flyer-mpm schema` describes it).
    #[arg(value_name = "SCENE.json")]
    pub scene: PathBuf,

    /// Overrides a value of the scene, such as domain.patches=[8], bodies.flyer.velocity=[500] (by
    /// name or index) or method.shape=cpdi; may be repeated. What is not JSON is a string.
    #[arg(long, value_name = "PATH=VALUE")]
    pub set: Vec<String>,
}

/// A run.
#[derive(Clone, Debug, Args)]
pub struct RunArgs {
    /// The scene: a JSON file (`flyer-mpm schema` describes it).
    #[arg(value_name = "SCENE.json", required_unless_present = "restart")]
    pub scene: Option<PathBuf>,

    /// Goes on from a checkpoint, or from the newest one of a folder that is whole, in place of a
    /// scene. --set may change time, output, domain.patches and decomposition.
    #[arg(long, value_name = "FILE|DIR", conflicts_with = "scene")]
    pub restart: Option<PathBuf>,

    /// Overrides a value of the scene, such as domain.patches=[8], bodies.flyer.velocity=[500] (by
    /// name or index) or method.shape=cpdi; may be repeated. What is not JSON is a string.
    #[arg(long, value_name = "PATH=VALUE")]
    pub set: Vec<String>,

    /// Folder of the results [default: output/<name of the scene>/].
    #[arg(long, value_name = "DIR")]
    pub output: Option<PathBuf>,

    /// Threads a rank [default: decomposition.threads of the scene, else 1].
    #[arg(long, value_name = "N", value_parser = threads)]
    pub threads: Option<usize>,

    /// Write a timeline of phases, ranks and patches in Chrome's trace format (Perfetto opens
    /// it).
    #[arg(long, value_name = "FILE")]
    pub trace: Option<PathBuf>,

    /// Steps of the timeline, first and last; each takes some kilobytes a patch.
    #[arg(long, value_name = "A..B", default_value = "1..200", value_parser = steps, requires = "trace")]
    pub trace_steps: std::ops::Range<u64>,

    /// Ends the run, and names the rank, when a rank gives no sign of life for so long while others
    /// wait for it.
    #[arg(long, value_name = "SECONDS", default_value_t = 300.0, value_parser = seconds)]
    pub stall_timeout: f64,

    /// Start even if the run seems to need more memory than this machine has left.
    #[arg(long)]
    pub ignore_memory: bool,

    /// Refuse to replace an earlier result.
    #[arg(long)]
    pub keep: bool,

    /// Say nothing but errors.
    #[arg(long)]
    pub quiet: bool,
}

/// Where `calibrate` writes and `predict` reads.
const MACHINE_FILE: &str = "output/machine.json";

/// A prediction.
#[derive(Clone, Debug, Args)]
pub struct PredictArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,

    /// Constants that `flyer-mpm calibrate` has measured with this scene's method.
    #[arg(long, value_name = "FILE", default_value = MACHINE_FILE)]
    pub machine: PathBuf,

    /// Numbers of ranks; the table goes on to 100 000.
    #[arg(long, value_name = "N,...", value_delimiter = ',', value_parser = ranks)]
    pub ranks: Vec<usize>,

    /// Threads a rank [default: decomposition.threads of the scene, else 1].
    #[arg(long, value_name = "N", value_parser = threads)]
    pub threads: Option<usize>,

    /// The network between nodes: measured, shared-memory, hdr, slingshot11, 25gbe, 25gbe-tcp, or
    /// latency and bandwidth such as 1.3e-6,25e9 [s, B/s].
    #[arg(long, value_name = "NAME|LATENCY,BANDWIDTH", default_value = "hdr")]
    pub network: String,

    /// Hold predictions against this scaling.json of scripts/strong_scaling.sh instead, with the
    /// study's overrides of the scene; may be repeated.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["ranks", "threads"])]
    pub against: Vec<PathBuf>,
}

/// A plan.
#[derive(Clone, Debug, Args)]
pub struct PlanArgs {
    /// The scene; its method, viscosity, cell size, particles and Courant number are chosen anew.
    #[command(flatten)]
    pub scene: SceneArgs,

    /// What is wanted: plateau_pressure, l1 (of each profile) or arrival_time.
    #[arg(long, value_name = "NAME", value_parser = quantity)]
    pub quantity: PlannedQuantity,

    /// Its relative error, at most: 0.5% or 0.005.
    #[arg(long, value_name = "ERROR", value_parser = fraction)]
    pub error: f64,

    /// The place whose arrival is asked for, in the struck body at the start, in metres [default:
    /// the first of error_estimate.arrivals].
    #[arg(long, value_name = "METRES", allow_negative_numbers = true)]
    pub at: Option<f64>,

    /// Wall time of the time loop, at most.
    #[arg(long, value_name = "SECONDS", default_value_t = 86400.0, value_parser = seconds)]
    pub budget: f64,

    /// Ranks that the run will have.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = ranks)]
    pub ranks: usize,

    /// File of the scene to run [default: output/plans/<name of the scene>.plan.json].
    #[arg(long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// What else the program does.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Print the exact chain of wave interactions of an impact and draw its Hugoniots and x-t
    /// diagram, without a run.
    Hugoniot {
        /// The scene.
        #[command(flatten)]
        scene: SceneArgs,
        /// Folder of the pictures [default: output/<name of the scene>.hugoniot/].
        #[arg(long, value_name = "DIR")]
        output: Option<PathBuf>,
    },
    /// Print and draw what a material's equation of state does: Hugoniot, isentropes, sound speed,
    /// and where it ceases to hold.
    Material {
        /// The scene: a JSON file.
        #[arg(value_name = "SCENE.json")]
        scene: PathBuf,
        /// Name of the material in the scene.
        #[arg(value_name = "NAME")]
        name: String,
        /// Overrides a value of the scene; may be repeated.
        #[arg(long, value_name = "PATH=VALUE")]
        set: Vec<String>,
        /// Folder of the pictures [default: output/<name of the
        /// scene>.material.<name>/].
        #[arg(long, value_name = "DIR")]
        output: Option<PathBuf>,
    },
    /// Check a scene and tell what a run would take: particles, cells, memory, steps, effects.
    Check {
        /// The scene.
        #[command(flatten)]
        scene: SceneArgs,
    },
    /// Measure what predictions need of this machine and a scene's method: seconds of a particle,
    /// a ghost, a node and a patch, of threads that part and join, of a second busy core, and with
    /// `mpirun -n 2 --bind-to none` of messages and reductions. Nothing else should run meanwhile.
    Calibrate {
        /// The scene: a JSON file whose method is measured [default: the flyer plate].
        #[arg(value_name = "SCENE.json")]
        scene: Option<PathBuf>,
        /// Overrides a value of the scene; may be repeated.
        #[arg(long, value_name = "PATH=VALUE")]
        set: Vec<String>,
        /// File of the constants.
        #[arg(long, value_name = "FILE", default_value = MACHINE_FILE)]
        output: PathBuf,
        /// Time to take; less is less exact.
        #[arg(long, value_name = "SECONDS", default_value_t = 16.0, value_parser = seconds)]
        seconds: f64,
        /// Print every sample of the fit.
        #[arg(long)]
        samples: bool,
    },
    /// Predict the time of a step and of the whole run on more ranks, and where that stops being
    /// worth it, by the constants of `flyer-mpm calibrate`; no run.
    Predict(PredictArgs),
    /// Sweep a scene over any of its keys, and show what accuracy costs: one table and pictures.
    /// What an earlier call has run is not run again.
    Study {
        /// The study: a JSON file such as those in inputs/studies/.
        #[arg(value_name = "STUDY.json")]
        study: PathBuf,
        /// Folder of the results [default: output/studies/<name of the study>/].
        #[arg(long, value_name = "DIR")]
        output: Option<PathBuf>,
        /// Say nothing but errors.
        #[arg(long)]
        quiet: bool,
    },
    /// Choose scheme, cell size, particles per cell and Courant number that reach an error for the
    /// least time, foretell both, and write the scene to run, which at its end tells foretold
    /// against actual. Times pilots of the scene: nothing else should run meanwhile.
    Plan(PlanArgs),
    /// Print the JSON schema of a scene.
    Schema,
    /// Compare the results of two runs: norms, and the first particle and column that differ.
    /// Exit code 1 if they differ.
    Compare {
        /// Folder of the first results.
        #[arg(value_name = "RUN")]
        first: PathBuf,
        /// Folder of the second results.
        #[arg(value_name = "RUN")]
        second: PathBuf,
    },
}

/// The command that `name`, which is none, was perhaps meant to be.
pub fn meant(name: &str) -> Option<String> {
    let commands = Cli::command();
    let names = commands.get_subcommands().map(|command| command.get_name().to_string());
    names
        .map(|known| (strsim::damerau_levenshtein(&name.to_lowercase(), &known), known))
        .filter(|(distance, known)| *distance <= (known.len().max(name.len()) / 3).max(1))
        .min()
        .map(|(_, known)| known)
}

/// Steps A to B, both included, as a range.
fn steps(text: &str) -> Result<std::ops::Range<u64>, String> {
    let ends = text.split_once("..").and_then(|(a, b)| Some((a.parse().ok()?, b.parse().ok()?)));
    match ends {
        Some((a, b)) if 1 <= a && a <= b && b < u64::MAX => Ok(a..b + 1),
        _ => Err("two steps such as 1..200 are allowed".into()),
    }
}

fn quantity(text: &str) -> Result<PlannedQuantity, String> {
    serde_json::from_value(text.into())
        .map_err(|_| "plateau_pressure, l1 or arrival_time is allowed".into())
}

/// A fraction, or per cent.
fn fraction(text: &str) -> Result<f64, String> {
    let (number, scale) = match text.strip_suffix('%') {
        Some(number) => (number, 0.01),
        None => (text, 1.0),
    };
    match number.trim().parse::<f64>().map(|n| n * scale) {
        Ok(error) if error > 0.0 && error < 1.0 => Ok(error),
        _ => {
            Err("a fraction between 0 and 1 such as 0.005, or per cent such as 0.5%, is allowed"
                .into())
        }
    }
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(s) if (1e-3..=1e9).contains(&s) => Ok(s),
        _ => Err("a number from 0.001 to 1e9 is allowed".into()),
    }
}

fn threads(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(n) if (1..=1024).contains(&n) => Ok(n),
        _ => Err("a whole number from 1 to 1024 is allowed".into()),
    }
}

fn ranks(text: &str) -> Result<usize, String> {
    match text.trim().parse() {
        Ok(n) if (1..=1_000_000).contains(&n) => Ok(n),
        _ => Err("a whole number from 1 to 1000000 is allowed".into()),
    }
}
