//! Scenes drawn at random: each is refused, ended by the monitor, or ends well; alike on 1 to 4
//! ranks.

use proptest::prelude::*;
use proptest::sample::select;
use serde_json::{Value, json};

use crate::random_scenes::scene;
use crate::verdict::{Verdict, verdict};

/// Scenes of one search, unless `PROPTEST_CASES` says otherwise.
const SCENES: u32 = 1000;

fn cases() -> u32 {
    std::env::var("PROPTEST_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(SCENES)
}

/// A scene of any Courant number, with 1 to 16 particles a cell, with and without contact, and with
/// what is cured by a watch that redoes.
fn hard_scene() -> impl Strategy<Value = Value> {
    let count = select(&[0usize, 0, 0, 1, 4, 8, 16][..]);
    let parts = (scene(), 0.05..=1.0, count, any::<bool>(), prop::bool::weighted(0.1));
    parts.prop_map(|(mut scene, courant, count, contact, redo)| {
        scene["time"]["courant"] = json!(courant);
        for body in scene["bodies"].as_array_mut().expect("bodies") {
            if count > 0 {
                body["particles_per_cell"] = json!([count]);
            }
        }
        if contact {
            scene["contact"] = json!({"type": "frictionless"});
        }
        let alarm = if redo { "redo" } else { "stop" };
        scene["monitor"] = json!({"on_courant_exceeded": "reduce", "on_alarm": alarm});
        scene
    })
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: cases(),
        failure_persistence: None,
        max_shrink_iters: 300,
        ..ProptestConfig::default()
    })]

    #[test]
    fn search_for_faults_without_a_message(scene in hard_scene(), ranks in 1usize..=4) {
        let end = verdict(&scene, 1);
        if let Verdict::Wrong(what) = &end {
            prop_assert!(false, "{what}\n{scene}");
        }
        if ranks > 1 {
            prop_assert_eq!(verdict(&scene, ranks), end, "{} ranks\n{}", ranks, scene);
        }
    }
}
