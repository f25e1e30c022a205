//! Patches and ranks that the model counts without particles.

use flyer_mpm::input;
use flyer_mpm::scene::CheckedScene;
use flyer_mpm::simulation::{CountedLayout, CountedRank, WantedLayout, count_layout};

fn scene(text: &[u8], sets: &[&str]) -> CheckedScene {
    let sets: Vec<String> = sets.iter().map(|s| s.to_string()).collect();
    input::parse(text, "scene.json", &sets).unwrap()
}

fn counted(scene: &CheckedScene, ranks: usize, time: f64) -> CountedLayout {
    let wanted = WantedLayout { ranks, threads: 1, halo: None, longest: None, time };
    count_layout(scene, &wanted).unwrap()
}

#[test]
fn every_particle_is_counted_once_in_a_plane_and_on_a_line() {
    for text in [
        &include_bytes!("../../inputs/flyer_2d.json")[..],
        include_bytes!("../../inputs/disks.json"),
        include_bytes!("../../inputs/flyer.json"),
    ] {
        let scene = scene(text, &[]);
        let layout = counted(&scene, 5, 0.0);
        let patches = || layout.ranks.iter().flat_map(|rank| &rank.patches);
        assert_eq!(patches().map(|p| p.own).sum::<u64>(), scene.particles);
        assert_eq!((layout.working, layout.ranks.len(), patches().count()), (5, 5, layout.patches));
    }
}

#[test]
fn patches_wake_when_the_wave_comes() {
    let scene = scene(include_bytes!("../../inputs/flyer.json"), &["domain.cell_size=2e-6"]);
    let asleep = |time: f64| {
        let layout = counted(&scene, 1, time);
        let patches = layout.ranks[0].patches.iter();
        patches.filter(|p| p.is_quiescent).map(|p| p.own).sum::<u64>()
    };
    let all = [0.0, 2e-7, 5e-7, 2e-6].map(asleep);
    assert!(all.is_sorted_by(|a, b| a > b), "{all:?}");
    // half of the particles, and none after the wave has crossed the target
    assert!(2 * all[0] > scene.particles && all[3] == 0, "{all:?}");
}

/// With patches at rest, the ranks with the wave get fewer patches than the others.
#[test]
fn loads_are_balanced_during_a_run() {
    let scene = scene(include_bytes!("../../inputs/flyer.json"), &["domain.patches=[60]"]);
    let busiest = |time: f64| {
        let layout = counted(&scene, 4, time);
        let of = |rank: &CountedRank| {
            rank.patches.iter().filter(|p| !p.is_quiescent).map(|p| p.own).sum::<u64>()
        };
        let loads: Vec<u64> = layout.ranks.iter().map(of).collect();
        loads.iter().copied().max().unwrap() as f64 * 4.0 / loads.iter().sum::<u64>() as f64
    };
    assert!(busiest(1e-12) < 1.6 && busiest(0.0) > 1.6, "{} {}", busiest(0.0), busiest(1e-12));
}
