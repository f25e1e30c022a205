//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

/// Impact and shock waves by the material point method, held against exact solutions.
///
/// Runs a scene on all ranks that it is started with:
///
///   mpirun -n 2 flyer-mpm inputs/flyer.json
///   flyer-mpm inputs/flyer.json --set domain.cell_size=5e-6 --output output/fine
///
/// Results go to output/<name of the scene>/: summary.json (errors against the exact solution,
/// energy, times), one CSV a profile time, histories.csv, results.hdf5 (ParaView opens it) and
/// pictures. A rerun replaces them once it is complete; a run that fails leaves them as they
/// were.
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
    #[arg(value_name = "SCENE.json")]
    pub scene: PathBuf,

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

    /// Refuse to replace an earlier result.
    #[arg(long)]
    pub keep: bool,

    /// Say nothing but errors.
    #[arg(long)]
    pub quiet: bool,
}

impl RunArgs {
    /// The scene and its overrides.
    pub fn scene(&self) -> SceneArgs {
        SceneArgs { scene: self.scene.clone(), set: self.set.clone() }
    }
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
        /// Folder of the pictures [default: output/<name of the scene>_hugoniot/].
        #[arg(long, value_name = "DIR")]
        output: Option<PathBuf>,
    },
    /// Check a scene and tell what a run would take: particles, cells, memory, steps, effects.
    Check {
        /// The scene.
        #[command(flatten)]
        scene: SceneArgs,
    },
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

/// Steps A to B, both included, as a range.
fn steps(text: &str) -> Result<std::ops::Range<u64>, String> {
    let ends = text.split_once("..").and_then(|(a, b)| Some((a.parse().ok()?, b.parse().ok()?)));
    match ends {
        Some((a, b)) if 1 <= a && a <= b && b < u64::MAX => Ok(a..b + 1),
        _ => Err("two steps such as 1..200 are allowed".into()),
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
