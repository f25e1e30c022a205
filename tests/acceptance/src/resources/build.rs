//! Time of a release build from clean and after a change, and of all tests.

use std::fs::File;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Instant, SystemTime};

use crate::bounds::resources::build as bounds;
use crate::program::{cargo, folder, profile_variables, root};
use crate::table::Table;

/// Builds in a target folder of its own, by the shipped profile.
pub fn check(table: &mut Table) {
    let target = folder().join("build");
    let _ = std::fs::remove_dir_all(&target);
    let build = || seconds(cargo("build"), &target);
    let Some(clean) = table.take("release build from clean", build()) else { return };
    table.check("release build from clean", Some(clean), bounds::FROM_CLEAN);
    for (file, bound) in [
        ("src/plot/mod.rs", bounds::AFTER_PLOT),
        ("src/cli/mod.rs", bounds::AFTER_CLI),
        ("src/effects/erosion.rs", bounds::AFTER_EFFECT),
    ] {
        let figure = format!("release build after a change of {file}");
        let time = touched(&root().join(file), build);
        if let Some(time) = table.take(&figure, time) {
            table.check(&figure, Some(time), bound);
        }
    }
    let tests = seconds(Command::new(root().join("scripts/test.sh")), &target);
    if let Some(time) = table.take("scripts/test.sh", tests) {
        table.check("scripts/test.sh", Some(time), bounds::TESTS);
    }
}

/// Result of `build` while `file` looks changed; its time of change is restored.
fn touched<T>(file: &Path, build: impl Fn() -> Result<T, String>) -> Result<T, String> {
    let failed = |error| format!("{}: {error}", file.display());
    let opened = File::options().append(true).open(file).map_err(failed)?;
    let before = opened.metadata().and_then(|data| data.modified()).map_err(failed)?;
    opened.set_modified(SystemTime::now()).map_err(failed)?;
    let result = build();
    opened.set_modified(before).map_err(failed)?;
    result
}

/// Wall time of a command \[s\] with a target folder and the profiles of Cargo.toml.
fn seconds(mut command: Command, target: &Path) -> Result<f64, String> {
    for variable in profile_variables() {
        command.env_remove(variable);
    }
    let start = Instant::now();
    let status = command.env("CARGO_TARGET_DIR", target).stdout(Stdio::null()).status();
    match status {
        Ok(status) if status.success() => Ok(start.elapsed().as_secs_f64()),
        Ok(status) => Err(format!("{command:?}: {status}")),
        Err(error) => Err(format!("{command:?}: {error}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_touched_file_looks_new_during_the_build_and_old_after_it() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let old = SystemTime::UNIX_EPOCH + std::time::Duration::from_secs(1000);
        file.as_file().set_modified(old).unwrap();
        let modified = || file.path().metadata().unwrap().modified().unwrap();
        let during = touched(file.path(), || Ok(modified())).unwrap();
        assert!(during > old);
        assert_eq!(modified(), old);
    }
}
