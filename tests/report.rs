//! `report.html`: its size, its content, and its use in a browser.
//!
//! The browser is Debian's chromium; without one its tests are skipped. It has no network: names are
//! not resolved, and the page forbids itself to load anything.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

/// Greatest size of a report [bytes].
const LARGEST: u64 = 5_000_000;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Calls the program, which must succeed.
fn call<A: AsRef<OsStr>>(folder: &Path, arguments: impl IntoIterator<Item = A>) -> Output {
    let mut program = Command::new(env!("CARGO_BIN_EXE_flyer-mpm"));
    let ended = program.args(arguments).current_dir(folder).output().expect("the program starts");
    assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
    ended
}

/// Runs a shipped scene with these overrides and `--report`; returns the page.
fn reported(home: &Path, scene: &str, sets: &[&str]) -> PathBuf {
    let scene = root().join("inputs").join(scene);
    let mut arguments = vec![scene.to_str().unwrap(), "--quiet", "--report", "--output", "run"];
    arguments.extend(sets.iter().flat_map(|set| ["--set", set]));
    call(home, arguments);
    home.join("run/report.html")
}

/// A short run of the flyer plate with frames.
fn flyer(home: &Path) -> PathBuf {
    let fields = "output.fields={\"every\": 5e-8}";
    let sets = ["domain.cell_size=4e-5", "time.end=5e-7", "output.profiles.times=[5e-7]", fields];
    reported(home, "flyer.json", &sets)
}

/// A short run of a scene in a plane.
fn plane(home: &Path) -> PathBuf {
    let sets = ["time.end=0.2", "output.profiles.times=[0.1, 0.2]"];
    reported(home, "disks.json", &sets)
}

fn chromium() -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let names = std::env::split_paths(&path).map(|folder| folder.join("chromium"));
    let found = names.into_iter().find(|path| path.exists());
    if found.is_none() {
        eprintln!("not run: chromium is not installed");
    }
    found
}

/// What the probe has seen in a page, and the lines of the console.
fn probed(home: &Path, page: &Path, extra: &str) -> Option<(Value, Vec<String>)> {
    let browser = chromium()?;
    let text = fs::read_to_string(page).unwrap();
    let probe = fs::read_to_string(root().join("tests/data/report_probe.js")).unwrap();
    let with_probe = home.join("probe.html");
    let script = format!("{extra}<script>\n{probe}</script></html>");
    fs::write(&with_probe, text.replace("</html>", &script)).unwrap();
    let ended = Command::new(browser)
        .args(["--headless=new", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr"])
        .args(["--host-resolver-rules=MAP * ~NOTFOUND", "--virtual-time-budget=20000"])
        .arg(format!("--user-data-dir={}", home.join("browser").display()))
        .args(["--dump-dom", &format!("file://{}", with_probe.display())])
        .output()
        .expect("chromium starts");
    let dom = String::from_utf8_lossy(&ended.stdout);
    let seen = dom.split("<pre id=\"probe\">").nth(1).expect("the probe has ended");
    let seen = seen.split("</pre>").next().unwrap().replace("&gt;", ">").replace("&lt;", "<");
    let log = String::from_utf8_lossy(&ended.stderr);
    let console = log.lines().filter(|line| line.contains("CONSOLE")).map(str::to_owned).collect();
    Some((serde_json::from_str(&seen).unwrap(), console))
}

/// The number behind a word of a text.
fn number(text: &Value, word: &str) -> f64 {
    let text = text.as_str().unwrap();
    let rest = text.split(word).nth(1).unwrap_or_else(|| panic!("no {word} in {text}"));
    rest.split_whitespace().next().unwrap().trim_end_matches([',', ':']).parse().unwrap()
}

/// A part of the picture that was dragged over is larger afterwards, and a double click shows all.
fn zooms(seen: &Value, word: &str) {
    let width = |state: &str| number(&seen[state][1], word) - number(&seen[state][0], word);
    let [before, zoomed, reset] = ["before", "zoomed", "reset"].map(width);
    assert!(zoomed > 0.0 && zoomed < 0.4 * before, "{seen}");
    assert!((reset / before - 1.0).abs() < 1e-6, "{seen}");
}

#[test]
fn a_run_on_a_line_zooms_and_shows_values() {
    let home = tempfile::tempdir().unwrap();
    let page = flyer(home.path());
    let Some((seen, console)) = probed(home.path(), &page, "") else { return };
    assert!(console.is_empty(), "{console:#?}");
    zooms(&seen, "position ");
    // material at rest ahead of the shock
    assert!(seen["before"][1].as_str().unwrap().contains(": aluminium 0, exact 0 GPa"), "{seen}");
    assert!(seen["last"].as_str().unwrap().starts_with("500 ns"), "{seen}");
    assert!(seen["first"].as_str().unwrap().starts_with("0 s"), "{seen}");
}

#[test]
fn a_run_in_a_plane_zooms_and_shows_values() {
    let home = tempfile::tempdir().unwrap();
    let page = plane(home.path());
    let Some((seen, console)) = probed(home.path(), &page, "") else { return };
    assert!(console.is_empty(), "{console:#?}");
    zooms(&seen, "x ");
    assert!(seen["first"].as_str().unwrap().starts_with("100 ms"), "{seen}");
    assert_eq!([&seen["chosen"], &seen["legend"]], ["materials", "rubber"], "{seen}");
}

/// The console and the ban on loading are seen by the test.
#[test]
fn faults_of_a_page_reach_the_console() {
    let home = tempfile::tempdir().unwrap();
    let page = plane(home.path());
    let fault = "<img src=\"http://localhost/a.png\">";
    let Some((_, console)) = probed(home.path(), &page, fault) else { return };
    assert!(console.iter().any(|line| line.contains("Content Security Policy")), "{console:#?}");
}

#[test]
fn a_report_has_the_data_of_its_result() {
    let home = tempfile::tempdir().unwrap();
    let page = flyer(home.path());
    let text = fs::read_to_string(&page).unwrap();
    assert!(text.len() as u64 <= LARGEST, "{} bytes", text.len());
    let data = text.split("id=\"data\">").nth(1).unwrap().split("</script>").next().unwrap();
    let data: Value = serde_json::from_str(data).unwrap();
    let summary = fs::read_to_string(home.path().join("run/summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&summary).unwrap();
    for key in ["version", "machine", "patches", "effects", "measured", "warnings"] {
        assert_eq!(data["summary"][key], summary[key], "{key}");
    }
    assert_eq!(data["bodies"][0]["material"], "copper");
    assert_eq!(data["frames"]["frames"].as_array().unwrap().len(), 11);
    let exact = &data["exact"][0];
    let greatest = exact["values"]["pressure"].as_array().unwrap();
    let greatest = greatest.iter().filter_map(Value::as_f64).fold(0.0, f64::max);
    assert!((greatest / 12.144294e9 - 1.0).abs() < 1e-6, "{greatest}");
    // the same page later, elsewhere; a file of the user is not replaced
    let said = call(home.path(), ["report", "run", "--output", "again.html"]);
    assert_eq!(String::from_utf8_lossy(&said.stdout), "again.html\n");
    assert!(fs::read_to_string(home.path().join("again.html")).unwrap() == text);
    fs::write(home.path().join("again.html"), "mine").unwrap();
    let refused = Command::new(env!("CARGO_BIN_EXE_flyer-mpm"))
        .args(["report", "run", "--output", "again.html"])
        .current_dir(home.path())
        .output()
        .unwrap();
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("is not a report"));
}
