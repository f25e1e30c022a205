//! A signal, or the end of the wall time, ends a run in good order.

use std::io::{PipeReader, Write};
use std::os::unix::process::ExitStatusExt;
use std::time::{Duration, Instant};

use nix::fcntl::{FcntlArg, fcntl};
use serde_json::json;

use crate::home::Home;
use crate::program::{Ended, Started, signal};
use crate::restarts::{recorded, same};

/// Waits until something holds; the run must go on meanwhile.
#[track_caller]
pub fn wait(run: &mut Started, holds: impl Fn() -> bool) {
    let since = Instant::now();
    while !holds() {
        assert!(run.runs(), "it has ended");
        assert!(since.elapsed() < Duration::from_secs(50), "it never comes");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// A run that waits with its first line, before its first step, until somebody hears it: it holds
/// its lock, and notes signals.
pub struct Unheard {
    pub run: Started,
    said: PipeReader,
}

impl Unheard {
    /// A run of the scene of `home`; it has taken its lock.
    #[track_caller]
    pub fn start(home: &Home) -> Unheard {
        let (said, mut pipe) = std::io::pipe().unwrap();
        // a full pipe takes nothing more
        let room = fcntl(&pipe, FcntlArg::F_GETPIPE_SZ).unwrap();
        pipe.write_all(&vec![b'\n'; room as usize]).unwrap();
        let mut call = home.call(["scene.json"]);
        call.stderr = Some(pipe);
        let mut run = call.start();
        wait(&mut run, || home.at("output/.scene.flyer.lock").exists());
        Unheard { run, said }
    }

    /// Hears it, and waits for its end.
    #[track_caller]
    pub fn end(mut self) -> Ended {
        let hearer = std::thread::spawn(move || std::io::read_to_string(&mut self.said).unwrap());
        let ended = self.run.end();
        Ended { stderr: hearer.join().unwrap().trim_start().into(), ..ended }
    }
}

#[test]
fn a_signal_writes_a_checkpoint_and_ends_the_run() {
    let mut scene = recorded(5);
    // too long to end by itself
    scene["domain"]["cell_size"] = json!(2e-7);
    let home = Home::with(&scene);
    for name in ["-TERM", "-INT", "-USR1"] {
        let mut run = home.call(["scene.json", "--quiet", "--output", "run"]).start();
        wait(&mut run, || home.at("run.checkpoints/checkpoint-000001.hdf5").exists());
        signal(name, run.id());
        let out = run.end();
        assert_eq!(out.status.code(), Some(4), "{name}: {}", out.stderr);
        assert!(out.stderr.starts_with("stopped at time "), "{}", out.stderr);
        assert!(out.stderr.contains("continue with --restart "), "{}", out.stderr);
        assert!(!home.at("run").exists() && !home.at(".run.flyer.lock").exists());
        // it continues from where it was
        let step = |text: &str| -> u64 {
            let (_, after) = text.split_once(", step ").unwrap();
            after.split(':').next().unwrap().parse().unwrap()
        };
        let args = ["--restart", "run", "--quiet", "--set", "time.wall_limit=1e-9"];
        let next = home.call(args).end();
        assert_eq!(next.status.code(), Some(4));
        assert_eq!(step(&next.stderr), step(&out.stderr) + 1);
        std::fs::remove_dir_all(home.at("run.checkpoints")).unwrap();
    }
}

#[test]
fn a_second_signal_ends_it_at_once() {
    let home = Home::with(&recorded(5));
    let Unheard { mut run, said: _said } = Unheard::start(&home);
    signal("-TERM", run.id());
    std::thread::sleep(Duration::from_millis(600));
    assert!(run.runs(), "the first signal waits for a step");
    signal("-TERM", run.id());
    assert_eq!(run.end().status.signal(), Some(15));
}

/// Without a folder of checkpoints there is nothing to continue from, and the message says so.
#[test]
fn a_run_without_checkpoints_is_stopped_too() {
    let home = Home::with(&recorded(5));
    let sets = ["output.checkpoint={\"keep\":0}", "time.wall_limit=1e-9"];
    let args = ["scene.json", "--set", sets[0], "--set", sets[1]];
    let out = home.call(args).end();
    assert_eq!(out.status.code(), Some(4));
    assert!(out.stderr.contains("no checkpoint was written"), "{}", out.stderr);
    // but its records
    let left = crate::home::names(&home.at("output/scene.unfinished"));
    assert!(left.iter().any(|name| name.starts_with("profile_")), "{left:?}");
    assert_eq!(crate::home::names(&home.at("output")), ["scene.unfinished"]);
}

/// One that nobody has asked for is there when it is needed, and goes with the end of the run.
#[test]
fn passing_checkpoints_go_with_a_good_end() {
    let mut scene = recorded(5);
    scene["output"].as_object_mut().unwrap().remove("checkpoint");
    let home = Home::with(&scene);
    let whole = home.run("whole", &[]);
    let args = ["scene.json", "--output", "run", "--set", "time.wall_limit=1e-9"];
    assert_eq!(home.call(args).end().status.code(), Some(4));
    assert!(home.at("run.checkpoints/checkpoint-000001.hdf5").exists());
    let args = ["--restart", "run.checkpoints", "--quiet", "--set", "time.wall_limit=null"];
    assert_eq!(home.call(args).end().succeeded(), "");
    same(&home.results("run"), &whole);
    assert_eq!(crate::home::names(home.path()), ["run", "scene.json", "whole"]);
}
