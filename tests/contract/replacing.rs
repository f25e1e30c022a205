//! An earlier result is replaced as a whole or left unchanged.

use std::fs;

use crate::home::{Home, names};
use crate::scenes::{mirrored_stray, short, stray, unstable};

#[test]
fn a_rerun_replaces_the_earlier_result_as_a_whole() {
    let home = Home::with(&short());
    let first = home.run("run", &[]);
    home.write("run/stale.csv", "1");
    home.write("run/more/stale.csv", "1");
    let second = home.run("run", &["--set", "bodies.flyer.velocity=[900]"]);
    assert_eq!(second.names(), first.names());
    assert_ne!(second.states(), first.states());
    assert_eq!(names(home.path()), ["run", "scene.json"]);
    // the same run again gives the same bytes
    assert_eq!(home.run("run", &[]).states(), first.states());
}

#[test]
fn keep_refuses_what_is_there() {
    let home = Home::with(&short());
    home.run("run", &["--keep"]);
    let before = home.contents();
    let again = home.call(["scene.json", "--keep", "--output", "run"]).end();
    again.failed(&["run", "--keep"]);
    assert_eq!(home.contents(), before);
}

#[test]
fn a_run_that_fails_leaves_the_earlier_result() {
    let home = Home::with(&short());
    home.run("output/scene", &[]);
    for (scene, what) in [
        (stray(), "leaves the domain by its upper side"),
        (mirrored_stray(), "leaves the domain by its lower side"),
        (unstable(), "body `"),
    ] {
        home.write("scene.json", &scene.to_string());
        let before = home.contents();
        for args in [vec!["scene.json"], vec!["scene.json", "--output", "made/for/it"]] {
            let failed = home.call(args).end();
            failed.failed(&["particle ", " of body `", " at x = ", ", time ", ", step ", what]);
            assert_eq!(home.contents(), before);
        }
    }
}

#[test]
fn a_fault_names_the_particle_that_has_it() {
    let home = Home::with(&stray());
    // the last of the 100 + 100 particles leaves the domain
    home.call(["scene.json"]).end().failed(&["particle 199 of body `target` at x = 1.99"]);
    let home = Home::with(&mirrored_stray());
    home.call(["scene.json"]).end().failed(&["particle 100 of body `target` at x = -1.99"]);
}

#[test]
fn what_is_not_a_result_is_not_replaced() {
    let home = Home::with(&short());
    home.write("mine/thesis.tex", "years of work");
    home.write("file", "work");
    fs::create_dir(home.at("empty")).unwrap();
    let before = home.contents();
    for (output, fragment) in [
        ("mine", "mine: holds files"),
        ("file", "file: is not a folder"),
        ("file/below", "file: is not a folder"),
        ("scene.json", "scene.json: is not a folder"),
        (".", "current folder"),
        ("/proc/flyer", "/proc"),
    ] {
        let refused = home.call(["scene.json", "--quiet", "--output", output]).end();
        refused.failed(&[fragment]);
        assert_eq!(refused.stderr.lines().count(), 1, "{}", refused.stderr);
        assert_eq!(home.contents(), before);
    }
    home.run("empty", &["--keep"]);
}

#[test]
fn a_link_to_the_results_stays() {
    let home = Home::with(&short());
    fs::create_dir(home.at("disk")).unwrap();
    std::os::unix::fs::symlink(home.at("disk"), home.at("output")).unwrap();
    home.call(["scene.json", "--quiet"]).end().succeeded();
    assert!(home.at("output").is_symlink());
    assert_eq!(names(&home.at("disk")), ["scene"]);
}
