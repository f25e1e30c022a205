//! Runs the sections of a check that its arguments name, or all of them.

use std::process::ExitCode;

use super::table::Table;

/// Checks one section.
pub type Section = fn(&mut Table);

/// Runs the sections named on the command line; without names all but those of `long`, which take
/// long. Exit code 1 where a bound is missed, 2 where no section has such a name.
pub fn run(sections: &[(&str, Section)], long: &[&str]) -> ExitCode {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let known = |name: &str| sections.iter().any(|(section, _)| *section == name);
    if let Some(unknown) = wanted.iter().find(|name| !known(name)) {
        let names: Vec<_> = sections.iter().map(|(name, _)| *name).collect();
        eprintln!("{unknown}: expected one of {}", names.join(", "));
        return ExitCode::from(2);
    }
    let mut table = Table::new();
    for (name, section) in sections {
        let asked = wanted.iter().any(|w| w == name);
        if asked || (wanted.is_empty() && !long.contains(name)) {
            section(&mut table);
        }
    }
    println!("{} of {} bounds held", table.bounded - table.missed, table.bounded);
    if table.missed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
