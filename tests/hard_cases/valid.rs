//! Random valid scenes: each ends well with finite numbers and energy within its bounds, is ended
//! by the monitor, or is refused by the check; never a panic and never without an end. Slow bodies
//! with a stable scheme are never ended, however cold they are or whatever tension they start in.

use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, TestRunner};
use serde_json::Value;

use crate::impact_scenes;
use crate::valid_scenes::{calm_scene, scene};
use crate::verdict::{Verdict, verdict};

/// Scenes of one search, unless `VALID_SCENES` gives their number.
const SCENES: u32 = 300;

fn cases(share: u32) -> u32 {
    let all = std::env::var("VALID_SCENES").ok().and_then(|n| n.parse().ok()).unwrap_or(SCENES);
    all / share
}

/// How many of a number of scenes ended in each way.
#[derive(Debug, Default)]
struct Count {
    well: usize,
    alarms: usize,
    refused: usize,
}

/// Runs scenes drawn by `strategy`; each alarm and each refusal is shown with `--nocapture`.
fn search(strategy: impl Strategy<Value = Value>, number: u32, alarms: bool) -> Count {
    let mut runner = TestRunner::new_with_rng(
        Config::default(),
        proptest::test_runner::TestRng::deterministic_rng(
            proptest::test_runner::RngAlgorithm::ChaCha,
        ),
    );
    let mut count = Count::default();
    let mut wrong = Vec::new();
    for k in 0..number {
        let value = strategy.new_tree(&mut runner).expect("a scene").current();
        match std::panic::catch_unwind(|| verdict(&value, 1)) {
            Ok(Verdict::Well(_)) => count.well += 1,
            Ok(Verdict::Refused(why)) => {
                count.refused += 1;
                println!("{k} refused: {why}");
            }
            Ok(Verdict::Alarm(why)) => {
                count.alarms += 1;
                println!("{k} alarm: {why}");
                if !alarms {
                    wrong.push(format!("{k}: {why}\n{value}"));
                }
            }
            Ok(Verdict::Wrong(what)) => wrong.push(format!("{k}: {what}\n{value}")),
            Err(_) => wrong.push(format!("{k}: a panic\n{value}")),
        }
    }
    println!("{count:?}");
    let shown: Vec<&String> = wrong.iter().take(5).collect();
    assert!(wrong.is_empty(), "{} of {number}: {shown:#?}", wrong.len());
    count
}

#[test]
fn valid_scenes_end_well_or_say_why() {
    let number = cases(1);
    let count = search(scene(), number, true);
    // else the search looks at nothing
    assert!(count.well as u32 > number / 5, "{count:?}");
}

#[test]
fn slow_bodies_are_never_ended() {
    let number = cases(2);
    let count = search(calm_scene(), number, false);
    assert!(count.well as u32 > number / 2, "{count:?}");
}

/// Impacts without a method get the default one, which no run-time check ends.
#[test]
fn impacts_with_the_default_method_are_never_ended() {
    let number = cases(15);
    let count = search(impact_scenes::scene(), number, false);
    assert!(count.refused == 0, "{count:?}");
}
