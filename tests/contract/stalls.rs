//! A rank that is stopped: the others name it and all end, wherever they wait for it.

use std::fs;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::home::Home;
use crate::program::{Started, signal};
use crate::ranks::ranks_of;
use crate::scenes::{short, whole};

/// Processes of the ranks, by rank, once all have started.
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
        assert!(run.runs() && since.elapsed() < Duration::from_secs(20), "{found:?}");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Asserts that the run ends soon, names `victim` alone, and that no rank lives on.
#[track_caller]
fn names(run: Started, victim: usize, ranks: &[u32], seconds: u64) {
    let stopped = Instant::now();
    let out = run.end();
    assert!(stopped.elapsed() < Duration::from_secs(seconds + 10), "{:?}", stopped.elapsed());
    let told = format!("error: rank {victim} has made no progress for {seconds} s: it hangs");
    out.failed(&[&told]);
    assert_eq!(out.status.code(), Some(7));
    let alive = |rank: &u32| fs::exists(format!("/proc/{rank}/exe")).unwrap_or(true);
    assert!(!ranks.iter().any(alive), "a rank lives on");
}

fn long() -> Value {
    let mut scene = short();
    scene["domain"]["cell_size"] = json!(1e-6);
    scene["time"]["end"] = json!(1e-6);
    scene
}

/// In the time loop others wait for it in an exchange or in a reduction, or for one that does.
#[test]
fn a_rank_that_is_stopped_is_named() {
    for victim in 0..3 {
        let home = Home::with(&short());
        home.run("output/scene", &[]);
        home.write("scene.json", &long().to_string());
        let before = home.contents();
        let args = ["scene.json", "--quiet", "--stall-timeout", "5"];
        let mut run = home.call(args).ranks(3).start();
        let ranks = processes(&mut run, 3);
        // well into the time loop
        std::thread::sleep(Duration::from_millis(1500));
        assert!(run.runs(), "the scene is too short for this test");
        signal("-STOP", ranks[victim]);
        names(run, victim, &ranks, 5);
        assert_eq!(home.contents(), before);
    }
}

/// It is asked whether it lives while it is stopped, and goes on before the time is over; its late
/// answer does no harm.
#[test]
fn a_rank_that_goes_on_is_waited_for() {
    let mut scene = long();
    scene["time"]["end"] = json!(2e-7);
    let home = Home::with(&scene);
    let args = ["scene.json", "--quiet", "--stall-timeout", "5"];
    let mut run = home.call(args).ranks(3).start();
    let ranks = processes(&mut run, 3);
    std::thread::sleep(Duration::from_millis(500));
    assert!(run.runs(), "the scene is too short for this test");
    signal("-STOP", ranks[1]);
    std::thread::sleep(Duration::from_millis(3500));
    assert!(run.runs(), "the run ends without a rank");
    signal("-CONT", ranks[1]);
    assert_eq!(run.end().succeeded(), "");
}

/// Whether the first profile stands in the folder of results that is being written.
fn writes(home: &Home) -> bool {
    let folders = fs::read_dir(home.at("output")).into_iter().flatten().flatten();
    let mut files = folders.flat_map(|f| fs::read_dir(f.path())).flatten().flatten();
    files.any(|file| file.file_name().to_string_lossy().starts_with("profile_"))
}

/// While rank 0 writes its files, all others wait for it at their end.
#[test]
fn a_rank_that_is_stopped_at_the_end_is_named() {
    for victim in 0..2 {
        let home = Home::with(&whole());
        let args = ["scene.json", "--quiet", "--stall-timeout", "2"];
        let mut run = home.call(args).ranks(2).start();
        let ranks = processes(&mut run, 2);
        let since = Instant::now();
        while !writes(&home) {
            assert!(run.runs() && since.elapsed() < Duration::from_secs(20), "no output");
        }
        signal("-STOP", ranks[victim]);
        names(run, victim, &ranks, 2);
    }
}

/// The process of a rank, as soon as it is there.
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
        assert!(run.runs() && since.elapsed() < Duration::from_secs(20), "rank {victim}");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// While MPI starts and ends no message can be sent: the others know of a rank by its signs of life.
/// FLYER_MPM_STOPS sets the number of moments, spread over the whole run.
#[test]
fn a_rank_that_is_stopped_at_any_moment_is_named() {
    let moments = std::env::var("FLYER_MPM_STOPS").ok().and_then(|n| n.parse().ok()).unwrap_or(5);
    let home = Home::with(&short());
    let args = ["scene.json", "--quiet", "--stall-timeout", "2"];
    let since = Instant::now();
    home.call(args).ranks(3).end().succeeded();
    let whole = since.elapsed();
    let mut named = 0;
    for k in 0..moments {
        let victim = k % 3;
        let mut run = home.call(args).ranks(3).start();
        let process = process_of(&mut run, victim);
        std::thread::sleep(whole.mul_f64(k as f64 / moments as f64));
        signal("-STOP", process);
        let stopped = Instant::now();
        let out = run.end();
        // it had ended before the signal came
        if out.status.success() {
            continue;
        }
        assert!(stopped.elapsed() < Duration::from_secs(12), "{:?}", stopped.elapsed());
        // one that ends and one that runs may both wait for it, and both tell
        let told = format!("error: rank {victim} has made no progress for 2 s: it hangs");
        let errors: Vec<&str> = out.stderr.lines().filter(|l| l.starts_with("error:")).collect();
        assert!(!errors.is_empty() && errors.iter().all(|l| l.starts_with(&told)), "{errors:?}");
        assert_eq!(out.status.code(), Some(7), "{}", out.stderr);
        assert!(!fs::exists(format!("/proc/{process}/exe")).unwrap_or(true), "it lives on");
        named += 1;
    }
    assert!(2 * named >= moments, "{named} of {moments}");
}
