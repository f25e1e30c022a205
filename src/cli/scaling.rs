//! The command `perf study`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use flyer_mpm::perf_model::Machine;
use flyer_mpm::study::scaling::{ScalingError, ScalingKind, ScalingOptions, ScalingPlan};
use flyer_mpm::study::scaling::{files, table};

use crate::{FAILED, Outcome, bad};

/// The quantity that the study holds fixed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Fixed {
    /// The same scene on every configuration
    Strong,
    /// The work per worker: N workers compute cells of 1/N of the size up to 1/N of the end time
    Weak,
}

/// Arguments of `perf study`.
#[derive(Clone, Debug, Args)]
pub struct ScalingArgs {
    /// The quantity that is held fixed.
    #[arg(value_name = "KIND")]
    pub kind: Fixed,

    /// The scene: a JSON file.
    #[arg(value_name = "SCENE.json")]
    pub scene: PathBuf,

    /// Numbers of ranks.
    #[arg(long, value_name = "N,...", required = true, value_delimiter = ',', value_parser = count)]
    pub ranks: Vec<usize>,

    /// Numbers of threads per rank.
    #[arg(
        long,
        value_name = "N,...",
        default_value = "1",
        value_delimiter = ',',
        value_parser = count
    )]
    pub threads: Vec<usize>,

    /// Runs of each configuration, of which the medians are taken.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = count)]
    pub repeats: usize,

    /// Override a value of the scene; may be repeated.
    #[arg(long, value_name = "PATH=VALUE")]
    pub set: Vec<String>,

    /// Folder of the results [default: output/<kind>_scaling_<name of the scene>/].
    #[arg(long, value_name = "DIR")]
    pub output: Option<PathBuf>,

    /// Constants of the machine from `perf calibrate`: the model's times beside the measured ones.
    #[arg(long, value_name = "FILE")]
    pub machine: Option<PathBuf>,

    /// Physical cores of the machine [default: the processors that this process may use].
    #[arg(long, value_name = "N", value_parser = count)]
    pub cores: Option<usize>,
}

/// Runs a scaling study and writes its files; returns its table.
pub fn scaling(args: &ScalingArgs) -> Outcome<String> {
    #[cfg(feature = "mpi")]
    if decomp::comm::mpi::Mpi::is_launched() {
        return Err(bad("perf study starts mpirun itself; start it without mpirun"));
    }
    let failed = |error: ScalingError| match error {
        ScalingError::Scene(_) | ScalingError::Folder(_) => bad(error),
        error => (FAILED, error.to_string()),
    };
    let machine = match &args.machine {
        Some(file) => Some((Machine::read(file).map_err(bad)?, file.clone())),
        None => None,
    };
    let options = ScalingOptions {
        machine,
        kind: match args.kind {
            Fixed::Strong => ScalingKind::Strong,
            Fixed::Weak => ScalingKind::Weak,
        },
        program: std::env::current_exe().map_err(|e| (FAILED, e.to_string()))?,
        scene: args.scene.clone(),
        sets: args.set.clone(),
        ranks: args.ranks.clone(),
        threads: args.threads.clone(),
        repeats: args.repeats,
        cores: args.cores,
        output: args.output.clone(),
    };
    let plan = ScalingPlan::new(options).map_err(failed)?;
    let study = plan.measure(|line| eprintln!("{line}")).map_err(failed)?;
    files::write(&study, &plan.output).map_err(failed)?;
    Ok(table::text(&study.rows) + &format!("results in {}\n", plan.output.display()))
}

fn count(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(n) if (1..=1024).contains(&n) => Ok(n),
        _ => Err("a whole number from 1 to 1024 is allowed".into()),
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;
    use crate::cli::{Cli, Command, PerfCommand};

    fn parsed(arguments: &str) -> Result<ScalingArgs, clap::Error> {
        let words = ["flyer-mpm", "perf", "study"].into_iter().chain(arguments.split_whitespace());
        match Cli::try_parse_from(words)?.command {
            Some(Command::Perf(PerfCommand::Study(args))) => Ok(args),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn lists_and_defaults_are_read() {
        let args = parsed("strong a.json --ranks 1,2,4 --set a.b=[1,2] --set c=3").unwrap();
        assert_eq!(
            (args.kind, &args.ranks[..], &args.threads[..]),
            (Fixed::Strong, &[1, 2, 4][..], &[1][..])
        );
        assert_eq!((args.repeats, &args.set[..]), (5, &["a.b=[1,2]".into(), "c=3".into()][..]));
        let args = parsed("weak a.json --ranks 2 --threads 1,2 --repeats 3").unwrap();
        assert_eq!((args.kind, &args.threads[..], args.repeats), (Fixed::Weak, &[1, 2][..], 3));
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
