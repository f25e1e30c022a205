//! A checkpoint comes back from its file as it was, or not at all.

use std::fs;
use std::path::Path;

use decomp::{Census, StoredParticles};
use flyer_mpm::driver::checkpoint::seal::HEAD;
use flyer_mpm::driver::checkpoint::{
    Checkpoint, CheckpointContents, CheckpointError, Due, StateColumn, file, folder,
};
use flyer_mpm::driver::figures::PressureRow;
use flyer_mpm::driver::output::histories::HistoryTable;
use flyer_mpm::driver::output::origin::{Origin, RUN};
use flyer_mpm::scene::{MethodChoice, Preset};
use flyer_mpm::simulation::Saved;
use flyer_mpm::simulation::monitor::Peaks;
use flyer_mpm::simulation::{BodyRow, ParticleTable, TableColumn};

/// A checkpoint of a few particles with all that one can hold.
fn example() -> Checkpoint {
    let named = |name: &str, values: &[f64]| TableColumn {
        name: name.into(),
        unit: "m".into(),
        values: values.to_vec(),
    };
    let table = ParticleTable {
        time: 1.5e-7,
        dimension: 2,
        ids: vec![4, 0, 7],
        material: vec![0, 1, 1],
        materials: vec!["Al 6061.T6".into(), "copper".into()],
        body: vec![0, 1, 1],
        columns: vec![named("x", &[0.1, -0.0, 3.0]), named("y", &[1.0, f64::MIN_POSITIVE, -3.0])],
        half_edges: vec![[[1.0, 2.0], [3.0, 4.0]]; 3],
    };
    let mut histories = HistoryTable::new([("time", "s"), ("interface_x", "m")]);
    histories.push(&[0.0, 0.1]);
    histories.push(&[1e-9, 1.0 / 3.0]);
    let mut checkpoint = Checkpoint {
        version: env!("CARGO_PKG_VERSION").into(),
        origin: Some(Origin::new(RUN, Path::new("Cargo.toml"))),
        method_choice: Some(MethodChoice {
            preset: Preset::Sharpest,
            reasons: vec!["FMPM(8)".into(), "two \"bodies\"".into()],
        }),
        scene: r#"{"title": "x"}"#.into(),
        dimension: 2,
        saved: Saved {
            time: 0.1 + 0.2,
            step: 1 << 60,
            stable: f64::INFINITY,
            longest: 1.0 / 3.0,
            redone_steps: 5,
            left: Census { particles: 3, marks: u64::MAX - 5 },
            sums: vec![i128::MIN, -1, 0, i128::MAX],
            peaks: Peaks::of([1.5, 2e6, 0.1 + 0.2, 1.0 / 3.0, 0.0, 0.7 / 3.0, 1e-3]),
            particles: StoredParticles {
                ids: vec![0, 3, u64::MAX],
                cells: vec![0, 1, 2, 3, -4, i32::MAX],
                columns: vec![vec![1.0, -0.0, 5e-324], vec![f64::MAX, 0.1, -1e-300]],
            },
        },
        columns: ["mass", "pressure"]
            .map(|name| StateColumn { name: name.into(), unit: "kg".into() })
            .into(),
        due: Due {
            history: 7,
            history_interval: Some(0.1),
            wave: 9,
            end: 1e-6,
            arrivals: Vec::new(),
        },
        record: Default::default(),
    };
    checkpoint.record.tables = vec![(table.clone(), "00ff".into()), (table, "ab".into())];
    checkpoint.record.waves = vec![
        PressureRow { time: 0.0, points: vec![(0.0, 1.0), (2.0, 3.0)] },
        PressureRow { time: 0.5, points: vec![] },
        PressureRow { time: 0.6, points: vec![(4.0, -0.0)] },
    ];
    let row = |time, failed| BodyRow { time, ends: vec![[0.0, 2.0], [2.0, 4.0]], failed };
    checkpoint.record.bodies =
        vec![row(0.0, vec![]), row(0.5, vec![[1.0, 1.5], [3.0, 3.0]]), row(0.6, vec![[1.0, 2.0]])];
    checkpoint.record.histories = Some(histories);
    checkpoint
}

fn contents(c: &Checkpoint) -> CheckpointContents<'_> {
    CheckpointContents {
        origin: c.origin.as_ref(),
        method_choice: c.method_choice.as_ref(),
        scene: &c.scene,
        dimension: c.dimension,
        saved: &c.saved,
        columns: &c.columns,
        due: c.due.clone(),
        tables: &c.record.tables,
        waves: &c.record.waves,
        bodies: &c.record.bodies,
        histories: c.record.histories.as_ref(),
    }
}

pub fn written(path: &Path) -> Vec<u8> {
    file::write(path, &contents(&example()), &|| {}).unwrap();
    fs::read(path).unwrap()
}

#[test]
fn all_comes_back() {
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("c.hdf5");
    let bytes = written(&path);
    // NaN has no place in it, so equal is equal to the bit but for the sign of zero
    let back = file::read(&path).unwrap();
    assert_eq!(back, example());
    let bits = |c: &Checkpoint| -> Vec<u64> {
        c.saved.particles.columns.iter().flatten().map(|v| v.to_bits()).collect()
    };
    assert_eq!(bits(&back), bits(&example()));
    // nothing in it depends on the clock or the place
    assert!(written(&home.path().join("d.hdf5")) == bytes);
    let mut empty = example();
    empty.record = Default::default();
    empty.saved.particles = StoredParticles { columns: vec![vec![]; 2], ..Default::default() };
    file::write(&path, &contents(&empty), &|| {}).unwrap();
    assert_eq!(file::read(&path).unwrap(), empty);
}

#[track_caller]
fn is_damaged(path: &Path, what: &str) {
    match file::read(path) {
        Err(CheckpointError::Damaged { .. }) => {}
        other => panic!("{what}: {other:?}"),
    }
}

/// A reproducible sequence of numbers (SplitMix64).
pub fn random(seed: &mut u64) -> u64 {
    *seed = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *seed;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[test]
fn every_loss_is_seen() {
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("c.hdf5");
    let bytes = written(&path);
    let mut seed = 1;
    let edges = [0, 1, HEAD as usize - 1, HEAD as usize, HEAD as usize + 1, bytes.len() - 1];
    let somewhere = (0..60).map(|_| random(&mut seed) as usize % bytes.len()).collect::<Vec<_>>();
    for length in edges.into_iter().chain(somewhere) {
        fs::write(&path, &bytes[..length]).unwrap();
        is_damaged(&path, &format!("cut to {length} bytes"));
    }
    fs::write(&path, [&bytes[..], b"\0"].concat()).unwrap();
    is_damaged(&path, "a byte more");
    fs::write(&path, &bytes).unwrap();
    file::read(&path).unwrap();
}

/// Every bit of the head, and many of the rest.
#[test]
fn every_changed_bit_is_seen() {
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("c.hdf5");
    let mut bytes = written(&path);
    let mut seed = 2;
    let head = (0..8 * HEAD as usize).step_by(7);
    let rest = (0..400).map(|_| random(&mut seed) as usize % (8 * bytes.len()));
    for bit in head.chain(rest.collect::<Vec<_>>()) {
        bytes[bit / 8] ^= 1 << (bit % 8);
        fs::write(&path, &bytes).unwrap();
        is_damaged(&path, &format!("bit {bit}"));
        bytes[bit / 8] ^= 1 << (bit % 8);
    }
}

#[test]
fn another_format_is_refused_in_words() {
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("c.hdf5");
    file::write_as(&path, &contents(&example()), &|| {}, 7).unwrap();
    let error = file::read(&path).unwrap_err().to_string();
    let version = env!("CARGO_PKG_VERSION");
    for words in ["format 7", &format!("version {version}"), "reads format 3", "c.hdf5"] {
        assert!(error.contains(words), "{error}");
    }
    assert!(!error.contains('\n'));
}

#[test]
fn the_last_few_stay_and_the_newest_whole_one_is_taken() {
    let home = tempfile::tempdir().unwrap();
    let place = home.path().join("run.checkpoints");
    let mut checkpoint = example();
    for step in 1..=5 {
        checkpoint.saved.step = step;
        folder::write(&place, 3, &contents(&checkpoint), &|| {}).unwrap();
    }
    let found = folder::list(&place);
    assert_eq!(found.iter().map(|f| f.0).collect::<Vec<_>>(), [5, 4, 3]);
    assert_eq!(fs::read_dir(&place).unwrap().count(), 3);
    let step = |path: &Path| {
        let (checkpoint, _, notes) = folder::open(path).unwrap();
        (checkpoint.saved.step, notes.len())
    };
    assert_eq!(step(&place), (5, 0));
    // named by the results, or one by one
    assert_eq!(step(&home.path().join("run")), (5, 0));
    assert_eq!(step(&found[2].1), (3, 0));
    assert_eq!(folder::results_of(&found[0].1), Some(home.path().join("run")));
    fs::write(&found[0].1, b"torn").unwrap();
    assert_eq!(step(&place), (4, 1));
    // the one that is next takes a number of its own
    folder::write(&place, 2, &contents(&checkpoint), &|| {}).unwrap();
    assert_eq!(folder::list(&place)[0].0, 6);
    for (_, path) in folder::list(&place) {
        fs::write(path, b"").unwrap();
    }
    let error = folder::open(&place).unwrap_err().to_string();
    assert!(error.contains("no checkpoint is whole"), "{error}");
    folder::clear(&place);
    assert!(!place.exists());
    let error = folder::open(&place).unwrap_err().to_string();
    assert!(error.contains("No such file") && error.contains("allowed: a checkpoint"), "{error}");
}

#[test]
fn what_cannot_be_written_leaves_the_last_good_one() {
    let home = tempfile::tempdir().unwrap();
    let place = home.path().join("run.checkpoints");
    folder::write(&place, 2, &contents(&example()), &|| {}).unwrap();
    // no file can be made where a folder of its name stands in the way
    fs::create_dir_all(place.join(".checkpoint-000002/x")).unwrap();
    let error = folder::write(&place, 2, &contents(&example()), &|| {}).unwrap_err().to_string();
    assert!(
        error.contains("the last good checkpoint is") && error.contains("--restart"),
        "{error}"
    );
    assert_eq!(folder::open(&place).unwrap().0, example());
    let none = folder::write(Path::new("/proc/none"), 2, &contents(&example()), &|| {});
    let error = none.unwrap_err().to_string();
    assert!(error.contains("/proc/none") && error.contains("no earlier checkpoint"), "{error}");
}
