//! Several ranks: identical bits, and no rank left running when one fails.

use std::fs;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::home::{Home, Results};
use crate::program::{Turn, at_once, signal};
use crate::scenes::{mirrored_stray, short, stray};

/// Runs `scene.json` on this many ranks.
#[track_caller]
fn on(home: &Home, ranks: usize, args: &[&str]) -> Results {
    let output = format!("on_{ranks}");
    let args = ["scene.json", "--quiet", "--output", &output].into_iter().chain(args.to_vec());
    assert_eq!(home.call(args).ranks(ranks).end().succeeded(), "");
    let results = home.results(&output);
    assert_eq!(results.count("ranks"), ranks as u64);
    results
}

#[test]
fn any_layout_gives_the_same_bits() {
    let home = Home::with(&short());
    let alone = home.run("alone", &[]);
    for patches in ["1", "5", "16"] {
        for threads in ["1", "2"] {
            let set = format!("domain.patches=[{patches}]");
            let run = on(&home, 2, &["--set", &set, "--threads", threads]);
            assert_eq!(run.states(), alone.states(), "{patches} patches, {threads} threads");
            assert_eq!(run.summary["threads"].to_string(), threads);
            // two ranks with two threads each have no use for one patch
            if (patches, threads) == ("1", "2") {
                assert!(
                    run.summary["patches"][0].as_u64() >= Some(4),
                    "{}",
                    run.summary["patches"]
                );
            } else {
                assert_eq!(run.summary["patches"].to_string(), format!("[{patches}]"));
            }
        }
    }
}

#[test]
fn a_rank_may_own_no_patch() {
    let home = Home::with(&short());
    let alone = home.run("alone", &[]);
    assert_eq!(on(&home, 3, &["--set", "domain.patches=[1]"]).states(), alone.states());
}

#[test]
fn every_output_is_written_once() {
    let home = Home::with(&crate::scenes::whole());
    let alone = home.run("alone", &[]);
    let run = on(&home, 2, &[]);
    assert_eq!(run.names(), alone.names());
    assert_eq!(run.states(), alone.states());
    assert_eq!(run.text("histories.csv"), alone.text("histories.csv"));
    // errors and totals do not depend on the layout either
    for key in ["energy", "momentum", "steps", "particles"] {
        assert_eq!(run.summary[key], alone.summary[key], "{key}");
    }
    assert_eq!(run.summary["profiles"], alone.summary["profiles"]);
}

/// A fault in the patch of only one of the two ranks, tested for each rank.
#[test]
fn a_fault_of_one_rank_ends_all() {
    let cases = [stray(), mirrored_stray()].map(|scene| {
        let home = Home::with(&short());
        home.run("output/scene", &[]);
        home.write("scene.json", &scene.to_string());
        let alone = home.call(["scene.json", "--quiet"]).end();
        (home.contents(), home, alone.stderr)
    });
    let turn = Turn::alone();
    let args = ["scene.json", "--quiet", "--set", "domain.patches=[2]"];
    let start = |home: &Home| home.call(args).ranks(2).within(&turn).start();
    let since = Instant::now();
    let runs = cases.each_ref().map(|(_, home, _)| start(home));
    for (run, (before, home, alone)) in runs.into_iter().zip(&cases) {
        let out = run.end();
        assert!(since.elapsed() < Duration::from_secs(20), "{:?}", since.elapsed());
        out.failed(&["particle ", " of body `target` at x = ", "leaves the domain"]);
        assert!(out.stderr.contains(alone.trim()), "{} is not {alone}", out.stderr);
        assert_eq!(home.contents(), *before);
    }
}

#[test]
fn arguments_are_judged_once() {
    let home = Home::with(&short());
    // no rank computes, so all the calls are made at once
    let turn = Turn::of(2);
    let start = |args: &[&str]| home.call(args.iter().copied()).ranks(2).within(&turn).start();
    let (help, schema) = (start(&["--help"]), start(&["schema"]));
    let threads = start(&["scene.json", "--threads", "0"]);
    let compare = start(&["compare", "a", "b"]);
    let timeouts = ["0", "-1", "nan", "soon"]
        .map(|wrong| start(&["scene.json", &format!("--stall-timeout={wrong}")]));
    assert_eq!(help.end().succeeded().matches("Usage:").count(), 1);
    assert!(serde_json::from_str::<Value>(&schema.end().succeeded()).is_ok());
    threads.end().failed(&["--threads"]);
    compare.end().failed(&["a/summary.json"]);
    for run in timeouts {
        run.end().failed(&["--stall-timeout", "from 0.001 to 1e9"]);
    }
}

/// Processes of the ranks that mpirun has started.
pub fn ranks_of(mpirun: u32) -> Vec<u32> {
    let mut found = Vec::new();
    for entry in fs::read_dir("/proc").unwrap().flatten() {
        let Ok(stat) = fs::read_to_string(entry.path().join("stat")) else { continue };
        let Some((before, after)) = stat.rsplit_once(") ") else { continue };
        let parent = after.split(' ').nth(1).and_then(|p| p.parse::<u32>().ok());
        if parent == Some(mpirun) && before.contains("(flyer-mpm") {
            found.extend(before.split(' ').next().and_then(|p| p.parse::<u32>().ok()));
        }
    }
    found.sort_unstable();
    found
}

#[test]
fn a_rank_that_is_lost_ends_all() {
    let mut long = short();
    long["domain"]["cell_size"] = json!(1e-6);
    long["time"]["end"] = json!(1e-6);
    let homes = [0, 1].map(|_| {
        let home = Home::with(&short());
        home.run("output/scene", &[]);
        home.write("scene.json", &long.to_string());
        home
    });
    let turn = Turn::alone();
    let lose = |home: &Home, victim: usize| {
        let before = home.contents();
        let mut run = home.call(["scene.json", "--quiet"]).ranks(2).within(&turn).start();
        let since = Instant::now();
        while ranks_of(run.id()).len() < 2 && since.elapsed() < Duration::from_secs(20) {
            std::thread::sleep(Duration::from_millis(20));
        }
        // well within the time loop
        std::thread::sleep(Duration::from_millis(1500));
        assert!(run.runs(), "the scene is too short for this test");
        let ranks = ranks_of(run.id());
        assert_eq!(ranks.len(), 2);
        signal("-KILL", ranks[victim]);
        let killed = Instant::now();
        let out = run.end();
        assert!(killed.elapsed() < Duration::from_secs(10), "{:?}", killed.elapsed());
        assert!(!out.status.success());
        assert_eq!(out.stdout, "");
        let alive = |rank: &u32| fs::exists(format!("/proc/{rank}/exe")).unwrap_or(true);
        assert!(!ranks.iter().any(alive), "a rank lives on");
        assert_eq!(home.contents(), before);
    };
    at_once(&homes, lose);
}
