//! Exchanges, messages and bytes of a step: the model's against a traced run on two ranks.

use std::path::Path;

use decomp::Comm;
use decomp::comm::local::run_ranks;
use flyer_mpm::input;
use flyer_mpm::perf_model::{StepCounts, Work};
use flyer_mpm::scene::{CheckedScene, FilterHalo};
use flyer_mpm::simulation::{Compiled, Simulation};
use flyer_mpm::solver::Stepper;

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

fn parsed(text: &[u8], sets: &[&str], halo: FilterHalo, patches: &[usize]) -> CheckedScene {
    let mut sets: Vec<String> = sets.iter().map(|s| s.to_string()).collect();
    let name = if halo == FilterHalo::Redundant { "redundant" } else { "exchange" };
    sets.push(format!("decomposition.filter_halo={name}"));
    sets.push(format!("domain.patches={patches:?}"));
    sets.push("decomposition.skip_quiescent=false".into());
    input::parse(text, "scene.json", &sets).unwrap()
}

/// Runs a few steps on some ranks.
fn seen(scene: &CheckedScene, ranks: usize) -> Vec<Seen> {
    match scene.dimension {
        1 => seen_in::<1>(scene, ranks),
        _ => seen_in::<2>(scene, ranks),
    }
}

fn seen_in<const D: usize>(scene: &CheckedScene, ranks: usize) -> Vec<Seen>
where
    Stepper<D>: Compiled<D>,
{
    run_ranks(ranks, |rank| {
        let mut simulation = Simulation::<D>::new(scene, rank, 1).unwrap();
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

/// Methods in a plane: spin, contact with friction, heat conduction, failure, sides that move.
const IN_A_PLANE: [&str; 6] =
    ["flyer_2d", "oblique_impact", "taylor_bar", "sliding_block", "hertz", "free_slide"];

fn in_a_plane(name: &str, halo: FilterHalo, patches: [usize; 2]) -> CheckedScene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("inputs/{name}.json"));
    parsed(&input::read(&path).unwrap(), &[], halo, &patches)
}

#[test]
fn exchanges_of_a_step_are_those_of_the_timeline() {
    for halo in [FilterHalo::Exchange, FilterHalo::Redundant] {
        let on_a_line = METHODS.iter().map(|(text, sets)| parsed(text, sets, halo, &[4]));
        let in_a_plane = IN_A_PLANE.iter().map(|name| in_a_plane(name, halo, [2, 2]));
        for scene in on_a_line.chain(in_a_plane) {
            let schedule = StepCounts::of(&scene);
            let steps = STEPS as f64;
            for rank in seen(&scene, 2) {
                let what = format!("{} {:?} {halo:?}", scene.scene.title, scene.scene.method);
                assert_eq!(rank.agreements as u64, STEPS, "{what}");
                let rows = schedule.row_exchanges * steps;
                assert_eq!(rank.rows as f64, rows, "{what}: rows");
                let all = schedule.exchanges(halo) * steps;
                assert!(((rank.rows + rank.nodes) as f64 - all).abs() < 1e-9, "{what}: {all}");
            }
        }
    }
}

/// Largest deviation of the predicted bytes: particles move, and those that change their rank travel
/// with all their columns.
const BYTES: f64 = 0.1;

/// Compares messages and bytes of each rank of `scene`.
fn compare(scene: &CheckedScene, ranks: usize, halo: FilterHalo) {
    let (work, share) = (Work::new(scene), Work::share(scene, ranks, 1, None, 0.0));
    let predicted = work.rank_works(&share, [1e6; 2]);
    let s = &work.schedule;
    let nodes = s.exchanges(halo) - s.row_exchanges;
    for (rank, seen) in predicted.iter().zip(seen(scene, ranks)) {
        let messages = s.row_exchanges * rank.neighbours[0] + nodes * rank.neighbours[1];
        let bytes = s.row_exchanges * rank.bytes[0] + rank.bytes[1];
        let per_step = |count: u64| count as f64 / STEPS as f64;
        let what = format!("{} {halo:?} {ranks} ranks", scene.scene.title);
        assert!((per_step(seen.messages) - messages).abs() < 1e-9, "{what}: {messages}");
        let counted = per_step(seen.bytes);
        assert!((bytes - counted).abs() <= BYTES * counted, "{what}: {bytes}, {counted}");
    }
}

#[test]
fn messages_and_bytes_of_each_rank_are_those_that_are_sent() {
    for halo in [FilterHalo::Exchange, FilterHalo::Redundant] {
        for (text, sets) in [METHODS[0], METHODS[8], METHODS[11]] {
            for (patches, ranks) in [(2, 2), (8, 2), (8, 5)] {
                compare(&parsed(text, sets, halo, &[patches]), ranks, halo);
            }
        }
        for name in IN_A_PLANE {
            compare(&in_a_plane(name, halo, [4, 3]), 2, halo);
            compare(&in_a_plane(name, halo, [5, 4]), 7, halo);
        }
    }
}
