//! The tests of the Python package, with the program of this build.
//!
//! `FLYER_MPM_VTK_PYTHON` names a Python that has numpy and h5py; `scripts/test.sh` sets it.

use std::path::Path;
use std::process::Command;

#[test]
fn results_are_read_from_python() {
    let Some(python) = std::env::var_os("FLYER_MPM_VTK_PYTHON") else {
        eprintln!("not run: FLYER_MPM_VTK_PYTHON is not set");
        return;
    };
    let package = Path::new(env!("CARGO_MANIFEST_DIR")).join("python");
    let ended = Command::new(python)
        .args(["-m", "unittest", "discover", "--start-directory", "tests"])
        .current_dir(&package)
        .env("PYTHONPATH", &package)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("FLYER_MPM", env!("CARGO_BIN_EXE_flyer-mpm"))
        .output()
        .expect("Python starts");
    let text = String::from_utf8_lossy(&ended.stderr);
    assert!(ended.status.success() && text.contains("Ran "), "{text}");
}
