//! Measures what checkpoints and faults promise, and prints each figure beside its bound.
//!
//! Started by `scripts/check_reliability.sh`, which builds the program first. Arguments: names of
//! sections to run them alone. Exit code 1 where a bound is missed.

mod cost;
mod damage;
mod full;
mod kills;
mod program;
mod restarts;
#[path = "../common/table.rs"]
mod table;

use std::process::ExitCode;

use table::Table;

/// Checks one section.
type Section = fn(&mut Table);

const SECTIONS: [(&str, Section); 5] = [
    ("restarts", restarts::check),
    ("kills", kills::check),
    ("full", full::check),
    ("damage", damage::check),
    ("cost", cost::check),
];

fn main() -> ExitCode {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let known = |name: &str| SECTIONS.iter().any(|(section, _)| *section == name);
    if let Some(unknown) = wanted.iter().find(|name| !known(name)) {
        let names: Vec<_> = SECTIONS.iter().map(|(name, _)| *name).collect();
        eprintln!("{unknown}: expected one of {}", names.join(", "));
        return ExitCode::from(2);
    }
    let mut table = Table::new();
    for (name, section) in SECTIONS {
        if wanted.is_empty() || wanted.iter().any(|w| w == name) {
            section(&mut table);
        }
    }
    println!("{} of {} bounds held", table.bounded - table.missed, table.bounded);
    if table.missed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
