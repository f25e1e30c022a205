//! What the options of the decomposition change: the work and its order, never a bit.

use decomp::Comm;
use decomp::comm::local::run_ranks;
use flyer_mpm::simulation::{Counters, Simulation, patch_counts};
use flyer_mpm::solver::clock::Event;
use serde_json::{Value, json};

use crate::tools::{checked, ending, shipped, with};

/// What one rank has seen of a run.
struct Seen {
    tally: Counters,
    digest: Option<String>,
    rank_events: Vec<Event>,
    patch_events: Vec<(usize, Event)>,
    inner: usize,
}

/// Runs a scene to its end on `ranks`, with a timeline of step 3.
fn on_ranks(value: &Value, decomposition: &Value, ranks: usize) -> Vec<Seen> {
    let scene = checked(&with(value, &json!({"decomposition": decomposition})));
    run_ranks(ranks, |comm| {
        let threads = scene.scene.decomposition.threads;
        let mut simulation = Simulation::<1>::new(&scene, comm, threads).unwrap();
        simulation.trace(3..4);
        while simulation.time() < scene.scene.time.end {
            simulation.advance(scene.scene.time.end).unwrap();
        }
        let patch_events = simulation.take_patch_events();
        Seen {
            tally: simulation.tally(),
            digest: simulation.gather().map(|(_, digest)| digest),
            rank_events: std::mem::take(&mut simulation.clock().events),
            inner: simulation.layout().patches_of(comm.rank()).len(),
            patch_events,
        }
    })
}

fn total(seen: &[Seen], of: fn(&Counters) -> u64) -> u64 {
    seen.iter().map(|s| of(&s.tally)).sum()
}

/// The standard problem, short.
fn plates(patches: usize) -> Value {
    let mut value = shipped("flyer.json");
    ending(&mut value, 5e-8);
    value["domain"]["patches"] = json!([patches]);
    value
}

/// A plate that flies from one end of the domain towards the other.
fn flight() -> Value {
    let mut value = plates(100);
    value["bodies"].as_array_mut().unwrap().truncate(1);
    value["materials"].as_object_mut().unwrap().remove("aluminium");
    value.as_object_mut().unwrap().remove("reference");
    value["domain"]["upper"] = json!([0.001]);
    value["bodies"][0]["velocity"] = json!([1500.0]);
    value["bodies"][0]["box"] = json!({"lower": [-0.0009], "upper": [-0.0004]});
    ending(&mut value, 4e-7);
    value
}

/// Left out, patches are chosen: several where some may sleep, and where a plane is shared and wide
/// enough for it.
#[test]
fn patches_follow_the_workers() {
    let counts = |value: &Value, ranks, threads| patch_counts(&checked(value), ranks, threads);
    let awake = json!({"decomposition": {"skip_quiescent": false}});
    let plane = with(&shipped("flyer_2d.json"), &awake);
    assert_eq!(plane["domain"]["patches"], Value::Null);
    assert_eq!(counts(&plane, 1, 1), [1, 1]);
    assert_eq!(counts(&plane, 2, 1), [2, 2]);
    assert_eq!(counts(&plane, 2, 2), counts(&plane, 4, 1));
    assert!(counts(&shipped("flyer_2d.json"), 1, 1).iter().product::<usize>() > 1);
    // several patches for each of many workers, so that none holds much more than the mean
    let many = counts(&shipped("flyer_2d.json"), 16, 1).iter().product::<usize>();
    assert!(many > 40, "{many}");
    // two patches for each worker would be too narrow
    let coarse = with(&plane, &json!({"domain": {"cell_size": 1e-4}}));
    assert_eq!(counts(&coarse, 2, 1), [2, 1]);
    let line = with(&shipped("flyer.json"), &awake);
    assert_eq!(counts(&line, 2, 1), [2]);
}

#[test]
fn quiet_patches_are_left_out() {
    let off = on_ranks(&plates(16), &json!({"skip_quiescent": false}), 1);
    let on = on_ranks(&plates(16), &json!({"skip_quiescent": true}), 1);
    assert_eq!(off[0].digest, on[0].digest);
    assert_eq!(off[0].tally.skipped_particle_steps, 0);
    let all = off[0].tally.particle_steps;
    assert_eq!(all, on[0].tally.particle_steps + on[0].tally.skipped_particle_steps);
    // the target is reached over a tenth of its length in this time
    let share = on[0].tally.skipped_particle_steps as f64 / all as f64;
    assert!(share > 0.6, "{share}");
}

#[test]
fn patches_move_where_balance_asks_for_it() {
    let run = |every: u64| {
        let balance = json!({"every": every, "cost": "particles"});
        on_ranks(&flight(), &json!({"balance": balance}), 3)
    };
    let (still, moving) = (run(0), run(4));
    assert_eq!(still[0].digest, moving[0].digest);
    assert_eq!(total(&still, |t| t.patches_moved), 0);
    assert!(total(&moving, |t| t.patches_moved) > 3);
    // particle-steps of an even split over those of the busiest rank
    let evenness = |seen: &[Seen]| {
        let even = total(seen, |t| t.particle_steps) as f64 / seen.len() as f64;
        even / seen[0].tally.busiest_particle_steps as f64
    };
    assert!(evenness(&still) < 0.75, "{}", evenness(&still));
    assert!(evenness(&moving) > 0.9, "{}", evenness(&moving));
}

#[test]
fn measured_cost_moves_patches_too() {
    let balance = json!({"every": 20, "cost": "time"});
    let seen = on_ranks(&flight(), &json!({"balance": balance}), 2);
    assert!(total(&seen, |t| t.patches_moved) > 0);
    assert_eq!(seen[0].digest, on_ranks(&flight(), &json!({}), 1)[0].digest);
}

/// With overlap the inner patches' phases lie within the exchange, without they come after it.
#[test]
fn inner_patches_are_computed_while_messages_fly() {
    let within = |overlap: bool| {
        let keys = json!({"overlap": overlap, "skip_quiescent": false, "balance": {"every": 0}});
        let seen = on_ranks(&plates(16), &keys, 2);
        let exchange = seen[0].rank_events.iter().find(|e| e.name == "exchange particles").unwrap();
        let end = exchange.start + exchange.length;
        let scatter = seen[0].patch_events.iter().filter(|(_, e)| e.name == "scatter");
        let (before, after): (Vec<_>, Vec<_>) =
            scatter.map(|(_, e)| e.start).partition(|&start| start < end);
        assert_eq!(before.len() + after.len(), seen[0].inner);
        assert!(!after.is_empty(), "the patch at the border comes last");
        before.len()
    };
    assert!(within(true) > 3);
    assert_eq!(within(false), 0);
}

#[test]
fn a_timeline_has_the_steps_that_were_asked_for() {
    for (halo, exchanges) in [("exchange", 17), ("redundant", 1)] {
        let seen = on_ranks(&plates(8), &json!({"filter_halo": halo, "skip_quiescent": false}), 2);
        for rank in &seen {
            assert!(rank.rank_events.iter().all(|e| e.step == 3));
            let count = rank.rank_events.iter().filter(|e| e.name.starts_with("exchange")).count();
            // rows, eight terms of the velocity's series, eight of the work's
            assert_eq!(count, exchanges, "{halo}");
        }
        let mut patches: Vec<usize> =
            seen.iter().flat_map(|s| &s.patch_events).map(|(p, _)| *p).collect();
        patches.sort_unstable();
        patches.dedup();
        assert!(patches.into_iter().eq(0..8), "{halo}");
    }
}

#[test]
fn more_ranks_than_patches_run() {
    let alone = on_ranks(&plates(1), &json!({}), 1);
    let seen = on_ranks(&plates(3), &json!({"balance": {"every": 7}}), 5);
    assert_eq!(seen[0].digest, alone[0].digest);
    assert!(seen.iter().any(|s| s.inner == 0));
}
