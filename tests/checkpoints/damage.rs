//! A checkpoint comes back from its file as it was, or not at all.

use std::fs;
use std::path::{Path, PathBuf};

use decomp::comm::local::run_ranks;
use decomp::{Census, Comm, Serial, StoredParticles};
use flyer_mpm::driver::checkpoint::seal::HEAD;
use flyer_mpm::driver::checkpoint::{
    Checkpoint, CheckpointContents, CheckpointError, Due, StateColumn, file, folder, profiles,
};
use flyer_mpm::driver::figures::{DiagramQuantity, WaveRow};
use flyer_mpm::driver::output::histories::HistoryTable;
use flyer_mpm::driver::output::origin::{Origin, RUN};
use flyer_mpm::scene::{MethodChoice, Preset};
use flyer_mpm::simulation::Saved;
use flyer_mpm::simulation::monitor::{Peaks, SelfContactEvent};
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
            digest: "0123".into(),
            peaks: Peaks::of([1.5, 2e6, 0.1 + 0.2, 1.0 / 3.0, 0.0, 0.7 / 3.0, 1e-3]),
            self_contact: Some(SelfContactEvent {
                time: 0.1 + 0.2,
                body: 1,
                place: [1.0 / 3.0, -0.7],
                gap: 0.9,
            }),
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
            frames: 4,
            quantities: ["velocity", "damage"]
                .map(|name| DiagramQuantity { name: name.into(), unit: "m/s".into() })
                .into(),
            arrivals: Vec::new(),
        },
        record: Default::default(),
    };
    checkpoint.record.tables = vec![(table.clone(), "00ff".into()), (table, "ab".into())];
    let waves = |time, x, pressure, others: [Vec<f64>; 2]| WaveRow {
        time,
        x,
        pressure,
        others: others.into(),
    };
    checkpoint.record.waves = vec![
        waves(0.0, vec![0.0, 2.0], vec![1.0, 3.0], [vec![5.0, 6.0], vec![]]),
        waves(0.5, vec![], vec![], [vec![], vec![]]),
        waves(0.6, vec![4.0], vec![-0.0], [vec![7.0], vec![8.0]]),
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
    file::write(&Serial, path, &contents(&example())).unwrap();
    fs::read(path).unwrap()
}

#[test]
fn all_comes_back() {
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("c.hdf5");
    let bytes = written(&path);
    // NaN has no place in it, so equal is equal to the bit but for the sign of zero
    let back = file::read(&Serial, &path).unwrap();
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
    file::write(&Serial, &path, &contents(&empty)).unwrap();
    assert_eq!(file::read(&Serial, &path).unwrap(), empty);
}

#[track_caller]
fn is_damaged(path: &Path, what: &str) {
    match file::read(&Serial, path) {
        Err(CheckpointError::Damaged { .. }) => {}
        other => panic!("{what}: {other:?}"),
    }
}

/// The particles of each rank, in any shares, come back as those of all ranks.
#[test]
fn ranks_write_and_read_their_shares() {
    let home = tempfile::tempdir().unwrap();
    let whole = example();
    let part = |rank: usize, ranks: usize| {
        let particles = &whole.saved.particles;
        let mine = |r: &usize| r * ranks / 3 == rank;
        let which: Vec<usize> = (0..3).filter(mine).collect();
        StoredParticles {
            ids: which.iter().map(|&r| particles.ids[r]).collect(),
            cells: which
                .iter()
                .flat_map(|&r| [particles.cells[2 * r], particles.cells[2 * r + 1]])
                .collect(),
            columns: particles
                .columns
                .iter()
                .map(|c| which.iter().map(|&r| c[r]).collect())
                .collect(),
        }
    };
    for (writers, readers) in [(1, 3), (2, 1), (3, 5), (5, 2)] {
        let path = home.path().join(format!("{writers}.hdf5"));
        run_ranks(writers, |comm| {
            let mut mine = whole.clone();
            mine.saved.particles = part(comm.rank(), writers);
            if comm.rank() > 0 {
                mine.record = Default::default();
            }
            file::write(comm, &path, &contents(&mine)).unwrap();
        });
        let back = run_ranks(readers, |comm| file::read(comm, &path).unwrap());
        let first = back[0].clone();
        let shares = back.into_iter().map(|c| c.saved);
        let saved = Saved::joined(shares.collect()).unwrap();
        assert_eq!(Checkpoint { saved, ..first }, whole, "{writers} and {readers} ranks");
    }
}

/// A share that cannot be written is an error on all ranks, with the message at rank 0.
#[test]
fn a_share_that_is_not_written_fails_on_all_ranks() {
    let errors = run_ranks(3, |comm| {
        let place = if comm.rank() == 0 { "/proc/none" } else { "" };
        let error = folder::write(comm, Path::new(place), 2, &contents(&example())).unwrap_err();
        error.to_string()
    });
    assert!(errors[0].contains("/proc/none"), "{errors:?}");
    assert!(errors[1..].iter().all(|e| e.contains("another rank")), "{errors:?}");
}

/// Files of profiles beside checkpoints.
fn profiles(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let is_one =
        |path: &PathBuf| profiles::is_profile(&path.file_name().unwrap().to_string_lossy());
    entries.filter(is_one).collect()
}

/// A profile has a file of its own, which is written once, and whose loss or damage is reported.
#[test]
fn a_profile_is_written_once() {
    let home = tempfile::tempdir().unwrap();
    let place = home.path().join("checkpoints");
    let mut checkpoint = example();
    let table = checkpoint.record.tables.remove(1).0;
    let [first, second, third] = [0, 1, 2].map(|k| {
        let more = if k == 1 { Some((table.clone(), "cd".into())) } else { None };
        checkpoint.record.tables.extend(more);
        let path = folder::write(&Serial, &place, 9, &contents(&checkpoint)).unwrap();
        let files = profiles(&place);
        let at = |path: &PathBuf| (path.clone(), fs::metadata(path).unwrap().modified().unwrap());
        (path, files.iter().map(at).collect::<Vec<_>>())
    });
    assert_eq!([&first.1, &second.1].map(Vec::len), [1, 2]);
    assert!(second.1.contains(&first.1[0]) && third.1 == second.1, "written again");
    // of a lost or damaged profile the checkpoints without it can be read
    let added = second.1.iter().find(|file| !first.1.contains(file)).unwrap().0.clone();
    let bytes = fs::read(&added).unwrap();
    let earlier = || {
        let (found, path, notes) = folder::open(&Serial, &place).unwrap();
        assert_eq!((found.record.tables.len(), path, notes.len()), (1, first.0.clone(), 2));
        notes[0].clone()
    };
    fs::remove_file(&added).unwrap();
    let note = earlier();
    assert!(note.contains("no longer beside it") && !note.contains('\n'), "{note}");
    for (k, at) in (0..bytes.len()).step_by(97).enumerate() {
        let mut changed = bytes.clone();
        changed[at] ^= 1 << (k % 8);
        fs::write(&added, if k % 9 == 8 { &bytes[..at] } else { &changed }).unwrap();
        let note = earlier();
        assert!(note.contains(&*added.to_string_lossy()) && !note.contains('\n'), "{note}");
    }
    // another profile under its name
    fs::copy(&first.1[0].0, &added).unwrap();
    assert!(earlier().contains("it is another profile"));
    // a run that still has the profile writes it again
    fs::remove_file(&added).unwrap();
    folder::write(&Serial, &place, 9, &contents(&checkpoint)).unwrap();
    assert!(fs::read(&added).unwrap() == bytes);
    assert_eq!(file::read(&Serial, &third.0).unwrap(), checkpoint);
    folder::clear(&place);
    assert!(!place.exists());
}

/// The message names the damaged column, on any number of ranks.
#[test]
fn the_damaged_part_is_named() {
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("c.hdf5");
    written(&path);
    // the last value of the first column, and one of a profile, each with the value before it: the
    // bytes of such small numbers alone stand in the structure of the file too
    for (before, value, name) in
        [(-0.0, 5e-324, "particles: mass"), (1.0, f64::MIN_POSITIVE, "columns/0001")]
    {
        written(&path);
        let damaged = match name.starts_with("particles") {
            true => path.clone(),
            false => profiles(home.path()).remove(0),
        };
        let mut bytes = fs::read(&damaged).unwrap();
        let two = [before, value].map(f64::to_ne_bytes).concat();
        let at = bytes.windows(16).position(|w| w == two).unwrap() + 8;
        bytes[at] ^= 1;
        fs::write(&damaged, &bytes).unwrap();
        for ranks in [1, 3] {
            let errors = run_ranks(ranks, |comm| file::read(comm, &path).unwrap_err().to_string());
            assert!(errors[0].contains(name) && errors[0].contains("(bytes "), "{errors:?}");
        }
        file::read_head_alone(&path).unwrap();
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
    file::read(&Serial, &path).unwrap();
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
    file::write_as(&Serial, &path, &contents(&example()), 7).unwrap();
    let error = file::read(&Serial, &path).unwrap_err().to_string();
    let version = env!("CARGO_PKG_VERSION");
    for words in ["format 7", &format!("version {version}"), "reads format 5", "c.hdf5"] {
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
        folder::write(&Serial, &place, 3, &contents(&checkpoint)).unwrap();
    }
    let found = folder::list(&place);
    assert_eq!(found.iter().map(|f| f.0).collect::<Vec<_>>(), [5, 4, 3]);
    // with two profiles, which all of them name
    assert_eq!(fs::read_dir(&place).unwrap().count(), 3 + profiles(&place).len());
    let step = |path: &Path| {
        let (checkpoint, _, notes) = folder::open(&Serial, path).unwrap();
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
    folder::write(&Serial, &place, 2, &contents(&checkpoint)).unwrap();
    assert_eq!(folder::list(&place)[0].0, 6);
    for (_, path) in folder::list(&place) {
        fs::write(path, b"").unwrap();
    }
    let error = folder::open(&Serial, &place).unwrap_err().to_string();
    assert!(error.contains("no checkpoint is whole"), "{error}");
    folder::clear(&place);
    assert!(!place.exists());
    let error = folder::open(&Serial, &place).unwrap_err().to_string();
    assert!(error.contains("No such file") && error.contains("allowed: a checkpoint"), "{error}");
}

#[test]
fn what_cannot_be_written_leaves_the_last_good_one() {
    let home = tempfile::tempdir().unwrap();
    let place = home.path().join("run.checkpoints");
    folder::write(&Serial, &place, 2, &contents(&example())).unwrap();
    // no file can be made where a folder of its name stands in the way
    fs::create_dir_all(place.join(".checkpoint-000002/x")).unwrap();
    let error = folder::write(&Serial, &place, 2, &contents(&example())).unwrap_err().to_string();
    assert!(
        error.contains("the last good checkpoint is") && error.contains("--restart"),
        "{error}"
    );
    assert_eq!(folder::open(&Serial, &place).unwrap().0, example());
    let none = folder::write(&Serial, Path::new("/proc/none"), 2, &contents(&example()));
    let error = none.unwrap_err().to_string();
    assert!(error.contains("/proc/none") && error.contains("no earlier checkpoint"), "{error}");
}
