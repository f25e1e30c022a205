//! Measures what flyer-mpm promises, and prints each figure beside its bound of `bounds.toml`.
//!
//! ```sh
//! cargo run --release -p acceptance -- flyer plane/bits kills   # groups and sections by name
//! cargo run --release -p acceptance -- --list                   # groups and sections
//! cargo run --release -p acceptance -- --quick                  # the quick part of all
//! cargo run --release -p acceptance -- flyer --write            # its part of docs/verification.md
//! ```
//!
//! Exit code 1 where a bound is missed, 2 where the command line is wrong or the program cannot be
//! built. A group is a module with `TITLE` and `SECTIONS`, and a word in the list below.

mod bound;
mod bounds;
mod counts;
mod heap;
mod program;
mod report;
mod resident;
mod runs;
mod section;
mod table;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;

use section::{Extent, Group, Section, When, select};
use table::{Table, Verdict};

macro_rules! groups {
    ($($name:ident),* $(,)?) => {
        $(mod $name;)*

        /// Groups in the order in which they run.
        const GROUPS: &[Group] = &[$(Group {
            name: stringify!($name),
            title: $name::TITLE,
            sections: &$name::SECTIONS,
        }),*];
    };
}

groups!(
    flyer,
    plane,
    contact,
    accuracy,
    effects,
    hard_cases,
    decomposition,
    scale,
    reliability,
    resources,
    kernels
);

/// Measures what flyer-mpm promises, and prints each figure beside its bound.
#[derive(Parser)]
#[command(name = "acceptance")]
struct Arguments {
    /// Groups, sections as GROUP/SECTION, or sections by name; without names all groups.
    names: Vec<String>,
    /// Lists groups and sections.
    #[arg(long)]
    list: bool,
    /// Only sections that take seconds, and these with fewer layouts.
    #[arg(long)]
    quick: bool,
    /// All layouts, and long runs.
    #[arg(long, conflicts_with = "quick")]
    full: bool,
    /// Writes the figures of whole groups to docs/verification.md.
    #[arg(long)]
    write: bool,
    /// Path of a program that is built already; otherwise cargo builds it.
    #[arg(long)]
    program: Option<PathBuf>,
}

fn list() {
    for group in GROUPS {
        println!("{}: {}", group.name, group.title);
        for section in group.sections {
            let when = match section.when {
                When::Quick => " (quick)",
                When::Usual => "",
                When::Named => " (by name only)",
            };
            println!("  {}/{}{when}", group.name, section.name);
        }
    }
}

/// Runs sections of a group.
fn measure(group: &Group, sections: &[&Section], extent: Extent) -> Table {
    let mut table = Table::new(extent);
    for section in sections {
        table.begin(group.name, section.name);
        (section.run)(&mut table);
    }
    table
}

fn run(arguments: Arguments) -> Result<bool, String> {
    let extent = match (arguments.quick, arguments.full) {
        (true, _) => Extent::Quick,
        (_, true) => Extent::Full,
        _ => Extent::Usual,
    };
    let is_group = |name: &String| GROUPS.iter().any(|group| group.name == name);
    if let Some(name) = arguments.names.iter().find(|name| arguments.write && !is_group(name)) {
        return Err(format!("{name}: --write takes whole groups"));
    }
    if let Some(path) = arguments.program {
        program::take(path.canonicalize().map_err(|e| format!("{}: {e}", path.display()))?);
    }
    let (mut held, mut missed, mut not_measured) = (0, 0, 0);
    for (group, sections) in select(GROUPS, &arguments.names, extent)? {
        let table = measure(group, &sections, extent);
        held += table.count(Verdict::Held);
        missed += table.count(Verdict::Missed);
        not_measured += table.count(Verdict::NotMeasured);
        if arguments.write {
            report::write(group, &table)?;
        }
    }
    println!(
        "\n{held} of {} bounds held, {not_measured} not measured",
        held + missed + not_measured
    );
    Ok(missed == 0)
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    if arguments.list {
        list();
        return ExitCode::SUCCESS;
    }
    match run(arguments) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::from(2)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_group_has_a_place_in_the_document() {
        let text = std::fs::read_to_string(report::document()).unwrap();
        for group in GROUPS {
            assert!(report::replaced(&text, group.name, "").is_some(), "{}", group.name);
        }
    }

    #[test]
    fn names_of_groups_and_sections_are_unique() {
        for (k, group) in GROUPS.iter().enumerate() {
            assert!(GROUPS[..k].iter().all(|other| other.name != group.name));
            for (k, section) in group.sections.iter().enumerate() {
                let before = &group.sections[..k];
                assert!(before.iter().all(|other| other.name != section.name), "{}", section.name);
            }
        }
    }
}
