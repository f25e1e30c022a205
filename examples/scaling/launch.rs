//! Starts the program under mpirun, as a user does.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::configuration::{Binding, Configuration};
use crate::summary::RunSummary;

/// One configuration with everything that the program is told.
#[derive(Clone, Debug)]
pub struct Job {
    /// Ranks and threads.
    pub configuration: Configuration,
    /// How its ranks are placed.
    pub binding: Binding,
    /// Whether what is quiet is skipped.
    pub skip_quiescent: bool,
    /// The scene's file.
    pub scene: PathBuf,
    /// Overrides of the scene.
    pub sets: Vec<String>,
}

impl Job {
    /// Runs it, with its results in `folder`; the error is what the program said first.
    pub fn run(&self, folder: &Path) -> Result<RunSummary, String> {
        let Configuration { ranks, threads } = self.configuration;
        let mut command = mpirun(ranks, self.binding);
        command.arg(program()).arg(&self.scene).arg("--quiet");
        command.arg("--output").arg(folder).args(["--threads", &threads.to_string()]);
        for set in &self.sets {
            command.args(["--set", set]);
        }
        let output = started(&mut command)?;
        if !output.status.success() {
            let text = String::from_utf8_lossy(&output.stderr);
            return Err(format!(
                "{ranks} ranks x {threads} threads, {}: {}",
                output.status,
                first_words(&text)
            ));
        }
        RunSummary::read(folder)
    }
}

/// The binding wished for, or none where mpirun cannot have it here.
pub fn possible_binding(configuration: Configuration, cores: usize) -> Result<Binding, String> {
    let wished = Binding::of(configuration, cores);
    let output = started(mpirun(configuration.ranks, wished).arg("true"))?;
    Ok(if output.status.success() { wished } else { Binding::None })
}

fn mpirun(ranks: usize, binding: Binding) -> Command {
    let mut command = Command::new("mpirun");
    command.args(["--quiet", "-n", &ranks.to_string()]).args(binding.options());
    command
}

fn started(command: &mut Command) -> Result<Output, String> {
    command.output().map_err(|e| format!("cannot start {command:?}: {e}"))
}

/// What a failed run says: the program's own line, else mpirun's first that is no rule.
fn first_words(text: &str) -> &str {
    let own = text.lines().find_map(|line| line.strip_prefix("error: "));
    let other = || text.lines().find(|line| line.contains(char::is_alphabetic));
    own.or_else(other).unwrap_or("no message").trim()
}

/// The release build of the program.
fn program() -> PathBuf {
    let target = std::env::var_os("CARGO_TARGET_DIR")
        .map_or(Path::new(env!("CARGO_MANIFEST_DIR")).join("target"), PathBuf::from);
    target.join("release/flyer-mpm")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_run_is_told_by_its_own_line() {
        assert_eq!(
            first_words("warning: thin\nerror: a particle has left\n"),
            "a particle has left"
        );
        assert_eq!(first_words("-----\nmpirun has detected\n"), "mpirun has detected");
        assert_eq!(first_words("\n"), "no message");
    }
}
