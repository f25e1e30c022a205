//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use serde::Serialize;

/// Measures how a scene's run scales with ranks and threads.
///
/// Every ranks x threads is run with nothing left out (the scaling figures) and once more with
/// quiet patches skipped; 1 x 1 is always added, as the base. Results: a table, a CSV, scaling.json
/// and a picture.
#[derive(Debug, Parser)]
#[command(verbatim_doc_comment, max_term_width = 100)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// The same scene on every configuration.
    Strong(Options),
    /// A scene whose work grows with ranks x threads: N workers get cells of a Nth of the size and
    /// run to a Nth of the end, so that particles a worker and the number of steps stay the same.
    Weak(Options),
}

/// What a study holds fixed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// The scene.
    Strong,
    /// The work of a worker.
    Weak,
}

impl Kind {
    /// Name of a study's table, and start of its folder's.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Strong => "strong_scaling",
            Kind::Weak => "weak_scaling",
        }
    }
}

/// What both studies are told.
#[derive(Clone, Debug, Args)]
pub struct Options {
    /// The scene: a JSON file.
    #[arg(value_name = "SCENE.json")]
    pub scene: PathBuf,

    /// Numbers of ranks.
    #[arg(long, value_name = "N,...", required = true, value_delimiter = ',', value_parser = count)]
    pub ranks: Vec<usize>,

    /// Numbers of threads a rank.
    #[arg(
        long,
        value_name = "N,...",
        default_value = "1",
        value_delimiter = ',',
        value_parser = count
    )]
    pub threads: Vec<usize>,

    /// Runs of each configuration; medians are taken.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = count)]
    pub repeats: usize,

    /// Overrides a value of the scene, as for the program; may be repeated.
    #[arg(long, value_name = "PATH=VALUE")]
    pub set: Vec<String>,

    /// Folder of the results [default: output/<kind>_scaling_<name of the scene>/].
    #[arg(long, value_name = "DIR")]
    pub output: Option<PathBuf>,

    /// Physical cores of the machine; the scripts know them.
    #[arg(long, hide = true, value_parser = count)]
    pub cores: Option<usize>,
}

impl Cli {
    /// The kind of the study and its options.
    pub fn study(&self) -> (Kind, &Options) {
        match &self.command {
            Command::Strong(options) => (Kind::Strong, options),
            Command::Weak(options) => (Kind::Weak, options),
        }
    }
}

fn count(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(n) if (1..=1024).contains(&n) => Ok(n),
        _ => Err("a whole number from 1 to 1024 is allowed".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(arguments: &str) -> Result<Cli, clap::Error> {
        Cli::try_parse_from(std::iter::once("scaling").chain(arguments.split_whitespace()))
    }

    #[test]
    fn lists_and_defaults_are_read() {
        let cli = parsed("strong a.json --ranks 1,2,4 --set a.b=[1,2] --set c=3").unwrap();
        let (kind, options) = cli.study();
        assert_eq!(
            (kind, &options.ranks[..], &options.threads[..]),
            (Kind::Strong, &[1, 2, 4][..], &[1][..])
        );
        assert_eq!(
            (options.repeats, &options.set[..]),
            (5, &["a.b=[1,2]".into(), "c=3".into()][..])
        );
        let cli = parsed("weak a.json --ranks 2 --threads 1,2 --repeats 3").unwrap();
        let (kind, options) = cli.study();
        assert_eq!((kind, &options.threads[..], options.repeats), (Kind::Weak, &[1, 2][..], 3));
    }

    #[test]
    fn bad_arguments_end_with_code_2_and_a_clear_line() {
        for (arguments, said) in [
            ("", "Usage"),
            ("medium a.json --ranks 1", "medium"),
            ("strong a.json", "--ranks"),
            ("strong --ranks 2", "SCENE.json"),
            ("strong a.json --ranks 1,0", "a whole number from 1 to 1024 is allowed"),
            ("strong a.json --ranks 1,,2", "a whole number from 1 to 1024 is allowed"),
            ("weak a.json --ranks 1 --repeats many", "a whole number from 1 to 1024 is allowed"),
            ("weak a.json --ranks 1 --speed 3", "--speed"),
        ] {
            let error = parsed(arguments).unwrap_err();
            assert_eq!(error.exit_code(), 2, "{arguments}");
            assert!(error.to_string().contains(said), "{arguments}: {error}");
        }
    }
}
