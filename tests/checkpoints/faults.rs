//! Faults of the machine leave what was good, and say what to do.

use std::fs;
use std::process::Command;
#[cfg(feature = "mpi")]
use std::time::{Duration, Instant};

use crate::home::{Home, names};
use crate::program::signal;
use crate::restarts::{recorded, same};
use crate::stops::Unheard;

#[test]
fn the_second_run_into_a_folder_is_refused() {
    let home = Home::with(&recorded(20));
    let whole = home.run("output/scene", &[]);
    fs::remove_dir_all(home.at("output")).unwrap();
    let first = Unheard::start(&home);
    let process = format!("process {} on ", first.run.id());
    for _ in 0..2 {
        let second = home.call(["scene.json", "--quiet"]).end();
        second.failed(&["output/scene: ", &process, "another --output"]);
        assert_eq!(second.status.code(), Some(2));
    }
    // the first goes on as if nothing had been
    first.end().succeeded();
    same(&home.results("output/scene"), &whole);
    assert_eq!(names(&home.at("output")), ["scene", "scene.checkpoints"]);
}

#[test]
fn a_killed_run_holds_nobody_up() {
    let home = Home::with(&recorded(20));
    let run = Unheard::start(&home);
    signal("-KILL", run.run.id());
    assert!(!run.end().status.success());
    assert!(home.at("output/.scene.flyer.lock").exists());
    home.run("output/scene", &[]);
    assert_eq!(names(&home.at("output")), ["scene", "scene.checkpoints"]);
}

/// A limit on the size of files is a full disk that needs no disk.
#[test]
fn a_full_disk_leaves_the_last_good_checkpoint() {
    let home = Home::with(&recorded(20));
    let whole = home.run("run", &[]);
    fs::remove_dir_all(home.at("run.checkpoints")).unwrap();
    let args = ["scene.json", "--quiet", "--output", "run", "--set", "time.wall_limit=1e-9"];
    assert_eq!(home.call(args).end().status.code(), Some(4));
    let before = home.contents();
    // in blocks of 512 or 1024 bytes: less than any checkpoint takes
    let line = r#"trap "" XFSZ; ulimit -f 8; exec "$0" "$@""#;
    let out = Command::new("sh")
        .args(["-c", line, env!("CARGO_BIN_EXE_flyer-mpm")])
        .args(["--restart", "run", "--quiet", "--set", "time.wall_limit=null"])
        .current_dir(home.path())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(3), "{said}");
    assert!(said.contains("the last good checkpoint is ") && said.contains("--restart"), "{said}");
    assert!(said.contains("File too large: make room"), "{said}");
    assert!(!said.contains("panicked"), "{said}");
    assert_eq!(home.contents(), before);
    let args = ["--restart", "run", "--quiet", "--set", "time.wall_limit=null"];
    home.call(args).end().succeeded();
    same(&home.results("run"), &whole);
}

/// Lets a run begin, does something to its folder, and lets it go on; how it ends.
fn while_it_runs(home: &Home, what: impl FnOnce()) -> crate::program::Ended {
    let run = Unheard::start(home);
    what();
    run.end()
}

/// A folder that vanishes is made again, and the results are complete.
#[test]
fn a_folder_that_vanishes_is_made_anew() {
    let home = Home::with(&recorded(20));
    let whole = home.run("output/scene", &[]);
    fs::remove_dir_all(home.at("output")).unwrap();
    // the run may put files there while they are taken away
    let vanished = || {
        let _ = fs::remove_dir_all(home.at("output"));
        !home.at("output").exists()
    };
    let end = while_it_runs(&home, || while !vanished() {});
    end.succeeded();
    same(&home.results("output/scene"), &whole);
}

/// Where nothing can be written any more the run says so, and leaves what is there as it is. A file
/// in place of the folder is refused to everybody, as one without permission is to most.
#[test]
fn a_folder_that_cannot_be_written_any_more_is_reported() {
    let home = Home::with(&recorded(20));
    // the run may make the folder again before the file stands there
    let replaced = || {
        let _ = fs::remove_dir_all(home.at("output"));
        fs::write(home.at("output"), "not a folder").is_ok()
    };
    let end = while_it_runs(&home, || while !replaced() {});
    // refused before its first step, or failed when it comes to write
    assert!(matches!(end.status.code(), Some(2 | 3)), "{}", end.stderr);
    assert!(end.stderr.contains("output") && !end.stderr.contains("panicked"), "{}", end.stderr);
    assert_eq!(fs::read_to_string(home.at("output")).unwrap(), "not a folder");
}

/// Permission does not bind root, a disk mounted to be read only binds everybody. A mount of the
/// test's own needs root or user namespaces; where neither is, the test says so and ends.
#[test]
fn a_folder_on_a_disk_that_is_read_only_is_reported() {
    let home = Home::with(&recorded(20));
    fs::create_dir_all(home.at("disk/there")).unwrap();
    let mounted = r#"mount --bind disk disk && mount -o remount,bind,ro disk && exec "$0" "$@""#;
    let call = |by: &str, args: &[&str]| {
        let mut run = Command::new("unshare");
        run.args([by, "sh", "-c", mounted]).args(args).current_dir(home.path()).output()
    };
    let works = |by: &&str| call(by, &["true"]).is_ok_and(|out| out.status.success());
    let Some(by) = ["-m", "-rm"].into_iter().find(works) else {
        eprintln!("skipped: no mount of its own is allowed here");
        return;
    };
    let before = home.contents();
    // the folder of results, and its parent
    for output in ["disk/there", "disk/new/run"] {
        let program = env!("CARGO_BIN_EXE_flyer-mpm");
        let out = call(by, &[program, "scene.json", "--quiet", "--output", output]).unwrap();
        let said = String::from_utf8_lossy(&out.stderr);
        assert_eq!(out.status.code(), Some(2), "{said}");
        assert_eq!(said.lines().count(), 1, "{said}");
        assert!(said.contains("disk/") && said.contains("Read-only file system"), "{said}");
        assert_eq!(home.contents(), before);
    }
}

/// What a scene calls things never leads out of its folder.
#[test]
fn names_lead_nowhere() {
    let home = Home::with(&recorded(50));
    let sets = [
        "title=../../title",
        "bodies.flyer.name=../../flyer",
        "bodies.target.name=/tmp/flyer-mpm-target",
        "reference=null",
        "output.histories.tracers=[]",
        "output.pictures=true",
        r#"materials.../x={"density":1,"eos":{"type":"ideal_gas","gamma":1.4}}"#,
    ];
    // the last is no path at all
    home.call(["scene.json", "--set", sets[6]]).end().failed(&["--set", "an empty key"]);
    let sets = sets[..6].iter().flat_map(|set| ["--set", set]);
    home.call(["scene.json", "--quiet", "--output", "deep/er/run"].into_iter().chain(sets))
        .end()
        .succeeded();
    assert_eq!(names(home.path()), ["deep", "scene.json"]);
    assert_eq!(names(&home.at("deep")), ["er"]);
    assert_eq!(names(&home.at("deep/er")), ["run", "run.checkpoints"]);
    assert!(!std::path::Path::new("/tmp/flyer-mpm-target").exists());
    let tracer = r#"output.histories.tracers=[{"name":"../t","body":"target","at":[0.0002]}]"#;
    home.call(["scene.json", "--set", tracer]).end().failed(&["../t", "letters, digits"]);
}

/// A rank of the test below: one of two panics while the other waits for it.
#[cfg(feature = "mpi")]
#[test]
#[ignore = "started by another test, by mpirun"]
fn a_rank_that_panics() {
    use decomp::Comm;
    let Some(ranks) = decomp::comm::mpi::Mpi::start() else { return };
    if ranks.rank() == 1 {
        panic!("on purpose");
    }
    ranks.gather(&[]);
}

#[cfg(feature = "mpi")]
#[test]
fn a_panic_of_one_rank_ends_all() {
    let mut run = Command::new("mpirun")
        .args(["--oversubscribe", "--bind-to", "none", "-n", "2"])
        .arg(std::env::current_exe().unwrap())
        .args(["--exact", "faults::a_rank_that_panics", "--ignored", "--nocapture"])
        .env("OMPI_ALLOW_RUN_AS_ROOT", "1")
        .env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
        .env("OMPI_MCA_btl_vader_single_copy_mechanism", "none")
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let stderr = run.stderr.take().unwrap();
    let said = std::thread::spawn(|| std::io::read_to_string(stderr).unwrap_or_default());
    let since = Instant::now();
    let status = loop {
        if let Some(status) = run.try_wait().unwrap() {
            break Some(status);
        }
        // well below the time after which a rank that waits would end by itself
        if since.elapsed() > Duration::from_secs(60) {
            signal("-TERM", run.id());
            run.wait().unwrap();
            break None;
        }
        std::thread::sleep(Duration::from_millis(10));
    };
    let said = said.join().unwrap();
    assert!(status.is_some_and(|s| !s.success()), "{status:?}: {said}");
    assert!(said.contains("on purpose"), "{said}");
}
