//! Runs that continue from a random step, with other ranks, threads and patches before and after.

use super::metal::metal;
use super::runs::{folder, good, left, scene, steps, with};
use calibration::random::Random;

use crate::bounds::reliability as bounds;
use crate::table::Table;

/// Restarts of each scene.
const RESTARTS: u64 = bounds::restarts::SAME_BITS.number() as u64;

/// Ranks before and after.
const RANKS: u64 = 4;

/// Scenes that are cut short, and the layouts that they are run on. The files of fields are written:
/// their data are the same, too.
fn scenes() -> [(&'static str, Vec<String>, [&'static str; 3]); 4] {
    let flyer = ["time.end=3e-7", "output.profiles.times=[1e-7,2e-7,3e-7]"];
    let histories = "output.histories={\"interval\":1e-8}";
    let plate = ["domain.cell_size=1e-4", "time.end=2.5e-7", "output.profiles.times=[1e-7,2.5e-7]"];
    let soft = ["time.end=2e-7", "output.profiles.times=[1e-7,2e-7]"];
    let line = ["[1]", "[7]", "[16]"];
    let copper = format!("materials.copper={}", metal(8930.0, 3940.0, 1e9));
    let aluminium = format!("materials.aluminium={}", metal(2785.0, 5386.0, 0.5e9));
    let effects = [
        &copper,
        &aluminium,
        "reference=null",
        "domain.cell_size=2e-5",
        "domain.upper=[0.002]",
        "bodies.target.box.upper=[0.002]",
        "time.end=6e-7",
        "output.profiles.times=[3e-7,6e-7]",
        "boundary.x_upper=wall",
        "boundary.temperature={\"x_upper\":400}",
        "body_force={\"gravity\":[-9.81]}",
    ];
    let of = |name: &str, sets: &[&str]| scene(name, &[sets, &["output.hdf5=true"]].concat());
    [
        ("flyer", of("flyer", &flyer), line),
        ("soft_flyer", of("soft_flyer", &soft), line),
        (
            "flyer_2d",
            of("flyer_2d", &[&plate[..], &[histories]].concat()),
            ["[1,1]", "[3,2]", "[4,4]"],
        ),
        ("soft_flyer with every effect that fits it", of("soft_flyer", &effects), line),
    ]
}

/// Each scene, broken at random steps.
pub fn check(table: &mut Table) {
    let mut random = Random::new(1);
    for (name, args, patches) in scenes() {
        let home = folder("restarts").join(name);
        let place = |role: &str| home.join(role).display().to_string();
        let figure = format!("{name}: restarts with the same bits");
        let whole = good(1, &with(&args, &["--output", &place("whole")]));
        let whole = whole.and_then(|()| left(&home.join("whole")));
        let Some(whole) = table.take(&figure, whole) else { continue };
        let all = steps(&home.join("whole"));
        let mut same = 0;
        for k in 0..RESTARTS {
            let step = 1 + random.below(all - 1);
            let (before, after) = ((k % RANKS) as usize + 1, (k / RANKS % RANKS) as usize + 1);
            let [first, then] = [0, 1].map(|_| patches[random.below(3) as usize]);
            let threads = (1 + random.below(2)).to_string();
            let when = format!("output.checkpoint={{\"every_steps\":{step},\"keep\":999}}");
            let cut = format!("domain.patches={first}");
            let broken = place("broken");
            let run = ["--output", &broken, "--set", &when, "--set", &cut];
            let from = format!("{broken}.checkpoints/checkpoint-000001.hdf5");
            let cut = format!("domain.patches={then}");
            let on = ["--restart", &from, "--set", &cut, "--threads", &threads];
            let on = with(&with(&[], &on), &["--output", &place("again")]);
            let outcome = good(before, &with(&args, &run)).and_then(|()| good(after, &on));
            let outcome = outcome.and_then(|()| left(&home.join("again")));
            let what = match outcome {
                Ok(again) => again.differs(&whole),
                Err(message) => Some(message),
            };
            let _ = std::fs::remove_dir_all(format!("{broken}.checkpoints"));
            match what {
                None => same += 1,
                Some(what) => println!(
                    "  step {step} of {all}, ranks {before} to {after}, patches {first} to {then}: {what}"
                ),
            }
        }
        table.all(&figure, same, bounds::restarts::SAME_BITS);
    }
}
