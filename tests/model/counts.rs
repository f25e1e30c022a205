//! Exchanges, messages and bytes of a step: the model's against a traced run on two ranks.

use decomp::Comm;
use decomp::comm::local::run_ranks;
use flyer_mpm::input;
use flyer_mpm::perf_model::{StepCounts, Work};
use flyer_mpm::scene::{CheckedScene, FilterHalo};
use flyer_mpm::simulation::Simulation;

const FLYER: &[u8] = include_bytes!("../../inputs/flyer.json");
const UINTAH: &[u8] = include_bytes!("../../inputs/flyer_uintah.json");

/// Steps that are looked at: each kind of step comes in whole numbers, and no census, no look at
/// the balance.
const STEPS: u64 = 6;

/// What a rank did.
struct Seen {
    rows: usize,
    nodes: usize,
    agreements: usize,
    messages: u64,
    bytes: u64,
}

fn parsed(text: &[u8], sets: &[&str], halo: FilterHalo, patches: usize) -> CheckedScene {
    let mut sets: Vec<String> = sets.iter().map(|s| s.to_string()).collect();
    let name = if halo == FilterHalo::Redundant { "redundant" } else { "exchange" };
    sets.push(format!("decomposition.filter_halo={name}"));
    sets.push(format!("domain.patches=[{patches}]"));
    sets.push("decomposition.skip_quiescent=false".into());
    input::parse(text, "scene.json", &sets).unwrap()
}

/// Runs a few steps on two ranks.
fn seen(scene: &CheckedScene) -> Vec<Seen> {
    run_ranks(2, |rank| {
        let mut simulation = Simulation::<1>::new(scene, rank, 1).unwrap();
        simulation.trace(1..STEPS + 1);
        let before = rank.traffic();
        for _ in 0..STEPS {
            simulation.advance(scene.scene.time.end).unwrap();
        }
        let after = rank.traffic();
        let events = &simulation.clock().events;
        let count = |name: &str| events.iter().filter(|e| e.name == name).count();
        Seen {
            rows: count("exchange particles"),
            nodes: count("exchange nodes"),
            agreements: count("agree"),
            messages: after.messages - before.messages,
            bytes: after.bytes - before.bytes,
        }
    })
}

const METHODS: [(&[u8], &[&str]); 14] = [
    (FLYER, &[]),
    (FLYER, &["method.pressure_relaxation=null"]),
    (FLYER, &["method.pressure_relaxation={\"rate\":0.1,\"interval\":3}"]),
    (FLYER, &["method.edge_mask=null", "method.transfer={\"fmpm\":1}"]),
    (FLYER, &["method.edge_mask=null", "method.transfer={\"xpic\":3}"]),
    (FLYER, &["method.edge_mask=null", "method.transfer={\"flip_pic\":0.9}"]),
    (
        FLYER,
        &[
            "method.edge_mask=null",
            "method.transfer={\"flip_pic\":0.9}",
            "method.pressure_relaxation=null",
        ],
    ),
    (FLYER, &["method.energy=textbook", "method.filter_heat=false"]),
    (UINTAH, &[]),
    (UINTAH, &["method.transfer=apic", "method.shape=bspline_quadratic"]),
    (UINTAH, &["method.transfer={\"xpic\":5}"]),
    (UINTAH, &["method.transfer={\"fmpm\":4}"]),
    (UINTAH, &["method.stress_update=first", "method.transfer={\"fmpm\":2}"]),
    (UINTAH, &["method.stress_update=modified_last", "method.transfer={\"xpic\":3}"]),
];

#[test]
fn exchanges_of_a_step_are_those_of_the_timeline() {
    for (text, sets) in METHODS {
        for halo in [FilterHalo::Exchange, FilterHalo::Redundant] {
            let scene = parsed(text, sets, halo, 4);
            let schedule = StepCounts::of(&scene.scene.method);
            let steps = STEPS as f64;
            for rank in seen(&scene) {
                let what = format!("{sets:?} {halo:?}");
                assert_eq!(rank.agreements as u64, STEPS, "{what}");
                let rows = schedule.row_exchanges * steps;
                assert_eq!(rank.rows as f64, rows, "{what}: rows");
                let all = schedule.exchanges(halo) * steps;
                assert!(((rank.rows + rank.nodes) as f64 - all).abs() < 1e-9, "{what}: {all}");
            }
        }
    }
}

#[test]
fn messages_and_bytes_are_those_that_are_sent() {
    for (text, sets) in [METHODS[0], METHODS[8], METHODS[11]] {
        for halo in [FilterHalo::Exchange, FilterHalo::Redundant] {
            for patches in [2, 8] {
                let scene = parsed(text, sets, halo, patches);
                let work = Work::new(&scene);
                let share = work.share(patches, 2, 1, halo);
                let (mut messages, mut bytes) = (0.0, 0.0);
                for rank in work.rank_works(&share, [1e6; 2]) {
                    let s = &work.schedule;
                    let nodes = s.exchanges(halo) - s.row_exchanges;
                    messages += s.row_exchanges * rank.neighbours[0] + nodes * rank.neighbours[1];
                    bytes += s.row_exchanges * rank.bytes[0] + rank.bytes[1];
                }
                let seen = seen(&scene);
                let count =
                    |of: fn(&Seen) -> u64| seen.iter().map(of).sum::<u64>() as f64 / STEPS as f64;
                let what = format!("{sets:?} {halo:?} {patches} patches");
                assert!((count(|s| s.messages) - messages).abs() < 1e-9, "{what}: {messages}");
                let ratio = bytes / count(|s| s.bytes);
                // rows move within their cells: one more or less is in reach
                assert!((0.8..1.25).contains(&ratio), "{what}: {ratio}");
            }
        }
    }
}
