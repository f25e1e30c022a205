//! Cases that strain the scheme, each with the bounds that it must keep; and scenes drawn at
//! random, none of which may end in NaN, a hang, a panic, or with a change of energy that no message reports.
//!
//! Cases that take long run where `HARD_CASES=all` is set, as `.ci/run` does;
//! `PROPTEST_CASES=100000 cargo test --release --test hard_cases search` searches further, and
//! `VALID_SCENES=5000 cargo test --release --test hard_cases valid` over all that a scene may name.

mod alarms;
mod cases;
mod estimates;
mod found;
#[path = "../common/impact_scenes.rs"]
mod impact_scenes;
#[path = "../common/random_scenes.rs"]
mod random_scenes;
mod search;
mod valid;
#[path = "../common/valid_scenes.rs"]
mod valid_scenes;
mod verdict;

use cases::CASES;
use cases::scenes;

/// Runs one case; a long one only where that is asked for.
fn check(name: &str) {
    let all = std::env::var("HARD_CASES").is_ok_and(|v| v == "all");
    let (_, measure, long) = CASES.iter().find(|(known, ..)| *known == name).expect("a case");
    if *long && !all {
        return;
    }
    let figures = measure();
    assert!(!figures.is_empty());
    let broken: Vec<String> = figures
        .iter()
        .filter(|f| f.value.is_nan() || f.value.abs() > f.bound)
        .map(|f| format!("{}: {:e}, allowed: {:e}", f.what, f.value, f.bound))
        .collect();
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

macro_rules! tests {
    ($($name:ident),* $(,)?) => {
        $(#[test]
        fn $name() {
            check(stringify!($name));
        })*

        #[test]
        fn every_case_is_a_test() {
            let mut tested = [$(stringify!($name)),*];
            let mut cases: Vec<&str> = CASES.iter().map(|(name, ..)| *name).collect();
            tested.sort_unstable();
            cases.sort_unstable();
            assert_eq!(cases, tested);
        }
    };
}

tests!(
    viscosity,
    particles_a_cell,
    irregular,
    shifted_grid,
    speeds,
    impedances,
    separation,
    courant,
    translation,
    mirror_and_shift,
    units,
    galilean,
    one_body_of_two,
    fifty_transits,
    borders,
    odd_times,
    tiny_bodies,
    rarefaction,
    cold_start,
    standing_wave,
    plane,
    debris,
    effects,
    scales,
    denormals,
);
