//! Strong and weak scaling of a scene over ranks and threads.
//!
//! Started by `scripts/strong_scaling.sh` and `scripts/weak_scaling.sh`, which build the program
//! first. Every configuration is run several times, all of them in turn, so that a slow minute of
//! the machine falls on all alike. Exit code 2 for bad arguments or a bad scene, 3 for a run that
//! fails.

mod arguments;
mod configuration;
mod files;
mod launch;
mod picture;
mod row;
mod statistics;
mod study;
mod summary;
mod table;

use std::process::ExitCode;

use clap::Parser;

use arguments::Cli;
use study::Study;

/// The command line or the scene is wrong.
const BAD_INPUT: u8 = 2;
/// A run failed, or the results cannot be written.
const FAILED: u8 = 3;

/// An exit code and one line for the user.
type Outcome<T> = Result<T, (u8, String)>;

fn main() -> ExitCode {
    match scale(&Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err((code, message)) => {
            eprintln!("error: {message}");
            ExitCode::from(code)
        }
    }
}

/// Runs the study, prints its table and writes its files.
fn scale(cli: &Cli) -> Outcome<()> {
    let (kind, options) = cli.study();
    let plan = study::Plan::new(kind, options).map_err(|e| (BAD_INPUT, e))?;
    let study: Study = plan.measure().map_err(|e| (FAILED, e))?;
    print!("{}", table::text(&study.rows));
    files::write(&study, &plan.output).map_err(|e| (FAILED, e))?;
    println!("results in {}", plan.output.display());
    Ok(())
}
