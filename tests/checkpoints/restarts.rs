//! A run continued from its files writes the same files as an uninterrupted one.

use serde_json::{Value, json};

use crate::home::{Home, Results, checkpoints, names};
use crate::scenes::with;
use crate::small_scenes::small;

/// A small scene that records all there is, with a checkpoint every so many steps.
pub fn recorded(every: u64) -> Value {
    let edit = json!({
        "output": {
            "profiles": {"times": [1e-8, 2.5e-8, 5e-8]},
            "histories": {"interval": 1e-9, "tracers": [{"name": "t", "body": "target", "at": [0.0002]}]},
            "checkpoint": {"every_steps": every, "keep": 99},
            "pictures": false
        }
    });
    with(&small("flyer.json"), &edit)
}

/// Asserts that two runs have left the same, but for times and layouts.
#[track_caller]
pub fn same(a: &Results, b: &Results) {
    assert_eq!(a.names(), b.names());
    for name in a.names() {
        let same = name == "summary.json" || a.bytes(name) == b.bytes(name);
        assert!(same, "{name} is another");
    }
    let message = |run: &Results| {
        let mut summary = run.summary.clone();
        let object = summary.as_object_mut().unwrap();
        object.retain(|key, _| {
            let layout = ["ranks", "threads", "patches", "decomposition", "phase_seconds"];
            let time = key.ends_with("seconds") || key == "particle_steps_per_cpu_second";
            !time && !layout.contains(&key.as_str())
        });
        for effect in object["effects"].as_array_mut().unwrap() {
            effect.as_object_mut().unwrap().remove("step_share");
        }
        // energy, momentum and profiles with their digests and errors are among the rest
        assert!(object.len() >= 10, "{summary}");
        summary
    };
    assert_eq!(message(a), message(b));
}

#[test]
fn every_file_is_as_without_a_break() {
    let mut scene = recorded(25);
    scene["output"]["pictures"] = json!(true);
    scene["output"]["diagrams"] = json!(["velocity", "strain"]);
    scene["output"]["profiles"]["times"] = json!([0.0, 1e-8, 2.5e-8, 5e-8]);
    let home = Home::with(&scene);
    let whole = home.run("whole", &[]);
    let steps = whole.count("steps");
    for name in ["x_t_diagram.svg", "x_t_diagram_velocity.svg", "x_t_diagram_strain.svg"] {
        assert!(whole.names().contains(&name), "{:?}", whole.names());
    }
    let checkpoints = checkpoints(&home.at("whole.checkpoints"));
    assert_eq!(checkpoints.len() as u64, steps / 25);
    for (k, name) in checkpoints.iter().enumerate() {
        let (file, threads) = (format!("whole.checkpoints/{name}"), (1 + k % 2).to_string());
        let args = ["--restart", &file, "--quiet", "--output", "again", "--threads", &threads];
        assert_eq!(home.call(args).end().succeeded(), "");
        let again = home.results("again");
        same(&again, &whole);
        let from = again.summary["decomposition"]["first_step"].as_u64();
        assert_eq!(from, Some(25 * (k as u64 + 1)));
    }
    assert_eq!(whole.summary["decomposition"]["first_step"], 0);
    // another quantity is drawn from the restart on
    let file = format!("whole.checkpoints/{}", checkpoints[0]);
    let density = "output.diagrams=[\"density\",\"velocity\"]";
    let args = ["--restart", &file, "--output", "other", "--set", density];
    home.call(args).end().succeeded();
    let (other, drawn) = (home.results("other"), "x_t_diagram_velocity.svg");
    assert!(other.bytes(drawn) == whole.bytes(drawn));
    assert!(other.names().contains(&"x_t_diagram_density.svg"));
}

/// From the checkpoint of the very last step, and of steps at which something is recorded.
#[test]
fn steps_that_record_are_recorded_once() {
    let mut line = recorded(1);
    line["output"]["checkpoint"]["keep"] = json!(999);
    line["output"]["pictures"] = json!(true);
    // 11 and 17 steps: a time over the interval of the histories rounds below a whole number
    let plane = |end: f64, courant: f64, speed: f64| {
        json!({
            "title": "a pool",
            "domain": {"lower": [-6e-4, -8e-4], "upper": [6e-4, 8e-4], "cell_size": 1e-4},
            "boundary": {"x_lower": "periodic", "x_upper": "periodic", "y_lower": "symmetry"},
            "materials": {"m": {"library": "water"}},
            "bodies": [{
                "name": "b",
                "material": "m",
                "box": {"lower": [-5e-4, -8e-4], "upper": [5e-4, 6e-4]},
                "particles_per_cell": [2, 2],
                "velocity": [speed, -60.0],
            }],
            "method": {"shape": "gimp", "transfer": {"xpic": 3}, "stepping": "midpoint"},
            "artificial_viscosity": {"linear": 0.5, "quadratic": 0.0},
            "time": {"end": end, "courant": courant},
            "output": {
                "pictures": false,
                "profiles": {"times": [0.5 * end, end]},
                "checkpoint": {"every_steps": 1, "keep": 99},
                "histories": {},
            },
        })
    };
    let planes = [(1.2e-7, 0.3), (9e-8, 0.25), (1e-7, 0.4)].map(|(e, c)| plane(e, c, 300.0));
    for (scene, all) in std::iter::once((&line, false)).chain(planes.iter().map(|p| (p, true))) {
        let home = Home::with(scene);
        let whole = home.run("whole", &[]);
        let checkpoints = checkpoints(&home.at("whole.checkpoints"));
        assert_eq!(checkpoints.len() as u64, whole.count("steps"));
        let last = checkpoints.len() - 1;
        for (k, name) in checkpoints.iter().enumerate() {
            if !(all || k == last || k % 9 == 0) {
                continue;
            }
            let file = format!("whole.checkpoints/{name}");
            let args = ["--restart", &file, "--quiet", "--output", "again"];
            assert_eq!(home.call(args).end().succeeded(), "");
            same(&home.results("again"), &whole);
        }
    }
}

/// Broken after every few steps, each time another number of ranks.
#[cfg(feature = "mpi")]
#[test]
fn ranks_and_patches_change_on_the_way() {
    let mut scene = recorded(1_000_000);
    scene["time"]["end"] = json!(5e-8);
    let home = Home::with(&scene);
    let whole = home.run("whole", &[]);
    assert!(whole.count("steps") > 60);
    // stops after its first step
    let args = ["scene.json", "--quiet", "--output", "run", "--set", "time.wall_limit=1e-9"];
    assert_eq!(home.call(args).end().status.code(), Some(4));
    for (ranks, patches) in [(3, "[9]"), (2, "[1]"), (4, "[16]")] {
        let set = format!("domain.patches={patches}");
        let args = ["--restart", "run.checkpoints", "--quiet", "--set", &set];
        let stopped = home.call(args).ranks(ranks).end();
        assert_eq!(stopped.status.code(), Some(4), "{}", stopped.stderr);
        assert!(stopped.stderr.contains("time.wall_limit is over"), "{}", stopped.stderr);
    }
    // not a bit of what it ends with, the scene's keys for the layout aside, has changed
    let sets = ["time.wall_limit=null", "domain.patches=null"].map(|s| ["--set", s]).concat();
    let args = ["--restart", "run", "--quiet"].into_iter().chain(sets);
    assert_eq!(home.call(args).ranks(2).end().succeeded(), "");
    let again = home.results("run");
    same(&again, &whole);
    assert_eq!(again.summary["decomposition"]["first_step"], 4);
}

#[test]
fn a_run_is_extended() {
    let mut scene = recorded(10);
    scene["output"]["profiles"] = json!({});
    let home = Home::with(&scene);
    home.run("short", &["--set", "time.end=2e-8"]);
    let first = "short.checkpoints/checkpoint-000001.hdf5";
    let args = ["--restart", first, "--set", "time.end=5e-8", "--output", "long", "--quiet"];
    home.call(args).end().succeeded();
    let (long, whole) = (home.results("long"), home.run("whole", &[]));
    assert_eq!(long.states(), whole.states());
    assert_eq!(long.text("histories.csv"), whole.text("histories.csv"));
    assert_eq!(long.summary["energy"], whole.summary["energy"]);
}

#[test]
fn what_may_not_change_after_the_start_is_refused() {
    let home = Home::with(&recorded(20));
    home.run("run", &[]);
    let before = home.contents();
    for (set, fragments) in [
        (
            "bodies.flyer.velocity=[900]",
            vec!["--set bodies.flyer", "cannot change after", "time, monitor, o"],
        ),
        ("domain.cell_size=1e-6", vec!["cannot change after", "domain.patches"]),
        ("domain={}", vec!["cannot change after", "domain.patches"]),
        ("timer=1", vec!["cannot change after the start", "allowed with"]),
        ("time.end=1e-9", vec!["checkpoint-", "beyond time.end"]),
        ("output.profiles.times=[3e-9,5e-8]", vec!["output.profiles.times: 3e-9", "not recorded"]),
        ("output.histories.tracers=[]", vec!["output.histories", "the same tracers"]),
        ("output.checkpoint.every_steps=0", vec!["every_steps = 0", "at least 1"]),
    ] {
        let refused = home.call(["--restart", "run.checkpoints", "--set", set]).end();
        refused.failed(&fragments);
        assert_eq!(refused.status.code(), Some(2), "{set}");
        assert_eq!(home.contents(), before);
    }
    home.call(["--restart", "run.checkpoints", "scene.json"]).end().failed(&["cannot be used"]);
    home.call(["--restart", "scene.json"])
        .end()
        .failed(&["scene.json: is JSON text such as a scene"]);
    home.call(["--restart", "nowhere"]).end().failed(&["nowhere", "cannot be read"]);
    // what does make sense is taken
    let args = ["--restart", "run.checkpoints", "--quiet", "--output", "other"];
    let sets = ["output.hdf5=false", "decomposition.threads=2", "time.courant=0.3"];
    let sets = sets.iter().flat_map(|set| ["--set", set]);
    home.call(args.into_iter().chain(sets)).end().succeeded();
    assert!(!home.results("other").names().contains(&"results.hdf5"));
}

#[test]
fn the_newest_is_damaged() {
    let home = Home::with(&recorded(20));
    let whole = home.run("run", &[]);
    let newest = checkpoints(&home.at("run.checkpoints")).pop().unwrap();
    home.write(&format!("run.checkpoints/{newest}"), "flyer-mpm checkpoint\n");
    let out = home.call(["--restart", "run", "--output", "again"]).end();
    assert!(out.stderr.contains(&newest) && out.stderr.contains("damaged"), "{}", out.stderr);
    assert!(out.stderr.contains("taking the one before"), "{}", out.stderr);
    out.succeeded();
    same(&home.results("again"), &whole);
}

/// Each key decides when a checkpoint is written, and none changes dt.
#[test]
fn keys_say_when() {
    let mut scene = recorded(1);
    scene["output"].as_object_mut().unwrap().remove("checkpoint");
    let home = Home::with(&scene);
    let whole = home.run("whole", &[]);
    // nobody has asked for them, and the run was short
    assert_eq!(names(home.path()), ["scene.json", "whole"]);
    let count = |set: &str| {
        let run = home.run("run", &["--set", set]);
        assert_eq!(run.states(), whole.states());
        assert_eq!(run.text("histories.csv"), whole.text("histories.csv"));
        let folder = home.at("run.checkpoints");
        let found = if folder.exists() { checkpoints(&folder) } else { Vec::new() };
        let _ = std::fs::remove_dir_all(folder);
        found.len() as u64
    };
    let steps = whole.count("steps");
    assert_eq!(count(r#"output.checkpoint={"every_steps":7,"keep":1000}"#), steps / 7);
    assert_eq!(count(r#"output.checkpoint={"every_steps":7}"#), 2);
    assert_eq!(count(r#"output.checkpoint={"every_steps":7,"keep":0}"#), 0);
    assert_eq!(count(r#"output.checkpoint={"every_seconds":1e-8,"keep":9}"#), 5);
    assert_eq!(count(r#"output.checkpoint={"at_times":[1e-9,1.01e-9,3e-8,5e-8],"keep":9}"#), 3);
    assert_eq!(count(r#"output.checkpoint={"every_wall_seconds":1e-9,"keep":999}"#), steps);
    assert_eq!(count(r#"output.checkpoint={"every_wall_seconds":1e9}"#), 0);
    assert_eq!(count("output.checkpoint={}"), 0);
    for (set, fragment) in [
        ("output.checkpoint.at_times=[2e-8,1e-8]", "output.checkpoint.at_times[1] = 1e-8"),
        ("output.checkpoint.at_times=[1]", "output.checkpoint.at_times[0]"),
        ("output.checkpoint.every_seconds=0", "every_seconds = 0: not allowed"),
        ("output.checkpoint.every_wall_seconds=-1", "every_wall_seconds = -1"),
        ("output.checkpoint.keep=-1", "keep = -1"),
        ("output.checkpoint.ever=1", "unknown key"),
        ("time.wall_limit=0", "time.wall_limit = 0"),
    ] {
        home.call(["scene.json", "--set", set]).end().failed(&[fragment, "allowed"]);
    }
}
