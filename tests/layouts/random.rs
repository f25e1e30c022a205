//! Scenes and layouts drawn at random: the same bits, or the same message, as one patch of one
//! rank that computes everything. `PROPTEST_CASES=10000 cargo test --release random` looks further.

use proptest::prelude::*;
use proptest::sample::select;

use crate::in_process::end_of;
use crate::layouts::{COSTS, HALOS, Layout};
use crate::random_scenes::{CELL, scene};

fn layout() -> impl Strategy<Value = Layout> {
    let patches = prop_oneof![1usize..=20, 1usize..=80];
    let balance = (select(&[0u64, 1, 2, 7][..]), select(&COSTS[..]));
    let switches = (any::<bool>(), any::<bool>());
    let parts = (1usize..=5, patches, 1usize..=2, balance, switches, select(&HALOS[..]));
    parts.prop_map(
        |(ranks, patches, threads, (every, cost), (skip_quiescent, overlap), filter_halo)| Layout {
            ranks,
            patches,
            threads,
            every,
            cost,
            skip_quiescent,
            overlap,
            filter_halo,
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig {
        failure_persistence: None,
        max_shrink_iters: 400,
        // as many as a search with many cases needs: about one scene of seven is rejected
        max_global_rejects: u32::MAX,
        ..ProptestConfig::default()
    })]

    #[test]
    fn any_scene_on_any_layout(scene in scene(), mut layout in layout()) {
        let whole = end_of(&scene, &Layout::WHOLE);
        if let Err(message) = &whole {
            // a scene that its check refuses says nothing of layouts
            prop_assume!(!message.starts_with("scene.json"));
        }
        let cells = (scene["domain"]["upper"][0].as_f64().unwrap() / CELL).round() as usize;
        layout.patches = layout.patches.min(cells);
        prop_assert_eq!(end_of(&scene, &layout), whole, "{}\n{}", layout, scene);
    }
}
