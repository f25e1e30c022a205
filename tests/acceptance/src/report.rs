//! The figures of a group in `docs/verification.md`, between `<!-- begin GROUP -->` and
//! `<!-- end GROUP -->`.

use std::fmt::Write;
use std::fs;
use std::path::PathBuf;

use crate::program::root;
use crate::section::{Extent, Group};
use crate::table::Table;

/// The page that the figures are written to.
pub fn document() -> PathBuf {
    root().join("docs/verification.md")
}

/// Replaces the section of a group.
///
/// # Errors
///
/// The file cannot be read or written, or has no markers for the group.
pub fn write(group: &Group, table: &Table) -> Result<(), String> {
    let path = document();
    let failed = |error| format!("{}: {error}", path.display());
    let text = fs::read_to_string(&path).map_err(failed)?;
    let text = replaced(&text, group.name, &body(group, table, &machine()))
        .ok_or_else(|| format!("{} has no markers of {}", path.display(), group.name))?;
    fs::write(&path, text).map_err(failed)
}

/// `text` with `body` between the markers of a group.
pub fn replaced(text: &str, group: &str, body: &str) -> Option<String> {
    let (begin, end) = (format!("<!-- begin {group} -->\n"), format!("<!-- end {group} -->"));
    let (before, rest) = text.split_once(&begin)?;
    let (_, after) = rest.split_once(&end)?;
    Some(format!("{before}{begin}{body}{end}{after}"))
}

/// Heading, machine and one table per section.
fn body(group: &Group, table: &Table, machine: &str) -> String {
    let part = match table.extent {
        Extent::Quick => "the quick part",
        Extent::Usual => "all sections but those that run by name only",
        Extent::Full => "all sections but those that run by name only, all layouts",
    };
    let mut text = format!("## {}\n\n{}. Run: {part}; {machine}.\n", group.name, group.title);
    let mut section = "";
    for row in &table.rows {
        if row.section != section {
            section = row.section;
            let _ = write!(text, "\n### {}/{section}\n\n", group.name);
            text += "| figure | measured | bound | ok |\n|---|---|---|---|\n";
        }
        let _ = writeln!(text, "{}", row.line([0; 4]));
    }
    text
}

/// Model and number of the processors.
fn machine() -> String {
    let text = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let line = text.lines().find(|line| line.starts_with("model name"));
    let model = line.and_then(|line| line.split_once(':')).map_or("unknown CPU", |(_, m)| m.trim());
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    format!("{model}, {cores} cores")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::Unit;

    #[test]
    fn the_text_between_the_markers_of_a_group_is_replaced() {
        let text = "a\n<!-- begin x -->\nold\n<!-- end x -->\nb <!-- begin y -->\n";
        let new = "a\n<!-- begin x -->\nnew\n<!-- end x -->\nb <!-- begin y -->\n";
        assert_eq!(replaced(text, "x", "new\n").as_deref(), Some(new));
        assert_eq!(replaced(text, "y", "new\n"), None);
        assert_eq!(replaced(text, "z", "new\n"), None);
    }

    #[test]
    fn a_section_has_its_own_table() {
        let group = Group { name: "flyer", title: "Title", sections: &[] };
        let mut table = Table::new(Extent::Quick);
        table.begin("flyer", "bits");
        table.holds("a", "1", "1", true);
        table.begin("flyer", "speed");
        table.beside("b", Some(0.5), "", Unit::One);
        let text = body(&group, &table, "one core");
        let head = "| figure | measured | bound | ok |\n|---|---|---|---|\n";
        assert_eq!(
            text,
            format!(
                "## flyer\n\nTitle. Run: the quick part; one core.\n\n### flyer/bits\n\n{head}\
                 | a | 1 | 1 | yes |\n\n### flyer/speed\n\n{head}| b | 0.5000 |  |  |\n"
            )
        );
    }
}
