//! A stopped rank: the others name it and all end, wherever they wait for it.

use std::fs;
use std::time::{Duration, Instant};

use nix::sched::{CpuSet, sched_getaffinity, sched_setaffinity};
use nix::unistd::Pid;
use serde_json::{Value, json};

use crate::home::Home;
use crate::program::{Call, Started, Turn, at_once, signal};
use crate::ranks::ranks_of;
use crate::scenes::{short, whole};

/// Longest time until a run shows what a test waits for.
const PATIENCE: Duration = Duration::from_secs(100);

/// Process ids of the ranks, in order of rank, once all have started.
fn processes(run: &mut Started, size: usize) -> Vec<u32> {
    let since = Instant::now();
    let number = |process: &u32| {
        let environment = fs::read(format!("/proc/{process}/environ")).unwrap_or_default();
        let mut entries = environment.split(|&b| b == 0);
        let rank = entries.find_map(|e| e.strip_prefix(b"OMPI_COMM_WORLD_RANK="));
        rank.and_then(|r| std::str::from_utf8(r).ok()?.parse::<usize>().ok())
    };
    loop {
        let mut found: Vec<u32> =
            ranks_of(run.id()).into_iter().filter(|p| number(p).is_some()).collect();
        if found.len() == size {
            found.sort_by_key(number);
            return found;
        }
        assert!(run.runs() && since.elapsed() < PATIENCE, "{found:?}");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Asserts that the run ends soon, names only `victim`, and leaves no rank running.
#[track_caller]
fn names(run: Started, victim: usize, ranks: &[u32], seconds: u64) {
    let stopped = Instant::now();
    let alive = |rank: &u32| fs::exists(format!("/proc/{rank}/exe")).unwrap_or(true);
    while ranks.iter().any(alive) {
        assert!(stopped.elapsed() < Duration::from_secs(seconds + 10), "a rank lives on");
        std::thread::sleep(Duration::from_millis(20));
    }
    let out = run.end();
    let text = format!("error: rank {victim} has made no progress for {seconds} s: it hangs");
    out.failed(&[&text]);
    assert_eq!(out.code(), Some(7));
}

fn long() -> Value {
    let mut scene = short();
    scene["domain"]["cell_size"] = json!(1e-6);
    scene["time"]["end"] = json!(1e-6);
    scene
}

/// In the time loop the other ranks wait for the stopped rank in an exchange or a reduction, or for
/// a rank that does.
#[test]
fn a_rank_that_is_stopped_is_named() {
    let homes = [0, 1, 2].map(|_| {
        let home = Home::with(&short());
        home.run("output/scene", &[]);
        home.write("scene.json", &long().to_string());
        home
    });
    let turn = Turn::alone();
    at_once(&homes, |home, victim| {
        let before = home.contents();
        let args = ["scene.json", "--quiet", "--stall-timeout", "5"];
        let mut run = home.call(args).ranks(3).within(&turn).start();
        let ranks = processes(&mut run, 3);
        // well within the time loop
        std::thread::sleep(Duration::from_millis(1500));
        assert!(run.runs(), "the scene is too short for this test");
        signal("-STOP", ranks[victim]);
        names(run, victim, &ranks, 5);
        assert_eq!(home.contents(), before);
    });
}

/// A rank is asked for a sign of life while it is stopped, and continues before the time is over;
/// its late answer does no harm.
#[test]
fn a_rank_that_goes_on_is_waited_for() {
    let mut scene = long();
    scene["time"]["end"] = json!(2e-7);
    let home = Home::with(&scene);
    let args = ["scene.json", "--quiet", "--stall-timeout", "5"];
    let turn = Turn::alone();
    let mut run = home.call(args).ranks(3).within(&turn).start();
    let ranks = processes(&mut run, 3);
    std::thread::sleep(Duration::from_millis(500));
    assert!(run.runs(), "the scene is too short for this test");
    signal("-STOP", ranks[1]);
    std::thread::sleep(Duration::from_millis(3500));
    assert!(run.runs(), "the run ends without a rank");
    signal("-CONT", ranks[1]);
    assert_eq!(run.end().succeeded(), "");
}

/// Whether the first profile exists in the folder of results that is being written.
fn writes(home: &Home) -> bool {
    let folders = fs::read_dir(home.at("output")).into_iter().flatten().flatten();
    let mut files = folders.flat_map(|f| fs::read_dir(f.path())).flatten().flatten();
    files.any(|file| file.file_name().to_string_lossy().starts_with("profile_"))
}

/// Rank 0 measures alone while the others sleep, on one core longer than the measurement; both
/// ranks answer.
#[test]
fn ranks_of_a_calibration_wait_for_each_other() {
    let home = Home::new();
    let (here, mut one) = (sched_getaffinity(Pid::from_raw(0)).unwrap(), CpuSet::new());
    let first = (0..CpuSet::count()).find(|&cpu| here.is_set(cpu).unwrap()).unwrap();
    one.set(first).unwrap();
    let turn = Turn::alone();
    // processes started from here have one core
    sched_setaffinity(Pid::from_raw(0), &one).unwrap();
    let run = home
        .call(["perf", "calibrate", "--seconds", "12", "--stall-timeout", "2"])
        .ranks(2)
        .within(&turn)
        .start();
    sched_setaffinity(Pid::from_raw(0), &here).unwrap();
    run.end().succeeded();
}

#[test]
fn a_rank_of_a_calibration_that_is_stopped_is_named() {
    let turn = Turn::alone();
    at_once(&[0, 1].map(|_| Home::new()), |home, victim| {
        let args = ["perf", "calibrate", "--seconds", "6", "--stall-timeout", "2"];
        let mut run = home.call(args).ranks(2).within(&turn).start();
        let ranks = processes(&mut run, 2);
        std::thread::sleep(Duration::from_millis(1500));
        assert!(run.runs(), "the calibration is too short for this test");
        signal("-STOP", ranks[victim]);
        // the running rank notices the stop when it waits, at the end of its own part
        let out = run.end();
        let text = format!("error: rank {victim} has made no progress for 2 s: it hangs");
        out.failed(&[&text]);
        assert_eq!(out.code(), Some(7));
    });
}

/// While rank 0 writes its files, all other ranks wait for it at their end.
#[test]
fn a_rank_that_is_stopped_at_the_end_is_named() {
    let turn = Turn::alone();
    at_once(&[0, 1].map(|_| Home::with(&whole())), |home, victim| {
        let args = ["scene.json", "--quiet", "--stall-timeout", "2"];
        let mut run = home.call(args).ranks(2).within(&turn).start();
        let ranks = processes(&mut run, 2);
        let since = Instant::now();
        while !writes(home) {
            assert!(run.runs() && since.elapsed() < PATIENCE, "no output");
        }
        signal("-STOP", ranks[victim]);
        names(run, victim, &ranks, 2);
    });
}

/// Process id of a rank, as soon as it exists.
fn process_of(run: &mut Started, victim: usize) -> u32 {
    let since = Instant::now();
    let mark = format!("OMPI_COMM_WORLD_RANK={victim}");
    let is_it = |process: &u32| {
        let environment = fs::read(format!("/proc/{process}/environ")).unwrap_or_default();
        environment.split(|&b| b == 0).any(|entry| entry == mark.as_bytes())
    };
    loop {
        if let Some(found) = ranks_of(run.id()).into_iter().find(is_it) {
            return found;
        }
        assert!(run.runs() && since.elapsed() < PATIENCE, "rank {victim}");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Runs that wait for a stopped rank at the same time.
const AT_ONCE: usize = 5;

/// While MPI starts and ends, no message can be sent: the ranks detect each other by signs of life.
/// FLYER_MPM_STOPS sets the number of moments, spread over the whole run.
#[test]
fn a_rank_that_is_stopped_at_any_moment_is_named() {
    let moments = std::env::var("FLYER_MPM_STOPS").ok().and_then(|n| n.parse().ok()).unwrap_or(5);
    let homes: Vec<Home> = (0..moments).map(|_| Home::with(&short())).collect();
    let args = ["scene.json", "--quiet", "--stall-timeout", "4"];
    let since = Instant::now();
    homes[0].call(args).ranks(3).end().succeeded();
    let whole = since.elapsed();
    let turn = Turn::alone();
    for (wave, some) in homes.chunks(AT_ONCE).enumerate() {
        at_once(some, |home, k| {
            let k = wave * AT_ONCE + k;
            let mut delay = whole.mul_f64(k as f64 / moments as f64);
            // a run that ended before its signal is no test: repeat it with a shorter delay
            while !stopped_rank_is_named(home.call(args).within(&turn), k % 3, delay) {
                assert!(delay > Duration::from_millis(1), "every run ends before its signal");
                delay /= 2;
            }
        });
    }
}

/// Stops one of three ranks after a delay and asserts that it is named. Returns false if the run
/// ended before.
fn stopped_rank_is_named(call: Call, victim: usize, delay: Duration) -> bool {
    let mut run = call.ranks(3).start();
    let process = process_of(&mut run, victim);
    let found = Instant::now();
    while found.elapsed() < delay && run.runs() {
        std::thread::sleep(Duration::from_millis(1));
    }
    signal("-STOP", process);
    let stopped = Instant::now();
    let alive = || fs::exists(format!("/proc/{process}/exe")).unwrap_or(true);
    // time since which the stopped rank is the only one, and no other has reported it
    let mut alone: Option<Instant> = None;
    while run.runs() && alive() {
        let waits = ranks_of(run.id()) != [process] || !run.said().is_empty();
        alone = if waits { None } else { alone.or(Some(Instant::now())) };
        if alone.is_some_and(|since| since.elapsed() > Duration::from_secs(2)) {
            // stopped after its last sign of life: the run was complete, and no rank waits for it
            signal("-CONT", process);
            break;
        }
        assert!(stopped.elapsed() < Duration::from_secs(30), "it lives on: {}", run.said());
        std::thread::sleep(Duration::from_millis(20));
    }
    let out = run.end();
    if out.status.success() {
        return false;
    }
    // a rank that ends and a running one may both wait for it, and both report it
    let text = format!("error: rank {victim} has made no progress for 4 s: it hangs");
    let errors: Vec<&str> = out.stderr.lines().filter(|l| l.starts_with("error:")).collect();
    assert!(!errors.is_empty() && errors.iter().all(|l| l.starts_with(&text)), "{errors:?}");
    assert_eq!(out.code(), Some(7), "{}", out.stderr);
    true
}
