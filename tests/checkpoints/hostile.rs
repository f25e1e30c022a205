//! Scenes, overrides and checkpoints that were changed at random, always the same ones: a verdict
//! of one line, never a panic.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use decomp::comm::local::run_ranks;
use decomp::{Comm, Serial};
use flyer_mpm::driver::checkpoint::file;
use flyer_mpm::input;
use flyer_mpm::scene::CheckedScene;
use flyer_mpm::simulation::{Compiled, RunError, Simulation};
use flyer_mpm::solver::Stepper;

use crate::damage::random;

/// What is put into texts.
const TOKENS: [&str; 30] = [
    "0",
    "-0.0",
    "-1",
    "1e308",
    "-1e308",
    "1e-320",
    "1e999",
    "18446744073709551616",
    "NaN",
    "null",
    "true",
    "{}",
    "[]",
    "[[]]",
    "\"\"",
    "\"\\u0000\"",
    "\"../../x\"",
    "{\"type\":",
    "]",
    "}",
    ",",
    ":",
    "\"",
    "\\",
    "\u{feff}",
    "\u{202e}",
    "\"box\":",
    "\"fmpm\"",
    "1e15",
    "0.1",
];

/// The shipped scenes that are small enough to be checked at once.
fn corpus() -> Vec<String> {
    let names = ["flyer", "soft_flyer", "piston", "sod", "noh_axis", "sliding_block", "gresho"];
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs");
    names.map(|name| fs::read_to_string(folder.join(format!("{name}.json"))).unwrap()).into()
}

/// A text with one to three changes: bytes changed, lost, doubled, swapped, or numbers and other
/// tokens replaced.
fn changed(text: &str, seed: &mut u64) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..1 + random(seed) % 3 {
        let at = random(seed) as usize % bytes.len().max(1);
        let length = random(seed) as usize % 12;
        let end = (at + length).min(bytes.len());
        let token = TOKENS[random(seed) as usize % TOKENS.len()];
        match random(seed) % 7 {
            0 if !bytes.is_empty() => bytes[at] ^= 1 << (random(seed) % 8),
            1 => drop(bytes.drain(at..end)),
            2 => {
                let piece = bytes[at..end].to_vec();
                bytes.splice(at..at, piece);
            }
            3 => bytes.truncate(at),
            _ => {
                // a number, if there is one ahead
                let digit = |b: &u8| b.is_ascii_digit();
                let Some(from) = bytes[at..].iter().position(digit).map(|k| at + k) else {
                    bytes.splice(at..end, token.bytes());
                    continue;
                };
                let part = |b: &u8| b.is_ascii_digit() || b"+-.eE".contains(b);
                let to =
                    bytes[from..].iter().position(|b| !part(b)).map_or(bytes.len(), |k| from + k);
                bytes.splice(from..to, token.bytes());
            }
        }
    }
    bytes
}

/// Asserts that a verdict is reached, and that a refusal has one line, or one line for each of a few
/// faults below a heading.
#[track_caller]
fn judged<T, E: ToString>(
    what: &dyn Fn() -> String,
    verdict: impl FnOnce() -> Result<T, E>,
) -> bool {
    match catch_unwind(AssertUnwindSafe(verdict)) {
        Ok(Ok(_)) => true,
        Ok(Err(error)) => {
            let text = error.to_string();
            let lines: Vec<&str> = text.lines().collect();
            let faults = lines.iter().skip(1).all(|line| line.starts_with("  "));
            assert!(faults && lines.len() <= 22, "{}: {text}", what());
            assert!(lines.iter().all(|line| line.len() < 4000), "{}: {text}", what());
            false
        }
        Err(_) => panic!("it panics: {}", what()),
    }
}

#[test]
fn changed_scenes() {
    let corpus = corpus();
    let (mut seed, mut taken) = (3, 0);
    for round in 0..4000 {
        let text = changed(&corpus[round % corpus.len()], &mut seed);
        let printed = || String::from_utf8_lossy(&text).into_owned();
        taken += usize::from(judged(&printed, || input::parse(&text, "scene.json", &[])));
    }
    // some changes are within what is allowed: the rest of the check is reached as well
    assert!((100..3000).contains(&taken), "{taken}");
}

#[test]
fn changed_overrides() {
    let text = corpus().remove(0).into_bytes();
    let sets = [
        "domain.cell_size=5e-6",
        "bodies.flyer.velocity=[500]",
        "materials.\"copper\".density=8930",
        "output.checkpoint={\"every_steps\":7,\"at_times\":[1e-7]}",
        "output.profiles.times[1]=6e-7",
    ];
    let mut seed = 4;
    for round in 0..3000 {
        let set =
            String::from_utf8_lossy(&changed(sets[round % sets.len()], &mut seed)).into_owned();
        let printed = || format!("--set {set}");
        judged(&printed, || input::parse(&text, "scene.json", std::slice::from_ref(&set)));
        let allowed = flyer_mpm::driver::checkpoint::fit::CHANGEABLE;
        judged(&printed, || input::parse_changed(&text, "c", std::slice::from_ref(&set), &allowed));
    }
}

#[test]
fn changed_checkpoints() {
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("c.hdf5");
    let whole = crate::damage::written(&path);
    let mut seed = 5;
    for _ in 0..1000 {
        let mut bytes = whole.clone();
        let at = random(&mut seed) as usize % bytes.len();
        let to = (at + random(&mut seed) as usize % 5000).min(bytes.len());
        match random(&mut seed) % 4 {
            0 => drop(bytes.drain(at..to)),
            1 => bytes[at..to].fill(0),
            2 => bytes.rotate_left(at.max(1)),
            _ => bytes[at..to].iter_mut().for_each(|b| *b ^= random(&mut seed) as u8 | 1),
        }
        if bytes == whole {
            continue;
        }
        fs::write(&path, &bytes).unwrap();
        assert!(!judged(&|| format!("at {at} to {to}"), || file::read(&Serial, &path)));
    }
}

/// What would not fit into the machine is refused before it is made.
#[test]
fn too_much_is_reported_before_it_is_taken() {
    const LEFT: Option<u64> = Some(8 << 30);
    let text = |name: &str| {
        fs::read(format!("{}/inputs/{name}.json", env!("CARGO_MANIFEST_DIR"))).unwrap()
    };
    let printed = |verdict: Result<(), input::SceneError>| {
        let error = verdict.unwrap_err().to_string();
        let words = ["need about ", "GiB of memory; allowed: 8.0 GiB", "--ignore-memory"];
        assert!(words.iter().all(|w| error.contains(w)), "{error}");
    };
    // particles at the borders of disks are made as the scene is read
    let size = |set: &str, left| input::check_size(&text("disks"), "s", &[set.to_string()], left);
    let border = "bodies.lower.particles_per_cell=[3000000,3000000]";
    printed(size(border, LEFT));
    size(border, None).unwrap();
    size(border, Some(1 << 40)).unwrap();
    size("domain.cell_size=5e-5", LEFT).unwrap();
    for (name, set) in [
        ("disks", "domain.cell_size=5e-5"),
        ("disks", "bodies.lower.particles_per_cell=[300,300]"),
        ("flyer", "bodies.flyer.particles_per_cell=[1000000]"),
        ("flyer", "domain.cell_size=1e-10"),
        ("flyer_2d", "domain.patches=[300,180]"),
    ] {
        let scene = input::parse(&text(name), "s", &[set.to_string()]).unwrap();
        printed(scene.check_memory(LEFT));
        scene.check_memory(None).unwrap();
    }
}

/// Begins a run of a changed scene on ranks of this process; what ends it.
fn begun<const D: usize>(scene: &CheckedScene, ranks: usize) -> Result<(), String>
where
    Stepper<D>: Compiled<D>,
{
    fn of_rank<const D: usize>(scene: &CheckedScene, comm: &dyn Comm) -> Result<(), RunError>
    where
        Stepper<D>: Compiled<D>,
    {
        let mut simulation = Simulation::<D>::new(scene, comm, 1)?;
        for _ in 0..3 {
            if simulation.time() < scene.scene.time.end {
                simulation.advance(scene.scene.time.end)?;
            }
        }
        Ok(())
    }
    let ends = run_ranks(ranks, |comm| match of_rank::<D>(scene, comm) {
        // one rank alone knows of it, and ends all in the program
        Err(RunError::Exchange(error)) => panic!("{LOST}{error}"),
        end => end,
    });
    let failed = ends.iter().filter(|end| end.is_err()).count();
    assert!(failed == 0 || failed == ends.len(), "all ranks end alike: {ends:?}");
    ends.into_iter().try_for_each(|end| end.map_err(|error| error.to_string()))
}

/// Begins the message of a rank that ends all.
const LOST: &str = "a row is lost: ";

/// Scenes that pass in spite of a change are run for some steps, on two ranks: they go on, or all
/// ranks end with a message. FLYER_MPM_MUTANTS sets how many are made, FLYER_MPM_MUTANT_RANKS on how
/// many ranks they run.
#[test]
fn changed_scenes_on_two_ranks() {
    let set = |name: &str| std::env::var(name).ok().and_then(|n| n.parse().ok());
    let ranks = set("FLYER_MPM_MUTANT_RANKS").unwrap_or(2);
    let corpus = corpus();
    let (mut seed, mut ran) = (6, 0);
    for round in 0..set("FLYER_MPM_MUTANTS").unwrap_or(600) {
        let text = changed(&corpus[round % corpus.len()], &mut seed);
        if input::check_size(&text, "scene.json", &[], Some(64 << 20)).is_err() {
            continue;
        }
        let Ok(scene) = input::parse(&text, "scene.json", &[]) else { continue };
        if scene.check_memory(Some(64 << 20)).is_err() {
            continue;
        }
        ran += 1;
        let end = catch_unwind(AssertUnwindSafe(|| match scene.dimension {
            1 => begun::<1>(&scene, ranks),
            _ => begun::<2>(&scene, ranks),
        }));
        let printed = String::from_utf8_lossy(&text);
        match end {
            Ok(Ok(())) => {}
            Ok(Err(error)) => assert_eq!(error.lines().count(), 1, "{error}: {printed}"),
            Err(fault) => {
                let word = fault.downcast_ref::<String>().map_or("", String::as_str);
                assert!(word.starts_with(LOST), "it panics, {word}: {printed}");
            }
        }
    }
    assert!(ran >= 20, "{ran}");
}
