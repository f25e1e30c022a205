//! Starts the program under mpirun, as a user does.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use super::configuration::{Configuration, RankBinding};
use super::error::ScalingError;
use super::measured_run::MeasuredRun;

/// One configuration with all arguments of the program.
#[derive(Clone, Debug)]
pub struct ScalingRun {
    /// Ranks and threads.
    pub configuration: Configuration,
    /// Placement of its ranks.
    pub binding: RankBinding,
    /// Whether patches at rest are skipped.
    pub skip_quiescent: bool,
    /// The scene's file.
    pub scene: PathBuf,
    /// Overrides of the scene.
    pub sets: Vec<String>,
}

impl ScalingRun {
    /// Runs the program at path `program` under mpirun, with its results in `folder`.
    ///
    /// # Errors
    ///
    /// If mpirun cannot be started, if the run fails, or if its summary cannot be read.
    pub fn run(&self, program: &Path, folder: &Path) -> Result<MeasuredRun, ScalingError> {
        let Configuration { ranks, threads } = self.configuration;
        let mut command = mpirun(ranks, self.binding);
        command.arg(program).arg(&self.scene).arg("--quiet");
        command.arg("--output").arg(folder).args(["--threads", &threads.to_string()]);
        for set in &self.sets {
            command.args(["--set", set]);
        }
        let output = started(&mut command)?;
        if !output.status.success() {
            let text = String::from_utf8_lossy(&output.stderr);
            return Err(ScalingError::Run(format!(
                "{ranks} ranks x {threads} threads, {}: {}",
                output.status,
                first_words(&text)
            )));
        }
        MeasuredRun::read(folder)
    }
}

/// The best binding for a configuration, or none if mpirun cannot provide it on this machine.
///
/// # Errors
///
/// If mpirun cannot be started.
pub fn possible_binding(
    configuration: Configuration,
    cores: usize,
) -> Result<RankBinding, ScalingError> {
    let preferred = RankBinding::of(configuration, cores);
    if preferred == RankBinding::Oversubscribed {
        // nothing is bound, and mpirun may wait forever for very many ranks that never start MPI
        return Ok(preferred);
    }
    let output = started(mpirun(configuration.ranks, preferred).arg("true"))?;
    Ok(if output.status.success() { preferred } else { RankBinding::None })
}

fn mpirun(ranks: usize, binding: RankBinding) -> Command {
    let mut command = Command::new("mpirun");
    command.args(["--quiet", "-n", &ranks.to_string()]).args(binding.options());
    command
}

fn started(command: &mut Command) -> Result<Output, ScalingError> {
    let output = command.output();
    output.map_err(|source| ScalingError::Start { command: format!("{command:?}"), source })
}

/// Message of a failed run: the line of the program, otherwise the first line of mpirun with words.
fn first_words(text: &str) -> &str {
    let own = text.lines().find_map(|line| line.strip_prefix("error: "));
    let other = || text.lines().find(|line| line.contains(char::is_alphabetic));
    own.or_else(other).unwrap_or("no message").trim()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_run_is_reported_by_its_own_line() {
        assert_eq!(
            first_words("warning: thin\nerror: a particle has left\n"),
            "a particle has left"
        );
        assert_eq!(first_words("-----\nmpirun has detected\n"), "mpirun has detected");
        assert_eq!(first_words("\n"), "no message");
    }
}
