//! README.md and the pages of docs/: their size, their links, and the generated reference.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::home::Home;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// README.md and docs/*.md.
fn pages() -> Vec<PathBuf> {
    let docs = fs::read_dir(root().join("docs")).unwrap().map(|entry| entry.unwrap().path());
    let pages = docs.filter(|path| path.extension().is_some_and(|e| e == "md"));
    pages.chain([root().join("README.md")]).collect()
}

/// Lines outside code blocks.
fn prose(text: &str) -> impl Iterator<Item = &str> {
    let mut in_code = false;
    text.lines().filter(move |line| {
        let fence = line.trim_start().starts_with("```");
        in_code ^= fence;
        !in_code && !fence
    })
}

/// Targets of the links and pictures in a page, other than addresses in the web.
fn links(text: &str) -> Vec<String> {
    let targets = prose(text).flat_map(|line| line.split("](").skip(1));
    let targets = targets.filter_map(|rest| rest.split(')').next());
    targets.filter(|target| !target.contains("://")).map(str::to_string).collect()
}

/// Names under which links find the headings of a page.
fn anchors(text: &str) -> BTreeSet<String> {
    let headings = prose(text).filter(|line| line.starts_with('#'));
    let kept = |c: char| match c {
        ' ' => Some('-'),
        c if c.is_alphanumeric() || "-_".contains(c) => Some(c.to_ascii_lowercase()),
        _ => None,
    };
    headings.map(|line| line.trim_matches(['#', ' ']).chars().filter_map(kept).collect()).collect()
}

#[test]
fn the_reference_of_scenes_is_the_output_of_the_program() {
    let printed = Home::new().call(["schema", "--markdown"]).end().succeeded();
    let page = fs::read_to_string(root().join("docs/scene.md")).unwrap();
    assert!(printed == page, "flyer-mpm schema --markdown > docs/scene.md writes the present one");
    for section in ["## Scene", "## Body", "### Eos `mie_gruneisen`", "## Monitor"] {
        assert!(page.lines().any(|line| line == section), "{section}");
    }
}

#[test]
fn the_reference_explains_every_key() {
    let page = fs::read_to_string(root().join("docs/scene.md")).unwrap();
    let rows = page.lines().filter(|line| line.starts_with("| `"));
    let mut count = 0;
    for row in rows {
        let cells: Vec<&str> = row.trim_matches('|').split(" | ").collect();
        assert!(cells.len() >= 4 && cells[2].trim().len() > 1, "a key without text: {row}");
        count += 1;
    }
    assert!(count > 250, "{count} keys");
}

#[test]
fn the_gallery_shows_every_scene() {
    let page = fs::read_to_string(root().join("docs/gallery.md")).unwrap();
    let mut count = 0;
    for folder in ["inputs", "inputs/hard"] {
        let files = fs::read_dir(root().join(folder)).unwrap().map(|entry| entry.unwrap().path());
        for scene in files.filter(|path| path.extension().is_some_and(|e| e == "json")) {
            let name = scene.file_stem().unwrap().to_str().unwrap();
            let command = format!("`flyer-mpm {folder}/{name}.json`");
            assert!(page.contains(&command), "scripts/gallery.py: {command}");
            let picture = root().join(format!("docs/gallery/{name}.png"));
            let size = fs::metadata(&picture).map(|data| data.len()).unwrap_or(0);
            assert!((1000..=60_000).contains(&size), "{}: {size} bytes", picture.display());
            count += 1;
        }
    }
    assert!(count > 40, "{count} scenes");
}

/// The schema that the shipped scenes name for editors is the program's.
#[test]
fn the_schema_of_the_inputs_is_the_output_of_the_program() {
    let printed = Home::new().call(["schema"]).end().succeeded();
    let file = root().join("inputs/schema/scene.schema.json");
    let text = fs::read_to_string(file).unwrap();
    assert!(
        printed == text,
        "flyer-mpm schema > inputs/schema/scene.schema.json writes the present one"
    );
    let mut count = 0;
    for folder in ["inputs", "inputs/hard"] {
        let folder = root().join(folder);
        let files = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path());
        for scene in files.filter(|path| path.extension().is_some_and(|e| e == "json")) {
            let value: Value = serde_json::from_str(&fs::read_to_string(&scene).unwrap()).unwrap();
            let named = folder.join(value["$schema"].as_str().expect("a name"));
            let same = fs::canonicalize(named).unwrap();
            assert_eq!(
                same,
                fs::canonicalize(root().join("inputs/schema/scene.schema.json")).unwrap()
            );
            count += 1;
        }
    }
    assert!(count > 40, "{count} scenes");
}

#[test]
fn the_readme_is_short() {
    let text = fs::read_to_string(root().join("README.md")).unwrap();
    let (lines, words) = (text.lines().count(), text.split_whitespace().count());
    assert!(lines <= 150, "{lines} lines");
    assert!(words <= 1500, "{words} words");
}

#[test]
fn links_lead_to_files_and_headings() {
    let mut count = 0;
    for page in pages() {
        let text = fs::read_to_string(&page).unwrap();
        for link in links(&text) {
            let (file, heading) = link.split_once('#').unwrap_or((&link, ""));
            let target = match file {
                "" => page.clone(),
                file => page.parent().unwrap().join(file),
            };
            assert!(target.exists(), "{}: {link}: no such file", page.display());
            if !heading.is_empty() {
                let known = anchors(&fs::read_to_string(&target).unwrap());
                assert!(known.contains(heading), "{}: {link}: no such heading", page.display());
            }
            count += 1;
        }
    }
    assert!(count > 50, "{count} links");
}

#[test]
fn the_summary_has_every_page() {
    let summary = fs::read_to_string(root().join("docs/SUMMARY.md")).unwrap();
    let listed: BTreeSet<String> = links(&summary).into_iter().collect();
    for page in pages().iter().filter(|page| page.parent().unwrap().ends_with("docs")) {
        let name = page.file_name().unwrap().to_str().unwrap();
        assert!(name == "SUMMARY.md" || listed.contains(name), "{name} is not in SUMMARY.md");
    }
}

/// A row of the table of the presets: name, mean of E1, median and worst overshoot.
fn preset_rows() -> Vec<(String, f64, [f64; 2])> {
    let page = fs::read_to_string(root().join("docs/methods.md")).unwrap();
    let table = page.split("<!-- begin presets -->\n").nth(1).unwrap();
    let table = table.split("<!-- end presets -->").next().unwrap();
    let row = |line: &str| {
        let cells: Vec<&str> = line.trim_matches(['|', ' ']).split(" | ").collect();
        let number = |k: usize| cells[k].trim_end_matches(" %").parse().unwrap();
        (cells[0].trim_matches('`').to_string(), number(1), [number(4), number(5)])
    };
    let rows: Vec<_> = table.lines().skip(2).map(row).collect();
    assert!(rows.len() > 12, "{rows:?}");
    rows
}

/// `sharpest` meets its rule: its mean of E1 is within 1 % of the least, and its median overshoot exceeds
/// the smallest of such schemes by at most 0.1 percentage points.
#[test]
fn the_table_of_the_presets_keeps_the_rule_of_sharpest() {
    let rows = preset_rows();
    let least = rows.iter().map(|row| row.1).fold(f64::INFINITY, f64::min);
    let equal = rows.iter().filter(|row| row.1 <= 1.01 * least);
    let smallest = equal.map(|row| row.2[0]).fold(f64::INFINITY, f64::min);
    let sharpest = rows.iter().find(|row| row.0 == "sharpest").unwrap();
    assert!(sharpest.1 <= 1.01 * least, "{rows:?}");
    assert!(sharpest.2[0] <= smallest + 0.1 + 1e-9, "{rows:?}");
}

/// `robust` has the smallest median and worst overshoot.
#[test]
fn the_table_of_the_presets_keeps_the_rule_of_robust() {
    let rows = preset_rows();
    let robust = rows.iter().find(|row| row.0 == "robust").unwrap();
    for other in rows.iter().filter(|row| row.0 != "robust") {
        assert!((0..2).all(|k| robust.2[k] <= other.2[k]), "{other:?}, {robust:?}");
    }
}

/// `default` and `robust` pass every hard case: each cell of their rows is a number.
#[test]
fn presets_pass_the_hard_cases() {
    let page = fs::read_to_string(root().join("docs/hard_cases.md")).unwrap();
    let cells = |line: &str| -> Vec<String> {
        line.trim_matches(['|', ' ']).split(" | ").map(String::from).collect()
    };
    let rows: Vec<Vec<String>> = page.lines().filter(|l| l.starts_with('|')).map(cells).collect();
    for preset in ["default", "default, updated frame", "robust"] {
        let row = rows.iter().find(|row| row[0] == preset).expect(preset);
        assert_eq!(row.len(), rows[0].len(), "{preset}");
        assert!(row[1..].iter().all(|cell| cell.parse::<f64>().is_ok()), "{preset}: {row:?}");
    }
}
