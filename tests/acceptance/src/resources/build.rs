//! Time of a release build from clean and after a change, and of all tests.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use crate::bounds::resources::build as bounds;
use crate::program::{cargo, folder, profile_variables, root};
use crate::table::Table;

/// Builds the crates of the project in a copy of the sources, by the shipped profile; their
/// dependencies are compiled before.
pub fn check(table: &mut Table) {
    let target = folder().join("build");
    let _ = std::fs::remove_dir_all(&target);
    let copied = copy_sources(&folder().join("sources"));
    let Some(sources) = table.take("copy of the sources", copied) else { return };
    let build = || {
        let mut command = cargo("build");
        command.current_dir(&sources);
        seconds(command, &target)
    };
    let remove = || {
        let mut command = cargo("clean");
        command.current_dir(&sources).args(["-p", "flyer-mpm", "-p", "decomp", "-p", "plot"]);
        seconds(command, &target)
    };
    let clean = build().and_then(|_| remove()).and_then(|_| build());
    let Some(clean) = table.take("release build from clean", clean) else { return };
    table.check("release build from clean", Some(clean), bounds::FROM_CLEAN);
    for (file, bound) in [
        ("crates/plot/src/layout.rs", bounds::AFTER_PLOT),
        ("src/cli/materials.rs", bounds::AFTER_CLI),
        ("src/effects/erosion.rs", bounds::AFTER_EFFECT),
    ] {
        let figure = format!("release build after a change of {file}");
        let time = change(&sources.join(file)).and_then(|()| build());
        if let Some(time) = table.take(&figure, time) {
            table.check(&figure, Some(time), bound);
        }
    }
    let tests = seconds(Command::new(root().join("scripts/test.sh")), &target);
    if let Some(time) = table.take("scripts/test.sh", tests) {
        table.check("scripts/test.sh", Some(time), bounds::TESTS);
    }
}

/// Copies the sources under version control to a new folder.
fn copy_sources(folder: &Path) -> Result<PathBuf, String> {
    let failed = |error: std::io::Error| format!("{}: {error}", folder.display());
    let _ = std::fs::remove_dir_all(folder);
    let list = Command::new("git").args(["ls-files", "-z"]).current_dir(root()).output();
    let list = String::from_utf8_lossy(&list.map_err(failed)?.stdout).into_owned();
    for name in list.split('\0').filter(|name| !name.is_empty()) {
        let to = folder.join(name);
        std::fs::create_dir_all(to.parent().unwrap_or(folder)).map_err(failed)?;
        std::fs::copy(root().join(name), to).map_err(failed)?;
    }
    Ok(folder.into())
}

/// Adds a local variable before the first one of `file`: with incremental compilation, a later time
/// of change alone compiles nothing.
fn change(file: &Path) -> Result<(), String> {
    let failed = |error: std::io::Error| format!("{}: {error}", file.display());
    let text = std::fs::read_to_string(file).map_err(failed)?;
    let mut lines: Vec<&str> = text.lines().collect();
    let first = lines.iter().position(|line| line.trim_start().starts_with("let "));
    let first = first.ok_or(format!("{}: no local variable", file.display()))?;
    lines.insert(first, "let _changed = std::hint::black_box(1);");
    std::fs::write(file, lines.join("\n")).map_err(failed)
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
    #[test]
    fn a_change_is_code_of_the_first_function() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.rs");
        std::fs::write(&file, "fn f() {\n    if let _ = 0 {}\n    let a = 1;\n    let b = a;\n}\n")
            .unwrap();
        super::change(&file).unwrap();
        let changed = std::fs::read_to_string(&file).unwrap();
        assert_eq!(changed.matches("black_box").count(), 1);
        assert!(changed.contains("black_box(1);\n    let a = 1;"), "{changed}");
        std::fs::write(&file, "const A: i32 = 1;\n").unwrap();
        assert!(super::change(&file).unwrap_err().contains("no local variable"));
    }
}
