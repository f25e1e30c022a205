//! docs/terminal.md: what runs print.

use std::path::Path;

use crate::home::Home;

/// The blocks of the page: command and printed lines.
fn blocks() -> Vec<(String, String)> {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/terminal.md");
    let page = std::fs::read_to_string(page).unwrap();
    let blocks = page.split("```text\n$ flyer-mpm ").skip(1);
    let blocks = blocks.map(|rest| rest.split("```").next().unwrap().split_once('\n').unwrap());
    blocks.map(|(command, lines)| (command.into(), lines.into())).collect()
}

/// The text with the time of the run replaced.
fn masked(text: &str) -> String {
    let line = |line: &str| match line.split_once(" thread: ") {
        Some((start, _)) => format!("{start} thread: T s\n"),
        None => format!("{line}\n"),
    };
    text.lines().map(line).collect()
}

#[test]
fn the_page_has_the_lines_of_a_run() {
    let blocks = blocks();
    assert_eq!(blocks.len(), 6);
    let (command, lines) = blocks.iter().find(|(c, _)| c == "shock_tube.json").unwrap();
    let home = Home::new();
    home.call(["new", "shock_tube"]).end().succeeded();
    let out = home.call([command.as_str(), "--progress", "never"]).end();
    assert_eq!(&masked(&format!("{}{}", out.stderr, out.stdout)), lines);
}

/// The report of a plain run has at most ten lines and its warnings, each of at most 100 characters.
#[test]
fn the_lines_of_a_run_are_few_and_short() {
    for (command, lines) in blocks() {
        assert!(lines.lines().all(|line| line.chars().count() <= 100), "{command}: {lines}");
        // after the lines of the start
        let method = |line: &&str| line.starts_with("method ") || line.starts_with("  ");
        let report = lines.lines().skip(1).skip_while(method);
        let is_warning =
            |line: &&str| line.starts_with("warning: ") || line.starts_with("         ");
        let report: Vec<&str> =
            report.filter(|line| !is_warning(line) || line.contains(" computed")).collect();
        assert!((6..=10).contains(&report.len()), "{command}: {report:#?}");
    }
}
