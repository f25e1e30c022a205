//! The command line: arguments and subcommands, one file each.

pub mod check;
pub mod manual;
pub mod material;
pub mod materials;
pub mod migrate;
pub mod new;
pub mod plan;
pub mod predict;
pub mod reference;
pub mod report;
pub mod scaling;
pub mod study;

use std::path::PathBuf;

use clap::{Args, CommandFactory, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;
use flyer_mpm::driver::progress::ProgressChoice;
use flyer_mpm::scene::PlannedQuantity;

/// Impact and shock waves by the material point method, compared with exact solutions.
///
/// Runs a scene on all ranks that it is started with:
///
///   mpirun -n 2 flyer-mpm inputs/flyer.json
///   flyer-mpm inputs/flyer.json --set domain.cell_size=5e-6 --output output/fine
///
/// Results go to output/<name of the scene>/: summary.json (errors against the exact solution,
/// energy, times), one CSV per profile time, histories.csv, results.hdf5 (for ParaView) and
/// pictures. A new run of the same scene file replaces them when it is complete; a run that fails
/// leaves them unchanged. Another scene of the same name gets output/<name>-2/; with --output, a
/// folder with results of another scene is refused.
///
/// Checkpoints go to <folder of the results>.checkpoints/, beside the folder of the results
/// (output.checkpoint of the scene; default: every ten minutes). SIGTERM, SIGINT, SIGUSR1 and
/// time.wall_limit write one and end the run with code 4; flyer-mpm --restart <folder of the
/// results>.checkpoints continues with the same bits.
///
/// Exit codes: 0 done; 1 `compare` found a difference; 2 error in the command line, scene or
/// folder; 3 the run failed; 4 the run was stopped and can be restarted; 7 a rank hangs.
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
    /// The subcommand.
    #[command(subcommand)]
    pub command: Option<Command>,

    /// The arguments of a run without subcommand.
    #[command(flatten)]
    pub run: Option<RunArgs>,
}

/// A scene and its overrides.
#[derive(Clone, Debug, Args)]
pub struct SceneArgs {
    /// The scene: a JSON file (`flyer-mpm schema` describes it).
    #[arg(value_name = "SCENE.json")]
    pub scene: PathBuf,

    /// Override a value of the scene, such as domain.patches=[8], bodies.flyer.velocity=[500] (by
    /// name or index) or method.shape=cpdi; may be repeated. A value that is not JSON is a string;
    /// without a value, as in artificial_viscosity=, the key is removed.
    #[arg(long, value_name = "PATH=VALUE")]
    pub set: Vec<String>,
}

/// Arguments of a run.
#[derive(Clone, Debug, Args)]
pub struct RunArgs {
    /// The scene: a JSON file (`flyer-mpm schema` describes it).
    #[arg(value_name = "SCENE.json", required_unless_present = "restart")]
    pub scene: Option<PathBuf>,

    /// Restart from a checkpoint, or from the newest undamaged one of a folder, instead of a scene.
    /// --set may change time, output, domain.patches and decomposition.
    #[arg(long, value_name = "FILE|DIR", conflicts_with = "scene")]
    pub restart: Option<PathBuf>,

    /// Override a value of the scene, such as domain.patches=[8], bodies.flyer.velocity=[500] (by
    /// name or index) or method.shape=cpdi; may be repeated. A value that is not JSON is a string;
    /// without a value, as in artificial_viscosity=, the key is removed.
    #[arg(long, value_name = "PATH=VALUE")]
    pub set: Vec<String>,

    /// Folder of the results [default: output/<name of the scene>/].
    #[arg(long, value_name = "DIR")]
    pub output: Option<PathBuf>,

    /// Threads per rank [default: decomposition.threads of the scene, else 1].
    #[arg(long, value_name = "N", value_parser = threads)]
    pub threads: Option<usize>,

    /// Write a timeline of phases, ranks and patches in Chrome's trace format (for Perfetto).
    #[arg(long, value_name = "FILE")]
    pub trace: Option<PathBuf>,

    /// Steps of the timeline, first and last; each takes some kilobytes per patch.
    #[arg(long, value_name = "A..B", default_value = "1..200", value_parser = steps, requires = "trace")]
    pub trace_steps: std::ops::Range<u64>,

    /// End the run and name the rank, if a rank gives no sign of life for this time while others
    /// wait for it.
    #[arg(long, value_name = "SECONDS", default_value_t = 300.0, value_parser = seconds)]
    pub stall_timeout: f64,

    /// Start even if the run seems to need more memory than this machine has left.
    #[arg(long)]
    pub ignore_memory: bool,

    /// Also write report.html: one page with curves and maps that can be enlarged, tables and the
    /// scene.
    #[arg(long)]
    pub report: bool,

    /// Refuse to replace an earlier result.
    #[arg(long)]
    pub keep: bool,

    /// Print errors only.
    #[arg(long)]
    pub quiet: bool,

    /// Progress during the run.
    #[arg(long, value_name = "WHEN", default_value = "auto")]
    pub progress: ProgressArg,

    /// Also print the errors of every profile, the cost of each effect and the work of each rank.
    #[arg(long, conflicts_with = "quiet")]
    pub verbose: bool,
}

/// When a run shows its progress.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum ProgressArg {
    /// A bar with the time left on a terminal, also under mpirun; otherwise a line every ten seconds
    Auto,
    /// A bar also if the output is not a terminal
    Always,
    /// No progress
    Never,
}

impl From<ProgressArg> for ProgressChoice {
    fn from(arg: ProgressArg) -> ProgressChoice {
        match arg {
            ProgressArg::Auto => ProgressChoice::Auto,
            ProgressArg::Always => ProgressChoice::Always,
            ProgressArg::Never => ProgressChoice::Never,
        }
    }
}

/// Default file that `perf calibrate` writes and `perf predict` reads.
const MACHINE_FILE: &str = "output/machine.json";

/// Arguments of `perf predict`.
#[derive(Clone, Debug, Args)]
pub struct PredictArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,

    /// Constants that `flyer-mpm perf calibrate` has measured with the method of this scene.
    #[arg(long, value_name = "FILE", default_value = MACHINE_FILE)]
    pub machine: PathBuf,

    /// Numbers of ranks; the table continues to 100 000.
    #[arg(long, value_name = "N,...", value_delimiter = ',', value_parser = ranks)]
    pub ranks: Vec<usize>,

    /// Threads per rank [default: decomposition.threads of the scene, else 1].
    #[arg(long, value_name = "N", value_parser = threads)]
    pub threads: Option<usize>,

    /// The network between nodes: measured, shared-memory, hdr, slingshot11, 25gbe, 25gbe-tcp, or
    /// latency and bandwidth such as 1.3e-6,25e9 [s, B/s].
    #[arg(long, value_name = "NAME|LATENCY,BANDWIDTH", default_value = "hdr")]
    pub network: String,

    /// Compare predictions with this scaling.json of `flyer-mpm perf study strong` instead, with the
    /// study's overrides of the scene; may be repeated.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["ranks", "threads"])]
    pub against: Vec<PathBuf>,
}

/// Arguments of `plan`.
#[derive(Clone, Debug, Args)]
pub struct PlanArgs {
    /// The scene; the plan replaces its method, viscosity, cell size, particles and Courant number.
    #[command(flatten)]
    pub scene: SceneArgs,

    /// Target quantity: plateau_pressure, l1 (of each profile) or arrival_time.
    #[arg(long, value_name = "NAME", value_parser = quantity)]
    pub quantity: PlannedQuantity,

    /// Largest relative error of the quantity: 0.5% or 0.005.
    #[arg(long, value_name = "ERROR", value_parser = fraction)]
    pub error: f64,

    /// The position of arrival_time, in the struck body at the start, in metres [default: the first
    /// of error_estimate.arrivals].
    #[arg(long, value_name = "METRES", allow_negative_numbers = true)]
    pub at: Option<f64>,

    /// Largest wall time of the time loop.
    #[arg(long, value_name = "SECONDS", default_value_t = 86400.0, value_parser = seconds)]
    pub budget: f64,

    /// Number of ranks of the run.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = ranks)]
    pub ranks: usize,

    /// File of the scene to run [default: output/plans/<name of the scene>.plan.json].
    #[arg(long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// Subcommands of the program.
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
    /// Write a template: a short scene that can be run without changes. Without a name, list the
    /// templates.
    New {
        /// Name of the template.
        #[arg(value_name = "NAME")]
        name: Option<String>,
        /// File to write [default: NAME.json].
        #[arg(long, value_name = "FILE", requires = "name")]
        output: Option<PathBuf>,
    },
    /// List the materials of the library: models, density and source of each.
    Materials,
    /// Print and draw the equation of state of a material: Hugoniot, isentropes, sound speed and
    /// limits of validity.
    Material {
        /// Name of a material of the library, or a scene: a JSON file.
        #[arg(value_name = "NAME|SCENE.json")]
        source: PathBuf,
        /// Name of the material in the scene.
        #[arg(value_name = "NAME")]
        name: Option<String>,
        /// Override a value of the scene; may be repeated.
        #[arg(long, value_name = "PATH=VALUE", requires = "name")]
        set: Vec<String>,
        /// Folder of the pictures [default: output/<name of the scene>.material.<name>/, or
        /// output/material.<name>/].
        #[arg(long, value_name = "DIR")]
        output: Option<PathBuf>,
    },
    /// Check a scene and print the costs of a run: particles, cells, memory, steps, effects.
    Check {
        /// The scene.
        #[command(flatten)]
        scene: SceneArgs,
    },
    /// Measure this machine and the scaling of a scene, and predict runs on more ranks.
    #[command(subcommand)]
    Perf(PerfCommand),
    /// Print a script that completes commands and options in a shell.
    Completions {
        /// The shell.
        #[arg(value_name = "SHELL")]
        shell: Shell,
    },
    /// Print the manual page, or write the pages of all commands.
    Man {
        /// Folder of the pages, such as ~/.local/share/man/man1.
        #[arg(long, value_name = "DIR")]
        output: Option<PathBuf>,
    },
    /// Rewrite a scene of a former format with the present names, in place.
    Migrate {
        /// The scene: a JSON file.
        #[arg(value_name = "SCENE.json")]
        scene: PathBuf,
        /// File to write instead.
        #[arg(long, value_name = "FILE")]
        output: Option<PathBuf>,
    },
    /// Vary keys of a scene and show the cost of accuracy: one table and pictures. Runs of an
    /// earlier call are reused.
    Study {
        /// The study: a JSON file such as those in inputs/studies/.
        #[arg(value_name = "STUDY.json")]
        study: PathBuf,
        /// Folder of the results [default: output/studies/<name of the study>/].
        #[arg(long, value_name = "DIR")]
        output: Option<PathBuf>,
        /// Print errors only.
        #[arg(long)]
        quiet: bool,
    },
    /// Choose the scheme, cell size, particles per cell and Courant number that reach an error in
    /// the least time. Predict error and time, and write the scene to run. That run compares
    /// predicted and actual values at its end. The plan measures the time of pilot runs of the
    /// scene: nothing else should run meanwhile.
    Plan(PlanArgs),
    /// Print the JSON schema of a scene.
    Schema {
        /// Print it as tables in Markdown, as in docs/scene.md.
        #[arg(long)]
        markdown: bool,
    },
    /// Write report.html about the results of a run: one page with curves and maps that can be
    /// enlarged and show values, tables, warnings and the scene. It needs no other file and no
    /// network.
    Report {
        /// Folder of the results.
        #[arg(value_name = "RUN")]
        folder: PathBuf,
        /// File to write [default: report.html in the folder].
        #[arg(long, value_name = "FILE")]
        output: Option<PathBuf>,
    },
    /// Compare the results of two runs: norms, and the first particle and column that differ. The
    /// exit code is 1 if they differ.
    Compare {
        /// Folder of the first results.
        #[arg(value_name = "RUN")]
        first: PathBuf,
        /// Folder of the second results.
        #[arg(value_name = "RUN")]
        second: PathBuf,
    },
}

/// Performance of this machine, and predictions for others.
#[derive(Debug, Subcommand)]
pub enum PerfCommand {
    /// Measure the constants of this machine and a scene's method: the time per particle, ghost,
    /// node and patch, of starting and joining threads, of a second busy core, and with `mpirun -n
    /// 2 --bind-to none` of messages and reductions. Nothing else should run meanwhile.
    Calibrate {
        /// The scene: a JSON file whose method is measured [default: the flyer plate].
        #[arg(value_name = "SCENE.json")]
        scene: Option<PathBuf>,
        /// Override a value of the scene; may be repeated.
        #[arg(long, value_name = "PATH=VALUE")]
        set: Vec<String>,
        /// File of the constants.
        #[arg(long, value_name = "FILE", default_value = MACHINE_FILE)]
        output: PathBuf,
        /// Measuring time; a shorter time gives less exact constants.
        #[arg(long, value_name = "SECONDS", default_value_t = 16.0, value_parser = seconds)]
        seconds: f64,
        /// Print every sample of the fit.
        #[arg(long)]
        samples: bool,
        /// End the measurement and name the rank, if a rank gives no sign of life for this time
        /// while others wait for it.
        #[arg(long, value_name = "SECONDS", default_value_t = 300.0, value_parser = seconds)]
        stall_timeout: f64,
    },
    /// Predict, without a run, the time of a step and of the whole run on more ranks, and the
    /// limits of strong scaling. Uses the constants of `flyer-mpm perf calibrate`.
    Predict(PredictArgs),
    /// Measure strong or weak scaling: run a scene under mpirun on every combination of ranks and
    /// threads, and on 1 x 1, each with every particle computed and once more with patches at rest
    /// skipped. Writes a table, a CSV, scaling.json and a picture. Nothing else should run
    /// meanwhile.
    Study(scaling::ScalingArgs),
}

/// The command that the unknown name `name` resembles, if any.
pub fn meant(name: &str) -> Option<String> {
    let commands = Cli::command();
    let mut names = Vec::new();
    for command in commands.get_subcommands() {
        names.push((command.get_name().to_string(), command.get_name().to_string()));
        for below in command.get_subcommands() {
            let whole = format!("{} {}", command.get_name(), below.get_name());
            names.push((below.get_name().to_string(), whole));
        }
    }
    // a command before one of `perf` with the same name
    names
        .into_iter()
        .map(|(known, whole)| {
            let distance = strsim::damerau_levenshtein(&name.to_lowercase(), &known);
            (distance, known != whole, known, whole)
        })
        .filter(|(distance, _, known, _)| *distance <= (known.len().max(name.len()) / 3).max(1))
        .min()
        .map(|(_, _, _, whole)| whole)
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

/// A fraction, also given in per cent.
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
