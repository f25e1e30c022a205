//! Measures what materials and effects promise, and prints each figure beside its bound.
//!
//! Started by `scripts/check_effects.sh`, which builds the program first. Arguments: names of
//! sections to run them alone. Exit code 1 where a bound is missed.

mod equations;
mod explosives;
mod heat;
mod paths;
mod plates;
#[path = "../common/resident.rs"]
mod resident;
#[path = "../common/runs.rs"]
mod runs;
mod spall;
mod strength;
#[path = "../common/table.rs"]
mod table;
mod tables;

use std::process::ExitCode;

use table::Table;

/// Checks one section.
type Section = fn(&mut Table);

const SECTIONS: [(&str, Section); 15] = [
    ("equations", equations::check),
    ("porous", equations::porous),
    ("tables", tables::check),
    ("products", explosives::products),
    ("burn", explosives::burn),
    ("paths", paths::check),
    ("strength_paths", strength::paths),
    ("piston", strength::piston),
    ("flyer", strength::flyer),
    ("taylor", strength::taylor),
    ("taylor_fine", strength::taylor_fine),
    ("spall", spall::check),
    ("heat", heat::check),
    ("plates", plates::check),
    ("window", plates::window),
];

/// Sections that take long, run where they are named alone.
const LONG: [&str; 1] = ["taylor_fine"];

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
        let asked = wanted.iter().any(|w| w == name);
        if asked || (wanted.is_empty() && !LONG.contains(&name)) {
            section(&mut table);
        }
    }
    println!("{} of {} bounds held", table.bounded - table.missed, table.bounded);
    if table.missed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
