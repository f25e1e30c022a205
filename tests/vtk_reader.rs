//! `results.hdf5` is read by VTK's own reader, and equals the CSV to the bit.
//!
//! `FLYER_MPM_VTK_PYTHON` names a Python that has the package vtk; `scripts/test.sh` sets it.

use std::path::Path;
use std::process::Command;
use std::sync::Mutex;

use flyer_mpm::driver::output::csv;
use flyer_mpm::driver::output::decomposition::DecompositionSummary;
use flyer_mpm::driver::output::summary::{Energy, Momentum, ProfileSummary, Summary};
use flyer_mpm::driver::output::vtkhdf::{RESULTS_FILE, RunInfo, write_vtkhdf};
use flyer_mpm::scene::{Decomposition, FilterHalo};
use flyer_mpm::simulation::{ParticleTable, TableColumn};
use serde_json::json;

/// One test at a time: a process that is started while another thread writes HDF5 inherits that
/// file's lock, and the reader is refused.
static ALONE: Mutex<()> = Mutex::new(());

/// A profile of `rows` particles in two materials; values of many magnitudes, one column with
/// holes.
fn table(dimension: usize, time: f64, rows: usize) -> ParticleTable {
    let coordinates = ["x", "y"].into_iter().take(dimension).map(|name| (name, "m"));
    let rest = [
        ("pressure", "Pa"),
        ("velocity", "m/s"),
        ("density", "kg/m3"),
        ("specific_internal_energy", "J/kg"),
        ("artificial_viscosity", "Pa"),
        ("temperature", "K"),
    ];
    let value = |column: usize, row: usize| match (column + row) % 7 {
        0 if column > dimension => 0.0,
        1 if column > dimension => -0.0,
        _ if column == dimension + 5 && row.is_multiple_of(3) => f64::NAN,
        k => (row as f64 + 0.1 * time) / 3.0 * 10_f64.powi(4 * k as i32 - 14),
    };
    let columns = coordinates.chain(rest).enumerate().map(|(i, (name, unit))| TableColumn {
        name: name.into(),
        unit: unit.into(),
        values: (0..rows).map(|row| value(i, row)).collect(),
    });
    ParticleTable {
        time,
        dimension,
        ids: (0..rows as u64).rev().collect(),
        material: (0..rows as u32).map(|row| row % 2).collect(),
        materials: vec!["aluminium".into(), "copper, hard".into()],
        body: vec![0; rows],
        half_edges: Vec::new(),
        columns: columns.collect(),
    }
}

/// Writes what a run writes, as far as the script reads it.
fn write_run(folder: &Path, tables: &[ParticleTable]) {
    let times: Vec<f64> = tables.iter().map(|t| t.time).collect();
    let scene = json!({"materials": {"aluminium": {}, "copper, hard": {}}});
    let mut profiles = Vec::new();
    for (table, file) in tables.iter().zip(csv::profile_names(&times)) {
        csv::write_profile(&folder.join(&file), table).unwrap();
        profiles.push(ProfileSummary {
            time: table.time,
            file,
            state_sha256: String::new(),
            errors: None,
            errors_cell_averaged: None,
        });
    }
    let info = RunInfo {
        title: "test",
        scene: &scene,
        materials: &["aluminium".into(), "copper, hard".into()],
        bodies: &["plate".into()],
        axisymmetric: false,
    };
    let tables: Vec<&ParticleTable> = tables.iter().collect();
    write_vtkhdf(&folder.join(RESULTS_FILE), &tables, &info).unwrap();
    let summary = Summary {
        format: flyer_mpm::driver::output::summary::SUMMARY_FORMAT,
        title: "test".into(),
        version: String::new(),
        commit: None,
        machine: String::new(),
        origin: None,
        scene,
        ranks: 1,
        threads: 1,
        patches: vec![1],
        particles: 0,
        cells: 0,
        steps: 0,
        wall_seconds: 0.0,
        loop_cpu_seconds: 0.0,
        loop_wall_seconds: 0.0,
        cpu_seconds: 0.0,
        particle_steps_per_cpu_second: 0.0,
        phase_seconds: [].into(),
        decomposition: DecompositionSummary::new(
            FilterHalo::Redundant,
            &Decomposition::default(),
            1,
            0,
            0,
            Vec::new(),
        ),
        effects: Vec::new(),
        failure: None,
        energy: Energy::new([0.0; 2], [0.0; 2], 0.0, 0.0),
        momentum: Momentum::new(&[0.0], &[0.0], &[0.0], 0.0),
        outflow: None,
        erosion: None,
        method_choice: None,
        measured: Vec::new(),
        gauges: Vec::new(),
        profiles,
        error_estimate: None,
        plan: None,
        warnings: vec![],
    };
    summary.write(folder).unwrap();
}

/// Runs the script for profiles on a folder; none where there is no VTK.
fn read_with_vtk(folder: &Path) -> Option<(bool, String)> {
    read_with("read_vtkhdf.py", folder)
}

/// Runs a script on a folder; none where there is no VTK.
fn read_with(script: &str, folder: &Path) -> Option<(bool, String)> {
    let Some(python) = std::env::var_os("FLYER_MPM_VTK_PYTHON") else {
        eprintln!("skipped: FLYER_MPM_VTK_PYTHON names no Python with vtk (see scripts/test.sh)");
        return None;
    };
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(script);
    let output = Command::new(python).arg(script).arg(folder).output().unwrap();
    let text = [output.stdout, output.stderr].concat();
    Some((output.status.success(), String::from_utf8_lossy(&text).into_owned()))
}

#[test]
fn vtk_reads_every_time_step_in_one_and_two_dimensions() {
    let _alone = ALONE.lock();
    for dimension in [1, 2] {
        let home = tempfile::tempdir().unwrap();
        // Outflow makes the steps unlike in length.
        let tables = [(0.0, 60), (2e-7, 60), (5e-7, 41), (1e-6, 1)];
        let tables = tables.map(|(time, rows)| table(dimension, time, rows));
        write_run(home.path(), &tables);
        let Some((passed, text)) = read_with_vtk(home.path()) else { return };
        assert!(passed, "{dimension}-D: {text}");
        assert!(text.contains("4 time steps read"), "{text}");
    }
}

#[test]
fn the_script_sees_a_wrong_bit() {
    let _alone = ALONE.lock();
    let home = tempfile::tempdir().unwrap();
    let mut tables = [table(1, 0.0, 20), table(1, 1e-6, 20)];
    write_run(home.path(), &tables);
    let wrong = &mut tables[1].columns[2].values[7];
    *wrong = wrong.next_up();
    csv::write_profile(&home.path().join("profile_1.000us.csv"), &tables[1]).unwrap();
    let Some((passed, text)) = read_with_vtk(home.path()) else { return };
    assert!(!passed, "{text}");
    assert!(text.contains("profile_1.000us.csv: velocity of row 7"), "{text}");
}

/// Frames that a run has written, on a line with strength of materials and in an axisymmetric domain.
#[test]
fn vtk_reads_the_fields_of_a_run() {
    let _alone = ALONE.lock();
    let inputs = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs");
    let runs = [
        ("flyer_strength.json", ["domain.cell_size=2e-5", "time.end=1e-7"], "1e-8"),
        ("taylor_bar.json", ["domain.cell_size=8e-4", "time.end=4e-6"], "1e-6"),
    ];
    for (scene, sets, every) in runs {
        let home = tempfile::tempdir().unwrap();
        let fields = format!(r#"output={{"fields":{{"every":{every},"format":"both"}}}}"#);
        let mut run = Command::new(env!("CARGO_BIN_EXE_flyer-mpm"));
        run.arg(inputs.join(scene)).args(["--quiet", "--output", "run", "--set", &fields]);
        for set in sets {
            run.args(["--set", set]);
        }
        let output = run.current_dir(home.path()).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let read = read_with("read_fields.py", &home.path().join("run"));
        let Some((passed, text)) = read else { return };
        assert!(passed && text.contains("frames read"), "{scene}: {text}");
    }
}
