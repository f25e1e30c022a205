//! The program under test: its build, and how it is started.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;

/// The program that the user has named.
static NAMED: OnceLock<PathBuf> = OnceLock::new();

/// The program that cargo has built.
static BUILT: OnceLock<PathBuf> = OnceLock::new();

/// Root of the repository.
pub fn root() -> &'static Path {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    own.ancestors().nth(2).unwrap_or(own)
}

/// Folder of what the sections write: `acceptance` in cargo's target folder.
pub fn folder() -> PathBuf {
    target().join("acceptance")
}

fn target() -> PathBuf {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or(root().join("target"), PathBuf::from);
    std::path::absolute(&target).unwrap_or(target)
}

/// Takes a program that is built already.
pub fn take(program: PathBuf) {
    let _ = NAMED.set(program);
}

/// The named program, or the release build of `flyer-mpm`, built at the first call.
pub fn path() -> &'static Path {
    NAMED.get().unwrap_or_else(|| BUILT.get_or_init(build))
}

/// Ends the process where the program cannot be built or Open MPI is missing.
fn build() -> PathBuf {
    let mpirun = mpirun().arg("--version").stdout(Stdio::null()).status();
    let built = mpirun.is_ok_and(|status| status.success())
        && cargo("build").args(["--bin", "flyer-mpm"]).status().is_ok_and(|s| s.success());
    if !built {
        eprintln!(
            "error: flyer-mpm cannot be built and started; it needs Open MPI and HDF5: \
             run scripts/setup.sh"
        );
        std::process::exit(2);
    }
    target().join("release/flyer-mpm")
}

/// Variables of the environment that change the profile of `Cargo.toml`.
pub fn profile_variables() -> impl Iterator<Item = OsString> {
    let names = std::env::vars_os().map(|(name, _)| name);
    names.filter(|name| name.to_string_lossy().starts_with("CARGO_PROFILE_"))
}

/// Whether the program is built by the profile of `Cargo.toml`, as far as can be known.
pub fn has_shipped_profile() -> bool {
    NAMED.get().is_some() || profile_variables().next().is_none()
}

/// A quiet release command of cargo at the root.
pub fn cargo(command: &str) -> Command {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
    cargo.current_dir(root()).env("CARGO_TARGET_DIR", target());
    cargo.args([command, "--release", "--quiet"]);
    cargo
}

/// mpirun, as root too, and without copies by ptrace, which many containers refuse.
pub fn mpirun() -> Command {
    let mut mpirun = Command::new("mpirun");
    for variable in ["OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"] {
        mpirun.env(variable, "1");
    }
    let copies = "OMPI_MCA_btl_vader_single_copy_mechanism";
    if std::env::var_os(copies).is_none() {
        mpirun.env(copies, "none");
    }
    mpirun
}
