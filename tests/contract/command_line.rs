//! Arguments: overrides, threads, help, and rejected ones.

use std::process::Command;

use serde_json::json;

use crate::home::{Home, names};
use crate::scenes::short;

#[test]
fn overrides_reach_every_place() {
    let mut scene = short();
    scene.as_object_mut().unwrap().remove("artificial_viscosity");
    let home = Home::with(&scene);
    let sets = [
        "domain.patches=[8]",
        "artificial_viscosity.linear=0.2",
        "artificial_viscosity.quadratic=2",
        "bodies.flyer.velocity=[500]",
        "bodies.1.velocity=[-25.5]",
        "bodies[1].particles_per_cell[0]=3",
        "title=a plate, = and \"all\"",
        "method.shape=cpdi",
        "method.transfer={\"fmpm\": 4}",
        "boundary.x_lower=\"outflow\"",
    ];
    let args: Vec<_> = sets.iter().flat_map(|set| ["--set", set]).collect();
    let run = home.run("run", &args);
    let scene = &run.summary["scene"];
    assert_eq!(scene["domain"]["patches"], json!([8]));
    assert_eq!(scene["artificial_viscosity"]["linear"], 0.2);
    assert_eq!(scene["artificial_viscosity"]["quadratic"], 2.0);
    assert_eq!(scene["bodies"][0]["velocity"], json!([500.0]));
    assert_eq!(scene["bodies"][1]["velocity"], json!([-25.5]));
    assert_eq!(scene["title"], "a plate, = and \"all\"");
    assert_eq!(scene["method"]["shape"], "cpdi");
    assert_eq!(scene["method"]["transfer"], json!({"fmpm": 4}));
    assert_eq!(scene["boundary"]["x_lower"], "outflow");
    assert_eq!(run.count("particles"), 100 + 450);
    assert_eq!(run.summary["title"], "a plate, = and \"all\"");
    // the file is unchanged
    assert_eq!(names(home.path()), ["run", "scene.json"]);
}

#[test]
fn the_scene_is_checked_after_all_overrides() {
    let home = Home::with(&short());
    // each of them would be rejected by itself
    let sets = ["--set", "time.end=1e-9", "--set", "output.profiles.times=[1e-9]"];
    assert_eq!(home.run("run", &sets).summary["profiles"][0]["time"], 1e-9);
    // the later one takes precedence
    let sets = ["--set", "time.courant=2", "--set", "time.courant=0.5"];
    assert_eq!(home.run("run", &sets).summary["scene"]["time"]["courant"], 0.5);
}

#[test]
fn what_cannot_be_understood_is_refused() {
    let home = Home::with(&short());
    let before = home.contents();
    let refused = |args: &[&str], fragments: &[&str]| {
        let all = ["scene.json"].into_iter().chain(args.to_vec());
        home.call(all).end().failed(fragments);
        assert_eq!(home.contents(), before);
    };
    refused(&["--threads", "0"], &["--threads", "0"]);
    refused(&["--threads", "abc"], &["--threads", "abc"]);
    refused(&["--threads", "-1"], &["-1"]);
    refused(&["--threads", "1.5"], &["--threads", "1.5"]);
    refused(&["--fast"], &["--fast"]);
    refused(&["--output"], &["--output"]);
    refused(&["second.json"], &["second.json"]);
    refused(&["--set", "time.end"], &["--set", "time.end", "PATH=VALUE"]);
    refused(&["--set", "=1"], &["--set", "PATH=VALUE"]);
    refused(&["--set", "bodies.flier.velocity=[1]"], &["bodies", "flier", "did you mean flyer"]);
    refused(&["--set", "bodies.7.velocity=[1]"], &["bodies", "7", "flyer"]);
    refused(&["--set", "tiem.end=1"], &["tiem", "did you mean time"]);
    refused(&["--set", "method.shape=spline"], &["method.shape", "spline", "cpdi"]);
    let out = home.call(["shema"]).end();
    out.failed(&["shema"]);
}

#[test]
fn help_and_version_are_reported() {
    let home = Home::new();
    let help = home.call(["--help"]).end().succeeded();
    let options = ["--set", "--output", "--threads", "--stall-timeout", "--keep", "--quiet"];
    for word in ["mpirun -n 2 flyer-mpm"].into_iter().chain(options) {
        assert!(help.contains(word), "no {word} in: {help}");
    }
    for word in
        ["hugoniot", "material", "check", "perf", "migrate", "schema", "compare", "summary.json"]
    {
        assert!(help.contains(word), "no {word} in: {help}");
    }
    let version = home.call(["--version"]).end().succeeded();
    assert_eq!(version.trim(), format!("flyer-mpm {}", env!("CARGO_PKG_VERSION")));
    for command in ["hugoniot", "material", "check", "perf", "migrate", "schema", "compare"] {
        home.call([command, "--help"]).end().succeeded();
    }
    assert!(names(home.path()).is_empty());
}

#[test]
fn an_example_in_the_help_stands_on_a_line_of_its_own() {
    let help = Home::new().call(["--help"]).end().succeeded();
    let examples = help.lines().filter(|line| line.matches("inputs/flyer.json").count() == 1);
    assert_eq!(examples.count(), 2, "{help}");
}

#[test]
fn without_arguments_it_says_how_it_is_used() {
    let home = Home::new();
    let out = home.call([]).end();
    assert!(!out.status.success());
    assert!(out.stderr.contains("Usage:") && out.stderr.contains("SCENE.json"), "{}", out.stderr);
    assert!(!out.stderr.contains("panicked"), "{}", out.stderr);
    assert!(names(home.path()).is_empty());
}

#[test]
fn faults_of_the_command_line_are_one_line() {
    let home = Home::with(&short());
    let says = |args: &[&str], line: &str| {
        let out = home.call(args.iter().copied()).end();
        assert_eq!((out.status.code(), out.stderr.trim_end()), (Some(2), line));
    };
    says(
        &["scene.json", "--outptu", "x"],
        "error: unexpected argument '--outptu' found; a similar argument exists: '--output'; see \
         --help",
    );
    says(
        &["plan", "scene.json"],
        "error: the following required arguments were not provided: --quantity <NAME> --error \
         <ERROR>; see --help",
    );
    says(
        &["scene.json", "--threads", "0"],
        "error: invalid value '0' for '--threads <N>': a whole number from 1 to 1024 is allowed; \
         see --help",
    );
    assert!(names(home.path()).iter().all(|name| name == "scene.json"));
}

#[test]
fn quiet_says_nothing_and_else_a_report_stands_at_the_end() {
    let home = Home::with(&short());
    let out = home.call(["scene.json", "--quiet"]).end();
    assert_eq!((out.stdout.as_str(), out.stderr.as_str()), ("", ""));
    let out = home.call(["scene.json"]).end();
    assert!(out.stderr.contains("400 particles") && out.stderr.contains("(chosen)"));
    let has = |text: &str, words: &[&str]| {
        for word in words {
            assert!(text.contains(word), "no {word} in: {text}");
        }
    };
    let brief = out.succeeded();
    has(&brief, &["pressure", "errors", "energy", "momentum", "steps", "output/scene"]);
    assert!(brief.lines().count() <= 10 && brief.lines().all(|l| l.len() <= 100), "{brief}");
    assert!(!brief.contains("share of step"), "{brief}");
    let full = home.call(["scene.json", "--verbose"]).end().succeeded();
    has(&full, &["L1", "energy", "momentum", "steps", "seconds", "share of step"]);
    let out = home.call(["scene.json", "--set", "domain.patches=[4]"]).end();
    assert!(!out.stderr.contains("(chosen)"), "{}", out.stderr);
}

/// A timeline in Chrome's format, for the steps requested.
#[test]
fn a_timeline_is_written() {
    let home = Home::with(&short());
    let args = ["scene.json", "--quiet", "--trace", "line.json", "--trace-steps", "2..3"];
    let patches = ["--set", "domain.patches=[4]", "--set", "decomposition.skip_quiescent=false"];
    home.call(args.into_iter().chain(patches)).end().succeeded();
    let text = std::fs::read_to_string(home.path().join("line.json")).unwrap();
    let trace: serde_json::Value = serde_json::from_str(&text).unwrap();
    let events = trace["traceEvents"].as_array().unwrap();
    let all = |key: &str| {
        let spans = events.iter().filter(|e| e["ph"] == "X");
        let mut values: Vec<u64> =
            spans.map(|e| e.get(key).unwrap_or(&e["args"][key]).as_u64().unwrap()).collect();
        values.sort_unstable();
        values.dedup();
        values
    };
    assert_eq!(all("step"), [2, 3]);
    assert_eq!(all("tid").last(), Some(&4), "patch 3 has a line");
    let named = |name: &str| events.iter().any(|e| e["name"] == name);
    assert!(["scatter", "gather", "exchange particles", "process_name"].into_iter().all(named));
    for bad in ["0..3", "5..2", "x", "3"] {
        let args = ["scene.json", "--trace", "line.json", "--trace-steps", bad];
        let out = home.call(args).end();
        assert_eq!(out.status.code(), Some(2));
        assert!(out.stderr.contains("1..200"), "{}", out.stderr);
    }
    // detected before the run, not at its end
    let out = home.call(["scene.json", "--quiet", "--trace", "none/line.json"]).end();
    out.failed(&["none/line.json", "cannot write"]);
    assert_eq!(out.status.code(), Some(2));
    let out = home.call(["scene.json", "--trace-steps", "1..2"]).end();
    assert!(!out.status.success() && out.stderr.contains("--trace"), "{}", out.stderr);
}

#[test]
fn no_environment_is_needed() {
    let home = Home::with(&short());
    let mut program = Command::new(env!("CARGO_BIN_EXE_flyer-mpm"));
    let status = program
        .env_clear()
        .current_dir(home.path())
        .args(["scene.json", "--quiet", "--threads", "2", "--set", "output.pictures=true"])
        .status();
    assert!(status.unwrap().success());
    assert_eq!(home.results("output/scene").count("ranks"), 1);
}

/// Names of all subcommands, those of `perf` too, from the help.
fn subcommands(home: &Home, of: &[&str]) -> Vec<String> {
    let help = home.call(of.iter().copied().chain(["--help"])).end().succeeded();
    let lines = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let lines = lines.take_while(|line| !line.is_empty());
    let names = lines.filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    names.filter_map(|line| line.split_whitespace().next()).map(String::from).collect()
}

#[test]
fn completions_name_every_command() {
    let home = Home::new();
    let commands = [subcommands(&home, &[]), subcommands(&home, &["perf"])].concat();
    assert!(commands.len() > 15 && commands.contains(&"calibrate".into()), "{commands:?}");
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = home.call(["completions", shell]).end().succeeded();
        for name in &commands {
            assert!(script.contains(name.as_str()), "no {name} for {shell}");
        }
        for option in ["restart", "ignore-memory", "progress"] {
            assert!(script.contains(option), "no --{option} for {shell}");
        }
    }
    home.write("flyer-mpm.bash", &home.call(["completions", "bash"]).end().succeeded());
    // the shell reads the script, and completes a command by it
    let typed = "source flyer-mpm.bash; COMP_WORDS=(flyer-mpm hug); COMP_CWORD=1; \
                 _flyer__mpm flyer-mpm hug flyer-mpm; echo \"${COMPREPLY[@]}\"";
    for (args, said) in [(["-n", "flyer-mpm.bash"], ""), (["-c", typed], "hugoniot\n")] {
        let bash = Command::new("bash").current_dir(home.path()).args(args).output().unwrap();
        assert!(bash.status.success(), "{}", String::from_utf8_lossy(&bash.stderr));
        assert_eq!(String::from_utf8_lossy(&bash.stdout), said);
    }
    home.call(["completions", "cmd"]).end().failed(&["cmd"]);
}

#[test]
fn there_is_a_page_for_every_command() {
    let home = Home::new();
    let page = home.call(["man"]).end().succeeded();
    assert!(page.contains(".TH flyer-mpm 1") && page.contains("stall\\-timeout"), "{page}");
    home.call(["man", "--output", "pages"]).end().succeeded();
    let pages = names(&home.at("pages"));
    for name in subcommands(&home, &[]).into_iter().filter(|name| name != "help") {
        assert!(pages.contains(&format!("flyer-mpm-{name}.1")), "no {name} in {pages:?}");
    }
    for name in ["flyer-mpm.1", "flyer-mpm-perf-study.1"] {
        assert!(pages.contains(&name.to_string()), "no {name} in {pages:?}");
    }
    home.write("file", "");
    home.call(["man", "--output", "file/below"]).end().failed(&["file/below: cannot write"]);
}

/// Where there is no terminal, no bar is drawn unless it is asked for.
#[test]
fn a_bar_is_drawn_without_a_terminal_only_if_it_is_asked_for() {
    let home = Home::with(&short());
    let long = ["--set", "domain.cell_size=1e-6", "--set", "time.end=1e-7"];
    let drawn = |choice: &str| {
        let args = ["scene.json", "--progress", choice].into_iter().chain(long);
        let out = home.call(args).end();
        assert!(out.status.success(), "{}", out.stderr);
        out.stderr.contains('\x1b')
    };
    assert_eq!(["auto", "always", "never"].map(drawn), [false, true, false]);
    home.call(["scene.json", "--progress", "often"]).end().failed(&["often"]);
}

#[test]
fn warnings_end_their_lines_between_words() {
    let home = Home::with(&short());
    let out = home
        .call([
            "scene.json",
            "--set",
            "monitor.on_courant_exceeded=allow",
            "--set",
            "materials.copper.density=8.93",
        ])
        .end();
    let warned = out.stderr.lines().filter(|line| line.starts_with("warning: ")).count();
    let more = out.stderr.lines().filter(|line| line.starts_with("         ")).count();
    assert!(warned > 0 && more > 0, "{}", out.stderr);
    assert!(
        out.stderr.lines().filter(|l| !l.starts_with("error: ")).all(|l| l.chars().count() <= 100),
        "{}",
        out.stderr
    );
}
